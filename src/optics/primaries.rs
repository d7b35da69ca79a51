//! Colours by other primaries brought to those that all light here is counted in: linear Rec. 709 with a white of D65.

/// The places of a colour space's primaries and of its white on the CIE diagram (x, y).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chromaticities {
    /// Red, green, blue.
    pub primaries: [[f64; 2]; 3],
    /// What equal parts of them are.
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

impl Chromaticities {
    /// Linear Rec. 709 from linear colours of this space, its white being white there; `None` where its primaries span no
    /// space, or where it is Rec. 709 to four digits.
    pub fn rec709_from(&self) -> Option<Matrix> {
        let numbers = |space: &Self| {
            space
                .primaries
                .into_iter()
                .chain([space.white])
                .flatten()
                .collect::<Vec<_>>()
        };
        let is_same = std::iter::zip(numbers(self), numbers(&REC709)).all(|(a, b)| (a - b).abs() < 1e-4);
        if is_same {
            return None;
        }
        let cones_from_xyz = CONES_FROM_XYZ;
        let [from, to] = [self.white, REC709.white].map(|white| transformed(&cones_from_xyz, xyz(white)));
        let gain: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { to[i] / from[i] } else { 0.0 }));
        let adapted = product(&inverse(&cones_from_xyz)?, &product(&gain, &cones_from_xyz));
        let matrix = product(
            &inverse(&REC709.xyz_from_rgb()?)?,
            &product(&adapted, &self.xyz_from_rgb()?),
        );
        matrix.iter().flatten().all(|x| x.is_finite()).then_some(matrix)
    }

    fn xyz_from_rgb(&self) -> Option<Matrix> {
        let columns = self.primaries.map(xyz);
        let unscaled: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]));
        let strengths = transformed(&inverse(&unscaled)?, xyz(self.white));
        Some(unscaled.map(|row| std::array::from_fn(|j| row[j] * strengths[j])))
    }
}

/// The colour of luminance 1 at a place of the diagram.
fn xyz([x, y]: [f64; 2]) -> [f64; 3] {
    [x / y, 1.0, (1.0 - x - y) / y]
}

/// A matrix times a colour.
pub fn transformed(matrix: &Matrix, color: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| (0..3).map(|i| row[i] * color[i]).sum())
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| std::array::from_fn(|j| (0..3).map(|k| row[k] * b[k][j]).sum()))
}

fn inverse(matrix: &Matrix) -> Option<Matrix> {
    let inverse = glam::DMat3::from_cols_array_2d(matrix).inverse();
    let inverse = inverse.is_finite().then(|| inverse.to_cols_array_2d());
    // Columns in, columns out: a transposed matrix has the transposed inverse.
    inverse.filter(|inverse| inverse.iter().flatten().all(|x| x.abs() < 1e6))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rec. 2020 and ACEScg to Rec. 709 as ITU-R BT.2087 and the Academy (with Bradford's adaptation) give them.
    #[test]
    fn known_spaces_have_their_known_matrices() {
        let rec2020 = Chromaticities {
            primaries: [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]],
            white: REC709.white,
        };
        let acescg = Chromaticities {
            primaries: [[0.713, 0.293], [0.165, 0.830], [0.128, 0.044]],
            white: [0.32168, 0.33767],
        };
        for (space, expected) in [
            (
                rec2020,
                [
                    [1.6605, -0.5876, -0.0728],
                    [-0.1246, 1.1329, -0.0083],
                    [-0.0182, -0.1006, 1.1187],
                ],
            ),
            (
                acescg,
                [
                    [1.7051, -0.6218, -0.0833],
                    [-0.1303, 1.1408, -0.0105],
                    [-0.0240, -0.1290, 1.1530],
                ],
            ),
        ] {
            let found = space.rec709_from().expect("a matrix");
            for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                assert!((found - expected).abs() < 4e-4, "{found} in place of {expected}");
            }
            let white = transformed(&found, [1.0; 3]);
            assert!(white.iter().all(|x| (x - 1.0).abs() < 1e-9), "{white:?}");
        }
        assert_eq!(REC709.rec709_from(), None);
        let line = Chromaticities {
            primaries: [[0.3, 0.3], [0.4, 0.4], [0.5, 0.5]],
            ..REC709
        };
        assert_eq!(line.rec709_from(), None);
    }
}
