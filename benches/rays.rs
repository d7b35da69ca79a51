//! Rays alone on one core: the processor's hierarchy under each instruction set against the GPU's hierarchy on the
//! processor, and against Embree where it is installed, in turns of one run; quoted in docs/PERFORMANCE.md.
//!
//! `cargo bench --bench rays`. Millions of rays a second by the clock on the wall, the best of some turns: quiet machines
//! only.

mod compressed;
mod embree;

use std::{hint::black_box, time::Duration, time::Instant};

use compressed::CompressedRays;
use embree::Embree;
use fearless_simd::Level;
use glossmith::{
    instructions::Instructions,
    optics::{
        random::{Sequence, random_pair, random_state},
        vector::{Vec3, vec3},
        warp::uniform_sphere,
    },
    scene::{Geometry, Model, PACKET, Packet, teapot},
};

/// Rays of a kind.
const COUNT: u32 = 100_000;
/// How long each turn lasts, at least.
const TURN: Duration = Duration::from_millis(100);
const TURNS: usize = 9;

/// Origin and direction.
type Ray = ([f32; 3], [f32; 3]);

/// Rays of a kind, and whether any triangle will do.
struct Kind {
    name: &'static str,
    any: bool,
    rays: Vec<Ray>,
}

fn main() {
    let sets = Instructions::ALL.iter().filter(|choice| **choice != Instructions::Auto);
    let sets: Vec<(&str, Level)> = sets.filter_map(|set| Some((set.label(), set.level()?))).collect();
    let heads: Vec<String> = sets.iter().map(|(name, _)| format!("{name} | ratio")).collect();
    println!(
        "| triangles | rays | compressed nodes | {} | Embree | Embree, robust |",
        heads.join(" | ")
    );
    println!("|{}", " --- |".repeat(5 + 2 * sets.len()));
    for segments in [9, 28, 90] {
        let model = Model {
            mesh: teapot::mesh(segments),
            ..Model::default()
        };
        let begun = Instant::now();
        let geometry = Geometry::build(&model, true);
        let bytes = geometry.prepare();
        let seconds = begun.elapsed().as_secs_f64();
        let count = geometry.triangle_count();
        let corners: Vec<[f32; 3]> = (0..count).flat_map(|triangle| geometry.corners(triangle)).collect();
        let numbers: Vec<[u32; 3]> = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let embree = [false, true].map(|is_robust| Embree::of(&corners, &numbers, is_robust));
        for kind in kinds(&geometry) {
            compare(&geometry, &sets, &kind, &embree);
            compare_packets(&geometry, &sets, &kind, &embree);
        }
        println!(
            "| {count} | | built in {seconds:.2} s, {} bytes a triangle |",
            bytes / count
        );
    }
}

fn compare(geometry: &Geometry, sets: &[(&str, Level)], kind: &Kind, embree: &[Option<Embree>; 2]) {
    let compressed = CompressedRays::new(&geometry.model);
    let mut best = vec![0.0_f64; 1 + sets.len()];
    let mut best_embree = [0.0_f64; 2];
    for _ in 0..TURNS {
        improve(&mut best_embree, kind, embree, false);
        best[0] = best[0].max(rate(kind, |(origin, direction)| match kind.any {
            true => compressed.trace::<true>(origin, direction, f32::MAX).is_some(),
            false => compressed.trace::<false>(origin, direction, f32::MAX).is_some(),
        }));
        for ((_, level), best) in sets.iter().zip(&mut best[1..]) {
            *best = best.max(rate(kind, |(origin, direction)| match kind.any {
                true => geometry.occluded_by(*level, origin, direction, f32::MAX),
                false => geometry.intersect_by(*level, origin, direction, f32::MAX).is_some(),
            }));
        }
    }
    let rates = best[1..]
        .iter()
        .map(|rate| format!("{:.2} | {:.2}", rate / 1e6, rate / best[0]));
    println!(
        "| {} | {} | {:.2} | {} | {:.2} | {:.2} |",
        geometry.triangle_count(),
        kind.name,
        best[0] / 1e6,
        rates.collect::<Vec<_>>().join(" | "),
        best_embree[0] / 1e6,
        best_embree[1] / 1e6
    );
}

