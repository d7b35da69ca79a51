//! Sums over many samples and many bounces, and the random numbers behind them.

use glam::DVec3;
use serde_json::json;

use super::{Stage, StudyError, glb::Glb, meshes::cube, stage::mean_luminance};
use crate::{
    cpu::probe::probe_random,
    document::{MaterialSettings, Strategy},
    job::probe::{ProbeScene, RandomQuestion},
    optics::fresnel::Fresnel,
    optics::random::{Sequence, hash_bits, path_state, random_pair, random_state},
    scene::{
        ModelSource,
        camera::{PIXEL_DIMENSION, pixel_ray},
        environment::{EnvironmentSource, environment_local_from_world, environment_radiance},
    },
    study::small_document,
};

cases! {
    "sums"
    "ten-million-samples"
        "a sum in f32 stalls once a sample is below its last bit: the mean falls as more are added"
        "a pixel of the edge between two soft boxes, 10⁷ samples (3 · 10⁵ in a quick run)"
        "mean and variance are those of the same samples in f64: worst relative error"
        "2 · 10⁷ ones add up to 1.68e7",
        "error" 1e-5, |stage| many_samples(stage);
    "white-box-lambert"
        "64 bounces between white walls multiply 64 roundings and what a sample loses"
        "the inside of a closed cube, Lambertian and white, that emits 1/65; paths of 64 bounces, two strategies"
        "the mean is 1"
        "0.99⁶⁴ = 0.53 where each bounce loses 1 %",
        "error" 5e-3, |stage| white_box(stage, MaterialSettings::diffuse("white", [1.0; 3]));
    "white-box-geometric"
        "the same with the geometric lobe: what it samples below the horizon is lost"
        "the same cube with the geometric lobe at R = 0.5 that reflects all"
        "the mean is 1"
        "a third of the samples are below the horizon at grazing views",
        "error" 5e-3, |stage| {
            let material = MaterialSettings {
                fresnel: Fresnel::None,
                roughness: 0.5,
                specular_color: [1.0; 3],
                specular_weight: 1.0,
                base_color: [0.0; 3],
                ..MaterialSettings::default()
            };
            white_box(stage, material)
        };
    "random-streams-never-repeat"
        "a short period or a hash that collides: samples that repeat add nothing, and show"
        "a pixel's number for samples all over 2³², both sequences, computed backwards"
        "each number names its sample, so that no two of 2³² share one; those that do not are counted"
        "34464 of 10⁵ repeat under 16-bit state",
        "count" 0.0, |stage| not_invertible(stage);
    "neighbours-uncorrelated"
        "pixels, samples and dimensions next to each other draw related numbers: patterns in the noise"
        "65 536 samples each of neighbouring pixels, seeds and dimensions, both numbers of both sequences"
        "the largest correlation of 96 pairs, in standard deviations of uniform random numbers"
        "a seed of x + 1024 · y: neighbours differ in one bit",
        "sigma" 5.0, |stage| largest_correlation(stage);
    "random-bits-everywhere-equal"
        "numbers made with floats (fract(sin(x) · 43758)) differ from adapter to adapter"
        "a million (100 000 in a quick run) random pixels, seeds, samples and dimensions, both sequences"
        "the engine's bits are the CPU's; those that are not are counted"
        "off by 1.1e1",
        "count" 0.0, |stage| {
            let count = if stage.thorough { 1_000_000 } else { 100_000 };
            let question = |i: u32| {
                let any = |salt: u32| hash_bits(hash_bits(i).wrapping_add(salt));
                RandomQuestion {
                    pixel: [any(1) & 0xffff, any(2) & 0xffff],
                    seed: any(3),
                    sample: any(4),
                    sequence: i % 2,
                    dimension: any(5) % 8192,
                }
            };
            let questions: Vec<_> = (0..count).map(question).collect();
            let answers = stage.prober.random(&ProbeScene::default(), &questions)?;
            let differ = |(a, b): &(&[u32; 2], &[u32; 2])| a != b;
            Ok(answers.iter().zip(&probe_random(&questions)).filter(differ).count() as f64)
        };
}

