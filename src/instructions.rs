//! The instruction set that the CPU engine computes with.

use std::sync::OnceLock;

use fearless_simd::Level;

use crate::named::named;

named! {
    /// An instruction set. What is computed does not depend on it, to the last bit; how fast does.
    #[derive(Default)]
    Instructions {
        #[default]
        Auto, "auto", "Automatic", "The best that this processor has.";
        Avx512, "avx512", "AVX-512", "Those of recent Intel and AMD processors (Ice Lake, Zen 4 and later).";
        Avx2, "avx2", "AVX2", "Those of Intel and AMD processors since 2013.";
        Neon, "neon", "NEON", "Those of 64-bit ARM processors.";
        Portable, "portable", "Portable", "Those that every processor has that the program was built for.";
    }
}

/// What was asked for, once for the whole process.
static ASKED_FOR: OnceLock<Level> = OnceLock::new();

/// An instruction set was asked for that this processor does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("this processor has no {} instructions: take auto or {}", .0.label(), available())]
pub struct Missing(pub Instructions);

impl Instructions {
    /// The instruction set itself; `None` if the CPU does not have it.
    pub fn level(self) -> Option<Level> {
        let best = Level::new();
        match self {
            Self::Auto => Some(best),
            Self::Portable => Some(Level::baseline()),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => best.as_avx512().map(Level::Avx512),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => best.as_avx2().map(Level::Avx2),
            #[cfg(target_arch = "aarch64")]
            Self::Neon => best.as_neon().map(Level::Neon),
            _ => None,
        }
    }

    /// Has the whole process compute with these instructions. To be called before anything is computed: later calls
    /// change nothing.
    ///
    /// # Errors
    /// If the CPU does not have them; the message names those that it has.
    pub fn force(self) -> Result<(), Missing> {
        let level = self.level().ok_or(Missing(self))?;
        ASKED_FOR.get_or_init(|| level);
        Ok(())
    }
}

/// The instructions to compute with: those asked for, else the best there are.
#[inline]
pub fn level() -> Level {
    *ASKED_FOR.get_or_init(Level::new)
}

/// Name of the instruction set in use.
pub fn instruction_set() -> &'static str {
    let is_it = |choice: &&Instructions| {
        let found = choice.level().filter(|_| **choice != Instructions::Auto);
        found.is_some_and(|found| std::mem::discriminant(&found) == std::mem::discriminant(&level()))
    };
    Instructions::ALL.iter().find(is_it).map_or("", |choice| choice.name())
}

/// The names of the instruction sets that this processor has.
fn available() -> String {
    let is_here = |choice: &&Instructions| **choice != Instructions::Auto && choice.level().is_some();
    let names = Instructions::ALL.iter().filter(is_here).map(|choice| choice.name());
    crate::named::joined(names, " or ")
}
