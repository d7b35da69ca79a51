// The material as the integrator sees it. Twin of src/optics/material.rs.
#import "optics/fresnel"
#import "optics/lobe/registry"
#import "scene/layout"
#import "scene/plan"

const ALBEDO_NODES: u32 = 64u;

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
}

struct Layers {
    base: vec3f,
    specular_probability: f32,
}

fn material_shape(material: Material) -> LobeShape {
    return LobeShape(
        planned(material.lobe, PLAN_LOBE), planned(material.curve, PLAN_CURVE), planned(material.horizon, PLAN_HORIZON),
        material.curve_table, material.roughness, select(0.0, material.anisotropy, PLAN_ANISOTROPY == 1u),
    );
}

fn material_fresnel_terms(material: Material) -> FresnelTerms {
    return FresnelTerms(
        planned(material.fresnel, PLAN_FRESNEL), material.base_color, material.metalness, material.specular_color, material.specular_weight,
        material.ior, material.eta, material.k,
    );
}

fn material_has_base(material: Material) -> bool {
    return PLAN_BASE == 1u && material.metalness < 1.0 && any(material.base_color > vec3f(0.0));
}

fn material_has_specular(material: Material) -> bool {
    return PLAN_SPECULAR == 1u && material.specular_weight > 0.0;
}

fn material_layers(material: Material, surface: Surface) -> Layers {
    if !material_has_base(material) {
        return Layers(vec3f(0.0), 1.0);
    }
    let diffuse = material.base_color * (1.0 - material.metalness);
    if !material_has_specular(material) {
        return Layers(diffuse, 0.0);
    }
    let taken = albedo_lookup(material.albedo_table, dot(surface.frame.normal, surface.wo));
    let base = max(diffuse * (vec3f(1.0) - taken), vec3f(0.0));
    let share = luminance(taken) / max(luminance(taken) + luminance(base), 1e-9);
    return Layers(base, clamp(share, 0.05, 0.95));
}

fn base_shape() -> LobeShape {
    return LobeShape(LOBE_LAMBERT, CURVE_SQRT, HORIZON_MIRROR, 0u, 1.0, 0.0);
}

fn material_sample(
    material: Material, surface: Surface, xi: vec3f, xi_layer: f32, wants_density: bool,
) -> MaterialSample {
    let layers = material_layers(material, surface);
    let is_specular = xi_layer < layers.specular_probability;
    var shape = base_shape();
    if is_specular {
        shape = material_shape(material);
    }
    let drawn = lobe_sample(shape, surface.frame, surface.normal, surface.wo, xi);
    var color = layers.base;
    var probability = 1.0 - layers.specular_probability;
    if is_specular {
        color = fresnel(material_fresnel_terms(material), half_vector_cosine(surface.wo, drawn.wi));
        probability = layers.specular_probability;
    }
    let mirror = is_mirror(shape);
    var density = 0.0;
    if wants_density && !mirror {
        density = probability * lobe_evaluate(shape, surface.frame, surface.normal, surface.wo, drawn.wi).y;
    }
    return MaterialSample(drawn.wi, color * (drawn.weight / probability), density, mirror);
}

fn material_evaluate(material: Material, surface: Surface, wi: vec3f, light_density: f32, competing: f32) -> vec3f {
    let layers = material_layers(material, surface);
    var sum = vec3f(0.0);
    let shape = material_shape(material);
    if material_has_specular(material) && !is_mirror(shape) {
        let lobe = lobe_evaluate(shape, surface.frame, surface.normal, surface.wo, wi);
        let share = light_density / (light_density + competing * layers.specular_probability * lobe.y);
        sum += fresnel(material_fresnel_terms(material), half_vector_cosine(surface.wo, wi)) * (lobe.x * share);
    }
    if material_has_base(material) {
        let lobe = lobe_evaluate(base_shape(), surface.frame, surface.normal, surface.wo, wi);
        let share = light_density / (light_density + competing * (1.0 - layers.specular_probability) * lobe.y);
        sum += layers.base * (lobe.x * share);
    }
    return sum;
}

fn albedo_lookup(albedo_table: u32, cosine: f32) -> vec3f {
    let last = f32(ALBEDO_NODES) - 1.0;
    let position = clamp(cosine, 0.0, 1.0) * last;
    let low = min(floor(position), last - 1.0);
    let first = albedo_table + 3u * u32(low);
    let left = vec3f(tables[first], tables[first + 1u], tables[first + 2u]);
    let right = vec3f(tables[first + 3u], tables[first + 4u], tables[first + 5u]);
    return mix(left, right, position - low);
}
