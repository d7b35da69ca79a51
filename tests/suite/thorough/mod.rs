//! What is random, long, or needs other programs: `make test-thorough`, which switches on the feature `thorough`.

use super::*;

#[cfg(unix)]
mod bounded;
mod denoise_cases;
mod denoise_libraries;
mod desktop;
mod exchange_samplers;
mod exchange_tools;
mod farm;
mod fuzz_documents;
mod installed;
mod monkey;
mod monkey_deeds;
mod screenshots;
mod tutorials;
mod xdotool_session;