/// Mean and variance of a pixel against the background's in f64 with the same random numbers.
fn many_samples(stage: &mut Stage) -> Result<f64, StudyError> {
    let samples = if stage.thorough { 10_000_000 } else { 300_000 };
    let light = stage.environment("steps.exr", [64, 32], |x, y| {
        [0.1 + (x % 7) as f32, 0.3 + (y % 5) as f32, 0.7 + ((x + y) % 3) as f32]
    })?;
    let mut document = small_document(ModelSource::Plane, light, 1, samples);
    (document.camera.position, document.camera.target) = (Some([0.0, 3.0, 0.0]), Some([0.0, 4.0, 0.3]));
    // Every ray misses; fewer bounces allow longer passes on software Vulkan.
    document.render.bounces = 1;
    let found = stage.film(&document)?;
    let Some(job) = stage.session.job().cloned() else {
        return Ok(f64::INFINITY);
    };
    let settings = &job.settings;
    let luminance = |sample: u32| {
        let state = path_state(0, 0, settings.seed, sample, settings.sequence);
        let numbers = [random_pair(state, PIXEL_DIMENSION), [0.0; 2]];
        let [_, direction] = pixel_ray(&settings.camera, [0.0; 2], settings.image_size, numbers);
        let local = environment_local_from_world(direction, settings.environment_rotation);
        environment_radiance(&job.environment, local).luminance() * settings.environment_strength
    };
    let add = |[sum, squares]: [f64; 2], x: f64| [sum + x, squares + x * x];
    let [sum, squares] = (0..samples).map(luminance).fold([0.0; 2], add);
    let count = f64::from(samples);
    let mean = sum / count;
    let variance = (squares - sum * mean) / (count - 1.0) / count;
    let errors = [found.luminance()[0] / mean, found.variance_of_mean()[0] / variance].map(|x| (x - 1.0).abs());
    Ok(errors
        .into_iter()
        .fold(0.0, |a: f64, b| if b.is_nan() { f64::INFINITY } else { a.max(b) }))
}

/// Deviation of the mean from 1 in a closed box that emits equally at each of 65 path vertices.
fn white_box(stage: &mut Stage, mut material: MaterialSettings) -> Result<f64, StudyError> {
    material.emission_color = [1.0; 3];
    material.emission_strength = 1.0 / 65.0;
    let model = Glb::of(&cube(DVec3::ONE, 2), json!({})).write(stage, "box.glb")?;
    let mut worst = 0.0_f64;
    for strategy in [Strategy::Lobe, Strategy::Mis] {
        let mut document = small_document(model.clone(), EnvironmentSource::Furnace, 16, 16);
        document.materials = vec![material.clone()];
        document.render.strategy = strategy;
        document.render.bounces = 64;
        (document.camera.position, document.camera.target) = (Some([0.3, 0.2, 0.1]), Some([-0.5, -0.4, -0.9]));
        let film = stage.film(&document)?;
        worst = worst.max((mean_luminance(&film) - 1.0).abs() + film.dropped() as f64);
    }
    Ok(worst)
}

/// Number of random numbers from which the sample index cannot be recovered by inverting the hash.
fn not_invertible(stage: &Stage) -> Result<f64, StudyError> {
    let (pixel, seed, dimension) = ([123, 456], 7, 9);
    let count = 1 << 17;
    let mut lost = 0;
    for sequence in Sequence::ALL {
        // The first, the last, and many in between.
        let sample = |i: u32| match i % 3 {
            0 => i,
            1 => u32::MAX - i,
            _ => hash_bits(i),
        };
        let question = |i: u32| RandomQuestion {
            pixel,
            seed,
            sample: sample(i),
            sequence: *sequence as u32,
            dimension,
        };
        let questions: Vec<_> = (0..count).map(question).collect();
        let key = random_state(pixel[0], pixel[1], seed, 0, *sequence).key;
        let answers = stage.prober.random(&ProbeScene::default(), &questions)?;
        let pairs = questions.iter().zip(&answers);
        lost += pairs
            .filter(|(question, bits)| sample_from_bits(key, dimension, *sequence, bits[0]) != question.sample)
            .count();
    }
    Ok(lost as f64)
}

