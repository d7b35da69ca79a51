//! Hard cases of lobes: extremes of roughness, random numbers, curves, anisotropy, horizon, and densities with vanishing
//! terms.

use super::{Stage, StudyError};
use crate::{
    document::CustomCurve,
    job::probe::{LobeAnswer, LobeQuestion, ProbeScene},
    optics::{
        curve::Curve,
        frame::frame_from_normal,
        lobe::{Horizon, Lobe, LobeShape, lobe_evaluate, lobe_middle},
        vector::{Vec3, vec3},
    },
    scene::surface::bent_normal,
    study::check::shapes,
};

/// Extreme random numbers, of 24 or 32 bits.
const XI_ENDS: [f32; 4] = [0.0, 1.0 / 16_777_216.0, 1.0 / 4_294_967_296.0, 1.0 - 1.0 / 16_777_216.0];
/// Roughness at its ends and in between.
const ROUGHNESS: [f32; 12] = [
    0.0,
    1e-7,
    0.0001,
    0.001,
    0.03,
    0.3,
    0.7,
    0.97,
    0.999,
    1.0 - 0.0001,
    1.0 - 1.2e-7,
    1.0,
];
const VIEW_ANGLES_DEG: [f32; 5] = [0.0, 45.0, 80.0, 89.99, 90.0];
/// Largest deviation of a direction's length from 1.
const LENGTH_ERROR: f32 = 1e-5;
/// A number in the interior of every range.
const ANY_XI: [f32; 3] = [0.37, 0.61, 0.53];

