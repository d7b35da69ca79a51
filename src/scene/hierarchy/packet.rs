//! Sixteen rays that go much the same way through the processor's hierarchy together: a node's eight boxes are met by the
//! interval of all rays first, so that rays through empty space end at once.
//!
//! Which rays meet a block's box or a triangle, and where, is computed for each as for single rays, to the last bit; a ray is
//! met by triangles of blocks alone whose boxes it meets itself, and of triangles as far away the first counts. So a ray meets
//! in company what it meets by itself, and it does not matter which rays make a packet.

use fearless_simd::{ExtractToken, Level, Simd, SimdBase, SimdMask, dispatch, f32x8, f32x16, mask32x16};

use super::bundle::{Bundle, Doors, Place};
use super::traverse::{BoxRay, Entry, INVERSE_MAX, Met, PLACE_ERROR, SingleRay, Stack, TriangleRay};
use super::wide::{BLOCK, Block, Node, Normals, WIDTH, Wide};
use crate::scene::Hit;

/// Rays of a packet.
pub const PACKET: usize = 16;

/// So few rays go on one after the other, as eight boxes or triangles at a time take less than all rays.
const FEW: u32 = 4;

/// Rays, axis by axis.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Packet {
    /// Where they start.
    pub origins: [[f32; PACKET]; 3],
    /// Where they go.
    pub directions: [[f32; PACKET]; 3],
    /// How far they go; negative where there is no ray.
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
    /// Of rays, sixteen at most: their origins, directions, and how far they go.
    #[inline(always)]
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

    /// Puts a ray in.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, origin: [f32; 3], direction: [f32; 3], t_max: f32) {
        for axis in 0..3 {
            self.origins[axis][lane] = origin[axis];
            self.directions[axis][lane] = direction[axis];
        }
        self.t_max[lane] = t_max;
    }

    /// The origin of a ray.
    #[inline(always)]
    pub fn origin(&self, lane: usize) -> [f32; 3] {
        self.origins.map(|axis| axis[lane])
    }

    /// The direction of a ray.
    #[inline(always)]
    pub fn direction(&self, lane: usize) -> [f32; 3] {
        self.directions.map(|axis| axis[lane])
    }

    /// Has the first ray stand in where there is none: it goes the same way and is met by nothing.
    #[inline(always)]
    pub fn fill(&mut self, count: usize) {
        let (origin, direction) = (self.origin(0), self.direction(0));
        (count..PACKET).for_each(|lane| self.set(lane, origin, direction, -1.0));
    }
}

/// What the rays of a packet met.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(in crate::scene) struct Found {
    /// How far away.
    t: [f32; PACKET],
    /// One more than the triangle's number; 0 where nothing was met.
    marks: [u32; PACKET],
    /// Twice the areas that the ray cuts the projected triangle into, opposite to its corners; left out where any triangle
    /// would do.
    areas: [[f32; PACKET]; 3],
    /// Which number the first triangle has of the hierarchy that the rays go through.
    pub first: u32,
}

impl Found {
    /// Nothing yet, as far as the rays go.
    #[inline(always)]
    pub fn nothing(packet: &Packet) -> Self {
        Self {
            t: packet.t_max,
            marks: [0; PACKET],
            areas: [[0.0; PACKET]; 3],
            first: 0,
        }
    }

    /// Takes a triangle of the hierarchy that a ray meets no farther away than what was found; whether it is nearer.
    #[inline(always)]
    fn add<const ANY: bool>(&mut self, lane: usize, t: f32, areas: [f32; 3], triangle: u32) -> bool {
        let mark = self.first + triangle + 1;
        // Of two as far away the first: so it does not matter in which order they are found.
        let is_nearer = t < self.t[lane] || mark < self.marks[lane];
        if is_nearer {
            self.t[lane] = if ANY { -1.0 } else { t };
            self.marks[lane] = mark;
            if !ANY {
                for (all, area) in self.areas.iter_mut().zip(areas) {
                    all[lane] = area;
                }
            }
        }
        is_nearer
    }

    /// Whether a ray met something.
    #[inline(always)]
    pub fn is_met(&self, lane: usize) -> bool {
        self.marks[lane] != 0
    }

