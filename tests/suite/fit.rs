//! Match look and lobe views against known values.

use glossmith::{
    analysis::fit::{Measure, Merl, Nearest, merl::CELLS, merl::SCALES, nearest_roughness},
    document::MaterialSettings,
    matching::{MatchError, Target, match_look},
    optics::{
        curve::Curve,
        lobe::{Lobe, model::LobeModel, model::view_direction, phong},
        vector::vec3,
    },
};

use crate::cli_support::Workplace;

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
        near!(phong_exponent / exponent, 1.0, 0.01, "{case}");
        // The last digits that the table gives.
        near!(ggx.roughness.powi(2), alpha, 0.001, "{case}");
        near!(phong.total_variation, phong_tv, 0.001, "{case}");
        near!(ggx.total_variation, ggx_tv, 0.0055, "{case}");
    }
}

#[test]
fn what_cannot_be_matched_is_told() {
    let ggx = LobeModel::new(Lobe::Ggx, 0.3, Curve::Smooth);
    let mirror = Target::Lobe(ggx.with_roughness(0.001));
    assert!(matches!(
        match_look(&mirror, Lobe::Geometric, 0.0),
        Err(MatchError::Mirror { .. })
    ));
    let stretched = Target::Lobe(LobeModel {
        anisotropy: 0.5,
        ..ggx.clone()
    });
    assert_eq!(
        match_look(&stretched, Lobe::Geometric, 0.0),
        Err(MatchError::Anisotropic)
    );
    for angle in [-1.0, 90.0, f64::NAN] {
        let outcome = match_look(&Target::Lobe(ggx.clone()), Lobe::Geometric, angle);
        assert!(matches!(outcome, Err(MatchError::ViewAngle(_))), "{angle}");
    }
}

/// A MERL file of a Lambertian base under a lobe, both coloured.
fn merl_file(base: [f64; 3], highlight: [f64; 3], lobe: &LobeModel) -> Vec<u8> {
    let mut bytes: Vec<u8> = CELLS.iter().flat_map(|count| (*count as i32).to_le_bytes()).collect();
    let quarter = std::f64::consts::FRAC_PI_2;
    let mut lobe_values = Vec::new();
    for cell in 0..CELLS.iter().product() {
        let index = [
            cell / (CELLS[1] * CELLS[2]),
            cell / CELLS[2] % CELLS[1],
            cell % CELLS[2],
        ];
        let place = |axis: usize| (index[axis] as f64 + 0.5) / CELLS[axis] as f64;
        let (theta_h, theta_d, phi_d) = (quarter * place(0).powi(2), quarter * place(1), 2.0 * quarter * place(2));
        let half = vec3(theta_h.sin(), 0.0, theta_h.cos());
        let across = vec3(theta_h.cos(), 0.0, -theta_h.sin());
        let around = across * phi_d.cos() + vec3(0.0, phi_d.sin(), 0.0);
        let wi = half * theta_d.cos() + around * theta_d.sin();
        let wo = wi.mirrored_about(half);
        let is_above = wi.z > 0.001 && wo.z > 0.001;
        // Below the horizon the database has negative numbers.
        lobe_values.push(if is_above {
            lobe.evaluate(wo, wi)[0] / wi.z
        } else {
            f64::NAN
        });
    }
    for channel in 0..3 {
        for value in &lobe_values {
            let reflectance = base[channel] / std::f64::consts::PI + highlight[channel] * value;
            let stored = if reflectance.is_nan() {
                -1.0
            } else {
                reflectance / SCALES[channel]
            };
            bytes.extend(stored.to_le_bytes());
        }
    }
    bytes
}

#[test]
fn measured_ggx_is_found_again() {
    let place = Workplace::new();
    let file = place.path("red-plastic.binary");
    let ggx = LobeModel::new(Lobe::Ggx, 0.3, Curve::Smooth);
    std::fs::write(&file, merl_file([0.4, 0.1, 0.05], [0.04; 3], &ggx)).unwrap();
    let merl = Merl::load(&file).unwrap();
    let (wo, wi) = (view_direction(0.5), vec3(0.3, 0.2, 0.9).normalize());
    let expected = 0.4 / std::f64::consts::PI + 0.04 * ggx.evaluate(wo, wi)[0] / wi.z;
    near!(merl.reflectance(wo, wi).x / expected, 1.0, 0.02);
    place.done("fit --target red-plastic.binary --lobe ggx --output fit.json");
    let material = place.material("fit.json");
    assert_eq!((material.lobe, material.metalness), (Lobe::Ggx, 0.0));
    near!(material.roughness / 0.3, 1.0, 0.03);
    near!(material.ior, 1.5, 0.03);
    for (found, expected) in material.base_color.into_iter().zip([0.4, 0.1, 0.05]) {
        // The base gets what the highlight leaves over.
        near!(found * 0.96 / expected, 1.0, 0.06, "{:?}", material.base_color);
    }
    // The geometric lobe, its curve free, and a metal.
    let gold = [0.9, 0.6, 0.2];
    let merl = Merl::parse(&file, &merl_file([0.0; 3], gold, &ggx)).unwrap();
    let target = Target::Measured {
        name: "gold".to_owned(),
        merl: merl.into(),
    };
    let found = match_look(&target, Lobe::Geometric, 30.0).unwrap();
    assert!(found.after.total_variation < 0.08, "{}", found.after.total_variation);
    assert!(found.after.total_variation < 0.5 * found.nearest.total_variation);
    let mut material = MaterialSettings::default();
    found.apply(&mut material);
    assert_eq!(material.metalness, 1.0);
    for (found, expected) in material.base_color.into_iter().zip(gold) {
        near!(f64::from(found) / expected, 1.0, 0.08, "{:?}", material.base_color);
    }
}

#[test]
fn command_line_fits_and_plots() {
    let place = Workplace::new();
    let printed = place
        .done("fit --target ggx:alpha=0.09 --output fit.json --plot fit.csv")
        .stdout;
    for word in [
        "target   GGX 0.3",
        "before   TV",
        "nearest  TV",
        "after    TV",
        "R        ",
        "curve    0:0,",
    ] {
        assert!(printed.contains(word), "{word}: {printed}");
    }
    let material = place.material("fit.json");
    assert_eq!((material.lobe, material.curve), (Lobe::Geometric, Curve::Custom));
    let rows = place.read("fit.csv");
    assert!(rows.starts_with("lobe,view_angle_deg,angle_deg,density\n"), "{rows}");
    for wrong in [
        "ggx:2",
        "ggx:0",
        "nothing",
        "geometric:alpha=0.1",
        "ggx:0.3/sqrt",
        "geometric:0.3/custom",
    ] {
        place.refused(2, &format!("fit --target {wrong} --output fit.json"), &[]);
    }
}
