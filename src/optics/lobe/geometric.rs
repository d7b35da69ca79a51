//! The geometric lobe: the mirror direction plus a random vector (paper, eqs. 8 to 10), and its density, which the
//! paper calls unavailable (docs/MATHEMATICS.md, section 4).
//!
//! In the frame where the lobe is a unit ball (widths M divided out) a sample is a + D (V + κ n), a = (1 − R) M⁻¹ r,
//! κ = R; `chord` has the density there.

use super::*;
use crate::optics::{
    chord::chord_density, curve::curve_distance, frame::world_from_local, numeric::normalize_or, warp::uniform_sphere,
};

/// Properties of the lobe.
pub const TRAITS: LobeTraits = LobeTraits {
    // The horizon policy decides about samples below the surface.
    is_hemispherical: false,
    is_anisotropic: true,
    // Refraction turns the lobe about the refracted direction.
    facets: Facets::None,
    width: Width::Roughness,
    has_curves: true,
    weighs_one: true,
    loses_light: false,
    // The density is infinite in the mirror direction.
    peak: 0.03,
};

inlined! {
    /// Widths of the lobe along the frame's axes: R itself three times, or stretched with the product of the first two kept.
    fn widths<T: Real>(shape: &LobeShape<'_, T>) -> Vec3<T> {
        let stretch = stretch_from_anisotropy(shape.anisotropy);
        vec3(shape.roughness * stretch, shape.roughness / stretch, shape.roughness)
    }

    /// The mirror direction plus a random vector: w = (1 − R) r + R (V + R n) D(ξ), normalised (paper, eqs. 8 to 10). The
    /// anisotropic lobe scales V + R n along the frame's axes.
    pub fn sample<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, xi: [T; 3]) -> Vec3<T> {
        let roughness = shape.roughness;
        let mirror = wo.mirrored_about(frame.normal);
        let ball = uniform_sphere([xi[0], xi[1]]) + frame.normal * roughness;
        let distance = curve_distance(shape.curve, shape.table, xi[2]);
        let spread = if is_stretched(shape) {
            let local = local_from_world(frame, ball);
            let width = widths(shape);
            world_from_local(frame, local * width)
        } else {
            ball * roughness
        };
        // R = 1 with D = 0 or V = −n leaves nothing to normalise: any direction is right for a set of measure zero.
        normalize_or(mirror * (T::ONE - roughness) + spread * distance, frame.normal)
    }

    /// The density of [`sample`] over the whole sphere, per steradian (mathematics, section 4).
    pub fn density<T: Real>(shape: &LobeShape<'_, T>, frame: &Frame<T>, wo: Vec3<T>, wi: Vec3<T>) -> T {
        let mirror = wo.mirrored_about(frame.normal);
        if !is_stretched(shape) {
            let stretch = T::ONE / shape.roughness;
            return chord_density(
                shape.curve,
                shape.table,
                shape.roughness,
                stretch,
                frame.normal,
                mirror,
                wi,
            );
        }
        let width = widths(shape);
        let (mirror, light) = (unstretched(frame, width, mirror), unstretched(frame, width, wi));
        let (mirror_length, light_length) = (mirror.length(), light.length());
        let up = vec3(T::ZERO, T::ZERO, T::ONE);
        let (mirror, light) = (mirror / mirror_length, light / light_length);
        let value = chord_density(
            shape.curve,
            shape.table,
            shape.roughness,
            mirror_length,
            up,
            mirror,
            light,
        );
        let density = value / (width.x * width.y * width.z * light_length * light_length * light_length);
        // A mirror has none: there the widths and the lengths measured in them are 0 and infinite.
        density.masked(shape.roughness.above_zero())
    }

    /// The local components of a vector in units of the lobe's widths.
    fn unstretched<T: Real>(frame: &Frame<T>, width: Vec3<T>, v: Vec3<T>) -> Vec3<T> {
        let local = local_from_world(frame, v);
        vec3(local.x / width.x, local.y / width.y, local.z / width.z)
    }

    /// Always 1: the lobe is its density.
    pub fn weight<T: Real>(_shape: &LobeShape<'_, T>, _frame: &Frame<T>, _wo: Vec3<T>, _wi: Vec3<T>) -> T {
        T::ONE
    }

    /// Lanes with different widths.
    fn is_stretched<T: Real>(shape: &LobeShape<'_, T>) -> bool {
        shape.anisotropy.differs(T::ZERO).any()
    }
}
