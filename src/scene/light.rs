//! Surfaces that emit: sampled by power, triangle by triangle, and weighed against the environment. Area lights are
//! rectangles, triangles, ellipses and balls among them.
//!
//! A triangle emits the same radiance from both sides, but for a spot's, which sends all of it into a cone. It is picked in
//! proportion to area × luminance, and a place on it uniformly; so the density per area is luminance / power for every place
//! of every triangle, and a hit needs no table to know it. With an emission texture the luminance is its mean. The functions
//! that start with `light_`, and `spot_share`, have WGSL twins in `shaders/scene/light.wgsl`.

use std::f64::consts::PI;

use bytemuck::{Pod, Zeroable};
use glam::{DQuat, DVec3};

use super::alias::{AliasEntry, alias_table, grid_place};
use super::camera::{orbit_direction, right_and_up};
use super::environment::Environment;
use super::geometry::Geometry;
use super::intersect::triangle_normal;
use super::mesh::Mesh;
use super::part::Part;
use super::shapes;
use super::surface::{POSITION_ERROR, position_error};
use super::texture::{Textures, emission_at, uvs_at, vertex_factors};
use crate::optics::material::Material;
use crate::optics::numeric::normalize_or;
use crate::optics::real::{Mask, Real, Scalar};
use crate::optics::vector::{Vec3, vec3};

/// Where an area light is and what it looks at. Places are relative to the centre of the model's bounding box, they and
/// lengths in units of the model's bounding radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaShape {
    /// What it looks at.
    pub target: [f64; 3],
    /// Azimuth in degrees, as a camera's: 0 on the +Z side, 90 on the +X side.
    pub yaw_deg: f64,
    /// Height above the horizon in degrees.
    pub pitch_deg: f64,
    /// Distance of its middle from the target, above 0.
    pub distance: f64,
    /// Its horizontal side, above 0.
    pub width: f64,
    /// Its other side, above 0.
    pub height: f64,
    /// How far it is turned about the line to its target, clockwise seen from there, degrees.
    pub turn_deg: f64,
    /// What it is bounded by.
    pub outline: Outline,
}

/// What bounds an area light within its width and height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outline {
    /// All of it.
    Rectangle,
    /// The width is its base; its tip is at the middle of the upper side.
    Triangle,
    /// Width and height are its axes.
    Ellipse,
    /// A ball as large as the width.
    Sphere,
}

/// The middle of an area light, and unit vectors along its sides and away from its target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaFrame {
    /// Its middle, in the geometry's units.
    pub middle: DVec3,
    /// Along its width, to the right of who looks at it from the target.
    pub across: DVec3,
    /// Along its height, upwards.
    pub up: DVec3,
    /// From the target to the middle.
    pub outwards: DVec3,
}

impl AreaShape {
    /// Where it is.
    pub fn frame(&self) -> AreaFrame {
        let outwards = orbit_direction(self.yaw_deg, self.pitch_deg);
        let [left, mut up] = right_and_up(-outwards);
        let mut across = -left;
        if self.turn_deg != 0.0 {
            let turn = DQuat::from_axis_angle(outwards, self.turn_deg.to_radians());
            (across, up) = (turn * across, turn * up);
        }
        AreaFrame {
            middle: DVec3::from_array(self.target) + self.distance * outwards,
            across,
            up,
            outwards,
        }
    }

    /// Its triangles in the geometry's units, facing the target.
    pub(super) fn mesh(&self, slot: u32) -> Mesh {
        let AreaFrame { middle, across, up, .. } = self.frame();
        let (half_u, half_v) = (across * (0.5 * self.width), up * (-0.5 * self.height));
        match self.outline {
            Outline::Rectangle => shapes::rectangle(middle, half_u, half_v, 1.0, slot),
            Outline::Triangle => shapes::triangle(middle, half_u, half_v, slot),
            Outline::Ellipse => shapes::ellipse(middle, half_u, half_v, slot),
            Outline::Sphere => shapes::ball(middle, 0.5 * self.width, slot),
        }
    }
}

impl AreaShape {
    /// The corners of its triangles, in the geometry's units.
    pub(super) fn corners(&self) -> Vec<[DVec3; 3]> {
        let mesh = self.mesh(0);
        (0..mesh.triangles.len())
            .map(|triangle| mesh.corners(triangle))
            .collect()
    }

    /// Whether one of its triangles is seen from a place: of a ball the near ones alone.
    pub(super) fn shows(&self, [a, b, c]: &[DVec3; 3], place: DVec3) -> bool {
        self.outline != Outline::Sphere || (b - a).cross(c - a).dot(place - a) > 0.0
    }
}

