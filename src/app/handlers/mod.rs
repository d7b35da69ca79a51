//! What the window does about actions, commands, files and answers: the methods of the editor, by what they concern.

mod commands;
pub mod files;
mod library;
pub mod models;
mod pictures;
mod rendering;
mod sheets;
