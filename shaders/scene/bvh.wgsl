// Rays against the geometry: the compressed wide hierarchy of obvhs (Ylitie, Karras, Laine 2017).
// intersect_triangle is the twin of the function in src/scene/intersect.rs.
#import "scene/layout"

// Hierarchies are built no deeper than 32 levels (DEPTH_MAX in src/scene/hierarchy/mod.rs), each of which adds one entry at
// most; one more waits for what is around the model.
const STACK_SIZE: u32 = 33u;
const NO_HIT: u32 = 0xffffffffu;

struct Hit {
    t: f32,
    triangle: u32,
    // Weights of the second and third corner.
    u: f32,
    v: f32,
}

// A ray and the plane that triangles are projected to along it (Woop, Benthin and Wald 2013).
struct RayFrame {
    origin: vec3f,
    direction: vec3f,
    axis_x: vec3f,
    axis_y: vec3f,
}

fn ray_frame(origin: vec3f, direction: vec3f) -> RayFrame {
    let d = direction;
    let size = abs(d);
    if size.z >= size.x && size.z >= size.y {
        return RayFrame(origin, d, vec3f(1.0, 0.0, -d.x / d.z), vec3f(0.0, 1.0, -d.y / d.z));
    }
    if size.y >= size.x {
        return RayFrame(origin, d, vec3f(1.0, -d.x / d.y, 0.0), vec3f(0.0, -d.z / d.y, 1.0));
    }
    return RayFrame(origin, d, vec3f(-d.y / d.x, 1.0, 0.0), vec3f(-d.z / d.x, 0.0, 1.0));
}

// A vector along a triangle's normal, by the right hand: the product of its two shorter edges over the square of the
// longest. The product of two long edges of a needle would be rounding noise, and that of two tiny ones underflow where it
// is squared.
fn triangle_normal(p0: vec3f, p1: vec3f, p2: vec3f) -> vec3f {
    let a = p1 - p0;
    let b = p2 - p1;
    let c = p0 - p2;
    let aa = dot(a, a);
    let bb = dot(b, b);
    let cc = dot(c, c);
    let a_is_longest = aa >= bb && aa >= cc;
    let b_is_longest = !a_is_longest && bb >= cc;
    let left = select(select(a, c, b_is_longest), b, a_is_longest);
    let right = select(select(b, a, b_is_longest), c, a_is_longest);
    return cross(left, right) / max(max(max(aa, bb), cc), 1e-37);
}

// (t, u, v) where the ray meets the triangle with 0 < t < t_max, from either side; t = -1 where it does not.
fn intersect_triangle(ray: RayFrame, v0: vec3f, v1: vec3f, v2: vec3f, t_max: f32) -> vec3f {
    let a = v0 - ray.origin;
    // The projected corners, one a lane: all three by the same instructions.
    let x = vec3f(v0.x, v1.x, v2.x) - ray.origin.x;
    let y = vec3f(v0.y, v1.y, v2.y) - ray.origin.y;
    let z = vec3f(v0.z, v1.z, v2.z) - ray.origin.z;
    let px = x * ray.axis_x.x + y * ray.axis_x.y + z * ray.axis_x.z;
    let py = x * ray.axis_y.x + y * ray.axis_y.y + z * ray.axis_y.z;
    // An edge's area from its corners in an order of their own: the same number for both triangles that share it,
    // whether or not a driver fuses the products.
    let is_turned = (px.zxy > px.yzx) | ((px.zxy == px.yzx) & (py.zxy > py.yzx));
    let low_x = select(px.zxy, px.yzx, is_turned);
    let low_y = select(py.zxy, py.yzx, is_turned);
    let high_x = select(px.yzx, px.zxy, is_turned);
    let high_y = select(py.yzx, py.zxy, is_turned);
    let ordered = low_x * high_y - low_y * high_x;
    let areas = select(ordered, -ordered, is_turned);
    let area = areas.x + areas.y + areas.z;
    if (any(areas < vec3f(0.0)) && any(areas > vec3f(0.0))) || area == 0.0 {
        return vec3f(-1.0);
    }
    let normal = triangle_normal(v0, v1, v2);
    let t = dot(normal, a) / dot(normal, ray.direction);
    if t > 0.0 && t < t_max {
        return vec3f(t, areas.y / area, areas.z / area);
    }
    return vec3f(-1.0);
}

// Makes up for the rounding of a box's far side (1 + 2 gamma_3 of Ize, "Robust BVH Ray Traversal", JCGT 2013).
const FAR_MARGIN: f32 = 1.0000005;
// Places relative to the ray's origin are off by at most this part of both: ten roundings, four of a box's plane and six
// of a triangle's projected corner.
const PLACE_ERROR: f32 = 6e-7;
// Inverse directions are at most this, so that their products with distances stay finite.
const INVERSE_MAX: f32 = 1e18;

