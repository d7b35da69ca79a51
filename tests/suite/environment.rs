//! Environments: conventions of the map, look-up, and the sampling density against statistics and quadrature.

use std::f64::consts::{PI, TAU};

use glossmith::optics::real::Real;
use glossmith::optics::vector::{Vec3, vec3};
use glossmith::scene::environment::{
    Environment, EnvironmentSource, SkyParams, environment_density, environment_direction,
    environment_local_from_world, environment_radiance, environment_sample, environment_uv,
    environment_world_from_local, furnace, load, sky, studio, sun_direction, sun_irradiance, thumbnail,
};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// SplitMix64 (Steele, Lea and Flood 2014), for reproducible tests.
struct Random(u64);

impl Random {
    /// Uniform in [0, 1) with 24 bits, as the renderer's numbers have.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 40) as f64 / f64::from(1 << 24)
    }

    fn direction(&mut self) -> Vec3<f64> {
        let y = 1.0 - 2.0 * self.next();
        let azimuth = TAU * self.next();
        let horizontal = (1.0 - y * y).sqrt();
        vec3(horizontal * azimuth.cos(), y, horizontal * azimuth.sin())
    }

    fn triple<T: Real>(&mut self) -> Vec3<T> {
        Vec3::from_f64([self.next(), self.next(), self.next()])
    }
}

/// Texels from very dark to very bright, a third of them black.
fn random_map(width: u32, height: u32) -> Environment {
    let mut random = Random(7);
    let texels = (0..width * height)
        .map(|_| {
            let brightness = if random.next() < 0.33 {
                0.0
            } else {
                (8.0 * random.next() - 6.0).exp()
            };
            let [red, green, blue] = [0; 3].map(|_| (brightness * random.next()) as f32);
            [red, green, blue, 1.0]
        })
        .collect();
    Environment::from_texels("random", width, height, texels).unwrap()
}

/// One texel of 10⁵ in a sky of 0.1.
fn sun_map() -> Environment {
    let mut texels = vec![[0.1, 0.1, 0.1, 1.0]; 128 * 64];
    texels[20 * 128 + 90] = [1e5, 1e5, 9e4, 1.0];
    Environment::from_texels("sun", 128, 64, texels).unwrap()
}

fn constant_map(width: u32, height: u32, radiance: f32) -> Environment {
    let texels = vec![[radiance, radiance, radiance, 1.0]; (width * height) as usize];
    Environment::from_texels("constant", width, height, texels).unwrap()
}

fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{what}: {found}, expected {expected} ± {tolerance}"
    );
}

#[test]
fn axes_lie_where_the_convention_says() {
    let cases = [
        ([0.0, 0.0, -1.0], [0.0, 0.5]),
        ([1.0, 0.0, 0.0], [0.25, 0.5]),
        ([0.0, 0.0, 1.0], [0.5, 0.5]),
        ([-1.0, 0.0, 0.0], [0.75, 0.5]),
        ([0.0, 1.0, 0.0], [0.0, 0.0]),
        ([0.0, -1.0, 0.0], [0.0, 1.0]),
    ];
    for (direction, expected) in cases {
        let found = environment_uv(Vec3::<f64>::from_f64(direction));
        let found_f32 = environment_uv(Vec3::<f32>::from_f64(direction));
        for axis in 0..2 {
            assert_near(
                found[axis],
                expected[axis],
                1e-15,
                &format!("{direction:?} axis {axis}"),
            );
            assert_near(
                found_f32[axis].into(),
                expected[axis],
                1e-7,
                &format!("{direction:?} axis {axis} in f32"),
            );
        }
    }
}

#[test]
fn place_and_direction_are_inverse() {
    let mut random = Random(1);
    for index in 0..20_000 {
        let mut direction = random.direction();
        if index % 4 == 0 {
            // Close to a pole, where acos would lose half the digits.
            let tilt = 1e-6 * random.next();
            direction = vec3(tilt * direction.x, direction.y.signum(), tilt * direction.z).normalize();
        }
        let back = environment_direction(environment_uv(direction));
        assert!(
            (back - direction).length() < 1e-14,
            "{direction:?} came back as {back:?}"
        );
        let single = Vec3::<f32>::from_f64(direction.to_f64());
        let uv = environment_uv(single);
        assert!(
            (0.0..1.0).contains(&uv[0]) && (0.0..=1.0).contains(&uv[1]),
            "{direction:?} lies at {uv:?}"
        );
        let back = Vec3::<f64>::from_f64(environment_direction(uv).to_f64());
        assert!(
            (back - direction).length() < 1e-6,
            "f32: {direction:?} came back as {back:?}"
        );
    }
}

