//! Match look and lobe views against known values.

use glossmith::analysis::fit::{Measure, Nearest, nearest_roughness};
use glossmith::analysis::lobe_model::{LobeModel, view_direction};
use glossmith::optics::curve::Curve;
use glossmith::optics::lobe::{Lobe, phong};

/// The roughness of `lobe` nearest to a target, at normal incidence unless said otherwise.
fn nearest(target: &LobeModel, lobe: Lobe, view_angle_deg: f64, measure: Measure) -> Nearest {
    let view_angle_rad = view_angle_deg.to_radians();
    let wo = view_direction(view_angle_rad);
    let profile = |wi| measure.of(target, wo, wi);
    nearest_roughness(
        &profile,
        &LobeModel::new(lobe, 0.5, Curve::Smooth),
        view_angle_rad,
        measure,
    )
}

/// Rows of the table in docs/MATHEMATICS.md, section 5: curve, R, Phong exponent and TV, GGX α and TV.
const EQUAL_LOOKS: [(Curve, f64, [f64; 2], [f64; 2]); 10] = [
    (Curve::Sqrt, 0.1, [403.0, 0.104], [0.030, 0.25]),
    (Curve::Sqrt, 0.3, [31.0, 0.099], [0.108, 0.25]),
    (Curve::Sqrt, 0.5, [8.02, 0.083], [0.209, 0.23]),
    (Curve::Sqrt, 0.7, [3.07, 0.059], [0.320, 0.20]),
    (Curve::Sqrt, 0.9, [1.42, 0.038], [0.421, 0.16]),
    (Curve::Smooth, 0.1, [844.0, 0.074], [0.020, 0.15]),
    (Curve::Smooth, 0.3, [63.5, 0.066], [0.072, 0.15]),
    (Curve::Smooth, 0.5, [15.7, 0.047], [0.145, 0.16]),
    (Curve::Smooth, 0.7, [5.52, 0.030], [0.245, 0.17]),
    (Curve::Smooth, 0.9, [1.98, 0.046], [0.378, 0.17]),
];

#[test]
fn table_of_equal_looks_is_reproduced() {
    for (curve, roughness, [exponent, phong_tv], [alpha, ggx_tv]) in EQUAL_LOOKS {
        let target = LobeModel::new(Lobe::Geometric, roughness, curve);
        let phong = nearest(&target, Lobe::Phong, 0.0, Measure::Density);
        let ggx = nearest(&target, Lobe::Ggx, 0.0, Measure::Density);
        let case = format!("{curve:?} {roughness}: {phong:?} {ggx:?}");
        let phong_exponent = phong::exponent(phong.roughness);
        assert!((phong_exponent / exponent - 1.0).abs() < 0.01, "{case}");
        // The last digits that the table gives.
        assert!((ggx.roughness.powi(2) - alpha).abs() < 0.001, "{case}");
        assert!((phong.total_variation - phong_tv).abs() < 0.001, "{case}");
        assert!((ggx.total_variation - ggx_tv).abs() < 0.0055, "{case}");
    }
}
