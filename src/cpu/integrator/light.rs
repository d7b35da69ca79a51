//! Light on a path: what it meets by itself, and what is drawn towards.

use super::group::Group;
use super::paths::{Paths, Vectors, take};
use super::{Arrival, BOUNCE_DIMENSIONS, FIRST_DIMENSION, Integrator};
use crate::cpu::recorder::{Event, Purpose, Recorder, Source, single};
use crate::job::{BackgroundKind, Strategy};
use crate::optics::frame::{frame_from_normal, world_from_local};
use crate::optics::layer::{Layers, material_evaluate};
use crate::optics::material::Material;
use crate::optics::real::{Mask, Real, Scalar};
use crate::optics::vector::{Vec3, vec3};
use crate::optics::warp::{split, uniform_disc};
use crate::scene::environment::{
    drawn_rows, environment_density_at, environment_local_from_world, environment_radiance_at, environment_uv,
    environment_world_from_local, fetch_cell, fetch_chosen, fetch_guide, fetch_place, sample_in_rows,
};
use crate::scene::light::{Emitters, LightSample, is_spot, light_density, light_sample, spot_share};
use crate::scene::surface::SurfacePoint;

impl<T: Real> Integrator<'_, T> {
    /// Where world directions lie in the environment's map.
    #[inline(always)]
    fn far_places(&self, direction: Vec3<T>) -> [T; 2] {
        environment_uv(environment_local_from_world(direction, self.rotation))
    }

    /// Radiance of the environment at a place in its map.
    #[inline(always)]
    fn far_radiance(&self, place: [T; 2]) -> Vec3<T> {
        environment_radiance_at(self.environment, place) * T::from_f64(self.settings.environment_strength)
    }

    /// What paths that left the scene see at a place in the environment's map, weighed against light sampling.
    #[inline(always)]
    pub(super) fn far_light<R: Recorder>(
        &self,
        ray: &Arrival<T>,
        place: [T; 2],
        paths: &mut Paths<T::Scalar, R>,
    ) -> Vec3<T> {
        let radiance = self.far_radiance(place);
        let mut density = T::zero();
        if self.samples_environment {
            density = self.environment_probability * environment_density_at(self.distribution, place);
        }
        self.weighed(Source::Environment, radiance, density, ray, paths)
    }

    /// Where what rays that met nothing see lies in the environment's map; 0 where they do not see the map as it is.
    #[inline(always)]
    pub(super) fn left_places(&self, direction: Vec3<T>, bounce: u32) -> [T; 2] {
        if bounce > 0 || self.settings.background == BackgroundKind::Environment {
            self.far_places(direction)
        } else {
            [T::zero(); 2]
        }
    }

    /// Finds where paths that met nothing look at the environment's map, and has the processor fetch what they see there.
    #[inline(always)]
    pub(super) fn locate_left<R: Recorder>(&self, group: &Group<T>, bounce: u32, paths: &mut Paths<T::Scalar, R>) {
        let place = self.left_places(group.vector(&paths.state.direction), bounce);
        fetch_place(self.environment, place);
        if bounce > 0 && self.samples_environment {
            fetch_cell(self.distribution, place);
        }
        set_places(group, &mut paths.place, place);
    }

    /// Finds where the environment's lights lie that arrive, and has the processor fetch what shines there.
    #[inline(always)]
    pub(super) fn locate_lights<R: Recorder>(&self, group: &Group<T>, paths: &mut Paths<T::Scalar, R>) {
        let place = self.far_places(group.vector(&paths.arriving.direction));
        fetch_place(self.environment, place);
        set_places(group, &mut paths.arriving.place, place);
    }

    /// Draws the numbers with which directions to lights are drawn, the first of which chooses whether they lead to the
    /// environment; and has the processor fetch what they are looked up in.
    #[inline(always)]
    pub(super) fn light_numbers<R: Recorder>(&self, group: &Group<T>, bounce: u32, paths: &mut Paths<T::Scalar, R>) {
        let dimension = FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS + 2;
        let [mut a, b] = group.pairs(paths, dimension, [Purpose::Light; 2]);
        let [c, _] = group.pairs(paths, dimension + 1, [Purpose::Light, Purpose::Unused]);
        if self.samples_emitters {
            let mut is_far = T::Mask::splat(false);
            if self.samples_environment {
                (is_far, a) = split(a, self.environment_probability);
            }
            group.set_truth(&mut paths.lights.is_far, group.mask(), is_far);
        }
        group.set_vector(&mut paths.light_numbers, group.mask(), vec3(a, b, c));
        if self.samples_environment {
            let rows = drawn_rows(self.distribution, b);
            fetch_guide(self.distribution, &rows, a);
            group.set_each(&mut paths.light_rows, &rows);
        }
    }

    /// Has the processor fetch what drawing with these numbers looks up next.
    #[inline(always)]
    pub(super) fn fetch_lights<R: Recorder>(&self, group: &Group<T>, paths: &Paths<T::Scalar, R>) {
        let numbers = group.own_number(&paths.light_numbers.x);
        fetch_chosen(self.distribution, &group.each(&paths.light_rows), numbers);
    }

    /// What surfaces emit that paths met, weighed against light sampling.
    #[inline(always)]
    pub(super) fn emitted_light<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        arrival: &Arrival<T>,
        paths: &mut Paths<T::Scalar, R>,
    ) -> Vec3<T> {
        let cosine = point.flat_normal().dot(point.surface.wo);
        let mut emission = material.emission;
        if is_spot(material) {
            let facing = T::select(point.surface.is_inside, -cosine, cosine);
            emission = emission * spot_share(material, facing);
        }
        let density = light_density(
            material.light_luminance,
            cosine,
            arrival.distance,
            self.density_per_luminance,
        );
        self.weighed(Source::Surface, emission, density, arrival, paths)
    }

    /// The share of light that rays have where they met it by themselves: all of it where light sampling does not draw from
    /// this source or could not have drawn this direction.
    #[inline(always)]
    fn weighed<R: Recorder>(
        &self,
        source: Source,
        radiance: Vec3<T>,
        light_density: T,
        arrival: &Arrival<T>,
        paths: &mut Paths<T::Scalar, R>,
    ) -> Vec3<T> {
        let is_sampled = match source {
            Source::Surface => self.samples_emitters,
            _ => self.samples_environment,
        };
        let (zero, one) = (T::zero(), T::one());
        let (mut density, mut weight) = (zero, one);
        if is_sampled {
            let is_only_sampled = self.settings.strategy == Strategy::Light;
            let share = lobe_share(arrival.lobe_density, light_density);
            let share = if is_only_sampled { zero } else { share };
            weight = T::select(arrival.is_mirror, one, share);
            density = T::select(
                arrival.is_mirror,
                zero,
                if is_only_sampled { zero } else { light_density },
            );
        }
        if R::KEEPS {
            arrival
                .members
                .record(&mut paths.found, arrival.on & radiance.is_any(), |lane| Event::Found {
                    source,
                    radiance: radiance.to_each().as_ref()[lane].to_f32(),
                    lobe_density: single(arrival.lobe_density.lane(lane)),
                    light_density: single(density.lane(lane)),
                    weight: single(weight.lane(lane)),
                });
        }
        // Also of what is not a number nothing is left where nothing counts.
        Vec3::select(zero.less(weight), radiance * weight, Vec3::zero())
    }

    /// Directions drawn from the triangles that emit or from the environment, whose radiance is looked up once it is known
    /// to arrive.
    #[inline(always)]
    fn draw_lights<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        group: &Group<T>,
        paths: &Paths<T::Scalar, R>,
    ) -> LightSample<T> {
        // Beyond the paths, too, numbers must be of the rows that they draw.
        let numbers = &paths.light_numbers;
        let xi = vec3(
            group.own_number(&numbers.x),
            group.own_number(&numbers.y),
            group.own_number(&numbers.z),
        );
        let is_far = self.are_far(group, &paths.lights);
        let (far, near) = (group.mask() & is_far, group.mask() & !is_far);
        let mut drawn = LightSample {
            direction: Vec3::zero(),
            density: T::zero(),
            distance: T::from_f64(f64::from(f32::MAX)),
            radiance: Vec3::zero(),
        };
        if far.any() {
            let rows = group.each(&paths.light_rows);
            let (local, density) = sample_in_rows(self.distribution, &rows, xi);
            drawn.direction = environment_world_from_local(local, self.rotation);
            drawn.density = density * self.environment_probability;
        }
        if !near.any() {
            return drawn;
        }
        let emitted = self.draw_emitters(point, xi);
        LightSample {
            direction: Vec3::select(near, emitted.direction, drawn.direction),
            density: T::select(near, emitted.density, drawn.density),
            distance: T::select(near, emitted.distance, drawn.distance),
            radiance: Vec3::select(near, emitted.radiance, drawn.radiance),
        }
    }

    /// True where lights are drawn from the environment; beyond the paths whatever was there.
    #[inline(always)]
    fn are_far(&self, group: &Group<T>, lights: &LightRays<T::Scalar>) -> T::Mask {
        if self.samples_emitters {
            group.truth(&lights.is_far)
        } else {
            T::Mask::splat(true)
        }
    }

    /// Directions drawn from the triangles that emit, one lane after the other.
    #[inline(always)]
    fn draw_emitters(&self, point: &SurfacePoint<T>, xi: Vec3<T>) -> LightSample<T> {
        let emitters = Emitters {
            geometry: self.geometry,
            materials: &self.of_lane,
            textures: self.textures,
            lights: self.lights,
            density_per_luminance: self.density_per_luminance.lane(0),
        };
        let (positions, errors, numbers) = (point.position.to_each(), point.error.to_each(), xi.to_each());
        let samples = T::each(|lane| {
            let number = numbers.as_ref()[lane];
            light_sample(&emitters, positions.as_ref()[lane], errors.as_ref()[lane], number)
        });
        let samples = samples.as_ref();
        LightSample {
            direction: Vec3::from_lanes(|lane| samples[lane].direction),
            density: T::from_lanes(|lane| samples[lane].density),
            distance: T::from_lanes(|lane| samples[lane].distance),
            radiance: Vec3::from_lanes(|lane| samples[lane].radiance),
        }
    }

    /// Aims paths at lights: one direction each, drawn towards the environment or what emits, unless nothing can come from
    /// there. What the material reflects or refracts of it is returned without the weight, where it is told.
    #[inline(always)]
    pub(super) fn aim<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        layers: &Layers<T>,
        arrival: &Arrival<T>,
        paths: &mut Paths<T::Scalar, R>,
    ) -> Vec3<T> {
        let (group, zero) = (arrival.group, T::zero());
        let drawn = self.draw_lights(point, &group, paths);
        let wi = drawn.direction;
        let transmits = material.transmits();
        let is_ahead = zero.less(point.surface.normal.dot(wi)) | transmits;
        let reaches = arrival.on & zero.less(drawn.density) & is_ahead;
        let competing = match self.settings.strategy {
            Strategy::Mis => T::one(),
            _ => zero,
        };
        let (tables, surface, density) = (self.tables, &point.surface, drawn.density);
        let evaluate = |competing| material_evaluate(material, tables, surface, layers, wi, density, competing);
        let mut value = Vec3::zero();
        if reaches.any() {
            value = Vec3::select(reaches, evaluate(competing), value);
        }
        let mut whole = Vec3::zero();
        if R::KEEPS {
            whole = Vec3::select(zero.less(drawn.density), evaluate(zero), whole);
        }
        let mut radiance = drawn.radiance;
        if self.samples_emitters {
            radiance = self.kept_from(point, material, [wi, radiance], drawn.distance, arrival, paths);
        }
        let largest = value.max_component();
        let is_lit = arrival.on & (zero.less(largest) | largest.is_nan());
        let all = group.mask();
        let lights = &mut paths.lights;
        group.set_vector(&mut lights.direction, all, wi);
        group.set_number(&mut lights.density, all, drawn.density);
        group.set_number(&mut lights.distance, all, drawn.distance);
        group.set_vector(&mut lights.origin, all, point.ray_origin(wi, transmits));
        group.set_vector(&mut lights.value, all, value);
        group.set_vector(&mut lights.throughput, all, arrival.throughput);
        group.set_number(&mut lights.visible, all, T::one());
        group.set_truth(&mut lights.meets_nothing, all, self.meets_nothing(point, wi));
        group.set_truth(&mut lights.is_aimed, all, is_lit);
        if self.samples_emitters {
            group.set_vector(&mut lights.radiance, all, radiance);
        }
        if R::KEEPS {
            let light = paths.lights.get(0);
            arrival.members.record(&mut paths.found, arrival.on & !is_lit, |lane| {
                light.told(whole.to_each().as_ref()[lane], T::Scalar::zero(), Vec3::zero())
            });
        }
        whole
    }

    /// The share of the light that a path is aimed at that is not stopped on its way.
    #[inline(always)]
    pub(super) fn visible(&self, light: &LightRay<T::Scalar>, rays: &mut u32) -> T::Scalar {
        if light.meets_nothing {
            return T::Scalar::one();
        }
        self.transmittance(light.origin, light.direction, light.distance, rays)
    }

    /// Adds the light that arrives; `whole` is what [`Integrator::aim`] told of a path that is recorded.
    #[inline(always)]
    pub(super) fn arrive<R: Recorder>(
        &self,
        group: &Group<T>,
        bounce: u32,
        whole: Vec3<T>,
        paths: &mut Paths<T::Scalar, R>,
    ) {
        let lights = &paths.arriving;
        let members = group.members(&lights.ids);
        let is_far = self.are_far(group, lights);
        let mut radiance = Vec3::zero();
        if is_far.any() {
            radiance = self.far_radiance([group.number(&lights.place[0]), group.number(&lights.place[1])]);
        }
        if !is_far.all() {
            radiance = Vec3::select(is_far, radiance, group.vector(&lights.radiance));
        }
        let share = group.number(&lights.visible) / group.number(&lights.density);
        let light = group.vector(&lights.throughput) * (group.vector(&lights.value) * radiance * share);
        if R::KEEPS {
            let ray = lights.get(0);
            members.record(&mut paths.found, group.mask(), |lane| {
                let (whole, radiance) = (whole.to_each().as_ref()[lane], radiance.to_each().as_ref()[lane]);
                ray.told(whole, ray.visible, radiance)
            });
        }
        // Each path has one light; accounts tell which kind it was.
        let (near, far) = (group.mask() & !is_far, group.mask() & is_far);
        if near.any() {
            self.add(&members, near, Source::Surface, light, bounce + 1, &mut paths.found);
        }
        self.add(&members, far, Source::Environment, light, bounce + 1, &mut paths.found);
    }

    /// What the camera sees where it meets nothing, and its alpha; a blur is drawn with the pair of this dimension.
    #[inline(always)]
    pub(super) fn camera_background<R: Recorder>(
        &self,
        group: &Group<T>,
        direction: Vec3<T>,
        place: [T; 2],
        dimension: u32,
        paths: &mut Paths<T::Scalar, R>,
    ) -> (Vec3<T>, T) {
        let BackgroundKind::Blurred(sine) = self.settings.background else {
            return self.plain_background(place);
        };
        let [x, y] = uniform_disc(group.pairs(paths, dimension, [Purpose::Blur; 2]));
        let (x, y) = (x * T::from_f64(sine), y * T::from_f64(sine));
        let height = (T::one() - x * x - y * y).safe_sqrt();
        let around = frame_from_normal(direction);
        let blurred = world_from_local(&around, vec3(x, y, height));
        (self.far_radiance(self.far_places(blurred)), T::one())
    }

    /// What the camera sees where it meets nothing and nothing is blurred, and its alpha.
    #[inline(always)]
    pub(super) fn plain_background(&self, place: [T; 2]) -> (Vec3<T>, T) {
        match self.settings.background {
            BackgroundKind::Environment | BackgroundKind::Blurred(_) => (self.far_radiance(place), T::one()),
            BackgroundKind::Transparent => (Vec3::zero(), T::zero()),
            BackgroundKind::Color(color) => (Vec3::from_f32(color), T::one()),
        }
    }
}

