//! Lobes in the furnace: their albedos by quadrature, and white metals whose facets scatter until all light is reflected.

use glossmith::{
    analysis::quadrature::integrate_hemisphere,
    optics::{
        curve::Curve,
        frame::frame_from_normal,
        lobe::{Horizon, Lobe, LobeShape, lobe_evaluate},
        vector::vec3,
    },
};

use crate::analytic_scenes::{Case, MIS};

/// A white surface of each lobe in the furnace, seen at 50 degrees: its albedo by quadrature.
pub fn lobes() -> impl Iterator<Item = Case> {
    const ROUGHNESS: f64 = 0.6;
    let (sin, cos) = 50.0_f64.to_radians().sin_cos();
    let wo = vec3(sin, 0.0, cos);
    let frame = frame_from_normal(vec3(0.0, 0.0, 1.0));
    Lobe::ALL.iter().map(move |&lobe| {
        let shape = LobeShape {
            lobe,
            curve: Curve::Smooth,
            horizon: Horizon::Absorb,
            roughness: ROUGHNESS,
            anisotropy: 0.0,
            eta: 0.0,
            table: &[],
        };
        let albedo = integrate_hemisphere(64, |wi| lobe_evaluate(&shape, &frame, frame.normal, wo, wi)[0]);
        let assignments = format!(
            "specular.lobe={} specular.roughness={ROUGHNESS} specular.fresnel=none specular.horizon=absorb \
             specular.curve=smooth specular.multiple_scattering=off",
            lobe.name()
        );
        Case::new(format!("lobe {}", lobe.name()), &[&assignments], [albedo; 3])
            .seen([3.0 * sin, 3.0 * cos, 0.0], [0.0; 3])
            .by(MIS, 1024)
    })
}
