//! Files that are dropped on the window together, and names that are pasted.

use std::path::{Path, PathBuf};

use crate::app::App;
use crate::app::actions::Action;
use crate::import::{endings, environment, holds_model, is_model};
use crate::render::worker::Level;
use crate::scene::environment::EnvironmentSource;
use crate::scene::path_text::path_of_text;
use crate::scene::texture::{UserTexture, set};
use crate::scene::{Model, ModelOptions, ModelSource};
use crate::store::file_kind::{FileKind, may_hold_document};

/// What was dropped on the window in this frame and, where text may be taken, pasted.
pub fn handed_over(ctx: &egui::Context, takes_text: bool) -> Vec<Action> {
    ctx.input(|input| {
        let dropped: Vec<_> = input
            .raw
            .dropped_files
            .iter()
            .map(|file| file.path().to_owned())
            .collect();
        let text = |event: &egui::Event| match event {
            egui::Event::Paste(text) if takes_text && !text.trim().is_empty() => {
                Some(Action::Paste(text.trim().to_owned()))
            }
            egui::Event::PasteImage(_) if takes_text => Some(Action::PastePicture),
            _ => None,
        };
        let pasted = input.events.iter().filter_map(text);
        let files = (!dropped.is_empty()).then_some(Action::Drop(dropped));
        files.into_iter().chain(pasted).collect()
    })
}

