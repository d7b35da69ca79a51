//! Packets through the CPU's hierarchy. The interval of all rays tests a node's eight boxes first, so that rays through empty
//! space end at once.

use fearless_simd::{Level, Simd, SimdMask};

use super::{
    interval::{ChildId, EntryPoints, RayInterval},
    packet::{PACKET, Packet, PacketHits, PacketRays, common_octant, load},
    traverse::Stack,
    wide::{BLOCK, Wide},
};

/// At or below this many active rays, they continue as single rays: testing eight boxes or triangles at a time is cheaper
/// than a nearly empty packet.
const SINGLE_MAX: u32 = 4;

impl Wide {
    /// Updates each ray with its closest hit with 0 < t, if that is nearer than its current one; with any hit if it has none
    /// yet, if `ANY`. Traversal starts from `entry_points`, or from the root. Returns false, and changes nothing, if the rays
    /// are not all in one octant.
    pub fn hits<const ANY: bool>(
        &self,
        level: Level,
        packet: &Packet,
        entry_points: Option<&EntryPoints>,
        hits: &mut PacketHits,
    ) -> bool {
        dispatch!(level, simd => trace::<_, ANY>(simd, self, packet, entry_points, hits))
    }
}

/// Traces a packet for closest hits, or for any hits if `ANY`.
#[inline(always)]
fn trace<S: Simd, const ANY: bool>(
    simd: S,
    wide: &Wide,
    packet: &Packet,
    entry_points: Option<&EntryPoints>,
    hits: &mut PacketHits,
) -> bool {
    let Some(octant) = common_octant(simd, packet) else {
        return false;
    };
    if wide.nodes.is_empty() {
        return true;
    }
    let rays = PacketRays::new(simd, packet, wide, octant);
    let interval = RayInterval::of(simd, &rays, wide);
    let mut limit = largest(simd, &hits.t);
    let mut stack = Stack::new();
    match entry_points {
        Some(entry_points) => entry_points.push_to(&mut stack),
        None => interval.push_children(wide, 0, limit, &mut stack),
    }
    while let Some(next) = stack.pop_before(limit) {
        let (parent, child) = ChildId(next.child()).parts();
        let parent = &wide.nodes[parent];
        let Some(entered) = rays.intersect_box(parent, child, &hits.t) else {
            continue;
        };
        let target = parent.children[child];
        let is_closer = if entered.mask.to_bitmask().count_ones() <= SINGLE_MAX {
            rays.traverse_singly::<ANY>(wide, target, &entered, hits)
        } else if target & BLOCK == 0 {
            interval.push_children(wide, target, limit, &mut stack);
            false
        } else {
            rays.intersect_block::<ANY>(wide, (target & !BLOCK) as usize, &entered, hits)
        };
        if is_closer {
            limit = largest(simd, &hits.t);
        }
    }
    true
}

#[inline(always)]
fn largest<S: Simd>(simd: S, lanes: &[f32; PACKET]) -> f32 {
    simd.reduce_max_f32x16(load(simd, lanes))
}
