//! Sums of tiles' pixels while samples arrive, as structure of arrays per pixel block: a block's samples are added in
//! SIMD.

use super::integrator::{BLOCK_PIXELS, Results, Tiles, is_sound};
use crate::job::{film::Film, film::HalfSums, guides::GUIDE_SAMPLES};
use crate::optics::prelude::*;

/// The sums of tiles and their part of the film.
pub struct TileSums<'a> {
    tiles: &'a Tiles,
    film: &'a mut Film,
    /// Even and odd samples of each block.
    halves: Vec<[BlockSums; 2]>,
}

impl<'a> TileSums<'a> {
    /// The sums so far; `film` is the tiles alone.
    pub fn of(film: &'a mut Film, tiles: &'a Tiles) -> Self {
        let mut sums = Self {
            tiles,
            film,
            halves: Vec::new(),
        };
        for block in tiles.blocks() {
            let mut halves = [BlockSums::default(); 2];
            for (i, place) in block.places.iter().enumerate() {
                let of_pixel = sums.film.pixels[sums.pixel(place)];
                for (half, of_pixel) in halves.iter_mut().zip(&of_pixel) {
                    half.set(i, of_pixel, of_pixel.mean_luminance(), true);
                }
            }
            sums.halves.push(halves);
        }
        sums
    }

    /// Film index of a pixel.
    fn pixel(&self, [x, y]: &[u32; 2]) -> usize {
        (y * self.film.width + x) as usize
    }

    /// Adds `count` samples of each pixel, from sample `first` on.
    pub fn add<T: Single>(&mut self, [first, count]: [u32; 2], results: &Results) {
        let (tiles, halves) = (self.tiles, &mut self.halves);
        for (costs, paths) in self.film.costs.iter_mut().zip(tiles.paths(count)) {
            costs.rays += results.rays(paths) as f64;
        }
        // Of what else is counted only the sum over the image is asked for.
        let costs = &mut self.film.costs[0];
        costs.cut += results.cut;
        vectorized!(T, {
            for (block, halves) in tiles.blocks().zip(halves) {
                for sample in 0..count {
                    let colors = results.radiances(block.path([sample, count]));
                    let mut are_sound = [false; BLOCK_PIXELS];
                    for (i, sound) in are_sound.iter_mut().enumerate() {
                        *sound = is_sound(vec3(colors[0][i], colors[1][i], colors[2][i]));
                    }
                    halves[(first + sample) as usize % 2].add(&colors, &are_sound);
                    let of_pixels = &are_sound[..block.places.len()];
                    costs.dropped += of_pixels.iter().filter(|is_sound| !**is_sound).count() as u64;
                }
            }
        });
        self.add_more([first, count], results);
    }

    /// Adds the optional sums: coverage, guides, light groups and clamped luminance.
    fn add_more(&mut self, [first, count]: [u32; 2], results: &Results) {
        let extras = self.film.extras();
        if !extras.coverage && extras.light_groups == 0 && !results.has_extras {
            return;
        }
        for sample in 0..count {
            for block in self.tiles.blocks() {
                let path = block.path([sample, count]);
                for (place, path) in block.places.iter().zip(path..) {
                    let (pixel, found) = (self.pixel(place), results.get(path));
                    if !is_sound(found.radiance) {
                        continue;
                    }
                    self.film.add_coverage(pixel, found.alpha.to_f64());
                    let half = (first + sample) as usize % 2;
                    self.film.add_lights(pixel, half, results.groups(path));
                    self.film.costs[0].clamped += found.clamped.to_f64();
                    if first + sample < GUIDE_SAMPLES {
                        self.film.add_guides(pixel, half, &found.guides);
                    }
                }
            }
        }
    }

    /// Writes the sums back to the film.
    pub fn finish(self) {
        for (block, halves) in self.tiles.blocks().zip(&self.halves) {
            for (i, place) in block.places.iter().enumerate() {
                let pixel = self.pixel(place);
                self.film.pixels[pixel] = halves.each_ref().map(|half| half.get(i));
            }
        }
    }
}

/// Sums of a pixel block, see [`HalfSums`].
#[derive(Clone, Copy, Debug, Default)]
struct BlockSums {
    color: [[f64; BLOCK_PIXELS]; 3],
    squared_deviations: [f64; BLOCK_PIXELS],
    samples: [f64; BLOCK_PIXELS],
    /// Mean luminance, needed for the next sample.
    mean_luminance: [f64; BLOCK_PIXELS],
}

impl BlockSums {
    #[inline(always)]
    fn get(&self, i: usize) -> HalfSums {
        HalfSums {
            color: self.color.map(|channel| channel[i]),
            squared_deviations: self.squared_deviations[i],
            samples: self.samples[i],
        }
    }

    /// Sets a pixel's sums if `is_set`. Branchless, so that compilers vectorise it.
    #[inline(always)]
    fn set(&mut self, i: usize, sums: &HalfSums, mean_luminance: f64, is_set: bool) {
        let [red, green, blue] = sums.color;
        let put = |to: &mut f64, value: f64| *to = if is_set { value } else { *to };
        put(&mut self.color[0][i], red);
        put(&mut self.color[1][i], green);
        put(&mut self.color[2][i], blue);
        put(&mut self.squared_deviations[i], sums.squared_deviations);
        put(&mut self.samples[i], sums.samples);
        put(&mut self.mean_luminance[i], mean_luminance);
    }

    /// Adds the sound samples, one per pixel.
    #[inline(always)]
    fn add(&mut self, colors: &[[f64; BLOCK_PIXELS]; 3], is_sound: &[bool; BLOCK_PIXELS]) {
        for i in 0..BLOCK_PIXELS {
            let mut sums = self.get(i);
            let color = [colors[0][i], colors[1][i], colors[2][i]];
            let mean = sums.add_to_mean(self.mean_luminance[i], color);
            self.set(i, &sums, mean, is_sound[i]);
        }
    }
}
