//! Shapes that are given by numbers, as meshes of unit size around Y.

use glam::{DMat3, DMat4, DVec2, DVec3, dvec2};
use openusd::{usd::Prim, usd::TimeCode};

use super::{kind, scene::value_at, text_of};
use crate::scene::{mesh::Mesh, shapes::Profile, shapes::rectangle};

/// Steps of half a circle.
const HALF: u32 = 32;

/// The kind of a shape, and the place of its unit mesh; `None` of other prims.
pub fn shape(prim: &Prim, time: TimeCode) -> Option<(String, DMat4)> {
    let number = |name: &str, default: f64| {
        let found = value_at(&prim.attribute(name), time).and_then(|value| value.cast::<f64>().ok());
        found.filter(|x| x.is_finite()).unwrap_or(default)
    };
    let (kind, radius) = (kind(prim), number("radius", 1.0));
    let size = match &*kind {
        "Sphere" => DVec3::splat(radius),
        "Cube" => DVec3::splat(number("size", 2.0) / 2.0),
        "Cylinder" | "Cone" => DVec3::new(radius, number("height", 2.0) / 2.0, radius),
        _ => return None,
    };
    let axis = match text_of(&prim.attribute("axis")).as_deref() {
        Some("X") => DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y),
        Some("Y") => DMat3::IDENTITY,
        _ => DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y),
    };
    Some((kind, DMat4::from_mat3(axis * DMat3::from_diagonal(size))))
}

pub fn unit_mesh(kind: &str, slot: u32) -> Mesh {
    let mut profile = Profile::start(DVec2::Y);
    let mut lines = |ends: &[[f64; 2]]| ends.iter().for_each(|[x, y]| profile.line(dvec2(*x, *y), 1));
    match kind {
        "Cylinder" => lines(&[[1.0, 1.0], [1.0, -1.0], [0.0, -1.0]]),
        "Cone" => lines(&[[1.0, -1.0], [0.0, -1.0]]),
        "Sphere" => profile.arc(DVec2::ZERO, 1.0, 90.0, -90.0, HALF),
        _ => {
            let mut cube = Mesh::default();
            for side in [DVec3::X, DVec3::Y, DVec3::Z]
                .into_iter()
                .flat_map(|axis| [axis, -axis])
            {
                let (u, v) = side.any_orthonormal_pair();
                cube.append(rectangle(side, v, u, 1.0, slot));
            }
            return cube;
        }
    }
    profile.revolve(2 * HALF, slot)
}
