//! The numbers of the views.

use super::{Axis, DiscMap, LinePlot, LobeView, MapPlot, Series, Solid, SolidPlot, ViewKind};
use crate::{
    analysis::sphere_grid::{Profile, Side, SphereGrid, rings},
    optics::{
        curve::{curve_density, curve_distance_max},
        lobe::microfacet_alpha,
        lobe::model::{LobeModel, view_direction},
        scattering::kept_energy,
        vector::{Vec3, vec3},
    },
    parallel,
};

/// Pixels along a side of a map.
const MAP_SIZE: usize = 300;
/// Decades that a map shows.
const MAP_DECADES: f64 = 4.0;
/// Faces around a body.
const SOLID_AZIMUTHS: usize = 48;
/// Directions whose reflectance is below this share of the largest do not count for the largest reciprocity error.
const RECIPROCITY_FLOOR: f64 = 0.01;
/// Closest that a slice comes to the mirror direction, degrees.
const SLICE_GAP_DEG: f64 = 0.02;

/// Samples of the energy that a lobe keeps, for a view.
const ENERGY_SAMPLES: u32 = 8192;

/// Points of a line over the distance, and how much of a long tail it shows.
const DISTANCE_POINTS: usize = 200;
const DISTANCE_SHOWN_MAX: f64 = 5.0;

/// The view of lobes under each of the angles, in degrees from 0 to below 90; the lobes must have a density
/// ([`LobeModel::has_density`]). Those of which there is nothing to see ([`ViewKind::shows`]) are left out.
pub fn lobe_view(kind: ViewKind, lobes: &[LobeModel], view_angles_deg: &[f64]) -> LobeView {
    let title = kind.label().to_owned();
    let each = || {
        lobes
            .iter()
            .flat_map(|lobe| view_angles_deg.iter().map(move |angle| (lobe, *angle)))
    };
    match kind {
        ViewKind::Polar => LobeView::Lines(polar(title, each())),
        ViewKind::Hemisphere => LobeView::Maps(maps(title, each())),
        ViewKind::Solid => LobeView::Solids(SolidPlot {
            title,
            solids: each().map(|(lobe, angle)| solid(lobe, angle)).collect(),
        }),
        ViewKind::Albedo if lobes.iter().any(|lobe| lobe.lobe.traits().loses_light) => {
            let columns = &["albedo", "compensated"];
            against_angle(title, "Albedo", columns, lobes, view_angles_deg, albedo_with_scattering)
        }
        ViewKind::Albedo => against_angle(title, "Albedo", &["albedo"], lobes, view_angles_deg, albedo),
        ViewKind::Horizon => {
            let label = "Share below the horizon";
            against_angle(
                title,
                label,
                &["fraction_below"],
                lobes,
                view_angles_deg,
                fraction_below,
            )
        }
        ViewKind::Distance => {
            let shown = lobes.iter().filter(|lobe| kind.shows(lobe.lobe));
            LobeView::Lines(distances(title, shown))
        }
        ViewKind::Reciprocity => {
            let label = "Relative difference of f(a, b) and f(b, a)";
            against_angle(title, label, &["rms", "max"], lobes, view_angles_deg, reciprocity_error)
        }
    }
}

