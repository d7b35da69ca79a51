//! Tone curves: from scene-referred to display-referred linear Rec. 709, and sRGB's encoding.
//!
//! To add a curve: a function here, a line in the list of curves, one in [`tone_map`].

mod aces2;
mod grade;
mod lut;

use crate::instructions::level;
use crate::named::named;
use crate::optics::lanes::{InLanes, in_lanes};
use crate::optics::prelude::*;

pub use aces2::tone_aces2;
pub use grade::Grade;
pub use lut::Lut;

named! {
    #[derive(Default)]
    ToneCurve {
        #[default]
        AgxPunchy = 5, "agx-punchy", "AgX Punchy", "AgX with more contrast and saturation: metals and paints keep their colour.";
        Agx = 0, "agx", "AgX", "Bright colours fade to white as on film: for any image with strong light.";
        Aces = 1, "aces", "ACES", "Strong contrast and saturation, as in films and games (Hill's fit of ACES 1.0).";
        Aces2 = 2, "aces2", "ACES 2", "The Academy's transform of 2024 for screens: softer than the first, colours keep their hue up to white.";
        PbrNeutral = 3, "pbr-neutral", "PBR Neutral", "Colours below the highlights stay exactly as they are: for product images.";
        None = 4, "none", "None", "Cut off at white: for comparing numbers.";
    }
}

/// Tone maps exposed scene-referred linear Rec. 709 to display-referred linear Rec. 709 in [0, 1]. Negative values and NaN
/// count as 0; values are clamped to [`SCENE_MAX`].
#[inline(always)]
pub fn tone_map<T: Real>(curve: ToneCurve, rgb_linear: Vec3<T>) -> Vec3<T> {
    let scene = rgb_linear.map(
        #[inline(always)]
        |x| x.clamp(T::ZERO, T::from_f64(SCENE_MAX)),
    );
    let display = match curve {
        ToneCurve::Agx => tone_agx(scene),
        ToneCurve::AgxPunchy => tone_agx_punchy(scene),
        ToneCurve::Aces => tone_aces(scene),
        ToneCurve::PbrNeutral => tone_pbr_neutral(scene),
        ToneCurve::None => tone_none(scene),
        ToneCurve::Aces2 => Vec3::from_lanes(|lane| tone_aces2(scene.lane(lane))),
    };
    display.map(
        #[inline(always)]
        |x| x.clamp(T::ZERO, T::ONE),
    )
}

/// sRGB codes in [0, 1] of exposed scene-referred colours, tone mapped in lanes.
pub fn display_codes(curve: ToneCurve, colors: &[Vec3<f32>]) -> Vec<Vec3<f32>> {
    in_lanes(level(), Codes { curve, colors })
}

struct Codes<'a> {
    curve: ToneCurve,
    colors: &'a [Vec3<f32>],
}

impl InLanes for Codes<'_> {
    type Output = Vec<Vec3<f32>>;

    fn run<T: Single>(self) -> Self::Output {
        let Self { curve, colors } = self;
        let mut codes = Vec::with_capacity(colors.len());
        vectorized!(T, {
            for group in colors.chunks(T::LANES) {
                let scene = Vec3::<T>::from_lanes(|lane| group[lane.min(group.len() - 1)]);
                let shown = srgb_from_linear(tone_map(curve, scene)).to_each();
                codes.extend((0..group.len()).map(|lane| shown[lane]));
            }
        });
        codes
    }
}

/// Largest scene-referred value: the largest half float.
pub const SCENE_MAX: f64 = 65504.0;

/// [`tone_agx`] with the look that its author calls punchy.
#[inline(always)]
pub fn tone_agx_punchy<T: Real>(scene: Vec3<T>) -> Vec3<T> {
    agx(
        scene,
        #[inline(always)]
        |encoded| {
            let powered = encoded.map(
                #[inline(always)]
                |x| x.max(T::ZERO).powf(T::from_f64(PUNCHY_POWER)),
            );
            let luminance = powered.dot(Vec3::from_f64(LUMINANCE));
            Vec3::splat(luminance).mix(powered, T::from_f64(PUNCHY_SATURATION))
        },
    )
}

/// The power of AgX's punchy look, on encoded values.
const PUNCHY_POWER: f64 = 1.35;
/// Saturation of the punchy look.
const PUNCHY_SATURATION: f64 = 1.4;
/// Luminance of Rec. 709's primaries.
pub const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// AgX (Sobotka 2022) in the form of Filament and three.js: its inset in Rec. 2020, here one matrix with the change of
/// primaries; Wrensch's polynomial fit of the sigmoid over 16.5 stops around middle grey ("Minimal AgX implementation",
/// 2023); the outset; display gamma 2.2.
#[inline(always)]
pub fn tone_agx<T: Real>(scene: Vec3<T>) -> Vec3<T> {
    agx(scene, |encoded| encoded)
}

/// [`tone_agx`] with a look: applied after the sigmoid, before the outset.
#[inline(always)]
fn agx<T: Real>(scene: Vec3<T>, look: impl Fn(Vec3<T>) -> Vec3<T>) -> Vec3<T> {
    let c = T::from_f64;
    let inset = transform(AGX_INSET_FROM_REC709, scene);
    let shaped = inset.map(
        #[inline(always)]
        |x| {
            let stops = x.max(c(1e-10)).ln() * c(std::f64::consts::LOG2_E);
            agx_contrast(((stops - c(AGX_STOPS_MIN)) / c(AGX_STOPS_MAX - AGX_STOPS_MIN)).clamp(T::ZERO, T::ONE))
        },
    );
    let encoded = transform(AGX_OUTSET, look(shaped));
    let linear = encoded.map(
        #[inline(always)]
        |x| x.max(c(1e-10)).powf(c(2.2)),
    );
    transform(REC709_FROM_REC2020, linear)
}

