// The refracting lobe. Twin of src/optics/layer/transmission.rs.
#import "scene/constants"
#import "optics/layer/facet"
#import "optics/layer/registry"
#import "optics/scattering"

fn transmission_albedo(material: Material, left_by_specular: vec3f) -> vec3f {
    return material.transmission_tint * (left_by_specular * (1.0 - material.metalness)) * material.transmission_weight;
}

fn transmission_toward(
    material: Material, layers: Layers, surface: Surface, shape: LobeShape, wi: vec3f,
) -> LayerToward {
    var toward = LayerToward(layers.transmission.albedo, layers.transmission.probability);
    if !refracts_at_facets(shape) {
        return toward;
    }
    let cosines = refracting_cosines(surface.wo, wi, shape.eta);
    let left = left_by_facet(material, surface, cosines);
    if shares_facets(material) {
        let reflected = luminance(fresnel(material_fresnel_terms(material, surface.is_inside), cosines.x));
        toward.probability = (1.0 - layers.base.probability) * (1.0 - mirrored_share(reflected, luminance(left)));
    }
    if bends(material) {
        toward.color = left / interface_kept(material, surface, 1u + u32(is_within(material, surface)));
    }
    return toward;
}

fn transmission_estimate(material: Material, layers: Layers) -> f32 {
    let is_apart = material_transmits(material) && material.transmission_roughness != material.roughness;
    return max(luminance(layers.transmission.albedo), select(0.0, APART_LEAST, is_apart));
}
