//! Rays of a path: camera rays, intersection and transmittance.

use super::shadow_rays::ShadowRays;
use super::*;
use crate::{
    cpu::recorder::Purpose,
    optics::random::random_pair,
    scene::camera::{LENS_DIMENSION, PIXEL_DIMENSION, pixel_ray},
    scene::surface::{hit_opacity, passed_origin},
};

impl<T: Single> Integrator<'_, T> {
    /// Generates the camera rays.
    #[inline(always)]
    pub fn camera_rays<R: Recorder>(&self, group: &Group<T>, paths: &mut Paths<R>) {
        let has_lens = self.camera.lens_radius.above_zero().any();
        let for_pixel = group.pairs(paths, PIXEL_DIMENSION, [Purpose::Pixel; 2]);
        let for_lens = if has_lens {
            group.pairs(paths, LENS_DIMENSION, [Purpose::Lens; 2])
        } else {
            [T::ZERO; 2]
        };
        let [x, y] = &paths.pixels;
        let pixel = [group.integer(x), group.integer(y)];
        let [origin, direction] = pixel_ray(&self.camera, pixel, self.settings.image_size, [for_pixel, for_lens]);
        group.set_vector(&mut paths.origin, group.mask(), origin);
        group.set_vector(&mut paths.state.direction, group.mask(), direction);
        let members = group.members(&paths.state.ids);
        members.record(&mut paths.outputs, group.mask(), |lane| Event::Camera {
            origin: origin.lane(lane).to_f32(),
            direction: direction.lane(lane).to_f32(),
        });
    }

    /// Share of light in [0, 1] that passes along a shadow ray: the product of (1 − opacity) of the surfaces on it.
    pub fn transmittance(&self, shadow_rays: &ShadowRays, index: usize, rays: &mut u32) -> f32 {
        let (mut origin, direction) = (shadow_rays.origin.get(index), shadow_rays.direction.get(index));
        let (mut transmittance, mut remaining) = (1.0, shadow_rays.distance[index]);
        for _ in 0..PASSES_MAX {
            *rays += 1;
            let Some(hit) = self.geometry.intersect(origin.to_f32(), direction.to_f32(), remaining) else {
                return transmittance;
            };
            transmittance *= 1.0 - hit_opacity(self.geometry, self.scalar_materials, self.textures, &hit);
            if transmittance <= 0.0 {
                break;
            }
            remaining -= hit.t;
            origin = passed_origin(self.geometry, &hit, direction);
        }
        0.0
    }

    /// Intersects the ray of the path at `index`, passing surfaces at random by their opacity. Returns false for a miss.
    #[inline(always)]
    pub fn intersect<R: Recorder>(&self, bounce: u32, index: usize, paths: &mut Paths<R>) -> bool {
        if paths.is_known_miss[index] {
            return false;
        }
        let (mut origin, direction) = (paths.origin.get(index), paths.state.direction.get(index));
        let dimension = OPACITY_DIMENSION + bounce;
        let [mut xi, _]: [f32; 2] = random_pair(paths.random_state(index), dimension);
        paths.output_at(index).recorder.record(|| Event::Number {
            dimension,
            half: 0,
            value: xi,
            purpose: Purpose::Opacity,
        });
        let mut distance = 0.0;
        for _ in 0..PASSES_MAX {
            let hit = self.geometry.intersect(origin.to_f32(), direction.to_f32(), f32::MAX);
            if !paths.record_hit(index, hit) {
                return false;
            }
            let hit = paths.state.hits[index];
            distance += hit.t;
            paths.state.distance[index] = distance;
            let slot = self.geometry.slot(hit.triangle as usize);
            let opacity = if bounce == 0 && slot >= self.settings.first_hidden_slot {
                0.0
            } else {
                hit_opacity(self.geometry, self.scalar_materials, self.textures, &hit)
            };
            if xi < opacity {
                return true;
            }
            paths.output_at(index).recorder.record(|| Event::Passed {
                slot,
                distance: hit.t,
                opacity,
            });
            // Uniform again, given that the surface did not stop the ray.
            xi = (xi - opacity) / (1.0 - opacity).max(1e-20);
            origin = passed_origin(self.geometry, &hit, direction);
        }
        paths.cut += f64::from(paths.state.throughput.get(index).luminance());
        false
    }
}
