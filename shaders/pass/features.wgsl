// What the camera sees first. Twin of src/cpu/features.rs and of trace_features in src/cpu/integrator.rs.
#import "optics/material"
#import "optics/random"
#import "scene/camera"
#import "scene/surface"

struct FeatureSample {
    albedo: vec3f,
    is_hit: f32,
    normal: vec3f,
    // Along the camera's axis, in the geometry's units.
    depth: f32,
}

fn trace_features(pixel: vec2u, sample: u32) -> FeatureSample {
    let state = random_state(pixel.x, pixel.y, globals.seed, sample, globals.sequence);
    var camera = globals.camera;
    camera.lens_radius = select(0.0, camera.lens_radius, PLAN_LENS == 1u);
    let ray = pixel_ray(camera, pixel, globals.image_size, state);
    let hit = trace(ray.origin, ray.direction, 1e30, false);
    if hit.triangle == NO_HIT {
        return FeatureSample(vec3f(0.0), 0.0, vec3f(0.0), 0.0);
    }
    let point = surface_at(hit, ray.direction);
    let albedo = material_albedo(materials[point.slot], point.surface);
    return FeatureSample(albedo, 1.0, point.surface.frame.normal, hit.t * dot(ray.direction, camera.forward));
}

// The path tracer's sums are empty meanwhile and lend their place.
@compute @workgroup_size(8, 8)
fn features(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= globals.tile_size) {
        return;
    }
    let pixel = globals.tile_origin + id.xy;
    let index = pixel.y * globals.image_size.x + pixel.x;
    for (var i = 0u; i < globals.sample_count; i++) {
        let seen = trace_features(pixel, globals.first_sample + i);
        color_sums[index] += vec4f(seen.albedo, seen.is_hit);
        statistics[index] += vec4f(seen.normal, seen.depth);
    }
}