/// Notes where paths look at the environment's map.
#[inline(always)]
fn set_places<T: Real>(group: &Group<T>, places: &mut [Vec<T::Scalar>; 2], place: [T; 2]) {
    group.set_number(&mut places[0], group.mask(), place[0]);
    group.set_number(&mut places[1], group.mask(), place[1]);
}

/// Rays towards lights, field by field.
pub(super) struct LightRays<S> {
    /// Which paths of the wave they belong to; of those that arrive.
    ids: Vec<u16>,
    /// Where they lie in the environment's map; of those that arrive.
    place: [Vec<S>; 2],
    /// Whether there is one: elsewhere the other fields hold whatever.
    pub is_aimed: Vec<bool>,
    /// See [`LightSample`].
    pub direction: Vectors<S>,
    density: Vec<S>,
    pub distance: Vec<S>,
    /// Of those that are drawn from what emits.
    radiance: Vectors<S>,
    /// True where they are drawn from the environment, whose radiance is looked up once it is known to arrive. Nothing else
    /// is there where no emitters are sampled. Told with the numbers, of all paths that met something.
    is_far: Vec<bool>,
    /// What the material reflects or refracts from there, weighed against sampling the lobe.
    value: Vectors<S>,
    /// Of the path before the surface.
    throughput: Vectors<S>,
    /// Where they start.
    pub origin: Vectors<S>,
    /// True where it is proven that nothing lies ahead.
    pub meets_nothing: Vec<bool>,
    /// The share of the light that is not stopped on its way.
    pub visible: Vec<S>,
}

