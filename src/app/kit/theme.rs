//! Dark and light, in untinted greys: colour is judged against its surroundings. One accent.

use egui::style::{HandleShape, ScrollStyle, Selection, WidgetVisuals, Widgets};
use egui::*;

use crate::render::worker::Level;

/// Space between the parts of a panel, points.
pub const GAP: f32 = 8.0;
/// Height of a row of a panel, points.
pub const ROW_HEIGHT: f32 = 22.0;
/// Height of bars: the menu, the viewport's header, tabs, the status bar.
pub const BAR_HEIGHT: f32 = 28.0;
/// Space around the contents of a panel, points.
pub const PANEL_MARGIN: i8 = 10;

/// The one colour of the interface.
pub fn accent(ui: &Ui) -> Color32 {
    ui.visuals().hyperlink_color
}

/// A grey of the dark theme, and of the light one.
fn grey(is_dark: bool, [dark, light]: [u8; 2]) -> Color32 {
    Color32::from_gray(if is_dark { dark } else { light })
}

/// What surrounds the image: a grey that is neither black nor white, so that both can be distinguished from it.
pub fn surround(is_dark: bool) -> Color32 {
    grey(is_dark, [28, 150])
}

pub fn install(ctx: &Context) {
    ctx.set_fonts(fonts());
    ctx.set_style_of(Theme::Dark, style(true));
    ctx.set_style_of(Theme::Light, style(false));
}

/// egui's fonts; what the proportional one lacks, such as the cube root, comes from the one for code.
fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    let monospace = fonts.families.get(&FontFamily::Monospace).cloned().unwrap_or_default();
    let proportional = fonts.families.entry(FontFamily::Proportional).or_default();
    for name in monospace {
        if !proportional.contains(&name) {
            proportional.push(name);
        }
    }
    fonts
}

fn style(is_dark: bool) -> Style {
    let mut style = Style {
        visuals: visuals(is_dark),
        ..Style::default()
    };
    let font = |size: f32| FontId::new(size, FontFamily::Proportional);
    style.text_styles = [
        (TextStyle::Small, font(11.0)),
        (TextStyle::Body, font(13.0)),
        (TextStyle::Button, font(13.0)),
        (TextStyle::Heading, font(15.0)),
        (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
    ]
    .into();
    let spacing = &mut style.spacing;
    spacing.item_spacing = Vec2::new(8.0, 5.0);
    spacing.button_padding = Vec2::new(8.0, 2.0);
    spacing.interact_size = Vec2::new(36.0, ROW_HEIGHT);
    spacing.menu_margin = Margin::same(6);
    spacing.window_margin = Margin::same(12);
    spacing.icon_width = 15.0;
    spacing.icon_width_inner = 9.0;
    spacing.slider_rail_height = 4.0;
    spacing.combo_height = 420.0;
    spacing.tooltip_width = 320.0;
    spacing.scroll = ScrollStyle {
        bar_width: 8.0,
        floating_width: 4.0,
        floating_allocated_width: 6.0,
        ..ScrollStyle::floating()
    };
    style.animation_time = 0.08;
    style.interaction.tooltip_delay = 0.4;
    style
}

fn visuals(is_dark: bool) -> Visuals {
    let grey = |dark: u8, light: u8| grey(is_dark, [dark, light]);
    let (panel, well, line) = (grey(36, 226), grey(26, 246), grey(52, 196));
    let (text, strong_text, hovered) = (grey(196, 40), grey(238, 8), grey(70, 194));
    let color = |dark: [u8; 3], light: [u8; 3]| {
        let [r, g, b] = if is_dark { dark } else { light };
        Color32::from_rgb(r, g, b)
    };
    let accent = color([86, 148, 214], [32, 102, 176]);
    let widget = |fill: Color32, bg_stroke: Stroke, text: Color32| WidgetVisuals {
        bg_fill: fill,
        weak_bg_fill: fill,
        bg_stroke,
        corner_radius: CornerRadius::same(3),
        fg_stroke: Stroke::new(1.0, text),
        expansion: 0.0,
    };
    let shadow = Shadow {
        offset: [0, 4],
        blur: 16,
        spread: 0,
        color: Color32::from_black_alpha(if is_dark { 120 } else { 60 }),
    };
    Visuals {
        widgets: Widgets {
            noninteractive: widget(panel, Stroke::new(1.0, line), text),
            inactive: widget(grey(58, 206), Stroke::NONE, text),
            hovered: widget(hovered, Stroke::NONE, strong_text),
            active: widget(grey(82, 180), Stroke::NONE, strong_text),
            open: widget(hovered, Stroke::NONE, strong_text),
        },
        selection: Selection {
            bg_fill: accent.gamma_multiply(if is_dark { 0.55 } else { 0.35 }),
            stroke: Stroke::new(1.0, grey(255, 8)),
        },
        weak_text_color: Some(grey(140, 96)),
        hyperlink_color: accent,
        faint_bg_color: grey(41, 218),
        extreme_bg_color: well,
        code_bg_color: well,
        warn_fg_color: color([230, 170, 70], [150, 92, 0]),
        error_fg_color: color([240, 110, 100], [180, 30, 20]),
        window_corner_radius: CornerRadius::same(6),
        window_shadow: shadow,
        window_fill: panel,
        window_stroke: Stroke::new(1.0, line),
        menu_corner_radius: CornerRadius::same(5),
        panel_fill: panel,
        popup_shadow: shadow,
        indent_has_left_vline: false,
        slider_trailing_fill: true,
        handle_shape: HandleShape::Circle,
        ..if is_dark { Visuals::dark() } else { Visuals::light() }
    }
}

/// The colour of what is said.
pub fn level_color(visuals: &Visuals, level: Level) -> Color32 {
    match level {
        Level::Error => visuals.error_fg_color,
        Level::Warning => visuals.warn_fg_color,
        Level::Info => visuals.text_color(),
    }
}

/// The grey between the panels.
pub fn ground(is_dark: bool) -> Color32 {
    grey(is_dark, [22, 176])
}
