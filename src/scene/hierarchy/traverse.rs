//! Single-ray traversal of the CPU's hierarchy, eight boxes or eight triangles at a time.
//!
//! A box is missed only if the ray misses it exactly. Triangles are hit as [`intersect_triangle`] says, bit for bit: nothing
//! is fused, so every instruction set gives the same hits. Rounding may put a hit before its block's box (an edge seen
//! nearly edge-on, or from afar). Such a hit is moved to the box's entry. So no box that is culled by distance has a closer
//! hit, and the result does not depend on the order of traversal.
//!
//! [`intersect_triangle`]: crate::scene::intersect_triangle

use std::mem::MaybeUninit;

use fearless_simd::{ExtractToken, Level, Simd, SimdBase, SimdMask, f32x8, mask32x8};
use glam::Vec3A;

use super::DEPTH_MAX;
use super::wide::{BLOCK, Block, Node, Normals, WIDTH, Wide};
use crate::optics::real::inlined;
use crate::scene::intersect::{Hit, RayFrame};

/// Relative error bound of a box's or a triangle's position from the ray's origin: eleven roundings, five of a box's plane
/// and six of a triangle's projected corner. So a distant camera loses nothing.
pub const RELATIVE_ERROR: f32 = 7e-7;

/// Bound of inverse directions. It keeps their products with distances finite.
pub const INVERSE_MAX: f32 = 1e18;

/// Each level adds at most all but one of a node's children.
const STACK_SIZE: usize = DEPTH_MAX * WIDTH;

impl Wide {
    /// The closest hit with 0 < t < `t_max`, or any hit if `ANY`.
    pub fn hit<const ANY: bool>(&self, level: Level, frame: &RayFrame, t_max: f32) -> Option<Hit> {
        dispatch!(level, simd => trace::<_, ANY>(simd, self, frame, t_max))
    }
}

/// The closest hit, or any hit if `ANY`.
#[inline(always)]
fn trace<S: Simd, const ANY: bool>(simd: S, wide: &Wide, frame: &RayFrame, t_max: f32) -> Option<Hit> {
    if wide.nodes.is_empty() {
        return None;
    }
    let ray = SingleRay {
        boxes: BoxRay::new(simd, frame, wide),
        leaves: TriangleRay::new(simd, frame),
    };
    let mut closest = ClosestHit::before(t_max);
    ray.traverse::<ANY, _>(wide, StackEntry::ROOT, &mut closest);
    closest.hit()
}

/// Receiver of a ray's hits.
pub trait HitSink {
    /// Distance beyond which hits are ignored.
    fn t_max(&self) -> f32;

    /// Records a hit with t ≤ t_max; for `areas` see [`BlockHits::areas`].
    fn record(&mut self, t: f32, triangle: u32, areas: [f32; 3]);
}

/// Keeps the closest hit. At equal distance the lowest index wins, so that the order of traversal does not matter.
pub struct ClosestHit {
    t: f32,
    triangle: Option<u32>,
    /// See [`BlockHits::areas`].
    areas: [f32; 3],
}

impl ClosestHit {
    /// No hit yet with t < `t_max`.
    pub fn before(t_max: f32) -> Self {
        Self {
            t: t_max,
            triangle: None,
            areas: [0.0; 3],
        }
    }

    pub fn hit(&self) -> Option<Hit> {
        Some(Hit::of(self.t, self.triangle?, self.areas))
    }
}

impl HitSink for ClosestHit {
    fn t_max(&self) -> f32 {
        self.t
    }

    fn record(&mut self, t: f32, triangle: u32, areas: [f32; 3]) {
        let is_first = || self.triangle.is_some_and(|other| triangle < other);
        if t < self.t || is_first() {
            (self.t, self.triangle, self.areas) = (t, Some(triangle), areas);
        }
    }
}

/// A ray's test against the contents of a leaf.
pub trait Leaves {
    /// Tests a block whose box is entered at distance `entered`. Returns true if anything in it is hit. If `ANY`, the first
    /// hit is enough.
    fn intersect<const ANY: bool, M: HitSink>(&self, wide: &Wide, block: usize, entered: f32, sink: &mut M) -> bool;
}

/// A ray prepared for single-ray traversal.
pub struct SingleRay<S: Simd, L = TriangleRay<S>> {
    pub boxes: BoxRay<S>,
    pub leaves: L,
}

