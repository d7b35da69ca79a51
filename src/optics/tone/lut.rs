//! Look-up tables (LUTs) of colours.

use crate::optics::vector::{Vec3, vec3};

/// A table over one or three channels of codes.
#[derive(Clone, Debug, PartialEq)]
pub struct Lut {
    /// A table that codes go through first.
    pub before: Option<Box<Lut>>,
    /// Entries along each side, at least 2.
    pub size: usize,
    /// True for a curve per channel, false for a cube with red varying fastest.
    pub is_one_dimensional: bool,
    /// Inputs of the first and the last entries.
    pub domain: [[f32; 3]; 2],
    /// `size` entries, or `size`³.
    pub entries: Vec<[f32; 3]>,
}

impl Lut {
    /// Applies the table to codes, linear between entries; codes are clamped to the domain.
    pub fn apply(&self, codes: Vec3<f32>) -> Vec3<f32> {
        let last = (self.size - 1) as f32;
        let [low, high] = self.domain;
        let codes = self
            .before
            .as_ref()
            .map_or(codes, |before| before.apply(codes))
            .to_f32();
        let place = |i: usize| {
            let share = (codes[i] - low[i]) / (high[i] - low[i]);
            // NaN counts as the lowest input.
            let at = last * if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
            let entry = (at as usize).min(self.size - 2);
            (entry, at - entry as f32)
        };
        let places = [place(0), place(1), place(2)];
        if self.is_one_dimensional {
            let along = |i: usize| {
                let (entry, share) = places[i];
                let [a, b] = [self.entries[entry][i], self.entries[entry + 1][i]];
                a + (b - a) * share
            };
            return vec3(along(0), along(1), along(2));
        }
        let [(r, along_r), (g, along_g), (b, along_b)] = places;
        let at = |i: usize, j: usize, k: usize| {
            Vec3::from_f32(self.entries[(r + i) + self.size * ((g + j) + self.size * (b + k))])
        };
        let row = |j: usize, k: usize| at(0, j, k).mix(at(1, j, k), along_r);
        let plane = |k: usize| row(0, k).mix(row(1, k), along_g);
        plane(0).mix(plane(1), along_b)
    }
}
