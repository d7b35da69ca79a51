//! The reference image, read beside the window.

use std::{path::Path, path::PathBuf, sync::Arc};

use egui::{Color32, ColorImage, TextureHandle, TextureOptions};

use crate::{import::Budget, import::picture::read_texture, scene::Texture, services::beside::Beside};

/// Longest side to which it is reduced, pixels.
const SIDE_MAX: u32 = 4096;

/// What became of a file.
type Read = (PathBuf, Result<TextureHandle, String>);

/// The image of the file that was asked for last.
#[derive(Default)]
pub struct ReferenceImage(Beside<PathBuf, Arc<Read>>);

impl ReferenceImage {
    /// The image of a file, once it is read. To be called while it is shown.
    pub fn texture(&mut self, ctx: &egui::Context, file: &Path) -> Option<TextureHandle> {
        let of_thread = ctx.clone();
        let read = self
            .0
            .ask(ctx, "reference image", file.to_owned(), move |file, responder| {
                let read = read_texture(&file, true, SIDE_MAX, &Budget::of_import());
                let loaded =
                    read.map(|texture| of_thread.load_texture("reference", image(&texture), TextureOptions::LINEAR));
                responder.publish(Arc::new((file, loaded)));
            })?;
        read.1.as_ref().ok().filter(|_| read.0 == file).cloned()
    }

    /// Why a file can't be shown, if that is known.
    pub fn failure(&self, file: &Path) -> Option<String> {
        let read = self.0.latest().filter(|read| read.0 == file)?;
        read.1.as_ref().err().cloned()
    }
}

/// As the screen shows it.
fn image(texture: &Texture) -> ColorImage {
    let color = |[r, g, b, a]: [u8; 4]| Color32::from_rgba_unmultiplied(r, g, b, a);
    let pixels = if texture.rgba16.is_empty() {
        let texels = texture.rgba8.as_chunks::<4>().0.iter();
        texels.map(|texel| color(*texel)).collect()
    } else {
        let texels = texture.rgba16.as_chunks::<4>().0.iter();
        texels.map(|texel| color(texel.map(|x| (x >> 8) as u8))).collect()
    };
    ColorImage::new([texture.width as usize, texture.height as usize], pixels)
}
