enable wgpu_ray_query;
// Ray queries on the adapter's own acceleration structures. This file replaces bvh.wgsl in kernels that are linked for them.
#import "scene/intersect"
#import "scene/layout"

// Instance 0 is the model, instance 1 its surroundings (src/gpu/structures.rs).
@group(0) @binding(15) var structures: acceleration_structure;

// Ray queries need finite numbers. A ray with a larger sum of coordinates misses.
const EXTENT_MAX = 1e36f;

// The closest hit with 0 < t < t_max, or any hit. As in bvh.wgsl, all triangles are opaque here: holes are the caller's.
fn trace(origin: vec3f, direction: vec3f, t_max: f32, any_hit: bool) -> Hit {
    let nothing = Hit(t_max, NO_HIT, 0.0, 0.0);
    // False for NaN, too.
    if !(dot(abs(origin) + abs(direction), vec3f(1.0)) < EXTENT_MAX) || globals.node_count == 0u {
        return nothing;
    }
    let flags = RAY_FLAG_FORCE_OPAQUE | select(0u, RAY_FLAG_TERMINATE_ON_FIRST_HIT, any_hit);
    var query: ray_query;
    rayQueryInitialize(&query, structures, RayDesc(flags, 0xffu, 0.0, t_max, origin, direction));
    while rayQueryProceed(&query) {}
    let committed = rayQueryGetCommittedIntersection(&query);
    if committed.kind == RAY_QUERY_INTERSECTION_NONE {
        return nothing;
    }
    let index = committed.primitive_index + committed.instance_custom_data * globals.around_triangle;
    // Recomputed, so that the numbers equal those of bvh.wgsl on any adapter.
    let exact = intersect_triangle(ray_frame(origin, direction), corners(triangle_at(index)), t_max);
    if exact.x > 0.0 {
        return Hit(exact.x, index, exact.y, exact.z);
    }
    // At an edge or an end of the ray, where the two tests round differently.
    return Hit(committed.t, index, committed.barycentrics.x, committed.barycentrics.y);
}
