//! The camera rays of a tile, and tiles in which they meet nothing: most of many a picture, of which no path is made.

use super::path::{Path, Ray};
use super::wave::{Tile, WavePath};
use super::{Integrator, PathResult};
use crate::cpu::recorder::Unrecorded;
use crate::instructions;
use crate::job::BackgroundKind;
use crate::job::features::GuideSums;
use crate::optics::random::{RandomState, path_state, random_pairs};
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;
use crate::scene::camera::{LENS_DIMENSION, PIXEL_DIMENSION, pixel_ray};
use crate::scene::{Hit, PACKET, Packet};

/// The first ray of a path.
pub(super) struct CameraRay<S> {
    /// The counters from which the path draws its numbers.
    state: RandomState,
    origin: Vec3<S>,
    /// Unit vector.
    direction: Vec3<S>,
}

impl<T: Real> Integrator<'_, T> {
    /// The camera rays of samples of all pixels of a tile, sample by sample.
    pub(super) fn camera_rays(&self, tile: &Tile, samples: std::ops::Range<u32>) -> Vec<CameraRay<T::Scalar>> {
        let mut rays = Vec::with_capacity(samples.len() * tile.places.len());
        T::vectorize(
            #[inline(always)]
            || {
                for sample in samples {
                    for places in tile.places.chunks(T::LANES) {
                        self.rays_side_by_side(tile.origin, places, sample, &mut rays);
                    }
                }
            },
        );
        rays
    }

    /// The same of one sample of as many pixels as there are lanes at most.
    #[inline(always)]
    fn rays_side_by_side(
        &self,
        corner: [u32; 2],
        places: &[[u32; 2]],
        sample: u32,
        rays: &mut Vec<CameraRay<T::Scalar>>,
    ) {
        let settings = self.settings;
        let pixel = |lane: usize| {
            let [x, y] = places[lane.min(places.len() - 1)];
            [corner[0] + x, corner[1] + y]
        };
        let states = T::each(|lane| {
            let [x, y] = pixel(lane);
            path_state(x, y, settings.seed, sample, settings.sequence)
        });
        let states = states.as_ref();
        let pair = |dimension: u32| {
            let (keys, samples) = (T::each(|lane| states[lane].key), T::each(|lane| states[lane].sample));
            random_pairs::<T>(&keys, &samples, settings.sequence, dimension)
        };
        let has_lens = T::zero().less(self.camera.lens_radius).any();
        let for_lens = if has_lens { pair(LENS_DIMENSION) } else { [T::zero(); 2] };
        let number = |number: u32| T::Scalar::from_f64(f64::from(number));
        let pixels = [0, 1].map(|axis| T::from_lanes(|lane| number(pixel(lane)[axis])));
        let numbers = [pair(PIXEL_DIMENSION), for_lens];
        let [origin, direction] = pixel_ray(&self.camera, pixels, settings.image_size, numbers);
        let (origins, directions) = (origin.to_each(), direction.to_each());
        rays.extend((0..places.len()).map(|lane| CameraRay {
            state: states[lane],
            origin: origins.as_ref()[lane],
            direction: directions.as_ref()[lane],
        }));
    }

    /// What camera rays meet where no surface has holes: those of squares of pixels together.
    pub(super) fn trace_camera_rays(&self, tile: &Tile, rays: &[CameraRay<T::Scalar>], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        // All pixels of all samples are there.
        for together in rays.chunks(tile.places.len()).flat_map(|sample| sample.chunks(PACKET)) {
            let mut packet = Packet::default();
            for (lane, ray) in together.iter().enumerate() {
                packet.set(lane, ray.origin.to_f32(), ray.direction.to_f32(), f32::MAX);
            }
            packet.fill(together.len());
            let met = self.geometry.intersect_packet(instructions::level(), &packet);
            hits.extend_from_slice(&met[..together.len()]);
        }
    }

    /// Whether what is seen behind everything takes no more than looking it up.
    pub(super) fn has_plain_background(&self) -> bool {
        !matches!(self.settings.background, BackgroundKind::Blurred(_))
    }

    /// What paths find whose camera rays meet nothing.
    pub(super) fn see_background(
        &self,
        rays: &[CameraRay<T::Scalar>],
        mut tell: impl FnMut(usize, &PathResult<T::Scalar>),
    ) {
        T::vectorize(
            #[inline(always)]
            || {
                for (chunk, rays) in rays.chunks(T::LANES).enumerate() {
                    let ray = |lane: usize| &rays[lane.min(rays.len() - 1)];
                    let place = self.left_places(Vec3::from_lanes(|lane| ray(lane).direction), 0);
                    let (radiance, alpha) = self.plain_background(place);
                    let [added, taken] = self.limited(radiance, 0);
                    let (radiances, alphas) = (added.to_each(), alpha.to_each());
                    let clamped = taken.luminance().to_each();
                    for lane in 0..rays.len() {
                        let found = PathResult {
                            radiance: radiances.as_ref()[lane],
                            alpha: alphas.as_ref()[lane],
                            rays: 1,
                            clamped: clamped.as_ref()[lane],
                            seen: GuideSums::default(),
                        };
                        tell(chunk * T::LANES + lane, &found);
                    }
                }
            },
        );
    }

    /// The paths of camera rays.
    pub(super) fn paths(&self, tile: &Tile, first: u32, rays: &[CameraRay<T::Scalar>]) -> Vec<WavePath<T>> {
        let mut paths = Vec::with_capacity(rays.len());
        for (sample, rays) in (first..).zip(rays.chunks(tile.places.len())) {
            for (&[x, y], ray) in tile.places.iter().zip(rays) {
                let pixel = [tile.origin[0] + x, tile.origin[1] + y];
                let mut path = Path::new(ray.state, pixel, sample < self.guide_samples, Unrecorded);
                path.ray = Ray::of_camera(ray.origin, ray.direction);
                paths.push(path);
            }
        }
        paths
    }
}