/// An entry of the alias table over the emitting triangles.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Zeroable, Pod)]
pub struct LightCell {
    /// The probability, in [0, 1], that a draw of this entry is kept.
    pub threshold: f32,
    /// The entry to take instead when it is not kept.
    pub alias_index: u32,
    /// Which of the geometry's triangles.
    pub triangle: u32,
}

/// The triangles of a scene that emit.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    /// The alias table, in rows of a grid; the last row is filled up with entries that are never chosen.
    pub cells: Vec<LightCell>,
    /// Columns and rows of the grid.
    pub cells_size: [u32; 2],
    /// Σ area × luminance of the emission, in the geometry's units.
    pub power: f64,
}

impl Lights {
    /// The triangles of slots whose materials emit.
    pub fn new(geometry: &Geometry, materials: &[Material<f32>]) -> Self {
        let luminances: Vec<f64> = materials
            .iter()
            .map(|material| material.light_luminance.into())
            .collect();
        if luminances.iter().all(|luminance| *luminance <= 0.0) {
            return Self::default();
        }
        // A model none of whose materials emits is not looked through.
        let has_any = |(_, first): &(&Part, usize)| {
            let slots = if *first == 0 {
                ..geometry.model_slots()
            } else {
                ..luminances.len()
            };
            luminances[slots].iter().any(|luminance| *luminance > 0.0)
        };
        let emitting = geometry.parts().into_iter().filter(has_any).flat_map(|(part, first)| {
            let luminances = part.slots.iter().map(|&slot| luminances[slot as usize]);
            luminances.zip(first as u32..).filter(|(luminance, _)| *luminance > 0.0)
        });
        let (mut weights, triangles): (Vec<f64>, Vec<u32>) = emitting
            .map(|(luminance, triangle)| (area(geometry, triangle) * luminance, triangle))
            .unzip();
        let power: f64 = weights.iter().sum();
        if power <= 0.0 {
            return Self::default();
        }
        let columns = (weights.len() as f64).sqrt().ceil() as usize;
        let rows = weights.len().div_ceil(columns);
        weights.resize(columns * rows, 0.0);
        let filler = triangles[0];
        let triangles = triangles.into_iter().chain(std::iter::repeat(filler));
        let cell = |(entry, triangle): (AliasEntry, u32)| LightCell {
            threshold: entry.threshold,
            alias_index: entry.alias_index,
            triangle,
        };
        Self {
            cells: alias_table(&weights).into_iter().zip(triangles).map(cell).collect(),
            cells_size: [columns as u32, rows as u32],
            power,
        }
    }

    /// True where nothing emits.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }
}

fn area(geometry: &Geometry, triangle: u32) -> f64 {
    let corners = geometry.corners(triangle as usize);
    let [a, b, c] = corners.map(|corner| DVec3::from_array(corner.map(f64::from)));
    0.5 * (b - a).cross(c - a).length()
}

/// How one light sample is shared out, and what the integrators need to know its density.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightChoice {
    /// The probability that the environment is sampled, not a triangle: 0 where it is not sampled at all.
    pub environment_probability: f64,
    /// The density per area of the emitting triangles over the luminance of their emission; 0 where none is sampled.
    pub density_per_luminance: f64,
    /// Columns and rows of the table of triangles.
    pub cells_size: [u32; 2],
}

/// Which light directions are drawn from, where it is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampled {
    /// The environment.
    pub environment: bool,
    /// The triangles that emit.
    pub emitters: bool,
    /// Nothing else finds the light ([`Environment::distribution`]).
    pub alone: bool,
}

/// Neither kind of light gets less than this share of the samples: power says nothing about what is near or in shadow.
const SHARE_MIN: f64 = 0.1;

impl LightChoice {
    /// Shares by power: what the environment sends into the model's bounding sphere, 4π² × mean luminance × strength,
    /// against what the triangles emit from both sides, 2π × Σ area × luminance. Of the environment what is drawn counts:
    /// beside lobes its excess alone. An environment that is equally bright everywhere, or black, is not sampled; nor is
    /// what is not `wanted`.
    pub fn new(environment: &Environment, environment_strength: f64, lights: &Lights, wanted: Sampled) -> Self {
        let is_uneven = !environment.is_constant && !environment.is_black && environment_strength > 0.0;
        let is_sampled = wanted.environment && is_uneven;
        let has_emitters = wanted.emitters && !lights.is_empty();
        let environment_probability = match (is_sampled, has_emitters) {
            (false, _) => 0.0,
            (true, false) => 1.0,
            (true, true) => {
                let mean = environment.distribution(wanted.alone).mean_luminance;
                let far = 2.0 * PI * mean * environment_strength;
                (far / (far + lights.power)).clamp(SHARE_MIN, 1.0 - SHARE_MIN)
            }
        };
        let density_per_luminance = if has_emitters {
            (1.0 - environment_probability) / lights.power
        } else {
            0.0
        };
        Self {
            environment_probability,
            density_per_luminance,
            cells_size: lights.cells_size,
        }
    }
}

