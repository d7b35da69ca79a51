//! Rays against the geometry.

use glam::{UVec2, Vec3A};
use obvhs::ray::Ray;

use super::geometry::Geometry;

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in lengths of the ray's direction, above 0.
    pub t: f32,
    /// Which triangle of [`Geometry::triangles`].
    pub triangle: u32,
    /// Weight of the triangle's second corner.
    pub u: f32,
    /// Weight of the triangle's third corner; the first has 1 − u − v.
    pub v: f32,
}

/// A ray and the plane that triangles are projected to along it: x and y of a place p are `axis_x · (p − origin)` and
/// `axis_y · (p − origin)`, both 0 on the ray. The axes are the shear of Woop, Benthin and Wald ("Watertight
/// Ray/Triangle Intersection", JCGT 2013): of each axis one component is 1 and one 0.
#[derive(Clone, Copy, Debug)]
pub struct RayFrame {
    /// Where the ray starts.
    pub origin: Vec3A,
    /// Where it goes; any length but 0.
    pub direction: Vec3A,
    /// First axis of the projection.
    pub axis_x: Vec3A,
    /// Second axis of the projection.
    pub axis_y: Vec3A,
}

impl RayFrame {
    /// The frame of a ray; a direction that is zero or not finite gives a frame that hits nothing.
    #[inline(always)]
    pub fn new(origin: Vec3A, direction: Vec3A) -> Self {
        let (d, size) = (direction, direction.abs());
        let (axis_x, axis_y) = if size.z >= size.x && size.z >= size.y {
            (Vec3A::new(1.0, 0.0, -d.x / d.z), Vec3A::new(0.0, 1.0, -d.y / d.z))
        } else if size.y >= size.x {
            (Vec3A::new(1.0, -d.x / d.y, 0.0), Vec3A::new(0.0, -d.z / d.y, 1.0))
        } else {
            (Vec3A::new(-d.y / d.x, 1.0, 0.0), Vec3A::new(-d.z / d.x, 0.0, 1.0))
        };
        Self {
            origin,
            direction,
            axis_x,
            axis_y,
        }
    }
}

/// The ray against one triangle, from either side: (t, u, v) as in [`Hit`] where 0 < t < `t_max`.
///
/// Watertight: a corner is projected alike for every triangle it belongs to, and the products of an edge's test are
/// the negatives of each other in the two triangles that share the edge. Rounding keeps their order, so a ray through
/// a closed mesh always hits some triangle at each crossing; one exactly on an edge hits both. A twin must keep the
/// products as they are (no fused multiply-add, no reordering).
#[inline(always)]
pub fn intersect_triangle(ray: &RayFrame, v0: Vec3A, v1: Vec3A, v2: Vec3A, t_max: f32) -> Option<(f32, f32, f32)> {
    let (a, b, c) = (v0 - ray.origin, v1 - ray.origin, v2 - ray.origin);
    let (ax, ay) = (ray.axis_x.dot(a), ray.axis_y.dot(a));
    let (bx, by) = (ray.axis_x.dot(b), ray.axis_y.dot(b));
    let (cx, cy) = (ray.axis_x.dot(c), ray.axis_y.dot(c));
    // Twice the areas that the ray cuts the projected triangle into, opposite to v0, v1 and v2.
    let area_a = cx * by - cy * bx;
    let area_b = ax * cy - ay * cx;
    let area_c = bx * ay - by * ax;
    let any_negative = area_a < 0.0 || area_b < 0.0 || area_c < 0.0;
    let any_positive = area_a > 0.0 || area_b > 0.0 || area_c > 0.0;
    let area = area_a + area_b + area_c;
    if (any_negative && any_positive) || area == 0.0 {
        return None;
    }
    // The distance by the plane: exact in sign for planes along the axes, whatever the triangle's size.
    let normal = (v1 - v0).cross(v2 - v0);
    let t = normal.dot(a) / normal.dot(ray.direction);
    // False for NaN, too.
    (t > 0.0 && t < t_max).then_some((t, area_b / area, area_c / area))
}

/// The direction with every −0 made 0: obvhs takes the sign of a direction in one place by its bit, in another by
/// comparing it with 0, and would look for boxes on the wrong side.
#[inline(always)]
fn without_negative_zero(direction: Vec3A) -> Vec3A {
    direction + Vec3A::ZERO
}

impl Geometry {
    /// The nearest triangle along a ray, in the geometry's units, with 0 < t < `t_max`.
    pub fn intersect(&self, origin: [f32; 3], direction: [f32; 3], t_max: f32) -> Option<Hit> {
        let frame = RayFrame::new(origin.into(), direction.into());
        let mut ray = Ray::new(frame.origin, without_negative_zero(frame.direction), 0.0, t_max);
        let mut nearest = None;
        let mut state = self.bvh.new_traversal(ray.direction);
        let mut node;
        obvhs::traverse!(self.bvh, node, state, node.intersect_ray(&ray, state.oct_inv4), {
            let [v0, v1, v2] = self.corners(state.primitive_id as usize).map(Vec3A::from_array);
            if let Some((t, u, v)) = intersect_triangle(&frame, v0, v1, v2, ray.tmax) {
                nearest = Some(Hit {
                    t,
                    triangle: state.primitive_id,
                    u,
                    v,
                });
                ray.tmax = t;
            }
        });
        nearest
    }

    /// Whether any triangle is met with 0 < t < `t_max`.
    pub fn occluded(&self, origin: [f32; 3], direction: [f32; 3], t_max: f32) -> bool {
        let frame = RayFrame::new(origin.into(), direction.into());
        let ray = Ray::new(frame.origin, without_negative_zero(frame.direction), 0.0, t_max);
        let mut state = self.bvh.new_traversal(ray.direction);
        let mut node;
        let mut met = false;
        obvhs::traverse!(self.bvh, node, state, node.intersect_ray(&ray, state.oct_inv4), {
            let [v0, v1, v2] = self.corners(state.primitive_id as usize).map(Vec3A::from_array);
            if intersect_triangle(&frame, v0, v1, v2, t_max).is_some() {
                met = true;
                break;
            }
        });
        met
    }
}
