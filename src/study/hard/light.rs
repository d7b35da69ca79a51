//! Hard cases of light: a sun beside a dark sky, black, a single pixel, poles and seam, invalid radiance.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use serde_json::json;

use super::{Stage, StudyError, glb::Glb, stage::mean_luminance, stage::worst_pixel};
use crate::{
    document::{AreaLight, Background, Document, MaterialSettings},
    job::Settings,
    optics::random::{path_state, random_pair},
    optics::vector::Vec3,
    scene::{
        Geometry, ModelSource,
        camera::{LENS_DIMENSION, PIXEL_DIMENSION, pixel_ray},
        environment::{Environment, EnvironmentSource, environment_direction, environment_radiance},
        shapes,
    },
    study::small_document,
};

cases! {
    "light"
    "sun-in-one-pixel"
        "a sun of 1e6 in one pixel beside a sky of 1e-2: found once in 10 000 samples, a speck 1e4 times too bright"
        "a white plane under a map of 64 × 32 with one such pixel, 45° up"
        "the mean radiance is the integral in f64: difference in standard deviations, and 1e-4 for roundings"
        "noise of 3 times the mean at 64 samples",
        "sigma" 4.0, |stage| {
            let sky = |x, y| if (x, y) == (40, 8) { [1e6; 3] } else { [0.01; 3] };
            let light = stage.environment("sun.exr", [64, 32], sky)?;
            let expected = irradiance(&stage.load_environment(&light)?) / PI;
            let film = stage.film(&plane_from_above(light, 64))?;
            let variance = film.variance_of_mean().iter().sum::<f64>() / (film.pixel_count() as f64).powi(2);
            Ok((mean_luminance(&film) - expected).abs() / (variance + (0.0001 * expected).powi(2)).sqrt() + film.dropped() as f64)
        };
    "black-environment"
        "a density of 0/0: NaN for every sample of the light"
        "a sphere under a map of zeros"
        "black, nothing dropped: largest pixel and samples dropped"
        "nan",
        "error" 0.0, |stage| {
            let light = stage.environment("black.exr", [16, 8], |_, _| [0.0; 3])?;
            let film = stage.film(&small_document(ModelSource::Sphere, light, 16, 4))?;
            let largest = film.colors().map(|c| c[0].abs().max(c[1].abs()).max(c[2].abs()));
            Ok(largest.fold(0.0, f64::max) + film.dropped() as f64)
        };
    "one-pixel-environment"
        "neighbours of the only texel lie outside: the look-up reads beyond the map"
        "a white furnace of 1 × 1 texels, coloured; a sphere that reflects all"
        "that colour everywhere: worst relative error of a pixel"
        "reads texel −1",
        "error" 1e-4, |stage| colored_furnace(stage, [1, 1], [0.5, 0.25, 0.125]);
    "poles-and-seam"
        "at the poles the azimuth is atan2(0, 0), at the seam −1e-9 turns round to a whole one: beyond the map"
        "a map of 64 × 32 random texels seen straight up, straight down and along the seam"
        "each pixel is the look-up in f64 in the same direction: worst relative error"
        "column 64 of 64",
        "error" 1e-3, |stage| {
            let noise = |x: u32, y: u32| {
                let bits = crate::optics::random::hash_bits(x + 64 * y);
                [0, 10, 20].map(|shift| 0.1 + ((bits >> shift) & 0x3ff) as f32 / 1023.0)
            };
            let light = stage.environment("noise.exr", [64, 32], noise)?;
            let environment = stage.load_environment(&light)?;
            let views = [
                ([0.0, 3.0, 0.0], [0.0, 4.0, 0.0]),
                ([0.0, -3.0, 0.0], [0.0, -4.0, 0.0]),
                ([0.0, 3.0, 0.0], [0.0, 3.0, -1.0]),
            ];
            let mut worst = 0.0_f64;
            for (position, target) in views {
                let mut document = small_document(ModelSource::Plane, light.clone(), 33, 1);
                (document.camera.position, document.camera.target) = (Some(position), Some(target));
                worst = worst.max(background_error(stage, &document, &environment)?);
            }
            Ok(worst)
        };
    "no-radiance-in-a-file"
        "NaN, infinity or a negative number in a file spreads over everything that it lights"
        "an .exr with 3 values that are NaN, 2 infinite and 4 negative; a sphere under it"
        "each is replaced and reported, the image is clean: what is not reported or dropped is counted"
        "a mean of nan",
        "count" 0.0, |stage| {
            let odd = |x: u32, y: u32| match (x, y) {
                (0..3, 0) => [f32::NAN, 1.0, 1.0],
                (3..5, 3) => [1.0, f32::INFINITY, 1.0],
                (5..9, 5) => [1.0, 1.0, -2.0],
                _ => [1.0; 3],
            };
            let light = stage.environment("odd.exr", [16, 8], odd)?;
            let warnings = stage.load_environment(&light)?.warnings;
            let expected = ["3 not-a-number", "2 infinite", "4 negative"];
            let missing = expected
                .iter()
                .filter(|words| !warnings.iter().any(|line| line.contains(*words)));
            let film = stage.film(&small_document(ModelSource::Sphere, light, 16, 8))?;
            let unsound = film.colors().flatten().filter(|x| !(x.is_finite() && *x >= 0.0));
            Ok((missing.count() + unsound.count()) as f64 + film.dropped() as f64)
        };
    "radiance-above-half"
        "half floats end at 65 504: brighter light is infinite, and infinity times 0 is NaN"
        "a map of 1e6 everywhere, seen itself and in a sphere that reflects all"
        "1e6 everywhere: worst relative error of a pixel"
        "inf as a half float",
        "error" 1e-4, |stage| colored_furnace(stage, [16, 8], [1e6; 3]);
    "shadow-terminator"
        "the triangles of a coarse smooth ball cut off light that still shines on the ball: black triangles"
        "a ball of 6 × 12 segments with smooth normals under a sun from the side"
        "no place is darker than half of what its normal implies, but for the last tenth: pixels that are"
        "below the horizon of the triangle there is no light",
        "count" 0.0, |stage| {
            let ball = Glb::of(&shapes::sphere(12, 6), json!({})).write(stage, "ball.glb")?;
            let mut document = small_document(ball, EnvironmentSource::Furnace, 64, 64);
            document.lighting.strength = 0.0;
            document.materials = vec![MaterialSettings::diffuse("ball", [0.8; 3])];
            let sun = AreaLight {
                yaw_deg: 60.0,
                pitch_deg: 20.0,
                strength: 3.0,
                ..AreaLight::sun()
            };
            document.lighting.area_lights = vec![sun];
            let film = stage.film(&document)?;
            let Some(job) = stage.session.job() else {
                return Ok(f64::INFINITY);
            };
            let ((side, front), (up, level)) = (60_f64.to_radians().sin_cos(), 20_f64.to_radians().sin_cos());
            let to_sun = DVec3::new(side * level, up, front * level);
            let dark = (0..film.pixel_count()).filter(|pixel| {
                let cosine = least_cosine(&job.geometry, &job.settings, *pixel as u32, to_sun);
                cosine.is_some_and(|cosine| film.luminance()[*pixel] < 0.5 * 0.8 * 3.0 / PI * cosine)
            });
            Ok(dark.count() as f64 + film.dropped() as f64)
        };
}

