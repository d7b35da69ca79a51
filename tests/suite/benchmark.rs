//! The benchmark: a quick run, its file against the schema, and two results side by side.

use glossmith::study::benchmark::compare::compare;
use glossmith::study::benchmark::report::{EngineReport, Report};
use serde_json::Value;

use super::cli_support::Workplace;

/// Where a value breaks a schema of the parts that docs/results/schema.json uses; empty where it does not.
fn breaches(value: &Value, schema: &Value, root: &Value, place: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut expect = |is_so: bool, what: String| {
        if !is_so {
            found.push(format!("{place}: {what}"));
        }
    };
    for (key, rule) in schema.as_object().unwrap() {
        match key.as_str() {
            "$schema" | "$defs" | "title" | "description" => {}
            "const" => expect(value == rule, format!("{value} is not {rule}")),
            "enum" => expect(
                rule.as_array().unwrap().contains(value),
                format!("{value} is none of {rule}"),
            ),
            "type" => {
                let is_of = |name: &str| match name {
                    "object" => value.is_object(),
                    "array" => value.is_array(),
                    "string" => value.is_string(),
                    "boolean" => value.is_boolean(),
                    "integer" => value.is_u64() || value.is_i64(),
                    "number" => value.is_number(),
                    "null" => value.is_null(),
                    name => panic!("no type {name}"),
                };
                let names = rule.as_array().cloned().unwrap_or_else(|| vec![rule.clone()]);
                expect(
                    names.iter().any(|name| is_of(name.as_str().unwrap())),
                    format!("{value} is no {rule}"),
                );
            }
            "required" => {
                for key in rule.as_array().unwrap() {
                    expect(value.get(key.as_str().unwrap()).is_some(), format!("lacks {key}"));
                }
            }
            "minItems" => expect(
                value.as_array().unwrap().len() as u64 >= rule.as_u64().unwrap(),
                "too few".to_owned(),
            ),
            "maxItems" => expect(
                value.as_array().unwrap().len() as u64 <= rule.as_u64().unwrap(),
                "too many".to_owned(),
            ),
            "additionalProperties" => {
                for key in value.as_object().unwrap().keys() {
                    expect(schema["properties"].get(key).is_some(), format!("has {key}"));
                }
            }
            "properties" | "items" | "$ref" | "anyOf" => {}
            key => panic!("the schema has {key}, which this test does not know"),
        }
    }
    if let Some(path) = schema["$ref"].as_str() {
        let of_root = root.pointer(path.trim_start_matches('#')).unwrap();
        found.extend(breaches(value, of_root, root, place));
    }
    if let Some(choices) = schema["anyOf"].as_array() {
        let fits = |choice: &Value| breaches(value, choice, root, place).is_empty();
        if !choices.iter().any(fits) {
            found.push(format!("{place}: fits none"));
        }
    }
    for (key, of_key) in schema["properties"].as_object().into_iter().flatten() {
        if let Some(value) = value.get(key) {
            found.extend(breaches(value, of_key, root, &format!("{place}/{key}")));
        }
    }
    if let (Some(values), Some(of_items)) = (value.as_array(), schema.get("items")) {
        for (number, value) in values.iter().enumerate() {
            found.extend(breaches(value, of_items, root, &format!("{place}/{number}")));
        }
    }
    found
}

fn schema() -> Value {
    serde_json::from_str(include_str!("../../docs/results/schema.json")).unwrap()
}

/// Each step is measured, or the report says why not.
fn has_all_steps(engine: &EngineReport) {
    let mut steps = vec!["samples", "rays", "to clean", "to clean, denoised"];
    if engine.engine == "gpu" {
        steps.push("ray queries");
    }
    for step in steps {
        let is_measured = engine.rows.iter().any(|row| row.step == step && row.value.median > 0.0);
        let is_explained = engine
            .left_out
            .iter()
            .any(|left| left.step == step && !left.why.is_empty());
        assert!(is_measured || is_explained, "{}: {step}: {engine:?}", engine.name());
    }
    for row in &engine.rows {
        let [low, high] = row.value.quartiles;
        assert!(low <= row.value.median && row.value.median <= high, "{row:?}");
    }
}

/// A run on both engines, its file, and the comparison with itself and with a slower machine.
#[test]
fn a_quick_run_measures_both_engines_and_can_be_compared() {
    let place = Workplace::new();
    let run = place.run("benchmark --quick --json a.json");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let text = place.read("a.json");
    let json: Value = serde_json::from_str(&text).unwrap();
    let schema = schema();
    assert_eq!(breaches(&json, &schema, &schema, ""), [""; 0]);
    let report = Report::read(&place.path("a.json")).unwrap();
    assert!(report.quick && report.machine.threads > 0 && !report.machine.instructions.is_empty());
    let kinds: Vec<_> = report.engines.iter().map(|engine| engine.engine.as_str()).collect();
    assert_eq!(kinds[..2], ["cpu", "gpu"]);
    for engine in &report.engines {
        has_all_steps(engine);
        assert!(run.stdout.contains(&engine.name()), "{}", run.stdout);
    }
    let itself = compare(&report, &report);
    assert!(itself.is_same_machine && itself.unmatched.is_empty(), "{itself:?}");
    assert!(itself.rows.iter().all(|row| row.verdict == "noise"), "{itself:?}");
    // Ten times as slow, with the same small spread.
    let mut slower = report.clone();
    slower.machine.cpu = "another".to_owned();
    for row in slower.engines.iter_mut().flat_map(|engine| &mut engine.rows) {
        let factor = if row.more_is_better { 0.01 } else { 100.0 };
        row.value.median *= factor;
        row.value.quartiles = [row.value.median; 2];
    }
    place.write("b.json", serde_json::to_string(&slower).unwrap().as_bytes());
    let run = place.run("benchmark --compare a.json b.json --json c.json");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert!(
        run.stdout.contains("another machine") && run.stdout.contains("worse"),
        "{}",
        run.stdout
    );
    let compared: Value = serde_json::from_str(&place.read("c.json")).unwrap();
    let rows = compared["rows"].as_array().unwrap();
    assert!(
        !rows.is_empty() && rows.iter().all(|row| row["verdict"] != "better"),
        "{compared}"
    );
    slower.engines.clear();
    place.write("b.json", serde_json::to_string(&slower).unwrap().as_bytes());
    place.refused(1, "benchmark --compare a.json b.json", &["in common"]);
}

#[test]
fn a_file_that_is_no_result_is_refused_in_a_line() {
    let place = Workplace::new();
    place.write("a.json", b"{\"schema\": \"another\"}");
    place.write(
        "b.json",
        b"{\"schema\": \"glossmith-benchmark\", \"schema_version\": 99}",
    );
    for (files, words) in [
        ("a.json a.json", "not a result of the benchmark"),
        ("b.json b.json", "its schema has version 99"),
        ("none.json b.json", "cannot be read"),
    ] {
        let run = place.run(&format!("benchmark --compare {files}"));
        assert_eq!((run.code, run.stderr.lines().count()), (Some(1), 1), "{}", run.stderr);
        assert!(run.stderr.contains(words), "{}", run.stderr);
    }
}
