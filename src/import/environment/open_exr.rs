//! OpenEXR files, by the `exr` crate.

use std::fs::File;
use std::io::{BufReader, Read, Seek};

use exr::{
    block::{UncompressedBlock, chunk::Chunk, lines::LineRef, reader::ChunksReader, reader::Reader},
    compression::Compression,
    error::Error as ExrError,
    math::Vec2,
    meta::{MetaData, attribute::EnvironmentMap, attribute::SampleType, header::Header},
    prelude::f16,
};

use super::canvas::{Canvas, Picture, Source};
use super::error::EnvironmentError;
use crate::{limits, panics::contained, parallel, picture::exr_space};

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
}

/// Reads the first layer that has colour or luminance, at its largest size, into its display window.
pub fn read(source: Source<'_>) -> Result<Picture, EnvironmentError> {
    // Some damaged files fail assertions inside the crate instead of giving errors.
    let read = contained(|| read_guarded(source));
    read.unwrap_or_else(|| Err(source.damaged("its pixels contradict each other")))
}

/// [`read`] without protection: the crate may panic.
fn read_guarded(source: Source<'_>) -> Result<Picture, EnvironmentError> {
    let mut file = source.io(limits::open(source.path))?;
    let file_bytes = source.io(file.metadata())?.len();
    check_preamble(source, &mut file)?;
    source.io(file.rewind())?;
    let reader = Reader::read_from_buffered(BufReader::new(file), false).map_err(|error| exr_error(source, error))?;
    let layers = reader.headers().len();
    let layer = choose_layer(source, reader.headers())?;
    let header = reader.headers()[layer.index].clone();
    let (mut canvas, offset) = window(source, &header)?;
    check_supported(source, &header, file_bytes)?;

    let chunks = reader
        .filter_chunks(false, |_, _, block| {
            block.layer == layer.index && block.level == Vec2(0, 0)
        })
        .map_err(|error| exr_error(source, error))?;
    let meta_data = chunks.meta_data().clone();
    for_each_block(source, chunks, &meta_data, |block| {
        for line in block.lines(&header.channels) {
            let channel = line.location.channel;
            let sample_type = header.channels.list[channel].sample_type;
            write_line(&line, sample_type, &layer.components[channel], offset, &mut canvas);
        }
    })?;
    let mut picture = canvas.finish();
    if layers > 1 {
        let shown = layer.index + 1;
        picture
            .warnings
            .push(format!("The file has {layers} layers; number {shown} is shown."));
    }
    picture.bring_to_rec709(source.path, &exr_space(&header));
    picture.is_cube = header.own_attributes.environment_map == Some(EnvironmentMap::Cube);
    Ok(picture)
}

/// Checks the first eight bytes, which the crate's errors do not distinguish.
fn check_preamble(source: Source<'_>, file: &mut File) -> Result<(), EnvironmentError> {
    let mut preamble = Vec::new();
    source.io(file.take(8).read_to_end(&mut preamble))?;
    if preamble.is_empty() {
        return Err(source.truncated("it has no content"));
    }
    let Some(version) = preamble.strip_prefix(&MAGIC) else {
        return Err(source.wrong("an OpenEXR"));
    };
    if <[u8; 4]>::try_from(version).is_ok_and(|version| u32::from_le_bytes(version) & DEEP_FLAG != 0) {
        let remedy = "flatten it and save it as a scan-line EXR with ZIP or PIZ compression";
        return Err(source.unsupported("deep pixels", remedy));
    }
    Ok(())
}

/// An empty image of the display window, and the position of the first stored pixel in it: negative for pixels outside the
/// window.
fn window(source: Source<'_>, header: &Header) -> Result<(Canvas, [i64; 2]), EnvironmentError> {
    let display = header.shared_attributes.display_window;
    let canvas = Canvas::new(source, display.size.width() as u64, display.size.height() as u64)?;
    let stored = header.layer_size;
    Canvas::check_size(source, stored.width() as u64, stored.height() as u64)?;
    let (own, shown) = (header.own_attributes.layer_position, display.position);
    let offset = [(own.x(), shown.x()), (own.y(), shown.y())];
    Ok((canvas, offset.map(|(own, shown)| i64::from(own) - i64::from(shown))))
}

