//! Handles of area lights: where they are in the image, and what pulling one makes of the light.

use glam::{DVec2, DVec3};

use super::motion::{Pull, View, move_along, move_in_plane, put_at, vector};
use crate::document::{AreaLight, range};
use crate::named::named;

/// Degrees to which angles snap.
const SNAP_DEG: f64 = 15.0;
/// Bounding radii to which lengths snap.
const SNAP_LENGTH: f64 = 0.1;
/// Points over which a distance or a cone's angle changes by a factor of e.
const POINTS_PER_E: f64 = 120.0;
/// Least distance between the middles of two handles, points.
const APART: f64 = 20.0;
/// A step along an axis that says where its handle is, in distances of the light from its target; and how far that is at
/// least in the image for it to have one, points.
const AXIS_STEP: f64 = 0.1;
const AXIS_SEEN: f64 = 3.0;
/// From the light's middle to handles that stand for no place, points.
const ARM: f64 = 46.0;

named! {
    /// A part of a light that can be taken hold of.
    LightHandle {
        Direction, "direction", "Move", "Moves the light around its target, or away from it where it is pulled farther; with ctrl in steps of 15°, with shift finely.";
        Width, "width", "Width", "Makes the light wider or narrower; the sun larger.";
        Height, "height", "Height", "Makes the light higher or lower.";
        Distance, "distance", "Distance", "Moves the light to its target or away from it.";
        Turn, "turn", "Turn", "Turns the light about the line to its target.";
        Cone, "cone", "Cone", "Opens or closes the cone of a spot.";
        InPlane, "in the plane", "In the plane", "Moves the light in the plane of the image. It goes on looking at its target.";
        AlongX, "along x", "Along x", "Moves the light along x, to the right of the model. It goes on looking at its target.";
        AlongY, "along y", "Along y", "Moves the light up or down. It goes on looking at its target.";
        AlongZ, "along z", "Along z", "Moves the light along z, before the model. It goes on looking at its target.";
    }
}

impl LightHandle {
    /// The axis along which it moves the light, if it does.
    pub fn axis(self) -> Option<DVec3> {
        match self {
            Self::AlongX => Some(DVec3::X),
            Self::AlongY => Some(DVec3::Y),
            Self::AlongZ => Some(DVec3::Z),
            _ => None,
        }
    }

    /// What it is called of a light.
    pub fn full_name(self, light: &str) -> String {
        match self {
            Self::Direction => format!("Move {light}"),
            Self::InPlane | Self::AlongX | Self::AlongY | Self::AlongZ => format!("Move {light} {}", self.name()),
            _ => format!("{} handle of {light}", self.label()),
        }
    }
}

/// The handles of a light and where they are: one alone, at the image's edge, where the light is not in the image.
pub fn handles(light: &AreaLight, view: &View, margin: f64) -> Vec<(LightHandle, DVec2)> {
    let shape = light.shape();
    let frame = shape.frame();
    let Some(middle) = view.seen_inside(frame.middle) else {
        return vec![(LightHandle::Direction, view.edge_towards(frame.middle, margin))];
    };
    let towards = |place: DVec3, otherwise: DVec2| {
        let arm = view.seen(place).unwrap_or(middle) - middle;
        (arm.try_normalize().unwrap_or(otherwise), arm.length())
    };
    let (across, half_width) = towards(frame.middle + 0.5 * shape.width * frame.across, DVec2::X);
    let (up, half_height) = towards(frame.middle + 0.5 * shape.height * frame.up, DVec2::NEG_Y);
    let (ahead, _) = towards(shape.target.into(), DVec2::Y);
    let mut placed = vec![(LightHandle::Direction, middle)];
    let mut put = |handle, along: DVec2, length: f64| {
        let mut length = length.max(APART);
        while placed
            .iter()
            .any(|(_, at)| at.distance(middle + length * along) < APART)
        {
            length += 0.25 * APART;
        }
        placed.push((handle, middle + length * along));
    };
    put(LightHandle::Width, across, half_width);
    if !light.is_sun() {
        if !light.is_sphere() {
            put(LightHandle::Height, up, half_height);
        }
        put(LightHandle::Distance, ahead, ARM);
        put(LightHandle::Turn, -up, half_height.max(APART) + APART);
    }
    if light.is_spot() {
        put(LightHandle::Cone, ahead.perp(), ARM);
    }
    if !light.is_sun() {
        for handle in [LightHandle::AlongX, LightHandle::AlongY, LightHandle::AlongZ] {
            let axis = handle.axis().unwrap_or_default();
            let (along, length) = towards(frame.middle + AXIS_STEP * shape.distance * axis, DVec2::ZERO);
            // Towards the viewer there is nothing to be pulled.
            if length > AXIS_SEEN {
                put(handle, along, ARM);
            }
        }
        put(LightHandle::InPlane, DVec2::ONE.normalize(), APART);
    }
    placed
}

