//! The turntable: what turns, how often it is taken, and where it goes; the queue renders it.

use std::path::{Path, PathBuf};
use std::time::Instant;

use egui::Ui;

use crate::app::kit::words::duration;
use crate::app::kit::{theme, widgets};
use crate::document::turntable::Turn;
use crate::document::{CameraSettings, Document};
use crate::named::named;
use crate::render::turntable::{FPS, Turntable};
use crate::store::video;

/// Frames at first: four seconds.
const FRAMES: u32 = 96;
/// Columns and rows at first, where the image's own size only follows from the window's.
pub const SIZE: [u32; 2] = [1920, 1080];

named! {
    /// What a turntable is written as.
    #[derive(Default)]
    Form {
        Pictures, "images", "Images", "Numbered images (.png) in a folder.";
        #[default]
        Mp4, "mp4", "Video (.mp4)", "H.264, which everything plays.";
        Gif, "gif", "Animation (.gif)", "256 colours a frame, in an endless loop.";
    }
}

impl Form {
    /// The ending of its file; none for a folder.
    fn ending(self) -> &'static str {
        match self {
            Self::Pictures => "",
            Self::Mp4 => "mp4",
            Self::Gif => "gif",
        }
    }
}

/// A turn in the viewport.
pub struct Preview {
    pub since: Instant,
    /// The document's camera: a turn ends where that is moved.
    pub camera: CameraSettings,
}

pub struct TurntableSheet {
    pub is_open: bool,
    frames: u32,
    pub turn: Turn,
    /// The turn that the viewport shows.
    pub preview: Option<Preview>,
    form: Form,
    fps: f64,
    pub samples: u32,
    pub size: [u32; 2],
    /// The folder or the file.
    pub output: String,
}

impl Default for TurntableSheet {
    fn default() -> Self {
        Self {
            is_open: false,
            frames: FRAMES,
            turn: Turn::default(),
            preview: None,
            form: Form::default(),
            fps: FPS,
            samples: 0,
            size: [0; 2],
            output: String::new(),
        }
    }
}

impl TurntableSheet {
    pub fn order(&self, document: &Document) -> Turntable {
        let mut document = document.clone();
        [document.render.width, document.render.height] = self.size;
        document.render.samples = self.samples;
        document.render.time_s = None;
        let path = PathBuf::from(self.output.trim());
        let is_video = self.form != Form::Pictures;
        Turntable {
            document,
            turn: self.turn,
            frames: self.frames,
            folder: (!is_video).then(|| path.clone()),
            video: is_video.then(|| path.with_extension(self.form.ending())),
            fps: self.fps,
            keeps_part: false,
        }
    }

    /// How long all frames take at so many pixel samples a second.
    fn seconds(&self, samples_per_second: f64) -> f64 {
        let pixels = self.size.map(f64::from);
        f64::from(self.frames) * f64::from(self.samples) * pixels[0] * pixels[1] / samples_per_second
    }

    /// The settings; true to begin. `samples_per_second`: how fast pixels are sampled at present.
    pub fn settings(&mut self, ui: &mut Ui, samples_per_second: f64) -> bool {
        let name = widgets::Name::new("Turntable turn", "Turn", "What turns, anticlockwise seen from above.");
        widgets::row(ui, name, |ui| {
            widgets::choice(ui, "turntable turn", &mut self.turn, &widgets::choices())
        });
        let mut number =
            |name: &str, label: &str, help: &str, value: &mut u32, range: std::ops::RangeInclusive<f64>| {
                let name = widgets::Name::new(name, label, help);
                widgets::row(ui, name, |ui| widgets::number(ui, value, &style(range, 0)));
            };
        number(
            "Turntable frames",
            "Frames",
            "Images of a whole turn.",
            &mut self.frames,
            1.0..=9999.0,
        );
        number(
            "Turntable samples",
            "Samples",
            "Samples per pixel of each.",
            &mut self.samples,
            1.0..=65536.0,
        );
        let [width, height] = &mut self.size;
        number("Turntable width", "Width", "Columns of each.", width, 1.0..=8192.0);
        number("Turntable height", "Height", "Rows of each.", height, 1.0..=8192.0);
        let name = widgets::Name::new("Turntable form", "Written as", "What the frames are written as.");
        widgets::row(ui, name, |ui| {
            widgets::choice(ui, "turntable form", &mut self.form, &widgets::choices())
        });
        let is_video = self.form != Form::Pictures;
        let name = widgets::Name::new("Turntable frames a second", "Frames/s", "How fast a video plays.");
        ui.add_enabled_ui(is_video, |ui| {
            widgets::row(ui, name, |ui| widgets::number(ui, &mut self.fps, &style(video::FPS, 3)))
        });
        let help = match is_video {
            true => "The file; what is there is replaced.",
            false => {
                "The folder for frame-0001.png, frame-0002.png and so on; made where it is not there. What is there is \
                 replaced."
            }
        };
        self.output = with_ending(&self.output, self.form.ending());
        widgets::row(ui, widgets::Name::new("Turntable output", "Output", help), |ui| {
            ui.add(
                egui::TextEdit::singleline(&mut self.output)
                    .desired_width(f32::INFINITY)
                    .margin(egui::vec2(6.0, 4.0)),
            )
        });
        let mut message = format!("A turn of {}", duration(f64::from(self.frames) / self.fps));
        if samples_per_second > 0.0 {
            let seconds = self.seconds(samples_per_second);
            message += &format!(", rendered in about {} at the present speed", duration(seconds));
        }
        widgets::note(ui, message + ".");
        ui.add_space(theme::GAP);
        let mut begins = false;
        ui.horizontal(|ui| {
            let is_usable = !self.output.trim().is_empty();
            begins = ui
                .add_enabled(is_usable, egui::Button::new("Add to the queue"))
                .clicked();
            if ui.button("Close").clicked() {
                ui.close();
            }
        });
        begins
    }
}

fn style(range: std::ops::RangeInclusive<f64>, decimals: usize) -> widgets::NumberStyle<'static> {
    widgets::NumberStyle::plain(range, "", 0.2, decimals)
}

/// A path with another of the endings that turntables have, or with none; as it is while it is being typed.
fn with_ending(path: &str, ending: &str) -> String {
    let has = Path::new(path)
        .extension()
        .and_then(|has| has.to_str())
        .unwrap_or_default();
    let is_known = Form::ALL.iter().any(|form| form.ending() == has);
    match is_known && has != ending && !path.is_empty() {
        true => Path::new(path).with_extension(ending).display().to_string(),
        false => path.to_owned(),
    }
}
