//! Documents: differences, history, compilation.

use glossmith::compile::compile;
use glossmith::document::custom_curve::CustomCurve;
use glossmith::document::history::History;
use glossmith::document::import::{geometric_from_ggx, ggx_from_geometric};
use glossmith::document::turntable::{Turn, turned};
use glossmith::document::{
    AreaLight, Background, Change, Document, ImportLobe, MaterialSettings, PARAMETERS, PixelFilter, Strategy,
};
use glossmith::optics::albedo::{ALBEDO_LENGTH, ROUGH_ALBEDO_LENGTH};
use glossmith::optics::curve::{CUSTOM_LENGTH, Curve, curve_distance, custom_table};
use glossmith::optics::lobe::Lobe;
use glossmith::optics::random::Sequence;
use glossmith::optics::tone::ToneCurve;
use glossmith::scene::environment::EnvironmentSource;
use glossmith::scene::{ModelSource, Slot};

use proptest::prelude::{Just, ProptestConfig, prop, prop_assert, prop_assert_eq, prop_oneof, proptest};

use crate::parameters::{is_in_range, valid_values};

#[test]
fn slots_of_a_model_become_materials_in_range() {
    let mut slot = Slot::neutral("lamp").with(&[("specular.ior", 9.0), ("specular.roughness", 0.4)]);
    slot.set_color("emission.color", [10.0, 5.0, 0.0]);
    let material = MaterialSettings::from_slot(&slot, ImportLobe::Ggx);
    assert!(is_in_range(&material));
    assert_eq!(
        (material.emission_color, material.emission_strength),
        ([1.0, 0.5, 0.0], 10.0)
    );
    assert_eq!(
        (material.name.as_str(), material.roughness, material.lobe),
        ("lamp", 0.4, Lobe::Ggx)
    );
    let material = MaterialSettings::from_slot(&slot, ImportLobe::Geometric);
    assert!(is_in_range(&material) && material.lobe == Lobe::Geometric);
    assert_eq!(material.roughness, geometric_from_ggx(0.4));
}

/// The table of the mathematics, section 5, the other way round: nearest lobes for α of GGX. Rough ones are hard to tell
/// apart.
#[test]
fn roughness_is_matched_to_the_look_of_ggx() {
    for (alpha, expected) in [(0.02, 0.1), (0.072, 0.3), (0.145, 0.5), (0.245, 0.7), (0.378, 0.9)] {
        let found = geometric_from_ggx(f32::sqrt(alpha));
        println!("{alpha} {found} {expected}");
        assert!(
            (found - expected).abs() < 0.055,
            "alpha {alpha}: {found}, expected {expected}"
        );
        assert!((ggx_from_geometric(found) - f32::sqrt(alpha)).abs() < 1e-5);
    }
    assert_eq!((geometric_from_ggx(0.0), ggx_from_geometric(0.0)), (0.0, 0.0));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn custom_curves_are_monotone_and_their_tables_sample_them(
        steps in prop::collection::vec((0.01_f32..1.0, prop_oneof![Just(0.0_f32), 0.0_f32..1.0]), 1..12),
        start in prop_oneof![Just(0.0_f32), 0.0_f32..0.5],
    ) {
        let total: f32 = steps.iter().map(|(step, _)| step).sum();
        let mut points = vec![[0.0, start]];
        let (mut xi, mut distance) = (0.0, start);
        for (step, rise) in &steps {
            xi += step / total;
            distance += rise;
            points.push([xi, distance]);
        }
        let end = distance + 0.01;
        let last = points.len() - 1;
        points[last] = [1.0, end];
        let curve = CustomCurve::try_from(points.clone()).expect("a valid curve");
        let table = curve.table();
        prop_assert_eq!(table.len(), CUSTOM_LENGTH);
        prop_assert!(table.iter().all(|x| x.is_finite() && *x >= 0.0));
        let end = f64::from(end);
        let mut before = 0.0;
        for i in 0..=1000 {
            let exact = curve.distance(f64::from(i) / 1000.0);
            prop_assert!(exact >= before - 1e-9 && exact <= end + 1e-9, "{} after {}", exact, before);
            before = exact;
        }
        for [xi, distance] in points {
            prop_assert!((curve.distance(f64::from(xi)) - f64::from(distance)).abs() < 1e-6);
        }
        // The table moves a sample by little more than a cell.
        for i in 0..200 {
            let xi = (f64::from(i) + 0.5) / 200.0;
            let drawn: f64 = curve_distance(Curve::Custom, &table, xi);
            prop_assert!((drawn - curve.distance(xi)).abs() < 1.5 * end / 64.0, "{}: {}", xi, drawn);
        }
    }
}

