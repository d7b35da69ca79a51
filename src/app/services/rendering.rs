//! What the viewport's renderer is set to beside the document.

use crate::render::{EngineChoice, RayQueries};

/// The engine that renders, and when it rests.
pub struct Rendering {
    /// The engine that was asked for, and the one that is remembered: the command line's is not.
    pub engine: EngineChoice,
    pub kept_engine: EngineChoice,
    /// Whether the GPU's engine uses ray queries, as it is remembered.
    pub kept_ray_queries: RayQueries,
    /// Rendering was stopped by hand.
    pub is_paused: bool,
    /// A study measures, for which it rests.
    pub is_measuring: bool,
}

impl Rendering {
    /// Renders with an engine; `kept` is remembered.
    pub fn new(engine: EngineChoice, kept: (EngineChoice, RayQueries)) -> Self {
        let (kept_engine, kept_ray_queries) = kept;
        Self {
            engine,
            kept_engine,
            kept_ray_queries,
            is_paused: false,
            is_measuring: false,
        }
    }
}
