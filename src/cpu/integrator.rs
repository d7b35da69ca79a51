//! The path tracer in Rust: twin of `shaders/pass/path_trace.wgsl`, generic over the precision of the shading.

use crate::document::job::{BackgroundKind, Job, Settings, Strategy};
use crate::optics::material::{Material, MaterialNumbers, material_evaluate, material_sample};
use crate::optics::random::{RandomState, random_pair, random_state};
use crate::optics::real::{Mask, Real};
use crate::optics::vector::{Vec3, vec3};
use crate::scene::camera::{Camera, camera_ray, filter_offset};
use crate::scene::environment::{
    Environment, environment_density, environment_local_from_world, environment_radiance, environment_sample,
    environment_world_from_local,
};
use crate::scene::light::{LightSample, Lights, light_density, light_sample};
use crate::scene::surface::{SurfacePoint, surface_at};
use crate::scene::{Geometry, Hit};

/// Pairs of numbers before the first bounce: pixel, lens.
pub const FIRST_DIMENSION: u32 = 2;
/// Pairs of numbers a bounce: lobe twice, light twice.
pub const BOUNCE_DIMENSIONS: u32 = 4;
/// The first of the pairs of numbers for what the specular lobe passed on, two a bounce: beyond those of every path.
pub const BELOW_DIMENSION: u32 = 4096;
/// Bounces before Russian roulette.
pub const ROULETTE_START: u32 = 3;
/// Beyond it the square would overflow f32: dropped and counted.
pub const RADIANCE_MAX: f64 = 1e18;

/// What one path found.
#[derive(Clone, Copy, Debug)]
pub struct PathResult<T> {
    /// Linear RGB.
    pub radiance: Vec3<T>,
    /// 1 where the path met something that is not transparent background.
    pub alpha: T,
    /// Rays traced.
    pub rays: u32,
    /// Luminance that limiting fireflies took.
    pub clamped: T,
}

