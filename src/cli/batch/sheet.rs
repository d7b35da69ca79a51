//! Contact sheets: all images of a batch, small, in one image and on a page that needs no network.

use std::{fmt::Write as _, path::Path, path::PathBuf};

use anyhow::Context;
use image::{RgbImage, imageops::overlay};

use super::{file::BatchFile, file::Picture, row::Row};
use crate::{
    cli::render::thumbnail,
    console::message,
    document::ViewSettings,
    job::film::Image,
    plot::{PictureSheet, plot_file},
    store::{picture::png_bytes, picture::png_image, replace::save_atomically},
};

/// Longest side of a thumbnail, pixels.
const SIDE: u32 = 192;
/// The folder of the thumbnails, and the names of the sheets.
pub const THUMBNAILS: &str = "thumbnails";
const SHEET: &str = "contact-sheet";
/// Codes of the paper where an image is missing or lets light through.
const PAPER: u8 = 230;

fn thumbnail_path(folder: &Path, name: &str) -> PathBuf {
    folder.join(THUMBNAILS).join(format!("{name}.png"))
}

/// Writes the thumbnail of one that was made.
pub fn write_thumbnail(folder: &Path, name: &str, image: &Image, view: &ViewSettings) -> anyhow::Result<()> {
    let path = thumbnail_path(folder, name);
    std::fs::create_dir_all(folder.join(THUMBNAILS))
        .with_context(|| format!("{}: the folder cannot be made", folder.join(THUMBNAILS).display()))?;
    let small = thumbnail(image, view, SIDE)
        .context("an image of another size")?
        .into_rgba8();
    let bytes = png_bytes([small.width(), small.height()], &small, None).map_err(anyhow::Error::msg)?;
    Ok(save_atomically(&path, &bytes)?)
}

/// A thumbnail on paper, in the middle of a square; paper alone where there is none.
fn cell(path: &Path) -> RgbImage {
    let mut cell = image::RgbaImage::from_pixel(SIDE, SIDE, image::Rgba([PAPER, PAPER, PAPER, 255]));
    if let Some(picture) = std::fs::read(path).ok().and_then(|bytes| png_image(&bytes).ok()) {
        let corner = |length: u32| i64::from(SIDE.saturating_sub(length) / 2);
        let (x, y) = (corner(picture.width()), corner(picture.height()));
        overlay(&mut cell, &picture, x, y);
    }
    image::DynamicImage::ImageRgba8(cell).to_rgb8()
}

/// Writes both sheets of all images, those that are missing among them.
pub fn write(file: &BatchFile, pictures: &[Picture]) -> anyhow::Result<()> {
    let folder = &file.folder;
    let title = file.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let cells = pictures.iter().map(|picture| {
        let path = thumbnail_path(folder, &picture.name);
        (picture.name.clone(), cell(&path))
    });
    let sheet = PictureSheet {
        title: title.clone(),
        pictures: cells.collect(),
    };
    let path = folder.join(format!("{SHEET}.png"));
    save_atomically(&path, &plot_file(&path, &sheet)?)?;
    let page = folder.join(format!("{SHEET}.html"));
    save_atomically(&page, html(folder, &title, pictures).as_bytes())?;
    message!("wrote {} and {}", path.display(), page.display());
    Ok(())
}

/// The page: images with their names and what is known of them, each a link to its file.
fn html(folder: &Path, title: &str, pictures: &[Picture]) -> String {
    let mut text = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n<style>\n\
         body {{ font: 14px sans-serif; margin: 24px; background: #fff; color: #222 }}\n\
         main {{ display: grid; grid-template-columns: repeat(auto-fill, minmax(200px, 1fr)); gap: 16px }}\n\
         figure {{ margin: 0 }}\nfigcaption {{ overflow-wrap: anywhere }}\nsmall {{ color: #666 }}\n\
         img, .missing {{ width: 192px; height: 192px; object-fit: contain; background: #e6e6e6; display: block }}\n\
         </style>\n</head>\n<body>\n<h1>{title}</h1>\n<main>\n",
        title = escaped(title)
    );
    for picture in pictures {
        let name = escaped(&picture.name);
        let row = Row::read(&folder.join(format!("{}.json", picture.name)));
        let file = row.as_ref().and_then(|row| row.files.first()?.file_name());
        let _ = match (&row, file) {
            (Some(row), Some(file)) => writeln!(
                text,
                "<figure><a href=\"{}\"><img src=\"{THUMBNAILS}/{name}.png\" alt=\"{name}\"></a><figcaption>{name}<br>\
                 <small>{}</small></figcaption></figure>",
                escaped(&file.to_string_lossy()),
                message(row)
            ),
            _ => writeln!(
                text,
                "<figure><div class=\"missing\"></div><figcaption>{name}<br><small>missing</small></figcaption></figure>"
            ),
        };
    }
    text + "</main>\n</body>\n</html>\n"
}

/// Samples, time and error.
fn message(row: &Row) -> String {
    let mut parts = Vec::new();
    parts.extend(row.samples_per_pixel.map(|samples| format!("{samples} samples")));
    parts.extend(row.render_seconds.map(|seconds| format!("{seconds:.1} s")));
    parts.extend(row.noise.map(|noise| format!("error {:.2} %", 100.0 * noise)));
    parts.join(", ")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
