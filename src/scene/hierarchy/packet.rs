//! Packets of sixteen coherent rays, and their tests against boxes and triangles.
//!
//! Invariant: the test of a ray against a block's box or a triangle gives the same bits as that of a single ray. A ray tests
//! the triangles of those blocks alone whose boxes it hits, and of hits at equal distance the lowest triangle wins. So a
//! ray's hit does not depend on the packet that it is in.

use fearless_simd::{ExtractToken, Simd, SimdBase, SimdMask, f32x8, f32x16, mask32x16};

use super::traverse::{BoxRay, HitSink, INVERSE_MAX, Leaves, RELATIVE_ERROR, SingleRay, StackEntry, TriangleRay};
use super::wide::{Block, Node, Normals, WIDTH, Wide};
use crate::{optics::real::inlined, scene::Hit};

/// Rays per packet.
pub const PACKET: usize = 16;

/// Rays as structure of arrays: `[axis][ray]`.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Packet {
    pub origins: [[f32; PACKET]; 3],
    /// Ray directions, of any length but 0.
    pub directions: [[f32; PACKET]; 3],
    /// Ray lengths, in lengths of the direction; negative for an inactive lane.
    pub t_max: [f32; PACKET],
}

impl Default for Packet {
    fn default() -> Self {
        Self {
            origins: [[0.0; PACKET]; 3],
            directions: [[1.0; PACKET]; 3],
            t_max: [-1.0; PACKET],
        }
    }
}

impl Packet {
    /// A packet of at most sixteen rays (origin, direction, t_max).
    pub fn of(rays: impl IntoIterator<Item = ([f32; 3], [f32; 3], f32)>) -> Self {
        let mut packet = Self::default();
        let mut count = 0;
        for (origin, direction, t_max) in rays {
            packet.set(count, origin, direction, t_max);
            count += 1;
        }
        packet.fill(count);
        packet
    }

    /// Sets the ray of a lane.
    pub fn set(&mut self, lane: usize, origin: [f32; 3], direction: [f32; 3], t_max: f32) {
        for axis in 0..3 {
            self.origins[axis][lane] = origin[axis];
            self.directions[axis][lane] = direction[axis];
        }
        self.t_max[lane] = t_max;
    }

    /// Origin of a lane's ray.
    pub fn origin(&self, lane: usize) -> [f32; 3] {
        self.origins.map(|axis| axis[lane])
    }

    /// Direction of a lane's ray.
    pub fn direction(&self, lane: usize) -> [f32; 3] {
        self.directions.map(|axis| axis[lane])
    }

    /// Fills the lanes from `count` on with the first ray, inactive, so that all rays of the packet stay in one octant.
    pub fn fill(&mut self, count: usize) {
        let (origin, direction) = (self.origin(0), self.direction(0));
        (count..PACKET).for_each(|lane| self.set(lane, origin, direction, -1.0));
    }
}

/// Closest hits of a packet's rays, or any hits.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct PacketHits {
    /// Distance of each hit, or the ray's t_max.
    pub t: [f32; PACKET],
    /// Triangle index plus one; 0 without a hit.
    marks: [u32; PACKET],
    /// Twice the signed areas into which the ray divides the projected triangle, each opposite to a corner. Not set for any
    /// hits.
    areas: [[f32; PACKET]; 3],
    /// Index of the first triangle of the hierarchy being traversed.
    pub first: u32,
}

impl PacketHits {
    /// No hits: distances are the rays' t_max.
    pub fn none(packet: &Packet) -> Self {
        Self {
            t: packet.t_max,
            marks: [0; PACKET],
            areas: [[0.0; PACKET]; 3],
            first: 0,
        }
    }

    /// Records a hit that is no farther than the lane's current one. Returns true if it replaces that.
    fn add<const ANY: bool>(&mut self, lane: usize, t: f32, areas: [f32; 3], triangle: u32) -> bool {
        let mark = self.first + triangle + 1;
        // At equal distance the lowest index wins, so that the order of traversal does not matter.
        let is_better = t < self.t[lane] || mark < self.marks[lane];
        if is_better {
            self.t[lane] = if ANY { -1.0 } else { t };
            self.marks[lane] = mark;
            if !ANY {
                for (all, area) in self.areas.iter_mut().zip(areas) {
                    all[lane] = area;
                }
            }
        }
        is_better
    }

    /// True if the lane has a hit.
    pub fn is_hit(&self, lane: usize) -> bool {
        self.marks[lane] != 0
    }

