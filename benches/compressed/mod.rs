//! Single rays through the GPU's hierarchy on the processor, as shaders/scene/bvh.wgsl has them: what the processor's own
//! hierarchy is measured against, and the oracle of its tests.
//!
//! Traversal and box test are our own rather than those of obvhs: its box test takes −0 in a direction for negative
//! when it inverts and for positive when it picks planes, loses boxes to rounding, ignores what is nearer than 1e-4,
//! and uses 128-bit vectors at most. Here a box is lost only if the ray passes it by, and eight boxes are tested at
//! once where the processor has AVX2.
use glam::Vec3A;
use glossmith::scene::{Compressed, Hit, Part, RayFrame, intersect_triangle};
use obvhs::cwbvh::node::CwBvhNode;

/// Groups of nodes still to be visited. A level adds one at most, and hierarchies are built no deeper.
const STACK_SIZE: usize = 32;

/// Makes up for the rounding of a box's far side (1 + 2γ₃ of Ize, "Robust BVH Ray Traversal", JCGT 2013, rounded up).
const FAR_MARGIN: f32 = 1.000_000_5;

/// Places relative to the ray's origin are off by at most this part of both: ten roundings, four of a box's plane and six
/// of a triangle's projected corner. So a far eye loses nothing.
const PLACE_ERROR: f32 = 6e-7;

/// Inverse directions are at most this, so that their products with distances stay finite.
const INVERSE_MAX: f32 = 1e18;

/// The GPU's hierarchy with its triangles in its own order.
pub struct CompressedRays<'a> {
    compressed: &'a Compressed,
    corners: Vec<[Vec3A; 3]>,
}

impl<'a> CompressedRays<'a> {
    pub fn new(part: &'a Part) -> Self {
        let compressed = part.compressed();
        let corners = |&triangle: &u32| part.corners(triangle as usize).map(Vec3A::from_array);
        Self {
            compressed,
            corners: compressed.triangles.iter().map(corners).collect(),
        }
    }

    /// The nearest triangle with 0 < t < `t_max`, or the first that is found if `ANY`.
    #[inline]
    pub fn trace<const ANY: bool>(&self, origin: [f32; 3], direction: [f32; 3], t_max: f32) -> Option<Hit> {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has what the function is compiled for.
            return unsafe { self.trace_avx2::<ANY>(origin, direction, t_max) };
        }
        self.trace_portable::<ANY>(origin, direction, t_max)
    }

    /// The same instructions eight lanes wide; without fused multiplication, so the results are the same, too.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn trace_avx2<const ANY: bool>(&self, origin: [f32; 3], direction: [f32; 3], t_max: f32) -> Option<Hit> {
        self.trace_portable::<ANY>(origin, direction, t_max)
    }

    /// The nearest triangle, or the first that is found if `ANY`.
    #[inline(always)]
    fn trace_portable<const ANY: bool>(&self, origin: [f32; 3], direction: [f32; 3], t_max: f32) -> Option<Hit> {
        if self.compressed.nodes.is_empty() {
            return None;
        }
        let frame = RayFrame::new(origin.into(), direction.into());
        let ray = BoxRay::new(&frame);
        let mut nearest = None;
        let mut t_max = t_max;
        let mut stack = [Group::default(); STACK_SIZE];
        let mut height = 0;
        // The root is the only child of a group of its own.
        let mut group = Group {
            first: 0,
            hits: 1 << 31,
        };
        loop {
            let slot = group.hits.leading_zeros() ^ 31;
            group.hits &= !(1 << slot);
            let rank = (slot - 24) ^ (ray.octant_inverse & 7);
            let node = &self.compressed.nodes[(group.first + (group.hits & ((1 << rank) - 1)).count_ones()) as usize];
            if group.hits >> 24 != 0 {
                stack[height] = group;
                height += 1;
            }
            let hits = ray.children_met(node, t_max);
            let mut triangles = hits & 0x00ff_ffff;
            while triangles != 0 {
                let triangle = node.primitive_base_idx + triangles.trailing_zeros();
                triangles &= triangles - 1;
                let [v0, v1, v2] = self.corners[triangle as usize];
                if let Some((t, u, v)) = intersect_triangle(&frame, v0, v1, v2, t_max) {
                    let triangle = self.compressed.triangles[triangle as usize];
                    nearest = Some(Hit { t, triangle, u, v });
                    if ANY {
                        return nearest;
                    }
                    t_max = t;
                }
            }
            group = Group {
                first: node.child_base_idx,
                hits: (hits & 0xff00_0000) | u32::from(node.imask),
            };
            if group.hits >> 24 == 0 {
                if height == 0 {
                    return nearest;
                }
                height -= 1;
                group = stack[height];
            }
        }
    }
}

