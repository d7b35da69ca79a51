//! The path tracer in Rust: twin of `shaders/pass/path_trace.wgsl`, generic over its number type, which may be a vector of
//! SIMD lanes.

mod camera;
mod catcher;
mod catcher_hit;
mod group;
mod light;
mod medium;
mod paths;
mod rays;
mod results;
mod scatter;
mod shadow_rays;
mod vectors;
mod wave;

use std::borrow::Cow;

use super::recorder::{End, Event, LightSource, Recorder};
use crate::optics::prelude::*;
use crate::{
    job::{
        Job, Settings, Strategy,
        effect::EffectId,
        guides::{GUIDE_SAMPLES, GuideSums},
        light_sums::ENVIRONMENT_GROUP,
    },
    optics::{
        layer::{Layers, material_albedo, material_normal},
        material::Material,
        random::Sequence,
    },
    scene::{
        Geometry, PACKET,
        camera::Camera,
        environment::{Distribution, Environment},
        light::Lights,
        medium::NO_MEDIUM,
        surface::{Hits, SurfacePoint, surfaces_at},
        texture::{Textures, textured_material},
    },
};
pub use catcher::CATCHER_DIMENSION;
use catcher_hit::CatcherHit;
use group::{Group, Members};
use paths::{GuideRecord, Paths};
pub use results::Results;
pub use wave::{BLOCK_PIXELS, PATHS, Tiles, WAVE_SAMPLES, Wave};

/// Random pairs before the first bounce: pixel and lens.
pub const FIRST_DIMENSION: u32 = 2;
/// Random pairs per bounce: two for the lobe, two for light sampling and Russian roulette.
pub const BOUNCE_DIMENSIONS: u32 = 4;
/// First dimension of the directions below the specular lobe, two pairs per bounce: beyond the dimensions of every path.
pub const BELOW_DIMENSION: u32 = 4096;
/// First dimension of the opacity tests, one pair per bounce.
pub const OPACITY_DIMENSION: u32 = 8192;
/// Transparent hits per ray at most. Beyond them a path's ray counts as a miss, and a shadow ray as blocked.
pub const PASSES_MAX: u32 = 4096;
/// Number of bounces without Russian roulette.
pub const ROULETTE_START: u32 = 3;
/// Largest radiance per channel that is kept. Its square would overflow f32; larger samples are dropped and counted.
pub const RADIANCE_MAX: f64 = 1e18;

/// Result of one path.
#[derive(Clone, Copy, Debug, Default)]
pub struct PathResult {
    /// Linear RGB.
    pub radiance: Vec3<f32>,
    /// Coverage in [0, 1]: 0 if the camera ray saw transparent background.
    pub alpha: f32,
    /// Rays traced, shadow rays included.
    pub rays: u32,
    /// Luminance that the firefly clamp removed.
    pub clamped: f32,
    /// First-hit guides (albedo, normal, depth); zero for samples from [`GUIDE_SAMPLES`] on.
    pub guides: GuideSums,
}

/// A job's scene and settings, converted to the precision of shading.
pub struct Integrator<'a, T: Single> {
    geometry: &'a Geometry,
    environment: &'a Environment,
    /// Distribution from which light sampling draws environment directions.
    distribution: &'a Distribution,
    tables: &'a [f32],
    textures: &'a Textures,
    has_holes: bool,
    has_absorption: bool,
    settings: &'a Settings,
    materials: Vec<Material<T>>,
    /// The same materials for a single lane.
    scalar_materials: &'a [Material<f32>],
    camera: Camera<T>,
    rotation: [T; 2],
    lights: &'a Lights,
    environment_probability: T,
    density_per_luminance: T,
    samples_environment: bool,
    samples_emitters: bool,
    is_interreflecting: bool,
    /// Samples per pixel that record first-hit guides.
    guide_samples: u32,
    /// Light groups that are summed apart.
    light_groups: usize,
    /// Largest component of an indirect contribution; `None` without a limit.
    firefly_clamp: Option<T>,
}

/// Where a contribution comes from.
#[derive(Clone, Copy)]
enum Origin<T> {
    Environment,
    Background,
    /// Surfaces that emit, with the numbers of their light groups.
    Surface(T),
}

