//! The bar at the bottom: what renders, what it is doing, how far it has come, and how long the window's frames take.

use std::time::{Duration, Instant};

use egui::{RichText, Ui};

use crate::render::worker::{Activity, Snapshot};

/// How long a frame counts as recent.
const RECENT: Duration = Duration::from_secs(10);
/// Frames left out of the worst: at the start, fonts and pipelines are made.
const WARM_UP_FRAMES: u64 = 10;

/// How long the window's frames take: what eframe counts of its last one, and where frames follow each other without a
/// pause, as while something moves, all that lies between them.
#[derive(Clone, Debug, Default)]
pub struct FrameMeter {
    frames: u64,
    begun: Option<Instant>,
    last: Duration,
    worst: Duration,
    recent: Vec<(Instant, Duration)>,
}

impl FrameMeter {
    /// A frame begins, which tells how long the last one was. `is_running`: it was asked for by the last one.
    pub(super) fn begin(&mut self, now: Instant, is_running: bool, cpu_seconds: Option<f32>) {
        let between = self.begun.filter(|_| is_running).map(|begun| now.duration_since(begun));
        let counted = cpu_seconds.map(|seconds| Duration::from_secs_f32(seconds.clamp(0.0, 1e3)));
        if let Some(last) = between.max(counted) {
            self.record(now, last);
        }
        self.begun = Some(now);
    }

    /// The panels took this long.
    pub(super) fn end(&mut self, duration: Duration) {
        self.record(Instant::now(), duration);
        self.frames += 1;
    }

    fn record(&mut self, now: Instant, duration: Duration) {
        self.last = duration;
        self.recent.retain(|(at, _)| now.duration_since(*at) < RECENT);
        self.recent.push((now, duration));
        if self.frames > WARM_UP_FRAMES {
            self.worst = self.worst.max(duration);
        }
    }

    /// One line for the log.
    pub fn summary(&self) -> String {
        let ms = |duration: Duration| 1e3 * duration.as_secs_f64();
        let recent = ms(self.recent_worst());
        format!(
            "window: {} frames, longest {:.1} ms, of the last 10 s {recent:.1} ms",
            self.frames,
            ms(self.worst)
        )
    }

    /// The longest frame since the start, the first few left out.
    pub fn worst(&self) -> Duration {
        self.worst
    }

    /// The longest frame of the last ten seconds.
    pub fn recent_worst(&self) -> Duration {
        self.recent
            .iter()
            .map(|(_, duration)| *duration)
            .max()
            .unwrap_or_default()
    }

    /// Frames recorded.
    pub fn frames(&self) -> u64 {
        self.frames
    }
}

/// Shows the bar's contents.
pub(super) fn show(ui: &mut Ui, snapshot: &Snapshot, meter: &FrameMeter) {
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = 16.0;
        engine(ui, snapshot);
        activity(ui, snapshot);
        let progress = &snapshot.progress;
        if progress.samples_wanted > 0 {
            ui.label(format!(
                "{} / {} samples",
                progress.samples_per_pixel, progress.samples_wanted
            ))
            .on_hover_text("Samples a pixel: rendered, and to be rendered");
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
    let label = ui.label(RichText::new(engine.kind.to_uppercase()).strong());
    let name = ui.label(&engine.adapter);
    label.union(name).on_hover_ui(|ui| {
        ui.label(format!("Engine: {}", engine.kind));
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
        let progress = &snapshot.progress;
        let share = f64::from(progress.samples_per_pixel) / f64::from(progress.samples_wanted.max(1));
        ui.add(
            egui::ProgressBar::new(share as f32)
                .desired_width(90.0)
                .desired_height(6.0),
        );
    }
}

fn window_time(ui: &mut Ui, meter: &FrameMeter, snapshot: &Snapshot) {
    let ms = |duration: Duration| 1e3 * duration.as_secs_f64();
    ui.weak(format!("window {:.0} ms", ms(meter.last))).on_hover_ui(|ui| {
        ui.label("Time of the window's own frames: they are drawn beside the renderer.");
        ui.label(format!("last: {:.1} ms", ms(meter.last)));
        ui.label(format!("longest of the last 10 s: {:.1} ms", ms(meter.recent_worst())));
        ui.label(format!(
            "longest: {:.1} ms of {} frames",
            ms(meter.worst()),
            meter.frames()
        ));
        if let Some(first) = snapshot.first_picture {
            ui.label(format!(
                "from the last change to its first picture: {:.0} ms",
                ms(first)
            ));
        }
    });
}

/// A number with three digits and a prefix.
pub(super) fn short_number(value: f64) -> String {
    let (scaled, prefix) = match value {
        v if v >= 1e9 => (v / 1e9, " G"),
        v if v >= 1e6 => (v / 1e6, " M"),
        v if v >= 1e3 => (v / 1e3, " k"),
        v => (v, ""),
    };
    let decimals = match scaled {
        s if s >= 100.0 || prefix.is_empty() => 0,
        s if s >= 10.0 => 1,
        _ => 2,
    };
    format!("{scaled:.decimals$}{prefix}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_three_digits() {
        assert_eq!(short_number(0.0), "0");
        assert_eq!(short_number(999.0), "999");
        assert_eq!(short_number(1234.0), "1.23 k");
        assert_eq!(short_number(45_670_000.0), "45.7 M");
        assert_eq!(short_number(3.21e11), "321 G");
    }

    #[test]
    fn frames_that_follow_each_other_count_whole_and_the_first_ones_not_at_all() {
        let mut meter = FrameMeter::default();
        let begun = Instant::now();
        let at = |ms: u64| begun + Duration::from_millis(ms);
        meter.begin(at(0), true, None);
        meter.end(Duration::from_secs(3));
        for frame in 1..=20 {
            meter.begin(at(40 * frame), true, Some(0.005));
            meter.end(Duration::from_millis(5));
        }
        assert_eq!(meter.worst(), Duration::from_millis(40));
        assert_eq!(meter.recent_worst(), Duration::from_secs(3));
        meter.begin(at(5000), false, Some(0.012));
        assert_eq!(meter.last, Duration::from_secs_f32(0.012));
    }
}
