//! Lobes in the furnace: their albedos by quadrature, and white metals whose facets scatter until all light is reflected.

use glossmith::analysis::quadrature::integrate_hemisphere;
use glossmith::optics::curve::Curve;
use glossmith::optics::frame::frame_from_normal;
use glossmith::optics::lobe::{Horizon, Lobe, LobeShape, lobe_evaluate};
use glossmith::optics::vector::vec3;

use crate::analytic_scenes::{Case, MIS};

/// A white surface of a lobe in the furnace, which shows what `expected` makes of the lobe's albedo by the sine of the view's
/// angle: by quadrature.
pub fn lobe_case(name: &str, lobe: Lobe, roughness: f64, expected: impl Fn(&dyn Fn(f64) -> f64) -> f64) -> Case {
    let frame = frame_from_normal(vec3(0.0, 0.0, 1.0));
    let shape = LobeShape {
        lobe,
        curve: Curve::Smooth,
        horizon: Horizon::Absorb,
        roughness,
        anisotropy: 0.0,
        eta: 0.0,
        table: &[],
    };
    let albedo = |sin: f64| {
        let wo = vec3(sin, 0.0, (1.0 - sin * sin).sqrt());
        integrate_hemisphere(64, |wi| lobe_evaluate(&shape, &frame, frame.normal, wo, wi)[0])
    };
    let assignments = [
        &format!("specular.lobe={}", lobe.name()),
        &format!("specular.roughness={roughness}"),
        "specular.fresnel=none",
        "specular.horizon=absorb",
        "specular.curve=smooth",
        "specular.multiple_scattering=off",
    ];
    Case::new(
        format!("{name} {}", lobe.name()),
        &[&assignments],
        [expected(&albedo); 3],
    )
}

/// Each lobe's albedo at 50 degrees.
pub fn lobes() -> Vec<Case> {
    let (sin, cos) = 50.0_f64.to_radians().sin_cos();
    let case = |lobe: &Lobe| {
        lobe_case("lobe", *lobe, 0.6, |albedo| albedo(sin))
            .seen([3.0 * sin, 3.0 * cos, 0.0], [0.0; 3])
            .by(MIS, 1024)
    };
    let single = Lobe::ALL.iter().map(case);
    single.chain(white_metals(sin, cos)).collect()
}

/// White metals of GGX, whose facets scatter until all light is reflected.
fn white_metals(sin: f64, cos: f64) -> impl Iterator<Item = Case> {
    let pairs = [
        (Lobe::Ggx, 0.3),
        (Lobe::Ggx, 1.0),
        (Lobe::Ggx2018, 0.8),
        (Lobe::GgxNdf, 0.5),
    ];
    pairs.into_iter().map(move |(lobe, roughness)| {
        let assignments = [
            &format!("specular.lobe={}", lobe.name()),
            &format!("specular.roughness={roughness}"),
            "specular.fresnel=schlick",
            "base.color=1,1,1",
            "base.metalness=1",
        ];
        Case::new(
            format!("white metal of {} {roughness}", lobe.name()),
            &[&assignments],
            [1.0; 3],
        )
        .seen([3.0 * sin, 3.0 * cos, 0.0], [0.0; 3])
        .by(MIS, 1024)
    })
}
