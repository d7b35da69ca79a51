//! The editor window.

use std::path::PathBuf;

use crate::render::EngineChoice;

/// Opens the editor.
///
/// # Errors
/// Where no window can be opened.
pub fn run(_files: Vec<PathBuf>, _engine: EngineChoice) -> anyhow::Result<()> {
    anyhow::bail!("the window is not there yet")
}
