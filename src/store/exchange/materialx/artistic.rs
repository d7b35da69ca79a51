//! Metals by their reflection seen head-on and a colour towards the edge, as Standard Surface has them (Gulbrandsen 2014): the
//! index and the absorption follow, and by these the tint at 82 degrees that Glossmith knows.

use crate::optics::{fresnel::fresnel_conductor, fresnel::fresnel_schlick, vector::Vec3};

/// The cosine at which edges are tinted.
const COSINE: f64 = 1.0 / 7.0;
/// Steps of the search for a colour: each halves what is left.
const STEPS: u32 = 40;

/// What Schlick's reflection at the edge is multiplied by, for a channel of the metal.
fn tint_of_channel(head_on: f64, edge: f64) -> f64 {
    let r = head_on.clamp(0.0, 0.99);
    let root = r.sqrt();
    let (most, least) = ((1.0 + root) / (1.0 - root), (1.0 - r) / (1.0 + r));
    let eta = most + (least - most) * edge;
    let k_squared = ((eta + 1.0).powi(2) * r - (eta - 1.0).powi(2)) / (1.0 - r);
    let there = fresnel_conductor(COSINE, eta, k_squared.max(0.0).sqrt());
    there / fresnel_schlick(Vec3::splat(r), COSINE).x
}

/// The tint of a metal's edge by the colour that Standard Surface has for it.
pub fn edge_tint(head_on: [f32; 3], edge_color: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| {
        let tint = tint_of_channel(f64::from(head_on[i]), f64::from(edge_color[i]).clamp(0.0, 1.0));
        tint.clamp(0.0, 1.0) as f32
    })
}

/// The colour for the edge that gives a tint, or the one that comes nearest: the tint grows with it.
pub fn edge_color(head_on: [f32; 3], tint: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..STEPS {
            let middle = 0.5 * (low + high);
            if tint_of_channel(f64::from(head_on[i]), middle) < f64::from(tint[i]) {
                low = middle;
            } else {
                high = middle;
            }
        }
        high as f32
    })
}
