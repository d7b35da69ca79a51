//! The brightest place of an environment.

use std::f32::consts::PI;

use super::{distribution::Luminances, environment_direction, environment_uv};
use crate::optics::vector::Vec3;

/// Share of the peak brightness from which connected cells belong to the brightest region.
const SHARE: f64 = 0.5;

/// Centre (u, v) of the cells around the brightest one that are at least half as bright; `None` for a black map.
pub fn brightest(luminances: &Luminances) -> Option<[f32; 2]> {
    let cells = &luminances.cells;
    let first = (0..cells.len()).max_by(|a, b| cells[*a].total_cmp(&cells[*b]))?;
    let least = SHARE * cells[first];
    if least <= 0.0 {
        return None;
    }
    let (columns, rows) = (luminances.width as usize, luminances.height as usize);
    let mut is_taken = vec![false; cells.len()];
    let mut open = vec![first];
    is_taken[first] = true;
    let mut sum = Vec3::ZERO;
    while let Some(index) = open.pop() {
        let (column, row) = (index % columns, index / columns);
        let uv = [(column as f32 + 0.5) / columns as f32, (row as f32 + 0.5) / rows as f32];
        sum += environment_direction(uv) * (cells[index] as f32 * (PI * uv[1]).sin());
        let beside = [
            Some(row * columns + (column + 1) % columns),
            Some(row * columns + (column + columns - 1) % columns),
            index.checked_sub(columns),
            Some(index + columns).filter(|below| *below < cells.len()),
        ];
        for next in beside.into_iter().flatten() {
            if !is_taken[next] && cells[next] >= least {
                is_taken[next] = true;
                open.push(next);
            }
        }
    }
    // A ring around the sky has no centre: its brightest cell is used.
    if sum.length() < 1e-6 {
        sum = environment_direction([
            ((first % columns) as f32 + 0.5) / columns as f32,
            ((first / columns) as f32 + 0.5) / rows as f32,
        ]);
    }
    Some(environment_uv(sum))
}
