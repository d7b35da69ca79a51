//! Cache of assets: models, their textures and geometry, environments.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard};

use super::error::AssetError;
use crate::import;
use crate::import::picture::read_texture;
use crate::import::{Budget, ModelError};
use crate::panics::lock;
use crate::scene::environment::{Environment, EnvironmentEncoding, EnvironmentSource};
use crate::scene::ground::Ground;
use crate::scene::texture::{Pack, TextureAssignment, Textures};
use crate::scene::{AreaShape, Geometry, Loading, Model, ModelOptions, ModelSource, Texture};

/// Key of a geometry: model, ground, area lights, hidden objects.
type GeometryKey = (ModelKey, Ground, Vec<AreaShape>, Vec<usize>);

/// Key of a model: source and options.
type ModelKey = (ModelSource, ModelOptions);

/// Key of a texture map: file, and whether it is read as colours.
type PictureKey = (PathBuf, bool);

/// A model's textures, and the user's own, each with whether its green channel is flipped.
type PackKey = (ModelKey, Vec<(PictureKey, bool)>);

/// Key of an environment: source and encoding.
type EnvironmentKey = (EnvironmentSource, EnvironmentEncoding);

/// Memory budget in bytes. The most recently used asset of each kind is kept at any size.
const MEMORY: usize = 1 << 30;

/// Geometries kept per model: each position of a dragged light makes a new one, built from one that is kept.
const GEOMETRIES_OF_MODEL: usize = 2;

/// Texture assignments that are kept.
const TEXTURES: usize = 8;

/// A cache of recently used assets, up to 1 GiB, least recently used first out. An edit that keeps a source costs nothing,
/// nor does alternating between two, as comparisons and studies do. Clones share their contents, so that two sessions with
/// the same scene load it once.
#[derive(Clone, Debug, Default)]
pub struct Assets {
    kept: Arc<Mutex<Cache>>,
    loading: Loading,
}

/// Assets after a reload.
#[derive(Clone, Debug)]
pub struct Reloaded {
    /// The model before, if known.
    pub before: Option<Arc<Model>>,
    pub model: Arc<Model>,
    pub environment: Arc<Environment>,
}

#[derive(Debug)]
struct Cache {
    models: Shelf<ModelKey, Model>,
    pictures: Shelf<PictureKey, Texture>,
    packs: Shelf<PackKey, Pack>,
    textures: Shelf<(ModelKey, Vec<TextureAssignment>), Textures>,
    geometries: Shelf<GeometryKey, Geometry>,
    environments: Shelf<EnvironmentKey, Environment>,
    /// Counts the uses.
    clock: u64,
    memory: usize,
}

impl Default for Cache {
    fn default() -> Self {
        Self {
            models: Shelf::new(Model::bytes),
            pictures: Shelf::new(Texture::bytes),
            packs: Shelf::new(Pack::bytes),
            textures: Shelf::new(Textures::bytes),
            geometries: Shelf::new(Geometry::bytes),
            environments: Shelf::new(Environment::bytes),
            clock: 0,
            memory: MEMORY,
        }
    }
}

impl Assets {
    /// Keeps within another memory, in bytes.
    pub fn within(memory: usize) -> Self {
        let kept = Cache {
            memory,
            ..Cache::default()
        };
        Self {
            kept: Arc::new(Mutex::new(kept)),
            loading: Loading::default(),
        }
    }

    /// The loading in progress, to be reported and cancelled.
    pub fn loading(&self) -> &Loading {
        &self.loading
    }

