//! A clear sky: the radiance model of Hosek and Wilkie (2012) with a sun of true size and energy, over dry ground.

use std::f64::consts::PI;

use hw_skymodel::rgb::{Channel, SkyParams as ModelParams, SkyState};
use serde::{Deserialize, Serialize};

use super::super::{Environment, MapError, distribution::texel_solid_angle, environment_direction, texel_direction};
use super::texels_of;
use crate::{
    named::with_defaults,
    optics::vector::{Vec3, vec3},
};

const WIDTH: u32 = 2048;
const HEIGHT: u32 = 1024;
/// The diameter of the sun's disc.
const SUN_DIAMETER_DEG: f64 = 0.53;
/// The optical thickness of the haze between the eye and the ground straight below. The thickness along a flatter ray is
/// this over the sine of its angle, so that the ground fades into the horizon over some degrees.
const HAZE_THICKNESS: f64 = 0.035;
/// Looks per texel side when the share of it that the sun covers is counted.
const SUN_TAPS: u32 = 32;
/// The sun's illuminance outside the atmosphere in the sky model's unit, 683 lx: 133 800 lx.
const SUN_OUTSIDE: f64 = 133_800.0 / 683.0;
/// The sun's colour outside the atmosphere, linear Rec. 709 at luminance 1: a black body of 5778 K.
const SUN_COLOR: [f64; 3] = [1.113, 0.975, 0.914];
/// Wavelengths of red, green and blue for the attenuation of the sun, in µm.
const WAVELENGTHS_UM: [f64; 3] = [0.612, 0.549, 0.464];
/// Optical thickness of 0.35 cm of ozone at these wavelengths.
const OZONE: [f64; 3] = [0.043, 0.030, 0.003];
/// Scale from the model's unit: sun and sky of the default parameters give level ground an irradiance of π, so that a white
/// diffuse table has luminance 1.
const EXPOSURE: f64 = 0.0315;

with_defaults! {
    /// A clear sky's parameters: late morning, the sun in front (+Z) and to the left (−X).
    #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
    pub struct SkyParams {
        /// Height of the sun above the horizon in degrees, in [0, 90].
        pub sun_elevation_deg: f64 = 40.0,
        /// Azimuth of the sun in degrees, from −Z (u = 0) towards +X (90) and +Z (180).
        pub sun_azimuth_deg: f64 = 222.0,
        /// Haze: 2 very clear, 3 clear, 6 hazy; in [1, 10].
        pub turbidity: f64 = 3.0,
        /// Albedo of the ground, linear Rec. 709, in [0, 1].
        pub ground_albedo: [f64; 3] = [0.23, 0.205, 0.175],
    }
}

/// The unit direction to the centre of the sun, in the map's frame.
pub fn sun_direction(params: &SkyParams) -> Vec3<f64> {
    environment_direction([params.sun_azimuth_deg / 360.0, 0.5 - params.sun_elevation_deg / 180.0])
}

/// Irradiance of the sun alone on a surface facing it: its radiance integrated over its solid angle, in the units of the
/// map. Attenuation by Rayleigh scattering, aerosol and ozone after Preetham, Shirley and Smits (1999), appendix.
pub fn sun_irradiance(params: &SkyParams) -> [f64; 3] {
    let zenith_deg = 90.0 - params.sun_elevation_deg;
    let air_mass = 1.0 / (zenith_deg.to_radians().cos() + 0.15 * (93.885 - zenith_deg).powf(-1.253));
    let aerosol = (0.046_08 * params.turbidity - 0.045_86).max(0.0);
    [0, 1, 2].map(|channel| {
        let wavelength_um = WAVELENGTHS_UM[channel];
        let thickness = 0.008_735 * wavelength_um.powf(-4.08) + aerosol * wavelength_um.powf(-1.3) + OZONE[channel];
        EXPOSURE * SUN_OUTSIDE * SUN_COLOR[channel] * (-thickness * air_mass).exp()
    })
}

/// The sky's map, 2048 × 1024.
///
/// # Errors
/// [`MapError::SkyParameter`] if a parameter is out of its range.
pub fn sky(params: &SkyParams) -> Result<Environment, MapError> {
    let model = Model::new(params)?;
    let ground = model.ground_radiance(params);
    let mut texels = texels_of(WIDTH, HEIGHT, |direction| {
        model.radiance_with_ground(direction, ground).map(|value| value as f32)
    });
    add_sun(params, &mut texels);
    Environment::from_texels("sky", WIDTH, HEIGHT, texels)
}

/// The sky without sun and ground.
struct Model {
    state: SkyState,
    sun_direction: Vec3<f64>,
}

impl Model {
    fn new(params: &SkyParams) -> Result<Self, MapError> {
        let model_params = ModelParams {
            elevation: params.sun_elevation_deg.to_radians() as f32,
            turbidity: params.turbidity as f32,
            albedo: params.ground_albedo.map(|albedo| albedo as f32),
        };
        let state = SkyState::new(&model_params).map_err(|error| {
            MapError::SkyParameter(format!("this sky cannot be computed: {error}; keep it in that range"))
        })?;
        if !params.sun_azimuth_deg.is_finite() {
            let message = "this sky cannot be computed: the sun's azimuth is not a number; give it in degrees";
            return Err(MapError::SkyParameter(message.to_owned()));
        }
        Ok(Self {
            state,
            sun_direction: sun_direction(params),
        })
    }

