//! Rays against the teapot on its ground: WGSL's traversal of its own hierarchy, and ray queries, against the processor's of its.

use glossmith::{
    gpu::{AdapterKind, GpuAdapter, Traversal, shader::link_with},
    optics::vector::{Vec3, vec3},
    scene::Geometry,
};
use rayon::prelude::*;

use super::bench::{Bench, SCENE, bench};
use super::harness::Rng;
use crate::shaders::validate;

const RAYS: usize = 40_000;
/// Distances that count as the same, relative to the distance or 1.
const SAME_DISTANCE: f32 = 1e-5;
/// The same of triangles seen edge-on, times the cosine: the processor moves no place before the box of its own hierarchy.
const EDGE_ON: f32 = 1e-6;
const NO_HIT: u32 = u32::MAX;
/// The share of rays that may pass an edge on another side by query than by arithmetic.
const PARTED: f64 = 1e-3;

const SOURCE: &str = "
@group(1) @binding(0) var<storage, read> rows_in: array<f32>;
@group(1) @binding(1) var<storage, read_write> rows_out: array<u32>;
@compute @workgroup_size(64)
fn trace_rays(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x * 7u;
    if row >= arrayLength(&rows_in) { return; }
    let origin = vec3f(rows_in[row], rows_in[row + 1u], rows_in[row + 2u]);
    let direction = vec3f(rows_in[row + 3u], rows_in[row + 4u], rows_in[row + 5u]);
    let t_max = rows_in[row + 6u];
    let hit = trace(origin, direction, t_max, false);
    let any = trace(origin, direction, t_max, true);
    let out = id.x * 5u;
    rows_out[out] = hit.triangle;
    rows_out[out + 1u] = bitcast<u32>(hit.t);
    rows_out[out + 2u] = bitcast<u32>(hit.u);
    rows_out[out + 3u] = bitcast<u32>(hit.v);
    rows_out[out + 4u] = any.triangle;
}
";

struct Ray {
    origin: [f32; 3],
    direction: [f32; 3],
    t_max: f32,
}

/// A ray from outside or inside the bounds; one in eight along an axis, one in eight at a vertex exactly.
fn random_ray(rng: &mut Rng, geometry: &Geometry) -> Ray {
    let origin: Vec3<f32> = rng.direction() * rng.range(0.0, 4.0);
    let target: Vec3<f32> = match rng.below(8) {
        0 => Vec3::from_f32(geometry.corners(rng.below(geometry.triangle_count()))[0]),
        _ => vec3(rng.range(-1.0, 1.0), rng.range(-0.8, 0.8), rng.range(-1.0, 1.0)),
    };
    let mut direction = target - origin;
    let mut origin = origin;
    if rng.below(8) == 0 {
        // Along an axis, the other components 0 of either sign, from where it passes the target.
        let axis = rng.below(3);
        let mut along = [0.0, 0.0, 0.0].map(|zero: f32| zero * rng.sign());
        along[axis] = rng.sign();
        direction = Vec3::from_f32(along);
        origin = target - direction * rng.range(0.0, 4.0);
    }
    let direction = if rng.chance(0.5) {
        direction.normalize()
    } else {
        direction
    };
    let t_max = if rng.chance(0.2) { rng.range(0.1, 3.0) } else { 1e30 };
    Ray {
        origin: origin.to_f32(),
        direction: direction.to_f32(),
        t_max,
    }
}

#[test]
fn rays_meet_the_same_triangles() {
    let failures = compared(bench(), "scene/bvh");
    assert!(failures.is_empty(), "{}", told(&failures));
}

/// An eighth of the rays are aimed at vertices, where the adapter may round to the other side.
#[test]
fn queries_meet_the_same_triangles() {
    let adapter = GpuAdapter::find(AdapterKind::Any).expect("an adapter: install mesa-vulkan-drivers");
    let opened = Bench::open(&adapter, Traversal::RayQueries);
    if !adapter.has_ray_queries() {
        let refused = opened.err().expect("it has none").to_string();
        println!("{} has no ray queries, and says so: {refused}", adapter.info.name);
        return;
    }
    let failures = compared(&opened.expect("it has them"), "scene/ray_query");
    println!("ray queries: {} of {RAYS} rays part", failures.len());
    assert!(failures.len() as f64 <= PARTED * RAYS as f64, "{}", told(&failures));
}

