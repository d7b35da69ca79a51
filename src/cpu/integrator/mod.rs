//! The path tracer in Rust: twin of `shaders/pass/path_trace.wgsl`, generic over the numbers that it shades with, of which
//! there may be many in lanes.

mod camera;
mod catcher;
mod group;
mod light;
mod medium;
mod paths;
mod rays;
mod results;
mod scatter;
mod wave;

use std::borrow::Cow;

use super::recorder::{End, Event, Recorder, Source, single};
use crate::job::effect::EffectId;
use crate::job::guides::{GUIDE_SAMPLES, GuideSums};
use crate::job::{Job, Settings, Strategy};
use crate::optics::layer::{Layers, material_albedo, material_layers, material_normal};
use crate::optics::material::Material;
use crate::optics::random::Sequence;
use crate::optics::real::{Mask, Real, Scalar};
use crate::optics::vector::Vec3;
use crate::scene::Geometry;
use crate::scene::camera::Camera;
use crate::scene::environment::{Distribution, Environment};
use crate::scene::light::Lights;
use crate::scene::medium::NO_MEDIUM;
use crate::scene::surface::{Hits, SurfacePoint, surfaces_at};
use crate::scene::texture::{Textures, textured_materials};
pub use catcher::CATCHER_DIMENSION;
use catcher::Caught;
use group::{Group, Members};
use paths::{Beginning, Found, Look, Paths};
pub(in crate::cpu) use results::Results;
pub use wave::WAVE_SAMPLES;
pub(in crate::cpu) use wave::{NEAR, Tile, Wave};

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
pub(in crate::cpu) struct Integrator<'a, T: Real> {
    geometry: &'a Geometry,
    environment: &'a Environment,
    /// What directions to the environment's light are drawn with.
    distribution: &'a Distribution,
    tables: &'a [f32],
    textures: &'a Textures,
    has_holes: bool,
    has_absorption: bool,
    has_transmission: bool,
    settings: &'a Settings,
    materials: Vec<Material<T>>,
    /// The materials for one lane.
    of_lane: Vec<Material<T::Scalar>>,
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

/// Paths of a group that have met surfaces, and how they got there.
#[derive(Clone, Copy)]
struct Arrival<T: Real> {
    group: Group<T>,
    members: Members<T>,
    bounce: u32,
    /// Which of them it is about.
    on: T::Mask,
    /// What light from their rays' other ends is multiplied by.
    throughput: Vec3<T>,
    /// Of their rays.
    direction: Vec3<T>,
    lobe_density: T,
    is_mirror: T::Mask,
    /// From their rays' origins.
    distance: T,
    /// True where a shadow catcher mirrors them, all of them.
    is_caught_mirrored: bool,
}

