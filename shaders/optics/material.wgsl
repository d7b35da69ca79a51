// The material as the integrator sees it. Twin of src/optics/material/mod.rs.
#import "optics/albedo"
#import "optics/coat"
#import "optics/fresnel"
#import "optics/lobe/registry"
#import "optics/numeric"
#import "optics/warp"
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
    // Albedo of the specular lobe, where anything lies under it.
    specular: vec3f,
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
    let tint = select(material.specular_color, vec3f(1.0), is_bare);
    let weight = select(material.specular_weight, 1.0, is_bare);
    return FresnelTerms(
        planned(material.fresnel, PLAN_FRESNEL), material.base_color, material.metalness, material.edge_tint, tint,
        select(weight * tint, vec3f(1.0), has_flag(material, SPARES_METAL)), weight, material_ior_ahead(material, is_inside), material.eta, material.k,
    );
}

fn material_has_holes(material: Material) -> bool {
    let is_masked = material.alpha_cutoff > material.opacity;
    let is_clear = material.alpha_cutoff < 0.0 && material.opacity < 1.0;
    let is_varied = material.opacity_texture != NO_TEXTURE || has_vertex_flag(material, VERTEX_OPACITY);
    return PLAN_ALPHA == 1u && (is_masked || is_clear || is_varied);
}

fn has_flag(material: Material, flag: u32) -> bool {
    return (material.flags & flag) != 0u;
}

// What vertices say of opacity and emission.
fn has_vertex_flag(material: Material, flag: u32) -> bool {
    return PLAN_VERTEX_COLORS == 1u && has_flag(material, flag);
}

fn material_has_base(material: Material) -> bool {
    let is_opaque = PLAN_TRANSMISSION == 0u || material.transmission_weight < 1.0;
    return PLAN_BASE == 1u && is_opaque && material.metalness < 1.0 && any(material.base_color > vec3f(0.0));
}

fn material_transmits(material: Material) -> bool {
    return PLAN_TRANSMISSION == 1u && material.transmission_weight > 0.0 && material.metalness < 1.0;
}

fn material_has_specular(material: Material) -> bool {
    if PLAN_SPECULAR == 0u {
        return false;
    }
    let may_be_metal = material.metalness > 0.0 || material.metalness_texture != NO_TEXTURE;
    let is_spared = may_be_metal && has_flag(material, SPARES_METAL);
    return material.specular_weight > 0.0 || is_spared || material_transmits(material);
}

