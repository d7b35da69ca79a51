//! Surfaces that emit: their sampler against its density, area lights against Lambert's formula, the strategies and
//! engines against each other.

use crate::{
    environment::triple,
    renders::{adjust, document},
    support::Random,
};
use glam::{DVec3, Vec2, Vec4};
use glossmith::{
    analysis::chi_square::test_counts,
    compile::compile,
    document::{AreaLight, AreaLightShape, Background, Document},
    optics::material::Material,
    optics::vector::{Vec3, vec3},
    scene::{
        Geometry, Model, ModelSource, Slot,
        camera::orbit_direction,
        environment::EnvironmentSource,
        light::{Emitters, Lights, light_density, light_sample, spot_share},
        mesh::Mesh,
        texture::Textures,
    },
};
use std::f64::consts::PI;

/// Rows of cells that a triangle is cut into.
const CUTS: u32 = 10;
const CELLS: usize = (CUTS * CUTS) as usize;
const DRAWS: u32 = 400_000;

/// Seven triangles around the origin that hide none of each other, of three materials, of which one does not emit.
fn shards() -> (Geometry, Vec<Material<f32>>) {
    let mut mesh = Mesh::default();
    let mut random = Random::new(4);
    for triangle in 0..8u32 {
        let center = DVec3::from_array(std::array::from_fn(|axis| {
            let side = if triangle >> axis & 1 == 0 { -1.0 } else { 1.0 };
            side * (0.5 + f64::from(random.unit()))
        }));
        let corners = [(); 3].map(|()| {
            let position = center + 0.45 * random.in_ball().as_dvec3();
            mesh.push_vertex(position, glam::Vec3::Y, Vec2::ZERO, Vec4::X)
        });
        mesh.push_triangle(corners, [0, 0, 1, 2, 0, 1, 0, 1][triangle as usize]);
    }
    let model = Model {
        mesh,
        slots: vec![Slot::neutral("shard"); 3],
        ..Model::default()
    };
    let (mut materials, _) = glossmith::compile::compile(&vec![Default::default(); 3]);
    materials[0].emission = vec3(1.0, 2.0, 3.0);
    materials[1].emission = vec3(0.7, 0.1, 0.0);
    for material in &mut materials {
        material.light_luminance = material.emission.luminance();
    }
    (Geometry::build(&model, false), materials)
}

