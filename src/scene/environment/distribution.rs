//! The density that an environment is sampled with: piecewise constant over cells, drawn row by row.

use std::f64::consts::{PI, TAU};

use crate::{
    parallel,
    scene::inversion::{DRAW_BITS, Drawn, Share, drawn, find, shares},
    scene::memory::room_in_large_pages,
};

/// Largest number of cells: 24 MiB of table. Finer cells gain nothing that a sample could show.
const MAX_CELLS: u64 = 2048 * 1024;

/// The least share of the light that is above its mean for that to be drawn alone.
const EXCESS_MIN: f64 = 0.05;

/// One cell of the distribution.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cell {
    /// Its range of numbers within its row.
    pub share: Share,
    /// The density inside the cell, per steradian, in the map's own frame.
    pub density: f32,
}

/// A borrowed latitude-longitude map.
pub struct Map<'a> {
    pub width: u32,
    pub height: u32,
    pub texels: &'a [[f32; 4]],
}

/// Luminance of a linear Rec. 709 texel (CIE Y).
fn luminance(texel: &[f32; 4]) -> f64 {
    0.2126 * f64::from(texel[0]) + 0.7152 * f64::from(texel[1]) + 0.0722 * f64::from(texel[2])
}

/// Solid angle of the full ring between rows `top` and `bottom` (possibly fractional) of `height`: 2π times the difference
/// of the cosines, written without cancellation.
fn band_solid_angle(top: f64, bottom: f64, height: f64) -> f64 {
    let half_turn = PI / height;
    let middle_rad = 0.5 * (top + bottom) * half_turn;
    2.0 * TAU * middle_rad.sin() * (0.5 * (bottom - top) * half_turn).sin()
}

/// Mean luminance of the bilinear map over each texel's cell of a row: neighbours along an axis weigh 1/8, 3/4, 1/8.
fn cell_luminances(map: &Map, row: u32) -> Vec<f64> {
    let width = map.width as usize;
    let line = |row: u32| &map.texels[row as usize * width..][..width];
    let above = line(row.saturating_sub(1));
    let here = line(row);
    let below = line((row + 1).min(map.height - 1));
    let columns: Vec<f64> = (0..width)
        .map(|x| 0.125 * (luminance(&above[x]) + luminance(&below[x])) + 0.75 * luminance(&here[x]))
        .collect();
    (0..width)
        .map(|x| {
            let left = columns[if x == 0 { width - 1 } else { x - 1 }];
            let right = columns[if x + 1 == width { 0 } else { x + 1 }];
            0.125 * (left + right) + 0.75 * columns[x]
        })
        .collect()
}

/// A texel's weight in the integral of the bilinear map over the sphere: the integral of its hat function, which stays 1
/// from the first and last row's centres to the poles.
pub fn texel_solid_angle(row: u32, width: u32, height: u32) -> f64 {
    let step_rad = PI / f64::from(height);
    let polar_rad = (f64::from(row) + 0.5) * step_rad;
    // ∫ (1 − t / step) sin(start + t) dt over t in [0, step].
    let ramp = |start_rad: f64| start_rad.cos() - ((start_rad + step_rad).sin() - start_rad.sin()) / step_rad;
    let above = if row == 0 {
        1.0 - polar_rad.cos()
    } else {
        ramp(PI - polar_rad)
    };
    let below = if row + 1 == height {
        1.0 + polar_rad.cos()
    } else {
        ramp(polar_rad)
    };
    (above + below) * TAU / f64::from(width)
}

/// Mean radiance of the bilinear map over the sphere, and its largest luminance.
pub fn summarise(map: &Map) -> ([f32; 3], f32) {
    let width = map.width as usize;
    let of_rows = parallel::map(map.texels.len() / width, |row| {
        let texels = &map.texels[row * width..][..width];
        let solid_angle = texel_solid_angle(row as u32, map.width, map.height);
        let sum =
            [0, 1, 2].map(|channel| solid_angle * texels.iter().map(|texel| f64::from(texel[channel])).sum::<f64>());
        (sum, texels.iter().map(luminance).fold(0.0, f64::max))
    });
    let (sum, max) = of_rows.into_iter().fold(([0.0; 3], 0.0), |(a, a_max), (b, b_max)| {
        ([a[0] + b[0], a[1] + b[1], a[2] + b[2]], f64::max(a_max, b_max))
    });
    (sum.map(|sum| (sum / (2.0 * TAU)) as f32), max as f32)
}

/// The size of the grid of cells: the map's own, halved while it has more than [`MAX_CELLS`].
fn cells_size(width: u32, height: u32) -> (u32, u32) {
    let mut size = (width, height);
    while u64::from(size.0) * u64::from(size.1) > MAX_CELLS {
        size = (size.0.div_ceil(2), size.1.div_ceil(2));
    }
    size
}

/// Sampling distribution over directions: piecewise constant over cells of the map.
#[derive(Clone, Debug)]
pub struct Distribution {
    /// `width` × `height` cells, in the order of the texels.
    pub cells: Vec<Cell>,
    /// The shares of the rows.
    pub rows: Vec<Share>,
    /// Width of the grid, in cells.
    pub width: u32,
    /// Height of the grid, in cells.
    pub height: u32,
    /// Mean over the sphere of the sampled luminance.
    pub mean_luminance: f64,
}

