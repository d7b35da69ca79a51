//! Files for other programs, made before anybody is asked whether to write them.

use std::path::Path;

use crate::render::looks::{Compared, compared};
use crate::store::exchange::{self, Prepared, Registered, Subject};

/// Materials of which balls are rendered: a model's may be hundreds.
const COMPARED_MAX: usize = 4;

/// A file that is ready to be written, with images of what it loses.
pub struct Ready {
    pub prepared: Prepared,
    /// One for each material, where there is something to show.
    pub compared: Vec<Option<Compared>>,
}

/// Makes the file of a subject.
pub fn ready(subject: &Subject, name: &str, path: &Path, format: &Registered) -> Result<Ready, String> {
    let mut prepared = exchange::prepare(subject, name, path, format).map_err(crate::in_words)?;
    let mut pictures: Vec<Option<Compared>> = Vec::new();
    for material in prepared.report.materials.iter_mut().take(COMPARED_MAX) {
        let of_both = material.looks.as_ref().map(|looks| compared(looks)).transpose();
        let of_both = of_both.map_err(crate::in_words)?;
        material.difference = of_both.as_ref().map(|compared| compared.difference);
        pictures.push(of_both);
    }
    pictures.resize(prepared.report.materials.len(), None);
    Ok(Ready {
        prepared,
        compared: pictures,
    })
}