cases! {
    "lobe"
    "roughness-at-its-ends"
        "R → 0: the density goes to infinity; R → 1: k → 0 is divided by"
        "R = 0, 1e-7, 1e-4, 1e-3 … 1 − 1e-4, 1 − 1e-7, 1, every lobe, curve and horizon, five views"
        "unit directions, finite weights and densities, none negative; answers that are not are counted"
        "12 of 12 densities at r are not finite",
        "count" 0.0, |stage| count_broken(stage, &grid(&shapes(), &ROUGHNESS, &VIEW_ANGLES_DEG, &[ANY_XI]));
    "random-numbers-at-their-ends"
        "ξ = 0 and 1 − 2⁻²⁴ come up sixty times a second: √ of −0, ln 0, 0/0"
        "each of three numbers 0, 2⁻²⁴, 2⁻³² or 1 − 2⁻²⁴, every lobe and curve, R at 0.03, 0.3, 0.97, 1"
        "unit directions, finite weights and densities, none negative; answers that are not are counted"
        "40 of 64 directions are NaN at R = 1",
        "count" 0.0, |stage| {
            count_broken(
                stage,
                &grid(&shapes(), &[0.03, 0.3, 0.97, 1.0], &[0.0, 60.0, 89.99], &xi_ends()),
            )
        };
    "nothing-left-to-normalise"
        "R = 1 with D = 0 or V = −n: w = 0, and 0/0 is NaN in the image for ever"
        "R = 1 and 1 − 1e-7, D = 0, V = n and V = −n to the bit (n along the axis of the sphere's map)"
        "unit directions with finite weight; others are counted"
        "8 of 12 directions are NaN",
        "count" 0.0, |stage| {
            let mut questions = Vec::new();
            for &curve in Curve::ALL {
                for roughness in [1.0, 1.0 - 1.2e-7] {
                    for normal in [vec3(1.0, 0.0, 0.0), vec3(-1.0, 0.0, 0.0)] {
                        let shape = shape(Lobe::Geometric, curve, roughness, 0.0, Horizon::None);
                        questions.extend(degenerate_xi().map(|xi| LobeQuestion {
                            shading: normal,
                            normal,
                            wo: normal,
                            xi,
                            wi: normal,
                            ..LobeQuestion::about(&shape, 0)
                        }));
                    }
                }
            }
            count_broken(stage, &questions)
        };
    "long-tail-to-its-end"
        "−ln(1 − √ξ) at ξ → 1: √ξ rounds to 1, the distance to infinity, the direction to NaN"
        "the long tail at the last 64 numbers below 1, five roughnesses, four views"
        "unit directions with finite weight and density; others are counted"
        "0 of 64 distances are infinite",
        "count" 0.0, |stage| {
            let ends: Vec<_> = last_numbers().map(|xi| [0.37, 0.61, xi]).collect();
            let tail = [
                (Lobe::Geometric, Curve::LongTail, 0.0),
                (Lobe::Geometric, Curve::LongTail, 0.9),
            ];
            count_broken(
                stage,
                &grid(&tail, &[0.001, 0.03, 0.3, 0.97, 1.0], &[0.0, 60.0, 85.0, 90.0], &ends),
            )
        };
    "curves-flat-and-steep"
        "a flat curve has infinite density, a steep one next to none: x/0 in the density, no interval to find"
        "curves drawn by hand: flat then steep, nearly steps, a late jump, the shortest and the longest"
        "unit directions, finite weights and densities, none negative; answers that are not are counted"
        "1/0 in the flat interval",
        "count" 0.0, |stage| {
            let mut questions = Vec::new();
            for which in 0..custom_curves().len() as u32 {
                let custom = [
                    (Lobe::Geometric, Curve::Custom, 0.0),
                    (Lobe::Geometric, Curve::Custom, -1.0),
                ];
                let asked = grid(&custom, &[0.001, 0.03, 0.5, 0.97, 1.0], &[0.0, 60.0, 89.99], &xi_ends());
                let length = crate::optics::curve::CUSTOM_LENGTH as u32;
                questions.extend(asked.into_iter().map(|question| LobeQuestion {
                    table: which * length,
                    ..question
                }));
            }
            count_broken(stage, &questions)
        };
    "anisotropy-at-its-ends"
        "the full stretch makes one width 19 times the other: squares of their ratio cancel in f32"
        "anisotropy −1, −0.999, 0.999 and 1, every lobe that stretches, R at its ends, five views"
        "unit directions, finite weights and densities, none negative; answers that are not are counted"
        "√((1 + 1)/(1 − 1)) is infinite",
        "count" 0.0, |stage| {
            let stretched: Vec<_> = shapes()
                .into_iter()
                .filter(|(lobe, _, anisotropy)| lobe.is_anisotropic() && *anisotropy == 0.0)
                .flat_map(|(lobe, curve, _)| [-1.0, -0.999, 0.999, 1.0].map(|stretch| (lobe, curve, stretch)))
                .collect();
            count_broken(
                stage,
                &grid(&stretched, &ROUGHNESS, &VIEW_ANGLES_DEG, &[ANY_XI, [0.0; 3]]),
            )
        };
    "mirror-direction-at-the-horizon"
        "r·n → 0: half of the lobe is below the surface, 1/cosθ is infinite"
        "views 0, 1e-20, 1e-7 and 1e-4 above the horizon, lit from there too; every lobe, R at its ends"
        "unit directions on the side they belong to, finite weights and densities; others are counted"
        "1/cosθ is inf at the horizon",
        "count" 0.0, |stage| {
            let mut questions = Vec::new();
            for height in [0.0, 1e-20, 1e-7, 1e-4_f32] {
                let level = |x: f32| vec3(x, 0.0, height).normalize();
                let asked = grid(&shapes(), &ROUGHNESS, &[90.0], &[ANY_XI, [0.99, 0.3, 0.99]]);
                questions.extend(asked.into_iter().flat_map(|question| {
                    [level(1.0), level(-1.0)].map(|wi| LobeQuestion {
                        wo: level(-1.0),
                        wi,
                        ..question
                    })
                }));
            }
            count_broken(stage, &questions)
        };
    "view-below-the-shading-normal"
        "a smooth mesh's normal leans away from the viewer: negative cosines, energy out of nothing"
        "interpolated normals 90° to 180° from the view, bent back as for images; every lobe, R at its ends"
        "unit directions above the true surface, finite weights and densities; others are counted"
        "cosine -0.41 of the view",
        "count" 0.0, |stage| {
            let wo = vec3(-0.995, 0.0, 0.1_f32).normalize();
            let mut questions = Vec::new();
            for lean_deg in [10.0, 30.0, 60.0, 89.0_f32] {
                let lean = lean_deg.to_radians();
                let shading = bent_normal(vec3(lean.sin(), 0.0, lean.cos()), wo);
                questions.extend(
                    grid(&shapes(), &ROUGHNESS, &[0.0], &xi_ends())
                        .into_iter()
                        .filter(|question| question.horizon != Horizon::None as u32)
                        .map(|question| LobeQuestion {
                            shading,
                            wo,
                            ..question
                        }),
                );
            }
            count_broken(stage, &questions)
        };
    "density-at-its-singular-places"
        "at r, at the silhouette and where n·ω, A, Δ or k vanish, the closed form is 0/0 or √ of less than 0"
        "directions at r and 1e-7 … 1e-3 beside it, on the silhouette (found by halving) and 3e-7 beside it, at \
               the horizon, along ±n and ±view; every lobe, curve and roughness"
        "finite values and densities, none negative; others are counted"
        "3 of 3 densities at r are not finite",
        "count" 0.0, |stage| {
            let mut questions = Vec::new();
            for question in grid(&shapes(), &ROUGHNESS, &[0.0, 45.0, 80.0, 89.99], &[ANY_XI]) {
                let directions = singular_directions(&question);
                questions.extend(directions.into_iter().map(|wi| LobeQuestion { wi, ..question }));
            }
            count_broken(stage, &questions)
        };
}

