//! Camera, view and render settings.

use egui::Ui;

use super::{Desk, Resolution};
use crate::app::actions::{Action, Command};
use crate::app::icons::{self, Icon};
use crate::app::widgets::{self, Name, NumberStyle};
use crate::document::{Bookmark, Denoise, DenoiseWhen, PixelFilter, Strategy, range};
use crate::named::Named;
use crate::optics::random::Sequence;
use crate::optics::tone::ToneCurve;

/// The noise limit when it is switched on.
const NOISE_AT_FIRST: f64 = 0.01;

pub(in crate::app) fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    widgets::group(ui, "Camera", |ui| camera(ui, desk));
    widgets::group(ui, "Bookmarks", |ui| bookmarks(ui, desk));
    widgets::group(ui, "View", |ui| view(ui, desk));
    widgets::group(ui, "Picture", |ui| picture(ui, desk));
    widgets::group(ui, "Accuracy", |ui| accuracy(ui, desk));
    widgets::group(ui, "Sampling", |ui| sampling(ui, desk));
}

fn angle(range: std::ops::RangeInclusive<f64>, bar: [f64; 2]) -> NumberStyle<'static> {
    NumberStyle {
        range,
        bar: Some(bar),
        unit: "°",
        speed: 1.0,
        decimals: 1,
    }
}

fn camera(ui: &mut Ui, desk: &mut Desk<'_>) {
    let camera = &mut desk.document.camera;
    let name = Name::new(
        "Field of view",
        "Field of view",
        "Vertical angle of the picture; small is a telephoto lens.",
    );
    let response = widgets::row(ui, name, |ui| {
        widgets::number(ui, &mut camera.fov_deg, &angle(range::FOV_DEG, [5.0, 120.0]))
    });
    desk.edited(response, "Field of view", |document| &mut document.camera.fov_deg);
    let camera = &mut desk.document.camera;
    let name = Name::new(
        "Yaw",
        "Yaw",
        "Turns the camera about the vertical axis. In the viewport: drag.",
    );
    let response = widgets::row(ui, name, |ui| {
        widgets::number(ui, &mut camera.yaw_deg, &angle(range::YAW_DEG, [-180.0, 180.0]))
    });
    desk.edited(response, "Camera yaw", |document| &mut document.camera.yaw_deg);
    let camera = &mut desk.document.camera;
    let name = Name::new(
        "Pitch",
        "Pitch",
        "Height of the camera above the horizon. In the viewport: drag.",
    );
    let response = widgets::row(ui, name, |ui| {
        widgets::number(ui, &mut camera.pitch_deg, &angle(range::PITCH_DEG, [-90.0, 90.0]))
    });
    desk.edited(response, "Camera pitch", |document| &mut document.camera.pitch_deg);
    depth_of_field(ui, desk);
    ui.horizontal_wrapped(|ui| {
        if ui.button("Frame all").on_hover_text(Command::FrameAll.help()).clicked() {
            desk.act(Command::FrameAll);
        }
        for (label, yaw_deg, pitch_deg) in [("Front", 0.0, 0.0), ("Side", 90.0, 0.0), ("Top", 0.0, 90.0)] {
            if ui.button(label).clicked() {
                desk.actions.push(Action::LookFrom(yaw_deg, pitch_deg));
            }
        }
        let help = Command::FrameSelected.help();
        if ui.button("Frame selected").on_hover_text(help).clicked() {
            desk.act(Command::FrameSelected);
        }
    });
}

fn depth_of_field(ui: &mut Ui, desk: &mut Desk<'_>) {
    let style = NumberStyle {
        range: range::APERTURE,
        bar: Some([0.0, 0.2]),
        unit: "",
        speed: 0.001,
        decimals: 4,
    };
    let name = Name::new(
        "Aperture",
        "Aperture",
        "Radius of the lens in bounding radii of the model. At 0 everything is sharp; the larger, the less.",
    );
    let aperture = &mut desk.document.camera.aperture;
    let response = widgets::row(ui, name, |ui| widgets::number(ui, aperture, &style));
    desk.edited(response, "Aperture", |document| &mut document.camera.aperture);
    if desk.document.camera.aperture == 0.0 {
        desk.state.picks_focus = false;
        return;
    }
    let at_target = desk.scene().map_or(1.0, |scene| {
        scene.job.settings.camera.focus_distance * scene.job.geometry.world_units_per_unit
    });
    let style = NumberStyle {
        range: range::DISTANCE,
        bar: None,
        unit: "",
        speed: 0.005 * at_target,
        decimals: 4,
    };
    let mut distance = desk.document.camera.focus_distance.unwrap_or(at_target);
    let name = Name::new(
        "Focus distance",
        "Focus",
        "How far away things are sharp, in the model's units; at first at the camera's target. In the viewport: \
         click with ctrl.",
    );
    let response = widgets::row(ui, name, |ui| widgets::number(ui, &mut distance, &style));
    if response.changed {
        desk.document.camera.focus_distance = Some(distance);
    }
    desk.edited(response, "Focus distance", |document| {
        &mut document.camera.focus_distance
    });
    let toggle = ui.toggle_value(&mut desk.state.picks_focus, "Pick focus");
    toggle.on_hover_text("The next click in the viewport says what is sharp.");
}

