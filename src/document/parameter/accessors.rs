//! Rows of the tables of parameters: what each takes, and how it reads and writes the value that it stands for.

/// Parameters by key, stage where the table has several, label, help, the value by the path of its field, and what a row adds.
macro_rules! rows {
    ($($key:literal $($stage:ident)? $label:literal $help:literal $what:ident($($of:tt)*) $(.$add:ident($($with:tt)*))*;)*) => {
        vec![$(of($key, $(Stage::$stage,)? $label, $help, $what!($($of)*)) $(.$add($($with)*))*),*]
    };
}

/// A field through the variant of [`Value`](super::Value) that holds it: `field(Number lens.radius, UNIT)`.
macro_rules! field {
    ($variant:ident $($path:ident).+ $([$at:expr])?, $kind:expr) => {
        (
            $kind,
            (
                |owner| $crate::document::Value::$variant(owner.$($path).+ $([$at])?),
                |owner, value| {
                    if let $crate::document::Value::$variant(value) = value {
                        owner.$($path).+ $([$at])? = value;
                    }
                },
            ),
        )
    };
}

/// The same for a field that may be left to the program.
macro_rules! optional {
    ($variant:ident $($path:ident).+, $kind:expr) => {
        (
            $kind,
            (
                |owner| owner.$($path).+.map_or($crate::document::Value::Absent, $crate::document::Value::$variant),
                |owner, value| {
                    owner.$($path).+ = match value {
                        $crate::document::Value::$variant(value) => Some(value),
                        _ => None,
                    };
                },
            ),
        )
    };
}

macro_rules! toggle {
    ($($path:tt)+) => {
        field!(Toggle $($path)+, $crate::document::Kind::Toggle)
    };
}

macro_rules! color {
    ($($path:tt)+) => {
        field!(Color $($path)+, $crate::document::Kind::Color)
    };
}

/// One of a closed list by its name.
macro_rules! choice {
    ($type:ident $($path:tt)+) => {
        (
            $crate::document::parameter::choices::<$type>(),
            (
                |owner| $crate::document::Value::Choice(owner.$($path)+.name()),
                |owner, value| {
                    if let $crate::document::Value::Choice(name) = value
                        && let Some(choice) = $crate::named::Named::by_name(name)
                    {
                        owner.$($path)+ = choice;
                    }
                },
            ),
        )
    };
}

/// What a function of this name gives.
macro_rules! own {
    ($name:ident) => {
        $name()
    };
}

pub(super) use {choice, color, field, optional, own, rows, toggle};
