//! Solids that absorb and have something inside, for the table of scenes: whatever a segment ends at, its length inside
//! counts.

use std::f64::consts::TAU;

use glam::{DVec3, Vec2, Vec4};
use glossmith::{document::Document, document::MaterialSettings, scene::mesh::Mesh, scene::shapes::sphere};

use crate::analytic_scenes::{ALL, BY_LIGHT, CLEAR, Case, MIS, add_box, add_rectangle};
use crate::renders::{material, set};

/// What the solids pass on over a way of 1.
const COLORS: [f64; 3] = [0.5, 0.25, 0.125];
/// Their colour, without refraction.
const TINTED: &str = "transmission.color=0.5,0.25,0.125 specular.ior=1";

/// Every case.
pub fn media() -> Vec<Case> {
    vec![
        clear_cube_in_cube(),
        camera_in_cube(),
        matt_insert(),
        lit_insert(),
        black_at_depth(),
    ]
}

/// What is left over a way.
fn kept(way: f64) -> [f64; 3] {
    COLORS.map(|color| color.powf(way))
}

fn shining(document: &mut Document) {
    let mut shining = MaterialSettings::diffuse("shining", [0.0; 3]);
    set(&mut shining, "emission.strength=1");
    document.materials.push(shining);
}

/// A cube of side 2 that absorbs, whose bounding radius is √3 in the units of a way of 1.
fn cube(name: &str, inside: impl FnOnce(&mut Mesh), expected: [f64; 3]) -> Case {
    let mut mesh = Mesh::default();
    add_box(&mut mesh, DVec3::ZERO, DVec3::ONE, false);
    inside(&mut mesh);
    let depth = format!("transmission.depth={}", 1.0 / 3.0_f64.sqrt());
    let case = Case::new(name, &[CLEAR, TINTED, &depth], expected).of(mesh);
    case.seen([0.1, 4.0, 0.1], [0.1, 0.0, 0.1])
}

/// A ball of radius 1 that absorbs, with something in it.
fn ball(name: &str, inside: impl FnOnce(&mut Mesh), expected: [f64; 3]) -> Case {
    let mut mesh = sphere(512, 256);
    inside(&mut mesh);
    let case = Case::new(name, &[CLEAR, TINTED, "transmission.depth=1"], expected).of(mesh);
    // The sphere has its pole above.
    case.seen([0.02, 4.0, 0.02], [0.0; 3])
}

/// A rectangle that faces upwards.
fn add_plate(mesh: &mut Mesh, height: f64, half: f64, slot: u32) {
    let (half_u, half_v) = (half * DVec3::X, half * DVec3::Z);
    add_rectangle(mesh, height * DVec3::Y, half_u, half_v, slot);
}

/// The segment to the inner solid's front is absorbed as is the one behind it, and nothing between.
fn clear_cube_in_cube() -> Case {
    let inner = |mesh: &mut Mesh| {
        let mut inner = Mesh::default();
        add_box(&mut inner, 0.2 * DVec3::Y, DVec3::splat(0.5), false);
        inner.slots.fill(1);
        mesh.append(inner);
    };
    let case = cube("clear solid inside a solid", inner, kept(1.0));
    let clear = |document: &mut Document| {
        document.materials.push(material(&format!("{CLEAR} specular.ior=1")));
    };
    case.with(clear).by(MIS, 4)
}

fn camera_in_cube() -> Case {
    let case = cube(
        "camera inside a solid",
        |mesh| add_plate(mesh, -0.5, 0.4, 1),
        kept(1.25),
    );
    let case = case.in_the_dark().with(shining);
    case.seen([0.1, 0.75, 0.1], [0.1, 0.0, 0.1]).by(ALL, 4)
}

/// White in the middle of a ball: from everywhere it is as far to it.
fn matt_insert() -> Case {
    let case = ball(
        "white insert in a solid",
        |mesh| add_plate(mesh, 0.0, 0.05, 1),
        kept(2.0),
    );
    let white = |document: &mut Document| document.materials.push(MaterialSettings::diffuse("white", [1.0; 3]));
    case.with(white).by(MIS, 16)
}

/// Lit by a zone of a sphere of half the radius, in the dark: the way of light that is drawn counts, too.
fn lit_insert() -> Case {
    const ALBEDO: f32 = 0.8;
    let [from, to] = [0.4_f64, 1.2];
    let irradiance = to.sin().powi(2) - from.sin().powi(2);
    let expected = kept(1.5).map(|kept| f64::from(ALBEDO) * irradiance * kept);
    let inside = |mesh: &mut Mesh| {
        add_plate(mesh, 0.0, 0.05, 1);
        add_zone(mesh, 0.5, [from, to], 2);
    };
    let case = ball("insert lit inside a solid", inside, expected).in_the_dark();
    let materials = |document: &mut Document| {
        document.materials.push(MaterialSettings::diffuse("grey", [ALBEDO; 3]));
        shining(document);
    };
    case.with(materials).by(BY_LIGHT, 1024)
}

/// A ball, slot 0, with a plate, slot 1, and a zone around it, slot 2.
pub fn ball_with_inserts() -> Mesh {
    let mut mesh = sphere(32, 16);
    add_plate(&mut mesh, -0.3, 0.5, 1);
    add_zone(&mut mesh, 0.6, [0.4, 1.2], 2);
    mesh
}

/// A zone of a sphere between two angles to +Y, of corners so far out that it takes the solid angle of the round one.
fn add_zone(mesh: &mut Mesh, radius: f64, [from, to]: [f64; 2], slot: u32) {
    const AROUND: u32 = 128;
    const RINGS: u32 = 24;
    let step = TAU / f64::from(AROUND);
    let stretch = (step / step.sin()).sqrt();
    let ring = |mesh: &mut Mesh, number: u32| -> Vec<u32> {
        let angle = from + (to - from) * f64::from(number) / f64::from(RINGS);
        let sine = angle.sin() * stretch;
        let height = (1.0 - sine * sine).sqrt();
        let corner = |i: u32| {
            let (z, x) = (f64::from(i) * step).sin_cos();
            let place = radius * DVec3::new(sine * x, height, sine * z);
            mesh.push_vertex(
                place,
                place.normalize().as_vec3(),
                Vec2::ZERO,
                Vec4::new(1.0, 0.0, 0.0, 1.0),
            )
        };
        (0..AROUND).map(corner).collect()
    };
    let mut above = ring(mesh, 0);
    for number in 1..=RINGS {
        let below = ring(mesh, number);
        for i in 0..AROUND as usize {
            let next = (i + 1) % AROUND as usize;
            mesh.push_triangle([above[i], above[next], below[next]], slot);
            mesh.push_triangle([above[i], below[next], below[i]], slot);
        }
        above = below;
    }
}

/// No light is left of a channel that is black at the depth, at a tenth of it either.
fn black_at_depth() -> Case {
    let mut mesh = Mesh::default();
    add_box(&mut mesh, DVec3::ZERO, DVec3::ONE, false);
    let depth = 20.0 / 3.0_f64.sqrt();
    let tinted = format!("transmission.color=1,0,0.1 specular.ior=1 transmission.depth={depth}");
    let expected = [1.0, 0.0, 0.1_f64.powf(0.1)];
    let case = Case::new("black at ten times the way", &[CLEAR, &tinted], expected).of(mesh);
    case.seen([0.1, 4.0, 0.1], [0.1, 0.0, 0.1]).by(MIS, 4)
}
