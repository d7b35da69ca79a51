//! Bodies whose picture is known in closed form, for the table of scenes: glass that absorbs, balls, discs, edges.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec3, Vec2};
use glossmith::analysis::quadrature::{gauss_legendre, integrate};
use glossmith::document::{MaterialSettings, assign};
use glossmith::optics::fresnel::fresnel_dielectric;
use glossmith::optics::lobe::Lobe;
use glossmith::scene::mesh::Mesh;
use glossmith::scene::shapes::sphere;

use crate::analytic_lobes::lobe_case;
use crate::analytic_scenes::{BY_LIGHT, CLEAR, Case, MATT, MIS, add_box, add_rectangle};

/// Every case.
pub fn bodies() -> Vec<Case> {
    let mut cases = Vec::new();
    cases.extend(cubes());
    cases.push(glass_ball());
    cases.extend(balls());
    cases.push(disc());
    cases.extend(edges());
    cases
}

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
fn cubes() -> Vec<Case> {
    let place = DVec3::new(0.13, 1.0, -0.22);
    let towards_viewer = DVec3::new(0.5, 0.7, 0.35).normalize();
    let mut cube = Mesh::default();
    add_box(&mut cube, DVec3::ZERO, DVec3::ONE, false);
    // A way of 1 in bounding radii.
    let depth = format!("transmission.depth={}", 1.0 / 3.0_f64.sqrt());
    let tinted = ["transmission.color=0.8,0.5,0.2", &depth];
    let case = |(ior, samples)| {
        let ior_set = format!("specular.ior={ior}");
        let case = Case::new(
            format!("cube that absorbs, of ior {ior}"),
            &[&CLEAR, &tinted, &[&ior_set]],
            cube_radiance(ior, place, towards_viewer),
        );
        let from = (place + 2.0 * towards_viewer).to_array();
        case.of(cube.clone()).seen(from, place.to_array()).by(MIS, samples)
    };
    [(1.0, 16), (1.5, 2048)].map(case).into()
}

/// A ball that absorbs and does not refract, as a whole.
fn glass_ball() -> Case {
    let set = [
        "transmission.color=0.8,0.5,0.2",
        "transmission.depth=1",
        "specular.ior=1",
    ];
    let expected = COLORS.map(|color| mean_of_ball(|sin| color.powf(2.0 * (1.0 - sin * sin).sqrt())));
    whole_ball(Case::new("ball that absorbs", &[&CLEAR, &set], expected)).by(MIS, 4096)
}

/// From so many radii the camera sees a ball.
const DISTANCE: f64 = 4.0;
/// Half the picture's side, at a distance of 1: more than the ball takes.
const HALF_SIDE: f64 = 0.27;

/// A picture of the unit ball.
fn whole_ball(case: Case) -> Case {
    let mut case = case.of(sphere(192, 96)).seen([0.0, 0.0, DISTANCE], [0.0; 3]).uneven();
    case.document.camera.fov_deg = 2.0 * HALF_SIDE.atan().to_degrees();
    case
}

/// The mean of that picture, where the radiance goes by the sine of the angle between view and normal.
fn mean_of_ball(radiance: impl Fn(f64) -> f64) -> f64 {
    let ring = |angle: f64| {
        let square = (angle.sin() / DISTANCE).powi(2);
        radiance(angle.sin()) * (2.0 * angle).sin() / DISTANCE.powi(2) / (1.0 - square).powi(2)
    };
    PI * integrate(&gauss_legendre(24), 0.0, FRAC_PI_2, ring) / (2.0 * HALF_SIDE).powi(2)
}

/// A ball of each lobe in a uniform field shows the lobe's albedo at each angle.
fn balls() -> Vec<Case> {
    let case = |lobe: &Lobe| {
        // Its samples are of many weights.
        let samples = if *lobe == Lobe::GgxNdf { 4096 } else { 1024 };
        whole_ball(lobe_case("ball of", *lobe, 0.5, |albedo| mean_of_ball(albedo))).by(MIS, samples)
    };
    Lobe::ALL.iter().map(case).collect()
}

/// A matt plane under a disc that shines, on its axis. The disc's many triangles have its area.
fn disc() -> Case {
    const CORNERS: u32 = 128;
    const RADIUS: f64 = 0.5;
    const HEIGHT: f64 = 0.7;
    let mut mesh = Mesh::default();
    add_rectangle(&mut mesh, DVec3::ZERO, DVec3::X, DVec3::Z, 0);
    let step = TAU / f64::from(CORNERS);
    let radius = RADIUS * (step / step.sin()).sqrt();
    let mut vertex =
        |place: DVec3| mesh.push_vertex(place, -glam::Vec3::Y, Vec2::ZERO, glam::Vec4::new(1.0, 0.0, 0.0, 1.0));
    let middle = vertex(HEIGHT * DVec3::Y);
    let rim: Vec<u32> = (0..CORNERS)
        .map(|i| {
            let (sin, cos) = (f64::from(i) * step).sin_cos();
            vertex(DVec3::new(radius * cos, HEIGHT, radius * sin))
        })
        .collect();
    for i in 0..CORNERS as usize {
        mesh.push_triangle([middle, rim[i], rim[(i + 1) % rim.len()]], 1);
    }
    let seen = RADIUS * RADIUS / (RADIUS * RADIUS + HEIGHT * HEIGHT);
    Case::new(
        "plane under a disc",
        &[&MATT, &["base.color=0.8,0.4,0.2"]],
        [0.8, 0.4, 0.2].map(|color| 5.0 * color * seen),
    )
    .of(mesh)
    .in_the_dark()
    .with(|document| {
        let mut shining = MaterialSettings::diffuse("shining", [0.0; 3]);
        assign(&mut shining, "emission.strength=5").unwrap();
        assign(&mut shining, "specular.weight=0").unwrap();
        document.materials.push(shining);
    })
    .seen([4.0, 3.0, 0.0], [0.0; 3])
    .by(BY_LIGHT, 512)
}

/// A straight edge out of focus: the share of the lens that sees past it is a segment of a circle.
fn edges() -> Vec<Case> {
    const BLUR: f64 = 0.5;
    let case = |offset: f64| {
        let share = offset / BLUR;
        let expected = 0.5 + (share.asin() + share * (1.0 - share * share).sqrt()) / PI;
        let mut mesh = Mesh::default();
        add_rectangle(&mut mesh, (2.0 - offset) * DVec3::X, 2.0 * DVec3::X, 2.0 * DVec3::Z, 0);
        let shining = ["base.color=0,0,0", "emission.color=1,1,1", "emission.strength=1"];
        let mut case = Case::new(
            format!("edge out of focus, {offset} off"),
            &[&MATT, &shining],
            [expected; 3],
        )
        .of(mesh)
        .in_the_dark()
        .with(|document| {
            // Twice as far as what is sharp, a place is as blurred as the lens is wide.
            document.camera.focus_distance = Some(2.0);
            document.camera.aperture = BLUR / 8.0_f64.sqrt();
        })
        .seen([0.0, 4.0, 0.0], [0.0; 3])
        .by(MIS, 2048);
        // Pixels beside each other see past it by different shares.
        case.document.camera.fov_deg = 0.01;
        case
    };
    [-0.3, 0.0, 0.2].map(case).into()
}
