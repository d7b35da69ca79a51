//! The turntable: what turns, how often it is taken, and where it goes; the queue renders it.

use std::{path::Path, time::Instant};

use super::*;
use crate::{
    document::{CameraSettings, Denoise, turntable::Turn},
    kit::words::duration,
    named::{named, with_defaults},
    render::Progress,
    render::turntable::{FPS, Turntable},
    store::video,
};

/// Frames at first: four seconds.
const FRAMES: u32 = 96;
/// Error at which a frame ends at first.
const NOISE: f64 = 0.03;
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

with_defaults! {
    pub struct TurntableSheet {
        pub is_open: bool,
        frames: u32 = FRAMES,
        pub turn: Turn,
        /// The turn that the viewport shows.
        pub preview: Option<Preview>,
        form: Form,
        fps: f64 = FPS,
        pub samples: u32,
        /// The denoised error at which a frame ends, before it has its samples; 0: none.
        noise: f64 = NOISE,
        pub size: [u32; 2],
        /// The folder or the file.
        pub output: String,
    }
}

impl TurntableSheet {
    pub fn order(&self, document: &Document) -> Turntable {
        let mut document = document.clone();
        [document.render.width, document.render.height] = self.size;
        document.render.samples = self.samples;
        document.render.time_s = None;
        if self.noise > 0.0 {
            (document.render.noise, document.view.denoise) = (Some(self.noise), Denoise::Auto);
        }
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

    /// How long all frames take at the speed of a render, and as noisy; `None` where either is not known yet.
    fn seconds(&self, progress: &Progress) -> Option<f64> {
        let pixels = self.size.map(f64::from);
        let to_noise = match self.noise > 0.0 {
            true => progress.samples_to(self.noise)?,
            false => f64::INFINITY,
        };
        let samples = to_noise.min(self.samples.into()).max(1.0);
        let pixel_samples = f64::from(self.frames) * samples * pixels[0] * pixels[1];
        Some(pixel_samples / progress.samples_per_second).filter(|seconds| seconds.is_finite())
    }

    /// The settings; true to begin, false to leave it. `progress`: of the render at present.
    pub fn settings(&mut self, ui: &mut Ui, progress: &Progress) -> Option<bool> {
        let help = "What turns, anticlockwise seen from above.";
        widgets::choice_row(ui, ["Turntable turn", "Turn", help], &mut self.turn);
        let [width, height] = &mut self.size;
        #[rustfmt::skip]
        let numbers = [
            (["Turntable frames", "Frames", "Images of a whole turn."], &mut self.frames, 9999.0),
            (["Turntable samples", "Samples", "Samples per pixel of each at most."], &mut self.samples, 65536.0),
            (["Turntable width", "Width", "Columns of each."], width, 8192.0),
            (["Turntable height", "Height", "Rows of each."], height, 8192.0),
        ];
        for (name, value, most) in numbers {
            widgets::row(ui, name, |ui| widgets::number(ui, value, &style(1.0..=most, 0)));
        }
        let help = "Each is denoised, and ends at this estimated error. At 0 it gets all its samples.";
        let name = ["Turntable noise limit", "Noise limit", help];
        let percent = widgets::NumberStyle {
            zero: Some("off"),
            ..widgets::NumberStyle::plain(0.0..=100.0, " %", 0.05, 2)
        };
        widgets::value_row(ui, name, &mut self.noise, NOISE, |ui, noise| {
            widgets::number_as(ui, noise, &percent, |share| 100.0 * share, |percent| 0.01 * percent)
        });
        let name = ["Turntable form", "Written as", "What the frames are written as."];
        widgets::choice_row(ui, name, &mut self.form);
        let is_video = self.form != Form::Pictures;
        let name = ["Turntable frames a second", "Frames/s", "How fast a video plays."];
        ui.add_enabled_ui(is_video, |ui| {
            widgets::number_row(ui, name, &mut self.fps, FPS, &style(video::FPS, 3))
        });
        let help = match is_video {
            true => "The file; what is there is replaced.",
            false => {
                "The folder for frame-0001.png, frame-0002.png and so on; made where it is not there. What is there is \
                 replaced."
            }
        };
        self.output = with_ending(&self.output, self.form.ending());
        widgets::row(ui, ["Turntable output", "Output", help], |ui| {
            let field = TextEdit::singleline(&mut self.output).desired_width(f32::INFINITY);
            ui.add(field.margin(vec2(6.0, 4.0)))
        });
        let mut message = format!("A turn of {}", duration(f64::from(self.frames) / self.fps));
        message += &match self.seconds(progress) {
            Some(seconds) => format!(", rendered in about {} at the present speed.", duration(seconds)),
            None => "; the render time is known once the image has an error.".to_owned(),
        };
        widgets::note(ui, message);
        ui.add_space(theme::GAP);
        let is_usable = !self.output.trim().is_empty();
        let buttons = |ui: &mut Ui| {
            let begins = widgets::pressed_if(ui, is_usable, "Add to the queue", "", "");
            begins.then_some(true).or(ui.button("Close").clicked().then_some(false))
        };
        ui.horizontal(buttons).inner
    }
}

fn style(range: std::ops::RangeInclusive<f64>, decimals: usize) -> widgets::NumberStyle<'static> {
    widgets::NumberStyle::plain(range, "", 0.2, decimals)
}

/// A path with another of the endings that turntables have, or with none; as it is while it is being typed.
fn with_ending(path: &str, ending: &str) -> String {
    let has = Path::new(path).extension().unwrap_or_default();
    let is_known = Form::ALL.iter().any(|form| has == form.ending());
    match is_known && has != ending && !path.is_empty() {
        true => Path::new(path).with_extension(ending).display().to_string(),
        false => path.to_owned(),
    }
}
