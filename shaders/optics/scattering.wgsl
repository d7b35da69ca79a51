// Multiple scattering between facets. Twin of src/optics/scattering.rs.
#import "optics/albedo"
#import "optics/material"

fn compensates(material: Material) -> bool {
    return PLAN_MULTIPLE_SCATTERING && has_flag(material, COMPENSATES);
}

fn interface_gain(material: Material, surface: Surface, shape: LobeShape) -> vec3f {
    if !compensates(material) {
        return WHITE;
    }
    // A film shares the light otherwise in each channel.
    let has_channels = PLAN_THIN_FILM && material.has_film == 1u && material_transmits(material);
    var kept = vec3f();
    for (var channel = 0u; channel < select(1u, 3u, has_channels); channel++) {
        let energies = kept_energies(material, surface, shape, channel);
        let energy = select(energies.y, energies.z, is_within(material, surface));
        kept = select(kept, vec3f(energy), vec3u(0u, 1u, 2u) >= vec3u(channel));
    }
    return 1.0 / kept;
}

fn scattered_again(
    material: Material, surface: Surface, shape: LobeShape, terms: FresnelTerms, cosine: f32, once: vec3f,
) -> vec3f {
    if !compensates(material) {
        return once;
    }
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
    // The refracting share of a dielectric is clear; the rest lies over a base.
    let share = select(0.0, material.transmission_weight, material_transmits(material));
    let gain = 1.0 + (interface_gain(material, surface, shape) - WHITE) * share;
    return mix(parts.dielectric * gain, parts.metal * (1.0 + head_on * again), terms.metalness);
}

fn kept_energies(material: Material, surface: Surface, shape: LobeShape, channel: u32) -> vec3f {
    let place = safe_sqrt(dot(surface.frame.normal, surface.wo));
    let length = select(4u * ALBEDO_NODES, ROUGH_ALBEDO_LENGTH, has_rows(material));
    return rough_albedo_lookup(shape.table + channel * length, place, table_row(material, surface)).xyz;
}
