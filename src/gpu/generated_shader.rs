//! Shader modules that are generated from Rust's lists, so that no number is copied by hand.

use super::layout::BACKGROUNDS;
use crate::job::Strategy;
use crate::job::effect::{ANY, EffectId};
use crate::job::features::GUIDE_SAMPLES;
use crate::named::Named;
use crate::optics::curve::Curve;
use crate::optics::fresnel::Fresnel;
use crate::optics::lobe::{Horizon, Lobe};
use crate::optics::random::Sequence;
use crate::scene::camera::PixelFilter;

/// A module that no file holds: the name that `#import` knows it by, and what writes it.
pub type Generated = (&'static str, fn() -> String);

/// Every module that no file holds.
pub const GENERATED: &[Generated] = &[
    ("optics/lobe/registry", lobe_registry),
    ("optics/choices", optics_choices),
    ("scene/choices", scene_choices),
    ("scene/plan_constants", plan_constants),
];

/// A constant for each choice: `CURVE_LONG_TAIL` of "long-tail".
fn choices<T: Named>(prefix: &str) -> String {
    let line = |choice: &T| {
        let name = choice.name().to_uppercase().replace('-', "_");
        format!("const {prefix}_{name}: u32 = {}u;\n", choice.number())
    };
    T::ALL.iter().map(line).collect()
}

/// The choices that the optics know.
fn optics_choices() -> String {
    let kinds = [
        choices::<Curve>("CURVE"),
        choices::<Fresnel>("FRESNEL"),
        choices::<Horizon>("HORIZON"),
        choices::<Sequence>("SEQUENCE"),
    ];
    format!("// Generated from the choices in src/optics.\n{}", kinds.concat())
}

/// The choices of camera, background and light sampling.
fn scene_choices() -> String {
    let backgrounds = BACKGROUNDS.map(|(name, number)| format!("const BACKGROUND_{name}: u32 = {number}u;\n"));
    format!(
        "// Generated from src/job, src/scene/camera.rs and src/gpu/layout.rs.\n{}{}{}const GUIDE_SAMPLES: u32 = {GUIDE_SAMPLES}u;\n",
        choices::<Strategy>("STRATEGY"),
        choices::<PixelFilter>("FILTER"),
        backgrounds.concat(),
    )
}

/// The override constants of the plan, each with the value that leaves nothing out.
fn plan_constants() -> String {
    let mut text = format!("// Generated from src/job/effect.rs.\nconst ANY: u32 = {ANY}u;\n");
    for constant in EffectId::ALL.iter().filter_map(|effect| effect.constant()) {
        text += &format!("override {}: u32 = {}u;\n", constant.name, constant.general);
    }
    text
}

/// WGSL that finds a lobe's functions by its number: the twin of the `match`es in `src/optics/lobe/mod.rs`.
fn lobe_registry() -> String {
    let mut text = String::from("// Generated from the registry in src/optics/lobe/mod.rs.\n");
    for lobe in Lobe::ALL {
        text += &format!("#import \"optics/lobe/{}\"\n", lobe.module());
    }
    for lobe in Lobe::ALL {
        text += &format!(
            "const LOBE_{}: u32 = {}u;\n",
            lobe.module().to_uppercase(),
            *lobe as u32
        );
    }
    let cases = |call: &dyn Fn(&str) -> String| -> String {
        let case = |lobe: &Lobe| {
            format!(
                "        case {}u: {{ return {}; }}\n",
                *lobe as u32,
                call(lobe.module())
            )
        };
        Lobe::ALL.iter().map(case).collect()
    };
    let dispatch = |signature: &str, switch: &str, cases: String, otherwise: &str| {
        format!(
            "fn {signature} {{\n    switch {switch} {{\n{cases}        default: {{ return {otherwise}; }}\n    }}\n}}\n"
        )
    };
    let directions = "shape: LobeShape, frame: Frame, wo: vec3f";
    text += &dispatch(
        &format!("raw_sample({directions}, xi: vec3f) -> vec3f"),
        "shape.lobe",
        cases(&|module| format!("{module}_sample(shape, frame, wo, xi)")),
        "frame.normal",
    );
    for name in ["density", "weight"] {
        text += &dispatch(
            &format!("raw_{name}({directions}, wi: vec3f) -> f32"),
            "shape.lobe",
            cases(&|module| format!("{module}_{name}(shape, frame, wo, wi)")),
            "0.0",
        );
    }
    let property = |signature: &str, value: &dyn Fn(Lobe) -> String, otherwise: &str| {
        let case = |lobe: &Lobe| format!("        case {}u: {{ return {}; }}\n", *lobe as u32, value(*lobe));
        dispatch(signature, "lobe", Lobe::ALL.iter().map(case).collect(), otherwise)
    };
    let hemispherical = |lobe: Lobe| format!("{}_HEMISPHERICAL", lobe.module().to_uppercase());
    text += &property("is_hemispherical(lobe: u32) -> bool", &hemispherical, "true");
    let anisotropic = |lobe: Lobe| lobe.is_anisotropic().to_string();
    text += &property("is_anisotropic(lobe: u32) -> bool", &anisotropic, "false");
    let facets = |lobe: Lobe| format!("{}u", lobe.facets() as u32);
    text += &property("facets(lobe: u32) -> u32", &facets, "0u");
    text
}