impl<'a, T: Real> Integrator<'a, T> {
    /// Reads the job.
    pub fn new(job: &'a Job) -> Self {
        let samples_light = job.settings.strategy != Strategy::Lobe;
        let choice = job.settings.light_choice;
        Self {
            geometry: &job.geometry,
            environment: &job.environment,
            distribution: job.distribution(),
            tables: &job.tables,
            textures: &job.textures,
            has_holes: job.plan.has(EffectId::Alpha),
            has_absorption: job.plan.has(EffectId::Absorption),
            has_transmission: job.plan.has(EffectId::Transmission),
            settings: &job.settings,
            materials: job.materials.iter().map(Material::cast).collect(),
            of_lane: job.materials.iter().map(Material::cast).collect(),
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

    /// Which numbers paths draw.
    pub fn sequence(&self) -> Sequence {
        self.settings.sequence
    }

    /// Whether directions to lights are drawn at all.
    fn samples_light(&self) -> bool {
        self.samples_environment || self.samples_emitters
    }

    /// What is noted of paths besides what they find.
    fn beginning(&self) -> Beginning {
        Beginning {
            guide_samples: self.guide_samples,
            has_catcher: self.settings.catcher.is_some(),
            counts_rough: self.settings.roulette_floor < 1.0,
            medium: self
                .has_absorption
                .then(|| self.settings.camera_medium.unwrap_or(NO_MEDIUM)),
        }
    }

    /// What a path of a wave found that has come to its end.
    fn result<R: Recorder>(&self, paths: &Paths<T::Scalar, R>, number: usize) -> PathResult<T::Scalar> {
        paths.result(number, self.settings.least_reflections == 0)
    }

    /// The surfaces that paths met, all of one slot.
    #[inline(always)]
    fn surfaces<R: Recorder>(
        &self,
        arrival: &Arrival<T>,
        slot: u32,
        paths: &mut Paths<T::Scalar, R>,
    ) -> SurfacePoint<T> {
        let hits: Hits<T> = arrival.group.each(&paths.state.hits);
        let materials = (&self.materials[slot as usize], &self.of_lane[slot as usize]);
        let mut point = surfaces_at(self.geometry, slot, materials, self.textures, &hits, arrival.direction);
        // Behind a surface that transmits, light goes on from the triangle itself.
        if self.settings.rounds_surfaces && !materials.1.least_metallic().transmits().any() {
            point.round(self.geometry, &hits);
        }
        arrival.members.record(&mut paths.found, arrival.on, |lane| Event::Hit {
            bounce: arrival.bounce,
            triangle: hits.as_ref()[lane].triangle,
            slot,
            distance: single(arrival.distance.lane(lane)),
            position: point.position.to_each().as_ref()[lane].to_f32(),
            normal: point.surface.normal.to_each().as_ref()[lane].to_f32(),
            shading_normal: point.surface.frame.normal.to_each().as_ref()[lane].to_f32(),
            is_inside: point.surface.is_inside.to_bits() >> lane & 1 == 1,
        });
        point
    }

    /// Where it is proven that nothing lies ahead: outside a convex body.
    #[inline(always)]
    fn meets_nothing(&self, point: &SurfacePoint<T>, wi: Vec3<T>) -> T::Mask {
        let is_outside = !point.surface.is_inside & T::zero().less(point.flat_normal().dot(wi));
        T::Mask::splat(!self.is_interreflecting) & is_outside
    }

    /// The material of paths that have met surfaces, with what its textures say there.
    #[inline(always)]
    fn material(&self, point: &SurfacePoint<T>, arrival: &Arrival<T>) -> Cow<'_, Material<T>> {
        let slot = match self.settings.catcher {
            Some(catcher) if arrival.is_caught_mirrored => catcher.reflection_slot,
            _ => point.slot,
        };
        let materials = (&self.materials[slot as usize], &self.of_lane[slot as usize]);
        if materials.1.is_varied() {
            let (textures, tables) = (self.textures, self.tables);
            Cow::Owned(T::out_of_line(
                #[inline(always)]
                || textured_materials(textures, tables, materials, &point.uvs, point.vertex_color),
            ))
        } else {
            Cow::Borrowed(materials.0)
        }
    }

    /// What paths find at the surfaces that stopped them, by themselves; false where they end there.
    #[inline(always)]
    fn meet<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        layers: &Layers<T>,
        arrival: &mut Arrival<T>,
        paths: &mut Paths<T::Scalar, R>,
    ) -> bool {
        self.absorb(point, material, arrival, paths);
        self.look(point, material, layers, arrival, paths);
        if material.emission.is_any().any() {
            let found = arrival.throughput * self.emitted_light(point, material, arrival, paths);
            self.add(
                &arrival.members,
                arrival.on,
                Source::Surface,
                found,
                arrival.bounce,
                &mut paths.found,
            );
        }
        let goes_on = arrival.bounce < self.settings.bounces;
        if !goes_on {
            if self.has_transmission {
                let cut = arrival.throughput.luminance().to_each();
                let lanes = std::iter::zip(0.., cut.as_ref()).filter(|(lane, _)| arrival.on.to_bits() >> lane & 1 == 1);
                paths.cut += lanes.map(|(_, cut)| cut.to_f64()).sum::<f64>();
            }
            let nowhere = T::Mask::splat(false);
            arrival.group.set_truth(&mut paths.goes_on, arrival.on, nowhere);
            arrival
                .members
                .record(&mut paths.found, arrival.on, |_| Event::Ended { why: End::Bounces });
        }
        goes_on
    }

