//! What a path has met of the shadow catcher.

use super::PathResult;
use crate::optics::vector::Vec3;

/// A path's state after its camera ray hit the shadow catcher or not.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum CatcherHit {
    /// The camera ray did not hit the catcher, or a mirrored path has hit a surface.
    #[default]
    Miss,
    /// The path gathers the light at the catcher, which scales the background.
    Shadow {
        /// Whether the background is transparent, so that the light becomes alpha.
        is_transparent: bool,
    },
    /// The path was mirrored: if it escapes, it shows the background with this alpha.
    Mirrored {
        /// Linear RGB.
        background: Vec3<f32>,
        /// See [`PathResult`].
        alpha: f32,
    },
}

impl CatcherHit {
    /// True if the path's last surface was the mirroring catcher.
    pub fn is_mirrored(&self) -> bool {
        matches!(self, Self::Mirrored { .. })
    }

    /// True if the path's light becomes alpha.
    pub fn is_alpha(&self) -> bool {
        matches!(self, Self::Shadow { is_transparent: true })
    }

    /// The path's result; over a transparent background the light becomes the shadow's alpha. A render of a part of the
    /// light has no shadow.
    pub fn result(self, path: PathResult, is_all_light: bool) -> PathResult {
        if !self.is_alpha() {
            return path;
        }
        PathResult {
            alpha: match is_all_light {
                true => 1.0 - path.radiance.luminance(),
                false => 0.0,
            },
            radiance: Vec3::ZERO,
            ..path
        }
    }
}
