//! Traversal of two levels: a hierarchy over the boxes of instances, and below each instance the hierarchy of its mesh.
//!
//! The boxes of a mesh are tested in its own space. Its triangles are tested in the geometry's space, with corners moved as by
//! [`Placement::point`]. So hits are those on the same triangles stored one by one, to the bit, and watertight like them.

use fearless_simd::{ExtractToken, Level, Simd, SimdBase, f32x8};
use glam::{DAffine3, DMat3, DVec3, Mat3A, Vec3A};

use super::traverse::{BoxRay, ClosestHit, HitSink, Leaves, RELATIVE_ERROR, SingleRay, StackEntry, TriangleRay};
use super::wide::{Block, Normals, WIDTH, Wide};
use crate::{
    optics::vector::Vec3,
    scene::intersect::{Hit, RayFrame, triangle_normal},
    scene::transform::normal_matrix,
};

/// Relative error bound of a ray moved to a mesh's space and of corners moved out of it: some ten roundings of each.
const PLACEMENT_ERROR: f32 = 1e-6;
/// Bound of the coordinates that count beside a ray's origin: corners, offsets and hits.
const EXTENT: f32 = 4.0;

/// Where an instance's mesh is.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// Images of the mesh's axes, and of its origin.
    axes: [[f32; 3]; 3],
    offset: [f32; 3],
    /// From directions to the mesh's space.
    inverse: Mat3A,
    /// Sums of the rows of `inverse` without signs.
    reach: Vec3A,
    /// Transform of normals, up to a positive factor.
    normals_from: Mat3A,
    /// True if the mesh is mirrored: its triangles are turned round.
    pub mirrors: bool,
}

impl Placement {
    /// A placement by a transform that can be inverted.
    pub fn new(units_from_mesh: DAffine3) -> Self {
        let axes = units_from_mesh
            .matrix3
            .to_cols_array_2d()
            .map(|axis| axis.map(|x| x as f32));
        // Of the rounded numbers, by which corners are moved.
        let linear = DMat3::from_cols_array_2d(&axes.map(|axis| axis.map(f64::from)));
        let inverse = linear.inverse();
        let rows = inverse.transpose();
        let sum = |row: DVec3| row.abs().element_sum() as f32;
        Self {
            axes,
            offset: units_from_mesh.translation.as_vec3().to_array(),
            inverse: Mat3A::from(inverse.as_mat3()),
            reach: Vec3A::new(sum(rows.x_axis), sum(rows.y_axis), sum(rows.z_axis)),
            normals_from: Mat3A::from(normal_matrix(linear).as_mat3()),
            mirrors: linear.determinant() < 0.0,
        }
    }

    /// The place of a point of the mesh, by the same roundings as those of a block's corners.
    pub fn point(&self, point: [f32; 3]) -> [f32; 3] {
        [0, 1, 2].map(|i| {
            let [x, y, z] = [0, 1, 2].map(|axis| self.axes[axis][i] * point[axis]);
            x + y + z + self.offset[i]
        })
    }

    /// Area here over that in the mesh, in the mean over directions if these differ.
    pub fn area_scale(&self) -> f64 {
        let [x, y, z] = self.axes.map(|axis| DVec3::from_array(axis.map(f64::from)));
        x.cross(y).dot(z).abs().powf(2.0 / 3.0)
    }

    /// Values of a triangle's corners in its order here.
    pub fn in_order<V>(&self, [a, b, c]: [V; 3]) -> [V; 3] {
        if self.mirrors { [a, c, b] } else { [a, b, c] }
    }

    /// A normal here; 0 stays 0.
    pub fn normal(&self, normal: [f32; 3]) -> [f32; 3] {
        (self.normals_from * Vec3A::from_array(normal))
            .normalize_or_zero()
            .to_array()
    }

    /// A tangent here, with the sign of its bitangent.
    pub fn tangent(&self, [along_x, along_y, along_z, side]: [f32; 4]) -> [f32; 4] {
        let [x, y, z] = self.axes.map(Vec3A::from_array);
        let [x, y, z] = (x * along_x + y * along_y + z * along_z).normalize_or_zero().to_array();
        [x, y, z, if self.mirrors { -side } else { side }]
    }

    /// A ray against the mesh's boxes.
    #[inline(always)]
    fn box_ray<S: Simd>(&self, simd: S, frame: &RayFrame, wide: &Wide) -> BoxRay<S> {
        let origin = self.inverse * (frame.origin - Vec3A::from_array(self.offset));
        let direction = self.inverse * frame.direction;
        let slack = self.reach * (PLACEMENT_ERROR * (EXTENT + frame.origin.abs().max_element()));
        let error = (wide.reach + origin.abs()) * RELATIVE_ERROR + slack;
        BoxRay::with_margin(simd, origin, direction, |size| error * size)
    }

