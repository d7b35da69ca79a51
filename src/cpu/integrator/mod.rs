//! The path tracer in Rust: twin of `shaders/pass/path_trace.wgsl`, generic over the precision of the shading.

mod catcher;
mod light;
mod path;
mod rays;
mod wave;

use std::borrow::Cow;

use super::recorder::{End, Event, Purpose, Recorder, Source, Unrecorded, single};
use crate::job::effect::EffectId;
use crate::job::features::{GUIDE_SAMPLES, GuideSums};
use crate::job::{Job, Settings, Strategy};
use crate::optics::material::{
    Material, MaterialNumbers, MaterialSample, material_albedo, material_layers, material_sample,
};
use crate::optics::random::path_state;
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;
use crate::scene::Geometry;
use crate::scene::camera::Camera;
use crate::scene::environment::Environment;
use crate::scene::light::Lights;
use crate::scene::surface::SurfacePoint;
use crate::scene::texture::{Textures, textured_material};
pub use catcher::CATCHER_DIMENSION;
use catcher::Caught;
use path::{Path, Ray};

/// Pairs of numbers before the first bounce: pixel, lens.
pub const FIRST_DIMENSION: u32 = 2;
/// Pairs of numbers a bounce: lobe twice, light twice.
pub const BOUNCE_DIMENSIONS: u32 = 4;
/// The first of the pairs of numbers for what the specular lobe passed on, two a bounce: beyond those of every path.
pub const BELOW_DIMENSION: u32 = 4096;
/// The first of the pairs of numbers that choose whether a surface stops a ray, one a bounce.
pub const OPACITY_DIMENSION: u32 = 8192;
/// Surfaces that a ray may go straight on through.
pub const PASSES_MAX: u32 = 256;
/// Bounces before Russian roulette.
pub const ROULETTE_START: u32 = 3;
/// Beyond it the square would overflow f32: dropped and counted.
pub const RADIANCE_MAX: f64 = 1e18;

/// What one path found.
#[derive(Clone, Copy, Debug, Default)]
pub struct PathResult<T> {
    /// Linear RGB.
    pub radiance: Vec3<T>,
    /// 1 where the path met something that is not transparent background.
    pub alpha: T,
    /// Rays traced.
    pub rays: u32,
    /// Luminance that limiting fireflies took.
    pub clamped: T,
    /// What it saw first, where it is one of those that tell.
    pub seen: GuideSums,
}

/// A job with its numbers in the precision of the shading.
pub struct Integrator<'a, T> {
    geometry: &'a Geometry,
    environment: &'a Environment,
    tables: &'a [f32],
    textures: &'a Textures,
    has_holes: bool,
    settings: &'a Settings,
    materials: Vec<Material<T>>,
    camera: Camera<T>,
    rotation: [T; 2],
    lights: &'a Lights,
    environment_probability: T,
    density_per_luminance: T,
    samples_environment: bool,
    samples_emitters: bool,
    is_interreflecting: bool,
    /// Samples of a pixel that tell what they see first.
    guide_samples: u32,
    /// Where fireflies are limited.
    firefly_clamp: Option<T>,
}

impl<'a, T: Real> Integrator<'a, T> {
    /// Reads the job.
    pub fn new(job: &'a Job) -> Self {
        let samples_light = job.settings.strategy != Strategy::Lobe;
        let choice = job.settings.light_choice;
        Self {
            geometry: &job.geometry,
            environment: &job.environment,
            tables: &job.tables,
            textures: &job.textures,
            has_holes: job.plan.has(EffectId::Alpha),
            settings: &job.settings,
            materials: job.materials.iter().map(Material::cast).collect(),
            camera: job.settings.camera.cast(),
            rotation: job.settings.environment_rotation.map(T::from_f64),
            lights: &job.lights,
            environment_probability: T::from_f64(choice.environment_probability),
            density_per_luminance: T::from_f64(choice.density_per_luminance),
            samples_environment: job.plan.has(EffectId::LightSampling)
                && samples_light
                && choice.environment_probability > 0.0,
            samples_emitters: job.plan.has(EffectId::EmitterSampling)
                && samples_light
                && choice.density_per_luminance > 0.0,
            is_interreflecting: job.plan.has(EffectId::Interreflection),
            guide_samples: if job.plan.has(EffectId::Guides) {
                GUIDE_SAMPLES
            } else {
                0
            },
            firefly_clamp: job
                .plan
                .has(EffectId::FireflyClamp)
                .then(|| T::from_f64(job.settings.firefly_clamp)),
        }
    }

