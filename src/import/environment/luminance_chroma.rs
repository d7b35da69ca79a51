//! OpenEXR files of luminance and chroma, whose chroma is stored at half the width and height.
//!
//! The `exr` crate decompresses such pixels and refuses to hand them out: here its parts are put together by hand, for
//! files of one part with scan lines. Y is the luminance, RY = (R − Y) / Y, BY = (B − Y) / Y (OpenEXR, "Technical
//! Introduction", Luminance/Chroma Images).

use std::io::{BufReader, Read};
use std::ops::Range;

use exr::block::chunk::{Chunk, CompressedBlock};
use exr::compression::Compression;
use exr::error::{Error as ExrError, Result as ExrResult};
use exr::io::PeekRead;
use exr::math::Vec2;
use exr::meta::attribute::{ChannelDescription, IntegerBounds};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData, Requirements};

use super::canvas::{Picture, Source};
use super::error::EnvironmentError;
use super::open_exr::{exr_error, number, window};
use crate::limits;
use crate::optics::primaries::REC709;
use crate::picture::exr_space;

/// Bytes per pixel of the three planes, at most.
const PIXEL_BYTES: u64 = 12;

/// Reads a file whose chroma is stored more coarsely than its luminance.
pub(super) fn read(source: Source<'_>) -> Result<Picture, EnvironmentError> {
    let mut file = PeekRead::new(BufReader::new(source.io(limits::open(source.path))?));
    let meta_data = read_header(&mut file).map_err(|error| exr_error(source, error))?;
    let header = &meta_data.headers[0];
    let (mut canvas, offset) = window(source, header)?;
    source.within(source.budget.check(PIXEL_BYTES * header.layer_size.area() as u64))?;
    let planes = read_planes(&mut file, &meta_data).map_err(|error| exr_error(source, error))?;
    let space = exr_space(header);
    // Invalid primaries count as Rec. 709, and `bring_to_rec709` warns.
    let luminances = space.luminances().or_else(|_| REC709.luminances());
    let weights = luminances.unwrap_or([0.0, 1.0, 0.0]).map(|weight| weight as f32);
    let [width, height] = canvas.source_size().map(i64::from);
    let stored = [header.layer_size.width(), header.layer_size.height()].map(|side| side as i64);
    for row in (0..height).filter(|row| (0..stored[1]).contains(&(row - offset[1]))) {
        for column in (0..width).filter(|column| (0..stored[0]).contains(&(column - offset[0]))) {
            let pixel = [(column - offset[0]) as usize, (row - offset[1]) as usize];
            let [y, ry, by] = planes.each_ref().map(|plane| plane.at(pixel));
            let (red, blue) = ((ry + 1.0) * y, (by + 1.0) * y);
            let green = (y - weights[0] * red - weights[2] * blue) / weights[1];
            canvas.add_color(
                column as u32,
                row as u32,
                [red, green, blue].map(|value| value.max(0.0)),
            );
        }
    }
    let mut picture = canvas.finish();
    picture.bring_to_rec709(source.path, &space);
    Ok(picture)
}

/// The header of a file of one part with scan lines, past the table of its chunks.
fn read_header(file: &mut PeekRead<impl Read>) -> ExrResult<MetaData> {
    let mut magic = [0; 4];
    file.read_exact(&mut magic)?;
    let requirements = Requirements::read(file)?;
    let headers = Header::read_all(file, &requirements, false)?;
    let [header] = headers.as_slice() else {
        return Err(ExrError::NotSupported(
            "coarse chroma in a file of several parts".into(),
        ));
    };
    if header.deep || header.blocks != BlockDescription::ScanLines {
        return Err(ExrError::NotSupported("coarse chroma in tiles".into()));
    }
    MetaData::skip_offset_tables(file, &headers)?;
    Ok(MetaData { requirements, headers })
}

/// The stored samples of one channel.
struct Plane {
    /// Index among the channels.
    channel: usize,
    /// Pixels for one sample, along x and along y.
    step: [usize; 2],
    size: [usize; 2],
    samples: Vec<f32>,
}

impl Plane {
    fn new(header: &Header, name: &str) -> ExrResult<Self> {
        let channels = &header.channels.list;
        let channel = channels.iter().position(|channel| channel.name.to_string() == name);
        let channel = channel.ok_or(ExrError::NotSupported(
            "channels stored coarsely that are no chroma".into(),
        ))?;
        let sampling = channels[channel].sampling;
        let step = [sampling.x(), sampling.y()].map(|step| step.max(1));
        let Vec2(width, height) = header.layer_size;
        let size = [width.div_ceil(step[0]), height.div_ceil(step[1])];
        let samples = vec![0.0; size[0] * size[1]];
        Ok(Self {
            channel,
            step,
            size,
            samples,
        })
    }

