//! Reference light of the shadow catcher: the light on its plane without objects.
//!
//! A shadow catcher shows the background times the ratio of the light that arrives to the light without objects. This is the
//! method of Debevec (1998), "Rendering synthetic objects into real scenes", with a quotient instead of the difference, so
//! that nothing becomes negative. The reference is a table, since lights may be near: a square of radiances of a white
//! diffuse plane, with nodes close together below the model. The table starts with its number of nodes per side and the
//! plane's reflectance. Functions that start with `catcher_` have WGSL twins in `shaders/scene/catcher.wgsl`.

use std::f64::consts::PI;

use glam::DVec3;

use super::{
    area_shape::AreaShape,
    environment::{Environment, environment_local_from_world, environment_radiance},
    ground::HALF_SIDE,
};
use crate::optics::prelude::*;
use crate::{optics::table::NODE_LENGTH, parallel};

/// Nodes per side with area lights; without them the light is uniform.
const SIDE: usize = 128;
/// The share of the half side over which nodes are close together.
pub const CATCHER_BEND: f32 = 0.15;
/// Half a side of the table in bounding radii: the ground's.
pub const CATCHER_HALF_SIDE: f32 = HALF_SIDE as f32;
/// Reflectance of glass of index 1.5 at normal incidence.
pub const CATCHER_REFLECTANCE: f32 = 0.04;

/// The lights on a shadow catcher.
#[derive(Clone, Copy, Debug)]
pub struct CatcherLight<'a> {
    pub environment: &'a Environment,
    /// Cosine and sine of its rotation about +Y.
    pub rotation: [f64; 2],
    /// Factor of its radiance.
    pub strength: f64,
    /// Area lights. They shine, and take the light from behind them away.
    pub area_lights: &'a [NearLight],
}

/// An area light that shines on a shadow catcher.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearLight {
    /// Placement of the light.
    pub shape: AreaShape,
    /// Radiance, linear RGB; a spot's on its axis.
    pub radiance: [f64; 3],
    /// The ramp of a spot's share over the cosine to the way it faces, see [`spot_share`](super::light::spot_share): scale and
    /// offset.
    pub spot: [f64; 2],
}

impl NearLight {
    /// Mean share of its radiance that a triangle emits to a position: exact for functions up to quadratic over the
    /// triangle.
    fn share(&self, place: DVec3, corners: &[DVec3; 3]) -> f64 {
        let [scale, offset] = self.spot;
        if scale == 0.0 {
            return 1.0;
        }
        let facing = -self.shape.frame().outwards;
        let shares = [0, 1, 2].map(|index| {
            let middle = corners[index].midpoint(corners[(index + 1) % 3]);
            ((place - middle).normalize_or_zero().dot(facing) * scale + offset)
                .clamp(0.0, 1.0)
                .powi(2)
        });
        shares.iter().sum::<f64>() / 3.0
    }
}

/// The table of a plane at `height` facing +Y, in the geometry's units; `reflection` is the weight of its varnish. The first
/// node has the nodes per side and the reflection.
pub fn catcher_table(light: &CatcherLight<'_>, height: f64, reflection: f32) -> Vec<f32> {
    let far = far_light(light.environment).map(|radiance| radiance * light.strength);
    let near: Vec<_> = light
        .area_lights
        .iter()
        .map(|light| (parts(&light.shape.corners()), light))
        .collect();
    let side = if near.is_empty() { 1 } else { SIDE };
    let at = |index: usize| {
        let [x, z] = [index % side, index / side].map(|number| node_place(number, side));
        let place = DVec3::new(x, height, z);
        let mut sum = far;
        for (triangles, near) in &near {
            for corners in triangles.iter().filter(|corners| near.shape.shows(corners, place)) {
                let share = form_factor(place, corners);
                let behind = light.behind(place, corners);
                let spot = near.share(place, corners);
                for (channel, sum) in sum.iter_mut().enumerate() {
                    *sum += share * (spot * near.radiance[channel] - behind[channel]);
                }
            }
        }
        sum.map(|radiance| radiance.max(0.0) as f32)
    };
    let nodes = parallel::map(side * side, at)
        .into_iter()
        .map(|[r, g, b]| [r, g, b, 0.0]);
    std::iter::once([side as f32, reflection, 0.0, 0.0])
        .chain(nodes)
        .flatten()
        .collect()
}

impl CatcherLight<'_> {
    /// The environment's radiance that the middle of a triangle hides from a position.
    fn behind(&self, place: DVec3, corners: &[DVec3; 3]) -> [f64; 3] {
        let [x, y, z] = (corners.iter().sum::<DVec3>() / 3.0 - place)
            .normalize_or(DVec3::Y)
            .to_array();
        let local = environment_local_from_world(vec3(x, y, z), self.rotation);
        environment_radiance(self.environment, local)
            .to_f64()
            .map(|radiance| radiance * self.strength)
    }
}

/// Triangles from which no further subdivision is needed: a disc's.
const MANY: usize = 16;

/// Triangles, each subdivided into four, so that the environment behind each part is nearly uniform.
fn parts(triangles: &[[DVec3; 3]]) -> Vec<[DVec3; 3]> {
    if triangles.len() >= MANY {
        return triangles.to_vec();
    }
    triangles
        .iter()
        .flat_map(|&[a, b, c]: &[DVec3; 3]| {
            let [ab, bc, ca] = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        })
        .collect()
}

