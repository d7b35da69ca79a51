//! The shader module of the layers of a material, generated from their registry in `src/optics/layer/mod.rs`: the twin of
//! the walks over it. A layer's code is in the kernels of plans that call for the effect of its name.

use crate::job::effect::{Constant, EffectId};
use crate::optics::layer::{Layer, LayerTraits};

/// WGSL of a layer from a template: `$` is the prefix of its functions, `#` its constant, `@` whether the plan uses it.
fn filled(template: &str, layer: Layer) -> String {
    let prefix = layer.module();
    let Constant { name: plan, .. } = layer
        .name()
        .parse()
        .ok()
        .and_then(EffectId::constant)
        .expect("an effect has the layer's name and a constant");
    template
        .replace('$', prefix)
        .replace('#', &format!("LAYER_{}", prefix.to_uppercase()))
        .replace('@', &format!("{plan} == 1u"))
}

/// A template's text for each layer that it is for, from the outermost inwards.
fn each(is_for: fn(LayerTraits) -> bool, template: &str) -> String {
    let layers = Layer::ALL.iter().filter(|layer| is_for(layer.traits()));
    layers.map(|layer| filled(template, *layer)).collect()
}

/// One template's text for each cover, another's for each other layer, from the outermost inwards.
fn by_kind(of_cover: &str, otherwise: &str) -> Vec<String> {
    let template = |layer: &Layer| if layer.traits().is_cover { of_cover } else { otherwise };
    let layers = Layer::ALL.iter();
    layers.map(|layer| filled(template(layer), *layer)).collect()
}

fn all(_: LayerTraits) -> bool {
    true
}

/// A function that finds a layer's by its number: of the layers that `is_for` picks, or of all. Of all, the last planned
/// layer's stands for every other number: drivers compute all branches, and with one kind of lobe planned no second one.
fn dispatch(signature: &str, is_for: Option<fn(LayerTraits) -> bool>, value: &str, otherwise: &str) -> String {
    let (is_for, is_asked) = match is_for {
        Some(is_for) => (is_for, "layer == #"),
        None => (all as fn(_) -> _, "(layer == # || last_layer() == #)"),
    };
    let cases = each(is_for, &format!("    if @ && {is_asked} {{ return {value}; }}\n"));
    format!("fn {signature} {{\n{cases}    return {otherwise};\n}}\n")
}

/// WGSL that finds a layer's functions by its number, and walks over the layers.
pub fn layer_registry() -> String {
    let modules = Layer::ALL.iter().map(|layer| layer.module());
    let imports: String = modules
        .map(|module| format!("#import \"optics/layer/{module}\"\n"))
        .collect();
    let numbers: String = Layer::ALL
        .iter()
        .map(|layer| filled(&format!("const #: u32 = {}u;\n", *layer as u32), *layer))
        .collect();
    let fields = each(all, "    $: LayerShare,\n");
    [
        "// Generated from the registry in src/optics/layer/mod.rs.\n#import \"optics/layer/layer\"\n".to_owned(),
        imports,
        "#import \"scene/plan\"\n".to_owned(),
        numbers,
        format!("const LAYERS: u32 = {}u;\n", Layer::ALL.len()),
        format!("struct Layers {{\n{fields}}}\n"),
        planned(),
        dispatches(),
        chosen(),
        shares(),
        seen(),
    ]
    .concat()
}

/// WGSL of the planned layers: their count, and the number of each.
fn planned() -> String {
    let counts = each(all, "    if @ { count += 1u; }\n");
    let found = each(
        all,
        "    if @ {\n        if place == before { return #; }\n        before += 1u;\n    }\n",
    );
    format!(
        "fn planned_layers() -> u32 {{\n    var count = 0u;\n{counts}    return count;\n}}\n\
         fn planned_layer(place: u32) -> u32 {{\n    var before = 0u;\n{found}    return LAYERS;\n}}\n\
         fn last_layer() -> u32 {{\n    return planned_layer(planned_layers() - 1u);\n}}\n"
    )
}

