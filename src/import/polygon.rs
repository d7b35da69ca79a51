//! Polygons as triangles, by the earcut crate where a fan from the first corner does not fit.

use earcut::{Earcut, utils3d::project3d_to_2d};
use glam::DVec3;

use crate::scene::report::{Fate, ImportReport};

/// The largest sum of squared numbers of corners of a file's concave polygons, those of few corners aside: the time of cutting grows
/// with it at worst, to a minute.
const WORK_MAX: usize = 1 << 31;
const FEW: usize = 256;

/// Twice a polygon's area, along its normal.
pub fn doubled_area(places: &[DVec3]) -> DVec3 {
    let from_first = |w: &[DVec3]| (w[0] - places[0]).cross(w[1] - places[0]);
    places.windows(2).map(from_first).sum()
}

/// Cuts polygons, with memory that it keeps for the next one.
pub struct Polygons {
    earcut: Earcut<f64>,
    flat: Vec<[f64; 2]>,
    found: Vec<u32>,
    work: usize,
    /// Concave polygons that were too much work, and became fans.
    uncut: usize,
}

impl Polygons {
    pub fn new() -> Self {
        Self {
            earcut: Earcut::new(),
            flat: Vec::new(),
            found: Vec::new(),
            work: 0,
            uncut: 0,
        }
    }

    /// Triangles of a polygon as places in its list of corners, in its orientation.
    pub fn cut(&mut self, corners: &[DVec3]) -> &[[u32; 3]] {
        self.found.clear();
        let count = corners.len();
        let is_concave = count > 3 && corners.iter().all(|corner| corner.is_finite()) && !is_convex(corners);
        let work = if count > FEW { count.saturating_mul(count) } else { 0 };
        if is_concave && work > WORK_MAX - self.work {
            self.uncut += 1;
        } else if is_concave {
            self.work += work;
            // Relative to one of them, since the crate takes a normal from products of places.
            let places: Vec<[f64; 3]> = corners.iter().map(|corner| (corner - corners[0]).to_array()).collect();
            if project3d_to_2d(&places, count, &mut self.flat) {
                self.earcut.earcut(self.flat.iter().copied(), &[], &mut self.found);
            }
        }
        if self.found.is_empty() {
            self.found
                .extend((2..count as u32).flat_map(|last| [0, last - 1, last]));
        }
        self.found.as_chunks().0
    }

    /// Reports those that became fans.
    pub fn report(&self, report: &mut ImportReport) {
        let what = "concave faces of very many corners, as if they were convex";
        report.count(Fate::Approximated, what, "", self.uncut);
    }
}

/// Whether every corner turns as the whole polygon does.
fn is_convex(corners: &[DVec3]) -> bool {
    let count = corners.len();
    let spokes = (2..count).map(|i| (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]));
    let normal: DVec3 = spokes.sum();
    let side = |i: usize| corners[(i + 1) % count] - corners[i % count];
    (0..count).all(|i| side(i).cross(side(i + 1)).dot(normal) >= 0.0)
}
