//! Light on a path: what it meets by itself, and what is drawn towards.

use super::path::{Path, Ray};
use super::{BOUNCE_DIMENSIONS, FIRST_DIMENSION, Integrator};
use crate::cpu::recorder::{Event, Purpose, Recorder, Source, single};
use crate::job::{BackgroundKind, Strategy};
use crate::optics::frame::{frame_from_normal, world_from_local};
use crate::optics::material::{Material, material_evaluate};
use crate::optics::real::{Mask, Real};
use crate::optics::vector::{Vec3, vec3};
use crate::optics::warp::uniform_disc;
use crate::scene::environment::{
    environment_density_at, environment_local_from_world, environment_radiance_at, environment_sample, environment_uv,
    environment_world_from_local, fetch_cell, fetch_chosen, fetch_place,
};
use crate::scene::light::{Emitters, LightSample, is_spot, light_density, light_sample, spot_share};
use crate::scene::surface::SurfacePoint;

impl<T: Real> Integrator<'_, T> {
    /// Where a world direction lies in the environment's map.
    #[inline(always)]
    pub(super) fn far_place(&self, direction: Vec3<T>) -> [T; 2] {
        environment_uv(environment_local_from_world(direction, self.rotation))
    }

    /// Radiance of the environment at a place in its map.
    #[inline(always)]
    fn far_radiance(&self, place: [T; 2]) -> Vec3<T> {
        environment_radiance_at(self.environment, place) * T::from_f64(self.settings.environment_strength)
    }

    /// What a path that left the scene sees at a place in the environment's map, weighed against light sampling.
    pub(super) fn far_light<R: Recorder>(&self, ray: &Ray<T>, place: [T; 2], path: &mut Path<'_, T, R>) -> Vec3<T> {
        let radiance = self.far_radiance(place);
        let light_density = || self.environment_probability * environment_density_at(self.environment, place);
        self.weighed(Source::Environment, radiance, ray, light_density, path)
    }

    /// Where what a ray that met nothing sees lies in the environment's map; 0 where it does not see the map as it is.
    #[inline(always)]
    pub(super) fn left_place(&self, ray: &Ray<T>, bounce: u32) -> [T; 2] {
        if bounce > 0 || self.settings.background == BackgroundKind::Environment {
            self.far_place(ray.direction)
        } else {
            [T::zero(); 2]
        }
    }

    /// Has the processor fetch what is looked up at a place in the environment's map, the density too where one is.
    #[inline(always)]
    pub(super) fn fetch_far(&self, place: [T; 2], with_density: bool) {
        fetch_place(self.environment, place, with_density && self.samples_environment);
    }

    /// The numbers with which a direction to a light is drawn.
    #[inline(always)]
    pub(super) fn light_numbers<R: Recorder>(&self, bounce: u32, path: &mut Path<'_, T, R>) -> Vec3<T> {
        if !self.samples_light() || path.caught.is_mirrored() {
            return Vec3::zero();
        }
        let dimension = FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS + 2;
        let [a, b] = path.pair(dimension, [Purpose::Light; 2]);
        let [c, _] = path.pair(dimension + 1, [Purpose::Light, Purpose::Unused]);
        vec3(a, b, c)
    }

    /// Has the processor fetch what drawing with these numbers looks up first, or once that is there, what it looks up then.
    #[inline(always)]
    pub(super) fn fetch_light(&self, numbers: Vec3<T>, is_first_there: bool) {
        // Where there are emitters, too, the last number chooses between them and the environment first.
        let numbers = vec3(numbers.x, numbers.y, numbers.z / self.environment_probability);
        if self.samples_environment && is_first_there {
            fetch_chosen(self.environment, numbers);
        } else if self.samples_environment {
            fetch_cell(self.environment, [numbers.x, numbers.y]);
        }
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
        let cosine = point.surface.normal.dot(point.surface.wo);
        let mut emission = material.emission;
        if is_spot(material) {
            let facing = if point.surface.is_inside { -cosine } else { cosine };
            emission = emission * spot_share(material, facing);
        }
        let density = || light_density(material.light_luminance, cosine, distance, self.density_per_luminance);
        self.weighed(Source::Surface, emission, ray, density, path)
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

    /// One direction drawn towards the environment or what emits; `None` where nothing can come from there.
    #[inline(always)]
    pub(super) fn aim<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        numbers: Vec3<T>,
        path: &mut Path<'_, T, R>,
    ) -> Option<LightRay<T>> {
        if !self.samples_light() || path.caught.is_mirrored() {
            return None;
        }
        let (drawn, is_far) = self.draw_light(point, numbers);
        let wi = drawn.direction;
        let is_behind = point.surface.normal.dot(wi).to_f64() <= 0.0;
        let mut light = LightRay {
            drawn,
            is_far,
            value: Vec3::zero(),
            throughput: path.throughput,
            origin: point.position,
            meets_nothing: true,
        };
        if light.drawn.density.to_f64() > 0.0 && (!is_behind || material.transmits()) {
            let competing = match self.settings.strategy {
                Strategy::Mis => T::one(),
                _ => T::zero(),
            };
            let density = light.drawn.density;
            light.value = material_evaluate(material, self.tables, &point.surface, wi, density, competing);
        }
        if light.value.max_component().to_f64() <= 0.0 {
            path.record(|| light.told(self.unweighed(point, material, &light), T::zero(), Vec3::zero()));
            return None;
        }
        light.meets_nothing = self.meets_nothing(point, wi);
        light.origin = point.ray_origin(wi, material.transmits());
        Some(light)
    }

    /// What the material reflects or refracts of a direction that was drawn, without the weight.
    pub(super) fn unweighed(&self, point: &SurfacePoint<T>, material: &Material<T>, light: &LightRay<T>) -> Vec3<T> {
        let LightSample { direction, density, .. } = light.drawn;
        if density.to_f64() > 0.0 {
            material_evaluate(material, self.tables, &point.surface, direction, density, T::zero())
        } else {
            Vec3::zero()
        }
    }

    /// The share of the light that is not stopped on its way.
    #[inline(always)]
    pub(super) fn visible(&self, light: &LightRay<T>, rays: &mut u32) -> T {
        if light.meets_nothing {
            return T::one();
        }
        self.transmittance(light.origin, light.drawn.direction, light.drawn.distance, rays)
    }

    /// Where a light that was drawn lies in the environment's map; 0 where it is not there.
    #[inline(always)]
    pub(super) fn light_place(&self, light: &LightRay<T>) -> [T; 2] {
        if light.is_far {
            self.far_place(light.drawn.direction)
        } else {
            [T::zero(); 2]
        }
    }

    /// Adds what arrives from a light, at this place in the environment's map, of which this share is visible; `unweighed` is called for only where it is told.
    #[inline(always)]
    pub(super) fn arrive<R: Recorder>(
        &self,
        light: &LightRay<T>,
        (visible, place): (T, [T; 2]),
        bounce: u32,
        path: &mut Path<'_, T, R>,
        unweighed: impl FnOnce() -> Vec3<T>,
    ) {
        if visible.to_f64() <= 0.0 {
            path.record(|| light.told(unweighed(), visible, Vec3::zero()));
            return;
        }
        let radiance = if light.is_far {
            self.far_radiance(place)
        } else {
            light.drawn.radiance
        };
        path.record(|| light.told(unweighed(), visible, radiance));
        let found = light.throughput * (light.value * radiance * (visible / light.drawn.density));
        self.add(light.source(), found, bounce + 1, path);
    }

    /// What the camera sees where it meets nothing, and its alpha; a blur is drawn with the pair of this dimension.
    pub(super) fn camera_background<R: Recorder>(
        &self,
        direction: Vec3<T>,
        place: [T; 2],
        dimension: u32,
        path: &mut Path<'_, T, R>,
    ) -> (Vec3<T>, T) {
        match self.settings.background {
            BackgroundKind::Environment => (self.far_radiance(place), T::one()),
            BackgroundKind::Blurred(sine) => {
                let disc: [T; 2] = uniform_disc(path.pair(dimension, [Purpose::Blur; 2]));
                let disc = disc.map(|x| x * T::from_f64(sine));
                let height = (T::one() - disc[0] * disc[0] - disc[1] * disc[1]).safe_sqrt();
                let around = frame_from_normal(direction);
                let blurred = world_from_local(&around, vec3(disc[0], disc[1], height));
                (self.far_radiance(self.far_place(blurred)), T::one())
            }
            BackgroundKind::Transparent => (Vec3::zero(), T::zero()),
            BackgroundKind::Color(color) => (Vec3::from_f32(color), T::one()),
        }
    }
}

