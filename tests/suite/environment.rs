//! Environments: conventions of the map, look-up, and the sampling density against statistics and quadrature.

use crate::support::Random;
use glossmith::{
    optics::real::Scalar,
    optics::vector::{Vec3, vec3},
    scene::environment::{
        Environment, SkyParams, brightened, environment_direction, environment_local_from_world, environment_radiance,
        environment_sample, environment_uv, environment_world_from_local, sky, studio, sun_direction, sun_irradiance,
    },
};
use std::f64::consts::{PI, TAU};

/// A direction, uniform on the sphere.
pub fn random_direction(random: &mut Random) -> Vec3<f64> {
    let y = 1.0 - 2.0 * number(random);
    let azimuth = TAU * number(random);
    let horizontal = (1.0 - y * y).sqrt();
    vec3(horizontal * azimuth.cos(), y, horizontal * azimuth.sin())
}

/// Uniform in [0, 1), with the 24 bits that the renderer's numbers have.
pub fn number(random: &mut Random) -> f64 {
    f64::from(random.unit())
}

/// What a sample is drawn with.
pub fn triple<T: Scalar>(random: &mut Random) -> Vec3<T> {
    Vec3::from_f64([number(random), number(random), number(random)])
}

/// Texels from very dark to very bright, a third of them black.
pub fn random_map(width: u32, height: u32) -> Environment {
    let mut random = Random::new(7);
    let texels = (0..width * height)
        .map(|_| {
            let brightness = if number(&mut random) < 0.33 {
                0.0
            } else {
                (8.0 * number(&mut random) - 6.0).exp()
            };
            let [red, green, blue] = [0; 3].map(|_| (brightness * number(&mut random)) as f32);
            [red, green, blue, 1.0]
        })
        .collect();
    Environment::from_texels("random", width, height, texels).expect("a sound map")
}

/// One texel of 10⁵ in a sky of 0.1.
pub fn sun_map() -> Environment {
    let mut texels = vec![[0.1, 0.1, 0.1, 1.0]; 128 * 64];
    texels[20 * 128 + 90] = [1e5, 1e5, 9e4, 1.0];
    Environment::from_texels("sun", 128, 64, texels).expect("a sound map")
}

pub fn constant_map(width: u32, height: u32, radiance: f32) -> Environment {
    let texels = vec![[radiance, radiance, radiance, 1.0]; (width * height) as usize];
    Environment::from_texels("constant", width, height, texels).expect("a sound map")
}

pub fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    near!(found, expected, tolerance, "{what}");
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
    // A hair before the seam, inside the map.
    let [u, v] = environment_uv(vec3(-1e-30_f32, 0.0, -1.0));
    assert!(u < 1.0 && v == 0.5, "({u}, {v})");
    let mut random = Random::new(1);
    for index in 0..20_000 {
        let mut direction = random_direction(&mut random);
        if index % 4 == 0 {
            // Close to a pole, where acos would lose half the digits.
            let tilt = 1e-6 * number(&mut random);
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
fn the_map_turns_anticlockwise_seen_from_above() {
    // A quarter turn brings what the map has at +Z to +X of the world.
    let rotation = [0.0, 1.0];
    let local = environment_local_from_world(vec3(1.0, 0.25, 0.0), rotation);
    assert_eq!(local, vec3(0.0, 0.25, 1.0));
    let mut random = Random::new(2);
    for _ in 0..100 {
        let direction = random_direction(&mut random);
        let angle = TAU * number(&mut random);
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
    let (mut sum, mut middle) = ([0.0; 3], Vec3::ZERO);
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
                0.002,
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
    let mut random = Random::new(23);
    let count = 100_000;
    let sum: f64 = (0..count)
        .map(|_| {
            let (direction, density) = environment_sample::<f64>(environment.distribution(true), triple(&mut random));
            environment_radiance(environment, direction).luminance() * direction.dot(normal).max(0.0) / density
        })
        .sum();
    sum / f64::from(count) / PI
}

#[test]
fn built_in_lights_are_right_for_exposure_0() {
    let sky = sky(&SkyParams::default()).unwrap();
    let table = white_radiance(&sky, vec3(0.0, 1.0, 0.0));
    assert_near(table, 1.0, 0.01, "a white table under the sky");
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
fn the_brightest_place_is_the_middle_of_what_touches_it() {
    let brightest = |bright: &[(usize, f32)]| {
        let mut texels = vec![[0.1, 0.1, 0.1, 1.0]; 16 * 8];
        bright
            .iter()
            .for_each(|(at, light)| texels[*at] = [*light, *light, *light, 1.0]);
        Environment::from_texels("spots", 16, 8, texels)
            .unwrap()
            .brightest
            .unwrap()
    };
    // Column 5, row 3.
    let [u, v] = brightest(&[(3 * 16 + 5, 4.0)]);
    assert!(
        (u - 5.5 / 16.0).abs() < 0.0001 && (v - 3.5 / 8.0).abs() < 0.02,
        "{u} {v}"
    );
    // Two beside each other across the map's edge, and one that does not touch them.
    let [u, _] = brightest(&[(3 * 16, 4.0), (3 * 16 + 15, 4.0), (3 * 16 + 7, 3.9)]);
    assert!(!(0.0001..=1.0 - 0.0001).contains(&u), "{u}");
    // What is far less than half as bright does not count.
    let [u, _] = brightest(&[(3 * 16 + 5, 4.0), (3 * 16 + 6, 1.0)]);
    near!(u, 5.5 / 16.0, 0.0001);
    assert_eq!(constant_map(16, 8, 0.0).brightest, None);
}

#[test]
fn a_thumbnail_is_as_bright_as_the_strength_says() {
    let pixels: Vec<u8> = (0..=255).collect();
    assert_eq!(brightened(&pixels, 1.0), pixels);
    let [dark, bright] = [0.25, 4.0].map(|factor| brightened(&pixels, factor));
    let colors = (1..250).filter(|index| index % 4 != 3);
    assert!(colors.clone().all(|i| dark[i] <= pixels[i] && bright[i] >= pixels[i]));
    assert!(dark[128] < 90 && bright[128] > 190, "{} {}", dark[128], bright[128]);
    // What is opaque stays opaque.
    assert!((0..256).filter(|index| index % 4 == 3).all(|i| dark[i] == pixels[i]));
    assert!(
        brightened(&pixels, 0.0)
            .iter()
            .enumerate()
            .all(|(i, code)| i % 4 == 3 || *code == 0)
    );
}
