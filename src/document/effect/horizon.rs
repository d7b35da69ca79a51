//! What happens to samples that point into the surface, and where none can.

use super::{Decision, Facts};
use crate::{
    optics::{curve::Curve, lobe::Horizon, lobe::Lobe, material::Material},
    scene::facing::least_view_cosine,
};

/// How far below the view's cosine roughness must stay: the rounding of either.
const MARGIN: f64 = 0.001;

/// The horizon policy that all lobes share; off if provably no sample is below the surface.
pub fn decide(facts: &Facts<'_>) -> Decision {
    let crosses = |lobe: u32| !Lobe::ALL[lobe as usize].is_hemispherical();
    let shared = facts.shared(|m| m.horizon, |number| Horizon::ALL[number as usize].name());
    if facts.reflecting().all(|material| material.roughness == 0.0) {
        Decision {
            is_on: false,
            reason: "every lobe is a mirror: no sample points below the surface".to_owned(),
            ..shared
        }
    } else if !facts.reflecting().any(|material| crosses(material.lobe)) {
        Decision {
            is_on: false,
            reason: "no lobe draws samples below the surface".to_owned(),
            ..shared
        }
    } else if stays_above(facts) {
        Decision {
            value: Horizon::Absorb as u32,
            ..Decision::off("roughness is below the cosine of every view: no sample is below the surface")
        }
    } else {
        shared
    }
}

/// Whether every view is steep enough for every lobe: a sample's height above the surface is at least
/// (1 − R)(n·r − R) (docs/MATHEMATICS.md, section 3). Only where no ray but the camera's meets anything are the views
/// known.
fn stays_above(facts: &Facts<'_>) -> bool {
    let is_bounded = |material: &Material<f32>| {
        Lobe::ALL[material.lobe as usize].has_curves()
            && Curve::ALL
                .iter()
                .any(|curve| *curve as u32 == material.curve && curve.is_within_unit())
            && material.anisotropy == 0.0
            && !material.is_textured()
            && material.coat_weight == 0.0
            && material.fuzz_weight == 0.0
            && !material.has_holes()
            && !material.transmits()
    };
    let camera = &facts.settings.camera;
    if !facts.geometry.is_convex() || camera.lens_radius > 0.0 || !facts.reflecting().all(|m| is_bounded(&m)) {
        return false;
    }
    let roughest = facts.reflecting().map(|m| f64::from(m.roughness)).fold(0.0, f64::max);
    let eye = [camera.origin.x, camera.origin.y, camera.origin.z];
    roughest + MARGIN <= least_view_cosine(facts.geometry, eye)
}