impl<S: Simd, L: Leaves> SingleRay<S, L> {
    /// Traverses the subtree of `child` and reports ever closer hits to `sink`; stops after the first hit if `ANY`. Returns
    /// true if so stopped.
    #[inline(always)]
    pub fn traverse<const ANY: bool, M: HitSink>(&self, wide: &Wide, child: StackEntry, sink: &mut M) -> bool {
        let mut stack = Stack::new();
        let mut next = child;
        loop {
            let child = next.child();
            if child & BLOCK == 0 {
                if let Some(nearest) = self.boxes.intersect_children(wide, child, sink.t_max(), &mut stack) {
                    next = nearest;
                    continue;
                }
            } else if self
                .leaves
                .intersect::<ANY, M>(wide, (child & !BLOCK) as usize, next.distance(), sink)
                && ANY
            {
                return true;
            }
            match stack.pop_before(sink.t_max()) {
                Some(entry) => next = entry,
                None => return false,
            }
        }
    }
}

impl<S: Simd> Leaves for TriangleRay<S> {
    #[inline(always)]
    fn intersect<const ANY: bool, M: HitSink>(&self, wide: &Wide, block: usize, entered: f32, sink: &mut M) -> bool {
        let Some(inside) = self.inside(&wide.blocks[block]) else {
            return false;
        };
        let hits = self.hits(
            &wide.blocks[block],
            &wide.normals[block],
            inside,
            [entered, sink.t_max()],
        );
        hits.record(wide.firsts[block], sink)
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, v: Vec3A) -> [f32x8<S>; 3] {
    [
        f32x8::splat(simd, v.x),
        f32x8::splat(simd, v.y),
        f32x8::splat(simd, v.z),
    ]
}

/// A ray prepared for tests against boxes.
pub struct BoxRay<S: Simd> {
    pub inverse: [f32x8<S>; 3],
    /// Added to a near side's coordinate times the inverse direction: gives its distance, rounded down.
    pub near_offset: [f32x8<S>; 3],
    /// The same for a far side's distance, rounded up.
    pub far_offset: [f32x8<S>; 3],
    /// Which side of a box is near on each axis: 0 is the low one.
    pub near: [usize; 3],
}

impl<S: Simd> BoxRay<S> {
    inlined! {
        pub fn new(simd: S, frame: &RayFrame, wide: &Wide) -> Self {
            let margin = |size: Vec3A| (wide.reach + frame.origin.abs()) * size * RELATIVE_ERROR;
            Self::with_margin(simd, frame.origin, frame.direction, margin)
        }

        /// A ray with a `margin` of distances, made of the sizes of its inverse directions.
        pub fn with_margin(simd: S, origin: Vec3A, direction: Vec3A, margin: impl FnOnce(Vec3A) -> Vec3A) -> Self {
            // −0 is positive here as in `backward`; NaN becomes the largest inverse.
            let is_backward = direction.cmplt(Vec3A::ZERO);
            let size = direction.abs().recip().min(Vec3A::splat(INVERSE_MAX));
            let inverse = Vec3A::select(is_backward, -size, size);
            let shift = -origin * inverse;
            let margin = margin(size);
            let backward = is_backward.bitmask() as usize;
            Self {
                inverse: splat(simd, inverse),
                near_offset: splat(simd, shift - margin),
                far_offset: splat(simd, shift + margin),
                near: [backward & 1, backward >> 1 & 1, backward >> 2 & 1],
            }
        }

        /// The nearest child whose box is hit before `t_max`. Pushes the other hit children, the nearest last.
        fn intersect_children(&self, wide: &Wide, index: u32, t_max: f32, stack: &mut Stack) -> Option<StackEntry> {
            let node = &wide.nodes[index as usize];
            let simd = self.inverse[0].token();
            let (x, y, z) = (self.near(node, 0), self.near(node, 1), self.near(node, 2));
            let near = x.max(y).max(z.max(f32x8::splat(simd, 0.0)));
            let (x, y, z) = (self.far(node, 0), self.far(node, 1), self.far(node, 2));
            let hit_bits = near
                .simd_le(x.min(y).min(z.min(f32x8::splat(simd, t_max))))
                .to_bitmask() as u32;
            if hit_bits == 0 {
                return None;
            }
            // What is visited later is prefetched, because memory latency dominates traversal.
            let near = near.to_array();
            let mut left = hit_bits;
            let mut take = || {
                let child = (left.trailing_zeros() % WIDTH as u32) as usize;
                left &= left - 1;
                (StackEntry::new(near[child], node.children[child]), left == 0)
            };
            let (first, is_all) = take();
            if is_all {
                return Some(first);
            }
            let (second, is_all) = take();
            let (nearest, farther) = if second.0 < first.0 {
                (second, first)
            } else {
                (first, second)
            };
            wide.prefetch(farther.child());
            if is_all {
                stack.push(farther);
                return Some(nearest);
            }
            let base = stack.height;
            stack.push(farther);
            stack.push(nearest);
            loop {
                let (entry, is_all) = take();
                wide.prefetch(entry.child());
                stack.insert(entry, base);
                if is_all {
                    return stack.pop();
                }
            }
        }

        /// Bit mask of the boxes `[low, high][axis][box]` that are hit before `t_max`, and their entry distances. Boxes of NaN are
        /// missed.
        pub fn intersect_boxes(&self, sides: [&[[f32; WIDTH]; 3]; 2], t_max: f32) -> (u32, [f32; WIDTH]) {
            let simd = self.inverse[0].token();
            let (mut near, mut far) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, t_max));
            let mut axis = 0;
            while axis < 3 {
                let side = |far: usize| f32x8::load_array_ref(simd, &sides[(self.near[axis] ^ far) & 1][axis]);
                near = near.max(side(0) * self.inverse[axis] + self.near_offset[axis]);
                far = far.min(side(1) * self.inverse[axis] + self.far_offset[axis]);
                axis += 1;
            }
            let low = f32x8::load_array_ref(simd, &sides[0][0]);
            (
                (near.simd_le(far) & low.simd_eq(low)).to_bitmask() as u32,
                near.to_array(),
            )
        }

