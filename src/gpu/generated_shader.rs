//! Shader modules that are generated from Rust's lists, so that no number is copied by hand.

use super::array::TEXEL_ROW_BITS;
use super::layout::{BACKGROUNDS, TILE_COLUMNS};
use super::material_array::FEW_MATERIALS;
use crate::job::Strategy;
use crate::job::effect::{ANY, EffectId};
use crate::job::guides::GUIDE_SAMPLES;
use crate::job::light_sums::{ENVIRONMENT_GROUP, LIGHT_GROUPS_MAX};
use crate::named::Named;
use crate::optics::curve::Curve;
use crate::optics::fresnel::Fresnel;
use crate::optics::lobe::{Horizon, Lobe, LobeTraits, Width};
use crate::optics::material::{FIELDS, Field};
use crate::optics::random::Sequence;
use crate::optics::target::TextureTarget;
use crate::scene::camera::PixelFilter;
use crate::scene::catcher::{CATCHER_BEND, CATCHER_HALF_SIDE, CATCHER_REFLECTANCE};

/// A generated module: its name for `#import`, and its generator.
pub type Generated = (&'static str, fn() -> String);

/// Every module that no file holds.
pub const GENERATED: &[Generated] = &[
    ("optics/lobe/registry", lobe_registry),
    ("optics/curve/registry", curve_registry),
    ("optics/choices", optics_choices),
    ("scene/material", material_structure),
    ("scene/choices", scene_choices),
    ("pass/light_groups", light_groups),
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

/// A material as the shaders read it.
fn material_structure() -> String {
    let field = |field: &Field| {
        let of_type = match field.of_type {
            "T" => "f32",
            "Vec3<T>" => "vec3f",
            "[u32; TARGETS]" => {
                let texture =
                    |target: &TextureTarget| format!("    {}_texture: u32,\n", target.name().replace('-', "_"));
                return TextureTarget::ALL.iter().map(texture).collect();
            }
            same => same,
        };
        format!("    {}: {of_type},\n", field.name)
    };
    let fields: String = FIELDS.iter().map(field).collect();
    format!("// Generated from src/optics/material.rs.\nstruct Material {{\n{fields}}}\n")
}

/// The choices of camera, background and light sampling, and how arrays lie in textures.
fn scene_choices() -> String {
    let backgrounds = BACKGROUNDS.map(|(name, number)| format!("const BACKGROUND_{name}: u32 = {number}u;\n"));
    format!(
        "// Generated from src/job, src/scene/camera.rs and src/gpu.\n{}{}{}const GUIDE_SAMPLES: u32 = {GUIDE_SAMPLES}u;\n\
         const ENVIRONMENT_GROUP: u32 = {ENVIRONMENT_GROUP}u;\n\
         const TEXEL_ROW_BITS: u32 = {TEXEL_ROW_BITS}u;\nconst TILE_COLUMNS: u32 = {TILE_COLUMNS}u;\n\
         const FEW_MATERIALS: u32 = {FEW_MATERIALS}u;\n\
         const CATCHER_BEND: f32 = {CATCHER_BEND:?};\nconst CATCHER_HALF_SIDE: f32 = {CATCHER_HALF_SIDE:?};\n\
         const CATCHER_REFLECTANCE: f32 = {CATCHER_REFLECTANCE:?};\n",
        choices::<Strategy>("STRATEGY"),
        choices::<PixelFilter>("FILTER"),
        backgrounds.concat(),
    )
}

/// The light of each group that a path has found. These are variables of their own: Mesa's software driver compiles a kernel
/// with a private array again for each dispatch.
fn light_groups() -> String {
    let each = |line: fn(usize) -> String| (0..LIGHT_GROUPS_MAX).map(line).collect::<String>();
    format!(
        "// Generated from src/job/light_sums.rs.\n#import \"scene/plan\"\n{}\
         fn add_to_group(group: u32, light: vec3f) {{\n    if PLAN_LIGHT_GROUPS == 1u {{\n{}    }}\n}}\n\
         fn clear_groups() {{\n    if PLAN_LIGHT_GROUPS == 1u {{\n{}    }}\n}}\n\
         fn group_light(group: u32) -> vec3f {{\n    switch group {{\n{}        default: {{ return vec3f(0.0); }}\n    }}\n}}\n",
        each(|i| format!("var<private> group_light_{i}: vec3f;\n")),
        each(|i| format!("        group_light_{i} += select(vec3f(0.0), light, group == {i}u);\n")),
        each(|i| format!("        group_light_{i} = vec3f(0.0);\n")),
        each(|i| format!("        case {i}u: {{ return group_light_{i}; }}\n")),
    )
}

/// The plan's override constants, each with the default of the über-shader.
fn plan_constants() -> String {
    let mut text = format!("// Generated from src/job/effect.rs.\nconst ANY: u32 = {ANY}u;\n");
    for constant in EffectId::ALL.iter().filter_map(|effect| effect.constant()) {
        text += &format!("override {}: u32 = {}u;\n", constant.name, constant.general);
    }
    text
}

/// A function that chooses among numbered cases; the number is called `switch`.
fn dispatch(signature: &str, switch: &str, cases: &[(u32, String)], otherwise: &str) -> String {
    let case = |(number, value): &(u32, String)| format!("        case {number}u: {{ return {value}; }}\n");
    let cases: String = cases.iter().map(case).collect();
    format!(
        "fn {signature} {{\n    switch {switch} {{\n{cases}        default: {{ return {otherwise}; }}\n    }}\n}}\n"
    )
}

/// A case for each choice.
fn cases<T: Named>(value: impl Fn(T) -> String) -> Vec<(u32, String)> {
    T::ALL.iter().map(|choice| (choice.number(), value(*choice))).collect()
}

/// WGSL that selects a lobe's functions and properties by its number: twin of the `match`es in `src/optics/lobe/mod.rs`.
fn lobe_registry() -> String {
    let mut text = String::from("// Generated from the registry in src/optics/lobe/mod.rs.\n");
    for lobe in Lobe::ALL {
        text += &format!("#import \"optics/lobe/{}\"\n", lobe.module());
    }
    for lobe in Lobe::ALL {
        let name = lobe.module().to_uppercase();
        text += &format!("const LOBE_{name}: u32 = {}u;\n", *lobe as u32);
    }
    let directions = "shape: LobeShape, frame: Frame, wo: vec3f";
    text += &dispatch(
        &format!("raw_sample({directions}, xi: vec3f) -> vec3f"),
        "shape.lobe",
        &cases(|lobe: Lobe| format!("{}_sample(shape, frame, wo, xi)", lobe.module())),
        "frame.normal",
    );
    for name in ["density", "weight"] {
        text += &dispatch(
            &format!("raw_{name}({directions}, wi: vec3f) -> f32"),
            "shape.lobe",
            &cases(|lobe: Lobe| format!("{}_{name}(shape, frame, wo, wi)", lobe.module())),
            "0.0",
        );
    }
    let mut of_lobe = |signature: &str, value: &dyn Fn(LobeTraits) -> String, otherwise: &str| {
        text += &dispatch(signature, "lobe", &cases(|lobe: Lobe| value(lobe.traits())), otherwise);
    };
    let hemispherical = |traits: LobeTraits| traits.is_hemispherical.to_string();
    of_lobe("is_hemispherical(lobe: u32) -> bool", &hemispherical, "true");
    let anisotropic = |traits: LobeTraits| traits.is_anisotropic.to_string();
    of_lobe("is_anisotropic(lobe: u32) -> bool", &anisotropic, "false");
    let weighs_one = |traits: LobeTraits| traits.weighs_one.to_string();
    of_lobe("weighs_one(lobe: u32) -> bool", &weighs_one, "false");
    let facets = |traits: LobeTraits| format!("{}u", traits.facets as u32);
    of_lobe("facets(lobe: u32) -> u32", &facets, "0u");
    let width = |traits: LobeTraits| match traits.width {
        Width::Fixed => "1.0".to_owned(),
        Width::Roughness => "roughness".to_owned(),
        Width::Alpha => "roughness * roughness".to_owned(),
    };
    of_lobe("lobe_width(lobe: u32, roughness: f32) -> f32", &width, "1.0");
    let refracting = |traits: LobeTraits| match traits.width {
        Width::Fixed => "roughness".to_owned(),
        Width::Roughness => "refracting_roughness_of(roughness, share)".to_owned(),
        Width::Alpha => "roughness * sqrt(share)".to_owned(),
    };
    let signature = "refracting_roughness_by(lobe: u32, roughness: f32, share: f32) -> f32";
    of_lobe(signature, &refracting, "roughness");
    text
}

/// WGSL that selects a curve's functions and properties by its number: twin of the `match`es in `src/optics/curve/mod.rs`.
fn curve_registry() -> String {
    let mut text = String::from("// Generated from the registry in src/optics/curve/mod.rs.\n");
    for curve in Curve::ALL {
        text += &format!("#import \"optics/curve/{}\"\n", curve.module());
    }
    let mut integrals: Vec<_> = Curve::ALL
        .iter()
        .map(|curve| curve.traits().integral.in_shaders())
        .collect();
    integrals.sort_unstable();
    integrals.dedup();
    for (number, name) in integrals {
        text += &format!("const INTEGRAL_{name}: u32 = {number}u;\n");
    }
    let mut of_curve = |signature: &str, value: &dyn Fn(Curve) -> String, otherwise: &str| {
        text += &dispatch(signature, "curve", &cases(value), otherwise);
    };
    let distance = |curve: Curve| format!("{}_distance(table, xi)", curve.module());
    of_curve(
        "curve_distance(curve: u32, table: u32, xi: f32) -> f32",
        &distance,
        "xi",
    );
    let distance_max = |curve: Curve| format!("{}_distance_max(table)", curve.module());
    of_curve(
        "curve_distance_max(curve: u32, table: u32) -> f32",
        &distance_max,
        "1.0",
    );
    let h = |curve: Curve| format!("{}_h(table, distance)", curve.module());
    of_curve("curve_h(curve: u32, table: u32, distance: f32) -> f32", &h, "0.0");
    let integral = |curve: Curve| format!("{}u", curve.traits().integral.in_shaders().0);
    of_curve("curve_integral(curve: u32) -> u32", &integral, "0u");
    let polynomial = |curve: Curve| {
        let [a, b, c] = curve.traits().integral.polynomial();
        format!("vec3f({a:?}, {b:?}, {c:?})")
    };
    of_curve("curve_polynomial(curve: u32) -> vec3f", &polynomial, "vec3f(0.0)");
    text
}
