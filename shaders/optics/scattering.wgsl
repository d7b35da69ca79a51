// Multiple scattering between facets. Twin of src/optics/scattering.rs.
#import "optics/albedo"
#import "optics/material"

fn compensates(material: Material) -> bool {
    return PLAN_MULTIPLE_SCATTERING && has_flag(material, COMPENSATES);
}

// `number` of the table: 1 and 2 are refracted from outside and within, 3 is reflected.
fn interface_kept(material: Material, surface: Surface, number: u32) -> vec3f {
    var kept = WHITE;
    if compensates(material) {
        // A film shares the light otherwise in each channel.
        for (var channel = 0u; channel < select(1u, 3u, PLAN_THIN_FILM && material.has_film == 1u); channel++) {
            kept = select(
                kept, vec3f(kept_energy_of(material, surface, channel, number)), vec3u(0u, 1u, 2u) >= vec3u(channel),
            );
        }
    }
    return kept;
}

fn scatters_within(material: Material, surface: Surface) -> bool {
    return compensates(material) && is_within(material, surface);
}

fn scattered_within(material: Material, surface: Surface) -> vec3f {
    return max(1.0 - 2.0 * interface_kept(material, surface, 3u), vec3f()) * f32(scatters_within(material, surface));
}

fn scattered_again(material: Material, surface: Surface, terms: FresnelTerms, cosine: f32, once: vec3f) -> vec3f {
    if !compensates(material) {
        return once;
    }
    let kept = kept_energy_of(material, surface, 0u, 0u);
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
        clear = 1.0 / max(interface_kept(material, surface, 3u), vec3f(0.5));
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

fn kept_cosine(material: Material, surface: Surface) -> f32 {
    if !PLAN_ANISOTROPY || is_over_azimuth(material) || material.anisotropy == 0.0 {
        return view_cosine(surface);
    }
    let stretch = stretch_from_anisotropy(material.anisotropy);
    let widths = vec3f(stretch, 1.0 / stretch, 0.5 * stretch + 0.5 / stretch);
    return normalize(local_from_world(surface.frame, surface.wo) * widths).z;
}

fn kept_energy_of(material: Material, surface: Surface, channel: u32, number: u32) -> f32 {
    let table = material.lobe_table + channel * select(4u * ALBEDO_NODES, ROUGH_ALBEDO_LENGTH, has_rows(material));
    return rough_albedo_lookup(table, safe_sqrt(kept_cosine(material, surface)), table_row(material, surface))[number];
}