impl<T: Single> Origin<T> {
    fn source(&self) -> LightSource {
        match self {
            Self::Environment => LightSource::Environment,
            Self::Background => LightSource::Background,
            Self::Surface(_) => LightSource::Surface,
        }
    }

    /// Numbers of the light groups.
    fn group(&self) -> T {
        match self {
            Self::Surface(groups) => *groups,
            _ => T::from_f64(f64::from(ENVIRONMENT_GROUP)),
        }
    }
}

/// Path vertices of a group: where its rays ended, on a surface or outside the scene, and how they got there.
#[derive(Clone, Copy)]
pub struct PathVertex<T: Single> {
    group: Group<T>,
    members: Members<T>,
    bounce: u32,
    active: T::Mask,
    /// Path throughput: weight of the light that arrives along the rays.
    throughput: Vec3<T>,
    /// Unit directions of the rays.
    direction: Vec3<T>,
    lobe_density: T,
    is_mirror: T::Mask,
    /// Distances from the rays' origins, in the geometry's units.
    distance: T,
    /// True if the shadow catcher mirrors all active lanes.
    is_catcher_mirror: bool,
}

impl<'a, T: Single> Integrator<'a, T> {
    /// The integrator of a job.
    pub fn new(job: &'a Job) -> Self {
        let samples_light = job.settings.strategy != Strategy::Lobe;
        let choice = job.settings.light_choice;
        let mut materials = Vec::with_capacity(job.materials.len());
        vectorized!(T, {
            for material in job.materials.iter() {
                materials.push(material.cast());
            }
        });
        let [cosine, sine] = job.settings.environment_rotation;
        vectorized!(
            T,
            Self {
                geometry: &job.geometry,
                environment: &job.environment,
                distribution: job.distribution(),
                tables: &job.tables,
                textures: &job.textures,
                has_holes: job.plan.has(EffectId::Alpha),
                has_absorption: job.plan.has(EffectId::Absorption),
                settings: &job.settings,
                materials,
                scalar_materials: &job.materials,
                camera: job.settings.camera.cast(),
                rotation: [T::from_f64(cosine), T::from_f64(sine)],
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
                light_groups: job.settings.light_groups as usize,
                firefly_clamp: match job.plan.has(EffectId::FireflyClamp) {
                    true => Some(T::from_f64(job.settings.firefly_clamp)),
                    false => None,
                },
            }
        )
    }

    /// The random sequence from which paths draw.
    pub fn sequence(&self) -> Sequence {
        self.settings.sequence
    }

    /// Whether light is sampled (next-event estimation).
    fn samples_light(&self) -> bool {
        self.samples_environment || self.samples_emitters
    }

    inlined! {
        /// Surface points of a group's hits, all of one material slot.
        fn surfaces<R: Recorder>(&self, vertex: &PathVertex<T>, slot: u32, paths: &mut Paths<R>) -> SurfacePoint<T> {
            let hits: Hits<T> = vertex.group.each(&paths.state.hits);
            let materials = (&self.materials[slot as usize], &self.scalar_materials[slot as usize]);
            let mut point = surfaces_at(self.geometry, slot, materials, self.textures, &hits, vertex.direction);
            // Surfaces that transmit stay flat: refracted light starts on the triangle itself.
            if self.settings.rounds_surfaces && !materials.1.least_metallic().transmits().any() {
                point.round(self.geometry, &hits);
            }
            vertex
                .members
                .record(&mut paths.outputs, vertex.active, |lane| Event::Hit {
                    bounce: vertex.bounce,
                    triangle: hits[lane].triangle,
                    slot,
                    distance: vertex.distance.lane(lane),
                    position: point.position.lane(lane).to_f32(),
                    normal: point.surface.normal.lane(lane).to_f32(),
                    shading_normal: point.surface.frame.normal.lane(lane).to_f32(),
                    is_inside: point.surface.is_inside.to_bits() >> lane & 1 == 1,
                });
            point
        }

        /// Lanes whose continuation is known to miss: outside a convex body, in a scene without interreflection.
        fn is_known_miss(&self, point: &SurfacePoint<T>, wi: Vec3<T>) -> T::Mask {
            let is_outside = !point.surface.is_inside & point.flat_normal().dot(wi).above_zero();
            T::Mask::splat(!self.is_interreflecting) & is_outside
        }

        /// The material at path vertices, with its textures evaluated.
        fn material(&self, point: &SurfacePoint<T>, vertex: &PathVertex<T>) -> Cow<'_, Material<T>> {
            let slot = match self.settings.catcher {
                Some(catcher) if vertex.is_catcher_mirror => catcher.reflection_slot,
                _ => point.slot,
            };
            let materials = (&self.materials[slot as usize], &self.scalar_materials[slot as usize]);
            if materials.1.is_varied() {
                let (textures, tables) = (self.textures, self.tables);
                Cow::Owned(out_of_line!(
                    T,
                    textured_material(textures, tables, materials.0, &point.uvs, point.vertex_color)
                ))
            } else {
                Cow::Borrowed(materials.0)
            }
        }

