// What the camera sees first. Twin of src/cpu/features.rs and of trace_features in src/cpu/integrator.rs.
#import "optics/material"
#import "optics/random"
#import "scene/camera"
#import "scene/surface"
#import "scene/visibility"

struct FeatureSample {
    albedo: vec3f,
    is_hit: f32,
    normal: vec3f,
    // Along the camera's axis, in the geometry's units.
    depth: f32,
}

fn trace_features(pixel: vec2u, sample: u32) -> FeatureSample {
    let state = path_state(pixel.x, pixel.y, globals.seed, sample, globals.sequence);
    var camera = globals.camera;
    camera.lens_radius = select(0.0, camera.lens_radius, PLAN_LENS == 1u);
    let ray = pixel_ray(camera, pixel, globals.image_size, state);
    var rays = 0u;
    let hit = stop(ray, state, 0u, &rays);
    if hit.triangle == NO_HIT {
        return FeatureSample(vec3f(0.0), 0.0, vec3f(0.0), 0.0);
    }
    let point = surface_at(hit, ray.direction);
    let material = textured_material(materials[point.slot], point.uvs, point.vertex_color);
    let albedo = material_albedo(material, point.surface);
    return FeatureSample(albedo, 1.0, point.surface.frame.normal, hit.t * dot(ray.direction, camera.forward));
}

// The path tracer's sums are empty meanwhile and lend their place.
@compute @workgroup_size(TILE_SIDE, TILE_SIDE)
fn features(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_id) place: vec3u) {
    let tile = tiles[workgroup.x];
    let pixel = tile.origin + place.xy;
    if any(pixel >= globals.image_size) {
        return;
    }
    let index = pixel.y * globals.image_size.x + pixel.x;
    for (var i = 0u; i < tile.sample_count; i++) {
        let seen = trace_features(pixel, tile.first_sample + i);
        color_sums[index] += vec4f(seen.albedo, seen.is_hit);
        statistics[index].luminance_squared += seen.normal.x;
        statistics[index].kept += seen.normal.y;
        statistics[index].odd_luminance += seen.normal.z;
        statistics[index].odd_kept += seen.depth;
    }
}
