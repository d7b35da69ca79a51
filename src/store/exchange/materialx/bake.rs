//! Graphs that compute, baked by MaterialX's own tools where they are installed: each input of a surface to its mean.

use std::collections::HashMap;
use std::ffi::OsString;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use roxmltree::Document;

use super::graph::{shaders, worth};
use super::images::Images;
use crate::scene::Loading;

/// The program of MaterialX, and the folder that it lies in where [`TOOLS_VARIABLE`] does not say another.
const PROGRAM: &str = "baketextures";
const TOOLS_FOLDER: &str = "format-tools";
/// The variable that names the folder of the formats' tools.
const TOOLS_VARIABLE: &str = "GLOSSMITH_TOOLS";
/// Side of the images whose means are taken, pixels.
const SIDE: &str = "128";
/// Longest time that it may take.
const PATIENCE: Duration = Duration::from_secs(60);

/// A document whose graphs are baked when they are first asked for.
pub(super) struct Baker<'a> {
    path: &'a Path,
    baked: Option<Result<Values, String>>,
}

/// Values by the names of materials and inputs.
type Values = HashMap<(String, String), [f32; 3]>;

impl<'a> Baker<'a> {
    pub(super) fn of(path: &'a Path) -> Self {
        Self { path, baked: None }
    }

    /// The mean of an input of a material's surface.
    pub(super) fn mean(&mut self, material: &str, input: &str) -> Result<[f32; 3], String> {
        let path = self.path;
        let baked = self
            .baked
            .get_or_insert_with(|| bake(path))
            .as_ref()
            .map_err(Clone::clone)?;
        let found = baked.get(&(material.to_owned(), input.to_owned()));
        found
            .copied()
            .ok_or_else(|| format!("{PROGRAM} of MaterialX leaves it as it is"))
    }
}

/// Where the program is.
fn program() -> Option<PathBuf> {
    let of_folder = |folder: PathBuf| folder.join("bin").join(PROGRAM);
    let named = std::env::var_os(TOOLS_VARIABLE).map(|folder| of_folder(folder.into()));
    let data = directories::ProjectDirs::from("", "", "glossmith");
    let installed = data.map(|folders| of_folder(folders.data_local_dir().join(TOOLS_FOLDER)));
    let places = named.into_iter().chain(installed);
    places.chain(in_path(PROGRAM)).find(|path| path.is_file())
}

fn in_path(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path)
        // A relative folder is seen from the current one, where what was downloaded may lie.
        .filter(|folder| folder.is_absolute())
        .map(|folder| folder.join(name))
        .find(|path| path.is_file())
}

/// How the program is started: it draws with OpenGL, which needs a display on Linux, and a virtual one will do.
fn command(program: PathBuf) -> Result<Command, String> {
    let has_display = !cfg!(target_os = "linux") || std::env::var_os("DISPLAY").is_some_and(|name| !name.is_empty());
    if has_display {
        return Ok(Command::new(program));
    }
    let Some(virtual_display) = in_path("xvfb-run") else {
        return Err(format!("{PROGRAM} of MaterialX needs a display, or xvfb-run"));
    };
    let mut command = Command::new(virtual_display);
    command.arg("-a").arg(program);
    Ok(command)
}

fn bake(path: &Path) -> Result<Values, String> {
    if crate::import::endings::ending(path) != "mtlx" {
        return Err(format!("{PROGRAM} of MaterialX reads files of its own alone"));
    }
    let Some(program) = program() else {
        return Err("MaterialX's tools would bake it: pip install materialx".to_owned());
    };
    let folder = tempfile::tempdir().map_err(crate::in_words)?;
    let output = run(command(program)?, path, folder.path())?;
    if let Some(missing) = output.split("Image file not found: ").nth(1) {
        let name = missing.lines().next().unwrap_or_default();
        return Err(format!("{name} is not there"));
    }
    let text = std::fs::read_to_string(folder.path().join("baked.mtlx")).map_err(|_| {
        let last = output.lines().last().unwrap_or("no word");
        format!("{PROGRAM} of MaterialX failed: {last}")
    })?;
    let document = Document::parse(&text).map_err(crate::in_words)?;
    let mut values = Values::new();
    let loading = Loading::default();
    let images = Images::in_folder(folder.path(), &loading);
    for shader in shaders(document.root_element()) {
        let name = shader
            .material
            .unwrap_or(shader.node)
            .attribute("name")
            .unwrap_or_default();
        for input in shader.node.children().filter(|node| node.has_tag_name("input")) {
            if let (Some(key), Ok(Some(found))) = (input.attribute("name"), worth(input, &shader.within, &images)) {
                values.insert((name.to_owned(), key.to_owned()), found.color());
            }
        }
    }
    Ok(values)
}

/// Runs it and gives back its words.
fn run(mut command: Command, path: &Path, folder: &Path) -> Result<String, String> {
    let path = std::path::absolute(path).map_err(crate::in_words)?;
    let words = folder.join("words.txt");
    let options = [
        "--width",
        SIDE,
        "--height",
        SIDE,
        "--hdr",
        "--average",
        "--writeDocumentPerMaterial",
        "false",
    ];
    command.args(options.map(OsString::from)).arg(path).arg("baked.mtlx");
    let started = File::create(&words).and_then(|log| {
        command.stdout(log.try_clone()?).stderr(log);
        command.stdin(Stdio::null()).current_dir(folder).spawn()
    });
    let mut child = started.map_err(|error| format!("{PROGRAM} of MaterialX: {error}"))?;
    let begun = Instant::now();
    while child.try_wait().map_err(crate::in_words)?.is_none() {
        if begun.elapsed() > PATIENCE {
            let _ = child.kill();
            let _ = child.wait();
            return Err(format!(
                "{PROGRAM} of MaterialX took longer than {} s",
                PATIENCE.as_secs()
            ));
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    Ok(std::fs::read_to_string(words).unwrap_or_default())
}
