//! Quadrature over directions, adapted to lobes: the pole on the mirror direction, narrow rings where the lobe is large.

use crate::{
    optics::lobe::model::{NORMAL, view_direction},
    optics::vector::{Vec3, vec3},
    parallel,
};

/// Side of the surface to integrate over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Above,
    Below,
}

/// A function of the direction towards the light, for a view that is settled.
pub type Profile<'a> = &'a (dyn Fn(Vec3<f64>) -> f64 + Sync);

/// Directions with their solid angles.
#[derive(Clone, Debug)]
pub struct SphereGrid {
    /// Unit directions with their solid angles in steradians.
    pub points: Vec<(Vec3<f64>, f64)>,
}

/// Radius of the innermost ring, radians.
const RING_FIRST: f64 = 1e-5;
/// Each ring of the first pass is this much wider than the one within.
const RING_RATIO: f64 = 1.2;
/// Largest share of any of the functions in a ring of the second pass; rings with less than the least are joined.
const SHARE_MAX: f64 = 1.0 / 48.0;
const SHARE_MIN: f64 = 1.0 / 2000.0;
/// Azimuths on half a circle under a view along the normal.
const AZIMUTHS: f64 = 14.0;
/// Nodes and weights of the 2-point Gauss–Legendre rule on [0, 1].
const NODES: [[f64; 2]; 2] = [[0.211_324_865_405_187_1, 0.5], [0.788_675_134_594_812_9, 0.5]];

impl SphereGrid {
    /// A grid for integrals of `profiles`, seen under `view_angle_rad`. `is_symmetric` says that all profiles look the
    /// same on both sides of the plane of incidence: half the circle is then enough.
    pub fn adapted(view_angle_rad: f64, side: Side, is_symmetric: bool, profiles: &[Profile]) -> Self {
        let pole = Pole::new(view_angle_rad, side, is_symmetric);
        let fine = ring_edges(&pole, profiles);
        Self {
            points: fine.windows(2).flat_map(|pair| pole.ring([pair[0], pair[1]])).collect(),
        }
    }

    /// The profile at the points, in their order.
    pub fn values(&self, profile: Profile) -> Vec<f64> {
        parallel::map_each(&self.points, |(direction, _)| profile(*direction))
    }

    /// The integral of values at the points.
    pub fn integral(&self, values: &[f64]) -> f64 {
        self.points
            .iter()
            .zip(values)
            .map(|((_, solid_angle), value)| solid_angle * value)
            .sum()
    }
}

/// Ring edges in radians from the mirror direction: finer where any of the profiles is larger.
fn ring_edges(pole: &Pole, profiles: &[Profile]) -> Vec<f64> {
    let mut edges = vec![0.0];
    let mut edge = RING_FIRST;
    while edge < std::f64::consts::PI {
        edges.push(edge);
        edge *= RING_RATIO;
    }
    edges.push(std::f64::consts::PI);
    let shares = ring_shares(pole, &edges, profiles);
    let mut fine = vec![0.0];
    let mut joined = 0.0;
    for (pair, share) in edges.windows(2).zip(shares) {
        joined += share;
        if joined < SHARE_MIN && pair[1] < std::f64::consts::PI {
            continue;
        }
        let start = fine[fine.len() - 1];
        let pieces = (joined / SHARE_MAX).ceil().max(1.0);
        let width = (pair[1] - start) / pieces;
        fine.extend((1..=pieces as usize).map(|i| start + width * i as f64));
        joined = 0.0;
    }
    fine
}

/// Directions on rings about the mirror direction, `azimuths` on each all around, the rings as in
/// [`SphereGrid::adapted`] from `innermost_rad` on; where the horizon cuts a ring its directions lie on the horizon.
pub fn rings(
    view_angle_rad: f64,
    is_symmetric: bool,
    profiles: &[Profile],
    azimuths: usize,
    innermost_rad: f64,
) -> Vec<Vec<Vec3<f64>>> {
    let pole = Pole::new(view_angle_rad, Side::Above, is_symmetric);
    let ring = |edge: &f64| {
        let direction = |i: usize| {
            let phi_rad = std::f64::consts::TAU * i as f64 / azimuths as f64;
            // A hair above, so that it counts as above.
            pole.direction(phi_rad, edge.min(pole.horizon(phi_rad) - 1e-9))
        };
        (0..azimuths).map(direction).collect()
    };
    let edges = ring_edges(&pole, profiles).into_iter();
    let edges = edges.filter(|edge| *edge > innermost_rad.max(RING_FIRST));
    std::iter::once(innermost_rad.max(RING_FIRST))
        .chain(edges)
        .map(|edge| ring(&edge))
        .collect()
}

