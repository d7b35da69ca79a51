//! The solid that a place is in.

use super::{Geometry, surface::hit_place, surface::passed_origin};
use crate::optics::{material::Material, vector::Vec3, vector::vec3};

/// The slot of no solid.
pub const NO_MEDIUM: u32 = u32::MAX;

/// Bound of the model in its radii.
const MODEL_RADIUS: f32 = 1.001;
/// Surfaces that are looked at.
const SURFACES_MAX: u32 = 256;

/// The slot of the medium around a position, found by the transmitting surfaces along a ray out of it: the first back hit
/// without its front before. `None` if no medium absorbs.
pub fn medium_at(geometry: &Geometry, materials: &[Material<f32>], position: Vec3<f32>) -> Option<u32> {
    let is_near = position.dot(position) < MODEL_RADIUS * MODEL_RADIUS;
    if !is_near
        || !materials
            .iter()
            .any(|material| material.transmits() && material.absorption.is_any())
    {
        return None;
    }
    // In no likely plane or axis of a model.
    let direction = vec3(0.36, 0.8, 0.48);
    let mut origin = position;
    let mut entered = Vec::new();
    for _ in 0..SURFACES_MAX {
        let hit = geometry.intersect(origin.to_f32(), direction.to_f32(), f32::MAX)?;
        let slot = geometry.slot(hit.triangle as usize);
        if materials[slot as usize].transmits() {
            let is_back = hit_place(geometry, &[hit], direction).is_back;
            let known = entered.iter().rposition(|other| *other == slot);
            match (is_back, known) {
                (false, _) => entered.push(slot),
                (true, Some(front)) => {
                    entered.remove(front);
                }
                (true, None) => return Some(slot),
            }
        }
        origin = passed_origin(geometry, &hit, direction);
    }
    None
}
