//! File extensions of readable files, without dots. Other programs' materials have theirs in the registry of formats above.

use std::path::{Path, PathBuf};

/// Models, in search order for folders and archives.
pub const MODELS: [&str; 10] = ["gltf", "glb", "usdz", "usdc", "usd", "fbx", "obj", "ply", "stl", "zip"];

/// Images of light, opened as environments.
pub const LIGHT: [&str; 6] = ["hdr", "exr", "ktx2", "dds", "pic", "rgbe"];

/// Display-referred images: environments if opened, textures if dropped.
pub const PICTURES: [&str; 8] = ["png", "jpg", "jpeg", "tif", "tiff", "webp", "bmp", "tga"];

/// Parts of models that cannot be shown alone.
pub const PARTS: [&str; 2] = ["bin", "mtl"];

/// Extension of a file name in lower case, without its dot; empty for none.
pub fn ending(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// True if a file has one of these extensions.
pub fn has_ending(path: &Path, endings: &[&str]) -> bool {
    endings.contains(&ending(path).as_str())
}

/// True for an image of either kind: all can be an environment or a texture.
pub fn is_picture(path: &Path) -> bool {
    has_ending(path, &LIGHT) || has_ending(path, &PICTURES)
}

/// The image files directly in a folder, by name.
pub fn pictures_in(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let paths = entries.flatten().map(|entry| entry.path());
    let mut pictures: Vec<PathBuf> = paths.filter(|path| is_picture(path) && path.is_file()).collect();
    pictures.sort();
    pictures
}