fn name(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

/// The images in a folder, where their names say that they belong on a material.
pub fn textures_in(path: &Path) -> Vec<PathBuf> {
    if !path.is_dir() || holds_model(path) {
        return Vec::new();
    }
    let pictures = endings::pictures_in(path);
    let (found, _) = set::recognised(&pictures);
    if found.is_empty() { Vec::new() } else { pictures }
}

/// What was dropped, by what it is for.
#[derive(Debug, Default, PartialEq)]
struct Sorted {
    models: Vec<PathBuf>,
    environments: Vec<PathBuf>,
    pictures: Vec<PathBuf>,
    parts: Vec<PathBuf>,
    others: Vec<PathBuf>,
}

impl Sorted {
    fn of(paths: Vec<PathBuf>) -> Self {
        let mut sorted = Self::default();
        if environment::are_faces(&paths) && paths.len() == 6 {
            // All lie in one folder, which is opened.
            let folder = paths[0].parent().map(Path::to_owned);
            sorted.environments.extend(folder);
            return sorted;
        }
        for path in paths {
            let of_material = textures_in(&path);
            if !of_material.is_empty() {
                sorted.pictures.extend(of_material);
                continue;
            }
            let kind = match FileKind::of(&path) {
                _ if path.is_dir() && holds_model(&path) => &mut sorted.models,
                _ if path.is_dir() => &mut sorted.environments,
                Some(FileKind::Model) => &mut sorted.models,
                Some(FileKind::Light) => &mut sorted.environments,
                Some(FileKind::Picture) => &mut sorted.pictures,
                Some(FileKind::Part) => &mut sorted.parts,
                _ => &mut sorted.others,
            };
            kind.push(path);
        }
        sorted
    }
}

impl App {
    /// Takes files that were dropped together. Models are shown together; what they name is looked for among the files,
    /// too. Images are for the selected material; one may have a document in it.
    pub fn drop_files(&mut self, paths: Vec<PathBuf>) {
        if let Some(address) = paths
            .iter()
            .find_map(|path| path.to_str().filter(|text| is_address(text)))
        {
            self.refuse_address(address);
            return;
        }
        let Sorted {
            models,
            environments,
            pictures,
            parts,
            others,
        } = Sorted::of(paths);
        for path in others {
            self.open(path);
        }
        if let [shown @ .., last] = environments.as_slice() {
            for path in shown {
                let text = format!("{}: one environment at a time; {} is opened", name(path), name(last));
                self.report(Level::Warning, text);
            }
            self.worker.open_environment(EnvironmentSource::File(last.clone()));
        }
        match models.as_slice() {
            [] => self.drop_without_model(pictures, &parts),
            [first, rest @ ..] => {
                let given = rest.iter().chain(&pictures).chain(&parts);
                // What lies beside the model is found there.
                let beside = given.filter(|path| is_model(path) || path.parent() != first.parent());
                let options = ModelOptions {
                    beside: beside.cloned().collect(),
                    ..ModelOptions::default()
                };
                self.files.dropped_with = pictures.into_iter().chain(parts).collect();
                self.worker.open_model(ModelSource::File(first.clone()), options);
            }
        }
    }

    /// Opens files given at the start, models among them together; how many there are to be waited for.
    pub fn open_all(&mut self, mut paths: Vec<PathBuf>) -> usize {
        let models: Vec<PathBuf> = paths.extract_if(.., |path| is_model(path)).collect();
        let mut awaited = 0;
        if let [first, rest @ ..] = models.as_slice() {
            let options = ModelOptions {
                beside: rest.to_vec(),
                ..ModelOptions::default()
            };
            self.worker.open_model(ModelSource::File(first.clone()), options);
            awaited += 1;
        }
        awaited
            + paths
                .into_iter()
                .map(|path| usize::from(self.open(path)))
                .sum::<usize>()
    }

    /// Images by themselves: for the selected material.
    fn drop_without_model(&mut self, pictures: Vec<PathBuf>, parts: &[PathBuf]) {
        for part in parts {
            let text = format!(
                "{}: part of a model; drop it together with the .gltf or .obj that names it, or open that",
                part.display()
            );
            self.report(Level::Error, text);
        }
        if let ([picture], Some(target)) = (pictures.as_slice(), self.shared.selection.texture) {
            self.put_textures(&[(target, UserTexture::of(picture.clone()))]);
            return;
        }
        if let [picture] = pictures.as_slice()
            && may_hold_document(picture)
        {
            // It may hold a document: that is looked for first.
            self.files.dropped = Some(picture.clone());
            self.open(picture.clone());
            return;
        }
        let left = self.put_pictures(&pictures);
        self.leave_out(&left);
    }

    /// What was dropped with a model and is not part of it: images that say what they are for are assigned to its first material.
    pub fn use_dropped_with(&mut self, model: &Model) {
        let names: Vec<String> = model.files.iter().map(|path| name(path)).collect();
        let mut left = std::mem::take(&mut self.files.dropped_with);
        left.retain(|path| !names.iter().any(|known| known.eq_ignore_ascii_case(&name(path))));
        let (found, left) = set::recognised(&left);
        self.put_textures(&found);
        self.leave_out(&left);
    }

    fn leave_out(&mut self, files: &[PathBuf]) {
        for file in files {
            let text = format!(
                "{}: not used: nothing here names it, nor does its name say what it is for, as wood_roughness.png does; \
                 choose it in Material, beside its parameter",
                name(file)
            );
            self.report(Level::Warning, text);
        }
    }

    /// Opens the files whose names were pasted, one a line.
    pub fn paste(&mut self, text: &str) {
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        if let Some(address) = lines.clone().find(|line| is_address(line)) {
            self.refuse_address(address);
            return;
        }
        let paths: Vec<PathBuf> = lines.map(path_of_text).collect();
        if paths.iter().all(|path| path.exists()) {
            self.drop_files(paths);
        } else {
            let shown: String = text.chars().take(80).collect();
            self.report(Level::Warning, format!("the pasted text is not a file name: {shown}"));
        }
    }

    fn refuse_address(&mut self, address: &str) {
        let text = format!("{address}: web addresses are not opened; save the file and open it here");
        self.report(Level::Error, text);
    }
}

/// Whether a text names something that is no file of this machine.
fn is_address(text: &str) -> bool {
    let scheme = text.split_once(":/").map_or("", |(scheme, _)| scheme);
    let is_scheme = scheme.len() > 1 && scheme.chars().all(|letter| letter.is_ascii_alphanumeric());
    is_scheme && scheme != "file"
}
