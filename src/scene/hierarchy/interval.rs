//! Interval traversal: the interval of many coherent rays is tested against boxes. A box that it misses is missed by every
//! ray.

use crate::optics::real::inlined;
use fearless_simd::{ExtractToken, Level, Simd, SimdBase, SimdMask, f32x8};

use super::{
    packet::{PACKET, Packet, PacketRays, load},
    traverse::{INVERSE_MAX, RELATIVE_ERROR, Stack, StackEntry},
    wide::{BLOCK, WIDTH, Wide},
};

/// Entry points at most. Every packet visits all of them, so that more would not pay.
const ENTRY_POINTS_MAX: usize = 6;

/// Nodes from which packets may start their traversal, instead of the root. Rays that miss all of them miss the scene.
#[derive(Clone, Copy)]
pub struct EntryPoints {
    /// Sorted by distance, the nearest last.
    entries: [StackEntry; ENTRY_POINTS_MAX],
    count: usize,
}

impl EntryPoints {
    /// True if no ray hits anything.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Pushes the entry points onto a traversal stack.
    pub fn push_to(&self, stack: &mut Stack) {
        for entry in &self.entries[..self.count] {
            stack.push(*entry);
        }
    }

    /// Moves all entries of a stack here. Invariant: they fit.
    fn append(&mut self, found: &mut Stack) {
        while let Some(entry) = found.pop() {
            self.entries[self.count] = entry;
            self.count += 1;
        }
    }
}

impl Wide {
    /// Entry points for some packets, as deep as [`ENTRY_POINTS_MAX`] allows. `None` if the rays' directions differ in sign:
    /// then the root is the only one.
    pub fn entry_points(&self, level: Level, packets: &[Packet]) -> Option<EntryPoints> {
        dispatch!(level, simd => entry_points(simd, self, packets))
    }
}

#[inline(always)]
fn entry_points<S: Simd>(simd: S, wide: &Wide, packets: &[Packet]) -> Option<EntryPoints> {
    let mut entry_points = EntryPoints {
        entries: [StackEntry::ROOT; ENTRY_POINTS_MAX],
        count: 0,
    };
    if wide.nodes.is_empty() {
        return Some(entry_points);
    }
    let interval = RayInterval::of_packets(simd, packets, wide)?;
    let mut found = Stack::new();
    interval.push_children(wide, 0, f32::MAX, &mut found);
    if found.height > ENTRY_POINTS_MAX {
        return None;
    }
    entry_points.append(&mut found);
    let mut expanded = 0;
    while expanded < entry_points.count {
        let (parent, child) = ChildId(entry_points.entries[expanded].child()).parts();
        let target = wide.nodes[parent].children[child];
        if target & BLOCK == 0 {
            interval.push_children(wide, target, f32::MAX, &mut found);
        }
        if target & BLOCK != 0 || entry_points.count - 1 + found.height > ENTRY_POINTS_MAX {
            found.height = 0;
            expanded += 1;
        } else {
            entry_points.count -= 1;
            entry_points.entries[expanded] = entry_points.entries[entry_points.count];
            entry_points.append(&mut found);
        }
    }
    entry_points.entries[..entry_points.count].sort_unstable_by(|a, b| b.cmp(a));
    Some(entry_points)
}

/// Minimum and maximum; `None` with a NaN.
#[inline(always)]
fn extent<'a, S: Simd>(simd: S, mut numbers: impl Iterator<Item = &'a [f32; PACKET]>) -> Option<[f32; 2]> {
    let first = load(simd, numbers.next()?);
    let (mut low, mut high, mut are_numbers) = (first, first, first.simd_eq(first));
    for next in numbers {
        let next = load(simd, next);
        low = low.min(next);
        high = high.max(next);
        are_numbers &= next.simd_eq(next);
    }
    are_numbers
        .all_true()
        .then_some([simd.reduce_min_f32x16(low), simd.reduce_max_f32x16(high)])
}

/// A child's index among the children of all nodes.
pub struct ChildId(pub u32);

impl ChildId {
    fn new(node: u32, child: usize) -> Self {
        Self(node * WIDTH as u32 + child as u32)
    }

    /// The node and the child's slot in it.
    pub fn parts(self) -> (usize, usize) {
        (self.0 as usize / WIDTH, self.0 as usize % WIDTH)
    }
}

