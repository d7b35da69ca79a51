//! Two reports side by side, and which of their differences are noise.
//!
//! A ratio is noise if its logarithm is within the tolerance: K √(s_A² + s_B²), with s the robust relative standard deviation
//! of a turn and K larger for few turns. Where the CPU does the work, s includes the spread of the machine's pace, and on the
//! same machine the drift of the pace between the runs is added.

use std::fmt::Write as _;

use serde::Serialize;

use super::report::{EngineReport, Report, Row, Spread, number};

/// Smallest relative standard deviation of a turn: clocks and schedulers are no better.
const DEVIATION_MIN: f64 = 0.02;
/// Interquartile range of a normal distribution, in standard deviations.
const NORMAL_QUARTILES: f64 = 1.349;
/// Relative deviation that is assumed for a single measurement.
const DEVIATION_SINGLE: f64 = 0.2;

/// Comparison of two reports.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// True if both are of the same machine.
    pub is_same_machine: bool,
    /// Pace of B relative to A, if both have it.
    pub pace_ratio: Option<f64>,
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
    /// Factor by which the ratio may differ from 1 by chance.
    pub tolerance: f64,
    /// `noise`, `better` or `worse`.
    pub verdict: &'static str,
}

/// Compares B with A. Engines are matched by kind and adapter; the only one of a kind with the other's only one.
pub fn compare(a: &Report, b: &Report) -> Comparison {
    let is_same_machine = a.machine == b.machine;
    let pace_ratio = a.pace.zip(b.pace).map(|(a, b)| b.median / a.median);
    let mut rows = Vec::new();
    let mut unmatched = Vec::new();
    for of_a in &a.engines {
        let Some(of_b) = counterpart(of_a, a, b) else {
            unmatched.push(format!("{}: only in A", of_a.name()));
            continue;
        };
        let is_on_cpu = of_a.is_software && of_b.is_software;
        let variation = PaceVariation {
            drift: pace_ratio
                .filter(|_| is_same_machine && is_on_cpu)
                .map_or(0.0, |ratio| ratio.ln().abs()),
            pace: [(a, of_a), (b, of_b)].map(|(report, engine)| {
                let pace = report.pace.as_ref().filter(|_| engine.is_software);
                pace.map_or(0.0, deviation)
            }),
        };
        for row in &of_a.rows {
            match of_b.row(&row.step, &row.case) {
                Some(other) => rows.push(compared((of_a, row), (of_b, other), variation)),
                None => unmatched.push(format!("{}, {}, {}: only in A", of_a.name(), row.step, row.case)),
            }
        }
    }
    Comparison {
        is_same_machine,
        pace_ratio,
        rows,
        unmatched,
    }
}

/// How uneven the machines' pace was: between the runs, and relative standard deviations within each.
#[derive(Clone, Copy, Default)]
struct PaceVariation {
    drift: f64,
    pace: [f64; 2],
}

fn counterpart<'a>(engine: &EngineReport, of: &Report, among: &'a Report) -> Option<&'a EngineReport> {
    let same_kind = |report: &'a Report| report.engines.iter().filter(|other| other.engine == engine.engine);
    let exact = same_kind(among).find(|other| (&other.adapter, &other.backend) == (&engine.adapter, &engine.backend));
    let is_only = of.engines.iter().filter(|other| other.engine == engine.engine).count() == 1;
    let only = same_kind(among)
        .next()
        .filter(|_| is_only && same_kind(among).count() == 1);
    exact.or(only)
}

fn compared(
    (a, row): (&EngineReport, &Row),
    (b, other): (&EngineReport, &Row),
    variation: PaceVariation,
) -> ComparedRow {
    let ratio = other.value.median / row.value.median;
    let turns = row.value.turns.min(other.value.turns) as f64;
    // Deviations of few turns are uncertain themselves, as Student's t says.
    let factor = 2.0 + 6.0 / (turns - 1.0).max(1.0);
    let [of_a, of_b] = [(&row.value, variation.pace[0]), (&other.value, variation.pace[1])];
    let [s_a, s_b] = [of_a, of_b].map(|(value, pace)| deviation(value).hypot(pace));
    let tolerance = (factor * s_a.hypot(s_b) + variation.drift).exp();
    let is_noise = ratio.ln().abs() <= tolerance.ln();
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
        tolerance,
        verdict,
    }
}

/// Relative standard deviation of a turn.
fn deviation(spread: &Spread) -> f64 {
    if spread.turns < 2 {
        return DEVIATION_SINGLE;
    }
    let [low, high] = spread.quartiles;
    ((high - low) / (NORMAL_QUARTILES * spread.median.abs().max(1e-300))).max(DEVIATION_MIN)
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
            let within = format!("within a factor of {:.2}", row.tolerance);
            let verdict = if row.verdict == "noise" {
                format!("noise, {within}")
            } else {
                row.verdict.to_owned()
            };
            let (what, unit) = (&row.what, &row.unit);
            let _ = writeln!(text, "  {what:40} {a:>9} {b:>9} {:>7.2}  {unit}: {verdict}", row.ratio);
        }
        self.unmatched.iter().for_each(|what| text += &format!("{what}\n"));
        if let Some(pace) = self.pace_ratio {
            let machine = if self.is_same_machine {
                "the same machine"
            } else {
                "another machine"
            };
            let _ = writeln!(text, "B is of {machine}, whose pace was {pace:.2} of A's.");
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn row(median: f64, spread: f64, turns: usize) -> Row {
        Row {
            step: "rate".to_owned(),
            case: "default".to_owned(),
            unit: "M samples/s".to_owned(),
            more_is_better: true,
            value: Spread {
                median,
                quartiles: [median * (1.0 - spread), median * (1.0 + spread)],
                turns,
            },
        }
    }

    fn engine(row: Row) -> EngineReport {
        EngineReport {
            engine: "cpu".to_owned(),
            adapter: "one".to_owned(),
            backend: String::new(),
            driver: String::new(),
            is_software: true,
            proofs: Vec::new(),
            rows: vec![row],
            left_out: Vec::new(),
        }
    }

    fn verdict(a: Row, b: Row, variation: PaceVariation) -> &'static str {
        compared((&engine(a.clone()), &a), (&engine(b.clone()), &b), variation).verdict
    }

    #[test]
    fn what_lies_within_the_spread_is_noise() {
        let calm = PaceVariation::default();
        assert_eq!(verdict(row(10.0, 0.01, 9), row(10.4, 0.01, 9), calm), "noise");
        assert_eq!(verdict(row(10.0, 0.01, 9), row(12.0, 0.01, 9), calm), "better");
        assert_eq!(verdict(row(12.0, 0.01, 9), row(10.0, 0.01, 9), calm), "worse");
        assert_eq!(verdict(row(10.0, 0.10, 9), row(12.0, 0.10, 9), calm), "noise");
        assert_eq!(
            verdict(row(12.0, 0.0, 1), row(10.0, 0.0, 1), calm),
            "noise",
            "a single turn"
        );
        // A machine that was slower as a whole, and one that was busy for a while.
        let slower = PaceVariation { drift: 0.2, ..calm };
        assert_eq!(verdict(row(12.0, 0.01, 9), row(10.0, 0.01, 9), slower), "noise");
        let busy = PaceVariation {
            pace: [0.3, 0.2],
            ..calm
        };
        assert_eq!(verdict(row(12.0, 0.01, 9), row(6.0, 0.01, 9), busy), "noise");
    }
}
