// The material as the integrator sees it. Twin of src/optics/material.rs.
#import "optics/albedo"
#import "optics/coat"
#import "optics/fresnel"
#import "optics/lobe/registry"
#import "optics/numeric"
#import "scene/layout"
#import "scene/plan"

const NO_TEXTURE: u32 = 0xffffffffu;
const MATCHED_NODES: u32 = 17u;

struct MaterialSample {
    wi: vec3f,
    throughput: vec3f,
    density: f32,
    is_mirror: bool,
}

struct Surface {
    frame: Frame,
    normal: vec3f,
    wo: vec3f,
    coat_normal: vec3f,
    is_inside: bool,
}

struct SpecularAlbedos {
    taken: vec3f,
    by_dielectric: vec3f,
}

struct Layers {
    base: vec3f,
    transmission: vec3f,
    specular_probability: f32,
    transmission_probability: f32,
    coat_probability: f32,
    below_coat: vec3f,
}

fn material_shape(material: Material) -> LobeShape {
    return LobeShape(
        planned(material.lobe, PLAN_LOBE), planned(material.curve, PLAN_CURVE), planned(material.horizon, PLAN_HORIZON),
        material.curve_table, material.roughness, select(0.0, material.anisotropy, PLAN_ANISOTROPY == 1u),
        0.0,
    );
}

fn material_transmission_shape(material: Material, is_inside: bool) -> LobeShape {
    var shape = material_shape(material);
    shape.roughness = material.transmission_roughness;
    shape.eta = material_ior_ahead(material, is_inside);
    return shape;
}

fn material_ior_ahead(material: Material, is_inside: bool) -> f32 {
    return select(material.ior, 1.0 / material.ior, is_inside && material_transmits(material));
}

fn material_fresnel_terms(material: Material, is_inside: bool) -> FresnelTerms {
    let is_bare = is_inside && material_transmits(material);
    return FresnelTerms(
        planned(material.fresnel, PLAN_FRESNEL), material.base_color, material.metalness, material.edge_tint,
        select(material.specular_color, vec3f(1.0), is_bare), select(material.specular_weight, 1.0, is_bare),
        material_ior_ahead(material, is_inside), material.eta, material.k,
    );
}

fn material_has_holes(material: Material) -> bool {
    let is_masked = material.alpha_cutoff > material.opacity;
    let is_clear = material.alpha_cutoff < 0.0 && material.opacity < 1.0;
    return PLAN_ALPHA == 1u && (is_masked || is_clear || material.opacity_texture != NO_TEXTURE);
}

fn material_has_base(material: Material) -> bool {
    let is_opaque = PLAN_TRANSMISSION == 0u || material.transmission_weight < 1.0;
    return PLAN_BASE == 1u && is_opaque && material.metalness < 1.0 && any(material.base_color > vec3f(0.0));
}

fn material_transmits(material: Material) -> bool {
    return PLAN_TRANSMISSION == 1u && material.transmission_weight > 0.0 && material.metalness < 1.0;
}

fn material_has_specular(material: Material) -> bool {
    return PLAN_SPECULAR == 1u && (material.specular_weight > 0.0 || material_transmits(material));
}

fn material_layers(material: Material, surface: Surface) -> Layers {
    let transmits = material_transmits(material);
    let coat = coat_share(material, surface);
    let below_coat = coat_transmittance(material, surface, coat);
    if !material_has_base(material) && !transmits {
        let below = select(0.0, 1.0, material_has_specular(material));
        return Layers(vec3f(0.0), vec3f(0.0), 1.0, 0.0, coat_probability(coat, below), below_coat);
    }
    var albedos = SpecularAlbedos(vec3f(0.0), vec3f(0.0));
    if material_has_specular(material) {
        albedos = specular_albedos(material, surface);
    }
    // Under the metal's share there is nothing; the rest lies under the dielectric alone.
    let left = max(vec3f(1.0) - albedos.by_dielectric, vec3f(0.0)) * (1.0 - material.metalness);
    var base = material.base_color * left;
    var transmission = vec3f(0.0);
    if transmits {
        base *= 1.0 - material.transmission_weight;
        transmission = material.transmission_tint * left * material.transmission_weight;
    }
    let specular = luminance(albedos.taken);
    let through = luminance(transmission);
    let rest = luminance(base) + through;
    var share = sampled_share(specular / max(specular + rest, 1e-9));
    share = select(1.0, share, rest > 0.0);
    // What is passed on is what was not reflected, no estimate.
    share = select(share, min(specular, 1.0), passes_on(material));
    return Layers(
        base, transmission, share, (1.0 - share) * (through / max(rest, 1e-9)),
        coat_probability(coat, specular + rest), below_coat,
    );
}