    /// One path through a pixel.
    pub fn trace_path(&self, pixel: [u32; 2], sample: u32) -> PathResult<T> {
        self.record_path(pixel, sample, &mut Unrecorded)
    }

    /// The same path, its events told to a recorder.
    pub fn record_path<R: Recorder>(&self, pixel: [u32; 2], sample: u32, recorder: &mut R) -> PathResult<T> {
        let mut path = self.begin(pixel, sample, recorder);
        let mut ray = self.first_ray(pixel, &mut path);
        for bounce in 0.. {
            let Some((point, distance)) = self.stop(&ray, bounce, &mut path) else {
                return self.left(&ray, self.left_place(&ray, bounce), bounce, &mut path);
            };
            if !self.pass_catcher(&point, &ray, bounce, &mut path) {
                return self.left(&ray, self.left_place(&ray, bounce), bounce, &mut path);
            }
            let material = &*self.material(&point, &path);
            if !self.meet(&point, material, distance, &ray, bounce, &mut path) {
                break;
            }
            let numbers = self.light_numbers(bounce, &mut path);
            if let Some(light) = self.aim(&point, material, numbers, &mut path) {
                let visible = (self.visible(&light, &mut path.rays), self.light_place(&light));
                self.arrive(&light, visible, bounce, &mut path, || {
                    self.unweighed(&point, material, &light)
                });
            }
            let Some(next) = self.scatter(&point, material, bounce, &mut path) else {
                break;
            };
            ray = next;
        }
        self.result(&path, T::one())
    }

    /// What a path found that has come to its end.
    fn result<R: Recorder>(&self, path: &Path<'_, T, R>, alpha: T) -> PathResult<T> {
        path.result(alpha, self.settings.least_reflections == 0)
    }

