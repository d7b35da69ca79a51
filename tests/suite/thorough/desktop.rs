//! A person at a screen: the real program in its window under Xvfb, with keys and mouse from xdotool.

use std::{
    fs::File,
    io::{BufRead as _, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Stdio},
    time::{Duration, Instant},
};

use glossmith::{document::Document, store::load_document};
use tempfile::TempDir;

/// A slow machine has to open a window, compile and render.
const PATIENCE: Duration = Duration::from_secs(600);
/// How often is looked whether something has happened.
const GLANCE: Duration = Duration::from_millis(30);

/// A screen, a home, and nothing else of the person's who runs the tests.
pub struct Desktop {
    server: Child,
    display: String,
    home: TempDir,
}

impl Desktop {
    pub fn new() -> Self {
        // Without -noreset the server starts over, and turns connections away, when the last of its programs ends: xdotool
        // that looks for a window which is still to come.
        let mut server = started(
            Command::new("Xvfb")
                .args([
                    "-displayfd",
                    "1",
                    "-screen",
                    "0",
                    "1440x900x24",
                    "-nolisten",
                    "tcp",
                    "-noreset",
                ])
                .stdout(Stdio::piped())
                .stderr(Stdio::null()),
            "xvfb",
        );
        let mut number = String::new();
        let output = server.stdout.take().expect("it is piped");
        BufReader::new(output)
            .read_line(&mut number)
            .expect("a display's number");
        assert!(!number.trim().is_empty(), "Xvfb has no free display");
        Self {
            server,
            display: format!(":{}", number.trim()),
            home: TempDir::new().expect("a temporary folder"),
        }
    }

    /// A place of the person's.
    pub fn path(&self, name: &str) -> PathBuf {
        self.home.path().join(name)
    }

    /// Documents put aside for after a crash.
    pub fn save_for_recovery(&self) -> Vec<Document> {
        let Ok(entries) = std::fs::read_dir(self.path("data/glossmith/recovery")) else {
            return Vec::new();
        };
        let paths = entries.flatten().map(|entry| entry.path());
        paths
            .filter(|path| path.extension().is_some_and(|ending| ending == "json"))
            .filter_map(|path| Some(load_document(&path).ok()?.value))
            .map(|document| Document {
                // What the copy knows about itself.
                extra: serde_json::Map::new(),
                ..document
            })
            .collect()
    }

    /// Starts the program and waits for its window. It finds no file dialog: its path names no programs, and there is
    /// no desktop to ask.
    pub fn start(&self, files: &[&Path], log: &str) -> Window<'_> {
        let log = self.path(log);
        let program = started(
            Command::new(crate::program())
                .args(["--engine", "cpu"])
                .args(files)
                .current_dir(self.home.path())
                .env("DISPLAY", &self.display)
                .env("HOME", self.home.path())
                .env("XDG_DATA_HOME", self.path("data"))
                .env("XDG_CONFIG_HOME", self.path("config"))
                .env("XDG_CACHE_HOME", self.path("cache"))
                .env("PATH", self.path("no programs"))
                .env("DBUS_SESSION_BUS_ADDRESS", "unix:path=/nowhere")
                .env("RUST_LOG", "glossmith=debug")
                .env_remove("WAYLAND_DISPLAY")
                .stdout(Stdio::null())
                .stderr(File::create(&log).expect("a temporary file")),
            "glossmith itself",
        );
        let mut window = Window {
            desktop: self,
            program,
            log,
            id: String::new(),
        };
        window.wait("the window", |window| {
            let found = window.xdotool(&["search", "--onlyvisible", "--name", "Glossmith"]);
            window.id = found.lines().next().unwrap_or_default().to_owned();
            !window.id.is_empty()
        });
        // There is no window manager that would give it the keys; it does not notice being given them before its first
        // frames.
        window.wait("its first frames", |window| window.said().contains("rendering with"));
        window.xdotool(&["windowfocus", "--sync", &window.id]);
        window
    }
}

