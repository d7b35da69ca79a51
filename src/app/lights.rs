//! Area lights as they are seen and moved in a view of the scene: their handles, and what pulling one makes of the light. No widget draws here.

use glam::{DVec2, DVec3};

use crate::{
    document::{AreaLight, range},
    named::named,
    optics::vector::Vec3,
    scene::camera::{Camera, camera_ray},
};

/// How a scene is seen in an image of this size.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// In the geometry's units.
    pub camera: Camera<f64>,
    /// Width and height of the image, points.
    pub size: DVec2,
}

/// A pull of the pointer, in points from the image's top left.
#[derive(Clone, Copy, Debug)]
pub struct Pull {
    pub from: DVec2,
    pub to: DVec2,
    /// Angles and lengths become round.
    pub snaps: bool,
}

impl View {
    /// Where a place is seen; `None` behind the camera.
    pub fn seen(&self, place: DVec3) -> Option<DVec2> {
        let away = place - vector(self.camera.origin);
        let depth = away.dot(vector(self.camera.forward));
        let shrinks = if self.camera.parallel_from > 0.0 { 1.0 } else { depth };
        let share = |axis| away.dot(vector(axis)) / vector(axis).length_squared() / shrinks;
        let at = DVec2::new(share(self.camera.right), -share(self.camera.up));
        (depth > 1e-6 && at.is_finite()).then(|| 0.5 * (at + 1.0) * self.size)
    }

    /// The same within the image.
    pub fn seen_inside(&self, place: DVec3) -> Option<DVec2> {
        self.seen(place)
            .filter(|at| at.cmpge(DVec2::ZERO).all() && at.cmple(self.size).all())
    }

    /// The point of the image's edge beyond which a place lies that is not in it.
    pub fn edge_towards(&self, place: DVec3, margin: f64) -> DVec2 {
        let away = place - vector(self.camera.origin);
        let side = |axis| away.dot(vector(axis).normalize());
        let towards = DVec2::new(side(self.camera.right), -side(self.camera.up));
        let towards = towards.try_normalize().unwrap_or(DVec2::Y);
        let half = (0.5 * self.size - margin).max(DVec2::ONE);
        let reach = half / towards.abs().max(DVec2::splat(1e-9));
        0.5 * self.size + towards * reach.min_element()
    }

    /// The ray through a point: origin and unit direction.
    pub fn ray(&self, at: DVec2) -> [DVec3; 2] {
        let pinhole = Camera {
            lens_radius: 0.0,
            ..self.camera
        };
        camera_ray(&pinhole, (at / self.size).to_array(), [1, 1], [0.5; 2]).map(vector)
    }
}

fn vector(of: Vec3<f64>) -> DVec3 {
    of.to_f64().into()
}

/// Puts the middle of a light at a place, or as near as the range of its distance lets it.
fn put_at(light: &mut AreaLight, place: DVec3) {
    let away = place - DVec3::from(light.target);
    let (least, most) = range::AREA_LENGTH.into_inner();
    light.distance = away.length().clamp(least, most);
    light.look_from(away.normalize_or(light.shape().frame().outwards));
}

/// Moves a light in the plane through it that is parallel to the image, as far as the pointer moved there.
fn move_in_plane(light: &mut AreaLight, view: &View, pull: &Pull) {
    let middle = light.shape().frame().middle;
    let forward = vector(view.camera.forward);
    let in_plane = |at: DVec2| {
        let [origin, along] = view.ray(at);
        origin + along * ((middle - origin).dot(forward) / along.dot(forward).max(1e-6))
    };
    put_at(light, middle + in_plane(pull.to) - in_plane(pull.from));
}

/// Moves a light along an axis of length 1, as far as the pointer moved along its image.
fn move_along(light: &mut AreaLight, axis: DVec3, view: &View, pull: &Pull) {
    let middle = light.shape().frame().middle;
    let [from, to] = [pull.from, pull.to].map(|at| nearest(view.ray(at), middle, axis));
    put_at(light, middle + axis * (to - from));
}

/// Where lights come into the image, as shares of half its sides from the middle: the first, the second, and so on.
const CORNERS: [[f64; 2]; 4] = [[0.72, -0.68], [-0.72, -0.68], [0.72, 0.6], [-0.72, 0.6]];
/// Least distance of such a light from its target, bounding radii: it is outside of the model.
const CLEAR: f64 = 1.3;