#[test]
fn a_direction_a_hair_before_the_seam_stays_inside_the_map() {
    let [u, v] = environment_uv(vec3(-1e-30_f32, 0.0, -1.0));
    assert!(u < 1.0 && v == 0.5, "({u}, {v})");
    let environment = random_map(8, 4);
    assert!(
        environment_radiance(&environment, vec3(-1e-30_f32, 0.0, -1.0))
            .max_component()
            .is_finite()
    );
}

#[test]
fn the_map_turns_anticlockwise_seen_from_above() {
    // A quarter turn brings what the map has at +Z to +X of the world.
    let rotation = [0.0, 1.0];
    let local = environment_local_from_world(vec3(1.0, 0.25, 0.0), rotation);
    assert_eq!(local, vec3(0.0, 0.25, 1.0));
    let mut random = Random(2);
    for _ in 0..100 {
        let direction = random.direction();
        let angle = TAU * random.next();
        let rotation = [angle.cos(), angle.sin()];
        let back = environment_world_from_local(environment_local_from_world(direction, rotation), rotation);
        assert!((back - direction).length() < 1e-14);
    }
}

#[test]
fn look_up_is_bilinear_wraps_around_and_stops_at_the_poles() {
    let environment = random_map(7, 5);
    let texel = |column: u32, row: u32| f64::from(environment.texels[(row * 7 + column) as usize][1]);
    let look = |x: f64, y: f64| environment_radiance(&environment, environment_direction([x / 7.0, y / 5.0])).y;
    for row in 0..5 {
        for column in 0..7 {
            let (x, y) = (f64::from(column) + 0.5, f64::from(row) + 0.5);
            let expected = texel(column, row);
            assert_near(look(x, y), expected, 1e-12, "at a centre");
            let right = texel((column + 1) % 7, row);
            assert_near(
                look(x + 0.25, y),
                0.75 * expected + 0.25 * right,
                1e-12,
                "between columns",
            );
            let below = texel(column, (row + 1).min(4));
            if row < 4 {
                assert_near(look(x, y + 0.4), 0.6 * expected + 0.4 * below, 1e-12, "between rows");
            }
        }
        let across_the_seam = 0.5 * (texel(6, row) + texel(0, row));
        assert_near(look(0.0, f64::from(row) + 0.5), across_the_seam, 1e-12, "on the seam");
    }
    assert_near(look(2.5, 0.2), texel(2, 0), 1e-12, "above the first row's centres");
    assert_near(look(2.5, 4.8), texel(2, 4), 1e-12, "below the last row's centres");
}

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
            let density = f64::from(environment.cells[(row * 12 + column) as usize].density);
            ratios.push(density / (sum / f64::from(POINTS * POINTS)));
        }
    }
    for ratio in &ratios {
        assert_near(ratio / ratios[0], 1.0, 1e-6, "density over mean luminance of a cell");
    }
}

/// ∫ density over the sphere: midpoints in azimuth and in the cosine, which is uniform in solid angle.
fn density_integral(environment: &Environment, columns: u32, rows: u32) -> f64 {
    let mut sum = 0.0;
    for row in 0..rows {
        let y = 1.0 - 2.0 * (f64::from(row) + 0.5) / f64::from(rows);
        for column in 0..columns {
            let azimuth = TAU * (f64::from(column) + 0.5) / f64::from(columns);
            let horizontal = (1.0 - y * y).sqrt();
            sum += environment_density(
                environment,
                vec3(horizontal * azimuth.sin(), y, -horizontal * azimuth.cos()),
            );
        }
    }
    sum * 4.0 * PI / (f64::from(columns) * f64::from(rows))
}

