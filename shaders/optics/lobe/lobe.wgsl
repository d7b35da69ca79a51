// Common part of the lobes, and the horizon policy. Twin of src/optics/lobe/mod.rs. raw_sample, raw_density, raw_weight, the
// lobes' properties and LOBE_* are generated from the registry.
#import "optics/lobe/registry"
#import "optics/microfacet"
#import "optics/refraction"

const FACETS_NONE = 0u;
const FACETS_VISIBLE = 1u;
const FACETS_ALL = 2u;

struct LobeShape {
    lobe: u32,
    curve: u32,
    horizon: u32,
    // Index of the custom curve in `tables`.
    table: u32,
    roughness: f32,
    anisotropy: f32,
    // 0: reflects. Else refracts: index behind the surface over index before it.
    eta: f32,
}

struct LobeSample {
    wi: vec3f,
    weight: f32,
}

fn alpha_from_roughness(roughness: f32) -> f32 {
    return max(roughness * roughness, ALPHA_MIN);
}

fn stretch_from_anisotropy(anisotropy: f32) -> f32 {
    let s = 0.9 * clamp(anisotropy, -1.0, 1.0);
    return sqrt((1.0 + s) / (1.0 - s));
}

fn microfacet_alpha(shape: LobeShape) -> vec2f {
    let alpha = alpha_from_roughness(shape.roughness);
    let stretch = stretch_from_anisotropy(shape.anisotropy);
    return vec2f(alpha * stretch, alpha / stretch);
}

fn isotropic_alpha(shape: LobeShape) -> vec2f {
    return vec2f(alpha_from_roughness(shape.roughness));
}

// The roughness at which a lobe whose width goes with it is as wide as facets make it that turn the light by this share.
fn refracting_roughness_of(roughness: f32, share: f32) -> f32 {
    let square = roughness * roughness;
    let turn = share * (3.0 * roughness + 3.2 * square + 2.2 * square * square);
    return 2.0 * turn / (3.0 + sqrt(9.0 + 16.0 * turn));
}

fn refracting_roughness(lobe: u32, roughness: f32, eta: f32) -> f32 {
    return min(refracting_roughness_by(lobe, roughness, 0.5 * abs(1.0 - 1.0 / eta)), 1.0);
}

fn is_mirror(shape: LobeShape) -> bool {
    var width = lobe_width(shape.lobe, shape.roughness);
    if refracts_at_facets(shape) {
        width *= abs(1.0 - 1.0 / shape.eta);
    } else if shape.eta != 0.0 {
        width = lobe_width(shape.lobe, refracting_roughness(shape.lobe, shape.roughness, shape.eta));
    }
    return width < MIRROR_WIDTH;
}

fn refracts_at_facets(shape: LobeShape) -> bool {
    return shape.eta != 0.0 && facets(shape.lobe) != FACETS_NONE;
}

fn facet_weight(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f, mirrored: vec3f) -> f32 {
    var alpha = isotropic_alpha(shape);
    if is_anisotropic(shape.lobe) { alpha = microfacet_alpha(shape); }
    let wo_local = local_from_world(frame, wo);
    let wi_local = local_from_world(frame, wi);
    var weight = smith_g1_over_cosine(alpha, wi_local) * abs(wi_local.z);
    if facets(shape.lobe) == FACETS_ALL {
        // Of the mirror direction, as in the density: otherwise facets near the horizon differ by the rounding of their height.
        let of_mirrored = facet(frame, wo, mirrored);
        let ratio = of_mirrored.cosine / max(of_mirrored.h.z, 1e-6);
        // Normals on the far side of the facets are drawn too; the viewer sees none of them.
        weight *= smith_g1_over_cosine(alpha, wo_local) * select(0.0, ratio, of_mirrored.h.z > 0.0);
    }
    // What nothing bends meets no facet.
    weight = select(weight, 1.0, shape.eta == 1.0);
    return select(0.0, weight, wi_local.z < 0.0 && wo_local.z > 0.0);
}

