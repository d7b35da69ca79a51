//! The image, and the camera that the pointer moves.
//!
//! As in Marmoset and Substance, with or without alt: left drag turns, middle drag (or ctrl and left) pans, right drag
//! and the wheel zoom, shift and left turns the light. As in Blender: shift and middle pans. A click selects the
//! material of what was clicked; with ctrl and shift it explains the pixel.

mod compare;
mod denoiser;
mod header;
mod legend;
mod light_handles;
mod loading;
mod look;
mod magnifier;
mod messages;
mod orbit;
mod outline;
mod picking;
mod precision_map;
mod reference;
mod region;
mod seen;

use std::{fmt::Debug, hash::Hash};

use egui::*;

use magnifier::Magnifier;
use orbit::Orbit;
use seen::{hit_at, pixel_at};

use super::{
    actions::Action,
    actions::Command,
    desk::Desk,
    kit::{drag::arrows, drag::wrapped_deg, icons, icons::Icon, keys::hold_arrows, theme, widgets},
    services::compare::View,
    services::viewing::Resolution,
};
use crate::{
    document::ReferencePlace,
    job::Job,
    render::shown,
    render::worker::{Picture, Scene},
};

/// Degrees of the environment's turn for a drag of one point.
const LIGHT_DEG_PER_POINT: f32 = 0.35;
/// Change of the distance's logarithm for a point of wheel or drag.
const ZOOM_PER_POINT: f64 = 0.004;
/// Points of a drag that an arrow key stands for.
const KEY_POINTS: f32 = 14.0;
/// From how many points a pixel on it has edges, points.
const PIXEL_SEEN: f32 = 2.0;
/// From the viewport's corner to what stands in it, points.
const LOADING_MARGIN: f32 = 12.0;
/// Sides of the squares behind transparent images, points.
const CHECKER: f32 = 12.0;
/// By how much less an image that fills the viewport may be stretched: what rounding to pixels makes of its shape.
const STRETCH_MAX: f32 = 0.03;
/// Largest side of an image that fills the viewport.
const SIDE_MAX_PX: u32 = 8192;

/// The viewport's own state.
#[derive(Default)]
pub struct Viewport {
    picture: ShownTexture,
    /// B's, where two are compared.
    rival: ShownTexture,
    /// How B differs from A.
    difference: ShownTexture,
    /// What of the numbers is not to be trusted.
    precision: precision_map::PrecisionView,
    /// Where the image may be, points.
    area: Option<Rect>,
    pixels_per_point: f32,
    is_software: bool,
    id: Option<Id>,
    region: region::RegionTool,
    magnifier: Magnifier,
    outline: outline::Outline,
    lights: light_handles::LightHandles,
    denoiser: denoiser::DenoiserOffer,
    /// By how much the image is to be shown larger; 0 is back to all of it.
    magnifies: Option<f32>,
}

/// A texture, and what it shows.
#[derive(Default)]
struct ShownTexture {
    texture: Option<TextureHandle>,
    /// What it stands for, and whether its pixels have edges.
    key: Option<([u64; 2], bool)>,
    shows_pixels: bool,
    /// Some of it lets through what is behind.
    is_transparent: bool,
    /// Behind it is a plate.
    over_plate: bool,
}

impl ShownTexture {
    /// Makes the texture show what the key stands for.
    fn upload(&mut self, ui: &Ui, key: [u64; 2], image: impl FnOnce() -> ColorImage) {
        let options = if self.shows_pixels {
            TextureOptions::NEAREST
        } else {
            TextureOptions::LINEAR
        };
        if self.key.replace((key, self.shows_pixels)) == Some((key, self.shows_pixels)) {
            return;
        }
        let image = image();
        self.is_transparent = image.pixels.iter().any(|pixel| pixel.a() < 255);
        match &mut self.texture {
            Some(texture) => texture.set(image, options),
            None => self.texture = Some(ui.ctx().load_texture("picture", image, options)),
        }
    }

