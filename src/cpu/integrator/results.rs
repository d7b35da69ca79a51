//! Results of a wave's paths as structure of arrays.

use super::{PathResult, group::Group, vectors::Vectors};
use crate::job::guides::GuideSums;
use crate::optics::prelude::*;
use std::ops::Range;

/// Results by path id. The fields have room for one more group of lanes.
pub struct Results {
    count: usize,
    /// Whether results have more than radiance and alpha: clamped luminance or guides.
    pub has_extras: bool,
    /// Sum over paths of the throughput's luminance where the bounce limit ended them.
    pub cut: f64,
    radiance: Vectors,
    alpha: Vec<f32>,
    clamped: Vec<f32>,
    rays: Vec<u32>,
    /// First-hit guides; empty if no path records them.
    guides: Vec<GuideSums>,
    /// Light of each group, those of a path in a row; empty if they are not summed apart.
    pub light_groups: Vec<Vec3<f32>>,
}

impl Results {
    /// Fields for `count` paths.
    pub fn new(count: usize) -> Self {
        Self {
            count: 0,
            has_extras: false,
            cut: 0.0,
            radiance: Vectors::new(count),
            alpha: vec![0.0; count],
            clamped: vec![0.0; count],
            rays: vec![0; count],
            guides: Vec::with_capacity(count),
            light_groups: Vec::new(),
        }
    }

    /// The result of one path.
    pub fn get(&self, path: usize) -> PathResult {
        PathResult {
            radiance: self.radiance.get(path),
            alpha: self.alpha[path],
            rays: self.rays[path],
            clamped: self.clamped[path],
            guides: self.guides.get(path).copied().unwrap_or_default(),
        }
    }

    /// Light of each group of one path; empty if they are not summed apart.
    pub fn groups(&self, path: usize) -> impl Iterator<Item = [f64; 3]> {
        let groups = self.light_groups.len() / self.count.max(1);
        let lights = &self.light_groups[path * groups..(path + 1) * groups];
        lights.iter().map(|light| light.to_f64())
    }

    /// Radiances of `N` consecutive paths, channel by channel; arbitrary beyond the last path.
    #[inline(always)]
    pub fn radiances<const N: usize>(&self, first: usize) -> [[f64; N]; 3] {
        let mut radiances = [[0.0; N]; 3];
        let Vectors { x, y, z } = &self.radiance;
        for (channel, numbers) in radiances.iter_mut().zip([x, y, z]) {
            for (to, number) in channel.iter_mut().zip(&numbers[first..first + N]) {
                *to = number.to_f64();
            }
        }
        radiances
    }

    /// Number of rays traced by some paths.
    pub fn rays(&self, paths: Range<usize>) -> u64 {
        self.rays[paths].iter().copied().map(u64::from).sum()
    }

    /// Starts over with `count` paths, each counting its camera ray.
    pub fn start(&mut self, count: usize, has_extras: bool) {
        (self.count, self.has_extras, self.cut) = (count, has_extras, 0.0);
        self.guides.clear();
        self.guides
            .resize(if has_extras { count } else { 0 }, GuideSums::default());
        self.rays[..count].fill(1);
    }

    /// Stores the result of one path.
    pub fn put(&mut self, path: usize, result: PathResult) {
        self.radiance.set(path, result.radiance);
        self.alpha[path] = result.alpha;
        self.clamped[path] = result.clamped;
        self.rays[path] = result.rays;
        if let Some(guides) = self.guides.get_mut(path) {
            *guides = result.guides;
        }
    }

    /// Stores the results of a group of consecutive paths.
    #[inline(always)]
    pub fn set<T: Single>(&mut self, group: &Group<T>, radiance: Vec3<T>, alpha: T, clamped: T) {
        let mask = group.mask();
        group.set_vector(&mut self.radiance, mask, radiance);
        group.set_number(&mut self.alpha, mask, alpha);
        group.set_number(&mut self.clamped, mask, clamped);
    }
}