#[test]
fn a_curve_drawn_like_a_named_one_samples_like_it() {
    let straight = CustomCurve::try_from(vec![[0.0, 0.0], [1.0, 1.0]])
        .expect("valid")
        .table();
    // Uniform: density 1 at every node.
    let exact = custom_table(1.0, &[1.0; 65]).expect("positive");
    for (a, b) in straight.iter().zip(exact) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
    let points = (0..=32)
        .map(|i| i as f32 / 32.0)
        .map(|xi| [xi, xi.sqrt()])
        .collect::<Vec<_>>();
    let drawn = CustomCurve::try_from(points).expect("valid").table();
    for i in 10..100 {
        let xi = f64::from(i) / 100.0;
        let (a, b): (f64, f64) = (curve_distance(Curve::Custom, &drawn, xi), xi.sqrt());
        assert!((a - b).abs() < 2e-3, "{xi}: {a} {b}");
    }
}

#[test]
fn albedo_tables_follow_what_they_depend_on() {
    for (metalness, length) in [(0.0, ALBEDO_LENGTH), (0.25, ROUGH_ALBEDO_LENGTH)] {
        let material = MaterialSettings {
            metalness,
            ..MaterialSettings::default()
        };
        let table = |edit: fn(&mut MaterialSettings)| {
            let mut edited = material.clone();
            edit(&mut edited);
            compile(&[edited]).1
        };
        let plain = table(|_| {});
        assert_eq!(plain.len(), length);
        assert_eq!(plain, table(|m| m.emission_strength = 1.0));
        assert_eq!(plain, table(|m| m.rotation_deg = 30.0));
        assert_eq!(plain, table(|m| m.base_color = [0.9, 0.1, 0.1]));
        // What is metal in part has a table over all roughnesses, of which only values are taken.
        assert_eq!(plain == table(|m| m.roughness = 0.8), metalness > 0.0);
        assert_ne!(plain, table(|m| m.ior = 2.0));
        assert_ne!(plain, table(|m| m.lobe = Lobe::Ggx));
    }
}

#[test]
fn a_render_region_has_an_inside() {
    let mut document = Document::default();
    for (region, is_right) in [
        ([0.2, 0.1, 0.3, 0.9], true),
        ([0.3, 0.1, 0.3, 0.9], false),
        ([0.2, 0.9, 0.3, 0.1], false),
        ([0.2, 0.1, 1.5, 0.9], false),
    ] {
        document.render.region = Some(region);
        assert_eq!(document.check().is_ok(), is_right, "{region:?}");
    }
}

