// The diffuse base. Twin of src/optics/layer/base.rs.
#import "optics/layer/registry"
#import "optics/rough_diffuse"
#import "optics/scattering"

fn base_shape() -> LobeShape {
    return LobeShape(LOBE_LAMBERT, CURVE_SQRT, HORIZON_MIRROR, 0u, 1.0, 0.0, 0.0);
}

fn base_albedo(material: Material, left: vec3f, again: vec3f) -> vec3f {
    return (1.0 - material.metalness)
        * mix(material.base_color * left * f32(PLAN_BASE), again, material.transmission_weight);
}

fn base_toward(material: Material, layers: Layers, surface: Surface, wi: vec3f) -> LayerToward {
    var color = layers.base.albedo;
    if PLAN_DIFFUSE_ROUGHNESS && material.diffuse_roughness > 0.0 && !is_within(material, surface) {
        color *= rough_diffuse(
            material.base_color, material.diffuse_roughness, vec2f(view_cosine(surface), dot(surface.frame.normal, wi)),
            dot(surface.wo, wi),
        );
    }
    return LayerToward(color, layers.base.probability);
}

fn base_chance(layers: Layers) -> f32 {
    let base = layers.base.probability;
    let through = layers.transmission.probability;
    return select(1.0, base / max(base + through, 1e-20), through > 0.0);
}

fn base_refined_sample(material: Material, surface: Surface, xi: vec3f, drawn: LobeSample) -> LobeSample {
    let spread = base_spread(material, surface);
    if spread >= 1.0 {
        return drawn;
    }
    let normal = surface.frame.normal;
    let wide = normalize_or(normal + uniform_sphere(xi.xy), normal);
    let cosine = dot(normal, wide);
    let raw = wide * spread + normal * (safe_sqrt(1.0 - spread * spread * (1.0 - cosine * cosine)) - spread * cosine);
    return LobeSample(select(raw, reflected_at_plane(raw, surface.normal), dot(surface.normal, raw) < 0.0), 1.0);
}

fn base_refined(material: Material, surface: Surface, wi: vec3f, evaluated: vec2f) -> vec2f {
    let spread = base_spread(material, surface);
    if spread >= 1.0 {
        return evaluated;
    }
    let above = dot(surface.normal, wi);
    let leaning = dot(surface.frame.normal, wi);
    let folded = leaning - 2.0 * above * dot(surface.frame.normal, surface.normal);
    return vec2f(select(0.0, narrow_density(leaning, spread) + narrow_density(folded, spread), above > 0.0));
}

// The sine of the widest angle to which the base scatters: 1 but from within, behind the interface.
fn base_spread(material: Material, surface: Surface) -> f32 {
    return select(1.0, material_ior_ahead(material, true), is_within(material, surface) && material_has_base(material));
}

// The density of Lambert's lobe with its sines multiplied by spread.
fn narrow_density(cosine: f32, spread: f32) -> f32 {
    let square = spread * spread;
    return select(0.0, cosine * INV_PI / square, cosine > 0.0 && 1.0 - cosine * cosine < square * BASE_EDGE);
}
