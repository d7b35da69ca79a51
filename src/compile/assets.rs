//! Cache of assets: models, their textures and geometry, environments.

use std::{any::Any, cell::RefCell, fmt::Debug, mem::discriminant, path::Path, path::PathBuf, sync::Arc, sync::Mutex};

use super::error::AssetError;
use crate::{
    import,
    import::{Budget, ModelError, picture::read_texture},
    panics::lock,
    scene::{
        AreaShape, Geometry, Loading, Model, ModelOptions, ModelSource, Texture,
        environment::{Environment, EnvironmentEncoding, EnvironmentSource},
        ground::Ground,
        texture::{Pack, Textures, UserTexture, UserTextures},
    },
};

/// Key of a model: source and options.
type ModelKey = (ModelSource, ModelOptions);

/// What an asset is made from.
#[derive(Clone, Debug, PartialEq)]
enum Key {
    Model(ModelKey),
    /// A texture map: file, and whether it is read as colours.
    Picture(PathBuf, bool),
    /// A model's textures, and the user's own, each with whether it is read as colours and whether its green channel is flipped.
    Pack(ModelKey, Vec<(PathBuf, bool, bool)>),
    Textures(ModelKey, Vec<UserTextures>),
    /// Model, ground, area lights, hidden objects.
    Geometry(ModelKey, Ground, Vec<AreaShape>, Vec<usize>),
    Environment(EnvironmentSource, EnvironmentEncoding),
}

/// What is kept.
trait Asset: Any + Send + Sync + Debug {
    fn bytes(&self) -> usize;
}

macro_rules! assets {
    ($($type:ident)*) => {
        $(impl Asset for $type {
            fn bytes(&self) -> usize {
                $type::bytes(self)
            }
        })*
    };
}

assets! { Model Texture Pack Textures Geometry Environment }

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
    entries: Vec<CachedAsset>,
    /// Counts the uses.
    clock: u64,
    memory: usize,
}

#[derive(Debug)]
struct CachedAsset {
    key: Key,
    value: Arc<dyn Asset>,
    used: u64,
}

