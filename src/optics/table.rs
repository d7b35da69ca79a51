//! Tables of materials, all in one array of numbers. Each starts at a multiple of [`NODE_LENGTH`], which the GPU loads at
//! once (`table_numbers` in `shaders/scene/layout.wgsl`).

use super::real::{Real, inlined};

/// Numbers of a node.
pub const NODE_LENGTH: usize = 4;

/// Appends a table and returns its start.
pub fn append_table(tables: &mut Vec<f32>, table: &[f32]) -> u32 {
    let first = tables.len();
    tables.extend(table);
    tables.resize(tables.len().next_multiple_of(NODE_LENGTH), 0.0);
    first as u32
}

/// A number of a table's node.
#[inline(always)]
pub fn look_up_number<T: Real>(table: &[f32], number: usize, node: T) -> T {
    T::look_up(&table[number..], T::from_f64(NODE_LENGTH as f64) * node)
}

inlined! {
    /// The last equidistant node not above a value in [0, 1], at most the last but one, and the offset of the value beyond it.
    pub fn node_below<T: Real>(value: T, nodes: usize) -> [T; 2] {
        let last = T::from_f64(nodes as f64 - 1.0);
        let position = value.clamp(T::ZERO, T::ONE) * last;
        let low = position.floor().min(last - T::ONE);
        [low, position - low]
    }

    /// A value between the equidistant nodes of a table of single numbers, the first for 0, the last for 1; linear.
    pub fn table_lookup<T: Real>(tables: &[f32], table: u32, nodes: usize, place: T) -> T {
        let [low, beyond] = node_below(place, nodes);
        let table = &tables[table as usize..];
        let (left, right) = (T::look_up(table, low), T::look_up(&table[1..], low));
        left + (right - left) * beyond
    }
}
