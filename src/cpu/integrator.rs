//! The path tracer in Rust: twin of `shaders/pass/path_trace.wgsl`, generic over the precision of the shading.

use crate::job::effect::EffectId;
use crate::job::{BackgroundKind, Job, Settings, Strategy};
use crate::optics::frame::{frame_from_normal, world_from_local};
use crate::optics::material::{Material, MaterialNumbers, material_albedo, material_evaluate, material_sample};
use crate::optics::random::{RandomState, path_state, random_pair};
use crate::optics::real::{Mask, Real};
use crate::optics::vector::{Vec3, vec3};
use crate::optics::warp::uniform_disc;
use crate::scene::camera::{Camera, pixel_ray};
use crate::scene::environment::{
    Environment, environment_density, environment_local_from_world, environment_radiance, environment_sample,
    environment_world_from_local,
};
use crate::scene::light::{Emitters, LightSample, Lights, light_density, light_sample};
use crate::scene::surface::{SurfacePoint, hit_opacity, passed_origin, surface_at};
use crate::scene::texture::{Textures, textured_material};
use crate::scene::{Geometry, Hit};

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

/// What one sample of the camera sees first.
#[derive(Clone, Copy, Debug)]
pub struct FeatureSample<T> {
    /// See [`material_albedo`].
    pub albedo: Vec3<T>,
    /// Shading normal in the world.
    pub normal: Vec3<T>,
    /// Along the camera's axis, in the geometry's units.
    pub depth: T,
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
            firefly_clamp: job
                .plan
                .has(EffectId::FireflyClamp)
                .then(|| T::from_f64(job.settings.firefly_clamp)),
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
    fn emitted_light(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        distance: T,
        lobe_density: T,
        is_mirror: bool,
    ) -> Vec3<T> {
        let emission = material.emission;
        if !self.samples_emitters || is_mirror {
            return emission;
        }
        if self.settings.strategy == Strategy::Light {
            return Vec3::zero();
        }
        let cosine = point.surface.normal.dot(point.surface.wo);
        let light_density = light_density(material.light_luminance, cosine, distance, self.density_per_luminance);
        emission * lobe_share(lobe_density, light_density)
    }