fn specular_albedos(material: Material, surface: Surface) -> SpecularAlbedos {
    var place = dot(surface.frame.normal, surface.wo);
    var first = material.albedo_table;
    if surface.is_inside && material_transmits(material) {
        place = albedo_place(place, material_ior_ahead(material, true));
        first = material.inner_albedo_table;
    }
    if PLAN_ROUGH_TABLES == 1u && material.has_rough_tables == 1u {
        let integrals = rough_albedo_lookup(first, place, material.roughness);
        let terms = material_fresnel_terms(material, surface.is_inside);
        return SpecularAlbedos(rough_albedo(terms, integrals), rough_albedo(of_dielectric(terms), integrals));
    }
    let taken = albedo_lookup(first, place);
    return SpecularAlbedos(taken, taken);
}

fn material_albedo(material: Material, surface: Surface) -> vec3f {
    var specular = vec3f(0.0);
    if material_has_specular(material) {
        if material_has_base(material) || material_transmits(material) {
            specular = specular_albedos(material, surface).taken;
        } else {
            let cosine = dot(surface.frame.normal, surface.wo);
            specular = fresnel(material_fresnel_terms(material, surface.is_inside), cosine);
        }
    }
    let layers = material_layers(material, surface);
    return specular + layers.base + layers.transmission;
}

fn base_probability(layers: Layers) -> f32 {
    return 1.0 - layers.specular_probability - layers.transmission_probability;
}

fn base_shape() -> LobeShape {
    return LobeShape(LOBE_LAMBERT, CURVE_SQRT, HORIZON_MIRROR, 0u, 1.0, 0.0, 0.0);
}

const LAYER_SPECULAR: u32 = 0u;
const LAYER_BASE: u32 = 1u;
const LAYER_TRANSMISSION: u32 = 2u;
const LAYER_COAT: u32 = 3u;

struct MaterialNumbers {
    lobe: vec3f,
    layer: f32,
    below: vec3f,
}

fn passes_on(material: Material) -> bool {
    return material_transmits(material) && weighs_one(planned(material.lobe, PLAN_LOBE));
}

fn material_sample(
    material: Material, surface: Surface, numbers: MaterialNumbers, wants_density: bool,
) -> MaterialSample {
    let layers = material_layers(material, surface);
    let base = base_probability(layers);
    let through = layers.transmission_probability;
    let is_passed_on = passes_on(material);
    var xi = numbers.lobe;
    var specular = layers.specular_probability;
    let is_coated = material_has_coat(material, surface);
    var choice = numbers.layer;
    if is_coated && choice >= layers.coat_probability {
        choice = rescaled(choice, layers.coat_probability);
    }
    let below = 1.0 - layers.coat_probability;
    var layer = below_layer(choice, specular, base, through);
    if is_passed_on || choice < specular {
        layer = LAYER_SPECULAR;
    }
    var frame = surface.frame;
    if is_coated && numbers.layer < layers.coat_probability {
        layer = LAYER_COAT;
        frame = frame_from_normal(surface.coat_normal);
    }
    var shape: LobeShape;
    var drawn: LobeSample;
    var color: vec3f;
    var probability: f32;
    // A loop, so that the lobes' code is there once: the second time where the specular lobe passed on.
    for (var i = 0u; i < 1u + PLAN_TRANSMISSION; i++) {
        shape = layer_shape(material, layer, surface.is_inside);
        drawn = lobe_sample(shape, frame, surface.normal, surface.wo, xi);
        if PLAN_COAT == 1u && layer == LAYER_COAT {
            color = vec3f(coat_fresnel(material, surface.wo, drawn.wi));
            probability = layers.coat_probability;
            break;
        }
        if layer == LAYER_SPECULAR {
            let terms = material_fresnel_terms(material, surface.is_inside);
            color = fresnel(terms, half_vector_cosine(surface.wo, drawn.wi));
            if is_passed_on {
                specular = select(0.0, luminance(color), drawn.weight > 0.0);
            }
            probability = specular;
            if choice < specular {
                break;
            }
            xi = numbers.below;
            layer = below_layer(choice, specular, base, through);
            continue;
        }
        if PLAN_TRANSMISSION == 1u && layer == LAYER_TRANSMISSION {
            color = transmission_color(material, layers, shape, surface, drawn.wi);
            probability = through;
        } else {
            color = layers.base;
            probability = base;
        }
        break;
    }
    if is_coated && layer != LAYER_COAT {
        color *= layers.below_coat;
        probability *= below;
    }
    let mirror = is_mirror(shape);
    var density = 0.0;
    if wants_density && !mirror {
        density = probability * lobe_evaluate(shape, frame, surface.normal, surface.wo, drawn.wi).y;
    }
    return MaterialSample(drawn.wi, color * (drawn.weight / max(probability, 1e-20)), density, mirror);
}

