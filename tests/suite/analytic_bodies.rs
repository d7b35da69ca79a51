//! Bodies whose picture is known in closed form, for the table of scenes: glass that absorbs, balls, discs, edges.

use glam::DVec3;
use glossmith::{optics::fresnel::fresnel_dielectric, scene::mesh::Mesh};

use crate::analytic_scenes::{CLEAR, Case, MIS, add_box};

/// What glass passes on over a way of 1.
const COLORS: [f64; 3] = [0.8, 0.5, 0.2];

/// What a cube of side 2 shows of an environment of radiance 1, along a view that meets its upper face at a place: at each
/// face a part gets out, the rest is reflected, and the same glass tints all of it.
fn cube_radiance(ior: f64, place: DVec3, towards_viewer: DVec3) -> [f64; 3] {
    let across = -towards_viewer / ior;
    let mut direction = DVec3::new(across.x, 0.0, across.z);
    direction.y = -(1.0 - direction.length_squared()).sqrt();
    let reflected = fresnel_dielectric(towards_viewer.y, ior);
    let mut found = [reflected; 3];
    let mut weights = [1.0 - reflected; 3];
    let mut place = place;
    while weights.iter().any(|weight| *weight > 1e-12) {
        let to_face = DVec3::from_array([0, 1, 2].map(|i| (direction[i].signum() - place[i]) / direction[i]));
        let axis = [0, 1, 2]
            .into_iter()
            .min_by(|&a, &b| to_face[a].total_cmp(&to_face[b]))
            .unwrap();
        let reflected = fresnel_dielectric(direction[axis].abs(), 1.0 / ior);
        for ((found, weight), color) in found.iter_mut().zip(&mut weights).zip(COLORS) {
            *weight *= color.powf(to_face[axis]);
            *found += *weight * (1.0 - reflected);
            *weight *= reflected;
        }
        place += direction * to_face[axis];
        direction[axis] = -direction[axis];
    }
    found
}

/// Glass that absorbs in the furnace: without refraction, where only the way through it counts, and with total reflection.
pub fn cubes() -> Vec<Case> {
    let place = DVec3::new(0.13, 1.0, -0.22);
    let towards_viewer = DVec3::new(0.5, 0.7, 0.35).normalize();
    let mut cube = Mesh::default();
    add_box(&mut cube, DVec3::ZERO, DVec3::ONE, false);
    // A way of 1 in bounding radii.
    let tinted = format!(
        "transmission.color=0.8,0.5,0.2 transmission.depth={}",
        1.0 / 3.0_f64.sqrt()
    );
    let case = |(ior, samples): (f64, u32)| {
        let case = Case::new(
            format!("cube that absorbs, of ior {ior}"),
            &[CLEAR, &tinted, &format!("specular.ior={ior}")],
            cube_radiance(ior, place, towards_viewer),
        );
        let from = (place + 2.0 * towards_viewer).to_array();
        case.of(cube.clone()).seen(from, place.to_array()).by(MIS, samples)
    };
    [(1.0, 16), (1.5, 2048)].map(case).into()
}
