//! Materials in JSON files, and the ones that come with the program.
//!
//! `{"glossmith": 1, "name": "Gold", "material": {"base.color": [1, 0.8, 0.3], "specular.lobe": "geometric", …}}`: inside
//! "material" the keys of [`PARAMETERS`]; those left out have their defaults. What this version does not know is kept
//! and written back.

use std::{path::Path, path::PathBuf, sync::LazyLock};

use serde_json::{Map, Value as Json, json};

use super::{FileError, Loaded, file, own, replace::save_atomically};
use crate::{
    document::{
        MaterialSettings, PARAMETERS, ParameterError, TextureError,
        material::FILM_THICKNESS_MAX,
        parameter::{nearest, nearest_key},
        texture_from_json, texture_to_json,
    },
    import::kept_keys,
    optics::layer::fuzz::fuzz_of_sheen,
    scene::{path_text::path_of_text, texture::TextureTarget},
};

/// The version of the format.
pub const VERSION: u64 = 1;
/// The key of the version, by which such a file is known.
pub const MARK: &str = "glossmith";

/// Turns an object of version n, at index n, into one of version n + 1.
const MIGRATIONS: [fn(&mut Map<String, Json>); VERSION as usize] = [migrate_0];

macro_rules! shipped {
    ($($group:literal: $($file:literal)*;)*) => {
        &[$(($group, &[$(include_str!(concat!("../../assets/presets/", $file, ".json")),)*]),)*]
    };
}

/// The files of the shipped materials in their groups, in the order of the menus.
pub const SHIPPED: &[(&str, &[&str])] = shipped! {
    "Plastics and rubber":
        "plastic-blue" "plastic-red" "plastic-white" "plastic-yellow" "rubber" "satin-black" "soft-touch-black";
    "Paint, clay and stone":
        "lambert-white" "clay" "chalk" "eggshell-paint" "matt-green-paint" "terracotta" "stoneware" "obsidian" "jade";
    "Ceramics and pearl": "porcelain" "celadon-glaze" "cobalt-glaze" "pearl";
    "Cloth": "velvet-burgundy" "velvet-navy" "cotton-white" "denim" "felt-grey" "suede-tan";
    "Lacquer and car paint":
        "lacquered-walnut" "lacquered-oak" "car-paint-red" "car-paint-blue" "car-paint-black" "car-paint-silver" "candy-red";
    "Metals":
        "chrome" "silver" "aluminium" "brushed-aluminium" "brushed-steel" "gold" "satin-gold" "brass" "brushed-brass"
        "copper" "platinum" "titanium" "cast-iron" "mercury";
    "Glass and liquids":
        "glass" "frosted-glass" "acrylic" "water" "bottle-glass" "amber" "emerald-glass" "ruby-glass" "sapphire-glass"
        "diamond";
    "Films and anodised metals":
        "soap-film" "oil-on-water" "tempered-steel" "anodised-titanium-blue" "anodised-titanium-gold"
        "anodised-titanium-magenta";
    "With texture maps":
        "hairline-steel" "hammered-copper" "metallic-blue" "orange-peel-paint" "linen" "leather-brown" "carbon-weave"
        "fingerprints";
};

/// The shipped materials, in the order of the menus.
pub static PRESETS: LazyLock<Vec<MaterialSettings>> = LazyLock::new(|| {
    let parse = |text: &&str| {
        let parsed = parse_material(Path::new("assets/presets"), text.as_bytes());
        let mut material = parsed.expect("shipped materials are valid").value;
        material.file_extra.shift_remove(SOURCE);
        material
    };
    SHIPPED.iter().flat_map(|(_, files)| *files).map(parse).collect()
});

/// The key in a shipped file that says where its values come from.
const SOURCE: &str = "source";

/// Where the values of [`PRESETS`] come from, in their order: read once, because the browser shows them in each frame.
static SOURCES: LazyLock<Vec<String>> = LazyLock::new(|| {
    let source = |text: &&str| {
        let object = file::object(Path::new("assets/presets"), text.as_bytes()).ok()?;
        Some(object.get(SOURCE)?.as_str()?.to_owned())
    };
    let texts = SHIPPED.iter().flat_map(|(_, files)| *files);
    texts.map(|text| source(text).unwrap_or_default()).collect()
});

/// Where a shipped material's values come from, one or two sentences; `None` for a material that is not shipped.
pub fn source_of_values(name: &str) -> Option<&'static str> {
    let index = PRESETS.iter().position(|material| material.name == name)?;
    Some(&SOURCES[index])
}

/// A material's name as it is written on the command line: lower case, hyphens for spaces.
pub fn command_line_name(name: &str) -> String {
    name.trim().to_lowercase().replace([' ', '_'], "-")
}

/// The shipped material of that name, in upper or lower case, with spaces or hyphens.
pub fn material_by_name(name: &str) -> Option<&'static MaterialSettings> {
    let wanted = command_line_name(name);
    PRESETS
        .iter()
        .find(|material| command_line_name(&material.name) == wanted)
}

