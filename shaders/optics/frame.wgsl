// The frame of a surface point. Twin of src/optics/frame.rs.
#import "optics/numeric"

struct Frame {
    tangent: vec3f,
    bitangent: vec3f,
    normal: vec3f,
}

fn frame_from_normal(normal: vec3f) -> Frame {
    let s = select(1.0, -1.0, normal.z < 0.0);
    let a = -1.0 / (s + normal.z);
    let b = normal.x * normal.y * a;
    return Frame(
        vec3f(1.0 + s * normal.x * normal.x * a, s * b, -s * normal.x),
        vec3f(b, s + normal.y * normal.y * a, -normal.y),
        normal,
    );
}

fn frame_from_tangent(normal: vec3f, tangent: vec3f, rotation_rad: f32) -> Frame {
    let flat_tangent = normalize_or(tangent - normal * dot(normal, tangent), frame_from_normal(normal).tangent);
    let turn = unit_circle(rotation_rad * (0.5 * INV_PI));
    let turned = flat_tangent * turn.x + cross(normal, flat_tangent) * turn.y;
    return Frame(turned, cross(normal, turned), normal);
}

fn local_from_world(frame: Frame, world: vec3f) -> vec3f {
    return vec3f(dot(frame.tangent, world), dot(frame.bitangent, world), dot(frame.normal, world));
}

fn world_from_local(frame: Frame, local: vec3f) -> vec3f {
    return frame.tangent * local.x + frame.bitangent * local.y + frame.normal * local.z;
}

// The mirror image of a direction about an axis, both pointing away.
fn mirrored_about(direction: vec3f, axis: vec3f) -> vec3f {
    return axis * (2.0 * dot(axis, direction)) - direction;
}

// The mirror image behind the plane with this normal.
fn reflected_at_plane(direction: vec3f, normal: vec3f) -> vec3f {
    return direction - normal * (2.0 * dot(normal, direction));
}
