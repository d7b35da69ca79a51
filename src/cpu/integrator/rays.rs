//! What the rays of a path meet. Twin of `shaders/scene/visibility.wgsl`.

use super::group::Group;
use super::path::{Path, Ray};
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
    pub(super) fn first_rays<R: Recorder>(&self, group: &Group<T>, paths: &mut [Path<T::Scalar, R>]) {
        let has_lens = T::zero().less(self.camera.lens_radius).any();
        let for_pixel = group.pairs(paths, PIXEL_DIMENSION, [Purpose::Pixel; 2]);
        let for_lens = if has_lens {
            group.pairs(paths, LENS_DIMENSION, [Purpose::Lens; 2])
        } else {
            [T::zero(); 2]
        };
        let number = |number: u32| T::Scalar::from_f64(f64::from(number));
        let pixel = [
            group.numbers(paths, |path| number(path.pixel[0])),
            group.numbers(paths, |path| number(path.pixel[1])),
        ];
        let [origin, direction] = pixel_ray(&self.camera, pixel, self.settings.image_size, [for_pixel, for_lens]);
        let (origins, directions) = (origin.to_each(), direction.to_each());
        group.for_each(paths, group.mask(), |path, lane| {
            path.ray = Ray::of_camera(origins.as_ref()[lane], directions.as_ref()[lane]);
        });
        group.record(paths, group.mask(), |lane| Event::Camera {
            origin: origins.as_ref()[lane].to_f32(),
            direction: directions.as_ref()[lane].to_f32(),
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

    /// Follows a path's ray to the surface that stops it, through those that do not; false where there is none.
    #[inline(always)]
    pub(super) fn stop<R: Recorder>(&self, bounce: u32, path: &mut Path<T::Scalar, R>) -> bool {
        if path.ray.leaves {
            return false;
        }
        let Ray {
            mut origin, direction, ..
        } = path.ray;
        let mut xi = T::Scalar::zero();
        if self.has_holes {
            let dimension = OPACITY_DIMENSION + bounce;
            [xi, _] = random_pair(path.state, dimension);
            path.record(|| Event::Number {
                dimension,
                half: 0,
                value: single(xi),
                purpose: Purpose::Opacity,
            });
        }
        path.distance = T::Scalar::zero();
        for _ in 0..PASSES_MAX {
            path.rays += 1;
            let Some(hit) = self.geometry.intersect(origin.to_f32(), direction.to_f32(), f32::MAX) else {
                return false;
            };
            path.distance += T::Scalar::from_f64(f64::from(hit.t));
            path.hit = hit;
            if !self.has_holes {
                return true;
            }
            let opacity = hit_opacity(self.geometry, &self.of_lane, self.textures, &hit);
            if xi < opacity {
                return true;
            }
            path.record(|| Event::Passed {
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
