//! `glossmith study accuracy`: the race.

use std::time::Duration;

use clap::Args;

use super::{CommonArguments, ReferenceArguments, watched};
use crate::{
    cli::render::thumbnail,
    console::{message, output},
    document::Document,
    job::{film::Image, plan::Plan},
    plot::{NamedPoint, PictureSheet, PointPlot, lobe_view::Axis, plot_file},
    render::{EngineChoice, Session},
    study::race::{Race, RaceOptions, Runner, race},
    study::technique::{Technique, TechniqueError, techniques},
};

/// Those that take part where none are named.
const DEFAULT: [&str; 6] = ["strategy", "sequence", "adaptive", "bounces", "fresnel", "lobe"];
/// Engine time of each and noise to reach where none are given; the same quickly.
const SECONDS: f64 = 10.0;
const NOISE: f64 = 0.02;
const QUICK_SECONDS: f64 = 0.05;
/// Longest time for a reference, as a multiple of each one's time.
const REFERENCE_TIMES: f64 = 6.0;
/// Images of a sheet are no wider than this.
const SHEET_SIDE: u32 = 256;

const COLUMNS: &str = "technique,label,seconds,samples_per_pixel,error,error_low,error_high,told_noise,time_to_noise,\
                       is_extrapolated,bias,bias_low,bias_high,is_unbiased,reference_noise,equal_error_seconds,is_on_front";

/// Arguments of `glossmith study accuracy`.
#[derive(Debug, Args)]
pub struct AccuracyArguments {
    /// Who takes part, besides the scene as it is: settings such as strategy=lobe,bounces=4, or all of a kind: strategy,
    /// sequence, adaptive, denoise, bounces, fresnel, lobe, curve, scattering, effect, numbers. May be repeated [default: strategy,
    /// sequence, adaptive, bounces, fresnel and lobe].
    #[arg(long = "technique", value_name = "SETTINGS|KIND", value_parser = parse_techniques)]
    techniques: Vec<String>,
    #[command(flatten)]
    reference: ReferenceArguments,
}

fn parse_techniques(text: &str) -> Result<String, TechniqueError> {
    techniques(text, &Plan::general()).map(|_| text.to_owned())
}

pub fn run(arguments: &AccuracyArguments) -> anyhow::Result<()> {
    let common = &arguments.reference.common;
    let mut document = common.document()?;
    // They say how long is raced, not how the scene is rendered.
    let (time_s, noise) = (document.render.time_s.take(), document.render.noise.take());
    let mut session = Session::open(EngineChoice::Cpu)?;
    session.submit(&document)?;
    let named: Vec<&str> = arguments.techniques.iter().map(String::as_str).collect();
    let named = if named.is_empty() { &DEFAULT[..] } else { &named };
    let mut runners: Vec<Technique> = Vec::new();
    if let Some(job) = session.job() {
        for text in named {
            runners.extend(techniques(text, &job.plan)?);
        }
    }
    let seconds = time_s.unwrap_or(if common.quick { QUICK_SECONDS } else { SECONDS });
    let options = RaceOptions {
        seconds,
        noise: noise.unwrap_or(NOISE),
        slice: Duration::from_secs_f64((seconds / 20.0).clamp(0.005, 0.25)),
        reference_seconds: arguments.reference.reference_time.unwrap_or(REFERENCE_TIMES * seconds),
        ..RaceOptions::new(common.scene.engine, runners)
    };
    message!(
        "up to {} techniques race for {} s each, after references that take up to {} s each",
        options.techniques.len() + 1,
        options.seconds,
        options.reference_seconds
    );
    let found = watched(|watch| race(&document, &options, watch))?;
    write(common, &document, &found)?;
    if common.answer.has_words() {
        print(&found);
    }
    Ok(())
}

fn print(race: &Race) {
    output!(
        "{} on {}, {} x {}, {} s each",
        race.machine.engine,
        race.machine.adapter,
        race.width,
        race.height,
        race.seconds
    );
    output!(
        "  time to {} %   bias      error     technique (* none is both faster and less biased)",
        100.0 * race.noise
    );
    let mut runners: Vec<&Runner> = race.runners.iter().collect();
    runners.sort_by(|a, b| a.time_to_noise.total_cmp(&b.time_to_noise));
    for runner in runners {
        let mark = if runner.is_on_front { '*' } else { ' ' };
        let bias = if runner.is_unbiased {
            "none".to_owned()
        } else if runner.bias.is_resolved() {
            format!("{:.2} %", 100.0 * runner.bias.value)
        } else {
            format!("<{:.2} %", 100.0 * runner.bias.high)
        };
        output!(
            "{mark} {:>11.3} s   {bias:8}  {:6.2} %  {}",
            runner.time_to_noise,
            100.0 * runner.error.value,
            runner.label
        );
    }
}

fn write(common: &CommonArguments, document: &Document, race: &Race) -> anyhow::Result<()> {
    common.write("accuracy", race, ["runners", COLUMNS], &pareto_plot(race))?;
    let sheet = |name: &str, title: String, picture: fn(&Runner) -> &Image, caption: &dyn Fn(&Runner) -> String| {
        let of_runner = |runner: &Runner| {
            let picture = thumbnail(picture(runner), &document.view, SHEET_SIDE)?;
            Some((caption(runner), picture.into_rgb8()))
        };
        let pictures = race.runners.iter().filter_map(of_runner).collect();
        let file = format!("{name}.png");
        common.write_file(&file, &plot_file(file.as_ref(), &PictureSheet { title, pictures })?)
    };
    let title = format!("After {} s each", race.seconds);
    sheet("equal-time", title, |runner| &runner.equal_time, &|runner| {
        format!("{}: {:.1} %", runner.label, 100.0 * runner.error.value)
    })?;
    let title = format!("At an error of {:.1} %", 100.0 * race.equal_error);
    sheet("equal-error", title, |runner| &runner.equal_error, &|runner| {
        format!("{}: {:.2} s", runner.label, runner.equal_error_seconds)
    })
}

/// Time to the race's noise against bias.
fn pareto_plot(race: &Race) -> PointPlot {
    let least = 100.0 * race.least_bias();
    let point = |runner: &Runner| NamedPoint {
        name: runner.label.clone(),
        place: [
            runner.time_to_noise.max(1e-6),
            (100.0 * runner.charted_bias(0.0)).max(least),
        ],
        y_range: [runner.bias.low, runner.bias.high].map(|end| (100.0 * end).max(least)),
        is_best: runner.is_on_front,
    };
    let points: Vec<NamedPoint> = race.runners.iter().map(point).collect();
    let time = format!("Time to a noise of {} % (s)", 100.0 * race.noise);
    let bias = format!("Bias (%); values under {least:.2} are not significant");
    let highest = |point: &NamedPoint| point.y_range[1].max(point.place[1]);
    PointPlot {
        title: format!("What accuracy costs: {}", race.machine.adapter),
        x: Axis::logarithmic(&time, points.iter().map(|point| point.place[0])),
        y: Axis::logarithmic(&bias, points.iter().map(highest).chain([least])),
        points,
    }
}