/// The light after a pull of a handle that began when it was as given.
pub fn pulled(light: &AreaLight, handle: LightHandle, view: &View, pull: &Pull) -> AreaLight {
    let mut moved = *light;
    let middle = view.seen_inside(light.shape().frame().middle);
    let at = handles(light, view, 0.0).into_iter().find(|(of, _)| *of == handle);
    let arm = match (middle, at) {
        (Some(middle), Some((_, at))) => at - middle,
        _ => DVec2::ZERO,
    };
    let by = pull.to - pull.from;
    let along = by.dot(arm.normalize_or_zero());
    // How far the handle was pulled, in lengths of its arm.
    let factor = (1.0 + along / arm.length().max(1.0)).max(0.01);
    let length = |length: f64| {
        let (least, most) = range::AREA_LENGTH.into_inner();
        snapped(length, SNAP_LENGTH, pull.snaps).clamp(least, most)
    };
    match handle {
        LightHandle::Direction => move_around(&mut moved, view, middle, pull),
        LightHandle::InPlane => move_in_plane(&mut moved, view, pull),
        LightHandle::AlongX | LightHandle::AlongY | LightHandle::AlongZ => {
            move_along(&mut moved, handle.axis().unwrap_or_default(), view, pull);
        }
        LightHandle::Width if light.is_sun() => {
            let (least, most) = range::SUN_ANGLE_DEG.into_inner();
            moved.angle_deg = snapped(light.angle_deg * factor, SNAP_LENGTH, pull.snaps).clamp(least, most);
        }
        LightHandle::Width => moved.width = length(light.width * factor),
        LightHandle::Height => moved.height = length(light.height * factor),
        LightHandle::Distance => moved.distance = length(light.distance * (-along / POINTS_PER_E).exp()),
        LightHandle::Turn => {
            let Some(middle) = middle else { return moved };
            let angle_deg = (pull.from - middle).angle_to(pull.to - middle).to_degrees();
            let sign = if faces_viewer(light, view) { 1.0 } else { -1.0 };
            moved.turn_deg = wrapped_deg(snapped(light.turn_deg + sign * angle_deg, SNAP_DEG, pull.snaps));
        }
        LightHandle::Cone => {
            let (least, most) = range::CONE_DEG.into_inner();
            let cone_deg = light.cone_deg * (along / POINTS_PER_E).exp();
            moved.cone_deg = snapped(cone_deg, 0.1 * SNAP_DEG, pull.snaps).clamp(least, most);
        }
    }
    moved
}

