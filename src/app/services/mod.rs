//! What the window keeps beside the document, each on its own: it sees neither panels nor the window.

pub(super) mod autosave;
pub(super) mod beside;
pub mod compare;
pub(super) mod crash;
pub(super) mod disk;
pub(super) mod edits;
pub(super) mod environments;
pub(super) mod export;
pub mod library;
pub(super) mod lobe_plots;
pub(super) mod look;
pub(super) mod messages;
pub(super) mod recent;
pub(super) mod reference;
pub(super) mod rendering;
pub(super) mod selection;
pub(super) mod shelves;
pub mod snapshots;
pub(super) mod viewing;
pub(super) mod watched;
pub mod workspaces;