fn shape(lobe: Lobe, curve: Curve, roughness: f32, anisotropy: f32, horizon: Horizon) -> LobeShape<'static, f32> {
    LobeShape {
        lobe,
        curve,
        horizon,
        roughness,
        anisotropy,
        eta: 0.0,
        table: &[],
    }
}

/// Every shape × roughness × view × numbers × horizon policy, reflecting; and refracting with the mirror policy.
fn grid(
    shapes: &[(Lobe, Curve, f32)],
    roughness: &[f32],
    view_angles_deg: &[f32],
    numbers: &[[f32; 3]],
) -> Vec<LobeQuestion> {
    let up = vec3(0.0, 0.0, 1.0);
    let kinds = [
        (Horizon::Mirror, 0.0),
        (Horizon::Absorb, 0.0),
        (Horizon::None, 0.0),
        (Horizon::Mirror, 1.5),
        (Horizon::Mirror, 1.0 / 1.5),
    ];
    let mut questions = Vec::new();
    for &(lobe, curve, anisotropy) in shapes {
        for &roughness in roughness {
            for &angle_deg in view_angles_deg {
                let angle = f64::from(angle_deg).to_radians();
                let wo = Vec3::from_f64([-angle.sin(), 0.0, angle.cos()]);
                for (horizon, eta) in kinds {
                    let shape = LobeShape {
                        eta,
                        ..shape(lobe, curve, roughness, anisotropy, horizon)
                    };
                    questions.extend(numbers.iter().map(|&xi| LobeQuestion {
                        shading: up,
                        normal: up,
                        wo,
                        xi,
                        wi: wo.mirrored_about(up),
                        ..LobeQuestion::about(&shape, 0)
                    }));
                }
            }
        }
    }
    questions
}

fn xi_ends() -> Vec<[f32; 3]> {
    let pairs = XI_ENDS.into_iter().flat_map(|a| XI_ENDS.map(|b| [a, b]));
    pairs.flat_map(|[a, b]| XI_ENDS.map(|c| [a, b, c])).collect()
}

/// V = ±x and about, D = 0 and about.
fn degenerate_xi() -> impl Iterator<Item = [f32; 3]> {
    let distances = [0.0, 1.0 / 4_294_967_296.0, 0.5];
    let poles = [0.0, 1.0 / 4_294_967_296.0, 1.0 - 1.0 / 16_777_216.0, 1.0];
    poles.into_iter().flat_map(move |a| distances.map(|c| [a, 0.25, c]))
}

/// The last 64 numbers below 1 that can be drawn.
fn last_numbers() -> impl Iterator<Item = f32> {
    (1..=64).map(|step| 1.0 - step as f32 / 16_777_216.0)
}

