//! Light profiles: how the intensity of a lamp depends on the direction, as measured. [`profile_share`] has a WGSL twin in
//! `shaders/scene/light.wgsl`.
//!
//! Angles are those of type C photometry: the vertical one is 0 towards what the lamp faces; the horizontal one turns from
//! its width to its height.

use std::f64::consts::PI;

use super::area_shape::AreaFrame;
use crate::optics::prelude::*;

/// Angles of one kind at most.
pub const ANGLES_MAX: usize = 2048;
/// Tolerance of angles, degrees.
const ANGLE_ERROR_DEG: f32 = 0.01;
/// Numbers of a table before its angles: axes, each followed by a count.
pub const PROFILE_AXES_LENGTH: usize = 12;

/// Intensities over a grid of angles; between them they are linear in both.
#[derive(Clone, Debug, PartialEq)]
pub struct LightProfile {
    /// Ascending, within 0 to 180 degrees; outside them there is no light.
    vertical_deg: Vec<f32>,
    /// Ascending from 0 to 360 degrees, or a single one where the profile is round.
    horizontal_deg: Vec<f32>,
    /// Those of all vertical angles for each horizontal angle, over their mean in all directions.
    shares: Vec<f32>,
    /// Mean intensity in all directions, candela.
    mean_cd: f64,
}

impl LightProfile {
    /// A profile from a grid of intensities in candela, those of all vertical angles for each horizontal angle. Horizontal
    /// angles up to 90 or 180 degrees, or from 90 to 270, are mirrored.
    pub fn new(vertical_deg: Vec<f32>, horizontal_deg: &[f32], candela: &[f32]) -> Result<Self, String> {
        check_angles("vertical", &vertical_deg, 180.0)?;
        check_angles("horizontal", horizontal_deg, 360.0)?;
        let count = vertical_deg.len();
        if vertical_deg.len() < 2 || candela.len() != count * horizontal_deg.len() {
            return Err(format!("{} intensities for its angles", candela.len()));
        }
        if !candela.iter().all(|x| (0.0..=1e9).contains(x)) {
            return Err("an intensity is negative or above 1e9".to_owned());
        }
        let rows = rows_around(horizontal_deg)?;
        let (horizontal_deg, rows): (Vec<f32>, Vec<usize>) = rows.into_iter().unzip();
        let shares = rows
            .into_iter()
            .flat_map(|row| &candela[row * count..(row + 1) * count])
            .copied()
            .collect();
        let mut profile = Self {
            vertical_deg,
            horizontal_deg,
            shares,
            mean_cd: 1.0,
        };
        profile.mean_cd = profile.mean_share();
        if profile.mean_cd <= 0.0 {
            return Err("all its intensities are 0".to_owned());
        }
        let scale = profile.mean_cd;
        profile
            .shares
            .iter_mut()
            .for_each(|share| *share = (f64::from(*share) / scale) as f32);
        Ok(profile)
    }

    /// Luminous flux in all directions, lumens.
    pub fn lumens(&self) -> f64 {
        4.0 * PI * self.mean_cd
    }

    /// The mean over the sphere, exact for what is linear in both angles.
    fn mean_share(&self) -> f64 {
        let count = self.vertical_deg.len();
        let of_row = |row: usize| {
            let shares = &self.shares[row * count..(row + 1) * count];
            let cells = (1..count).map(|i| {
                let [low, high] = [i - 1, i].map(|i| f64::from(self.vertical_deg[i]).to_radians());
                let [a, b] = [i - 1, i].map(|i| f64::from(shares[i]));
                a * low.cos() - b * high.cos() + (b - a) / (high - low) * (high.sin() - low.sin())
            });
            0.5 * cells.sum::<f64>()
        };
        let angles = &self.horizontal_deg;
        if angles.len() == 1 {
            return of_row(0);
        }
        let cells = (1..angles.len())
            .map(|i| 0.5 * (f64::from(angles[i] - angles[i - 1]) / 360.0) * (of_row(i - 1) + of_row(i)));
        cells.sum()
    }

    /// The table of a lamp that is placed like this, for [`profile_share`].
    pub fn table(&self, frame: &AreaFrame) -> Vec<f32> {
        let counts = [self.vertical_deg.len(), self.horizontal_deg.len(), 0];
        let axes = [-frame.outwards, frame.across, frame.up];
        let mut table: Vec<f32> = std::iter::zip(axes, counts)
            .flat_map(|(axis, count)| {
                let [x, y, z] = axis.to_array().map(|x| x as f32);
                [x, y, z, count as f32]
            })
            .collect();
        table.extend(&self.vertical_deg);
        table.extend(&self.horizontal_deg);
        table.extend(&self.shares);
        table
    }
}

