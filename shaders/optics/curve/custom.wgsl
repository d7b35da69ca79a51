// D(xi) and h(D) of a custom curve, whose table starts at number `table`. An interval has four numbers: distribution and
// density at its start, density at its end, and D's maximum. Twin of src/optics/curve/custom.rs.
#import "scene/layout"

fn custom_distance(table: u32, xi: f32) -> f32 {
    // Six halvings of 64 intervals; `low` counts those that end below xi.
    var low = 0u;
    for (var step = CUSTOM_INTERVALS / 2u; step > 0u; step /= 2u) {
        let middle = low + step;
        low = select(middle, low, xi < table_numbers(table, middle).x);
    }
    let interval = table_numbers(table, low);
    let width = interval.w * (1.0 / f32(CUSTOM_INTERVALS));
    let left = interval.y;
    let missing = max(xi - interval.x, 0.0);
    let root = safe_sqrt(left * left + 2.0 * (interval.z - left) / width * missing);
    return width * f32(low) + min(2.0 * missing / max(left + root, 1e-12), width);
}

fn custom_distance_max(table: u32) -> f32 {
    return table_numbers(table, 0u).w;
}

fn custom_h(table: u32, distance: f32) -> f32 {
    let position = clamp(distance / custom_distance_max(table) * f32(CUSTOM_INTERVALS), 0.0, f32(CUSTOM_INTERVALS));
    let low = min(floor(position), f32(CUSTOM_INTERVALS) - 1.0);
    let interval = table_numbers(table, u32(low));
    let fraction = position - low;
    return (interval.y * (1.0 - fraction) + interval.z * fraction) / max(distance, 1e-6);
}