fn bookmarks(ui: &mut Ui, desk: &mut Desk<'_>) {
    let mut bookmarks = desk.document.bookmarks.clone();
    let mut removed = None;
    for (index, bookmark) in bookmarks.iter_mut().enumerate() {
        ui.horizontal(|ui| {
            let is_here = bookmark.camera == desk.document.camera;
            let name = format!("Camera bookmark {}", index + 1);
            if ui
                .selectable_label(is_here, "Go")
                .on_hover_text("Looks from there.")
                .clicked()
            {
                desk.document.camera = bookmark.camera;
                desk.edits.note("Go to bookmark", "");
            }
            let width = (ui.available_width() - 72.0).max(40.0);
            let field = egui::TextEdit::singleline(&mut bookmark.name).desired_width(width);
            if ui.add(field).accessible_name(name.as_str()).changed() {
                desk.edits.note("Rename bookmark", name.clone());
            }
            if ui
                .button("Set")
                .on_hover_text("Replaces it by the present camera.")
                .clicked()
            {
                bookmark.camera = desk.document.camera;
                desk.edits.note("Set bookmark", "");
            }
            let remove = format!("Remove {}", name.to_lowercase());
            if icons::button(ui, Icon::Close, &remove, "Remove this bookmark").clicked() {
                removed = Some(index);
            }
        });
    }
    if let Some(index) = removed {
        bookmarks.remove(index);
        desk.edits.note("Remove bookmark", "");
    }
    if ui
        .button("Add bookmark")
        .on_hover_text("Remembers the camera with the project.")
        .clicked()
    {
        bookmarks.push(Bookmark {
            name: format!("View {}", bookmarks.len() + 1),
            camera: desk.document.camera,
        });
        desk.edits.note("Add bookmark", "");
    }
    desk.document.bookmarks = bookmarks;
}

fn view(ui: &mut Ui, desk: &mut Desk<'_>) {
    let choices = named_choices::<ToneCurve>();
    let tone_map = &mut desk.document.view.tone_map;
    let name = Name::new(
        "Tone map",
        "Tone map",
        "How radiance beyond what a screen can show is brought into its range.",
    );
    let response = widgets::row(ui, name, |ui| widgets::choice(ui, "tone map", tone_map, &choices));
    desk.edited(response, "Tone map", |document| &mut document.view.tone_map);
    let style = exposure_style();
    let exposure_ev = &mut desk.document.view.exposure_ev;
    let name = Name::new("Exposure", "Exposure", "Brightness in stops: +1 doubles it.");
    let response = widgets::row(ui, name, |ui| widgets::number(ui, exposure_ev, &style));
    desk.edited(response, "Exposure", |document| &mut document.view.exposure_ev);
    let auto = &mut desk.document.view.auto_exposure;
    let name = Name::new(
        "Automatic exposure",
        "Automatic",
        "Brings the picture's mean brightness to middle grey; the exposure is added to that.",
    );
    let response = widgets::row(ui, name, |ui| ui.checkbox(auto, ""));
    desk.edited(response, "Automatic exposure", |document| {
        &mut document.view.auto_exposure
    });
    denoising(ui, desk);
}

fn denoising(ui: &mut Ui, desk: &mut Desk<'_>) {
    let view = &mut desk.document.view;
    let name = Name::new(
        "Denoise",
        "Denoise",
        "Takes the picture's noise out, led by what is seen, and tells how far it then is from the truth.",
    );
    let choices = named_choices::<Denoise>();
    let response = widgets::row(ui, name, |ui| {
        widgets::choice(ui, "denoise", &mut view.denoise, &choices)
    });
    desk.edited(response, "Denoise", |document| &mut document.view.denoise);
    if desk.document.view.denoise == Denoise::Off {
        return;
    }
    let when = &mut desk.document.view.denoise_when;
    let choices = named_choices::<DenoiseWhen>();
    let name = Name::new(
        "Denoise when",
        "When",
        "From the first sample on, or once all has been rendered.",
    );
    let response = widgets::row(ui, name, |ui| widgets::choice(ui, "denoise when", when, &choices));
    desk.edited(response, "Denoise when", |document| &mut document.view.denoise_when);
}