impl Default for Cache {
    fn default() -> Self {
        Self {
            entries: Vec::new(),
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

    /// What is found in the cache, which is tidied then. A panic leaves consistent state behind: every change is a single
    /// assignment.
    fn had<V>(&self, find: impl FnOnce(&mut Cache) -> Result<Arc<V>, AssetError>) -> Result<Arc<V>, AssetError> {
        let mut kept = lock(&self.kept);
        let found = find(&mut kept)?;
        kept.tidy();
        Ok(found)
    }

    /// The model of a source, loaded if not cached.
    pub fn model(&self, source: &ModelSource, options: &ModelOptions) -> Result<Arc<Model>, AssetError> {
        self.had(|kept| kept.model((source.clone(), options.clone()), &self.loading))
    }

    /// The packed textures of a source, with users' maps on its slots. Missing ones are reported.
    pub fn textures(
        &self,
        source: &ModelSource,
        options: &ModelOptions,
        assigned: &[UserTextures],
    ) -> Result<Arc<Textures>, AssetError> {
        self.had(|kept| kept.textures((source.clone(), options.clone()), assigned, &self.loading))
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
        let of_model = (source.clone(), options.clone());
        self.had(|kept| kept.geometry(of_model, ground, area_lights, hidden, &self.loading))
    }

    /// The environment of a source, loaded if not cached.
    pub fn environment(
        &self,
        source: &EnvironmentSource,
        encoding: EnvironmentEncoding,
    ) -> Result<Arc<Environment>, AssetError> {
        self.had(|kept| kept.environment(source.clone(), encoding, &self.loading))
    }

    /// Inserts a model as if it had been loaded from `source`.
    pub fn keep_model(&self, source: ModelSource, model: Model) {
        let key = (source, ModelOptions::default());
        let mut kept = lock(&self.kept);
        kept.entries.retain(|entry| match &entry.key {
            Key::Pack(of, _) | Key::Textures(of, _) | Key::Geometry(of, ..) => *of != key,
            _ => true,
        });
        kept.put(Key::Model(key), model);
    }

    /// The same for an environment.
    pub fn keep_environment(&self, source: EnvironmentSource, environment: Environment) {
        let key = Key::Environment(source, EnvironmentEncoding::default());
        lock(&self.kept).put(key, environment);
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
        let of_model = (source.clone(), options.clone());
        let model = fresh.model(of_model.clone(), &self.loading)?;
        let environment = fresh.environment(environment.clone(), encoding, &self.loading)?;
        let mut kept = lock(&self.kept);
        fresh.memory = kept.memory;
        let before = kept.get(&Key::Model(of_model));
        *kept = fresh;
        Ok(Reloaded {
            before,
            model,
            environment,
        })
    }
}

impl Cache {
    fn get<V: Asset>(&mut self, key: &Key) -> Option<Arc<V>> {
        let entry = self.entries.iter_mut().find(|entry| entry.key == *key)?;
        self.clock += 1;
        entry.used = self.clock;
        let value: Arc<dyn Any + Send + Sync> = entry.value.clone();
        value.downcast().ok()
    }

    fn put<V: Asset>(&mut self, key: Key, value: V) -> Arc<V> {
        let value = Arc::new(value);
        self.entries.retain(|entry| entry.key != key);
        self.clock += 1;
        self.entries.push(CachedAsset {
            key,
            value: value.clone(),
            used: self.clock,
        });
        value
    }

    /// Drops the least recently used of some entries, so that fewer than `most` stay.
    fn keep_fewer(&mut self, most: usize, among: impl Fn(&Key) -> bool) {
        let mut uses: Vec<u64> = self
            .entries
            .iter()
            .filter(|entry| among(&entry.key))
            .map(|entry| entry.used)
            .collect();
        uses.sort_unstable();
        let dropped = (uses.len() + 1).saturating_sub(most);
        self.entries.retain(|entry| !uses[..dropped].contains(&entry.used));
    }

    fn model(&mut self, key: ModelKey, loading: &Loading) -> Result<Arc<Model>, AssetError> {
        let (source, options) = &key;
        let known = Key::Model(key.clone());
        if let Some(model) = self.get(&known) {
            return Ok(model);
        }
        let model = import::load_watched(source, options, loading)?;
        if let Some(summary) = model.report.summary() {
            log::warn!("{source}: {summary}");
        }
        Ok(self.put(known, model))
    }

    fn textures(
        &mut self,
        of: ModelKey,
        assigned: &[UserTextures],
        loading: &Loading,
    ) -> Result<Arc<Textures>, AssetError> {
        let key = Key::Textures(of.clone(), assigned.to_vec());
        if let Some(textures) = self.get(&key) {
            return Ok(textures);
        }
        let model = self.model(of.clone(), loading)?;
        let textures = self.pack(of, &model, assigned).textures(&model, assigned);
        // Each assignment is an entry of its own and takes little memory; only the last few are ever needed again.
        self.keep_fewer(TEXTURES, |key| matches!(key, Key::Textures(..)));
        Ok(self.put(key, textures))
    }

    /// The packed texels of a model's and users' maps, for any mapping.
    fn pack(&mut self, of: ModelKey, model: &Model, assigned: &[UserTextures]) -> Arc<Pack> {
        let picture = |(target, texture): (_, &UserTexture)| {
            (
                texture.file.clone(),
                texture.is_srgb(target),
                texture.is_flipped(target),
            )
        };
        let mut own: Vec<_> = assigned.iter().flat_map(UserTextures::iter).map(picture).collect();
        own.sort();
        own.dedup();
        let side_max = of.1.texture_side_max;
        let key = Key::Pack(of, own);
        if let Some(pack) = self.get(&key) {
            return pack;
        }
        // The user's own are of one import with the model's.
        let budget = Budget::of_import();
        let _ = budget.take((model.bytes() as u64).min(budget.left()));
        let cache = RefCell::new(&mut *self);
        let read = |path: &Path, is_color: bool| {
            let key = Key::Picture(path.to_owned(), is_color);
            if let Some(picture) = cache.borrow_mut().get::<Texture>(&key) {
                let taken = budget.take(picture.bytes() as u64);
                return taken.map(|()| picture).map_err(|over| over.to_string());
            }
            let picture = read_texture(path, is_color, side_max, &budget)?;
            Ok(cache.borrow_mut().put(key, picture))
        };
        let pack = Pack::new(model, assigned, &read);
        pack.warnings().iter().for_each(|warning| log::warn!("{warning}"));
        self.put(key, pack)
    }

    fn geometry(
        &mut self,
        of: ModelKey,
        ground: Ground,
        area_lights: Vec<AreaShape>,
        hidden: Vec<usize>,
        loading: &Loading,
    ) -> Result<Arc<Geometry>, AssetError> {
        let key = Key::Geometry(of.clone(), ground, area_lights.clone(), hidden.clone());
        if let Some(geometry) = self.get(&key) {
            return Ok(geometry);
        }
        let of_same = self
            .entries
            .iter()
            .map(|entry| &entry.key)
            .find(|key| matches!(key, Key::Geometry(other, _, _, without) if *other == of && *without == hidden));
        let alike = of_same.cloned().and_then(|alike| self.get::<Geometry>(&alike));
        let alike = match alike {
            Some(alike) => alike,
            None => {
                let model = self.model(of.clone(), loading)?;
                Arc::new(Geometry::of_model(&model, &hidden, loading).map_err(ModelError::from)?)
            }
        };
        let geometry = alike.surrounded(ground, &area_lights);
        self.keep_fewer(
            GEOMETRIES_OF_MODEL,
            |key| matches!(key, Key::Geometry(other, ..) if *other == of),
        );
        Ok(self.put(key, geometry))
    }

    fn environment(
        &mut self,
        source: EnvironmentSource,
        encoding: EnvironmentEncoding,
        loading: &Loading,
    ) -> Result<Arc<Environment>, AssetError> {
        let key = Key::Environment(source.clone(), encoding);
        if let Some(environment) = self.get(&key) {
            return Ok(environment);
        }
        let environment = import::environment::load_watched(&source, encoding, loading)?;
        let warnings = environment.warnings.iter();
        warnings.for_each(|warning| log::warn!("{source}: {warning}"));
        Ok(self.put(key, environment))
    }

    /// Evicts the least recently used assets until the rest fits the memory budget, but for the last one of each kind. Hierarchies
    /// count from when they are built.
    fn tidy(&mut self) {
        while self.entries.iter().map(|entry| entry.value.bytes()).sum::<usize>() > self.memory {
            let has_others = |entry: &&CachedAsset| {
                let is_alike = |other: &&CachedAsset| discriminant(&other.key) == discriminant(&entry.key);
                self.entries.iter().filter(is_alike).count() > 1
            };
            let spare = self.entries.iter().filter(has_others);
            let Some(oldest) = spare.map(|entry| entry.used).min() else {
                return;
            };
            self.entries.retain(|entry| entry.used != oldest);
        }
    }
}
