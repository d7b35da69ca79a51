//! Images that carry the document they show: PNG files with the project's JSON in a compressed iTXt chunk before the
//! pixels. Any viewer shows the image; opening it here brings materials, camera and light back.

use std::{
    fs::File,
    io::{BufRead, BufReader, Cursor, Seek},
    path::Path,
};

use image::{DynamicImage, ImageResult, RgbaImage, codecs::png::PngDecoder};
use png::text_metadata::ITXtChunk;

use super::{FileError, Loaded, error::SIZE_MAX, project};
use crate::{document::Document, import::limits};

/// The keyword of the chunk.
pub const KEYWORD: &str = "glossmith";
/// What every PNG file begins with.
const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// The image in a PNG file. `image::load_from_memory` would bring every other decoder into the program once more.
pub fn png_image(bytes: &[u8]) -> ImageResult<RgbaImage> {
    DynamicImage::from_decoder(PngDecoder::new(Cursor::new(bytes))?).map(DynamicImage::into_rgba8)
}

/// Whether a file begins as PNG files do.
pub fn is_png(path: &Path) -> bool {
    let begins = |mut file: File| {
        let mut start = [0; SIGNATURE.len()];
        std::io::Read::read_exact(&mut file, &mut start).is_ok() && start == SIGNATURE
    };
    limits::open(path).is_ok_and(begins)
}

/// A PNG file's bytes: 8 bits of red, green, blue and alpha (not premultiplied) a pixel, row by row from the top, with a
/// text that [`document_text`](project::document_text) made.
pub fn png_bytes([width, height]: [u32; 2], rgba: &[u8], document_text: Option<&str>) -> Result<Vec<u8>, String> {
    let write = || -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        // Not the encoder's fastest setting: what noise there is makes files half as large again with it.
        encoder.set_compression(png::Compression::Balanced);
        encoder.set_filter(png::Filter::Adaptive);
        let mut writer = encoder.write_header()?;
        if let Some(text) = document_text {
            let mut chunk = ITXtChunk::new(KEYWORD, text);
            chunk.compressed = true;
            writer.write_text_chunk(&chunk)?;
        }
        writer.write_image_data(rgba)?;
        writer.finish()?;
        Ok(bytes.into_inner())
    };
    write().map_err(crate::in_words)
}

/// The document in an image.
pub fn load_picture_document(path: &Path) -> Result<Loaded<Document>, FileError> {
    project::parse_document(path, document_text_in(path)?.as_bytes())
}

/// The text of the document in an image.
pub(super) fn document_text_in(path: &Path) -> Result<String, FileError> {
    let file = limits::open(path).map_err(FileError::reading(path))?;
    text_in(path, BufReader::new(file))
}

/// The document in an image's contents. Relative file names are relative to `path`'s folder.
pub fn parse_picture_document(path: &Path, contents: impl BufRead + Seek) -> Result<Loaded<Document>, FileError> {
    project::parse_document(path, text_in(path, contents)?.as_bytes())
}

fn text_in(path: &Path, contents: impl BufRead + Seek) -> Result<String, FileError> {
    let damaged = |error: png::DecodingError| {
        FileError::content(
            path,
            format!("not a whole PNG image ({error}); save it again where it came from"),
        )
    };
    let mut reader = png::Decoder::new(contents).read_info().map_err(damaged)?;
    let chunk = |info: &png::Info<'_>| info.utf8_text.iter().find(|chunk| chunk.keyword == KEYWORD).cloned();
    let mut found = chunk(reader.info());
    if found.is_none() {
        // Other programs move texts behind the pixels.
        reader.finish().map_err(damaged)?;
        found = chunk(reader.info());
    }
    let mut found = found.ok_or_else(|| FileError::NoDocument { path: path.to_owned() })?;
    found
        .decompress_text_with_limit(SIZE_MAX as usize)
        .and_then(|()| found.get_text())
        .map_err(|error| {
            let reason = format!("the document in the image is damaged ({error}); open its project instead");
            FileError::content(path, reason)
        })
}
