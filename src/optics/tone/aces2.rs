//! The ACES 2.0 output transform for sRGB screens, as a table that `scripts/tone-table` makes by OpenColorIO.

use std::sync::LazyLock;

use super::linear_from_srgb;
use crate::optics::real::Scalar;
use crate::optics::vector::Vec3;

/// Nodes along each side of the table.
const SIDE: usize = 48;
/// Nodes are at equal distances in the logarithm of a channel plus this.
const FLOOR: f64 = 1.0 / 512.0;
/// The channel of the last node.
const CEILING: f64 = 128.0;

/// Display value at each node, sRGB-encoded in [0, 1]; red varies fastest.
static TABLE: LazyLock<Vec<[f32; 3]>> = LazyLock::new(|| {
    let bytes = include_bytes!("../../../assets/tone/aces2.table");
    let numbers = bytes.as_chunks::<2>().0.iter();
    let numbers: Vec<f32> = numbers
        .map(|code| f32::from(u16::from_le_bytes(*code)) / 65535.0)
        .collect();
    numbers.as_chunks::<3>().0.to_vec()
});

/// ACES 2.0 (A.M.P.A.S., 2024; 100 nit, Rec. 709), linear in the cells' six tetrahedra, so
/// that greys stay grey. Within 0.006 of the transform, sRGB-encoded, for 99 of 100 colours, 0.0005 in the mean.
#[inline(always)]
pub fn tone_aces2<T: Scalar>(scene: Vec3<T>) -> Vec3<T> {
    let c = T::from_f64;
    let last = (SIDE - 1) as f64;
    let scale = last / ((CEILING + FLOOR) / FLOOR).ln();
    let place = scene.map(|x| {
        let along = (x.min(c(CEILING)) / c(FLOOR) + T::one()).ln() * c(scale);
        along.clamp(T::zero(), c(last))
    });
    let low = place.map(|x| x.floor().min(c(last - 1.0)));
    let share = [place.x - low.x, place.y - low.y, place.z - low.z];
    // From the lowest corner along the axes, the one with the largest share first.
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| share[b].to_f64().total_cmp(&share[a].to_f64()));
    let [mut x, mut y, mut z] = low.to_f64().map(|x| x as usize);
    let node = |x: usize, y: usize, z: usize| Vec3::<T>::from_f32(TABLE[(z * SIDE + y) * SIDE + x]);
    let mut shown = node(x, y, z) * (T::one() - share[axes[0]]);
    for (step, axis) in axes.into_iter().enumerate() {
        *[&mut x, &mut y, &mut z][axis] += 1;
        let next = axes.get(step + 1).map_or(T::zero(), |&next| share[next]);
        shown += node(x, y, z) * (share[axis] - next);
    }
    linear_from_srgb(shown)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::tone::srgb_from_linear;
    use crate::optics::vector::vec3;

    /// What `scripts/tone-table --check 12` prints: scene colours, and what OpenColorIO 2.5 makes of them.
    const KNOWN: [[f64; 6]; 12] = [
        [0.392921, 4.562575, 1.526241, 0.760671, 0.930863, 0.804952],
        [0.010700, 0.021025, 3.686530, 0.351585, 0.401180, 1.000000],
        [0.001475, 2.300645, 1.850572, 0.569000, 0.859285, 0.813640],
        [0.095340, 0.021575, 0.017284, 0.200891, 0.043101, 0.031538],
        [0.013979, 0.077592, 0.132604, 0.030091, 0.193775, 0.264604],
        [0.206117, 11.062247, 1.778516, 0.865901, 0.985116, 0.870809],
        [0.382730, 10.429158, 0.009787, 0.824730, 1.000000, 0.772173],
        [0.005957, 0.350888, 0.002089, 0.104125, 0.485747, 0.080230],
        [0.001940, 0.145554, 0.093866, 0.038981, 0.293370, 0.237794],
        [5.461321, 0.407822, 0.144546, 1.000000, 0.635568, 0.547880],
        [0.123743, 0.013082, 0.001564, 0.201397, 0.041254, 0.002723],
        [0.007962, 0.718214, 0.008573, 0.196178, 0.663307, 0.173153],
    ];

    #[test]
    fn colours_are_those_of_the_reference() {
        assert_eq!(TABLE.len(), SIDE * SIDE * SIDE);
        let mut apart = Vec::new();
        for [r, g, b, expected @ ..] in KNOWN {
            let shown = srgb_from_linear(tone_aces2(vec3(r, g, b))).to_f64();
            let worst = (0..3).map(|i| (shown[i] - expected[i]).abs()).fold(0.0, f64::max);
            assert!(worst < 0.012, "{:?}: {shown:?}, not {expected:?}", [r, g, b]);
            apart.push(worst);
        }
        let mean = apart.iter().sum::<f64>() / apart.len() as f64;
        assert!(mean < 0.003, "{mean}");
        // Middle grey and white, by OpenColorIO.
        for (grey, expected) in [(0.18, 0.349188), (1.0, 0.706683), (16.0, 0.974728)] {
            let shown = srgb_from_linear(tone_aces2(vec3(grey, grey, grey))).to_f64();
            assert!(shown.iter().all(|x: &f64| (x - expected).abs() < 1e-3), "{shown:?}");
        }
    }
}