    /// The sample of a stored pixel, bilinear.
    fn at(&self, pixel: [usize; 2]) -> f32 {
        let low = [0, 1].map(|axis| pixel[axis] / self.step[axis]);
        let high = [0, 1].map(|axis| (low[axis] + 1).min(self.size[axis] - 1));
        let [fx, fy] = [0, 1].map(|axis| (pixel[axis] % self.step[axis]) as f32 / self.step[axis] as f32);
        let at = |x: usize, y: usize| self.samples[y * self.size[0] + x];
        let mix = |a: f32, b: f32, t: f32| if t == 0.0 { a } else { a + t * (b - a) };
        let row = |y: usize| mix(at(low[0], y), at(high[0], y), fx);
        mix(row(low[1]), row(high[1]), fy)
    }
}

/// Y, RY and BY of the stored pixels.
fn read_planes(file: &mut impl Read, meta_data: &MetaData) -> ExrResult<[Plane; 3]> {
    let header = &meta_data.headers[0];
    let height = header.layer_size.height();
    let mut planes = [
        Plane::new(header, "Y")?,
        Plane::new(header, "RY")?,
        Plane::new(header, "BY")?,
    ];
    for _ in 0..header.chunk_count {
        let chunk = Chunk::read(file, meta_data)?;
        let CompressedBlock::ScanLine(block) = chunk.compressed_block else {
            return Err(ExrError::Invalid("a chunk that is no scan lines".into()));
        };
        let first = i64::from(block.y_coordinate) - i64::from(header.own_attributes.layer_position.y());
        let first = usize::try_from(first).ok().filter(|first| *first < height);
        let first = first.ok_or_else(|| ExrError::Invalid("scan lines outside the image".into()))?;
        let lines = header.compression.scan_lines_per_block().min(height - first);
        let bytes = decompress(header, block.compressed_pixels_le, first, lines)?;
        take(&mut planes, header, &bytes, first..first + lines)?;
    }
    Ok(planes)
}

/// Stores the lines of a block, channel by channel, of the channels that have each line.
fn take(planes: &mut [Plane; 3], header: &Header, bytes: &[u8], rows: Range<usize>) -> ExrResult<()> {
    let mut rest = bytes;
    for row in rows {
        for (index, channel) in header.channels.list.iter().enumerate() {
            let Some(count) = samples_in_line(channel, header.layer_size.width(), row) else {
                continue;
            };
            let size = channel.sample_type.bytes_per_sample();
            let cut = || ExrError::Invalid("a block that is too short".into());
            let (line, others) = rest.split_at_checked(count * size).ok_or_else(cut)?;
            rest = others;
            let Some(plane) = planes.iter_mut().find(|plane| plane.channel == index) else {
                continue;
            };
            let samples = line
                .chunks_exact(size)
                .map(|sample| number(channel.sample_type, sample));
            let start = row / plane.step[1] * plane.size[0];
            for (place, sample) in plane.samples[start..].iter_mut().zip(samples) {
                *place = sample;
            }
        }
    }
    Ok(())
}

/// Number of a channel's samples in a line; 0 if it skips the line.
fn samples_in_line(channel: &ChannelDescription, width: usize, row: usize) -> Option<usize> {
    row.is_multiple_of(channel.sampling.y().max(1))
        .then(|| width / channel.sampling.x().max(1))
}

/// Decompresses lines. The crate takes a block's size from the bytes of a pixel, which here are a mean over the block.
fn decompress(header: &Header, compressed: Vec<u8>, first: usize, lines: usize) -> ExrResult<Vec<u8>> {
    // The crate's B44 assumes full-size channels.
    if matches!(header.compression, Compression::B44 | Compression::B44A) {
        return Err(ExrError::NotSupported("B44 compression of coarse chroma".into()));
    }
    let width = header.layer_size.width();
    let bytes_of_line = |row: usize| {
        let of_channel = |channel: &ChannelDescription| {
            samples_in_line(channel, width, row).map_or(0, |count| count * channel.sample_type.bytes_per_sample())
        };
        header.channels.list.iter().map(of_channel).sum::<usize>()
    };
    let total: usize = (first..first + lines).map(bytes_of_line).sum();
    let area = width * lines;
    if area == 0 || !total.is_multiple_of(area) {
        return Err(ExrError::NotSupported("this size with coarse chroma".into()));
    }
    let mut header = header.clone();
    header.channels.bytes_per_pixel = total / area;
    let position = header.own_attributes.layer_position;
    let corner = Vec2(position.x(), position.y() + first as i32);
    let section = IntegerBounds::new(corner, Vec2(width, lines));
    header
        .compression
        .decompress_image_section_from_le(&header, compressed, section, false)
}
