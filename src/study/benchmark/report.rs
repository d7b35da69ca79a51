//! The benchmark's result: one schema for files, tables and comparisons.

use std::{fmt::Write as _, io, path::Path, path::PathBuf};

use serde::{Deserialize, Serialize};

use crate::study::quantile;

/// Name of the schema, in the key `schema`.
pub const SCHEMA: &str = "glossmith-benchmark";
/// Version of the schema, in the key `schema_version`. It grows if a key changes its meaning or disappears. Version 1 had
/// `pace` and `proofs` besides.
pub const SCHEMA_VERSION: u32 = 2;

/// Why a report cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The system cannot read the file.
    #[error("{0}: cannot be read: {1}; check the path and its permissions")]
    Read(PathBuf, io::Error),
    /// Something else than a report, or one of another version.
    #[error("{0}: {1}; make one with glossmith benchmark --json")]
    Invalid(PathBuf, String),
}

/// Result of a benchmark.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: String,
    /// [`SCHEMA_VERSION`].
    pub schema_version: u32,
    /// The program's version.
    pub version: String,
    /// `release`, or `debug` for a build whose numbers mean little.
    pub build: String,
    /// Small images and few scenes, to see that the benchmark works.
    pub quick: bool,
    /// Time of the whole run, in seconds.
    pub seconds: f64,
    /// The machine.
    pub machine: Machine,
    /// Denoiser with version and device; `None` without one.
    pub denoiser: Option<String>,
    /// Peak memory of the process in MiB, if the system reports it.
    pub peak_memory_mib: Option<f64>,
    /// Engines in the order of measurement.
    pub engines: Vec<EngineReport>,
}

/// The machine of a report.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Name of the CPU.
    pub cpu: String,
    /// Rendering threads.
    pub threads: usize,
    /// Memory in MiB.
    pub memory_mib: u64,
    /// Operating system with version.
    pub system: String,
    /// Instruction set of the CPU engine.
    pub instructions: String,
}

/// Measurements on one engine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EngineReport {
    /// `cpu` or `gpu`.
    pub engine: String,
    /// Name of the adapter or CPU.
    pub adapter: String,
    /// Graphics interface, such as `vulkan`; empty for the CPU.
    pub backend: String,
    /// Driver with version; empty for the CPU.
    pub driver: String,
    /// True if the CPU does the work.
    pub is_software: bool,
    /// Measurements.
    pub rows: Vec<Row>,
    /// What was not measured, and why.
    pub left_out: Vec<LeftOut>,
}

/// A measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Step of the benchmark, such as `rate`.
    pub step: String,
    /// Scene or variant.
    pub case: String,
    /// Unit of the value.
    pub unit: String,
    /// True if a larger value is better.
    pub more_is_better: bool,
    /// The value with its spread.
    pub value: Spread,
}

/// Median and quartiles of repeated measurements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// First and third quartile.
    pub quartiles: [f64; 2],
    /// Number of measurements.
    pub turns: usize,
}

/// A measurement that was not made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeftOut {
    /// Step of the benchmark.
    pub step: String,
    /// Scene or variant; empty for the whole step.
    pub case: String,
    /// Reason.
    pub why: String,
}

impl Spread {
    /// Median and quartiles; `None` without values.
    pub fn of(values: &[f64]) -> Option<Self> {
        (!values.is_empty()).then(|| Self {
            median: quantile(values, 0.5),
            quartiles: [0.25, 0.75].map(|share| quantile(values, share)),
            turns: values.len(),
        })
    }
}

impl EngineReport {
    /// Name of the engine, as in `cpu on NAME`.
    pub fn name(&self) -> String {
        format!("{} on {}", self.engine, self.adapter)
    }

    /// A measurement by step and case.
    pub fn row(&self, step: &str, case: &str) -> Option<&Row> {
        self.rows.iter().find(|row| row.step == step && row.case == case)
    }

    /// Adds a measurement, or that there is none.
    pub(super) fn add(&mut self, step: &str, case: &str, (unit, more_is_better): (&str, bool), values: &[f64]) {
        match Spread::of(values) {
            Some(value) => self.rows.push(Row {
                step: step.to_owned(),
                case: case.to_owned(),
                unit: unit.to_owned(),
                more_is_better,
                value,
            }),
            None => self.leave_out(step, case, "the time was over before it was its turn"),
        }
    }

    /// Notes what is not measured. The first reason for it is kept.
    pub(super) fn leave_out(&mut self, step: &str, case: &str, why: impl Into<String>) {
        if self.left_out.iter().any(|left| left.step == step && left.case == case) {
            return;
        }
        self.left_out.push(LeftOut {
            step: step.to_owned(),
            case: case.to_owned(),
            why: why.into(),
        });
    }
}

impl Report {
    /// Reads a report from a file.
    ///
    /// # Errors
    /// A file that cannot be read, is no report, or has another version of the schema.
    pub fn read(path: &Path) -> Result<Self, ReportError> {
        let invalid = |reason: String| ReportError::Invalid(path.to_owned(), reason);
        let text = std::fs::read_to_string(path).map_err(|source| ReportError::Read(path.to_owned(), source))?;
        let parsed: serde_json::Value = serde_json::from_str(&text).map_err(|error| invalid(error.to_string()))?;
        if parsed["schema"] != SCHEMA {
            return Err(invalid("not a result of the benchmark".to_owned()));
        }
        let version = &parsed["schema_version"];
        if !(1..=SCHEMA_VERSION).any(|known| *version == known) {
            let reason = format!("its schema has version {version}, this program reads up to {SCHEMA_VERSION}");
            return Err(invalid(reason));
        }
        serde_json::from_value(parsed).map_err(|error| invalid(error.to_string()))
    }

    /// The report as text for a terminal.
    pub fn text(&self) -> String {
        let Machine {
            cpu,
            threads,
            memory_mib,
            system,
            instructions,
        } = &self.machine;
        let mut text = format!(
            "Glossmith {} ({}), {cpu}, {threads} threads, {instructions}, {memory_mib} MiB, {system}; {:.0} s\n",
            self.version, self.build, self.seconds
        );
        for engine in &self.engines {
            let _ = writeln!(text, "\n{} {}", engine.name(), engine.driver);
            for row in &engine.rows {
                let Row { step, case, unit, .. } = row;
                let _ = writeln!(text, "  {step:16} {case:24} {:>22}  {unit}", words(&row.value));
            }
            for LeftOut { step, case, why } in &engine.left_out {
                let _ = writeln!(text, "  {step:16} {case:24} not measured: {why}");
            }
        }
        if let Some(peak) = self.peak_memory_mib {
            let _ = writeln!(text, "\nPeak memory: {peak:.0} MiB");
        }
        text
    }
}

/// A median with its quartiles.
fn words(spread: &Spread) -> String {
    let [low, high] = spread.quartiles;
    format!("{} ({}–{})", number(spread.median), number(low), number(high))
}

/// A number with three significant digits.
pub fn number(value: f64) -> String {
    let digits = 2 - value.abs().max(1e-9).log10().floor() as i32;
    format!("{value:.*}", digits.clamp(0, 4) as usize)
}