/// The shipped material of that name, else the material in the file of that name.
///
/// # Errors
/// What is wrong with the file; the names that there are if there is no such file.
pub fn find(name_or_path: &str) -> Result<Loaded<MaterialSettings>, FileError> {
    if let Some(material) = material_by_name(name_or_path) {
        return Ok(Loaded {
            value: material.clone(),
            warnings: Vec::new(),
        });
    }
    let path = &path_of_text(name_or_path);
    let is_path = path.extension().is_some() || path.components().count() > 1;
    if !is_path && !path.exists() {
        let known: Vec<_> = PRESETS
            .iter()
            .map(|material| command_line_name(&material.name))
            .collect();
        let near = nearest(
            &command_line_name(name_or_path),
            known.iter().map(|name| (name.as_str(), name)),
        );
        return Err(FileError::UnknownMaterial {
            name: name_or_path.to_owned(),
            hint: match near {
                Some(near) => format!("did you mean {near}?"),
                None => format!("the shipped ones are {}", known.join(", ")),
            },
        });
    }
    open_material(path, &file::read(path)?)
}

/// The material in a file's contents that may come from elsewhere: what lies outside of its surroundings is only named by the
/// user's own.
pub(super) fn open_material(path: &Path, bytes: &[u8]) -> Result<Loaded<MaterialSettings>, FileError> {
    own::within_reach(path, bytes, parse_material(path, bytes)?, named)
}

/// The files that a material names.
fn named(material: &MaterialSettings) -> Vec<PathBuf> {
    material.user_textures.files().cloned().collect()
}

/// The material in a file.
pub fn load_material(path: &Path) -> Result<Loaded<MaterialSettings>, FileError> {
    parse_material(path, &file::read(path)?)
}

/// The material in a file's contents. `path` is only named in messages.
pub fn parse_material(path: &Path, bytes: &[u8]) -> Result<Loaded<MaterialSettings>, FileError> {
    let mut object = file::object(path, bytes)?;
    let version = file::version(path, &object, MARK)?.unwrap_or(0);
    let mut warnings = file::of_newer(path, version, VERSION);
    for migrate in MIGRATIONS.iter().skip(version as usize) {
        migrate(&mut object);
    }
    if !object.contains_key("material") {
        return Err(FileError::WrongKind {
            path: path.to_owned(),
            expected: "material",
            mark: MARK,
        });
    }
    let mut material = MaterialSettings::try_from(object).map_err(|error| FileError::content(path, error))?;
    material.user_textures.map_files(file::named_in(path));
    warnings.extend(unknown_keys(&material).map(|warning| format!("{}: {warning}", path.display())));
    Ok(Loaded {
        value: material,
        warnings,
    })
}

/// Files without a number, as people write them by hand: parameters may stand beside the name, with or without their
/// group where one group only has them ("roughness").
fn migrate_0(object: &mut Map<String, Json>) {
    let mut material = match object.remove("material") {
        Some(Json::Object(material)) => material,
        // Left for the reader to refuse.
        Some(other) => {
            object.insert("material".to_owned(), other);
            return;
        }
        None => Map::new(),
    };
    for key in object.keys().cloned().collect::<Vec<_>>() {
        let is_meant = |known: &str| known == key || known.split_once('.').is_some_and(|(_, short)| short == key);
        // Groups that came after version 0 are never meant.
        let mut meant = PARAMETERS
            .iter()
            .map(|parameter| parameter.key)
            .filter(|known| is_meant(known) && !is_newer(known));
        if let (Some(known), None) = (meant.next(), meant.next())
            && let Some(value) = object.remove(&key)
        {
            material.insert(known.to_owned(), value);
        }
    }
    if !material.is_empty() {
        object.insert("material".to_owned(), Json::Object(material));
        object.insert(MARK.to_owned(), json!(1));
    }
}

/// True of parameters that came after version 0.
fn is_newer(key: &str) -> bool {
    let groups = ["transmission.", "coat.", "fuzz.", "thin_film.", "geometry."];
    groups.iter().any(|group| key.starts_with(group)) || key == "base.weight" || key.ends_with("_texture")
}

/// A sentence for each key of "material" that has no effect.
pub(super) fn unknown_keys(material: &MaterialSettings) -> impl Iterator<Item = String> + '_ {
    // Comes with a model's materials, for when it can be shown.
    let is_kept = |key: &&String| kept_keys().any(|kept| kept == key.as_str());
    material.extra.keys().filter(move |key| !is_kept(key)).map(|key| {
        let hint = nearest_key(key).map_or_else(String::new, |near| format!("; did you mean {near}?"));
        format!("{key} is no parameter and has no effect{hint}")
    })
}

/// Saves a material, replacing the file at once.
///
/// # Errors
/// [`FileError::Write`]; the old file is then untouched.
pub fn save_material(path: &Path, material: &MaterialSettings) -> Result<(), FileError> {
    save_atomically(path, material_text(path, material).as_bytes())
}

