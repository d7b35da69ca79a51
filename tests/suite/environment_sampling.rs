//! Environments: the density that they are sampled with, against the picture and statistics.

use crate::environment::{assert_near, constant_map, random_map, sun_map, triple};
use crate::support::Random;
use glossmith::{
    analysis::chi_square::test_counts,
    import::environment::load,
    optics::vector::{Vec3, vec3},
    scene::environment::{
        Distribution, EnvironmentSource, SkyParams, environment_density, environment_direction, environment_radiance,
        environment_sample, environment_uv, sky,
    },
    scene::inversion::{DRAW_BITS, drawn, find, place_in, shares},
};
use std::f64::consts::{PI, TAU};

#[test]
fn density_is_the_luminance_of_the_bilinear_picture() {
    let environment = random_map(12, 6);
    let mut ratios = Vec::new();
    for row in 0..6 {
        for column in 0..12 {
            // The midpoint rule with an even number of points is exact for pieces that are linear.
            const POINTS: u32 = 16;
            let sum: f64 = (0..POINTS * POINTS)
                .map(|point| {
                    let x = f64::from(column) + (f64::from(point % POINTS) + 0.5) / f64::from(POINTS);
                    let y = f64::from(row) + (f64::from(point / POINTS) + 0.5) / f64::from(POINTS);
                    environment_radiance(&environment, environment_direction([x / 12.0, y / 6.0])).luminance()
                })
                .sum();
            let density = f64::from(environment.distribution(true).cells[(row * 12 + column) as usize].density);
            ratios.push(density / (sum / f64::from(POINTS * POINTS)));
        }
    }
    for ratio in &ratios {
        // To the nearest of the 2²⁴ numbers that draw a cell of its row, and a row.
        assert_near(ratio / ratios[0], 1.0, 0.0001, "density over mean luminance of a cell");
    }
}

/// The solid angle of a cell, told by the cosines of its borders.
fn cell_solid_angle(distribution: &Distribution, index: usize) -> f64 {
    let row = (index as u32 / distribution.width) as f64;
    let cosine = |border: f64| (PI * border / f64::from(distribution.height)).cos();
    TAU / f64::from(distribution.width) * (cosine(row) - cosine(row + 1.0))
}

/// So many samples see a density that is off by 1 % on half of some fifty blocks with 99.9 %.
const COUNT: u32 = 1_000_000;

/// The p-value of samples against the integral of the density over blocks of cells, and that of a density that is 1 % too
/// high or low in every other block.
fn p_values(distribution: &Distribution, block: [u32; 2]) -> [f64; 2] {
    let columns = distribution.width.div_ceil(block[0]) as usize;
    let rows = distribution.height.div_ceil(block[1]) as usize;
    let block_of = |cell: [u32; 2]| (cell[1] / block[1]) as usize * columns + (cell[0] / block[0]) as usize;
    let mut expected = vec![0.0; columns * rows];
    for (index, cell) in distribution.cells.iter().enumerate() {
        let place = [index as u32 % distribution.width, index as u32 / distribution.width];
        expected[block_of(place)] += f64::from(cell.density) * cell_solid_angle(distribution, index) * f64::from(COUNT);
    }
    let mut found = vec![0; columns * rows];
    let mut random = Random::new(11);
    for _ in 0..COUNT {
        let (direction, density) = environment_sample::<f32>(distribution, triple(&mut random));
        assert!(density > 0.0 && density.is_finite());
        let uv = environment_uv(Vec3::<f64>::from_f64(direction.to_f64()));
        let size = [distribution.width, distribution.height];
        found[block_of([0, 1].map(|axis| ((uv[axis] * f64::from(size[axis])) as u32).min(size[axis] - 1)))] += 1;
    }
    let tampered: Vec<f64> = expected
        .iter()
        .enumerate()
        .map(|(i, x)| x * [1.01, 0.99][i % 2])
        .collect();
    [&expected, &tampered].map(|expected| test_counts(&found, expected).p_value)
}

#[test]
fn samples_follow_the_density() {
    let cases = [
        ("random", random_map(37, 19), [5, 3], true),
        ("single sun", sun_map(), [4, 4], true),
        ("sky", load(&EnvironmentSource::Sky).unwrap(), [256, 128], false),
    ];
    for (name, environment, block, is_alone) in &cases {
        let [right, tampered] = p_values(environment.distribution(*is_alone), *block);
        assert!(right > 0.001, "{name}: p = {right}");
        assert!(
            tampered < 0.001,
            "{name}: a tampered density passed with p = {tampered}"
        );
    }
}

