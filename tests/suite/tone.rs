//! Tone curves and sRGB's encoding.

use glossmith::{
    document::ViewSettings,
    job::film::Image,
    optics::tone::{ToneCurve, linear_from_srgb, srgb_from_linear, tone_map},
    optics::vector::{Vec3, vec3},
    render::display::display,
};

fn mapped(curve: ToneCurve, rgb: [f64; 3]) -> [f64; 3] {
    tone_map(curve, Vec3::<f64>::from_f64(rgb)).to_f64()
}

fn assert_near(actual: [f64; 3], expected: [f64; 3], tolerance: f64) {
    let is_near = actual.iter().zip(expected).all(|(a, e)| (a - e).abs() <= tolerance);
    assert!(is_near, "{actual:?} instead of {expected:?}");
}

/// Greys and colours over 38 stops.
fn scene_colors() -> impl Iterator<Item = [f64; 3]> {
    (-20..=18).flat_map(|stop| {
        let hues = [
            [1.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.5, 0.1],
            [0.2, 0.9, 1.0],
        ];
        hues.map(|hue| hue.map(|x| x * f64::from(stop).exp2()))
    })
}

#[test]
fn every_curve_stays_in_range_in_both_precisions() {
    for &curve in ToneCurve::ALL {
        for color in scene_colors() {
            let display = mapped(curve, color);
            assert!(
                display.iter().all(|x| (0.0..=1.0).contains(x)),
                "{curve:?} {color:?} {display:?}"
            );
            let single = tone_map(curve, Vec3::<f32>::from_f64(color)).to_f64();
            assert_near(single, display, 1e-5);
        }
    }
}

#[test]
fn every_curve_keeps_grey_grey_and_in_order() {
    for &curve in ToneCurve::ALL {
        let mut before = 0.0;
        for step in 0..=3000 {
            let grey = (-12.0 + f64::from(step) * 0.009).exp2();
            let [r, g, b] = mapped(curve, [grey; 3]);
            // The rows of ACES's published matrices add to 1 within 1e-5 and 0.0002.
            assert!(
                (r - g).abs() < 0.0003 && (b - g).abs() < 0.0003,
                "{curve:?} {grey} {r} {g} {b}"
            );
            assert!(g >= before, "{curve:?} at {grey}: {g} after {before}");
            before = g;
        }
        assert!(before > 0.99, "{curve:?} ends white, not at {before}");
        assert_near(mapped(curve, [0.0; 3]), [0.0; 3], 1e-9);
    }
}

#[test]
fn what_is_no_colour_becomes_one() {
    for &curve in ToneCurve::ALL {
        for odd in [f32::NAN, f32::INFINITY, -1.0, f32::MIN, f32::MAX] {
            let display = tone_map(curve, vec3(odd, 0.5, 0.5)).to_f32();
            assert!(
                display.iter().all(|x| (0.0..=1.0).contains(x)),
                "{curve:?} {odd} {display:?}"
            );
        }
    }
}

#[test]
fn none_cuts_off() {
    assert_eq!(mapped(ToneCurve::None, [0.25, 1.5, -3.0]), [0.25, 1.0, 0.0]);
}

#[test]
fn pbr_neutral_is_what_khronos_specifies() {
    let neutral = |rgb| mapped(ToneCurve::PbrNeutral, rgb);
    // Below 0.76 only the reflectance of 0.04 is taken off, near black along the parabola 6.25 x².
    assert_near(neutral([0.5, 0.4, 0.3]), [0.46, 0.36, 0.26], 1e-12);
    assert_near(neutral([0.04; 3]), [0.01; 3], 1e-12);
    assert_near(neutral([0.8 - 1e-9; 3]), [0.76; 3], 1e-8);
    // A grey of 1.04: peak 1 goes to 1 − 0.24²/(1 + 0.24 − 0.76) = 0.88.
    assert_near(neutral([1.04; 3]), [0.88; 3], 1e-12);
    // A red of 5, no offset: peak to 1 − 0.0576/4.48, faded by 1 − 1/(0.15 (5 − peak) + 1).
    let peak = 1.0 - 0.0576 / 4.48;
    let faded = 1.0 - 1.0 / (0.15 * (5.0 - peak) + 1.0);
    assert_near(neutral([5.0, 0.0, 0.0]), [peak, peak * faded, peak * faded], 1e-12);
}

#[test]
fn agx_and_aces_have_their_published_values() {
    // Hill's fit, which greys pass without the matrices.
    let fit = |x: f64| (x * (x + 0.0245786) - 0.000090537) / (x * (0.983729 * x + 0.432951) + 0.238081);
    for grey in [0.18, 1.0] {
        assert_near(mapped(ToneCurve::Aces, [grey; 3]), [fit(grey); 3], 0.001);
    }
    // AgX: grey passes the matrices; middle grey lies 10 of 16.5 stops up, white at the end.
    let x = (0.18_f64.log2() + 12.47393) / (4.026069 + 12.47393);
    let powers = [-0.00232, 0.1191, 0.4298, -6.868, 31.96, -40.14, 15.5];
    let sigmoid: f64 = powers
        .iter()
        .enumerate()
        .map(|(power, factor)| factor * x.powi(power as i32))
        .sum();
    assert_near(mapped(ToneCurve::Agx, [0.18; 3]), [sigmoid.powf(2.2); 3], 1e-6);
    // The punchy look's saturation does nothing to grey.
    assert_near(
        mapped(ToneCurve::AgxPunchy, [0.18; 3]),
        [sigmoid.powf(1.35 * 2.2); 3],
        1e-6,
    );
    let [plain, punchy] = [ToneCurve::Agx, ToneCurve::AgxPunchy].map(|curve| mapped(curve, [0.5, 0.3, 0.1]));
    assert!(
        punchy[0] - punchy[2] > plain[0] - plain[2],
        "{punchy:?} after {plain:?}"
    );
    assert_near(
        mapped(ToneCurve::Agx, [0.18 * 6.5_f64.exp2(); 3]),
        [0.99858_f64.powf(2.2); 3],
        0.0001,
    );
    // Bright pure colours fade towards white.
    let [r, g, b] = mapped(ToneCurve::Agx, [100.0, 0.0, 0.0]);
    assert!(r > 0.9 && g > 0.3 && b > 0.3, "{r} {g} {b}");
}

