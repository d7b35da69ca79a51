//! Endings of the files that are read, without their dots: what the program knows a kind of file by. Materials of other
//! programs have theirs in the registry of formats above.

use std::path::Path;

/// Models, those first that are looked for first in folders and archives.
pub const MODELS: [&str; 6] = ["gltf", "glb", "obj", "ply", "stl", "zip"];

/// Pictures of light: environments where they are opened.
pub const LIGHT: [&str; 6] = ["hdr", "exr", "ktx2", "dds", "pic", "rgbe"];

/// Pictures for screens: environments where they are opened, textures where they are dropped.
pub const PICTURES: [&str; 8] = ["png", "jpg", "jpeg", "tif", "tiff", "webp", "bmp", "tga"];

/// What models refer to and nothing can be seen of by itself.
pub const PARTS: [&str; 2] = ["bin", "mtl"];

/// The ending of a file's name in lower case, without its dot; empty where there is none.
pub fn ending(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// True where a file's ending is one of these.
pub fn has_ending(path: &Path, endings: &[&str]) -> bool {
    endings.contains(&ending(path).as_str())
}

/// True for a picture of either kind: all of them can be an environment or a texture.
pub fn is_picture(path: &Path) -> bool {
    has_ending(path, &LIGHT) || has_ending(path, &PICTURES)
}