fn told(failures: &[String]) -> String {
    let some = failures[..failures.len().min(10)].join("\n");
    format!("{} rays differ:\n{some}", failures.len())
}

/// Where the module's rays meet something else than the processor's.
fn compared(bench: &Bench, module: &str) -> Vec<String> {
    let geometry = &SCENE.geometry;
    let mut rng = Rng::new(99);
    let rays: Vec<_> = (0..RAYS).map(|_| random_ray(&mut rng, geometry)).collect();
    let mut words = Vec::new();
    for ray in &rays {
        let numbers = ray.origin.iter().chain(&ray.direction).chain([&ray.t_max]);
        words.extend(numbers.map(|x| x.to_bits()));
    }
    let linked = link_with(&[module], SOURCE).unwrap();
    validate(&linked).unwrap();
    let pipeline = bench.pipeline(&bench.module(&linked.source), "trace_rays");
    let out = bench.run(&pipeline, &words, RAYS, 5);
    let outcomes: Vec<_> = rays
        .par_iter()
        .zip(out.par_chunks(5))
        .map(|(ray, out)| compare(geometry, ray, out))
        .collect();
    let count = |which: fn(&Outcome) -> bool| outcomes.iter().filter(|outcome| which(outcome)).count();
    let (hits, other_triangle) = (count(|o| o.is_hit), count(|o| o.is_other_triangle));
    let largest = outcomes.iter().map(|o| o.difference).fold(0.0, f32::max);
    println!(
        "{module}: {hits} of {RAYS} rays hit, {other_triangle} another triangle as far away, t within {largest:.1e}"
    );
    assert!(hits > RAYS / 4 && hits < RAYS);
    assert!(other_triangle < RAYS / 20, "{other_triangle} rays met another triangle");
    outcomes.into_iter().filter_map(|outcome| outcome.failure).collect()
}

/// The cosine between a ray and a triangle's normal, without its sign.
fn slope(geometry: &Geometry, ray: &Ray, triangle: u32) -> f32 {
    let [a, b, c]: [Vec3<f32>; 3] = geometry.corners(triangle as usize).map(Vec3::from_f32);
    let normal = (b - a).cross(c - a);
    normal.normalize().dot(Vec3::from_f32(ray.direction).normalize()).abs()
}

#[derive(Default)]
struct Outcome {
    is_hit: bool,
    is_other_triangle: bool,
    /// Of the distances, relative to the distance or 1.
    difference: f32,
    failure: Option<String>,
}

fn compare(geometry: &Geometry, ray: &Ray, out: &[u32]) -> Outcome {
    let rust = geometry.intersect(ray.origin, ray.direction, ray.t_max);
    let is_occluded = geometry.occluded(ray.origin, ray.direction, ray.t_max);
    let (triangle, any) = (out[0], out[4]);
    let [t, u, v] = [out[1], out[2], out[3]].map(f32::from_bits);
    let mut outcome = Outcome {
        is_hit: rust.is_some(),
        ..Default::default()
    };
    let agrees = match rust {
        None => triangle == NO_HIT,
        Some(hit) if triangle != NO_HIT => {
            outcome.is_other_triangle = hit.triangle != geometry.triangle_at(triangle);
            outcome.difference = (hit.t - t).abs() / hit.t.max(1.0);
            let weights = (hit.u - u).abs().max((hit.v - v).abs());
            let same = SAME_DISTANCE.max(EDGE_ON / slope(geometry, ray, geometry.triangle_at(triangle)));
            outcome.difference <= same && (outcome.is_other_triangle || weights < 1e-3)
        }
        Some(_) => false,
    };
    if !agrees || is_occluded != (any != NO_HIT) || is_occluded != rust.is_some() {
        outcome.failure = Some(format!(
            "from {:?} along {:?} up to {}: WGSL triangle {triangle} at {t} ({u}, {v}), any {any}; Rust {rust:?}, \
             occluded {is_occluded}",
            ray.origin, ray.direction, ray.t_max
        ));
    }
    outcome
}