fn against_angle<const N: usize>(
    title: String,
    label: &str,
    columns: &[&'static str; N],
    lobes: &[LobeModel],
    view_angles_deg: &[f64],
    quantities: fn(&LobeModel, f64) -> [f64; N],
) -> LobeView {
    let mut series = Vec::new();
    for (group, lobe) in lobes.iter().enumerate() {
        let rows = parallel::map_each(view_angles_deg, |angle| quantities(lobe, angle.to_radians()));
        series.extend(columns.iter().enumerate().map(|(column, quantity)| {
            let points = view_angles_deg
                .iter()
                .zip(&rows)
                .map(|(angle, row)| [*angle, row[column]])
                .collect();
            Series {
                lobe: lobe.name.clone(),
                view_angle_deg: None,
                quantity,
                group,
                points,
            }
        }));
    }
    let x = Axis::linear("Angle of the view to the normal in degrees", [0.0, 90.0]);
    LobeView::Lines(LinePlot::of_lobes(title, x, label, "view_angle_deg", series))
}

/// ∫ evaluate over the hemisphere.
fn albedo(lobe: &LobeModel, view_angle_rad: f64) -> [f64; 1] {
    let wo = view_direction(view_angle_rad);
    [integral(lobe, view_angle_rad, Side::Above, &|wi| {
        lobe.evaluate(wo, wi)[0]
    })]
}

fn integral(lobe: &LobeModel, view_angle_rad: f64, side: Side, profile: Profile) -> f64 {
    let grid = SphereGrid::adapted(view_angle_rad, side, lobe.is_symmetric(), &[profile]);
    grid.integral(&grid.values(profile))
}

/// The same, and with the light that a white metal's facets scatter more than once, as renders have it.
fn albedo_with_scattering(lobe: &LobeModel, view_angle_rad: f64) -> [f64; 2] {
    let [single] = albedo(lobe, view_angle_rad);
    if !lobe.lobe.traits().loses_light || lobe.eta != 0.0 {
        return [single; 2];
    }
    let kept = kept_energy(microfacet_alpha(&lobe.shape()), view_angle_rad.cos(), ENERGY_SAMPLES);
    [single, single * (1.0 + (1.0 - kept) / kept)]
}

/// ∫ density over the lower hemisphere, before the policy.
fn fraction_below(lobe: &LobeModel, view_angle_rad: f64) -> [f64; 1] {
    let wo = view_direction(view_angle_rad);
    [integral(lobe, view_angle_rad, Side::Below, &|wi| {
        lobe.raw_density(wo, wi)
    })]
}

/// Of |f(a, b) − f(b, a)| over the mean of the two, a the view, b over the hemisphere, f the reflectance without the
/// cosine: the root of the mean square, each b counting as the light that it gets, and the largest where f is not
/// negligible. In [0, 2].
fn reciprocity_error(lobe: &LobeModel, view_angle_rad: f64) -> [f64; 2] {
    let a = view_direction(view_angle_rad);
    let profile = |b| lobe.evaluate(a, b)[0];
    let grid = SphereGrid::adapted(view_angle_rad, Side::Above, lobe.is_symmetric(), &[&profile]);
    let means_and_errors: Vec<[f64; 2]> = grid
        .points
        .iter()
        .map(|(b, _)| {
            let (there, back) = (profile(*b) / b.z, lobe.evaluate(*b, a)[0] / a.z);
            let mean = 0.5 * (there + back);
            [mean, if mean > 0.0 { (there - back).abs() / mean } else { 0.0 }]
        })
        .collect();
    let energies = grid.values(&profile);
    let squares: Vec<f64> = energies
        .iter()
        .zip(&means_and_errors)
        .map(|(energy, [_, error])| energy * error * error)
        .collect();
    let top = means_and_errors.iter().map(|[mean, _]| *mean).fold(0.0, f64::max);
    let counting = means_and_errors
        .iter()
        .filter(|[mean, _]| *mean > RECIPROCITY_FLOOR * top);
    [
        (grid.integral(&squares) / grid.integral(&energies).max(f64::MIN_POSITIVE)).sqrt(),
        counting.map(|[_, error]| *error).fold(0.0, f64::max),
    ]
}

/// Density of D (paper, Fig. 2).
fn distances<'a>(title: String, lobes: impl Iterator<Item = &'a LobeModel>) -> LinePlot {
    let line = |(group, lobe): (usize, &LobeModel)| {
        let reach = curve_distance_max::<f64>(lobe.curve, &lobe.table).min(DISTANCE_SHOWN_MAX);
        let point = |index: usize| {
            let distance = reach * index as f64 / DISTANCE_POINTS as f64;
            // The limit at 0, where the formula is 0/0.
            [distance, curve_density(lobe.curve, &lobe.table, distance.max(1e-9))]
        };
        Series {
            lobe: lobe.name.clone(),
            view_angle_deg: None,
            quantity: "density",
            group,
            points: (0..=DISTANCE_POINTS).map(point).collect(),
        }
    };
    let series: Vec<Series> = lobes.enumerate().map(line).collect();
    let reach = series.iter().flat_map(|series| &series.points);
    let reach = reach.map(|[x, _]| *x).fold(0.0, f64::max);
    let x = Axis::linear(
        "Distance D from the mirror direction, in units of R",
        [0.0, reach.max(1.0)],
    );
    LinePlot::of_lobes(title, x, "Density", "distance", series)
}

