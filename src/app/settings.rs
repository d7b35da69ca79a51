//! What the window is opened with, and what is remembered from one start to the next.

use std::{path::Path, path::PathBuf, sync::Arc};

use egui::ThemePreference;
use serde::{Deserialize, Serialize};

use crate::{
    document::{Denoise, ImportLobe},
    import::limits,
    named::with_defaults,
    render::{EngineChoice, denoise::Library},
    services::{shelves::KeptShelves, viewing::Resolution},
    store::picture::png_image,
    workspaces::Workspaces,
};

/// Under which the window's state is stored.
const KEY: &str = "editor";

pub fn native_options(backends: wgpu::Backends) -> eframe::NativeOptions {
    let viewport = egui::ViewportBuilder::default()
        // The name of the menu entry that desktops find the icon by: inside a Flatpak the program's id there.
        .with_app_id(std::env::var("FLATPAK_ID").unwrap_or_else(|_| "glossmith".to_owned()))
        .with_icon(icon())
        .with_title("Glossmith")
        .with_inner_size([1440.0, 900.0])
        .with_min_inner_size([760.0, 480.0]);
    let mut options = eframe::NativeOptions {
        viewport,
        // Colours have 8 bits already; software Vulkan draws an eighth faster without.
        dithering: false,
        ..eframe::NativeOptions::default()
    };
    if let eframe::egui_wgpu::WgpuSetup::CreateNew(setup) = &mut options.wgpu_options.wgpu_setup {
        setup.device_descriptor = Arc::new(device_descriptor);
        setup.instance_descriptor.backends &= backends;
    }
    options
}

/// The window's image, which desktops show beside its name.
fn icon() -> Arc<egui::IconData> {
    let png = include_bytes!("../../assets/desktop/glossmith.png");
    let icon = png_image(png).map(|image| egui::IconData {
        width: image.width(),
        height: image.height(),
        rgba: image.into_raw(),
    });
    Arc::new(icon.unwrap_or_default())
}

/// Frames after the start in which the window is fitted to the screen: by then the system has reported both sizes.
const FITTED_FRAMES: u64 = 30;

/// Fills the screen with a window that was opened as large as it or larger: what is around a window would push its last
/// bar beyond the screen.
pub fn fit_to_screen(ctx: &egui::Context) {
    if ctx.cumulative_frame_nr() > FITTED_FRAMES {
        return;
    }
    let info = ctx.input(|input| input.viewport().clone());
    let fills = [info.maximized, info.fullscreen].contains(&Some(true));
    let (Some(screen), Some(inner), false) = (info.monitor_size, info.inner_rect, fills) else {
        return;
    };
    let around = info
        .outer_rect
        .map_or(egui::Vec2::ZERO, |outer| outer.size() - inner.size());
    let most = (screen - around.max(egui::Vec2::ZERO)).max(egui::Vec2::splat(1.0));
    let fitted = inner.size().min(most);
    if fitted != inner.size() {
        ctx.send_viewport_cmd(egui::ViewportCommand::InnerSize(fitted));
        ctx.send_viewport_cmd(egui::ViewportCommand::Maximized(true));
    }
}

/// The window only draws triangles with textures: it takes what limits the adapter has, as the defaults ask for compute
/// that OpenGL may lack, and for less than the largest screens need.
fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    let offered = adapter.limits();
    let modest = wgpu::Limits::downlevel_webgl2_defaults();
    wgpu::DeviceDescriptor {
        label: Some("glossmith window"),
        required_limits: wgpu::Limits {
            max_texture_dimension_2d: offered.max_texture_dimension_2d.min(16_384),
            max_buffer_size: offered.max_buffer_size.min(1 << 28),
            ..modest
        },
        ..Default::default()
    }
}

/// The folder for what belongs to the user, and that for what can be made again, where the system has them.
pub fn folders() -> Option<[PathBuf; 2]> {
    let folders = directories::ProjectDirs::from("", "", "glossmith")?;
    Some([folders.data_local_dir(), folders.cache_dir()].map(Path::to_owned))
}

with_defaults! {
    /// What is remembered.
    #[derive(Serialize, Deserialize)]
    #[serde(default)]
    pub struct KeptSettings {
        pub theme: ThemePreference = ThemePreference::Dark,
        /// With their arrangements of the panels.
        pub workspaces: Workspaces,
        pub resolution: Resolution,
        pub import_lobe: ImportLobe,
        /// The engine as it was chosen by hand.
        pub engine: EngineChoice,
        /// How images were denoised last: new documents begin with that.
        #[serde(default = "first_denoise")]
        pub denoise: Denoise,
        /// Files opened and saved, the latest first.
        pub recent: Vec<PathBuf>,
        /// What the browser remembers.
        pub shelves: KeptShelves,
        /// Files that others may name, wherever they lie.
        pub allowed: Vec<PathBuf>,
    }
}

impl KeptSettings {
    /// What the last start left; the defaults where that can't be read any more, or nothing is kept.
    pub fn load(creation: &eframe::CreationContext<'_>) -> Self {
        let first = || Self {
            denoise: first_denoise(),
            ..Self::default()
        };
        let kept: Self = creation.storage.map_or_else(Self::default, |storage| {
            let kept = storage.get_string(KEY);
            kept.and_then(|text| serde_json::from_str(&text).ok())
                .unwrap_or_else(first)
        });
        limits::allow(&kept.allowed);
        kept
    }

    /// Leaves it for the next start.
    pub fn save(&self, storage: &mut dyn eframe::Storage) {
        match serde_json::to_string(self) {
            Ok(text) => storage.set_string(KEY, text),
            Err(error) => log::error!("settings are not kept: {error}"),
        }
    }
}

/// Denoises from the start where the library is installed.
fn first_denoise() -> Denoise {
    Library::get().map_or(Denoise::Off, |_| Denoise::Auto)
}
