//! Documents: differences, history, compilation.

use glossmith::{
    compile::compile,
    document::{
        AreaLight, Change, Document, MaterialSettings, PARAMETERS,
        custom_curve::CustomCurve,
        history::History,
        turntable::{Turn, turned},
    },
    optics::{
        albedo::{ALBEDO_LENGTH, ROUGH_ALBEDO_LENGTH},
        curve::{CUSTOM_LENGTH, Curve, curve_distance},
        lobe::Lobe,
    },
    scene::{ModelSource, environment::EnvironmentSource},
};

use proptest::prelude::{Just, ProptestConfig, prop, prop_assert, prop_assert_eq, prop_oneof, proptest};

use crate::parameters::valid_values;

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
    let (materials, geometry) = (
        Change {
            materials: true,
            ..none
        },
        Change { geometry: true, ..none },
    );
    // Settings: see parameters.rs.
    type Edit = fn(&mut Document);
    let edits: [(Edit, Change); 8] = [
        (|_| {}, none),
        (|d| d.materials[0].name = "x".into(), none),
        (
            |d| d.lighting.environment = EnvironmentSource::Sky,
            Change {
                environment: true,
                ..none
            },
        ),
        (
            |d| d.lighting.area_lights.push(AreaLight::default()),
            Change {
                materials: true,
                ..geometry
            },
        ),
        (|d| d.lighting.ground_color = [1.0; 3], materials),
        (|d| d.materials.push(MaterialSettings::default()), materials),
        (|d| d.model = ModelSource::Sphere, geometry),
        // Said outright, though without a noise to reach it is so anyway.
        (|d| d.render.adaptive = Some(false), Change { target: true, ..none }),
    ];
    for (number, (edit, expected)) in edits.into_iter().enumerate() {
        assert_eq!(change(edit), expected, "{number}");
    }
    for parameter in PARAMETERS.iter() {
        let other = valid_values(parameter)
            .into_iter()
            .find(|value| *value != parameter.default_value());
        let mut new = old.clone();
        parameter
            .set(&mut new.materials[0], other.expect("two values"))
            .expect("valid");
        assert_eq!(Change::between(&old, &new), materials, "{}", parameter.key);
    }
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
    near!(back.camera.yaw_deg, document.camera.yaw_deg, 1e-9);
    near!(back.lighting.rotation_deg, document.lighting.rotation_deg, 0.0001);
    let yaws = [&back, &document].map(|document| document.lighting.area_lights[0].yaw_deg);
    near!(yaws[0], yaws[1], 1e-9);
}