/// The solid angle of a triangle seen from the origin (Van Oosterom and Strackee 1983).
fn solid_angle(corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners.map(DVec3::normalize);
    let numerator = a.dot(b.cross(c)).abs();
    2.0 * numerator.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// The cell of a triangle that holds the place with weights u and v of its second and third corner.
fn cell_of(u: f64, v: f64) -> usize {
    let n = f64::from(CUTS);
    let (i, j) = ((u * n).floor().min(n - 1.0), (v * n).floor().min(n - 1.0));
    let is_upper = u * n - i + v * n - j > 1.0;
    // Row i holds 2 (n − i) − 1 small triangles.
    let before = i * (2.0 * n - i);
    (before + 2.0 * j) as usize + usize::from(is_upper)
}

/// The weights (u, v) of the corners of every cell, in the order of [`cell_of`].
fn cells() -> Vec<[[f64; 2]; 3]> {
    let n = f64::from(CUTS);
    let mut cells = Vec::new();
    for i in 0..CUTS {
        for j in 0..CUTS - i {
            let at = |di: u32, dj: u32| [f64::from(i + di) / n, f64::from(j + dj) / n];
            cells.push([at(0, 0), at(1, 0), at(0, 1)]);
            if i + j + 1 < CUTS {
                cells.push([at(1, 1), at(0, 1), at(1, 0)]);
            }
        }
    }
    cells
}

/// The p-value of samples of the triangles seen from `origin` against their density integrated over the solid angle of
/// each cell, and of one that is off by 3 % in every other cell.
fn p_values(origin: Vec3<f64>) -> [f64; 2] {
    let (geometry, materials) = shards();
    let lights = Lights::new(&geometry, &materials);
    let per_luminance = 1.0 / lights.power;
    let from = DVec3::from_array(origin.to_f64());
    let mut expected = vec![0.0; geometry.triangle_count() * CELLS];
    for triangle in 0..geometry.triangle_count() {
        let luminance = f64::from(materials[geometry.slot(triangle) as usize].light_luminance);
        let corners = geometry.corners(triangle);
        let [a, b, c] = corners.map(|corner| DVec3::from_array(corner.map(f64::from)) - from);
        let normal = (b - a).cross(c - a).normalize();
        for (cell, weights) in cells().into_iter().enumerate() {
            let corners = weights.map(|[u, v]| a * (1.0 - u - v) + b * u + c * v);
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            let cosine = normal.dot(middle.normalize()).abs();
            let density = light_density(luminance, cosine, middle.length(), per_luminance);
            let index = triangle * CELLS + cell;
            expected[index] = density * solid_angle(corners) * f64::from(DRAWS);
        }
    }
    let origin = Vec3::<f32>::from_f64(origin.to_f64());
    let mut observed = vec![0; expected.len()];
    let mut random = Random::new(9);
    let density = per_luminance as f32;
    let emitters = Emitters {
        geometry: &geometry,
        materials: &materials,
        textures: &Textures::default(),
        lights: &lights,
        tables: &[],
        density_per_luminance: density,
    };
    for _ in 0..DRAWS {
        let sample = light_sample(&emitters, origin, 0.0, triple(&mut random));
        let hit = geometry.intersect(origin.to_f32(), sample.direction.to_f32(), f32::MAX);
        // Rounding at an edge.
        let Some(hit) = hit else { continue };
        let luminance = materials[geometry.slot(hit.triangle as usize) as usize].light_luminance;
        let [a, b, c] = geometry
            .corners(hit.triangle as usize)
            .map(|corner| DVec3::from_array(corner.map(f64::from)));
        let normal = (b - a).cross(c - a).normalize();
        let cosine = normal.dot(DVec3::from_array(sample.direction.to_f64())).abs();
        let at_hit = f64::from(light_density(luminance, cosine as f32, hit.t, density));
        near!(f64::from(sample.density) / at_hit, 1.0, 0.001);
        observed[hit.triangle as usize * CELLS + cell_of(hit.u.into(), hit.v.into())] += 1;
    }
    let tampered: Vec<f64> = expected
        .iter()
        .enumerate()
        .map(|(i, x)| x * [1.03, 0.97][i % 2])
        .collect();
    [&expected, &tampered].map(|expected| test_counts(&observed, expected).p_value)
}

#[test]
fn triangles_are_sampled_with_their_density() {
    for origin in [vec3(0.0, 0.0, 0.0), vec3(0.1, -0.05, 0.07)] {
        let [right, tampered] = p_values(origin);
        assert!(right > 0.001, "from {origin:?}: p = {right}");
        assert!(tampered < 1e-6, "a tampered density passed with p = {tampered}");
    }
}

#[test]
fn the_table_holds_what_emits_and_nothing_else() {
    let (geometry, materials) = shards();
    let lights = Lights::new(&geometry, &materials);
    let emitting = geometry.model.slots.iter().filter(|&&slot| slot < 2).count();
    assert_eq!((emitting, lights.cells_size), (7, [3, 3]));
    let chosen = |index: usize| {
        let kept = f64::from(lights.cells[index].threshold);
        let taken = lights.cells.iter().filter(|cell| cell.alias_index as usize == index);
        kept + taken.map(|cell| 1.0 - f64::from(cell.threshold)).sum::<f64>()
    };
    assert!((0..7).all(|index| chosen(index) > 0.0));
    assert_eq!([chosen(7), chosen(8)], [0.0; 2]);
    let dark: Vec<_> = materials[2..].repeat(3);
    assert!(Lights::new(&geometry, &dark).is_empty());
}

/// The corners of an area light as docs/CONVENTIONS.md says, in bounding radii about the model's centre.
pub fn corners(light: &AreaLight) -> [DVec3; 4] {
    let (yaw, pitch) = (light.yaw_deg.to_radians(), light.pitch_deg.to_radians());
    let outwards = DVec3::new(pitch.cos() * yaw.sin(), pitch.sin(), pitch.cos() * yaw.cos());
    let across = DVec3::new(yaw.cos(), 0.0, -yaw.sin());
    let along = outwards.cross(across);
    let corner = |u: f64, v: f64| light.distance * outwards + across * (u * light.width) + along * (v * light.height);
    [
        corner(-0.5, -0.5),
        corner(0.5, -0.5),
        corner(0.5, 0.5),
        corner(-0.5, 0.5),
    ]
}

/// Irradiance at a place with this normal of a polygon of radiance 1 above its horizon (Lambert 1760).
pub fn irradiance(place: DVec3, normal: DVec3, polygon: &[DVec3; 4]) -> f64 {
    let seen = polygon.map(|corner| (corner - place).normalize());
    let edges = (0..4).map(|i| {
        let (a, b) = (seen[i], seen[(i + 1) % 4]);
        a.dot(b).acos() * a.cross(b).normalize().dot(normal)
    });
    0.5 * edges.sum::<f64>().abs()
}

/// Area lights large enough that the lobe strategy has an honest variance.
fn large_lights() -> Vec<AreaLight> {
    let one = AreaLight {
        distance: 2.5,
        width: 2.0,
        height: 2.0,
        strength: 4.0,
        color: [1.0, 0.6, 0.3],
        ..AreaLight::default()
    };
    let other = AreaLight {
        yaw_deg: 100.0,
        pitch_deg: 10.0,
        strength: 2.0,
        color: [0.2, 0.5, 1.0],
        ..one
    };
    vec![one, other]
}

/// With an environment to share the samples with, with one that is not sampled, and with none.
pub fn lit_scenes() -> Vec<(&'static str, Document)> {
    let matt = ["base.metalness=0 specular.roughness=0.6 base.color=0.5,0.6,0.7"];
    let mut studio = document(ModelSource::Teapot, EnvironmentSource::Studio, &matt);
    studio.lighting.area_lights = large_lights();
    studio.ground = true;
    let metal = ["specular.lobe=ggx specular.roughness=0.8"];
    let mut dark = document(ModelSource::Sphere, EnvironmentSource::Sky, &metal);
    dark.lighting.strength = 0.0;
    dark.lighting.area_lights = large_lights();
    let glow = ["emission.strength=2 emission.color=0.3,1,0.5 specular.roughness=0.5"];
    let mut furnace = document(ModelSource::Sphere, EnvironmentSource::Furnace, &glow);
    furnace.ground = true;
    // Far off on the ground a chance hit of the light would be rare.
    (furnace.camera.pitch_deg, furnace.camera.distance) = (60.0, Some(5.0));
    furnace.lighting.area_lights = large_lights()[..1].to_vec();
    let mut scenes = vec![("studio", studio), ("dark", dark), ("furnace", furnace)];
    for (_, document) in &mut scenes {
        document.lighting.background = Background::Transparent;
        // Few paths that found much light would make the lobe's variance dishonest: no more than 4 bounces.
        adjust(
            document,
            "render.width=40 render.height=40 render.samples=512 render.bounces=4",
        );
    }
    scenes
}

#[test]
fn a_highlight_is_where_the_lights_middle_is_mirrored() {
    for (place, mirrored) in [
        (DVec3::new(0.3, 0.5, 0.6), DVec3::new(-0.6, 0.64, 0.48)),
        (DVec3::ZERO, DVec3::Y),
        (DVec3::new(8.0, -1.0, 3.0), DVec3::new(0.0, 1.0, 0.0)),
    ] {
        for target in [[0.0; 3], [0.2, -0.4, 0.1]] {
            for start in [AreaLight::default(), AreaLight::spot(), AreaLight::sun()] {
                let mut light = AreaLight { target, ..start };
                light.put_highlight(place, mirrored);
                let seen = (light.shape().frame().middle - place).normalize();
                let tolerance = if light.is_sun() { 0.002 } else { 1e-9 };
                assert!(seen.distance(mirrored) < tolerance, "{place} {mirrored}: {light:?}");
                assert!(light.distance >= AreaLight::default().distance);
            }
        }
    }
}

#[test]
fn a_light_looks_at_its_target() {
    let light = AreaLight {
        target: [0.5, -1.0, 2.0],
        turn_deg: 30.0,
        ..AreaLight::default()
    };
    let frame = light.shape().frame();
    let outwards = orbit_direction(light.yaw_deg, light.pitch_deg);
    assert!((frame.middle - 3.0 * outwards).distance(DVec3::new(0.5, -1.0, 2.0)) < 1e-12);
    // To the right of who looks at it, and turned clockwise: downwards.
    let untilted = AreaLight { turn_deg: 0.0, ..light }.shape().frame();
    assert!(untilted.across.cross(untilted.up).distance(-outwards) < 1e-12);
    assert!(frame.across.dot(untilted.across) > 0.0 && frame.across.dot(untilted.up) < 0.0);
}

#[test]
fn power_and_strength_are_the_same_said_twice() {
    for start in [AreaLight::default(), AreaLight::spot(), AreaLight::sun()] {
        let mut light = AreaLight {
            color: [1.0, 0.5, 0.2],
            ..start
        };
        light.set_power(800.0, 0.3);
        near!(light.power(0.3), 800.0, 0.001);
    }
    // A square metre of 1 cd/m² sends π lm to each side.
    let square = AreaLight {
        strength: 1.0,
        ..AreaLight::default()
    };
    near!(square.power(1.0), 2.0 * PI, 1e-9);
    // A ball of radius 1 m sends 4π² of it.
    let ball = AreaLight {
        shape: AreaLightShape::Sphere,
        width: 2.0,
        ..square
    };
    near!(ball.power(1.0), 4.0 * PI * PI, 1e-9);
    let mut black = AreaLight {
        color: [0.0; 3],
        ..square
    };
    black.set_power(5.0, 1.0);
    assert_eq!(black.strength, 1.0);
}

/// The flux of a spot against the integral of what it sends in each direction.
#[test]
fn the_power_of_a_spot_is_what_its_cone_holds() {
    for (cone_deg, softness) in [(40.0, 0.2), (120.0, 1.0), (5.0, 0.0)] {
        let light = AreaLight {
            cone_deg,
            softness,
            ..AreaLight::spot()
        };
        let mut material = compile(&[light.material()]).0[0];
        light.shine().finish(&mut material);
        let steps = 200_000;
        let shares = (0..steps).map(|step| {
            let cosine = (f64::from(step) + 0.5) / f64::from(steps);
            2.0 * PI * cosine * spot_share(&material.cast::<f64>(), cosine)
        });
        let projected = shares.sum::<f64>() / f64::from(steps);
        let expected = projected * light.radiance() * 0.25 * PI * 0.09 * 4.0;
        let power = light.power(2.0);
        near!(power / expected, 1.0, 0.005, "{cone_deg} {softness}");
    }
}
