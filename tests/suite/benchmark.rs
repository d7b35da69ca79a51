//! The benchmark: a quick run, its file against the schema, and two results side by side.

use glossmith::study::benchmark::{compare::compare, report::EngineReport, report::Report};
use serde_json::Value;

use super::cli_support::Workplace;

/// Whether a value is one of a schema, of the parts that docs/results/schema.json uses.
fn fits(value: &Value, schema: &Value, root: &Value) -> bool {
    if let Some(path) = schema["$ref"].as_str() {
        return fits(value, root.pointer(path.trim_start_matches('#')).unwrap(), root);
    }
    let is_of = |name: &Value| match name.as_str().unwrap() {
        "integer" => value.is_u64() || value.is_i64(),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "array" => value.is_array(),
        name => name == "object" && value.is_object(),
    };
    schema
        .as_object()
        .unwrap()
        .iter()
        .all(|(key, rule)| match key.as_str() {
            "const" => value == rule,
            "enum" => rule.as_array().unwrap().contains(value),
            "type" => rule
                .as_array()
                .map_or_else(|| is_of(rule), |names| names.iter().any(is_of)),
            "required" => rule
                .as_array()
                .unwrap()
                .iter()
                .all(|key| value.get(key.as_str().unwrap()).is_some()),
            "additionalProperties" => value
                .as_object()
                .unwrap()
                .keys()
                .all(|key| !schema["properties"][key].is_null()),
            "properties" => rule.as_object().unwrap().iter().all(|(key, rule)| {
                let of_key = value.get(key);
                let is_right = of_key.is_none_or(|value| fits(value, rule, root));
                assert!(is_right, "{key}: {of_key:?} is not {rule}");
                true
            }),
            "items" => value.as_array().unwrap().iter().all(|value| fits(value, rule, root)),
            "anyOf" => rule.as_array().unwrap().iter().any(|rule| fits(value, rule, root)),
            "minItems" => value.as_array().unwrap().len() as u64 >= rule.as_u64().unwrap(),
            "maxItems" => value.as_array().unwrap().len() as u64 <= rule.as_u64().unwrap(),
            "$schema" | "$defs" | "title" | "description" => true,
            key => panic!("the schema has {key}, which this test does not know"),
        })
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
    let run = place.run("benchmark --quick --seconds 6 --json a.json");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let text = place.read("a.json");
    let json: Value = serde_json::from_str(&text).unwrap();
    let schema = schema();
    assert!(fits(&json, &schema, &schema), "{text}");
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
    place.write("b.json", serde_json::to_string(&slower).unwrap());
    let run = place.run("benchmark --compare a.json b.json --json c.json");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert!(
        run.stdout.contains("another machine") && run.stdout.contains("worse"),
        "{}",
        run.stdout
    );
    let compared: Value = place.json("c.json");
    let rows = compared["rows"].as_array().unwrap();
    assert!(
        !rows.is_empty() && rows.iter().all(|row| row["verdict"] != "better"),
        "{compared}"
    );
    slower.engines.clear();
    place.write("b.json", serde_json::to_string(&slower).unwrap());
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
