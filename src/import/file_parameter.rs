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
    /// What the file writes for 1 of the parameter: 1000 for nm of what is in µm.
    pub per: f32,
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

/// Rows by the beginning of their places: `"place" = "default" / PER "example" => GOES "where": "note" in 0.0..1.0 of "layer";`,
/// where what is usual is left out.
#[macro_export]
macro_rules! file_parameters {
    ($($prefix:literal { $(
        $key:literal $(= $default:literal)? $(/ $per:tt)? $example:expr => $goes:ident $to:tt
            $(: $note:literal)? $(in $least:literal..$most:literal)? $(of $layer:literal)?;
    )* })*) => {
        &[$($(
            $crate::FileParameter::$goes(concat!($prefix, $key), concat!($($default)?), $example, $to)
                $(.with_note($note))? $(.within($least, $most))? $(.of($layer))? $(.per($per))?,
        )*)*]
    };
}

impl FileParameter {
    const fn new(place: &'static str, default: &'static str, example: &'static str, goes: Goes) -> Self {
        Self {
            place,
            default,
            example,
            range: None,
            per: 1.0,
            layer: "",
            goes,
            note: "",
        }
    }

    pub const fn to(place: &'static str, default: &'static str, example: &'static str, to: &'static str) -> Self {
        Self::new(place, default, example, Goes::To(to))
    }

    /// The same for what lies between 0 and 1.
    pub const fn share(place: &'static str, default: &'static str, example: &'static str, to: &'static str) -> Self {
        Self::to(place, default, example, to).within(0.0, 1.0)
    }

    pub const fn kept(place: &'static str, default: &'static str, example: &'static str, key: &'static str) -> Self {
        Self::new(place, default, example, Goes::Kept(key))
    }

    pub const fn nowhere(place: &'static str, default: &'static str, example: &'static str, why: &'static str) -> Self {
        Self::new(place, default, example, Goes::Nowhere(why))
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

    /// The parameter in another unit.
    #[must_use]
    pub const fn per(mut self, per: f32) -> Self {
        self.per = per;
        self
    }

    /// The key of the first parameter that it goes to, and of the second.
    pub fn keys(&self) -> [&'static str; 2] {
        let Goes::To(to) = self.goes else { return [""; 2] };
        let (first, rest) = to.split_once(", ").unwrap_or((to, ""));
        [first, rest]
    }

    /// What the file's parameter is worth that is left out: a number three times, or the first three of a list.
    pub fn default_value(&self) -> Option<[f32; 3]> {
        let number = |text: &str| match text.trim() {
            "false" => Some(0.0),
            text => text.parse().ok(),
        };
        let list = self.default.trim_matches(['[', ']']).split(',');
        let numbers: Vec<f32> = list.map(number).collect::<Option<_>>()?;
        numbers.first_chunk().copied().or(Some([*numbers.first()?; 3]))
    }

    /// Whether it is a list of numbers.
    pub fn is_list(&self) -> bool {
        self.default.contains(',')
    }

    /// The parameter with a note on its approximation.
    #[must_use]
    pub const fn with_note(mut self, note: &'static str) -> Self {
        self.note = note;
        self
    }
}
