//! The bar at the bottom: what renders, what it is doing, how far it has come, and how long the window's frames take.

use std::time::{Duration, Instant};

use egui::{RichText, Ui};

use crate::app::kit::words::{percent, short_number};
use crate::render::Progress;
use crate::render::worker::{Activity, Snapshot};

/// How long a frame counts as recent.
const RECENT: Duration = Duration::from_secs(10);
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
    pub(in crate::app) fn begin(&mut self, now: Instant, is_running: bool, work_seconds: Option<f32>) {
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

/// Shows the bar's contents.
pub(in crate::app) fn show(ui: &mut Ui, snapshot: &Snapshot, meter: &FrameMeter) {
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = 16.0;
        engine(ui, snapshot);
        activity(ui, snapshot);
        let progress = &snapshot.progress;
        if progress.samples_wanted > 0 {
            ui.label(samples(progress))
                .on_hover_text("Samples a pixel: rendered (in the mean, where some rest), and to be rendered");
            if let Some(noise) = progress.noise {
                ui.label(format!("error {}", percent(noise.relative)))
                    .on_hover_ui(|ui| {
                        ui.label("Standard error of a pixel, root mean square, relative to the mean luminance");
                        let (low, high) = (percent(noise.low), percent(noise.high));
                        ui.label(format!("The true one lies between {low} and {high} (95 %)."));
                    });
            }
            if let Some(told) = snapshot.denoised {
                ui.label(format!("denoised {}", percent(told.value))).on_hover_ui(|ui| {
                    ui.label(
                        "Error of the denoised picture, its bias included: root mean square over the mean luminance",
                    );
                    let (low, high) = (percent(told.low), percent(told.high));
                    ui.label(format!("The true one lies between {low} and {high} (95 %)."));
                });
            }
            ui.label(format!("{:.1} s", progress.render_seconds))
                .on_hover_text("Render time of this picture");
            ui.label(format!("{} samples/s", short_number(snapshot.samples_per_second)))
                .on_hover_text("Pixel samples a second, over the whole of this picture");
        }
        if let Some(picture) = &snapshot.picture {
            let size = format!("{} × {}", picture.width, picture.height);
            let reduced = format!("{size} (1/{})", picture.reduction);
            ui.label(if picture.reduction > 1 { reduced } else { size })
                .on_hover_text("Size of the picture shown");
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            window_time(ui, meter, snapshot)
        });
    });
}

fn engine(ui: &mut Ui, snapshot: &Snapshot) {
    let Some(engine) = &snapshot.engine else {
        ui.weak("no engine yet");
        return;
    };
    let label = ui.label(RichText::new(engine.kind.label()).strong());
    let name = ui.label(&engine.adapter);
    label.union(name).on_hover_ui(|ui| {
        ui.label(format!("Engine: {}", engine.kind.name()));
        ui.label(&engine.adapter);
        if !engine.driver.is_empty() {
            ui.label(&engine.driver);
        }
        ui.label(format!("Chosen because: {}", engine.reason));
    });
}

fn activity(ui: &mut Ui, snapshot: &Snapshot) {
    let is_busy = matches!(
        snapshot.activity,
        Activity::Starting | Activity::Loading(_) | Activity::Preparing
    );
    if is_busy {
        ui.add(egui::Spinner::new().size(12.0));
    }
    ui.label(snapshot.activity.to_string());
    if snapshot.activity == Activity::Rendering {
        if snapshot.progress.is_standing_in {
            ui.add(egui::Spinner::new().size(12.0));
            ui.weak("compiling the kernel")
                .on_hover_text("The processor draws until the GPU's kernel for this scene is compiled.");
        }
        let limit = snapshot.scene.as_ref().and_then(|scene| scene.document.render.time_s);
        let share = snapshot.progress.share_done(limit);
        ui.add(
            egui::ProgressBar::new(share as f32)
                .desired_width(90.0)
                .desired_height(6.0),
        );
    }
}

fn window_time(ui: &mut Ui, meter: &FrameMeter, snapshot: &Snapshot) {
    ui.weak(format!("window {:.0} ms", ms(meter.work.last)))
        .on_hover_ui(|ui| {
            meter.describe(ui);
            if let Some(first) = snapshot.first_picture {
                ui.label(format!(
                    "From the last change to its first picture: {:.0} ms",
                    ms(first)
                ));
            }
        });
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_counts_every_frame_and_intervals_only_those_without_a_pause() {
        let mut meter = FrameMeter::default();
        let begun = Instant::now();
        let at = |ms: u64| begun + Duration::from_millis(ms);
        // The first frames make fonts and pipelines: they count as recent, not as the longest.
        meter.begin(at(0), true, None);
        meter.begin(at(3000), true, Some(3.0));
        for frame in 1..=20 {
            meter.begin(at(3000 + 40 * frame), true, Some(0.005));
        }
        assert_eq!(meter.work.worst, Duration::from_millis(5));
        assert_eq!(meter.interval.worst, Duration::from_millis(40));
        assert_eq!(meter.work.recent_worst(), Duration::from_secs(3));
        // A pause is no interval, but the frame before it counts.
        meter.begin(at(9000), false, Some(0.012));
        assert_eq!(meter.work.last, Duration::from_secs_f32(0.012));
        assert_eq!(meter.interval.worst, Duration::from_millis(40));
    }
}
