//! Measured reflectance from the MERL BRDF database (Matusik et al. 2003): `.binary` files.
//!
//! Three little-endian 32-bit integers, 90, 90 and 180, then for red, green and blue as many doubles: the reflectance
//! over (θ_h, θ_d, φ_d), the half vector's angle to the normal, the difference vector's to the half vector and its
//! azimuth, φ_d running fastest. θ_h's cells are even in its square root. The numbers are divided by 1500, 1500/1.15 and
//! 1500/1.66. Negative numbers stand for what could not be measured.

use std::path::{Path, PathBuf};

use crate::optics::vector::{Vec3, vec3};

/// Cells of θ_h, θ_d and φ_d (over half a turn: the other half is equal by reciprocity).
pub const CELLS: [usize; 3] = [90, 90, 180];
/// Factors of the channels.
pub const SCALES: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
/// Bytes before the numbers.
const HEADER_LENGTH: usize = 12;
/// Numbers of a channel.
const COUNT: usize = CELLS[0] * CELLS[1] * CELLS[2];
/// Bytes of a file.
pub const FILE_LENGTH: usize = HEADER_LENGTH + 3 * 8 * COUNT;

/// A measured material.
#[derive(Clone, Debug, PartialEq)]
pub struct Merl {
    /// Reflectance of the cells in 1/sr, red, green, blue; not negative.
    cells: Vec<[f32; 3]>,
}

/// Why a file is no MERL measurement.
#[derive(Debug, thiserror::Error)]
pub enum MerlError {
    /// The system does not give it.
    #[error("{path}: cannot be read: {source}; check the path and its permissions")]
    Read { path: PathBuf, source: std::io::Error },
    /// Not the three numbers that such a file begins with.
    #[error(
        "{path}: not a MERL measurement: it does not begin with 90, 90, 180; choose a .binary file of the MERL BRDF database"
    )]
    Header { path: PathBuf },
    /// Cut short, or too long.
    #[error(
        "{path}: {length} bytes instead of {FILE_LENGTH}: cut short or not a MERL measurement; fetch the file again"
    )]
    Length { path: PathBuf, length: u64 },
    #[error("{path}: reflects nothing: every number is 0, negative or not finite; choose another file")]
    Empty { path: PathBuf },
}

impl Merl {
    /// Reads a file.
    pub fn load(path: &Path) -> Result<Self, MerlError> {
        let read = |source| MerlError::Read {
            path: path.to_owned(),
            source,
        };
        let length = std::fs::metadata(path).map_err(read)?.len();
        // Before the whole file is read: it may be anything.
        if length > FILE_LENGTH as u64 {
            return Err(MerlError::Length {
                path: path.to_owned(),
                length,
            });
        }
        Self::parse(path, &std::fs::read(path).map_err(read)?)
    }

    /// From a file's contents. `path` is only named in messages.
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, MerlError> {
        let header: Vec<u8> = CELLS.iter().flat_map(|count| (*count as i32).to_le_bytes()).collect();
        if !bytes.starts_with(&header) {
            return Err(MerlError::Header { path: path.to_owned() });
        }
        if bytes.len() != FILE_LENGTH {
            return Err(MerlError::Length {
                path: path.to_owned(),
                length: bytes.len() as u64,
            });
        }
        let number = |i: usize| {
            let at = HEADER_LENGTH + 8 * i;
            let mut eight = [0; 8];
            eight.copy_from_slice(&bytes[at..at + 8]);
            f64::from_le_bytes(eight)
        };
        let value = |cell: usize, channel: usize| {
            let value = (number(channel * COUNT + cell) * SCALES[channel]) as f32;
            if value.is_finite() { value.max(0.0) } else { 0.0 }
        };
        let cells: Vec<[f32; 3]> = (0..COUNT)
            .map(|cell| [0, 1, 2].map(|channel| value(cell, channel)))
            .collect();
        if cells.iter().all(|cell| *cell == [0.0; 3]) {
            return Err(MerlError::Empty { path: path.to_owned() });
        }
        Ok(Self { cells })
    }

    /// The reflectance in 1/sr, linear RGB, without the cosine; linear between the cells' middles. Unit directions above
    /// the surface, normal +z.
    pub fn reflectance(&self, wo: Vec3<f64>, wi: Vec3<f64>) -> Vec3<f64> {
        let [theta_h_rad, theta_d_rad, phi_d_rad] = half_difference(wo, wi);
        let quarter = std::f64::consts::FRAC_PI_2;
        let places = [
            (theta_h_rad / quarter).max(0.0).sqrt() * CELLS[0] as f64,
            theta_d_rad / quarter * CELLS[1] as f64,
            phi_d_rad / std::f64::consts::PI * CELLS[2] as f64,
        ];
        let mut sum = Vec3::ZERO;
        for corner in 0..8 {
            let mut weight = 1.0;
            let mut cell = 0;
            for axis in 0..3 {
                let place = places[axis] - 0.5;
                let upper = (corner >> axis) & 1;
                let share = place - place.floor();
                weight *= if upper == 1 { share } else { 1.0 - share };
                let index = place.floor() as i64 + upper;
                let count = CELLS[axis] as i64;
                let index = if axis == 2 {
                    index.rem_euclid(count)
                } else {
                    index.clamp(0, count - 1)
                };
                cell = cell * CELLS[axis] + index as usize;
            }
            sum += Vec3::from_f32(self.cells[cell]) * weight;
        }
        sum
    }
}

/// (θ_h, θ_d, φ_d) of a pair of directions, radians; φ_d in [0, π) (Rusinkiewicz 1998).
fn half_difference(wo: Vec3<f64>, wi: Vec3<f64>) -> [f64; 3] {
    let half = (wo + wi).normalize();
    let across = half.x.hypot(half.y);
    let theta_h_rad = across.atan2(half.z);
    // The half vector turned onto the normal: first about z into the plane y = 0, then about y.
    let (cos_phi, sin_phi) = if across > 0.0 {
        (half.x / across, half.y / across)
    } else {
        (1.0, 0.0)
    };
    let flat = vec3(wi.x * cos_phi + wi.y * sin_phi, wi.y * cos_phi - wi.x * sin_phi, wi.z);
    let difference = vec3(
        flat.x * half.z - flat.z * across,
        flat.y,
        flat.x * across + flat.z * half.z,
    );
    let theta_d_rad = difference.x.hypot(difference.y).atan2(difference.z);
    let phi_d_rad = difference.y.atan2(difference.x).rem_euclid(std::f64::consts::PI);
    [theta_h_rad, theta_d_rad, phi_d_rad]
}
