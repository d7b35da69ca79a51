//! Import of models from files, folders and archives: choice of the reader, and common steps.

use std::path::{Path, PathBuf};

use super::{fbx, gltf, obj, ply, stl};
use crate::{
    endings::{MODELS, ending, has_ending},
    files::{Files, Import},
    limits::Reach,
    model_error::ModelError,
    scene::{
        Framing, LIGHTS_MAX, LightKind, Loading, Model, ModelLight, ModelOptions, ModelSource, Texture,
        report::{Fate, ImportReport},
        texture::TextureTarget,
    },
};

/// Loads a model. Blocks while reading and decoding; never panics on a damaged file.
pub fn load(source: &ModelSource) -> Result<Model, ModelError> {
    load_with(source, &ModelOptions::default())
}

/// The same with options.
pub fn load_with(source: &ModelSource, options: &ModelOptions) -> Result<Model, ModelError> {
    load_watched(source, options, &Loading::default())
}

/// The same with progress and cancellation.
pub fn load_watched(source: &ModelSource, options: &ModelOptions, loading: &Loading) -> Result<Model, ModelError> {
    match source {
        ModelSource::File(path) => load_path(path, options, loading),
        _ => Ok(Model::built_in(source).unwrap_or_default()),
    }
}

/// Loads the model in a file, folder or archive, joined with those given with it.
fn load_path(path: &Path, options: &ModelOptions, loading: &Loading) -> Result<Model, ModelError> {
    let import = Import::new(loading);
    let mut model = load_one(path, options, &import)?;
    let stem = if path.is_dir() {
        path.file_name()
    } else {
        path.file_stem()
    };
    model.name = stem.map_or_else(|| "model".into(), |stem| stem.to_string_lossy().into_owned());
    for part in options.beside.iter().filter(|file| is_model(file)) {
        let other = load_one(part, options, &import)?;
        let name = part.file_name().unwrap_or_default().to_string_lossy();
        model.report.note(Fate::Used, "models shown together with it", &name);
        model.join(other);
    }
    loading.check()?;
    finish(&mut model);
    model.name_its_whole();
    model.files = import.asked.take();
    note_outside(&mut model, path, &options.beside);
    Ok(model)
}

/// Reports files read outside the model's reach, because exports may contain them.
fn note_outside(model: &mut Model, path: &Path, given: &[PathBuf]) {
    let folder = if path.is_dir() { Some(path) } else { path.parent() };
    let reach = Reach::of_folder(folder.unwrap_or(Path::new("")));
    for file in &model.files {
        if file != path && !given.contains(file) && !reach.encloses(file) {
            let what = "files from outside of the model's surroundings";
            model.report.note(Fate::Used, what, &file.to_string_lossy());
        }
    }
}

fn load_one(path: &Path, options: &ModelOptions, import: &Import) -> Result<Model, ModelError> {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    import.loading.step(format!("reading {name}"))?;
    let read = |error| match import.loading.check() {
        Err(cancelled) => cancelled.into(),
        Ok(()) => unreadable(path, error),
    };
    let in_folder = |folder: &Path| Files::in_folder(folder, &options.beside, import);
    if path.is_dir() {
        return load_inside(path, in_folder(path), options);
    }
    import.asked.note(path);
    if ending(path) == "zip" {
        let files = Files::in_archive(path, import).map_err(read)?;
        return load_inside(path, files, options);
    }
    let bytes = import.read(path).map_err(read)?;
    load_file(path, in_folder(path.parent().unwrap_or(Path::new(""))), bytes, options)
}

fn unreadable(path: &Path, error: std::io::Error) -> ModelError {
    let what = format_args!("cannot read this model: {error}; check the path and its permissions");
    ModelError::refused(path, what)
}

/// Whether a file's ending is that of a model.
pub fn is_model(path: &Path) -> bool {
    has_ending(path, &MODELS)
}

/// Whether a folder has a model in it.
pub fn holds_model(folder: &Path) -> bool {
    let entries = std::fs::read_dir(folder);
    entries.is_ok_and(|mut entries| entries.any(|entry| entry.is_ok_and(|entry| is_model(&entry.path()))))
}

