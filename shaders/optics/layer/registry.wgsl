// The layers of a material by their numbers, and the walks over them. Twin of the registry in src/optics/layer/mod.rs and of
// src/optics/layer/shares.rs and seen.rs. A layer's code is in the kernels of plans that call for the effect of its name.
#import "optics/layer/layer"
#import "optics/layer/fuzz"
#import "optics/layer/coat"
#import "optics/layer/specular"
#import "optics/layer/base"
#import "optics/layer/transmission"
#import "scene/plan"

const LAYER_FUZZ: u32 = 0u;
const LAYER_COAT: u32 = 1u;
const LAYER_SPECULAR: u32 = 2u;
const LAYER_BASE: u32 = 3u;
const LAYER_TRANSMISSION: u32 = 4u;
const LAYERS: u32 = 5u;

struct Layers {
    fuzz: LayerShare,
    coat: LayerShare,
    specular: LayerShare,
    base: LayerShare,
    transmission: LayerShare,
}

fn planned_layers() -> u32 {
    return PLAN_FUZZ + PLAN_COAT + PLAN_SPECULAR + PLAN_BASE + PLAN_TRANSMISSION;
}

fn planned_layer(place: u32) -> u32 {
    if place < PLAN_FUZZ { return LAYER_FUZZ; }
    if place < PLAN_FUZZ + PLAN_COAT { return LAYER_COAT; }
    if place < PLAN_FUZZ + PLAN_COAT + PLAN_SPECULAR { return LAYER_SPECULAR; }
    if place < PLAN_FUZZ + PLAN_COAT + PLAN_SPECULAR + PLAN_BASE { return LAYER_BASE; }
    if place < planned_layers() { return LAYER_TRANSMISSION; }
    return LAYERS;
}

fn last_layer() -> u32 {
    return planned_layer(planned_layers() - 1u);
}

// Finds the layer of a number. The last planned layer stands for every other number: drivers compute all branches, and with
// one kind of lobe planned no second one.
fn is_layer(layer: u32, number: u32) -> bool {
    return layer == number || last_layer() == number;
}

fn layer_is_there(layer: u32, material: Material, surface: Surface) -> bool {
    if PLAN_FUZZ == 1u && is_layer(layer, LAYER_FUZZ) { return fuzz_is_there(material, surface); }
    if PLAN_COAT == 1u && is_layer(layer, LAYER_COAT) { return coat_is_there(material, surface); }
    if PLAN_SPECULAR == 1u && is_layer(layer, LAYER_SPECULAR) { return specular_is_there(material, surface); }
    if PLAN_BASE == 1u && is_layer(layer, LAYER_BASE) { return base_is_there(material, surface); }
    if PLAN_TRANSMISSION == 1u && is_layer(layer, LAYER_TRANSMISSION) { return transmission_is_there(material, surface); }
    return false;
}

fn layer_lobe(layer: u32, material: Material, surface: Surface) -> LayerLobe {
    if PLAN_FUZZ == 1u && is_layer(layer, LAYER_FUZZ) { return fuzz_lobe(material, surface); }
    if PLAN_COAT == 1u && is_layer(layer, LAYER_COAT) { return coat_lobe(material, surface); }
    if PLAN_SPECULAR == 1u && is_layer(layer, LAYER_SPECULAR) { return specular_lobe(material, surface); }
    if PLAN_BASE == 1u && is_layer(layer, LAYER_BASE) { return base_lobe(material, surface); }
    if PLAN_TRANSMISSION == 1u && is_layer(layer, LAYER_TRANSMISSION) { return transmission_lobe(material, surface); }
    return no_lobe(surface);
}

