//! What each guard costs: the form that keeps its digits against the textbook's, in turns; quoted in docs/STABILITY.md.
//!
//! `cargo bench --bench guards`. Medians of one run. The naive forms are here only; what they get wrong is
//! `glossmith check --hard`.

mod compressed;

use std::{hint::black_box, time::Duration, time::Instant};

use compressed::CompressedRays;
use glam::Vec3A;
use glossmith::{
    cpu::integrator::is_sound,
    document::Document,
    job::film::Film,
    optics::{
        fresnel::{fresnel_conductor, half_vector_cosine},
        numeric::normalize_or,
        random::hash_bits,
        vector::{Vec3, vec3},
        warp::uniform_sphere,
    },
    render::{EngineChoice, Session, SessionError},
    scene::{Geometry, Model, RayFrame, intersect_triangle, surface::position_error, teapot, triangle_normal},
};
use obvhs::{cwbvh::CwBvh, ray::Ray, ray::RayHit};

/// Turns of each pair.
const TURNS: usize = 31;
/// Inputs, gone through so many times a turn.
const COUNT: usize = 1024;
const REPEATS: usize = 50;
/// How long each turn of a picture lasts.
const PICTURE: Duration = Duration::from_millis(400);

fn main() -> Result<(), SessionError> {
    println!("| guard | a call of | guarded, ns | naive, ns | ratio |");
    println!("| --- | --- | --- | --- | --- |");
    let scene = Scene::new();
    edges(&scene);
    whole_rays(&scene);
    offset(&scene);
    small_forms(&scene);
    sums(&scene);
    fireflies()
}

/// What the forms are fed with.
struct Scene {
    geometry: Geometry,
    directions: Vec<Vec3<f32>>,
    /// A ray to each of some triangles, and which.
    rays: Vec<([f32; 3], [f32; 3], usize)>,
}

impl Scene {
    fn new() -> Self {
        let model = Model {
            mesh: teapot::mesh(8),
            ..Model::default()
        };
        let geometry = Geometry::build(&model, false);
        let unit = |bits: u32| (bits >> 8) as f32 / 16_777_216.0;
        let directions: Vec<Vec3<f32>> = (0..COUNT as u32)
            .map(|i| uniform_sphere([unit(hash_bits(i)), unit(hash_bits(i ^ 0x9e37_79b9))]).normalize())
            .collect();
        let ray = |(i, direction): (usize, &Vec3<f32>)| {
            let triangle = hash_bits(i as u32 ^ 0x55) as usize % geometry.triangle_count();
            let [a, b, c] = geometry.corners(triangle).map(Vec3::from_f32);
            let middle = (a + b + c) / 3.0;
            ((middle - *direction * 2.0).to_f32(), direction.to_f32(), triangle)
        };
        let rays = directions.iter().enumerate().map(ray).collect();
        Self {
            geometry,
            directions,
            rays,
        }
    }
}

/// Median nanoseconds a call of two forms over all inputs, in turns.
fn nanoseconds<I>(inputs: &[I], mut guarded: impl FnMut(&I) -> f32, mut naive: impl FnMut(&I) -> f32) -> [f64; 2] {
    let mut times = [const { Vec::new() }; 2];
    for turn in 0..=TURNS {
        for (side, times) in times.iter_mut().enumerate() {
            let begun = Instant::now();
            let mut sum = 0.0;
            for _ in 0..REPEATS {
                for input in black_box(inputs) {
                    sum += if side == 0 { guarded(input) } else { naive(input) };
                }
            }
            black_box(sum);
            if turn > 0 {
                times.push(begun.elapsed().as_secs_f64() * 1e9 / (REPEATS * inputs.len()) as f64);
            }
        }
    }
    times.map(median)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn row(guard: &str, call: &str, [guarded, naive]: [f64; 2]) {
    println!(
        "| {guard} | {call} | {guarded:.1} | {naive:.1} | {:.2} |",
        guarded / naive
    );
}

/// Möller and Trumbore's test.
fn naive_triangle(origin: Vec3A, direction: Vec3A, [a, b, c]: [Vec3A; 3], t_max: f32) -> Option<f32> {
    let (to_b, to_c) = (b - a, c - a);
    let across = direction.cross(to_c);
    let determinant = to_b.dot(across);
    if determinant.abs() < 1e-7 {
        return None;
    }
    let inverse = 1.0 / determinant;
    let from_a = origin - a;
    let u = from_a.dot(across) * inverse;
    let other = from_a.cross(to_b);
    let v = direction.dot(other) * inverse;
    let t = to_c.dot(other) * inverse;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 1e-4 && t < t_max).then_some(t)
}

fn edges(scene: &Scene) {
    let corners = |triangle: usize| scene.geometry.corners(triangle).map(Vec3A::from_array);
    let times = nanoseconds(
        &scene.rays,
        |&(origin, direction, triangle)| {
            let ray = RayFrame::new(origin.into(), direction.into());
            let [a, b, c] = corners(triangle);
            intersect_triangle(&ray, a, b, c, 1e30).map_or(0.0, |(t, ..)| t)
        },
        |&(origin, direction, triangle)| {
            naive_triangle(origin.into(), direction.into(), corners(triangle), 1e30).unwrap_or(0.0)
        },
    );
    row(
        "watertight edges, distances by the plane",
        "one ray, one triangle",
        times,
    );
    let times = nanoseconds(
        &scene.rays,
        |&(.., triangle)| triangle_normal(scene.geometry.corners(triangle).map(Vec3::<f32>::from_f32)).x,
        |&(.., triangle)| {
            let [a, b, c] = scene.geometry.corners(triangle).map(Vec3::<f32>::from_f32);
            (b - a).cross(c - a).x
        },
    );
    row("normal from the shorter edges", "one triangle", times);
}

