//! An image with a name, to choose: as a tile of a grid, or as a row of a list; with a button for what else can be done.

use egui::text::LayoutJob;
use egui::{Color32, Mesh, Rect, Response, Sense, Shape, TextStyle, TextureHandle, Ui, Vec2, pos2, vec2};

use super::theme;
use super::widgets::PictureRow;

/// Between tiles, points.
const GAP: f32 = 6.0;
/// Side of the button in a tile's corner, points.
const BUTTON: f32 = 18.0;

/// How things are laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layout {
    /// Rows with thumbnails of this height.
    List(f32),
    /// A grid of images of this height.
    Grid(f32),
}

/// What is shown.
pub struct Tile<'a> {
    /// What stands below the image, or beside it.
    pub name: &'a str,
    /// What it is called where only one thing may have a name.
    pub full_name: &'a str,
    /// What the button is called.
    pub menu_name: &'a str,
    /// `None` until it is there.
    pub picture: Option<&'a TextureHandle>,
    /// Width of the image over its height.
    pub aspect: f32,
    /// Stands in for the image.
    pub color: Color32,
    pub is_current: bool,
    pub is_favourite: bool,
}

/// Tiles side by side, in as many rows as they take.
pub fn grid(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = Vec2::splat(GAP);
        content(ui);
    });
}

/// Begins another row of a grid where there is no room for something so wide, points.
pub fn make_room(ui: &mut Ui, width: f32) {
    if ui.available_size_before_wrap().x < width {
        ui.end_row();
    }
}

impl Tile<'_> {
    /// Shows it; `menu` is what its button and a right click open.
    pub fn show(&self, ui: &mut Ui, layout: Layout, mut menu: impl FnMut(&mut Ui)) -> Response {
        match layout {
            Layout::List(height) => self.row(ui, height, &mut menu),
            Layout::Grid(height) => self.tile(ui, height, &mut menu),
        }
    }

    fn row(&self, ui: &mut Ui, height: f32, menu: &mut dyn FnMut(&mut Ui)) -> Response {
        ui.horizontal(|ui| {
            let width = ui.available_width() - 32.0;
            let row = PictureRow {
                name: self.name,
                full_name: self.full_name,
                picture: self.picture,
                size: vec2(height * self.aspect, height),
                color: self.color,
                is_current: self.is_current,
            };
            let response = ui.allocate_ui(vec2(width, height), |ui| row.show(ui)).inner;
            if self.is_favourite {
                star(ui, response.rect.right_center() - vec2(10.0, 0.0));
            }
            response.context_menu(&mut *menu);
            let button = ui.menu_button("…", &mut *menu).response;
            button.accessible_name(self.menu_name);
            response
        })
        .inner
    }

    fn tile(&self, ui: &mut Ui, height: f32, menu: &mut dyn FnMut(&mut Ui)) -> Response {
        let font = TextStyle::Small.resolve(ui.style());
        let line = ui.fonts_mut(|fonts| fonts.row_height(&font));
        let picture = vec2(height * self.aspect, height);
        let (rect, response) = ui.allocate_exact_size(picture + vec2(0.0, line + 4.0), Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, self.is_current, self.full_name));
        let place = Rect::from_min_size(rect.left_top(), picture);
        match self.picture {
            Some(picture) => egui::Image::new(picture).corner_radius(4.0).paint_at(ui, place),
            None => _ = ui.painter().rect_filled(place, 4.0, self.color),
        }
        let visuals = ui.style().interact_selectable(&response, self.is_current);
        let is_lit = response.hovered() || response.has_focus() || response.contains_pointer();
        if self.is_current || is_lit {
            let accent = theme::accent(ui.visuals().dark_mode);
            let color = if self.is_current {
                accent
            } else {
                visuals.fg_stroke.color
            };
            let stroke = egui::Stroke::new(if self.is_current { 2.0 } else { 1.0 }, color);
            ui.painter().rect_stroke(place, 4.0, stroke, egui::StrokeKind::Inside);
        }
        let mut job = LayoutJob::simple_singleline(self.name.to_owned(), font, ui.visuals().text_color());
        job.wrap = egui::text::TextWrapping::truncate_at_width(picture.x);
        job.halign = egui::Align::Center;
        let galley = ui.painter().layout_job(job);
        ui.painter().galley(
            pos2(place.center().x, place.bottom() + 2.0),
            galley,
            ui.visuals().text_color(),
        );
        if self.is_favourite {
            star(ui, place.left_top() + Vec2::splat(10.0));
        }
        self.corner_button(ui, place, is_lit, menu);
        response.context_menu(&mut *menu);
        response.on_hover_text(self.full_name)
    }

    /// A button in the corner, seen while the tile is pointed at or has the keys.
    fn corner_button(&self, ui: &mut Ui, place: Rect, is_lit: bool, menu: &mut dyn FnMut(&mut Ui)) {
        let corner = Rect::from_min_size(place.right_top() - vec2(BUTTON + 2.0, -2.0), Vec2::splat(BUTTON));
        let mut over = ui.new_child(egui::UiBuilder::new().max_rect(corner).id_salt(self.menu_name));
        over.spacing_mut().button_padding = vec2(3.0, 0.0);
        over.spacing_mut().interact_size = Vec2::splat(BUTTON);
        let id = egui::Id::unique(("corner button", self.menu_name));
        let was_seen = over.ctx().data(|data| data.get_temp::<bool>(id).unwrap_or_default());
        if !is_lit && !was_seen {
            over.set_opacity(0.0);
        }
        let button = over.menu_button("…", &mut *menu).response;
        let is_seen = button.has_focus() || button.hovered() || egui::Popup::is_id_open(ui.ctx(), button.id);
        ui.ctx().data_mut(|data| data.insert_temp(id, is_seen));
        button.accessible_name(self.menu_name);
    }
}

