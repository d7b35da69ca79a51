// D(xi) and h(D) of a curve drawn by hand, whose table lies in `tables` from index `table` on. Twin of
// src/optics/curve/custom.rs.
#import "optics/numeric"
#import "scene/layout"

const CUSTOM_INTERVALS: u32 = 64u;

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

fn custom_distance_max(table: u32) -> f32 {
    return tables[table];
}

fn custom_h(table: u32, distance: f32) -> f32 {
    return custom_density(table, distance) / max(distance, 1e-6);
}

fn custom_density(table: u32, distance: f32) -> f32 {
    let position = clamp(distance / tables[table] * f32(CUSTOM_INTERVALS), 0.0, f32(CUSTOM_INTERVALS));
    let low = min(floor(position), f32(CUSTOM_INTERVALS) - 1.0);
    let node = table + CUSTOM_INTERVALS + 2u + u32(low);
    let fraction = position - low;
    return tables[node] * (1.0 - fraction) + tables[node + 1u] * fraction;
}