// -0 is positive, as where planes are picked.
fn bounded_inverse(x: f32) -> f32 {
    let size = min(1.0 / max(abs(x), 1e-18), INVERSE_MAX);
    return select(size, -size, x < 0.0);
}

// Four children of a node: which the ray meets, as bits to be or-ed into the node's hit mask.
fn intersect_children(
    meta_bytes: u32, low: array<u32, 3>, high: array<u32, 3>, scale: vec3f, shift: vec3f, margin: vec3f,
    octant_inverse: u32, t_max: f32,
) -> u32 {
    let early = shift - margin;
    let late = shift + margin;
    let near = max(
        max(vec4f(unpack4xU8(low[0])) * scale.x + early.x, vec4f(unpack4xU8(low[1])) * scale.y + early.y),
        max(vec4f(unpack4xU8(low[2])) * scale.z + early.z, vec4f(0.0)),
    );
    let far = min(
        min(vec4f(unpack4xU8(high[0])) * scale.x + late.x, vec4f(unpack4xU8(high[1])) * scale.y + late.y),
        min(vec4f(unpack4xU8(high[2])) * scale.z + late.z, vec4f(t_max)),
    );
    // Inner children have bits 3 and 4 of their meta byte set; their slot is put in the ray's order.
    let is_inner = (meta_bytes & (meta_bytes << 1u)) & 0x10101010u;
    let inner_mask = (is_inner >> 4u) * 0xffu;
    let bit_index = unpack4xU8((meta_bytes ^ (octant_inverse & inner_mask)) & 0x1f1f1f1fu);
    let child_bits = unpack4xU8((meta_bytes >> 5u) & 0x07070707u);
    let met = select(vec4u(0u), child_bits << bit_index, near <= far * FAR_MARGIN);
    return met.x | met.y | met.z | met.w;
}

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
    let margin = (abs(corner) + abs(ray.origin)) * abs(inverse) * PLACE_ERROR;
    let backward = ray.direction < vec3f(0.0);
    let x_low = select(x.xy, x.zw, backward.x);
    let x_high = select(x.zw, x.xy, backward.x);
    let y_low = select(y.xy, y.zw, backward.y);
    let y_high = select(y.zw, y.xy, backward.y);
    let z_low = select(z.xy, z.zw, backward.z);
    let z_high = select(z.zw, z.xy, backward.z);
    return intersect_children(
        links.z, array<u32, 3>(x_low.x, y_low.x, z_low.x), array<u32, 3>(x_high.x, y_high.x, z_high.x),
        scale, shift, margin, octant_inverse, t_max,
    ) | intersect_children(
        links.w, array<u32, 3>(x_low.y, y_low.y, z_low.y), array<u32, 3>(x_high.y, y_high.y, z_high.y),
        scale, shift, margin, octant_inverse, t_max,
    );
}

// The nearest triangle with 0 < t < t_max; any triangle if `any_hit`.
fn trace(origin: vec3f, direction: vec3f, t_max: f32, any_hit: bool) -> Hit {
    var nearest = Hit(t_max, NO_HIT, 0.0, 0.0);
    if globals.node_count == 0u {
        return nearest;
    }
    let ray = ray_frame(origin, direction);
    let inverse = vec3f(bounded_inverse(direction.x), bounded_inverse(direction.y), bounded_inverse(direction.z));
    let octant_inverse = select(0x04040404u, 0u, direction.x < 0.0)
        | select(0x02020202u, 0u, direction.y < 0.0)
        | select(0x01010101u, 0u, direction.z < 0.0);
    var stack: array<vec2u, STACK_SIZE>;
    var stack_height = 0u;
    // x: where the children begin; y: hit mask in the high byte, which children are inner in the low one.
    var node_group = vec2u(0u, 0x80000000u);
    var triangle_group = vec2u(0u);
    if globals.around_root != 0u {
        stack[0] = vec2u(globals.around_root, 0x80000000u);
        stack_height = 1u;
    }
    loop {
        while triangle_group.y != 0u {
            let local = firstLeadingBit(triangle_group.y);
            triangle_group.y &= ~(1u << local);
            let index = triangle_group.x + local;
            let triangle = triangle_at(index);
            let met = intersect_triangle(
                ray, bitcast<vec3f>(triangle.corners[0].xyz), bitcast<vec3f>(triangle.corners[1].xyz),
                bitcast<vec3f>(triangle.corners[2].xyz), nearest.t,
            );
            if met.x > 0.0 {
                nearest = Hit(met.x, index, met.y, met.z);
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
        let slot = (child - 24u) ^ (octant_inverse & 0xffu);
        let node = children + countOneBits(hits & ~(0xffffffffu << slot));
        let hit_mask = intersect_node(node, ray, inverse, octant_inverse, nearest.t);
        node_group = vec2u(node_words(node * 5u + 1u).x, (hit_mask & 0xff000000u) | (node_words(node * 5u).w >> 24u));
        triangle_group = vec2u(node_words(node * 5u + 1u).y, hit_mask & 0x00ffffffu);
    }
    return nearest;
}
