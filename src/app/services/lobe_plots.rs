//! What the plots of lobes and of their samples share.

use std::path::PathBuf;

/// The angle between view and normal at first, degrees.
pub const VIEW_ANGLE_DEG: f32 = 45.0;

/// What the plots of lobes and of their samples share.
#[derive(Clone, Debug)]
pub struct LobePlots {
    /// The angle between view and normal, degrees.
    pub view_angle_deg: f32,
    /// The file of a measured material, to compare lobes with.
    pub measured: Option<PathBuf>,
}

impl Default for LobePlots {
    fn default() -> Self {
        Self {
            view_angle_deg: VIEW_ANGLE_DEG,
            measured: None,
        }
    }
}
