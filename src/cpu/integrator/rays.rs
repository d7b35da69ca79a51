//! Rays of a path: camera rays, intersection and transmittance.

use super::group::Group;
use super::paths::Paths;
use super::{Integrator, OPACITY_DIMENSION, PASSES_MAX};
use crate::cpu::recorder::{Event, Purpose, Recorder, single};
use crate::optics::random::random_pair;
use crate::optics::real::{Mask, Real, Scalar};
use crate::optics::vector::Vec3;
use crate::scene::camera::{LENS_DIMENSION, PIXEL_DIMENSION, pixel_ray};
use crate::scene::surface::{hit_opacity, passed_origin};

impl<T: Real> Integrator<'_, T> {
    /// Generates the camera rays.
    #[inline(always)]
    pub(super) fn camera_rays<R: Recorder>(&self, group: &Group<T>, paths: &mut Paths<T::Scalar, R>) {
        let has_lens = T::zero().less(self.camera.lens_radius).any();
        let for_pixel = group.pairs(paths, PIXEL_DIMENSION, [Purpose::Pixel; 2]);
        let for_lens = if has_lens {
            group.pairs(paths, LENS_DIMENSION, [Purpose::Lens; 2])
        } else {
            [T::zero(); 2]
        };
        let [x, y] = &paths.pixels;
        let pixel = [group.integer(x), group.integer(y)];
        let [origin, direction] = pixel_ray(&self.camera, pixel, self.settings.image_size, [for_pixel, for_lens]);
        group.set_vector(&mut paths.origin, group.mask(), origin);
        group.set_vector(&mut paths.state.direction, group.mask(), direction);
        let members = group.members(&paths.state.ids);
        members.record(&mut paths.outputs, group.mask(), |lane| Event::Camera {
            origin: origin.to_each().as_ref()[lane].to_f32(),
            direction: direction.to_each().as_ref()[lane].to_f32(),
        });
    }

    /// Share of light in [0, 1] that passes along a ray of length `distance`: the product of (1 − opacity) of the surfaces
    /// on it.
    pub(super) fn transmittance(
        &self,
        mut origin: Vec3<T::Scalar>,
        direction: Vec3<T::Scalar>,
        distance: T::Scalar,
        rays: &mut u32,
    ) -> T::Scalar {
        let (zero, one) = (T::Scalar::zero(), T::Scalar::one());
        if !self.has_holes {
            *rays += 1;
            let distance = distance.to_f64() as f32;
            let is_occluded = self.geometry.occluded(origin.to_f32(), direction.to_f32(), distance);
            return if is_occluded { zero } else { one };
        }
        let (mut transmittance, mut remaining) = (one, distance);
        for _ in 0..PASSES_MAX {
            *rays += 1;
            let t_max = remaining.to_f64() as f32;
            let Some(hit) = self.geometry.intersect(origin.to_f32(), direction.to_f32(), t_max) else {
                return transmittance;
            };
            transmittance =
                transmittance * (one - hit_opacity(self.geometry, &self.scalar_materials, self.textures, &hit));
            if transmittance <= zero {
                break;
            }
            remaining = remaining - T::Scalar::from_f64(f64::from(hit.t));
            origin = passed_origin(self.geometry, &hit, direction);
        }
        zero
    }

    /// Intersects the ray of the path at `index`, passing surfaces at random by their opacity. Returns false for a miss.
    #[inline(always)]
    pub(super) fn intersect<R: Recorder>(&self, bounce: u32, index: usize, paths: &mut Paths<T::Scalar, R>) -> bool {
        if paths.is_known_miss[index] {
            return false;
        }
        let (mut origin, direction) = (paths.origin.get(index), paths.state.direction.get(index));
        if !self.has_holes {
            let hit = self.geometry.intersect(origin.to_f32(), direction.to_f32(), f32::MAX);
            return paths.record_hit(index, hit);
        }
        let dimension = OPACITY_DIMENSION + bounce;
        let [mut xi, _]: [T::Scalar; 2] = random_pair(paths.random_state(index), dimension);
        paths.output_at(index).record(|| Event::Number {
            dimension,
            half: 0,
            value: single(xi),
            purpose: Purpose::Opacity,
        });
        let mut distance = T::Scalar::zero();
        for _ in 0..PASSES_MAX {
            let hit = self.geometry.intersect(origin.to_f32(), direction.to_f32(), f32::MAX);
            if !paths.record_hit(index, hit) {
                return false;
            }
            let hit = paths.state.hits[index];
            distance += T::Scalar::from_f64(f64::from(hit.t));
            paths.state.distance[index] = distance;
            let slot = self.geometry.slot(hit.triangle as usize);
            let opacity = if bounce == 0 && slot >= self.settings.first_hidden_slot {
                T::Scalar::zero()
            } else {
                hit_opacity(self.geometry, &self.scalar_materials, self.textures, &hit)
            };
            if xi < opacity {
                return true;
            }
            paths.output_at(index).record(|| Event::Passed {
                slot,
                distance: hit.t,
                opacity: single(opacity),
            });
            // Uniform again, given that the surface did not stop the ray.
            let one = T::Scalar::one();
            xi = (xi - opacity) / (one - opacity).max(T::Scalar::from_f64(1e-20));
            origin = passed_origin(self.geometry, &hit, direction);
        }
        false
    }
}
