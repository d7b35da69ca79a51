// A thin film within which light interferes. Twin of src/optics/thin_film.rs.
#import "scene/constants"
#import "optics/fresnel"
#import "optics/refraction"

struct FilmTerms {
    weight: f32,
    ior: f32,
    behind: f32,
    path: vec3f,
}

fn film_change_of_dielectric(terms: FresnelTerms, cosine: f32) -> vec3f {
    if !(terms.metalness < 1.0) {
        return vec3f();
    }
    return -(min(terms.tint, WHITE) * film_passed(terms, cosine, -1.0)) * terms.weight;
}

fn film_change_of_metal(terms: FresnelTerms, cosine: f32) -> vec3f {
    if !(terms.metalness > 0.0) {
        return vec3f();
    }
    return film_on_metal(terms, max(cosine_in_coat(terms, cosine), LEAST_FILM_COSINE)) * terms.metal_tint;
}

fn cosine_in_coat(terms: FresnelTerms, cosine: f32) -> f32 {
    return select(cosine, safe_sqrt(refracted_square(cosine, terms.coat)) / terms.coat, terms.coat != 1.0);
}

// `height` is negative where it is not known.
fn film_passed(terms: FresnelTerms, from_normal: f32, height: f32) -> vec3f {
    let cosine = max(cosine_in_coat(terms, from_normal), LEAST_FILM_COSINE);
    let index = terms.film.behind;
    let beyond = select(height, safe_sqrt(refracted_square(cosine, index)), height < 0.0 || terms.coat != 1.0);
    let behind = vec4f(beyond, 0.0, beyond / (index * index), 0.0);
    let bare = entered_bare(cosine, behind);
    return (entered(terms.film, cosine, mat3x4f(behind, behind, behind)) - vec3f(bare)) * terms.film.weight;
}

fn film_on_conductor(terms: FresnelTerms, from_normal: f32, bare: vec3f) -> vec3f {
    let cosine = max(from_normal, LEAST_FILM_COSINE);
    var behind = mat3x4f();
    for (var channel = 0u; channel < 3u; channel++) {
        behind[channel] = admittances(cosine, terms.eta[channel], terms.k[channel]);
    }
    return mix(bare, max(1.0 - entered(terms.film, cosine, behind), vec3f()), terms.film.weight);
}

fn film_on_metal(terms: FresnelTerms, cosine: f32) -> vec3f {
    var behind = mat3x4f();
    var bare = vec3f();
    for (var channel = 0u; channel < 3u; channel++) {
        let index = index_of_colors(terms.metal_f0[channel], terms.edge_tint[channel]);
        behind[channel] = admittances(cosine, index.x, index.y);
        bare[channel] = max(entered_bare(cosine, behind[channel]), FILM_TINY);
    }
    let scale = entered(terms.film, cosine, behind) / bare;
    let reflected = fresnel_metal(terms.metal_f0, terms.edge_tint, cosine);
    let lost = 1.0 - reflected;
    return max((lost - lost * scale) * terms.film.weight + reflected, vec3f()) - reflected;
}

fn index_of_colors(f0: f32, edge: f32) -> vec2f {
    let r = min(f0, LARGEST_FILM_F0);
    let root = sqrt(r);
    let eta = edge * (1.0 - r) / (1.0 + r) + (1.0 - edge) * (1.0 + root) / (1.0 - root);
    return vec2f(eta, safe_sqrt(((eta + 1.0) * (eta + 1.0) * r - (eta - 1.0) * (eta - 1.0)) / (1.0 - r)));
}

// For both polarisations: perpendicular, then parallel, each real and imaginary.
fn admittances(cosine: f32, eta: f32, k: f32) -> vec4f {
    let x = refracted_square(cosine, eta) - k * k;
    let y = 2.0 * eta * k;
    // The root of x + iy, without cancellation.
    let leg = sqrt(0.5 * (sqrt(x * x + y * y) + abs(x)));
    let other = 0.5 * y / max(leg, FILM_TINY);
    let root = select(vec2f(leg, other), vec2f(other, leg), x < 0.0);
    // Over the squared index for the other polarisation.
    let square = (eta - k) * (eta + k);
    let size = eta * eta + k * k;
    let scale = 1.0 / max(size * size, FILM_TINY);
    return vec4f(root, max((root.x * square + root.y * y) * scale, 0.0), (root.y * square - root.x * y) * scale);
}

fn entered(film: FilmTerms, cosine: f32, behind: mat3x4f) -> vec3f {
    // Beyond the film's own critical angle it counts as one that light just grazes.
    let square = max(refracted_square(cosine, film.ior), 0.0);
    let height = sqrt(square);
    let index_square = film.ior * film.ior;
    var media = behind;
    var sum = vec3f();
    for (var channel = 0u; channel < 3u; channel++) {
        let path = film.path[channel];
        let phase = path * height;
        let circle = unit_circle(phase * (0.5 * INV_PI));
        let across = path * select(circle.y / max(phase, FILM_TINY), 1.0, phase < 1e-4);
        let squares = vec2f(square, square / (index_square * index_square));
        sum[channel] = entered_polarised(cosine, media[channel], squares, circle.x, vec2f(across, across * index_square));
    }
    return sum;
}

fn entered_bare(cosine: f32, behind: vec4f) -> f32 {
    return entered_polarised(cosine, behind, vec2f(), 1.0, vec2f());
}

// The mean of both polarisations, which are the components here.
fn entered_polarised(before: f32, behind: vec4f, film_square: vec2f, along: f32, across: vec2f) -> f32 {
    let x = (before + behind.xz) * along + before * behind.yw * across;
    let y = behind.yw * along - (before * behind.xz + film_square) * across;
    let entered = 4.0 * before * behind.xz / max(x * x + y * y, vec2f(FILM_TINY));
    return 0.5 * (entered.x + entered.y);
}

// The mean facet's cosine, and the lobe's albedo.
fn mean_facet(constant: f32, grazing: f32) -> vec2f {
    let energy = constant + grazing;
    return vec2f(1.0 - pow(clamp(grazing / max(energy, FILM_TINY), FILM_TINY, 1.0), 0.2), energy);
}
