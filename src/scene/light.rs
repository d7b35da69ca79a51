//! Surfaces that emit: sampled by power, triangle by triangle, and weighed against the environment. Area lights are
//! rectangles, triangles, ellipses and balls among them.
//!
//! A triangle emits the same radiance from both sides, but for a spot's, which sends all of it into a cone. It is picked in
//! proportion to area × luminance, and a place on it uniformly; so the density per area is luminance / power for every place
//! of every triangle, and a hit needs no table to know it. With an emission texture the luminance is its mean. The functions
//! that start with `light_`, and `spot_share`, have WGSL twins in `shaders/scene/light.wgsl`.

use std::f64::consts::PI;

use bytemuck::{Pod, Zeroable};

use super::{
    alias::{alias_table, grid_place},
    environment::Environment,
    geometry::Geometry,
    intersect::triangle_normal,
    light_profile::profile_share,
    part::exact,
    surface::{POSITION_ERROR, position_error},
    texture::{TextureTarget, Textures, emission_at, multiply_by, uvs_at, vertex_factors},
};
use crate::optics::prelude::*;
use crate::optics::{
    coat_medium::coat_over_emission,
    material::{COAT_ABSORBS, HAS_BOX, HAS_PROFILE, Material},
    numeric::normalize_or,
};

/// An entry of the alias table over the emitting triangles.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Zeroable, Pod)]
pub struct LightCell {
    /// The probability, in [0, 1], that a draw of this entry is kept.
    pub threshold: f32,
    /// The entry to take instead when it is not kept.
    pub alias_index: u32,
    /// Index of the triangle in the geometry.
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
        let (first, count) = if luminances[..geometry.model_slots()]
            .iter()
            .any(|luminance| *luminance > 0.0)
        {
            (0, geometry.triangle_count())
        } else {
            // A model none of whose materials emits is not looked through.
            (geometry.parts()[1].1, geometry.around.triangles.len())
        };
        let emitting = (first as u32..).zip(geometry.slots().skip(first).take(count));
        let emitting = emitting
            .map(|(triangle, slot)| (luminances[slot as usize], triangle))
            .filter(|(luminance, _)| *luminance > 0.0);
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
        let first = triangles[0];
        let triangles = triangles.into_iter().chain(std::iter::repeat(first));
        Self {
            cells: alias_table(&weights)
                .into_iter()
                .zip(triangles)
                .map(|(entry, triangle)| LightCell {
                    threshold: entry.threshold,
                    alias_index: entry.alias_index,
                    triangle,
                })
                .collect(),
            cells_size: [columns as u32, rows as u32],
            power,
        }
    }

    /// True if nothing emits.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }
}

fn area(geometry: &Geometry, triangle: u32) -> f64 {
    let [a, b, c] = exact(geometry.corners(triangle as usize));
    0.5 * (b - a).cross(c - a).length()
}

/// Split of light samples between environment and emitters, as the integrators need it for densities.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightChoice {
    /// Probability in [0, 1] of sampling the environment instead of a triangle.
    pub environment_probability: f64,
    /// Density per area on emitting triangles, divided by the luminance of their emission; 0 if none is sampled.
    pub density_per_luminance: f64,
    /// Columns and rows of the table of triangles.
    pub cells_size: [u32; 2],
}

/// Which lights are sampled, if present.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampled {
    /// Whether the environment is sampled.
    pub environment: bool,
    /// The triangles that emit.
    pub emitters: bool,
    /// Whether light sampling is the only strategy, see [`Environment::distribution`].
    pub alone: bool,
}

/// Smallest share of samples for either kind of light: power says nothing about nearness or shadow.
const SHARE_MIN: f64 = 0.1;

impl LightChoice {
    /// Splits samples by power. The environment sends 4π² × mean luminance × strength into the model's bounding sphere;
    /// triangles emit 2π × Σ area × luminance from both sides. With BSDF sampling, only the environment's sampled excess
    /// counts. A uniform or black environment is not sampled, nor is anything not `wanted`.
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
    /// Unit direction to the sampled position.
    pub direction: Vec3<T>,
    /// Density per steradian.
    pub density: T,
    /// Length of the shadow ray: it ends just before the position, so that the triangle itself is not hit.
    pub distance: T,
    /// Emitted radiance, linear RGB.
    pub radiance: Vec3<T>,
    /// Number of its light group.
    pub group: T,
}

