//! Light groups: the light of each group's sources summed apart, beside the film's sums of all light. Their mix is another
//! image of the same samples.

use std::borrow::Cow;

use super::film::{Film, HalfSums, Image, LightSums, luminance};
use crate::parallel;

/// Light groups at most.
pub const LIGHT_GROUPS_MAX: usize = 16;
/// The group of the environment and of the background.
pub const ENVIRONMENT_GROUP: u32 = 0;

impl Film {
    /// Number of light groups that are summed apart.
    pub fn light_groups(&self) -> usize {
        self.lights.len() / self.pixel_count().max(1)
    }

    /// Sums of the light groups of a pixel.
    pub fn lights(&self, pixel: usize) -> &[LightSums] {
        let groups = self.light_groups();
        &self.lights[pixel * groups..(pixel + 1) * groups]
    }

    /// Adds the light of each group to one half of a pixel's samples.
    pub fn add_lights(&mut self, pixel: usize, half: usize, lights: impl IntoIterator<Item = [f64; 3]>) {
        let groups = self.light_groups();
        let sums = &mut self.lights[pixel * groups..(pixel + 1) * groups];
        for (sums, light) in sums.iter_mut().zip(lights) {
            (0..3).for_each(|channel| sums[half][channel] += light[channel]);
        }
    }

    /// Adds other sums of a group in a pixel.
    pub fn add_light(&mut self, pixel: usize, group: usize, more: LightSums) {
        let place = pixel * self.light_groups() + group;
        let sums = self.lights[place].as_flattened_mut().iter_mut();
        sums.zip(more.as_flattened()).for_each(|(sum, more)| *sum += more);
    }

    /// The mean light of a group: linear RGB with an alpha of 1.
    pub fn light_image(&self, group: usize) -> Image {
        let mean = |pixel: usize| {
            let samples = self.samples_of(pixel).max(1.0);
            let [even, odd] = self.lights(pixel)[group];
            let mean = |channel: usize| ((even[channel] + odd[channel]) / samples) as f32;
            [mean(0), mean(1), mean(2), 1.0]
        };
        self.image_of(mean)
    }

    /// The film with a factor per channel on each group's light, without the groups; itself if no factor differs from 1. The spread of a
    /// pixel's samples changes with the square of its luminance, which is exact where one group lights it.
    pub fn mixed(&self, factors: &[[f64; 3]]) -> Cow<'_, Film> {
        if self.lights.is_empty() || factors.iter().flatten().all(|factor| *factor == 1.0) {
            return Cow::Borrowed(self);
        }
        let mixed = |pixel: usize| {
            let halves = self.pixels[pixel];
            std::array::from_fn(|number| {
                let lights = self.lights(pixel).iter().map(|sums| sums[number]);
                mixed_half(&halves[number], lights.zip(factors))
            })
        };
        Cow::Owned(Film {
            pixels: parallel::map(self.pixels.len(), mixed),
            coverage: self.coverage.clone(),
            guides: self.guides.clone(),
            lights: Vec::new(),
            costs: self.costs.clone(),
            ..*self
        })
    }
}

fn mixed_half<'f>(half: &HalfSums, lights: impl Iterator<Item = ([f64; 3], &'f [f64; 3])>) -> HalfSums {
    let mut color = [0.0; 3];
    for (light, factor) in lights {
        (0..3).for_each(|channel| color[channel] += factor[channel] * light[channel]);
    }
    let before = half.luminance();
    let ratio = if before > 0.0 { luminance(color) / before } else { 1.0 };
    HalfSums {
        color,
        squared_deviations: half.squared_deviations * ratio * ratio,
        samples: half.samples,
    }
}
