//! Vectors of the paths of a wave as structure of arrays.

use crate::optics::vector::{Vec3, vec3};

/// A vector per path, axis by axis.
pub struct Vectors {
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    pub z: Vec<f32>,
}

impl Vectors {
    /// Zero vectors.
    pub fn new(count: usize) -> Self {
        Self {
            x: vec![0.0; count],
            y: vec![0.0; count],
            z: vec![0.0; count],
        }
    }

    pub fn get(&self, index: usize) -> Vec3<f32> {
        vec3(self.x[index], self.y[index], self.z[index])
    }

    pub fn set(&mut self, index: usize, value: Vec3<f32>) {
        (self.x[index], self.y[index], self.z[index]) = (value.x, value.y, value.z);
    }

    pub fn fill(&mut self, value: f32) {
        self.x.fill(value);
        self.y.fill(value);
        self.z.fill(value);
    }

    /// Gathers vectors from `from` by index.
    pub fn gather(&mut self, from: &Self, order: &[u16]) {
        gather(&mut self.x, &from.x, order);
        gather(&mut self.y, &from.y, order);
        gather(&mut self.z, &from.z, order);
    }
}

/// Gathers elements of `from` by index: `field[i] = from[order[i]]`.
pub fn gather<E: Copy>(field: &mut [E], from: &[E], order: &[u16]) {
    for (to, &index) in field.iter_mut().zip(order) {
        *to = from[usize::from(index)];
    }
}