    fn show(&self, ui: &Ui, clip: Rect, place: Rect) {
        if let Some(texture) = &self.texture {
            let painter = ui.painter_at(clip);
            let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            painter.image(texture.id(), place, whole, Color32::WHITE);
        }
    }

    /// Paints an image as far as `clip` shows it; `source` distinguishes renderers whose serials may be the same.
    fn paint(&mut self, ui: &Ui, clip: Rect, place: Rect, picture: &Picture, source: u64) {
        self.upload(ui, [source, picture.serial], || {
            let size = [picture.width as usize, picture.height as usize];
            ColorImage::from_rgba_premultiplied(size, &picture.rgba)
        });
        if self.is_transparent && !self.over_plate {
            checker(ui, clip.intersect(place));
        }
        self.show(ui, clip, place);
    }
}

impl Viewport {
    /// The widget that takes the focus; `None` before the first frame.
    pub fn id(&self) -> Option<Id> {
        self.id
    }

    /// The next drag says which part of the image is rendered.
    pub fn draw_region(&mut self) {
        self.region.arm();
    }

    /// Magnifies the image by a factor from the next frame on; 0 shows all of it.
    pub fn magnify(&mut self, by: f32) {
        self.magnifies = Some(by);
    }

    /// The size that an image that fills the viewport has; `None` before the viewport was laid out, or where the
    /// image's size is the document's.
    pub fn fill_size(&self, resolution: Resolution) -> Option<[u32; 2]> {
        let area = self.area?;
        let scale = match resolution {
            Resolution::Document => return None,
            Resolution::Native => self.pixels_per_point,
            Resolution::Half => 0.5 * self.pixels_per_point,
            Resolution::Auto if self.is_software => 1.0_f32.min(self.pixels_per_point),
            Resolution::Auto => self.pixels_per_point,
        };
        let side = |points: f32| ((points * scale).round() as u32).clamp(16, SIDE_MAX_PX);
        Some([side(area.width()), side(area.height())])
    }

    pub fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        let whole = ui.max_rect();
        let surround = theme::surround(ui.visuals().dark_mode);
        ui.painter().rect_filled(whole, 0.0, surround);
        let bar = Rect::from_min_size(whole.min, vec2(whole.width(), theme::BAR_HEIGHT));
        let is_compared = desk.shared.compare.is_on;
        let below = if is_compared { compare::BAR_HEIGHT } else { 0.0 };
        let compare_bar = Rect::from_min_size(bar.left_bottom(), vec2(whole.width(), below));
        let (area, beside) = reference::split(Rect::from_min_max(compare_bar.left_bottom(), whole.max), desk);
        if let Some(beside) = beside {
            reference::beside(ui, beside, desk);
        }
        self.area = Some(if is_compared {
            compare::area_of_a(area, desk.shared.compare.view)
        } else {
            area
        });
        self.pixels_per_point = ui.ctx().pixels_per_point();
        self.is_software = desk.snapshot.engine.as_ref().is_none_or(|engine| engine.is_software);
        header::show(ui, bar, desk);
        if is_compared {
            compare::bar(ui, compare_bar, desk);
        }

