//! Shader modules that are generated from Rust's lists, so that no number is copied by hand.

use super::{
    array::TEXEL_ROW_BITS,
    layout::{BACKGROUNDS, Globals, PixelColors, PixelStatistics, TILE_COLUMNS, Tile},
    scene_group::FEW_MATERIALS,
};
use crate::{
    job::{
        Strategy,
        effect::{ANY, EffectId},
        guides::GUIDE_SAMPLES,
        light_sums::{ENVIRONMENT_GROUP, LIGHT_GROUPS_MAX},
        probe::{
            DrawAnswer, DrawQuestion, FresnelQuestion, LobeAnswer, LobeQuestion, MaterialQuestion, RandomQuestion,
            RayAnswer, RayQuestion,
        },
    },
    named::Named,
    optics::{
        chord::{GAUSS_6, GAUSS_12, GAUSS_20, RANGE_MAX},
        curve::Curve,
        fresnel::Fresnel,
        layer::Layer,
        lobe::{Horizon, Lobe, LobeTraits, Width},
        material::{FIELDS, Field, NO_TEXTURE, TEXTURES},
        random::Sequence,
        target::{TextureTarget, TextureValues},
    },
    scene::camera::PixelFilter,
    scene::catcher::{CATCHER_BEND, CATCHER_HALF_SIDE, CATCHER_REFLECTANCE},
};