/// A place on an emitting triangle, seen from a point.
#[derive(Clone, Copy, Debug, Default)]
pub struct LightSample<T> {
    /// Towards the place.
    pub direction: Vec3<T>,
    /// With which it was drawn, per steradian.
    pub density: T,
    /// The way that must be free: it ends so far before the place that the triangle itself is not met.
    pub distance: T,
    /// What the place emits.
    pub radiance: Vec3<T>,
}

/// What light samples are drawn from.
#[derive(Clone, Copy, Debug)]
pub struct Emitters<'a, T> {
    /// The triangles.
    pub geometry: &'a Geometry,
    /// The materials of their slots.
    pub materials: &'a [Material<T>],
    /// What these look up.
    pub textures: &'a Textures,
    /// Which triangles emit.
    pub lights: &'a Lights,
    /// See [`LightChoice`].
    pub density_per_luminance: T,
}

/// A place on an emitting triangle, drawn with three uniform numbers in [0, 1): `xi.x` and `xi.y` choose an entry of the
/// table and the place, `xi.z` whether the entry or its alias is taken. There must be such a triangle. The ray towards it
/// may start up to `origin_error` off `origin`.
pub fn light_sample<T: Scalar>(
    emitters: &Emitters<'_, T>,
    origin: Vec3<T>,
    origin_error: T,
    xi: Vec3<T>,
) -> LightSample<T> {
    let Emitters { geometry, lights, .. } = *emitters;
    let (drawn, [x, y]) = grid_place([xi.x, xi.y], lights.cells_size);
    let cell = lights.cells[drawn as usize];
    let keep = xi.z.less(T::from_f64(f64::from(cell.threshold)));
    let chosen = if keep { drawn } else { cell.alias_index };
    let triangle = lights.cells[chosen as usize].triangle as usize;
    let [p0, p1, p2] = geometry.corners(triangle).map(Vec3::from_f32);
    // Uniform in area.
    let s = x.sqrt();
    let weights = [T::one() - s, s * (T::one() - y), s * y];
    let place = p0 * weights[0] + p1 * weights[1] + p2 * weights[2];
    let towards = place - origin;
    let distance = towards.length();
    let direction = normalize_or(towards, vec3(T::zero(), T::one(), T::zero()));
    let normal = normalize_or(triangle_normal([p0, p1, p2]), direction);
    let material = &emitters.materials[geometry.slot(triangle) as usize];
    let mut radiance = material.emission;
    if material.is_varied() || material.has_holes() {
        let uvs = uvs_at(geometry, triangle, weights, material.has_box_projection == 1);
        let of_vertices = vertex_factors(geometry, material, triangle, weights);
        radiance = emission_at(emitters.textures, material, uvs, of_vertices);
    }
    if is_spot(material) {
        radiance = radiance * spot_share(material, -normal.dot(direction));
    }
    let cosine = normal.dot(direction).abs();
    let error = position_error([p0, p1, p2], weights, normal) + origin_error + T::from_f64(POSITION_ERROR) * distance;
    LightSample {
        direction,
        density: light_density(
            material.light_luminance,
            cosine,
            distance,
            emitters.density_per_luminance,
        ),
        distance: distance - error / cosine.max(T::from_f64(COSINE_MIN)),
        radiance,
    }
}

/// True where what a material emits depends on the direction.
#[inline(always)]
pub fn is_spot<T: Real>(material: &Material<T>) -> bool {
    material.spot_scale.differs(T::zero()).any()
}

/// The share of its radiance that a spot sends in a direction under this cosine to the way it faces: 1 within the inner
/// cone, 0 outside the outer one, and between them the square of a ramp in the cosine, as glTF's spots have it
/// (KHR_lights_punctual).
#[inline(always)]
pub fn spot_share<T: Real>(material: &Material<T>, cosine: T) -> T {
    let ramp = (cosine * material.spot_scale + material.spot_offset)
        .max(T::zero())
        .min(T::one());
    ramp * ramp
}

/// Keeps densities finite where a triangle is seen edge-on.
pub const COSINE_MIN: f64 = 1e-6;

/// The density, per steradian, with which [`light_sample`] draws the direction to a place of a material with this
/// `light_luminance` that is seen under this cosine from this distance.
#[inline(always)]
pub fn light_density<T: Real>(light_luminance: T, cosine: T, distance: T, density_per_luminance: T) -> T {
    let per_area = density_per_luminance * light_luminance;
    per_area * distance * distance / cosine.max(T::from_f64(COSINE_MIN))
}
