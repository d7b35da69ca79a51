//! The whole reflectance of a material as the MERL BRDF database tabulates it (`analysis::fit::merl` has the format).

use std::path::Path;

use super::{
    ExchangeError, Subject, Written,
    report::{Entry, MaterialReport, Residual},
};
use crate::{
    analysis::fit::merl::{CELLS, FILE_LENGTH, SCALES},
    compile::compile,
    document::MaterialSettings,
    optics::{
        layer::{material_evaluate, material_is_mirror, material_layers},
        material::{Material, Surface},
        vector::{Vec3, vec3},
    },
    parallel,
};

/// Least cosine that reflectances are asked at: at 0 there is none.
const COSINE_MIN: f64 = 0.001;

pub fn write(subject: &Subject, path: &Path) -> Result<Written, ExchangeError> {
    let material = subject.only(path)?;
    let reflectance = Reflectance::of(material).map_err(|reason| ExchangeError::Unsuitable {
        path: path.to_owned(),
        reason,
    })?;
    let cells = parallel::map(CELLS.iter().product(), |cell| reflectance.both_ways(cell));
    let mut bytes = Vec::with_capacity(FILE_LENGTH);
    bytes.extend(CELLS.iter().flat_map(|count| (*count as i32).to_le_bytes()));
    for (channel, scale) in SCALES.into_iter().enumerate() {
        for [there, back] in &cells {
            let mean = 0.5 * (there.to_f64()[channel] + back.to_f64()[channel]);
            bytes.extend((mean / scale).to_le_bytes());
        }
    }
    Ok(Written {
        bytes,
        beside: Vec::new(),
        materials: vec![report(material, &cells)],
    })
}

fn report(material: &MaterialSettings, cells: &[[Vec3<f64>; 2]]) -> MaterialReport {
    let mut entries = vec![Entry::exact("reflectance at the middles of the table's cells")];
    let (mut apart, mut sum) = (0.0, 0.0);
    for [there, back] in cells {
        apart += (there.luminance() - back.luminance()).abs();
        sum += there.luminance() + back.luminance();
    }
    let asymmetry = apart / f64::max(sum, f64::MIN_POSITIVE);
    if asymmetry > 1e-6 {
        let detail = "the table has one number for light and view exchanged: their mean";
        let residual = Residual {
            residual: asymmetry,
            measure: "mean difference from it, of all cells",
        };
        entries.insert(0, Entry::approximated("both ways of the light", detail, Some(residual)));
    }
    if material.emission_strength > 0.0 || material.opacity < 1.0 {
        entries.insert(0, Entry::dropped("emission and opacity", "the table is of reflectance"));
    }
    MaterialReport {
        carries_exact_parameters: false,
        ..MaterialReport::of(material, entries)
    }
}

/// A material's reflectance by directions.
struct Reflectance {
    material: Material<f64>,
    tables: Vec<f32>,
}

impl Reflectance {
    fn of(settings: &MaterialSettings) -> Result<Self, String> {
        if settings.anisotropy != 0.0 && settings.lobe.is_anisotropic() {
            return Err("the table is of round highlights; set the anisotropy to 0".to_owned());
        }
        if settings.transmission_weight > 0.0 && settings.metalness < 1.0 {
            return Err("the table is of what is reflected; this material lets light through".to_owned());
        }
        let (materials, tables) = compile(std::slice::from_ref(settings));
        let material: Material<f64> = materials[0].cast();
        let is_sharp = settings.reflects() && !crate::matching::lobe_of_material(settings).has_density();
        if material_is_mirror(&material) || is_sharp {
            return Err("a mirror's reflection fits in no table; give it some roughness".to_owned());
        }
        Ok(Self { material, tables })
    }

    /// The reflectance in 1/sr for the directions of a cell, and for light and view exchanged.
    fn both_ways(&self, cell: usize) -> [Vec3<f64>; 2] {
        let [wo, wi] = directions(cell);
        [self.at(wo, wi), self.at(wi, wo)]
    }

    fn at(&self, wo: Vec3<f64>, wi: Vec3<f64>) -> Vec3<f64> {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Vec3::ZERO;
        }
        let (material, tables, surface) = (&self.material, &self.tables, Surface::upwards(wo));
        let layers = material_layers(material, tables, &surface);
        material_evaluate(material, tables, &surface, &layers, wi, 1.0, 0.0) / wi.z.max(COSINE_MIN)
    }
}

/// Light and view in the middle of a cell: the difference direction about z, tilted so that z becomes the half vector.
fn directions(cell: usize) -> [Vec3<f64>; 2] {
    let place = |index: usize, count: usize| (index as f64 + 0.5) / count as f64;
    let quarter = std::f64::consts::FRAC_PI_2;
    let phi_d_rad = place(cell % CELLS[2], CELLS[2]) * std::f64::consts::PI;
    let theta_d_rad = place(cell / CELLS[2] % CELLS[1], CELLS[1]) * quarter;
    let theta_h_rad = place(cell / (CELLS[2] * CELLS[1]), CELLS[0]).powi(2) * quarter;
    let difference = vec3(
        theta_d_rad.sin() * phi_d_rad.cos(),
        theta_d_rad.sin() * phi_d_rad.sin(),
        theta_d_rad.cos(),
    );
    let (sin, cos) = theta_h_rad.sin_cos();
    let tilted = |v: Vec3<f64>| vec3(v.x * cos + v.z * sin, v.y, v.z * cos - v.x * sin);
    let wi = tilted(difference);
    let wo = tilted(vec3(-difference.x, -difference.y, difference.z));
    [wo, wi]
}
