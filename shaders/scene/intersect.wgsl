// A ray against a triangle. Twin of src/scene/intersect.rs.

const NO_HIT = 0xffffffffu;

struct Hit {
    t: f32,
    triangle: u32,
    // Barycentric weights of the second and third corner.
    u: f32,
    v: f32,
}

// A ray and its projection plane for triangles (Woop, Benthin and Wald 2013).
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

// A vector along a triangle's normal (right hand rule): the product of its two shorter edges over the squared longest edge.
// The product of a needle's two long edges would be rounding noise, and that of two tiny edges would underflow when squared.
fn triangle_normal(corners: mat3x3f) -> vec3f {
    let a = corners[1] - corners[0];
    let b = corners[2] - corners[1];
    let c = corners[0] - corners[2];
    let aa = dot(a, a);
    let bb = dot(b, b);
    let cc = dot(c, c);
    let a_is_longest = aa >= bb && aa >= cc;
    let b_is_longest = !a_is_longest && bb >= cc;
    let left = select(select(a, c, b_is_longest), b, a_is_longest);
    let right = select(select(b, a, b_is_longest), c, a_is_longest);
    return cross(left, right) / max(max(max(aa, bb), cc), 1e-37);
}

// The hit (t, u, v) with 0 < t < t_max, from either side; t = -1 for a miss.
fn intersect_triangle(ray: RayFrame, corners: mat3x3f, t_max: f32) -> vec3f {
    // The projected corners, one per lane: all three by the same instructions.
    let axes = transpose(corners);
    let relative = mat3x3f(axes[0] - ray.origin.x, axes[1] - ray.origin.y, axes[2] - ray.origin.z);
    let px = relative * ray.axis_x;
    let py = relative * ray.axis_y;
    // An edge's area with its corners in a canonical order: the same number for both triangles that share it, whether or not
    // a driver fuses the products.
    let is_turned = (px.zxy > px.yzx) | ((px.zxy == px.yzx) & (py.zxy > py.yzx));
    let low_x = select(px.zxy, px.yzx, is_turned);
    let low_y = select(py.zxy, py.yzx, is_turned);
    let high_x = select(px.yzx, px.zxy, is_turned);
    let high_y = select(py.yzx, py.zxy, is_turned);
    let ordered = low_x * high_y - low_y * high_x;
    let areas = select(ordered, -ordered, is_turned);
    let area = areas.x + areas.y + areas.z;
    if (any(areas < vec3f()) && any(areas > vec3f())) || area == 0.0 {
        return vec3f(-1.0);
    }
    let normal = triangle_normal(corners);
    let t = dot(normal, corners[0] - ray.origin) / dot(normal, ray.direction);
    if t > 0.0 && t < t_max {
        return vec3f(t, areas.y / area, areas.z / area);
    }
    return vec3f(-1.0);
}