    /// Notes what is seen here: at the first surface, and behind mirrors and clear glass.
    #[inline(always)]
    fn look<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        layers: &Layers<T>,
        arrival: &Arrival<T>,
        paths: &mut Paths<T::Scalar, R>,
    ) {
        let members = arrival.members;
        if paths.looks.is_empty() {
            return;
        }
        let is_looking = arrival.on & members.truths(&paths.looks, |look| look.goes_on);
        if !is_looking.any() {
            return;
        }
        let albedo = arrival.throughput * material_albedo(material, &point.surface, layers);
        let depth = arrival.distance * arrival.direction.dot(self.camera.forward);
        let normal = material_normal(material, self.tables, &point.surface, layers);
        let (albedos, normals) = (albedo.to_each(), normal.to_each());
        let depths = depth.to_each();
        members.for_each(&mut paths.looks, is_looking, |Look { seen, .. }, lane| {
            seen.albedo = albedos.as_ref()[lane].to_f32().map(|share| share.clamp(0.0, 1.0));
            seen.normal = normals.as_ref()[lane].to_f32();
            if arrival.bounce == 0 {
                seen.hits = 1.0;
                seen.depth = single(depths.as_ref()[lane]);
            }
        });
    }

    /// The end of paths that met nothing, and see these places in the environment's map.
    #[inline(always)]
    fn leave<R: Recorder>(&self, arrival: &Arrival<T>, place: [T; 2], paths: &mut Paths<T::Scalar, R>) {
        let Arrival {
            group,
            members,
            bounce,
            on,
            ..
        } = *arrival;
        if bounce == 0 {
            // The numbers of the first bounce, which there is none of.
            let (radiance, alpha) = self.camera_background(&group, arrival.direction, place, FIRST_DIMENSION, paths);
            self.add(&members, on, Source::Background, radiance, 0, &mut paths.found);
            let alphas = alpha.to_each();
            members.for_each(&mut paths.found, on, |path, lane| path.alpha = alphas.as_ref()[lane]);
        } else {
            let is_caught = match self.settings.catcher {
                Some(_) => on & members.truths(&paths.caught, Caught::is_mirrored),
                None => T::Mask::splat(false),
            };
            if is_caught.any() {
                self.leave_catcher(&members, is_caught, bounce, paths);
            }
            let ray = Arrival {
                on: on & !is_caught,
                ..*arrival
            };
            if ray.on.any() {
                let found = arrival.throughput * self.far_light(&ray, place, paths);
                self.add(&members, ray.on, Source::Environment, found, bounce, &mut paths.found);
            }
        }
        group.set_truth(&mut paths.goes_on, on, T::Mask::splat(false));
        members.record(&mut paths.found, on, |_| Event::Ended { why: End::Left });
    }

    /// The same of paths that a shadow catcher mirrors: they see the background.
    #[inline(always)]
    fn leave_catcher<R: Recorder>(
        &self,
        members: &Members<T>,
        on: T::Mask,
        bounce: u32,
        paths: &mut Paths<T::Scalar, R>,
    ) {
        let Paths { found, caught, .. } = paths;
        let background = Vec3::from_lanes(|lane| match *members.of(caught, lane) {
            Caught::Mirrored { background, .. } => background,
            _ => Vec3::zero(),
        });
        self.add(members, on, Source::Background, background, bounce, found);
        members.for_each(found, on, |path, lane| {
            if let Caught::Mirrored { alpha, .. } = *members.of(caught, lane) {
                path.alpha = alpha;
            }
        });
    }

    /// Adds light that was reflected so many times, no more than firefly limiting allows.
    #[inline(always)]
    fn add<R: Recorder>(
        &self,
        members: &Members<T>,
        on: T::Mask,
        source: Source,
        light: Vec3<T>,
        reflections: u32,
        found: &mut [Found<T::Scalar, R>],
    ) {
        let [added, taken] = self.limited(light, reflections);
        let radiances = added.to_each();
        members.for_each(found, on, |path, lane| path.radiance += radiances.as_ref()[lane]);
        if self.firefly_clamp.is_some() {
            let taken = taken.luminance().to_each();
            members.for_each(found, on, |path, lane| path.clamped += taken.as_ref()[lane]);
        }
        members.record(found, on & light.is_any(), |lane| Event::Contribution {
            source,
            reflections,
            found: light.to_each().as_ref()[lane].to_f32(),
            added: added.to_each().as_ref()[lane].to_f32(),
        });
    }

    /// What contributions that were reflected so many times add, and what is beyond the limit.
    #[inline(always)]
    fn limited(&self, contribution: Vec3<T>, reflections: u32) -> [Vec3<T>; 2] {
        let nothing = Vec3::zero();
        if reflections < self.settings.least_reflections {
            return [nothing, nothing];
        }
        let Some(limit) = self.firefly_clamp.filter(|_| reflections > 1) else {
            return [contribution, nothing];
        };
        let largest = contribution.max_component();
        let is_beyond = limit.less(largest);
        let kept = limit / largest;
        [
            Vec3::select(is_beyond, contribution * kept, contribution),
            Vec3::select(is_beyond, contribution * (T::one() - kept), nothing),
        ]
    }
}

