//! The bar at the bottom: whether the image is clean or how long that takes; in *Measure* also what renders, how exact
//! it is, and how long the window's frames take. Elsewhere these are shown under the pointer.

use std::time::{Duration, Instant};

use egui::{RichText, Ui};

use crate::app::actions::Action;
use crate::app::kit::widgets;
use crate::app::kit::words::{error, percent, short_number, time_left};
use crate::render::Progress;
use crate::render::worker::{Activity, Snapshot};

/// How often the loading message is refreshed.
const LOADING_REPAINT: Duration = Duration::from_millis(200);
/// How long a frame counts as recent.
const RECENT: Duration = Duration::from_secs(10);
/// An image that has ended below this estimated error is called clean.
const CLEAN: f64 = 0.05;
/// Frames left out of the worst: at the start, fonts and pipelines are made.
const WARM_UP_FRAMES: u64 = 10;

/// How long the window's frames take. Two times, as they have different causes: the *work* of a frame, for which nothing
/// else happens in the window (panels, tessellation, upload, submission: what eframe counts), and the *interval* between
/// frames that follow each other without a pause, which also holds the driver's drawing and the wait for the screen.
#[derive(Clone, Debug, Default)]
pub struct FrameMeter {
    frames: u64,
    begun: Option<Instant>,
    work: Track,
    interval: Track,
}

/// One of the two times.
#[derive(Clone, Debug, Default)]
struct Track {
    last: Duration,
    worst: Duration,
    recent: Vec<(Instant, Duration)>,
}

impl Track {
    fn record(&mut self, now: Instant, duration: Duration, is_warm: bool) {
        self.last = duration;
        self.recent.retain(|(at, _)| now.duration_since(*at) < RECENT);
        self.recent.push((now, duration));
        if is_warm {
            self.worst = self.worst.max(duration);
        }
    }

    fn recent_worst(&self) -> Duration {
        let durations = self.recent.iter().map(|(_, duration)| *duration);
        durations.max().unwrap_or_default()
    }
}

impl FrameMeter {
    /// A frame begins. `is_running`: it was asked for while the last one was drawn. `work_seconds`: eframe's count of
    /// the last one.
    pub fn begin(&mut self, now: Instant, is_running: bool, work_seconds: Option<f32>) {
        let is_warm = self.frames > WARM_UP_FRAMES;
        if let Some(seconds) = work_seconds {
            let work = Duration::from_secs_f32(seconds.clamp(0.0, 1e3));
            self.work.record(now, work, is_warm);
        }
        if let Some(begun) = self.begun.filter(|_| is_running) {
            self.interval.record(now, now.duration_since(begun), is_warm);
        }
        self.begun = Some(now);
        self.frames += 1;
    }

    /// One line for the log.
    pub fn summary(&self) -> String {
        format!(
            "window: {} frames; longest frame {:.1} ms, longest interval between frames {:.1} ms",
            self.frames,
            ms(self.work.worst),
            ms(self.interval.worst)
        )
    }

    fn describe(&self, ui: &mut Ui) {
        ui.label("The window's own frames: they are drawn beside the renderer.");
        egui::Grid::new("frame times").num_columns(4).show(ui, |ui| {
            for heading in ["", "last", "longest in 10 s", "longest"] {
                ui.weak(heading);
            }
            ui.end_row();
            for (label, track) in [("Frame", &self.work), ("From frame to frame", &self.interval)] {
                ui.label(label);
                for duration in [track.last, track.recent_worst(), track.worst] {
                    ui.label(format!("{:.1} ms", ms(duration)));
                }
                ui.end_row();
            }
        });
        ui.weak("From frame to frame: while something moves; with the driver's drawing and the wait for the screen.");
    }
}

fn ms(duration: Duration) -> f64 {
    1e3 * duration.as_secs_f64()
}

/// What the bar keeps longest where it is narrow, first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Engine,
    Activity,
    Samples,
    Error,
    Denoised,
    Share,
    Time,
    Size,
    Rate,
    Adapter,
    Window,
}

/// A part of the bar.
struct Part<'a> {
    rank: Rank,
    /// Points, with the space behind it.
    width: f32,
    show: Box<dyn FnOnce(&mut Ui) + 'a>,
}

/// Space between two parts, points.
const SPACING: f32 = 16.0;
/// Widths are taken for multiples of this, so that parts do not come and go with each digit.
const WIDTH_STEP: f32 = 8.0;
/// Side of a spinner, and length of the bar of what has been done, points.
const SPINNER: f32 = 12.0;
const SHARE_LENGTH: f32 = 90.0;
/// Width of the button that gives up loading, points.
const STOP_WIDTH: f32 = 86.0;

impl<'a> Part<'a> {
    fn new(rank: Rank, width: f32, show: impl FnOnce(&mut Ui) + 'a) -> Self {
        let width = SPACING + (width / WIDTH_STEP).ceil() * WIDTH_STEP;
        let show = Box::new(show);
        Self { rank, width, show }
    }

