//! Videos written to files, frame by frame: H.264 in MP4, and GIF.

use std::path::{Path, PathBuf};

use super::FileError;
use super::mp4::{self, Mp4};
use super::replace::save_atomically;
use crate::import::endings::ending;

/// Frames a second that a video may have.
pub const FPS: std::ops::RangeInclusive<f64> = 1.0..=120.0;
/// How much of a GIF's pixels its palette is learnt from: 1 is all, 30 is fast.
const PALETTE_SPEED: i32 = 5;
/// Alpha from which a GIF's pixel is there at all.
const OPAQUE_FROM: u8 = 128;

/// Why a video can't be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "messages say what the fields are")]
pub enum VideoError {
    /// The extension is not that of a format that can be written.
    #[error("{}: videos are written as .mp4 or .gif; give the file one of these endings", path.display())]
    Format { path: PathBuf },
    /// The program was built without the encoder.
    #[error("{}: this program was built without H.264 (the feature `video`); give the file the ending .gif", path.display())]
    NotBuilt { path: PathBuf },
    /// The encoder refuses, mostly for its size.
    #[error("{}: no video of {width} × {height} pixels: {why}; choose another size", path.display())]
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
    ///
    /// # Errors
    /// [`VideoError`], also for a size that the format does not take.
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
    ///
    /// # Errors
    /// [`VideoError::Encoder`].
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
            Frames::Gif(gif) => gif.encoder.into_inner().map_err(|error| error.to_string()),
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
        let mut encoder = gif::Encoder::new(Vec::new(), width, height, &[]).map_err(|error| error.to_string())?;
        encoder
            .set_repeat(gif::Repeat::Infinite)
            .map_err(|error| error.to_string())?;
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
        self.encoder.write_frame(&frame).map_err(|error| error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [u32; 2] = [48, 33];

    /// A frame of one colour with a bright square that moves.
    fn frame(number: u32) -> Vec<u8> {
        let [width, height] = SIZE;
        let pixel = |index: u32| match (index % width / 8, index / width / 8) {
            (x, 1) if x == number => [250, 240, 230, 255],
            _ => [180, 60, 30, 255],
        };
        (0..width * height).flat_map(pixel).collect()
    }

    fn written(path: &Path, fps: f64) {
        let mut video = Video::begin(path, SIZE, fps).expect("a video");
        (0..4).for_each(|number| video.add(&frame(number)).expect("a frame"));
        video.finish().expect("written");
    }

    /// Mean difference of two images' channels.
    fn difference(a: &[u8], b: &[u8]) -> f64 {
        assert_eq!(a.len(), b.len());
        let of_bytes = a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b)));
        of_bytes.sum::<f64>() / a.len() as f64
    }

    #[cfg(feature = "video")]
    #[test]
    fn an_mp4_is_played_back_frame_by_frame() {
        use openh264::decoder::Decoder;
        use openh264::formats::YUVSource as _;
        use shiguredo_mp4::boxes::SampleEntry;
        use shiguredo_mp4::demux::{Input, Mp4FileDemuxer};
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("turn.mp4");
        written(&path, 25.0);
        let bytes = std::fs::read(&path).expect("the file");
        let mut demuxer = Mp4FileDemuxer::new();
        demuxer.handle_input(Input {
            position: 0,
            data: &bytes,
        });
        let seconds = demuxer.tracks().expect("tracks")[0].duration as f64 / 25e3;
        assert!((seconds - 0.16).abs() < 1e-9, "{seconds} s");
        let mut decoder = Decoder::new().expect("a decoder");
        let mut number = 0;
        while let Some(sample) = demuxer.next_sample().expect("a sample") {
            let mut stream = Vec::new();
            let annex_b = |unit: &[u8], stream: &mut Vec<u8>| {
                stream.extend([0, 0, 0, 1]);
                stream.extend(unit);
            };
            if let Some(SampleEntry::Avc1(entry)) = sample.sample_entry {
                let sets = entry.avcc_box.sps_list.iter().chain(&entry.avcc_box.pps_list);
                sets.for_each(|set| annex_b(set, &mut stream));
            }
            let mut data = &bytes[sample.data_offset as usize..][..sample.data_size];
            while let Some((length, rest)) = data.split_first_chunk::<4>() {
                let (unit, rest) = rest.split_at(u32::from_be_bytes(*length) as usize);
                annex_b(unit, &mut stream);
                data = rest;
            }
            let picture = decoder.decode(&stream).expect("it decodes").expect("a picture");
            assert_eq!(picture.dimensions(), (48, 32), "the odd row is left out");
            let mut rgb = vec![0; 3 * 48 * 32];
            picture.write_rgb8(&mut rgb);
            let expected = frame(number);
            let expected: Vec<u8> = expected[..4 * 48 * 32]
                .chunks(4)
                .flat_map(|p| [p[0], p[1], p[2]])
                .collect();
            let error = difference(&rgb, &expected);
            assert!(error < 4.0, "frame {number} is off by {error} codes");
            number += 1;
        }
        assert_eq!(number, 4);
    }

    #[test]
    fn a_gif_is_read_back_frame_by_frame_and_takes_its_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("turn.GIF");
        written(&path, 30.0);
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options
            .read_info(std::fs::File::open(&path).expect("the file"))
            .expect("a GIF");
        let mut delays = Vec::new();
        while let Some(read) = decoder.read_next_frame().expect("a frame") {
            let error = difference(&read.buffer, &frame(delays.len() as u32));
            assert!(error < 1.0, "frame {} is off by {error} codes", delays.len());
            delays.push(read.delay);
        }
        assert_eq!(delays, [3, 4, 3, 3], "hundredths of a second");
    }

    #[test]
    fn what_no_video_can_be_is_told() {
        let wrong = Video::begin(Path::new("turn.avi"), SIZE, 24.0)
            .err()
            .expect("no format");
        assert!(wrong.to_string().contains(".mp4 or .gif"), "{wrong}");
        let huge = Video::begin(Path::new("turn.gif"), [70_000, 2], 24.0)
            .err()
            .expect("too wide");
        assert!(
            huge.to_string().starts_with("turn.gif: no video of 70000 × 2 pixels"),
            "{huge}"
        );
    }
}
