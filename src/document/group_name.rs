//! Names of light groups.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Letters of a group's name at most.
pub const NAME_MAX: usize = 24;

/// The name of a light group, part of a layer's name: letters, digits, `-` and `_`; empty for the one that a light has by
/// its kind.
#[derive(Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "String", into = "String")]
pub struct GroupName {
    letters: [u8; NAME_MAX],
    length: u8,
}

impl GroupName {
    /// The name nearest to a text: spaces become `-`, and what no name may have is left out.
    pub fn new(text: &str) -> Self {
        let spaced = text.chars().map(|letter| if letter == ' ' { '-' } else { letter });
        let allowed = spaced.filter(|letter| letter.is_ascii_alphanumeric() || matches!(letter, '-' | '_'));
        let mut name = Self::default();
        for (place, letter) in name.letters.iter_mut().zip(allowed) {
            *place = letter as u8;
            name.length += 1;
        }
        name
    }

    /// The name as text.
    pub fn as_str(&self) -> &str {
        std::str::from_utf8(&self.letters[..usize::from(self.length)]).unwrap_or_default()
    }

    /// Whether a light goes by its kind.
    pub fn is_empty(&self) -> bool {
        self.length == 0
    }
}

impl From<String> for GroupName {
    fn from(text: String) -> Self {
        Self::new(&text)
    }
}

impl From<GroupName> for String {
    fn from(name: GroupName) -> Self {
        name.as_str().to_owned()
    }
}

impl fmt::Display for GroupName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Debug for GroupName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.as_str())
    }
}