impl<S: Scalar> Integrator<'_, S> {
    /// One path through a pixel, its events told to a recorder.
    pub(in crate::cpu) fn record_path<R: Recorder>(
        &self,
        pixel: [u32; 2],
        sample: u32,
        recorder: &mut R,
    ) -> PathResult<S> {
        let settings = self.settings;
        let mut paths = Paths::new(1, S::LANES, settings.sequence);
        paths.add(pixel, &[[0, 0]], sample);
        paths.set_counters(settings.seed);
        paths.start([recorder], &self.beginning());
        self.first_rays(&Group::ALONE, &mut paths);
        for bounce in 0.. {
            let is_stopped = self.stop(bounce, 0, &mut paths);
            let arrival = Arrival::new(Group::ALONE, bounce, &paths);
            if !is_stopped {
                self.leave(&arrival, self.left_places(arrival.direction, bounce), &mut paths);
                break;
            }
            self.bounce_alone(arrival, &mut paths);
            if !paths.goes_on[0] {
                break;
            }
        }
        self.result(&paths, 0)
    }

    /// What a path does at the surface that stopped it.
    fn bounce_alone<R: Recorder>(&self, mut arrival: Arrival<S>, paths: &mut Paths<S, R>) {
        let (group, bounce) = (arrival.group, arrival.bounce);
        let slot = self.geometry.slot(paths.state.hits[0].triangle as usize);
        let point = self.surfaces(&arrival, slot, paths);
        let passed = self.pass_catcher(&point, &mut arrival, paths);
        if !passed.is_there {
            self.leave(&arrival, self.left_places(arrival.direction, bounce), paths);
            return;
        }
        arrival.is_caught_mirrored = passed.is_mirrored;
        let material = &*self.material(&point, &arrival);
        let layers = &material_layers(material, self.tables, &point.surface);
        if !self.meet(&point, material, layers, &mut arrival, paths) {
            return;
        }
        if self.samples_light() && !arrival.is_caught_mirrored {
            self.light_numbers(&group, bounce, paths);
            paths.lights.is_aimed[0] = false;
            let whole = self.aim(&point, material, layers, &arrival, paths);
            if paths.lights.is_aimed[0] {
                self.arrive_alone(whole, bounce, paths);
            }
        }
        self.scatter(&point, material, layers, &arrival, paths);
    }

    /// Adds the light that a path is aimed at, if it arrives; `whole` is what [`Integrator::aim`] told.
    fn arrive_alone<R: Recorder>(&self, whole: Vec3<S>, bounce: u32, paths: &mut Paths<S, R>) {
        let light = paths.lights.get(0);
        let visible = self.visible(&light, &mut paths.found[0].rays);
        paths.lights.visible[0] = visible;
        if visible > S::zero() {
            paths.take_arriving(&[0], true);
            self.locate_lights(&Group::ALONE, paths);
            self.arrive(&Group::ALONE, bounce, whole, paths);
        } else {
            paths.found[0].record(|| light.told(whole, visible, Vec3::zero()));
        }
    }
}

/// Finite and not negative: what may be added to the picture.
#[inline(always)]
pub fn is_sound<S: Scalar>(color: Vec3<S>) -> bool {
    let is_within = |x: S| (0.0..=RADIANCE_MAX).contains(&x.to_f64());
    is_within(color.x) & is_within(color.y) & is_within(color.z)
}
