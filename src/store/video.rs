//! Videos written to files, frame by frame: H.264 in MP4, and GIF.

use std::path::{Path, PathBuf};

use super::{FileError, mp4, mp4::Mp4, replace::save_atomically};
use crate::import::endings::ending;

/// Frames a second that a video may have.
pub const FPS: std::ops::RangeInclusive<f64> = 1.0..=120.0;
/// How much of a GIF's pixels its palette is learnt from: 1 is all, 30 is fast.
const PALETTE_SPEED: i32 = 5;
/// Alpha from which a GIF's pixel is there at all.
const OPAQUE_FROM: u8 = 128;

/// Why a video can't be written.
#[derive(Debug, thiserror::Error)]
pub enum VideoError {
    /// The extension is not that of a format that can be written.
    #[error("{path}: videos are written as .mp4 or .gif; give the file one of these endings")]
    Format { path: PathBuf },
    /// The program was built without the encoder.
    #[error("{path}: this program was built without H.264 (the feature `video`); give the file the ending .gif")]
    NotBuilt { path: PathBuf },
    /// The encoder refuses, mostly for its size.
    #[error("{path}: no video of {width} × {height} pixels: {why}; choose another size")]
    Encoder {
        path: PathBuf,
        width: u32,
        height: u32,
        why: String,
    },
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
}

/// The formats, by a file's ending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VideoFormat {
    /// H.264, which everything plays. Sides are even: an odd one loses its last row. What is transparent is black.
    Mp4,
    /// 256 colours a frame, in an endless loop; transparency is kept.
    Gif,
}

impl VideoFormat {
    /// The format that a file's ending asks for.
    ///
    /// # Errors
    /// [`VideoError::Format`] for another ending, [`VideoError::NotBuilt`]: ask before hours of rendering.
    pub fn of(path: &Path) -> Result<Self, VideoError> {
        match ending(path).as_str() {
            "mp4" if !mp4::IS_BUILT => Err(VideoError::NotBuilt { path: path.to_owned() }),
            "mp4" => Ok(Self::Mp4),
            "gif" => Ok(Self::Gif),
            _ => Err(VideoError::Format { path: path.to_owned() }),
        }
    }
}

/// A video under way. Its file is written when it is finished, at once.
pub struct Video {
    path: PathBuf,
    size: [u32; 2],
    frames: Frames,
}

enum Frames {
    Mp4(Box<Mp4>),
    Gif(Box<Gif>),
}

impl Video {
    /// A video of `fps` frames a second, in [`FPS`], in the format of the file's ending.
    pub fn begin(path: &Path, size: [u32; 2], fps: f64) -> Result<Self, VideoError> {
        let fps = fps.clamp(*FPS.start(), *FPS.end());
        let frames = match VideoFormat::of(path)? {
            VideoFormat::Mp4 => Mp4::new(size, fps).map(|mp4| Frames::Mp4(Box::new(mp4))),
            VideoFormat::Gif => Gif::new(size, fps).map(|gif| Frames::Gif(Box::new(gif))),
        };
        Ok(Self {
            path: path.to_owned(),
            size,
            frames: frames.map_err(|why| refused(path, size, why))?,
        })
    }

    /// Adds a frame: red, green, blue, alpha of 8 bits as the screen shows them, row by row from the top.
    pub fn add(&mut self, rgba: &[u8]) -> Result<(), VideoError> {
        let added = match &mut self.frames {
            Frames::Mp4(mp4) => mp4.add(self.size, rgba),
            Frames::Gif(gif) => gif.add(rgba),
        };
        added.map_err(|why| refused(&self.path, self.size, why))
    }

    /// Writes the file.
    ///
    /// # Errors
    /// [`VideoError`] naming the file, which is then as it was.
    pub fn finish(self) -> Result<(), VideoError> {
        let bytes = match self.frames {
            Frames::Mp4(mp4) => mp4.bytes(),
            Frames::Gif(gif) => gif.encoder.into_inner().map_err(crate::in_words),
        };
        let bytes = bytes.map_err(|why| refused(&self.path, self.size, why))?;
        Ok(save_atomically(&self.path, &bytes)?)
    }
}

fn refused(path: &Path, [width, height]: [u32; 2], why: String) -> VideoError {
    VideoError::Encoder {
        path: path.to_owned(),
        width,
        height,
        why,
    }
}

/// Frames as a GIF.
struct Gif {
    encoder: gif::Encoder<Vec<u8>>,
    size: [u16; 2],
    fps: f64,
    count: u32,
}

impl Gif {
    fn new(size: [u32; 2], fps: f64) -> Result<Self, String> {
        let [Ok(width), Ok(height)] = size.map(u16::try_from) else {
            return Err("a GIF's sides are at most 65535 pixels".to_owned());
        };
        let mut encoder = gif::Encoder::new(Vec::new(), width, height, &[]).map_err(crate::in_words)?;
        encoder.set_repeat(gif::Repeat::Infinite).map_err(crate::in_words)?;
        Ok(Self {
            encoder,
            size: [width, height],
            fps,
            count: 0,
        })
    }

    fn add(&mut self, rgba: &[u8]) -> Result<(), String> {
        let mut pixels = rgba.to_vec();
        for pixel in pixels.chunks_exact_mut(4) {
            match pixel[3] {
                OPAQUE_FROM.. => pixel[3] = 255,
                _ => pixel.fill(0),
            }
        }
        let [width, height] = self.size;
        let mut frame = gif::Frame::from_rgba_speed(width, height, &mut pixels, PALETTE_SPEED);
        // Hundredths of a second, rounded so that all of them together take the right time.
        let until = |frames: u32| (100.0 * f64::from(frames) / self.fps).round() as u32;
        frame.delay = (until(self.count + 1) - until(self.count)) as u16;
        frame.dispose = gif::DisposalMethod::Background;
        self.count += 1;
        self.encoder.write_frame(&frame).map_err(crate::in_words)
    }
}