fn layer_toward(layer: u32, material: Material, layers: Layers, surface: Surface, shape: LobeShape, wi: vec3f) -> LayerToward {
    if PLAN_FUZZ == 1u && is_layer(layer, LAYER_FUZZ) { return fuzz_toward(material, layers, surface, shape, wi); }
    if PLAN_COAT == 1u && is_layer(layer, LAYER_COAT) { return coat_toward(material, layers, surface, shape, wi); }
    if PLAN_SPECULAR == 1u && is_layer(layer, LAYER_SPECULAR) { return specular_toward(material, layers, surface, shape, wi); }
    if PLAN_BASE == 1u && is_layer(layer, LAYER_BASE) { return base_toward(material, layers, surface, shape, wi); }
    if PLAN_TRANSMISSION == 1u && is_layer(layer, LAYER_TRANSMISSION) { return transmission_toward(material, layers, surface, shape, wi); }
    return LayerToward();
}

fn layer_share(layer: u32, layers: Layers) -> LayerShare {
    if PLAN_FUZZ == 1u && is_layer(layer, LAYER_FUZZ) { return layers.fuzz; }
    if PLAN_COAT == 1u && is_layer(layer, LAYER_COAT) { return layers.coat; }
    if PLAN_SPECULAR == 1u && is_layer(layer, LAYER_SPECULAR) { return layers.specular; }
    if PLAN_BASE == 1u && is_layer(layer, LAYER_BASE) { return layers.base; }
    if PLAN_TRANSMISSION == 1u && is_layer(layer, LAYER_TRANSMISSION) { return layers.transmission; }
    return LayerShare();
}

fn layer_refined_sample(layer: u32, material: Material, surface: Surface, xi: vec3f, drawn: LobeSample) -> LobeSample {
    if PLAN_FUZZ == 1u && layer == LAYER_FUZZ { return fuzz_refined_sample(material, surface, xi, drawn); }
    if PLAN_COAT == 1u && layer == LAYER_COAT { return coat_refined_sample(material, surface, xi, drawn); }
    if PLAN_BASE == 1u && layer == LAYER_BASE { return base_refined_sample(material, surface, xi, drawn); }
    return drawn;
}

fn layer_refined(layer: u32, material: Material, surface: Surface, wi: vec3f, evaluated: vec2f) -> vec2f {
    if PLAN_FUZZ == 1u && layer == LAYER_FUZZ { return fuzz_refined(material, surface, wi, evaluated); }
    if PLAN_COAT == 1u && layer == LAYER_COAT { return coat_refined(material, surface, wi, evaluated); }
    if PLAN_BASE == 1u && layer == LAYER_BASE { return base_refined(material, surface, wi, evaluated); }
    return evaluated;
}

fn layer_decides_by_facet(layer: u32, material: Material) -> bool {
    return PLAN_SPECULAR == 1u && layer == LAYER_SPECULAR && decides_by_facet(material);
}

fn layer_pass_on(layer: u32, material: Material, layers: ptr<function, Layers>, weight: f32, probability: f32) -> bool {
    if PLAN_SPECULAR == 1u && layer == LAYER_SPECULAR { return specular_pass_on(material, layers, weight, probability); }
    return false;
}

// Chooses a layer by a number, from the layer `first` on. One that decides by the facet that is drawn is chosen without it.
fn layer_choice(material: Material, layers: Layers, first: u32, number: f32) -> LayerChoice {
    var left = number;
    if PLAN_FUZZ == 1u && first <= LAYER_FUZZ {
        let part = split(left, layers.fuzz.probability);
        if part.is_below { return LayerChoice(LAYER_FUZZ, part.remapped); }
        left = part.remapped;
    }
    if PLAN_COAT == 1u && first <= LAYER_COAT {
        let part = split(left, layers.coat.probability);
        if part.is_below { return LayerChoice(LAYER_COAT, part.remapped); }
        left = part.remapped;
    }
    if PLAN_SPECULAR == 1u && first <= LAYER_SPECULAR {
        if decides_by_facet(material) { return LayerChoice(LAYER_SPECULAR, left); }
        let part = split(left, layers.specular.probability);
        if part.is_below { return LayerChoice(LAYER_SPECULAR, part.remapped); }
        left = part.remapped;
    }
    if PLAN_BASE == 1u && first <= LAYER_BASE {
        let part = split(left, base_chance(layers));
        if part.is_below { return LayerChoice(LAYER_BASE, part.remapped); }
        left = part.remapped;
    }
    if PLAN_TRANSMISSION == 1u && first <= LAYER_TRANSMISSION {
        return LayerChoice(LAYER_TRANSMISSION, left);
    }
    return LayerChoice(LAYERS, left);
}

