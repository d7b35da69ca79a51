//! A monkey at the window: it clicks, drags and types at random at whatever the accessibility tree offers. Nothing may
//! panic, no control may become another, and undoing everything must give the first document back to the bit.
//!
//! `GLOSSMITH_MONKEY_SEED=7` plays episode 7 alone.

use std::{
    collections::{HashSet, VecDeque},
    path::PathBuf,
    sync::{Mutex, MutexGuard, Once, PoisonError},
    time::{Duration, Instant},
};

use egui_kittest::Harness;
use glossmith::{
    app::{App, Options, Resolution, actions::Action, actions::Command},
    document::{AreaLight, Document, Kind, PARAMETERS, Value},
    render::EngineChoice,
    scene::ModelSource,
    store::{PRESETS, save_document, save_material},
};
use tempfile::TempDir;

use super::{
    cli_support::write_hdr,
    displays::faults,
    monkey_deeds::{Deed, Surroundings},
    random_documents::random_document,
    support::Random,
    ui::{Editor, assert_same_controls, controls},
    ui_panels::write_textured_square,
};

/// Deeds of an episode: fewer than the steps that can be undone.
const EPISODE: u64 = 200;
/// Episodes, half of them for each of the two tests, which run beside each other: at least; more as
/// time allows.
const EPISODES: u64 = 26;
/// How long each of the tests goes on.
const LONGEST: Duration = Duration::from_secs(30 * 60);
/// The last deeds that are told where something breaks.
const TOLD: usize = 40;
/// Frames in which nobody does anything, after a deed's own have passed.
const QUIET_FRAMES: usize = 3;
/// How long files that are being opened may take.
const PATIENCE: Duration = Duration::from_secs(600);
/// Panics of the program's own threads, which no test sees otherwise.
static BROKEN: Mutex<Vec<String>> = Mutex::new(Vec::new());

fn broken() -> MutexGuard<'static, Vec<String>> {
    BROKEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Takes note of panics in threads that have a name of the program's: tests are named after their path.
fn listen() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            let thread = std::thread::current();
            let is_ours = thread.name().is_some_and(|name| name != "main" && !name.contains("::"));
            let text = panic.to_string();
            if is_ours && !glossmith::panics::is_contained() {
                broken().push(format!("{}: {text}", thread.name().unwrap_or_default()));
            }
            usual(panic);
        }));
    });
}

/// What was done last, told where the episode breaks.
struct Trail {
    seed: u64,
    deeds: VecDeque<String>,
}

impl Drop for Trail {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!(
                "the monkey broke it; again by GLOSSMITH_MONKEY_SEED={}. Its last deeds:",
                self.seed
            );
            for deed in &self.deeds {
                eprintln!("  {deed}");
            }
        }
    }
}

/// The document that an episode begins with: the seeds together have every choice of every parameter, models with and
/// without textures, and up to two area lights.
fn first_document(seed: u64, textured: PathBuf) -> Document {
    let mut document = random_document(&mut Random::new(seed));
    for parameter in PARAMETERS.iter() {
        if let Kind::Choice(choices) = &parameter.kind {
            let value = Value::Choice(choices[seed as usize % choices.len()].name);
            parameter.set(&mut document.materials[0], value).expect("one of them");
        }
    }
    document.lighting.area_lights = vec![AreaLight::default(); seed as usize % 3];
    if seed.is_multiple_of(4) {
        document.model = ModelSource::File(textured);
    }
    document
}

/// Files of every kind that can be opened, one that is damaged, and one that is not there.
fn files(folder: &TempDir, seed: u64) -> Vec<PathBuf> {
    let path = |name: &str| folder.path().join(name);
    let project = random_document(&mut Random::new(seed + 1000));
    save_document(&path("project.json"), &project).expect("a temporary file");
    save_material(&path("material.json"), &PRESETS[seed as usize % PRESETS.len()]).expect("a temporary file");
    write_textured_square(&path("square.glb"));
    write_hdr(&path("light.hdr"), 16, 8, |x, _| [x as f32, 0.4, 0.1]);
    std::fs::write(path("damaged.glb"), b"this is no model").expect("a temporary file");
    let names = [
        "square.glb",
        "project.json",
        "material.json",
        "light.hdr",
        "damaged.glb",
        "missing.json",
    ];
    names.map(path).to_vec()
}

struct Monkey {
    harness: Editor,
    trail: Trail,
    surroundings: Surroundings,
    /// Deleted last, after the program has let go of it.
    _folder: TempDir,
}