#[test]
fn what_lobes_find_as_well_is_left_to_them() {
    let sky = sky(&SkyParams::default()).unwrap();
    let density = |is_alone, direction| environment_density(sky.distribution(is_alone), direction);
    let sun = environment_direction(sky.brightest.unwrap().map(f64::from));
    // The zenith, and the ground.
    for away in [vec3(0.0, 1.0, 0.0), vec3(0.0, -1.0, 0.0)] {
        assert!(density(true, away) > 0.0 && density(false, away) == 0.0);
    }
    assert!(density(false, sun) > density(true, sun));
    // An even environment has nothing above its mean, but for rounding.
    let even = constant_map(64, 32, 0.7);
    let cells = &even.distribution(false).cells;
    assert!(
        cells
            .iter()
            .all(|cell| (f64::from(cell.density) * 4.0 * PI - 1.0).abs() < 0.001)
    );
}

#[test]
fn the_density_of_a_sampled_direction_is_the_one_it_was_drawn_with() {
    for environment in [random_map(37, 19), sun_map(), sky(&SkyParams::default()).unwrap()] {
        let mut random = Random::new(13);
        let size = [
            environment.distribution(true).width,
            environment.distribution(true).height,
        ]
        .map(f64::from);
        let mut strays = 0;
        for _ in 0..50_000 {
            let (direction, density) = environment_sample::<f32>(environment.distribution(true), triple(&mut random));
            if environment_density(environment.distribution(true), direction) == density {
                continue;
            }
            strays += 1;
            let uv = environment_uv(Vec3::<f64>::from_f64(direction.to_f64()));
            let to_border = [0, 1].map(|axis| {
                let place = uv[axis] * size[axis];
                (place - place.round()).abs()
            });
            // Near a pole a step of 1e-7 in the direction is a long way in azimuth.
            let horizontal = f64::from(direction.x).hypot(direction.z.into());
            let reach = 2e-7 * size[0];
            assert!(
                to_border[0] < reach / horizontal || to_border[1] < reach,
                "{}: {direction:?}, {to_border:?} from the border",
                environment.name
            );
        }
        assert!(strays < 50, "{}: {strays} strays", environment.name);
    }
}

/// How many numbers there are to draw with.
const DRAWS: u32 = 1 << DRAW_BITS;

fn check(weights: &[f64]) {
    let shares = shares(weights);
    let count = weights.len() as u32;
    let mut before = 0;
    for share in &shares {
        assert!(share.upper >= before);
        before = share.upper;
    }
    assert_eq!(before, DRAWS);
    for number in (0..DRAWS).step_by(97).chain(DRAWS - 40..DRAWS) {
        let share = |index: u32| shares[index as usize];
        let drawn = drawn(find(count, number, share), share);
        assert!((drawn.lower..drawn.upper).contains(&number), "{number}: {drawn:?}");
        let place = place_in(drawn, number, 0.5_f64);
        assert!((0.0..=1.0).contains(&place));
    }
    let total: f64 = weights.iter().sum();
    let fair = |weight: f64| weight / total * f64::from(DRAWS);
    // Each weight of less than a number has one all the same, which others lack.
    let raised = weights.iter().filter(|weight| fair(**weight) < 1.0).count() as f64;
    for (index, weight) in weights.iter().enumerate() {
        let lower = index.checked_sub(1).map_or(0, |before| shares[before].upper);
        let own = f64::from(shares[index].upper - lower);
        assert_eq!(own > 0.0, *weight > 0.0);
        near!(own, fair(*weight), 1.0 + raised, "{index}");
    }
}

#[test]
fn numbers_are_shared_out_in_proportion_and_each_draws_its_entry() {
    check(&[1.0]);
    check(&[0.0, 3.0, 0.0, 0.0, 1.0, 0.0]);
    check(&[1.0; 1000]);
    let weights: Vec<f64> = (0..1501).map(|i| f64::from(i * 7919 % 83) * 0.3).collect();
    check(&weights);
    // A sun: all others share a slot.
    let sun: Vec<f64> = (0..2048).map(|i| if i == 700 { 1e9 } else { 0.001 }).collect();
    check(&sun);
}

#[test]
fn nothing_is_drawn_where_there_is_nothing() {
    let shares = shares(&[0.0; 5]);
    let share = |index: u32| shares[index as usize];
    let drawn = drawn(find(5, 77, share), share);
    assert_eq!((drawn.lower, drawn.upper), (0, 0));
    assert_eq!(place_in(drawn, 77, 0.5_f32), 1.0);
}