#[test]
fn every_edit_is_the_change_that_it_is() {
    let old = Document::default();
    let change = |edit: fn(&mut Document)| {
        let mut new = old.clone();
        edit(&mut new);
        Change::between(&old, &new)
    };
    let none = Change::default();
    assert_eq!(change(|_| {}), none);
    assert_eq!(change(|d| d.materials[0].name = "x".into()), none);
    assert_eq!(change(|d| d.view.exposure_ev = 1.0), Change { display: true, ..none });
    assert_eq!(
        change(|d| d.view.tone_map = ToneCurve::None),
        Change { display: true, ..none }
    );
    assert_eq!(change(|d| d.camera.yaw_deg = 1.0), Change { camera: true, ..none });
    assert_eq!(change(|d| d.render.width = 1), Change { size: true, ..none });
    assert_eq!(
        change(|d| d.lighting.environment = EnvironmentSource::Sky),
        Change {
            environment: true,
            ..none
        }
    );
    assert_eq!(
        change(|d| d.lighting.rotation_deg = 1.0),
        Change { lighting: true, ..none }
    );
    assert_eq!(change(|d| d.lighting.strength = 2.0), Change { lighting: true, ..none });
    assert_eq!(
        change(|d| d.lighting.background = Background::Transparent),
        Change { lighting: true, ..none }
    );
    assert_eq!(
        change(|d| d.lighting.area_lights.push(AreaLight::default())),
        Change {
            materials: true,
            geometry: true,
            ..none
        }
    );
    assert_eq!(
        change(|d| d.lighting.ground_color = [1.0; 3]),
        Change {
            materials: true,
            ..none
        }
    );
    assert_eq!(
        change(|d| d.materials.push(MaterialSettings::default())),
        Change {
            materials: true,
            ..none
        }
    );
    assert_eq!(
        change(|d| d.model = ModelSource::Sphere),
        Change { geometry: true, ..none }
    );
    assert_eq!(change(|d| d.ground = true), Change { geometry: true, ..none });
    assert_eq!(change(|d| d.render.samples = 1), Change { target: true, ..none });
    assert_eq!(change(|d| d.render.time_s = Some(1.0)), Change { target: true, ..none });
    assert_eq!(change(|d| d.render.noise = Some(0.1)), Change { target: true, ..none });
    assert_eq!(change(|d| d.render.min_samples = 64), Change { target: true, ..none });
    assert_eq!(
        change(|d| d.render.adaptive = Some(true)),
        Change { target: true, ..none }
    );
    // Said outright, though without a noise to reach it is so anyway.
    assert_eq!(
        change(|d| d.render.adaptive = Some(false)),
        Change { target: true, ..none }
    );
    let sampling = Change { sampling: true, ..none };
    assert_eq!(change(|d| d.render.bounces = 1), sampling);
    assert_eq!(change(|d| d.render.seed = 1), sampling);
    assert_eq!(change(|d| d.render.strategy = Strategy::Lobe), sampling);
    assert_eq!(change(|d| d.render.filter = PixelFilter::Box), sampling);
    assert_eq!(change(|d| d.render.sequence = Sequence::Independent), sampling);
    for parameter in PARAMETERS.iter() {
        let other = valid_values(parameter)
            .into_iter()
            .find(|value| *value != parameter.default_value());
        let mut new = old.clone();
        parameter
            .set(&mut new.materials[0], other.expect("two values"))
            .expect("valid");
        assert_eq!(
            Change::between(&old, &new),
            Change {
                materials: true,
                ..none
            },
            "{}",
            parameter.key
        );
    }
}

#[test]
fn changes_say_what_follows() {
    let (none, all) = (Change::default(), Change::everything());
    assert!(none.is_none() && !none.restarts());
    assert!(all.restarts() && all.geometry && all.environment && all.materials);
    let display = Change { display: true, ..none };
    assert!(!display.restarts() && display.display);
    let target = Change { target: true, ..none };
    assert!(!target.restarts() && !target.is_none());
    let geometry = Change { geometry: true, ..none };
    assert!(geometry.restarts() && geometry.geometry);
    assert!(!geometry.environment);
    let camera = Change { camera: true, ..none };
    assert!(camera.restarts() && !camera.geometry && !camera.materials);
}