/// The emitters, as light sampling needs them.
#[derive(Clone, Copy, Debug)]
pub struct Emitters<'a, T> {
    /// Geometry with the triangles.
    pub geometry: &'a Geometry,
    /// The materials of their slots.
    pub materials: &'a [Material<T>],
    /// Textures of the materials.
    pub textures: &'a Textures,
    pub lights: &'a Lights,
    /// Tables of the materials.
    pub tables: &'a [f32],
    /// See [`LightChoice`].
    pub density_per_luminance: T,
}

/// Samples a position on an emitting triangle with three uniform numbers in [0, 1): `xi.x` and `xi.y` select an entry of the
/// table and the position, `xi.z` the entry or its alias. There must be such a triangle. The ray may start up to
/// `origin_error` off `origin`.
pub fn light_sample<T: Scalar>(
    emitters: &Emitters<'_, T>,
    origin: Vec3<T>,
    origin_error: T,
    xi: Vec3<T>,
) -> LightSample<T> {
    let Emitters { geometry, lights, .. } = *emitters;
    let (drawn, [x, y]) = grid_place([xi.x, xi.y], lights.cells_size);
    let cell = lights.cells[drawn as usize];
    let chosen = if xi.z.less(T::from_f64(f64::from(cell.threshold))) {
        drawn
    } else {
        cell.alias_index
    };
    let triangle = lights.cells[chosen as usize].triangle as usize;
    let [p0, p1, p2] = geometry.corners(triangle).map(Vec3::from_f32);
    // Uniform in area.
    let s = x.sqrt();
    let weights = [T::ONE - s, s * (T::ONE - y), s * y];
    let towards = p0 * weights[0] + p1 * weights[1] + p2 * weights[2] - origin;
    let distance = towards.length();
    let direction = normalize_or(towards, vec3(T::ZERO, T::ONE, T::ZERO));
    let normal = normalize_or(triangle_normal([p0, p1, p2]), direction);
    let material = &emitters.materials[geometry.slot(triangle) as usize];
    let mut radiance = material.emission;
    let mut coated = *material;
    if material.is_varied() || material.has_holes() {
        let uvs = uvs_at(geometry, triangle, weights, material.has_flag(HAS_BOX));
        let of_vertices = vertex_factors(geometry, material, triangle, weights);
        radiance = emission_at(emitters.textures, material, uvs, of_vertices);
        multiply_by(
            emitters.textures,
            TextureTarget::OF_COAT,
            &T::each(|_| uvs),
            &mut coated,
        );
    }
    if is_spot(material) {
        radiance = radiance * spot_share(material, -normal.dot(direction));
    }
    if material.has_flag(COAT_ABSORBS) {
        let facing = -normal.dot(direction);
        radiance = radiance * coat_over_emission(&coated, facing, facing.below_zero());
    }
    if material.has_flag(HAS_PROFILE) {
        radiance = radiance * profile_share(&emitters.tables[material.lobe_table as usize..], -direction);
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
        group: T::from_count(material.light_group()),
    }
}

/// True if a material's emission depends on the direction.
#[inline(always)]
pub fn is_spot<T: Real>(material: &Material<T>) -> bool {
    material.spot_scale.differs(T::ZERO).any()
}

/// Share in [0, 1] of its radiance that a spot emits at this cosine to its axis: 1 within the inner cone, 0 outside the
/// outer one. In between it is the square of a ramp in the cosine, as glTF's spots have it (KHR_lights_punctual).
#[inline(always)]
pub fn spot_share<T: Real>(material: &Material<T>, cosine: T) -> T {
    let ramp = (cosine * material.spot_scale + material.spot_offset)
        .max(T::ZERO)
        .min(T::ONE);
    ramp * ramp
}

/// Keeps densities finite where a triangle is seen edge-on.
pub const COSINE_MIN: f64 = 1e-6;

/// Density per steradian of [`light_sample`] for a position on a material of this `light_luminance`, at this cosine and
/// distance.
#[inline(always)]
pub fn light_density<T: Real>(light_luminance: T, cosine: T, distance: T, density_per_luminance: T) -> T {
    density_per_luminance * light_luminance * distance * distance / cosine.max(T::from_f64(COSINE_MIN))
}
