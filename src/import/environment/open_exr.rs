//! OpenEXR files, by the `exr` crate.

use std::io::{BufReader, Read};
use std::path::Path;

use exr::block::UncompressedBlock;
use exr::block::chunk::Chunk;
use exr::block::lines::LineRef;
use exr::block::reader::{ChunksReader, Reader};
use exr::compression::Compression;
use exr::error::Error as ExrError;
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, EnvironmentMap, SampleType, Text};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::f16;

use super::canvas::Canvas;
use super::decoded::{Picture, Source, io};
use super::error::EnvironmentError;
use super::exr_window::{exr_error, window};
use super::luminance_chroma;
use crate::panics::contained;
use crate::parallel;
use crate::picture::exr_space::space;
use crate::resource;

const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// The bit of the version field that says that some part is deep.
const DEEP_FLAG: u32 = 1 << 11;
/// Deflate cannot do better than 1032 : 1, the other lossless schemes stay below it.
const MAX_COMPRESSION: u64 = 1500;
/// DWA deflates one number for 64 pixels that are all the same.
const MAX_COMPRESSION_DWA: u64 = 64 * 1032;
/// Chunks that are decompressed together: enough for every core, little enough to hold in memory.
const CHUNKS_AT_ONCE: usize = 32;

/// A layer of the file, and which of a texel's red, green and blue each of its channels fills.
struct Layer {
    index: usize,
    components: Vec<[bool; 3]>,
    warnings: Vec<String>,
}

/// Reads the first layer that has colour or luminance, at its largest size, into its display window.
pub(super) fn read(source: Source<'_>) -> Result<Picture, EnvironmentError> {
    let path = source.path;
    // Some damaged files fail assertions inside the crate instead of giving errors.
    contained(|| read_guarded(source)).unwrap_or_else(|| {
        let detail = "its pixels contradict each other".to_owned();
        Err(EnvironmentError::damaged(path, detail))
    })
}

/// [`read`] without protection: the crate may panic.
fn read_guarded(source: Source<'_>) -> Result<Picture, EnvironmentError> {
    let path = source.path;
    let file_bytes = check_preamble(path)?;
    let file = BufReader::new(io(path, resource::open(path))?);
    let reader = match Reader::read_from_buffered(file, false) {
        Err(ExrError::NotSupported(what)) if what.contains("subsampling") => return luminance_chroma::read(source),
        result => result.map_err(|error| exr_error(path, error))?,
    };
    if has_fine_chroma(reader.headers()) {
        return luminance_chroma::read(source);
    }
    let layer = choose_layer(path, reader.headers())?;
    let header = reader.headers()[layer.index].clone();
    let (mut canvas, offset) = window(source, &header)?;
    check_supported(path, &header, file_bytes)?;

    let chunks = reader
        .filter_chunks(false, |_, _, block| {
            block.layer == layer.index && block.level == Vec2(0, 0)
        })
        .map_err(|error| exr_error(path, error))?;
    let meta_data = chunks.meta_data().clone();
    for_each_block(source, chunks, &meta_data, |block| {
        for line in block.lines(&header.channels) {
            let channel = line.location.channel;
            let sample_type = header.channels.list[channel].sample_type;
            write_line(&line, sample_type, &layer.components[channel], offset, &mut canvas);
        }
    })?;
    let mut picture = canvas.finish();
    picture.warnings.extend(layer.warnings);
    picture.bring_to_rec709(path, &space(&header));
    let layout = header.shared_attributes.other.get(&Text::from("envmap"));
    picture.is_cube = matches!(layout, Some(AttributeValue::EnvironmentMap(EnvironmentMap::Cube)));
    Ok(picture)
}

/// Checks the first eight bytes, which the crate's errors do not distinguish; returns the length of the file.
fn check_preamble(path: &Path) -> Result<u64, EnvironmentError> {
    let mut file = io(path, resource::open(path))?;
    let length = io(path, file.metadata())?.len();
    let mut preamble = Vec::new();
    io(path, file.by_ref().take(8).read_to_end(&mut preamble))?;
    if preamble.is_empty() {
        return Err(EnvironmentError::truncated(path, "it has no content"));
    }
    let Some(version) = preamble.strip_prefix(&MAGIC) else {
        return Err(EnvironmentError::WrongContent {
            path: path.to_owned(),
            expected: "an OpenEXR",
        });
    };
    if let Ok(version) = <[u8; 4]>::try_from(version)
        && u32::from_le_bytes(version) & DEEP_FLAG != 0
    {
        return Err(EnvironmentError::Unsupported {
            path: path.to_owned(),
            feature: "deep pixels".to_owned(),
            remedy: "flatten it and save it as a scan-line EXR with ZIP or PIZ compression",
        });
    }
    Ok(length)
}

/// Whether a file of one part holds luminance and chroma of the same size, line by line.
fn has_fine_chroma(headers: &[Header]) -> bool {
    let [header] = headers else { return false };
    let has = |name: &str| {
        let mut channels = header.channels.list.iter();
        channels.any(|channel| channel.name.to_string() == name)
    };
    header.blocks == BlockDescription::ScanLines && ["Y", "RY", "BY"].into_iter().all(has) && !has("R")
}

