//! What the window is opened with, and what is remembered from one start to the next.

use std::path::PathBuf;
use std::sync::Arc;

use egui::ThemePreference;
use egui_tiles::Tree;
use serde::{Deserialize, Serialize};

use crate::app::desk::Resolution;
use crate::app::layout::{self, Pane};
use crate::document::{Denoise, ImportLobe};
use crate::render::denoise::Library;

/// Under which the window's state is stored.
const KEY: &str = "editor";

/// The window's options.
pub(super) fn native_options() -> eframe::NativeOptions {
    let viewport = egui::ViewportBuilder::default()
        .with_app_id("glossmith")
        .with_title("Glossmith")
        .with_inner_size([1440.0, 900.0])
        .with_min_inner_size([760.0, 480.0]);
    let mut options = eframe::NativeOptions {
        viewport,
        ..eframe::NativeOptions::default()
    };
    if let eframe::egui_wgpu::WgpuSetup::CreateNew(setup) = &mut options.wgpu_options.wgpu_setup {
        setup.device_descriptor = Arc::new(device_descriptor);
    }
    options
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

/// The folder for what belongs to the user, where the system has one.
pub(super) fn data_folder() -> Option<PathBuf> {
    Some(
        directories::ProjectDirs::from("", "", "glossmith")?
            .data_local_dir()
            .to_owned(),
    )
}

/// The folder for what can be made again, where the system has one.
pub(super) fn cache_folder() -> Option<PathBuf> {
    Some(
        directories::ProjectDirs::from("", "", "glossmith")?
            .cache_dir()
            .to_owned(),
    )
}

/// What is remembered.
#[derive(Serialize, Deserialize)]
#[serde(default)]
pub(super) struct Kept {
    pub(super) theme: ThemePreference,
    pub(super) layout: Option<Tree<Pane>>,
    pub(super) resolution: Resolution,
    pub(super) import_lobe: ImportLobe,
    /// How noise was taken out last: new documents begin with that.
    #[serde(default = "first_denoise")]
    pub(super) denoise: Denoise,
    /// Files opened and saved, the latest first.
    pub(super) recent: Vec<PathBuf>,
}

impl Default for Kept {
    fn default() -> Self {
        Self {
            theme: ThemePreference::Dark,
            layout: None,
            resolution: Resolution::default(),
            import_lobe: ImportLobe::default(),
            denoise: Denoise::Off,
            recent: Vec::new(),
        }
    }
}

impl Kept {
    /// What the last start left; the defaults where that can't be read any more, or nothing is kept.
    pub(super) fn load(creation: &eframe::CreationContext<'_>) -> Self {
        let first = || Self {
            denoise: first_denoise(),
            ..Self::default()
        };
        let mut kept: Self = creation.storage.map_or_else(Self::default, |storage| {
            eframe::get_value(storage, KEY).unwrap_or_else(first)
        });
        kept.layout = kept.layout.and_then(layout::complete);
        kept
    }

    /// Leaves it for the next start.
    pub(super) fn save(&self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, KEY, self);
    }
}

/// Pictures are clean at once where that can be had.
fn first_denoise() -> Denoise {
    if Library::get().is_ok() {
        Denoise::Auto
    } else {
        Denoise::Off
    }
}
