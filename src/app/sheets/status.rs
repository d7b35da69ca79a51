//! The bar at the bottom: whether the image is clean or how long that takes; in *Measure* also what renders, how exact
//! it is. Elsewhere these are shown under the pointer.

use std::time::Duration;

use super::*;
use crate::{
    kit::words::{error, percent, short_number, time_left},
    render::{Progress, beyond_bounces, worker::Activity, worker::Snapshot},
};

/// How often the loading message is refreshed.
const LOADING_REPAINT: Duration = Duration::from_millis(200);
/// An image below this estimated error is called clean.
const CLEAN: f64 = 0.05;

/// Space between two parts, points.
const SPACING: f32 = 16.0;
/// Widths are taken for multiples of this, so that parts do not come and go with each digit.
const WIDTH_STEP: f32 = 8.0;
/// Side of a spinner, and length of the bar of what has been done, points.
const SPINNER: f32 = 12.0;
const SHARE_LENGTH: f32 = 90.0;

/// A text, and the lines that explain it under the pointer.
type Told = (String, Vec<String>);

fn lines(ui: &mut Ui, lines: Vec<String>) {
    for line in lines {
        ui.label(line);
    }
}

/// Shows the bar's contents, what there is room for. `has_numbers`: error, samples and times stand in it, too.
pub fn show(ui: &mut Ui, snapshot: &Snapshot, has_numbers: bool, actions: &mut Vec<Action>) {
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = SPACING;
        activity(ui, snapshot, actions);
        let mut told = Vec::new();
        if has_numbers {
            told.push(engine(snapshot));
            if snapshot.progress.samples_wanted > 0 {
                told.extend(progress(snapshot));
            }
        }
        if let Some(picture) = &snapshot.picture {
            let mut size = format!("{} × {}", picture.width, picture.height);
            if picture.reduction > 1 {
                size += &format!(" (1/{})", picture.reduction);
            }
            told.push((size, vec!["Size of the image shown".to_owned()]));
        }
        let font = TextStyle::Body.resolve(ui.style());
        for (text, help) in told {
            let galley = ui
                .painter()
                .layout_no_wrap(text.clone(), font.clone(), Color32::PLACEHOLDER);
            // What has no room is left out as a whole, and what follows it.
            if (galley.size().x / WIDTH_STEP).ceil() * WIDTH_STEP > ui.available_width() {
                break;
            }
            ui.label(text).on_hover_ui(|ui| lines(ui, help));
        }
    });
}

fn engine(snapshot: &Snapshot) -> Told {
    let Some(engine) = &snapshot.engine else {
        return ("no engine yet".to_owned(), Vec::new());
    };
    let mut help = vec![
        format!("Engine: {}", engine.kind.name()),
        engine.adapter.clone(),
        engine.driver.clone(),
        format!("Chosen because: {}", engine.reason),
    ];
    help.retain(|line| !line.is_empty());
    (engine.kind.label().to_owned(), help)
}

fn activity(ui: &mut Ui, snapshot: &Snapshot, actions: &mut Vec<Action>) {
    let is_loading = matches!(snapshot.activity, Activity::Loading(_) | Activity::Preparing);
    let is_fallback = snapshot.activity == Activity::Rendering && snapshot.progress.is_fallback;
    if is_loading || is_fallback || snapshot.activity == Activity::Starting {
        ui.add(Spinner::new().size(SPINNER));
    }
    let doing = snapshot.loading.doing();
    let text = if is_loading && !doing.is_empty() {
        format!("{}: {doing}", snapshot.activity)
    } else {
        state(snapshot)
    };
    ui.label(text).on_hover_ui(|ui| account(ui, snapshot));
    if is_loading {
        ui.ctx().request_repaint_after(LOADING_REPAINT);
        // By a name, as what stands before it comes and goes.
        let cancel = widgets::known_by(ui, "cancel loading", |ui| ui.small_button("Stop loading"));
        let help = "Gives up what is being loaded; what is shown stays";
        if cancel.on_hover_text(help).clicked() {
            actions.push(Action::CancelLoading);
        }
    }
    if is_fallback {
        ui.weak("compiling the kernel")
            .on_hover_text("The CPU renders until the GPU's kernel for this scene is compiled.");
    }
    if snapshot.activity == Activity::Rendering {
        let bar = ProgressBar::new(share_done(snapshot) as f32).desired_width(SHARE_LENGTH);
        ui.add(bar.desired_height(6.0));
    }
}

