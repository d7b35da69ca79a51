//! Two reports side by side. A difference is noise if the ranges between the quartiles overlap.

use std::fmt::Write as _;

use serde::Serialize;

use super::report::{EngineReport, Report, Row, number};

/// Comparison of two reports.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// True if both are of the same machine.
    pub is_same_machine: bool,
    /// Measurements that both have.
    pub rows: Vec<ComparedRow>,
    /// Measurements that only one has.
    pub unmatched: Vec<String>,
}

/// A measurement in both reports.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparedRow {
    /// Engine with adapter in A, and in B if another.
    pub engine: String,
    /// Step and case.
    pub what: String,
    /// Unit of the medians.
    pub unit: String,
    /// Median of A and of B.
    pub medians: [f64; 2],
    /// B over A.
    pub ratio: f64,
    /// `noise`, `better` or `worse`.
    pub verdict: &'static str,
}

/// Compares B with A. Engines are matched by kind and adapter; the only one of a kind with the other's only one.
pub fn compare(a: &Report, b: &Report) -> Comparison {
    let mut rows = Vec::new();
    let mut unmatched = Vec::new();
    for of_a in &a.engines {
        let Some(of_b) = counterpart(of_a, a, b) else {
            unmatched.push(format!("{}: only in A", of_a.name()));
            continue;
        };
        for row in &of_a.rows {
            match of_b.row(&row.step, &row.case) {
                Some(other) => rows.push(compared((of_a, row), (of_b, other))),
                None => unmatched.push(format!("{}, {}, {}: only in A", of_a.name(), row.step, row.case)),
            }
        }
    }
    Comparison {
        is_same_machine: a.machine == b.machine,
        rows,
        unmatched,
    }
}

fn counterpart<'a>(engine: &EngineReport, of: &Report, among: &'a Report) -> Option<&'a EngineReport> {
    let is_same = |other: &&EngineReport| other.engine == engine.engine;
    let theirs: Vec<_> = among.engines.iter().filter(is_same).collect();
    let is_exact = |other: &&EngineReport| other.adapter == engine.adapter && other.backend == engine.backend;
    let is_only = theirs.len() == 1 && of.engines.iter().filter(is_same).count() == 1;
    theirs.into_iter().find(|other| is_only || is_exact(other))
}

fn compared((a, row): (&EngineReport, &Row), (b, other): (&EngineReport, &Row)) -> ComparedRow {
    let ratio = other.value.median / row.value.median;
    let [[low_a, high_a], [low_b, high_b]] = [row.value.quartiles, other.value.quartiles];
    let is_noise = low_a <= high_b && low_b <= high_a;
    let verdict = match (is_noise, (ratio > 1.0) == row.more_is_better) {
        (true, _) => "noise",
        (false, true) => "better",
        (false, false) => "worse",
    };
    let engine = if a.adapter == b.adapter {
        a.name()
    } else {
        format!("{} / {}", a.name(), b.name())
    };
    ComparedRow {
        engine,
        what: format!("{}, {}", row.step, row.case),
        unit: row.unit.clone(),
        medians: [row.value.median, other.value.median],
        ratio,
        verdict,
    }
}

impl Comparison {
    /// The comparison as text for a terminal.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let mut engine = "";
        for row in &self.rows {
            if row.engine != engine {
                engine = &row.engine;
                let _ = writeln!(text, "{engine}\n  {:40} {:>9} {:>9} {:>7}", "", "A", "B", "B / A");
            }
            let [a, b] = row.medians.map(number);
            let (what, unit, verdict) = (&row.what, &row.unit, row.verdict);
            let _ = writeln!(text, "  {what:40} {a:>9} {b:>9} {:>7.2}  {unit}: {verdict}", row.ratio);
        }
        self.unmatched.iter().for_each(|what| text += &format!("{what}\n"));
        let machine = if self.is_same_machine { "the same" } else { "another" };
        let _ = writeln!(text, "B is of {machine} machine.");
        let count = |verdict: &str| self.rows.iter().filter(|row| row.verdict == verdict).count();
        let [noise, better, worse] = ["noise", "better", "worse"].map(count);
        let _ = write!(
            text,
            "{} ratios: {noise} noise, {better} better, {worse} worse",
            self.rows.len()
        );
        text
    }
}
