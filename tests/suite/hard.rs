//! The catalogue of hard cases on both engines, its page of documentation, and that shipped scenes drop no sample.

use std::path::Path;

use glossmith::{
    render::EngineChoice,
    study::check::Check,
    study::hard::{HardOptions, Stage, catalogue, markdown, run},
};

/// Those that compare f32 with f64, which take most of the time, or the others.
fn assert_hold(engine: EngineChoice, against_f64: bool) {
    let mut stage = Stage::open(engine, false, Default::default()).expect("an engine: install mesa-vulkan-drivers");
    let cases = catalogue().filter(|case| case.name.starts_with("f32-against-f64") == against_f64);
    let rows: Vec<_> = cases.map(|case| case.run(&mut stage).unwrap()).collect();
    for row in &rows {
        println!("{:34} {:6.2} s  {:.2e}", row.case.name, row.seconds, row.check.value);
    }
    let failed: Vec<_> = rows
        .iter()
        .map(|row| &row.check)
        .filter(|check| !check.passed)
        .collect();
    assert!(failed.is_empty() && !rows.is_empty(), "{failed:#?}");
}

#[test]
fn hard_cases_hold_on_the_processor() {
    assert_hold(EngineChoice::Cpu, false);
}

#[test]
fn numbers_are_those_of_f64_on_the_processor() {
    assert_hold(EngineChoice::Cpu, true);
}

#[test]
fn hard_cases_hold_on_the_gpu() {
    assert_hold(EngineChoice::Gpu, false);
}

#[test]
fn numbers_are_those_of_f64_on_the_gpu() {
    assert_hold(EngineChoice::Gpu, true);
}

/// What does not depend on the machine stands in docs/STABILITY.md to the letter; UPDATE_DOCS=1 runs all cases
/// thoroughly and writes it anew.
#[test]
fn the_table_of_stability_is_the_programs_own() {
    const BEGIN: &str = "<!-- made from the program: hard cases -->\n\n";
    const END: &str = "<!-- end -->";
    let path = Path::new(crate::ROOT).join("docs/STABILITY.md");
    let text = std::fs::read_to_string(&path).unwrap();
    let (head, rest) = text.split_once(BEGIN).expect("a table");
    let (table, tail) = rest.split_once(END).expect("an end");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        let engines = [EngineChoice::Gpu, EngineChoice::Cpu].map(|engine| {
            let (thorough, only) = (false, String::new());
            run(&HardOptions { engine, thorough, only }, |_| {}).unwrap()
        });
        let table = markdown(&engines);
        std::fs::write(&path, format!("{head}{BEGIN}{table}{END}{tail}")).unwrap();
        return;
    }
    assert_eq!(
        table.lines().count(),
        2 + catalogue().count(),
        "run UPDATE_DOCS=1 cargo test hard"
    );
    for (line, case) in table.lines().skip(2).zip(catalogue()) {
        let fixed = format!(
            "| {}: {} | {} | {}: {} |",
            case.group, case.name, case.danger, case.made, case.must
        );
        assert!(line.starts_with(&fixed), "{line}: run UPDATE_DOCS=1 cargo test hard");
        let [_, limit] = Check::new(case.group, case.name, case.measure, 0.0, case.limit).texts();
        assert!(
            line.contains(&format!("| {} {limit} |", case.measure)),
            "{line}: the limit is {limit}"
        );
        assert!(!line.contains("**fails**"), "{line}");
    }
}
