//! Hard cases: situations where naive code fails, as data. Each states the failure, the set-up and the requirement.
//! `glossmith check --hard`, the editor and the tests run them.

/// The cases of a group, each by name, danger, how it is made, what must hold, the naive form, measure, limit, and what finds
/// the value; see [`HardCase`].
macro_rules! cases {
    ($group:literal $($name:literal $danger:literal $made:literal $must:literal $naive:literal, $measure:literal $limit:expr, $find:expr;)*) => {
        pub const CASES: &[$crate::study::hard::HardCase] = &[$($crate::study::hard::HardCase {
            name: $name,
            group: $group,
            danger: $danger,
            made: $made,
            must: $must,
            naive: $naive,
            measure: $measure,
            limit: $limit,
            find: $find,
        }),*];
    };
}

mod against_f64;
mod fresnel;
mod geometry;
mod glb;
mod light;
mod lobe;
mod meshes;
mod rays;
mod stage;
mod sums;

use std::{fmt::Write as _, sync::Arc, time::Instant};

use super::{StudyError, check::Check};
use crate::{job::film::Image, render::EngineChoice, render::EngineInfo};
pub use stage::Stage;

/// A situation where naive code fails.
#[derive(Clone, Copy)]
pub struct HardCase {
    /// Name on the command line and in tables.
    pub name: &'static str,
    /// `lobe`, `fresnel`, `geometry`, `light` or `sums`.
    pub group: &'static str,
    /// Failure of naive code.
    pub danger: &'static str,
    /// Set-up of the case.
    pub made: &'static str,
    pub must: &'static str,
    /// Result of the naive form, computed if cheap.
    pub naive: &'static str,
    /// Measure, as in [`Check::measure`].
    pub measure: &'static str,
    /// Limit of the measure.
    pub limit: f64,
    pub find: fn(&mut Stage) -> Result<f64, StudyError>,
}

/// Every case, group by group.
pub fn catalogue() -> impl Iterator<Item = &'static HardCase> {
    [
        lobe::CASES,
        against_f64::CASES,
        fresnel::CASES,
        geometry::CASES,
        light::CASES,
        sums::CASES,
    ]
    .into_iter()
    .flatten()
}

impl HardCase {
    /// Runs the case on an engine.
    pub fn run(&'static self, stage: &mut Stage) -> Result<HardRow, StudyError> {
        let begun = Instant::now();
        stage.check_stop()?;
        stage.picture = None;
        let value = (self.find)(stage)?;
        Ok(HardRow {
            case: self,
            check: Check::new(self.group, self.name, self.measure, value, self.limit),
            seconds: begun.elapsed().as_secs_f64(),
            picture: stage.picture.take(),
        })
    }
}

/// Result of a case.
#[derive(Clone)]
pub struct HardRow {
    /// The case that was run.
    pub case: &'static HardCase,
    pub check: Check,
    /// Time in seconds.
    pub seconds: f64,
    /// Rendered image, if any.
    pub picture: Option<Image>,
}

/// Options of a run.
#[derive(Clone, Debug)]
pub struct HardOptions {
    /// The engine to check.
    pub engine: EngineChoice,
    /// A million pairs a lobe and ten million samples, not a part of them.
    pub thorough: bool,
    /// Only cases whose names contain this.
    pub only: String,
}

/// Runs all cases; `progress` receives each case's name before it starts.
pub fn run(options: &HardOptions, progress: impl Fn(&str)) -> Result<(EngineInfo, Vec<HardRow>), StudyError> {
    let mut stage = Stage::open(options.engine, options.thorough, Arc::default())?;
    let mut rows = Vec::new();
    for case in catalogue().filter(|case| case.name.contains(&options.only)) {
        progress(case.name);
        rows.push(case.run(&mut stage)?);
    }
    Ok((stage.engine().clone(), rows))
}

/// The rows of several engines as a table in Markdown, engines side by side. All have the same cases.
pub fn markdown(engines: &[(EngineInfo, Vec<HardRow>)]) -> String {
    let mut text =
        String::from("| case | what goes wrong in naive code | how it is made, what must hold | naive | limit |");
    for (engine, _) in engines {
        let _ = write!(text, " {engine} |");
    }
    text.push_str("\n| --- | --- | --- | --- | --- |");
    text.push_str(&" --- |".repeat(engines.len()));
    text.push('\n');
    let Some((_, first)) = engines.first() else {
        return text;
    };
    for (index, row) in first.iter().enumerate() {
        let case = row.case;
        let [_, limit] = row.check.texts();
        let _ = write!(
            text,
            "| {}: {} | {} | {}: {} | {} | {} {limit} |",
            case.group, case.name, case.danger, case.made, case.must, case.naive, case.measure
        );
        for check in engines
            .iter()
            .filter_map(|(_, rows)| rows.get(index))
            .map(|row| &row.check)
        {
            let verdict = if check.passed { "" } else { "**fails** " };
            let _ = write!(text, " {verdict}{} |", check.texts()[0]);
        }
        text.push('\n');
    }
    text
}
