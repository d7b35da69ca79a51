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
        let shares = select(energies.yz, vec2f(1.0, energies.w), is_reflected);
        let energy = select(shares.x, shares.y, is_within(material, surface));
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
    // Of the light that meets facets again a part leaves each time; those it meets at a slant reflect more.
    let leaves = sqrt(kept);
    let slant = 0.45 - 0.2 * view_cosine(surface);
    let mean = mix(head_on, terms.metal_tint, kept * leaves * slant);
    let gain = 1.0 + mean * leaves / (1.0 - mean * (1.0 - leaves)) * ((1.0 - kept) / kept);
    if !has_parts(terms) {
        return once * mix(WHITE, gain, terms.metalness);
    }
    let parts = fresnel_parts(terms, cosine);
    // The refracting share of a dielectric is clear; the rest lies over a base.
    let clear = mix(WHITE, interface_gain(material, surface, shape, true), material.transmission_weight) * parts.dielectric;
    return mix(clear, parts.metal * gain, terms.metalness);
}

fn kept_energies(material: Material, surface: Surface, shape: LobeShape, channel: u32) -> vec4f {
    let table = shape.table + channel * select(4u * ALBEDO_NODES, ROUGH_ALBEDO_LENGTH, has_rows(material));
    return rough_albedo_lookup(table, safe_sqrt(view_cosine(surface)), table_row(material, surface));
}