impl Distribution {
    /// A distribution proportional to the cells' luminances above `floor`, rounded to whole numbers of 2⁻²⁴ within a row.
    /// All densities are 0 if none is above.
    pub fn new(luminances: &Luminances, floor: f64) -> Self {
        let Luminances { width, height, .. } = *luminances;
        let columns = width as usize;
        let of_rows = parallel::map(height as usize, |row| {
            let luminances = luminances.cells[row * columns..][..columns].iter();
            let above: Vec<f64> = luminances.map(|luminance| (luminance - floor).max(0.0)).collect();
            (
                shares(&above),
                above.iter().sum::<f64>() * cell_solid_angle(row, width, height),
            )
        });
        let (of_cells, weights): (Vec<Vec<Share>>, Vec<f64>) = of_rows.into_iter().unzip();
        let rows = shares(&weights);
        let of_rows = probabilities(&rows);
        let mut cells = room_in_large_pages(columns * height as usize);
        // Each row's shares are freed as its cells are made.
        for (row, shares) in of_cells.into_iter().enumerate() {
            let density = of_rows[row] / cell_solid_angle(row, width, height);
            let with_probabilities = shares.iter().zip(probabilities(&shares));
            cells.extend(with_probabilities.map(|(share, probability)| Cell {
                share: *share,
                density: (density * probability) as f32,
            }));
        }
        Self {
            cells,
            rows,
            width,
            height,
            mean_luminance: weights.iter().sum::<f64>() / (2.0 * TAU),
        }
    }

    /// A distribution proportional to the luminance above the mean, or to all of it for a nearly uniform map.
    pub fn of_excess(luminances: &Luminances) -> Self {
        let mean = luminances.mean_of(|luminance| luminance);
        let excess = luminances.mean_of(|luminance| (luminance - mean).max(0.0));
        Self::new(luminances, if excess < EXCESS_MIN * mean { 0.0 } else { mean })
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.cells[..]) + size_of_val(&self.rows[..])
    }

    /// The row that a number draws.
    pub fn row(&self, number: u32) -> u32 {
        find(self.height, number, |row| self.rows[row as usize])
    }

    /// A row, as it is drawn.
    pub fn row_at(&self, row: u32) -> Drawn {
        drawn(row, |row| self.rows[row as usize])
    }

    /// The column that a number draws in a row.
    pub fn column(&self, row: u32, number: u32) -> Drawn {
        let first = row * self.width;
        let share = |column| self.cells[(first + column) as usize].share;
        drawn(find(self.width, number, share), share)
    }
}

/// The solid angle of each cell of a row.
fn cell_solid_angle(row: usize, width: u32, height: u32) -> f64 {
    band_solid_angle(row as f64, (row + 1) as f64, f64::from(height)) / f64::from(width)
}

/// Mean luminance of the bilinear map in each cell.
pub struct Luminances {
    /// In the order of the texels.
    pub cells: Vec<f64>,
    /// Columns of cells: the map's, or halved until there are at most [`MAX_CELLS`].
    pub width: u32,
    /// Height of the grid, in cells.
    pub height: u32,
}

impl Luminances {
    pub fn of(map: &Map) -> Self {
        let (width, height) = cells_size(map.width, map.height);
        let row = |row| cell_row_luminances(map, row as u32, width, height);
        Self {
            cells: parallel::map(height as usize, row).concat(),
            width,
            height,
        }
    }

    /// Mean over the sphere of a function of the luminance.
    fn mean_of(&self, f: impl Fn(f64) -> f64) -> f64 {
        self.cells
            .chunks(self.width as usize)
            .enumerate()
            .map(|(row, cells)| {
                cells.iter().map(|luminance| f(*luminance)).sum::<f64>()
                    * cell_solid_angle(row, self.width, self.height)
            })
            .sum::<f64>()
            / (2.0 * TAU)
    }
}

/// The probability of each entry.
fn probabilities(shares: &[Share]) -> Vec<f64> {
    let mut before = 0;
    shares
        .iter()
        .map(|share| {
            let numbers = share.upper - std::mem::replace(&mut before, share.upper);
            f64::from(numbers) / f64::from(1 << DRAW_BITS)
        })
        .collect()
}

/// Mean luminances of one row of cells, by area overlap with the texels' cells.
fn cell_row_luminances(map: &Map, cell_row: u32, cells_width: u32, cells_height: u32) -> Vec<f64> {
    let mut weights = vec![0.0; cells_width as usize];
    for (row, row_share) in overlaps(cell_row, cells_height, map.height) {
        let band = band_solid_angle(f64::from(row), f64::from(row + 1), f64::from(map.height));
        let factor = row_share * band / f64::from(map.width);
        let luminances = cell_luminances(map, row);
        // As most maps are: a cell for each texel.
        if (cells_width, cells_height) == (map.width, map.height) {
            weights = luminances.iter().map(|luminance| factor * luminance).collect();
            break;
        }
        for (cell, weight) in weights.iter_mut().enumerate() {
            for (column, share) in overlaps(cell as u32, cells_width, map.width) {
                *weight += factor * share * luminances[column as usize];
            }
        }
    }
    let solid_angle = cell_solid_angle(cell_row as usize, cells_width, cells_height);
    weights.into_iter().map(|weight| weight / solid_angle).collect()
}

/// The intervals out of `fine` equal ones of [0, 1] that overlap interval `index` out of `coarse`, each with its covered
/// share.
fn overlaps(index: u32, coarse: u32, fine: u32) -> impl Iterator<Item = (u32, f64)> {
    // In units of 1 / (coarse × fine), in which all borders are integers.
    let (coarse, fine) = (u64::from(coarse), u64::from(fine));
    let (begin, end) = (u64::from(index) * fine, (u64::from(index) + 1) * fine);
    (begin / coarse..end.div_ceil(coarse)).map(move |i| {
        (
            i as u32,
            (end.min((i + 1) * coarse) - begin.max(i * coarse)) as f64 / coarse as f64,
        )
    })
}
