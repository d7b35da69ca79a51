//! Parameters of materials and settings of documents: what they take, as text, in files and by their keys.

use glossmith::{
    document::{
        Change, Conductor, Document, MaterialSettings, PARAMETERS, SETTINGS, Stage,
        parameter::{Kind, Parameter, Precision, Value, assign, parameter, parse_color},
    },
    render::EngineChoice,
    store::{PRESETS, preset},
};

use super::{renders::render, worker::small_document};

/// Values of a kind: both ends and something between, every choice.
fn values_of(kind: &Kind) -> Vec<Value> {
    match kind {
        Kind::Number {
            range: [low, high],
            precision,
            ..
        } => {
            let between = low + 0.317 * (high - low);
            let between = match precision {
                Precision::Single => f64::from(between as f32),
                Precision::Double => between,
                Precision::Whole => between.round(),
            };
            [*low, between, *high].map(Value::Number).to_vec()
        }
        Kind::Place { range: [low, high] } => vec![Value::Place([*low, *high, 0.1])],
        Kind::Optional { kind, .. } => values_of(kind).into_iter().chain([Value::Absent]).collect(),
        Kind::Color { most } => vec![Value::Color([0.0, *most, 0.123_456_7]), Value::Color([0.9; 3])],
        Kind::Triple { range: [low, high] } => {
            vec![Value::Triple([*low, *high, 0.765_432_1]), Value::Triple([*low; 3])]
        }
        Kind::Choice(choices) => choices.iter().map(|choice| Value::Choice(choice.name)).collect(),
        Kind::Toggle => vec![Value::Toggle(false), Value::Toggle(true)],
        Kind::Curve => vec![
            Value::Curve(vec![[0.0, 0.0], [1.0, 1.0]]),
            Value::Curve(vec![[0.0, 0.25], [0.333, 0.25], [0.9, 7.1], [1.0, 20.0]]),
        ],
    }
}

/// Values that a parameter takes.
pub(crate) fn valid_values<T>(parameter: &Parameter<T>) -> Vec<Value> {
    values_of(&parameter.kind)
}

/// Texts that a parameter refuses.
fn invalid_texts(kind: &Kind) -> Vec<String> {
    let texts: &[&str] = match kind {
        Kind::Number {
            precision: Precision::Whole,
            ..
        } => &["-1", "1.5", "4294967296", "many", ""],
        Kind::Number { range: [low, high], .. } => {
            let beyond = [low - 1.0, high * 2.0 + 1.0].map(|x| x.to_string()).into_iter();
            let odd = ["NaN", "inf", "1e99", "much", ""].map(str::to_owned);
            return beyond.chain(odd).collect();
        }
        Kind::Place { .. } => &["1", "1,2", "1,2,x", "1,2,3,4", "NaN,0,0", "1e10,0,0"],
        Kind::Optional { kind, .. } => return invalid_texts(kind),
        Kind::Color { most: 1.0 } => &[
            "#12345", "#+1+2+3", "#äöü", "1,1", "1,1,1,1", "-0.1,0,0", "1.1,0,0", "red", "NaN,0,0", "",
        ],
        Kind::Color { .. } => &["#12345", "1,1", "-0.1,0,0", "1e9,0,0", "red", "NaN,0,0", ""],
        Kind::Triple { .. } => &["1", "1,2", "1,2,x", "-1,0,0", "21,0,0", "inf,0,0"],
        Kind::Choice(_) => &["", "no such", "Geometric"],
        Kind::Toggle => &["", "1", "yes"],
        Kind::Curve => &[
            "",
            "0:0",
            "0:0,1",
            "0:0,0.5:2,1:1",
            "0.1:0,1:1",
            "0:0,1:21",
            "0:0,1:0",
            "0:0,0.5:0.5,0.5:0.6,1:1",
            "0:-1,1:1",
            "0:0,1:NaN",
        ],
    };
    texts.iter().map(|text| (*text).to_owned()).collect()
}

pub(crate) fn is_in_range(material: &MaterialSettings) -> bool {
    PARAMETERS
        .iter()
        .all(|parameter| parameter.check(&parameter.get(material)).is_ok())
}

