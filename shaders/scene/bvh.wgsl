// Traversal of the compressed wide BVH of obvhs (Ylitie, Karras, Laine 2017).
#import "scene/intersect"
#import "scene/layout"

// Hierarchies have at most 32 levels (DEPTH_MAX in src/scene/hierarchy/mod.rs), each of which adds one entry at most. One
// more entry is for the surroundings of the model.
const STACK_SIZE = 33u;

// Covers the rounding of a box's far side (1 + 2 gamma_3 of Ize, "Robust BVH Ray Traversal", JCGT 2013).
const FAR_MARGIN = 1.0000005f;
// Relative error bound of a position from the ray's origin: ten roundings, four of a box's plane and six of a triangle's
// projected corner.
const RELATIVE_ERROR = 6e-7f;
// Bound of inverse directions. It keeps their products with distances finite.
const INVERSE_MAX = 1e18f;

// -0 is positive, as in the choice of near and far planes.
fn bounded_inverse(x: vec3f) -> vec3f {
    let size = min(1.0 / max(abs(x), vec3f(1e-18)), vec3f(INVERSE_MAX));
    return select(size, -size, x < vec3f());
}

// The hit children of a node as bits of its hit mask.
fn intersect_node(node: u32, ray: RayFrame, inverse: vec3f, octant_inverse: u32, t_max: f32) -> u32 {
    let first = node_words(node * 5u);
    let links = node_words(node * 5u + 1u);
    let x = node_words(node * 5u + 2u);
    let y = node_words(node * 5u + 3u);
    let z = node_words(node * 5u + 4u);
    let exponents = vec3u(first.w, first.w >> 8u, first.w >> 16u) & vec3u(0xffu);
    let scale = bitcast<vec3f>(exponents << vec3u(23u)) * inverse;
    let corner = bitcast<vec3f>(first.xyz);
    let shift = (corner - ray.origin) * inverse;
    let margin = (abs(corner) + abs(ray.origin)) * abs(inverse) * RELATIVE_ERROR;
    let backward = ray.direction < vec3f();
    // The near sides of both halves of the children, then the far ones.
    let sides_x = select(x, x.zwxy, backward.x);
    let sides_y = select(y, y.zwxy, backward.y);
    let sides_z = select(z, z.zwxy, backward.z);
    let early = shift - margin;
    let late = shift + margin;
    var hit_bits = 0u;
    for (var half = 0u; half < 2u; half++) {
        let back = half + 2u;
        let near = max(
            max(vec4f(unpack4xU8(sides_x[half])) * scale.x + early.x, vec4f(unpack4xU8(sides_y[half])) * scale.y + early.y),
            max(vec4f(unpack4xU8(sides_z[half])) * scale.z + early.z, vec4f()),
        );
        let far = min(
            min(vec4f(unpack4xU8(sides_x[back])) * scale.x + late.x, vec4f(unpack4xU8(sides_y[back])) * scale.y + late.y),
            min(vec4f(unpack4xU8(sides_z[back])) * scale.z + late.z, vec4f(t_max)),
        );
        // Inner children have bits 3 and 4 of their meta byte set; their slot is put in the ray's order.
        let meta_bytes = links[back];
        let is_inner = (meta_bytes & (meta_bytes << 1u)) & 0x10101010u;
        let inner_mask = (is_inner >> 4u) * 0xffu;
        let bit_index = unpack4xU8((meta_bytes ^ (octant_inverse & inner_mask)) & 0x1f1f1f1fu);
        let child_bits = unpack4xU8((meta_bytes >> 5u) & 0x07070707u);
        let hits = select(vec4u(), child_bits << bit_index, near <= far * FAR_MARGIN);
        hit_bits |= hits.x | hits.y | hits.z | hits.w;
    }
    return hit_bits;
}

// The closest hit with 0 < t < t_max, or any hit.
fn trace(origin: vec3f, direction: vec3f, t_max: f32, any_hit: bool) -> Hit {
    var nearest = Hit(t_max, NO_HIT, 0.0, 0.0);
    if globals.node_count == 0u {
        return nearest;
    }
    let ray = ray_frame(origin, direction);
    let inverse = bounded_inverse(direction);
    let octant_inverse = select(0x04040404u, 0u, direction.x < 0.0)
        | select(0x02020202u, 0u, direction.y < 0.0)
        | select(0x01010101u, 0u, direction.z < 0.0);
    var stack: array<vec2u, STACK_SIZE>;
    var stack_height = 0u;
    // x: first child; y: hit mask in the high byte, which children are inner in the low one.
    var node_group = vec2u(0u, 0x80000000u);
    var triangle_group = vec2u();
    if globals.around_root != 0u {
        stack[0] = vec2u(globals.around_root, 0x80000000u);
        stack_height = 1u;
    }
    loop {
        while triangle_group.y != 0u {
            let local = firstLeadingBit(triangle_group.y);
            triangle_group.y &= ~(1u << local);
            let index = triangle_group.x + local;
            let hit = intersect_triangle(ray, corners(triangle_at(index)), nearest.t);
            if hit.x > 0.0 {
                nearest = Hit(hit.x, index, hit.y, hit.z);
                if any_hit {
                    return nearest;
                }
            }
        }
        if (node_group.y & 0xff000000u) == 0u {
            if stack_height == 0u {
                break;
            }
            stack_height -= 1u;
            node_group = stack[stack_height];
        }
        let child = firstLeadingBit(node_group.y);
        let hits = node_group.y;
        let children = node_group.x;
        node_group.y &= ~(1u << child);
        if (node_group.y & 0xff000000u) != 0u {
            stack[stack_height] = node_group;
            stack_height += 1u;
        }
        let node = children + countOneBits(hits & ~(0xffffffffu << ((child - 24u) ^ (octant_inverse & 0xffu))));
        let hit_mask = intersect_node(node, ray, inverse, octant_inverse, nearest.t);
        let links = node_words(node * 5u + 1u);
        node_group = vec2u(links.x, (hit_mask & 0xff000000u) | (node_words(node * 5u).w >> 24u));
        triangle_group = vec2u(links.y, hit_mask & 0x00ffffffu);
    }
    return nearest;
}