impl<S: Scalar> LightRays<S> {
    /// Room for as many.
    pub fn new(count: usize) -> Self {
        let numbers = || vec![S::zero(); count];
        Self {
            ids: vec![0; count],
            place: [numbers(), numbers()],
            is_aimed: vec![false; count],
            direction: Vectors::new(count),
            density: numbers(),
            distance: numbers(),
            radiance: Vectors::new(count),
            is_far: vec![true; count],
            value: Vectors::new(count),
            throughput: Vectors::new(count),
            origin: Vectors::new(count),
            meets_nothing: vec![false; count],
            visible: numbers(),
        }
    }

    /// One of them.
    pub fn get(&self, place: usize) -> LightRay<S> {
        LightRay {
            origin: self.origin.get(place),
            direction: self.direction.get(place),
            distance: self.distance[place],
            density: self.density[place],
            value: self.value.get(place),
            is_far: self.is_far[place],
            meets_nothing: self.meets_nothing[place],
            visible: self.visible[place],
        }
    }
}

impl<S: Scalar, R: Recorder> Paths<S, R> {
    /// Puts what is needed of the rays at these places side by side, as they arrive; `may_be_near` where emitters are sampled,
    /// too.
    pub(super) fn take_arriving(&mut self, places: &[u16], may_be_near: bool) {
        let (to, from) = (&mut self.arriving, &self.lights);
        take(&mut to.ids, &self.state.ids, places);
        to.direction.take(&from.direction, places);
        take(&mut to.density, &from.density, places);
        if may_be_near {
            to.radiance.take(&from.radiance, places);
            take(&mut to.is_far, &from.is_far, places);
        }
        to.value.take(&from.value, places);
        to.throughput.take(&from.throughput, places);
        take(&mut to.visible, &from.visible, places);
    }
}