#[test]
fn keys_are_unique_and_defaults_in_range() {
    let mut keys: Vec<_> = PARAMETERS.iter().map(|parameter| parameter.key).collect();
    keys.sort_unstable();
    let count = keys.len();
    keys.dedup();
    assert_eq!(keys.len(), count, "keys are unique");
    for parameter in PARAMETERS.iter() {
        assert_eq!(parameter.check(&parameter.default_value()), Ok(()), "{}", parameter.key);
        bar_lies_in_range(parameter);
    }
}

/// The bar of a row spans a part of what its number may be.
fn bar_lies_in_range<T>(parameter: &Parameter<T>) {
    let range = match &parameter.kind {
        Kind::Number { range, .. } => *range,
        _ => return,
    };
    if let Some(bar) = parameter.row.bar {
        let key = parameter.key;
        assert!(range[0] <= bar[0] && bar[0] < bar[1] && bar[1] <= range[1], "{key}");
        assert!(parameter.row.step > 0.0, "{key}");
    }
}

#[test]
fn every_value_survives_the_material_the_text_and_the_file() {
    for parameter in PARAMETERS.iter() {
        for value in valid_values(parameter) {
            let key = parameter.key;
            let mut material = MaterialSettings::default();
            parameter.set(&mut material, value.clone()).expect(key);
            assert_eq!(parameter.get(&material), value, "{key}");

            let mut from_text = MaterialSettings::default();
            assign(&mut from_text, &format!(" {key} = {} ", parameter.text(&value))).expect(key);
            assert_eq!(from_text, material, "{key}");

            let json = serde_json::from_str(&parameter.json_from_value(&value).to_string()).expect(key);
            assert_eq!(parameter.value_from_json(&json), Ok(value), "{key}");

            let text = preset::material_text(std::path::Path::new(""), &material);
            let loaded = preset::parse_material("x.json".as_ref(), text.as_bytes()).expect(key);
            assert_eq!((loaded.value, loaded.warnings), (material, vec![]), "{key}");
        }
    }
}

#[test]
fn what_a_parameter_does_not_take_leaves_the_material_alone() {
    for parameter in PARAMETERS.iter() {
        for text in invalid_texts(&parameter.kind) {
            let mut material = MaterialSettings::default();
            let error = assign(&mut material, &format!("{}={text}", parameter.key))
                .expect_err(&text)
                .to_string();
            assert!(
                error.starts_with(&format!("{} does not take ", parameter.key)),
                "{error}"
            );
            assert!(error.contains("; give ") || error.contains("; let "), "{error}");
            assert_eq!(material, MaterialSettings::default(), "{} = {text}", parameter.key);
        }
        for other in PARAMETERS.iter() {
            let value = other.default_value();
            if std::mem::discriminant(&value) != std::mem::discriminant(&parameter.default_value()) {
                assert!(
                    parameter.check(&value).is_err(),
                    "{} takes {}'s",
                    parameter.key,
                    other.key
                );
            }
        }
    }
}

#[test]
fn every_setting_is_set_by_its_key_checked_and_called_a_change_of_its_stage() {
    for setting in SETTINGS.iter() {
        let key = setting.key;
        assert!(
            !PARAMETERS.iter().any(|parameter| parameter.key == key),
            "{key} is a material's, too"
        );
        assert_eq!(setting.check(&setting.default_value()), Ok(()), "{key}");
        bar_lies_in_range(setting);
        for value in valid_values(setting) {
            let mut document = Document::default();
            document
                .assign(&format!("{key} = {}", setting.text(&value)))
                .expect(key);
            assert_eq!(setting.get(&document), value, "{key}");
            let json = serde_json::from_str(&setting.json_from_value(&value).to_string()).expect(key);
            assert_eq!(setting.value_from_json(&json), Ok(value.clone()), "{key}");
            let change = Change::between(&Document::default(), &document);
            assert_eq!(change.is_none(), value == setting.default_value(), "{key}");
            let restarts = !matches!(setting.stage, Stage::Display | Stage::Goal);
            assert!(change.is_none() || change.restarts() == restarts, "{key}");
            assert_eq!(document.check(), Ok(()), "{key}");
        }
        for text in invalid_texts(&setting.kind) {
            let mut document = Document::default();
            let error = document.assign(&format!("{key}={text}")).expect_err(&text).to_string();
            assert!(error.starts_with(&format!("{key} does not take ")), "{error}");
            assert_eq!(document, Document::default(), "{key} = {text}");
        }
    }
}