#[test]
fn a_drag_is_one_step_of_the_history() {
    let mut history = History::new(0, 100);
    assert!(history.undo().is_none() && history.redo().is_none() && history.undo_label().is_none());
    for value in 1..=9 {
        history.push("Roughness", Some("roughness".into()), &value);
    }
    history.seal();
    history.push("Roughness", Some("roughness".into()), &20);
    history.push("Metalness", Some("metalness".into()), &30);
    history.push("Preset", None, &40);
    history.push("Preset", None, &50);
    history.push("Nothing", None, &50);
    assert_eq!(history.undo_label(), Some("Preset"));
    let undone: Vec<_> = std::iter::from_fn(|| history.undo().copied()).collect();
    assert_eq!(undone, [40, 30, 20, 9, 0]);
    assert_eq!(history.redo_label(), Some("Roughness"));
    assert_eq!(history.redo(), Some(&9));
    assert_eq!((history.undo_label(), history.current()), (Some("Roughness"), &9));
    // The same key after an undo or redo is a new step, and what was undone is gone.
    history.push("Roughness", Some("roughness".into()), &10);
    assert_eq!(history.redo(), None);
    assert_eq!(history.undo(), Some(&9));
}

#[test]
fn a_drag_back_to_where_it_began_is_no_step() {
    let mut history = History::new(5, 100);
    for value in [6, 7, 5] {
        history.push("Roughness", Some("r".into()), &value);
    }
    assert_eq!(history.undo(), None);
    assert_eq!(history.current(), &5);
    assert!(history.is_saved());
}

#[test]
fn a_history_has_a_limit_and_knows_what_is_saved() {
    let mut history = History::new(0, 3);
    for value in 1..=10 {
        history.push("Edit", None, &value);
    }
    let undone: Vec<_> = std::iter::from_fn(|| history.undo().copied()).collect();
    assert_eq!(undone, [9, 8, 7]);
    assert!(!history.is_saved(), "the saved value has dropped out");
    history.mark_saved();
    assert!(history.is_saved());
    assert!(history.redo().is_some() && !history.is_saved());
    assert!(history.undo().is_some() && history.is_saved());
    history.push("Drag", Some("k".into()), &70);
    history.mark_saved();
    history.push("Drag", Some("k".into()), &71);
    assert!(!history.is_saved(), "a drag that goes on after saving is an edit");
    assert_eq!(history.undo(), Some(&70));
    assert!(history.is_saved());
}

#[test]
fn frames_turn_by_equal_angles_from_the_document_itself() {
    let mut document = Document::default();
    document.camera.yaw_deg = 170.0;
    for turn in Turn::ALL {
        assert_eq!(turned(&document, *turn, 0, 8, [0.0; 3]), document);
    }
    let quarter = turned(&document, Turn::Camera, 2, 8, [0.0; 3]);
    assert_eq!((quarter.camera.yaw_deg, quarter.lighting.rotation_deg), (-100.0, 0.0));
}

#[test]
fn places_turn_with_the_yaw() {
    // Yaw 0 is +Z, and the yaw goes towards +X.
    let mut document = Document::default();
    document.camera.position = Some([1.0, 2.0, 8.0]);
    let quarter = turned(&document, Turn::Camera, 1, 4, [1.0, 0.0, 3.0]);
    let place = quarter.camera.position.expect("it had one");
    let expected = [6.0, 2.0, 3.0];
    assert!(
        std::iter::zip(place, expected).all(|(a, b)| (a - b).abs() < 1e-12),
        "{place:?}"
    );
}

#[test]
fn turning_the_model_is_turning_all_else_back() {
    let mut document = Document::default();
    document.lighting.area_lights.push(AreaLight::default());
    let both = turned(
        &turned(&document, Turn::Model, 1, 6, [0.0; 3]),
        Turn::Camera,
        1,
        6,
        [0.0; 3],
    );
    let back = turned(&both, Turn::Light, 1, 6, [0.0; 3]);
    assert!((back.camera.yaw_deg - document.camera.yaw_deg).abs() < 1e-9);
    assert!((back.lighting.rotation_deg - document.lighting.rotation_deg).abs() < 1e-4);
    let yaws = [&back, &document].map(|document| document.lighting.area_lights[0].yaw_deg);
    assert!((yaws[0] - yaws[1]).abs() < 1e-9);
}