fn material_layers(material: Material, surface: Surface) -> Layers {
    var layers = Layers();
    var transmittance = vec3f(1.0);
    layers.fuzz.transmittance = transmittance;
    if PLAN_FUZZ == 1u && fuzz_is_there(material, surface) {
        let albedo = fuzz_albedo(material, surface);
        layers.fuzz.albedo = albedo.reflected;
        transmittance *= albedo.transmittance;
    }
    layers.coat.transmittance = transmittance;
    if PLAN_COAT == 1u && coat_is_there(material, surface) {
        let albedo = coat_albedo(material, surface);
        layers.coat.albedo = albedo.reflected;
        transmittance *= albedo.transmittance;
    }
    layers.specular.transmittance = transmittance;
    var left = vec3f(1.0);
    if PLAN_SPECULAR == 1u && specular_is_there(material, surface) {
        let albedo = specular_albedo(material, surface);
        layers.specular.albedo = albedo.reflected;
        left = albedo.transmittance;
    }
    layers.base.transmittance = transmittance;
    if PLAN_BASE == 1u && base_is_there(material, surface) {
        layers.base.albedo = base_albedo(material, surface, left);
    }
    layers.transmission.transmittance = transmittance;
    if PLAN_TRANSMISSION == 1u && transmission_is_there(material, surface) {
        layers.transmission.albedo = transmission_albedo(material, surface, left);
    }
    var below = luminance(layers.base.albedo) + luminance(layers.transmission.albedo);
    below = specular_choose(material, &layers, below);
    if PLAN_COAT == 1u {
        let choice = cover_choose(layers.coat.albedo, below);
        layers.coat.probability = choice.x;
        below = choice.y;
    }
    if PLAN_FUZZ == 1u {
        let choice = cover_choose(layers.fuzz.albedo, below);
        layers.fuzz.probability = choice.x;
        below = choice.y;
    }
    layers.fuzz.reached = 1.0;
    var reached = 1.0 - layers.fuzz.probability;
    layers.coat.reached = reached;
    reached *= 1.0 - layers.coat.probability;
    layers.specular.reached = reached;
    layers.base.reached = reached;
    layers.transmission.reached = reached;
    return layers;
}

fn material_albedo(material: Material, surface: Surface, layers: Layers) -> vec3f {
    var covers = vec3f(0.0);
    var below = vec3f(0.0);
    if PLAN_FUZZ == 1u { covers += layers.fuzz.transmittance * layers.fuzz.albedo; }
    if PLAN_COAT == 1u { covers += layers.coat.transmittance * layers.coat.albedo; }
    if PLAN_SPECULAR == 1u { below += layers.specular.transmittance * specular_seen_albedo(material, surface, layers.specular); }
    if PLAN_BASE == 1u { below += layers.base.transmittance * layers.base.albedo; }
    if PLAN_TRANSMISSION == 1u { below += layers.transmission.transmittance * layers.transmission.albedo; }
    if PLAN_COAT_ABSORPTION == 1u { below *= coat_tint(material, layers, surface, surface.wo); }
    return covers + below;
}

fn material_normal(material: Material, surface: Surface, layers: Layers) -> vec3f {
    var normal = surface.frame.normal;
    if PLAN_COAT == 1u && coat_is_there(material, surface) {
        normal = mix(normal, coat_lobe(material, surface).frame.normal, layers.coat.probability);
    }
    if PLAN_FUZZ == 1u && fuzz_is_there(material, surface) {
        normal = mix(normal, fuzz_lobe(material, surface).frame.normal, layers.fuzz.probability);
    }
    return normal;
}
