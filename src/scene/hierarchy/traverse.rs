//! Rays through the processor's hierarchy, eight boxes or eight triangles at a time.
//!
//! A box is lost only if the ray passes it by, and triangles are met as [`intersect_triangle`] says, bit for bit: nothing
//! is fused, so every instruction set gives the same hits. A place that rounding puts before the block's own box (an edge
//! seen nearly edge-on, or from afar) is moved to where the ray enters that: so no box that is left out as too far away holds
//! a nearer triangle, and what is met does not depend on the order in which boxes are opened.
//!
//! [`intersect_triangle`]: crate::scene::intersect_triangle

use std::mem::MaybeUninit;

use fearless_simd::{ExtractToken, Level, Simd, SimdBase, SimdMask, dispatch, f32x8};
use glam::Vec3A;

use super::DEPTH_MAX;
use super::wide::{BLOCK, Block, Node, Normals, WIDTH, Wide};
use crate::scene::intersect::{Hit, RayFrame};

/// Places relative to the ray's origin are off by at most this part of both: eleven roundings, five of a box's plane and
/// six of a triangle's projected corner. So a far eye loses nothing.
pub(super) const PLACE_ERROR: f32 = 7e-7;

/// Inverse directions are at most this, so that their products with distances stay finite.
pub(super) const INVERSE_MAX: f32 = 1e18;

/// A level adds all but one of a node's children, at most.
const STACK_SIZE: usize = DEPTH_MAX * WIDTH;

impl Wide {
    /// Where a ray meets the nearest triangle with 0 < t < `t_max`.
    pub fn nearest(&self, level: Level, frame: &RayFrame, t_max: f32) -> Option<Hit> {
        dispatch!(level, simd => trace::<_, false>(simd, self, frame, t_max))
    }

    /// Where it meets some triangle with 0 < t < `t_max`.
    pub fn any(&self, level: Level, frame: &RayFrame, t_max: f32) -> Option<Hit> {
        dispatch!(level, simd => trace::<_, true>(simd, self, frame, t_max))
    }
}

/// The nearest triangle, or the first that is found if `ANY`.
#[inline(always)]
fn trace<S: Simd, const ANY: bool>(simd: S, wide: &Wide, frame: &RayFrame, t_max: f32) -> Option<Hit> {
    if wide.nodes.is_empty() {
        return None;
    }
    let ray = SingleRay {
        boxes: BoxRay::new(simd, frame, wide),
        triangles: TriangleRay::new(simd, frame),
    };
    let mut nearest = Nearest {
        t: t_max,
        triangle: None,
        areas: [0.0; 3],
    };
    ray.search::<ANY, _>(wide, Entry::ROOT, &mut nearest);
    Some(Hit::of(nearest.t, nearest.triangle?, nearest.areas))
}

/// Where a ray puts the triangles that it meets.
pub(super) trait Met {
    /// How far away triangles may be that count.
    fn t_max(&self) -> f32;

    /// Takes a triangle that is no farther away; its areas, see [`TrianglesMet::areas`].
    fn take(&mut self, t: f32, triangle: u32, areas: [f32; 3]);
}

/// The nearest triangle, of those as far away the first: so it does not matter in which order they are found.
struct Nearest {
    t: f32,
    triangle: Option<u32>,
    /// See [`TrianglesMet::areas`].
    areas: [f32; 3],
}

impl Met for Nearest {
    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t
    }

    #[inline(always)]
    fn take(&mut self, t: f32, triangle: u32, areas: [f32; 3]) {
        let is_first = || self.triangle.is_some_and(|other| triangle < other);
        if t < self.t || is_first() {
            (self.t, self.triangle, self.areas) = (t, Some(triangle), areas);
        }
    }
}

/// A ray by itself.
pub(super) struct SingleRay<S: Simd> {
    pub boxes: BoxRay<S>,
    pub triangles: TriangleRay<S>,
}

impl<S: Simd> SingleRay<S> {
    /// Finds the triangles that the ray meets of what is under a child of a node, nearer and nearer ones; if `ANY` no more than
    /// one that counts.
    #[inline(always)]
    pub fn search<const ANY: bool, M: Met>(&self, wide: &Wide, child: Entry, found: &mut M) {
        let mut stack = Stack::new();
        let mut next = child;
        loop {
            let place = next.place();
            if place & BLOCK == 0 {
                if let Some(nearest) = self.boxes.enter(wide, place, found.t_max(), &mut stack) {
                    next = nearest;
                    continue;
                }
            } else if self.meet(wide, (place & !BLOCK) as usize, next.distance(), found) && ANY {
                return;
            }
            match stack.pop_before(found.t_max()) {
                Some(entry) => next = entry,
                None => return,
            }
        }
    }

