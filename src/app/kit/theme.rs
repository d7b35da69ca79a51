//! Dark and light, in untinted greys: colour is judged against its surroundings. One accent.

use egui::style::{HandleShape, ScrollStyle, Selection, WidgetVisuals, Widgets};
use egui::{
    Color32, CornerRadius, FontDefinitions, FontFamily, FontId, Margin, Shadow, Stroke, Style, TextStyle, Theme, Vec2,
    Visuals,
};

/// Space between the parts of a panel, points.
pub const GAP: f32 = 8.0;
/// Height of a row of a panel, points.
pub const ROW_HEIGHT: f32 = 22.0;
/// Height of bars: the menu, the viewport's header, tabs, the status bar.
pub const BAR_HEIGHT: f32 = 28.0;
/// Space around the contents of a panel, points.
pub const PANEL_MARGIN: i8 = 10;

/// The greys of a theme, from the darkest surface to the text.
struct Palette {
    /// Behind and between the panels.
    ground: u8,
    panel: u8,
    /// What is typed into.
    well: u8,
    widget: u8,
    hovered: u8,
    pressed: u8,
    line: u8,
    weak_text: u8,
    text: u8,
    strong_text: u8,
}

const DARK: Palette = Palette {
    ground: 22,
    panel: 36,
    well: 26,
    widget: 58,
    hovered: 70,
    pressed: 82,
    line: 52,
    weak_text: 140,
    text: 196,
    strong_text: 238,
};

const LIGHT: Palette = Palette {
    ground: 176,
    panel: 226,
    well: 246,
    widget: 206,
    hovered: 194,
    pressed: 180,
    line: 196,
    weak_text: 96,
    text: 40,
    strong_text: 8,
};

/// The one colour of the interface.
pub fn accent(is_dark: bool) -> Color32 {
    if is_dark {
        Color32::from_rgb(86, 148, 214)
    } else {
        Color32::from_rgb(32, 102, 176)
    }
}

/// What surrounds the image: a grey that is neither black nor white, so that both can be distinguished from it.
pub fn surround(is_dark: bool) -> Color32 {
    Color32::from_gray(if is_dark { 28 } else { 150 })
}

pub fn install(ctx: &egui::Context) {
    ctx.set_fonts(fonts());
    ctx.set_style_of(Theme::Dark, style(&DARK, true));
    ctx.set_style_of(Theme::Light, style(&LIGHT, false));
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

fn style(palette: &Palette, is_dark: bool) -> Style {
    let mut style = Style {
        visuals: visuals(palette, is_dark),
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

fn visuals(palette: &Palette, is_dark: bool) -> Visuals {
    let grey = Color32::from_gray;
    let accent = accent(is_dark);
    let widget = |fill: u8, line: Option<u8>, text: u8| WidgetVisuals {
        bg_fill: grey(fill),
        weak_bg_fill: grey(fill),
        bg_stroke: line.map_or(Stroke::NONE, |line| Stroke::new(1.0, grey(line))),
        corner_radius: CornerRadius::same(3),
        fg_stroke: Stroke::new(1.0, grey(text)),
        expansion: 0.0,
    };
    let shadow = Shadow {
        offset: [0, 4],
        blur: 16,
        spread: 0,
        color: Color32::from_black_alpha(if is_dark { 120 } else { 60 }),
    };
    let base = if is_dark { Visuals::dark() } else { Visuals::light() };
    Visuals {
        widgets: Widgets {
            noninteractive: widget(palette.panel, Some(palette.line), palette.text),
            inactive: widget(palette.widget, None, palette.text),
            hovered: widget(palette.hovered, None, palette.strong_text),
            active: widget(palette.pressed, None, palette.strong_text),
            open: widget(palette.hovered, None, palette.strong_text),
        },
        selection: Selection {
            bg_fill: accent.gamma_multiply(if is_dark { 0.55 } else { 0.35 }),
            stroke: Stroke::new(
                1.0,
                if is_dark {
                    Color32::WHITE
                } else {
                    grey(palette.strong_text)
                },
            ),
        },
        weak_text_color: Some(grey(palette.weak_text)),
        hyperlink_color: accent,
        faint_bg_color: grey(if is_dark { palette.panel + 5 } else { palette.panel - 8 }),
        extreme_bg_color: grey(palette.well),
        code_bg_color: grey(palette.well),
        warn_fg_color: if is_dark {
            Color32::from_rgb(230, 170, 70)
        } else {
            Color32::from_rgb(150, 92, 0)
        },
        error_fg_color: if is_dark {
            Color32::from_rgb(240, 110, 100)
        } else {
            Color32::from_rgb(180, 30, 20)
        },
        window_corner_radius: CornerRadius::same(6),
        window_shadow: shadow,
        window_fill: grey(palette.panel),
        window_stroke: Stroke::new(1.0, grey(palette.line)),
        menu_corner_radius: CornerRadius::same(5),
        panel_fill: grey(palette.panel),
        popup_shadow: shadow,
        indent_has_left_vline: false,
        slider_trailing_fill: true,
        handle_shape: HandleShape::Circle,
        ..base
    }
}

/// The grey between the panels.
pub fn ground(is_dark: bool) -> Color32 {
    Color32::from_gray(if is_dark { DARK.ground } else { LIGHT.ground })
}
