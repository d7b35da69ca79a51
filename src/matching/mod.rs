//! "Match look": the material whose highlight comes closest to another lobe's or to a measured one's.

pub mod measured;

use std::sync::Arc;

use crate::{
    analysis::fit::{
        CurveFit, CurveTarget, Measure, Merl, Nearest, fit_curve, nearest_roughness, roughness, total_variation,
    },
    analysis::sphere_grid::{Profile, Side, SphereGrid},
    document::MaterialSettings,
    document::custom_curve::{CustomCurve, POINTS_MAX, XI_STEP_MIN},
    optics::{
        curve::{CUSTOM_INTERVALS, Curve},
        lobe::{
            Horizon, Lobe,
            model::{LobeModel, roughness_min, view_direction},
        },
        vector::{Vec3, vec3},
    },
    plot::lobe_view::{Axis, LinePlot, Series, slice_angles_deg},
};

/// Largest distances that a fitted curve may have: long tails need more than 1.
const DISTANCES_MAX: [f64; 6] = [1.0, 1.5, 2.5, 4.0, 7.0, 12.0];
/// Steps of the scan for R, and relative accuracy of its search.
const CURVE_SCAN: (usize, f64) = (9, 0.02);
/// The same once the curve is settled.
const FINAL_SCAN: (usize, f64) = (4, 0.001);
/// The scan for the roughness of a stretched lobe.
const STRETCHED_SCAN: (usize, f64) = (16, 0.001);
/// Largest R of a fitted curve: at 1 every curve gives the same lobe.
const ROUGHNESS_MAX: f64 = 0.99;
/// Roughness that a measured material is compared at before the fit.
const ROUGHNESS_BEFORE: f64 = 0.3;
/// Share of the largest value below which a target is not shown.
const SHOWN_FLOOR: f64 = 0.001;
/// Largest angle of the view, degrees.
pub const VIEW_ANGLE_MAX_DEG: f64 = 85.0;

/// What a look is matched to.
#[derive(Clone, Debug)]
pub enum Target {
    Lobe(LobeModel),
    Measured {
        name: String,
        /// Its reflectance.
        merl: Arc<Merl>,
    },
}

/// Why a look cannot be matched.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MatchError {
    /// The target is a mirror.
    #[error("the target's roughness of {roughness} is a mirror's; a highlight to match needs at least {least}")]
    Mirror { roughness: f64, least: f64 },
    /// The target is anisotropic.
    #[error("the target is anisotropic; only round highlights can be matched: set its anisotropy to 0")]
    Anisotropic,
    /// The view is too flat or no number.
    #[error("a view angle of {0}° cannot be matched at; give 0 to {VIEW_ANGLE_MAX_DEG}")]
    ViewAngle(f64),
    /// Nothing is reflected, or only diffusely.
    #[error("the target has no highlight at this view angle; try another angle")]
    NoHighlight,
}

/// A lobe and how far it is from the target.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    pub model: LobeModel,
    /// Total variation distance in [0, 1].
    pub total_variation: f64,
}

/// A look that was matched.
#[derive(Clone, Debug, PartialEq)]
pub struct LookMatch {
    /// Angle of the view, degrees.
    pub view_angle_deg: f64,
    pub target: String,
    /// The lobe with its default curve at the target's own roughness (0.3 for a measured one).
    pub before: Candidate,
    /// The lobe with its default curve at the roughness that comes closest.
    pub nearest: Candidate,
    /// The best found: for the geometric lobe with a curve of its own, else `nearest`.
    pub after: Candidate,
    pub curve: Option<CustomCurve>,
    /// Colours of a measured material.
    pub colors: Option<measured::Colors>,
}

impl LookMatch {
    /// Gives a material this look. What the target does not describe stays.
    pub fn apply(&self, material: &mut MaterialSettings) {
        material.lobe = self.after.model.lobe;
        material.roughness = self.after.model.roughness as f32;
        material.horizon = self.after.model.horizon;
        material.anisotropy = 0.0;
        material.curve = self.after.model.curve;
        if let Some(curve) = &self.curve {
            material.custom_curve = curve.clone();
        }
        if let Some(colors) = &self.colors {
            colors.apply(material);
        }
    }
}

