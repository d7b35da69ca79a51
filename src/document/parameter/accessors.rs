//! Rows of the tables of parameters: what each takes, and how it reads and writes the value that it stands for.

use super::Value;

/// Parameters by key, stage where the table has several, label, help, the value by the path of its field, and what a row adds.
macro_rules! rows {
    ($($key:literal $($stage:ident)? $label:literal $help:literal $what:ident($($of:tt)*) $(.$add:ident($($with:tt)*))*;)*) => {
        vec![$(of($key, $(Stage::$stage,)? $label, $help, $what!($($of)*)) $(.$add($($with)*))*),*]
    };
}

/// A field by its path: `field(lens.radius, real(RADIUS, ""))`.
macro_rules! field {
    ($($path:ident).+ $([$at:expr])?, $kind:expr) => {
        (
            $kind,
            (
                |owner| $crate::document::parameter::accessors::Field::value(&owner.$($path).+ $([$at])?),
                |owner, value| $crate::document::parameter::accessors::Field::take(&mut owner.$($path).+ $([$at])?, value),
            ),
        )
    };
}

macro_rules! toggle {
    ($($path:tt)+) => {
        field!($($path)+, $crate::document::Kind::Toggle)
    };
}

/// A number between 0 and 1.
macro_rules! share {
    ($path:ident) => {
        field!($path, single(0.0..=1.0, ""))
    };
}

macro_rules! color {
    ($($path:tt)+) => {
        field!($($path)+, $crate::document::Kind::Color { most: 1.0 })
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

pub(super) use {choice, color, field, own, rows, share, toggle};

/// A field of a document that a [`Value`] stands for.
pub trait Field {
    fn value(&self) -> Value;
    /// Nothing changes where the value is of another kind.
    fn take(&mut self, value: Value);
}

/// Types with the variant of [`Value`] that holds them, and the ways there and back.
macro_rules! fields {
    ($($type:ty, $variant:ident($x:ident) $value:expr, $back:expr;)*) => {
        $(impl Field for $type {
            fn value(&self) -> Value {
                let $x = *self;
                Value::$variant($value)
            }

            fn take(&mut self, value: Value) {
                if let Value::$variant($x) = value {
                    *self = $back;
                }
            }
        })*
    };
}

fields! {
    f32, Number(x) x.into(), x as f32;
    f64, Number(x) x, x;
    u32, Number(x) x.into(), x as u32;
    bool, Toggle(x) x, x;
    [f32; 3], Color(x) x, x;
    [f64; 3], Place(x) x, x;
}

/// What may be left to the program.
impl<F: Field + Default> Field for Option<F> {
    fn value(&self) -> Value {
        self.as_ref().map_or(Value::Absent, F::value)
    }

    fn take(&mut self, value: Value) {
        *self = (value != Value::Absent).then(F::default);
        if let Some(field) = self {
            field.take(value);
        }
    }
}
