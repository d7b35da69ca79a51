//! What the paths of a wave have found in the end, field by field.

use super::PathResult;
use super::group::Group;
use super::paths::Vectors;
use crate::job::guides::GuideSums;
use crate::optics::real::{Real, Scalar};
use crate::optics::vector::Vec3;

/// What paths have found, by their numbers in the wave. Behind the last there is room for as many as there are lanes.
pub struct Results<S> {
    count: usize,
    /// See [`Results::have_more`].
    has_more: bool,
    /// Sum of the luminances of the throughputs of paths that ended at their last bounce.
    pub cut: f64,
    radiance: Vectors<S>,
    alpha: Vec<S>,
    clamped: Vec<S>,
    rays: Vec<u32>,
    /// Empty where no path tells what it sees.
    seen: Vec<GuideSums>,
}

impl<S: Scalar> Results<S> {
    /// Room for those of as many paths.
    pub(super) fn new(count: usize) -> Self {
        Self {
            count: 0,
            has_more: false,
            cut: 0.0,
            radiance: Vectors::new(count),
            alpha: vec![S::zero(); count],
            clamped: vec![S::zero(); count],
            rays: vec![0; count],
            seen: Vec::with_capacity(count),
        }
    }

    /// What one path has found.
    pub fn get(&self, path: usize) -> PathResult<S> {
        PathResult {
            radiance: self.radiance.get(path),
            alpha: self.alpha[path],
            rays: self.rays[path],
            clamped: self.clamped[path],
            seen: self.seen.get(path).copied().unwrap_or_default(),
        }
    }

    /// The radiances of `N` paths from one on, channel by channel; of less where there are no more, then whatever.
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

    /// Rays traced by all paths.
    pub fn rays(&self) -> u64 {
        self.rays[..self.count].iter().copied().map(u64::from).sum()
    }

    /// Whether any path may have found more than radiance and alpha, as fireflies are limited or paths tell what they see.
    pub fn have_more(&self) -> bool {
        self.has_more
    }

    /// Forgets all, and has as many paths take their place whose first rays have been traced.
    pub(super) fn start(&mut self, count: usize, has_more: bool) {
        (self.count, self.has_more, self.cut) = (count, has_more, 0.0);
        self.seen.clear();
        self.rays[..count].fill(1);
    }

    /// Puts in what all paths have found.
    pub(super) fn fill(&mut self, results: impl Iterator<Item = PathResult<S>>) {
        for (path, result) in results.enumerate() {
            self.radiance.set(path, result.radiance);
            self.alpha[path] = result.alpha;
            self.clamped[path] = result.clamped;
            self.rays[path] = result.rays;
            if self.has_more {
                self.seen.push(result.seen);
            }
        }
    }

    /// Sets what paths have found that lie side by side.
    #[inline(always)]
    pub(super) fn set<T: Real<Scalar = S>>(&mut self, group: &Group<T>, radiance: Vec3<T>, alpha: T, clamped: T) {
        let mask = group.mask();
        group.set_vector(&mut self.radiance, mask, radiance);
        group.set_number(&mut self.alpha, mask, alpha);
        group.set_number(&mut self.clamped, mask, clamped);
    }
}