/// Smallest cosine between a direction and the smooth normals within a pixel, if above a tenth and the pixel shows only the
/// model.
fn least_cosine(geometry: &Geometry, settings: &Settings, pixel: u32, direction: DVec3) -> Option<f64> {
    let camera = settings.camera.cast::<f32>();
    let [width, height] = settings.image_size;
    let places = [0.02, 0.5, 0.98];
    let cosines = places.into_iter().flat_map(|x| places.map(|y| [x, y])).map(|[x, y]| {
        let across = 2.0 * ((pixel % width) as f32 + x) / width as f32 - 1.0;
        let down = 2.0 * ((pixel / width) as f32 + y) / height as f32 - 1.0;
        let ray = camera.forward + camera.right * across - camera.up * down;
        let hit = geometry.intersect(camera.origin.to_f32(), ray.to_f32(), f32::INFINITY)?;
        let [a, b, c] = geometry
            .vertices(hit.triangle as usize)
            .map(|vertex| DVec3::from_array(vertex.normal.map(f64::from)));
        let (u, v) = (f64::from(hit.u), f64::from(hit.v));
        Some((a * (1.0 - u - v) + b * u + c * v).normalize_or_zero().dot(direction))
    });
    let least = cosines.reduce(|least, cosine| Some(least?.min(cosine?)))??;
    (least > 0.1).then_some(least)
}

