//! Hard cases of geometry in f32: scale and position, needles, duplicates, broken normals, and rays through edges, vertices
//! and planes.

use glam::{DVec3, Vec3, Vec4};
use serde_json::json;

use super::{
    Stage, StudyError,
    glb::Glb,
    meshes::{add_square, model, needle, small_ball, spirals},
    rays::{axis_rays, direction, edge_aim, leaks, leaving_rays, ray, unit},
    stage::{mean_luminance, worst_pixel},
};
use crate::{
    job::film::Film,
    optics::{fresnel::Fresnel, lobe::Horizon, random::hash_bits},
    scene::{Geometry, ModelSource, environment::EnvironmentSource, mesh::Mesh, shapes, teapot},
    study::small_document,
};

/// Largest difference of an image's mean under a change of scale or position: silhouettes by a rounding.
const SAME_PICTURE: f64 = 0.001;
/// The most that a pixel of the white furnace may be off.
const WHITE: f64 = 0.005;

cases! {
    "geometry"
    "scene-scaled"
        "a ray offset of a fixed length swallows a model of 1e-6 and does nothing for one of 1e6"
        "a teapot scaled by 1e-6, 1e-3, 1e3 and 1e6 through its node"
        "the image of the unscaled one, numbers drawn alike: mean difference over mean"
        "an offset of 1e-4 is 100 radii",
        "error" SAME_PICTURE, |stage| {
            let scaled = [1e-6, 1e-3, 1e3, 1e6].map(|scale| json!({"scale": [scale, scale, scale]}));
            picture_difference(stage, &scaled)
        };
    "scene-moved"
        "f32 places 1e5 from the origin are 0.008 apart: the model crumbles"
        "a teapot moved by 1e5 along each axis and along all through its node"
        "the image of the unmoved one, numbers drawn alike: mean difference over mean"
        "vertices off by 1.5e-3",
        "error" SAME_PICTURE, |stage| {
            let far = 1e5;
            let places = [[far, 0.0, 0.0], [0.0, -far, 0.0], [0.0, 0.0, far], [far, far, far]];
            picture_difference(stage, &places.map(|place| json!({"translation": place})))
        };
    "scene-scaled-and-moved"
        "a model of 1e-6 at 1e5: places differ in their twelfth digit, f64 transforms leave four of them"
        "a teapot scaled by 1e-6 or 1e6 and moved by 1e5 along all axes through its node"
        "the image of the unscaled, unmoved one, numbers drawn alike: mean difference over mean"
        "vertices off by 4000 radii",
        "error" SAME_PICTURE, |stage| {
            let moved = [1e-6, 1e6].map(|s| json!({"scale": [s, s, s], "translation": [1e5, 1e5, 1e5]}));
            picture_difference(stage, &moved)
        };
    "triangles-of-a-millionth"
        "a triangle of 1e-6 beside one of 1: its area is rounding noise, rays slip through"
        "a closed ball of radius 1e-6 in a scene of radius 1; rays from within, and from outside to its middle"
        "no ray leaks out of it or misses it; those that do are counted"
        "10000 of 10 000 rays",
        "count" 0.0, |stage| {
            let middle = DVec3::new(0.4, 0.3, 0.2);
            let mut mesh = small_ball();
            mesh.append(shapes::plane());
            let geometry = Geometry::build(&model(mesh), false);
            let middle = geometry.units_from_world(middle).as_vec3();
            let directions = || (0..stage.rays() / 10).map(direction);
            let outwards: Vec<_> = directions().map(|d| ray(middle, d)).collect();
            let inwards: Vec<_> = directions().map(|d| ray(middle + d * 0.7, -d)).collect();
            Ok(leaks(stage, &geometry, &outwards, 1e-5)? + leaks(stage, &geometry, &inwards, 0.700_01)?)
        };
    "needles"
        "triangles 1e5 times as long as wide: normals and areas cancel, rays slip through"
        "a closed rod of 1 × 1e-5 × 1e-5, turned off the axes; rays from within"
        "no ray leaks out; those that do are counted"
        "2485 of 10 000 rays",
        "count" 0.0, |stage| {
            let geometry = Geometry::build(&model(needle()), false);
            let rays: Vec<_> = (0..stage.rays() / 10).map(|i| ray(Vec3::ZERO, direction(i))).collect();
            leaks(stage, &geometry, &rays, f32::INFINITY)
        };
    "closed-mesh-leaks-nothing"
        "a ray at a shared edge or vertex is outside both triangles by rounding: black or bright specks"
        "a sphere of 18 000 triangles; a million rays (100 000 in a quick run) from within to its edges and vertices"
        "no ray leaks out; those that do are counted"
        "755 of 10 000 rays",
        "count" 0.0, |stage| {
            let mesh = shapes::sphere(96, 96);
            let geometry = Geometry::build(&model(mesh), false);
            let rays: Vec<_> = (0..stage.rays())
                .map(|i| {
                    let origin = direction(i) * 0.9 * unit(hash_bits(i ^ 0x55));
                    ray(origin, edge_aim(&geometry, i) - origin)
                })
                .collect();
            leaks(stage, &geometry, &rays, f32::INFINITY)
        };
    "rays-along-axes-and-in-planes"
        "a direction with zeros makes 0 · inf = NaN in the test against boxes; in a triangle's plane the distance \
                 is 0/0"
        "a cube of 6 × 8 × 8 squares; rays from places of its grid along axes (±0), diagonals, and in its planes"
        "each leaves at the wall that it must; others are counted"
        "(0.5 − 0.5) · inf = NaN",
        "count" 0.0, |stage| axis_rays(stage);
    "seen-from-afar"
        "the places of boxes and triangles relative to a far eye round apart: triangles vanish from their boxes"
        "a sphere seen from 30, 1e3 and 3e4 radii away; rays into its inner part, at edges and vertices too"
        "no ray misses it; those that do are counted"
        "relative places round by 4e-3 radii",
        "count" 0.0, |stage| {
            let geometry = Geometry::build(&model(shapes::sphere(192, 96)), false);
            let mut rays = Vec::new();
            for i in 0..stage.rays() / 2 {
                let away = direction(i);
                let distance = [30.0, 1e3, 3e4][i as usize % 3];
                // What the direction's own rounding moves the ray by stays below a tenth.
                let aim = edge_aim(&geometry, i) * 0.85;
                rays.push(ray(aim + away * distance, -away));
            }
            leaks(stage, &geometry, &rays, f32::INFINITY)
        };
    "rays-leave-their-surface"
        "a place on a surface is rounded to beside it: a ray from there meets the surface that it left"
        "a convex mesh of radius 1, and one of 1e-3 at the edge of a scene of radius 1. Rays leave hits at all \
               angles down to 1e-5 from the plane, outwards and inwards"
        "outwards nothing is met, inwards the mesh is; others are counted"
        "0.7 + 1e-8 is 0.7: true",
        "count" 0.0, |stage| leaving_rays(stage);
    "deep-hierarchy"
        "a stack of fixed size drops boxes that do not fit: parts of the model vanish"
        "20 000 triangles in spirals, each 0.968 times the last, down to 1e-8; those above 3e-6 are aimed at"
        "each triangle is found by a ray at its middle, or one before it; those that are not are counted"
        "boxes beyond the 32nd level dropped",
        "count" 0.0, |stage| {
            let geometry = Geometry::build(&model(spirals()), false);
            let rays: Vec<_> = (0..geometry.triangle_count())
                .map(|triangle| geometry.corners(triangle).map(Vec3::from_array))
                // The ray's own place rounds to 3e-8.
                .filter(|[a, b, _]| a.distance(*b) > 3e-6)
                .map(|[a, b, c]| {
                    let middle = (a + b + c) / 3.0;
                    let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
                    ray(middle + normal * 0.5, -normal)
                })
                .collect();
            leaks(stage, &geometry, &rays, 0.5001)
        };
    "zero-area-and-duplicates"
        "no normal, 0/0 in the weights; thousands of equal boxes take the builder for ever"
        "a sphere whose triangles are there three times, with 1000 of no area; white furnace"
        "the furnace is white: worst pixel"
        "a normal of nan",
        "error" WHITE, |stage| {
            let mut mesh = shapes::sphere(48, 24);
            let once = mesh.triangles.clone();
            for [a, b, c] in once {
                mesh.push_triangle([a, b, c], 0);
                mesh.push_triangle([b, c, a], 0);
            }
            for i in 0..1000_u32 {
                let vertex = i % mesh.positions.len() as u32;
                mesh.triangles.push([vertex, vertex, (vertex + 1) % 100]);
                mesh.slots.push(0);
            }
            let model = Glb::of(&mesh, json!({})).write(stage, "duplicates.glb")?;
            furnace(stage, model)
        };
    "broken-normals-and-tangents"
        "zero, opposite, endless or missing normals and tangents: NaN frames, black patches"
        "a sphere whose normals are by turns right, 0, opposite, NaN and 1e30 long, its tangents 0, NaN or along the \
               normal; anisotropy 1; white furnace"
        "the furnace is white: worst pixel"
        "a frame of nan",
        "error" WHITE, |stage| {
            let mut mesh = shapes::sphere(32, 16);
            for (i, normal) in mesh.normals.iter_mut().enumerate() {
                *normal = [*normal, Vec3::ZERO, -*normal, Vec3::NAN, *normal * 1e30][i % 5];
            }
            let along = |(i, n): (usize, &Vec3)| [Vec4::ZERO, Vec4::NAN, n.extend(1.0), Vec4::X][i % 4];
            let tangents: Vec<Vec4> = mesh.normals.iter().enumerate().map(along).collect();
            let mut glb = Glb::of(&mesh, json!({}));
            glb.tangents(0, &tangents);
            let model = glb.write(stage, "normals.glb")?;
            furnace(stage, model)
        };
    "non-manifold-and-coplanar"
        "faces in one place hide each other by turns; a fan of faces on one edge has no inside"
        "eight squares in one plane, turned against each other, and seven on one edge; white furnace"
        "the furnace is white: worst pixel"
        "rays that start inside the other face: dark",
        "error" WHITE, |stage| {
            let mut mesh = Mesh::default();
            for i in 0..8 {
                let (sin, cos) = (f64::from(i) * 0.4).sin_cos();
                let (u, v) = (DVec3::new(cos, 0.0, sin), DVec3::new(-sin, 0.0, cos));
                add_square(&mut mesh, [-u - v, u - v, u + v, v - u], i % 2 == 0);
            }
            for i in 0..7 {
                let (sin, cos) = (f64::from(i) * 0.9 + 0.1).sin_cos();
                let (edge, out) = (DVec3::Y, DVec3::new(cos, 0.0, sin));
                let corners = [DVec3::ZERO, edge, edge + out, out];
                add_square(&mut mesh, corners, i % 2 == 0);
            }
            let model = Glb::of(&mesh, json!({})).write(stage, "coplanar.glb")?;
            furnace(stage, model)
        };
    "ten-glasses-in-each-other"
        "rays caught between surfaces that nearly touch, offsets into the next glass, paths of 64 bounces cut off"
        "ten instances of a clear sphere of index 1.1 inside each other, each 0.95 of the last; white furnace"
        "the mean of the image is white"
        "0.96²⁰ = 0.44 where reflected light is dropped",
        "error" WHITE, |stage| {
            let mut glb = Glb::default();
            let ball = glb.mesh(&shapes::sphere(64, 32));
            for i in 0..10 {
                let scale = 0.95_f64.powi(i);
                glb.node(ball, json!({"scale": [scale, scale, scale]}));
            }
            let model = glb.write(stage, "glasses.glb")?;
            let mut document = small_document(model, EnvironmentSource::Furnace, 24, 32);
            let glass = &mut document.materials[0];
            glass.metalness = 0.0;
            glass.ior = 1.1;
            glass.transmission_weight = 1.0;
            glass.roughness = 0.0;
            glass.transmission_roughness = 0.0;
            glass.transmission_depth = 0.0;
            glass.transmission_color = [1.0; 3];
            let film = stage.film(&document)?;
            Ok((mean_luminance(&film) - 1.0).abs() + film.dropped() as f64)
        };
}