/// The specular lobe of a material.
pub fn lobe_of_material(material: &MaterialSettings) -> LobeModel {
    let is_custom = material.lobe.has_curves() && material.curve.has_table();
    LobeModel {
        name: material.name.clone(),
        lobe: material.lobe,
        curve: material.curve,
        horizon: material.horizon,
        roughness: f64::from(material.roughness),
        anisotropy: f64::from(material.anisotropy),
        rotation_rad: f64::from(material.rotation_deg).to_radians(),
        eta: 0.0,
        table: if is_custom {
            material.custom_curve.table()
        } else {
            Vec::new()
        },
    }
}

/// The highlight's profile of a target for one view: what is matched, and for a measured one what was left out.
pub struct TargetProfile<'a> {
    target: &'a Target,
    wo: Vec3<f64>,
    /// Albedo of the Lambertian part that is no part of the highlight.
    pub base_albedo: f64,
}

impl<'a> TargetProfile<'a> {
    /// The profile under an angle in radians.
    pub fn new(target: &'a Target, view_angle_rad: f64) -> Result<Self, MatchError> {
        let mut profile = Self {
            target,
            wo: view_direction(view_angle_rad),
            base_albedo: 0.0,
        };
        match target {
            Target::Lobe(model) if !model.has_density() => Err(MatchError::Mirror {
                roughness: model.roughness,
                least: roughness_min(model.lobe),
            }),
            Target::Lobe(model) if !model.is_symmetric() => Err(MatchError::Anisotropic),
            Target::Lobe(_) => Ok(profile),
            Target::Measured { merl, .. } => {
                let base = measured::base_albedo(merl, view_angle_rad);
                profile.base_albedo = base.ok_or(MatchError::NoHighlight)?;
                Ok(profile)
            }
        }
    }

    /// Evaluate of the highlight, the cosine included.
    pub fn value(&self, wi: Vec3<f64>) -> f64 {
        match self.target {
            Target::Lobe(model) => model.evaluate(self.wo, wi)[0],
            Target::Measured { merl, .. } => measured::highlight(merl, self.wo, wi, self.base_albedo),
        }
    }
}

/// Matches a lobe to a target, seen `view_angle_deg` from the normal. For the geometric lobe the curve is fitted too.
pub fn match_look(target: &Target, lobe: Lobe, view_angle_deg: f64) -> Result<LookMatch, MatchError> {
    if !(0.0..=VIEW_ANGLE_MAX_DEG).contains(&view_angle_deg) {
        return Err(MatchError::ViewAngle(view_angle_deg));
    }
    let view_angle_rad = view_angle_deg.to_radians();
    let target_profile = TargetProfile::new(target, view_angle_rad)?;
    let profile: Profile = &|wi| target_profile.value(wi);
    let (name, roughness) = match target {
        Target::Lobe(model) => (model.name.clone(), model.roughness.max(roughness_min(lobe))),
        Target::Measured { name, .. } => (name.clone(), ROUGHNESS_BEFORE),
    };
    let default = MaterialSettings::default();
    let candidate = |roughness: f64| {
        let model = LobeModel {
            horizon: default.horizon,
            ..LobeModel::new(lobe, rounded(roughness), default.curve)
        };
        let total_variation = total_variation(profile, &model, view_angle_rad, Measure::Evaluate);
        Candidate { model, total_variation }
    };
    let start = candidate(roughness);
    let found = nearest_roughness(profile, &start.model, view_angle_rad, Measure::Evaluate);
    let nearest = candidate(found.roughness);
    let mut after = nearest.clone();
    let mut curve = None;
    if lobe.has_curves() {
        let fitted = curve_candidate(profile, view_angle_rad, &nearest.model).ok_or(MatchError::NoHighlight)?;
        if fitted.0.total_variation < after.total_variation {
            (after, curve) = (fitted.0, Some(fitted.1));
        }
    }
    let colors = match target {
        Target::Lobe(_) => None,
        Target::Measured { merl, .. } => Some(measured::colors(merl, view_angle_rad, &after.model)),
    };
    Ok(LookMatch {
        view_angle_deg,
        target: name,
        before: start,
        nearest,
        after,
        curve,
        colors,
    })
}

