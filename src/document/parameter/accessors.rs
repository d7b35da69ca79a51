//! How parameters read and write the value that they stand for, by the path of its field.

/// Reads and writes a field through the variant of [`Value`](super::Value) that holds it: `field!(Number lens.radius)`.
macro_rules! field {
    ($variant:ident $($path:tt)+) => {
        (
            |owner| $crate::document::Value::$variant(owner.$($path)+),
            |owner, value| {
                if let $crate::document::Value::$variant(value) = value {
                    owner.$($path)+ = value;
                }
            },
        )
    };
}

/// The same for a field that may be left to the program.
macro_rules! optional {
    ($variant:ident $($path:tt)+) => {
        (
            |owner| owner.$($path)+.map_or($crate::document::Value::Absent, $crate::document::Value::$variant),
            |owner, value| {
                owner.$($path)+ = match value {
                    $crate::document::Value::$variant(value) => Some(value),
                    _ => None,
                };
            },
        )
    };
}

/// Reads and writes one of a closed list by its name.
macro_rules! choice {
    ($($path:tt)+) => {
        (
            |owner| $crate::document::Value::Choice(owner.$($path)+.name()),
            |owner, value| {
                if let $crate::document::Value::Choice(name) = value
                    && let Some(choice) = $crate::named::Named::by_name(name)
                {
                    owner.$($path)+ = choice;
                }
            },
        )
    };
}

pub(super) use {choice, field, optional};