/// Puts a new light in a corner of the image, where it is seen, beside the model or before it. It stays where it is if the
/// camera is too near for that.
pub fn put_in_view(light: &mut AreaLight, view: &View, number: usize) {
    let [x, y] = CORNERS[number % CORNERS.len()];
    let [origin, along] = view.ray(0.5 * view.size * (DVec2::ONE + DVec2::new(x, y)));
    let target = DVec3::from(light.target);
    let forward = vector(view.camera.forward);
    let mut length = (target - origin).dot(forward) / along.dot(forward).max(1e-6);
    if (origin + along * length).distance(target) < CLEAR {
        let half = (target - origin).dot(along);
        let below_root = half * half - (origin - target).length_squared() + CLEAR * CLEAR;
        length = half - below_root.max(0.0).sqrt();
    }
    if length > 0.0 {
        put_at(light, origin + along * length);
    }
}

/// Where a line through a place comes nearest to a ray, counted from there; 0 where they are parallel.
fn nearest([origin, along]: [DVec3; 2], place: DVec3, axis: DVec3) -> f64 {
    let (cosine, away) = (axis.dot(along), place - origin);
    let sine_squared = 1.0 - cosine * cosine;
    if sine_squared < 1e-6 {
        return 0.0;
    }
    (cosine * along.dot(away) - axis.dot(away)) / sine_squared
}

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
    match handle {
        LightHandle::Direction => move_around(&mut moved, view, middle, pull),
        LightHandle::InPlane => move_in_plane(&mut moved, view, pull),
        LightHandle::AlongX | LightHandle::AlongY | LightHandle::AlongZ => {
            move_along(&mut moved, handle.axis().unwrap_or_default(), view, pull);
        }
        LightHandle::Width | LightHandle::Height => scale(&mut moved, handle, factor, pull.snaps),
        LightHandle::Distance => scale(&mut moved, handle, (-along / POINTS_PER_E).exp(), pull.snaps),
        LightHandle::Cone => scale(&mut moved, handle, (along / POINTS_PER_E).exp(), pull.snaps),
        LightHandle::Turn => {
            let Some(middle) = middle else { return moved };
            let angle_deg = (pull.from - middle).angle_to(pull.to - middle).to_degrees();
            let sign = if faces_viewer(light, view) { 1.0 } else { -1.0 };
            moved.turn_deg = wrapped_deg(snapped(light.turn_deg + sign * angle_deg, SNAP_DEG, pull.snaps));
        }
    }
    moved
}

/// Scales the angle or the length that a handle stands for.
fn scale(light: &mut AreaLight, handle: LightHandle, factor: f64, snaps: bool) {
    let (value, step, range) = match handle {
        LightHandle::Cone => (&mut light.cone_deg, 0.1 * SNAP_DEG, range::CONE_DEG),
        LightHandle::Width if light.is_sun() => (&mut light.angle_deg, SNAP_LENGTH, range::SUN_ANGLE_DEG),
        LightHandle::Width => (&mut light.width, SNAP_LENGTH, range::AREA_LENGTH),
        LightHandle::Height => (&mut light.height, SNAP_LENGTH, range::AREA_LENGTH),
        _ => (&mut light.distance, SNAP_LENGTH, range::AREA_LENGTH),
    };
    let (least, most) = range.into_inner();
    *value = snapped(*value * factor, step, snaps).clamp(least, most);
}

/// The light after steps of the arrow keys, to the right and upwards, on a handle: degrees, or hundredths of a length.
pub fn nudged(light: &AreaLight, handle: LightHandle, steps: DVec2) -> AreaLight {
    let mut moved = *light;
    let sum = steps.x + steps.y;
    match handle {
        LightHandle::Direction => {
            moved.yaw_deg = wrapped_deg(light.yaw_deg + steps.x);
            moved.pitch_deg = (light.pitch_deg + steps.y).clamp(-90.0, 90.0);
        }
        LightHandle::Turn => moved.turn_deg = wrapped_deg(light.turn_deg + sum),
        LightHandle::Width | LightHandle::Height | LightHandle::Distance | LightHandle::Cone => {
            scale(&mut moved, handle, 1.01_f64.powf(sum), false);
        }
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
        let below_root = half * half - (origin - target).length_squared() + distance * distance;
        (origin, along, half, below_root)
    };
    let is_far = match middle {
        Some(middle) => {
            let (origin, _, half, _) = nearest(middle);
            frame.middle.distance(origin) > half
        }
        None => frame.outwards.dot(vector(view.camera.forward)) > 0.0,
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
    (vector(view.camera.origin) - frame.middle).dot(frame.outwards) < 0.0
}

fn snapped(value: f64, step: f64, snaps: bool) -> f64 {
    if snaps { (value / step).round() * step } else { value }
}

/// In [−180, 180).
fn wrapped_deg(angle: f64) -> f64 {
    (angle + 180.0).rem_euclid(360.0) - 180.0
}
