// The geometric lobe and its density. Twin of src/optics/lobe/geometric.rs, which explains the mathematics.
#import "optics/chord"
#import "optics/lobe/lobe"

fn geometric_widths(shape: LobeShape) -> vec3f {
    let stretch = stretch_from_anisotropy(shape.anisotropy);
    return vec3f(shape.roughness * stretch, shape.roughness / stretch, shape.roughness);
}

fn geometric_sample(shape: LobeShape, frame: Frame, wo: vec3f, xi: vec3f) -> vec3f {
    let mirror = mirrored_about(wo, frame.normal);
    let ball = uniform_sphere(xi.xy) + frame.normal * shape.roughness;
    let distance = curve_distance(shape.curve, shape.table, xi.z);
    var spread = ball * shape.roughness;
    if shape.anisotropy != 0.0 {
        spread = world_from_local(frame, local_from_world(frame, ball) * geometric_widths(shape));
    }
    // R = 1 with D = 0 or V = -n leaves nothing to normalise: any direction is right for a set of measure zero.
    return normalize_or(mirror * (1.0 - shape.roughness) + spread * distance, frame.normal);
}

fn geometric_density(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    // The density is called at one place, stretched or not: drivers inline it.
    var normal = frame.normal;
    var mirror = mirrored_about(wo, frame.normal);
    var light = wi;
    var stretch = 1.0 / shape.roughness;
    var factor = 1.0;
    if shape.anisotropy != 0.0 {
        // The density of the ball's directions, in coordinates in which it is a ball.
        let width = geometric_widths(shape);
        mirror = local_from_world(frame, mirror) / width;
        light = local_from_world(frame, wi) / width;
        stretch = length(mirror);
        let light_length = length(light);
        mirror /= stretch;
        light /= light_length;
        normal = UPWARDS;
        factor = 1.0 / (width.x * width.y * width.z * light_length * light_length * light_length);
    }
    let density = chord_density(shape.curve, shape.table, shape.roughness, stretch, normal, mirror, light) * factor;
    // A stretched mirror has none: there the widths and the lengths measured in them are 0 and infinite.
    return select(0.0, density, shape.anisotropy == 0.0 || shape.roughness > 0.0);
}

fn geometric_weight(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    return 1.0;
}
