// The density with which a material draws a direction. Twin of src/optics/layer/density.rs.
#import "optics/layer/registry"

fn material_density(material: Material, surface: Surface, layers: Layers, wi: vec3f) -> f32 {
    var density = 0.0;
    for (var place = 0u; place < countOneBits(planned_layers()); place++) {
        let layer = planned_layer(place);
        let lobe = layer_lobe(layer, material, layers, surface);
        if !lobe.is_there || is_mirror(lobe.shape) {
            continue;
        }
        let toward = layer_toward(layer, material, layers, surface, lobe.shape, wi);
        density += lobe.share.reached * toward.probability * layer_refined(layer, material, surface, lobe, wi).y;
    }
    return density;
}