    /// A path before its first ray.
    #[inline(always)]
    fn begin<'r, R: Recorder>(&self, pixel: [u32; 2], sample: u32, recorder: &'r mut R) -> Path<'r, T, R> {
        let settings = self.settings;
        let state = path_state(pixel[0], pixel[1], settings.seed, sample, settings.sequence);
        Path::new(state, sample < self.guide_samples, recorder)
    }

    /// What a path finds at the surface that stopped it, by itself; false where it ends there.
    #[inline(always)]
    fn meet<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        distance: T,
        ray: &Ray<T>,
        bounce: u32,
        path: &mut Path<'_, T, R>,
    ) -> bool {
        if point.surface.is_inside && material.transmits() {
            self.absorb(material, distance, path);
        }
        if path.is_looking {
            self.look(point, material, distance, ray, bounce, path);
        }
        let found = path.throughput * self.emitted_light(point, material, distance, ray, path);
        self.add(Source::Surface, found, bounce, path);
        let goes_on = bounce < self.settings.bounces;
        if !goes_on {
            path.record(|| Event::Ended { why: End::Bounces });
        }
        goes_on
    }

    /// Whether directions to lights are drawn at all.
    fn samples_light(&self) -> bool {
        self.samples_environment || self.samples_emitters
    }

    /// The material at a point where a path is, with what its textures say there.
    #[inline(always)]
    fn material<R>(&self, point: &SurfacePoint<T>, path: &Path<'_, T, R>) -> Cow<'_, Material<T>> {
        let slot = match self.settings.catcher {
            Some(catcher) if path.caught.is_mirrored() => catcher.reflection_slot,
            _ => point.slot,
        };
        let plain = &self.materials[slot as usize];
        if plain.is_textured() || plain.has_vertex_colors == 1 {
            Cow::Owned(textured_material(
                self.textures,
                self.tables,
                plain,
                point.uvs,
                point.vertex_color,
            ))
        } else {
            Cow::Borrowed(plain)
        }
    }

    /// What the interior leaves of light over this way through it.
    fn absorb<R: Recorder>(&self, material: &Material<T>, distance: T, path: &mut Path<'_, T, R>) {
        let kept = material.absorption.map(|absorption| (-absorption * distance).exp());
        path.record(|| Event::Absorption {
            distance: single(distance),
            kept: kept.to_f32(),
        });
        path.throughput = path.throughput * kept;
    }

    /// Notes what is seen here: at the first surface, and behind mirrors and clear glass.
    fn look<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        distance: T,
        ray: &Ray<T>,
        bounce: u32,
        path: &mut Path<'_, T, R>,
    ) {
        let albedo = path.throughput * material_albedo(material, self.tables, &point.surface);
        path.seen.albedo = albedo.to_f32().map(|share| share.clamp(0.0, 1.0));
        path.seen.normal = point.surface.frame.normal.to_f32();
        if bounce == 0 {
            path.seen.hits = 1.0;
            path.seen.depth = single(distance * ray.direction.dot(self.camera.forward));
        }
    }

    /// The end of a path that met nothing, and sees this place in the environment's map.
    fn left<R: Recorder>(&self, ray: &Ray<T>, place: [T; 2], bounce: u32, path: &mut Path<'_, T, R>) -> PathResult<T> {
        let mut alpha = T::one();
        if bounce == 0 {
            // The numbers of the first bounce, which there is none of.
            let (radiance, seen) = self.camera_background(ray.direction, place, FIRST_DIMENSION, path);
            self.add(Source::Background, radiance, 0, path);
            alpha = seen;
        } else if let Caught::Mirrored {
            background,
            alpha: seen,
        } = path.caught
        {
            self.add(Source::Background, background, bounce, path);
            alpha = seen;
        } else {
            let found = path.throughput * self.far_light(ray, place, path);
            self.add(Source::Environment, found, bounce, path);
        }
        path.record(|| Event::Ended { why: End::Left });
        self.result(path, alpha)
    }

    /// Adds light that was reflected so many times, no more than firefly limiting allows.
    #[inline(always)]
    fn add<R: Recorder>(&self, source: Source, found: Vec3<T>, reflections: u32, path: &mut Path<'_, T, R>) {
        let added = self.limited(found, reflections, &mut path.clamped);
        path.radiance += added;
        if found.to_f64() != [0.0; 3] {
            path.record(|| Event::Contribution {
                source,
                reflections,
                found: found.to_f32(),
                added: added.to_f32(),
            });
        }
    }

    /// What a contribution that was reflected so many times adds; `taken` grows by the luminance that is beyond the limit.
    #[inline(always)]
    fn limited(&self, contribution: Vec3<T>, reflections: u32, taken: &mut T) -> Vec3<T> {
        if reflections < self.settings.least_reflections {
            return Vec3::zero();
        }
        let Some(limit) = self.firefly_clamp.filter(|_| reflections > 1) else {
            return contribution;
        };
        let largest = contribution.max_component();
        if !limit.less(largest).any() {
            return contribution;
        }
        let kept = limit / largest;
        *taken += contribution.luminance() * (T::one() - kept);
        contribution * kept
    }

    /// The ray on which the path goes on; `None` where it ends.
    #[inline(always)]
    fn scatter<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        bounce: u32,
        path: &mut Path<'_, T, R>,
    ) -> Option<Ray<T>> {
        let numbers = material_numbers(material, bounce, path);
        let wants_density = self.samples_light() && self.settings.strategy == Strategy::Mis;
        let mut drawn = material_sample(material, self.tables, &point.surface, numbers, wants_density);
        let mut leaves = self.meets_nothing(point, drawn.wi);
        path.is_looking &= drawn.is_mirror;
        if path.caught.is_mirrored() {
            // All of it goes on, also what the facets would keep, and none of what it meets is left to light sampling.
            leaves |= drawn.throughput.max_component().to_f64() <= 0.0;
            drawn.throughput = Vec3::splat(T::one());
            drawn.is_mirror = true;
        }
        path.throughput = path.throughput * drawn.throughput;
        let throughput = path.throughput;
        path.record(|| self.scattered(point, material, &drawn, throughput));
        if !survives(bounce, path) {
            return None;
        }
        Some(Ray {
            origin: point.ray_origin(drawn.wi, material.transmits()),
            direction: drawn.wi,
            lobe_density: drawn.density,
            is_mirror: drawn.is_mirror,
            leaves,
        })
    }

    fn scattered(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        drawn: &MaterialSample<T>,
        throughput: Vec3<T>,
    ) -> Event {
        let layers = material_layers(material, self.tables, &point.surface);
        let below = T::one() - layers.coat_probability;
        let probabilities = [
            layers.coat_probability,
            below * layers.specular_probability,
            below * layers.base_probability(),
            below * layers.transmission_probability,
        ];
        Event::Scattered {
            layer: drawn.layer,
            probabilities: probabilities.map(single),
            direction: drawn.wi.to_f32(),
            factor: drawn.throughput.to_f32(),
            density: single(drawn.density),
            is_mirror: drawn.is_mirror,
            throughput: throughput.to_f32(),
        }
    }
}

