//! What the window keeps beside the document, each on its own: it sees neither panels nor the window.

pub mod autosave;
pub mod beside;
pub mod compare;
pub mod crash;
pub mod disk;
pub mod edits;
pub mod environments;
pub mod export;
pub mod library;
pub mod lobe_plots;
pub mod look;
pub mod messages;
pub mod recent;
pub mod reference;
pub mod rendering;
pub mod selection;
pub mod shelves;
pub mod snapshots;
pub mod viewing;
pub mod watched;
pub mod workspaces;
