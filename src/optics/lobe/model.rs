//! A lobe with all its settings, for sampling, fitting, plotting and comparison.

use super::*;
use super::{Lobe, raw_density};
use crate::optics::frame::frame_from_tangent;

/// A lobe with its settings. Directions are in the frame with the normal +z and the view in the half plane x ≤ 0.
#[derive(Clone, Debug, PartialEq)]
pub struct LobeModel {
    /// Name in legends and columns.
    pub name: String,
    /// Model of the lobe.
    pub lobe: Lobe,
    /// The geometric lobe's curve.
    pub curve: Curve,
    pub horizon: Horizon,
    /// Perceptual roughness in [0, 1].
    pub roughness: f64,
    /// Stretch in [−1, 1].
    pub anisotropy: f64,
    /// Relative index of refraction; 0 for reflection.
    pub eta: f64,
    /// Turn of the tangent out of the plane of incidence, radians.
    pub rotation_rad: f64,
    /// Table of the custom curve; empty for a named curve.
    pub table: Vec<f32>,
}

impl LobeModel {
    /// An isotropic lobe under the mirror policy, named after its settings.
    pub fn new(lobe: Lobe, roughness: f64, curve: Curve) -> Self {
        let mut name = lobe.label().to_owned();
        if lobe.has_roughness() {
            name += &format!(" {roughness}");
        }
        if lobe.has_curves() {
            name += &format!(", {}", curve.label().to_lowercase());
        }
        Self {
            name,
            lobe,
            curve,
            horizon: Horizon::Mirror,
            roughness,
            anisotropy: 0.0,
            eta: 0.0,
            rotation_rad: 0.0,
            table: Vec::new(),
        }
    }

    /// The same lobe at another roughness.
    pub fn with_roughness(&self, roughness: f64) -> Self {
        Self {
            roughness,
            ..self.clone()
        }
    }

    /// The lobe's parameters in a precision.
    pub fn shape<T: Real>(&self) -> LobeShape<'_, T> {
        LobeShape {
            lobe: self.lobe,
            curve: self.curve,
            horizon: self.horizon,
            roughness: T::from_f64(self.roughness),
            anisotropy: T::from_f64(self.anisotropy),
            eta: T::from_f64(self.eta),
            table: &self.table,
        }
    }

    pub fn frame(&self) -> Frame<f64> {
        frame_from_tangent(NORMAL, vec3(1.0, 0.0, 0.0), self.rotation_rad)
    }

    /// (evaluate with the cosine, density per steradian) for light from `wi`, the horizon policy applied.
    pub fn evaluate(&self, wo: Vec3<f64>, wi: Vec3<f64>) -> [f64; 2] {
        lobe_evaluate(&self.shape(), &self.frame(), NORMAL, wo, wi)
    }

    /// Density of the lobe's samples before the horizon policy, per steradian over the whole sphere.
    pub fn raw_density(&self, wo: Vec3<f64>, wi: Vec3<f64>) -> f64 {
        raw_density(&self.shape(), &self.frame(), wo, wi)
    }

    /// True if the lobe is symmetric about the plane of incidence.
    pub fn is_symmetric(&self) -> bool {
        self.anisotropy == 0.0 || !self.lobe.is_anisotropic()
    }

    /// Radius about the mirror direction, in radians, that plots omit: an integrable singularity would be as high as its
    /// nearest sample point.
    pub fn peak_radius_rad(&self) -> f64 {
        self.lobe.traits().peak * self.roughness
    }

    /// False if the roughness is too small for a density to plot or fit.
    pub fn has_density(&self) -> bool {
        self.roughness >= roughness_min(self.lobe)
    }
}

pub const NORMAL: Vec3<f64> = Vec3 { x: 0.0, y: 0.0, z: 1.0 };

/// Towards the viewer, `view_angle_rad` from the normal.
pub fn view_direction(view_angle_rad: f64) -> Vec3<f64> {
    vec3(-view_angle_rad.sin(), 0.0, view_angle_rad.cos())
}

/// The smallest roughness at which a lobe's density is one: below, it is a mirror.
pub fn roughness_min(lobe: Lobe) -> f64 {
    match lobe.traits().width {
        Width::Fixed => 0.0,
        Width::Roughness => MIRROR_WIDTH,
        Width::Alpha => ALPHA_MIN.sqrt(),
    }
}