// A number in [0, 1) that was not below `share`, stretched to [0, 1) again.
fn rescaled(number: f32, share: f32) -> f32 {
    return min((number - share) / max(1.0 - share, 1e-20), 0.99999994);
}

// The layer below the specular one, whose probability was `specular`.
fn below_layer(xi_layer: f32, specular: f32, base: f32, through: f32) -> u32 {
    let base_end = specular + (1.0 - specular) * (base / max(base + through, 1e-20));
    let is_base = PLAN_TRANSMISSION == 0u || xi_layer < base_end || !(through > 0.0);
    return select(LAYER_TRANSMISSION, LAYER_BASE, is_base);
}

fn layer_shape(material: Material, layer: u32, is_inside: bool) -> LobeShape {
    if layer == LAYER_SPECULAR {
        return material_shape(material);
    }
    if PLAN_TRANSMISSION == 1u && layer == LAYER_TRANSMISSION {
        return material_transmission_shape(material, is_inside);
    }
    if PLAN_COAT == 1u && layer == LAYER_COAT {
        return coat_shape(material);
    }
    return base_shape();
}

fn transmission_color(material: Material, layers: Layers, shape: LobeShape, surface: Surface, wi: vec3f) -> vec3f {
    if !refracts_at_facets(shape) {
        return layers.transmission;
    }
    let cosines = refracting_cosines(surface.wo, wi, shape.eta);
    let left = fresnel_left(material_fresnel_terms(material, surface.is_inside), cosines.x, cosines.y);
    return material.transmission_tint * left * (material.transmission_weight * (1.0 - material.metalness));
}

fn material_evaluate(material: Material, surface: Surface, wi: vec3f, light_density: f32, competing: f32) -> vec3f {
    let layers = material_layers(material, surface);
    let below = 1.0 - layers.coat_probability;
    var sum = vec3f(0.0);
    // A loop over the specular and the refracting lobe, so that the lobes' code is there once.
    for (var i = 0u; i < 1u + PLAN_TRANSMISSION; i++) {
        let is_through = PLAN_TRANSMISSION == 1u && i == 1u;
        var shape = material_shape(material);
        var probability = layers.specular_probability;
        var is_there = material_has_specular(material);
        if is_through {
            shape = material_transmission_shape(material, surface.is_inside);
            probability = layers.transmission_probability;
            is_there = material_transmits(material);
        }
        if !is_there || is_mirror(shape) {
            continue;
        }
        let lobe = lobe_evaluate(shape, surface.frame, surface.normal, surface.wo, wi);
        var color = vec3f(0.0);
        if is_through {
            color = transmission_color(material, layers, shape, surface, wi);
        } else {
            let terms = material_fresnel_terms(material, surface.is_inside);
            color = fresnel(terms, half_vector_cosine(surface.wo, wi));
            probability = select(probability, luminance(color), passes_on(material));
        }
        let share = light_density / (light_density + competing * below * probability * lobe.y);
        sum += color * layers.below_coat * (lobe.x * share);
    }
    if material_has_base(material) {
        let lobe = lobe_evaluate(base_shape(), surface.frame, surface.normal, surface.wo, wi);
        let share = light_density / (light_density + competing * below * base_probability(layers) * lobe.y);
        sum += layers.base * layers.below_coat * (lobe.x * share);
    }
    if material_has_coat(material, surface) {
        let lobe = coat_evaluate(material, surface, wi);
        sum += vec3f(lobe.x * (light_density / (light_density + competing * layers.coat_probability * lobe.y)));
    }
    return sum;
}