/// The lobe with its default curve that comes closest to the specular lobe of a material, seen along the normal: only
/// the roughness is looked for, as that is what `lobe` has in common with others.
pub fn matched_lobe(model: &LobeModel, lobe: Lobe) -> Result<LobeModel, MatchError> {
    matched_lobe_and_curve(model, lobe, MaterialSettings::default().curve)
}

/// The same with a curve of choice.
pub fn matched_lobe_and_curve(model: &LobeModel, lobe: Lobe, curve: Curve) -> Result<LobeModel, MatchError> {
    let target = Target::Lobe(model.clone());
    let target_profile = TargetProfile::new(&target, 0.0)?;
    let profile: Profile = &|wi| target_profile.value(wi);
    let default = MaterialSettings::default();
    let start = LobeModel {
        horizon: default.horizon,
        ..LobeModel::new(lobe, model.roughness, curve)
    };
    let found = nearest_roughness(profile, &start, 0.0, Measure::Evaluate);
    Ok(start.with_roughness(rounded(found.roughness)))
}

/// The roughness of GGX that comes closest to a lobe seen along the normal, stretched and turned alike.
pub fn nearest_ggx(model: &LobeModel) -> Nearest {
    let wo = view_direction(0.0);
    let candidate = LobeModel {
        lobe: Lobe::Ggx,
        table: Vec::new(),
        ..model.clone()
    };
    let target: Profile = &|wi| model.evaluate(wo, wi)[0];
    if model.is_symmetric() {
        return nearest_roughness(target, &candidate, 0.0, Measure::Evaluate);
    }
    let distance =
        |roughness: f64| total_variation(target, &candidate.with_roughness(roughness), 0.0, Measure::Evaluate);
    roughness::minimum(
        [roughness_min(Lobe::Ggx), 1.0],
        STRETCHED_SCAN.0,
        STRETCHED_SCAN.1,
        &distance,
    )
}

/// Target and candidates side by side: the normalised profiles in the plane of incidence, around the mirror direction
/// as far as the target is not negligible.
pub fn comparison(target: &Target, found: &LookMatch) -> Result<LinePlot, MatchError> {
    let view_angle_rad = found.view_angle_deg.to_radians();
    let wo = view_direction(view_angle_rad);
    let target_profile = TargetProfile::new(target, view_angle_rad)?;
    let line = |group: usize, name: String, profile: Profile, gap_rad: f64| {
        let grid = SphereGrid::adapted(view_angle_rad, Side::Above, true, &[profile]);
        let total = grid.integral(&grid.values(profile)).max(f64::MIN_POSITIVE);
        let point = |angle_deg: f64| {
            let angle_rad = angle_deg.to_radians();
            [angle_deg, profile(vec3(angle_rad.sin(), 0.0, angle_rad.cos())) / total]
        };
        Series {
            lobe: name,
            view_angle_deg: Some(found.view_angle_deg),
            quantity: "density",
            group,
            points: slice_angles_deg(found.view_angle_deg, gap_rad.to_degrees())
                .into_iter()
                .map(point)
                .collect(),
        }
    };
    let mut series = vec![line(0, found.target.clone(), &|wi| target_profile.value(wi), 0.0)];
    let mut candidates = vec![("before", &found.before), ("nearest", &found.nearest)];
    if found.curve.is_some() {
        candidates.push(("after", &found.after));
    }
    for (word, candidate) in candidates {
        let model = &candidate.model;
        let name = format!("{word}: {}, TV {:.3}", model.name, candidate.total_variation);
        series.push(line(
            series.len(),
            name,
            &|wi| model.evaluate(wo, wi)[0],
            model.peak_radius_rad(),
        ));
    }
    let top = series[0].points.iter().map(|[_, y]| *y).fold(0.0, f64::max);
    let seen = series[0]
        .points
        .iter()
        .filter(|[_, y]| *y > SHOWN_FLOOR * top)
        .map(|[x, _]| *x);
    let range = [seen.clone().fold(90.0, f64::min), seen.fold(-90.0, f64::max)];
    let points = series.iter().flat_map(|series| &series.points);
    let highest = points.map(|[_, y]| *y).fold(top, f64::max);
    // Only what lies on the plot.
    for series in &mut series {
        series.points.retain(|[x, _]| (range[0]..=range[1]).contains(x));
    }
    Ok(LinePlot {
        title: "Matched look".to_owned(),
        x: Axis::linear("Angle to the normal in degrees", range),
        y: Axis {
            is_logarithmic: true,
            ..Axis::linear("Share of the highlight in 1/sr", [SHOWN_FLOOR * top, 1.5 * highest])
        },
        is_polar: false,
        x_column: "angle_deg",
        series,
    })
}