/// A closed list as a menu takes it.
fn named_choices<T: Named>() -> Vec<(T, &'static str, &'static str)> {
    T::ALL
        .iter()
        .map(|choice| (*choice, choice.label(), choice.help()))
        .collect()
}

pub(in crate::app) fn exposure_style() -> NumberStyle<'static> {
    NumberStyle {
        range: range::EXPOSURE_EV,
        bar: Some([-6.0, 6.0]),
        unit: " EV",
        speed: 0.05,
        decimals: 2,
    }
}

/// The sizes of the picture to choose from: (value, label, help).
pub(in crate::app) const RESOLUTIONS: [(Resolution, &str, &str); 4] = [
    (
        Resolution::Auto,
        "Fill",
        "Fills the viewport: with the screen's pixels on a GPU, with fewer on the processor.",
    ),
    (
        Resolution::Native,
        "Fill, native",
        "Fills the viewport with the screen's own pixels.",
    ),
    (
        Resolution::Half,
        "Fill, half",
        "Fills the viewport with half as many pixels each way.",
    ),
    (
        Resolution::Document,
        "Picture size",
        "Width and height as set below, whatever the viewport's shape.",
    ),
];

fn whole(range: std::ops::RangeInclusive<f64>, unit: &'static str) -> NumberStyle<'static> {
    NumberStyle {
        range,
        bar: None,
        unit,
        speed: 1.0,
        decimals: 0,
    }
}

fn picture(ui: &mut Ui, desk: &mut Desk<'_>) {
    let name = Name::new("Picture size", "Size", "What the viewport renders, and what is saved.");
    let response = widgets::row(ui, name, |ui| {
        widgets::choice(ui, "size", &mut desk.state.resolution, &RESOLUTIONS)
    });
    if response.reset {
        desk.state.resolution = Resolution::default();
    }
    if desk.state.resolution == Resolution::Document {
        let width = &mut desk.document.render.width;
        let response = widgets::row(ui, Name::new("Width", "Width", ""), |ui| {
            widgets::number(ui, width, &whole(range::SIZE, " px"))
        });
        desk.edited(response, "Picture width", |document| &mut document.render.width);
        let height = &mut desk.document.render.height;
        let response = widgets::row(ui, Name::new("Height", "Height", ""), |ui| {
            widgets::number(ui, height, &whole(range::SIZE, " px"))
        });
        desk.edited(response, "Picture height", |document| &mut document.render.height);
    }
    super::region::show(ui, desk);
    let samples = &mut desk.document.render.samples;
    let name = Name::new(
        "Samples",
        "Samples",
        "Samples a pixel after which rendering stops: noise halves with four times as many.",
    );
    let response = widgets::row(ui, name, |ui| widgets::number(ui, samples, &whole(range::SAMPLES, "")));
    desk.edited(response, "Samples", |document| &mut document.render.samples);
    let mut is_limited = desk.document.render.time_s.is_some();
    let name = Name::new("Time limit", "Time limit", "Stops rendering after some seconds.");
    let response = widgets::row(ui, name, |ui| ui.checkbox(&mut is_limited, ""));
    if response.changed {
        desk.document.render.time_s = is_limited.then_some(60.0);
    }
    desk.edited(response, "Time limit", |document| &mut document.render.time_s);
    if let Some(time_s) = &mut desk.document.render.time_s {
        let style = NumberStyle {
            decimals: 3,
            ..whole(range::TIME_S, " s")
        };
        let response = widgets::row(ui, Name::new("Seconds", "Seconds", ""), |ui| {
            widgets::number(ui, time_s, &style)
        });
        if response.changed {
            desk.edits.note("Time limit", "Time limit");
        }
    }
}

fn accuracy(ui: &mut Ui, desk: &mut Desk<'_>) {
    let mut is_limited = desk.document.render.noise.is_some();
    let help = "Stops rendering when the picture's estimated relative error is small enough.";
    let name = Name::new("Noise limit", "Noise limit", help);
    let response = widgets::row(ui, name, |ui| ui.checkbox(&mut is_limited, ""));
    if response.changed {
        desk.document.render.noise = is_limited.then_some(NOISE_AT_FIRST);
    }
    desk.edited(response, "Noise limit", |document| &mut document.render.noise);
    if let Some(noise) = &mut desk.document.render.noise {
        let mut noise_percent = 100.0 * *noise;
        let style = NumberStyle {
            range: 100.0 * range::NOISE.start()..=100.0 * range::NOISE.end(),
            bar: None,
            unit: " %",
            speed: 0.01,
            decimals: 3,
        };
        let help = "Standard error of a pixel, root mean square over the picture, relative to its mean luminance.";
        let name = Name::new("Noise to reach", "Error", help);
        let response = widgets::row(ui, name, |ui| widgets::number(ui, &mut noise_percent, &style));
        if response.changed {
            *noise = 0.01 * noise_percent;
            desk.edits.note("Noise limit", "Noise limit");
        }
    }
    let min_samples = &mut desk.document.render.min_samples;
    let help = "Samples that every pixel has before its error is believed: with fewer a small light may be missed.";
    let name = Name::new("Minimum samples", "At least", help);
    let style = whole(range::MIN_SAMPLES, " samples");
    let response = widgets::row(ui, name, |ui| widgets::number(ui, min_samples, &style));
    desk.edited(response, "Minimum samples", |document| &mut document.render.min_samples);
    let adaptive = &mut desk.document.render.adaptive;
    let choices = [
        (
            None,
            "With a noise limit",
            "Adaptive where a noise is to be reached, else even.",
        ),
        (
            Some(true),
            "On",
            "Samples go where the error is; the number of samples is the most of a pixel.",
        ),
        (Some(false), "Off", "Every pixel has the same number of samples."),
    ];
    let name = Name::new(
        "Adaptive sampling",
        "Adaptive",
        "Parts of the picture that are exact rest.",
    );
    let response = widgets::row(ui, name, |ui| widgets::choice(ui, "adaptive", adaptive, &choices));
    desk.edited(response, "Adaptive sampling", |document| &mut document.render.adaptive);
}

fn sampling(ui: &mut Ui, desk: &mut Desk<'_>) {
    let style = NumberStyle {
        bar: Some([1.0, 64.0]),
        ..whole(range::BOUNCES, "")
    };
    let bounces = &mut desk.document.render.bounces;
    let name = Name::new("Bounces", "Bounces", "Reflections that a path may have.");
    let response = widgets::row(ui, name, |ui| widgets::number(ui, bounces, &style));
    desk.edited(response, "Bounces", |document| &mut document.render.bounces);
    let strategy = &mut desk.document.render.strategy;
    let choices = [
        (
            Strategy::Mis,
            "Both (MIS)",
            "Sample both, each weighed by its density (Veach 1997).",
        ),
        (
            Strategy::Lobe,
            "Lobe",
            "Sample the material's lobe and see what light it meets.",
        ),
        (
            Strategy::Light,
            "Light",
            "Sample the light and see how the material reflects it.",
        ),
    ];
    let name = Name::new(
        "Strategy",
        "Strategy",
        "How light is found. All three converge to the same picture.",
    );
    let response = widgets::row(ui, name, |ui| widgets::choice(ui, "strategy", strategy, &choices));
    desk.edited(response, "Strategy", |document| &mut document.render.strategy);
    let sequence = &mut desk.document.render.sequence;
    let choices = [
        (
            Sequence::Sobol,
            "Sobol",
            "Owen-scrambled Sobol points: less noise for the same time.",
        ),
        (
            Sequence::Independent,
            "Independent",
            "Plain random numbers: what statistics assume.",
        ),
    ];
    let name = Name::new("Sequence", "Sequence", "The random numbers that are drawn.");
    let response = widgets::row(ui, name, |ui| widgets::choice(ui, "sequence", sequence, &choices));
    desk.edited(response, "Sequence", |document| &mut document.render.sequence);
    let filter = &mut desk.document.render.filter;
    let choices = [
        (PixelFilter::Gaussian, "Gaussian", "Half a pixel wide: smoother edges."),
        (
            PixelFilter::Box,
            "Box",
            "Evenly over the pixel: what to compare renderers with.",
        ),
    ];
    let name = Name::new(
        "Pixel filter",
        "Pixel filter",
        "How samples are spread over a pixel and its neighbours.",
    );
    let response = widgets::row(ui, name, |ui| widgets::choice(ui, "filter", filter, &choices));
    desk.edited(response, "Pixel filter", |document| &mut document.render.filter);
    let seed = &mut desk.document.render.seed;
    let name = Name::new("Seed", "Seed", "Which of the possible pictures' noise.");
    let response = widgets::row(ui, name, |ui| {
        widgets::number(ui, seed, &whole(0.0..=4_294_967_295.0, ""))
    });
    desk.edited(response, "Seed", |document| &mut document.render.seed);
}