        let response = ui.interact(area, ui.scope_id().with("viewport"), Sense::click_and_drag());
        self.id = Some(response.id);
        widgets::describe(&response, Role::Canvas, "Viewport");
        let picture = desk.snapshot.picture.clone();
        if let Some(picture) = &picture {
            let place = if is_compared {
                self.compared(ui, area, picture, desk)
            } else {
                let place = self.magnified(ui, &response, area, picture, desk.shared.viewing.resolution);
                self.picture.over_plate = reference::within(ui, area, place, ReferencePlace::Under, desk);
                self.picture.paint(ui, area.intersect(place), place, picture, 0);
                reference::within(ui, area, place, ReferencePlace::Over, desk);
                if let Some(scene) = &desk.snapshot.scene
                    && desk.shared.viewing.shown == shown::Shown::Precision
                {
                    self.precision.show(ui, area, place, &scene.job);
                }
                place
            };
            if is_compared && desk.shared.compare.view == View::Wipe {
                Self::divider(ui, place, desk);
            }
            if desk.shared.viewing.shows_safe_frames && !is_compared {
                safe_frames(&ui.painter().with_clip_rect(area), place);
            }
            if let Some((shown, scale)) = picture.map {
                legend::show(ui, area, shown, scale);
            }
            // Where two are compared, both are shown whole.
            let is_drawing = !is_compared && self.region.show(ui, &response, place, desk);
            if let Some(scene) = desk.snapshot.scene.clone() {
                if !is_compared {
                    picking::hover(ui, &response, place, &scene, desk);
                    self.outline.show(ui, area, place, &scene.job, desk);
                }
                if !is_drawing && !is_compared {
                    self.lights.show(ui, area, place, &scene.job, desk);
                }
                if !is_drawing {
                    self.navigate(ui, &response, place, &scene, desk);
                }
                if desk.shared.look.was_shown {
                    look::follow(ui, &response, area, place, &scene, picture, desk);
                }
            }
            if !is_compared {
                self.whole_picture(ui, area, place, picture);
            }
        } else {
            waiting(ui, area, desk);
        }
        if response.has_focus() {
            widgets::frame(ui, area);
        }
        if let Some(picture) = &picture {
            loading::show(ui, area, picture, desk);
        }
        messages::open_model(ui, area, desk);
        self.denoiser.show(ui, area, desk);
        messages::show(ui, area, desk);
        drop_hint(ui, area);
    }

    /// Where the image is, after what the user does to magnify it.
    fn magnified(
        &mut self,
        ui: &Ui,
        response: &Response,
        area: Rect,
        picture: &Picture,
        resolution: Resolution,
    ) -> Rect {
        let fitted = placed(area, picture, resolution);
        let (modifiers, wheel) = ui.input(|input| (input.modifiers, input.zoom_delta()));
        let pointer = response.hover_pos();
        let by_wheel = pointer.and((modifiers.command && wheel != 1.0).then_some(wheel));
        for by in self.magnifies.take().into_iter().chain(by_wheel) {
            let at = pointer.unwrap_or(area.center());
            self.magnifier.zoom(by, at, area, fitted, picture.width);
        }
        if pans(response, modifiers) && self.magnifier.is_on() {
            self.magnifier.pan(response.drag_delta(), fitted);
        }
        let place = self.magnifier.place(area, fitted);
        self.picture.shows_pixels = self.magnifier.is_on() && place.width() >= PIXEL_SEEN * picture.width as f32;
        place
    }

    /// How much the image is magnified, and a way back.
    fn whole_picture(&mut self, ui: &mut Ui, area: Rect, place: Rect, picture: &Picture) {
        if !self.magnifier.is_on() {
            return;
        }
        let percent = 100.0 * place.width() * self.pixels_per_point / picture.width.max(1) as f32;
        let size = vec2(64.0, theme::ROW_HEIGHT);
        let corner = area.max - size - Vec2::splat(LOADING_MARGIN);
        let mut inside = over(ui, "whole image", Rect::from_min_size(corner, size));
        let button = Button::new(format!("{percent:.0} %")).min_size(size);
        let button = inside.add(button).on_hover_text("Shows the whole image again (0)");
        if button.clicked() {
            self.magnify(0.0);
        }
        button.accessible_name("Show the whole image");
    }

    fn navigate(&self, ui: &mut Ui, response: &Response, place: Rect, scene: &Scene, desk: &mut Desk) {
        let modifiers = ui.input(|input| input.modifiers);
        let before = Orbit::new(&desk.document.camera, &scene.job);
        let mut orbit = before;
        let moved = response.drag_delta();
        let points = [f64::from(moved.x), f64::from(moved.y)];
        let pans = pans(response, modifiers);
        // What is magnified is moved itself, see `magnified`.
        if moved != Vec2::ZERO && !(pans && self.magnifier.is_on()) {
            let height = f64::from(place.height().max(1.0));
            if pans {
                orbit.pan(points.map(|p| p / height));
            } else if response.dragged_by(PointerButton::Primary) && modifiers.shift {
                let rotation_deg = &mut desk.document.lighting.rotation_deg;
                *rotation_deg = wrapped_deg(*rotation_deg + LIGHT_DEG_PER_POINT * moved.x);
                desk.edits.note("Turn the light", "Environment rotation");
            } else if response.dragged_by(PointerButton::Primary) {
                orbit.turn(points);
            } else if response.dragged_by(PointerButton::Secondary) {
                orbit.zoom((ZOOM_PER_POINT * (points[1] - points[0])).exp());
            }
        }
        // With ctrl the wheel magnifies.
        if response.hovered() && !modifiers.command {
            let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            orbit.zoom((-ZOOM_PER_POINT * f64::from(scroll)).exp() / f64::from(pinch));
        }
        let is_dropped_on = ui.input(|input| !input.raw.dropped_files.is_empty());
        let under_pointer = response.hover_pos().filter(|_| is_dropped_on);
        if let Some(slot) = under_pointer.and_then(|at| hit_at(pixel_at(at, place, scene)?, scene)?.slot) {
            desk.actions.push(Action::SelectSlot(slot));
        }
        if response.has_focus() {
            hold_arrows(ui, response, true, true);
            // Arrows turn, with ctrl they pan; page up and down zoom.
            let points = |modifiers| {
                let Vec2 { x, y } = KEY_POINTS * arrows(ui, modifiers);
                [f64::from(x), f64::from(-y)]
            };
            orbit.turn(points(Modifiers::NONE));
            orbit.pan(points(Modifiers::COMMAND).map(|p| 0.002 * p));
            for (key, factor) in [(Key::PageUp, 0.9), (Key::PageDown, 1.0 / 0.9)] {
                if ui.input_mut(|input| input.consume_key(Modifiers::NONE, key)) {
                    orbit.zoom(factor);
                }
            }
        }
        if let Some((label, key)) = orbit.write(&before, &mut desk.document.camera) {
            desk.edits.note(label, key);
        }
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            response.request_focus();
            self.clicked(ui, at, place, scene, desk);
        }
    }

    /// A click says what is sharp, where that was asked for or ctrl is held, or has the pixel explained, where shift is
    /// held, too; otherwise it selects a slot, and the plots take the angle of the place.
    fn clicked(&self, ui: &Ui, at: Pos2, place: Rect, scene: &Scene, desk: &mut Desk) {
        let Some(pixel) = pixel_at(at, place, scene) else {
            return;
        };
        let modifiers = ui.input(|input| input.modifiers);
        if modifiers.command && modifiers.shift {
            let last = desk.snapshot.progress.samples_per_pixel.saturating_sub(1);
            let pixel = pixel.map(|share| share as u32);
            desk.actions.push(Action::Explain(pixel, last));
            return;
        }
        let Some(hit) = hit_at(pixel, scene) else { return };
        if picking::is_picked(&hit, modifiers.command, desk) {
            return;
        }
        picking::choose(&hit, modifiers.shift, desk);
    }
}