        /// Shades path vertices but for scattering: absorbs along the segment, records guides, adds emission. Returns false if
        /// the paths end here, because their bounces are used up.
        fn shade_hit<R: Recorder>(
            &self,
            point: &SurfacePoint<T>,
            material: &Material<T>,
            layers: &Layers<T>,
            vertex: &mut PathVertex<T>,
            paths: &mut Paths<R>,
        ) -> bool {
            self.absorb(point, material, vertex, paths);
            self.record_guides(point, material, layers, vertex, paths);
            if material.emission.is_any().any() {
                let contribution = vertex.throughput * self.emitted_light(point, material, vertex, paths);
                self.add(
                    &vertex.members,
                    vertex.active,
                    Origin::Surface(T::from_count(material.light_group())),
                    contribution,
                    vertex.bounce,
                    paths,
                );
            }
            let is_active = vertex.bounce < self.settings.bounces;
            if !is_active {
                // What the surface would have scattered on: a lamp or a black wall ends no light.
                let albedo = material_albedo(material, &point.surface, layers);
                let cut = (vertex.throughput * albedo).luminance().to_each();
                let lanes = std::iter::zip(0.., cut.as_ref()).filter(|(lane, _)| vertex.active.to_bits() >> lane & 1 == 1);
                paths.cut += lanes.map(|(_, cut)| cut.to_f64()).sum::<f64>();
                let nowhere = T::Mask::splat(false);
                vertex.group.set_flags(&mut paths.is_active, vertex.active, nowhere);
                vertex
                    .members
                    .record(&mut paths.outputs, vertex.active, |_| Event::Ended {
                        why: End::Bounces,
                    });
            }
            is_active
        }

        /// Records first-hit guides: at the first surface, then behind mirrors and clear glass.
        fn record_guides<R: Recorder>(
            &self,
            point: &SurfacePoint<T>,
            material: &Material<T>,
            layers: &Layers<T>,
            vertex: &PathVertex<T>,
            paths: &mut Paths<R>,
        ) {
            let members = vertex.members;
            if paths.guides.is_empty() {
                return;
            }
            let is_recorded = vertex.active & members.flags(&paths.guides, |record| record.is_active);
            if !is_recorded.any() {
                return;
            }
            let albedo = vertex.throughput * material_albedo(material, &point.surface, layers);
            let depth = vertex.distance * vertex.direction.dot(self.camera.forward) - self.camera.parallel_from;
            let normal = material_normal(material, self.tables, &point.surface, layers);
            let (albedos, normals) = (albedo.to_each(), normal.to_each());
            let depths = depth.to_each();
            members.for_each(&mut paths.guides, is_recorded, |GuideRecord { guides, .. }, lane| {
                guides.albedo = albedos[lane].to_f32().map(|share| share.clamp(0.0, 1.0));
                guides.normal = normals[lane].to_f32();
                if vertex.bounce == 0 {
                    guides.hits = 1.0;
                    guides.depth = depths[lane];
                }
            });
        }

