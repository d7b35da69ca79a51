// The Fresnel factor at the half vector. Twin of src/optics/fresnel.rs.
#import "optics/choices"
#import "optics/thin_film"
#import "scene/plan"

struct FresnelTerms {
    model: u32,
    metal_f0: vec3f,
    metalness: f32,
    edge_tint: vec3f,
    tint: vec3f,
    metal_tint: vec3f,
    weight: f32,
    ior: f32,
    eta: vec3f,
    k: vec3f,
    before: f32,
    has_film: bool,
    film: FilmTerms,
}

fn untinted(terms: FresnelTerms) -> FresnelTerms {
    var without = terms;
    if terms.model == FRESNEL_DIELECTRIC {
        without.tint = WHITE;
    }
    return without;
}

fn of_dielectric(terms: FresnelTerms) -> FresnelTerms {
    var without = terms;
    without.metalness = 0.0;
    return without;
}

fn shows_film(terms: FresnelTerms) -> bool {
    return PLAN_THIN_FILM && terms.has_film;
}

fn fresnel(terms: FresnelTerms, cosine: f32) -> vec3f {
    if terms.model == FRESNEL_NONE {
        return terms.weight * terms.tint;
    }
    if has_parts(terms) {
        let parts = fresnel_parts(terms, cosine);
        return mix(parts.dielectric, parts.metal, terms.metalness);
    }
    let within = cosine_in_coat(terms, cosine);
    var channels = vec3f(
        fresnel_conductor(within, terms.eta.x, terms.k.x),
        fresnel_conductor(within, terms.eta.y, terms.k.y),
        fresnel_conductor(within, terms.eta.z, terms.k.z),
    );
    if shows_film(terms) {
        channels = film_on_conductor(terms, within, channels);
    }
    return terms.weight * terms.tint * channels;
}

// Whether a dielectric and a metal are mixed.
fn has_parts(terms: FresnelTerms) -> bool {
    return terms.model == FRESNEL_SCHLICK || terms.model == FRESNEL_DIELECTRIC;
}

struct FresnelParts {
    dielectric: vec3f,
    metal: vec3f,
}

fn fresnel_parts(terms: FresnelTerms, cosine: f32) -> FresnelParts {
    var dielectric = terms.tint * fresnel_dielectric(cosine, terms.ior);
    if terms.model == FRESNEL_SCHLICK {
        dielectric = fresnel_schlick(terms.tint * fresnel_f0(terms.ior), cosine);
    }
    var parts = FresnelParts(
        terms.weight * dielectric, fresnel_metal(terms.metal_f0, terms.edge_tint, cosine) * terms.metal_tint,
    );
    if shows_film(terms) {
        parts.dielectric = saturate(parts.dielectric + film_change_of_dielectric(terms, cosine));
        parts.metal = saturate(parts.metal + film_change_of_metal(terms, cosine));
    }
    return parts;
}

fn half_vector_cosine(wo: vec3f, wi: vec3f) -> f32 {
    return min(0.5 * length(wo + wi), 1.0);
}

fn fresnel_f0(ior: f32) -> f32 {
    let ratio = (ior - 1.0) / (ior + 1.0);
    return ratio * ratio;
}

fn fresnel_schlick(f0: vec3f, cosine: f32) -> vec3f {
    let x = saturate(1.0 - cosine);
    let x2 = x * x;
    return f0 + (1.0 - f0) * (x2 * x2 * x);
}

fn fresnel_metal(f0: vec3f, edge_tint: vec3f, cosine: f32) -> vec3f {
    if !PLAN_EDGE_TINT {
        return fresnel_schlick(f0, cosine);
    }
    return max(fresnel_schlick(f0, cosine) - edge_darkening(f0, edge_tint) * edge_shape(cosine), vec3f());
}

fn edge_darkening(f0: vec3f, edge_tint: vec3f) -> vec3f {
    let seventh = 1.0 / 7.0;
    return fresnel_schlick(f0, seventh) * (1.0 - edge_tint) * (1.0 / edge_shape(seventh));
}

fn edge_shape(cosine: f32) -> f32 {
    let c = saturate(cosine);
    let x = 1.0 - c;
    let x2 = x * x;
    return c * x2 * x2 * x2;
}

fn fresnel_dielectric(cosine: f32, ior: f32) -> f32 {
    let c = saturate(cosine);
    // ior^2 cos^2 of the refracted angle, not negative unless the reflection is total.
    let square = refracted_square(c, ior);
    let g = safe_sqrt(square);
    let perpendicular = (c - g) / max(c + g, 1e-12);
    let parallel = (ior * ior * c - g) / max(ior * ior * c + g, 1e-12);
    return select(0.5 * (perpendicular * perpendicular + parallel * parallel), 1.0, square < 0.0);
}

fn fresnel_left(terms: FresnelTerms, cosine: f32, behind: f32) -> vec3f {
    var left = vec3f(fresnel_transmitted(cosine, behind, terms.ior));
    if shows_film(terms) {
        left += film_passed(terms, cosine, terms.ior * behind);
    }
    return max(1.0 - terms.weight + left * terms.weight, vec3f());
}

fn fresnel_transmitted(cosine: f32, behind: f32, ior: f32) -> f32 {
    return 0.5 * (fresnel_passed(cosine, ior * behind) + fresnel_passed(ior * cosine, behind));
}

// 1 - ((a - b)/(a + b))^2.
fn fresnel_passed(a: f32, b: f32) -> f32 {
    let sum = max(a + b, 1e-12);
    return 4.0 * (a / sum) * (b / sum);
}

fn fresnel_conductor(cosine: f32, eta: f32, k: f32) -> f32 {
    let c = saturate(cosine);
    let cos2 = c * c;
    let sin2 = (1.0 - c) * (1.0 + c);
    // (a + ib)^2 = t0 + iu, so written that nothing cancels, neither at grazing for eta near 1 nor head-on for eta near 0;
    // its size without the squares, which would overflow.
    let t0 = select(eta * eta - sin2, refracted_square(c, eta), cos2 < 0.5) - k * k;
    let u = 2.0 * eta * k;
    let largest = max(max(abs(t0), u), 1e-30);
    let scaled = vec2f(t0, u) / largest;
    let a2_plus_b2 = largest * sqrt(dot(scaled, scaled));
    let leg = sqrt(0.5 * (a2_plus_b2 + abs(t0)));
    let t1 = a2_plus_b2 + cos2;
    let t2 = 2.0 * select(leg, 0.5 * u / max(leg, 1e-30), t0 < 0.0) * c;
    let perpendicular = (t1 - t2) / max(t1 + t2, 1e-37);
    let t3 = cos2 * a2_plus_b2 + sin2 * sin2;
    let t4 = t2 * sin2;
    // Head-on both may be 0; there both polarisations are alike.
    let parallel = perpendicular * select((t3 - t4) / max(t3 + t4, 1e-37), 1.0, t3 + t4 < 1e-37);
    return saturate(0.5 * (perpendicular + parallel));
}
