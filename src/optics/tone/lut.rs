//! Look-up tables (LUTs) of colours.

use crate::optics::vector::{Vec3, vec3};

/// A table over one or three channels of codes.
#[derive(Clone, Debug, PartialEq)]
pub struct Lut {
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
        let codes = codes.to_f32();
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube that swaps red and blue, with a bend in green, on a domain of its own.
    #[test]
    fn a_cube_is_linear_between_its_entries() {
        let size = 3;
        let at = |i: usize| i as f32 / 2.0;
        let entries = (0..27).map(|i| {
            let [r, g, b] = [at(i % size), at(i / size % size), at(i / 9)];
            [b, g * g, r]
        });
        let lut = Lut {
            size,
            is_one_dimensional: false,
            domain: [[0.0; 3], [2.0; 3]],
            entries: entries.collect(),
        };
        let found = lut.apply(vec3(0.5, 0.5, 1.7)).to_f32();
        // Half way between 0 and 0.5², as the table is linear there.
        let expected = [0.85, 0.125, 0.25];
        assert!(
            std::iter::zip(found, expected).all(|(a, b)| (a - b).abs() < 1e-6),
            "{found:?}"
        );
        assert_eq!(lut.apply(vec3(9.0, -1.0, f32::NAN)).to_f32(), [0.0, 0.0, 1.0]);
        let curves = Lut {
            size: 2,
            is_one_dimensional: true,
            domain: [[0.0; 3], [1.0; 3]],
            entries: vec![[1.0, 0.0, 0.5], [0.0, 1.0, 0.5]],
        };
        assert_eq!(curves.apply(vec3(0.25, 0.25, 0.25)).to_f32(), [0.75, 0.25, 0.5]);
    }
}
