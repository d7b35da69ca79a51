//! The environment as it lies around the model: it turns with its rotation, and is dragged to turn it.

use super::*;
use crate::{
    kit::drag::{Drag, LARGE_STEP, steps, wrapped_deg},
    render::worker::Scene,
    scene::environment::brightened,
    services::shelves::environment_key,
};

/// Radius of the ring around the brightest place, points.
const RING: f32 = 7.0;

/// The image as it is shown, and what is done to it.
#[derive(Default)]
pub struct Preview {
    texture: Option<TextureHandle>,
    /// The environment and the strength that the texture shows.
    key: Option<(EnvironmentSource, f32, usize)>,
    held: Option<Drag<f32>>,
}

impl Preview {
    /// The environment in use, as large as the panel lets it be.
    pub fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        let Some(scene) = desk.snapshot.scene.clone() else {
            return;
        };
        let width = ui.available_width();
        let (place, response) = ui.allocate_exact_size(vec2(width, 0.5 * width), Sense::click_and_drag());
        let rotation_deg = desk.document.lighting.rotation_deg;
        response.widget_info(|| WidgetInfo::slider(true, rotation_deg.into(), "Environment preview"));
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

    fn react(&mut self, ui: &Ui, response: &Response, desk: &mut Desk) {
        let before = desk.document.lighting.rotation_deg;
        if response.clicked() {
            response.request_focus();
        }
        let (mut rotation_deg, seals) = Drag::follow(&mut self.held, ui, response, before, |start_deg, pull| {
            let turned = start_deg - 360.0 * (pull.to.x - pull.from.x) / response.rect.width();
            wrapped_deg(match pull.snaps {
                true => (turned / LARGE_STEP).round() * LARGE_STEP,
                false => turned,
            })
        });
        if seals {
            desk.edits.history.seal();
        }
        let by = steps(ui, response, false).x;
        if by != 0.0 {
            rotation_deg = wrapped_deg(rotation_deg - by);
        }
        if rotation_deg != before {
            desk.document.lighting.rotation_deg = rotation_deg;
            desk.edits.note("Turn the environment", "Environment rotation");
        }
    }

    /// The thumbnail under the strength that the document has.
    fn upload(&mut self, ui: &Ui, scene: &Scene, desk: &Desk) {
        let lighting = &desk.document.lighting;
        let source = &scene.document.lighting.environment;
        let Some(picture) = desk.shared.pictures.image(&environment_key(source)) else {
            return;
        };
        let key = (source.clone(), lighting.strength, Arc::as_ptr(picture) as usize);
        if self.key.as_ref() == Some(&key) {
            return;
        }
        let size = [picture.width() as usize, picture.height() as usize];
        let shown = brightened(picture, lighting.strength);
        let image = ColorImage::from_rgba_unmultiplied(size, &shown);
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
        if let (Some(texture), Some((of, ..))) = (&self.texture, &self.key)
            && *of == scene.document.lighting.environment
        {
            // The map's left edge lies at the shift, and goes on at the left of the image.
            for turns in [-1.0, 0.0] {
                let at = place.translate(vec2((shift + turns) * place.width(), 0.0));
                let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                painter.image(texture.id(), at, whole, Color32::WHITE);
            }
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
            painter.rect_stroke(place, 3.0, stroke, StrokeKind::Inside);
        }
    }
}
