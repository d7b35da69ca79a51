// The medium of a coat that absorbs by the length of the way through it. Twin of src/optics/coat_medium.rs.
#import "optics/material"

fn way_length(material: Material, cosine: f32) -> f32 {
    return 1.0 / max(safe_sqrt(refracted_square(cosine, material.coat_ior)) / material.coat_ior, WAY_COSINE_MIN);
}

// The coat's colour, that of a way in and out at right angles, over a way of this length.
fn color_over(material: Material, way: f32) -> vec3f {
    return pow(max(material.coat_color, vec3f(COLOR_MIN)), vec3f(0.5 * way));
}

// What such a coat leaves of the light that a surface emits at this cosine to its normal.
fn coat_over_emission(material: Material, cosine: f32, is_back: bool) -> vec3f {
    if !has_flag(material, COAT_ABSORBS) || (is_back && material_transmits(material)) {
        return WHITE;
    }
    return mix(WHITE, color_over(material, way_length(material, abs(cosine))), material.coat_weight);
}