#[test]
fn density_integrates_to_one() {
    // The error is that of borders between cells that fall between midpoints: it goes with 1 / rows.
    assert_near(
        density_integral(&random_map(37, 19), 37 * 4, 40_000),
        1.0,
        2e-4,
        "random 37 × 19",
    );
    assert_near(density_integral(&sun_map(), 256, 40_000), 1.0, 1e-3, "sun");
    assert_near(density_integral(&constant_map(1, 1, 3.0), 8, 8), 1.0, 1e-6, "one texel");
    assert_near(density_integral(&furnace().unwrap(), 8, 8), 1.0, 1e-6, "furnace");
}

#[test]
fn a_large_map_has_merged_cells() {
    let (width, height) = (3001, 1401);
    let environment = random_map(width, height);
    assert_eq!((environment.cells_width, environment.cells_height), (1501, 701));
    let total: f64 = (0..environment.cells.len())
        .map(|index| f64::from(environment.cells[index].density) * cell_solid_angle(&environment, index))
        .sum();
    assert_near(total, 1.0, 1e-5, "sum of density times solid angle");
    // A merged cell is black only where the picture is.
    let mut random = Random(3);
    for _ in 0..20_000 {
        let direction = random.direction();
        if environment_radiance(&environment, direction).luminance() > 0.0 {
            assert!(
                environment_density(&environment, direction) > 0.0,
                "light without density at {direction:?}"
            );
        }
    }
    let p = chi_square_p::<f32>(&environment, [19, 19], 400_000, |_| 1.0);
    assert!(p > 1e-3, "p = {p}");
}

/// The solid angle of a cell, told by the cosines of its borders.
fn cell_solid_angle(environment: &Environment, index: usize) -> f64 {
    let row = (index as u32 / environment.cells_width) as f64;
    let cosine = |border: f64| (PI * border / f64::from(environment.cells_height)).cos();
    TAU / f64::from(environment.cells_width) * (cosine(row) - cosine(row + 1.0))
}

/// The p-value of `count` samples against the integral of the density over blocks of cells, each expectation times
/// `tamper(block)`.
fn chi_square_p<T: Real>(environment: &Environment, block: [u32; 2], count: u32, tamper: impl Fn(usize) -> f64) -> f64 {
    let columns = environment.cells_width.div_ceil(block[0]) as usize;
    let rows = environment.cells_height.div_ceil(block[1]) as usize;
    let block_of = |cell: [u32; 2]| (cell[1] / block[1]) as usize * columns + (cell[0] / block[0]) as usize;
    let mut expected = vec![0.0; columns * rows];
    for (index, cell) in environment.cells.iter().enumerate() {
        let index_u32 = index as u32;
        let place = [index_u32 % environment.cells_width, index_u32 / environment.cells_width];
        expected[block_of(place)] += f64::from(cell.density) * cell_solid_angle(environment, index) * f64::from(count);
    }
    let mut found = vec![0.0; columns * rows];
    let mut random = Random(11);
    for _ in 0..count {
        let (direction, density) = environment_sample::<T>(environment, random.triple());
        assert!(density.to_f64() > 0.0 && density.to_f64().is_finite());
        assert_near(direction.length().to_f64(), 1.0, 1e-6, "length");
        let uv = environment_uv(Vec3::<f64>::from_f64(direction.to_f64()));
        let size = [environment.cells_width, environment.cells_height];
        found[block_of([0, 1].map(|axis| ((uv[axis] * f64::from(size[axis])) as u32).min(size[axis] - 1)))] += 1.0;
    }
    let (mut statistic, mut cells, mut pooled) = (0.0, 0, (0.0, 0.0));
    for (block, (found, expected)) in found.iter().zip(&expected).enumerate() {
        let expected = expected * tamper(block);
        if expected < 10.0 {
            pooled = (pooled.0 + found, pooled.1 + expected);
        } else {
            statistic += (found - expected) * (found - expected) / expected;
            cells += 1;
        }
    }
    if pooled.1 >= 1.0 {
        statistic += (pooled.0 - pooled.1) * (pooled.0 - pooled.1) / pooled.1;
        cells += 1;
    } else {
        assert!(pooled.0 < 12.0, "{} samples where {} were expected", pooled.0, pooled.1);
    }
    ChiSquared::new(f64::from(cells - 1)).unwrap().sf(statistic)
}

