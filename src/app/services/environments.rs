//! The environments to choose from: those that come with the program, and the files opened last, with thumbnails.

use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use egui::{ColorImage, TextureHandle, TextureOptions};

use crate::app::services::beside::started;
use crate::render::environment_thumbnails::{
    EnvironmentThumbnailWorker, EnvironmentThumbnails, SIZE, Wanted, spawn_environment_thumbnails,
};
use crate::scene::environment::{Environment, EnvironmentSource};

/// What to call an environment in a menu.
pub fn environment_label(source: &EnvironmentSource) -> String {
    match source {
        EnvironmentSource::File(path) => path.file_name().map_or_else(
            || path.display().to_string(),
            |name| name.to_string_lossy().into_owned(),
        ),
        other => other.built_in().map_or("", |built_in| built_in.label).to_owned(),
    }
}

/// The thumbnails of environments.
#[derive(Default)]
pub struct Environments {
    cache: Option<PathBuf>,
    /// Set while the viewport goes first.
    hold: Arc<AtomicBool>,
    worker: Option<EnvironmentThumbnailWorker>,
    has_failed: bool,
    /// What each part of the window shows.
    wanted: BTreeMap<&'static str, Vec<EnvironmentSource>>,
    /// What was asked for last, and the environment that was there then.
    asked: Option<(Vec<EnvironmentSource>, Option<Arc<Environment>>)>,
    textures: HashMap<EnvironmentSource, TextureHandle>,
    uploaded: Option<EnvironmentThumbnails>,
}

impl Environments {
    /// `cache` keeps the images from one start to the next; nothing is made while `hold` is set.
    pub fn new(cache: Option<PathBuf>, hold: Arc<AtomicBool>) -> Self {
        Self {
            cache,
            hold,
            ..Self::default()
        }
    }

    /// The image of an environment.
    pub fn picture(&self, source: &EnvironmentSource) -> Option<&TextureHandle> {
        self.textures.get(source)
    }

    /// The pixels of that image, red, green, blue and alpha.
    pub fn pixels(&self, source: &EnvironmentSource) -> Option<&[u8]> {
        self.uploaded.as_ref()?.get(source)?.as_deref().map(Vec::as_slice)
    }

    /// Whether its file is not there or can't be read.
    pub fn is_missing(&self, source: &EnvironmentSource) -> bool {
        let known = self.uploaded.as_ref().and_then(|made| made.get(source));
        known.is_some_and(Option::is_none)
    }

    /// Asks for the images of what a part of the window shows, besides those that others do, and takes those that are there.
    /// `loaded` is the environment in use, with where it comes from. To be called while they are seen.
    pub fn make_pictures(
        &mut self,
        ctx: &egui::Context,
        (shown_by, shown): (&'static str, &[EnvironmentSource]),
        loaded: Option<(&EnvironmentSource, &Arc<Environment>)>,
    ) {
        if self.has_failed {
            return;
        }
        let worker = started(&mut self.worker, ctx, |repaint| {
            let folder = self.cache.as_ref().map(|cache| cache.join("environments"));
            spawn_environment_thumbnails(folder, self.hold.clone(), repaint)
        });
        let Some(worker) = worker else {
            self.has_failed = true;
            return;
        };
        if self.wanted.get(shown_by).is_none_or(|before| before != shown) {
            self.wanted.insert(shown_by, shown.to_vec());
        }
        let mut sources: Vec<EnvironmentSource> = Vec::new();
        for source in self.wanted.values().flatten() {
            if !sources.contains(source) {
                sources.push(source.clone());
            }
        }
        let is_asked = self.asked.as_ref().is_some_and(|(asked, with)| {
            let is_same = match (with, loaded) {
                (Some(with), Some((_, environment))) => Arc::ptr_eq(with, environment),
                (with, loaded) => with.is_none() && loaded.is_none(),
            };
            is_same && *asked == sources
        });
        if !is_asked {
            let wanted = sources.iter().map(|source| Wanted {
                source: source.clone(),
                loaded: loaded
                    .filter(|(of, _)| *of == source)
                    .map(|(_, environment)| environment.clone()),
            });
            worker.ask(wanted.collect());
            self.asked = Some((sources, loaded.map(|(_, environment)| environment.clone())));
        }
        let Some(made) = worker.latest() else {
            return;
        };
        let before = self.uploaded.replace(made.clone());
        if before.as_ref().is_some_and(|before| Arc::ptr_eq(before, &made)) {
            return;
        }
        for (source, pixels) in made.iter() {
            let known = before.as_ref().and_then(|before| before.get(source));
            let Some(pixels) = pixels
                .as_ref()
                .filter(|_| known.and_then(Option::as_ref) != pixels.as_ref())
            else {
                continue;
            };
            let image = ColorImage::from_rgba_unmultiplied(SIZE.map(|side| side as usize), pixels);
            let texture = ctx.load_texture("environment", image, TextureOptions::LINEAR);
            self.textures.insert(source.clone(), texture);
        }
    }
}
