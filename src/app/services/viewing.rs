//! How the viewport shows the render, and what a click in it is for.

use serde::{Deserialize, Serialize};

use crate::render::shown::Shown;

/// How the viewport shows the render.
#[derive(Clone, Debug, Default)]
pub(in crate::app) struct Viewing {
    /// How large the image is.
    pub(in crate::app) resolution: Resolution,
    /// What of the render is shown.
    pub(in crate::app) shown: Shown,
    /// What every screen shows is marked.
    pub(in crate::app) shows_safe_frames: bool,
    /// What the next click is for.
    pub(in crate::app) picks: Option<Pick>,
}

/// What a click in the viewport can be for instead of choosing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::app) enum Pick {
    /// It says what is sharp.
    Focus,
    /// It says where the highlight of the area light with this number is seen.
    Highlight(usize),
}

/// How large the image is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Resolution {
    /// It fills the viewport: with the screen's pixels on a hardware GPU, else with one a point.
    #[default]
    Auto,
    /// It fills the viewport with the screen's pixels.
    Native,
    /// It fills the viewport with half as many pixels each way.
    Half,
    /// Width and height as in the document, shown with its own shape.
    Document,
}

/// The sizes of the image to choose from: (value, label, help).
pub(in crate::app) const RESOLUTIONS: [(Resolution, &str, &str); 4] = [
    (
        Resolution::Auto,
        "Fill",
        "Fills the viewport: with the screen's pixels on a GPU, with fewer on the CPU.",
    ),
    (
        Resolution::Native,
        "Fill, native",
        "Fills the viewport with the screen's own pixels.",
    ),
    (
        Resolution::Half,
        "Fill, half",
        "Fills the viewport with half as many pixels each way.",
    ),
    (
        Resolution::Document,
        "Image size",
        "Width and height as set below, for any shape of the viewport.",
    ),
];