    /// What a ray met.
    #[inline(always)]
    pub fn hit(&self, lane: usize) -> Option<Hit> {
        let areas = [self.areas[0][lane], self.areas[1][lane], self.areas[2][lane]];
        Some(Hit::of(self.t[lane], self.marks[lane].checked_sub(1)?, areas))
    }
}

/// Where one of a packet's rays puts what it meets.
struct OfLane<'f, const ANY: bool> {
    lane: usize,
    found: &'f mut Found,
    /// True once it has met something.
    is_new: bool,
}

impl<const ANY: bool> Met for OfLane<'_, ANY> {
    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.found.t[self.lane]
    }

    #[inline(always)]
    fn take(&mut self, t: f32, triangle: u32, areas: [f32; 3]) {
        self.is_new |= self.found.add::<ANY>(self.lane, t, areas, triangle);
    }
}

/// Which way a ray goes: the signs of its direction, and its longest axis. Rays of a packet go the same way.
#[inline(always)]
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

/// How many ways there are.
pub const OCTANTS: usize = 24;

impl Wide {
    /// Puts the nearest triangle with 0 < t on each ray in that is nearer than what was found, of what is behind these doors;
    /// false where the rays do not go the same way, and nothing is done.
    pub fn nearest_of(&self, level: Level, packet: &Packet, doors: Option<&Doors>, found: &mut Found) -> bool {
        dispatch!(level, simd => trace::<_, false>(simd, self, packet, doors, found))
    }

    /// The same with some triangle on each ray, unless one was found.
    pub fn any_of(&self, level: Level, packet: &Packet, found: &mut Found) -> bool {
        dispatch!(level, simd => trace::<_, true>(simd, self, packet, None, found))
    }
}

/// Puts the nearest triangles in, or the first that are found if `ANY`.
#[inline(always)]
fn trace<S: Simd, const ANY: bool>(
    simd: S,
    wide: &Wide,
    packet: &Packet,
    doors: Option<&Doors>,
    found: &mut Found,
) -> bool {
    let Some(way) = way_of(simd, packet) else {
        return false;
    };
    if wide.nodes.is_empty() {
        return true;
    }
    let rays = Rays::new(simd, packet, wide, way);
    let bundle = Bundle::of(simd, &rays, wide);
    let mut limit = largest(simd, &found.t);
    let mut stack = Stack::new();
    match doors {
        Some(doors) => doors.enter(&mut stack),
        None => bundle.enter(wide, 0, limit, &mut stack),
    }
    while let Some(next) = stack.pop_before(limit) {
        let (parent, child) = Place(next.place()).parts();
        let parent = &wide.nodes[parent];
        let Some(entered) = rays.enter(parent, child, &found.t) else {
            continue;
        };
        let place = parent.children[child];
        let is_new = if entered.met.to_bitmask().count_ones() <= FEW {
            rays.search_alone::<ANY>(wide, place, &entered, found)
        } else if place & BLOCK == 0 {
            bundle.enter(wide, place, limit, &mut stack);
            false
        } else {
            rays.meet::<ANY>(wide, (place & !BLOCK) as usize, &entered, found)
        };
        if is_new {
            limit = largest(simd, &found.t);
        }
    }
    true
}

#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, lanes: &[f32; PACKET]) -> f32x16<S> {
    f32x16::load_array_ref(simd, lanes)
}

#[inline(always)]
fn load_three<S: Simd>(simd: S, axes: &[[f32; PACKET]; 3]) -> [f32x16<S>; 3] {
    [load(simd, &axes[0]), load(simd, &axes[1]), load(simd, &axes[2])]
}

#[inline(always)]
fn largest<S: Simd>(simd: S, lanes: &[f32; PACKET]) -> f32 {
    simd.reduce_max_f32x16(load(simd, lanes))
}

