//! Names on the command line.

use crate::named::Named;

/// The choice of this name; the parser of every option that takes one of a closed list.
pub(super) fn choice<T: Named>(text: &str) -> Result<T, String> {
    let names = || T::ALL.iter().map(|choice| choice.name()).collect::<Vec<_>>().join(", ");
    T::by_name(text).ok_or_else(|| format!("expected one of {}", names()))
}