/// The sample that a pixel's first number of a pair came from: the sequences backwards.
fn sample_from_bits(key: u32, dimension: u32, sequence: Sequence, bits: u32) -> u32 {
    let place = dimension.wrapping_mul(0x9e37_79b9);
    match sequence {
        Sequence::Independent => {
            let stream = hash_bits(key ^ (2 * dimension).wrapping_mul(0x9e37_79b9));
            unhash(unhash(bits).wrapping_sub(stream.rotate_left(16) ^ key)) ^ stream
        }
        Sequence::Sobol => {
            let seed = hash_bits(key ^ place.wrapping_add(0x2545_f491));
            let index = unscramble(bits.reverse_bits(), hash_bits(seed ^ 0x68bc_21eb));
            unscramble(index.reverse_bits(), seed).reverse_bits()
        }
    }
}

/// The inverse of an odd number modulo 2³², by Newton's iteration.
fn inverse(odd: u32) -> u32 {
    (0..5).fold(odd, |x, _| x.wrapping_mul(2u32.wrapping_sub(odd.wrapping_mul(x))))
}

/// [`hash_bits`] backwards.
fn unhash(bits: u32) -> u32 {
    let mut x = bits;
    x ^= x >> 16;
    x = x.wrapping_mul(inverse(0x846c_a68b));
    x ^= (x >> 15) ^ (x >> 30);
    x = x.wrapping_mul(inverse(0x7feb_352d));
    x ^ (x >> 16)
}

/// x from x ^ x · `even`, bit by bit from the lowest: each is only changed by those below it.
fn undo(y: u32, even: u32) -> u32 {
    (0..32).fold(y, |x, _| y ^ x.wrapping_mul(even))
}

/// Owen's scramble backwards.
fn unscramble(bits: u32, seed: u32) -> u32 {
    let mut x = undo(bits, 0x53a2_2864);
    x = undo(x, 0x0552_6c56);
    x = x.wrapping_mul(inverse((seed >> 16) | 1));
    x = x.wrapping_sub(seed);
    undo(x, 0x3d20_adea)
}

/// The largest correlation between numbers drawn at places next to each other, times √n.
fn largest_correlation(stage: &Stage) -> Result<f64, StudyError> {
    const SAMPLES: u32 = 1 << 16;
    /// Pixel, seed, first sample and dimension.
    const MIDDLE: ([u32; 2], u32, u32, u32) = ([100, 200], 0, 0, 3);
    let others = [
        ([101, 200], 0, 0, 3),
        ([100, 201], 0, 0, 3),
        ([101, 201], 0, 0, 3),
        ([102, 200], 0, 0, 3),
        ([100, 200], 1, 0, 3),
        ([200, 100], 0, 0, 3),
        ([100, 200], 0, 0, 4),
        ([100, 200], 0, 0, 2),
        ([100, 200], 0, 0, 4096),
        // Points of the Sobol sequence depend on each other by design: not for it.
        ([100, 200], 0, 1, 3),
    ];
    let mut worst = 0.0_f64;
    for &sequence in Sequence::ALL {
        let draw = |(pixel, seed, first, dimension): ([u32; 2], u32, u32, u32)| {
            let question = |i: u32| {
                let sample = first + i;
                RandomQuestion {
                    pixel,
                    seed,
                    sample,
                    sequence: sequence as u32,
                    dimension,
                }
            };
            stage
                .prober
                .random(&ProbeScene::default(), &(0..SAMPLES).map(question).collect::<Vec<_>>())
        };
        let middle = draw(MIDDLE)?;
        let mut judge = |a: usize, other: &[[u32; 2]], b: usize| {
            worst = worst.max(correlation(&middle, a, other, b).abs() * f64::from(SAMPLES).sqrt());
        };
        for other in others
            .into_iter()
            .filter(|other| other.2 == 0 || sequence == Sequence::Independent)
        {
            let other = draw(other)?;
            for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                judge(a, &other, b);
            }
        }
        judge(0, &middle, 1);
    }
    Ok(worst)
}

fn correlation(left: &[[u32; 2]], a: usize, right: &[[u32; 2]], b: usize) -> f64 {
    let unit = |bits: u32| f64::from(bits) / f64::from(u32::MAX) - 0.5;
    let sum: f64 = left.iter().zip(right).map(|(l, r)| unit(l[a]) * unit(r[b])).sum();
    12.0 * sum / left.len() as f64
}
