// D(xi) and h(D). Twin of src/optics/curve/cbrt.rs.

fn cbrt_distance(table: u32, xi: f32) -> f32 {
    return pow(xi, 0.33333334);
}

fn cbrt_h(table: u32, distance: f32) -> f32 {
    return 3.0 * distance;
}