/// The light after steps of the arrow keys, to the right and upwards, on a handle: degrees, or hundredths of a length.
pub fn nudged(light: &AreaLight, handle: LightHandle, steps: DVec2) -> AreaLight {
    let mut moved = *light;
    let sum = steps.x + steps.y;
    let scaled = |value: f64, range: std::ops::RangeInclusive<f64>| {
        let (least, most) = range.into_inner();
        (value * 1.01_f64.powf(sum)).clamp(least, most)
    };
    match handle {
        LightHandle::Direction => {
            moved.yaw_deg = wrapped_deg(light.yaw_deg + steps.x);
            moved.pitch_deg = (light.pitch_deg + steps.y).clamp(-90.0, 90.0);
        }
        LightHandle::Width if light.is_sun() => moved.angle_deg = scaled(light.angle_deg, range::SUN_ANGLE_DEG),
        LightHandle::Width => moved.width = scaled(light.width, range::AREA_LENGTH),
        LightHandle::Height => moved.height = scaled(light.height, range::AREA_LENGTH),
        LightHandle::Distance => moved.distance = scaled(light.distance, range::AREA_LENGTH),
        LightHandle::Turn => moved.turn_deg = wrapped_deg(light.turn_deg + sum),
        LightHandle::Cone => moved.cone_deg = scaled(light.cone_deg, range::CONE_DEG),
        LightHandle::InPlane => put_at(&mut moved, light.shape().frame().middle + 0.01 * steps.extend(0.0)),
        LightHandle::AlongX | LightHandle::AlongY | LightHandle::AlongZ => {
            let axis = handle.axis().unwrap_or_default();
            put_at(&mut moved, light.shape().frame().middle + 0.01 * sum * axis);
        }
    }
    moved
}

/// Moves a light so that it is under the pointer: over the sphere around its target, on the side that it was on, or where
/// the pointer is beside that sphere, farther away from the target. One that was not in the image comes into it.
fn move_around(light: &mut AreaLight, view: &View, middle: Option<DVec2>, pull: &Pull) {
    let shape = light.shape();
    let (frame, distance) = (shape.frame(), shape.distance);
    let target = frame.middle - distance * frame.outwards;
    // Along the ray through a point: where the target is beside it, and how far from there the sphere is.
    let nearest = |at: DVec2| {
        let [origin, along] = view.ray(at);
        let half = (target - origin).dot(along);
        (
            origin,
            along,
            half,
            half * half - (origin - target).length_squared() + distance * distance,
        )
    };
    let is_far = match middle {
        Some(middle) => {
            let (origin, _, half, _) = nearest(middle);
            frame.middle.distance(origin) > half
        }
        None => frame.outwards.dot(vector(view.camera.forward.to_f64())) > 0.0,
    };
    let (origin, along, half, below_root) = nearest(middle.unwrap_or(pull.from) + pull.to - pull.from);
    let root = below_root.max(0.0).sqrt();
    let hits_sphere = below_root >= 0.0;
    let (t, is_on_sphere) = match half - root {
        near if near > 0.0 && !is_far => (near, hits_sphere),
        // It was behind the camera: it stays on the viewer's side of the target.
        _ if !is_far && half > 0.0 && !light.is_sun() => (0.5 * half, false),
        _ => (half + root, hits_sphere),
    };
    // With the target behind the camera nothing that is seen is nearest to it.
    let (t, is_on_sphere) = if t > 0.0 { (t, is_on_sphere) } else { (distance, false) };
    let away = origin + t * along - target;
    light.look_from(away.normalize_or(frame.outwards));
    // On the sphere the distance is what it was, to the last digit.
    if !light.is_sun() && !is_on_sphere {
        let (least, most) = range::AREA_LENGTH.into_inner();
        light.distance = away.length().clamp(least, most);
    }
    light.yaw_deg = snapped(light.yaw_deg, SNAP_DEG, pull.snaps);
    light.pitch_deg = snapped(light.pitch_deg, SNAP_DEG, pull.snaps);
}

/// Whether the viewer sees the side of a light that looks at its target.
fn faces_viewer(light: &AreaLight, view: &View) -> bool {
    let frame = light.shape().frame();
    (vector(view.camera.origin.to_f64()) - frame.middle).dot(frame.outwards) < 0.0
}

fn snapped(value: f64, step: f64, snaps: bool) -> f64 {
    if snaps { (value / step).round() * step } else { value }
}

/// In [−180, 180).
fn wrapped_deg(angle: f64) -> f64 {
    (angle + 180.0).rem_euclid(360.0) - 180.0
}