fn check_angles(kind: &str, angles: &[f32], most: f32) -> Result<(), String> {
    let is_ascending = angles.windows(2).all(|pair| pair[1] - pair[0] > ANGLE_ERROR_DEG);
    let is_within = angles.iter().all(|angle| (0.0..=most).contains(angle));
    if angles.is_empty() || angles.len() > ANGLES_MAX || !is_ascending || !is_within {
        return Err(format!("its {kind} angles do not ascend from 0 to {most} degrees"));
    }
    Ok(())
}

/// The horizontal angles all around, each with the row that it shows.
fn rows_around(angles: &[f32]) -> Result<Vec<(f32, usize)>, String> {
    let near = |a: f32, b: f32| (a - b).abs() < ANGLE_ERROR_DEG;
    let (first, last) = (angles[0], angles[angles.len() - 1]);
    if angles.len() == 1 {
        return Ok(vec![(0.0, 0)]);
    }
    let mirrored = |angle: f32| -> Vec<f32> {
        match (first, last) {
            (first, last) if near(first, 0.0) && near(last, 90.0) => {
                vec![angle, 180.0 - angle, 180.0 + angle, 360.0 - angle]
            }
            (first, last) if near(first, 0.0) && near(last, 180.0) => vec![angle, 360.0 - angle],
            (first, last) if near(first, 90.0) && near(last, 270.0) => vec![angle, (540.0 - angle) % 360.0],
            _ => vec![angle],
        }
    };
    let all = angles.iter().zip(0..);
    let mut rows: Vec<(f32, usize)> = all
        .flat_map(|(angle, row)| mirrored(*angle).into_iter().map(move |angle| (angle, row)))
        .filter(|(angle, _)| *angle < 360.0 - ANGLE_ERROR_DEG)
        .collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    rows.dedup_by(|a, b| near(a.0, b.0));
    let start = rows[0];
    let is_whole = near(start.0, 0.0) && rows[rows.len() - 1].0 > 180.0 - ANGLE_ERROR_DEG;
    if !is_whole {
        return Err("its horizontal angles go neither around nor to 90 or 180 degrees".to_owned());
    }
    rows.push((360.0, start.1));
    Ok(rows)
}

/// The radiance in a unit direction away from a lamp over its mean, by the table of its profile.
pub fn profile_share<T: Scalar>(table: &[f32], direction: Vec3<T>) -> T {
    let axis = |i: usize| vec3(table[4 * i], table[4 * i + 1], table[4 * i + 2]).to_f64();
    let along = |i: usize| direction.dot(Vec3::from_f64(axis(i)));
    let [ahead, across, up] = [along(0), along(1), along(2)];
    let aside = (across * across + up * up).sqrt();
    let degrees = T::from_f64(180.0 / PI);
    let vertical = (aside.atan2(ahead) * degrees).min(T::from_f64(180.0));
    let [rows, columns] = [table[3] as usize, table[7] as usize];
    let angles = &table[PROFILE_AXES_LENGTH..];
    let (verticals, horizontals) = (&angles[..rows], &angles[rows..rows + columns]);
    let shares = &angles[rows + columns..];
    let bound = |angle: f32| T::from_f64(f64::from(angle));
    if vertical < bound(verticals[0]) || vertical > bound(verticals[rows - 1]) {
        return T::ZERO;
    }
    let (row, beyond) = angle_cell(verticals, vertical);
    let of_column = |column: usize| {
        let [low, high] = [row, row + 1].map(|row| bound(shares[column * rows + row]));
        low + (high - low) * beyond
    };
    if columns == 1 || aside <= T::ZERO {
        return of_column(0);
    }
    let turned = up.atan2(across) * degrees;
    let turned = if turned < T::ZERO {
        turned + T::from_f64(360.0)
    } else {
        turned
    };
    let (column, beyond) = angle_cell(horizontals, turned);
    let [low, high] = [column, column + 1].map(of_column);
    low + (high - low) * beyond
}

/// The last angle not above one, at most the last but one, and the share of the way to the next.
fn angle_cell<T: Scalar>(angles: &[f32], angle: T) -> (usize, T) {
    let at = |index: usize| T::from_f64(f64::from(angles[index]));
    let (mut low, mut high) = (0, angles.len() - 1);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if angle < at(middle) {
            high = middle
        } else {
            low = middle
        }
    }
    (low, ((angle - at(low)) / (at(high) - at(low))).max(T::ZERO).min(T::ONE))
}
