// A thin film within which light interferes. Twin of src/optics/thin_film.rs.
#import "scene/constants"
#import "optics/fresnel"
#import "optics/refraction"

struct FilmTerms {
    weight: f32,
    ior: f32,
    behind: f32,
    path: vec3f,
    has_bands: bool,
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
    let within = max(cosine_in_coat(terms, cosine), LEAST_FILM_COSINE);
    let index = index_of_colors(terms.metal_f0, terms.edge_tint);
    let behind = admittances(within, index[0], index[1]);
    let scale = entered(terms, 1.0, within, behind) / max(entered(terms, 0.0, within, behind), vec3f(FILM_TINY));
    let reflected = fresnel_metal(terms.metal_f0, terms.edge_tint, within);
    let lost = 1.0 - reflected;
    return (saturate((lost - lost * scale) * terms.film.weight + reflected) - reflected) * terms.metal_tint;
}

fn cosine_in_coat(terms: FresnelTerms, cosine: f32) -> f32 {
    return select(cosine, safe_sqrt(refracted_square(cosine, terms.before)) / terms.before, terms.before != 1.0);
}

// `height` is negative where it is not known.
fn film_passed(terms: FresnelTerms, from_normal: f32, height: f32) -> vec3f {
    let cosine = max(cosine_in_coat(terms, from_normal), LEAST_FILM_COSINE);
    let index = terms.film.behind;
    let bent = safe_sqrt(refracted_square(cosine, index));
    let beyond = vec3f(select(height, bent, height < 0.0 || terms.before != 1.0));
    let behind = mat4x3f(beyond, vec3f(), beyond / (index * index), vec3f());
    return (entered(terms, 1.0, cosine, behind) - entered(terms, 0.0, cosine, behind)) * terms.film.weight;
}

fn film_on_conductor(terms: FresnelTerms, from_normal: f32, bare: vec3f) -> vec3f {
    let cosine = max(from_normal, LEAST_FILM_COSINE);
    let passed = entered(terms, 1.0, cosine, admittances(cosine, terms.eta, terms.k));
    return mix(bare, saturate(1.0 - passed), terms.film.weight);
}

// Eta and k of each channel.
fn index_of_colors(f0: vec3f, edge: vec3f) -> mat2x3f {
    let r = min(f0, vec3f(LARGEST_FILM_F0));
    let root = sqrt(r);
    let eta = edge * (1.0 - r) / (1.0 + r) + (1.0 - edge) * (1.0 + root) / (1.0 - root);
    return mat2x3f(eta, sqrt(max(((eta + 1.0) * (eta + 1.0) * r - (eta - 1.0) * (eta - 1.0)) / (1.0 - r), vec3f())));
}

// By channel: perpendicular, then parallel, each real and imaginary.
fn admittances(cosine: f32, eta: vec3f, k: vec3f) -> mat4x3f {
    let tiny = vec3f(FILM_TINY);
    let x = (eta - 1.0) * (eta + 1.0) + cosine * cosine - k * k;
    let y = 2.0 * eta * k;
    // The root of x + iy, without cancellation.
    let leg = sqrt(0.5 * (sqrt(x * x + y * y) + abs(x)));
    let other = 0.5 * y / max(leg, tiny);
    let re = select(leg, other, x < vec3f());
    let im = select(other, leg, x < vec3f());
    // Over the squared index for the other polarisation.
    let square = (eta - k) * (eta + k);
    let size = eta * eta + k * k;
    let scale = 1.0 / max(size * size, tiny);
    return mat4x3f(re, im, max((re * square + im * y) * scale, vec3f()), (im * square - re * y) * scale);
}

// The share of unpolarised light that enters the media behind a film, as thick as it is or of no thickness.
fn entered(terms: FresnelTerms, thickness: f32, cosine: f32, behind: mat4x3f) -> vec3f {
    // Beyond the film's own critical angle it counts as one that light just grazes.
    let film = terms.film;
    let path = film.path * thickness;
    let height_square = max(refracted_square(cosine, film.ior), 0.0);
    let phase = path * sqrt(height_square);
    let turns = phase * (0.5 * INV_PI);
    let circle = transpose(mat3x2f(unit_circle(turns.x), unit_circle(turns.y), unit_circle(turns.z)));
    let across = path * select(circle[1] / max(phase, vec3f(FILM_TINY)), WHITE, phase < vec3f(1e-4));
    var media = behind;
    var share = vec3f();
    // A loop over the polarisations.
    for (var i = 0u; i < 4u; i += 2u) {
        let re = media[i];
        let im = media[i + 1u];
        let scale = select(film.ior * film.ior, 1.0, i == 0u);
        let film_square = height_square / (scale * scale);
        let sum = cosine + re;
        let product = cosine * re + film_square;
        let far = cosine * im;
        let over = across * scale;
        let x = sum * circle[0] + far * over;
        let y = im * circle[0] - product * over;
        let square = x * x + y * y;
        var part = 2.0 * cosine * re / max(square, vec3f(FILM_TINY));
        if PLAN_FILM_BANDS && film.has_bands {
            // The mean of the square over all phases, and of the share's denominator.
            let level = 0.5 * (sum * sum + im * im + (product * product + far * far) / film_square);
            let mean = (sum * product + far * im) / sqrt(film_square);
            let damping = exp(max(phase - UNBANDED_PHASE, vec3f()) * (-2.0 * BAND_WIDTH));
            let fade = 1.0 - damping * damping;
            let lost = 1.0 - damping;
            let banded = (fade * level / mean + 2.0 - fade)
                / (2.0 * damping * square + lost * lost * level + fade * mean);
            part = select(part, 2.0 * cosine * re * banded, damping < WHITE);
        }
        share += part;
    }
    return share;
}

// The mean facet's cosine, and the lobe's albedo.
fn mean_facet(constant: f32, grazing: f32) -> vec2f {
    let energy = constant + grazing;
    return vec2f(1.0 - pow(clamp(grazing / max(energy, FILM_TINY), FILM_TINY, 1.0), 0.2), energy);
}
