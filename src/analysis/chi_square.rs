//! Pearson's χ² test of sampled directions against a density.
//!
//! The cells are in polar coordinates around an axis. Their rings follow the samples' own quantiles, so that a lobe of a
//! hundredth of a degree is resolved as well as a diffuse one. An absorbed sample is an outcome like any other: its
//! expectation is 1 minus the density's integral.

use std::f64::consts::{PI, TAU};

use super::{gamma::upper_share, quadrature::Patch, quadrature::SphereFunction};
use crate::optics::{frame::Frame, frame::local_from_world, vector::Vec3};

/// Cells with a smaller expectation are pooled: below it the counts are not nearly normal.
pub const EXPECTATION_MIN: f64 = 5.0;
/// Relative error to which a cell's expectation is integrated, times the root of the number of samples: less than needed, as a
/// rule that misses an edge may agree with itself by chance. All cells so wrong would add 0.01 to the statistic.
const CELL_TOLERANCE: f64 = 0.1;

/// Cells on the sphere: rings around an axis, cut into equal sectors.
#[derive(Clone, Debug)]
pub struct PolarGrid {
    /// The axis is the normal.
    frame: Frame<f64>,
    /// Upper ends of the rings, radians, ascending, the last one π.
    ring_ends_rad: Vec<f64>,
    sectors: usize,
}

impl PolarGrid {
    /// Rings with equal numbers of the `pilot` samples. For narrow lobes the axis (the frame's normal) should be the mirror
    /// direction.
    pub fn following(
        frame: Frame<f64>,
        rings: usize,
        sectors: usize,
        pilot: impl IntoIterator<Item = Vec3<f64>>,
    ) -> Self {
        let mut angles: Vec<f64> = pilot.into_iter().map(|w| polar_angle_rad(&frame, w)).collect();
        angles.sort_by(f64::total_cmp);
        let quantile = |ring: usize| angles.get(ring * angles.len() / rings).copied();
        let mut ring_ends_rad: Vec<f64> = (1..rings)
            .filter_map(quantile)
            .filter(|a| *a > 0.0 && *a < PI)
            .collect();
        ring_ends_rad.dedup();
        // Beyond the pilot's last sample rings that grow by halves: one ring to π would be so wide that its nodes could
        // miss a narrow lobe's tail.
        let mut end = angles.last().copied().unwrap_or(PI).max(1e-6);
        while end < PI {
            ring_ends_rad.push(end);
            end *= 1.5;
        }
        ring_ends_rad.push(PI);
        Self {
            frame,
            ring_ends_rad,
            sectors,
        }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.ring_ends_rad.len() * self.sectors
    }

    /// The cell of a direction.
    pub fn cell(&self, direction: Vec3<f64>) -> usize {
        let local = local_from_world(&self.frame, direction);
        let polar = polar_angle_rad(&self.frame, direction);
        let ring = self
            .ring_ends_rad
            .partition_point(|end| *end < polar)
            .min(self.ring_ends_rad.len() - 1);
        let turn = (local.y.atan2(local.x) + PI) / TAU;
        ring * self.sectors + ((turn * self.sectors as f64) as usize).min(self.sectors - 1)
    }

    /// The cell's patch of the sphere.
    pub fn patch(&self, cell: usize) -> Patch {
        let (ring, sector) = (cell / self.sectors, cell % self.sectors);
        let start = if ring == 0 { 0.0 } else { self.ring_ends_rad[ring - 1] };
        let azimuth = |sector: usize| TAU * sector as f64 / self.sectors as f64 - PI;
        Patch {
            polar_rad: [start, self.ring_ends_rad[ring]],
            azimuth_rad: [azimuth(sector), azimuth(sector + 1)],
        }
    }

    /// The probability of each cell under `density` (per steradian), which may jump across the planes through the
    /// origin with the normals `cuts`. Exact to a thousandth of a count of `samples` in the smallest cells that matter.
    pub fn probabilities(&self, samples: u64, cuts: &[Vec3<f64>], density: impl Fn(Vec3<f64>) -> f64) -> Vec<f64> {
        let function = SphereFunction {
            frame: self.frame,
            cuts,
            f: density,
        };
        let count = samples.max(1) as f64;
        let relative = CELL_TOLERANCE / count.sqrt();
        let absolute = relative * EXPECTATION_MIN / count;
        let integral = |patch: Patch| function.integrate(patch, relative, absolute);
        let cell = |cell| narrow_rings(self.patch(cell)).map(integral).sum();
        (0..self.cells()).map(cell).collect()
    }
}