impl Drop for Desktop {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// The program in its window.
pub struct Window<'a> {
    desktop: &'a Desktop,
    program: Child,
    log: PathBuf,
    id: String,
}

impl Window<'_> {
    fn xdotool(&self, arguments: &[&str]) -> String {
        let mut command = Command::new("xdotool");
        let command = command.args(arguments).env("DISPLAY", &self.desktop.display);
        let output = started(command.stdout(Stdio::piped()).stderr(Stdio::null()), "xdotool").wait_with_output();
        String::from_utf8_lossy(&output.expect("it ends").stdout).into_owned()
    }

    pub fn keys(&self, keys: &str) {
        self.xdotool(&["key", "--clearmodifiers", keys]);
    }

    pub fn write(&self, text: &str) {
        self.xdotool(&["type", "--clearmodifiers", "--delay", "8", text]);
    }

    /// The window's title.
    pub fn title(&self) -> String {
        self.xdotool(&["getwindowname", &self.id])
    }

    /// What the program has said so far.
    pub fn said(&self) -> String {
        std::fs::read_to_string(&self.log).unwrap_or_default()
    }

    pub fn wait(&mut self, what: &str, mut until: impl FnMut(&mut Self) -> bool) {
        let begun = Instant::now();
        while !until(self) {
            if let Some(status) = self.program.try_wait().expect("a child") {
                panic!("waiting for {what} the program ended: {status}\n{}", self.said());
            }
            assert!(begun.elapsed() < PATIENCE, "waited in vain for {what}\n{}", self.said());
            std::thread::sleep(GLANCE);
        }
    }

    /// Does something, and waits until the program says that it has.
    pub fn until_said(&mut self, words: &str, act: impl FnOnce(&Self)) {
        let count = |window: &Self| window.said().matches(words).count();
        let before = count(self);
        act(self);
        self.wait(words, |window| count(window) > before);
    }

    /// Chooses from the command palette by what is typed into it; `words` is what the program says to that.
    pub fn choose(&mut self, text: &str, words: &str) {
        self.until_said("Find a command", |window| window.keys("ctrl+k"));
        self.write(text);
        self.until_said(words, |window| window.keys("Return"));
    }

    /// Names a file in the field that stands in for a file dialog.
    pub fn name_file(&mut self, path: &Path) {
        self.keys("ctrl+a");
        self.write(path.to_str().expect("a name of letters"));
        self.until_said(&format!("({})", path.display()), |window| window.keys("Return"));
    }

    /// Drags with the left button from the middle of the picture until the title shows that something was changed.
    pub fn drag_until_changed(&mut self) {
        self.wait("a changed document", |window| {
            // A press during the first frames may be lost: each try has its own.
            window.xdotool(&["mousemove", "--window", &window.id, "680", "450", "mousedown", "1"]);
            for _ in 0..8 {
                window.xdotool(&["mousemove_relative", "--", "12", "3"]);
                std::thread::sleep(GLANCE);
            }
            window.xdotool(&["mouseup", "1"]);
            window.title().contains('*')
        });
    }

    /// Ends it without a warning, as a crash would.
    pub fn kill(mut self) {
        self.program.kill().expect("it runs");
        self.program.wait().expect("it ends");
    }

    /// Waits until it has ended by itself.
    pub fn ended(mut self) -> (ExitStatus, String) {
        let begun = Instant::now();
        loop {
            if let Some(status) = self.program.try_wait().expect("a child") {
                return (status, self.said());
            }
            assert!(begun.elapsed() < PATIENCE, "it does not end\n{}", self.said());
            std::thread::sleep(GLANCE);
        }
    }
}

impl Drop for Window<'_> {
    fn drop(&mut self) {
        // It has ended by itself where all went well.
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

fn started(command: &mut Command, package: &str) -> Child {
    command.spawn().unwrap_or_else(|error| {
        let program = command.get_program().display();
        panic!("{program} can't be started ({error}): scripts/setup test installs it (package {package})")
    })
}
