//! The list of the panels, and what is known of each without its code.

use serde::{Deserialize, Serialize};

/// Where a panel is docked at first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Home {
    UpperLeft,
    LowerLeft,
    UpperRight,
    LowerRight,
}

/// Hands the list of the panels to a macro: name in saved layouts, title of the tab, where it is docked at first, the
/// module in `src/app/panels/` with the type that it is, and the address of its page in the book. A line here is all that a
/// new file there needs.
macro_rules! list {
    ($make:ident) => {
        $make! {
            /// Materials to start from.
            Presets, "Presets", UpperLeft, presets::PresetsPanel, "reference/window.md#presets";
            /// Objects.
            Scene, "Scene", UpperLeft, scene::ScenePanel, "reference/window.md#scene";
            Snapshots, "Snapshots", UpperLeft, snapshots::SnapshotsPanel, "how-to/compare.md#snapshots";
            /// Renders that go on beside.
            Queue, "Queue", UpperLeft, queue::QueuePanel, "reference/window.md#saving-and-queueing";
            Lighting, "Light", LowerLeft, lighting::LightingPanel, "how-to/lights.md";
            /// Camera, view and render settings.
            Camera, "Camera & image", LowerLeft, camera::CameraPanel, "reference/settings.md";
            /// What is simulated, why, and what it costs.
            Effects, "Effects", LowerLeft, effects::EffectsPanel, "how-to/profile.md";
            /// Techniques against each other.
            Race, "Race", LowerLeft, race::RacePanel, "how-to/profile.md#race-techniques";
            Material, "Material", UpperRight, material::MaterialPanel, "reference/materials.md#parameters";
            /// The proof on this machine.
            Check, "Check", UpperRight, check::CheckPanel, "STABILITY.md";
            Log, "Log", UpperRight, log::LogPanel, "reference/window.md#messages";
            /// The geometric lobe's curve.
            Curve, "Curve", LowerRight, curve::CurvePanel, "tutorials/geometric-lobe.md#what-dξ-does";
            /// What the lobe draws.
            Samples, "Samples", LowerRight, samples::SamplesPanel, "tutorials/geometric-lobe.md#three-formulas";
            Lobe, "Lobe", LowerRight, lobe::LobePanel, "how-to/match.md";
            /// What is known of a pixel, and how bright the image is.
            Inspector, "Inspector", LowerRight, inspector::InspectorPanel, "reference/window.md#error-and-display";
            Convergence, "Convergence", LowerRight, convergence::ConvergencePanel, "tutorials/accuracy.md#2-render-to-an-error";
        }
    };
}
pub(crate) use list;

macro_rules! panes {
    ($($(#[$doc:meta])* $name:ident, $title:literal, $home:ident, $module:ident::$panel:ident, $manual:literal;)*) => {
        /// A part of the window with a tab: the viewport or a panel.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum Pane {
            Viewport,
            $($(#[$doc])* $name,)*
        }

        impl Pane {
            pub const ALL: [Self; 1 + [$(Self::$name),*].len()] = [Self::Viewport, $(Self::$name),*];

            /// What it is called.
            pub fn title(self) -> &'static str {
                match self {
                    Self::Viewport => "Viewport",
                    $(Self::$name => $title,)*
                }
            }

            /// Address in the book: a page, with an anchor or without.
            pub fn manual(self) -> &'static str {
                match self {
                    Self::Viewport => "reference/window.md#viewport",
                    $(Self::$name => $manual,)*
                }
            }

            /// Where it is docked at first; `None` for the viewport, which has the middle.
            pub fn home(self) -> Option<Home> {
                match self {
                    Self::Viewport => None,
                    $(Self::$name => Some(Home::$home),)*
                }
            }
        }
    };
}

list!(panes);
