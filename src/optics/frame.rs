//! The frame of a surface point.

use crate::optics::prelude::*;

/// A right-handed orthonormal frame in world space, its third axis the shading normal.
#[derive(Clone, Copy, Debug)]
pub struct Frame<T> {
    /// First axis, along which anisotropic roughness is measured.
    pub tangent: Vec3<T>,
    /// Second axis.
    pub bitangent: Vec3<T>,
    /// Third axis: the shading normal.
    pub normal: Vec3<T>,
}

inlined! {
    /// A frame around a unit normal, without branches (Duff et al., "Building an orthonormal basis, revisited", JCGT 2017).
    pub fn frame_from_normal<T: Real>(normal: Vec3<T>) -> Frame<T> {
        let sign = T::select(normal.z.below_zero(), -T::ONE, T::ONE);
        let a = -T::ONE / (sign + normal.z);
        let b = normal.x * normal.y * a;
        Frame {
            tangent: vec3(T::ONE + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
            bitangent: vec3(b, sign + normal.y * normal.y * a, -normal.y),
            normal,
        }
    }

    /// A frame around a unit normal with `tangent` made perpendicular and rotated by `rotation_rad` about the normal; any
    /// tangent if the given one is parallel to the normal.
    pub fn frame_from_tangent<T: Real>(normal: Vec3<T>, tangent: Vec3<T>, rotation_rad: T) -> Frame<T> {
        let fallback = frame_from_normal(normal).tangent;
        let flat = super::numeric::normalize_or(tangent - normal * normal.dot(tangent), fallback);
        let across = normal.cross(flat);
        let tangent = flat * rotation_rad.cos() + across * rotation_rad.sin();
        Frame {
            tangent,
            bitangent: normal.cross(tangent),
            normal,
        }
    }

    /// Components of a world direction along the frame's axes.
    pub fn local_from_world<T: Real>(frame: &Frame<T>, world: Vec3<T>) -> Vec3<T> {
        vec3(
            frame.tangent.dot(world),
            frame.bitangent.dot(world),
            frame.normal.dot(world),
        )
    }

    /// The world direction with these components along the frame's axes.
    pub fn world_from_local<T: Real>(frame: &Frame<T>, local: Vec3<T>) -> Vec3<T> {
        frame.tangent * local.x + frame.bitangent * local.y + frame.normal * local.z
    }
}
