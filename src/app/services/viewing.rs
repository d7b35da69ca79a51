//! What renders the viewport, how it shows that, and what a click in it is for.

use crate::{named::named, render::EngineChoice, render::shown::Shown};

/// How the viewport shows the render.
#[derive(Clone, Debug, Default)]
pub struct Viewing {
    /// How large the image is.
    pub resolution: Resolution,
    /// What of the render is shown.
    pub shown: Shown,
    /// What every screen shows is marked.
    pub shows_safe_frames: bool,
    /// The workspace is *Measure*.
    pub measures: bool,
    /// What the next click is for.
    pub picks: Option<Pick>,
}

/// What a click in the viewport can be for instead of choosing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pick {
    /// It says what is sharp.
    Focus,
    /// Its angle between view and normal is that of the plots.
    Angle,
    /// The next click on a preset says what B is.
    Rival,
    /// It says where the highlight of the area light with this number is seen.
    Highlight(usize),
}

named! {
    /// How large the image is.
    #[derive(Default)]
    Resolution {
        #[default]
        Auto, "Auto", "Fill", "Fills the viewport: with the screen's pixels on a GPU, with fewer on the CPU.";
        Native, "Native", "Fill, full resolution", "Fills the viewport with the screen's own pixels.";
        Half, "Half", "Fill, half resolution", "Fills the viewport with half as many pixels each way.";
        Document, "Document", "Image size", "Width and height as set below, for any shape of the viewport.";
    }
}

/// The engine that renders, and when it rests.
pub struct Rendering {
    /// The engine that was asked for, and the one that is remembered: the command line's is not.
    pub engine: EngineChoice,
    pub kept_engine: EngineChoice,
    /// Rendering was stopped by hand.
    pub is_paused: bool,
    /// A study measures, for which it rests.
    pub is_measuring: bool,
}