/// Siblings that a ray meets: in the high byte those to be visited, highest bit first; in the low byte which of the
/// parent's children are nodes at all.
#[derive(Clone, Copy, Default)]
struct Group {
    /// Where the first of the children is.
    first: u32,
    hits: u32,
}

/// What the test against boxes needs of a ray.
struct BoxRay {
    origin: Vec3A,
    inverse: Vec3A,
    backward: [bool; 3],
    /// Of 7 − octant, four times over: exclusive-or with it puts children into the ray's order.
    octant_inverse: u32,
}

impl BoxRay {
    #[inline(always)]
    fn new(frame: &RayFrame) -> Self {
        let direction = frame.direction.to_array();
        let backward = direction.map(|d| d < 0.0);
        // −0 is positive here as in `backward`; NaN becomes the largest inverse.
        let inverse = [0, 1, 2].map(|i| {
            let size = 1.0 / direction[i].abs();
            let size = if size < INVERSE_MAX { size } else { INVERSE_MAX };
            if backward[i] { -size } else { size }
        });
        let bit = |i: usize, value: u32| if backward[i] { 0 } else { value };
        Self {
            origin: frame.origin,
            inverse: inverse.into(),
            backward,
            octant_inverse: bit(0, 0x0404_0404) | bit(1, 0x0202_0202) | bit(2, 0x0101_0101),
        }
    }

    /// Which children of a node are met before `t_max`: nodes as bits of the high byte in the ray's order, triangles as
    /// the lower bits.
    #[inline(always)]
    fn children_met(&self, node: &CwBvhNode, t_max: f32) -> u32 {
        let scale = node.compute_extent() * self.inverse;
        let corner = Vec3A::from(node.p);
        let shift = (corner - self.origin) * self.inverse;
        let margin = (corner.abs() + self.origin.abs()) * self.inverse.abs() * PLACE_ERROR;
        let (early, late) = (shift - margin, shift + margin);
        let sides =
            |low: &[u8; 8], high: &[u8; 8], backward: bool| if backward { (*high, *low) } else { (*low, *high) };
        let (near_x, far_x) = sides(&node.child_min_x, &node.child_max_x, self.backward[0]);
        let (near_y, far_y) = sides(&node.child_min_y, &node.child_max_y, self.backward[1]);
        let (near_z, far_z) = sides(&node.child_min_z, &node.child_max_z, self.backward[2]);
        let (child_bits, bit_index) = node.get_child_and_index_bits(self.octant_inverse);
        let (child_bits, bit_index) = (child_bits.to_le_bytes(), bit_index.to_le_bytes());
        let mut met = [0u32; 8];
        for child in 0..8 {
            let near = larger(
                larger(
                    f32::from(near_x[child]) * scale.x + early.x,
                    f32::from(near_y[child]) * scale.y + early.y,
                ),
                larger(f32::from(near_z[child]) * scale.z + early.z, 0.0),
            );
            let far = smaller(
                smaller(
                    f32::from(far_x[child]) * scale.x + late.x,
                    f32::from(far_y[child]) * scale.y + late.y,
                ),
                smaller(f32::from(far_z[child]) * scale.z + late.z, t_max),
            );
            let bits = u32::from(child_bits[child]) << (bit_index[child] & 31);
            met[child] = if near <= far * FAR_MARGIN { bits } else { 0 };
        }
        met.into_iter().fold(0, |all, bits| all | bits)
    }
}

/// As one instruction: of a NaN and a number, the second.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// As one instruction: of a NaN and a number, the second.
#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