fn share_done(snapshot: &Snapshot) -> f64 {
    let limit = snapshot.scene.as_ref().and_then(|scene| scene.document.render.time_s);
    snapshot.progress.share_done(limit)
}

/// How the image stands, in a word or two.
fn state(snapshot: &Snapshot) -> String {
    let progress = &snapshot.progress;
    let noise = progress.noise.map(|noise| noise.relative);
    let shown_error = snapshot.denoised.map(|denoised| denoised.value).or(noise);
    match (&snapshot.activity, shown_error) {
        (Activity::Rendering | Activity::Done, Some(shown)) if shown <= CLEAN => "clean".to_owned(),
        (Activity::Rendering, _) => match time_left(share_done(snapshot), progress.render_seconds) {
            Some(left) => format!("refining, {left}"),
            None => "refining".to_owned(),
        },
        _ => snapshot.activity.to_string(),
    }
}

/// What the word stands for, in numbers.
fn account(ui: &mut Ui, snapshot: &Snapshot) {
    let mut text: Vec<String> = Vec::new();
    if let Some(engine) = &snapshot.engine {
        text.push(format!("{}: {}", engine.kind.label(), engine.adapter));
    }
    if snapshot.progress.samples_wanted > 0 {
        for (told, help) in progress(snapshot) {
            text.push(told);
            // The interval.
            text.extend(help.into_iter().skip(1));
        }
    }
    lines(ui, text);
}

/// How far the image has come, in numbers.
fn progress(snapshot: &Snapshot) -> Vec<Told> {
    let progress = &snapshot.progress;
    let help = |text: &str| vec![text.to_owned()];
    let about_samples = help("Samples per pixel: average so far / target");
    let mut parts = vec![(samples(progress), about_samples)];
    if let Some(noise) = progress.noise {
        let mut help = help("Estimated noise: RMS pixel error / mean luminance");
        help.push(band(noise.low, noise.high));
        let text = format!("error {}", raw_error(snapshot, noise.relative));
        parts.push((text, help));
    }
    if let Some(estimate) = snapshot.denoised {
        let mut help = help("Estimated error of the denoised image, bias included: RMS / mean luminance");
        help.push(band(estimate.low, estimate.high));
        parts.push((format!("denoised {}", error(estimate.value)), help));
    }
    let time = format!("{:.1} s", progress.render_seconds);
    parts.push((time, help("Render time of this image")));
    let rate = format!("{} samples/s", short_number(snapshot.samples_per_second));
    let about_rate = help("Pixel samples per second, over this whole image");
    parts.push((rate, about_rate));
    parts
}

/// The error of the samples, and what the last bounce cuts off.
fn raw_error(snapshot: &Snapshot, noise: f64) -> String {
    let bounces = snapshot.scene.as_ref().map_or(0, |scene| scene.document.render.bounces);
    error(noise) + &beyond_bounces(snapshot.progress.cut_share, bounces)
}

fn band(low: f64, high: f64) -> String {
    if high >= 1.0 {
        return "Too few samples for an interval.".to_owned();
    }
    format!("95 % interval: {} – {}", percent(low), percent(high))
}

fn samples(progress: &Progress) -> String {
    let most = progress.samples_per_pixel;
    let mut text = format!("{most} / {} samples", progress.samples_wanted);
    // Where some pixels rest.
    if progress.mean_samples < 0.99 * f64::from(most) {
        text += &format!(" (mean {:.0})", progress.mean_samples);
    }
    text
}