    /// Hit of a lane.
    pub fn hit(&self, lane: usize) -> Option<Hit> {
        let areas = [self.areas[0][lane], self.areas[1][lane], self.areas[2][lane]];
        Some(Hit::of(self.t[lane], self.marks[lane].checked_sub(1)?, areas))
    }
}

/// The hits of one lane, for single-ray traversal.
struct LaneSink<'f, const ANY: bool> {
    lane: usize,
    hits: &'f mut PacketHits,
    /// True once the lane's hit has been replaced.
    is_closer: bool,
}

impl<const ANY: bool> HitSink for LaneSink<'_, ANY> {
    fn t_max(&self) -> f32 {
        self.hits.t[self.lane]
    }

    fn record(&mut self, t: f32, triangle: u32, areas: [f32; 3]) {
        self.is_closer |= self.hits.add::<ANY>(self.lane, t, areas, triangle);
    }
}

/// The tests of one lane's ray against triangles, prepared at each leaf: many rays meet none.
struct LaneTriangles<'r, S: Simd> {
    rays: &'r PacketRays<S>,
    lane: usize,
}

impl<S: Simd> Leaves for LaneTriangles<'_, S> {
    #[inline(always)]
    fn intersect<const ANY: bool, M: HitSink>(&self, wide: &Wide, block: usize, entered: f32, sink: &mut M) -> bool {
        let ray = self.rays.triangles(self.lane);
        ray.intersect::<ANY, M>(wide, block, entered, sink)
    }
}

/// Octant of a direction: its signs (bits 0 to 2) and its longest axis (bits 3 and 4). Rays of a packet share it.
pub fn ray_octant(direction: [f32; 3]) -> usize {
    let [x, y, z] = direction.map(f32::abs);
    let longest = if z >= x && z >= y {
        2
    } else if y >= x {
        1
    } else {
        0
    };
    let sign = |axis: usize| usize::from(direction[axis] < 0.0) << axis;
    longest << 3 | sign(0) | sign(1) | sign(2)
}

/// Number of octants: eight, times three longest axes.
pub const OCTANTS: usize = 24;

inlined! {
    pub fn load<S: Simd>(simd: S, lanes: &[f32; PACKET]) -> f32x16<S> {
        f32x16::load_array_ref(simd, lanes)
    }

    fn load_three<S: Simd>(simd: S, axes: &[[f32; PACKET]; 3]) -> [f32x16<S>; 3] {
        [load(simd, &axes[0]), load(simd, &axes[1]), load(simd, &axes[2])]
    }

    /// A lane's number, in all lanes.
    fn splat<S: Simd>(all: &f32x16<S>, lane: usize) -> f32x8<S> {
        f32x8::splat(all.token(), all.as_slice()[lane])
    }

    fn splats<S: Simd>([x, y, z]: &[f32x16<S>; 3], lane: usize) -> [f32x8<S>; 3] {
        [splat(x, lane), splat(y, lane), splat(z, lane)]
    }

    /// The octant of all rays; `None` if they differ.
    pub fn common_octant<S: Simd>(simd: S, packet: &Packet) -> Option<usize> {
        let octant = ray_octant(packet.direction(0));
        let zero = f32x16::splat(simd, 0.0);
        let directions = load_three(simd, &packet.directions);
        let mut axis = 0;
        while axis < 3 {
            let backward = directions[axis].simd_lt(zero);
            let is_alike = if octant >> axis & 1 == 1 {
                backward.all_true()
            } else {
                backward.all_false()
            };
            if !is_alike {
                return None;
            }
            axis += 1;
        }
        let (x, y, z) = (directions[0].abs(), directions[1].abs(), directions[2].abs());
        let along_z = z.simd_ge(x) & z.simd_ge(y);
        let is_alike = match octant >> 3 {
            2 => along_z.all_true(),
            1 => along_z.all_false() && y.simd_ge(x).all_true(),
            _ => along_z.all_false() && y.simd_ge(x).all_false(),
        };
        is_alike.then_some(octant)
    }
}

/// Result of a packet against a box.
pub struct BoxHits<S: Simd> {
    /// Rays that overlap the box within [0, t_max].
    pub mask: mask32x16<S>,
    /// Entry distances, at least 0.
    distance: f32x16<S>,
}

