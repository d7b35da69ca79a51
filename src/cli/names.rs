//! Names on the command line.

use crate::named::Named;

/// The choice of this name; the parser of every option that takes one of a closed list.
pub(super) use crate::named::parse as choice;

pub fn names<T: Named>() -> String {
    T::ALL.iter().map(|choice| choice.name()).collect::<Vec<_>>().join(", ")
}
