//! Many rays that go much the same way as one interval: what that does not meet, none of them meets.

use fearless_simd::{ExtractToken, Level, Simd, SimdBase, SimdMask, dispatch, f32x8};

use super::packet::{PACKET, Packet, Rays, load};
use super::traverse::{Entry, INVERSE_MAX, PLACE_ERROR, Stack};
use super::wide::{BLOCK, WIDTH, Wide};

/// Doors at most: each ray's packet tries all of them.
const DOORS_MAX: usize = 6;

/// Where rays of some packets may enter the hierarchy: boxes without which none of them meets anything.
#[derive(Clone, Copy)]
pub(in crate::scene) struct Doors {
    /// The nearest last.
    entries: [Entry; DOORS_MAX],
    count: usize,
}

impl Doors {
    /// True where no ray meets anything.
    pub fn are_none(&self) -> bool {
        self.count == 0
    }

    /// Puts them on the stack.
    #[inline(always)]
    pub(super) fn enter(&self, stack: &mut Stack) {
        for entry in &self.entries[..self.count] {
            stack.push(*entry);
        }
    }

    /// Takes what was found, of which there is no more than there is room for.
    #[inline(always)]
    fn take(&mut self, found: &mut Stack) {
        while let Some(entry) = found.pop() {
            self.entries[self.count] = entry;
            self.count += 1;
        }
    }
}

impl Wide {
    /// Where rays of these packets may enter, as far down as there are not many doors; `None` where they do not go much the
    /// same way, and may enter anywhere.
    pub fn doors(&self, level: Level, packets: &[Packet]) -> Option<Doors> {
        dispatch!(level, simd => doors(simd, self, packets))
    }
}

#[inline(always)]
fn doors<S: Simd>(simd: S, wide: &Wide, packets: &[Packet]) -> Option<Doors> {
    let mut doors = Doors {
        entries: [Entry::ROOT; DOORS_MAX],
        count: 0,
    };
    if wide.nodes.is_empty() {
        return Some(doors);
    }
    let bundle = Bundle::around(simd, packets, wide)?;
    let mut found = Stack::new();
    bundle.enter(wide, 0, f32::MAX, &mut found);
    if found.height > DOORS_MAX {
        return None;
    }
    doors.take(&mut found);
    let mut closed = 0;
    while closed < doors.count {
        let (parent, child) = Place(doors.entries[closed].place()).parts();
        let place = wide.nodes[parent].children[child];
        if place & BLOCK == 0 {
            bundle.enter(wide, place, f32::MAX, &mut found);
        }
        if place & BLOCK != 0 || doors.count - 1 + found.height > DOORS_MAX {
            found.height = 0;
            closed += 1;
        } else {
            doors.count -= 1;
            doors.entries[closed] = doors.entries[doors.count];
            doors.take(&mut found);
        }
    }
    doors.entries[..doors.count].sort_unstable_by(|a, b| b.cmp(a));
    Some(doors)
}

/// The least and the largest of numbers; `None` where one is not a number.
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
    let extent = [simd.reduce_min_f32x16(low), simd.reduce_max_f32x16(high)];
    are_numbers.all_true().then_some(extent)
}

/// A child of a node by its number among all that nodes have.
pub(super) struct Place(pub u32);

impl Place {
    #[inline(always)]
    fn new(node: u32, child: usize) -> Self {
        Self(node * WIDTH as u32 + child as u32)
    }

    /// The node and which of its children.
    #[inline(always)]
    pub fn parts(self) -> (usize, usize) {
        (self.0 as usize / WIDTH, self.0 as usize % WIDTH)
    }
}

/// The interval of all rays: what it does not meet, none of them meets.
pub(super) struct Bundle<S: Simd> {
    /// The least and the largest inverse direction on each axis.
    inverse: [[f32x8<S>; 2]; 3],
    /// The origin that a box's near side is nearest to, and that its far side is farthest from, with a margin for rounding.
    origin: [[f32x8<S>; 2]; 3],
    /// Which of the two sides of a box is near on each axis.
    near: [usize; 3],
}

impl<S: Simd> Bundle<S> {
    #[inline(always)]
    fn nothing(simd: S, near: [usize; 3]) -> Self {
        let zero = [f32x8::splat(simd, 0.0); 2];
        Self {
            inverse: [zero; 3],
            origin: [zero; 3],
            near,
        }
    }

    /// The interval of a packet's rays.
    #[inline(always)]
    pub fn of(simd: S, rays: &Rays<S>, wide: &Wide) -> Self {
        let mut bundle = Self::nothing(simd, rays.near);
        let mut axis = 0;
        while axis < 3 {
            let (inverse, origin) = (rays.inverse[axis], rays.origin[axis]);
            let inverse = [simd.reduce_min_f32x16(inverse), simd.reduce_max_f32x16(inverse)];
            let origin = [simd.reduce_min_f32x16(origin), simd.reduce_max_f32x16(origin)];
            bundle.set(axis, inverse, origin, wide);
            axis += 1;
        }
        bundle
    }

    /// The interval of the rays of packets; `None` where their directions have other signs, or one is no number.
    #[inline(always)]
    fn around(simd: S, packets: &[Packet], wide: &Wide) -> Option<Self> {
        let mut bundle = Self::nothing(simd, [0; 3]);
        let mut axis = 0;
        while axis < 3 {
            let origin = extent(simd, packets.iter().map(|packet| &packet.origins[axis]))?;
            let [low, high] = extent(simd, packets.iter().map(|packet| &packet.directions[axis]))?;
            let is_backward = high < 0.0;
            if low < 0.0 && !is_backward {
                return None;
            }
            bundle.near[axis] = usize::from(is_backward);
            // Rounded as each ray's own, between which they are in any case.
            let inverse = [low, high].map(|direction| (1.0 / direction.abs()).min(INVERSE_MAX));
            let inverse = if is_backward {
                [-inverse[1], -inverse[0]]
            } else {
                [inverse[1], inverse[0]]
            };
            bundle.set(axis, inverse, origin, wide);
            axis += 1;
        }
        Some(bundle)
    }

    #[inline(always)]
    fn set(&mut self, axis: usize, [least, most]: [f32; 2], [low, high]: [f32; 2], wide: &Wide) {
        let simd = self.inverse[0][0].token();
        self.inverse[axis] = [f32x8::splat(simd, least), f32x8::splat(simd, most)];
        let margin = 2.0 * PLACE_ERROR * (wide.reach[axis] + low.abs().max(high.abs()));
        let outer = [low - margin, high + margin];
        let near = self.near[axis];
        self.origin[axis] = [
            f32x8::splat(simd, outer[(near ^ 1) & 1]),
            f32x8::splat(simd, outer[near & 1]),
        ];
    }

    /// Puts the children of a node on the stack that some ray may meet, the nearest last.
    #[inline(always)]
    pub fn enter(&self, wide: &Wide, index: u32, limit: f32, stack: &mut Stack) {
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
        let mut met = near.simd_le(far).to_bitmask() as u32;
        let distances = near.to_array();
        let base = stack.height;
        while met != 0 {
            let child = (met.trailing_zeros() % WIDTH as u32) as usize;
            met &= met - 1;
            wide.prefetch(node.children[child]);
            stack.insert(Entry::new(distances[child], Place::new(index, child).0), base);
        }
    }
}
