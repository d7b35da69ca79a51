//! Colours: of black bodies, between spaces, graded, and of metals by two colours.

use glossmith::{
    document::{Conductor, MaterialSettings},
    optics::{
        blackbody::{blackbody_color, temperature_of_color},
        fresnel::{Fresnel, fresnel_conductor, fresnel_metal},
        primaries::{Chromaticities, NoSpace, REC709, transformed},
        tone::Grade,
        vector::Vec3,
    },
};

/// Middle grey, which contrast keeps.
const MIDDLE_GREY: f32 = 0.18;
/// Cosine of the 82° at which metals by two colours have their tint.
const EDGE: f64 = 1.0 / 7.0;

/// Rec. 709's primaries as XYZ, so that colours can be compared by their chromaticities.
fn chromaticity([r, g, b]: [f64; 3]) -> [f64; 2] {
    let x = 0.4124 * r + 0.3576 * g + 0.1805 * b;
    let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let z = 0.0193 * r + 0.1192 * g + 0.9505 * b;
    [x / (x + y + z), y / (x + y + z)]
}

/// Known points of the Planckian locus (Wyszecki and Stiles, table 1(5.1.6-1); 2856 K is illuminant A).
#[test]
fn colors_are_on_the_planckian_locus() {
    for (temperature_k, [x, y]) in [
        (2856.0, [0.4476, 0.4074]),
        (4000.0, [0.3805, 0.3767]),
        (6500.0, [0.3135, 0.3237]),
        (10000.0, [0.2807, 0.2884]),
    ] {
        let found = chromaticity(blackbody_color(temperature_k));
        assert!(
            (found[0] - x).abs() < 0.004 && (found[1] - y).abs() < 0.004,
            "{temperature_k}: {found:?}"
        );
    }
}

#[test]
fn a_color_tells_its_temperature() {
    for temperature_k in [2000.0, 2700.0, 5600.0, 19000.0] {
        let found = temperature_of_color(blackbody_color(temperature_k));
        near!(found / temperature_k, 1.0, 1e-6);
    }
    // White is near that of the day.
    assert!((6000.0..7500.0).contains(&temperature_of_color([1.0; 3])));
}

/// Rec. 2020 and ACEScg to Rec. 709 as ITU-R BT.2087 and the Academy (with Bradford's adaptation) give them.
#[test]
fn known_spaces_have_their_known_matrices() {
    let rec2020 = Chromaticities {
        primaries: [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]],
        white: REC709.white,
    };
    let acescg = Chromaticities {
        primaries: [[0.713, 0.293], [0.165, 0.830], [0.128, 0.044]],
        white: [0.32168, 0.33767],
    };
    for (space, expected) in [
        (
            rec2020,
            [
                [1.6605, -0.5876, -0.0728],
                [-0.1246, 1.1329, -0.0083],
                [-0.0182, -0.1006, 1.1187],
            ],
        ),
        (
            acescg,
            [
                [1.7051, -0.6218, -0.0833],
                [-0.1303, 1.1408, -0.0105],
                [-0.0240, -0.1290, 1.1530],
            ],
        ),
    ] {
        let found = space.rec709_from().expect("a space").expect("a matrix");
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            near!(found, expected, 0.0004);
        }
        let white = transformed(&found, [1.0; 3]);
        assert!(white.iter().all(|x| (x - 1.0).abs() < 1e-9), "{white:?}");
    }
    assert_eq!(REC709.rec709_from(), Ok(None));
    let line = Chromaticities {
        primaries: [[0.3, 0.3], [0.4, 0.4], [0.5, 0.5]],
        ..REC709
    };
    assert_eq!(line.rec709_from(), Err(NoSpace));
}

#[test]
fn the_light_that_is_to_be_white_becomes_white() {
    for kelvin in [2800.0, 4000.0, 9000.0] {
        let light = blackbody_color(f64::from(kelvin));
        let white = blackbody_color(f64::from(Grade::NEUTRAL_K));
        let [r, g, b] = Grade::new(kelvin, 1.0, 1.0).apply(Vec3::from_f64(light)).to_f32();
        let scale = g / white[1] as f32;
        near!(r / scale, white[0] as f32, 0.0001, "{kelvin} K");
        near!(b / scale, white[2] as f32, 0.0001, "{kelvin} K");
    }
}

#[test]
fn contrast_keeps_middle_grey_and_saturation_luminance() {
    let grey = Vec3::splat(MIDDLE_GREY);
    near!(Grade::new(Grade::NEUTRAL_K, 1.7, 1.0).apply(grey).x, MIDDLE_GREY, 1e-6);
    let color = Vec3::from_f64([0.5, 0.3, 0.2]);
    let changed = Grade::new(Grade::NEUTRAL_K, 1.0, 1.3).apply(color);
    near!(changed.luminance(), color.luminance(), 1e-6);
    assert!(changed.x > color.x && changed.z < color.z);
    let grey = Grade::new(Grade::NEUTRAL_K, 1.0, 0.0).apply(color);
    near!(grey.x, grey.z, 1e-6);
}

/// Every measured metal keeps its colour head-on and at 82°, and is near between.
#[test]
fn measured_metals_keep_their_look_by_two_colours() {
    for conductor in Conductor::all().filter(|conductor| *conductor != Conductor::Custom) {
        let measured = MaterialSettings::default().by_measured(conductor);
        let colored = measured.by_colors();
        assert_eq!((colored.fresnel, colored.metalness), (Fresnel::Schlick, 1.0));
        let [f0, tint] = [colored.base_color, colored.edge_tint].map(|color| Vec3::from_f64(color.map(f64::from)));
        for (cosine, tolerance) in [(1.0, 1e-5), (EDGE, 1e-5), (0.7, 0.03), (0.4, 0.05)] {
            let by_colors = fresnel_metal(f0, tint, cosine).to_f64();
            for (i, found) in by_colors.into_iter().enumerate() {
                let exact = fresnel_conductor(cosine, f64::from(measured.eta[i]), f64::from(measured.k[i]));
                // The tint only darkens: what brightens towards 82° stays Schlick's there.
                let slack = if tint.to_f64()[i] >= 1.0 { 0.05 } else { tolerance };
                let name = conductor.name();
                near!(found, exact, slack, "{name} at {cosine}");
            }
        }
    }
}