/// Curves that are hard to draw from.
fn custom_curves() -> Vec<Vec<f32>> {
    let points: [&[[f32; 2]]; 6] = [
        &[[0.0, 0.0], [0.5, 0.0], [0.501, 1.0], [1.0, 1.0]],
        &[[0.0, 0.0], [0.001, 0.99], [1.0, 1.0]],
        &[[0.0, 0.0], [0.999, 0.01], [1.0, 20.0]],
        &[[0.0, 0.5], [0.5, 0.5], [1.0, 0.5]],
        &[
            [0.0, 0.0],
            [0.25, 0.1],
            [0.251, 0.4],
            [0.5, 0.4],
            [0.501, 0.9],
            [1.0, 0.9],
        ],
        &[[0.0, 0.0], [1.0, 0.01]],
    ];
    let table = |points: &[[f32; 2]]| CustomCurve::try_from(points.to_vec()).unwrap_or_default().table();
    points.into_iter().map(table).collect()
}

/// Counts invalid answers.
fn count_broken(stage: &Stage, questions: &[LobeQuestion]) -> Result<f64, StudyError> {
    let tables = custom_curves().concat();
    let scene = ProbeScene {
        tables: &tables,
        ..ProbeScene::default()
    };
    let answers = stage.prober.lobes(&scene, questions)?;
    let broken: Vec<_> = questions
        .iter()
        .zip(&answers)
        .filter(|(q, a)| is_broken(q, a))
        .collect();
    if let Some((question, answer)) = broken.first() {
        log::debug!("{} broken, first {question:?}: {answer:?}", broken.len());
    }
    Ok(broken.len() as f64)
}

fn is_broken(question: &LobeQuestion, answer: &LobeAnswer) -> bool {
    let is_unit = (answer.wi.length() - 1.0).abs() < LENGTH_ERROR;
    let numbers = [
        answer.weight,
        answer.drawn[0],
        answer.drawn[1],
        answer.given[0],
        answer.given[1],
    ];
    let are_sound = numbers.into_iter().all(|x| x.is_finite() && x >= 0.0);
    // A mirrored sample is above the surface; a refracting lobe's may be on either side.
    let height = question.normal.dot(answer.wi);
    let is_above = question.horizon != Horizon::Mirror as u32 || question.eta != 0.0 || height >= -1e-6;
    let is_kept = answer.weight > 0.0;
    !is_unit || !are_sound || (is_kept && !is_above)
}

/// Directions where a density may fail: its centre and silhouette with neighbours, horizon, normal and view.
fn singular_directions(question: &LobeQuestion) -> Vec<Vec3<f32>> {
    let tables = custom_curves();
    let shape = LobeShape {
        lobe: Lobe::ALL[question.lobe as usize],
        curve: Curve::ALL[question.curve as usize],
        horizon: Horizon::ALL[question.horizon as usize],
        roughness: f64::from(question.roughness),
        anisotropy: f64::from(question.anisotropy),
        eta: f64::from(question.eta),
        table: &tables[0],
    };
    let normal = Vec3::from_f64(question.normal.to_f64());
    let wo = Vec3::from_f64(question.wo.to_f64()).normalize();
    let frame = frame_from_normal(normal);
    let middle = lobe_middle(&shape, &frame, normal, wo).normalize();
    let around = frame_from_normal(middle);
    let mut directions = vec![middle, normal, -normal, wo, -wo, -middle];
    for i in 0..4 {
        let (sin, cos) = (f64::from(i) * std::f64::consts::FRAC_PI_2 + 0.1).sin_cos();
        let across = around.tangent * cos + around.bitangent * sin;
        let level = frame.tangent * cos + frame.bitangent * sin;
        let at = |angle_rad: f64| middle * angle_rad.cos() + across * angle_rad.sin();
        directions.extend([1e-7, 1e-6, 1e-4, 1e-3].map(at));
        directions.extend([-1e-7, -1e-20, 0.0, 1e-20, 1e-7, 0.001].map(|height| level + normal * height));
        let (mut inside, mut outside) = (0.0, std::f64::consts::PI);
        for _ in 0..40 {
            let half = 0.5 * (inside + outside);
            if lobe_evaluate(&shape, &frame, normal, wo, at(half))[1] > 0.0 {
                inside = half;
            } else {
                outside = half;
            }
        }
        directions.extend([-3e-7, -1e-7, 0.0, 1e-7, 3e-7].map(|by| at(inside + by)));
    }
    directions.into_iter().map(|v| Vec3::from_f32(v.to_f32())).collect()
}
