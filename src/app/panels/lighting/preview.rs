//! The environment as it lies around the model: it turns with its rotation, and is dragged to turn it.

use egui::{
    Color32, ColorImage, CursorIcon, Key, Modifiers, PointerButton, Pos2, Rect, Response, Sense, Stroke, TextureHandle,
    TextureOptions, Ui, pos2, vec2,
};

use crate::app::desk::Desk;
use crate::app::kit::keys::hold_arrows;
use crate::render::environment_thumbnails::SIZE;
use crate::render::worker::Scene;
use crate::scene::environment::{EnvironmentSource, brightened};

/// Radius of the ring around the brightest place, points.
const RING: f32 = 7.0;
/// Degrees to which the rotation snaps.
const SNAP_DEG: f32 = 15.0;
/// Share of the pointer's way that counts with shift.
const FINE: f32 = 0.1;

/// The image as it is shown, and what is done to it.
#[derive(Default)]
pub struct Preview {
    texture: Option<TextureHandle>,
    /// The environment and the strength that the texture shows.
    key: Option<(EnvironmentSource, f32, usize)>,
    /// The rotation at which a drag began, and where.
    held: Option<(f32, Pos2)>,
}

impl Preview {
    /// The environment in use, as large as the panel lets it be.
    pub fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        let Some(scene) = desk.snapshot.scene.clone() else {
            return;
        };
        let width = ui.available_width();
        let (place, response) = ui.allocate_exact_size(vec2(width, 0.5 * width), Sense::click_and_drag());
        let rotation_deg = desk.document.lighting.rotation_deg;
        response.widget_info(|| egui::WidgetInfo::slider(true, rotation_deg.into(), "Environment preview"));
        self.react(ui, &response, desk);
        self.upload(ui, &scene, desk);
        self.paint(ui, place, &response, &scene, desk.document.lighting.rotation_deg);
        let environment = &scene.job.environment;
        let [width, height] = [environment.width, environment.height];
        let help = "Drag it, or press the arrow keys, to turn it; with ctrl in steps of 15°, with shift finely. The ring marks \
                    its brightest place.";
        response
            .on_hover_cursor(CursorIcon::ResizeHorizontal)
            .on_hover_text(format!("{}, {width} × {height}. {help}", environment.name));
    }

    fn react(&mut self, ui: &Ui, response: &Response, desk: &mut Desk<'_>) {
        let before = desk.document.lighting.rotation_deg;
        let mut rotation_deg = before;
        if response.drag_started_by(PointerButton::Primary) {
            let from = ui.input(|input| input.pointer.press_origin());
            self.held = from.map(|from| (before, from));
            desk.edits.seal();
        }
        if response.clicked() {
            response.request_focus();
        }
        let modifiers = ui.input(|input| input.modifiers);
        if let Some((start_deg, from)) = self.held {
            // It ends the drag for the interface, too.
            if ui.input(|input| input.key_pressed(Key::Escape)) {
                rotation_deg = start_deg;
                self.held = None;
            } else if !response.dragged() {
                self.held = None;
                desk.edits.seal();
            } else if let Some(at) = response.interact_pointer_pos()
                && at != from
            {
                let share = if modifiers.shift { FINE } else { 1.0 };
                let turned = start_deg - 360.0 * share * (at.x - from.x) / response.rect.width();
                rotation_deg = wrapped_deg(if modifiers.command {
                    (turned / SNAP_DEG).round() * SNAP_DEG
                } else {
                    turned
                });
            }
        }
        if response.has_focus() {
            rotation_deg = keyed(ui, response, rotation_deg);
        }
        if rotation_deg != before {
            desk.document.lighting.rotation_deg = rotation_deg;
            desk.edits.note("Turn the environment", "Environment rotation");
        }
    }

    /// The thumbnail under the strength that the document has.
    fn upload(&mut self, ui: &Ui, scene: &Scene, desk: &Desk<'_>) {
        let lighting = &desk.document.lighting;
        let source = &scene.document.lighting.environment;
        let Some(pixels) = desk.shared.environments.pixels(source) else {
            return;
        };
        let key = (source.clone(), lighting.strength, pixels.as_ptr() as usize);
        if self.key.as_ref() == Some(&key) {
            return;
        }
        let shown = brightened(pixels, lighting.strength);
        let image = ColorImage::from_rgba_unmultiplied(SIZE.map(|side| side as usize), &shown);
        match &mut self.texture {
            Some(texture) => texture.set(image, TextureOptions::LINEAR),
            None => {
                self.texture = Some(
                    ui.ctx()
                        .load_texture("environment preview", image, TextureOptions::LINEAR),
                )
            }
        }
        self.key = Some(key);
    }

    fn paint(&self, ui: &Ui, place: Rect, response: &Response, scene: &Scene, rotation_deg: f32) {
        let painter = ui.painter_at(place);
        painter.rect_filled(place, 3.0, ui.visuals().extreme_bg_color);
        // Anticlockwise seen from above is to the left of who looks around from within.
        let shift = (-rotation_deg / 360.0).rem_euclid(1.0);
        let is_current = self
            .key
            .as_ref()
            .is_some_and(|(of, ..)| *of == scene.document.lighting.environment);
        if let Some(texture) = self.texture.as_ref().filter(|_| is_current) {
            // The map's left edge lies at the shift, and goes on at the left of the image.
            let part = |from: f32, to: f32, u: f32| {
                let x = |share: f32| place.left() + share * place.width();
                let at = Rect::from_min_max(pos2(x(from), place.top()), pos2(x(to), place.bottom()));
                let uv = Rect::from_min_max(pos2(u, 0.0), pos2(u + to - from, 1.0));
                painter.image(texture.id(), at, uv, Color32::WHITE);
            };
            part(0.0, shift, 1.0 - shift);
            part(shift, 1.0, 0.0);
        }
        if let Some([u, v]) = scene.job.environment.brightest {
            let at = place.min + vec2((u + shift).rem_euclid(1.0), v) * place.size();
            // Where the ring crosses the image's side, its other half is on the other side.
            for turns in [-1.0, 0.0, 1.0] {
                let at = at + vec2(turns * place.width(), 0.0);
                painter.circle_stroke(at, RING, Stroke::new(3.5, Color32::from_black_alpha(150)));
                painter.circle_stroke(at, RING, Stroke::new(1.5, Color32::WHITE));
            }
        }
        if response.has_focus() {
            let stroke = ui.visuals().selection.stroke;
            painter.rect_stroke(place, 3.0, stroke, egui::StrokeKind::Inside);
        }
    }
}

/// The rotation after the arrow keys of this frame.
fn keyed(ui: &Ui, response: &Response, rotation_deg: f32) -> f32 {
    hold_arrows(ui, response, true, false);
    let mut by = 0.0;
    for (modifiers, size) in [
        (Modifiers::COMMAND, SNAP_DEG),
        (Modifiers::SHIFT, 0.1),
        (Modifiers::NONE, 1.0),
    ] {
        for (key, sign) in [(Key::ArrowLeft, 1.0), (Key::ArrowRight, -1.0)] {
            by += sign * size * ui.input_mut(|input| input.count_and_consume_key(modifiers, key)) as f32;
        }
    }
    if by == 0.0 {
        rotation_deg
    } else {
        wrapped_deg(rotation_deg + by)
    }
}

/// In [−180, 180).
fn wrapped_deg(angle: f32) -> f32 {
    (angle + 180.0).rem_euclid(360.0) - 180.0
}
