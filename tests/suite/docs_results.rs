//! The table of machines in docs/results.

use std::path::PathBuf;

use glossmith::study::benchmark::report::{EngineReport, Report, number};

use super::{docs::root, docs_tables::table};

/// A row for each engine of each result in `docs/results`.
pub fn table_of_results() -> String {
    let folder = root().join("docs/results");
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.retain(|path| path.extension().is_some_and(|ending| ending == "json") && !path.ends_with("schema.json"));
    files.sort();
    let of_file = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let report = Report::read(path).unwrap_or_else(|error| panic!("{error}"));
        let rows = report.engines.iter().map(|engine| result_row(&name, &report, engine));
        rows.collect::<Vec<_>>()
    };
    table(
        &[
            "file",
            "engine",
            "version",
            "M samples/s",
            "M rays/s",
            "clean, s",
            "denoised, s",
        ],
        files.iter().flat_map(of_file),
    )
}

fn result_row(file: &str, report: &Report, engine: &EngineReport) -> Vec<String> {
    let value = |step: &str, case: &str| {
        let row = engine.row(step, case);
        row.map_or_else(|| "–".to_owned(), |row| number(row.value.median))
    };
    let name = match engine.engine.as_str() {
        "cpu" => format!(
            "{}, {} threads, {}",
            engine.adapter, report.machine.threads, report.machine.instructions
        ),
        _ => format!("{}, {}", engine.adapter, engine.driver),
    };
    vec![
        format!("[{file}]({file})"),
        name,
        match report.build.as_str() {
            "release" => report.version.clone(),
            build => format!("{}, {build} build", report.version),
        },
        value("samples", "default"),
        value("rays", "default"),
        value("to clean", "default"),
        value("to clean, denoised", "default"),
    ]
}