/// For each ring the largest share that one of the profiles has in it.
fn ring_shares(pole: &Pole, edges: &[f64], profiles: &[Profile]) -> Vec<f64> {
    let rings: Vec<_> = edges.windows(2).map(|pair| pole.ring([pair[0], pair[1]])).collect();
    let mut shares = vec![0.0_f64; rings.len()];
    for profile in profiles {
        let in_ring = |ring: &Vec<(Vec3<f64>, f64)>| ring.iter().map(|(w, area)| area * profile(*w)).sum();
        let contents: Vec<f64> = parallel::map_each(&rings, in_ring);
        let total: f64 = contents.iter().sum();
        for (share, content) in shares.iter_mut().zip(contents) {
            *share = share.max(if total > 0.0 { content / total } else { 0.0 });
        }
    }
    shares
}

/// Polar coordinates about the mirror direction, cut off at the horizon.
struct Pole {
    mirror: Vec3<f64>,
    across: Vec3<f64>,
    cosine: f64,
    sine: f64,
    side: Side,
    azimuths: usize,
    /// The circle, or half of it.
    span_rad: f64,
    /// Multiplicity of each point.
    multiplicity: f64,
}

impl Pole {
    fn new(view_angle_rad: f64, side: Side, is_symmetric: bool) -> Self {
        let view = view_direction(view_angle_rad);
        let mirror = view.mirrored_about(NORMAL);
        let (cosine, sine) = (mirror.z, mirror.x);
        // Lobes get thin across the plane of incidence towards grazing angles.
        let half_circle = (AZIMUTHS / cosine.max(0.1)) as usize;
        let is_round = sine == 0.0 && is_symmetric;
        let (azimuths, span_rad, multiplicity) = match (is_round, is_symmetric) {
            (true, _) => (1, std::f64::consts::PI, 2.0),
            (_, true) => (half_circle, std::f64::consts::PI, 2.0),
            _ => (2 * half_circle, std::f64::consts::TAU, 1.0),
        };
        Self {
            mirror,
            across: vec3(cosine, 0.0, -sine),
            cosine,
            sine,
            side,
            azimuths,
            span_rad,
            multiplicity,
        }
    }

    /// Angle from the mirror direction, in radians, at which the great circle of an azimuth crosses the horizon.
    fn horizon(&self, phi_rad: f64) -> f64 {
        self.cosine.atan2(self.sine * phi_rad.cos())
    }

    /// The direction `alpha_rad` from the mirror direction; the azimuth is 0 away from the normal.
    fn direction(&self, phi_rad: f64, alpha_rad: f64) -> Vec3<f64> {
        let around = self.across * phi_rad.cos() + vec3(0.0, phi_rad.sin(), 0.0);
        self.mirror * alpha_rad.cos() + around * alpha_rad.sin()
    }

    /// The points of a ring between two angles from the mirror direction: two of Gauss's nodes at each azimuth, between
    /// the edges as the horizon cuts them.
    fn ring(&self, edges: [f64; 2]) -> Vec<(Vec3<f64>, f64)> {
        let step_rad = self.span_rad / self.azimuths as f64;
        let mut points = Vec::with_capacity(2 * self.azimuths);
        for i in 0..self.azimuths {
            let phi_rad = step_rad * (i as f64 + 0.5);
            let horizon = self.horizon(phi_rad);
            let [inner, outer] = match self.side {
                Side::Above => edges.map(|edge| edge.min(horizon)),
                Side::Below => edges.map(|edge| edge.max(horizon)),
            };
            if outer <= inner {
                continue;
            }
            for [place, weight] in NODES {
                let alpha_rad = inner + (outer - inner) * place;
                let solid_angle = weight * (outer - inner) * alpha_rad.sin() * step_rad * self.multiplicity;
                points.push((self.direction(phi_rad, alpha_rad), solid_angle));
            }
        }
        points
    }
}
