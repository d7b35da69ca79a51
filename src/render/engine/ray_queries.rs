//! Use of hardware ray queries.

use std::str::FromStr;

use crate::named::{Named, named};
use crate::render::chosen::Chosen;

named! {
    /// Whether kernels use ray queries instead of our own traversal.
    #[derive(Default)]
    RayQueries {
        #[default]
        Auto, "auto", "Automatic", "On a hardware GPU that has them.";
        On, "on", "On", "Wherever the adapter has them.";
        Off, "off", "Off", "Never.";
    }
}

static CHOSEN: Chosen<RayQueries> = Chosen::first();

impl RayQueries {
    /// Holds for all engines that are opened from now on.
    pub fn choose(self) {
        CHOSEN.set(self);
    }

    pub fn chosen() -> Self {
        CHOSEN.get()
    }
}

impl FromStr for RayQueries {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        Self::by_name(text).ok_or_else(|| format!("ray queries are auto, on or off, not {text}"))
    }
}
