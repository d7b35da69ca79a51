//! Each kind of file can be opened by each way that leads to it: the table of kinds is what dialogs, dropped files, watched
//! folders, recent files, help and documents ask, and what its endings promise is read.

use crate::cli_support::Workplace;
use std::path::{Path, PathBuf};

use clap::CommandFactory as _;
use glossmith::{
    cli::Arguments,
    import::picture::mean_of_file,
    render::output,
    scene::environment::EnvironmentSource,
    store::exchange::FORMATS,
    store::file_kind::{FileKind, OPENED, PICTURE_KINDS, endings, may_hold_document},
};
use image::{ImageFormat, RgbImage};

fn corpus(file: &str) -> Vec<u8> {
    std::fs::read(Path::new(crate::ROOT).join("fuzz/corpus").join(file)).unwrap()
}

/// A picture with this ending: panoramas, so that each can be an environment.
fn picture(ending: &str) -> Vec<u8> {
    let colors = RgbImage::from_fn(64, 32, |x, y| image::Rgb([4 * x as u8, 8 * y as u8, 128]));
    let format = match ending {
        "exr" => return corpus("exr/plain-float.exr"),
        "ktx2" => return corpus("ktx2/shared-exponent.ktx2"),
        "dds" => return corpus("dds/bc1.dds"),
        "pic" | "rgbe" => ImageFormat::Hdr,
        ending => ImageFormat::from_extension(ending).unwrap(),
    };
    let picture = image::DynamicImage::from(colors);
    let picture = match format {
        ImageFormat::Hdr => picture.to_rgb32f().into(),
        _ => picture,
    };
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

#[test]
fn every_picture_is_read_as_an_environment_and_as_a_texture() {
    let folder = Workplace::new();
    for ending in endings(PICTURE_KINDS) {
        let path = folder.path(format!("picture.{ending}"));
        std::fs::write(&path, picture(ending)).unwrap();
        let environment = glossmith::import::environment::load(&EnvironmentSource::File(path.clone()));
        assert!(
            environment.is_ok(),
            ".{ending} as an environment: {}",
            environment.unwrap_err()
        );
        let texture = mean_of_file(&path, &glossmith::import::Budget::of_import());
        assert!(texture.is_ok(), ".{ending} as a texture: {}", texture.unwrap_err());
    }
}

#[test]
fn an_ending_belongs_to_one_kind() {
    for &kind in FileKind::ALL {
        for ending in kind.endings() {
            for written in [ending.to_owned(), ending.to_uppercase()] {
                let path = PathBuf::from(format!("a.{written}"));
                assert_eq!(FileKind::of(&path), Some(kind), "{}", path.display());
            }
        }
    }
    assert_eq!(FileKind::of(Path::new("a.txt")), None);
    assert!(may_hold_document(Path::new("a.PNG")) && !may_hold_document(Path::new("a.jpg")));
}

/// What the program writes it opens again.
#[test]
fn what_is_written_is_of_a_kind_that_is_opened() {
    let pictures = output::FORMATS.map(|(ending, _)| ending);
    let materials = FORMATS
        .iter()
        .filter(|format| format.is_read())
        .flat_map(|format| format.extensions);
    for ending in pictures.iter().chain(materials) {
        let kind = FileKind::of(&PathBuf::from(format!("a.{ending}")));
        assert!(kind.is_some_and(|kind| OPENED.contains(&kind)), ".{ending}");
    }
}

#[test]
fn the_help_names_every_ending() {
    let help = Arguments::command().render_long_help().to_string();
    for ending in endings(OPENED) {
        assert!(help.contains(&format!(".{ending}")), "--help says nothing of .{ending}");
    }
}