    /// Finds the triangles that the ray meets of a block, whose box it enters so far away; whether there is one.
    #[inline(always)]
    fn meet<M: Met>(&self, wide: &Wide, block: usize, entered: f32, found: &mut M) -> bool {
        let reach = [entered, found.t_max()];
        let triangles = self.triangles.meet(&wide.blocks[block], &wide.normals[block], reach);
        let TrianglesMet { mut met, t, areas } = triangles;
        if met == 0 {
            return false;
        }
        let distances = t.to_array();
        let areas = [areas[0].to_array(), areas[1].to_array(), areas[2].to_array()];
        while met != 0 {
            let lane = (met.trailing_zeros() % WIDTH as u32) as usize;
            met &= met - 1;
            // What was found may be nearer by now.
            if distances[lane] <= found.t_max() {
                let areas = [areas[0][lane], areas[1][lane], areas[2][lane]];
                found.take(distances[lane], wide.firsts[block] + lane as u32, areas);
            }
        }
        true
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

/// What the test against boxes needs of a ray.
pub(super) struct BoxRay<S: Simd> {
    pub inverse: [f32x8<S>; 3],
    /// Added to a side's coordinate times the inverse direction: the near side's distance, rounded down.
    pub early: [f32x8<S>; 3],
    /// The same for the far side's distance, rounded up.
    pub late: [f32x8<S>; 3],
    /// Which of the two sides on each axis is near.
    pub near: [usize; 3],
}

impl<S: Simd> BoxRay<S> {
    #[inline(always)]
    fn new(simd: S, frame: &RayFrame, wide: &Wide) -> Self {
        let (origin, direction) = (frame.origin, frame.direction);
        // −0 is positive here as in `backward`; NaN becomes the largest inverse.
        let is_backward = direction.cmplt(Vec3A::ZERO);
        let size = direction.abs().recip().min(Vec3A::splat(INVERSE_MAX));
        let inverse = Vec3A::select(is_backward, -size, size);
        let shift = -origin * inverse;
        let margin = (wide.reach + origin.abs()) * size * PLACE_ERROR;
        let backward = is_backward.bitmask() as usize;
        Self {
            inverse: splat(simd, inverse),
            early: splat(simd, shift - margin),
            late: splat(simd, shift + margin),
            near: [backward & 1, backward >> 1 & 1, backward >> 2 & 1],
        }
    }

    /// The nearest child of a node that is met before `t_max`; the others that are go on the stack, the nearest last.
    #[inline(always)]
    fn enter(&self, wide: &Wide, index: u32, t_max: f32, stack: &mut Stack) -> Option<Entry> {
        let node = &wide.nodes[index as usize];
        let simd = self.inverse[0].token();
        let (x, y, z) = (self.near(node, 0), self.near(node, 1), self.near(node, 2));
        let near = x.max(y).max(z.max(f32x8::splat(simd, 0.0)));
        let (x, y, z) = (self.far(node, 0), self.far(node, 1), self.far(node, 2));
        let far = x.min(y).min(z.min(f32x8::splat(simd, t_max)));
        let met = near.simd_le(far).to_bitmask() as u32;
        if met == 0 {
            return None;
        }
        let mut met = Children {
            children: met,
            near: near.to_array(),
        };
        let first = met.take(wide, node);
        if met.children == 0 {
            return Some(first);
        }
        let second = met.take(wide, node);
        let (nearest, farther) = if second.0 < first.0 {
            (second, first)
        } else {
            (first, second)
        };
        if met.children == 0 {
            stack.push(farther);
            return Some(nearest);
        }
        let base = stack.height;
        stack.push(farther);
        stack.push(nearest);
        while met.children != 0 {
            stack.insert(met.take(wide, node), base);
        }
        stack.pop()
    }

    /// How far away the children's near sides are.
    #[inline(always)]
    fn near(&self, node: &Node, axis: usize) -> f32x8<S> {
        let simd = self.inverse[0].token();
        f32x8::load_array_ref(simd, &node.sides[axis][self.near[axis] & 1]) * self.inverse[axis] + self.early[axis]
    }

    /// How far away the children's far sides are.
    #[inline(always)]
    fn far(&self, node: &Node, axis: usize) -> f32x8<S> {
        let simd = self.inverse[0].token();
        f32x8::load_array_ref(simd, &node.sides[axis][(self.near[axis] ^ 1) & 1]) * self.inverse[axis] + self.late[axis]
    }
}

/// Children that a ray meets.
struct Children {
    /// As bits, those that have not been taken.
    children: u32,
    /// How far away each child is.
    near: [f32; WIDTH],
}

impl Children {
    /// The next, which the processor is to fetch meanwhile: rays wait for memory more than for anything else.
    #[inline(always)]
    fn take(&mut self, wide: &Wide, node: &Node) -> Entry {
        let child = (self.children.trailing_zeros() % WIDTH as u32) as usize;
        self.children &= self.children - 1;
        wide.prefetch(node.children[child]);
        Entry::new(self.near[child], node.children[child])
    }
}

/// Triangles of a block that a ray meets.
struct TrianglesMet<S: Simd> {
    /// As bits.
    met: u32,
    /// How far away.
    t: f32x8<S>,
    /// Twice the areas that the ray cuts each projected triangle into, opposite to its corners.
    areas: [f32x8<S>; 3],
}

/// What the test against triangles needs of a ray.
pub(super) struct TriangleRay<S: Simd> {
    pub origin: [f32x8<S>; 3],
    pub direction: [f32x8<S>; 3],
    pub axes: [usize; 3],
    pub shear: [f32x8<S>; 2],
}

impl<S: Simd> TriangleRay<S> {
    #[inline(always)]
    fn new(simd: S, frame: &RayFrame) -> Self {
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

    /// Which triangles of a block are met with 0 < t ≤ `t_max`, where t is `entered` at least.
    #[inline(always)]
    fn meet(&self, block: &Block, normals: &Normals, [entered, t_max]: [f32; 2]) -> TrianglesMet<S> {
        let simd = self.origin[0].token();
        let zero = f32x8::splat(simd, 0.0);
        let [(ax, ay), (bx, by), (cx, cy)] = [self.project(block, 0), self.project(block, 1), self.project(block, 2)];
        // Neighbours share an edge's area but for its sign, as no product is fused.
        let (u, v, w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
        let areas = [u, v, w];
        let is_inside = (u.simd_ge(zero) & v.simd_ge(zero) & w.simd_ge(zero))
            | (u.simd_le(zero) & v.simd_le(zero) & w.simd_le(zero));
        if is_inside.all_false() {
            return TrianglesMet { met: 0, t: zero, areas };
        }
        let x = f32x8::load_array_ref(simd, &normals.axes[0]);
        let y = f32x8::load_array_ref(simd, &normals.axes[1]);
        let z = f32x8::load_array_ref(simd, &normals.axes[2]);
        let [dx, dy, dz] = self.direction;
        let from_origin = [
            self.place(block, 0, 0),
            self.place(block, 0, 1),
            self.place(block, 0, 2),
        ];
        let t = (x * from_origin[0] + y * from_origin[1] + z * from_origin[2]) / (x * dx + y * dy + z * dz);
        let placed = t.max(f32x8::splat(simd, entered));
        // Not where the triangle is seen from its side; nor where t is NaN.
        let is_before = t.simd_gt(zero) & placed.simd_le(f32x8::splat(simd, t_max));
        let is_met = is_inside & !(u + v + w).simd_eq(zero) & is_before;
        TrianglesMet {
            met: is_met.to_bitmask() as u32,
            t: placed,
            areas,
        }
    }

    /// A coordinate of a corner, from the ray's origin.
    #[inline(always)]
    fn place(&self, block: &Block, corner: usize, axis: usize) -> f32x8<S> {
        f32x8::load_array_ref(self.origin[0].token(), &block.corners[corner][axis]) - self.origin[axis]
    }

    /// A corner along the ray.
    #[inline(always)]
    fn project(&self, block: &Block, corner: usize) -> (f32x8<S>, f32x8<S>) {
        let [axis_x, axis_y, along] = self.axes;
        let depth = self.place(block, corner, along);
        (
            self.place(block, corner, axis_x) + depth * self.shear[0],
            self.place(block, corner, axis_y) + depth * self.shear[1],
        )
    }
}

/// A child to be visited and how far away its box is, ordered by the distance: that is not negative, so that its bits
/// are in its order.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Entry(u64);

impl Entry {
    /// The node around all.
    pub const ROOT: Self = Self(0);

    #[inline(always)]
    pub fn new(distance: f32, place: u32) -> Self {
        Self(u64::from(distance.to_bits()) << 32 | u64::from(place))
    }

    #[inline(always)]
    pub fn place(self) -> u32 {
        self.0 as u32
    }

    #[inline(always)]
    fn distance(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }
}

/// Children to be visited, the next one last. Not filled beforehand: that would take longer than many a ray.
pub(super) struct Stack {
    entries: [MaybeUninit<Entry>; STACK_SIZE],
    /// How many there are.
    pub height: usize,
}

impl Stack {
    #[inline(always)]
    pub fn new() -> Self {
        Self {
            entries: [const { MaybeUninit::uninit() }; STACK_SIZE],
            height: 0,
        }
    }

    #[inline(always)]
    pub fn push(&mut self, entry: Entry) {
        self.entries[self.height].write(entry);
        self.height += 1;
    }

    #[inline(always)]
    pub fn pop(&mut self) -> Option<Entry> {
        self.height = self.height.checked_sub(1)?;
        // SAFETY: everything below the height that was has been written by `push` or `insert`.
        Some(unsafe { self.entries[self.height].assume_init() })
    }

    /// The next that is no farther than `t_max`.
    #[inline(always)]
    pub fn pop_before(&mut self, t_max: f32) -> Option<Entry> {
        loop {
            let entry = self.pop()?;
            if entry.distance() <= t_max {
                return Some(entry);
            }
        }
    }

    /// Pushes an entry below those from `base` on that are nearer.
    #[inline(always)]
    pub fn insert(&mut self, entry: Entry, base: usize) {
        let mut place = self.height;
        self.height += 1;
        while place > base {
            let below = self.entries[place - 1];
            // SAFETY: it is below the height that was, see `pop`.
            if unsafe { below.assume_init() }.0 >= entry.0 {
                break;
            }
            self.entries[place] = below;
            place -= 1;
        }
        self.entries[place].write(entry);
    }
}
