//! The files of a study, and its answer to the program that called.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use serde::Serialize;

use crate::cli::answer::Answer;
use crate::console::message;
use crate::plot::PlotError;
use crate::store::replace::save_atomically;

/// The folder that a study writes into, and the name that its files begin with.
pub(super) struct Folder<'a> {
    pub(super) path: &'a Path,
    pub(super) name: &'a str,
}

/// Makes the folder, and asks whether the answer can be written, before the work that fills both.
///
/// # Errors
/// What the system says.
pub(super) fn prepare(path: &Path, answer: &Answer) -> anyhow::Result<()> {
    std::fs::create_dir_all(path).with_context(|| {
        format!(
            "{}: the folder could not be made; check its name and permissions",
            path.display()
        )
    })?;
    answer.check_writable()
}

impl Folder<'_> {
    /// The numbers, whole; they are the answer, too.
    pub(super) fn json(&self, value: &impl Serialize, answer: &Answer) -> anyhow::Result<()> {
        self.write("json", (serde_json::to_string_pretty(value)? + "\n").as_bytes())?;
        answer.write(value)
    }

    /// The numbers as a table.
    pub(super) fn csv(&self, head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> anyhow::Result<()> {
        let mut text = head.join(",") + "\n";
        for row in rows {
            let cells: Vec<String> = row.iter().map(|cell| quoted(cell)).collect();
            text += &(cells.join(",") + "\n");
        }
        self.write("csv", text.as_bytes())
    }

    /// A plot, as .svg and as .png.
    pub(super) fn plots<P>(&self, plot: &P, draw: fn(&Path, &P) -> Result<Vec<u8>, PlotError>) -> anyhow::Result<()> {
        ["svg", "png"]
            .into_iter()
            .try_for_each(|ending| self.write(ending, &draw(&self.file(ending), plot)?))
    }

    fn file(&self, ending: &str) -> PathBuf {
        self.path.join(format!("{}.{ending}", self.name))
    }

    fn write(&self, ending: &str, contents: &[u8]) -> anyhow::Result<()> {
        let path = self.file(ending);
        save_atomically(&path, contents)?;
        message!("wrote {}", path.display());
        Ok(())
    }
}

/// A cell of a table, in quotes where it needs them.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}
