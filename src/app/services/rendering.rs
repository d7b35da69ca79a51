//! What the viewport's renderer is set to beside the document.

use std::path::Path;

use crate::render::{EngineChoice, RayQueries};
use crate::study::references::ReferenceCache;

/// The engine that renders, and when it rests.
pub(in crate::app) struct Rendering {
    /// The engine that was asked for, and the one that is remembered: the command line's is not.
    pub(in crate::app) engine: EngineChoice,
    pub(in crate::app) kept_engine: EngineChoice,
    /// Whether the GPU's engine uses ray queries, as it is remembered.
    pub(in crate::app) kept_ray_queries: RayQueries,
    /// Rendering was stopped by hand.
    pub(in crate::app) is_paused: bool,
    /// A study measures, for which it rests.
    pub(in crate::app) is_measuring: bool,
    /// Converged images to measure against.
    pub(in crate::app) references: ReferenceCache,
}

impl Rendering {
    /// Renders with an engine; `kept` is remembered. Converged images are kept in the folder `cache`.
    pub(in crate::app) fn new(engine: EngineChoice, kept: (EngineChoice, RayQueries), cache: Option<&Path>) -> Self {
        let (kept_engine, kept_ray_queries) = kept;
        let references = cache.map(|cache| ReferenceCache::at(cache.join("references")));
        Self {
            engine,
            kept_engine,
            kept_ray_queries,
            is_paused: false,
            is_measuring: false,
            references: references.unwrap_or_else(ReferenceCache::none),
        }
    }
}