/// A packet's rays prepared for the tests against boxes and triangles; fields as in [`BoxRay`] and [`TriangleRay`].
pub struct PacketRays<S: Simd> {
    pub origin: [f32x16<S>; 3],
    direction: [f32x16<S>; 3],
    pub inverse: [f32x16<S>; 3],
    near_offset: [f32x16<S>; 3],
    far_offset: [f32x16<S>; 3],
    /// Which side of a box is near on each axis: 0 is the low one.
    pub near: [usize; 3],
    axes: [usize; 3],
    shear: [f32x16<S>; 2],
}

impl<S: Simd> PacketRays<S> {
    inlined! {
        pub fn new(simd: S, packet: &Packet, wide: &Wide, octant: usize) -> Self {
            let axes = [[1, 2, 0], [0, 2, 1], [0, 1, 2]][octant >> 3];
            let [axis_x, axis_y, along] = axes;
            let direction = load_three(simd, &packet.directions);
            let mut rays = Self {
                origin: load_three(simd, &packet.origins),
                direction,
                inverse: direction,
                near_offset: direction,
                far_offset: direction,
                near: [octant & 1, octant >> 1 & 1, octant >> 2 & 1],
                axes,
                shear: [
                    -direction[axis_x] / direction[along],
                    -direction[axis_y] / direction[along],
                ],
            };
            rays.invert(wide, 0);
            rays.invert(wide, 1);
            rays.invert(wide, 2);
            rays
        }

        /// Prepares the test against boxes on one axis, with the same arithmetic as for single rays.
        fn invert(&mut self, wide: &Wide, axis: usize) {
            let (origin, direction) = (self.origin[axis], self.direction[axis]);
            let simd = origin.token();
            let size = (f32x16::splat(simd, 1.0) / direction.abs()).min(f32x16::splat(simd, INVERSE_MAX));
            let inverse = if self.near[axis] == 1 { -size } else { size };
            let reach = f32x16::splat(simd, wide.reach[axis]) + origin.abs();
            let (shift, margin) = (-origin * inverse, reach * size * f32x16::splat(simd, RELATIVE_ERROR));
            self.inverse[axis] = inverse;
            self.near_offset[axis] = shift - margin;
            self.far_offset[axis] = shift + margin;
        }

        /// Tests the rays against a child's box; `None` if none hits.
        pub fn intersect_box(&self, node: &Node, child: usize, t_max: &[f32; PACKET]) -> Option<BoxHits<S>> {
            let limits = load(self.origin[0].token(), t_max);
            let simd = limits.token();
            let (x, y, z) = (
                self.near(node, child, 0),
                self.near(node, child, 1),
                self.near(node, child, 2),
            );
            let distance = x.max(y).max(z.max(f32x16::splat(simd, 0.0)));
            let (x, y, z) = (
                self.far(node, child, 0),
                self.far(node, child, 1),
                self.far(node, child, 2),
            );
            let mask = distance.simd_le(x.min(y).min(z.min(limits)));
            mask.any_true().then_some(BoxHits { mask, distance })
        }

        /// Distance to a child's near side.
        fn near(&self, node: &Node, child: usize, axis: usize) -> f32x16<S> {
            let side = node.sides[axis][self.near[axis] & 1][child];
            f32x16::splat(self.origin[0].token(), side) * self.inverse[axis] + self.near_offset[axis]
        }

        /// Distance to a child's far side.
        fn far(&self, node: &Node, child: usize, axis: usize) -> f32x16<S> {
            let side = node.sides[axis][(self.near[axis] ^ 1) & 1][child];
            f32x16::splat(self.origin[0].token(), side) * self.inverse[axis] + self.far_offset[axis]
        }
    }