/// A job with its numbers in the precision of the shading.
pub struct Integrator<'a, T> {
    geometry: &'a Geometry,
    environment: &'a Environment,
    tables: &'a [f32],
    settings: &'a Settings,
    materials: Vec<Material<T>>,
    camera: Camera<T>,
    rotation: [T; 2],
    lights: &'a Lights,
    environment_probability: T,
    density_per_luminance: T,
    samples_environment: bool,
    samples_emitters: bool,
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
            settings: &job.settings,
            materials: job.materials.iter().map(Material::cast).collect(),
            camera: job.settings.camera.cast(),
            rotation: job.settings.environment_rotation.map(T::from_f64),
            lights: &job.lights,
            environment_probability: T::from_f64(choice.environment_probability),
            density_per_luminance: T::from_f64(choice.density_per_luminance),
            samples_environment: job.plan.light_sampling && samples_light,
            samples_emitters: job.plan.emitter_sampling && samples_light,
            firefly_clamp: job.plan.firefly_clamp.then(|| T::from_f64(job.settings.firefly_clamp)),
        }
    }

    /// Radiance of the environment in a world direction.
    fn far_radiance(&self, direction: Vec3<T>) -> Vec3<T> {
        let local = environment_local_from_world(direction, self.rotation);
        environment_radiance(self.environment, local) * T::from_f64(self.settings.environment_strength)
    }

    /// What a path that left the scene sees, weighed against light sampling.
    fn far_light(&self, direction: Vec3<T>, lobe_density: T, is_mirror: bool) -> Vec3<T> {
        let radiance = self.far_radiance(direction);
        if !self.samples_environment || is_mirror {
            return radiance;
        }
        if self.settings.strategy == Strategy::Light {
            return Vec3::zero();
        }
        let local = environment_local_from_world(direction, self.rotation);
        let light_density = self.environment_probability * environment_density(self.environment, local);
        radiance * lobe_share(lobe_density, light_density)
    }

    /// What a surface emits that a path met at `distance`, weighed against light sampling.
    fn emitted_light(&self, point: &SurfacePoint<T>, distance: T, lobe_density: T, is_mirror: bool) -> Vec3<T> {
        let emission = self.materials[point.slot as usize].emission;
        if !self.samples_emitters || is_mirror {
            return emission;
        }
        if self.settings.strategy == Strategy::Light {
            return Vec3::zero();
        }
        let cosine = point.surface.normal.dot(point.surface.wo);
        let light_density = light_density(emission, cosine, distance, self.density_per_luminance);
        emission * lobe_share(lobe_density, light_density)
    }

    /// A direction drawn from the triangles that emit or from the environment; true for the latter, whose radiance is
    /// looked up once it is known to arrive.
    fn draw_light(&self, point: &SurfacePoint<T>, xi: Vec3<T>) -> (LightSample<T>, bool) {
        let share = self.environment_probability;
        if self.samples_emitters && !(self.samples_environment && xi.z.less(share).any()) {
            let xi = vec3(xi.x, xi.y, (xi.z - share) / (T::one() - share));
            let (materials, density) = (&self.materials, self.density_per_luminance);
            let (lights, place) = (self.lights, point.position);
            let sample = light_sample(self.geometry, materials, lights, density, place, point.error, xi);
            return (sample, false);
        }
        let (local, density) = environment_sample(self.environment, vec3(xi.x, xi.y, xi.z / share));
        let sample = LightSample {
            direction: environment_world_from_local(local, self.rotation),
            density: density * share,
            distance: T::from_f64(f64::from(f32::MAX)),
            radiance: Vec3::zero(),
        };
        (sample, true)
    }

    /// Light that arrives straight from the environment or from what emits, one direction drawn.
    fn direct_light(&self, point: &SurfacePoint<T>, state: RandomState, dimension: u32, rays: &mut u32) -> Vec3<T> {
        let [a, b] = random_pair(state, dimension);
        let [c, _] = random_pair(state, dimension + 1);
        let (light, is_far) = self.draw_light(point, vec3(a, b, c));
        let (wi, density) = (light.direction, light.density);
        let material = &self.materials[point.slot as usize];
        let is_behind = point.surface.normal.dot(wi).to_f64() <= 0.0;
        if density.to_f64() <= 0.0 || (is_behind && !material.transmits()) {
            return Vec3::zero();
        }
        let competing = T::from_f64(if self.settings.strategy == Strategy::Mis {
            1.0
        } else {
            0.0
        });
        let value = material_evaluate(material, self.tables, &point.surface, wi, density, competing);
        if value.max_component().to_f64() <= 0.0 {
            return Vec3::zero();
        }
        *rays += 1;
        let origin = point.ray_origin(wi, material.transmits());
        let distance = light.distance.to_f64() as f32;
        if self.geometry.occluded(origin.to_f32(), wi.to_f32(), distance) {
            return Vec3::zero();
        }
        let radiance = if is_far { self.far_radiance(wi) } else { light.radiance };
        value * radiance / density
    }

    /// What a contribution that was reflected so many times adds; `taken` grows by the luminance that is beyond the limit.
    #[inline(always)]
    fn limited(&self, contribution: Vec3<T>, reflections: u32, taken: &mut T) -> Vec3<T> {
        let Some(limit) = self.firefly_clamp.filter(|_| reflections > 1) else {
            return contribution;
        };
        let kept = limit / contribution.max_component().max(limit);
        *taken += contribution.luminance() * (T::one() - kept);
        contribution * kept
    }

    fn camera_background(&self, direction: Vec3<T>, rays: u32) -> PathResult<T> {
        let (radiance, alpha) = match self.settings.background {
            BackgroundKind::Environment => (self.far_radiance(direction), T::one()),
            BackgroundKind::Transparent => (Vec3::zero(), T::zero()),
            BackgroundKind::Color(color) => (Vec3::from_f32(color), T::one()),
        };
        PathResult {
            radiance,
            alpha,
            rays,
            clamped: T::zero(),
        }
    }

    /// One path through a pixel.
    pub fn trace_path(&self, pixel: [u32; 2], sample: u32) -> PathResult<T> {
        let settings = self.settings;
        let state = random_state(pixel[0], pixel[1], settings.seed, sample, settings.sequence);
        let offset: [T; 2] = filter_offset(self.camera.filter_kind, random_pair(state, 0));
        let half = T::from_f64(0.5);
        let place = [0, 1].map(|i| T::from_f64(f64::from(pixel[i])) + half + offset[i]);
        let [mut origin, mut direction] = camera_ray(&self.camera, place, settings.image_size, random_pair(state, 1));
        let samples_light = self.samples_environment || self.samples_emitters;
        let mut throughput = Vec3::splat(T::one());
        let mut radiance = Vec3::zero();
        let mut clamped = T::zero();
        let mut lobe_density = T::zero();
        let mut was_mirror = true;
        let mut rays = 0;
        for bounce in 0.. {
            rays += 1;
            let Some(hit) = self.geometry.intersect(origin.to_f32(), direction.to_f32(), f32::MAX) else {
                if bounce == 0 {
                    return self.camera_background(direction, rays);
                }
                let found = throughput * self.far_light(direction, lobe_density, was_mirror);
                radiance += self.limited(found, bounce, &mut clamped);
                break;
            };
            let point = self.surface(&hit, direction);
            let material = &self.materials[point.slot as usize];
            let distance = T::from_f64(f64::from(hit.t));
            if point.surface.is_inside && material.transmits() {
                throughput = throughput * material.absorption.map(|absorption| (-absorption * distance).exp());
            }
            let found = throughput * self.emitted_light(&point, distance, lobe_density, was_mirror);
            radiance += self.limited(found, bounce, &mut clamped);
            if bounce >= settings.bounces {
                break;
            }
            let dimension = FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS;
            if samples_light {
                let found = throughput * self.direct_light(&point, state, dimension + 2, &mut rays);
                radiance += self.limited(found, bounce + 1, &mut clamped);
            }
            let [a, b] = random_pair(state, dimension);
            let [c, layer] = random_pair(state, dimension + 1);
            let mut numbers = MaterialNumbers {
                lobe: [a, b, c],
                layer,
                below: [a, b, c],
            };
            if material.transmits() {
                let [a, b] = random_pair(state, BELOW_DIMENSION + 2 * bounce);
                let [c, _] = random_pair(state, BELOW_DIMENSION + 2 * bounce + 1);
                numbers.below = [a, b, c];
            }
            let wants_density = samples_light && settings.strategy == Strategy::Mis;
            let drawn = material_sample(material, self.tables, &point.surface, numbers, wants_density);
            throughput = throughput * drawn.throughput;
            let strength = throughput.max_component();
            // Also ends paths that are NaN.
            if strength.to_f64().partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
                break;
            }
            if bounce >= ROULETTE_START && strength.to_f64() < 1.0 {
                let [_, survival]: [T; 2] = random_pair(state, dimension + 3);
                if survival.to_f64() >= strength.to_f64() {
                    break;
                }
                throughput = throughput / strength;
            }
            lobe_density = drawn.density;
            was_mirror = drawn.is_mirror;
            (origin, direction) = (point.ray_origin(drawn.wi, material.transmits()), drawn.wi);
        }
        PathResult {
            radiance,
            alpha: T::one(),
            rays,
            clamped,
        }
    }

    fn surface(&self, hit: &Hit, direction: Vec3<T>) -> SurfacePoint<T> {
        surface_at(self.geometry, &self.materials, hit, direction)
    }
}

/// The share of the lobe under the balance heuristic (Veach 1997) where it met light by itself.
fn lobe_share<T: Real>(lobe_density: T, light_density: T) -> T {
    lobe_density / (lobe_density + light_density).max(T::from_f64(1e-30))
}

/// Finite and not negative: what may be added to the picture.
pub fn is_sound<T: Real>(color: Vec3<T>) -> bool {
    color.to_f64().iter().all(|x| (0.0..=RADIANCE_MAX).contains(x))
}
