//! Light at path vertices: the environment, emission and next-event estimation, combined by multiple importance sampling
//! (MIS).

use super::shadow_rays::ShadowRays;
use super::*;
use crate::{
    cpu::recorder::Purpose,
    job::BackgroundKind,
    optics::{
        coat_medium::coat_over_emission,
        frame::{frame_from_normal, world_from_local},
        layer::material_evaluate,
        material::{COAT_ABSORBS, HAS_PROFILE},
        warp::{split, uniform_disc},
    },
    scene::{
        environment::{
            drawn_rows, environment_density_at, environment_local_from_world, environment_radiance_at, environment_uv,
            environment_world_from_local, prefetch_cell, prefetch_chosen, prefetch_guide, prefetch_texels,
            sample_in_rows,
        },
        light::{Emitters, LightSample, is_spot, light_density, light_sample, spot_share},
        light_profile::profile_share,
    },
};

impl<T: Single> Integrator<'_, T> {
    inlined! {
        /// Coordinates of world directions in the environment map.
        fn world_environment_uv(&self, direction: Vec3<T>) -> [T; 2] {
            environment_uv(environment_local_from_world(direction, self.rotation))
        }

        /// Radiance of the environment in the scene at map coordinates, strength included.
        fn world_environment_radiance(&self, uv: [T; 2]) -> Vec3<T> {
            environment_radiance_at(self.environment, uv) * T::from_f64(self.settings.environment_strength)
        }

        /// The environment's radiance for escaped paths, times the MIS weight of BSDF sampling.
        pub fn weighted_environment<R: Recorder>(&self, ray: &PathVertex<T>, uv: [T; 2], paths: &mut Paths<R>) -> Vec3<T> {
            let radiance = self.world_environment_radiance(uv);
            let mut density = T::ZERO;
            if self.samples_environment {
                density = self.environment_probability * environment_density_at(self.distribution, uv);
            }
            self.mis_weighted(LightSource::Environment, radiance, density, ray, paths)
        }
    }

    inlined! {
        /// Environment map coordinates of escaped rays; 0 if they do not show the map unblurred.
        pub fn escaped_uv(&self, direction: Vec3<T>, bounce: u32) -> [T; 2] {
            if bounce > 0 || self.settings.background == BackgroundKind::Environment {
                self.world_environment_uv(direction)
            } else {
                [T::ZERO; 2]
            }
        }

        /// Computes where escaped paths look up the environment map, and prefetches its texels.
        pub fn locate_escaped<R: Recorder>(&self, group: &Group<T>, bounce: u32, paths: &mut Paths<R>) {
            let uv = self.escaped_uv(group.vector(&paths.state.direction), bounce);
            prefetch_texels(self.environment, uv);
            if bounce > 0 && self.samples_environment {
                prefetch_cell(self.distribution, uv);
            }
            store_uv(group, &mut paths.environment_uv, uv);
        }

        /// Computes where unoccluded shadow rays look up the environment map, and prefetches its texels.
        pub fn locate_unoccluded<R: Recorder>(&self, group: &Group<T>, paths: &mut Paths<R>) {
            let uv = self.world_environment_uv(group.vector(&paths.unoccluded_rays.direction));
            prefetch_texels(self.environment, uv);
            store_uv(group, &mut paths.unoccluded_rays.environment_uv, uv);
        }

        /// Draws the random numbers of light sampling and prefetches the environment cells that they select. The first number
        /// chooses between environment and emitters.
        pub fn light_xi<R: Recorder>(&self, group: &Group<T>, bounce: u32, paths: &mut Paths<R>) {
            let dimension = FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS + 2;
            let [mut a, b] = group.pairs(paths, dimension, [Purpose::Light; 2]);
            let [c, _] = group.pairs(paths, dimension + 1, [Purpose::Light, Purpose::Unused]);
            if self.samples_emitters {
                let mut is_environment = T::Mask::splat(false);
                if self.samples_environment {
                    (is_environment, a) = split(a, self.environment_probability);
                }
                group.set_flags(&mut paths.shadow_rays.is_environment, group.mask(), is_environment);
            }
            group.set_vector(&mut paths.light_xi, group.mask(), vec3(a, b, c));
            if self.samples_environment {
                let rows = drawn_rows(self.distribution, b);
                prefetch_guide(self.distribution, &rows, a);
                group.set_each(&mut paths.light_rows, &rows);
            }
        }

        /// Prefetches what sampling the environment with the drawn numbers looks up next.
        pub fn prefetch_lights<R: Recorder>(&self, group: &Group<T>, paths: &Paths<R>) {
            let numbers = group.padded_number(&paths.light_xi.x);
            prefetch_chosen(self.distribution, &group.each(&paths.light_rows), numbers);
        }

        /// Emission of hit surfaces towards the path, times the MIS weight of BSDF sampling.
        pub fn emitted_light<R: Recorder>(
            &self,
            point: &SurfacePoint<T>,
            material: &Material<T>,
            vertex: &PathVertex<T>,
            paths: &mut Paths<R>,
        ) -> Vec3<T> {
            let cosine = point.flat_normal().dot(point.surface.wo);
            let mut emission = material.emission;
            if is_spot(material) {
                let facing = T::select(point.surface.is_inside, -cosine, cosine);
                emission = emission * spot_share(material, facing);
            }
            if material.has_flag(COAT_ABSORBS) {
                emission = emission * coat_over_emission(material, cosine, point.surface.is_inside);
            }
            if material.has_flag(HAS_PROFILE) {
                emission = emission * self.profile_shares(material, point.surface.wo);
            }
            let density = light_density(
                material.light_luminance,
                cosine,
                vertex.distance,
                self.density_per_luminance,
            );
            self.mis_weighted(LightSource::Surface, emission, density, vertex, paths)
        }

        /// The share of its mean radiance that a light with a profile sends in each lane's direction.
        fn profile_shares(&self, material: &Material<T>, directions: Vec3<T>) -> T {
            let table = &self.tables[material.lobe_table as usize..];
            let directions = directions.to_each();
            T::from_lanes(|lane| profile_share(table, directions[lane]))
        }

        /// Radiance times the MIS weight of BSDF sampling. The weight is 1 if light sampling does not sample this source or
        /// could not have drawn this direction.
        fn mis_weighted<R: Recorder>(
            &self,
            source: LightSource,
            radiance: Vec3<T>,
            light_density: T,
            vertex: &PathVertex<T>,
            paths: &mut Paths<R>,
        ) -> Vec3<T> {
            let is_sampled = match source {
                LightSource::Surface => self.samples_emitters,
                _ => self.samples_environment,
            };
            let (zero, one) = (T::ZERO, T::ONE);
            let (mut density, mut weight) = (zero, one);
            if is_sampled {
                let is_only_sampled = self.settings.strategy == Strategy::Light;
                let share = mis_weight_lobe(vertex.lobe_density, light_density);
                let share = if is_only_sampled { zero } else { share };
                weight = T::select(vertex.is_mirror, one, share);
                density = T::select(
                    vertex.is_mirror,
                    zero,
                    if is_only_sampled { zero } else { light_density },
                );
            }
            if R::KEEPS {
                vertex
                    .members
                    .record(&mut paths.outputs, vertex.active & radiance.is_any(), |lane| {
                        Event::LightHit {
                            source,
                            radiance: radiance.lane(lane).to_f32(),
                            lobe_density: vertex.lobe_density.lane(lane),
                            light_density: density.lane(lane),
                            weight: weight.lane(lane),
                        }
                    });
            }
            // A weight of 0 removes NaN, too.
            (radiance * weight).masked(weight.above_zero())
        }

        /// Samples a direction per lane from the emitters or the environment. The environment's radiance is left out: it is
        /// looked up only if the shadow ray is unoccluded.
        fn sample_light_directions<R: Recorder>(
            &self,
            point: &SurfacePoint<T>,
            group: &Group<T>,
            paths: &Paths<R>,
        ) -> LightSample<T> {
            // Lanes beyond the group, too, need numbers that match their rows.
            let numbers = &paths.light_xi;
            let xi = vec3(
                group.padded_number(&numbers.x),
                group.padded_number(&numbers.y),
                group.padded_number(&numbers.z),
            );
            let is_environment = self.samples_of_environment(group, &paths.shadow_rays);
            let (of_environment, of_emitters) = (group.mask() & is_environment, group.mask() & !is_environment);
            let mut sampled = LightSample {
                direction: Vec3::ZERO,
                density: T::ZERO,
                distance: T::from_f64(f64::from(f32::MAX)),
                radiance: Vec3::ZERO,
                group: T::ZERO,
            };
            if of_environment.any() {
                let rows = group.each(&paths.light_rows);
                let (local, density) = sample_in_rows(self.distribution, &rows, xi);
                sampled.direction = environment_world_from_local(local, self.rotation);
                sampled.density = density * self.environment_probability;
            }
            if !of_emitters.any() {
                return sampled;
            }
            let emitted = self.sample_emitter_directions(point, xi);
            LightSample {
                direction: Vec3::select(of_emitters, emitted.direction, sampled.direction),
                density: T::select(of_emitters, emitted.density, sampled.density),
                distance: T::select(of_emitters, emitted.distance, sampled.distance),
                radiance: Vec3::select(of_emitters, emitted.radiance, sampled.radiance),
                group: emitted.group,
            }
        }

        /// Lanes whose light sample is of the environment; arbitrary beyond the group.
        fn samples_of_environment(&self, group: &Group<T>, shadow_rays: &ShadowRays) -> T::Mask {
            if self.samples_emitters {
                group.flags(&shadow_rays.is_environment)
            } else {
                T::Mask::splat(true)
            }
        }

        /// Samples directions to emitting triangles, lane by lane.
        fn sample_emitter_directions(&self, point: &SurfacePoint<T>, xi: Vec3<T>) -> LightSample<T> {
            let emitters = Emitters {
                geometry: self.geometry,
                materials: self.scalar_materials,
                textures: self.textures,
                lights: self.lights,
                tables: self.tables,
                density_per_luminance: self.density_per_luminance.lane(0),
            };
            let (positions, errors, numbers) = (point.position.to_each(), point.error.to_each(), xi.to_each());
            let samples = T::each(|lane| {
                let number = numbers[lane];
                light_sample(&emitters, positions[lane], errors[lane], number)
            });
            let samples = samples.as_ref();
            LightSample {
                direction: Vec3::from_lanes(|lane| samples[lane].direction),
                density: T::from_lanes(|lane| samples[lane].density),
                distance: T::from_lanes(|lane| samples[lane].distance),
                radiance: Vec3::from_lanes(|lane| samples[lane].radiance),
                group: T::from_lanes(|lane| samples[lane].group),
            }
        }

        /// Next-event estimation, first half: samples one light direction per lane, evaluates the material, and leaves a pending
        /// shadow ray. Lanes that cannot receive light from there get none.
        pub fn sample_direct_light<R: Recorder>(
            &self,
            point: &SurfacePoint<T>,
            material: &Material<T>,
            layers: &Layers<T>,
            vertex: &PathVertex<T>,
            paths: &mut Paths<R>,
        ) {
            let (group, zero) = (vertex.group, T::ZERO);
            let sampled = self.sample_light_directions(point, &group, paths);
            let wi = sampled.direction;
            let transmits = material.transmits();
            let is_ahead = point.surface.normal.dot(wi).above_zero() | transmits;
            let reaches = vertex.active & sampled.density.above_zero() & is_ahead;
            let competing = match self.settings.strategy {
                Strategy::Mis => T::ONE,
                _ => zero,
            };
            let (tables, surface, density) = (self.tables, &point.surface, sampled.density);
            let evaluate = |competing| material_evaluate(material, tables, surface, layers, wi, density, competing);
            let mut value = Vec3::ZERO;
            if reaches.any() {
                value = Vec3::select(reaches, evaluate(competing), value);
            }
            let mut radiance = sampled.radiance;
            if self.samples_emitters {
                radiance = self.attenuated_emission(point, material, [wi, radiance], sampled.distance, vertex, paths);
            }
            let largest = value.max_component();
            let is_lit = vertex.active & (largest.above_zero() | largest.is_nan());
            let all = group.mask();
            let shadow_rays = &mut paths.shadow_rays;
            group.set_vector(&mut shadow_rays.direction, all, wi);
            group.set_number(&mut shadow_rays.density, all, sampled.density);
            group.set_number(&mut shadow_rays.distance, all, sampled.distance);
            group.set_vector(&mut shadow_rays.origin, all, point.ray_origin(wi, transmits));
            group.set_vector(&mut shadow_rays.value, all, value);
            group.set_vector(&mut shadow_rays.throughput, all, vertex.throughput);
            group.set_number(&mut shadow_rays.visibility, all, T::ONE);
            group.set_flags(&mut shadow_rays.is_known_miss, all, self.is_known_miss(point, wi));
            group.set_flags(&mut shadow_rays.is_pending, all, is_lit);
            if self.samples_emitters {
                group.set_vector(&mut shadow_rays.radiance, all, radiance);
                if self.light_groups > 0 {
                    group.set_number(&mut shadow_rays.groups, all, sampled.group);
                }
            }
            if R::KEEPS {
                let unweighted = Vec3::select(sampled.density.above_zero(), evaluate(zero), Vec3::ZERO);
                let is_environment = self.samples_of_environment(&group, &paths.shadow_rays).to_bits();
                vertex.members.record(&mut paths.outputs, vertex.active, |lane| {
                    let (kept, unweighted) = (value.lane(lane).to_f32(), unweighted.lane(lane).to_f32());
                    Event::Light {
                        source: match is_environment >> lane & 1 {
                            1 => LightSource::Environment,
                            _ => LightSource::Surface,
                        },
                        direction: wi.lane(lane).to_f32(),
                        density: sampled.density.lane(lane),
                        value: unweighted,
                        weight: [0, 1, 2].map(|i| if kept[i] > 0.0 { kept[i] / unweighted[i] } else { 0.0 }),
                        visible: 0.0,
                        radiance: [0.0; 3],
                    }
                });
            }
        }

        /// Next-event estimation, second half: adds the light of unoccluded shadow rays.
        pub fn add_direct_light<R: Recorder>(&self, group: &Group<T>, bounce: u32, paths: &mut Paths<R>) {
            let shadow_rays = &paths.unoccluded_rays;
            let members = group.members(&shadow_rays.ids);
            let is_environment = self.samples_of_environment(group, shadow_rays);
            let mut radiance = Vec3::ZERO;
            if is_environment.any() {
                radiance = self.world_environment_radiance([
                    group.number(&shadow_rays.environment_uv[0]),
                    group.number(&shadow_rays.environment_uv[1]),
                ]);
            }
            if !is_environment.all() {
                radiance = Vec3::select(is_environment, radiance, group.vector(&shadow_rays.radiance));
            }
            let share = group.number(&shadow_rays.visibility) / group.number(&shadow_rays.density);
            let light = group.vector(&shadow_rays.throughput) * (group.vector(&shadow_rays.value) * radiance * share);
            if R::KEEPS {
                let visibility = group.number(&shadow_rays.visibility);
                members.for_each(&mut paths.outputs, group.mask(), |path, lane| {
                    let arrived = (visibility.lane(lane), radiance.lane(lane).to_f32());
                    path.recorder.light_arrives(arrived.0, arrived.1);
                });
            }
            // A path has one light sample; accounts differ by its source.
            let (of_emitters, of_environment) = (group.mask() & !is_environment, group.mask() & is_environment);
            if of_emitters.any() {
                let groups = group.number(&shadow_rays.groups);
                let origin = Origin::Surface(groups);
                self.add(&members, of_emitters, origin, light, bounce + 1, paths);
            }
            self.add(&members, of_environment, Origin::Environment, light, bounce + 1, paths);
        }

        /// Radiance and alpha of the background for camera rays. `dimension` is the random pair that a blur draws.
        pub fn camera_background<R: Recorder>(
            &self,
            group: &Group<T>,
            direction: Vec3<T>,
            uv: [T; 2],
            dimension: u32,
            paths: &mut Paths<R>,
        ) -> (Vec3<T>, T) {
            let BackgroundKind::Blurred(sine) = self.settings.background else {
                return self.plain_background(uv);
            };
            let [x, y] = uniform_disc(group.pairs(paths, dimension, [Purpose::Blur; 2]));
            let (x, y) = (x * T::from_f64(sine), y * T::from_f64(sine));
            let height = (T::ONE - x * x - y * y).safe_sqrt();
            let around = frame_from_normal(direction);
            let blurred = world_from_local(&around, vec3(x, y, height));
            (
                self.world_environment_radiance(self.world_environment_uv(blurred)),
                T::ONE,
            )
        }
    }

    /// Radiance and alpha of the unblurred background at environment map coordinates.
    #[inline(always)]
    pub fn plain_background(&self, uv: [T; 2]) -> (Vec3<T>, T) {
        match self.settings.background {
            BackgroundKind::Environment | BackgroundKind::Blurred(_) => (self.world_environment_radiance(uv), T::ONE),
            BackgroundKind::Transparent => (Vec3::ZERO, T::ZERO),
            BackgroundKind::Color(color) => (Vec3::from_f32(color), T::ONE),
        }
    }
}

inlined! {
    /// Stores environment map coordinates.
    fn store_uv<T: Single>(group: &Group<T>, field: &mut [Vec<f32>; 2], uv: [T; 2]) {
        group.set_number(&mut field[0], group.mask(), uv[0]);
        group.set_number(&mut field[1], group.mask(), uv[1]);
    }

    /// Balance-heuristic weight of BSDF sampling (Veach 1997).
    fn mis_weight_lobe<T: Single>(lobe_density: T, light_density: T) -> T {
        lobe_density / (lobe_density + light_density).max(T::from_f64(1e-30))
    }
}