#[test]
fn errors_say_what_would_be_right() {
    let error = |assignment: &str| {
        assign(&mut MaterialSettings::default(), assignment)
            .expect_err(assignment)
            .to_string()
    };
    let expected = "specular.roughness does not take 1.5; give a number from 0 to 1";
    assert_eq!(error("specular.roughness=1.5"), expected);
    let expected = "specular.horizon does not take up; give one of mirror, absorb, none";
    assert_eq!(error("specular.horizon=up"), expected);
    let expected = "specular.rotation does not take 400; give a number from -360 to 360 °";
    assert_eq!(error("specular.rotation=400"), expected);
    assert!(error("specular.rougness=1").ends_with("did you mean specular.roughness?"));
    assert!(error("roughness=1").ends_with("did you mean specular.roughness?"));
    assert!(error("metalnes=1").ends_with("did you mean base.metalness?"));
    assert!(error("qqqqqqqq=1").contains("the parameters are base.weight, "));
    assert!(error("specular.roughness").contains("KEY=VALUE"));
    assert!(error(&format!("specular.lobe={}", "x".repeat(5000))).len() < 300);
    assert!(parameter("specular.roughness").is_ok() && parameter("specular.Roughness").is_err());
}

#[test]
fn hexadecimal_colours_are_srgb_and_triples_linear() {
    assert_eq!(parse_color("#ffffff"), Ok([1.0; 3]));
    assert_eq!(parse_color("0.5,0.25,1"), Ok([0.5, 0.25, 1.0]));
    let [r, g, b] = parse_color("#0A80FF").expect("a colour");
    // IEC 61966-2-1: 10/255 lies on the straight part, 128/255 decodes to 0.2158605.
    assert!((r - 10.0 / 255.0 / 12.92).abs() < 1e-7 && (g - 0.215_860_5).abs() < 1e-6 && b == 1.0);
}

#[test]
fn a_metal_brings_its_indices_and_indices_of_ones_own_are_custom() {
    let mut material = MaterialSettings::default();
    assign(&mut material, "specular.conductor=gold").expect("gold");
    assert_eq!(material.eta, [0.143, 0.375, 1.442]);
    assert_eq!(material.k, [3.983, 2.386, 1.603]);
    assign(&mut material, "specular.eta=0.143,0.375,1.442").expect("its own");
    assert_eq!(material.conductor.name(), "gold");
    assign(&mut material, "specular.k=1,2,3").expect("another");
    assert_eq!(
        (material.conductor, material.eta),
        (Conductor::Custom, [0.143, 0.375, 1.442])
    );
    let text = br#"{"glossmith": 1, "material": {"specular.k": [1, 2, 3], "specular.conductor": "gold"}}"#;
    let loaded = preset::parse_material("x.json".as_ref(), text).expect("valid").value;
    assert_eq!(
        loaded.k,
        [1.0, 2.0, 3.0],
        "the file's k wins over its metal's, in whatever order"
    );
    assert_eq!(loaded.conductor, Conductor::Custom);
}

/// What is shown grey changes nothing: the picture stays the same to the bit.
#[test]
fn what_is_idle_has_no_effect() {
    let mut document = small_document();
    document.materials[0] = PRESETS
        .iter()
        .find(|preset| preset.name == "Gold")
        .expect("it is shipped")
        .clone();
    let idle: Vec<&Parameter> = PARAMETERS
        .iter()
        .filter(|parameter| (parameter.idle)(&document.materials[0]).is_some())
        .collect();
    assert!(idle.iter().any(|parameter| parameter.key == "base.color"));
    let before = render(EngineChoice::Cpu, &document);
    for parameter in idle {
        for value in valid_values(parameter) {
            let mut changed = document.clone();
            parameter.set(&mut changed.materials[0], value).expect("it is valid");
            let after = render(EngineChoice::Cpu, &changed);
            assert!(after.colors().eq(before.colors()), "{}", parameter.key);
        }
    }
    assign(&mut document.materials[0], "specular.fresnel=schlick").expect("it is one");
    let color = parameter("base.color").expect("it is one");
    assert!((color.idle)(&document.materials[0]).is_none());
}