/// Interval bounds of a set of rays, for tests against eight boxes at a time.
pub struct RayInterval<S: Simd> {
    /// Minimum and maximum inverse direction on each axis.
    inverse: [[f32x8<S>; 2]; 3],
    /// Origins on each axis: the one nearest to a box's near side, and the one farthest from its far side; with a margin for
    /// rounding.
    origin: [[f32x8<S>; 2]; 3],
    /// Which side of a box is near on each axis: 0 is the low one.
    near: [usize; 3],
}

impl<S: Simd> RayInterval<S> {
    inlined! {
        fn nothing(simd: S, near: [usize; 3]) -> Self {
            let zero = [f32x8::splat(simd, 0.0); 2];
            Self {
                inverse: [zero; 3],
                origin: [zero; 3],
                near,
            }
        }

        /// The interval of one packet's rays.
        pub fn of(simd: S, rays: &PacketRays<S>, wide: &Wide) -> Self {
            let mut interval = Self::nothing(simd, rays.near);
            let mut axis = 0;
            while axis < 3 {
                let (inverse, origin) = (rays.inverse[axis], rays.origin[axis]);
                let inverse = [simd.reduce_min_f32x16(inverse), simd.reduce_max_f32x16(inverse)];
                interval.set(
                    axis,
                    inverse,
                    [simd.reduce_min_f32x16(origin), simd.reduce_max_f32x16(origin)],
                    wide,
                );
                axis += 1;
            }
            interval
        }

        /// The interval of several packets' rays; `None` if their directions differ in sign, or one is NaN.
        fn of_packets(simd: S, packets: &[Packet], wide: &Wide) -> Option<Self> {
            let mut interval = Self::nothing(simd, [0; 3]);
            let mut axis = 0;
            while axis < 3 {
                let origin = extent(simd, packets.iter().map(|packet| &packet.origins[axis]))?;
                let [low, high] = extent(simd, packets.iter().map(|packet| &packet.directions[axis]))?;
                let is_backward = high < 0.0;
                if low < 0.0 && !is_backward {
                    return None;
                }
                interval.near[axis] = usize::from(is_backward);
                // Rounding is monotonic: each ray's own inverse lies between these bounds.
                let inverse = [low, high].map(|direction| (1.0 / direction.abs()).min(INVERSE_MAX));
                let inverse = if is_backward {
                    [-inverse[1], -inverse[0]]
                } else {
                    [inverse[1], inverse[0]]
                };
                interval.set(axis, inverse, origin, wide);
                axis += 1;
            }
            Some(interval)
        }

        fn set(&mut self, axis: usize, [least, most]: [f32; 2], [low, high]: [f32; 2], wide: &Wide) {
            let simd = self.inverse[0][0].token();
            self.inverse[axis] = [f32x8::splat(simd, least), f32x8::splat(simd, most)];
            let margin = 2.0 * RELATIVE_ERROR * (wide.reach[axis] + low.abs().max(high.abs()));
            let outer = [low - margin, high + margin];
            let near = self.near[axis];
            self.origin[axis] = [
                f32x8::splat(simd, outer[(near ^ 1) & 1]),
                f32x8::splat(simd, outer[near & 1]),
            ];
        }

        /// Pushes the children of a node that the interval hits, the nearest last.
        pub fn push_children(&self, wide: &Wide, index: u32, limit: f32, stack: &mut Stack) {
            let node = &wide.nodes[index as usize];
            let simd = self.origin[0][0].token();
            let mut near = f32x8::splat(simd, 0.0);
            let mut far = f32x8::splat(simd, limit);
            let mut axis = 0;
            while axis < 3 {
                let [least, most] = self.inverse[axis];
                let sides = &node.sides[axis];
                let to_near = f32x8::load_array_ref(simd, &sides[self.near[axis] & 1]) - self.origin[axis][0];
                let to_far = f32x8::load_array_ref(simd, &sides[(self.near[axis] ^ 1) & 1]) - self.origin[axis][1];
                near = near.max((to_near * least).min(to_near * most));
                far = far.min((to_far * least).max(to_far * most));
                axis += 1;
            }
            let mut hit_bits = near.simd_le(far).to_bitmask() as u32;
            let distances = near.to_array();
            let base = stack.height;
            while hit_bits != 0 {
                let child = (hit_bits.trailing_zeros() % WIDTH as u32) as usize;
                hit_bits &= hit_bits - 1;
                wide.prefetch(node.children[child]);
                stack.insert(StackEntry::new(distances[child], ChildId::new(index, child).0), base);
            }
        }
    }
}
