//! Environments from files: choice of the decoder, and repairs.

mod canvas;
mod cube;
mod error;
mod image;
mod open_exr;
mod radiance_hdr;

use std::path::Path;

use canvas::{Picture, Source};
pub use cube::are_faces;
pub use error::EnvironmentError;

use crate::{
    endings::{ending, is_picture},
    limits::Budget,
    scene::Loading,
    scene::environment::{Environment, EnvironmentEncoding, EnvironmentSource},
};

/// Bytes per texel of unfolding a cube and of the sampling tables, besides the map.
const WORK_BYTES: u64 = 40;

/// Loads or computes an environment. Takes seconds for an 8k file: do not call it on the window's thread.
pub fn load(source: &EnvironmentSource) -> Result<Environment, EnvironmentError> {
    load_encoded(source, EnvironmentEncoding::default())
}

/// The same with an `encoding` for integer images.
pub fn load_encoded(
    source: &EnvironmentSource,
    encoding: EnvironmentEncoding,
) -> Result<Environment, EnvironmentError> {
    load_watched(source, encoding, &Loading::default())
}

/// The same with progress and cancellation.
pub fn load_watched(
    source: &EnvironmentSource,
    encoding: EnvironmentEncoding,
    loading: &Loading,
) -> Result<Environment, EnvironmentError> {
    match source {
        EnvironmentSource::File(path) => load_path(path, encoding, loading),
        _ => Ok(source.computed()?),
    }
}

/// Loads an image of the whole sphere: a latitude-longitude or cube map in a file, or six faces in a folder.
fn load_path(path: &Path, encoding: EnvironmentEncoding, loading: &Loading) -> Result<Environment, EnvironmentError> {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    loading.step(format!("reading {name}"))?;
    let source = Source {
        path,
        encoding,
        loading,
        budget: &Budget::of_import(),
    };
    let check_work = |texels: usize| source.within(source.budget.check(WORK_BYTES * texels as u64));
    let picture = if path.is_dir() {
        cube::read_folder(source, decode)?
    } else {
        decode(source)?
    };
    check_work(picture.texels.len())?;
    let mut picture = cube::unfolded(picture);
    check_work(picture.texels.len())?;
    loading.step("the environment's distribution")?;
    repair(&mut picture);
    let mut environment = Environment::from_texels(name, picture.width, picture.height, picture.texels)?;
    environment.warnings = picture.warnings;
    Ok(environment)
}

fn decode(source: Source<'_>) -> Result<Picture, EnvironmentError> {
    match ending(source.path).as_str() {
        "hdr" | "pic" | "rgbe" => radiance_hdr::read(source),
        "exr" => open_exr::read(source),
        _ if is_picture(source.path) => image::read(source),
        _ => Err(EnvironmentError::Refused(format!(
            "the environment {} is neither a .hdr nor an .exr, .ktx2, .dds, PNG, JPEG, TIFF or WebP file: convert it to one of \
             them, or use studio, sky or furnace",
            source.path.display()
        ))),
    }
}

/// Replaces invalid radiances, makes the texels opaque, and records warnings.
fn repair(picture: &mut Picture) {
    let (mut not_a_number, mut negative, mut infinite) = (0_u64, 0_u64, 0_u64);
    let mut largest = 0.0_f32;
    for texel in &mut picture.texels {
        for value in &mut texel[..3] {
            if value.is_nan() {
                not_a_number += 1;
                *value = 0.0;
            } else if *value < 0.0 {
                negative += 1;
                *value = 0.0;
            } else if value.is_infinite() {
                infinite += 1;
            } else {
                largest = largest.max(*value);
            }
        }
        texel[3] = 1.0;
    }
    if infinite > 0 {
        for value in picture.texels.as_flattened_mut() {
            *value = value.min(largest.max(1.0));
        }
    }
    let warnings = &mut picture.warnings;
    let mut report = |count: u64, what: &str, instead: &str| {
        if count > 0 {
            warnings.push(format!("{count} {what} values were replaced by {instead}."));
        }
    };
    report(not_a_number, "not-a-number", "0");
    report(negative, "negative", "0");
    report(infinite, "infinite", &format!("the largest finite one, {largest}"));
    if picture.width != 2 * picture.height {
        warnings.push(format!(
            "The image is {} × {}, not twice as wide as it is high; it is stretched over the whole sphere.",
            picture.width, picture.height
        ));
    }
}
