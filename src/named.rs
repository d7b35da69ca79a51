//! Choices that have a name in files and on the command line, a label in menus and a sentence of help.

/// One of a closed list of choices.
pub trait Named: Copy + PartialEq + Sized + 'static {
    /// Every choice, in the order of the menus.
    const ALL: &'static [Self];

    /// Name in files and on the command line.
    fn name(self) -> &'static str;

    /// Name in the menus.
    fn label(self) -> &'static str;

    /// What it means, or when to choose it.
    fn help(self) -> &'static str;

    /// The number that the shaders know it by.
    fn number(self) -> u32;

    /// The choice of this name.
    fn by_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|choice| choice.name() == name)
    }
}

/// The choice of this name, or what there is to choose from.
pub fn parse<T: Named>(name: &str) -> Result<T, String> {
    T::by_name(name).ok_or_else(|| format!("expected one of {}", names::<T>()))
}

pub fn names<T: Named>() -> String {
    joined(T::ALL.iter().map(|choice| choice.name()), ", ")
}

/// The items as one text, with `between` between them.
pub fn joined<T: ToString>(items: impl IntoIterator<Item = T>, between: &str) -> String {
    let texts: Vec<String> = items.into_iter().map(|item| item.to_string()).collect();
    texts.join(between)
}

/// Declares an enum of choices, one line each: `Variant = number, "name", "Label", "Help.";`. The number is the one that
/// the shaders know it by; it may be left out. In files a choice stands by its name.
#[macro_export]
macro_rules! named {
    ($(#[$doc:meta])* $type:ident {
        $($(#[$attribute:meta])* $variant:ident $(= $index:literal)?, $name:literal, $label:literal, $help:literal;)*
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
        #[repr(u32)]
        pub enum $type {
            $(#[doc = $help] #[serde(rename = $name)] $(#[$attribute])* $variant $(= $index)?,)*
        }

        impl $type {
            /// Every one, in the order of the menus.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// Name in files and on the command line.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// Name in the menus.
            pub const fn label(self) -> &'static str {
                match self { $(Self::$variant => $label,)* }
            }

            pub const fn help(self) -> &'static str {
                match self { $(Self::$variant => $help,)* }
            }
        }

        impl std::str::FromStr for $type {
            type Err = String;

            fn from_str(name: &str) -> Result<Self, String> {
                $crate::named::parse(name)
            }
        }

        impl $crate::named::Named for $type {
            const ALL: &'static [Self] = Self::ALL;

            fn name(self) -> &'static str {
                self.name()
            }

            fn label(self) -> &'static str {
                self.label()
            }

            fn help(self) -> &'static str {
                self.help()
            }

            fn number(self) -> u32 {
                self as u32
            }
        }
    };
}

/// A struct whose fields have the defaults that stand behind them, else those of their types.
#[macro_export]
macro_rules! with_defaults {
    (@) => {
        Default::default()
    };
    (@ $default:expr) => {
        $default
    };
    ($(#[$meta:meta])* pub struct $name:ident {
        $($(#[$field_meta:meta])* $vis:vis $field:ident: $type:ty $(= $default:expr)?,)*
    }) => {
        $(#[$meta])*
        pub struct $name {
            $($(#[$field_meta])* $vis $field: $type,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self {
                    $($field: $crate::with_defaults!(@ $($default)?),)*
                }
            }
        }
    };
}

pub use crate::{named, with_defaults};