    /// A text that explains itself under the pointer.
    fn text(ui: &Ui, rank: Rank, text: impl Into<RichText>, help: impl FnOnce(&mut Ui) + 'a) -> Self {
        let text = text.into();
        let font = egui::FontSelection::Default;
        let layout = egui::WidgetText::from(text.clone());
        let galley = layout.into_galley(ui, Some(egui::TextWrapMode::Extend), f32::INFINITY, font);
        Self::new(rank, galley.size().x, move |ui| {
            ui.label(text).on_hover_ui(help);
        })
    }
}

/// Shows the bar's contents, what there is room for. `has_numbers`: error, samples and times stand in it, too.
pub fn show(ui: &mut Ui, snapshot: &Snapshot, meter: &FrameMeter, has_numbers: bool, actions: &mut Vec<Action>) {
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = SPACING;
        let mut parts = if has_numbers { engine(ui, snapshot) } else { Vec::new() };
        parts.extend(activity(ui, snapshot, actions));
        if has_numbers {
            parts.extend(progress(ui, snapshot));
        }
        parts.extend(size(ui, snapshot));
        if has_numbers {
            parts.push(window_time(ui, meter, snapshot));
        }
        let widths: Vec<_> = parts.iter().map(|part| (part.rank, part.width)).collect();
        let fits = fitting(&widths, ui.available_width() + SPACING);
        for part in parts.into_iter().filter(|part| fits.contains(&part.rank)) {
            if part.rank == Rank::Window {
                widgets::at_right(ui, part.show);
            } else {
                (part.show)(ui);
            }
        }
    });
}

/// What there is room for, points: what ranks higher goes first.
fn fitting(parts: &[(Rank, f32)], room: f32) -> Vec<Rank> {
    let mut ranked = parts.to_vec();
    ranked.sort_by_key(|(rank, _)| *rank);
    let mut left = room;
    let fits = |of_rank: &&[(Rank, f32)]| {
        left -= of_rank.iter().map(|(_, width)| width).sum::<f32>();
        left >= 0.0
    };
    let of_ranks = ranked.chunk_by(|a, b| a.0 == b.0);
    of_ranks.take_while(fits).map(|of_rank| of_rank[0].0).collect()
}

fn engine<'a>(ui: &Ui, snapshot: &'a Snapshot) -> Vec<Part<'a>> {
    let Some(engine) = &snapshot.engine else {
        let text = RichText::new("no engine yet").weak();
        return vec![Part::text(ui, Rank::Engine, text, |_| {})];
    };
    let help = |ui: &mut Ui| {
        ui.label(format!("Engine: {}", engine.kind.name()));
        ui.label(&engine.adapter);
        if !engine.driver.is_empty() {
            ui.label(&engine.driver);
        }
        ui.label(format!("Chosen because: {}", engine.reason));
    };
    let kind = RichText::new(engine.kind.label()).strong();
    vec![
        Part::text(ui, Rank::Engine, kind, help),
        Part::text(ui, Rank::Adapter, &engine.adapter, help),
    ]
}

fn activity<'a>(ui: &Ui, snapshot: &'a Snapshot, actions: &'a mut Vec<Action>) -> Vec<Part<'a>> {
    let spinner = || {
        Part::new(Rank::Activity, SPINNER, |ui| {
            _ = ui.add(egui::Spinner::new().size(SPINNER))
        })
    };
    let is_busy = matches!(
        snapshot.activity,
        Activity::Starting | Activity::Loading(_) | Activity::Preparing
    );
    let mut parts: Vec<Part<'a>> = is_busy.then(spinner).into_iter().collect();
    let doing = snapshot.loading.doing();
    let is_loading = matches!(snapshot.activity, Activity::Loading(_) | Activity::Preparing);
    let text = if is_loading && !doing.is_empty() {
        format!("{}: {doing}", snapshot.activity)
    } else {
        state(snapshot)
    };
    parts.push(Part::text(ui, Rank::Activity, text, |ui| account(ui, snapshot)));
    if is_loading {
        ui.ctx().request_repaint_after(LOADING_REPAINT);
        parts.push(Part::new(Rank::Engine, STOP_WIDTH, move |ui| {
            // By a name, as what stands before it comes and goes.
            let builder = egui::UiBuilder::new().scope_id(egui::Id::unique("cancel loading"));
            let cancel = ui.scope_builder(builder, |ui| ui.small_button("Stop loading")).inner;
            let cancel = cancel.on_hover_text("Gives up what is being loaded; what is shown stays");
            if cancel.clicked() {
                actions.push(Action::CancelLoading);
            }
        }));
    }
    if snapshot.activity == Activity::Rendering {
        if snapshot.progress.is_fallback {
            let text = RichText::new("compiling the kernel").weak();
            parts.push(spinner());
            parts.push(Part::text(ui, Rank::Activity, text, |ui| {
                ui.label("The CPU renders until the GPU's kernel for this scene is compiled.");
            }));
        }
        let share = share_done(snapshot) as f32;
        parts.push(Part::new(Rank::Share, SHARE_LENGTH, move |ui| {
            let bar = egui::ProgressBar::new(share)
                .desired_width(SHARE_LENGTH)
                .desired_height(6.0);
            ui.add(bar);
        }));
    }
    parts
}