/// Stops below which AgX is black: ten below middle grey.
pub const AGX_STOPS_MIN: f64 = -12.47393;
/// Stops above which AgX is white: 6.5 above middle grey.
pub const AGX_STOPS_MAX: f64 = 4.026069;

/// AgX's sigmoid on [0, 1].
#[inline(always)]
fn agx_contrast<T: Real>(x: T) -> T {
    let c = T::from_f64;
    let high = c(31.96) + x * (c(-40.14) + x * c(15.5));
    c(-0.00232) + x * (c(0.1191) + x * (c(0.4298) + x * (c(-6.868) + x * high)))
}

/// Hill's fit of the ACES 1.0 reference rendering and output transforms for sRGB displays (BakingLab, 2016), without
/// the exposure of 1/0.6 that some programs put before it.
#[inline(always)]
pub fn tone_aces<T: Real>(scene: Vec3<T>) -> Vec3<T> {
    let c = T::from_f64;
    let fitted = transform(ACES_INPUT, scene).map(
        #[inline(always)]
        |x| {
            let a = x * (x + c(0.0245786)) - c(0.000090537);
            let b = x * (c(0.983729) * x + c(0.432951)) + c(0.238081);
            a / b
        },
    );
    transform(ACES_OUTPUT, fitted)
}

/// The Khronos PBR Neutral tone mapper (Khronos 3D Commerce, 2024), as specified.
#[inline(always)]
pub fn tone_pbr_neutral<T: Real>(scene: Vec3<T>) -> Vec3<T> {
    let c = T::from_f64;
    let darkest = scene.x.min(scene.y).min(scene.z);
    // Subtracts the reflectance of 0.04 that every dielectric adds to its base colour.
    let offset = T::select(darkest.less(c(0.08)), darkest - c(6.25) * darkest * darkest, c(0.04));
    let color = scene - Vec3::splat(offset);
    let peak = color.max_component();
    let room = c(1.0 - NEUTRAL_START);
    let compressed_peak = T::ONE - room * room / (peak + room - c(NEUTRAL_START)).max(room);
    let whiteness = T::ONE - T::ONE / (c(0.15) * (peak - compressed_peak) + T::ONE);
    let compressed = color * (compressed_peak / peak.max(c(NEUTRAL_START)));
    let faded = compressed.mix(Vec3::splat(compressed_peak), whiteness);
    Vec3::select(peak.less(c(NEUTRAL_START)), color, faded)
}

/// Peak above which PBR Neutral compresses.
pub const NEUTRAL_START: f64 = 0.8 - 0.04;

/// Linear, clamped by [`tone_map`].
#[inline(always)]
pub fn tone_none<T: Real>(scene: Vec3<T>) -> Vec3<T> {
    scene
}

/// sRGB-encoded from linear, both in [0, 1] (IEC 61966-2-1).
#[inline(always)]
pub fn srgb_from_linear<T: Real>(linear: Vec3<T>) -> Vec3<T> {
    let c = T::from_f64;
    linear.map(
        #[inline(always)]
        |x| {
            let bright = c(1.055) * x.max(c(0.0031308)).powf(c(1.0 / 2.4)) - c(0.055);
            T::select(c(0.0031308).less(x), bright, c(12.92) * x)
        },
    )
}

/// Linear from sRGB-encoded, both in [0, 1] (IEC 61966-2-1).
pub fn linear_from_srgb<T: Scalar>(srgb: Vec3<T>) -> Vec3<T> {
    let c = T::from_f64;
    srgb.map(|x| {
        let bright = ((x.max(c(0.04045)) + c(0.055)) / c(1.055)).powf(c(2.4));
        T::select(c(0.04045).less(x), bright, x / c(12.92))
    })
}

/// Rows of a matrix applied to a colour.
#[inline(always)]
fn transform<T: Real>(rows: [[f64; 3]; 3], color: Vec3<T>) -> Vec3<T> {
    let [x, y, z] = mapped!([rows[0], rows[1], rows[2]], |row| Vec3::from_f64(row).dot(color));
    vec3(x, y, z)
}

/// AgX's inset after the change from Rec. 709's to Rec. 2020's primaries.
const AGX_INSET_FROM_REC709: [[f64; 3]; 3] = [
    [0.544814746, 0.373787398, 0.081397855],
    [0.140416948, 0.754137555, 0.105445497],
    [0.088810420, 0.178871756, 0.732317824],
];
const AGX_OUTSET: [[f64; 3]; 3] = [
    [1.127100582, -0.110606643, -0.016493939],
    [-0.141329763, 1.157823702, -0.016493939],
    [-0.141329763, -0.110606643, 1.251936407],
];
/// From Rec. 2020's to Rec. 709's primaries (ITU-R BT.2407).
const REC709_FROM_REC2020: [[f64; 3]; 3] = [
    [1.660491002, -0.587641139, -0.072849863],
    [-0.124550475, 1.132899897, -0.008349423],
    [-0.018150763, -0.100578898, 1.118729661],
];
/// Rec. 709 to ACES AP1 with the reference rendering's saturation.
const ACES_INPUT: [[f64; 3]; 3] = [
    [0.59719, 0.35458, 0.04823],
    [0.07600, 0.90834, 0.01566],
    [0.02840, 0.13383, 0.83777],
];
/// The output transform's saturation, then AP1 to Rec. 709.
const ACES_OUTPUT: [[f64; 3]; 3] = [
    [1.60475, -0.53108, -0.07367],
    [-0.10208, 1.10813, -0.00605],
    [-0.00327, -0.07276, 1.07602],
];