/// Whether a drag moves what is seen along the image's plane.
fn pans(response: &Response, modifiers: Modifiers) -> bool {
    response.dragged_by(PointerButton::Middle) || (response.dragged_by(PointerButton::Primary) && modifiers.command)
}

/// A part of the viewport over the image, under an identity that stays while others come and go.
fn over(ui: &mut Ui, name: impl Hash + Debug, place: Rect) -> Ui {
    laid_over(ui, name, place, Layout::left_to_right(Align::Center))
}

/// The same, laid out in another way.
fn laid_over(ui: &mut Ui, name: impl Hash + Debug, place: Rect, layout: Layout) -> Ui {
    let builder = UiBuilder::new().scope_id(Id::unique(name)).max_rect(place);
    ui.new_child(builder.layout(layout))
}

/// A text on a ground from which it can be distinguished.
fn plate(painter: &Painter, corner: Align2, at: Pos2, text: &str, [ground, color]: [Color32; 2]) {
    let font = FontId::proportional(13.0);
    let galley = painter.layout_no_wrap(text.to_owned(), font, color);
    let rect = corner.anchor_size(at, galley.size() + vec2(14.0, 6.0));
    painter.rect_filled(rect, 3.0, ground);
    painter.galley(rect.min + vec2(7.0, 3.0), galley, color);
}

