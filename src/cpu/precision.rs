//! A map of numerical trouble, pixel by pixel: f32 against f64 on the same surface, dropped samples, and rays that start on
//! the wrong side.

use super::{integrator::is_sound, oracle::PathTracer, probe::moved_direction};
use crate::{
    job::{
        Job, Settings,
        precision::{ERROR_BOUND, Finding, PrecisionMap, relative_error},
    },
    optics::{
        frame::Frame,
        layer::{MaterialNumbers, material_evaluate, material_layers, material_sample},
        material::Material,
        material::Surface,
        random::{RandomState, path_state, random_pair},
        vector::Vec3,
        warp::uniform_sphere,
    },
    parallel,
    scene::{camera::camera_ray, surface::SurfacePoint, surface::surface_at, texture::textured_material},
};

/// Paths a pixel that are looked at for samples to drop.
const PATHS: u32 = 4;
/// Directions of the light a pixel, by turns drawn from the material and from everywhere.
const LIGHTS: u32 = 6;
/// Density of the light's directions, per steradian: one that lets lobe and light compete.
const LIGHT_DENSITY: f64 = 1.0;
/// The first of the pairs of numbers that directions are drawn with.
const DIMENSION: u32 = 64;
/// Distances at which a ray's own surface must be hit straight back from its origin, in bounds of the position's error.
const DISTANCE: [f32; 2] = [0.5, 2.0];

/// Rows of a map between two looks whether it is superseded.
const MAP_ROWS: u32 = 8;

impl Settings {
    /// A map of the image: what is found at the centre of each of its pixels, row by row, from the place in the image and the
    /// origin and direction of the ray through it. `None` as soon as it is superseded.
    pub fn mapped<R: Send>(
        &self,
        [width, height]: [u32; 2],
        is_superseded: impl Fn() -> bool,
        find: impl Fn([f64; 2], [Vec3<f32>; 2]) -> R + Sync,
    ) -> Option<Vec<R>> {
        let camera = self.camera.cast();
        let mut found = Vec::with_capacity(width as usize * height as usize);
        for first in (0..height).step_by(MAP_ROWS as usize) {
            if is_superseded() {
                return None;
            }
            let pixels = (first + MAP_ROWS).min(height) * width - first * width;
            found.extend(parallel::map(pixels as usize, |index| {
                let index = first * width + index as u32;
                let share = |pixel: u32, count: u32| (f64::from(pixel) + 0.5) / f64::from(count);
                let shares = [share(index % width, width), share(index / width, height)];
                let place = [0, 1].map(|i| shares[i] * f64::from(self.image_size[i]));
                find(
                    place,
                    camera_ray(&camera, place.map(|x| x as f32), self.image_size, [0.5; 2]),
                )
            }));
        }
        Some(found)
    }
}

/// The map of a job; `None` if cancelled.
pub fn precision(job: &Job, [width, height]: [u32; 2], is_superseded: impl Fn() -> bool) -> Option<PrecisionMap> {
    let tracer = PathTracer::new(job);
    let find = |place: [f64; 2], ray: [Vec3<f32>; 2]| find(job, &tracer, place, ray);
    Some(PrecisionMap {
        width,
        height,
        bound: ERROR_BOUND,
        findings: job.settings.mapped([width, height], is_superseded, find)?,
    })
}

/// The findings at a place of the image.
fn find(job: &Job, tracer: &PathTracer<'_>, place: [f64; 2], [origin, direction]: [Vec3<f32>; 2]) -> Finding {
    let settings = &job.settings;
    let of_picture = place.map(|x| x as u32);
    let is_dropped = |sample: &u32| !is_sound(tracer.trace(of_picture, *sample).radiance);
    let dropped = (0..PATHS).filter(is_dropped).count() as u32;
    let nothing = Finding {
        dropped,
        ..Finding::default()
    };
    let Some(hit) = job.geometry.intersect(origin.to_f32(), direction.to_f32(), f32::MAX) else {
        return nothing;
    };
    let point = surface_at(&job.geometry, &job.materials, &job.textures, &hit, direction);
    let plain = &job.materials[point.slot as usize];
    let material = textured_material(&job.textures, &job.tables, plain, &point.uvs, point.vertex_color);
    let state = path_state(of_picture[0], of_picture[1], settings.seed, 0, settings.sequence);
    Finding {
        cosine: point.surface.normal.dot(point.surface.wo).clamp(0.0, 1.0),
        error: largest_error(job, &material, &point.surface, state),
        starts_astray: starts_astray(job, &point, material.transmits()),
        ..nothing
    }
}

/// Largest relative error of the material's value in f32, over some light directions where it is not singular.
fn largest_error(job: &Job, material: &Material<f32>, surface: &Surface<f32>, state: RandomState) -> f64 {
    let (exact, exact_surface) = (material.cast::<f64>(), widened(surface));
    let layers = material_layers(material, &job.tables, surface);
    let exact_layers = material_layers(&exact, &job.tables, &exact_surface);
    let error = |light: u32| {
        let [a, b] = random_pair(state, DIMENSION + 2 * light);
        let [c, facet] = random_pair(state, DIMENSION + 2 * light + 1);
        let lobe = [a, b, c];
        let numbers = MaterialNumbers {
            lobe,
            facet,
            below: lobe,
        };
        let wi = match light % 2 {
            0 => material_sample(material, &job.tables, surface, &layers, numbers, false).wi,
            _ => uniform_sphere([a, b]),
        };
        let density = LIGHT_DENSITY as f32;
        let answer = material_evaluate(material, &job.tables, surface, &layers, wi, density, 1.0);
        relative_error(answer, |moved| {
            let wi = moved_direction(Vec3::from_f64(wi.to_f64()), moved);
            material_evaluate(
                &exact,
                &job.tables,
                &exact_surface,
                &exact_layers,
                wi,
                LIGHT_DENSITY,
                1.0,
            )
        })
    };
    (0..LIGHTS).filter_map(error).fold(0.0, f64::max)
}

/// Whether rays from the surface (and into it, if it transmits) start on the wrong side: straight back, their own surface
/// must be the first hit, at the offset's distance.
fn starts_astray(job: &Job, point: &SurfacePoint<f32>, transmits: bool) -> bool {
    let is_astray = |out: Vec3<f32>| {
        let origin = point.ray_origin(out, true);
        let reach = DISTANCE[1] * point.error;
        let back = job.geometry.intersect(origin.to_f32(), (-out).to_f32(), reach);
        back.is_none_or(|hit| hit.t < DISTANCE[0] * point.error)
    };
    let normal = point.surface.normal;
    is_astray(normal) || (transmits && is_astray(-normal))
}

/// The very same surface in f64.
fn widened(surface: &Surface<f32>) -> Surface<f64> {
    let wide = |v: Vec3<f32>| Vec3::from_f64(v.to_f64());
    Surface {
        frame: Frame {
            tangent: wide(surface.frame.tangent),
            bitangent: wide(surface.frame.bitangent),
            normal: wide(surface.frame.normal),
        },
        normal: wide(surface.normal),
        wo: wide(surface.wo),
        coat_normal: wide(surface.coat_normal),
        is_inside: surface.is_inside,
    }
}