/// The numbers with which a material's direction is drawn.
#[inline(always)]
fn material_numbers<T: Real, R: Recorder>(
    material: &Material<T>,
    bounce: u32,
    path: &mut Path<'_, T, R>,
) -> MaterialNumbers<T> {
    let dimension = FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS;
    let [a, b] = path.pair(dimension, [Purpose::Lobe; 2]);
    let [c, layer] = path.pair(dimension + 1, [Purpose::Lobe, Purpose::Layer]);
    let lobe = [a, b, c];
    let mut below = lobe;
    if material.transmits() {
        let dimension = BELOW_DIMENSION + 2 * bounce;
        let [a, b] = path.pair(dimension, [Purpose::Below; 2]);
        let [c, _] = path.pair(dimension + 1, [Purpose::Below, Purpose::Unused]);
        below = [a, b, c];
    }
    MaterialNumbers { lobe, layer, below }
}

/// Whether a path goes on: Russian roulette, its survivors made up for by their throughput.
#[inline(always)]
fn survives<T: Real, R: Recorder>(bounce: u32, path: &mut Path<'_, T, R>) -> bool {
    let strength = path.throughput.max_component();
    // Also ends paths that are NaN.
    if strength.to_f64().partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
        path.record(|| Event::Ended { why: End::Absorbed });
        return false;
    }
    if bounce < ROULETTE_START || strength.to_f64() >= 1.0 {
        return true;
    }
    let dimension = FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS + 3;
    let [_, number] = path.pair(dimension, [Purpose::Unused, Purpose::Roulette]);
    path.record(|| Event::Roulette {
        survival: single(strength),
        number: single(number),
    });
    if number.to_f64() >= strength.to_f64() {
        path.record(|| Event::Ended { why: End::Roulette });
        return false;
    }
    path.throughput = path.throughput / strength;
    true
}

/// Finite and not negative: what may be added to the picture.
pub fn is_sound<T: Real>(color: Vec3<T>) -> bool {
    color.to_f64().iter().all(|x| (0.0..=RADIANCE_MAX).contains(x))
}