/// A generated module: its name for `#import`, and its generator.
pub type Generated = (&'static str, fn() -> String);

/// Every module that no file holds.
pub const GENERATED: &[Generated] = &[
    ("optics/lobe/registry", lobe_registry),
    ("optics/curve/registry", curve_registry),
    ("optics/choices", optics_choices),
    ("scene/material", material_structure),
    ("scene/choices", scene_choices),
    ("scene/constants", constants),
    ("scene/structures", structures),
    ("pass/light_groups", light_groups),
    ("pass/probe_entries", probe_entries),
    ("scene/plan_constants", plan_constants),
];

/// A constant for each choice: `CURVE_LONG_TAIL` of "long-tail".
fn choices<T: Named>(prefix: &str) -> String {
    T::ALL
        .iter()
        .map(|choice| {
            let name = choice.name().to_uppercase().replace('-', "_");
            format!("const {prefix}_{name}: u32 = {}u;\n", choice.number())
        })
        .collect()
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

/// A material as the shaders read it, with its textures by their numbers.
fn material_structure() -> String {
    let texture = |target: TextureTarget| format!("{}_texture", target.name().replace('-', "_"));
    let field = |field: &Field| {
        let of_type = match field.of_type {
            "T" => "f32",
            "Vec3<T>" => "vec3f",
            "[u32; TEXTURES]" => {
                let spare = |index| format!("spare_{index}");
                let name = |index| {
                    TextureTarget::ALL
                        .get(index)
                        .map_or_else(|| spare(index), |target| texture(*target))
                };
                return (0..TEXTURES)
                    .map(|index| format!("    {}: u32,\n", name(index)))
                    .collect();
            }
            same => same,
        };
        format!("    {}: {of_type},\n", field.name)
    };
    let fields: String = FIELDS.iter().map(field).collect();
    let numbers = dispatch(
        "material_texture(material: Material, kind: u32) -> u32",
        "kind",
        &cases(|target| format!("material.{}", texture(target))),
        &format!("return {NO_TEXTURE}u;"),
    );
    let products = TextureTarget::ALL.iter().map(|target| {
        let channels = match target.values() {
            TextureValues::Number(channel) => ["x", "y", "z", "w"][channel],
            _ => "xyz",
        };
        let product = |field: &&str| format!("(*material).{field} *= value.{channels}; ");
        (target.number(), target.fields().iter().map(product).collect())
    });
    let multiply = dispatch(
        "multiply(material: ptr<function, Material>, kind: u32, value: vec4f)",
        "kind",
        &products.collect::<Vec<_>>(),
        "",
    );
    format!(
        "// Generated from src/optics/material.rs and target.rs.\nstruct Material {{\n{fields}}}\n{numbers}{multiply}"
    )
}

/// Constants by their names in Rust.
macro_rules! by_name {
    (@ $type:ty, $($module:ident)::+, $($name:ident)*) => {{
        use crate::$($module)::+ as from;
        vec![$((stringify!($name), from::$name as $type)),*]
    }};
    ($type:ty: $($($module:ident)::+: $($name:ident)*;)*) => {
        [$(by_name!(@ $type, $($module)::+, $($name)*)),*].concat()
    };
}

/// The constants that Rust and the shaders share.
fn constants() -> String {
    let whole = by_name! { u32:
        optics::albedo: ALBEDO_NODES TOTAL_NODES ROUGHNESS_NODES ROUGH_ALBEDO_LENGTH;
        optics::curve: CUSTOM_INTERVALS;
        optics::material: MATCHED_NODES NO_TEXTURE HOLDS_INTEGRALS HOLDS_FILM OVER_AZIMUTH VERTEX_BASE VERTEX_EMISSION VERTEX_OPACITY SPARES_METAL COMPENSATES FILM_BANDS HAS_BOX WEIGHS_INDEX HAS_PROFILE COATS_BASE COAT_ABSORBS COAT_IS_GGX LIGHT_GROUP_SHIFT;
        scene::texture: WRAP_REPEAT WRAP_MIRRORED WRAP_CLAMP IS_SRGB IS_NEAREST IS_SECOND_SET IS_FINE IS_BOX TURNS_NORMALS CHANNEL_SHIFT WRAP_SHIFT;
        scene::camera: PIXEL_DIMENSION LENS_DIMENSION;
        scene::inversion: DRAW_BITS;
        scene::medium: NO_MEDIUM;
        scene::light_profile: PROFILE_AXES_LENGTH;
        job::tiles: TILE_SIDE;
    };
    let real = by_name! { f64:
        optics::lobe: ALPHA_MIN MIRROR_WIDTH;
        optics::layer::transmission: APART_LEAST;
        optics::layer::base: BASE_EDGE;
        optics::coat_medium: INNER_MAX COLOR_MIN WAY_COSINE_MIN;
        optics::layer::fuzz: FUZZ_ROUGHNESS_MIN;
        optics::rough_diffuse: HEAD_ON MEAN ROUGH_COSINE_MIN;
        optics::thin_film: LARGEST_FILM_F0 LEAST_FILM_COSINE FILM_TINY BAND_WIDTH UNBANDED_PHASE;
        optics::chord: SHORT_RULE_ROUGHNESS SHORT_RANGE PEAK_RADIUS TINY;
        scene::camera: GAUSSIAN_SIGMA;
        scene::light: COSINE_MIN;
        scene::surface: POSITION_ERROR MIRROR_HEIGHT_MIN VIEW_COSINE_MIN;
    };
    let mut text = choices::<Layer>("LAYER");
    text.extend(
        whole
            .iter()
            .map(|(name, value)| format!("const {name}: u32 = {value}u;\n")),
    );
    text.extend(
        real.iter()
            .map(|(name, value)| format!("const {name}: f32 = {value:?}f;\n")),
    );
    let vector = |[a, b]: [f64; 2]| format!("vec2f({a:?}, {b:?})");
    let nodes = [GAUSS_6.as_slice(), &GAUSS_12, &GAUSS_20].concat();
    let count = nodes.len();
    let nodes = crate::named::joined(nodes.into_iter().map(vector), ", ");
    text += &format!("const GAUSS: array<vec2f, {count}> = array<vec2f, {count}>({nodes});\n");
    text + &format!("const RANGE_MAX: vec2f = {};\n", vector(RANGE_MAX))
}

/// The structures of `gpu::layout`.
fn structures() -> String {
    let structure = |name: &str, members: &[(&str, &str)]| {
        let member = |(name, of_type): &(&str, &str)| {
            let of_type = match *of_type {
                "[u32; 2]" => "vec2u",
                "[f32; 2]" => "vec2f",
                "[f32; 3]" | "Vec3<f32>" => "vec3f",
                "[f32; 4]" => "vec4f",
                "Camera<f32>" => "Camera",
                same => same,
            };
            format!("    {name}: {of_type},\n")
        };
        format!(
            "struct {name} {{\n{}}}\n",
            members.iter().map(member).collect::<String>()
        )
    };
    [
        "// Generated from src/gpu/layout.rs.\n#import \"scene/camera\"\n".to_owned(),
        structure("Globals", Globals::MEMBERS),
        structure("Tile", Tile::MEMBERS),
        structure("PixelColors", PixelColors::MEMBERS),
        structure("PixelStatistics", PixelStatistics::MEMBERS),
    ]
    .concat()
}

/// The choices of camera, background and light sampling, and how arrays lie in textures.
fn scene_choices() -> String {
    let backgrounds: String = BACKGROUNDS
        .iter()
        .enumerate()
        .map(|(number, name)| format!("const BACKGROUND_{name}: u32 = {number}u;\n"))
        .collect();
    format!(
        "// Generated from src/job, src/scene/camera.rs and src/gpu.\n{}{}{}const GUIDE_SAMPLES: u32 = {GUIDE_SAMPLES}u;\n\
         const ENVIRONMENT_GROUP: u32 = {ENVIRONMENT_GROUP}u;\n\
         const TEXEL_ROW_BITS: u32 = {TEXEL_ROW_BITS}u;\nconst TILE_COLUMNS: u32 = {TILE_COLUMNS}u;\n\
         const FEW_MATERIALS: u32 = {FEW_MATERIALS}u;\n\
         const CATCHER_BEND: f32 = {CATCHER_BEND:?};\nconst CATCHER_HALF_SIDE: f32 = {CATCHER_HALF_SIDE:?};\n\
         const CATCHER_REFLECTANCE: f32 = {CATCHER_REFLECTANCE:?};\n",
        choices::<Strategy>("STRATEGY"),
        choices::<PixelFilter>("FILTER"),
        backgrounds,
    )
}

/// The light of each group that a path has found. These are variables of their own: Mesa's software driver compiles a kernel
/// with a private array again for each dispatch.
fn light_groups() -> String {
    let each = |line: fn(usize) -> String| (0..LIGHT_GROUPS_MAX).map(line).collect::<String>();
    format!(
        "// Generated from src/job/light_sums.rs.\n#import \"scene/plan\"\n{}\
         fn add_to_group(group: u32, light: vec3f) {{\n    if PLAN_LIGHT_GROUPS {{\n{}    }}\n}}\n\
         fn clear_groups() {{\n    if PLAN_LIGHT_GROUPS {{\n{}    }}\n}}\n\
         fn group_light(group: u32) -> vec3f {{\n    switch group {{\n{}        default: {{ return vec3f(0.0); }}\n    }}\n}}\n",
        each(|i| format!("var<private> group_light_{i}: vec3f;\n")),
        each(|i| format!("        group_light_{i} += select(vec3f(0.0), light, group == {i}u);\n")),
        each(|i| format!("        group_light_{i} = vec3f(0.0);\n")),
        each(|i| format!("        case {i}u: {{ return group_light_{i}; }}\n")),
    )
}

/// An entry point for each kind of question, whose answers are by functions of `pass/probe`.
fn probe_entries() -> String {
    let entry = |(kind, question, answer): (&str, usize, usize)| {
        let [question, answer] = [question, answer].map(|size| size / 4);
        format!(
            "@compute @workgroup_size(64)\nfn probe_{kind}(@builtin(global_invocation_id) id: vec3u) {{\n\
             \x20   if id.x < arrayLength(&questions) / {question}u {{\n\
             \x20       answer_{kind}(id.x * {question}u, id.x * {answer}u);\n    }}\n}}\n"
        )
    };
    let kinds = [
        ("lobe", size_of::<LobeQuestion>(), size_of::<LobeAnswer>()),
        ("fresnel", size_of::<FresnelQuestion>(), size_of::<f32>()),
        ("random", size_of::<RandomQuestion>(), size_of::<[u32; 2]>()),
        ("material", size_of::<MaterialQuestion>(), size_of::<[f32; 3]>()),
        ("density", size_of::<MaterialQuestion>(), size_of::<f32>()),
        ("draw", size_of::<DrawQuestion>(), size_of::<DrawAnswer>()),
        ("ray", size_of::<RayQuestion>(), size_of::<RayAnswer>()),
    ];
    "// Generated from src/job/probe.rs.\n#import \"pass/probe\"\n".to_owned() + &kinds.map(entry).concat()
}

/// The plan's override constants, each with the default of the über-shader.
fn plan_constants() -> String {
    let mut text = format!("// Generated from src/job/effect.rs.\nconst ANY: u32 = {ANY}u;\n");
    for constant in EffectId::ALL.iter().filter_map(|effect| effect.constant()) {
        text += &match constant.general {
            ANY => format!("override {}: u32 = ANY;\n", constant.name),
            general => format!("override {}: bool = {};\n", constant.name, general == 1),
        };
    }
    let layers: String = Layer::ALL
        .iter()
        .map(|layer| {
            let planned = match layer {
                Layer::Base => "plans_base()".to_owned(),
                other => format!("PLAN_{}", other.name().to_uppercase()),
            };
            format!(" + (u32({planned}) << {}u)", *layer as u32)
        })
        .collect();
    text += &format!(
        "// Its lobe also has what facets of a clear interface scatter within.\nfn plans_base() -> bool {{\n    \
         return PLAN_BASE || (PLAN_MULTIPLE_SCATTERING && PLAN_TRANSMISSION);\n}}\n\
         // As bits.\nfn planned_layers() -> u32 {{\n    return 0u{layers};\n}}\n"
    );
    let multiplied = |targets: &[TextureTarget]| targets.iter().any(|target| !target.fields().is_empty());
    let textures = TextureTarget::PLANS.iter().filter(|(_, targets)| multiplied(targets));
    let textures: String = textures
        .map(|(plan, targets)| {
            let bits = targets.iter().fold(0, |bits, target| bits | 1_u32 << *target as u32);
            format!(" + u32({plan}) * {bits}u")
        })
        .collect();
    text + &format!(
        "// As bits: those whose values a material is multiplied by.\nfn planned_textures() -> u32 {{\n    return 0u{textures};\n}}\n"
    )
}

/// A function that chooses among numbered cases; the number is called `switch`.
fn dispatch(signature: &str, switch: &str, cases: &[(u32, String)], otherwise: &str) -> String {
    let cases: String = cases
        .iter()
        .map(|(number, does)| format!("        case {number}u: {{ {does} }}\n"))
        .collect();
    format!("fn {signature} {{\n    switch {switch} {{\n{cases}        default: {{ {otherwise} }}\n    }}\n}}\n")
}

/// A case for each choice, which returns a value.
fn cases<T: Named>(value: impl Fn(T) -> String) -> Vec<(u32, String)> {
    let case = |choice: &T| (choice.number(), format!("return {};", value(*choice)));
    T::ALL.iter().map(case).collect()
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
        "return frame.normal;",
    );
    for name in ["density", "weight"] {
        text += &dispatch(
            &format!("raw_{name}({directions}, wi: vec3f) -> f32"),
            "shape.lobe",
            &cases(|lobe: Lobe| format!("{}_{name}(shape, frame, wo, wi)", lobe.module())),
            "return 0.0;",
        );
    }
    let mut of_lobe = |signature: &str, value: &dyn Fn(LobeTraits) -> String, otherwise: &str| {
        let otherwise = format!("return {otherwise};");
        text += &dispatch(signature, "lobe", &cases(|lobe: Lobe| value(lobe.traits())), &otherwise);
    };
    of_lobe(
        "is_hemispherical(lobe: u32) -> bool",
        &|traits| traits.is_hemispherical.to_string(),
        "true",
    );
    of_lobe(
        "is_anisotropic(lobe: u32) -> bool",
        &|traits| traits.is_anisotropic.to_string(),
        "false",
    );
    of_lobe(
        "weighs_one(lobe: u32) -> bool",
        &|traits| traits.weighs_one.to_string(),
        "false",
    );
    of_lobe(
        "facets(lobe: u32) -> u32",
        &|traits| format!("{}u", traits.facets as u32),
        "0u",
    );
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
        text += &dispatch(signature, "curve", &cases(value), &format!("return {otherwise};"));
    };
    of_curve(
        "curve_distance(curve: u32, table: u32, xi: f32) -> f32",
        &|curve| format!("{}_distance(table, xi)", curve.module()),
        "xi",
    );
    let distance_max = |curve: Curve| match curve.traits().reach {
        Some(reach) => format!("{reach:?}"),
        None => format!("{}_distance_max(table)", curve.module()),
    };
    of_curve(
        "curve_distance_max(curve: u32, table: u32) -> f32",
        &distance_max,
        "1.0",
    );
    of_curve(
        "curve_h(curve: u32, table: u32, distance: f32) -> f32",
        &|curve| format!("{}_h(table, distance)", curve.module()),
        "0.0",
    );
    of_curve(
        "curve_integral(curve: u32) -> u32",
        &|curve| format!("{}u", curve.traits().integral.in_shaders().0),
        "0u",
    );
    let polynomial = |curve: Curve| {
        let [a, b, c] = curve.traits().integral.polynomial();
        format!("vec3f({a:?}, {b:?}, {c:?})")
    };
    of_curve("curve_polynomial(curve: u32) -> vec3f", &polynomial, "vec3f(0.0)");
    text
}
