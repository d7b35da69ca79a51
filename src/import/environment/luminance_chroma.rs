//! OpenEXR files of luminance and chroma, whose chroma is stored at half the width and height.
//!
//! The `exr` crate decompresses such pixels and refuses to hand them out: here its parts are put together by hand, for
//! files of one part with scan lines. Y is the luminance, RY = (R − Y) / Y, BY = (B − Y) / Y (OpenEXR, "Technical
//! Introduction", Luminance/Chroma Images).

use std::io::{BufReader, Read};

use exr::block::chunk::{Chunk, CompressedBlock};
use exr::compression::Compression;
use exr::error::{Error as ExrError, Result as ExrResult};
use exr::io::PeekRead;
use exr::math::Vec2;
use exr::meta::attribute::{ChannelDescription, IntegerBounds, SampleType};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData, Requirements};
use exr::prelude::f16;

use super::decoded::{Picture, Source, io};
use super::error::EnvironmentError;
use super::exr_window::{exr_error, window};
use crate::optics::primaries::REC709;
use crate::picture::exr_space::space;
use crate::resource;

/// Bytes per pixel of the three planes, at most.
const PIXEL_BYTES: u64 = 12;

/// Reads a file whose chroma is stored more coarsely than its luminance.
pub(super) fn read(source: Source<'_>) -> Result<Picture, EnvironmentError> {
    let path = source.path;
    let mut file = PeekRead::new(BufReader::new(io(path, resource::open(path))?));
    let meta_data = read_header(&mut file).map_err(|error| exr_error(path, error))?;
    let header = &meta_data.headers[0];
    let (mut canvas, offset) = window(source, header)?;
    source.within(source.budget.check(PIXEL_BYTES * header.layer_size.area() as u64))?;
    let planes = Planes::read(&mut file, &meta_data).map_err(|error| exr_error(path, error))?;
    let space = space(header);
    // Invalid primaries count as Rec. 709, and `bring_to_rec709` warns.
    let luminances = space.luminances().or_else(|_| REC709.luminances());
    let weights = luminances.unwrap_or([0.0, 1.0, 0.0]).map(|weight| weight as f32);
    let [width, height] = canvas.source_size().map(i64::from);
    for row in (0..height).filter(|row| (0..planes.height as i64).contains(&(row - offset[1]))) {
        for column in (0..width).filter(|column| (0..planes.width as i64).contains(&(column - offset[0]))) {
            let color = planes.color((column - offset[0]) as usize, (row - offset[1]) as usize, weights);
            canvas.add_color(column as u32, row as u32, color);
        }
    }
    let mut picture = canvas.finish();
    picture.bring_to_rec709(path, &space);
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
    let mut table = file.by_ref().take(8 * header.chunk_count as u64);
    std::io::copy(&mut table, &mut std::io::sink())?;
    Ok(MetaData { requirements, headers })
}

/// Y, RY and BY of the stored pixels.
struct Planes {
    width: usize,
    height: usize,
    luminance: Vec<f32>,
    chroma: [Vec<f32>; 2],
    /// Pixels for one of the chroma, along x and along y.
    step: [usize; 2],
}

impl Planes {
    fn read(file: &mut impl Read, meta_data: &MetaData) -> ExrResult<Self> {
        let header = &meta_data.headers[0];
        let (width, height) = (header.layer_size.width(), header.layer_size.height());
        let channels = &header.channels.list;
        let find = |name: &str| channels.iter().position(|channel| channel.name.to_string() == name);
        let (Some(y), Some(ry), Some(by)) = (find("Y"), find("RY"), find("BY")) else {
            return Err(ExrError::NotSupported(
                "channels stored coarsely that are no chroma".into(),
            ));
        };
        let step = [channels[ry].sampling.x(), channels[ry].sampling.y()];
        if step.contains(&0) || channels[by].sampling != channels[ry].sampling || channels[y].sampling != Vec2(1, 1) {
            return Err(ExrError::NotSupported("chroma of two sizes".into()));
        }
        let coarse = || vec![0.0; width.div_ceil(step[0]) * height.div_ceil(step[1])];
        let mut planes = Self {
            width,
            height,
            luminance: vec![0.0; width * height],
            chroma: [coarse(), coarse()],
            step,
        };
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
            planes.take(header, &bytes, first, lines, [y, ry, by])?;
        }
        Ok(planes)
    }

    /// Stores the lines of a block, channel by channel, of the channels that have each line.
    fn take(&mut self, header: &Header, bytes: &[u8], first: usize, lines: usize, names: [usize; 3]) -> ExrResult<()> {
        let mut rest = bytes;
        for row in first..first + lines {
            for (index, channel) in header.channels.list.iter().enumerate() {
                let Some(count) = samples_in_line(channel, self.width, row) else {
                    continue;
                };
                let size = channel.sample_type.bytes_per_sample();
                let cut = || ExrError::Invalid("a block that is too short".into());
                let (line, others) = rest.split_at_checked(count * size).ok_or_else(cut)?;
                rest = others;
                let samples = line
                    .chunks_exact(size)
                    .map(|sample| number(channel.sample_type, sample));
                let coarse = row / self.step[1] * self.width.div_ceil(self.step[0]);
                let plane = match names.iter().position(|name| *name == index) {
                    Some(0) => &mut self.luminance[row * self.width..],
                    Some(1) => &mut self.chroma[0][coarse..],
                    Some(2) => &mut self.chroma[1][coarse..],
                    _ => continue,
                };
                plane
                    .iter_mut()
                    .zip(samples)
                    .for_each(|(place, sample)| *place = sample);
            }
        }
        Ok(())
    }

    /// Red, green and blue of a stored pixel, its chroma bilinear, from the luminance of each.
    fn color(&self, column: usize, row: usize, luminances: [f32; 3]) -> [f32; 3] {
        let y = self.luminance[row * self.width + column];
        let stride = self.width.div_ceil(self.step[0]);
        let rows = self.height.div_ceil(self.step[1]);
        let (left, top) = (column / self.step[0], row / self.step[1]);
        let (right, below) = ((left + 1).min(stride - 1), (top + 1).min(rows - 1));
        let share = |place: usize, step: usize| (place % step) as f32 / step as f32;
        let (fx, fy) = (share(column, self.step[0]), share(row, self.step[1]));
        let [ry, by] = [0, 1].map(|plane| {
            let at = |x: usize, y: usize| self.chroma[plane][y * stride + x];
            let mix = |a: f32, b: f32, t: f32| a + t * (b - a);
            mix(
                mix(at(left, top), at(right, top), fx),
                mix(at(left, below), at(right, below), fx),
                fy,
            )
        });
        let (red, blue) = ((ry + 1.0) * y, (by + 1.0) * y);
        let green = (y - luminances[0] * red - luminances[2] * blue) / luminances[1];
        [red, green, blue].map(|value| value.max(0.0))
    }
}

/// Number of a channel's samples in a line; 0 if it skips the line.
fn samples_in_line(channel: &ChannelDescription, width: usize, row: usize) -> Option<usize> {
    row.is_multiple_of(channel.sampling.y().max(1))
        .then(|| width / channel.sampling.x().max(1))
}

fn number(sample_type: SampleType, bytes: &[u8]) -> f32 {
    match (sample_type, bytes) {
        (SampleType::F16, &[a, b]) => f16::from_le_bytes([a, b]).to_f32(),
        (SampleType::F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
        (SampleType::U32, &[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]) as f32,
        _ => 0.0,
    }
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
