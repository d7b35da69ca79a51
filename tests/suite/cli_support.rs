//! The program run as a user runs it: in a folder of its own, by its arguments, judged by its files and messages.

use std::{collections::HashMap, path::Path, path::PathBuf, process::Command};

use exr::prelude::{
    Encoding, Image, Layer, LayerAttributes, ReadChannels as _, ReadLayers as _, SpecificChannels, Vec2, WritableImage,
    f16, read, read_first_rgba_layer_from_file,
};
use glossmith::{
    document::{Document, MaterialSettings},
    store::{load_document, load_material, save_document, save_material},
};
use serde_json::Value;
use tempfile::TempDir;

/// What a run left behind.
pub struct Run {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

/// Runs an ignored test of this program in a process of its own, since it changes what holds for a whole process.
pub fn passes_alone(test: &str) {
    let child = Command::new(std::env::current_exe().expect("a path"))
        .args(["--ignored", "--exact", test])
        .output()
        .expect("this very program");
    let output = String::from_utf8_lossy(&child.stdout);
    assert!(child.status.success(), "{output}");
    assert!(output.contains("1 passed"), "{output}");
}

/// A folder of its own for a test, in which the program runs.
pub struct Workplace(TempDir);

/// Quick to render, and still a picture; for each option that a test does not give itself.
const QUICK: [&str; 4] = ["--engine cpu", "--size 24x24", "--samples 4", "--output quick.exr"];

fn quick(arguments: &str) -> String {
    let is_given = |option: &&str| {
        let name = option.split_whitespace().next();
        arguments.split_whitespace().any(|word| Some(word) == name)
    };
    let missing: Vec<_> = QUICK.into_iter().filter(|option| !is_given(option)).collect();
    format!("render {} {arguments}", missing.join(" "))
}

impl Workplace {
    pub fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    pub fn root(&self) -> &Path {
        self.0.path()
    }

    pub fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.root().join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    pub fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    pub fn material(&self, name: &str) -> MaterialSettings {
        load_material(&self.path(name)).unwrap().value
    }

    pub fn document(&self, name: &str) -> Document {
        load_document(&self.path(name)).unwrap().value
    }

    pub fn save_material(&self, name: &str, material: &MaterialSettings) {
        save_material(&self.path(name), material).unwrap();
    }

    pub fn save_document(&self, name: &str, document: &Document) {
        save_document(&self.path(name), document).unwrap();
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }

