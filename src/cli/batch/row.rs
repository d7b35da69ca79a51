//! The record of an image of a batch.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::file::Picture;

/// What became of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// It was rendered.
    Rendered,
    /// Its parts were joined.
    Merged,
    /// It was there, made of the same inputs.
    Kept,
    /// It could not be made.
    #[default]
    Failed,
}

/// An image's record: printed as a line of JSON, and kept beside it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Row {
    /// Its number from 1.
    pub number: usize,
    /// Its name.
    pub picture: String,
    /// What became of it.
    pub status: Status,
    /// Its files.
    #[serde(with = "crate::scene::path_text::list")]
    pub files: Vec<PathBuf>,
    /// The hash of what it was made of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hash: Option<String>,
    /// The hash of its files: one that was damaged since is made again. Records of older versions have none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub files_hash: Option<String>,
    /// The numbers of the first sample and the one after the last, of a part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<[u32; 2]>,
    /// Samples per pixel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples_per_pixel: Option<u32>,
    /// The engine's own time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub render_seconds: Option<f64>,
    /// The estimated error of the image's mean brightness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<f64>,
    /// Why it is not there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

impl Row {
    pub fn new(number: usize, picture: &Picture, status: Status) -> Self {
        Self {
            number,
            picture: picture.name.clone(),
            status,
            ..Self::default()
        }
    }

    pub fn failed(number: usize, picture: &Picture, error: &anyhow::Error) -> Self {
        Self {
            error: Some(format!("{error:#}")),
            ..Self::new(number, picture, Status::Failed)
        }
    }

    /// The record beside an image; none where there is none that can be read.
    pub fn read(path: &Path) -> Option<Self> {
        serde_json::from_slice(&std::fs::read(path).ok()?).ok()
    }
}