struct LobeView {
    frame: Frame,
    normal: vec3f,
    wo: vec3f,
    // The lobe that the reflection shows.
    seen: LobeShape,
}

fn lobe_view(shape: LobeShape, frame: Frame, surface_normal: vec3f, wo: vec3f) -> LobeView {
    var view = LobeView(frame, surface_normal, wo, shape);
    if refracts_at_facets(shape) {
        view.normal = -surface_normal;
    } else if shape.eta != 0.0 {
        let behind = refracted(wo, frame.normal, shape.eta);
        if !behind.is_total {
            let turned = Frame(frame.tangent, -frame.bitangent, -frame.normal);
            view = LobeView(turned, -surface_normal, mirrored_about(behind.wi, frame.normal), shape);
            view.seen.roughness = refracting_roughness(shape.lobe, shape.roughness, shape.eta);
        }
    }
    return view;
}

fn lobe_sample(shape: LobeShape, frame: Frame, surface_normal: vec3f, wo: vec3f, xi: vec3f) -> LobeSample {
    let view = lobe_view(shape, frame, surface_normal, wo);
    var raw = raw_sample(view.seen, view.frame, view.wo, xi);
    var weight = 0.0;
    if refracts_at_facets(shape) {
        let behind = facet_refracted(wo, raw, shape.eta);
        raw = behind.wi;
        weight = facet_weight(shape, frame, wo, raw, facet_mirror(frame, wo, raw, shape.eta));
        weight = select(weight, 0.0, behind.is_total);
    } else {
        weight = raw_weight(view.seen, view.frame, view.wo, raw);
        if is_hemispherical(shape.lobe) {
            weight = select(0.0, weight, dot(view.frame.normal, raw) > 0.0);
        }
    }
    let below = dot(view.normal, raw) < 0.0;
    if below && shape.horizon == HORIZON_ABSORB {
        weight = 0.0;
    }
    if below && shape.horizon == HORIZON_MIRROR && weight > 0.0 {
        raw = reflected_at_plane(raw, view.normal);
    }
    return LobeSample(raw, weight);
}

// (evaluate, density), the cosine included.
fn lobe_evaluate(shape: LobeShape, frame: Frame, surface_normal: vec3f, wo: vec3f, wi: vec3f) -> vec2f {
    let view = lobe_view(shape, frame, surface_normal, wo);
    if shape.horizon != HORIZON_NONE && !(dot(view.normal, wi) > 0.0) {
        return vec2f();
    }
    // A loop, so that the lobes' code is there once: drivers inline, and compile in more than proportion to the size.
    var result = vec2f();
    var direction = wi;
    for (var i = 0u; i < select(1u, 2u, shape.horizon == HORIZON_MIRROR); i++) {
        result += raw_evaluate(shape, view, direction);
        direction = reflected_at_plane(wi, view.normal);
    }
    return result;
}

fn raw_evaluate(shape: LobeShape, view: LobeView, wi: vec3f) -> vec2f {
    // Facets have the density of the direction that they mirror to.
    var mirrored = wi;
    var factor = 1.0;
    let at_facets = refracts_at_facets(shape);
    if at_facets {
        mirrored = facet_mirror(view.frame, view.wo, wi, shape.eta);
        factor = facet_density_factor(view.frame, view.wo, wi, shape.eta, refracting_normal(view.wo, wi, shape.eta));
        if !(factor > 0.0) {
            return vec2f();
        }
    } else if is_hemispherical(shape.lobe) && dot(view.frame.normal, wi) <= 0.0 {
        return vec2f();
    }
    let density = raw_density(view.seen, view.frame, view.wo, mirrored) * factor;
    if at_facets {
        return vec2f(density * facet_weight(shape, view.frame, view.wo, wi, mirrored), density);
    }
    return vec2f(density * raw_weight(view.seen, view.frame, view.wo, wi), density);
}