    /// Runs the program with arguments that have blanks between them, without a display.
    pub fn run(&self, arguments: &str) -> Run {
        let output = Command::new(crate::program())
            .args(arguments.split_whitespace())
            .current_dir(self.root())
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("RUST_LOG")
            // Without it libraries of the system complain on standard error.
            .env("XDG_RUNTIME_DIR", self.root())
            .output()
            .unwrap();
        Run {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Runs the program, which must succeed.
    pub fn done(&self, arguments: &str) -> Run {
        let run = self.run(arguments);
        assert_eq!(run.code, Some(0), "{arguments}\n{}", run.stderr);
        run
    }

    /// A small picture by these arguments of `render`, linear.
    pub fn picture(&self, arguments: &str) -> Picture {
        self.done(&quick(arguments));
        read_exr(&self.path("quick.exr"))
    }

    /// The report of a small picture by these arguments of `render`.
    pub fn report(&self, arguments: &str) -> Value {
        self.done(&quick(&format!("--report report.json {arguments}")));
        self.json("report.json")
    }

    /// Runs the program, which must refuse with this exit code and all these words in one line, after warnings at most.
    /// Exit code 2 comes from the parser of arguments, which adds where to find help.
    pub fn refused(&self, code: i32, arguments: &str, words: &[&str]) {
        let run = self.run(arguments);
        let stderr = run.stderr.trim_end();
        assert_eq!(run.code, Some(code), "{arguments}\n{stderr}");
        assert!(!stderr.contains("panicked"), "{arguments}\n{stderr}");
        let is_notice = |line: &&str| line.starts_with("There is no display");
        // As the log writes it: [time WARN place] text.
        let is_warning = |line: &&str| {
            let head = line.strip_prefix('[').and_then(|rest| rest.split_once(']'));
            head.is_some_and(|(head, _)| head.contains(" WARN "))
        };
        let is_before = |line: &&str| is_notice(line) || is_warning(line);
        let lines: Vec<_> = stderr.lines().skip_while(is_before).collect();
        assert!(!lines.is_empty(), "nothing is told: {arguments}\n{stderr}");
        for word in words {
            assert!(
                lines[0].contains(word),
                "'{word}' is not in the first line: {arguments}\n{stderr}"
            );
        }
        assert!(
            lines[0].matches("os error").count() <= 1,
            "told twice: {arguments}\n{stderr}"
        );
        let most = if code == 2 { 7 } else { 1 };
        assert!(lines.len() <= most, "more than {most} lines: {arguments}\n{stderr}");
    }
}

/// A linear picture with opacity.
#[derive(Clone, PartialEq)]
pub struct Picture {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<[f32; 4]>,
}

impl Picture {
    pub fn at(&self, x: usize, y: usize) -> [f32; 4] {
        self.pixels[y * self.width + x]
    }

    /// Mean difference of the colours over the mean colour.
    pub fn difference(&self, other: &Picture) -> f64 {
        assert_eq!((self.width, self.height), (other.width, other.height));
        let pairs = self.pixels.iter().flatten().zip(other.pixels.iter().flatten());
        let (difference, sum) = pairs.fold((0.0, 0.0), |(difference, sum), (a, b)| {
            (difference + f64::from(a - b).abs(), sum + 0.5 * f64::from(a + b))
        });
        difference / sum
    }
}

pub fn read_exr(path: &Path) -> Picture {
    let new = |size: Vec2<usize>, _: &_| Picture {
        width: size.0,
        height: size.1,
        pixels: vec![[0.0; 4]; size.0 * size.1],
    };
    let set = |picture: &mut Picture, place: Vec2<usize>, (r, g, b, a): (f32, f32, f32, f32)| {
        picture.pixels[place.1 * picture.width + place.0] = [r, g, b, a];
    };
    let image = read_first_rgba_layer_from_file(path, new, set).unwrap();
    image.layer_data.channel_data.pixels
}

/// The channels of an EXR file by name.
pub fn channels(path: &Path) -> HashMap<String, Vec<f32>> {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .unwrap();
    let channels = image.layer_data.channel_data.list.into_iter();
    channels
        .map(|channel| (channel.name.to_string(), channel.sample_data.values_as_f32().collect()))
        .collect()
}

/// The values of `width` × `height` texels as an EXR file of half floats.
pub fn write_exr(path: &Path, width: usize, height: usize, texel: impl Sync + Fn(usize, usize) -> [f32; 3]) {
    let channels = SpecificChannels::rgb(|place: Vec2<usize>| {
        let [r, g, b] = texel(place.0, place.1).map(f16::from_f32);
        (r, g, b)
    });
    let layer = Layer::new(
        (width, height),
        LayerAttributes::default(),
        Encoding::SMALL_LOSSLESS,
        channels,
    );
    Image::from_layer(layer).write().to_file(path).unwrap();
}

/// The values of `width` × `height` texels as a Radiance file.
pub fn write_hdr(path: &Path, width: usize, height: usize, texel: impl Fn(usize, usize) -> [f32; 3]) {
    let texels: Vec<_> = (0..width * height)
        .map(|index| image::Rgb(texel(index % width, index / width)))
        .collect();
    let file = std::fs::File::create(path).unwrap();
    image::codecs::hdr::HdrEncoder::new(file)
        .encode(&texels, width, height)
        .unwrap();
}