/// The contents of a material's file at `path`.
pub fn material_text(path: &Path, material: &MaterialSettings) -> String {
    let mut material = material.clone();
    let mark = own::mark(path, &named(&material));
    material.user_textures.map_files(file::written_in(path));
    let mut object = Map::new();
    object.insert(MARK.to_owned(), json!(VERSION));
    object.extend(Map::from(material));
    object.extend(mark.map(|mark| (own::KEY.to_owned(), mark.into())));
    file::text(&object)
}

/// What makes an object no material.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MaterialError {
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A texture of the user's own.
    #[error(transparent)]
    Texture(#[from] TextureError),
    /// The name is no text.
    #[error("\"name\" must be text; put it in quotation marks")]
    Name,
    /// "material" is no object.
    #[error("\"material\" must be an object; write {{\"specular.roughness\": 0.3}} or the like")]
    Material,
}

/// Turns what older files kept of glTF's iridescence into the thin film that it is.
fn show_iridescence(values: &mut Map<String, Json>) {
    values.shift_remove("iridescence.thickness_min_nm");
    let mut take = |key: &str| values.shift_remove(key).and_then(|value| value.as_f64());
    let [weight, ior, thickness_nm] = ["weight", "ior", "thickness_nm"].map(|key| take(&format!("iridescence.{key}")));
    let Some(weight) = weight else { return };
    let film = [
        ("thin_film.weight", weight.clamp(0.0, 1.0)),
        ("thin_film.ior", ior.unwrap_or(1.3).clamp(1.0, 3.0)),
        (
            "thin_film.thickness",
            (0.001 * thickness_nm.unwrap_or(400.0)).clamp(0.0, FILM_THICKNESS_MAX.into()),
        ),
    ];
    for (key, value) in film {
        values.entry(key).or_insert(json!(value));
    }
}

/// Turns what older files kept of glTF's sheen into fuzz.
fn show_sheen(values: &mut Map<String, Json>) {
    let roughness = values.shift_remove("sheen.roughness").and_then(|value| value.as_f64());
    let Some(Json::Array(color)) = values.shift_remove("sheen.color") else {
        return;
    };
    let channel = |i: usize| color.get(i).and_then(Json::as_f64).unwrap_or(0.0).clamp(0.0, 1.0) as f32;
    let (weight, tint, roughness) = fuzz_of_sheen([0, 1, 2].map(channel), roughness.unwrap_or(0.0) as f32);
    let fuzz = [
        ("fuzz.weight", json!(weight)),
        ("fuzz.color", json!(tint)),
        ("fuzz.roughness", json!(roughness)),
    ];
    for (key, value) in fuzz {
        values.entry(key).or_insert(value);
    }
}

/// From `{"name": …, "material": {…}}`.
impl TryFrom<Map<String, Json>> for MaterialSettings {
    type Error = MaterialError;
    fn try_from(mut object: Map<String, Json>) -> Result<Self, MaterialError> {
        let mut material = Self::default();
        match object.shift_remove("name") {
            Some(Json::String(name)) => material.name = name,
            Some(_) => return Err(MaterialError::Name),
            None => {}
        }
        let mut values = match object.shift_remove("material") {
            Some(Json::Object(values)) => values,
            Some(_) => return Err(MaterialError::Material),
            None => Map::new(),
        };
        show_iridescence(&mut values);
        show_sheen(&mut values);
        let has_coat = values.get("coat.weight").and_then(Json::as_f64) > Some(0.0);
        if has_coat && !values.contains_key("coat.on_base") {
            // From before coats changed what lies below them.
            material.keep_below_coat();
        }
        for parameter in PARAMETERS.iter() {
            if let Some(json) = values.shift_remove(parameter.key) {
                parameter.set(&mut material, parameter.value_from_json(&json)?)?;
            }
        }
        for &target in TextureTarget::ALL {
            if let Some(json) = values.shift_remove(target.map_key()) {
                material.user_textures.set(target, Some(texture_from_json(json)?));
            }
        }
        object.shift_remove(MARK);
        object.shift_remove(own::KEY);
        material.extra = values;
        material.file_extra = object;
        Ok(material)
    }
}

/// To `{"name": …, "material": {…}}`.
impl From<MaterialSettings> for Map<String, Json> {
    fn from(material: MaterialSettings) -> Self {
        let mut values = Map::new();
        for parameter in PARAMETERS.iter() {
            values.insert(
                parameter.key.to_owned(),
                parameter.json_from_value(&parameter.get(&material)),
            );
        }
        for (target, texture) in material.user_textures.iter() {
            values.insert(target.map_key().to_owned(), texture_to_json(texture));
        }
        values.extend(material.extra);
        let mut object = Map::new();
        object.insert("name".to_owned(), Json::from(material.name));
        object.insert("material".to_owned(), Json::Object(values));
        object.extend(material.file_extra);
        object
    }
}
