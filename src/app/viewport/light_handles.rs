//! Area lights in the viewport: a mark for each, and handles of the chosen one that are dragged or moved by keys.

use glam::{DVec2, DVec3};

use super::*;
use crate::{
    document::AreaLight,
    kit::drag::{Drag, steps},
    kit::widgets::shown,
    lights::{LightHandle, Pull, View, handles, nudged, pulled},
    scene::Outline,
};

/// Radius of a light's mark, points.
const MARK: f32 = 7.0;
/// From the image's edge to the marks of lights beyond it, points.
const MARGIN: f64 = 14.0;
/// Points of a line around a disc or a cone.
const AROUND: u32 = 48;

/// The handle that is being dragged.
#[derive(Default)]
pub struct LightHandles {
    held: Option<Drag<AreaLight>>,
}

impl LightHandles {
    /// Shows the lights over the image at `place` while their list is shown, and lets them be moved.
    pub fn show(&mut self, ui: &mut Ui, area: Rect, place: Rect, job: &Job, desk: &mut Desk) {
        if !desk.shared.selection.showed_lights {
            self.held = None;
            return;
        }
        let view = View {
            camera: job.settings.camera,
            size: DVec2::new(place.width().into(), place.height().into()),
        };
        let clip = area.intersect(place);
        for index in 0..desk.document.lighting.area_lights.len() {
            let light = desk.document.lighting.area_lights[index];
            let is_chosen = desk.shared.selection.light == Some(index);
            if is_chosen {
                outline(&ui.painter_at(clip), &view, place, &light);
            }
            let is_outside = view.seen_inside(light.shape().frame().middle).is_none();
            let mut placed = handles(&light, &view, MARGIN);
            let on_screen = |at: DVec2| place.min + vec2(at.x as f32, at.y as f32);
            if is_chosen {
                axes(&ui.painter_at(clip), &placed, on_screen);
            }
            // The light's own mark last, over its other handles.
            placed.reverse();
            for (handle, at) in placed {
                let at = on_screen(at);
                let is_mark = handle == LightHandle::Direction;
                if (is_mark || is_chosen) && clip.expand(1.0).contains(at) {
                    let response = interact(ui, clip, index, handle, at);
                    let painter = ui.painter_at(clip);
                    if is_outside {
                        arrow(&painter, at, (at - place.center()).normalized());
                    }
                    draw(&painter, ui, handle, at, &light, is_chosen, &response);
                    self.react(ui, &response, (index, handle), &view, place, desk);
                }
            }
        }
    }

    fn react(
        &mut self,
        ui: &Ui,
        response: &Response,
        (index, handle): (usize, LightHandle),
        view: &View,
        place: Rect,
        desk: &mut Desk,
    ) {
        let light = desk.document.lighting.area_lights[index];
        if response.clicked() {
            response.request_focus();
        }
        if response.clicked() || response.drag_started_by(PointerButton::Primary) {
            desk.shared.selection.light = Some(index);
        }
        let in_picture = |at: Pos2| {
            let at = at - place.min;
            DVec2::new(at.x.into(), at.y.into())
        };
        let (mut moved, seals) = Drag::follow(&mut self.held, ui, response, light, |start, drag| {
            let pull = Pull {
                from: in_picture(drag.from),
                to: in_picture(drag.to),
                snaps: drag.snaps,
            };
            pulled(start, handle, view, &pull)
        });
        if seals {
            desk.edits.history.seal();
        }
        let by = steps(ui, response, true);
        if by != Vec2::ZERO {
            moved = nudged(&moved, handle, DVec2::new(by.x.into(), by.y.into()));
        }
        if moved != light {
            desk.document.lighting.area_lights[index] = moved;
            let key = format!("{} of area light {}", handle.name(), index + 1);
            desk.edits.note(format!("{} area light", handle.label()), key);
        }
    }
}

fn interact(ui: &Ui, clip: Rect, index: usize, handle: LightHandle, at: Pos2) -> Response {
    let rect = Rect::from_center_size(at, Vec2::splat(20.0)).intersect(clip);
    let id = Id::unique(("light handle", index, handle.name()));
    let name = handle.full_name(&format!("area light {}", index + 1));
    let response = ui.interact(rect, id, Sense::click_and_drag());
    widgets::describe(&response, Role::Button, &name);
    let cursor = match response.dragged() {
        true => CursorIcon::Grabbing,
        false => CursorIcon::Grab,
    };
    response.on_hover_cursor(cursor).on_hover_text(handle.help())
}

/// Light and dark, so that it is seen against everything.
fn line(painter: &Painter, points: Vec<Pos2>, color: Color32) {
    let shadow = Stroke::new(3.0, Color32::from_black_alpha(110));
    painter.add(Shape::line(points.clone(), shadow));
    painter.add(Shape::line(points, Stroke::new(1.2, color)));
}

/// Points outwards beside the mark of a light that is not in the image.
fn arrow(painter: &Painter, at: Pos2, outwards: Vec2) {
    let tip = at + (MARK + 7.0) * outwards;
    let foot = at + (MARK + 1.0) * outwards;
    let half = 4.5 * outwards.rot90();
    let shadow = Stroke::new(2.0, Color32::from_black_alpha(130));
    let corners = vec![tip, foot + half, foot - half];
    painter.add(Shape::convex_polygon(corners, Color32::WHITE, shadow));
}

