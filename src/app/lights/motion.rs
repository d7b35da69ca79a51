//! Area lights in a view of the scene: put into it, moved in its plane or along an axis, while they go on looking at their
//! targets.

use glam::{DVec2, DVec3};

use crate::document::{AreaLight, range};
use crate::scene::camera::Camera;

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
        let away = place - vector(self.camera.origin.to_f64());
        let depth = away.dot(vector(self.camera.forward.to_f64()));
        let shrinks = if self.is_parallel() { 1.0 } else { depth };
        let share = |axis: [f64; 3]| away.dot(vector(axis)) / vector(axis).length_squared() / shrinks;
        let at = DVec2::new(share(self.camera.right.to_f64()), -share(self.camera.up.to_f64()));
        (depth > 1e-6 && at.is_finite()).then(|| 0.5 * (at + 1.0) * self.size)
    }

    fn is_parallel(&self) -> bool {
        self.camera.parallel_from > 0.0
    }

    /// The same within the image.
    pub fn seen_inside(&self, place: DVec3) -> Option<DVec2> {
        self.seen(place)
            .filter(|at| at.cmpge(DVec2::ZERO).all() && at.cmple(self.size).all())
    }

    /// The point of the image's edge beyond which a place lies that is not in it.
    pub fn edge_towards(&self, place: DVec3, margin: f64) -> DVec2 {
        let away = place - vector(self.camera.origin.to_f64());
        let side = |axis: [f64; 3]| away.dot(vector(axis).normalize());
        let towards = DVec2::new(side(self.camera.right.to_f64()), -side(self.camera.up.to_f64()));
        let towards = towards.try_normalize().unwrap_or(DVec2::Y);
        let half = (0.5 * self.size - margin).max(DVec2::ONE);
        let reach = half / towards.abs().max(DVec2::splat(1e-9));
        0.5 * self.size + towards * reach.min_element()
    }

    /// The ray through a point: origin and unit direction.
    pub fn ray(&self, at: DVec2) -> [DVec3; 2] {
        let share = 2.0 * at / self.size - 1.0;
        let [origin, forward] = [self.camera.origin, self.camera.forward].map(|of| vector(of.to_f64()));
        let aside = share.x * vector(self.camera.right.to_f64()) - share.y * vector(self.camera.up.to_f64());
        if self.is_parallel() {
            return [origin + aside, forward];
        }
        [origin, (forward + aside).normalize()]
    }
}

pub fn vector(of: [f64; 3]) -> DVec3 {
    DVec3::from_array(of)
}

/// Puts the middle of a light at a place, or as near as the range of its distance lets it.
pub fn put_at(light: &mut AreaLight, place: DVec3) {
    let away = place - DVec3::from_array(light.target);
    let (least, most) = range::AREA_LENGTH.into_inner();
    light.distance = away.length().clamp(least, most);
    light.look_from(away.normalize_or(light.shape().frame().outwards));
}

/// Moves a light in the plane through it that is parallel to the image, as far as the pointer moved there.
pub fn move_in_plane(light: &mut AreaLight, view: &View, pull: &Pull) {
    let middle = light.shape().frame().middle;
    let forward = DVec3::from_array(view.camera.forward.to_f64());
    let in_plane = |at: DVec2| {
        let [origin, along] = view.ray(at);
        origin + along * ((middle - origin).dot(forward) / along.dot(forward).max(1e-6))
    };
    put_at(light, middle + in_plane(pull.to) - in_plane(pull.from));
}

/// Moves a light along an axis of length 1, as far as the pointer moved along its image.
pub fn move_along(light: &mut AreaLight, axis: DVec3, view: &View, pull: &Pull) {
    let middle = light.shape().frame().middle;
    let (from, to) = (
        nearest(view.ray(pull.from), middle, axis),
        nearest(view.ray(pull.to), middle, axis),
    );
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
    let target = DVec3::from_array(light.target);
    let forward = DVec3::from_array(view.camera.forward.to_f64());
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
