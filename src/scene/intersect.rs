//! A ray against a triangle.

use glam::{Vec3A, Vec3Swizzles};

use crate::optics::prelude::*;

/// A hit of a ray on a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hit {
    /// Distance in lengths of the ray's direction, above 0.
    pub t: f32,
    /// Index into [`Geometry::triangles`](super::Geometry::triangles).
    pub triangle: u32,
    /// Weight of the triangle's second corner.
    pub u: f32,
    /// Weight of the triangle's third corner; the first has 1 − u − v.
    pub v: f32,
}

impl Hit {
    /// The hit at distance `t` from the areas into which the ray divides the triangle, opposite to its corners.
    pub fn of(t: f32, triangle: u32, [u, v, w]: [f32; 3]) -> Self {
        let area = u + v + w;
        Self {
            t,
            triangle,
            // Without the sign of a zero, which depends on the order of corners.
            u: v / area + 0.0,
            v: w / area + 0.0,
        }
    }
}

/// A ray and the plane that triangles are projected to along it: x and y of a place p are `axis_x · (p − origin)` and
/// `axis_y · (p − origin)`, both 0 on the ray. The axes are the shear of Woop, Benthin and Wald ("Watertight
/// Ray/Triangle Intersection", JCGT 2013): of each axis one component is 1 and one 0.
#[derive(Clone, Copy, Debug)]
pub struct RayFrame {
    pub origin: Vec3A,
    /// Ray direction, of any length but 0.
    pub direction: Vec3A,
    /// First axis of the projection.
    pub axis_x: Vec3A,
    /// Second axis of the projection.
    pub axis_y: Vec3A,
    /// Coordinate axes: the one that `axis_x` keeps, the one that `axis_y` keeps, and the one along which both are sheared.
    pub axes: [usize; 3],
}

impl RayFrame {
    /// The frame of a ray; a direction that is zero or not finite gives a frame that hits nothing.
    pub fn new(origin: Vec3A, direction: Vec3A) -> Self {
        let (d, size) = (direction, direction.abs());
        let (axes, axis_x, axis_y) = if size.z >= size.x && size.z >= size.y {
            let (x, y) = (-d.x / d.z, -d.y / d.z);
            ([0, 1, 2], Vec3A::new(1.0, 0.0, x), Vec3A::new(0.0, 1.0, y))
        } else if size.y >= size.x {
            let (x, y) = (-d.x / d.y, -d.z / d.y);
            ([0, 2, 1], Vec3A::new(1.0, x, 0.0), Vec3A::new(0.0, y, 1.0))
        } else {
            let (x, y) = (-d.y / d.x, -d.z / d.x);
            ([1, 2, 0], Vec3A::new(x, 1.0, 0.0), Vec3A::new(y, 0.0, 1.0))
        };
        Self {
            origin,
            direction,
            axis_x,
            axis_y,
            axes,
        }
    }

    /// Twice the signed areas into which the ray divides a projected triangle, opposite to its corners. A hit has equal
    /// signs.
    fn areas(&self, [v0, v1, v2]: [Vec3A; 3]) -> Vec3A {
        // The projected corners, one a lane.
        let x = Vec3A::new(v0.x, v1.x, v2.x) - self.origin.x;
        let y = Vec3A::new(v0.y, v1.y, v2.y) - self.origin.y;
        let z = Vec3A::new(v0.z, v1.z, v2.z) - self.origin.z;
        let px = x * self.axis_x.x + y * self.axis_x.y + z * self.axis_x.z;
        let py = x * self.axis_y.x + y * self.axis_y.y + z * self.axis_y.z;
        let (from_x, from_y, to_x, to_y) = (px.zxy(), py.zxy(), px.yzx(), py.yzx());
        let is_turned = from_x.cmpgt(to_x) | (from_x.cmpeq(to_x) & from_y.cmpgt(to_y));
        let (low_x, high_x) = (
            Vec3A::select(is_turned, to_x, from_x),
            Vec3A::select(is_turned, from_x, to_x),
        );
        let (low_y, high_y) = (
            Vec3A::select(is_turned, to_y, from_y),
            Vec3A::select(is_turned, from_y, to_y),
        );
        let ordered = low_x * high_y - low_y * high_x;
        Vec3A::select(is_turned, -ordered, ordered)
    }
}

/// A vector along a triangle's normal, by the right hand: the product of its two shorter edges over the square of the
/// longest. The product of two long edges of a needle would be rounding noise, and that of two tiny ones underflow where
/// it is squared. 0 where the triangle has no area.
#[inline(always)]
pub fn triangle_normal<T: Real>([p0, p1, p2]: [Vec3<T>; 3]) -> Vec3<T> {
    let (a, b, c) = (p1 - p0, p2 - p1, p0 - p2);
    let (aa, bb, cc) = (a.dot(a), b.dot(b), c.dot(c));
    let a_is_longest = !aa.less(bb) & !aa.less(cc);
    let b_is_longest = !a_is_longest & !bb.less(cc);
    let left = Vec3::select(a_is_longest, b, Vec3::select(b_is_longest, c, a));
    let right = Vec3::select(a_is_longest, c, Vec3::select(b_is_longest, a, b));
    left.cross(right) / aa.max(bb).max(cc).max(T::from_f64(1e-37))
}

/// The ray against one triangle, from either side: (t, u, v) as in [`Hit`] where 0 < t < `t_max`.
///
/// Watertight: a corner is projected alike for every triangle it belongs to, and an edge's area is computed from its
/// corners in an order of their own (by their projections), then given the triangle's sign. So the two triangles that
/// share an edge get the same number with opposite signs however the products are rounded, also where a GPU's driver
/// fuses them; a ray through a closed mesh always hits some triangle at each crossing, one exactly on an edge hits both.
pub fn intersect_triangle(ray: &RayFrame, v0: Vec3A, v1: Vec3A, v2: Vec3A, t_max: f32) -> Option<(f32, f32, f32)> {
    let a = v0 - ray.origin;
    let areas = ray.areas([v0, v1, v2]);
    let area = areas.x + areas.y + areas.z;
    if (areas.min_element() < 0.0 && areas.max_element() > 0.0) || area == 0.0 {
        return None;
    }
    // The distance by the plane: exact in sign for axis-aligned planes, for any size of triangle.
    let normal = triangle_normal([v0, v1, v2].map(|v| vec3(v.x, v.y, v.z)));
    let normal = Vec3A::new(normal.x, normal.y, normal.z);
    let t = normal.dot(a) / normal.dot(ray.direction);
    // False for NaN, too.
    (t > 0.0 && t < t_max).then_some((t, areas.y / area, areas.z / area))
}
