enable wgpu_ray_query;
// Rays against the geometry through hierarchies of the adapter's own making: what takes the place of bvh.wgsl in kernels
// that are linked for ray queries.
#import "scene/intersect"
#import "scene/layout"

// The model, which instances call 0, and what is around it, 1 (src/gpu/structures.rs).
@group(0) @binding(15) var structures: acceleration_structure;

// Queries take finite numbers alone: of a ray whose coordinates add up to more, nothing is met.
const EXTENT_MAX: f32 = 1e36;

// The nearest triangle with 0 < t < t_max; any triangle if `any_hit`. Holes are none of its business, as in bvh.wgsl: all
// triangles stop rays here.
fn trace(origin: vec3f, direction: vec3f, t_max: f32, any_hit: bool) -> Hit {
    let nothing = Hit(t_max, NO_HIT, 0.0, 0.0);
    // False for NaN, too.
    let is_sound = dot(abs(origin) + abs(direction), vec3f(1.0)) < EXTENT_MAX;
    if !is_sound || globals.node_count == 0u {
        return nothing;
    }
    let flags = RAY_FLAG_FORCE_OPAQUE | select(0u, RAY_FLAG_TERMINATE_ON_FIRST_HIT, any_hit);
    var query: ray_query;
    rayQueryInitialize(&query, structures, RayDesc(flags, 0xffu, 0.0, t_max, origin, direction));
    while rayQueryProceed(&query) {}
    let met = rayQueryGetCommittedIntersection(&query);
    if met.kind == RAY_QUERY_INTERSECTION_NONE {
        return nothing;
    }
    let index = met.primitive_index + met.instance_custom_data * globals.around_triangle;
    let triangle = triangle_at(index);
    // The same numbers as by the other traversal, whatever the adapter computes with.
    let exact = intersect_triangle(
        ray_frame(origin, direction), bitcast<vec3f>(triangle.corners[0].xyz), bitcast<vec3f>(triangle.corners[1].xyz),
        bitcast<vec3f>(triangle.corners[2].xyz), t_max,
    );
    if exact.x > 0.0 {
        return Hit(exact.x, index, exact.y, exact.z);
    }
    // At an edge or an end of the ray, where the two round to different sides.
    return Hit(met.t, index, met.barycentrics.x, met.barycentrics.y);
}
