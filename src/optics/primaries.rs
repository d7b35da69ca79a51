//! Conversion of colour spaces to the working space: linear Rec. 709 with a white of D65.

/// The places of a colour space's primaries and of its white on the CIE diagram (x, y).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chromaticities {
    /// Red, green, blue.
    pub primaries: [[f64; 2]; 3],
    /// Chromaticity of white: equal parts of the primaries.
    pub white: [f64; 2],
}

/// Rec. 709, and sRGB.
pub const REC709: Chromaticities = Chromaticities {
    primaries: [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06]],
    white: [0.3127, 0.3290],
};

/// Rows of a matrix.
pub type Matrix = [[f64; 3]; 3];

/// Responses of the eye's cones from XYZ. Source: Lam, "Metamerism and Colour Constancy" (1985), known as Bradford's.
const CONES_FROM_XYZ: Matrix = [
    [0.8951, 0.2664, -0.1614],
    [-0.7502, 1.7135, 0.0367],
    [0.0389, -0.0685, 1.0296],
];

/// Chromaticities whose primaries span no space of colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoSpace;

impl Chromaticities {
    /// Matrix to linear Rec. 709 from linear colours of this space; `None` if it is Rec. 709 to four digits. White maps to
    /// white; but XYZ has no white of its own and is taken as it is.
    ///
    /// # Errors
    ///
    /// If its primaries span no space.
    pub fn rec709_from(&self) -> Result<Option<Matrix>, NoSpace> {
        if self.is_near(&REC709.primaries) && is_near(self.white, REC709.white) {
            return Ok(None);
        }
        let rec709_from_xyz = inverse(&REC709.xyz_from_rgb()?)?;
        if self.is_near(&XYZ) {
            return Ok(Some(rec709_from_xyz));
        }
        let [from, to] = [self.white, REC709.white].map(white_xyz);
        let adapted = adaptation(&CONES_FROM_XYZ, from, to)?;
        let matrix = product(&rec709_from_xyz, &product(&adapted, &self.xyz_from_rgb()?));
        let is_finite = matrix.iter().flatten().all(|x| x.is_finite());
        is_finite.then_some(Some(matrix)).ok_or(NoSpace)
    }

    /// Luminance of each primary, with white at 1.
    ///
    /// # Errors
    ///
    /// If its primaries span no space, or green is dark.
    pub fn luminances(&self) -> Result<[f64; 3], NoSpace> {
        let [_, luminances, _] = self.xyz_from_rgb()?;
        (luminances[1] > 0.001).then_some(luminances).ok_or(NoSpace)
    }

    /// Whether its primaries are these to four digits.
    fn is_near(&self, primaries: &[[f64; 2]; 3]) -> bool {
        std::iter::zip(self.primaries, primaries).all(|(own, other)| is_near(own, *other))
    }

    /// Matrix to CIE XYZ from linear colours of this space.
    ///
    /// # Errors
    ///
    /// If its primaries span no space.
    pub fn xyz_from_rgb(&self) -> Result<Matrix, NoSpace> {
        // Not divided by y, which is 0 for two primaries of XYZ.
        let columns = self.primaries.map(|[x, y]| [x, y, 1.0 - x - y]);
        let unscaled: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]));
        let strengths = transformed(&inverse(&unscaled)?, white_xyz(self.white));
        finite(unscaled.map(|row| std::array::from_fn(|j| row[j] * strengths[j])))
    }
}

/// The primaries of CIE XYZ itself.
const XYZ: [[f64; 2]; 3] = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];

fn is_near(a: [f64; 2], b: [f64; 2]) -> bool {
    std::iter::zip(a, b).all(|(a, b)| (a - b).abs() < 0.0001)
}

/// The white of luminance 1 at a place of the diagram.
fn white_xyz([x, y]: [f64; 2]) -> [f64; 3] {
    [x / y, 1.0, (1.0 - x - y) / y]
}

/// A matrix times a colour.
pub fn transformed(matrix: &Matrix, color: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| (0..3).map(|i| row[i] * color[i]).sum())
}

/// Bradford's chromatic adaptation in linear Rec. 709 from one white to another; the identity if a colour is too dark to be
/// white.
pub fn rec709_adapted(from: [f64; 3], to: [f64; 3]) -> Matrix {
    let matrix = REC709
        .xyz_from_rgb()
        .and_then(|xyz_from_rgb| adaptation(&product(&CONES_FROM_XYZ, &xyz_from_rgb), from, to));
    matrix.unwrap_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
}

/// Scaling of the cones' responses from the white `from` to the white `to`, both and the result in the space of
/// `cones_from`.
fn adaptation(cones_from: &Matrix, from: [f64; 3], to: [f64; 3]) -> Result<Matrix, NoSpace> {
    let [from, to] = [from, to].map(|white| transformed(cones_from, white));
    let gain: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { to[i] / from[i] } else { 0.0 }));
    finite(product(&inverse(cones_from)?, &product(&gain, cones_from)))
}

fn finite(matrix: Matrix) -> Result<Matrix, NoSpace> {
    let is_finite = matrix.iter().flatten().all(|x| x.is_finite());
    is_finite.then_some(matrix).ok_or(NoSpace)
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| std::array::from_fn(|j| (0..3).map(|k| row[k] * b[k][j]).sum()))
}

fn inverse(matrix: &Matrix) -> Result<Matrix, NoSpace> {
    let inverse = glam::DMat3::from_cols_array_2d(matrix).inverse();
    let inverse = inverse.is_finite().then(|| inverse.to_cols_array_2d());
    // Columns in, columns out: a transposed matrix has the transposed inverse.
    let inverse = inverse.filter(|inverse| inverse.iter().flatten().all(|x| x.abs() < 1e6));
    inverse.ok_or(NoSpace)
}