    /// A panic leaves consistent state behind: every change is a single assignment.
    fn kept(&self) -> MutexGuard<'_, Cache> {
        lock(&self.kept)
    }

    /// The model of a source, loaded if not cached.
    pub fn model(&self, source: &ModelSource, options: &ModelOptions) -> Result<Arc<Model>, AssetError> {
        let mut kept = self.kept();
        let model = kept.model(&(source.clone(), options.clone()), &self.loading)?;
        kept.tidy();
        Ok(model)
    }

    /// The packed textures of a source, with users' maps on its slots. Missing ones are reported.
    pub fn textures(
        &self,
        source: &ModelSource,
        options: &ModelOptions,
        assigned: &[TextureAssignment],
    ) -> Result<Arc<Textures>, AssetError> {
        let mut kept = self.kept();
        let textures = kept.textures((source.clone(), options.clone()), assigned, &self.loading)?;
        kept.tidy();
        Ok(textures)
    }

    /// The geometry of a source, on a ground, with area lights, without the objects that are hidden.
    pub fn geometry(
        &self,
        source: &ModelSource,
        options: &ModelOptions,
        ground: Ground,
        area_lights: Vec<AreaShape>,
        hidden: Vec<usize>,
    ) -> Result<Arc<Geometry>, AssetError> {
        let mut kept = self.kept();
        let key = ((source.clone(), options.clone()), ground, area_lights, hidden);
        let geometry = kept.geometry(key, &self.loading)?;
        kept.tidy();
        Ok(geometry)
    }

    /// The environment of a source, loaded if not cached.
    pub fn environment(
        &self,
        source: &EnvironmentSource,
        encoding: EnvironmentEncoding,
    ) -> Result<Arc<Environment>, AssetError> {
        let mut kept = self.kept();
        let environment = kept.environment(&(source.clone(), encoding), &self.loading)?;
        kept.tidy();
        Ok(environment)
    }

    /// Inserts a model as if it had been loaded from `source`.
    pub fn keep_model(&self, source: ModelSource, model: Model) {
        let key = (source, ModelOptions::default());
        let mut kept = self.kept();
        kept.packs.retain(|(of, _)| *of != key);
        kept.textures.retain(|(of, _)| *of != key);
        kept.geometries.retain(|(of, ..)| *of != key);
        let now = kept.now();
        kept.models.put(key, Arc::new(model), now);
    }

    /// The same for an environment.
    pub fn keep_environment(&self, source: EnvironmentSource, environment: Environment) {
        let key = (source, EnvironmentEncoding::default());
        let mut kept = self.kept();
        let now = kept.now();
        kept.environments.put(key, Arc::new(environment), now);
    }

    /// Reloads a model and an environment and drops all others. Returns them, and the model before. If either fails, nothing
    /// changes.
    pub fn reload(
        &self,
        source: &ModelSource,
        options: &ModelOptions,
        environment: &EnvironmentSource,
        encoding: EnvironmentEncoding,
    ) -> Result<Reloaded, AssetError> {
        let mut fresh = Cache::default();
        let (of_model, of_environment) = ((source.clone(), options.clone()), (environment.clone(), encoding));
        let model = fresh.model(&of_model, &self.loading)?;
        let environment = fresh.environment(&of_environment, &self.loading)?;
        let mut kept = self.kept();
        fresh.memory = kept.memory;
        let before = kept.models.get(&of_model, 0);
        *kept = fresh;
        Ok(Reloaded {
            before,
            model,
            environment,
        })
    }
}

impl Cache {
    fn now(&mut self) -> u64 {
        self.clock += 1;
        self.clock
    }

    fn model(&mut self, key: &ModelKey, loading: &Loading) -> Result<Arc<Model>, AssetError> {
        let now = self.now();
        if let Some(model) = self.models.get(key, now) {
            return Ok(model);
        }
        let (source, options) = key;
        let model = Arc::new(import::load_watched(source, options, loading)?);
        if let Some(summary) = model.report.summary() {
            log::warn!("{source}: {summary}");
        }
        self.models.put(key.clone(), model.clone(), now);
        Ok(model)
    }

    fn textures(
        &mut self,
        of: ModelKey,
        assigned: &[TextureAssignment],
        loading: &Loading,
    ) -> Result<Arc<Textures>, AssetError> {
        let now = self.now();
        let key = (of, assigned.to_vec());
        if let Some(textures) = self.textures.get(&key, now) {
            return Ok(textures);
        }
        let model = self.model(&key.0, loading)?;
        let textures = Arc::new(self.pack(&key.0, &model, assigned).textures(&model, assigned));
        // Each assignment is an entry of its own and takes little memory; only the last few are ever needed again.
        while self.textures.count(|_| true) >= TEXTURES {
            self.textures.drop_oldest(|_| true);
        }
        self.textures.put(key, textures.clone(), now);
        Ok(textures)
    }

    /// The packed texels of a model's and users' maps, for any mapping.
    fn pack(&mut self, of: &ModelKey, model: &Model, assigned: &[TextureAssignment]) -> Arc<Pack> {
        let now = self.now();
        let mut own: Vec<_> = assigned.iter().map(|one| (one.picture(), one.is_flipped())).collect();
        own.sort();
        own.dedup();
        let key = (of.clone(), own);
        if let Some(pack) = self.packs.get(&key, now) {
            return pack;
        }
        let pictures = RefCell::new(&mut self.pictures);
        // The user's own are of one import with the model's.
        let budget = Budget::of_import();
        let _ = budget.take((model.bytes() as u64).min(budget.left()));
        let read = |path: &Path, is_color: bool| {
            let key = (path.to_owned(), is_color);
            if let Some(picture) = pictures.borrow_mut().get(&key, now) {
                let taken = budget.take(picture.bytes() as u64);
                return taken.map(|()| picture).map_err(|over| over.to_string());
            }
            let picture = Arc::new(read_texture(path, is_color, of.1.texture_side_max, &budget)?);
            pictures.borrow_mut().put(key, picture.clone(), now);
            Ok(picture)
        };
        let pack = Arc::new(Pack::new(model, assigned, &read));
        pack.warnings().iter().for_each(|warning| log::warn!("{warning}"));
        self.packs.put(key, pack.clone(), now);
        pack
    }

