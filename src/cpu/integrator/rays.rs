//! What the rays of a path meet. Twin of `shaders/scene/visibility.wgsl`.

use super::path::{Path, Ray};
use super::{Integrator, OPACITY_DIMENSION, PASSES_MAX};
use crate::cpu::recorder::{Event, Purpose, Recorder, single};
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;
use crate::scene::Hit;
use crate::scene::camera::{LENS_DIMENSION, PIXEL_DIMENSION, pixel_ray};
use crate::scene::surface::{SurfacePoint, hit_opacity, passed_origin, surface_at};

impl<T: Real> Integrator<'_, T> {
    /// The path's first ray.
    #[inline(always)]
    pub(super) fn first_ray<R: Recorder>(&self, pixel: [u32; 2], path: &mut Path<'_, T, R>) -> Ray<T> {
        let has_lens = self.camera.lens_radius.to_f64() > 0.0;
        let for_pixel = path.pair(PIXEL_DIMENSION, [Purpose::Pixel; 2]);
        let for_lens = if has_lens {
            path.pair(LENS_DIMENSION, [Purpose::Lens; 2])
        } else {
            [T::zero(); 2]
        };
        let numbers = [for_pixel, for_lens];
        let [origin, direction] = pixel_ray(&self.camera, pixel, self.settings.image_size, numbers);
        path.record(|| Event::Camera {
            origin: origin.to_f32(),
            direction: direction.to_f32(),
        });
        Ray {
            origin,
            direction,
            lobe_density: T::zero(),
            is_mirror: true,
            leaves: false,
        }
    }

    /// The share of light that reaches the origin of a ray from so far.
    pub(super) fn transmittance(&self, mut origin: Vec3<T>, direction: Vec3<T>, distance: T, rays: &mut u32) -> T {
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

    /// The surface that stops a ray, with its distance from the ray's origin: surfaces that do not stop it are passed.
    #[inline(always)]
    pub(super) fn stop<R: Recorder>(
        &self,
        ray: &Ray<T>,
        bounce: u32,
        path: &mut Path<'_, T, R>,
    ) -> Option<(SurfacePoint<T>, T)> {
        if ray.leaves {
            return None;
        }
        let (mut origin, direction) = (ray.origin, ray.direction);
        let mut xi = T::zero();
        if self.has_holes {
            [xi, _] = path.pair(OPACITY_DIMENSION + bounce, [Purpose::Opacity, Purpose::Unused]);
        }
        let mut distance = T::zero();
        for _ in 0..PASSES_MAX {
            path.rays += 1;
            let hit = self.geometry.intersect(origin.to_f32(), direction.to_f32(), f32::MAX)?;
            distance += T::from_f64(f64::from(hit.t));
            if !self.has_holes {
                return Some((self.met(&hit, ray, distance, bounce, path), distance));
            }
            let opacity = hit_opacity(self.geometry, &self.materials, self.textures, &hit);
            if xi.less(opacity).any() {
                return Some((self.met(&hit, ray, distance, bounce, path), distance));
            }
            path.record(|| Event::Passed {
                slot: self.geometry.slot(hit.triangle as usize),
                distance: hit.t,
                opacity: single(opacity),
            });
            // Uniform again, given that the surface did not stop the ray.
            xi = (xi - opacity) / (T::one() - opacity).max(T::from_f64(1e-20));
            origin = passed_origin(self.geometry, &hit, direction);
        }
        None
    }

    /// True where it is proven that nothing lies ahead: outside a convex body.
    pub(super) fn meets_nothing(&self, point: &SurfacePoint<T>, wi: Vec3<T>) -> bool {
        !self.is_interreflecting && !point.surface.is_inside && point.surface.normal.dot(wi).to_f64() > 0.0
    }

    /// The surface that a ray met at this distance from its origin.
    #[inline(always)]
    pub(super) fn met<R: Recorder>(
        &self,
        hit: &Hit,
        ray: &Ray<T>,
        distance: T,
        bounce: u32,
        path: &mut Path<'_, T, R>,
    ) -> SurfacePoint<T> {
        let point = surface_at(self.geometry, &self.materials, self.textures, hit, ray.direction);
        path.record(|| Event::Hit {
            bounce,
            triangle: hit.triangle,
            slot: point.slot,
            distance: single(distance),
            position: point.position.to_f32(),
            normal: point.surface.normal.to_f32(),
            shading_normal: point.surface.frame.normal.to_f32(),
            is_inside: point.surface.is_inside,
        });
        point
    }
}
