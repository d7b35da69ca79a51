// Elementary functions in forms that do not cancel. Twin of src/optics/numeric.rs.

const PI: f32 = 3.14159265358979;
const INV_PI: f32 = 0.318309886183791;

fn expm1(x: f32) -> f32 {
    let series = x * (1.0 + x * (0.5 + x * (0.16666667 + x * 0.041666668)));
    return select(exp(x) - 1.0, series, abs(x) < 0.01);
}

fn log1p(x: f32) -> f32 {
    let series = x * (1.0 - x * (0.5 - x * (0.33333334 - x * (0.25 - x * 0.2))));
    return select(log(1.0 + x), series, abs(x) < 0.01);
}

fn safe_sqrt(x: f32) -> f32 {
    return sqrt(max(x, 0.0));
}

fn normalize_or(v: vec3f, fallback: vec3f) -> vec3f {
    let square = dot(v, v);
    let usable = square > 1e-30;
    let scale = 1.0 / sqrt(select(1.0, square, usable));
    return select(fallback, v * scale, usable);
}

fn luminance(colour: vec3f) -> f32 {
    return dot(colour, vec3f(0.2126, 0.7152, 0.0722));
}