    /// Radiance of the sky in a direction; below the horizon that of the horizon.
    fn radiance(&self, direction: Vec3<f64>) -> [f64; 3] {
        let zenith_rad = direction.y.clamp(0.0, 1.0).acos() as f32;
        let from_sun_rad = direction.dot(self.sun_direction).clamp(-1.0, 1.0).acos() as f32;
        [Channel::R, Channel::G, Channel::B]
            .map(|channel| EXPOSURE * f64::from(self.state.radiance(zenith_rad, from_sun_rad, channel)).max(0.0))
    }

    /// Radiance of ground that scatters the light of sun and sky evenly.
    fn ground_radiance(&self, params: &SkyParams) -> [f64; 3] {
        let sun = sun_irradiance(params);
        let sky = self.sky_irradiance();
        [0, 1, 2].map(|channel| {
            params.ground_albedo[channel] * (sky[channel] + sun[channel] * self.sun_direction.y.max(0.0)) / PI
        })
    }

    /// Irradiance of the sky without the sun on level ground, by the midpoint rule over cos² and azimuth.
    fn sky_irradiance(&self) -> [f64; 3] {
        const ROWS: u32 = 128;
        const COLUMNS: u32 = 256;
        let mut sum = [0.0; 3];
        for place in 0..ROWS * COLUMNS {
            let cos = ((f64::from(place / COLUMNS) + 0.5) / f64::from(ROWS)).sqrt();
            let azimuth_rad = (f64::from(place % COLUMNS) + 0.5) / f64::from(COLUMNS) * 2.0 * PI;
            let sin = (1.0 - cos * cos).sqrt();
            let radiance = self.radiance(vec3(sin * azimuth_rad.cos(), cos, sin * azimuth_rad.sin()));
            sum = [0, 1, 2].map(|channel| sum[channel] + radiance[channel]);
        }
        sum.map(|sum| sum * PI / f64::from(ROWS * COLUMNS))
    }

    /// The sky above the horizon, the ground through the haze below.
    fn radiance_with_ground(&self, direction: Vec3<f64>, ground: [f64; 3]) -> [f64; 3] {
        let above = self.radiance(direction);
        let share = if direction.y < 0.0 {
            (HAZE_THICKNESS / direction.y).exp()
        } else {
            0.0
        };
        [0, 1, 2].map(|channel| above[channel] * (1.0 - share) + ground[channel] * share)
    }
}

/// Adds the sun's disc, each texel by its covered area, such that the bilinear map has exactly the sun's irradiance.
fn add_sun(params: &SkyParams, texels: &mut [[f32; 4]]) {
    let coverage = sun_coverage(sun_direction(params));
    let covered: f64 = coverage
        .iter()
        .map(|&(index, share)| share * texel_solid_angle(index as u32 / WIDTH, WIDTH, HEIGHT))
        .sum();
    let radiance = sun_irradiance(params).map(|irradiance| irradiance / covered);
    for &(index, share) in &coverage {
        for (value, radiance) in texels[index].iter_mut().zip(radiance) {
            *value += (share * radiance) as f32;
        }
    }
}

/// The texels that the disc touches, with the share of each that it covers.
fn sun_coverage(sun_direction: Vec3<f64>) -> Vec<(usize, f64)> {
    let radius_rad = (0.5 * SUN_DIAMETER_DEG).to_radians();
    let is_inside =
        |uv: [f64; 2]| (environment_direction(uv) - sun_direction).length() < 2.0 * (0.5 * radius_rad).sin();
    let top_rad = sun_direction.y.clamp(-1.0, 1.0).acos() - radius_rad;
    let rows_per_rad = f64::from(HEIGHT) / PI;
    let first = (top_rad * rows_per_rad).floor().max(0.0) as u32;
    let last = (((top_rad + 2.0 * radius_rad) * rows_per_rad).floor() as u32).min(HEIGHT - 1);
    let taps = f64::from(SUN_TAPS);
    let mut coverage = Vec::new();
    for row in first..=last {
        for column in 0..WIDTH {
            let centre = texel_direction([column, row], [WIDTH, HEIGHT]);
            if (centre - sun_direction).length() > radius_rad + 2.0 * PI / f64::from(HEIGHT) {
                continue;
            }
            let count = (0..SUN_TAPS * SUN_TAPS)
                .filter(|tap| {
                    let u = f64::from(column) + (f64::from(tap % SUN_TAPS) + 0.5) / taps;
                    let v = f64::from(row) + (f64::from(tap / SUN_TAPS) + 0.5) / taps;
                    is_inside([u / f64::from(WIDTH), v / f64::from(HEIGHT)])
                })
                .count();
            if count > 0 {
                coverage.push(((row * WIDTH + column) as usize, count as f64 / (taps * taps)));
            }
        }
    }
    coverage
}
