// A layer of small fibres over everything else. Twin of src/optics/layer/fuzz.rs.
#import "optics/layer/registry"

fn fuzz_is_there(material: Material, surface: Surface) -> bool {
    return PLAN_FUZZ && material.fuzz_weight > 0.0 && !is_within(material, surface);
}

fn fuzz_albedo(material: Material, surface: Surface) -> LayerAlbedo {
    let share = material.fuzz_weight * fuzz_reflectance(material, dot(fuzz_normal(material, surface), surface.wo));
    return LayerAlbedo(material.fuzz_color * share, vec3f(1.0 - share));
}

fn fuzz_refined_sample(material: Material, surface: Surface, xi: vec3f) -> LobeSample {
    let frame = fuzz_frame(material, surface);
    let bent_by = fuzz_matrix(material, dot(frame.normal, surface.wo));
    let cosine = local_from_world(frame, normalize_or(frame.normal + uniform_sphere(xi.xy), frame.normal));
    let bent = vec3f((cosine.x - bent_by.y * cosine.z) / bent_by.x, cosine.y / bent_by.x, cosine.z);
    let raw = world_from_local(frame, normalize_or(bent, UPWARDS));
    return LobeSample(select(raw, reflected_at_plane(raw, surface.normal), dot(surface.normal, raw) < 0.0), 1.0);
}

fn fuzz_refined(material: Material, surface: Surface, wi: vec3f) -> vec2f {
    let frame = fuzz_frame(material, surface);
    let bent_by = fuzz_matrix(material, dot(frame.normal, surface.wo));
    let folded = local_from_world(frame, reflected_at_plane(wi, surface.normal));
    let both = fuzz_density(bent_by, local_from_world(frame, wi)) + fuzz_density(bent_by, folded);
    return vec2f(select(0.0, both, dot(surface.normal, wi) > 0.0));
}

// Between the coat's and that of what lies below, by the coat's weight.
fn fuzz_normal(material: Material, surface: Surface) -> vec3f {
    let normal = surface.frame.normal;
    if !PLAN_COAT || material.coat_weight == 0.0 {
        return normal;
    }
    return normalize_or(mix(normal, surface.coat_normal, material.coat_weight), normal);
}

// The frame with the view in the half plane of the tangent.
fn fuzz_frame(material: Material, surface: Surface) -> Frame {
    return frame_from_tangent(fuzz_normal(material, surface), surface.wo, 0.0);
}

// What the matrix stretches the tangent plane by, and what it adds of the height along the view.
fn fuzz_matrix(material: Material, cosine: f32) -> vec2f {
    let x = saturate(cosine);
    let y = material.fuzz_roughness;
    let stretch = (2.58126 * x + 0.813703 * y) * y / (1.0 + 0.310327 * x * x + 2.60994 * x * y);
    let divisor = 0.0000254053 + 1.71228 * x - 1.71506 * x * y + 1.34174 * y;
    return vec2f(stretch, safe_sqrt(1.0 - x) * (y - 1.0) * y * y * y / divisor);
}

fn fuzz_density(bent_by: vec2f, wi: vec3f) -> f32 {
    let straight = vec3f(bent_by.x * wi.x + bent_by.y * wi.z, bent_by.x * wi.y, wi.z);
    let ratio = bent_by.x / dot(straight, straight);
    return max(wi.z, 0.0) * INV_PI * ratio * ratio;
}

fn fuzz_reflectance(material: Material, cosine: f32) -> f32 {
    let y = material.fuzz_roughness;
    let middle = y * (-0.193854 + y * (-1.14885 + y * (1.7932 - 0.95943 * y * y))) / (0.046391 + y);
    let width = y * (0.0206607 + 1.58491 * y) / (0.0379424 + y * (1.32227 + y));
    let floor_y = y * (0.000654023 + (-0.0207818 + 0.119681 * y) * y) / (1.26264 + y * (-1.92021 + y));
    let off = (saturate(cosine) - middle) / width;
    return saturate(exp(-0.5 * off * off) / (width * sqrt(2.0 * PI)) + floor_y);
}
