//! What becomes of each number of a file's material: rows of the tables in docs/FORMATS.md, which importers read.

/// A parameter of a file, and what becomes of it.
#[derive(Clone, Copy, Debug)]
pub struct FileParameter {
    /// Where a material has it.
    pub place: &'static str,
    /// What it is where a file leaves it out, as the format writes it; empty where it is then not there.
    pub default: &'static str,
    /// A value off its default, as the format writes it.
    pub example: &'static str,
    /// The least and the largest number that is shown; others are taken as the nearer one, which the report tells.
    pub range: Option<[f32; 2]>,
    /// The parameter without which it shows nothing; empty where it always counts.
    pub layer: &'static str,
    /// Where it goes.
    pub goes: Goes,
    /// What is approximated; empty where it is shown as it is.
    pub note: &'static str,
}

/// Where a parameter of a file goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goes {
    /// Into these parameters of a material.
    To(&'static str),
    /// Into the material's file, for when it can be shown.
    Kept(&'static str),
    /// Nowhere; the report says these words.
    Nowhere(&'static str),
}

impl FileParameter {
    /// A parameter of any range that counts by itself and is shown as it is.
    pub const fn new(place: &'static str, default: &'static str, example: &'static str, goes: Goes) -> Self {
        Self {
            place,
            default,
            example,
            range: None,
            layer: "",
            goes,
            note: "",
        }
    }

    /// The same with the least and the largest number that is shown.
    #[must_use]
    pub const fn within(mut self, least: f32, most: f32) -> Self {
        self.range = Some([least, most]);
        self
    }

    /// The same as part of a layer, by the parameter that is its weight.
    #[must_use]
    pub const fn of(mut self, layer: &'static str) -> Self {
        self.layer = layer;
        self
    }

    /// The same with what is approximated.
    #[must_use]
    pub const fn with_note(mut self, note: &'static str) -> Self {
        self.note = note;
        self
    }
}
