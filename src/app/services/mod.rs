//! What the window keeps beside the document, each on its own: it sees neither panels nor the window.

pub mod autosave;
pub mod beside;
pub mod compare;
pub mod crash;
pub mod disk;
pub mod edits;
pub mod export;
pub mod library;
pub mod look;
pub mod messages;
pub mod pictures;
pub mod recent;
pub mod reference;
pub mod selection;
pub mod shelves;
pub mod viewing;
pub mod watched;
pub mod workspaces;
