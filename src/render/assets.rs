//! What a document names and a session keeps: models, their geometry, environments.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::session::SessionError;
use crate::scene::environment::{self, Environment, EnvironmentSource};
use crate::scene::light::AreaShape;
use crate::scene::texture::Textures;
use crate::scene::{self, Geometry, Model, ModelSource};

/// What a geometry is made of: model, ground, area lights.
type GeometryKey = (ModelSource, bool, Vec<AreaShape>);

/// The last of each kind that was asked for: an edit that leaves a source alone costs nothing. Clones share what they
/// keep, so that two sessions with the same scene load it once.
#[derive(Clone, Debug, Default)]
pub struct Assets(Arc<Mutex<Kept>>);

#[derive(Debug, Default)]
struct Kept {
    model: Option<(ModelSource, Arc<Model>)>,
    textures: Option<(ModelSource, Arc<Textures>)>,
    geometry: Option<(GeometryKey, Arc<Geometry>)>,
    environment: Option<(EnvironmentSource, Arc<Environment>)>,
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
    pub fn model(&self, source: &ModelSource) -> Result<Arc<Model>, SessionError> {
        self.kept().model(source)
    }

    /// The textures of a source, packed.
    ///
    /// # Errors
    /// As [`Assets::model`].
    pub fn textures(&self, source: &ModelSource) -> Result<Arc<Textures>, SessionError> {
        self.kept().textures(source)
    }

    /// The geometry of a source, with or without ground, with area lights.
    ///
    /// # Errors
    /// As [`Assets::model`].
    pub fn geometry(
        &self,
        source: &ModelSource,
        ground: bool,
        area_lights: Vec<AreaShape>,
    ) -> Result<Arc<Geometry>, SessionError> {
        self.kept().geometry(source, ground, area_lights)
    }

    /// The environment of a source.
    ///
    /// # Errors
    /// Names the file, what is wrong with it and what to do.
    pub fn environment(&self, source: &EnvironmentSource) -> Result<Arc<Environment>, SessionError> {
        self.kept().environment(source)
    }

    /// Keeps a model under a name of its own, as if it had been loaded from there, until another one is asked for.
    pub fn keep_model(&self, source: ModelSource, model: Model) {
        let mut kept = self.kept();
        (kept.textures, kept.geometry) = (None, None);
        kept.model = Some((source, Arc::new(model)));
    }

    /// The same for an environment.
    pub fn keep_environment(&self, source: EnvironmentSource, environment: Environment) {
        self.kept().environment = Some((source, Arc::new(environment)));
    }

    /// Forgets files, so that they are read again.
    pub fn reload(&self) {
        *self.kept() = Kept::default();
    }
}

impl Kept {
    fn model(&mut self, source: &ModelSource) -> Result<Arc<Model>, SessionError> {
        if let Some((_, model)) = self.model.as_ref().filter(|(of, _)| of == source) {
            return Ok(model.clone());
        }
        let model = Arc::new(scene::load(source)?);
        if let Some(summary) = model.report.summary() {
            log::warn!("{source}: {summary}");
        }
        self.model = Some((source.clone(), model.clone()));
        Ok(model)
    }

    fn textures(&mut self, source: &ModelSource) -> Result<Arc<Textures>, SessionError> {
        if let Some((_, textures)) = self.textures.as_ref().filter(|(of, _)| of == source) {
            return Ok(textures.clone());
        }
        let textures = Arc::new(Textures::new(&*self.model(source)?));
        textures.warnings.iter().for_each(|warning| log::warn!("{warning}"));
        self.textures = Some((source.clone(), textures.clone()));
        Ok(textures)
    }

    fn geometry(
        &mut self,
        source: &ModelSource,
        ground: bool,
        area_lights: Vec<AreaShape>,
    ) -> Result<Arc<Geometry>, SessionError> {
        let key = (source.clone(), ground, area_lights);
        if let Some((_, geometry)) = self.geometry.as_ref().filter(|(of, _)| *of == key) {
            return Ok(geometry.clone());
        }
        let geometry = Arc::new(Geometry::build_lit(&*self.model(source)?, ground, &key.2));
        self.geometry = Some((key, geometry.clone()));
        Ok(geometry)
    }

    fn environment(&mut self, source: &EnvironmentSource) -> Result<Arc<Environment>, SessionError> {
        if let Some((_, environment)) = self.environment.as_ref().filter(|(of, _)| of == source) {
            return Ok(environment.clone());
        }
        let environment = Arc::new(environment::load(source)?);
        environment.warnings.iter().for_each(|warning| log::warn!("{warning}"));
        self.environment = Some((source.clone(), environment.clone()));
        Ok(environment)
    }
}
