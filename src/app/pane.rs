//! The list of the panels, and what is known of each without its code.

use serde::{Deserialize, Serialize};

/// Where a panel is docked at first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Home {
    UpperLeft,
    LowerLeft,
    UpperRight,
    LowerRight,
}

/// Hands the list of the panels to a macro: name in saved layouts, title of the tab, where it is docked at first, and the
/// module in `src/app/panels/` with the type that it is. A line here is all that a new file there needs.
macro_rules! list {
    ($make:ident) => {
        $make! {
            /// Materials to start from.
            Presets, "Presets", UpperLeft, presets::PresetsPanel;
            /// Objects, materials, lights and cameras.
            Scene, "Scene", UpperLeft, scene::ScenePanel;
            /// Pinned states.
            Snapshots, "Snapshots", UpperLeft, snapshots::SnapshotsPanel;
            /// Renders that go on beside.
            Queue, "Queue", UpperLeft, queue::QueuePanel;
            /// Environment, background, ground.
            Lighting, "Light", LowerLeft, lighting::LightingPanel;
            /// Camera, view and render settings.
            Camera, "Camera & image", LowerLeft, camera::CameraPanel;
            /// What is simulated, why, and what it costs.
            Effects, "Effects", LowerLeft, effects::EffectsPanel;
            /// Techniques against each other.
            Race, "Race", LowerLeft, race::RacePanel;
            /// The material's parameters.
            Material, "Material", UpperRight, material::MaterialPanel;
            /// The proof on this machine.
            Check, "Check", UpperRight, check::CheckPanel;
            /// What was said.
            Log, "Log", UpperRight, log::LogPanel;
            /// The geometric lobe's curve.
            Curve, "Curve", LowerRight, curve::CurvePanel;
            /// What the lobe draws.
            Samples, "Samples", LowerRight, samples::SamplesPanel;
            /// The lobe itself.
            Lobe, "Lobe", LowerRight, lobe::LobePanel;
            /// What is known of a pixel, and how bright the picture is.
            Inspector, "Inspector", LowerRight, inspector::InspectorPanel;
            /// Error against time.
            Convergence, "Convergence", LowerRight, convergence::ConvergencePanel;
        }
    };
}
pub(super) use list;

macro_rules! panes {
    ($($(#[$doc:meta])* $name:ident, $title:literal, $home:ident, $module:ident::$panel:ident;)*) => {
        /// A part of the window with a tab: the viewport or a panel.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum Pane {
            /// The picture.
            Viewport,
            $($(#[$doc])* $name,)*
        }

        impl Pane {
            /// All of them.
            pub const ALL: [Self; 1 + [$(Self::$name),*].len()] = [Self::Viewport, $(Self::$name),*];

            /// What it is called.
            pub fn title(self) -> &'static str {
                match self {
                    Self::Viewport => "Viewport",
                    $(Self::$name => $title,)*
                }
            }

            /// Where it is docked at first; `None` for the viewport, which has the middle.
            pub(super) fn home(self) -> Option<Home> {
                match self {
                    Self::Viewport => None,
                    $(Self::$name => Some(Home::$home),)*
                }
            }
        }
    };
}

list!(panes);

impl Pane {
    /// What bringing it to the front is called.
    pub(super) fn command(self) -> String {
        format!("Show {}", self.title().to_lowercase())
    }
}
