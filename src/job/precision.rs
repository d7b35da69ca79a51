//! Map of numerical trouble in a render: f32 against f64, dropped samples, rays that start on the wrong side.

use crate::{named::named, optics::vector::Vec3};

/// Largest error of f32 against f64, relative as in [`relative_error`], that counts as none.
pub const ERROR_BOUND: f64 = 0.001;
/// Values below this part of a white Lambertian's count as if they were that large.
const SMALL: f64 = 0.001 / std::f64::consts::PI;
/// Relative change of the value, in f64, by one rounding of the direction from which a point counts as singular.
const SINGULAR: f64 = 2e-5;

/// Largest error of a colour channel, relative to the right value or to 1e-3 of white; infinite for NaN, 0 at a singularity.
/// `oracle` returns the right value with the direction moved by some roundings of f32 along two tangents.
pub fn relative_error(answer: Vec3<f32>, oracle: impl Fn([f64; 2]) -> Vec3<f64>) -> Option<f64> {
    let right = oracle([0.0; 2]);
    let size = right.max_component().max(SMALL);
    let off = |other: Vec3<f64>| (other - right).map(f64::abs).max_component() / size;
    let moves = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    let is_regular = moves.into_iter().all(|moved| off(oracle(moved)) < SINGULAR);
    let error = off(Vec3::from_f64(answer.to_f64()));
    is_regular.then_some(if error.is_nan() { f64::INFINITY } else { error })
}

/// Finding at a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Finding {
    /// Cosine between the view and the hit surface, in [0, 1]; 0 without a hit.
    pub cosine: f32,
    /// Samples that were not finite or negative.
    pub dropped: u32,
    /// The largest error of the material's value in f32.
    pub error: f64,
    /// Whether a ray from the surface starts on the wrong side of it, or of another one.
    pub starts_astray: bool,
}

named! {
    /// Kinds of trouble, the gravest first.
    Fault {
        Dropped, "dropped", "dropped", "Pixels where a sample was not finite or negative, and left out.";
        Differs, "differs", "f32 off f64", "Pixels where the material's value in f32 is off that in f64 by more than 0.1 %.";
        Astray, "astray", "start inside", "Pixels where a ray that leaves the surface would start within other geometry, or on the wrong side.";
    }
}

impl Fault {
    /// Its colour, 8-bit RGB, from a palette safe for colour-blind viewers.
    pub fn color(self) -> [u8; 3] {
        match self {
            Self::Dropped => [230, 40, 150],
            Self::Differs => [255, 176, 0],
            Self::Astray => [60, 170, 255],
        }
    }
}

/// Brightness of a surface without a fault, seen along its normal.
const FACING: f32 = 56.0;

/// Findings of all pixels, rows from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PrecisionMap {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Errors above this count.
    pub bound: f64,
    /// Findings, one per pixel.
    pub findings: Vec<Finding>,
}

impl PrecisionMap {
    fn has(&self, finding: &Finding, fault: Fault) -> bool {
        match fault {
            Fault::Dropped => finding.dropped > 0,
            Fault::Differs => finding.error > self.bound,
            Fault::Astray => finding.starts_astray,
        }
    }

    /// Pixels with this fault.
    pub fn count(&self, fault: Fault) -> usize {
        self.findings.iter().filter(|finding| self.has(finding, fault)).count()
    }

    /// RGBA, 8 bits each: the gravest finding's colour, else dim grey to recognise the scene, black without a hit.
    pub fn colors(&self) -> Vec<u8> {
        let color = |finding: &Finding| {
            let fault = Fault::ALL.iter().find(|fault| self.has(finding, **fault));
            let [red, green, blue] = fault.map_or([(FACING * finding.cosine) as u8; 3], |fault| fault.color());
            [red, green, blue, 255]
        };
        self.findings.iter().flat_map(color).collect()
    }
}