/// A ray towards a light.
pub(super) struct LightRay<T> {
    /// How it was drawn.
    pub drawn: LightSample<T>,
    /// True where it was drawn from the environment, whose radiance is looked up once it is known to arrive.
    is_far: bool,
    /// What the material reflects or refracts from there, weighed against sampling the lobe.
    value: Vec3<T>,
    /// Of the path before the surface.
    throughput: Vec3<T>,
    /// Where it starts.
    pub origin: Vec3<T>,
    /// True where it is proven that nothing lies ahead.
    pub meets_nothing: bool,
}

impl<T: Real> LightRay<T> {
    fn source(&self) -> Source {
        if self.is_far {
            Source::Environment
        } else {
            Source::Surface
        }
    }

    /// The event of this light: `whole` is its value without the weight.
    fn told(&self, whole: Vec3<T>, visible: T, radiance: Vec3<T>) -> Event {
        let (whole, kept) = (whole.to_f32(), self.value.to_f32());
        Event::Light {
            source: self.source(),
            direction: self.drawn.direction.to_f32(),
            density: single(self.drawn.density),
            value: whole,
            weight: [0, 1, 2].map(|i| if kept[i] > 0.0 { kept[i] / whole[i] } else { 0.0 }),
            visible: single(visible),
            radiance: radiance.to_f32(),
        }
    }
}

/// The share of the lobe under the balance heuristic (Veach 1997) where it met light by itself.
fn lobe_share<T: Real>(lobe_density: T, light_density: T) -> T {
    lobe_density / (lobe_density + light_density).max(T::from_f64(1e-30))
}