#[test]
fn samples_follow_the_density() {
    let cases = [
        ("random 37 × 19", random_map(37, 19), [1, 1]),
        ("random 2000 × 1000", random_map(2000, 1000), [40, 40]),
        ("single sun", sun_map(), [2, 2]),
        ("sky", load(&EnvironmentSource::Sky).unwrap(), [32, 32]),
        ("studio", load(&EnvironmentSource::Studio).unwrap(), [16, 16]),
    ];
    for (name, environment, block) in &cases {
        let double = chi_square_p::<f64>(environment, *block, 1_000_000, |_| 1.0);
        assert!(double > 1e-3, "{name} in f64: p = {double}");
        let single = chi_square_p::<f32>(environment, *block, 1_000_000, |_| 1.0);
        assert!(single > 1e-3, "{name} in f32: p = {single}");
        // The test sees a density that is off by two per cent.
        let tampered = chi_square_p::<f32>(
            environment,
            *block,
            1_000_000,
            |block| if block % 2 == 0 { 1.02 } else { 0.98 },
        );
        assert!(tampered < 1e-6, "{name}: a tampered density passed with p = {tampered}");
    }
}

#[test]
fn samples_are_uniform_inside_a_cell() {
    for environment in [constant_map(1, 1, 2.0), furnace().unwrap(), constant_map(3, 3, 1.0)] {
        const ROWS: usize = 24;
        const COLUMNS: usize = 48;
        let mut found = vec![0.0; ROWS * COLUMNS];
        let mut random = Random(5);
        let count = 500_000;
        for _ in 0..count {
            let (direction, density) = environment_sample::<f32>(&environment, random.triple());
            assert_near(density.into(), 0.25 / PI, 1e-6, "density");
            let row = ((1.0 - direction.y) / 2.0 * ROWS as f32) as usize;
            let column = environment_uv(direction)[0] * COLUMNS as f32;
            found[row.min(ROWS - 1) * COLUMNS + column as usize] += 1.0;
        }
        let expected = f64::from(count) / (ROWS * COLUMNS) as f64;
        let statistic: f64 = found
            .iter()
            .map(|found: &f64| (found - expected).powi(2) / expected)
            .sum();
        let p = ChiSquared::new((ROWS * COLUMNS - 1) as f64).unwrap().sf(statistic);
        assert!(p > 1e-3, "{} × {}: p = {p}", environment.width, environment.height);
    }
}

