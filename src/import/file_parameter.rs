//! Fates of material parameters in files: rows of the tables in docs/FORMATS.md, which importers read.

/// A parameter of a file, and its fate.
#[derive(Clone, Copy, Debug)]
pub struct FileParameter {
    /// Path in a material.
    pub place: &'static str,
    /// Default value in the format's notation; empty for none.
    pub default: &'static str,
    /// A value off its default, as the format writes it.
    pub example: &'static str,
    /// Supported range; values outside are clamped and reported.
    pub range: Option<[f32; 2]>,
    /// Weight parameter that it depends on; empty for none.
    pub layer: &'static str,
    pub goes: Goes,
    /// Approximation; empty for an exact import.
    pub note: &'static str,
}

/// Destination of a file's parameter.
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

    /// The parameter with a supported range.
    #[must_use]
    pub const fn within(mut self, least: f32, most: f32) -> Self {
        self.range = Some([least, most]);
        self
    }

    /// The parameter as part of a layer, by the layer's weight.
    #[must_use]
    pub const fn of(mut self, layer: &'static str) -> Self {
        self.layer = layer;
        self
    }

    /// The parameter with a note on its approximation.
    #[must_use]
    pub const fn with_note(mut self, note: &'static str) -> Self {
        self.note = note;
        self
    }
}