    /// A block of the mesh's triangles here.
    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, block: &Block) -> Block {
        let mut placed = *block;
        let mut corner = 0;
        while corner < 3 {
            let from = &block.corners[if self.mirrors { (3 - corner) % 3 } else { corner }];
            let [x, y, z] = [0, 1, 2].map(|axis| f32x8::load_array_ref(simd, &from[axis]));
            let mut i = 0;
            while i < 3 {
                let [along_x, along_y, along_z] = [0, 1, 2].map(|axis| f32x8::splat(simd, self.axes[axis][i]));
                let moved = along_x * x + along_y * y + along_z * z + f32x8::splat(simd, self.offset[i]);
                placed.corners[corner][i] = moved.to_array();
                i += 1;
            }
            corner += 1;
        }
        placed
    }
}

/// What is below an instance.
pub struct Bottom<'a> {
    pub wide: &'a Wide,
    pub placement: &'a Placement,
    /// First triangle.
    pub first: u32,
}

impl Wide {
    /// The closest hit with 0 < t < `t_max` on the instances whose boxes these are, or any hit if `ANY`; `bottom` gives each.
    pub fn hit_below<'a, const ANY: bool>(
        &self,
        level: Level,
        frame: &RayFrame,
        t_max: f32,
        bottom: impl Fn(u32) -> Bottom<'a>,
    ) -> Option<Hit> {
        dispatch!(level, simd => trace::<_, ANY>(simd, self, frame, t_max, &bottom))
    }
}

/// The closest hit, or any hit if `ANY`.
#[inline(always)]
fn trace<'a, S: Simd, const ANY: bool>(
    simd: S,
    top: &Wide,
    frame: &RayFrame,
    t_max: f32,
    bottom: &impl Fn(u32) -> Bottom<'a>,
) -> Option<Hit> {
    let instances = InstanceRay {
        frame,
        boxes: BoxRay::new(simd, frame, top),
        triangles: TriangleRay::new(simd, frame),
        bottom,
    };
    let ray = SingleRay {
        boxes: BoxRay::new(simd, frame, top),
        leaves: instances,
    };
    let mut closest = ClosestHit::before(t_max);
    ray.traverse::<ANY, _>(top, StackEntry::ROOT, &mut closest);
    closest.hit()
}

/// A ray prepared for tests against instances.
struct InstanceRay<'r, S: Simd, F> {
    frame: &'r RayFrame,
    boxes: BoxRay<S>,
    triangles: TriangleRay<S>,
    bottom: &'r F,
}

impl<'a, S: Simd, F: Fn(u32) -> Bottom<'a>> Leaves for InstanceRay<'_, S, F> {
    /// Tests the instances of a block, the nearest box first.
    #[inline(always)]
    fn intersect<const ANY: bool, M: HitSink>(&self, wide: &Wide, block: usize, _: f32, sink: &mut M) -> bool {
        let [low, high, _] = &wide.blocks[block].corners;
        let (mut hit_bits, near) = self.boxes.intersect_boxes([low, high], sink.t_max());
        while hit_bits != 0 {
            let lanes = (0..WIDTH).filter(|lane| hit_bits >> lane & 1 == 1);
            let Some(lane) = lanes.min_by(|a, b| near[*a].total_cmp(&near[*b])) else {
                break;
            };
            hit_bits &= !(1 << lane);
            if near[lane] > sink.t_max() {
                break;
            }
            let below = (self.bottom)(wide.firsts[block] + lane as u32);
            let simd = self.triangles.origin[0].token();
            let ray = SingleRay {
                boxes: below.placement.box_ray(simd, self.frame, below.wide),
                leaves: PlacedRay {
                    triangles: &self.triangles,
                    placement: below.placement,
                    first: below.first,
                },
            };
            if ray.traverse::<ANY, M>(below.wide, StackEntry::ROOT, sink) {
                return true;
            }
        }
        false
    }
}

/// A ray prepared for tests against an instance's triangles.
struct PlacedRay<'r, S: Simd> {
    triangles: &'r TriangleRay<S>,
    placement: &'r Placement,
    first: u32,
}

impl<S: Simd> Leaves for PlacedRay<'_, S> {
    #[inline(always)]
    fn intersect<const ANY: bool, M: HitSink>(&self, wide: &Wide, block: usize, entered: f32, sink: &mut M) -> bool {
        let placed = self
            .placement
            .block(self.triangles.origin[0].token(), &wide.blocks[block]);
        let Some(inside) = self.triangles.inside(&placed) else {
            return false;
        };
        let hits = self
            .triangles
            .hits(&placed, &normals(&placed), inside, [entered, sink.t_max()]);
        hits.record(self.first + wide.firsts[block], sink)
    }
}

/// The normals of a block's triangles.
fn normals(block: &Block) -> Normals {
    let mut axes = [[f32::NAN; WIDTH]; 3];
    for lane in 0..WIDTH {
        let corner = |corner: usize| [0, 1, 2].map(|axis| block.corners[corner][axis][lane]);
        let normal = triangle_normal([corner(0), corner(1), corner(2)].map(Vec3::<f32>::from_f32)).to_f32();
        for (lanes, coordinate) in axes.iter_mut().zip(normal) {
            lanes[lane] = coordinate;
        }
    }
    Normals { axes }
}