impl Monkey {
    fn new(seed: u64) -> (Self, Document) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let files = files(&folder, seed);
        let first = first_document(seed, files[0].clone());
        let options = Options {
            engine: EngineChoice::Cpu,
            document: Some(first.clone()),
            resolution: Some(Resolution::Document),
            data: Some(folder.path().join("data")),
            typed_paths: Some(folder.path().to_owned()),
            ..Options::default()
        };
        // Half a pixel a point: pictures that fill the viewport stay small.
        let mut harness = Harness::builder()
            .with_size(egui::Vec2::new(1100.0, 760.0))
            .with_pixels_per_point(0.5)
            .with_step_dt(1.0 / 60.0)
            .build_eframe(move |creation| App::new(creation, options).expect("a thread to render on"));
        let app = harness.state_mut();
        if seed % 2 == 1 {
            app.request(Action::Do(Command::Compare));
        }
        match seed % 5 {
            0 => app.request(Action::Do(Command::Race)),
            1 => app.request(Action::Do(Command::Measure)),
            2 => app.request(Action::Do(Command::Pause)),
            _ => {}
        }
        let monkey = Self {
            harness: Editor(harness),
            trail: Trail {
                seed,
                deeds: VecDeque::new(),
            },
            surroundings: Surroundings {
                folder: folder.path().to_owned(),
                files,
                before: HashSet::new(),
                touched: HashSet::new(),
            },
            _folder: folder,
        };
        (monkey, first)
    }

    /// One deed, what follows from it, and some frames in which nothing is done.
    fn act(&mut self, index: u64) {
        // Numbers of its own for each deed: where one goes another way than last time, the others need not.
        let mut random = Random::new(self.trail.seed.wrapping_mul(1_000_003) + index);
        let deed = Deed::random(&mut random, &self.harness, &mut self.surroundings);
        if self.trail.deeds.len() == TOLD {
            self.trail.deeds.pop_front();
        }
        self.trail.deeds.push_back(format!("{index}: {deed:?}"));
        deed.perform(&mut self.harness);
        self.harness.run_steps(2);
        for _ in 0..QUIET_FRAMES {
            let before = controls(&self.harness);
            self.harness.step();
            assert_same_controls(&before, &controls(&self.harness), "a rest");
        }
        self.check();
        self.keep_small();
    }

    fn check(&self) {
        let broken = std::mem::take(&mut *broken());
        assert!(broken.is_empty(), "panics beside the window: {broken:#?}");
        let app = self.harness.state();
        let both = [Some(app.snapshot()), app.rival_snapshot()];
        let pictures = both
            .into_iter()
            .flatten()
            .filter_map(|snapshot| snapshot.picture.clone());
        let faults: Vec<String> = pictures.flat_map(|picture| faults(&picture)).collect();
        assert!(faults.is_empty(), "{faults:#?}");
        let messages = app.messages();
        let failed = messages.iter().find(|text| text.contains("the renderer failed"));
        assert!(failed.is_none(), "{failed:?}");
    }

    /// Takes back what would take the machine's memory.
    fn keep_small(&mut self) {
        let render = self.harness.document().render;
        if render.width.max(render.height) > 256 {
            self.undo();
        }
    }

    fn undo(&mut self) {
        self.harness.state_mut().request(Action::Do(Command::Undo));
        self.harness.step();
    }

    /// Waits until what was asked for has been opened: it is an edit.
    fn rest(&mut self) {
        let begun = Instant::now();
        let mut quiet = 0;
        while quiet < 3 {
            self.harness.step();
            quiet = if self.harness.state().is_opening() {
                0
            } else {
                quiet + 1
            };
            assert!(begun.elapsed() < PATIENCE, "it is loading for ever");
            std::thread::sleep(Duration::from_millis(4));
        }
    }

    /// Takes everything back, makes it again, and takes it back once more.
    fn undo_all(&mut self, first: &Document) {
        self.rest();
        // What was taken back last is made again, too.
        self.repeat(Command::Redo);
        let last = self.harness.document().clone();
        self.repeat(Command::Undo);
        self.assert_document(first, "undoing everything");
        self.repeat(Command::Redo);
        self.assert_document(&last, "making everything again");
        self.repeat(Command::Undo);
        self.assert_document(first, "undoing everything once more");
    }

    /// Does the same until it changes nothing.
    fn repeat(&mut self, command: Command) {
        loop {
            let before = bits(self.harness.document());
            self.harness.state_mut().request(Action::Do(command));
            self.harness.step();
            if bits(self.harness.document()) == before {
                return;
            }
        }
    }

    fn assert_document(&self, expected: &Document, what: &str) {
        let [found, expected] = [self.harness.document(), expected].map(bits);
        assert!(
            found == expected,
            "{what} gives another document:\n{found}\ninstead of\n{expected}"
        );
    }
}

/// The document as text that tells every bit of its numbers.
fn bits(document: &Document) -> String {
    serde_json::to_string(document).expect("plain values")
}

fn play(seed: u64) {
    listen();
    let (mut monkey, first) = Monkey::new(seed);
    for index in 0..EPISODE {
        monkey.act(index);
    }
    monkey.undo_all(&first);
    monkey.check();
}

/// Episodes whose numbers leave this remainder when divided by two.
fn play_all(remainder: u64) {
    if let Ok(seed) = std::env::var("GLOSSMITH_MONKEY_SEED") {
        let seed: u64 = seed.parse().expect("a number");
        if seed % 2 == remainder {
            play(seed);
        }
        return;
    }
    let begun = Instant::now();
    let mut seeds = (0..).map(|turn| 2 * turn + remainder);
    let is_enough = |seed: u64| seed >= EPISODES && begun.elapsed() >= LONGEST;
    while let Some(seed) = seeds.next().filter(|seed| !is_enough(*seed)) {
        play(seed);
    }
}

#[test]
fn whatever_is_done_nothing_breaks_and_all_can_be_undone() {
    play_all(0);
}

#[test]
fn whatever_is_done_beside_a_comparison_nothing_breaks() {
    play_all(1);
}
