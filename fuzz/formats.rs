//! What becomes of a file's bytes, whatever they are: something that can be rendered, or an error. Both the fuzz targets
//! and the test suite call it.

use std::path::{Path, PathBuf};

use glossmith::scene::environment::{self, EnvironmentSource};
use glossmith::scene::{Geometry, ModelSource, load};
use glossmith::store::{file, load_document, load_material};

/// Kinds of files.
#[allow(dead_code)]
pub const FORMATS: [&str; 10] = [
    "glb", "obj", "ply", "stl", "zip", "hdr", "exr", "png", "material", "project",
];

/// Reads a file of a kind. Panics where what comes out can't be rendered; that is the point of it.
pub fn try_file(format: &str, bytes: &[u8]) {
    let path = path(format);
    std::fs::write(&path, bytes).expect("a temporary folder that can be written to");
    try_path(format, &path);
}

fn path(format: &str) -> PathBuf {
    let ending = match format {
        "material" | "project" => "json",
        other => other,
    };
    let thread = format!("{:?}", std::thread::current().id()).replace(['(', ')'], "");
    std::env::temp_dir().join(format!("glossmith-fuzz-{}-{thread}.{ending}", std::process::id()))
}

fn try_path(format: &str, path: &Path) {
    match format {
        "glb" | "obj" | "ply" | "stl" | "zip" => {
            if let Ok(model) = load(&ModelSource::File(path.to_owned())) {
                let geometry = Geometry::build(&model, true);
                let hit = geometry.intersect([0.3, 0.2, -2.0], [0.01, 0.02, 1.0], f32::INFINITY);
                assert!(hit.is_none_or(|hit| hit.t > 0.0));
            }
        }
        "hdr" | "exr" | "png" => {
            if let Ok(map) = environment::load(&EnvironmentSource::File(path.to_owned())) {
                assert!(map.texels.iter().flatten().all(|x| x.is_finite() && *x >= 0.0));
                assert!(
                    map.cells
                        .iter()
                        .all(|cell| cell.density.is_finite() && cell.density >= 0.0)
                );
            }
        }
        _ => {
            let _ = file::open(path);
            let _ = load_material(path);
            if let Ok(document) = load_document(path) {
                assert!(document.value.check().is_ok());
            }
        }
    }
}
