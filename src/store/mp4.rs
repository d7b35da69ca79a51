//! H.264 in MP4, by the encoder openh264.

use std::num::NonZeroU32;

use openh264::{
    OpenH264API, Timestamp,
    encoder::{
        BitRate, Encoder, EncoderConfig, FrameRate, FrameType, MatrixCoefficients, QpRange, RateControlMode, VuiConfig,
    },
    formats::{RgbSliceU8, YUVBuffer},
};
use shiguredo_mp4::{
    TrackKind,
    bitstream::h264::{
        H264NalUnitType, H264SampleEntryConfig, LengthSize, build_avc1_box_from_annexb, parse_annexb_nal_units,
    },
    boxes::SampleEntry,
    mux::{Mp4FileMuxer, Mp4FileMuxerOptions, Sample, estimate_maximum_moov_box_size},
};

/// Whether this program can write them.
pub const IS_BUILT: bool = true;
/// Mean bits per pixel of an MP4: enough that gradients of clean images show no banding.
const BITS_PER_PIXEL: f64 = 0.25;
/// Fewest rows and columns that the encoder takes.
const SIDE_MIN: u32 = 16;
/// Finest and coarsest steps of an MP4's coefficients: beyond the second blocks are seen.
const QUANTIZERS: [u8; 2] = [12, 26];
/// Ticks of an MP4's clock in a frame.
const TICKS: u32 = 1000;

/// Frames as H.264.
pub struct Mp4 {
    encoder: Encoder,
    fps: f64,
    /// What a player must know before the first frame.
    entry: Option<SampleEntry>,
    /// Each frame's units with their lengths, and whether it is a key frame.
    frames: Vec<(Vec<u8>, bool)>,
}

impl Mp4 {
    /// A video of so many columns, rows, and frames a second.
    pub fn new(size: [u32; 2], fps: f64) -> Result<Self, String> {
        let [width, height] = even(size);
        if width < SIDE_MIN || height < SIDE_MIN {
            return Err(format!("an MP4's sides have at least {SIDE_MIN} pixels"));
        }
        let bits_per_second = BITS_PER_PIXEL * f64::from(width) * f64::from(height) * fps;
        // The library converts by the matrix of BT.601, which the file says.
        let colors = VuiConfig::bt709().matrix_coefficients(MatrixCoefficients::Smpte170M);
        let config = EncoderConfig::new()
            .bitrate(BitRate::from_bps(bits_per_second.clamp(1e5, 1e8) as u32))
            .max_frame_rate(FrameRate::from_hz(fps as f32))
            .rate_control_mode(RateControlMode::Bufferbased)
            .qp(QpRange::new(QUANTIZERS[0], QUANTIZERS[1]))
            .skip_frames(false)
            .vui(colors);
        // It only looks at sizes when it is given a frame.
        let black = YUVBuffer::new(width as usize, height as usize);
        encoder_of(config)?.encode(&black).map_err(refusal)?;
        Ok(Self {
            encoder: encoder_of(config)?,
            fps,
            entry: None,
            frames: Vec::new(),
        })
    }

    /// Adds a frame of that size.
    pub fn add(&mut self, size: [u32; 2], rgba: &[u8]) -> Result<(), String> {
        let [width, height] = even(size).map(|side| side as usize);
        let rows = rgba.chunks_exact(4 * size[0] as usize).take(height);
        let rgb: Vec<u8> = rows
            .flat_map(|row| row.as_chunks::<4>().0.iter().take(width))
            .flat_map(|[r, g, b, alpha]| [r, g, b].map(|code| over_black(*code, *alpha)))
            .collect();
        let picture = YUVBuffer::from_rgb8_source(RgbSliceU8::new(&rgb, (width, height)));
        let millis = (1e3 * self.frames.len() as f64 / self.fps).round() as u64;
        let encoded = self.encoder.encode_at(&picture, Timestamp::from_millis(millis));
        let encoded = encoded.map_err(refusal)?;
        let is_whole = encoded.frame_type() == FrameType::IDR;
        let stream = encoded.to_vec();
        let words = |error: shiguredo_mp4::Error| error.to_string();
        if self.entry.is_none() {
            let length_size = LengthSize::FourBytes;
            let entry = build_avc1_box_from_annexb(&stream, &H264SampleEntryConfig { length_size }).map_err(words)?;
            self.entry = Some(SampleEntry::Avc1(entry));
        }
        let mut frame = Vec::with_capacity(stream.len());
        for unit in parse_annexb_nal_units(&stream).map_err(words)? {
            // These stand in the entry.
            if !matches!(unit.nal_unit_type, H264NalUnitType::Sps | H264NalUnitType::Pps) {
                frame.extend((unit.data.len() as u32).to_be_bytes());
                frame.extend(unit.data);
            }
        }
        self.frames.push((frame, is_whole));
        Ok(())
    }

    /// The file.
    pub fn bytes(self) -> Result<Vec<u8>, String> {
        let words = |error: shiguredo_mp4::mux::MuxError| error.to_string();
        let mut muxer = Mp4FileMuxer::with_options(Mp4FileMuxerOptions {
            // The index before the frames: a browser plays what it has of the file.
            reserved_moov_box_size: estimate_maximum_moov_box_size(&[self.frames.len()]),
            ..Mp4FileMuxerOptions::default()
        })
        .map_err(words)?;
        let timescale = NonZeroU32::new((self.fps * f64::from(TICKS)).round() as u32).unwrap_or(NonZeroU32::MIN);
        let mut bytes = muxer.initial_boxes_bytes().to_vec();
        let mut entry = self.entry;
        for (frame, is_whole) in &self.frames {
            let sample = Sample {
                track_kind: TrackKind::Video,
                sample_entry: entry.take(),
                keyframe: *is_whole,
                timescale,
                duration: TICKS,
                composition_time_offset: None,
                data_offset: bytes.len() as u64,
                data_size: frame.len(),
            };
            muxer.append_sample(&sample).map_err(words)?;
            bytes.extend(frame);
        }
        for (offset, part) in muxer.finalize().map_err(words)?.offset_and_bytes_pairs() {
            let (from, to) = (offset as usize, offset as usize + part.len());
            bytes.resize(bytes.len().max(to), 0);
            bytes[from..to].copy_from_slice(part);
        }
        Ok(bytes)
    }
}

fn encoder_of(config: EncoderConfig) -> Result<Encoder, String> {
    Encoder::with_api_config(OpenH264API::from_source(), config).map_err(refusal)
}

fn refusal(error: openh264::Error) -> String {
    log::debug!("{error}");
    "the encoder refuses it".to_owned()
}

/// A code where nothing but black is behind.
fn over_black(code: u8, alpha: u8) -> u8 {
    ((u32::from(code) * u32::from(alpha) + 127) / 255) as u8
}

fn even(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| side / 2 * 2)
}
