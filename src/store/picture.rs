//! Images that carry the document they show: PNG files with the project's JSON in a compressed iTXt chunk before the
//! pixels. Any viewer shows the image; opening it here brings materials, camera and light back.

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Seek};
use std::path::Path;

use png::text_metadata::ITXtChunk;

use super::error::SIZE_MAX;
use super::project;
use super::{FileError, Loaded};
use crate::document::Document;
use crate::import::resource;

/// The keyword of the chunk.
pub const KEYWORD: &str = "glossmith";
/// What every PNG file begins with.
const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// Whether a file begins as PNG files do.
pub fn is_png(path: &Path) -> bool {
    let begins = |mut file: File| {
        let mut start = [0; SIGNATURE.len()];
        std::io::Read::read_exact(&mut file, &mut start).is_ok() && start == SIGNATURE
    };
    resource::open(path).is_ok_and(begins)
}

/// A PNG file's bytes: 8 bits of red, green, blue and alpha (not premultiplied) a pixel, row by row from the top, with a
/// text that [`document_text`](project::document_text) made.
///
/// # Errors
/// What is wrong with the size, in words.
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
    write().map_err(|error| error.to_string())
}

/// The document in an image.
///
/// # Errors
/// [`FileError`] where the file cannot be read, is no PNG, or carries no document; what is wrong with the document.
pub fn load_picture_document(path: &Path) -> Result<Loaded<Document>, FileError> {
    project::parse_document(path, document_text_in(path)?.as_bytes())
}

/// The text of the document in an image.
pub(super) fn document_text_in(path: &Path) -> Result<String, FileError> {
    let file = resource::open(path).map_err(FileError::reading(path))?;
    text_in(path, BufReader::new(file))
}

/// The document in an image's contents. Relative file names are relative to `path`'s folder.
///
/// # Errors
/// As [`load_picture_document`].
pub fn parse_picture_document(path: &Path, contents: impl BufRead + Seek) -> Result<Loaded<Document>, FileError> {
    project::parse_document(path, text_in(path, contents)?.as_bytes())
}

fn text_in(path: &Path, contents: impl BufRead + Seek) -> Result<String, FileError> {
    let damaged = |error: png::DecodingError| FileError::Content {
        path: path.to_owned(),
        reason: format!("not a whole PNG image ({error}); save it again where it came from"),
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
        .map_err(|error| FileError::Content {
            path: path.to_owned(),
            reason: format!("the document in the image is damaged ({error}); open its project instead"),
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::MaterialSettings;
    use crate::scene::ModelSource;
    use crate::store::project::document_text;

    const SIZE: [u32; 2] = [5, 3];

    fn document() -> Document {
        let mut document = Document {
            model: ModelSource::File("models/pot.glb".into()),
            materials: vec![MaterialSettings {
                name: "Öl – 油".to_owned(),
                roughness: 0.123,
                ..MaterialSettings::default()
            }],
            ..Document::default()
        };
        document.camera.yaw_deg = -70.25;
        document.lighting.rotation_deg = 12.5;
        document
    }

    fn picture(path: &Path) -> Vec<u8> {
        let pixels: Vec<u8> = (0..60).map(|i| i * 4).collect();
        let text = document_text(path, &document()).expect("Unicode");
        png_bytes(SIZE, &pixels, Some(&text)).expect("the right size")
    }

    fn parse(path: &Path, bytes: &[u8]) -> Result<Loaded<Document>, FileError> {
        parse_picture_document(path, Cursor::new(bytes))
    }

    #[test]
    fn a_picture_gives_back_its_document_and_its_pixels() {
        let path = Path::new("/somewhere/a.png");
        let bytes = picture(path);
        let mut expected = document();
        expected.model = ModelSource::File(std::path::absolute("models/pot.glb").expect("a working folder"));
        assert_eq!(parse(path, &bytes).expect("whole").value, expected);
        let shown = image::load_from_memory(&bytes).expect("a picture").into_rgba8();
        assert_eq!(shown.dimensions(), (SIZE[0], SIZE[1]));
        assert_eq!(shown.as_raw()[59], 59 * 4);
    }

    #[test]
    fn a_text_behind_the_pixels_is_found() {
        let path = Path::new("/somewhere/a.png");
        let bytes = picture(path);
        let at = |name: &[u8]| bytes.windows(4).position(|window| window == name).expect("there") - 4;
        let (text, pixels, end) = (at(b"iTXt"), at(b"IDAT"), at(b"IEND"));
        assert!(text < pixels);
        let moved = [&bytes[..text], &bytes[pixels..end], &bytes[text..pixels], &bytes[end..]].concat();
        assert_eq!(parse(path, &moved).expect("whole").value.camera, document().camera);
    }

    #[test]
    fn a_picture_without_a_document_says_so() {
        let plain = png_bytes(SIZE, &[9; 60], None).expect("the right size");
        let error = parse(Path::new("a.png"), &plain).expect_err("there is none");
        assert!(matches!(error, FileError::NoDocument { .. }), "{error}");
        assert!(error.to_string().starts_with("a.png: "), "{error}");
        assert!(png_bytes(SIZE, &[9; 59], None).is_err(), "a byte is missing");
    }

    #[test]
    fn no_damage_makes_it_panic_or_gives_another_document() {
        let path = Path::new("/somewhere/a.png");
        let bytes = picture(path);
        let whole = parse(path, &bytes).expect("whole");
        for end in 0..bytes.len() {
            if let Ok(loaded) = parse(path, &bytes[..end]) {
                assert_eq!(loaded, whole, "cut at {end}");
            }
        }
        for at in 0..bytes.len() {
            for flip in [1, 0x20, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] ^= flip;
                // The checksum guards the text: it is read whole or not at all.
                if let Ok(loaded) = parse(path, &damaged) {
                    assert_eq!(loaded, whole, "byte {at} ^ {flip}");
                }
            }
        }
    }

    #[test]
    fn a_text_of_the_right_name_and_wrong_contents_is_an_error() {
        for text in [
            "",
            "{",
            "[]",
            "{\"glossmith\": 1, \"material\": {}}",
            "{\"glossmith-document\": \"x\"}",
        ] {
            let bytes = png_bytes(SIZE, &[0; 60], Some(text)).expect("the right size");
            let error = parse(Path::new("b.png"), &bytes).expect_err("no document");
            assert!(error.to_string().starts_with("b.png: "), "{error}");
        }
    }
}
