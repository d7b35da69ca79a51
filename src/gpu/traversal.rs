//! Traversal methods of kernels.

use crate::named::named;

named! {
    /// Traversal method of a kernel. Hits are the same but for rounding at edges.
    #[derive(Default)]
    Traversal {
        #[default]
        Own, "own", "our own traversal", "Through a BVH of our own, by arithmetic that every adapter has.";
        RayQueries, "ray-queries", "ray queries", "Through the adapter's own hierarchy, by its hardware where it has some for that.";
    }
}

impl Traversal {
    /// The module of `shaders/` that has it.
    pub fn module(self) -> &'static str {
        match self {
            Self::Own => "scene/bvh",
            Self::RayQueries => "scene/ray_query",
        }
    }
}
