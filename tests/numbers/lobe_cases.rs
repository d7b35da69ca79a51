//! The grid of lobes, roughnesses and view angles that the statistical tests loop over.

use glossmith::optics::{
    curve::{CUSTOM_INTERVALS, Curve, Integral, custom_table},
    frame::{Frame, frame_from_normal},
    lobe::{Horizon, Lobe, LobeShape, lobe_middle},
    vector::{Vec3, vec3},
};

/// Mirror-like, glossy, rough, nearly Lambertian, Lambertian.
pub const ROUGHNESS: &[f64] = if cfg!(feature = "thorough") {
    &[0.02, 0.1, 0.3, 0.6, 0.9, 0.999, 1.0]
} else {
    &[0.02, 0.3, 0.9, 1.0]
};
/// From above to grazing.
pub const ANGLES_DEG: &[f64] = if cfg!(feature = "thorough") {
    &[0.0, 30.0, 60.0, 80.0, 89.0]
} else {
    &[0.0, 60.0, 89.0]
};

/// A lobe, seen from somewhere.
#[derive(Clone)]
pub struct Case {
    pub lobe: Lobe,
    pub curve: Curve,
    pub horizon: Horizon,
    pub roughness: f64,
    pub anisotropy: f64,
    /// 0 where the lobe reflects, else the index of refraction behind the surface over that before it.
    pub eta: f64,
    pub angle_deg: f64,
    /// Angle of the geometric normal to the shading normal, towards the viewer where positive.
    pub lean_deg: f64,
    /// Different for each case of a grid.
    pub seed: u32,
    pub table: &'static [f32],
}

impl std::fmt::Debug for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (lobe, curve, horizon) = (self.lobe.name(), self.curve.name(), self.horizon.name());
        let Self {
            roughness,
            anisotropy,
            eta,
            angle_deg,
            lean_deg,
            ..
        } = self;
        write!(
            f,
            "{lobe}/{curve} {horizon} roughness {roughness}/{anisotropy} eta {eta} view {angle_deg}° leaning {lean_deg}°"
        )
    }
}

impl Case {
    pub fn new(lobe: Lobe, curve: Curve, horizon: Horizon, roughness: f64, angle_deg: f64) -> Self {
        let table = if curve == Curve::Custom { custom() } else { &[] };
        Self {
            lobe,
            curve,
            horizon,
            roughness,
            anisotropy: 0.0,
            eta: 0.0,
            angle_deg,
            lean_deg: 0.0,
            seed: 0,
            table,
        }
    }

    /// Every combination of the last three.
    pub fn grid(
        lobe: Lobe,
        curve: Curve,
        horizon: Horizon,
        anisotropies: &[f64],
        roughnesses: &[f64],
        angles_deg: &[f64],
    ) -> Vec<Self> {
        let mut cases = Vec::new();
        for &anisotropy in anisotropies {
            for &roughness in roughnesses {
                for &angle_deg in angles_deg {
                    let number = ((lobe as u32 * 8 + curve as u32) * 4 + horizon as u32) * 256 + cases.len() as u32;
                    let case = Self::new(lobe, curve, horizon, roughness, angle_deg);
                    cases.push(Self {
                        anisotropy,
                        seed: number,
                        ..case
                    });
                }
            }
        }
        cases
    }

    pub fn shape(&self) -> LobeShape<'static, f64> {
        LobeShape {
            lobe: self.lobe,
            curve: self.curve,
            horizon: self.horizon,
            roughness: self.roughness,
            anisotropy: self.anisotropy,
            eta: self.eta,
            table: self.table,
        }
    }

    /// A shading frame in no special position.
    pub fn frame(&self) -> Frame<f64> {
        frame_from_normal(vec3(0.36, -0.48, 0.8))
    }

    /// Towards the viewer, in a plane between tangent and bitangent.
    pub fn wo(&self) -> Vec3<f64> {
        self.in_view_plane(self.angle_deg)
    }

    /// The middle of the lobe.
    pub fn middle(&self) -> Vec3<f64> {
        lobe_middle(&self.shape(), &self.frame(), self.surface_normal(), self.wo())
    }

    /// The geometric normal.
    pub fn surface_normal(&self) -> Vec3<f64> {
        self.in_view_plane(self.lean_deg)
    }

    fn in_view_plane(&self, angle_deg: f64) -> Vec3<f64> {
        let frame = self.frame();
        let (sine, cosine) = angle_deg.to_radians().sin_cos();
        frame.normal * cosine + (frame.tangent * 0.8 + frame.bitangent * 0.6) * sine
    }
}

/// Every lobe; the geometric one with every curve.
pub fn lobes_and_curves() -> Vec<(Lobe, Curve)> {
    Lobe::ALL
        .iter()
        .flat_map(|&lobe| lobe.curves().iter().map(move |&curve| (lobe, curve)))
        .collect()
}

/// False for curves whose density is integrated node by node or interval by interval, which takes ten times as long.
pub fn is_quick(curve: Curve) -> bool {
    !matches!(curve.traits().integral, Integral::Quadrature | Integral::Table)
}

/// The same with quick curves alone: for what is done to a lobe whatever its curve. With all in `make test-thorough`.
pub fn lobes_and_quick_curves() -> Vec<(Lobe, Curve)> {
    let mut all = lobes_and_curves();
    all.retain(|&(_, curve)| is_quick(curve) || cfg!(feature = "thorough"));
    all
}

/// A custom curve with a crowded middle, a gap and a ring: nothing that one rule of quadrature would meet by chance.
pub fn custom() -> &'static [f32] {
    static TABLE: std::sync::OnceLock<Vec<f32>> = std::sync::OnceLock::new();
    TABLE.get_or_init(|| {
        let node = |i: usize| {
            let d = i as f64 / CUSTOM_INTERVALS as f64;
            (0.3 - d).max(0.0) + 0.6 * (0.1 - (d - 0.75).abs()).max(0.0) + if i % 8 == 4 { 0.1 } else { 0.0 }
        };
        let density: Vec<f64> = (0..=CUSTOM_INTERVALS).map(node).collect();
        custom_table(1.5, &density).expect("a density")
    })
}