/// Loads the model among files: of the first format that there is, the file that is nearest to the top.
fn load_inside(path: &Path, files: Files, options: &ModelOptions) -> Result<Model, ModelError> {
    let read = |error| unreadable(path, error);
    let mut names = files.names().map_err(read)?;
    // What macOS puts beside files on foreign disks and into archives.
    names.retain(|name| {
        !name.starts_with("__MACOSX/") && !name.rsplit('/').next().is_some_and(|last| last.starts_with("._"))
    });
    let of_format = |wanted: &&str| {
        let mut found: Vec<&String> = names.iter().filter(|name| ending(Path::new(name)) == *wanted).collect();
        found.sort_by_key(|name| name.matches('/').count());
        found.into_iter().next().cloned()
    };
    let name = MODELS.iter().filter(|ending| **ending != "zip").find_map(of_format);
    let all = || MODELS.join(", ");
    let name = name.ok_or_else(|| ModelError::refused(path, format_args!("no model in it; models are {}", all())))?;
    let bytes = files.read(&name).map_err(read)?;
    let others = names
        .iter()
        .filter(|other| **other != name && is_model(Path::new(other)))
        .count();
    let mut model = load_file(&path.join(&name), files.seen_from(&name), bytes, options)?;
    model.report.note(Fate::Used, "the model file", &name);
    model.report.count(Fate::Ignored, "other models beside it", "", others);
    Ok(model)
}

/// Loads the contents of a file by its ending.
fn load_file(path: &Path, files: Files, bytes: Vec<u8>, options: &ModelOptions) -> Result<Model, ModelError> {
    let model = match ending(path).as_str() {
        "fbx" => fbx::load(path, &files, &bytes, options)?,
        "obj" => obj::load(path, &files, &bytes, options)?,
        "ply" => ply::load(path, &files, &bytes, options)?,
        "stl" => stl::load(path, &bytes, &files.import.loading)?,
        "usd" | "usda" | "usdc" | "usdz" => load_usd(path, files, bytes, options)?,
        // glTF files are recognised by their first bytes, not by name.
        _ => gltf::load(path, files, bytes, options)?,
    };
    if model.triangle_count() == 0 {
        return Err(ModelError::no_triangles(path));
    }
    Ok(model)
}

#[cfg(feature = "usd")]
use crate::usd::load as load_usd;

/// Says that the program was built without.
#[cfg(not(feature = "usd"))]
fn load_usd(path: &Path, _files: Files, _bytes: Vec<u8>, _options: &ModelOptions) -> Result<Model, ModelError> {
    let what = "this program was built without USD (the feature `usd`); convert the model to glTF";
    Err(ModelError::refused(path, what))
}

/// Common steps of all formats: lengths in bounding radii, and a warning on unusable triangles.
fn finish(model: &mut Model) {
    let framing = Framing::of(model);
    let radius = framing.world_units_per_unit as f32;
    for slot in &mut model.slots {
        let depth = slot.number("transmission.depth");
        if depth > 0.0 {
            slot.set("transmission.depth", depth / radius);
        }
        let texture = slot
            .texture(TextureTarget::Roughness)
            .and_then(|place| model.textures.get(place.texture));
        slot.roughest_texel = texture.map_or(1.0, |texture| texture.brightest(1));
    }
    (model.center, model.radius) = (framing.center_world.to_array(), framing.world_units_per_unit);
    let all = model.triangle_count();
    let no_area = all - framing.dropped_not_finite - framing.usable;
    let cameras = model.cameras.len();
    note_lights(&mut model.report, &model.lights);
    let texture_bytes: usize = model.textures.iter().map(Texture::bytes).sum();
    let report = &mut model.report;
    report.count(Fate::Used, "cameras, as bookmarks", "", cameras);
    report.count(Fate::Used, "triangles", "", framing.usable);
    if texture_bytes > 0 {
        let mib = texture_bytes as f64 / f64::from(1 << 20);
        report.note(Fate::Used, format!("textures, {mib:.1} MiB in memory"), "");
    }
    report.count(Fate::Ignored, "triangles without area", "", no_area);
    let what = "triangles with a corner that is not finite";
    report.count(Fate::Ignored, what, "", framing.dropped_not_finite);
}

/// Reports the fates of a file's lights; a scene has a maximum number of lights.
fn note_lights(report: &mut ImportReport, lights: &[ModelLight]) {
    let shown = &lights[..lights.len().min(LIGHTS_MAX)];
    for light in shown {
        let (fate, what) = match light.kind {
            LightKind::Point => (Fate::Approximated, "points of light, as small spheres"),
            LightKind::Spot(_) => (
                Fate::Approximated,
                "spots, as small discs, which are dimmer askew by the cosine",
            ),
            LightKind::Directional => (Fate::Used, "suns, 0.53° across"),
        };
        report.note(fate, what, "");
    }
    report.count(Fate::Ignored, "lights of too many", "", lights.len() - shown.len());
}