/// Where the image is shown: over the whole area, or with its own shape in the middle of it, as large as fits. A
/// image that was kept while the area got another shape keeps its own, too.
fn placed(area: Rect, picture: &Picture, resolution: Resolution) -> Rect {
    let size = vec2(picture.width as f32, picture.height as f32);
    let stretch = size.x / size.y.max(1.0) * area.height() / area.width().max(1.0);
    if resolution != Resolution::Document && (stretch - 1.0).abs() < STRETCH_MAX {
        return area;
    }
    fitted(area, size)
}

/// The middle of an area, in a shape of its own.
fn fitted(area: Rect, size: Vec2) -> Rect {
    let scale = (area.width() / size.x).min(area.height() / size.y);
    Rect::from_center_size(area.center(), size * scale)
}

/// Squares that show through where the image is transparent.
fn checker(ui: &Ui, place: Rect) {
    let painter = ui.painter_at(place);
    let [light, dark] = if ui.visuals().dark_mode { [70, 54] } else { [206, 182] };
    painter.rect_filled(place, 0.0, Color32::from_gray(dark));
    let [columns, rows] = [place.width(), place.height()].map(|side| (side / CHECKER).ceil() as u32);
    for row in 0..rows {
        for column in (row % 2..columns).step_by(2) {
            let min = place.min + CHECKER * vec2(column as f32, row as f32);
            let square = Rect::from_min_size(min, Vec2::splat(CHECKER));
            painter.rect_filled(square, 0.0, Color32::from_gray(light));
        }
    }
}

/// What is going on before there is an image.
fn waiting(ui: &mut Ui, area: Rect, desk: &Desk) {
    let center = area.center();
    let spinner = Rect::from_center_size(center - vec2(0.0, 16.0), Vec2::splat(24.0));
    Spinner::new().paint_at(ui, spinner);
    let font = TextStyle::Body.resolve(ui.style());
    let text = desk.snapshot.activity.to_string();
    let color = ui.visuals().text_color();
    ui.painter()
        .text(center + vec2(0.0, 16.0), Align2::CENTER_CENTER, text, font, color);
}

/// What every screen shows of the image at `place`: actions, and within them titles (EBU R 95).
fn safe_frames(painter: &Painter, place: Rect) {
    for share in [0.93, 0.9] {
        let frame = Rect::from_center_size(place.center(), share * place.size());
        // Seen before light and dark.
        for (width, color) in [
            (3.0, Color32::from_black_alpha(80)),
            (1.0, Color32::from_white_alpha(160)),
        ] {
            painter.rect_stroke(frame, 0.0, Stroke::new(width, color), StrokeKind::Middle);
        }
    }
}

fn drop_hint(ui: &Ui, area: Rect) {
    if ui.input(|input| input.raw.hovered_files.is_empty()) {
        return;
    }
    let accent = theme::accent(ui);
    ui.painter().rect_filled(area, 0.0, Color32::from_black_alpha(140));
    let frame = Stroke::new(2.0, accent);
    ui.painter()
        .rect_stroke(area.shrink(6.0), 4.0, frame, StrokeKind::Inside);
    let font = TextStyle::Heading.resolve(ui.style());
    let text = "Drop to open: model, environment, material, project or texture";
    ui.painter()
        .text(area.center(), Align2::CENTER_CENTER, text, font, Color32::WHITE);
}
