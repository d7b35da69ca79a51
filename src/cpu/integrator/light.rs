//! Light on a path: what it meets by itself, and what is drawn towards.

use super::path::{Path, Ray};
use super::{FIRST_DIMENSION, Integrator};
use crate::cpu::recorder::{Event, Purpose, Recorder, Source, single};
use crate::job::{BackgroundKind, Strategy};
use crate::optics::frame::{frame_from_normal, world_from_local};
use crate::optics::material::{Material, material_evaluate};
use crate::optics::real::{Mask, Real};
use crate::optics::vector::{Vec3, vec3};
use crate::optics::warp::uniform_disc;
use crate::scene::environment::{
    environment_density, environment_local_from_world, environment_radiance, environment_sample,
    environment_world_from_local,
};
use crate::scene::light::{Emitters, LightSample, light_density, light_sample};
use crate::scene::surface::SurfacePoint;

impl<T: Real> Integrator<'_, T> {
    /// Radiance of the environment in a world direction.
    fn far_radiance(&self, direction: Vec3<T>) -> Vec3<T> {
        let local = environment_local_from_world(direction, self.rotation);
        environment_radiance(self.environment, local) * T::from_f64(self.settings.environment_strength)
    }

    /// What a path that left the scene sees, weighed against light sampling.
    pub(super) fn far_light<R: Recorder>(&self, ray: &Ray<T>, path: &mut Path<'_, T, R>) -> Vec3<T> {
        let radiance = self.far_radiance(ray.direction);
        let light_density = || {
            let local = environment_local_from_world(ray.direction, self.rotation);
            self.environment_probability * environment_density(self.environment, local)
        };
        self.weighed(Source::Environment, radiance, ray, light_density, path)
    }

    /// What a surface emits that a path met at `distance`, weighed against light sampling.
    pub(super) fn emitted_light<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        distance: T,
        ray: &Ray<T>,
        path: &mut Path<'_, T, R>,
    ) -> Vec3<T> {
        let density = || {
            let cosine = point.surface.normal.dot(point.surface.wo);
            light_density(material.light_luminance, cosine, distance, self.density_per_luminance)
        };
        self.weighed(Source::Surface, material.emission, ray, density, path)
    }

    /// The share of light that the ray has where it met it by itself: all of it where light sampling does not draw from
    /// this source or could not have drawn this direction.
    #[inline(always)]
    fn weighed<R: Recorder>(
        &self,
        source: Source,
        radiance: Vec3<T>,
        ray: &Ray<T>,
        light_density: impl FnOnce() -> T,
        path: &mut Path<'_, T, R>,
    ) -> Vec3<T> {
        let is_sampled = match source {
            Source::Surface => self.samples_emitters,
            _ => self.samples_environment,
        };
        let mut density = T::zero();
        let mut weight = T::one();
        let mut found = radiance;
        if is_sampled && !ray.is_mirror {
            if self.settings.strategy == Strategy::Light {
                weight = T::zero();
                found = Vec3::zero();
            } else {
                density = light_density();
                weight = lobe_share(ray.lobe_density, density);
                found = radiance * weight;
            }
        }
        if radiance.to_f64() != [0.0; 3] {
            path.record(|| Event::Found {
                source,
                radiance: radiance.to_f32(),
                lobe_density: single(ray.lobe_density),
                light_density: single(density),
                weight: single(weight),
            });
        }
        found
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

    /// Light that arrives straight from the environment or from what emits, one direction drawn, and where it is from.
    pub(super) fn direct_light<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        dimension: u32,
        path: &mut Path<'_, T, R>,
    ) -> (Vec3<T>, Source) {
        let [a, b] = path.pair(dimension, [Purpose::Light; 2]);
        let [c, _] = path.pair(dimension + 1, [Purpose::Light, Purpose::Unused]);
        let (light, is_far) = self.draw_light(point, vec3(a, b, c));
        let (wi, density) = (light.direction, light.density);
        let source = if is_far { Source::Environment } else { Source::Surface };
        let evaluate = |competing| material_evaluate(material, self.tables, &point.surface, wi, density, competing);
        let told = |value: Vec3<T>, visible: T, radiance: Vec3<T>| {
            let whole = if density.to_f64() > 0.0 {
                evaluate(T::zero())
            } else {
                value
            }
            .to_f32();
            let kept = value.to_f32();
            Event::Light {
                source,
                direction: wi.to_f32(),
                density: single(density),
                value: whole,
                weight: [0, 1, 2].map(|i| if kept[i] > 0.0 { kept[i] / whole[i] } else { 0.0 }),
                visible: single(visible),
                radiance: radiance.to_f32(),
            }
        };
        let dark = Vec3::zero();
        let is_behind = point.surface.normal.dot(wi).to_f64() <= 0.0;
        if density.to_f64() <= 0.0 || (is_behind && !material.transmits()) {
            path.record(|| told(dark, T::zero(), dark));
            return (dark, source);
        }
        let is_weighed = self.settings.strategy == Strategy::Mis;
        let value = evaluate(if is_weighed { T::one() } else { T::zero() });
        if value.max_component().to_f64() <= 0.0 {
            path.record(|| told(dark, T::zero(), dark));
            return (dark, source);
        }
        let mut visible = T::one();
        if !self.meets_nothing(point, wi) {
            let origin = point.ray_origin(wi, material.transmits());
            visible = self.transmittance(origin, wi, light.distance, &mut path.rays);
        }
        if visible.to_f64() <= 0.0 {
            path.record(|| told(value, visible, dark));
            return (dark, source);
        }
        let radiance = if is_far { self.far_radiance(wi) } else { light.radiance };
        path.record(|| told(value, visible, radiance));
        (value * radiance * (visible / density), source)
    }

    /// What the camera sees where it meets nothing, and its alpha.
    pub(super) fn camera_background<R: Recorder>(&self, direction: Vec3<T>, path: &mut Path<'_, T, R>) -> (Vec3<T>, T) {
        match self.settings.background {
            BackgroundKind::Environment => (self.far_radiance(direction), T::one()),
            BackgroundKind::Blurred(sine) => {
                // The numbers of the first bounce, which there is none of.
                let disc: [T; 2] = uniform_disc(path.pair(FIRST_DIMENSION, [Purpose::Blur; 2]));
                let disc = disc.map(|x| x * T::from_f64(sine));
                let height = (T::one() - disc[0] * disc[0] - disc[1] * disc[1]).safe_sqrt();
                let around = frame_from_normal(direction);
                let blurred = world_from_local(&around, vec3(disc[0], disc[1], height));
                (self.far_radiance(blurred), T::one())
            }
            BackgroundKind::Transparent => (Vec3::zero(), T::zero()),
            BackgroundKind::Color(color) => (Vec3::from_f32(color), T::one()),
        }
    }
}

/// The share of the lobe under the balance heuristic (Veach 1997) where it met light by itself.
fn lobe_share<T: Real>(lobe_density: T, light_density: T) -> T {
    lobe_density / (lobe_density + light_density).max(T::from_f64(1e-30))
}