/// The patch cut into rings that end at one and a half times the angle at which they begin: the outermost ring may begin
/// within a hundredth of a degree, and all that is in it may lie there.
fn narrow_rings(patch: Patch) -> impl Iterator<Item = Patch> {
    let [start, end] = patch.polar_rad;
    let next = move |from: f64| if from > 0.0 { (1.5 * from).min(end) } else { end };
    std::iter::successors(Some([start, next(start)]), move |[_, to]| {
        (*to < end).then(|| [*to, next(*to)])
    })
    .map(move |polar_rad| Patch { polar_rad, ..patch })
}

/// Angle to the frame's normal in radians, exact near 0.
fn polar_angle_rad(frame: &Frame<f64>, direction: Vec3<f64>) -> f64 {
    let local = local_from_world(frame, direction);
    local.x.hypot(local.y).atan2(local.z)
}

/// The outcome of a test.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ChiSquare {
    /// Σ (observed − expected)²/expected over the pooled cells.
    pub statistic: f64,
    /// Pooled cells less one.
    pub degrees_of_freedom: u32,
    /// Probability of a statistic at least this large if the samples do follow the density.
    pub p_value: f64,
}

/// Tests directions against a density. `samples` has `None` for an absorbed sample; there should be about twenty or more per
/// cell. `cuts` as for [`PolarGrid::probabilities`].
pub fn test_samples(
    grid: &PolarGrid,
    samples: &[Option<Vec3<f64>>],
    cuts: &[Vec3<f64>],
    density: impl Fn(Vec3<f64>) -> f64,
) -> ChiSquare {
    let mut observed = vec![0_u64; grid.cells() + 1];
    for sample in samples {
        observed[sample.map_or(grid.cells(), |direction| grid.cell(direction))] += 1;
    }
    let count = samples.len() as u64;
    let mut expected: Vec<f64> = grid.probabilities(count, cuts, density);
    expected.push((1.0 - expected.iter().sum::<f64>()).max(0.0));
    expected.iter_mut().for_each(|probability| *probability *= count as f64);
    test_counts(&observed, &expected)
}

/// Tests counts against their expectations. Cells expected to have fewer than [`EXPECTATION_MIN`] are pooled. Non-finite
/// expectations, or counts where the expectation is 0, give a p-value of 0.
pub fn test_counts(observed: &[u64], expected: &[f64]) -> ChiSquare {
    let mut cells: Vec<(f64, f64)> = observed.iter().zip(expected).map(|(o, e)| (*e, *o as f64)).collect();
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut statistic, mut used) = (0.0, 0_u32);
    let mut pool = (0.0, 0.0);
    for (expectation, count) in cells {
        pool = (pool.0 + expectation, pool.1 + count);
        if pool.0 >= EXPECTATION_MIN || !pool.0.is_finite() {
            statistic += (pool.1 - pool.0).powi(2) / pool.0;
            used += 1;
            pool = (0.0, 0.0);
        }
    }
    // The rest, if all cells together expect too little for a test.
    let impossible = used == 0 && pool.1 > 0.0 && pool.0 < 1e-9;
    let degrees_of_freedom = used.saturating_sub(1);
    let p_value = if !statistic.is_finite() || impossible {
        0.0
    } else if degrees_of_freedom == 0 {
        1.0
    } else {
        upper_tail(statistic, f64::from(degrees_of_freedom))
    };
    ChiSquare {
        statistic,
        degrees_of_freedom,
        p_value,
    }
}

/// Probability that a χ² variable of so many degrees of freedom is at least `statistic`.
pub fn upper_tail(statistic: f64, degrees_of_freedom: f64) -> f64 {
    if statistic <= 0.0 {
        1.0
    } else {
        upper_share(0.5 * degrees_of_freedom, 0.5 * statistic)
    }
}

/// The p-value below which one of `cases` independent tests fails, so that all of them together fail by chance with
/// probability `level` (Šidák 1967).
pub fn sidak_level(level: f64, cases: usize) -> f64 {
    -((-level).ln_1p() / cases.max(1) as f64).exp_m1()
}
