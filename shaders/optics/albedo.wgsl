// The share of light that a lobe reflects of each view. Twin of src/optics/albedo.rs.
#import "optics/lobe/lobe"
#import "optics/thin_film"
#import "scene/layout"

// The node, and how far the value is beyond it.
fn node_below(value: f32, nodes: u32) -> vec2f {
    let last = f32(nodes) - 1.0;
    let position = saturate(value) * last;
    let low = min(floor(position), last - 1.0);
    return vec2f(low, position - low);
}

fn azimuth_place(anisotropy: f32, frame: Frame, wo: vec3f) -> f32 {
    let stretch = stretch_from_anisotropy(anisotropy);
    let along = local_from_world(frame, wo).xy;
    let width = length(along * vec2f(stretch, 1.0 / stretch)) / max(length(along), 1e-15);
    let most = max(stretch, 1.0 / stretch);
    return (width - 1.0 / most) / max(most - 1.0 / most, 1e-6);
}

fn albedo_place(cosine: f32, eta: f32) -> f32 {
    let critical = safe_sqrt(-refracted_square(0.0, eta));
    let share = f32(TOTAL_NODES) / (f32(ALBEDO_NODES) - 1.0);
    if !(critical > 0.0) {
        return cosine;
    }
    let square = refracted_square(cosine, eta);
    let above = share + (1.0 - share) * (safe_sqrt(square) / eta);
    let below = share * (max(cosine, 0.0) / critical);
    return select(above, below, square < 0.0);
}

fn table_lookup(table: u32, nodes: u32, place: f32) -> f32 {
    let below = node_below(place, nodes);
    let low = u32(below.x);
    let left = table_number(table, low);
    return left + (table_number(table, low + 1u) - left) * below.y;
}

// A table over the view alone is read at roughness 0.
fn rough_albedo_lookup(albedo_table: u32, place: f32, roughness: f32) -> vec4f {
    let step = node_below(roughness, ROUGHNESS_NODES);
    let below = node_below(place, ALBEDO_NODES);
    let first = u32(step.x) * ALBEDO_NODES + u32(below.x);
    // A loop over the rows that have weight. Between equal numbers it is exact: total reflection leaves nothing.
    var found = vec4f();
    for (var row = 0u; row < select(1u, 2u, step.y > 0.0); row++) {
        let left = table_numbers(albedo_table, first + ALBEDO_NODES * row);
        let along = left + (table_numbers(albedo_table, first + ALBEDO_NODES * row + 1u) - left) * below.y;
        found += (along - found) * select(step.y, 1.0, row == 0u);
    }
    return found;
}

// `film` is what the film changes of the dielectric, untinted; its last number is 1 where that is known.
fn rough_albedo(terms: FresnelTerms, integrals: vec4f, film: vec4f) -> vec3f {
    if !has_parts(terms) {
        return terms.weight * terms.tint * integrals.xyz;
    }
    var dielectric = terms.tint * integrals.x;
    if terms.model == FRESNEL_SCHLICK {
        dielectric = terms.tint * (fresnel_f0(terms.ior) * integrals.y) + integrals.z;
    }
    var metal = terms.metal_f0 * integrals.y + integrals.z;
    if PLAN_EDGE_TINT {
        metal = max(metal - edge_darkening(terms.metal_f0, terms.edge_tint) * integrals.w, vec3f());
    }
    dielectric *= terms.weight;
    metal *= terms.metal_tint;
    if shows_film(terms) {
        // No table has every thickness or metal: the lobe counts as its mean facet.
        let facet = mean_facet(integrals.y, integrals.z);
        var change = film.xyz * min(terms.tint, WHITE) * terms.weight;
        if film.w == 0.0 {
            change = film_change_of_dielectric(terms, facet.x) * facet.y;
        }
        dielectric = max(dielectric + change, vec3f());
        metal = max(metal + film_change_of_metal(terms, facet.x) * facet.y, vec3f());
    }
    return mix(dielectric, metal, terms.metalness);
}