        /// Ends escaped paths: adds the background to camera rays and the environment to others. `uv` is where they look up the
        /// environment map.
        fn escape<R: Recorder>(&self, vertex: &PathVertex<T>, uv: [T; 2], paths: &mut Paths<R>) {
            let PathVertex {
                group,
                members,
                bounce,
                active,
                ..
            } = *vertex;
            if bounce == 0 {
                // The dimensions of the first bounce are free, because there is none.
                let (radiance, alpha) = self.camera_background(&group, vertex.direction, uv, FIRST_DIMENSION, paths);
                self.add(&members, active, Origin::Background, radiance, 0, paths);
                let alphas = alpha.to_each();
                members.for_each(&mut paths.outputs, active, |path, lane| path.alpha = alphas[lane]);
            } else {
                let is_caught = match self.settings.catcher {
                    Some(_) => active & members.flags(&paths.catcher_hits, CatcherHit::is_mirrored),
                    None => T::Mask::splat(false),
                };
                if is_caught.any() {
                    self.escape_mirrored(&members, is_caught, bounce, paths);
                }
                let ray = PathVertex {
                    active: active & !is_caught,
                    ..*vertex
                };
                if ray.active.any() {
                    let contribution = vertex.throughput * self.weighted_environment(&ray, uv, paths);
                    self.add(&members, ray.active, Origin::Environment, contribution, bounce, paths);
                }
            }
            group.set_flags(&mut paths.is_active, active, T::Mask::splat(false));
            members.record(&mut paths.outputs, active, |_| Event::Ended { why: End::Escaped });
        }
    }

    inlined! {
        /// Ends escaped paths that the shadow catcher mirrors: they show the camera's background.
        fn escape_mirrored<R: Recorder>(&self, members: &Members<T>, active: T::Mask, bounce: u32, paths: &mut Paths<R>) {
            let background = Vec3::from_lanes(|lane| match paths.catcher_hits[members.path(lane)] {
                CatcherHit::Mirrored { background, .. } => background,
                _ => Vec3::ZERO,
            });
            self.add(members, active, Origin::Background, background, bounce, paths);
            members.each_path(active, |path, _| {
                if let CatcherHit::Mirrored { alpha, .. } = paths.catcher_hits[path] {
                    paths.outputs[path].alpha = alpha;
                }
            });
        }

        /// Adds a contribution after `reflections` bounces of the light, limited by the firefly clamp.
        fn add<R: Recorder>(
            &self,
            members: &Members<T>,
            active: T::Mask,
            origin: Origin<T>,
            light: Vec3<T>,
            reflections: u32,
            paths: &mut Paths<R>,
        ) {
            let [added, clamped] = self.clamp_fireflies(light, reflections);
            let radiances = added.to_each();
            if self.light_groups > 0 {
                let groups = origin.group().to_each();
                members.each_path(active, |path, lane| {
                    paths.light_groups[path * self.light_groups + groups[lane] as usize] += radiances[lane];
                });
            }
            let outputs = &mut paths.outputs;
            members.for_each(outputs, active, |path, lane| path.radiance += radiances[lane]);
            if self.firefly_clamp.is_some() {
                let clamped = clamped.luminance().to_each();
                members.for_each(outputs, active, |path, lane| path.clamped += clamped[lane]);
            }
            members.record(outputs, active & light.is_any(), |lane| Event::Contribution {
                source: origin.source(),
                reflections,
                found: light.lane(lane).to_f32(),
                added: added.lane(lane).to_f32(),
            });
        }

        /// A contribution's kept part and the part that the firefly clamp removes. Both are zero below `least_reflections`.
        fn clamp_fireflies(&self, contribution: Vec3<T>, reflections: u32) -> [Vec3<T>; 2] {
            let nothing = Vec3::ZERO;
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
                Vec3::select(is_beyond, contribution * (T::ONE - kept), nothing),
            ]
        }
    }
}

/// True for a finite, non-negative colour of at most [`RADIANCE_MAX`]: only such samples enter the film.
pub fn is_sound<S: Scalar>(color: Vec3<S>) -> bool {
    let is_within = |x: S| (0.0..=RADIANCE_MAX).contains(&x.to_f64());
    is_within(color.x) & is_within(color.y) & is_within(color.z)
}
