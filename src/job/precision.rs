//! Where the numbers behind a picture are not to be trusted: f32 against f64, samples dropped, rays that start astray.

use crate::optics::vector::Vec3;

/// Largest error of f32 against f64, relative as in [`relative_error`], that counts as none.
pub const ERROR_BOUND: f64 = 1e-3;
/// Values below this part of a white Lambertian's count as if they were that large.
const SMALL: f64 = 1e-3 / std::f64::consts::PI;
/// A singularity is where one rounding of the direction changes the value, in f64, by more than this part.
const SINGULAR: f64 = 2e-5;

/// The largest error of a colour channel, relative to the right value or to 1e-3 of white; infinite where the answer is not
/// a number, nothing at a singularity. `oracle` gives the right value with the direction moved by so many roundings of f32
/// along two tangents.
pub fn relative_error(answer: Vec3<f32>, oracle: impl Fn([f64; 2]) -> Vec3<f64>) -> Option<f64> {
    let right = oracle([0.0; 2]);
    let size = right.max_component().max(SMALL);
    let off = |other: Vec3<f64>| (other - right).map(f64::abs).max_component() / size;
    let moves = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    let is_regular = moves.into_iter().all(|moved| off(oracle(moved)) < SINGULAR);
    let error = off(Vec3::from_f64(answer.to_f64()));
    is_regular.then_some(if error.is_nan() { f64::INFINITY } else { error })
}

/// What was found at a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Finding {
    /// Cosine between the view and the surface met, in [0, 1]; 0 where nothing is met.
    pub cosine: f32,
    /// Samples that were not finite or negative.
    pub dropped: u32,
    /// The largest error of the material's value in f32.
    pub error: f64,
    /// Whether a ray from the surface starts on the wrong side of it, or of another one.
    pub starts_astray: bool,
}

/// What a pixel of the map tells, the gravest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Samples were dropped.
    Dropped,
    /// f32 and f64 differ by more than the bound.
    Differs,
    /// Rays start on the wrong side of a surface.
    Astray,
}

impl Fault {
    /// All of them, with what they are called and explained as.
    pub const ALL: [(Self, &str, &str); 3] = [
        (
            Self::Dropped,
            "dropped",
            "Pixels where a sample was not finite or negative, and left out.",
        ),
        (
            Self::Differs,
            "f32 off f64",
            "Pixels where the material's value in f32 is off that in f64 by more than 0.1 %.",
        ),
        (
            Self::Astray,
            "start inside",
            "Pixels where a ray that leaves the surface would start within other geometry, or on the wrong side.",
        ),
    ];

    /// Its colour: red, green, blue of 8 bits, told apart by the colour-blind, too.
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

/// What was found at all pixels; row by row from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PrecisionMap {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Errors above this count.
    pub bound: f64,
    /// One a pixel.
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

    /// Red, green, blue and alpha of 8 bits: the gravest fault's colour, else a dim grey by which the scene is recognised,
    /// black where there is nothing.
    pub fn colors(&self) -> Vec<u8> {
        let color = |finding: &Finding| {
            let fault = Fault::ALL.iter().find(|(fault, ..)| self.has(finding, *fault));
            let [red, green, blue] = fault.map_or([(FACING * finding.cosine) as u8; 3], |(fault, ..)| fault.color());
            [red, green, blue, 255]
        };
        self.findings.iter().flat_map(color).collect()
    }
}
