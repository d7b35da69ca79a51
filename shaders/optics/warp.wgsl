// Uniform numbers turned into directions and points. Twin of src/optics/warp.rs.
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