/// The worst pixel of a sphere that reflects all of a map of one colour.
fn colored_furnace(stage: &mut Stage, texels: [u32; 2], color: [f32; 3]) -> Result<f64, StudyError> {
    // Files of one name would be one file to the cache.
    let light = stage.environment(&format!("furnace-{}.exr", texels[0]), texels, |_, _| color)?;
    let mut document = small_document(ModelSource::Sphere, light, 16, 4);
    document.materials[0].fresnel = crate::optics::fresnel::Fresnel::None;
    Ok(worst_pixel(&stage.film(&document)?, color))
}

/// A white Lambertian plane that fills the image.
fn plane_from_above(light: EnvironmentSource, samples: u32) -> Document {
    let mut document = small_document(ModelSource::Plane, light, 16, samples);
    document.materials = vec![MaterialSettings::diffuse("white", [1.0; 3])];
    (document.camera.pitch_deg, document.camera.distance) = (90.0, Some(1.5));
    document
}

/// ∫ radiance × cosine to +Y over the upper hemisphere, luminance, by midpoints of the bilinear map.
fn irradiance(environment: &Environment) -> f64 {
    const FINER: u32 = 16;
    let (columns, rows) = (environment.width * FINER, environment.height * FINER / 2);
    let mut sum = 0.0;
    for row in 0..rows {
        let v = (f64::from(row) + 0.5) / f64::from(2 * rows);
        let weight = (PI * v).sin() * (PI * v).cos() * TAU / f64::from(columns) * PI / f64::from(2 * rows);
        for column in 0..columns {
            let u = (f64::from(column) + 0.5) / f64::from(columns);
            let radiance: Vec3<f64> = environment_radiance(environment, environment_direction([u, v]));
            sum += weight * radiance.luminance();
        }
    }
    sum
}

/// Largest relative error of an image of the environment alone, against the f64 look-up along the same rays.
fn background_error(stage: &mut Stage, document: &Document, environment: &Environment) -> Result<f64, StudyError> {
    let document = Document {
        lighting: crate::document::Lighting {
            background: Background::Environment,
            ..document.lighting.clone()
        },
        ..document.clone()
    };
    let film = stage.film(&document)?;
    let Some(settings) = stage.session.job().map(|job| job.settings.clone()) else {
        return Ok(f64::INFINITY);
    };
    let mut worst = 0.0_f64;
    for (i, pixel) in film.image().pixels.iter().enumerate() {
        let (x, y) = (i as u32 % film.width, i as u32 / film.width);
        let state = path_state(x, y, settings.seed, 0, settings.sequence);
        let numbers = [PIXEL_DIMENSION, LENS_DIMENSION].map(|dimension| random_pair(state, dimension));
        let [_, direction] = pixel_ray(&settings.camera, [x, y].map(f64::from), settings.image_size, numbers);
        let expected = environment_radiance(environment, direction).to_f64();
        for (found, expected) in pixel.iter().zip(expected) {
            worst = worst.max((f64::from(*found) / expected - 1.0).abs());
        }
    }
    Ok(worst + film.dropped() as f64)
}
