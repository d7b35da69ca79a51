// Elementary functions in forms that do not cancel. Twin of src/optics/numeric.rs.

const PI = 3.14159265358979f;
const INV_PI = 0.318309886183791f;

const WHITE = vec3f(1.0);
// The normal of a local frame.
const UPWARDS = vec3f(0.0, 0.0, 1.0);

fn expm1(x: f32) -> f32 {
    let series = x * (1.0 + x * (0.5 + x * (0.16666667 + x * 0.041666668)));
    return select(exp(x) - 1.0, series, abs(x) < 0.01);
}

fn sampled_share(share: f32) -> f32 {
    let small = min(share, 1.0 - share);
    let raised = max(small, min(20.0 * small, 0.05));
    return select(1.0 - raised, raised, share < 0.5);
}

fn log1p(x: f32) -> f32 {
    let series = x * (1.0 - x * (0.5 - x * (0.33333334 - x * (0.25 - x * 0.2))));
    return select(log(1.0 + x), series, abs(x) < 0.01);
}

// The angle of the vector (x, y) in radians, in [-pi, pi], to 2e-7; not for the null vector. Instead of the built-in
// atan2, which may be 4096 roundings off: a fifth of a texel of an environment's map.
fn arctan2(y: f32, x: f32) -> f32 {
    let size = abs(vec2f(x, y));
    let high = max(size.x, size.y);
    let low = min(size.x, size.y);
    // The octant's half above 22.5 degrees is seen from 45 degrees.
    let is_steep = low > 0.41421356 * high;
    let slope = select(low, low - high, is_steep) / select(high, low + high, is_steep);
    let s = slope * slope;
    let series = -0.3333295 + s * (0.1997771 + s * (-0.1387768 + s * 0.08053721));
    let in_octant = slope + slope * s * series + select(0.0, 0.25 * PI, is_steep);
    let in_quadrant = select(in_octant, 0.5 * PI - in_octant, size.y > size.x);
    let angle = select(in_quadrant, PI - in_quadrant, x < 0.0);
    return select(angle, -angle, y < 0.0);
}

// Cosine and sine of an angle in turns, in [-1e4, 1e4], accurate to 2e-7. The built-ins may be off by 5e-4, a tenth of the
// width of a sharp reflection. Polynomials of Cephes.
fn unit_circle(turns: f32) -> vec2f {
    let quarters = 4.0 * turns;
    let quadrant = round(quarters);
    let angle = (quarters - quadrant) * (0.5 * PI);
    let s = angle * angle;
    let sine = angle + angle * s * (-1.6666654611e-1 + s * (8.3321608736e-3 - s * 1.9515295891e-4));
    let cosine = 1.0 - 0.5 * s + s * s * (4.166664568298827e-2 + s * (-1.388731625493765e-3 + s * 2.443315711809948e-5));
    let turned = i32(quadrant);
    let place = select(vec2f(cosine, sine), vec2f(-sine, cosine), (turned & 1) != 0);
    return select(place, -place, (turned & 2) != 0);
}

fn safe_sqrt(x: f32) -> f32 {
    return sqrt(max(x, 0.0));
}

fn normalize_or(v: vec3f, fallback: vec3f) -> vec3f {
    let square = dot(v, v);
    let usable = square > 1e-30;
    return select(fallback, v * (1.0 / sqrt(select(1.0, square, usable))), usable);
}

fn max_component(v: vec3f) -> f32 {
    return max(max(v.x, v.y), v.z);
}

fn luminance(colour: vec3f) -> f32 {
    return dot(colour, vec3f(0.2126, 0.7152, 0.0722));
}
