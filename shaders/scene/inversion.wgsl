// Samples discrete weights by inverting their cumulative sum. Twin of src/scene/inversion.rs, which explains the method.
#import "scene/constants"

// Relative position in [0, 1] of a number within the range that selects an entry. bounds: first number of the range, and the
// number after its last. jitter is added to the number.
fn place_in(bounds: vec2u, number: u32, jitter: f32) -> f32 {
    return min((f32(number - bounds.x) + jitter) / f32(max(bounds.y - bounds.x, 1u)), 1.0);
}
