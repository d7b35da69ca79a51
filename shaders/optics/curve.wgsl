// D(xi): how far from the mirror direction the geometric lobe's samples lie. Twin of src/optics/curve.rs.
// A custom curve's table lies in `tables` from index `table` on.
#import "optics/choices"
#import "optics/numeric"
#import "scene/layout"

const CUSTOM_INTERVALS: u32 = 64u;
const LONG_TAIL_MAX: f32 = 17.32868;

fn curve_distance(curve: u32, table: u32, xi: f32) -> f32 {
    switch curve {
        case CURVE_LINEAR: { return xi; }
        case CURVE_SQRT: { return sqrt(xi); }
        case CURVE_CBRT: { return pow(xi, 0.33333334); }
        case CURVE_SMOOTH: {
            // 1 - sqrt(1 - sqrt(xi)) without the cancellation near xi = 0.
            let root = sqrt(xi);
            return root / (1.0 + safe_sqrt(1.0 - root));
        }
        case CURVE_LONG_TAIL: {
            // 1 - sqrt(xi) = (1 - xi)/(1 + sqrt(xi)): stays above zero for the largest number below 1.
            let root = sqrt(xi);
            let complement = max((1.0 - xi) / (1.0 + root), 2.9802322e-8);
            return select(-log(complement), -log1p(-root), root < 0.5);
        }
        default: { return custom_distance(table, xi); }
    }
}

fn curve_distance_max(curve: u32, table: u32) -> f32 {
    switch curve {
        case CURVE_LONG_TAIL: { return LONG_TAIL_MAX; }
        case CURVE_LINEAR, CURVE_SQRT, CURVE_CBRT, CURVE_SMOOTH: { return 1.0; }
        default: { return tables[table]; }
    }
}

fn curve_h(curve: u32, table: u32, distance: f32) -> f32 {
    switch curve {
        case CURVE_LINEAR: { return 1.0 / max(distance, 1e-12); }
        case CURVE_SQRT: { return 2.0; }
        case CURVE_CBRT: { return 3.0 * distance; }
        case CURVE_SMOOTH: { return 4.0 * (2.0 - distance) * max(1.0 - distance, 0.0); }
        case CURVE_LONG_TAIL: {
            // 2 e^(-D) (1 - e^(-D))/D; the last factor goes to 1 at D = 0.
            let d = max(distance, 1e-6);
            return -2.0 * exp(-d) * expm1(-d) / d;
        }
        default: { return custom_density(table, distance) / max(distance, 1e-6); }
    }
}

fn custom_distance(table: u32, xi: f32) -> f32 {
    // Six halvings of 64 intervals; `low` counts the nodes that lie below xi.
    var low = 0u;
    for (var step = CUSTOM_INTERVALS / 2u; step > 0u; step /= 2u) {
        let middle = low + step;
        low = select(middle, low, xi < tables[table + 1u + middle]);
    }
    let width = tables[table] * (1.0 / f32(CUSTOM_INTERVALS));
    let left = tables[table + CUSTOM_INTERVALS + 2u + low];
    let right = tables[table + CUSTOM_INTERVALS + 3u + low];
    let missing = max(xi - tables[table + 1u + low], 0.0);
    let root = safe_sqrt(left * left + 2.0 * (right - left) / width * missing);
    let step = 2.0 * missing / max(left + root, 1e-12);
    return width * f32(low) + min(step, width);
}

fn custom_density(table: u32, distance: f32) -> f32 {
    let position = clamp(distance / tables[table] * f32(CUSTOM_INTERVALS), 0.0, f32(CUSTOM_INTERVALS));
    let low = min(floor(position), f32(CUSTOM_INTERVALS) - 1.0);
    let node = table + CUSTOM_INTERVALS + 2u + u32(low);
    let fraction = position - low;
    return tables[node] * (1.0 - fraction) + tables[node + 1u] * fraction;
}
