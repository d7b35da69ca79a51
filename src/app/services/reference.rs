//! The reference image, read beside the window.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Color32, ColorImage, TextureHandle, TextureOptions};

use crate::app::services::beside::started;
use crate::import::Budget;
use crate::import::picture::read_texture;
use crate::render::background::Background;
use crate::scene::Texture;

/// Longest side to which it is reduced, pixels.
const SIDE_MAX: u32 = 4096;

/// What became of a file.
struct Read {
    file: PathBuf,
    image: Result<ColorImage, String>,
}

/// The image of the file that was asked for last.
#[derive(Default)]
pub struct ReferenceImage {
    worker: Option<Background<PathBuf, Arc<Read>>>,
    asked: Option<PathBuf>,
    /// What was read last, with its texture.
    read: Option<(Arc<Read>, Option<TextureHandle>)>,
}

impl ReferenceImage {
    /// The image of a file, once it is read. To be called while it is shown.
    pub fn texture(&mut self, ctx: &egui::Context, file: &Path) -> Option<&TextureHandle> {
        let worker = started(&mut self.worker, ctx, |repaint| {
            Background::spawn("reference image", repaint, |file: PathBuf, responder| {
                let image = read_texture(&file, true, SIDE_MAX, &Budget::of_import()).map(|texture| image(&texture));
                responder.publish(Arc::new(Read { file, image }));
            })
        })?;
        if self.asked.as_deref() != Some(file) {
            worker.ask(file.to_owned());
            self.asked = Some(file.to_owned());
        }
        let is_known = |latest: &Arc<Read>| matches!(&self.read, Some((read, _)) if Arc::ptr_eq(read, latest));
        if let Some(latest) = worker.latest().filter(|latest| !is_known(latest)) {
            let load = |image: &ColorImage| ctx.load_texture("reference", image.clone(), TextureOptions::LINEAR);
            let texture = latest.image.as_ref().ok().map(load);
            self.read = Some((latest, texture));
        }
        let (read, texture) = self.read.as_ref()?;
        texture.as_ref().filter(|_| read.file == file)
    }

    /// Why a file can't be shown, if that is known.
    pub fn failure(&self, file: &Path) -> Option<&str> {
        let (read, _) = self.read.as_ref().filter(|(read, _)| read.file == file)?;
        read.image.as_ref().err().map(String::as_str)
    }
}

/// As the screen shows it.
fn image(texture: &Texture) -> ColorImage {
    let color = |[r, g, b, a]: [u8; 4]| Color32::from_rgba_unmultiplied(r, g, b, a);
    let pixels = if texture.rgba16.is_empty() {
        texture
            .rgba8
            .as_chunks::<4>()
            .0
            .iter()
            .map(|texel| color(*texel))
            .collect()
    } else {
        let texels = texture.rgba16.as_chunks::<4>().0.iter();
        texels.map(|texel| color(texel.map(|x| (x >> 8) as u8))).collect()
    };
    ColorImage::new([texture.width as usize, texture.height as usize], pixels)
}