/// The same rays sixteen at a time, against one by one.
fn compare_packets(geometry: &Geometry, sets: &[(&str, Level)], kind: &Kind, embree: &[Option<Embree>; 2]) {
    let packet = |rays: &[Ray]| Packet::of(rays.iter().map(|&(origin, direction)| (origin, direction, f32::MAX)));
    let packets: Vec<Packet> = kind.rays.chunks(PACKET).map(packet).collect();
    let (mut cells, mut best_embree) = (Vec::new(), [0.0_f64; 2]);
    for (_, level) in sets {
        let (mut alone, mut together) = (0.0_f64, 0.0_f64);
        for _ in 0..TURNS {
            improve(&mut best_embree, kind, embree, true);
            alone = alone.max(rate(kind, |(origin, direction)| match kind.any {
                true => geometry.occluded_by(*level, origin, direction, f32::MAX),
                false => geometry.intersect_by(*level, origin, direction, f32::MAX).is_some(),
            }));
            let begun = Instant::now();
            let mut rays = 0;
            while begun.elapsed() < TURN {
                for packet in &packets {
                    match kind.any {
                        true => _ = black_box(geometry.occluded_packet(*level, packet).iter().len()),
                        false => _ = black_box(geometry.intersect_packet(*level, packet).iter().len()),
                    }
                }
                rays += kind.rays.len();
            }
            together = together.max(rays as f64 / begun.elapsed().as_secs_f64());
        }
        cells.push(format!("{:.2} | {:.2}", together / 1e6, together / alone));
    }
    let name = format!("{} in packets, against alone", kind.name);
    let count = geometry.triangle_count();
    println!(
        "| {count} | {name} | | {} | {:.2} | {:.2} |",
        cells.join(" | "),
        best_embree[0] / 1e6,
        best_embree[1] / 1e6
    );
}

/// Raises the best rates of Embree; they stay 0 where it is not installed.
fn improve(best: &mut [f64; 2], kind: &Kind, embree: &[Option<Embree>; 2], in_packets: bool) {
    for (best, embree) in best.iter_mut().zip(embree) {
        let Some(embree) = embree else { continue };
        let (begun, mut rays) = (Instant::now(), 0);
        while begun.elapsed() < TURN {
            black_box(embree.hits(&kind.rays, kind.any, in_packets, kind.name == "camera"));
            rays += kind.rays.len();
        }
        *best = best.max(rays as f64 / begun.elapsed().as_secs_f64());
    }
}

/// Rays a second.
fn rate(kind: &Kind, trace: impl Fn(Ray) -> bool) -> f64 {
    let begun = Instant::now();
    let (mut rays, mut met) = (0, 0);
    while begun.elapsed() < TURN {
        met += kind.rays.iter().filter(|ray| trace(**ray)).count();
        rays += kind.rays.len();
    }
    black_box(met);
    rays as f64 / begun.elapsed().as_secs_f64()
}

fn kinds(geometry: &Geometry) -> Vec<Kind> {
    let pair = |i: u32, dimension: u32| -> [f32; 2] {
        random_pair(random_state(0, 0, 0, i, Sequence::Independent), dimension)
    };
    let incoherent = |i: u32| {
        let origin = uniform_sphere(pair(i, 0)) * 0.6;
        (origin.to_f32(), uniform_sphere(pair(i, 1)).to_f32())
    };
    // Row by row, through a window that the model fills.
    let eye = vec3(1.2_f32, 1.0, 2.6);
    let (forward, right) = ((-eye).normalize(), vec3(eye.z, 0.0, -eye.x).normalize());
    let up = right.cross(forward);
    let side = f64::from(COUNT).sqrt().ceil() as u32;
    let camera = |i: u32| {
        let [x, y] = [i % side, i / side].map(|cell| cell as f32 / side as f32 - 0.5);
        let direction = (forward + right * (0.7 * x) - up * (0.7 * y)).normalize();
        (eye.to_f32(), direction.to_f32())
    };
    let camera: Vec<Ray> = (0..COUNT).map(camera).collect();
    let places = |i: u32| {
        let (origin, direction) = camera[i as usize];
        let hit = geometry.intersect(origin, direction, f32::MAX)?;
        let place = Vec3::from_f32(origin) + Vec3::from_f32(direction) * (hit.t * 0.9999);
        Some((i, place.to_f32()))
    };
    let places: Vec<(u32, [f32; 3])> = (0..COUNT).filter_map(places).collect();
    let from_places = |direction: &dyn Fn(u32) -> Vec3<f32>| {
        let ray = |&(i, place): &(u32, [f32; 3])| (place, direction(i).to_f32());
        places.iter().map(ray).collect()
    };
    let sun = |i: u32| vec3(0.4, 0.8, 0.45).normalize() + uniform_sphere(pair(i, 2)) * 0.02;
    let kind = |name, any, rays| Kind { name, any, rays };
    vec![
        kind("incoherent", false, (0..COUNT).map(incoherent).collect()),
        kind("camera", false, camera.clone()),
        kind("sun, any", true, from_places(&sun)),
        kind("bounce", false, from_places(&|i| uniform_sphere(pair(i, 3)))),
    ]
}