/// Side of the image that follows the pointer in a drag, and how far it is from it, points.
const DRAGGED: f32 = 56.0;
const DRAGGED_BY: f32 = 10.0;

/// Shows what is dragged beside the pointer: what is under the pointer stays in sight.
pub fn at_pointer(ui: &Ui, picture: Option<&TextureHandle>, color: Color32) {
    let Some(at) = ui.input(|input| input.pointer.latest_pos()) else {
        return;
    };
    let layer = egui::LayerId::new(egui::Order::Tooltip, egui::Id::unique("what is dragged"));
    let painter = ui.ctx().layer_painter(layer);
    let place = Rect::from_min_size(at + Vec2::splat(DRAGGED_BY), Vec2::splat(DRAGGED));
    match picture {
        Some(picture) => {
            let whole = Rect::from_min_max(egui::Pos2::ZERO, pos2(1.0, 1.0));
            painter.image(picture.id(), place, whole, Color32::WHITE);
        }
        None => _ = painter.rect_filled(place, 4.0, color),
    }
    let stroke = egui::Stroke::new(2.0, theme::accent(ui.visuals().dark_mode));
    painter.rect_stroke(place, 4.0, stroke, egui::StrokeKind::Outside);
}

/// The mark of a favourite, of five points; drawn, as fonts differ.
fn star(ui: &Ui, center: egui::Pos2) {
    let color = Color32::from_rgb(255, 196, 60);
    let mut mesh = Mesh::default();
    mesh.colored_vertex(center, color);
    for corner in 0..10 {
        let angle = std::f32::consts::TAU * (corner as f32 / 10.0 - 0.25);
        let radius = if corner % 2 == 0 { 6.0 } else { 2.6 };
        mesh.colored_vertex(center + radius * Vec2::angled(angle), color);
    }
    for corner in 0..10 {
        mesh.add_triangle(0, 1 + corner, 1 + (corner + 1) % 10);
    }
    ui.painter().circle_filled(center, 8.0, Color32::from_black_alpha(120));
    ui.painter().add(Shape::mesh(mesh));
}