fn whole_rays(scene: &Scene) {
    let geometry = &scene.geometry;
    let guarded = CompressedRays::new(&geometry.model);
    let compressed = geometry.model.compressed();
    let naive = CwBvh {
        nodes: compressed.nodes.clone(),
        ..CwBvh::default()
    };
    let times = nanoseconds(
        &scene.rays,
        |&(origin, direction, _)| {
            let hit = guarded.trace::<false>(origin, direction, f32::MAX);
            hit.map_or(0.0, |hit| hit.t)
        },
        |&(origin, direction, _)| {
            let ray = Ray::new_inf(origin.into(), direction.into());
            let mut hit = RayHit::none();
            naive.ray_traverse(ray, &mut hit, |ray, entry| {
                let triangle = compressed.triangles[entry] as usize;
                let corners = geometry.corners(triangle).map(Vec3A::from_array);
                naive_triangle(ray.origin, ray.direction, corners, ray.tmax).unwrap_or(f32::INFINITY)
            });
            hit.t
        },
    );
    row(
        "conservative boxes and watertight edges",
        "one ray through a teapot of 57 000 triangles, compressed nodes (naive: obvhs' own traversal)",
        times,
    );
}

fn offset(scene: &Scene) {
    let place = |direction: &Vec3<f32>| *direction * 0.7;
    let times = nanoseconds(
        &scene.rays,
        |&(_, direction, triangle)| {
            let normal = Vec3::from_f32(direction);
            let corners = scene.geometry.corners(triangle).map(Vec3::from_f32);
            let error = position_error(corners, [0.2, 0.3, 0.5], normal);
            (place(&normal) + normal * error).x
        },
        |&(_, direction, triangle)| {
            black_box(scene.geometry.corners(triangle));
            let normal = Vec3::from_f32(direction);
            (place(&normal) + normal * 1e-4).x
        },
    );
    row("ray's origin outside a bound on the error", "one origin", times);
}

fn small_forms(scene: &Scene) {
    let up = vec3(0.0, 0.0, 1.0);
    let times = nanoseconds(
        &scene.directions,
        |&v| normalize_or(v + up, up).x,
        |&v| ((v + up) / (v + up).length()).x,
    );
    row("robust normalise", "one vector", times);
    let times = nanoseconds(
        &scene.directions,
        |&v| half_vector_cosine(v, up),
        |&v| (0.5 + 0.5 * v.dot(up)).sqrt(),
    );
    row("half vector's cosine from the sum's length", "one pair", times);
    let times = nanoseconds(
        &scene.directions,
        |&v| fresnel_conductor(v.z.abs(), 0.2, 3.9),
        |&v| naive_conductor(v.z.abs(), 0.2, 3.9),
    );
    row("Fresnel's equations of a metal", "one channel", times);
}

fn sums(scene: &Scene) {
    let mut film = Film::new(1, 1);
    let mut single = [0.0_f32; 5];
    let times = nanoseconds(
        &scene.directions,
        |v| {
            film.add(0, 0, [v.x, v.y, v.z, 1.0].map(f64::from));
            v.x
        },
        |v| {
            let luminance = 0.2126 * v.x + 0.7152 * v.y + 0.0722 * v.z;
            for (sum, x) in single.iter_mut().zip([v.x, v.y, v.z, 1.0, luminance * luminance]) {
                *sum += x;
            }
            v.x
        },
    );
    black_box((&film, single));
    row("sums in f64, two halves (naive: f32, one)", "one sample", times);
    let times = nanoseconds(&scene.directions, |&v| if is_sound(v) { v.x } else { 0.0 }, |&v| v.x);
    row("the last guard: finite and not negative", "one sample", times);
}

/// A whole image with and without the limit.
fn fireflies() -> Result<(), SessionError> {
    let mut sessions = [Session::open(EngineChoice::Cpu)?, Session::open(EngineChoice::Cpu)?];
    let mut times = [const { Vec::new() }; 2];
    for turn in 0..=TURNS / 4 {
        for side in 0..2 {
            let mut document = Document::default();
            (document.render.width, document.render.height) = (256, 256);
            document.render.samples = u32::MAX;
            document.render.seed = turn as u32;
            document.render.firefly_clamp = (side == 0).then_some(10.0);
            sessions[side].submit(&document)?;
            let progress = sessions[side].step(PICTURE)?;
            if turn > 0 {
                times[side].push(1e9 / progress.samples_per_second);
            }
        }
    }
    let what = format!("one sample of a picture (teapot, studio; {})", sessions[0].engine());
    row("firefly clamp (off unless asked for)", &what, times.map(median));
    Ok(())
}

/// As textbooks write it.
fn naive_conductor(cosine: f32, eta: f32, k: f32) -> f32 {
    let (cos2, sin2) = (cosine * cosine, 1.0 - cosine * cosine);
    let t0 = eta * eta - k * k - sin2;
    let size = (t0 * t0 + 4.0 * eta * eta * k * k).sqrt();
    let a = (0.5 * (size + t0)).sqrt();
    let (t1, t2) = (size + cos2, 2.0 * a * cosine);
    let perpendicular = (t1 - t2) / (t1 + t2);
    let (t3, t4) = (cos2 * size + sin2 * sin2, t2 * sin2);
    0.5 * (perpendicular + perpendicular * (t3 - t4) / (t3 + t4))
}
