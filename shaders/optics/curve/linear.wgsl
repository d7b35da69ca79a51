// D(xi) and h(D). Twin of src/optics/curve/linear.rs.

fn linear_distance(table: u32, xi: f32) -> f32 {
    return xi;
}

fn linear_h(table: u32, distance: f32) -> f32 {
    return 1.0 / max(distance, 1e-12);
}