/// A layer's functions by its number.
fn dispatches() -> String {
    let at = "material: Material, surface: Surface";
    let by_number = |signature: String, is_for, value, otherwise| dispatch(&signature, is_for, value, otherwise);
    [
        by_number(
            format!("layer_is_there(layer: u32, {at}) -> bool"),
            None,
            "$_is_there(material, surface)",
            "false",
        ),
        by_number(
            format!("layer_lobe(layer: u32, {at}) -> LayerLobe"),
            None,
            "$_lobe(material, surface)",
            "no_lobe(surface)",
        ),
        by_number(
            "layer_toward(layer: u32, material: Material, layers: Layers, surface: Surface, shape: LobeShape, wi: vec3f) \
             -> LayerToward"
                .to_owned(),
            None,
            "$_toward(material, layers, surface, shape, wi)",
            "LayerToward()",
        ),
        by_number(
            "layer_share(layer: u32, layers: Layers) -> LayerShare".to_owned(),
            None,
            "layers.$",
            "LayerShare()",
        ),
        by_number(
            format!("layer_refined_sample(layer: u32, {at}, xi: vec3f, drawn: LobeSample) -> LobeSample"),
            Some(|traits| traits.refines),
            "$_refined_sample(material, surface, xi, drawn)",
            "drawn",
        ),
        by_number(
            format!("layer_refined(layer: u32, {at}, wi: vec3f, evaluated: vec2f) -> vec2f"),
            Some(|traits| traits.refines),
            "$_refined(material, surface, wi, evaluated)",
            "evaluated",
        ),
        by_number(
            "layer_decides_by_facet(layer: u32, material: Material) -> bool".to_owned(),
            Some(|traits| traits.decides),
            "$_decides_by_facet(material)",
            "false",
        ),
        by_number(
            "layer_pass_on(layer: u32, material: Material, layers: ptr<function, Layers>, weight: f32, probability: f32) \
             -> bool"
                .to_owned(),
            Some(|traits| traits.decides),
            "$_pass_on(material, layers, weight, probability)",
            "false",
        ),
    ]
    .concat()
}

/// The function that chooses a layer by a number, from the layer `first` on. One that decides by the facet that is drawn is
/// chosen without it.
fn chosen() -> String {
    let layer = |layer: &Layer| {
        let LayerTraits { is_cover, decides, .. } = layer.traits();
        let chance = if is_cover {
            "layers.$.probability"
        } else {
            "$_chance(layers)"
        };
        let by_facet = "        if $_decides_by_facet(material) { return LayerChoice(#, left); }\n";
        let by_facet = if decides { by_facet } else { "" };
        let template = format!(
            "    if @ && first <= # {{\n{by_facet}        let part = split(left, {chance});\n        \
             if part.is_below {{ return LayerChoice(#, part.remapped); }}\n        left = part.remapped;\n    }}\n"
        );
        filled(&template, *layer)
    };
    let layers: String = Layer::ALL.iter().map(layer).collect();
    format!(
        "fn layer_choice(material: Material, layers: Layers, first: u32, number: f32) -> LayerChoice {{\n    \
         var left = number;\n{layers}    return LayerChoice(LAYERS, left);\n}}\n"
    )
}

/// WGSL of the layers' shares for a view: albedos on the way inwards, probabilities on the way outwards, then what is
/// reached.
fn shares() -> String {
    let albedo = "    layers.$.transmittance = transmittance;\n    if @ && $_is_there(material, surface) {\n        \
                  let albedo = $_albedo(material, surface, left);\n        layers.$.albedo = albedo.reflected;\n        ";
    let albedos = by_kind(
        &format!("{albedo}transmittance *= albedo.transmittance;\n    }}\n"),
        &format!("{albedo}left *= albedo.transmittance;\n    }}\n"),
    );
    let mut probabilities = by_kind(
        "    if @ {\n        let choice = cover_choose(layers.$.albedo, below);\n        \
         layers.$.probability = choice.x;\n        below = choice.y;\n    }\n",
        "    below = $_choose(material, &layers, below);\n",
    );
    probabilities.reverse();
    let reached = by_kind(
        "    layers.$.reached = reached;\n    reached *= 1.0 - layers.$.probability;\n",
        "    layers.$.reached = reached;\n",
    );
    format!(
        "fn material_layers(material: Material, surface: Surface) -> Layers {{\n    var layers = Layers();\n    \
         var transmittance = vec3f(1.0);\n    var left = vec3f(1.0);\n{}    var below = 0.0;\n{}    \
         var reached = 1.0;\n{}    return layers;\n}}\n",
        albedos.concat(),
        probabilities.concat(),
        reached.concat(),
    )
}

/// The albedo and the normal that lead a denoiser.
fn seen() -> String {
    let albedos = by_kind(
        "    if @ { covers += layers.$.transmittance * layers.$.albedo; }\n",
        "    if @ { below += layers.$.transmittance * $_seen_albedo(material, surface, layers.$); }\n",
    );
    let mut normals = by_kind(
        "    if @ && $_is_there(material, surface) {\n        \
         normal = mix(normal, $_lobe(material, surface).frame.normal, layers.$.probability);\n    }\n",
        "",
    );
    normals.reverse();
    format!(
        "fn material_albedo(material: Material, surface: Surface, layers: Layers) -> vec3f {{\n    \
         var covers = vec3f(0.0);\n    var below = vec3f(0.0);\n{}    \
         if PLAN_COAT_ABSORPTION == 1u {{ below *= coat_tint(material, layers, surface, surface.wo); }}\n    \
         return covers + below;\n}}\n\
         fn material_normal(material: Material, surface: Surface, layers: Layers) -> vec3f {{\n    \
         var normal = surface.frame.normal;\n{}    return normal;\n}}\n",
        albedos.concat(),
        normals.concat(),
    )
}
