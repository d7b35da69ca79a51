// D(xi) and h(D). Twin of src/optics/curve/smooth.rs.
#import "optics/numeric"

fn smooth_distance(table: u32, xi: f32) -> f32 {
    // 1 - sqrt(1 - sqrt(xi)) without the cancellation near xi = 0.
    let root = sqrt(xi);
    return root / (1.0 + safe_sqrt(1.0 - root));
}

fn smooth_h(table: u32, distance: f32) -> f32 {
    return 4.0 * (2.0 - distance) * max(1.0 - distance, 0.0);
}
