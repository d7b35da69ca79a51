//! What the rays of a path meet. Twin of `shaders/scene/visibility.wgsl`.

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
    /// The paths' first rays.
    #[inline(always)]
    pub(super) fn first_rays<R: Recorder>(&self, group: &Group<T>, paths: &mut Paths<T::Scalar, R>) {
        let has_lens = T::zero().less(self.camera.lens_radius).any();
        let for_pixel = group.pairs(paths, PIXEL_DIMENSION, [Purpose::Pixel; 2]);
        let for_lens = if has_lens {
            group.pairs(paths, LENS_DIMENSION, [Purpose::Lens; 2])
        } else {
            [T::zero(); 2]
        };
        let [x, y] = &paths.pixels;
        let pixel = [group.whole_number(x), group.whole_number(y)];
        let [origin, direction] = pixel_ray(&self.camera, pixel, self.settings.image_size, [for_pixel, for_lens]);
        group.set_vector(&mut paths.origin, group.mask(), origin);
        group.set_vector(&mut paths.state.direction, group.mask(), direction);
        let members = group.members(&paths.state.ids);
        members.record(&mut paths.found, group.mask(), |lane| Event::Camera {
            origin: origin.to_each().as_ref()[lane].to_f32(),
            direction: direction.to_each().as_ref()[lane].to_f32(),
        });
    }

    /// The share of light that reaches the origin of a ray from so far.
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
        let (mut share, mut left) = (one, distance);
        for _ in 0..PASSES_MAX {
            *rays += 1;
            let far = left.to_f64() as f32;
            let Some(hit) = self.geometry.intersect(origin.to_f32(), direction.to_f32(), far) else {
                return share;
            };
            share = share * (one - hit_opacity(self.geometry, &self.of_lane, self.textures, &hit));
            if share <= zero {
                break;
            }
            left = left - T::Scalar::from_f64(f64::from(hit.t));
            origin = passed_origin(self.geometry, &hit, direction);
        }
        zero
    }

    /// Follows the ray of the path at a place to the surface that stops it, through those that do not; false where there is
    /// none.
    #[inline(always)]
    pub(super) fn stop<R: Recorder>(&self, bounce: u32, place: usize, paths: &mut Paths<T::Scalar, R>) -> bool {
        if paths.leaves[place] {
            return false;
        }
        let (mut origin, direction) = (paths.origin.get(place), paths.state.direction.get(place));
        if !self.has_holes {
            let hit = self.geometry.intersect(origin.to_f32(), direction.to_f32(), f32::MAX);
            return paths.note(place, hit);
        }
        let dimension = OPACITY_DIMENSION + bounce;
        let [mut xi, _]: [T::Scalar; 2] = random_pair(paths.random_state(place), dimension);
        paths.found_at(place).record(|| Event::Number {
            dimension,
            half: 0,
            value: single(xi),
            purpose: Purpose::Opacity,
        });
        let mut distance = T::Scalar::zero();
        for _ in 0..PASSES_MAX {
            let hit = self.geometry.intersect(origin.to_f32(), direction.to_f32(), f32::MAX);
            if !paths.note(place, hit) {
                return false;
            }
            let hit = paths.state.hits[place];
            distance += T::Scalar::from_f64(f64::from(hit.t));
            paths.state.distance[place] = distance;
            let opacity = hit_opacity(self.geometry, &self.of_lane, self.textures, &hit);
            if xi < opacity {
                return true;
            }
            paths.found_at(place).record(|| Event::Passed {
                slot: self.geometry.slot(hit.triangle as usize),
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
