//! An image with a name, to choose: as a tile of a grid, or as a row of a list; with a button for what else can be done.

use egui::text::LayoutJob;
use egui::*;

use super::theme;

/// Side of the button in a tile's corner, points.
const BUTTON: f32 = 18.0;

/// Lines of a name below an image.
const LINES: usize = 2;

/// How things are laid out.
#[derive(Clone, Copy)]
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
    /// `None` until it is there.
    pub picture: Option<&'a TextureHandle>,
    /// Of the image, points.
    pub size: Vec2,
    /// Stands in for the image.
    pub color: Color32,
    pub is_current: bool,
}

/// An image of so many columns and rows by its sRGB bytes, opacity last.
pub fn pixels(size: [u32; 2], rgba: &[u8]) -> ColorImage {
    ColorImage::from_rgba_unmultiplied(size.map(|side| side as usize), rgba)
}

/// An opaque image.
pub fn rgb_pixels(image: &image::RgbImage) -> ColorImage {
    ColorImage::from_rgb([image.width() as usize, image.height() as usize], image)
}

/// Tiles side by side, in as many rows as they take.
pub fn grid(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = Vec2::splat(6.0);
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
    /// Shows it; `menu` is what its button, which has a name, and a right click open.
    pub fn show(
        &self,
        ui: &mut Ui,
        layout: Layout,
        (menu_name, is_favourite): (&str, bool),
        mut menu: impl FnMut(&mut Ui),
    ) -> Response {
        let (response, at) = match layout {
            Layout::List(height) => ui.horizontal(|ui| {
                let size = vec2(ui.available_width() - 32.0, height);
                let response = ui.allocate_ui(size, |ui| self.row(ui)).inner;
                let button = ui.menu_button("…", &mut menu).response;
                button.accessible_name(menu_name);
                let star = response.rect.right_center() - vec2(10.0, 0.0);
                (response, star)
            }),
            Layout::Grid(_) => ui.scope(|ui| {
                let response = self.cell(ui, menu_name, &mut menu).on_hover_text(self.full_name);
                let star = response.rect.left_top() + Vec2::splat(10.0);
                (response, star)
            }),
        }
        .inner;
        if is_favourite {
            star(ui, at);
        }
        response.context_menu(&mut menu);
        response
    }

    fn place(&self, ui: &mut Ui, size: Vec2) -> Response {
        let (_, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, self.is_current, self.full_name));
        response
    }

    /// The middle of the image fills its place.
    fn paint(&self, ui: &Ui, place: Rect) {
        let Some(picture) = self.picture else {
            let line = ui.visuals().widgets.noninteractive.bg_stroke;
            ui.painter().rect(place, 3.0, self.color, line, StrokeKind::Inside);
            return;
        };
        let size = picture.size_vec2();
        let scale = (place.width() / size.x).max(place.height() / size.y);
        let middle = Rect::from_center_size(pos2(0.5, 0.5), place.size() / (scale * size));
        Image::new(picture).uv(middle).corner_radius(3.0).paint_at(ui, place);
    }

    /// The name in so many lines, as far as it goes.
    fn text(&self, ui: &Ui, style: TextStyle, width: f32, max_rows: usize) -> std::sync::Arc<Galley> {
        let (font, color) = (style.resolve(ui.style()), Color32::PLACEHOLDER);
        let mut job = LayoutJob::simple(self.name.to_owned(), font, color, width.max(1.0));
        job.wrap.max_rows = max_rows;
        job.wrap.break_anywhere = max_rows == 1;
        ui.painter().layout_job(job)
    }

    /// The image with the name beside it.
    pub fn row(&self, ui: &mut Ui) -> Response {
        let response = self.place(ui, vec2(ui.available_width(), self.size.y + 4.0));
        let rect = response.rect;
        let visuals = ui.style().interact_selectable(&response, self.is_current);
        if self.is_current || response.hovered() || response.has_focus() {
            ui.painter()
                .rect_filled(rect, visuals.corner_radius, visuals.weak_bg_fill);
        }
        let place = Rect::from_min_size(rect.left_top() + vec2(4.0, 2.0), self.size);
        self.paint(ui, place);
        let left = place.right() + 10.0;
        let text = self.text(ui, TextStyle::Body, rect.right() - left - 4.0, 1);
        let at = pos2(left, rect.center().y - 0.5 * text.size().y);
        ui.painter().galley(at, text, visuals.text_color());
        response
    }

    /// The image with the name below it, and in its corner a button, which is seen while it is pointed at or has the keys.
    pub fn cell(&self, ui: &mut Ui, menu_name: &str, menu: impl FnMut(&mut Ui)) -> Response {
        let line = ui.text_style_height(&TextStyle::Small);
        let response = self.place(ui, self.size + vec2(0.0, LINES as f32 * line + 4.0));
        let place = Rect::from_min_size(response.rect.left_top(), self.size);
        self.paint(ui, place);
        let is_lit = response.hovered() || response.has_focus() || response.contains_pointer();
        let frame = match (self.is_current, is_lit) {
            (true, _) => Stroke::new(2.0, theme::accent(ui)),
            (_, true) => Stroke::new(1.0, ui.style().interact(&response).fg_stroke.color),
            _ => Stroke::NONE,
        };
        ui.painter().rect_stroke(place, 4.0, frame, StrokeKind::Inside);
        let color = ui.visuals().text_color();
        let text = self.text(ui, TextStyle::Small, self.size.x, LINES);
        let at = pos2(place.center().x - 0.5 * text.size().x, place.bottom() + 2.0);
        ui.painter().galley(at, text, color);
        let corner = Rect::from_min_size(place.right_top() - vec2(BUTTON + 2.0, -2.0), Vec2::splat(BUTTON));
        let mut over = ui.new_child(UiBuilder::new().max_rect(corner).id_salt(menu_name));
        over.spacing_mut().button_padding = vec2(3.0, 0.0);
        over.spacing_mut().interact_size = Vec2::splat(BUTTON);
        let id = Id::unique(("corner button", menu_name));
        if !is_lit && !over.data(|data| data.get_temp(id).unwrap_or(false)) {
            over.set_opacity(0.0);
        }
        let button = over.menu_button("…", menu).response;
        let is_seen = button.has_focus() || button.hovered() || Popup::is_id_open(ui.ctx(), button.id);
        ui.data_mut(|data| data.insert_temp(id, is_seen));
        button.accessible_name(menu_name);
        response
    }

    /// Shows it beside the pointer while it is dragged: what is under the pointer stays in sight.
    pub fn at_pointer(&self, ui: &mut Ui) {
        let Some(at) = ui.input(|input| input.pointer.latest_pos()) else {
            return;
        };
        let layer = LayerId::new(Order::Tooltip, Id::unique("what is dragged"));
        let place = Rect::from_min_size(at + Vec2::splat(10.0), Vec2::splat(56.0));
        let color = theme::accent(ui);
        let mut over = ui.new_child(UiBuilder::new().layer_id(layer).max_rect(place));
        over.set_clip_rect(Rect::EVERYTHING);
        self.paint(&over, place);
        let frame = Stroke::new(2.0, color);
        over.painter().rect_stroke(place, 4.0, frame, StrokeKind::Outside);
    }
}

/// The mark of a favourite, of five points; drawn, as fonts differ.
fn star(ui: &Ui, center: Pos2) {
    let color = Color32::from_rgb(255, 196, 60);
    let mut mesh = Mesh::default();
    mesh.colored_vertex(center, color);
    for corner in 0..10 {
        let angle = std::f32::consts::TAU * (corner as f32 / 10.0 - 0.25);
        let radius = if corner % 2 == 0 { 6.0 } else { 2.6 };
        mesh.colored_vertex(center + radius * Vec2::angled(angle), color);
        mesh.add_triangle(0, 1 + corner, 1 + (corner + 1) % 10);
    }
    ui.painter().circle_filled(center, 8.0, Color32::from_black_alpha(120));
    ui.painter().add(Shape::mesh(mesh));
}