/// The way of all rays; `None` where they differ.
#[inline(always)]
fn way_of<S: Simd>(simd: S, packet: &Packet) -> Option<usize> {
    let way = ray_octant(packet.direction(0));
    let zero = f32x16::splat(simd, 0.0);
    let directions = load_three(simd, &packet.directions);
    let mut axis = 0;
    while axis < 3 {
        let backward = directions[axis].simd_lt(zero);
        let is_alike = if way >> axis & 1 == 1 {
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
    let is_alike = match way >> 3 {
        2 => along_z.all_true(),
        1 => along_z.all_false() && y.simd_ge(x).all_true(),
        _ => along_z.all_false() && y.simd_ge(x).all_false(),
    };
    is_alike.then_some(way)
}

/// How rays meet a box.
struct Entered<S: Simd> {
    /// Which of them do.
    met: mask32x16<S>,
    /// How far away, at least 0.
    distance: f32x16<S>,
}

/// What the tests of single rays need of each ray.
pub(super) struct Rays<S: Simd> {
    pub origin: [f32x16<S>; 3],
    direction: [f32x16<S>; 3],
    pub inverse: [f32x16<S>; 3],
    early: [f32x16<S>; 3],
    late: [f32x16<S>; 3],
    /// Which of the two sides of a box is near on each axis.
    pub near: [usize; 3],
    axes: [usize; 3],
    shear: [f32x16<S>; 2],
}

impl<S: Simd> Rays<S> {
    #[inline(always)]
    fn new(simd: S, packet: &Packet, wide: &Wide, way: usize) -> Self {
        let axes = [[1, 2, 0], [0, 2, 1], [0, 1, 2]][way >> 3];
        let [axis_x, axis_y, along] = axes;
        let direction = load_three(simd, &packet.directions);
        let mut rays = Self {
            origin: load_three(simd, &packet.origins),
            direction,
            inverse: direction,
            early: direction,
            late: direction,
            near: [way & 1, way >> 1 & 1, way >> 2 & 1],
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

    /// What the test against boxes needs on an axis, as for single rays.
    #[inline(always)]
    fn invert(&mut self, wide: &Wide, axis: usize) {
        let (origin, direction) = (self.origin[axis], self.direction[axis]);
        let simd = origin.token();
        let size = (f32x16::splat(simd, 1.0) / direction.abs()).min(f32x16::splat(simd, INVERSE_MAX));
        let inverse = if self.near[axis] == 1 { -size } else { size };
        let reach = f32x16::splat(simd, wide.reach[axis]) + origin.abs();
        let (shift, margin) = (-origin * inverse, reach * size * f32x16::splat(simd, PLACE_ERROR));
        self.inverse[axis] = inverse;
        self.early[axis] = shift - margin;
        self.late[axis] = shift + margin;
    }

    /// Which rays meet a child's box before they end, and where they enter it; `None` where no ray does.
    #[inline(always)]
    fn enter(&self, node: &Node, child: usize, t_max: &[f32; PACKET]) -> Option<Entered<S>> {
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
        let left = x.min(y).min(z.min(limits));
        let met = distance.simd_le(left);
        met.any_true().then_some(Entered { met, distance })
    }

    /// How far away a child's near side is.
    #[inline(always)]
    fn near(&self, node: &Node, child: usize, axis: usize) -> f32x16<S> {
        let side = node.sides[axis][self.near[axis] & 1][child];
        f32x16::splat(self.origin[0].token(), side) * self.inverse[axis] + self.early[axis]
    }

    /// How far away a child's far side is.
    #[inline(always)]
    fn far(&self, node: &Node, child: usize, axis: usize) -> f32x16<S> {
        let side = node.sides[axis][(self.near[axis] ^ 1) & 1][child];
        f32x16::splat(self.origin[0].token(), side) * self.inverse[axis] + self.late[axis]
    }

    /// Has the rays that meet a child's box go on through what is under it one after the other; whether any meets something
    /// nearer than what was found.
    #[inline(always)]
    fn search_alone<const ANY: bool>(&self, wide: &Wide, child: u32, entered: &Entered<S>, found: &mut Found) -> bool {
        let mut rays = entered.met.to_bitmask();
        let distances = entered.distance.to_array();
        let mut is_new = false;
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize % PACKET;
            rays &= rays - 1;
            let mut lane_met = OfLane::<ANY> {
                lane,
                found,
                is_new: false,
            };
            let entry = Entry::new(distances[lane], child);
            self.single(lane).search::<ANY, _>(wide, entry, &mut lane_met);
            is_new |= lane_met.is_new;
        }
        is_new
    }

    /// One of the rays by itself.
    #[inline(always)]
    fn single(&self, lane: usize) -> SingleRay<S> {
        let simd = self.origin[0].token();
        let splat = |all: f32x16<S>| f32x8::splat(simd, all.as_slice()[lane]);
        let splats = |[x, y, z]: [f32x16<S>; 3]| [splat(x), splat(y), splat(z)];
        let [shear_x, shear_y] = self.shear;
        SingleRay {
            boxes: BoxRay {
                inverse: splats(self.inverse),
                early: splats(self.early),
                late: splats(self.late),
                near: self.near,
            },
            triangles: TriangleRay {
                origin: splats(self.origin),
                direction: splats(self.direction),
                axes: self.axes,
                shear: [splat(shear_x), splat(shear_y)],
            },
        }
    }

    /// Puts the triangles of a block in that are nearer than what was found, one after the other against all rays; whether
    /// there are any.
    #[inline(always)]
    fn meet<const ANY: bool>(&self, wide: &Wide, block: usize, entered: &Entered<S>, found: &mut Found) -> bool {
        let (first, normals, block) = (wide.firsts[block], &wide.normals[block], &wide.blocks[block]);
        let simd = self.origin[0].token();
        let zero = f32x16::splat(simd, 0.0);
        let mut is_new = false;
        let mut triangle = 0;
        // Behind the last triangle of a block there is none.
        while triangle < WIDTH && !block.corners[0][0][triangle].is_nan() {
            let (ax, ay) = self.project(block, 0, triangle);
            let (bx, by) = self.project(block, 1, triangle);
            let (cx, cy) = self.project(block, 2, triangle);
            let (u, v, w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
            let is_inside = (u.simd_ge(zero) & v.simd_ge(zero) & w.simd_ge(zero))
                | (u.simd_le(zero) & v.simd_le(zero) & w.simd_le(zero));
            let is_inside = is_inside & entered.met;
            if is_inside.any_true() {
                let area = u + v + w;
                let (t, towards) = self.distance(block, normals, triangle);
                let t = t / towards;
                let placed = t.max(entered.distance);
                let is_before = t.simd_gt(zero) & placed.simd_le(load(simd, &found.t));
                let mut met = (is_inside & !area.simd_eq(zero) & is_before).to_bitmask() as u32;
                let (placed, u, v, w) = (placed.to_array(), u.to_array(), v.to_array(), w.to_array());
                while met != 0 {
                    let lane = (met.trailing_zeros() % PACKET as u32) as usize;
                    met &= met - 1;
                    let areas = [u[lane], v[lane], w[lane]];
                    is_new |= found.add::<ANY>(lane, placed[lane], areas, first + triangle as u32);
                }
            }
            triangle += 1;
        }
        is_new
    }

    /// How far the rays' origins are from the plane of a triangle, and how much nearer they come to it in a unit of length;
    /// both in lengths of its normal.
    #[inline(always)]
    fn distance(&self, block: &Block, normals: &Normals, triangle: usize) -> (f32x16<S>, f32x16<S>) {
        let simd = self.origin[0].token();
        let x = f32x16::splat(simd, normals.axes[0][triangle]);
        let y = f32x16::splat(simd, normals.axes[1][triangle]);
        let z = f32x16::splat(simd, normals.axes[2][triangle]);
        let [dx, dy, dz] = self.direction;
        let from_x = self.place(block, 0, 0, triangle);
        let from_y = self.place(block, 0, 1, triangle);
        let from_z = self.place(block, 0, 2, triangle);
        (x * from_x + y * from_y + z * from_z, x * dx + y * dy + z * dz)
    }

    /// A coordinate of a corner, from the rays' origins.
    #[inline(always)]
    fn place(&self, block: &Block, corner: usize, axis: usize, triangle: usize) -> f32x16<S> {
        f32x16::splat(self.origin[0].token(), block.corners[corner][axis][triangle]) - self.origin[axis]
    }

    /// A corner along the rays.
    #[inline(always)]
    fn project(&self, block: &Block, corner: usize, triangle: usize) -> (f32x16<S>, f32x16<S>) {
        let [axis_x, axis_y, along] = self.axes;
        let depth = self.place(block, corner, along, triangle);
        (
            self.place(block, corner, axis_x, triangle) + depth * self.shear[0],
            self.place(block, corner, axis_y, triangle) + depth * self.shear[1],
        )
    }
}
