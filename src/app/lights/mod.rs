//! Area lights as they are seen and moved in a view of the scene; no widget draws here.

mod handle;
mod motion;

pub use handle::{LightHandle, handles, nudged, pulled};
pub use motion::{Pull, View, put_in_view};
