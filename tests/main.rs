//! All tests in one binary.

#[path = "suite/document.rs"]
mod document;
#[path = "suite/files.rs"]
mod files;
#[path = "suite/tone.rs"]
mod tone;
