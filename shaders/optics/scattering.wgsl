// Multiple scattering between facets. Twin of src/optics/scattering.rs.
#import "optics/albedo"
#import "optics/material"

fn compensates(material: Material) -> bool {
    return PLAN_MULTIPLE_SCATTERING && has_flag(material, COMPENSATES);
}

fn interface_gain(material: Material, surface: Surface, shape: LobeShape, is_reflected: bool) -> vec3f {
    if !compensates(material) {
        return WHITE;
    }
    // A film shares the light otherwise in each channel.
    let has_channels = PLAN_THIN_FILM && material.has_film == 1u && material_transmits(material);
    var kept = vec3f();
    for (var channel = 0u; channel < select(1u, 3u, has_channels); channel++) {
        let energies = kept_energies(material, surface, shape, channel);
        let refracted = select(energies.y, energies.z, is_within(material, surface));
        let energy = select(refracted, energies.w, is_reflected);
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
    var head_on = terms.metal_f0 * terms.metal_tint;
    if !has_parts(terms) {
        head_on = fresnel(terms, 1.0);
    } else if shows_film(terms) {
        head_on = fresnel_parts(terms, 1.0).metal;
    }
    let gain = facet_gain(head_on, terms.metal_tint, kept, view_cosine(surface));
    if !has_parts(terms) {
        return once * mix(WHITE, gain, terms.metalness);
    }
    let parts = fresnel_parts(terms, cosine);
    // The refracting share of a dielectric is clear; the rest lies over a base. An index of 1 lets all else go straight on.
    var clear = facet_gain(vec3f(fresnel_f0(terms.ior)), WHITE, kept, view_cosine(surface));
    if is_within(material, surface) {
        clear = interface_gain(material, surface, shape, true);
    }
    let dielectric = parts.dielectric * mix(WHITE, clear, material.transmission_weight * f32(material.ior != 1.0));
    return mix(dielectric, parts.metal * gain, terms.metalness);
}

fn facet_gain(head_on: vec3f, grazing: vec3f, kept: f32, cosine: f32) -> vec3f {
    let leaves = sqrt(kept);
    // A tint may be above 1.
    let mean = min(mix(head_on, grazing, kept * leaves * (0.45 - 0.2 * cosine)), WHITE);
    return 1.0 + mean * leaves / (1.0 - mean * (1.0 - leaves)) * ((1.0 - kept) / kept);
}

fn kept_energies(material: Material, surface: Surface, shape: LobeShape, channel: u32) -> vec4f {
    let table = shape.table + channel * select(4u * ALBEDO_NODES, ROUGH_ALBEDO_LENGTH, has_rows(material));
    return rough_albedo_lookup(table, safe_sqrt(view_cosine(surface)), table_row(material, surface));
}
