//! The units that MaterialX names.

use crate::import::FileParameter;

/// Of a length in metres, of an angle in degrees.
const UNITS: &[(&str, f64)] = &[
    ("nanometer", 1e-9),
    ("micron", 1e-6),
    ("micrometer", 1e-6),
    ("millimeter", 1e-3),
    ("centimeter", 1e-2),
    ("inch", 0.0254),
    ("foot", 0.3048),
    ("yard", 0.9144),
    ("meter", 1.0),
    ("kilometer", 1e3),
    ("mile", 1609.344),
    ("degree", 1.0),
    ("radian", 180.0 / std::f64::consts::PI),
];

/// What a value in a unit is multiplied by, to be in that of an input.
pub fn factor(unit: &str, row: &FileParameter) -> Option<f32> {
    let (_, of_unit) = UNITS.iter().find(|(name, _)| *name == unit)?;
    // Films are in µm, other lengths in metres.
    let own = match row.keys()[0] {
        "thin_film.thickness" => 1e-6,
        _ => 1.0,
    };
    Some((of_unit / own * f64::from(row.per)) as f32)
}
