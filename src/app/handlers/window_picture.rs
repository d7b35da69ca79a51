//! A screenshot itself, panels and all: for guides, and for reports of what looks wrong.

use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::Duration;

use egui::ColorImage;

use crate::app::App;
use crate::app::services::messages::Success;
use crate::store::picture::png_bytes;
use crate::store::replace::save_atomically;

/// How long the image may take to come.
const PATIENCE: Duration = Duration::from_secs(20);

impl App {
    /// Asks for the image that was wanted in the frame before, when a sheet may have lain over the window.
    pub fn picture_window(&mut self, ctx: &egui::Context) {
        let Some(path) = self.window_picture.take() else {
            return;
        };
        let (sender, taken) = channel();
        ctx.request_screenshot(move |image| {
            // Nobody listens where it took too long.
            let _ = sender.send(image);
        });
        ctx.request_repaint();
        self.files.disk.write_beside(move || {
            let image: Arc<ColorImage> = taken
                .recv_timeout(PATIENCE)
                .map_err(|_| format!("{}: the screenshot can't be read back from the GPU", path.display()))?;
            let [width, height] = image.size;
            save(&path, &image)?;
            Ok(Success::with_file(
                "Saved",
                &path,
                &format!("{width} × {height} pixels"),
            ))
        });
    }
}

fn save(path: &Path, image: &ColorImage) -> Result<(), String> {
    // The window is opaque, even if its surface has an alpha.
    let opaque = |pixel: &egui::Color32| [pixel.r(), pixel.g(), pixel.b(), 255];
    let rgba: Vec<u8> = image.pixels.iter().flat_map(opaque).collect();
    let bytes = png_bytes(image.size.map(|side| side as u32), &rgba, None)?;
    save_atomically(path, &bytes).map_err(crate::in_words)
}
