//! Use of hardware ray queries.

use std::str::FromStr;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use crate::named::{Named, named};

named! {
    /// Whether kernels use ray queries instead of our own traversal.
    #[derive(Default)]
    RayQueries {
        #[default]
        Auto, "auto", "Automatic", "Where they were measured to be faster on this adapter and driver.";
        On, "on", "On", "Wherever the adapter has them.";
        Off, "off", "Off", "Never.";
    }
}

/// The process-wide choice, as a number.
static CHOSEN: AtomicU32 = AtomicU32::new(RayQueries::Auto as u32);

impl RayQueries {
    /// Holds for all engines that are opened from now on.
    pub fn choose(self) {
        CHOSEN.store(self as u32, Relaxed);
    }

    /// The latest choice.
    pub fn chosen() -> Self {
        let number = CHOSEN.load(Relaxed);
        let is_it = |choice: &&Self| **choice as u32 == number;
        Self::ALL.iter().find(is_it).copied().unwrap_or_default()
    }
}

impl FromStr for RayQueries {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        Self::by_name(text).ok_or_else(|| format!("ray queries are auto, on or off, not {text}"))
    }
}