fn material_layers(material: Material, surface: Surface) -> Layers {
    let transmits = material_transmits(material);
    let coat = coat_share(material, surface);
    let below_coat = coat_transmittance(material, surface, coat);
    if !material_has_base(material) && !transmits {
        let below = select(0.0, 1.0, material_has_specular(material));
        return Layers(vec3f(0.0), vec3f(0.0), 1.0, 0.0, coat_probability(coat, below), below_coat, vec3f(0.0));
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
        coat_probability(coat, specular + rest), below_coat, albedos.taken,
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

fn material_albedo(material: Material, surface: Surface, layers: Layers) -> vec3f {
    var specular = layers.specular;
    if material_has_specular(material) && !material_has_base(material) && !material_transmits(material) {
        let cosine = dot(surface.frame.normal, surface.wo);
        specular = fresnel(material_fresnel_terms(material, surface.is_inside), cosine);
    }
    return coat_share(material, surface) + layers.below_coat * (specular + layers.base + layers.transmission);
}

fn material_normal(surface: Surface, layers: Layers) -> vec3f {
    return mix(surface.frame.normal, surface.coat_normal, layers.coat_probability);
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
    facet: f32,
    below: vec3f,
}

// Light from a direction that was drawn with some density. competing: 1 where the material's own density takes its share.
struct MaterialLight {
    wi: vec3f,
    density: f32,
    competing: f32,
}

// A direction drawn, and what the material reflects of the light.
struct MaterialScatter {
    drawn: MaterialSample,
    reflected: vec3f,
}

// What is done at a surface point, in order: light is weighed by each lobe, then a direction is drawn, and once more where
// the specular lobe passed on.
const STEP_SPECULAR: u32 = 0u;
const STEP_TRANSMISSION: u32 = 1u;
const STEP_COAT: u32 = 2u;
const STEP_DRAW: u32 = 3u;
const STEP_DRAW_BELOW: u32 = 4u;

fn passes_on(material: Material) -> bool {
    return material_transmits(material) && weighs_one(planned(material.lobe, PLAN_LOBE));
}

fn material_sample(
    material: Material, surface: Surface, numbers: MaterialNumbers, wants_density: bool,
) -> MaterialSample {
    let steps = vec2u(STEP_DRAW, STEP_DRAW_BELOW + PLAN_TRANSMISSION);
    let layers = material_layers(material, surface);
    return material_scatter(material, surface, layers, steps, numbers, wants_density, MaterialLight()).drawn;
}

fn material_evaluate(material: Material, surface: Surface, wi: vec3f, light_density: f32, competing: f32) -> vec3f {
    let light = MaterialLight(wi, light_density, competing);
    let steps = vec2u(STEP_SPECULAR, STEP_DRAW);
    let layers = material_layers(material, surface);
    return material_scatter(material, surface, layers, steps, MaterialNumbers(), false, light).reflected;
}

// The steps from steps.x to before steps.y. A loop, so that the code of the lobes and of what they reflect is there once:
// drivers inline every call, and compile in more than proportion to the size.
fn material_scatter(
    material: Material, surface: Surface, layers: Layers, steps: vec2u, numbers: MaterialNumbers, wants_density: bool,
    light: MaterialLight,
) -> MaterialScatter {
    let base = base_probability(layers);
    let spread = base_spread(material, surface);
    var through = layers.transmission_probability;
    let below = 1.0 - layers.coat_probability;
    let is_passed_on = passes_on(material);
    let is_shared = shares_facets(material);
    let is_coated = material_has_coat(material, surface);
    let is_by_facet = is_passed_on || is_shared;
    var xi = numbers.lobe;
    var chosen = LAYER_SPECULAR;
    if is_coated {
        let part = split(xi.x, layers.coat_probability);
        xi.x = part.stretched;
        chosen = select(LAYER_SPECULAR, LAYER_COAT, part.is_below);
    }
    let choice = select(xi.x, numbers.facet, is_by_facet);
    var specular = layers.specular_probability;
    if !is_by_facet && chosen == LAYER_SPECULAR {
        let part = split(choice, specular);
        xi.x = part.stretched;
        if !part.is_below {
            let rest = split(part.stretched, share_of_base(base, through));
            xi.x = rest.stretched;
            chosen = below_layer(rest, through);
        }
    }
    var drawn = MaterialSample();
    var reflected = vec3f(0.0);
    if material_has_base(material) && steps.x < STEP_DRAW {
        let value = base_evaluate(surface, light.wi, spread);
        let share = light.density / (light.density + light.competing * below * base * value);
        reflected = layers.base * layers.below_coat * (value * share);
    }
    for (var step = steps.x; step < steps.y; step++) {
        let draws = step >= STEP_DRAW;
        var layer = LAYER_SPECULAR;
        var is_there = material_has_specular(material);
        if PLAN_TRANSMISSION == 1u && step == STEP_TRANSMISSION {
            layer = LAYER_TRANSMISSION;
            is_there = material_transmits(material);
        }
        if PLAN_COAT == 1u && step == STEP_COAT {
            layer = LAYER_COAT;
            is_there = is_coated;
        }
        if draws {
            layer = chosen;
            is_there = true;
        } else if step != STEP_SPECULAR && layer == LAYER_SPECULAR {
            is_there = false;
        }
        let shape = layer_shape(material, layer, surface.is_inside);
        let mirror = is_mirror(shape);
        if !is_there || (mirror && !draws) {
            continue;
        }
        var frame = surface.frame;
        if PLAN_COAT == 1u && layer == LAYER_COAT {
            frame = frame_from_normal(surface.coat_normal);
        }
        var wi = light.wi;
        var weight = 1.0;
        if draws {
            let sample = lobe_sample(shape, frame, surface.normal, surface.wo, xi);
            wi = sample.wi;
            weight = sample.weight;
            if spread < 1.0 && layer == LAYER_BASE {
                wi = base_narrowed(surface, xi.xy, spread);
                weight = 1.0;
            }
        }
        var color = layers.base;
        var probability = base;
        if layer == LAYER_SPECULAR {
            let terms = material_fresnel_terms(material, surface.is_inside);
            color = fresnel(terms, half_vector_cosine(surface.wo, wi));
            specular = specular_probability(material, layers, surface, wi, color);
            if is_passed_on && !(weight > 0.0) {
                specular = 0.0;
            }
            probability = specular;
            if draws && choice >= specular {
                // What is below is drawn with its own numbers, or at the same facet.
                if is_passed_on {
                    xi = numbers.below;
                }
                if is_shared {
                    through = 1.0 - base - specular;
                }
                let rest = split(choice, specular).stretched;
                chosen = below_layer(split(rest, share_of_base(base, through)), through);
                continue;
            }
        }
        // With what a layer is drawn differs from what its direction tells where the horizon policy has turned that.
        var drawn_with = probability;
        if PLAN_TRANSMISSION == 1u && layer == LAYER_TRANSMISSION {
            let there = transmission(material, layers, shape, surface, wi);
            color = there.color;
            probability = there.probability;
            drawn_with = through;
        }
        if PLAN_COAT == 1u && layer == LAYER_COAT {
            color = vec3f(coat_fresnel(material, surface.wo, wi));
            probability = layers.coat_probability;
            drawn_with = probability;
        } else if is_coated {
            color *= layers.below_coat;
            probability *= below;
            drawn_with *= below;
        }
        var lobe = vec2f(0.0);
        if !draws || (wants_density && !mirror) {
            lobe = lobe_evaluate(shape, frame, surface.normal, surface.wo, wi);
            if spread < 1.0 && layer == LAYER_BASE {
                lobe = vec2f(base_evaluate(surface, wi, spread));
            }
        }
        if draws {
            drawn = MaterialSample(wi, color * (weight / max(drawn_with, 1e-20)), probability * lobe.y, mirror);
            break;
        }
        reflected += color * (lobe.x * (light.density / (light.density + light.competing * probability * lobe.y)));
    }
    return MaterialScatter(drawn, reflected);
}

fn share_of_base(base: f32, through: f32) -> f32 {
    return base / max(base + through, 1e-20);
}

// The layer below the specular one, by the base's part of the two.
fn below_layer(part: Part, through: f32) -> u32 {
    let is_base = PLAN_TRANSMISSION == 0u || part.is_below || !(through > 0.0);
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

// One facet is drawn that mirrors or refracts, as its Fresnel factor has it.
fn shares_facets(material: Material) -> bool {
    return material_transmits(material) && facets(planned(material.lobe, PLAN_LOBE)) != FACETS_NONE
        && material.transmission_roughness == material.roughness;
}

// The probability of sampling the specular lobe for a direction that it mirrors to with this Fresnel factor.
fn specular_probability(material: Material, layers: Layers, surface: Surface, wi: vec3f, color: vec3f) -> f32 {
    let reflected = luminance(color);
    if passes_on(material) {
        return reflected;
    }
    if !shares_facets(material) {
        return layers.specular_probability;
    }
    let ior = material_ior_ahead(material, surface.is_inside);
    let cosine = half_vector_cosine(surface.wo, wi);
    let square = refracted_square(cosine, ior);
    let left = left_by_facet(material, surface, vec2f(cosine, sqrt(max(square, 0.0)) / ior));
    // What is reflected totally is not refracted, whatever the model of the Fresnel factor says.
    let refracted = select(0.0, luminance(left), square > 0.0);
    return (1.0 - base_probability(layers)) * mirrored_share(reflected, refracted);
}

fn mirrored_share(reflected: f32, refracted: f32) -> f32 {
    return sampled_share(reflected / max(reflected + refracted, 1e-20));
}

struct Transmission {
    color: vec3f,
    probability: f32,
}

fn transmission(material: Material, layers: Layers, shape: LobeShape, surface: Surface, wi: vec3f) -> Transmission {
    var through = Transmission(layers.transmission, layers.transmission_probability);
    if !refracts_at_facets(shape) {
        return through;
    }
    let cosines = refracting_cosines(surface.wo, wi, shape.eta);
    through.color = left_by_facet(material, surface, cosines);
    if shares_facets(material) {
        let reflected = luminance(fresnel(material_fresnel_terms(material, surface.is_inside), cosines.x));
        let share = 1.0 - mirrored_share(reflected, luminance(through.color));
        through.probability = (1.0 - base_probability(layers)) * share;
    }
    return through;
}

fn left_by_facet(material: Material, surface: Surface, cosines: vec2f) -> vec3f {
    let left = fresnel_left(material_fresnel_terms(material, surface.is_inside), cosines.x, cosines.y);
    return material.transmission_tint * left * (material.transmission_weight * (1.0 - material.metalness));
}

// Rounding of a squared sine at the edge of the base's cone.
const BASE_EDGE: f32 = 1.00001;

// The sine of the widest angle to which the base scatters: 1 but from within. Twin of src/optics/material/base.rs.
fn base_spread(material: Material, surface: Surface) -> f32 {
    if PLAN_TRANSMISSION == 0u || PLAN_BASE == 0u {
        return 1.0;
    }
    return select(1.0, material_ior_ahead(material, true), surface.is_inside && material_transmits(material));
}

// A direction drawn from the base from within: refracted into the solid.
fn base_narrowed(surface: Surface, xi: vec2f, spread: f32) -> vec3f {
    let normal = surface.frame.normal;
    let wide = normalize_or(normal + uniform_sphere(xi), normal);
    let cosine = dot(normal, wide);
    let height = safe_sqrt(1.0 - spread * spread * (1.0 - cosine * cosine));
    let raw = wide * spread + normal * (height - spread * cosine);
    let depth = dot(surface.normal, raw);
    return select(raw, raw - surface.normal * (2.0 * depth), depth < 0.0);
}

// The base's lobe with its cosine, which is its density, too: its own horizon's mirror image folded back.
fn base_evaluate(surface: Surface, wi: vec3f, spread: f32) -> f32 {
    let above = dot(surface.normal, wi);
    let leaning = dot(surface.frame.normal, wi);
    let folded = leaning - 2.0 * above * dot(surface.frame.normal, surface.normal);
    if spread < 1.0 {
        let both = narrow_density(leaning, spread) + narrow_density(folded, spread);
        return select(0.0, both, above > 0.0);
    }
    return select(0.0, (max(leaning, 0.0) + max(folded, 0.0)) * INV_PI, above > 0.0);
}

// The density of Lambert's lobe with its sines multiplied by spread.
fn narrow_density(cosine: f32, spread: f32) -> f32 {
    let square = spread * spread;
    let is_in_cone = 1.0 - cosine * cosine < square * BASE_EDGE;
    return select(0.0, cosine * INV_PI / square, cosine > 0.0 && is_in_cone);
}