/// A ray towards a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightRay<S> {
    origin: Vec3<S>,
    direction: Vec3<S>,
    distance: S,
    density: S,
    value: Vec3<S>,
    is_far: bool,
    meets_nothing: bool,
    visible: S,
}

impl<S: Scalar> LightRay<S> {
    fn source(&self) -> Source {
        if self.is_far {
            Source::Environment
        } else {
            Source::Surface
        }
    }

    /// The event of this light: `whole` is its value without the weight.
    pub fn told(&self, whole: Vec3<S>, visible: S, radiance: Vec3<S>) -> Event {
        let (whole, kept) = (whole.to_f32(), self.value.to_f32());
        Event::Light {
            source: self.source(),
            direction: self.direction.to_f32(),
            density: single(self.density),
            value: whole,
            weight: [0, 1, 2].map(|i| if kept[i] > 0.0 { kept[i] / whole[i] } else { 0.0 }),
            visible: single(visible),
            radiance: radiance.to_f32(),
        }
    }
}

/// The share of the lobe under the balance heuristic (Veach 1997) where it met light by itself.
#[inline(always)]
fn lobe_share<T: Real>(lobe_density: T, light_density: T) -> T {
    lobe_density / (lobe_density + light_density).max(T::from_f64(1e-30))
}
