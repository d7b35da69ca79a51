//! What of a measured material is base, what highlight, and the colours of both.

use std::f64::consts::FRAC_1_PI;

use crate::{
    analysis::fit::{CurveTarget, Merl, fit_curve, roughness},
    analysis::sphere_grid::{Side, SphereGrid},
    document::MaterialSettings,
    optics::{
        fresnel::Fresnel,
        lobe::Horizon,
        lobe::model::{LobeModel, NORMAL, view_direction},
        vector::Vec3,
    },
};

/// Roughnesses between which the highlight is looked for: a rougher lobe cannot be distinguished from the base.
const ROUGHNESS_RANGE: [f64; 2] = [0.005, 0.5];
/// Reach of the curve that stands for the highlight.
const DISTANCE_MAX: f64 = 4.0;
/// Albedo of a base below which the material is a metal.
const BASE_ALBEDO_MIN: f64 = 0.01;
/// Largest reflectance of a dielectric at normal incidence: at an index of refraction of 4.
const DIELECTRIC_F0_MAX: f64 = 0.36;

/// Colours of a measured material, linear RGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colors {
    /// Albedo of the base as it is seen.
    pub base: Vec3<f64>,
    /// Factor of the highlight's lobe: its Fresnel reflectance.
    pub highlight: Vec3<f64>,
}

/// The luminance of evaluate, the cosine included.
fn luminance(merl: &Merl, wo: Vec3<f64>, wi: Vec3<f64>) -> f64 {
    merl.reflectance(wo, wi).luminance() * NORMAL.dot(wi).max(0.0)
}

/// The luminance of evaluate without a base of this albedo, not negative.
pub fn highlight(merl: &Merl, wo: Vec3<f64>, wi: Vec3<f64>, base_albedo: f64) -> f64 {
    (luminance(merl, wo, wi) - base_albedo * FRAC_1_PI * NORMAL.dot(wi).max(0.0)).max(0.0)
}

/// The Lambertian part's albedo, in luminance: the constant term beside a geometric lobe whose curve is free. `None`
/// where there is no highlight beside it.
pub fn base_albedo(merl: &Merl, view_angle_rad: f64) -> Option<f64> {
    let wo = view_direction(view_angle_rad);
    let target = CurveTarget::new(&|wi| luminance(merl, wo, wi), view_angle_rad)?;
    let fit = |roughness: f64| fit_curve(&target, roughness, DISTANCE_MAX, Horizon::Mirror, true);
    let residual = |roughness: f64| fit(roughness).map_or(1.0, |fit| fit.residual);
    let best = fit(roughness::minimum(ROUGHNESS_RANGE, 12, 0.02, &residual).roughness)?;
    (best.lobe_albedo > 0.0001 * best.base_albedo).then_some(best.base_albedo)
}

/// The colours beside a lobe of settled shape: least squares in each channel, not negative.
pub fn colors(merl: &Merl, view_angle_rad: f64, model: &LobeModel) -> Colors {
    let wo = view_direction(view_angle_rad);
    let lobe = |wi: Vec3<f64>| model.evaluate(wo, wi)[0];
    let base = |wi: Vec3<f64>| NORMAL.dot(wi).max(0.0) * FRAC_1_PI;
    let measured = |wi: Vec3<f64>| luminance(merl, wo, wi);
    let grid = SphereGrid::adapted(view_angle_rad, Side::Above, true, &[&lobe, &base, &measured]);
    // Each direction counts by the inverse of what is seen there: else the highlight's peak alone would count.
    let mut normal = [[0.0; 2]; 2];
    let mut right = [Vec3::ZERO; 2];
    for (wi, solid_angle) in &grid.points {
        let columns = [lobe(*wi), base(*wi)];
        let value = merl.reflectance(wo, *wi) * NORMAL.dot(*wi).max(0.0);
        let weight = solid_angle / (value.luminance() + 0.001);
        for i in 0..2 {
            right[i] += value * (weight * columns[i]);
            for j in 0..2 {
                normal[i][j] += weight * columns[i] * columns[j];
            }
        }
    }
    let channel = |right: [f64; 2]| non_negative_pair(normal, right);
    let [r, g, b] = [0, 1, 2].map(|c| channel([right[0].to_f64()[c], right[1].to_f64()[c]]));
    Colors {
        highlight: Vec3::from_f64([r[0], g[0], b[0]]),
        base: Vec3::from_f64([r[1], g[1], b[1]]),
    }
}

/// The non-negative solution of a least-squares problem with two unknowns, from its normal equations.
fn non_negative_pair(m: [[f64; 2]; 2], right: [f64; 2]) -> [f64; 2] {
    let determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    let alone = |i: usize| (right[i] / m[i][i].max(f64::MIN_POSITIVE)).max(0.0);
    let both = [
        (right[0] * m[1][1] - right[1] * m[0][1]) / determinant,
        (right[1] * m[0][0] - right[0] * m[1][0]) / determinant,
    ];
    match both {
        [x, y] if x >= 0.0 && y >= 0.0 => both,
        [x, _] if x < 0.0 => [0.0, alone(1)],
        [_, _] => [alone(0), 0.0],
    }
}

impl Colors {
    /// Sets a material's colours: a metal where there is hardly a base or the highlight is too strong for a dielectric,
    /// else a dielectric whose index of refraction gives the highlight's strength.
    pub fn apply(&self, material: &mut MaterialSettings) {
        material.fresnel = Fresnel::Schlick;
        material.specular_weight = 1.0;
        material.emission_strength = 0.0;
        let strength = self.highlight.max_component();
        if self.base.luminance() < BASE_ALBEDO_MIN || strength > DIELECTRIC_F0_MAX {
            material.metalness = 1.0;
            material.base_color = unit(self.highlight);
            material.specular_color = [1.0; 3];
            return;
        }
        material.metalness = 0.0;
        let root = strength.sqrt();
        material.ior = ((1.0 + root) / (1.0 - root)).clamp(1.0, 4.0) as f32;
        material.specular_color = unit(self.highlight / strength.max(1e-9));
        // The base gets what the highlight leaves over.
        let left = Vec3::splat(1.0) - self.highlight;
        let share = |base: f64, left: f64| base / left.max(0.1);
        material.base_color = unit(Vec3 {
            x: share(self.base.x, left.x),
            y: share(self.base.y, left.y),
            z: share(self.base.z, left.z),
        });
    }
}

/// To four digits, in [0, 1].
fn unit(color: Vec3<f64>) -> [f32; 3] {
    color.map(|x| ((x * 1e4).round() / 1e4).clamp(0.0, 1.0)).to_f32()
}