#[test]
fn srgb_is_the_standards() {
    let encoded = srgb_from_linear(Vec3::<f64>::from_f64([0.0, 0.0031308, 0.214_041_14])).to_f64();
    assert_near(encoded, [0.0, 0.04045, 0.5], 1e-5);
    for byte in 0..=255 {
        let srgb = f64::from(byte) / 255.0;
        let back = srgb_from_linear(linear_from_srgb(Vec3::splat(srgb as f32))).to_f64();
        assert_near(back, [srgb; 3], 2e-6);
        let back = srgb_from_linear(linear_from_srgb(Vec3::splat(srgb))).to_f64();
        assert_near(back, [srgb; 3], 1e-7);
    }
}

/// What `scripts/tone-table --check 12` prints: scene colours, and what OpenColorIO 2.5 makes of them.
const KNOWN: [[f64; 6]; 12] = [
    [0.392921, 4.562575, 1.526241, 0.760671, 0.930863, 0.804952],
    [0.010700, 0.021025, 3.686530, 0.351585, 0.401180, 1.000000],
    [0.001475, 2.300645, 1.850572, 0.569000, 0.859285, 0.813640],
    [0.095340, 0.021575, 0.017284, 0.200891, 0.043101, 0.031538],
    [0.013979, 0.077592, 0.132604, 0.030091, 0.193775, 0.264604],
    [0.206117, 11.062247, 1.778516, 0.865901, 0.985116, 0.870809],
    [0.382730, 10.429158, 0.009787, 0.824730, 1.000000, 0.772173],
    [0.005957, 0.350888, 0.002089, 0.104125, 0.485747, 0.080230],
    [0.001940, 0.145554, 0.093866, 0.038981, 0.293370, 0.237794],
    [5.461321, 0.407822, 0.144546, 1.000000, 0.635568, 0.547880],
    [0.123743, 0.013082, 0.001564, 0.201397, 0.041254, 0.002723],
    [0.007962, 0.718214, 0.008573, 0.196178, 0.663307, 0.173153],
];

#[test]
fn aces_2_has_the_colours_of_open_color_io() {
    let mut apart = Vec::new();
    for [r, g, b, expected @ ..] in KNOWN {
        let shown = srgb_from_linear(tone_map(ToneCurve::Aces2, vec3(r, g, b))).to_f64();
        let worst = (0..3).map(|i| (shown[i] - expected[i]).abs()).fold(0.0, f64::max);
        assert!(worst < 0.012, "{:?}: {shown:?}, not {expected:?}", [r, g, b]);
        apart.push(worst);
    }
    let mean = apart.iter().sum::<f64>() / apart.len() as f64;
    assert!(mean < 0.003, "{mean}");
    // Middle grey and white, by OpenColorIO.
    for (grey, expected) in [(0.18, 0.349188), (1.0, 0.706683), (16.0, 0.974728)] {
        let shown = srgb_from_linear(tone_map(ToneCurve::Aces2, Vec3::splat(grey))).to_f64();
        assert!(shown.iter().all(|x: &f64| (x - expected).abs() < 0.001), "{shown:?}");
    }
}

/// What a view shows of an image, of one channel.
fn shown(image: &Image, glare: f32, vignette: f32) -> Vec<f64> {
    let view = ViewSettings {
        glare,
        vignette,
        tone_map: ToneCurve::None,
        ..ViewSettings::default()
    };
    let light = |code: &u8| linear_from_srgb(Vec3::splat(f64::from(*code) / 255.0)).x;
    display(image, &view).iter().step_by(4).map(light).collect()
}

/// A share of the light moves, none is made or lost, and it falls off with the distance. The corners keep what the vignette says.
#[test]
fn glare_spreads_light_and_a_vignette_darkens_the_corners() {
    let (width, height) = (64, 48);
    let mut sparks = Image {
        width,
        height,
        pixels: vec![[0.0, 0.0, 0.0, 1.0]; (width * height) as usize],
    };
    let at = |x: u32, y: u32| (y * width + x) as usize;
    let middle = at(21, 24);
    sparks.pixels[middle] = [0.9, 0.6, 0.3, 1.0];
    let glowing = shown(&sparks, 0.3, 0.0);
    let [centre, near, far] = [middle, at(24, 24), at(30, 24)].map(|place| glowing[place]);
    assert!(centre > 0.7 * 0.9 && centre < 0.8 * 0.9, "{centre}");
    assert!(near > far, "{near} and {far}");
    let even = Image {
        pixels: vec![[0.4, 0.3, 0.2, 1.0]; sparks.pixels.len()],
        ..sparks
    };
    let plain = shown(&even, 0.0, 0.0);
    assert_eq!(
        shown(&even, 0.5, 0.0),
        plain,
        "an image of one tone has nothing to spread"
    );
    let dark = shown(&even, 0.0, 1.0);
    near!(dark[at(32, 24)] / plain[0], 1.0, 0.01);
    near!(dark[0] / plain[0], 0.25, 0.02);
}