/// The colour of an axis, as most programs have it.
fn axis_color(handle: LightHandle) -> Option<Color32> {
    match handle {
        LightHandle::AlongX => Some(Color32::from_rgb(230, 80, 70)),
        LightHandle::AlongY => Some(Color32::from_rgb(110, 190, 60)),
        LightHandle::AlongZ => Some(Color32::from_rgb(80, 140, 240)),
        _ => None,
    }
}

/// Lines from the light to the handles of its axes.
fn axes(painter: &Painter, placed: &[(LightHandle, DVec2)], on_screen: impl Fn(DVec2) -> Pos2) {
    let mark = placed.iter().find(|(handle, _)| *handle == LightHandle::Direction);
    for (handle, at) in placed {
        if let (Some((_, from)), Some(color)) = (mark, axis_color(*handle)) {
            line(painter, vec![on_screen(*from), on_screen(*at)], color);
        }
    }
}

/// The rim of the chosen light, the line to its target, and where a spot's cone ends there.
fn outline(painter: &Painter, view: &View, place: Rect, light: &AreaLight) {
    let shape = light.shape();
    let frame = shape.frame();
    let color = Color32::from_white_alpha(220);
    let seen = |at: DVec3| {
        view.seen(at)
            .map(|at| place.min + vec2(at.x as f32, at.y as f32))
            .filter(|at| at.x.abs() < 1e5 && at.y.abs() < 1e5)
    };
    let closed = |places: Vec<DVec3>| {
        let points: Option<Vec<Pos2>> = places.iter().chain(places.first()).map(|at| seen(*at)).collect();
        if let Some(points) = points {
            line(painter, points, color);
        }
    };
    let at = |u: f64, v: f64| frame.middle + 0.5 * (u * shape.width * frame.across + v * shape.height * frame.up);
    let turn = |step: u32| std::f64::consts::TAU * f64::from(step) / f64::from(AROUND);
    closed(match shape.outline {
        Outline::Rectangle => vec![at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)],
        Outline::Triangle => vec![at(-1.0, -1.0), at(1.0, -1.0), at(0.0, 1.0)],
        Outline::Ellipse | Outline::Sphere => (0..AROUND).map(|step| at(turn(step).cos(), turn(step).sin())).collect(),
    });
    let target = DVec3::from_array(shape.target);
    if let (Some(middle), Some(target)) = (seen(frame.middle), seen(target))
        && !light.is_sun()
    {
        painter.extend(Shape::dashed_line(&[middle, target], Stroke::new(1.0, color), 4.0, 4.0));
    }
    // A wider cone ends too far out to be seen.
    if light.is_spot() && light.cone_deg < 120.0 {
        let radius = shape.distance * (0.5 * light.cone_deg).to_radians().tan();
        let rim = |step: u32| target + radius * (turn(step).cos() * frame.across + turn(step).sin() * frame.up);
        closed((0..AROUND).map(rim).collect());
    }
}

fn draw(
    painter: &Painter,
    ui: &Ui,
    handle: LightHandle,
    at: Pos2,
    light: &AreaLight,
    is_chosen: bool,
    response: &Response,
) {
    let accent = theme::accent(ui);
    let is_lit = response.hovered() || response.dragged() || response.has_focus();
    let rim = if is_lit { accent } else { Color32::WHITE };
    let shadow = Stroke::new(3.5, Color32::from_black_alpha(130));
    let stroke = Stroke::new(1.5, rim);
    match handle {
        LightHandle::Direction => {
            let fill = match light.is_muted {
                true => Color32::from_black_alpha(120),
                false => shown(light.color),
            };
            painter.circle(at, MARK, fill, shadow);
            painter.circle_stroke(at, MARK, stroke);
            for ray in (0..8).filter(|_| !light.is_muted) {
                let along = Vec2::angled(std::f32::consts::FRAC_PI_4 * ray as f32);
                painter.line_segment([at + (MARK + 2.0) * along, at + (MARK + 4.5) * along], stroke);
            }
            if is_chosen {
                painter.circle_stroke(at, MARK + 6.5, Stroke::new(1.5, accent));
            }
        }
        LightHandle::Width | LightHandle::Height | LightHandle::InPlane => {
            let (side, grey) = match handle {
                LightHandle::InPlane => (9.0, 90),
                _ => (8.0, 40),
            };
            let square = Rect::from_center_size(at, Vec2::splat(side));
            painter.rect(square, 1.0, Color32::from_gray(grey), shadow, StrokeKind::Middle);
            painter.rect_stroke(square, 1.0, stroke, StrokeKind::Middle);
        }
        LightHandle::AlongX | LightHandle::AlongY | LightHandle::AlongZ => {
            let color = axis_color(handle).filter(|_| !is_lit).unwrap_or(rim);
            painter.circle(at, 5.0, color, shadow);
        }
        LightHandle::Turn => {
            painter.circle_stroke(at, 5.0, shadow);
            painter.circle_stroke(at, 5.0, stroke);
            painter.circle_filled(at, 1.5, rim);
        }
        LightHandle::Distance | LightHandle::Cone => {
            let tips: &[[f32; 2]] = match handle {
                LightHandle::Distance => &[[0.0, -5.5], [5.5, 0.0], [0.0, 5.5], [-5.5, 0.0]],
                _ => &[[0.0, -5.5], [5.5, 5.5], [-5.5, 5.5]],
            };
            let tips: Vec<Pos2> = tips.iter().map(|tip| at + Vec2::from(*tip)).collect();
            painter.add(Shape::convex_polygon(tips.clone(), Color32::from_gray(40), shadow));
            painter.add(Shape::closed_line(tips, stroke));
        }
    }
}
