// Multiple scattering between facets. Twin of src/optics/scattering.rs.
#import "optics/albedo"
#import "optics/material"

fn compensates(material: Material) -> bool {
    return PLAN_MULTIPLE_SCATTERING && has_flag(material, COMPENSATES);
}

fn interface_gain(material: Material, surface: Surface, shape: LobeShape) -> vec3f {
    if !compensates(material) {
        return vec3f(1.0);
    }
    let is_inside = is_within(material, surface);
    let first = kept_energies(material, surface, shape, 0u);
    var kept = vec3f(select(first.y, first.z, is_inside));
    if PLAN_THIN_FILM && material.has_film == 1u && material_transmits(material) {
        // A film shares the light otherwise in each channel.
        for (var channel = 1u; channel < 3u; channel++) {
            let other = kept_energies(material, surface, shape, channel);
            kept = select(kept, vec3f(select(other.y, other.z, is_inside)), vec3u(0u, 1u, 2u) == vec3u(channel));
        }
    }
    return 1.0 / kept;
}

fn scattered_again(
    material: Material, surface: Surface, shape: LobeShape, terms: FresnelTerms, cosine: f32, once: vec3f,
) -> vec3f {
    if compensates(material) {
        return compensated(material, surface, shape, terms, cosine);
    }
    return once;
}

fn compensated(
    material: Material, surface: Surface, shape: LobeShape, terms: FresnelTerms, cosine: f32,
) -> vec3f {
    let kept = kept_energies(material, surface, shape, 0u).x;
    let again = (1.0 - kept) / kept;
    if terms.model == FRESNEL_NONE || terms.model == FRESNEL_CONDUCTOR {
        let head_on = fresnel(terms, 1.0);
        return fresnel(terms, cosine) * (1.0 + head_on * (again * terms.metalness));
    }
    let parts = fresnel_parts(terms, cosine);
    var head_on = terms.metal_f0 * terms.metal_tint;
    if shows_film(terms) {
        head_on = fresnel_parts(terms, 1.0).metal;
    }
    let metal = parts.metal * (1.0 + head_on * again);
    // The refracting share of a dielectric is clear; the rest lies over a base.
    let share = select(0.0, material.transmission_weight, material_transmits(material));
    let gain = 1.0 + (interface_gain(material, surface, shape) - vec3f(1.0)) * share;
    return mix(parts.dielectric * gain, metal, terms.metalness);
}

fn kept_energies(material: Material, surface: Surface, shape: LobeShape, channel: u32) -> vec3f {
    let place = safe_sqrt(dot(surface.frame.normal, surface.wo));
    if has_rows(material) {
        return rough_albedo_lookup(shape.table + channel * ROUGH_ALBEDO_LENGTH, place, table_row(material, surface)).xyz;
    }
    return albedo_lookup(shape.table + channel * 4u * ALBEDO_NODES, place);
}