#[test]
fn the_density_of_a_sampled_direction_is_the_one_it_was_drawn_with() {
    for environment in [random_map(37, 19), sun_map(), sky(&SkyParams::default()).unwrap()] {
        let mut random = Random(13);
        let size = [environment.cells_width, environment.cells_height].map(f64::from);
        let mut strays = 0;
        for _ in 0..200_000 {
            let (direction, density) = environment_sample::<f32>(&environment, random.triple());
            if environment_density(&environment, direction) == density {
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
        assert!(strays < 200, "{}: {strays} strays", environment.name);
    }
}

#[test]
fn extreme_random_numbers_give_sound_samples() {
    let last = 1.0 - f32::EPSILON / 2.0;
    for environment in [
        random_map(37, 19),
        sun_map(),
        constant_map(1, 1, 1.0),
        constant_map(2000, 3, 1.0),
    ] {
        for corner in 0..8 {
            let xi = [0, 1, 2].map(|bit| if corner >> bit & 1 == 0 { 0.0 } else { last });
            let (direction, density) = environment_sample::<f32>(&environment, vec3(xi[0], xi[1], xi[2]));
            assert_near(direction.length().into(), 1.0, 1e-6, "length");
            assert!(density > 0.0 && density.is_finite());
        }
    }
}

#[test]
fn a_black_map_has_no_density_and_no_trouble() {
    let environment = constant_map(6, 3, 0.0);
    assert!(environment.is_black && environment.is_constant);
    let mut random = Random(17);
    for _ in 0..1000 {
        let (direction, density) = environment_sample::<f32>(&environment, random.triple());
        assert_eq!(density, 0.0);
        assert_near(direction.length().into(), 1.0, 1e-6, "length");
        assert_eq!(environment_density(&environment, direction), 0.0);
    }
    assert!(
        thumbnail(&environment, 4, 2)
            .iter()
            .all(|pixel| *pixel == [0, 0, 0, 255])
    );
}

#[test]
fn the_furnace_is_one_everywhere() {
    let environment = load(&EnvironmentSource::Furnace).unwrap();
    assert!(environment.is_constant && !environment.is_black);
    assert_eq!(environment.mean_radiance, [1.0; 3]);
    let mut random = Random(19);
    for _ in 0..1000 {
        let radiance = environment_radiance(&environment, Vec3::<f32>::from_f64(random.direction().to_f64()));
        assert_eq!(radiance, Vec3::splat(1.0));
    }
}

/// ∫ radiance over a disc around `centre`, and the same for the luminance-weighted direction.
fn disc_integral(environment: &Environment, centre: Vec3<f64>, radius_rad: f64) -> ([f64; 3], Vec3<f64>) {
    const POINTS: u32 = 800;
    let helper = if centre.y.abs() < 0.9 {
        vec3(0.0, 1.0, 0.0)
    } else {
        vec3(1.0, 0.0, 0.0)
    };
    let right = helper.cross(centre).normalize();
    let up = centre.cross(right);
    let (mut sum, mut middle) = ([0.0; 3], Vec3::zero());
    let step = 2.0 * radius_rad.tan() / f64::from(POINTS);
    for point in 0..POINTS * POINTS {
        let x = (f64::from(point % POINTS) + 0.5) * step - radius_rad.tan();
        let y = (f64::from(point / POINTS) + 0.5) * step - radius_rad.tan();
        let length_squared = 1.0 + x * x + y * y;
        if length_squared > 1.0 + radius_rad.tan().powi(2) {
            continue;
        }
        let direction = (centre + right * x + up * y).normalize();
        let radiance = environment_radiance(environment, direction);
        let solid_angle = step * step / length_squared.powf(1.5);
        sum = [0, 1, 2].map(|channel| sum[channel] + radiance.to_f64()[channel] * solid_angle);
        middle += direction * (radiance.luminance() * solid_angle);
    }
    (sum, middle.normalize())
}

#[test]
fn the_sun_of_the_sky_has_its_energy_and_its_place() {
    let default = SkyParams::default();
    let cases = [
        default,
        SkyParams {
            sun_elevation_deg: 3.0,
            turbidity: 6.0,
            ..default
        },
        SkyParams {
            sun_azimuth_deg: 0.03,
            ..default
        },
        SkyParams {
            sun_elevation_deg: 89.9,
            ..default
        },
        SkyParams {
            sun_elevation_deg: 90.0,
            ..default
        },
    ];
    for params in cases {
        let environment = sky(&params).unwrap();
        let centre = sun_direction(&params);
        let expected = sun_irradiance(&params);
        let radius_rad = 0.6_f64.to_radians();
        let (found, middle) = disc_integral(&environment, centre, radius_rad);
        // What the sky itself adds: its radiance just outside of the disc.
        let tilt = 0.8_f64.to_radians();
        let beside = (centre + vec3(0.0, 1.0, 0.001).cross(centre).normalize() * tilt).normalize();
        let background = environment_radiance(&environment, beside).to_f64();
        for channel in 0..3 {
            let sun = found[channel] - background[channel] * PI * radius_rad * radius_rad;
            assert_near(
                sun / expected[channel],
                1.0,
                2e-3,
                &format!("energy, channel {channel}, {params:?}"),
            );
        }
        let off_deg = (middle - centre).length().to_degrees();
        assert!(off_deg < 0.02, "the sun is off by {off_deg}° with {params:?}");
    }
}

#[test]
fn the_sky_is_plausible_and_its_parameters_are_checked() {
    let params = SkyParams::default();
    let environment = sky(&params).unwrap();
    let up = environment_radiance(&environment, vec3(0.0, 1.0, 0.0_f64));
    assert!(up.z > 1.3 * up.x, "the zenith is blue: {up:?}");
    let ground = environment_radiance(&environment, vec3(0.0, -1.0, 0.0_f64));
    assert!(ground.x > ground.z, "the ground is brownish: {ground:?}");
    let ratio = f64::from(environment.max_luminance) / up.luminance();
    assert!((1e4..1e6).contains(&ratio), "sun over sky: {ratio}");
    for bad in [
        SkyParams {
            turbidity: 0.0,
            ..params
        },
        SkyParams {
            sun_elevation_deg: -1.0,
            ..params
        },
        SkyParams {
            sun_azimuth_deg: f64::NAN,
            ..params
        },
        SkyParams {
            ground_albedo: [2.0, 0.0, 0.0],
            ..params
        },
    ] {
        assert!(sky(&bad).is_err(), "{bad:?} passed");
    }
}

/// The radiance of a white diffuse surface with the given normal.
fn white_radiance(environment: &Environment, normal: Vec3<f64>) -> f64 {
    let mut random = Random(23);
    let count = 100_000;
    let sum: f64 = (0..count)
        .map(|_| {
            let (direction, density) = environment_sample::<f64>(environment, random.triple());
            environment_radiance(environment, direction).luminance() * direction.dot(normal).max(0.0) / density
        })
        .sum();
    sum / f64::from(count) / PI
}

#[test]
fn built_in_lights_are_right_for_exposure_0() {
    let sky = sky(&SkyParams::default()).unwrap();
    let table = white_radiance(&sky, vec3(0.0, 1.0, 0.0));
    assert_near(table, 1.0, 0.05, "a white table under the sky");
    let studio = studio().unwrap();
    let towards_key = white_radiance(&studio, vec3(-0.62, 0.6, 0.5).normalize());
    assert!(
        (0.8..1.4).contains(&towards_key),
        "white towards the key light: {towards_key}"
    );
    let shadow_side = white_radiance(&studio, vec3(1.0, -0.2, 0.4).normalize());
    assert!(
        (0.08..0.5).contains(&shadow_side),
        "white on the shadow side: {shadow_side}"
    );
}

#[test]
fn a_thumbnail_shows_the_map() {
    let mut texels = vec![[0.02, 0.02, 0.02, 1.0]; 16 * 8];
    for row in 0..4 {
        for column in 0..8 {
            texels[row * 16 + column] = [2.0, 0.5, 0.5, 1.0];
        }
    }
    let environment = Environment::from_texels("quarters", 16, 8, texels).unwrap();
    let pixels = thumbnail(&environment, 8, 4);
    assert_eq!(pixels.len(), 32);
    let [red, green, _, alpha] = pixels[8 + 2];
    assert!(red > 150 && red > green && alpha == 255, "{:?}", pixels[10]);
    assert!(pixels[3 * 8 + 6][0] < 80, "{:?}", pixels[3 * 8 + 6]);
}

#[test]
fn the_shader_is_valid() {
    let stub = "
        @group(0) @binding(0) var environment_map: texture_2d<f32>;
        @group(0) @binding(1) var<storage, read> environment_cells: array<AliasCell>;
        @group(0) @binding(2) var<storage, read_write> result: array<vec4f>;
        @compute @workgroup_size(1) fn main() {
            let world = environment_direction(vec2f(0.25, 0.5));
            let local = environment_local_from_world(world, vec2f(1.0, 0.0));
            let drawn = environment_sample(vec3f(0.1, 0.2, 0.3), vec2u(4u, 2u));
            result[0] = vec4f(environment_radiance(local), environment_density(drawn.direction, vec2u(4u, 2u)));
            result[1] = vec4f(environment_world_from_local(drawn.direction, vec2f(1.0, 0.0)), drawn.density);
        }";
    let source = include_str!("../../shaders/scene/environment.wgsl").to_owned() + stub;
    let module =
        naga::front::wgsl::parse_str(&source).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)));
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    validator
        .validate(&module)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)));
    let cell = module
        .types
        .iter()
        .find(|(_, t)| t.name.as_deref() == Some("AliasCell"))
        .unwrap()
        .1;
    let naga::TypeInner::Struct { members, span } = &cell.inner else {
        panic!("AliasCell is no struct")
    };
    assert_eq!(*span as usize, size_of::<glossmith::scene::environment::AliasCell>());
    let names: Vec<_> = members
        .iter()
        .map(|member| (member.name.as_deref().unwrap(), member.offset))
        .collect();
    assert_eq!(names, [("threshold", 0), ("alias_index", 4), ("density", 8)]);
}