/// To the digits that a file is read by people with.
fn rounded(roughness: f64) -> f64 {
    (roughness * 1e5).round() / 1e5
}

/// The best custom curve with its roughness. Each of [`DISTANCES_MAX`] is fitted, turned into the points that the
/// document stores, and judged by these.
fn curve_candidate(profile: Profile, view_angle_rad: f64, start: &LobeModel) -> Option<(Candidate, CustomCurve)> {
    let target = CurveTarget::new(profile, view_angle_rad)?;
    let fits = DISTANCES_MAX.iter().filter_map(|&distance_max| {
        let fit = best_fit(&target, start.roughness, distance_max, start.horizon)?;
        let curve = curve_from_fit(&fit)?;
        Some((judged(profile, view_angle_rad, start, fit.roughness, &curve), curve))
    });
    fits.min_by(|a, b| a.0.total_variation.total_cmp(&b.0.total_variation))
}

/// The best curve with distances up to `distance_max`, over all R around `start`.
fn best_fit(target: &CurveTarget, start: f64, distance_max: f64, horizon: Horizon) -> Option<CurveFit> {
    let fit = |roughness: f64| fit_curve(target, roughness, distance_max, horizon, false);
    let range = [
        (0.3 * start / distance_max).max(roughness_min(Lobe::Geometric)),
        (2.5 * start).min(ROUGHNESS_MAX),
    ];
    let residual = |roughness: f64| fit(roughness).map_or(1.0, |fit| fit.residual);
    fit(roughness::minimum(range, CURVE_SCAN.0, CURVE_SCAN.1, &residual).roughness)
}

/// The lobe with the document's curve, at the roughness near the fit's that suits it best.
fn judged(profile: Profile, view_angle_rad: f64, start: &LobeModel, roughness: f64, curve: &CustomCurve) -> Candidate {
    let model = LobeModel {
        curve: Curve::Custom,
        table: curve.table(),
        name: "Geometric, fitted curve".to_owned(),
        ..start.clone()
    };
    let at = |roughness: f64| model.with_roughness(rounded(roughness));
    let distance = |roughness: f64| total_variation(profile, &at(roughness), view_angle_rad, Measure::Evaluate);
    let range = [
        (0.93 * roughness).max(roughness_min(Lobe::Geometric)),
        (1.07 * roughness).min(ROUGHNESS_MAX),
    ];
    let found = roughness::minimum(range, FINAL_SCAN.0, FINAL_SCAN.1, &distance);
    Candidate {
        model: at(found.roughness),
        total_variation: found.total_variation,
    }
}

/// The points (ξ, D) of a fitted curve: where the table that the lobe samples has its limits, as far as ξ differs there
/// by what the document stores.
pub fn curve_from_fit(fit: &CurveFit) -> Option<CustomCurve> {
    let distance_max = *fit.nodes.last()?;
    let limits = (0..CUSTOM_INTERVALS).map(|i| (i as f64 + 0.5) / CUSTOM_INTERVALS as f64 * distance_max);
    let candidates: Vec<[f32; 2]> = limits
        .map(|distance| [fit.cumulative(distance), distance].map(|x| ((x * 1e5).round() / 1e5) as f32))
        .collect();
    let mut points = Vec::new();
    let mut step = XI_STEP_MIN;
    loop {
        points.clear();
        points.push([0.0, 0.0]);
        for candidate in &candidates {
            let last: [f32; 2] = points[points.len() - 1];
            if candidate[0] - last[0] >= step && 1.0 - candidate[0] >= step {
                points.push(*candidate);
            }
        }
        points.push([1.0, distance_max as f32]);
        if points.len() <= POINTS_MAX {
            return CustomCurve::try_from(points).ok();
        }
        step += 0.5 * XI_STEP_MIN;
    }
}
