//! Names on the command line, looked up in the registries.

use crate::analysis::lobe_view::ViewKind;
use crate::document::turntable::Turn;
use crate::document::{ImportLobe, PixelFilter, Strategy};
use crate::optics::curve::Curve;
use crate::optics::lobe::{Horizon, Lobe};
use crate::optics::random::Sequence;
use crate::optics::tone::ToneCurve;

/// The entry of a registry with this name.
fn by_name<E: Copy>(all: &[E], name: fn(E) -> &'static str, text: &str) -> Result<E, String> {
    let names = || all.iter().map(|&entry| name(entry)).collect::<Vec<_>>().join(", ");
    all.iter()
        .copied()
        .find(|&entry| name(entry) == text)
        .ok_or_else(|| format!("expected one of {}", names()))
}

/// A parser for the names of a registry.
macro_rules! parsers {
    ($($parser:ident: $registry:ident;)*) => {
        $(
            /// The entry with this name.
            pub(super) fn $parser(text: &str) -> Result<$registry, String> {
                by_name($registry::ALL, $registry::name, text)
            }
        )*
    };
}

parsers! {
    filter: PixelFilter;
    strategy: Strategy;
    tone: ToneCurve;
    sequence: Sequence;
    import_lobe: ImportLobe;
    lobe: Lobe;
    curve: Curve;
    horizon: Horizon;
    view_kind: ViewKind;
    turn: Turn;
}
