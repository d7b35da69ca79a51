//! What became of a material on its way into another program's format, as a value and in words.

use std::{fmt, path::PathBuf};

use serde::Serialize;

use crate::{document::MaterialSettings, scene::path_text};

/// What became of a part of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// It is there as it was.
    Exact,
    /// Something near it is there.
    Approximated,
    /// The format has no place for it.
    Dropped,
}

impl Outcome {
    /// As it is said.
    pub fn word(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Approximated => "approximated",
            Self::Dropped => "dropped",
        }
    }
}

/// All parts of a material.
pub const EVERYTHING: &str = "everything";

/// A part of a material and what became of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Entry {
    /// What became of it.
    pub outcome: Outcome,
    pub what: String,
    /// By what it is replaced, or why it is left out; empty where it is exact.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub detail: String,
    /// How far off it is.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub residual: Option<Residual>,
}

/// How far an approximation is off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Residual {
    /// How far, in [0, 1].
    pub residual: f64,
    pub measure: &'static str,
}

impl Residual {
    /// Total variation: the share of the light that goes elsewhere.
    pub fn total_variation(residual: f64) -> Self {
        Self {
            residual,
            measure: "total variation",
        }
    }

    /// The largest difference of a reflectance, over angles and colours.
    pub fn reflectance(residual: f64) -> Self {
        Self {
            residual,
            measure: "largest difference of the reflectance",
        }
    }
}

impl Entry {
    /// A part that is as it was.
    pub fn exact(what: impl Into<String>) -> Self {
        Self {
            outcome: Outcome::Exact,
            what: what.into(),
            detail: String::new(),
            residual: None,
        }
    }

    /// A part that something near it stands for.
    pub fn approximated(what: impl Into<String>, detail: impl Into<String>, residual: Option<Residual>) -> Self {
        Self {
            outcome: Outcome::Approximated,
            what: what.into(),
            detail: detail.into(),
            residual,
        }
    }

    /// What of a material is left out where its specular lobe alone is written.
    pub fn all_but_the_lobe(detail: &str) -> Self {
        Self::dropped("colours, base, coat, refraction", detail)
    }

    /// A part that is left out.
    pub fn dropped(what: impl Into<String>, detail: impl Into<String>) -> Self {
        Self {
            outcome: Outcome::Dropped,
            what: what.into(),
            detail: detail.into(),
            residual: None,
        }
    }
}

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:<13} {}", self.outcome.word(), self.what)?;
        if !self.detail.is_empty() {
            write!(f, ": {}", self.detail)?;
        }
        match self.residual {
            Some(Residual { residual, measure }) => write!(f, " ({measure} {residual:.3})"),
            None => Ok(()),
        }
    }
}

/// What became of a material.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MaterialReport {
    pub material: String,
    /// The file also has the exact parameters, by which it can be opened again without loss.
    pub carries_exact_parameters: bool,
    /// What became of its parts.
    pub entries: Vec<Entry>,
    /// The material, and the one that the file shows; none where it shows no material.
    #[serde(skip)]
    pub looks: Option<Box<[MaterialSettings; 2]>>,
    /// How far images of a ball with the one and the other are apart, where they were rendered: the root mean square of
    /// the difference over the mean brightness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub difference: Option<f64>,
}

impl MaterialReport {
    /// Of a file that also has the exact parameters, and shows nothing that could be rendered.
    pub fn of(material: &MaterialSettings, entries: Vec<Entry>) -> Self {
        Self {
            material: material.name.clone(),
            carries_exact_parameters: true,
            entries,
            looks: None,
            difference: None,
        }
    }

    /// The worst that became of a part.
    pub fn worst(&self) -> Outcome {
        let outcomes = self.entries.iter().map(|entry| entry.outcome);
        outcomes.max().unwrap_or(Outcome::Exact)
    }
}

/// What became of a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The file or the shipped material that was read.
    pub input: String,
    /// The file that was written.
    #[serde(serialize_with = "path_text::serialize")]
    pub output: PathBuf,
    /// The name of its format.
    pub format: &'static str,
    /// What became of the materials.
    pub materials: Vec<MaterialReport>,
}

impl Report {
    /// How many parts came to this, over all materials.
    pub fn count(&self, outcome: Outcome) -> usize {
        let entries = self.materials.iter().flat_map(|material| &material.entries);
        entries.filter(|entry| entry.outcome == outcome).count()
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} as {}", self.input, self.output.display())?;
        for material in &self.materials {
            let also = if material.carries_exact_parameters {
                "; the exact parameters travel with it"
            } else {
                ""
            };
            write!(f, "\n  {}{also}", material.material)?;
            for entry in &material.entries {
                write!(f, "\n    {entry}")?;
            }
            if let Some(difference) = material.difference {
                write!(f, "\n    two balls differ by {:.1} %", 100.0 * difference)?;
            }
        }
        Ok(())
    }
}