        /// Distances to the children's near sides.
        fn near(&self, node: &Node, axis: usize) -> f32x8<S> {
            let simd = self.inverse[0].token();
            f32x8::load_array_ref(simd, &node.sides[axis][self.near[axis] & 1]) * self.inverse[axis]
                + self.near_offset[axis]
        }

        /// Distances to the children's far sides.
        fn far(&self, node: &Node, axis: usize) -> f32x8<S> {
            let simd = self.inverse[0].token();
            f32x8::load_array_ref(simd, &node.sides[axis][(self.near[axis] ^ 1) & 1]) * self.inverse[axis]
                + self.far_offset[axis]
        }
    }
}

/// Triangles of a block that a ray's line passes through.
pub struct Inside<S: Simd> {
    mask: mask32x8<S>,
    /// See [`BlockHits::areas`].
    areas: [f32x8<S>; 3],
}

/// Hits of a ray in a block.
pub struct BlockHits<S: Simd> {
    /// Bit mask of the hit triangles.
    hit_bits: u32,
    /// Distances.
    t: f32x8<S>,
    /// Twice the signed areas into which the ray divides each projected triangle, opposite to its corners.
    areas: [f32x8<S>; 3],
}

impl<S: Simd> BlockHits<S> {
    /// Records the hits on a block of triangles from `first` on. Returns true if there are any.
    #[inline(always)]
    pub fn record<M: HitSink>(self, first: u32, sink: &mut M) -> bool {
        let Self { mut hit_bits, t, areas } = self;
        if hit_bits == 0 {
            return false;
        }
        let distances = t.to_array();
        let areas = [areas[0].to_array(), areas[1].to_array(), areas[2].to_array()];
        while hit_bits != 0 {
            let lane = (hit_bits.trailing_zeros() % WIDTH as u32) as usize;
            hit_bits &= hit_bits - 1;
            // An earlier hit of this block may be closer by now.
            if distances[lane] <= sink.t_max() {
                let areas = [areas[0][lane], areas[1][lane], areas[2][lane]];
                sink.record(distances[lane], first + lane as u32, areas);
            }
        }
        true
    }
}

/// A ray prepared for tests against triangles: the shear of [`RayFrame`].
pub struct TriangleRay<S: Simd> {
    pub origin: [f32x8<S>; 3],
    pub direction: [f32x8<S>; 3],
    pub axes: [usize; 3],
    pub shear: [f32x8<S>; 2],
}

