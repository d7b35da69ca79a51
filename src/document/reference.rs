//! An image to work from: a background plate or a photograph, under, over or beside the render.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::named::{named, with_defaults};

named! {
    /// Where a reference image is shown.
    #[derive(Default)]
    ReferencePlace {
        #[default]
        Under, "under", "Under the render", "Behind the render, as a background plate: seen where that is transparent.";
        Over, "over", "Over the render", "Over the render, as far as its opacity says.";
        Beside, "beside", "Beside the render", "In the right half of the viewport.";
    }
}

with_defaults! {
    /// A reference image, which is shown in the viewport and is no part of what is rendered or saved as an image.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default)]
    pub struct Reference {
        pub file: PathBuf,
        /// Where it is shown.
        pub place: ReferencePlace,
        /// Share of it in what is seen, in [0, 1].
        pub opacity: f32 = 1.0,
    }
}