/// Relative mean difference of images of the same model at other nodes.
fn picture_difference(stage: &mut Stage, nodes: &[serde_json::Value]) -> Result<f64, StudyError> {
    let mesh = teapot::mesh(4);
    let mut picture = |node: serde_json::Value, name: &str| {
        let model = Glb::of(&mesh, node).write(stage, name)?;
        let mut document = small_document(model, EnvironmentSource::Studio, 48, 8);
        document.ground = true;
        document.materials[0].roughness = 0.3;
        stage.film(&document)
    };
    let still = picture(json!({}), "still.glb")?;
    let mut worst = 0.0_f64;
    for (i, node) in nodes.iter().enumerate() {
        let moved = picture(node.clone(), &format!("moved-{i}.glb"))?;
        worst = worst.max(difference(&still, &moved));
    }
    Ok(worst)
}

/// Σ|a − b| / Σ a over pixels; infinite for a black image or a dropped sample.
fn difference(a: &Film, b: &Film) -> f64 {
    let (mut apart, mut size) = (0.0, 0.0);
    for (a, b) in a.luminance().iter().zip(b.luminance()) {
        apart += (a - b).abs();
        size += a;
    }
    let value = apart / size;
    if value.is_nan() || b.dropped() > 0 {
        f64::INFINITY
    } else {
        value
    }
}

/// Largest deviation from white of a pixel in the white furnace, plus the number of dropped samples.
fn furnace(stage: &mut Stage, model: ModelSource) -> Result<f64, StudyError> {
    let mut document = small_document(model, EnvironmentSource::Furnace, 40, 4);
    let material = &mut document.materials[0];
    material.fresnel = Fresnel::None;
    material.horizon = Horizon::Mirror;
    material.roughness = 0.5;
    material.anisotropy = 1.0;
    Ok(worst_pixel(&stage.film(&document)?, [1.0; 3]))
}
