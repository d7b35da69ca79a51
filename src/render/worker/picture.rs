//! What the window shows.

use std::{ops::Deref, sync::Arc};

use crate::{
    document::Document,
    document::ViewSettings,
    job::film::Image,
    render::{display::display, frame::Frame, shown::Scale, shown::Shown},
};

/// A frame as it is shown: the image itself or a map of it.
#[derive(Clone, Debug)]
pub struct Picture {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// Display-referred RGBA, 8 bits each, premultiplied in gamma space; rows from the top.
    pub rgba: Vec<u8>,
    /// Unique number of the image.
    pub serial: u64,
    /// Revision of its submission, see [`Worker::submit`](super::Worker::submit).
    pub revision: u64,
    /// The map that `rgba` shows, with its colour scale if it has one; `None` for the image itself.
    pub map: Option<(Shown, Option<Scale>)>,
    /// The document, with the size at full resolution.
    pub document: Arc<Document>,
    pub frame: Frame,
}

impl Deref for Picture {
    type Target = Frame;

    fn deref(&self) -> &Frame {
        &self.frame
    }
}

/// Display-referred RGBA, premultiplied in gamma space as windows blend it.
pub fn displayed(image: &Image, view: &ViewSettings) -> Vec<u8> {
    let mut rgba = display(image, view);
    for pixel in rgba.chunks_exact_mut(4).filter(|pixel| pixel[3] < 255) {
        let alpha = u16::from(pixel[3]);
        for channel in &mut pixel[..3] {
            *channel = ((u16::from(*channel) * alpha + 127) / 255) as u8;
        }
    }
    rgba
}
