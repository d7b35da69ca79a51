//! Pairs of directions, from a file or as a grid.

use std::{fmt::Display, path::Path};

use anyhow::{Context, bail};

use crate::optics::vector::Vec3;

/// The columns that a file must have: angles in degrees, to the viewer and to the light.
const COLUMNS: [&str; 4] = ["theta_o", "phi_o", "theta_i", "phi_i"];
/// The columns that are added.
const ADDED: [&str; 4] = ["r", "g", "b", "density"];

/// Pairs of directions with the rows that hold them.
pub struct Pairs {
    /// Names of the columns, with commas between them.
    pub header: String,
    /// Cells of each pair, with commas between them.
    pub rows: Vec<String>,
    /// (theta, phi) to the viewer and to the light, in degrees.
    pub angles_deg: Vec<[[f64; 2]; 2]>,
}

impl Pairs {
    /// Reads a table; lines that begin with # are comments.
    ///
    /// # Errors
    /// Names the file, the line and what is wrong with it.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let name = path.display();
        let text = std::fs::read_to_string(path);
        Self::parse(
            &name,
            &text.with_context(|| format!("{name}: the table cannot be read as text"))?,
        )
    }

    fn parse(name: &dyn Display, text: &str) -> anyhow::Result<Self> {
        let lines = (1..).zip(text.lines().map(str::trim));
        let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let (_, header) = lines.next().with_context(|| format!("{name}: the table is empty"))?;
        let columns: Vec<&str> = header.split(',').map(str::trim).collect();
        if let Some(taken) = columns.iter().find(|column| ADDED.contains(column)) {
            bail!("{name}: it has a column {taken} already, which would be added; rename it");
        }
        let mut places = [0; 4];
        for (place, wanted) in places.iter_mut().zip(COLUMNS) {
            let found = columns.iter().position(|column| *column == wanted);
            *place = found.with_context(|| {
                format!(
                    "{name}: there is no column {wanted}; the first line must name {}",
                    COLUMNS.join(",")
                )
            })?;
        }
        let mut pairs = Self {
            header: header.to_owned(),
            rows: Vec::new(),
            angles_deg: Vec::new(),
        };
        for (number, line) in lines {
            let cells: Vec<&str> = line.split(',').collect();
            if cells.len() != columns.len() {
                bail!(
                    "{name}, line {number}: {} cells, but there are {} columns",
                    cells.len(),
                    columns.len()
                );
            }
            let mut angles = [0.0; 4];
            for (angle, place) in angles.iter_mut().zip(places) {
                let number_there = cells[place].trim().parse().ok().filter(|x: &f64| x.is_finite());
                *angle = number_there
                    .with_context(|| format!("{name}, line {number}: {} is no angle in degrees", cells[place]))?;
            }
            let [theta_o, phi_o, theta_i, phi_i] = angles;
            pairs.rows.push(line.to_owned());
            pairs.angles_deg.push([[theta_o, phi_o], [theta_i, phi_i]]);
        }
        if pairs.rows.is_empty() {
            bail!("{name}: there are no directions below the names of the columns");
        }
        Ok(pairs)
    }

    /// `steps` views in the plane of the tangent, each with a grid of lights over the hemisphere, or over the sphere.
    pub fn grid(steps: u32, on_both_sides: bool) -> anyhow::Result<Self> {
        let step_deg = 90.0 / f64::from(steps);
        let theta_deg = |index: u32| step_deg * (f64::from(index) + 0.5);
        let heights = if on_both_sides { 2 * steps } else { steps };
        let mut text = COLUMNS.join(",");
        for view in 0..steps {
            for height in 0..heights {
                for turn in 0..2 * steps {
                    let phi_deg = 2.0 * step_deg * f64::from(turn);
                    text += &format!("\n{},0,{},{phi_deg}", theta_deg(view), theta_deg(height));
                }
            }
        }
        Self::parse(&"the grid", &text)
    }
}

/// The unit direction of angles in degrees; `up` is the z of the normal from which theta counts.
pub fn unit_direction([theta_deg, phi_deg]: [f64; 2], up: f64) -> Vec3<f32> {
    let (sine, cosine) = theta_deg.to_radians().sin_cos();
    let (across, along) = phi_deg.to_radians().sin_cos();
    Vec3::from_f64([sine * along, sine * across, up * cosine])
}
