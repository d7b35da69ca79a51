// D(xi) and h(D). Twin of src/optics/curve/long_tail.rs.
#import "scene/constants"
#import "optics/numeric"

fn long_tail_distance(table: u32, xi: f32) -> f32 {
    // 1 - sqrt(xi) = (1 - xi)/(1 + sqrt(xi)): stays above zero for the largest number below 1.
    let root = sqrt(xi);
    return select(-log(max((1.0 - xi) / (1.0 + root), 2.9802322e-8)), -log1p(-root), root < 0.5);
}

fn long_tail_h(table: u32, distance: f32) -> f32 {
    // 2 e^(-D) (1 - e^(-D))/D; the last factor goes to 1 at D = 0.
    let d = max(distance, 1e-6);
    return -2.0 * exp(-d) * expm1(-d) / d;
}
