// The refracting lobe. Twin of src/optics/layer/transmission.rs.
#import "optics/layer/facet"
#import "optics/layer/registry"
#import "optics/scattering"

fn transmission_albedo(material: Material, surface: Surface, left: vec3f) -> vec3f {
    let left_by_metal = left * (1.0 - material.metalness);
    return material.transmission_tint * left_by_metal * material.transmission_weight;
}

fn transmission_toward(
    material: Material, layers: Layers, surface: Surface, shape: LobeShape, wi: vec3f,
) -> LayerToward {
    var toward = LayerToward(layers.transmission.albedo, layers.transmission.probability);
    if !refracts_at_facets(shape) {
        return toward;
    }
    let cosines = refracting_cosines(surface.wo, wi, shape.eta);
    toward.color = left_by_facet(material, surface, cosines);
    if shares_facets(material) {
        let reflected = luminance(fresnel(material_fresnel_terms(material, surface.is_inside), cosines.x));
        let share = 1.0 - mirrored_share(reflected, luminance(toward.color));
        toward.probability = (1.0 - layers.base.probability) * share;
    }
    toward.color *= interface_gain(material, surface, shape);
    return toward;
}
