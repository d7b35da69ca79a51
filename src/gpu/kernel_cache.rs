//! Cache of compiled kernels on disk, if the driver supports it (`Features::PIPELINE_CACHE`: Vulkan).

use std::{io::Write, path::Path, path::PathBuf};

use super::{device::GpuDevice, traversal::Traversal};

/// The driver's cache of a device, and the file that it is kept in.
#[derive(Debug)]
pub struct KernelCache {
    pub cache: wgpu::PipelineCache,
    path: PathBuf,
}

impl KernelCache {
    /// Opens the cache in the user's cache folder. `None` if the driver or the system has none. Software Vulkan compiles
    /// later and has its own cache.
    pub fn open(gpu: &GpuDevice) -> Option<Self> {
        if gpu.is_software() || !gpu.device.features().contains(wgpu::Features::PIPELINE_CACHE) {
            return None;
        }
        let folders = directories::ProjectDirs::from("", "", "glossmith")?;
        let key = wgpu::util::pipeline_cache_key(&gpu.info)?;
        // A file per traversal, so that devices of different kinds do not overwrite each other's.
        let ending = match gpu.traversal {
            Traversal::Own => "kernels",
            Traversal::RayQueries => "ray-query.kernels",
        };
        let path = folders.cache_dir().join(format!("{key}.{ending}"));
        let data = std::fs::read(&path).ok();
        let descriptor = wgpu::PipelineCacheDescriptor {
            label: Some("kernels"),
            data: data.as_deref(),
            fallback: true,
        };
        // SAFETY: the file is written by `save` alone, whole, and wgpu checks that it is of this driver and adapter.
        let cache = unsafe { gpu.device.create_pipeline_cache(&descriptor) };
        Some(Self { cache, path })
    }

    /// Saves the compiled kernels. If that fails, the next start compiles again.
    pub fn save(&self) {
        let Some(data) = self.cache.get_data() else { return };
        if let Err(error) = replace(&self.path, &data) {
            log::debug!("{}: compiled kernels could not be kept: {error}", self.path.display());
        }
    }
}

/// Replaces the file atomically: another process finds the old cache or the new one.
fn replace(path: &Path, data: &[u8]) -> std::io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(data)?;
    file.persist(path)?;
    Ok(())
}