/// The first layer with red, green and blue, else the first with luminance. In one layer the channels may have a prefix
/// (`view.R`): the shortest prefix wins.
fn choose_layer(path: &Path, headers: &[Header]) -> Result<Layer, EnvironmentError> {
    let names = |header: &Header| -> Vec<String> {
        header
            .channels
            .list
            .iter()
            .map(|channel| channel.name.to_string())
            .collect()
    };
    let find = |wanted: &[&str]| {
        headers.iter().enumerate().find_map(|(index, header)| {
            let names = names(header);
            let mut prefixes: Vec<&str> = names.iter().filter_map(|name| name.strip_suffix(wanted[0])).collect();
            prefixes.retain(|prefix| prefix.is_empty() || prefix.ends_with('.'));
            prefixes.retain(|prefix| wanted.iter().all(|name| names.contains(&format!("{prefix}{name}"))));
            prefixes.sort_by_key(|prefix| prefix.len());
            prefixes.first().map(|prefix| (index, (*prefix).to_owned()))
        })
    };
    let (index, prefix, is_color) = if let Some((index, prefix)) = find(&["R", "G", "B"]) {
        (index, prefix, true)
    } else if let Some((index, prefix)) = find(&["Y"]) {
        (index, prefix, false)
    } else {
        let found: Vec<String> = headers.iter().flat_map(names).collect();
        return Err(EnvironmentError::Unsupported {
            path: path.to_owned(),
            feature: format!("only the channels {}", found.join(", ")),
            remedy: "save it with channels R, G and B, or Y",
        });
    };
    let components = names(&headers[index])
        .iter()
        .map(|name| match name.strip_prefix(prefix.as_str()) {
            Some("R") => [is_color, false, false],
            Some("G") => [false, is_color, false],
            Some("B") => [false, false, is_color],
            Some("Y") => [!is_color; 3],
            _ => [false; 3],
        })
        .collect();
    let mut warnings = Vec::new();
    if headers.len() > 1 {
        warnings.push(format!(
            "The file has {} layers; number {} is shown.",
            headers.len(),
            index + 1
        ));
    }
    Ok(Layer {
        index,
        components,
        warnings,
    })
}

/// Refuses unsupported files, and headers that claim more than the file can contain.
fn check_supported(path: &Path, header: &Header, file_bytes: u64) -> Result<(), EnvironmentError> {
    if matches!(header.compression, Compression::HTJ2K32 | Compression::HTJ2K256) {
        return Err(EnvironmentError::Unsupported {
            path: path.to_owned(),
            feature: "HTJ2K compression".to_owned(),
            remedy: "re-save it with ZIP or PIZ compression",
        });
    }
    let promised = (header.layer_size.area() as u64).saturating_mul(header.channels.bytes_per_pixel as u64);
    let least = match header.compression {
        Compression::Uncompressed => promised,
        Compression::DWAA(_) | Compression::DWAB(_) => promised / MAX_COMPRESSION_DWA,
        _ => promised / MAX_COMPRESSION,
    };
    if file_bytes < least {
        return Err(EnvironmentError::Truncated {
            path: path.to_owned(),
            detail: format!("it has {file_bytes} bytes, too few for the {promised} that its header promises"),
        });
    }
    Ok(())
}

/// Decompresses all chunks on all cores and passes the blocks on in order. (The crate's own parallel reader runs detached
/// tasks, in which a panic would end the program.)
fn for_each_block(
    source: Source<'_>,
    mut chunks: impl ChunksReader,
    meta_data: &MetaData,
    mut use_block: impl FnMut(&UncompressedBlock),
) -> Result<(), EnvironmentError> {
    let failed = |error| exr_error(source.path, error);
    let count = chunks.len();
    loop {
        let left = chunks.len();
        source.loading.step(format!("block {} of {count}", count - left))?;
        let batch: Result<Vec<Chunk>, _> = chunks.by_ref().take(CHUNKS_AT_ONCE).collect();
        let batch = batch.map_err(failed)?;
        if batch.is_empty() {
            return Ok(());
        }
        let block = |chunk| UncompressedBlock::decompress_chunk(chunk, meta_data, false);
        for block in parallel::map_into(batch, block) {
            use_block(&block.map_err(failed)?);
        }
    }
}

/// Writes the visible part of one line of one channel.
fn write_line(line: &LineRef<'_>, sample_type: SampleType, shown: &[bool; 3], offset: [i64; 2], canvas: &mut Canvas) {
    let [width, height] = canvas.source_size().map(i64::from);
    let row = line.location.position.y() as i64 + offset[1];
    if !(0..height).contains(&row) {
        return;
    }
    let first_column = line.location.position.x() as i64 + offset[0];
    let end_column = first_column + line.location.sample_count as i64;
    let columns = first_column.max(0)..end_column.min(width);
    let bytes = |column: i64, size: usize| &line.value[(column - first_column) as usize * size..][..size];
    let sample = |column: i64| match sample_type {
        SampleType::F16 => f16::from_bits(bytemuck::pod_read_unaligned(bytes(column, 2))).to_f32(),
        SampleType::F32 => bytemuck::pod_read_unaligned(bytes(column, 4)),
        SampleType::U32 => bytemuck::pod_read_unaligned::<u32>(bytes(column, 4)) as f32,
    };
    for (component, _) in shown.iter().enumerate().filter(|(_, shown)| **shown) {
        for column in columns.clone() {
            canvas.add(column as u32, row as u32, component, sample(column));
        }
    }
}
