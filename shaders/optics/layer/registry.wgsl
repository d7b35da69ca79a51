// The layers of a material by their numbers, and the walks over them. Twin of the registry in src/optics/layer/mod.rs and of
// src/optics/layer/shares.rs and seen.rs. A layer's code is in the kernels of plans that call for the effect of its name.
#import "optics/layer/layer"
#import "optics/layer/fuzz"
#import "optics/layer/coat"
#import "optics/layer/specular"
#import "optics/layer/base"
#import "optics/layer/transmission"

struct Layers {
    fuzz: LayerShare,
    coat: LayerShare,
    specular: LayerShare,
    base: LayerShare,
    transmission: LayerShare,
}

fn planned_layer(place: u32) -> u32 {
    var left = planned_layers();
    for (var i = 0u; i < place; i++) {
        left &= left - 1u;
    }
    return firstTrailingBit(left);
}

// Finds the layer of a number. The last planned layer stands for every other number: drivers compute all branches, and with
// one kind of lobe planned no second one.
fn is_layer(layer: u32, number: u32) -> bool {
    return layer == number || firstLeadingBit(planned_layers()) == number;
}

// A layer at a surface point.
fn layer_lobe(layer: u32, material: Material, layers: Layers, surface: Surface) -> LayerLobe {
    if PLAN_FUZZ && is_layer(layer, LAYER_FUZZ) {
        return LayerLobe(fuzz_is_there(material, surface), base_shape(), surface.frame, layers.fuzz);
    }
    if PLAN_COAT && is_layer(layer, LAYER_COAT) { return coat_lobe(material, layers, surface); }
    if PLAN_SPECULAR && is_layer(layer, LAYER_SPECULAR) {
        return LayerLobe(material_has_specular(material), material_shape(material), surface.frame, layers.specular);
    }
    if PLAN_TRANSMISSION && (layer == LAYER_TRANSMISSION || !plans_base()) {
        return LayerLobe(
            material_transmits(material), material_transmission_shape(material, surface.is_inside), surface.frame,
            layers.transmission,
        );
    }
    return LayerLobe(
        material_has_base(material) || scatters_within(material, surface), base_shape(), surface.frame, layers.base,
    );
}

fn layer_toward(
    layer: u32, material: Material, layers: Layers, surface: Surface, shape: LobeShape, wi: vec3f,
) -> LayerToward {
    if PLAN_FUZZ && is_layer(layer, LAYER_FUZZ) { return LayerToward(layers.fuzz.albedo, layers.fuzz.probability); }
    if PLAN_COAT && is_layer(layer, LAYER_COAT) { return LayerToward(WHITE, layers.coat.probability); }
    if PLAN_SPECULAR && is_layer(layer, LAYER_SPECULAR) { return specular_toward(material, layers, surface, wi); }
    if plans_base() && is_layer(layer, LAYER_BASE) { return base_toward(material, layers, surface, wi); }
    if PLAN_TRANSMISSION && is_layer(layer, LAYER_TRANSMISSION) {
        return transmission_toward(material, layers, surface, shape, wi);
    }
    return LayerToward();
}

fn layer_refined_sample(layer: u32, material: Material, surface: Surface, xi: vec3f, drawn: LobeSample) -> LobeSample {
    if PLAN_FUZZ && layer == LAYER_FUZZ { return fuzz_refined_sample(material, surface, xi); }
    if PLAN_COAT && layer == LAYER_COAT { return coat_refined_sample(material, surface, drawn); }
    if plans_base() && layer == LAYER_BASE { return base_refined_sample(material, surface, xi, drawn); }
    return drawn;
}

fn layer_refined(layer: u32, material: Material, surface: Surface, lobe: LayerLobe, wi: vec3f) -> vec2f {
    let evaluated = lobe_evaluate(lobe.shape, lobe.frame, surface.normal, surface.wo, wi);
    if PLAN_FUZZ && layer == LAYER_FUZZ { return fuzz_refined(material, surface, wi); }
    if PLAN_COAT && layer == LAYER_COAT {
        return vec2f(evaluated.x * coat_fresnel(material, surface.wo, wi), evaluated.y);
    }
    if plans_base() && layer == LAYER_BASE { return base_refined(material, surface, wi, evaluated); }
    return evaluated;
}

