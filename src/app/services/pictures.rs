//! The thumbnails of materials and environments that the window shows.

use std::{
    collections::HashMap,
    path::PathBuf,
    sync::Arc,
    sync::atomic::{AtomicBool, Ordering},
};

use egui::{ColorImage, TextureHandle, TextureOptions};
use image::RgbaImage;

use crate::{
    document::MaterialSettings,
    render::thumbnails::{Subject, Thumbnail, Thumbnails, Wanted, makes},
    scene::environment::{Environment, EnvironmentSource},
    services::beside::Beside,
};

/// What shows thumbnails: the first come first.
#[derive(Clone, Copy)]
pub enum Part {
    Light,
    Document,
    Browser,
}

/// An image on the GPU.
pub fn uploaded(ctx: &egui::Context, picture: &RgbaImage) -> TextureHandle {
    let size = [picture.width() as usize, picture.height() as usize];
    let image = ColorImage::from_rgba_unmultiplied(size, picture);
    ctx.load_texture("picture", image, TextureOptions::LINEAR)
}

/// Each is known by a key: a path, `preset:gold`, `environment:studio`.
#[derive(Default)]
pub struct Pictures {
    /// Keeps them from one start to the next; without it none are made of materials.
    cache: Option<PathBuf>,
    hold: Arc<AtomicBool>,
    worker: Beside<Wanted, Thumbnails>,
    /// By the part that shows them.
    wanted: [Vec<(String, Subject)>; 3],
    is_asked: bool,
    loaded: Option<Arc<Environment>>,
    latest: Thumbnails,
    textures: HashMap<String, (Thumbnail, Option<TextureHandle>)>,
}

impl Pictures {
    pub fn new(cache: Option<PathBuf>) -> Self {
        Self {
            cache,
            hold: Arc::new(AtomicBool::new(true)),
            ..Self::default()
        }
    }

    /// Whether they have to wait.
    pub fn hold(&self, is_held: bool) {
        self.hold.store(is_held, Ordering::Relaxed);
    }

    pub fn texture(&self, key: &str) -> Option<&TextureHandle> {
        self.textures.get(key)?.1.as_ref()
    }

    pub fn image(&self, key: &str) -> Option<&Arc<RgbaImage>> {
        self.textures.get(key)?.0.as_ref()
    }

    /// Whether its file is not there or can't be read.
    pub fn is_missing(&self, key: &str) -> bool {
        self.textures.get(key).is_some_and(|(made, _)| made.is_none())
    }

    /// What a part of the window shows now.
    pub fn want(&mut self, part: Part, subjects: impl Iterator<Item = (String, Subject)>) {
        let subjects: Vec<_> = subjects.collect();
        if self.wanted[part as usize] != subjects {
            self.wanted[part as usize] = subjects;
            self.is_asked = false;
        }
    }

    /// Those of the document's materials. While they are edited they are those from before.
    pub fn of_document(&mut self, materials: &[MaterialSettings], is_in_flow: bool) -> Vec<Option<TextureHandle>> {
        let keyed = |(slot, material): (usize, &MaterialSettings)| {
            (
                format!("{slot} {}", material.name),
                Subject::Material(Box::new(material.clone())),
            )
        };
        let keyed: Vec<_> = materials.iter().enumerate().map(keyed).collect();
        let pictures = keyed.iter().map(|(key, _)| self.texture(key).cloned()).collect();
        if !is_in_flow {
            self.want(Part::Document, keyed.into_iter());
        }
        pictures
    }

    /// Asks for those that are not there yet, and takes those that are; `loaded` is the environment in use.
    pub fn make(&mut self, ctx: &egui::Context, loaded: Option<(&EnvironmentSource, &Arc<Environment>)>) {
        if self.wanted.iter().all(Vec::is_empty) {
            return;
        }
        let environment = loaded.map(|(_, environment)| environment);
        let is_loaded = environment.map(Arc::as_ptr) == self.loaded.as_ref().map(Arc::as_ptr);
        if !self.is_asked || !is_loaded {
            let mut subjects: Vec<(String, Subject)> = Vec::new();
            for wanted in self.wanted.iter().flatten() {
                let is_environment = matches!(wanted.1, Subject::Environment(_));
                if (is_environment || self.cache.is_some()) && !subjects.contains(wanted) {
                    subjects.push(wanted.clone());
                }
            }
            // Environments are made soonest.
            subjects.sort_by_key(|(_, subject)| matches!(subject, Subject::Material(_)));
            let loaded = loaded.map(|(source, environment)| (source.clone(), environment.clone()));
            let work = makes(self.cache.clone(), self.hold.clone());
            self.worker
                .ask_again(ctx, "thumbnails", Wanted { subjects, loaded }, work);
            self.loaded = environment.cloned();
            self.is_asked = true;
        }
        let Some(made) = self.worker.latest().filter(|made| !Arc::ptr_eq(made, &self.latest)) else {
            return;
        };
        for (key, thumbnail) in made.iter() {
            let place = |thumbnail: &Thumbnail| thumbnail.as_ref().map(Arc::as_ptr);
            if self
                .textures
                .get(key)
                .is_some_and(|(known, _)| place(known) == place(thumbnail))
            {
                continue;
            }
            let texture = thumbnail.as_ref().map(|picture| uploaded(ctx, picture));
            self.textures.insert(key.clone(), (thumbnail.clone(), texture));
        }
        self.latest = made;
        // The panels are drawn already.
        ctx.request_repaint();
    }
}