    /// A direction drawn from the triangles that emit or from the environment; true for the latter, whose radiance is
    /// looked up once it is known to arrive.
    fn draw_light(&self, point: &SurfacePoint<T>, xi: Vec3<T>) -> (LightSample<T>, bool) {
        let share = self.environment_probability;
        if self.samples_emitters && !(self.samples_environment && xi.z.less(share).any()) {
            let xi = vec3(xi.x, xi.y, (xi.z - share) / (T::one() - share));
            let emitters = Emitters {
                geometry: self.geometry,
                materials: &self.materials,
                textures: self.textures,
                lights: self.lights,
                density_per_luminance: self.density_per_luminance,
            };
            return (light_sample(&emitters, point.position, point.error, xi), false);
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
    fn direct_light(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        state: RandomState,
        dimension: u32,
        rays: &mut u32,
    ) -> Vec3<T> {
        let [a, b] = random_pair(state, dimension);
        let [c, _] = random_pair(state, dimension + 1);
        let (light, is_far) = self.draw_light(point, vec3(a, b, c));
        let (wi, density) = (light.direction, light.density);
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
        let mut transmittance = T::one();
        if !self.meets_nothing(point, wi) {
            let origin = point.ray_origin(wi, material.transmits());
            transmittance = self.transmittance(origin, wi, light.distance, rays);
        }
        if transmittance.to_f64() <= 0.0 {
            return Vec3::zero();
        }
        let radiance = if is_far { self.far_radiance(wi) } else { light.radiance };
        value * radiance * (transmittance / density)
    }

    /// The share of light that reaches the origin of a ray from so far.
    fn transmittance(&self, mut origin: Vec3<T>, direction: Vec3<T>, distance: T, rays: &mut u32) -> T {
        if !self.has_holes {
            *rays += 1;
            let distance = distance.to_f64() as f32;
            let is_occluded = self.geometry.occluded(origin.to_f32(), direction.to_f32(), distance);
            return if is_occluded { T::zero() } else { T::one() };
        }
        let (mut share, mut left) = (T::one(), distance);
        for _ in 0..PASSES_MAX {
            *rays += 1;
            let far = left.to_f64() as f32;
            let Some(hit) = self.geometry.intersect(origin.to_f32(), direction.to_f32(), far) else {
                return share;
            };
            share = share * (T::one() - hit_opacity(self.geometry, &self.materials, self.textures, &hit));
            if share.to_f64() <= 0.0 {
                break;
            }
            left = left - T::from_f64(f64::from(hit.t));
            origin = passed_origin(self.geometry, &hit, direction);
        }
        T::zero()
    }

    /// The surface that stops a ray, with its distance from the origin; the origin moves on with the ray through
    /// surfaces that do not.
    fn stop(
        &self,
        mut origin: Vec3<T>,
        direction: Vec3<T>,
        state: RandomState,
        bounce: u32,
        rays: &mut u32,
    ) -> Option<(SurfacePoint<T>, T)> {
        let mut xi = T::zero();
        if self.has_holes {
            [xi, _] = random_pair(state, OPACITY_DIMENSION + bounce);
        }
        let mut distance = T::zero();
        for _ in 0..PASSES_MAX {
            *rays += 1;
            let hit = self.geometry.intersect(origin.to_f32(), direction.to_f32(), f32::MAX)?;
            distance += T::from_f64(f64::from(hit.t));
            if !self.has_holes {
                return Some((self.surface(&hit, direction), distance));
            }
            let opacity = hit_opacity(self.geometry, &self.materials, self.textures, &hit);
            if xi.less(opacity).any() {
                return Some((self.surface(&hit, direction), distance));
            }
            // Uniform again, given that the surface did not stop the ray.
            xi = (xi - opacity) / (T::one() - opacity).max(T::from_f64(1e-20));
            origin = passed_origin(self.geometry, &hit, direction);
        }
        None
    }

    /// True where it is proven that nothing lies ahead: outside a convex body.
    fn meets_nothing(&self, point: &SurfacePoint<T>, wi: Vec3<T>) -> bool {
        !self.is_interreflecting && !point.surface.is_inside && point.surface.normal.dot(wi).to_f64() > 0.0
    }

    /// What a contribution that was reflected so many times adds; `taken` grows by the luminance that is beyond the limit.
    #[inline(always)]
    fn limited(&self, contribution: Vec3<T>, reflections: u32, taken: &mut T) -> Vec3<T> {
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

    fn camera_background(&self, direction: Vec3<T>, state: RandomState, rays: u32) -> PathResult<T> {
        let (radiance, alpha) = match self.settings.background {
            BackgroundKind::Environment => (self.far_radiance(direction), T::one()),
            BackgroundKind::Blurred(sine) => {
                // The numbers of the first bounce, which there is none of.
                let disc: [T; 2] = uniform_disc(random_pair(state, FIRST_DIMENSION));
                let disc = disc.map(|x| x * T::from_f64(sine));
                let height = (T::one() - disc[0] * disc[0] - disc[1] * disc[1]).safe_sqrt();
                let around = frame_from_normal(direction);
                let blurred = world_from_local(&around, vec3(disc[0], disc[1], height));
                (self.far_radiance(blurred), T::one())
            }
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
        let state = path_state(pixel[0], pixel[1], settings.seed, sample, settings.sequence);
        let [mut origin, mut direction] = pixel_ray(&self.camera, pixel, settings.image_size, state);
        let samples_light = self.samples_environment || self.samples_emitters;
        let mut throughput = Vec3::splat(T::one());
        let mut radiance = Vec3::zero();
        let mut clamped = T::zero();
        let mut lobe_density = T::zero();
        let mut was_mirror = true;
        let mut rays = 0;
        let mut leaves = false;
        for bounce in 0.. {
            let mut met = None;
            if !leaves {
                met = self.stop(origin, direction, state, bounce, &mut rays);
            }
            let Some((point, distance)) = met else {
                if bounce == 0 {
                    return self.camera_background(direction, state, rays);
                }
                let found = throughput * self.far_light(direction, lobe_density, was_mirror);
                radiance += self.limited(found, bounce, &mut clamped);
                break;
            };
            let plain = &self.materials[point.slot as usize];
            let textured;
            let material = if plain.is_textured() {
                textured = textured_material(self.textures, self.tables, plain, point.uvs, point.vertex_color);
                &textured
            } else {
                plain
            };
            if point.surface.is_inside && material.transmits() {
                throughput = throughput * material.absorption.map(|absorption| (-absorption * distance).exp());
            }
            let found = throughput * self.emitted_light(&point, material, distance, lobe_density, was_mirror);
            radiance += self.limited(found, bounce, &mut clamped);
            if bounce >= settings.bounces {
                break;
            }
            let dimension = FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS;
            if samples_light {
                let found = throughput * self.direct_light(&point, material, state, dimension + 2, &mut rays);
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
            leaves = self.meets_nothing(&point, drawn.wi);
            (origin, direction) = (point.ray_origin(drawn.wi, material.transmits()), drawn.wi);
        }
        PathResult {
            radiance,
            alpha: T::one(),
            rays,
            clamped,
        }
    }

    /// What the camera sees first through a pixel, with the same ray as [`Integrator::trace_path`]; `None` where it meets
    /// nothing.
    pub fn trace_features(&self, pixel: [u32; 2], sample: u32) -> Option<FeatureSample<T>> {
        let settings = self.settings;
        let state = path_state(pixel[0], pixel[1], settings.seed, sample, settings.sequence);
        let [origin, direction] = pixel_ray(&self.camera, pixel, settings.image_size, state);
        let (point, distance) = self.stop(origin, direction, state, 0, &mut 0)?;
        let plain = &self.materials[point.slot as usize];
        let material = textured_material(self.textures, self.tables, plain, point.uvs, point.vertex_color);
        Some(FeatureSample {
            albedo: material_albedo(&material, self.tables, &point.surface),
            normal: point.surface.frame.normal,
            depth: distance * direction.dot(self.camera.forward),
        })
    }

    fn surface(&self, hit: &Hit, direction: Vec3<T>) -> SurfacePoint<T> {
        surface_at(self.geometry, &self.materials, self.textures, hit, direction)
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
