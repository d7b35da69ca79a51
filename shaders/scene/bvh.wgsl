// Rays against the geometry: the compressed wide hierarchy of obvhs (Ylitie, Karras, Laine 2017).
// intersect_triangle is the twin of the function in src/scene/intersect.rs.
#import "scene/layout"

const STACK_SIZE: u32 = 32u;
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

// (t, u, v) where the ray meets the triangle with 0 < t < t_max, from either side; t = -1 where it does not.
fn intersect_triangle(ray: RayFrame, v0: vec3f, v1: vec3f, v2: vec3f, t_max: f32) -> vec3f {
    let a = v0 - ray.origin;
    let b = v1 - ray.origin;
    let c = v2 - ray.origin;
    let ax = dot(ray.axis_x, a);
    let ay = dot(ray.axis_y, a);
    let bx = dot(ray.axis_x, b);
    let by = dot(ray.axis_y, b);
    let cx = dot(ray.axis_x, c);
    let cy = dot(ray.axis_y, c);
    let areas = vec3f(cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
    let area = areas.x + areas.y + areas.z;
    if (any(areas < vec3f(0.0)) && any(areas > vec3f(0.0))) || area == 0.0 {
        return vec3f(-1.0);
    }
    let normal = cross(v1 - v0, v2 - v0);
    let t = dot(normal, a) / dot(normal, ray.direction);
    if t > 0.0 && t < t_max {
        return vec3f(t, areas.y / area, areas.z / area);
    }
    return vec3f(-1.0);
}

fn safe_inverse(x: f32) -> f32 {
    return 1.0 / select(x, select(-1.1920929e-7, 1.1920929e-7, x >= 0.0), abs(x) <= 1.1920929e-7);
}

// Four children of a node: which the ray meets, as bits to be or-ed into the node's hit mask.
fn intersect_children(
    meta_bytes: u32, low: array<u32, 3>, high: array<u32, 3>, scale: vec3f, shift: vec3f, octant_inverse: u32, t_max: f32,
) -> u32 {
    let near = max(
        max(vec4f(unpack4xU8(low[0])) * scale.x + shift.x, vec4f(unpack4xU8(low[1])) * scale.y + shift.y),
        max(vec4f(unpack4xU8(low[2])) * scale.z + shift.z, vec4f(0.0)),
    );
    let far = min(
        min(vec4f(unpack4xU8(high[0])) * scale.x + shift.x, vec4f(unpack4xU8(high[1])) * scale.y + shift.y),
        min(vec4f(unpack4xU8(high[2])) * scale.z + shift.z, vec4f(t_max)),
    );
    // Inner children have bits 3 and 4 of their meta byte set; their slot is put in the ray's order.
    let is_inner = (meta_bytes & (meta_bytes << 1u)) & 0x10101010u;
    let inner_mask = (is_inner >> 4u) * 0xffu;
    let bit_index = unpack4xU8((meta_bytes ^ (octant_inverse & inner_mask)) & 0x1f1f1f1fu);
    let child_bits = unpack4xU8((meta_bytes >> 5u) & 0x07070707u);
    let met = select(vec4u(0u), child_bits << bit_index, near <= far);
    return met.x | met.y | met.z | met.w;
}

fn intersect_node(node: u32, ray: RayFrame, inverse: vec3f, octant_inverse: u32, t_max: f32) -> u32 {
    let first = nodes[node * 5u];
    let links = nodes[node * 5u + 1u];
    let x = nodes[node * 5u + 2u];
    let y = nodes[node * 5u + 3u];
    let z = nodes[node * 5u + 4u];
    let exponents = vec3u(first.w, first.w >> 8u, first.w >> 16u) & vec3u(0xffu);
    let scale = bitcast<vec3f>(exponents << vec3u(23u)) * inverse;
    let shift = (bitcast<vec3f>(first.xyz) - ray.origin) * inverse;
    let backward = ray.direction < vec3f(0.0);
    let x_low = select(x.xy, x.zw, backward.x);
    let x_high = select(x.zw, x.xy, backward.x);
    let y_low = select(y.xy, y.zw, backward.y);
    let y_high = select(y.zw, y.xy, backward.y);
    let z_low = select(z.xy, z.zw, backward.z);
    let z_high = select(z.zw, z.xy, backward.z);
    return intersect_children(
        links.z, array<u32, 3>(x_low.x, y_low.x, z_low.x), array<u32, 3>(x_high.x, y_high.x, z_high.x),
        scale, shift, octant_inverse, t_max,
    ) | intersect_children(
        links.w, array<u32, 3>(x_low.y, y_low.y, z_low.y), array<u32, 3>(x_high.y, y_high.y, z_high.y),
        scale, shift, octant_inverse, t_max,
    );
}

// The nearest triangle with 0 < t < t_max; any triangle if `any_hit`.
fn trace(origin: vec3f, direction: vec3f, t_max: f32, any_hit: bool) -> Hit {
    var nearest = Hit(t_max, NO_HIT, 0.0, 0.0);
    if globals.node_count == 0u {
        return nearest;
    }
    let ray = ray_frame(origin, direction);
    let inverse = vec3f(safe_inverse(direction.x), safe_inverse(direction.y), safe_inverse(direction.z));
    let octant_inverse = select(0x04040404u, 0u, direction.x < 0.0)
        | select(0x02020202u, 0u, direction.y < 0.0)
        | select(0x01010101u, 0u, direction.z < 0.0);
    var stack: array<vec2u, STACK_SIZE>;
    var stack_height = 0u;
    // x: where the children begin; y: hit mask in the high byte, which children are inner in the low one.
    var node_group = vec2u(0u, 0x80000000u);
    var triangle_group = vec2u(0u);
    loop {
        while triangle_group.y != 0u {
            let local = firstLeadingBit(triangle_group.y);
            triangle_group.y &= ~(1u << local);
            let index = triangle_group.x + local;
            let triangle = triangles[index];
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
        if (node_group.y & 0xff000000u) != 0u && stack_height < STACK_SIZE {
            stack[stack_height] = node_group;
            stack_height += 1u;
        }
        let slot = (child - 24u) ^ (octant_inverse & 0xffu);
        let node = children + countOneBits(hits & ~(0xffffffffu << slot));
        let hit_mask = intersect_node(node, ray, inverse, octant_inverse, nearest.t);
        node_group = vec2u(nodes[node * 5u + 1u].x, (hit_mask & 0xff000000u) | (nodes[node * 5u].w >> 24u));
        triangle_group = vec2u(nodes[node * 5u + 1u].y, hit_mask & 0x00ffffffu);
    }
    return nearest;
}
