//! The part of the image that is rendered: drawn with the mouse, outlined, taken away again.

use super::*;

/// A rectangle with a side shorter than this was a click, points.
const SIDE_MIN: f32 = 6.0;

/// Drawing a region.
#[derive(Default)]
pub struct RegionTool {
    /// The next drag is the region.
    is_armed: bool,
    /// Where the drag began, points.
    from: Option<Pos2>,
    /// What had the keys in the frame before: escape takes them from it before it is seen here.
    focused: Option<Id>,
}

impl RegionTool {
    pub fn arm(&mut self) {
        (self.is_armed, self.from) = (true, None);
    }

    /// Shows the region over the image at `place`; true while the viewport's drags are its own.
    pub fn show(&mut self, ui: &mut Ui, response: &Response, place: Rect, desk: &mut Desk) -> bool {
        let is_wanted = self.is_armed || desk.document.render.region.is_some();
        if is_wanted && self.takes_escape(ui, response) {
            if !self.is_armed {
                desk.act(Command::ClearRegion);
            }
            self.is_armed = false;
        }
        self.focused = ui.memory(|memory| memory.focused());
        if self.is_armed {
            self.draw(ui, response, place, desk);
            return true;
        }
        if let Some(region) = desk.document.render.region {
            outline(ui, response.rect, place_of(region, place), desk);
        }
        false
    }

    /// Whether escape was pressed and nothing else wants it.
    fn takes_escape(&self, ui: &Ui, response: &Response) -> bool {
        let is_free = self.focused.is_none_or(|id| id == response.id)
            && ui.memory(|memory| memory.top_modal_layer().is_none())
            && !Popup::is_any_open(ui.ctx());
        is_free && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape))
    }

    fn draw(&mut self, ui: &mut Ui, response: &Response, place: Rect, desk: &mut Desk) {
        if response.hovered() || self.from.is_some() {
            ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
        }
        let text = "Drag a rectangle: only that part is rendered. Escape leaves it.";
        let top = place.center_top() + vec2(0.0, 10.0);
        let colors = [ui.visuals().panel_fill, ui.visuals().strong_text_color()];
        plate(ui.painter(), Align2::CENTER_TOP, top, text, colors);
        if response.drag_started_by(PointerButton::Primary) {
            self.from = ui.input(|input| input.pointer.press_origin());
        }
        let Some((from, to)) = self.from.zip(response.interact_pointer_pos()) else {
            return;
        };
        let drawn = Rect::from_two_pos(from, to).intersect(place);
        let is_large = drawn.width() >= SIDE_MIN && drawn.height() >= SIDE_MIN;
        if is_large {
            frame(ui, response.rect, drawn);
        }
        if response.drag_stopped() {
            self.from = None;
            if is_large {
                desk.document.render.region = Some(region_of(drawn, place));
                desk.edits.did("Render region");
                self.is_armed = false;
            }
        }
    }
}

/// Left, top, right and bottom of a rectangle as shares of the image.
fn region_of(drawn: Rect, place: Rect) -> [f64; 4] {
    let share = |at: Pos2| (at - place.min) / place.size();
    let (from, to) = (share(drawn.min), share(drawn.max));
    [from.x, from.y, to.x, to.y].map(|share| f64::from(share.clamp(0.0, 1.0)))
}

fn place_of([left, top, right, bottom]: [f64; 4], place: Rect) -> Rect {
    let at = |x: f64, y: f64| place.min + vec2(x as f32, y as f32) * place.size();
    Rect::from_min_max(at(left, top), at(right, bottom))
}

/// Light and dark, so that it is seen against everything.
fn frame(ui: &Ui, area: Rect, at: Rect) {
    let painter = ui.painter_at(area);
    let accent = theme::accent(ui);
    for (at, color) in [(at.expand(1.0), Color32::from_black_alpha(160)), (at, accent)] {
        painter.rect_stroke(at, 0.0, Stroke::new(1.0, color), StrokeKind::Inside);
    }
}

fn outline(ui: &mut Ui, area: Rect, at: Rect, desk: &mut Desk) {
    frame(ui, area, at);
    let corner = at.intersect(area).right_top() + vec2(-26.0, 4.0);
    let corner = Rect::from_min_size(corner, Vec2::splat(theme::ROW_HEIGHT));
    let mut inside = over(ui, "clear region", corner);
    let help = "Render the whole image again (Esc)";
    if icons::button(&mut inside, Icon::Close, Command::ClearRegion.label(), help).clicked() {
        desk.act(Command::ClearRegion);
    }
}
