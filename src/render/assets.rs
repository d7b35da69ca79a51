//! What a document names and a session keeps: models, their geometry, environments.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::session::SessionError;
use crate::scene::environment::{self, Environment, EnvironmentEncoding, EnvironmentSource};
use crate::scene::light::AreaShape;
use crate::scene::texture::Textures;
use crate::scene::{self, Geometry, Model, ModelOptions, ModelSource};

/// What a geometry is made of: model, ground, area lights.
type GeometryKey = (ModelKey, bool, Vec<AreaShape>);

/// A model's file, and what is shown of it.
type ModelKey = (ModelSource, ModelOptions);

/// An environment's file, and what its numbers stand for.
type EnvironmentKey = (EnvironmentSource, EnvironmentEncoding);

/// The last of each kind that was asked for: an edit that leaves a source alone costs nothing. Clones share what they
/// keep, so that two sessions with the same scene load it once.
#[derive(Clone, Debug, Default)]
pub struct Assets(Arc<Mutex<Kept>>);

#[derive(Debug, Default)]
struct Kept {
    model: Option<(ModelKey, Arc<Model>)>,
    textures: Option<(ModelKey, Arc<Textures>)>,
    geometry: Option<(GeometryKey, Arc<Geometry>)>,
    environment: Option<(EnvironmentKey, Arc<Environment>)>,
}

impl Assets {
    /// What a panic left is whole: every change is a single assignment.
    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The model of a source, loaded unless it is the last one.
    ///
    /// # Errors
    /// Names the file, what is wrong with it and what to do.
    pub fn model(&self, source: &ModelSource, options: &ModelOptions) -> Result<Arc<Model>, SessionError> {
        self.kept().model(&(source.clone(), options.clone()))
    }

    /// The textures of a source, packed.
    ///
    /// # Errors
    /// As [`Assets::model`].
    pub fn textures(&self, source: &ModelSource, options: &ModelOptions) -> Result<Arc<Textures>, SessionError> {
        self.kept().textures(&(source.clone(), options.clone()))
    }

    /// The geometry of a source, with or without ground, with area lights.
    ///
    /// # Errors
    /// As [`Assets::model`].
    pub fn geometry(
        &self,
        source: &ModelSource,
        options: &ModelOptions,
        ground: bool,
        area_lights: Vec<AreaShape>,
    ) -> Result<Arc<Geometry>, SessionError> {
        let key = ((source.clone(), options.clone()), ground, area_lights);
        self.kept().geometry(key)
    }

    /// The environment of a source.
    ///
    /// # Errors
    /// Names the file, what is wrong with it and what to do.
    pub fn environment(
        &self,
        source: &EnvironmentSource,
        encoding: EnvironmentEncoding,
    ) -> Result<Arc<Environment>, SessionError> {
        self.kept().environment(&(source.clone(), encoding))
    }

    /// Keeps a model under a name of its own, as if it had been loaded from there, until another one is asked for.
    pub fn keep_model(&self, source: ModelSource, model: Model) {
        let mut kept = self.kept();
        (kept.textures, kept.geometry) = (None, None);
        kept.model = Some(((source, ModelOptions::default()), Arc::new(model)));
    }

    /// The same for an environment.
    pub fn keep_environment(&self, source: EnvironmentSource, environment: Environment) {
        let key = (source, EnvironmentEncoding::default());
        self.kept().environment = Some((key, Arc::new(environment)));
    }

    /// Forgets files, so that they are read again.
    pub fn reload(&self) {
        *self.kept() = Kept::default();
    }
}

impl Kept {
    fn model(&mut self, key: &ModelKey) -> Result<Arc<Model>, SessionError> {
        if let Some((_, model)) = self.model.as_ref().filter(|(of, _)| of == key) {
            return Ok(model.clone());
        }
        let (source, options) = key;
        let model = Arc::new(scene::load_with(source, options)?);
        if let Some(summary) = model.report.summary() {
            log::warn!("{source}: {summary}");
        }
        self.model = Some((key.clone(), model.clone()));
        Ok(model)
    }

    fn textures(&mut self, key: &ModelKey) -> Result<Arc<Textures>, SessionError> {
        if let Some((_, textures)) = self.textures.as_ref().filter(|(of, _)| of == key) {
            return Ok(textures.clone());
        }
        let textures = Arc::new(Textures::new(&*self.model(key)?));
        textures.warnings.iter().for_each(|warning| log::warn!("{warning}"));
        self.textures = Some((key.clone(), textures.clone()));
        Ok(textures)
    }

    fn geometry(&mut self, key: GeometryKey) -> Result<Arc<Geometry>, SessionError> {
        if let Some((_, geometry)) = self.geometry.as_ref().filter(|(of, _)| *of == key) {
            return Ok(geometry.clone());
        }
        let (model, ground, area_lights) = &key;
        let geometry = Arc::new(Geometry::build_lit(&*self.model(model)?, *ground, area_lights));
        self.geometry = Some((key, geometry.clone()));
        Ok(geometry)
    }

    fn environment(&mut self, key: &EnvironmentKey) -> Result<Arc<Environment>, SessionError> {
        if let Some((_, environment)) = self.environment.as_ref().filter(|(of, _)| of == key) {
            return Ok(environment.clone());
        }
        let environment = Arc::new(environment::load_encoded(&key.0, key.1)?);
        environment.warnings.iter().for_each(|warning| log::warn!("{warning}"));
        self.environment = Some((key.clone(), environment.clone()));
        Ok(environment)
    }
}
