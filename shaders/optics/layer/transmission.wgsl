// The refracting lobe. Twin of src/optics/layer/transmission.rs.
#import "scene/constants"
#import "optics/layer/facet"
#import "optics/layer/registry"
#import "optics/scattering"

fn transmission_albedo(material: Material, surface: Surface, left_by_specular: vec3f) -> vec3f {
    var left = left_by_specular;
    if !bends(material) {
        let gain = interface_gain(material, surface, material_shape(material));
        left = max(1.0 - (1.0 - left) * gain, vec3f());
    }
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
    let straight = toward.color;
    toward.color = left_by_facet(material, surface, cosines);
    if shares_facets(material) {
        let reflected = luminance(fresnel(material_fresnel_terms(material, surface.is_inside), cosines.x));
        let share = 1.0 - mirrored_share(reflected, luminance(toward.color));
        toward.probability = (1.0 - layers.base.probability) * share;
    }
    toward.color = select(straight, toward.color * interface_gain(material, surface, shape), bends(material));
    return toward;
}

fn transmission_estimate(material: Material, layers: Layers) -> f32 {
    let mean = luminance(layers.transmission.albedo);
    let is_apart = material_transmits(material) && material.transmission_roughness != material.roughness;
    return select(mean, max(mean, APART_LEAST), is_apart);
}