// Chooses a layer by a number, from the place `first` on. One that decides by the facet that is drawn is chosen without it.
fn layer_choice(material: Material, layers: Layers, first: u32, number: f32) -> LayerChoice {
    var choice = LayerChoice(first, number);
    for (; choice.place < countOneBits(planned_layers()); choice.place++) {
        let layer = planned_layer(choice.place);
        if PLAN_SPECULAR && layer == LAYER_SPECULAR && decides_by_facet(material) {
            break;
        }
        let part = split(choice.number, layer_chance(layer, layers));
        choice.number = part.remapped;
        if part.is_below {
            break;
        }
    }
    return choice;
}

fn layer_chance(layer: u32, layers: Layers) -> f32 {
    if PLAN_FUZZ && layer == LAYER_FUZZ { return layers.fuzz.probability; }
    if PLAN_COAT && layer == LAYER_COAT { return layers.coat.probability; }
    if PLAN_SPECULAR && layer == LAYER_SPECULAR { return layers.specular.probability; }
    return select(1.0, base_chance(layers), layer == LAYER_BASE);
}

fn material_layers(material: Material, surface: Surface) -> Layers {
    let nothing = LayerShare(vec3f(), 0.0, WHITE, 1.0);
    var layers = Layers(nothing, nothing, nothing, nothing, nothing);
    if fuzz_is_there(material, surface) {
        let albedo = fuzz_albedo(material, surface);
        layers.fuzz.albedo = albedo.reflected;
        layers.coat.transmittance = albedo.transmittance;
    }
    var below = layers.coat;
    if coat_is_there(material, surface) {
        let albedo = coat_albedo(material, surface);
        layers.coat.albedo = albedo.reflected;
        below.transmittance *= albedo.transmittance;
    }
    layers.specular = below;
    layers.base = below;
    layers.transmission = below;
    var left = WHITE;
    if material_has_specular(material) {
        let albedo = specular_albedo(material, surface);
        layers.specular.albedo = albedo.reflected;
        left = albedo.transmittance;
    }
    if material_has_base(material) || scatters_within(material, surface) {
        let again = scattered_within(material, surface);
        layers.base.albedo = base_albedo(material, left, again);
        left = max(left - again, vec3f());
    }
    if material_transmits(material) {
        layers.transmission.albedo = transmission_albedo(material, left);
    }
    let below_specular = luminance(layers.base.albedo) + transmission_estimate(material, layers);
    let beneath = specular_choose(material, &layers, below_specular);
    let coat = cover_choose(layers.coat.albedo, beneath);
    layers.coat.probability = coat.x;
    layers.fuzz.probability = cover_choose(layers.fuzz.albedo, coat.y).x;
    layers.coat.reached = 1.0 - layers.fuzz.probability;
    let reached = layers.coat.reached * (1.0 - layers.coat.probability);
    layers.specular.reached = reached;
    layers.base.reached = reached;
    layers.transmission.reached = reached;
    return layers;
}

fn material_albedo(material: Material, surface: Surface, layers: Layers) -> vec3f {
    var covers = vec3f();
    var below = vec3f();
    if PLAN_FUZZ { covers += layers.fuzz.transmittance * layers.fuzz.albedo; }
    if PLAN_COAT { covers += layers.coat.transmittance * layers.coat.albedo; }
    if PLAN_SPECULAR { below += layers.specular.transmittance * specular_seen_albedo(material, surface, layers.specular); }
    if plans_base() { below += layers.base.transmittance * layers.base.albedo; }
    if PLAN_TRANSMISSION { below += layers.transmission.transmittance * layers.transmission.albedo; }
    if PLAN_COAT_ABSORPTION { below *= coat_tint(material, layers, surface, surface.wo); }
    return covers + below;
}

fn material_normal(material: Material, surface: Surface, layers: Layers) -> vec3f {
    var normal = surface.frame.normal;
    if coat_is_there(material, surface) {
        normal = mix(normal, surface.coat_normal, layers.coat.probability);
    }
    if fuzz_is_there(material, surface) {
        normal = mix(normal, fuzz_normal(material, surface), layers.fuzz.probability);
    }
    return normal;
}