impl<S: Simd> TriangleRay<S> {
    inlined! {
        pub fn new(simd: S, frame: &RayFrame) -> Self {
            let [_, _, along] = frame.axes;
            Self {
                origin: splat(simd, frame.origin),
                direction: splat(simd, frame.direction),
                axes: frame.axes,
                shear: [
                    f32x8::splat(simd, frame.axis_x[along]),
                    f32x8::splat(simd, frame.axis_y[along]),
                ],
            }
        }

        /// The triangles of a block that the ray's line passes through; `None` if there are none.
        pub fn inside(&self, block: &Block) -> Option<Inside<S>> {
            let zero = f32x8::splat(self.origin[0].token(), 0.0);
            let [(ax, ay), (bx, by), (cx, cy)] = [self.project(block, 0), self.project(block, 1), self.project(block, 2)];
            // Watertight: neighbours compute the same area for a shared edge but for its sign, as no product is fused.
            let (u, v, w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
            let mask = (u.simd_ge(zero) & v.simd_ge(zero) & w.simd_ge(zero))
                | (u.simd_le(zero) & v.simd_le(zero) & w.simd_le(zero));
            let areas = [u, v, w];
            (!mask.all_false()).then_some(Inside { mask, areas })
        }

        /// The triangles of a block that are hit with 0 < t ≤ `t_max`; t is raised to `entered`.
        pub fn hits(
            &self,
            block: &Block,
            normals: &Normals,
            Inside { mask, areas }: Inside<S>,
            [entered, t_max]: [f32; 2],
        ) -> BlockHits<S> {
            let simd = self.origin[0].token();
            let zero = f32x8::splat(simd, 0.0);
            let [u, v, w] = areas;
            let x = f32x8::load_array_ref(simd, &normals.axes[0]);
            let y = f32x8::load_array_ref(simd, &normals.axes[1]);
            let z = f32x8::load_array_ref(simd, &normals.axes[2]);
            let [dx, dy, dz] = self.direction;
            let from_origin = [
                self.relative(block, 0, 0),
                self.relative(block, 0, 1),
                self.relative(block, 0, 2),
            ];
            let t = (x * from_origin[0] + y * from_origin[1] + z * from_origin[2]) / (x * dx + y * dy + z * dz);
            let clamped = t.max(f32x8::splat(simd, entered));
            // False for a triangle seen edge-on and for NaN.
            let is_before = t.simd_gt(zero) & clamped.simd_le(f32x8::splat(simd, t_max));
            let is_hit = mask & !(u + v + w).simd_eq(zero) & is_before;
            BlockHits {
                hit_bits: is_hit.to_bitmask() as u32,
                t: clamped,
                areas,
            }
        }

        /// A coordinate of a corner relative to the ray's origin.
        fn relative(&self, block: &Block, corner: usize, axis: usize) -> f32x8<S> {
            f32x8::load_array_ref(self.origin[0].token(), &block.corners[corner][axis]) - self.origin[axis]
        }

        /// A corner projected along the ray.
        fn project(&self, block: &Block, corner: usize) -> (f32x8<S>, f32x8<S>) {
            let [axis_x, axis_y, along] = self.axes;
            let depth = self.relative(block, corner, along);
            (
                self.relative(block, corner, axis_x) + depth * self.shear[0],
                self.relative(block, corner, axis_y) + depth * self.shear[1],
            )
        }
    }
}

/// A child to visit, ordered by the distance of its box. The distance is not negative, so that its bits sort as integers.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct StackEntry(u64);

impl StackEntry {
    pub const ROOT: Self = Self(0);

    pub fn new(distance: f32, child: u32) -> Self {
        Self(u64::from(distance.to_bits()) << 32 | u64::from(child))
    }

    pub fn child(self) -> u32 {
        self.0 as u32
    }

    fn distance(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }
}

/// The traversal stack. Left uninitialised, because filling it would cost more than many a ray.
pub struct Stack {
    entries: [MaybeUninit<StackEntry>; STACK_SIZE],
    /// Number of entries.
    pub height: usize,
}

impl Stack {
    pub fn new() -> Self {
        Self {
            entries: [const { MaybeUninit::uninit() }; STACK_SIZE],
            height: 0,
        }
    }

    pub fn push(&mut self, entry: StackEntry) {
        self.entries[self.height].write(entry);
        self.height += 1;
    }

    pub fn pop(&mut self) -> Option<StackEntry> {
        self.height = self.height.checked_sub(1)?;
        // SAFETY: everything below the height that was has been written by `push` or `insert`.
        Some(unsafe { self.entries[self.height].assume_init() })
    }

    /// Pops the next entry that is no farther than `t_max`.
    pub fn pop_before(&mut self, t_max: f32) -> Option<StackEntry> {
        loop {
            let entry = self.pop()?;
            if entry.distance() <= t_max {
                return Some(entry);
            }
        }
    }

    /// Inserts an entry below the nearer entries from `base` on.
    pub fn insert(&mut self, entry: StackEntry, base: usize) {
        let mut at = self.height;
        self.height += 1;
        while at > base {
            let below = self.entries[at - 1];
            // SAFETY: it is below the height that was, see `pop`.
            if unsafe { below.assume_init() }.0 >= entry.0 {
                break;
            }
            self.entries[at] = below;
            at -= 1;
        }
        self.entries[at].write(entry);
    }
}