    fn geometry(&mut self, key: GeometryKey, loading: &Loading) -> Result<Arc<Geometry>, AssetError> {
        let now = self.now();
        if let Some(geometry) = self.geometries.get(&key, now) {
            return Ok(geometry);
        }
        let (of_model, ground, area_lights, hidden) = &key;
        let is_of_same = |(of, _, _, without): &GeometryKey| of == of_model && without == hidden;
        let alike = match self.geometries.find(is_of_same) {
            Some(alike) => alike,
            None => {
                let model = self.model(of_model, loading)?;
                Arc::new(Geometry::of_model(&model, hidden, loading).map_err(ModelError::from)?)
            }
        };
        let geometry = Arc::new(alike.surrounded(*ground, area_lights));
        let others = |(of, ..): &GeometryKey| of == of_model;
        while self.geometries.count(others) >= GEOMETRIES_OF_MODEL {
            self.geometries.drop_oldest(others);
        }
        self.geometries.put(key, geometry.clone(), now);
        Ok(geometry)
    }

    fn environment(&mut self, key: &EnvironmentKey, loading: &Loading) -> Result<Arc<Environment>, AssetError> {
        let now = self.now();
        if let Some(environment) = self.environments.get(key, now) {
            return Ok(environment);
        }
        let environment = Arc::new(import::environment::load_watched(&key.0, key.1, loading)?);
        environment.warnings.iter().for_each(|warning| log::warn!("{warning}"));
        self.environments.put(key.clone(), environment.clone(), now);
        Ok(environment)
    }

    /// Evicts the least recently used assets until the rest fits the memory budget. Hierarchies count from when they are
    /// built.
    fn tidy(&mut self) {
        loop {
            let mut shelves: [&mut dyn Tidied; 6] = [
                &mut self.models,
                &mut self.pictures,
                &mut self.packs,
                &mut self.textures,
                &mut self.geometries,
                &mut self.environments,
            ];
            if shelves.iter().map(|shelf| shelf.bytes()).sum::<usize>() <= self.memory {
                return;
            }
            let oldest = shelves.iter_mut().filter(|shelf| shelf.spare().is_some());
            let Some(shelf) = oldest.min_by_key(|shelf| shelf.spare()) else {
                return;
            };
            shelf.drop_spare();
        }
    }
}

/// Values of one kind by their keys.
#[derive(Debug)]
struct Shelf<K, V> {
    entries: Vec<Entry<K, V>>,
    bytes_of: fn(&V) -> usize,
}

#[derive(Debug)]
struct Entry<K, V> {
    key: K,
    value: Arc<V>,
    used: u64,
}

impl<K: PartialEq, V> Shelf<K, V> {
    fn new(bytes_of: fn(&V) -> usize) -> Self {
        Self {
            entries: Vec::new(),
            bytes_of,
        }
    }

    fn get(&mut self, key: &K, now: u64) -> Option<Arc<V>> {
        let entry = self.entries.iter_mut().find(|entry| entry.key == *key)?;
        entry.used = now;
        Some(entry.value.clone())
    }

    /// Any value whose key satisfies the predicate.
    fn find(&self, is_wanted: impl Fn(&K) -> bool) -> Option<Arc<V>> {
        let entry = self.entries.iter().find(|entry| is_wanted(&entry.key))?;
        Some(entry.value.clone())
    }

    fn put(&mut self, key: K, value: Arc<V>, now: u64) {
        self.retain(|known| *known != key);
        self.entries.push(Entry { key, value, used: now });
    }

    fn retain(&mut self, stays: impl Fn(&K) -> bool) {
        self.entries.retain(|entry| stays(&entry.key));
    }

    fn count(&self, counts: impl Fn(&K) -> bool) -> usize {
        self.entries.iter().filter(|entry| counts(&entry.key)).count()
    }

    /// Drops the least recently used of some entries.
    fn drop_oldest(&mut self, among: impl Fn(&K) -> bool) {
        let candidates = self.entries.iter().filter(|entry| among(&entry.key));
        if let Some(oldest) = candidates.map(|entry| entry.used).min() {
            self.entries.retain(|entry| entry.used != oldest);
        }
    }
}

/// A shelf of any type of value.
trait Tidied {
    fn bytes(&self) -> usize;
    /// Last use of the entry to drop first, if any can be dropped: the last one of its kind can't.
    fn spare(&self) -> Option<u64>;
    fn drop_spare(&mut self);
}

impl<K: PartialEq, V> Tidied for Shelf<K, V> {
    fn bytes(&self) -> usize {
        self.entries.iter().map(|entry| (self.bytes_of)(&entry.value)).sum()
    }

    fn spare(&self) -> Option<u64> {
        let oldest = self.entries.iter().map(|entry| entry.used).min();
        oldest.filter(|_| self.entries.len() > 1)
    }

    fn drop_spare(&mut self) {
        self.drop_oldest(|_| true);
    }
}
