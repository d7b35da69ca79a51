//! What the window does about actions, commands, files and answers: the methods of the editor, by what they concern.

mod commands;
mod compare;
pub mod dropped;
mod export;
pub mod files;
mod library;
mod manual;
pub mod models;
mod outside;
mod palette_items;
mod queue;
mod recovery;
mod snapshots;
mod submit;
mod take_picture;
mod textures;
mod turntable;
mod unsaved;
mod window_picture;
