//! Compiled kernels kept on disk between starts, where the driver can (`Features::PIPELINE_CACHE`: Vulkan).

use std::path::PathBuf;

use super::device::GpuDevice;
use crate::document::file::save_atomically;

/// The driver's cache of a device, and the file that it is kept in.
#[derive(Debug)]
pub(super) struct KernelCache {
    cache: wgpu::PipelineCache,
    path: PathBuf,
}

impl KernelCache {
    /// In the user's cache folder; `None` where the driver or the system has no place for it. Software Vulkan compiles
    /// later, and keeps a cache of its own.
    pub(super) fn open(gpu: &GpuDevice) -> Option<Self> {
        if gpu.is_software() {
            return None;
        }
        let folders = directories::ProjectDirs::from("", "", "glossmith")?;
        let key = wgpu::util::pipeline_cache_key(&gpu.info)?;
        Self::at(gpu, folders.cache_dir().join(format!("{key}.kernels")))
    }

    /// Reads what an earlier start left in a file; `None` where the driver keeps nothing.
    fn at(gpu: &GpuDevice, path: PathBuf) -> Option<Self> {
        if !gpu.device.features().contains(wgpu::Features::PIPELINE_CACHE) {
            return None;
        }
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

    /// For the making of a pipeline.
    pub(super) fn cache(&self) -> &wgpu::PipelineCache {
        &self.cache
    }

    /// Writes what the driver has compiled. A cache: where it can't be written, the next start compiles again.
    pub(super) fn save(&self) {
        let Some(data) = self.cache.get_data() else { return };
        let written = self.path.parent().map(std::fs::create_dir_all);
        let written = written.is_some_and(|made| made.is_ok()) && save_atomically(&self.path, &data).is_ok();
        if !written {
            log::debug!("{}: compiled kernels could not be kept", self.path.display());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::AdapterKind;

    #[test]
    fn a_damaged_cache_is_passed_over() {
        let gpu = GpuDevice::open(AdapterKind::Any).expect("an adapter: install mesa-vulkan-drivers");
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("cache/of.kernels");
        let Some(cache) = KernelCache::at(&gpu, path.clone()) else {
            assert!(!gpu.device.features().contains(wgpu::Features::PIPELINE_CACHE));
            return;
        };
        cache.save();
        let whole = std::fs::read(&path).expect("it was saved");
        for damaged in [&whole[..whole.len() / 2], b"not a cache".as_slice()] {
            std::fs::write(&path, damaged).expect("written");
            assert!(KernelCache::at(&gpu, path.clone()).is_some());
        }
    }
}
