//! What metals and paints look like at first sight: the shipped light and the default tone curve.

use crate::renders::adjust;
use std::time::Duration;

use glossmith::{
    document::{Background, Document, ViewSettings},
    optics::{
        primaries::{REC709, transformed},
        tone::{ToneCurve, linear_from_srgb},
        vector::Vec3,
    },
    render::{EngineChoice, Session, display::display},
    scene::{
        ModelSource,
        environment::{EnvironmentSource, texel_direction},
    },
    store::material_by_name,
};

const SIDE: u32 = 48;

/// Lightness, chroma and hue in degrees in CIELAB.
type Look = [f64; 3];

fn look_of([r, g, b]: [f64; 3]) -> Look {
    let xyz_from_rgb = REC709.xyz_from_rgb().expect("a space");
    let white = transformed(&xyz_from_rgb, [1.0; 3]);
    let f = |t: f64| {
        if t > (6.0 / 29.0_f64).powi(3) {
            t.cbrt()
        } else {
            t * (29.0 / 6.0_f64).powi(2) / 3.0 + 4.0 / 29.0
        }
    };
    let xyz = transformed(&xyz_from_rgb, [r, g, b]);
    let [x, y, z] = [0, 1, 2].map(|i| f(xyz[i] / white[i]));
    let (a, b) = (500.0 * (x - y), 200.0 * (y - z));
    [116.0 * y - 16.0, a.hypot(b), b.atan2(a).to_degrees()]
}

/// The codes of the displayed picture of a ball.
fn codes(name: &str, environment: EnvironmentSource, tone_map: ToneCurve, background: Background) -> Vec<u8> {
    let mut document = Document {
        model: ModelSource::Sphere,
        materials: vec![material_by_name(name).expect("shipped").clone()],
        ground: background == Background::Environment,
        view: ViewSettings {
            tone_map,
            ..ViewSettings::default()
        },
        ..Document::default()
    };
    (document.lighting.environment, document.lighting.background) = (environment, background);
    adjust(
        &mut document,
        &format!("render.width={SIDE} render.height={SIDE} render.samples=64"),
    );
    let mut session = Session::open(EngineChoice::Cpu).expect("always");
    session.submit(&document).expect("a sphere");
    while !session.step(Duration::from_secs(1)).expect("it renders").is_done {}
    display(&session.image().expect("it is done"), &document.view)
}

/// The mean of the displayed picture of a ball, as light from a screen, over the ball.
fn ball(name: &str, environment: EnvironmentSource, tone_map: ToneCurve) -> Look {
    let codes = codes(name, environment, tone_map, Background::Environment);
    let middle = SIDE as usize / 3..2 * SIDE as usize / 3;
    let pixels = middle
        .clone()
        .flat_map(|y| middle.clone().map(move |x| 4 * (y * SIDE as usize + x)));
    let colors: Vec<Vec3<f64>> = pixels
        .map(|at| linear_from_srgb(Vec3::from_f64([0, 1, 2].map(|i| f64::from(codes[at + i]) / 255.0))))
        .collect();
    let sum = colors.iter().fold(Vec3::splat(0.0), |sum, color| sum + *color);
    look_of((sum / colors.len() as f64).to_f64())
}

/// Hue in degrees and saturation of the mean code, as painting programs count them: metals are warm in the light of the start.
#[test]
fn gold_and_copper_have_their_hue_and_saturation() {
    for (name, hues, least) in [("gold", 40.0..=50.0, 0.45), ("copper", 12.0..=25.0, 0.35)] {
        let light = EnvironmentSource::default();
        let codes = codes(name, light, ToneCurve::default(), Background::Transparent);
        let opaque = codes.as_chunks::<4>().0.iter().filter(|code| code[3] > 250);
        let sum = |channel: usize| opaque.clone().map(|code| f64::from(code[channel])).sum::<f64>();
        let [red, green, blue] = [0, 1, 2].map(sum);
        let (hue, saturation) = (60.0 * (green - blue) / (red - blue), 1.0 - blue / red);
        assert!(
            hues.contains(&hue) && saturation >= least,
            "{name}: {hue:.1}°, {saturation:.3}"
        );
    }
}

/// What lies level gets neutral light, and white materials are as light as they are white.
#[test]
fn white_is_white_in_the_light_of_the_start() {
    let light = EnvironmentSource::default().computed().expect("built in");
    let mut irradiance = Vec3::splat(0.0);
    for row in 0..light.height / 2 {
        for column in 0..light.width {
            let height = texel_direction([column, row], [light.width, light.height]).y;
            let [r, g, b, _] = light.texels[(row * light.width + column) as usize];
            irradiance += Vec3::from_f32([r, g, b]) * (height * (1.0 - height * height).sqrt());
        }
    }
    let mean = (irradiance.x + irradiance.y + irradiance.z) / 3.0;
    for (channel, of_mean) in (irradiance / mean).to_f64().into_iter().enumerate() {
        near!(of_mean, 1.0, 0.02, "channel {channel}");
    }
    for name in ["plastic-white", "porcelain"] {
        let [lightness, chroma, _] = ball(name, EnvironmentSource::default(), ToneCurve::default());
        assert!(
            lightness > 70.0 && chroma < 5.0,
            "{name}: lightness {lightness:.1}, chroma {chroma:.1}"
        );
    }
}

/// The range of hues, in degrees, and the least chroma; without a hue what is to be grey, with the most chroma.
const LOOKS: [(&str, Option<[f64; 2]>, f64); 6] = [
    ("gold", Some([72.0, 98.0]), 25.0),
    ("copper", Some([20.0, 65.0]), 12.0),
    ("car-paint-red", Some([15.0, 45.0]), 40.0),
    ("chrome", None, 9.0),
    ("porcelain", None, 5.0),
    ("rubber", None, 9.0),
];

/// The table of docs/PERFORMANCE.md is what this prints; before is the dark studio under AgX.
#[test]
fn gold_copper_and_red_look_like_themselves() {
    println!("| material | before: lightness, chroma, hue | now |");
    for (name, hues, chroma) in LOOKS {
        let before = ball(name, EnvironmentSource::Studio, ToneCurve::Agx);
        let now = ball(name, EnvironmentSource::default(), ToneCurve::default());
        println!("| {name} | {before:.0?} | {now:.0?} |");
        match hues {
            Some([from, to]) => {
                assert!((from..=to).contains(&now[2]), "{name}: hue {:.0}°", now[2]);
                assert!(now[1] >= chroma, "{name}: chroma {:.0}", now[1]);
                assert!(
                    now[1] > before[1],
                    "{name}: chroma {:.0} after {:.0}",
                    now[1],
                    before[1]
                );
            }
            None => assert!(now[1] <= chroma, "{name}: chroma {:.0}", now[1]),
        }
    }
}