/// Evaluate in the plane of incidence.
fn polar<'a>(title: String, each: impl Iterator<Item = (&'a LobeModel, f64)>) -> LinePlot {
    let line = |(group, (lobe, angle)): (usize, (&LobeModel, f64))| {
        let wo = view_direction(angle.to_radians());
        let point = |angle_deg: f64| {
            let angle_rad = angle_deg.to_radians();
            [
                angle_deg,
                lobe.evaluate(wo, vec3(angle_rad.sin(), 0.0, angle_rad.cos()))[0],
            ]
        };
        Series {
            lobe: lobe.name.clone(),
            view_angle_deg: Some(angle),
            quantity: "value",
            group,
            points: slice_angles_deg(angle, lobe.peak_radius_rad().to_degrees())
                .into_iter()
                .map(point)
                .collect(),
        }
    };
    let series: Vec<Series> = each.enumerate().map(line).collect();
    let x = Axis::linear("Angle to the normal in degrees", [-90.0, 90.0]);
    LinePlot {
        is_polar: true,
        ..LinePlot::of_lobes(title, x, "BRDF × cos θ (1/sr)", "angle_deg", series)
    }
}

/// Angles from the normal across the hemisphere, dense near the mirror direction but not closer than `gap_deg`, rising.
pub fn slice_angles_deg(mirror_deg: f64, gap_deg: f64) -> Vec<f64> {
    let gap_deg = gap_deg.max(SLICE_GAP_DEG);
    let offsets = (0..).map(|i| gap_deg * 1.055_f64.powi(i));
    let offsets: Vec<f64> = offsets.take_while(|offset| *offset < 180.0).collect();
    let below = offsets.iter().rev().map(|offset| mirror_deg - offset);
    let above = offsets.iter().map(|offset| mirror_deg + offset);
    let inside = below.chain(above).filter(|angle| angle.abs() < 90.0);
    std::iter::once(-90.0).chain(inside).chain([90.0]).collect()
}

/// The density of what is kept, in pixels.
fn maps<'a>(title: String, each: impl Iterator<Item = (&'a LobeModel, f64)>) -> MapPlot {
    let maps: Vec<DiscMap> = each.map(|(lobe, angle)| map(lobe, angle)).collect();
    let values = maps.iter().flat_map(|map| &map.values);
    let top = values.copied().fold(1e-9, f64::max);
    MapPlot {
        title,
        range: [top * 10.0_f64.powf(-MAP_DECADES), top],
        maps,
    }
}

fn map(lobe: &LobeModel, view_angle_deg: f64) -> DiscMap {
    let wo = view_direction(view_angle_deg.to_radians());
    let pixel = |pixel: usize| {
        let direction = DiscMap::direction(MAP_SIZE, pixel % MAP_SIZE, pixel / MAP_SIZE);
        direction.map_or(f64::NAN, |wi| lobe.evaluate(wo, wi)[1])
    };
    DiscMap {
        lobe: lobe.name.clone(),
        view_angle_deg,
        size: MAP_SIZE,
        values: parallel::map(MAP_SIZE * MAP_SIZE, pixel),
    }
}

/// Evaluate along rings about the mirror direction.
fn solid(lobe: &LobeModel, view_angle_deg: f64) -> Solid {
    let view_angle_rad = view_angle_deg.to_radians();
    let wo = view_direction(view_angle_rad);
    let profile = |wi: Vec3<f64>| lobe.evaluate(wo, wi)[0];
    let directions = rings(
        view_angle_rad,
        lobe.is_symmetric(),
        &[&profile],
        SOLID_AZIMUTHS,
        lobe.peak_radius_rad(),
    );
    let ring = |ring: &Vec<Vec3<f64>>| ring.iter().map(|wi| (*wi, profile(*wi))).collect();
    Solid {
        lobe: lobe.name.clone(),
        view_angle_deg,
        rings: parallel::map_each(&directions, ring),
    }
}