    /// Continues below a child with the rays that hit its box, one by one. Returns true if any hit is replaced.
    #[inline(always)]
    pub fn traverse_singly<const ANY: bool>(
        &self,
        wide: &Wide,
        child: u32,
        entered: &BoxHits<S>,
        hits: &mut PacketHits,
    ) -> bool {
        let mut rays = entered.mask.to_bitmask();
        let distances = entered.distance.to_array();
        let mut is_closer = false;
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize % PACKET;
            rays &= rays - 1;
            let mut sink = LaneSink::<ANY> {
                lane,
                hits,
                is_closer: false,
            };
            self.single(lane)
                .traverse::<ANY, _>(wide, StackEntry::new(distances[lane], child), &mut sink);
            is_closer |= sink.is_closer;
        }
        is_closer
    }

    inlined! {
        /// A lane's ray for single-ray traversal.
        fn single(&self, lane: usize) -> SingleRay<S, LaneTriangles<'_, S>> {
            SingleRay {
                boxes: BoxRay {
                    inverse: splats(&self.inverse, lane),
                    near_offset: splats(&self.near_offset, lane),
                    far_offset: splats(&self.far_offset, lane),
                    near: self.near,
                },
                leaves: LaneTriangles { rays: self, lane },
            }
        }

        /// A lane's ray prepared for tests against triangles.
        fn triangles(&self, lane: usize) -> TriangleRay<S> {
            TriangleRay {
                origin: splats(&self.origin, lane),
                direction: splats(&self.direction, lane),
                axes: self.axes,
                shear: [splat(&self.shear[0], lane), splat(&self.shear[1], lane)],
            }
        }
    }

    /// Tests the triangles of a block one by one against all rays, and records closer hits. Returns true if there are any.
    #[inline(always)]
    pub fn intersect_block<const ANY: bool>(
        &self,
        wide: &Wide,
        block: usize,
        entered: &BoxHits<S>,
        hits: &mut PacketHits,
    ) -> bool {
        let (first, normals, block) = (wide.firsts[block], &wide.normals[block], &wide.blocks[block]);
        let simd = self.origin[0].token();
        let zero = f32x16::splat(simd, 0.0);
        let mut is_closer = false;
        let mut triangle = 0;
        // NaN corners mark the end of a partial block.
        while triangle < WIDTH && !block.corners[0][0][triangle].is_nan() {
            let (ax, ay) = self.project(block, 0, triangle);
            let (bx, by) = self.project(block, 1, triangle);
            let (cx, cy) = self.project(block, 2, triangle);
            let (u, v, w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
            let is_inside = (u.simd_ge(zero) & v.simd_ge(zero) & w.simd_ge(zero))
                | (u.simd_le(zero) & v.simd_le(zero) & w.simd_le(zero));
            let is_inside = is_inside & entered.mask;
            if is_inside.any_true() {
                let area = u + v + w;
                let (t, towards) = self.distance(block, normals, triangle);
                let t = t / towards;
                let clamped = t.max(entered.distance);
                let is_before = t.simd_gt(zero) & clamped.simd_le(load(simd, &hits.t));
                let mut hit_bits = (is_inside & !area.simd_eq(zero) & is_before).to_bitmask() as u32;
                let (clamped, u, v, w) = (clamped.to_array(), u.to_array(), v.to_array(), w.to_array());
                while hit_bits != 0 {
                    let lane = (hit_bits.trailing_zeros() % PACKET as u32) as usize;
                    hit_bits &= hit_bits - 1;
                    let areas = [u[lane], v[lane], w[lane]];
                    is_closer |= hits.add::<ANY>(lane, clamped[lane], areas, first + triangle as u32);
                }
            }
            triangle += 1;
        }
        is_closer
    }

    inlined! {
        /// Numerator and denominator of the distance to a triangle's plane: (n · (corner − origin), n · direction).
        fn distance(&self, block: &Block, normals: &Normals, triangle: usize) -> (f32x16<S>, f32x16<S>) {
            let simd = self.origin[0].token();
            let x = f32x16::splat(simd, normals.axes[0][triangle]);
            let y = f32x16::splat(simd, normals.axes[1][triangle]);
            let z = f32x16::splat(simd, normals.axes[2][triangle]);
            let [dx, dy, dz] = self.direction;
            let from_x = self.relative(block, 0, 0, triangle);
            let from_y = self.relative(block, 0, 1, triangle);
            (
                x * from_x + y * from_y + z * self.relative(block, 0, 2, triangle),
                x * dx + y * dy + z * dz,
            )
        }

        /// A coordinate of a corner relative to the rays' origins.
        fn relative(&self, block: &Block, corner: usize, axis: usize, triangle: usize) -> f32x16<S> {
            f32x16::splat(self.origin[0].token(), block.corners[corner][axis][triangle]) - self.origin[axis]
        }

        /// A corner projected along the rays.
        fn project(&self, block: &Block, corner: usize, triangle: usize) -> (f32x16<S>, f32x16<S>) {
            let [axis_x, axis_y, along] = self.axes;
            let depth = self.relative(block, corner, along, triangle);
            (
                self.relative(block, corner, axis_x, triangle) + depth * self.shear[0],
                self.relative(block, corner, axis_y, triangle) + depth * self.shear[1],
            )
        }
    }
}
