//! The specular lobe as a table: values and densities over directions.

use std::{fmt::Write as _, path::Path};

use super::{ExchangeError, Subject, Written, carried, report::Entry, report::MaterialReport};
use crate::{matching::lobe_of_material, optics::vector::vec3};

/// Steps between the directions, degrees: of the view, of the light's angle to the normal and of its azimuth.
const STEPS_DEG: [usize; 3] = [15, 3, 10];

pub fn write(subject: &Subject, path: &Path) -> Result<Written, ExchangeError> {
    let material = subject.only(path)?;
    let model = lobe_of_material(material);
    if !model.has_density() {
        return Err(ExchangeError::Unsuitable {
            path: path.to_owned(),
            reason: "a mirror has no density; give it some roughness".to_owned(),
        });
    }
    let mut text = format!(
        "# {}\n# The specular lobe alone, without Fresnel's factor and colours; value has the cosine in it, both are per \
             steradian.\nview_deg,light_deg,light_azimuth_deg,value,density\n",
        carried::comment(material)
    );
    for view_deg in (0..90).step_by(STEPS_DEG[0]) {
        let wo = direction(view_deg, 180);
        for light_deg in (0..90).step_by(STEPS_DEG[1]) {
            for azimuth_deg in (0..360).step_by(STEPS_DEG[2]) {
                let [value, density] = model.evaluate(wo, direction(light_deg, azimuth_deg));
                let _ = writeln!(text, "{view_deg},{light_deg},{azimuth_deg},{value:.7e},{density:.7e}");
            }
        }
    }
    let entries = vec![
        Entry::all_but_the_lobe("the table is of the specular lobe alone"),
        Entry::exact("the lobe's values at the table's directions"),
    ];
    Ok(Written::text(text, vec![MaterialReport::of(material, entries)]))
}

/// A direction by its angle to the normal and its azimuth from the tangent, degrees.
fn direction(angle_deg: usize, azimuth_deg: usize) -> crate::optics::vector::Vec3<f64> {
    let (sin, cos) = (angle_deg as f64).to_radians().sin_cos();
    let (sin_azimuth, cos_azimuth) = (azimuth_deg as f64).to_radians().sin_cos();
    vec3(sin * cos_azimuth, sin * sin_azimuth, cos)
}
