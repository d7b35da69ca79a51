// Uniform numbers turned into directions, points and choices. Twin of src/optics/warp.rs.
#import "optics/numeric"

// A uniform direction on the unit sphere (paper, eq. 9).
fn uniform_sphere(xi: vec2f) -> vec3f {
    let x = 2.0 * xi.x - 1.0;
    let s = safe_sqrt(1.0 - x * x);
    let around = unit_circle(xi.y);
    return vec3f(x, s * around.y, s * around.x);
}

fn uniform_disc(xi: vec2f) -> vec2f {
    return safe_sqrt(xi.x) * unit_circle(xi.y);
}

// A part of [0, 1) that a number selects, and the number remapped to [0, 1) within it.
struct Part {
    is_below: bool,
    remapped: f32,
}

// Chooses with a number, and remaps it for further use.
fn split(number: f32, share: f32) -> Part {
    let is_below = number < share;
    let length = max(select(1.0 - share, share, is_below), 1e-20);
    return Part(is_below, min((number - select(share, 0.0, is_below)) / length, 0.99999994));
}