/// Position of a node along an axis.
fn node_place(number: usize, side: usize) -> f64 {
    if side == 1 {
        return 0.0;
    }
    let along = 2.0 * number as f64 / (side - 1) as f64 - 1.0;
    let bend = f64::from(CATCHER_BEND);
    HALF_SIDE * along * bend / (1.0 + bend - along.abs())
}

/// The cosine-weighted mean of an environment over the upper hemisphere: the radiance of a white diffuse plane. The map
/// rotates about +Y alone, so that its rotation does not matter.
fn far_light(environment: &Environment) -> [f64; 3] {
    let columns = environment.width as usize;
    let row_mean = |row: &[[f32; 4]]| {
        let sum = row.iter().fold([0.0; 3], |sum, texel| {
            [0, 1, 2].map(|channel| sum[channel] + f64::from(texel[channel]))
        });
        sum.map(|sum| sum / columns as f64)
    };
    let height = environment.height as usize;
    let upper = (height / 2 + 1).min(height);
    let rows = parallel::map(upper, |row| row_mean(&environment.texels[row * columns..][..columns]));
    // Midpoint rule in the squared sine, in which the weight is uniform.
    let steps = (8 * height).max(4096);
    let mut sum = [0.0; 3];
    for step in 0..steps {
        let v = ((step as f64 + 0.5) / steps as f64).sqrt().asin() / PI;
        let place = (v * height as f64 - 0.5).clamp(0.0, (upper - 1) as f64);
        let (row, share) = (place.floor() as usize, place.fract());
        let next = (row + 1).min(upper - 1);
        for (channel, sum) in sum.iter_mut().enumerate() {
            *sum += rows[row][channel] * (1.0 - share) + rows[next][channel] * share;
        }
    }
    sum.map(|sum| sum / steps as f64)
}

/// Form factor of a triangle, on either side, for a horizontal plane at a position; parts below the horizon do not count
/// (Lambert 1760; Baum, Rushmeier and Winget 1989, eq. 9).
fn form_factor(place: DVec3, corners: &[DVec3; 3]) -> f64 {
    let relative = corners.map(|corner| corner - place);
    let mut above = Vec::with_capacity(4);
    for (index, &corner) in relative.iter().enumerate() {
        let next = relative[(index + 1) % 3];
        if corner.y >= 0.0 {
            above.push(corner);
        }
        if (corner.y < 0.0) != (next.y < 0.0) {
            above.push(corner.lerp(next, corner.y / (corner.y - next.y)));
        }
    }
    let edge = |(index, from): (usize, &DVec3)| {
        let to = above[(index + 1) % above.len()];
        let across = from.cross(to);
        let sine = across.length();
        // An edge without length does not count.
        if sine > 0.0 {
            sine.atan2(from.dot(to)) * across.y / sine
        } else {
            0.0
        }
    };
    let sum: f64 = above.iter().enumerate().map(edge).sum();
    sum.abs() / (2.0 * PI)
}

/// Radiance of a white diffuse plane at a position, lit by all lights without occluders: bilinear between the table's nodes.
pub fn catcher_light<T: Scalar>(tables: &[f32], table: u32, position: Vec3<T>) -> Vec3<T> {
    let side = tables[table as usize] as usize;
    let ((column, across), (row, down)) = (catcher_node(position.x, side), catcher_node(position.z, side));
    let at = |row: usize, column: usize| catcher_radiance::<T>(tables, table, side, row, column);
    let upper = at(row, column).mix(at(row, column + 1), across);
    upper.mix(at(row + 1, column).mix(at(row + 1, column + 1), across), down)
}

/// The node of the table before a place along an axis, and how far the place is behind it.
fn catcher_node<T: Scalar>(along: T, side: usize) -> (usize, T) {
    let away = (along.abs() / T::from_f64(f64::from(CATCHER_HALF_SIDE))).min(T::ONE);
    let bend = T::from_f64(f64::from(CATCHER_BEND));
    let bent = away * (T::ONE + bend) / (away + bend);
    let turned = T::select(along.below_zero(), -bent, bent);
    let place = (turned * T::HALF + T::HALF) * T::from_f64(side as f64 - 1.0);
    let low = place.floor();
    (low.to_f64() as usize, place - low)
}

/// Radiance at a node, clamped to the last row and column.
fn catcher_radiance<T: Scalar>(tables: &[f32], table: u32, side: usize, row: usize, column: usize) -> Vec3<T> {
    let node = table as usize + NODE_LENGTH * (1 + (row.min(side - 1) * side + column.min(side - 1)));
    Vec3::from_f32([tables[node], tables[node + 1], tables[node + 2]])
}

/// Reflectance of the plane at a cosine, in [0, 1] (Schlick 1994, eq. 15).
#[inline(always)]
pub fn catcher_reflectance<T: Real>(tables: &[f32], table: u32, cosine: T) -> T {
    let reflection = T::from_f64(f64::from(tables[table as usize + 1]));
    let straight = T::from_f64(f64::from(CATCHER_REFLECTANCE));
    let away = (T::ONE - cosine).clamp(T::ZERO, T::ONE);
    let squared = away * away;
    reflection * (straight + (T::ONE - straight) * squared * squared * away)
}