/// Converts the crate's error.
fn exr_error(source: Source<'_>, error: ExrError) -> EnvironmentError {
    match error {
        ExrError::Io(error) => source.unreadable(error),
        ExrError::NotSupported(feature) => source.unsupported(
            format_args!("an OpenEXR feature ({feature})"),
            "re-save it as a plain RGB scan-line EXR with ZIP or PIZ compression",
        ),
        ExrError::Invalid(detail) if detail == "reference to missing bytes" => {
            source.truncated("bytes that it refers to are missing")
        }
        error => source.damaged(error),
    }
}

/// The first layer with red, green and blue, else the first with luminance. In one layer the channels may have a prefix
/// (`view.R`): the shortest prefix wins.
fn choose_layer(source: Source<'_>, headers: &[Header]) -> Result<Layer, EnvironmentError> {
    let channels = headers.iter().map(|header| &header.channels.list);
    let names = channels.map(|list| list.iter().map(|channel| channel.name.to_string()).collect());
    let names: Vec<Vec<String>> = names.collect();
    let find = |wanted: &[&str]| {
        names.iter().enumerate().find_map(|(index, names)| {
            let mut prefixes: Vec<&str> = names.iter().filter_map(|name| name.strip_suffix(wanted[0])).collect();
            prefixes.retain(|prefix| prefix.is_empty() || prefix.ends_with('.'));
            prefixes.retain(|prefix| wanted.iter().all(|name| names.contains(&format!("{prefix}{name}"))));
            let prefix = prefixes.into_iter().min_by_key(|prefix| prefix.len())?;
            let fills = |name: &String| {
                let name = name.strip_prefix(prefix);
                let fills = |channel: usize| name == Some(wanted[channel % wanted.len()]);
                [fills(0), fills(1), fills(2)]
            };
            let components = names.iter().map(fills).collect();
            Some(Layer { index, components })
        })
    };
    // Some programs write the names in lower case. A luminance with chroma is no grey.
    let has_chroma = names.iter().flatten().any(|name| name == "RY");
    let named = [&["R", "G", "B"][..], &["r", "g", "b"], &["Y"]];
    let known = &named[..if has_chroma { 2 } else { 3 }];
    known.iter().find_map(|wanted| find(wanted)).ok_or_else(|| {
        let found = format!("only the channels {}", names.concat().join(", "));
        source.unsupported(found, "save it with channels R, G and B, or Y")
    })
}

/// Refuses unsupported files, and headers that claim more than the file can contain.
fn check_supported(source: Source<'_>, header: &Header, file_bytes: u64) -> Result<(), EnvironmentError> {
    if matches!(header.compression, Compression::HTJ2K32 | Compression::HTJ2K256) {
        return Err(source.unsupported("HTJ2K compression", "re-save it with ZIP or PIZ compression"));
    }
    let promised = (header.layer_size.area() as u64).saturating_mul(header.channels.bytes_per_pixel as u64);
    let least = match header.compression {
        Compression::Uncompressed => promised,
        Compression::DWAA(_) | Compression::DWAB(_) => promised / MAX_COMPRESSION_DWA,
        _ => promised / MAX_COMPRESSION,
    };
    if file_bytes < least {
        return Err(source.truncated(format_args!(
            "it has {file_bytes} bytes, too few for the {promised} that its header promises"
        )));
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
    let failed = |error| exr_error(source, error);
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
    let size = sample_type.bytes_per_sample();
    let sample = |column: i64| {
        number(
            sample_type,
            &line.value[(column - first_column) as usize * size..][..size],
        )
    };
    for (component, _) in shown.iter().enumerate().filter(|(_, shown)| **shown) {
        for column in columns.clone() {
            canvas.add(column as u32, row as u32, component, sample(column));
        }
    }
}

/// A sample of a decompressed block.
#[inline]
fn number(sample_type: SampleType, bytes: &[u8]) -> f32 {
    match sample_type {
        SampleType::F16 => f16::from_bits(bytemuck::pod_read_unaligned(bytes)).to_f32(),
        SampleType::F32 => bytemuck::pod_read_unaligned(bytes),
        SampleType::U32 => bytemuck::pod_read_unaligned::<u32>(bytes) as f32,
    }
}