fn share_done(snapshot: &Snapshot) -> f64 {
    let limit = snapshot.scene.as_ref().and_then(|scene| scene.document.render.time_s);
    snapshot.progress.share_done(limit)
}

/// How the image stands, in a word or two.
fn state(snapshot: &Snapshot) -> String {
    let progress = &snapshot.progress;
    match snapshot.activity {
        Activity::Rendering => match time_left(share_done(snapshot), progress.render_seconds) {
            Some(left) => format!("refining, {left}"),
            None => "refining".to_owned(),
        },
        Activity::Done if shown_error(snapshot).is_some_and(|error| error <= CLEAN) => "clean".to_owned(),
        _ => snapshot.activity.to_string(),
    }
}

/// The estimated error of what is shown.
fn shown_error(snapshot: &Snapshot) -> Option<f64> {
    let noise = snapshot.progress.noise.map(|noise| noise.relative);
    snapshot.denoised.as_ref().map(|denoised| denoised.value).or(noise)
}

/// What the word stands for, in numbers.
fn account(ui: &mut Ui, snapshot: &Snapshot) {
    let progress = &snapshot.progress;
    if let Some(engine) = &snapshot.engine {
        ui.label(format!("{}: {}", engine.kind.label(), engine.adapter));
    }
    if progress.samples_wanted == 0 {
        return;
    }
    ui.label(samples(progress));
    if let Some(noise) = progress.noise {
        ui.label(format!("Estimated error {}", error(noise.relative)));
        band(ui, noise.low, noise.high);
    }
    if let Some(denoised) = &snapshot.denoised {
        ui.label(format!("Denoised: estimated error {}", error(denoised.value)));
        band(ui, denoised.low, denoised.high);
    }
    ui.label(format!("{:.1} s of rendering", progress.render_seconds));
    ui.weak("More in the panel Convergence and the workspace Measure.");
}

/// How far the image has come, in numbers.
fn progress<'a>(ui: &Ui, snapshot: &'a Snapshot) -> Vec<Part<'a>> {
    let progress = &snapshot.progress;
    let mut parts = Vec::new();
    if progress.samples_wanted > 0 {
        parts.push(Part::text(ui, Rank::Samples, samples(progress), |ui| {
            ui.label("Samples per pixel: average so far / target");
        }));
        if let Some(noise) = progress.noise {
            let text = format!("error {}", error(noise.relative));
            parts.push(Part::text(ui, Rank::Error, text, move |ui| {
                ui.label("Estimated noise: RMS pixel error / mean luminance");
                band(ui, noise.low, noise.high);
            }));
        }
        if let Some(estimate) = snapshot.denoised {
            let text = format!("denoised {}", error(estimate.value));
            parts.push(Part::text(ui, Rank::Denoised, text, move |ui| {
                ui.label("Estimated error of the denoised image, bias included: RMS / mean luminance");
                band(ui, estimate.low, estimate.high);
            }));
        }
        let time = format!("{:.1} s", progress.render_seconds);
        parts.push(Part::text(ui, Rank::Time, time, |ui| {
            ui.label("Render time of this image");
        }));
        let rate = format!("{} samples/s", short_number(snapshot.samples_per_second));
        parts.push(Part::text(ui, Rank::Rate, rate, |ui| {
            ui.label("Pixel samples per second, over this whole image");
        }));
    }
    parts
}

fn size<'a>(ui: &Ui, snapshot: &Snapshot) -> Option<Part<'a>> {
    let picture = snapshot.picture.as_ref()?;
    let size = format!("{} × {}", picture.width, picture.height);
    let reduced = format!("{size} (1/{})", picture.reduction);
    let text = if picture.reduction > 1 { reduced } else { size };
    Some(Part::text(ui, Rank::Size, text, |ui| {
        ui.label("Size of the image shown");
    }))
}

fn band(ui: &mut Ui, low: f64, high: f64) {
    if high >= 1.0 {
        ui.label("Too few samples for an interval.");
        return;
    }
    let (low, high) = (percent(low), percent(high));
    ui.label(format!("95 % interval: {low} – {high}"));
}

fn window_time<'a>(ui: &Ui, meter: &'a FrameMeter, snapshot: &'a Snapshot) -> Part<'a> {
    let text = RichText::new(format!("window {:.0} ms", ms(meter.work.last))).weak();
    Part::text(ui, Rank::Window, text, |ui| {
        meter.describe(ui);
        if let Some(first) = snapshot.first_picture {
            ui.label(format!("From the last change to its first image: {:.0} ms", ms(first)));
        }
    })
}

fn samples(progress: &Progress) -> String {
    let most = progress.samples_per_pixel;
    let has_resting = progress.mean_samples < 0.99 * f64::from(most);
    let mean = if has_resting {
        format!(" (mean {:.0})", progress.mean_samples)
    } else {
        String::new()
    };
    format!("{most} / {} samples{mean}", progress.samples_wanted)
}
