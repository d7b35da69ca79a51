//! glTF 2.0: the model of a document with its materials and textures, or a ball with one material; and materials back.

mod material;
mod own;

use std::path::Path;

use serde_json::{Map, Value as Json, json};

use self::material::{ANISOTROPY, SlotTextures, UNLIT, extensions_used, material_json};
use super::{
    ExchangeError, ReadOptions, Subject, Written, carried,
    report::Entry,
    shown,
    surface::{Law, Surface, Takes},
};
use crate::{
    document::{Document, ImportLobe, MaterialSettings, of_model::import_report, of_model::materials_of},
    import::{Budget, endings::has_ending, gltf_from_widths, limits, load, load_with},
    scene::{Fate, Model, ModelSource, Slot, Wrap, texture::TextureTarget, texture::texture_mean},
    store::picture::png_bytes,
};

/// α is 1 there at most.
fn shown_widths(surface: &Surface) -> [f32; 2] {
    let exported = gltf_from_widths(surface.roughness, surface.anisotropy);
    let across = exported.roughness * exported.roughness;
    [across + (1.0 - across) * exported.stretch * exported.stretch, across]
}

/// Numbers of the format: of components, buffers' uses, sampling.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// What it takes of a material: OpenPBR's coat by a draft.
fn takes(material: &MaterialSettings) -> Takes {
    Takes {
        law: Law::Schlick,
        widths: shown_widths,
        lacks: [
            "specular.eta specular.edge_tint specular.weight_in_index specular.on_metal transmission.roughness",
            if material.coat_on_base {
                ""
            } else {
                "coat.ior coat.color coat.anisotropy coat.on_base coat.darkening"
            },
        ],
    }
}

pub fn write(subject: &Subject, path: &Path) -> Result<Written, ExchangeError> {
    let mut model = match &subject.document {
        Some(document) => load_with(&document.model, &document.import)?,
        None => load(&ModelSource::Sphere)?,
    };
    let budget = Budget::of_import();
    let _ = budget.take((model.bytes() as u64).min(budget.left()));
    let used = model
        .meshes()
        .flat_map(|mesh| &mesh.slots)
        .copied()
        .max()
        .map_or(1, |slot| slot as usize + 1);
    let mut file = Builder::default();
    let mut reports = Vec::new();
    let mut materials = Vec::new();
    for slot in 0..used {
        // A slot beyond the last takes the last one.
        let Some(material) = subject.materials.get(slot).or(subject.materials.last()) else {
            continue;
        };
        let mut material = material.clone();
        let of_own = match model.slots.get(slot) {
            Some(_) => own::hand_over(&mut model, slot, &mut material, &budget),
            None => Vec::new(),
        };
        let material = &material;
        let (surface, mut report) = shown(material, &takes(material));
        report.entries.extend(of_own);
        let textures = file.textures(&model, slot, material);
        if textures.roughness_mean.is_some() && surface.anisotropy != 0.0 {
            let detail = "the strength is that of the roughness texture's mean";
            report
                .entries
                .insert(0, Entry::approximated("anisotropy, which varies", detail, None));
        }
        let json = material_json(material, &surface, &textures, radius_of(&model));
        if textures.is_unlit && json["extensions"][UNLIT].is_null() {
            let detail = "the format has them where a surface does nothing but shine, with 1 at most";
            report
                .entries
                .insert(0, Entry::dropped("vertex colours of the emission", detail));
        }
        materials.push(json);
        if subject.document.as_ref().is_some_and(|document| document.ground) && slot == 0 {
            report
                .entries
                .insert(0, Entry::dropped("the ground", "the file has the model alone"));
        }
        reports.push(report);
    }
    let primitives = file.primitives(&model, &materials);
    let is_binary = !has_ending(path, &["gltf"]);
    let json = file.document(&model.name, primitives, materials);
    Ok(packed(path, json, file.bytes, is_binary, reports))
}

pub fn read(path: &Path, options: ReadOptions) -> Result<Subject, ExchangeError> {
    let source = ModelSource::File(path.to_owned());
    let model = load(&source)?;
    let mut materials = materials_of(&model, options.lobe);
    let mut losses: Vec<Vec<Entry>> = materials.iter().map(|_| losses_of(&model, options.lobe)).collect();
    let written = materials_in(path);
    for ((slot, material), losses) in model.slots.iter().zip(&mut materials).zip(&mut losses) {
        let of_file = slot.file_material.and_then(|index| written.get(index));
        let exact = of_file.and_then(|raw| carried::from_json(raw["extras"][carried::MARK].clone()));
        let (Some(exact), Some(of_file), false) = (exact, of_file, options.is_plain) else {
            continue;
        };
        let mut shows = material_json(
            &exact,
            &shown(&exact, &takes(&exact)).0,
            &SlotTextures {
                is_unlit: !of_file["extensions"][UNLIT].is_null(),
                ..SlotTextures::default()
            },
            radius_of(&model),
        );
        if let (true, Some(extensions)) = (
            exact.textures[TextureTarget::Roughness],
            shows["extensions"].as_object_mut(),
        ) {
            // It depends on the texture.
            extensions.remove(ANISOTROPY);
            shows["pbrMetallicRoughness"]["roughnessFactor"] =
                of_file["pbrMetallicRoughness"]["roughnessFactor"].clone();
        }
        if is_near(&shows, of_file) {
            *material = exact;
            losses.clear();
        } else {
            losses.push(Entry::dropped(
                "the exact parameters",
                "the file was changed since it was exported",
            ));
        }
    }
    let document = Document {
        model: source,
        materials: materials.clone(),
        ..Document::default()
    };
    Ok(Subject {
        materials,
        document: Some(Box::new(document)),
        losses,
    })
}

/// What lengths inside materials are counted in: from the middle of the model to its farthest vertex.
fn radius_of(model: &Model) -> f64 {
    if model.radius > 0.0 {
        return model.radius;
    }
    let places = &model.whole_mesh().positions;
    let (low, high) = places
        .iter()
        .fold((glam::DVec3::MAX, glam::DVec3::MIN), |(low, high), place| {
            (low.min(*place), high.max(*place))
        });
    let middle = 0.5 * (low + high);
    let farthest = places.iter().map(|place| place.distance(middle)).fold(0.0, f64::max);
    if farthest > 0.0 { farthest } else { 1.0 }
}

/// What reading the model approximated or left out.
fn losses_of(model: &Model, lobe: ImportLobe) -> Vec<Entry> {
    let entry = |entry: &crate::scene::ImportNote| match entry.fate {
        Fate::Used => None,
        Fate::Approximated => Some(Entry::approximated(entry.what.clone(), "", None)),
        Fate::Ignored | Fate::Missing => Some(Entry::dropped(entry.what.clone(), "")),
    };
    import_report(model, lobe).entries.iter().filter_map(entry).collect()
}

/// The JSON of a file's materials, of which nothing else is kept; none if it can't be read.
fn materials_in(path: &Path) -> Vec<Json> {
    #[derive(Default, serde::Deserialize)]
    struct Written {
        #[serde(default)]
        materials: Vec<Json>,
    }
    let bytes = limits::read(path, u64::MAX - 1).unwrap_or_default();
    let json = match bytes.strip_prefix(b"glTF") {
        Some(rest) => {
            let length = rest
                .get(8..12)
                .and_then(|four| four.try_into().ok())
                .map_or(0, u32::from_le_bytes);
            rest.get(16..16 + length as usize).unwrap_or_default()
        }
        None => bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes),
    };
    serde_json::from_slice::<Written>(json).unwrap_or_default().materials
}

/// Whether a material of a file has the numbers of another, but for the digits that other programs write; textures and
/// extras aside.
fn is_near(wanted: &Json, found: &Json) -> bool {
    match (wanted, found) {
        (Json::Object(wanted), _) => wanted.iter().all(|(key, wanted)| {
            let is_aside = key == "extras" || key == "name" || key.ends_with("Texture");
            is_aside || is_near(wanted, &found[key])
        }),
        (Json::Array(wanted), Json::Array(found)) => {
            wanted.len() == found.len() && wanted.iter().zip(found).all(|(a, b)| is_near(a, b))
        }
        (Json::Number(wanted), Json::Number(found)) => {
            let [a, b] = [wanted, found].map(|number| number.as_f64().unwrap_or(f64::NAN));
            (a - b).abs() <= 0.0001 * (1.0 + a.abs())
        }
        _ => wanted == found,
    }
}

/// A file that grows: its numbers and images, and what refers to them.
#[derive(Default)]
struct Builder {
    bytes: Vec<u8>,
    views: Vec<Json>,
    accessors: Vec<Json>,
    images: Vec<Json>,
    samplers: Vec<Json>,
    textures: Vec<Json>,
}

impl Builder {
    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        while !self.bytes.len().is_multiple_of(4) {
            self.bytes.push(0);
        }
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend_from_slice(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    /// An accessor of vectors of floats.
    fn floats<const N: usize>(&mut self, values: &[[f32; N]], has_bounds: bool) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        let view = self.view(&bytes, Some(VERTICES));
        let mut accessor = json!({ "bufferView": view, "componentType": FLOAT, "count": values.len(), "type": kind });
        if has_bounds {
            let bound = |pick: fn(f32, f32) -> f32, start: f32| -> Vec<f32> {
                (0..N).map(|i| values.iter().map(|v| v[i]).fold(start, pick)).collect()
            };
            accessor["min"] = json!(bound(f32::min, f32::INFINITY));
            accessor["max"] = json!(bound(f32::max, f32::NEG_INFINITY));
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn indices(&mut self, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(INDICES));
        self.accessors.push(
            json!({ "bufferView": view, "componentType": UNSIGNED_INT, "count": indices.len(), "type": "SCALAR" }),
        );
        self.accessors.len() - 1
    }

    /// The textures of a slot that its material looks up.
    fn textures(&mut self, model: &Model, slot: usize, material: &MaterialSettings) -> SlotTextures {
        let Some(slot) = model.slots.get(slot) else {
            return SlotTextures::default();
        };
        // In the place of one's own texture there is none of the model's.
        let uses = material.uses_of_model();
        let has_roughness = uses[TextureTarget::Roughness];
        let has_opacity = uses[TextureTarget::Opacity];
        let mut textures = SlotTextures {
            roughness_mean: has_roughness.then(|| mean_of_roughness(model, slot)).flatten(),
            thinnest: slot.thinnest,
            alpha: Some((slot.alpha_mode, slot.alpha_cutoff)).filter(|_| has_opacity),
            is_double_sided: slot.double_sided,
            is_unlit: slot.is_unlit && slot.has_vertex_colors && uses[TextureTarget::Emission],
            ..SlotTextures::default()
        };
        for &target in TextureTarget::ALL.iter().filter(|target| target.home() == **target) {
            let is_used = uses[target] || (target == TextureTarget::BaseColor && has_opacity);
            let place = slot.texture(target).filter(|_| is_used);
            let info = |place| Some(material::texture_info(self.texture(model, &place)?, &place));
            textures.of[target as usize] = place.and_then(info);
        }
        textures
    }

    fn texture(&mut self, model: &Model, place: &crate::scene::TextureRef) -> Option<usize> {
        let picture = model.textures.get(place.texture)?;
        let name = format!("{} {}", place.texture, picture.name);
        let known = self.images.iter().position(|image| image["name"] == name.as_str());
        let image = match known {
            Some(image) => image,
            None => {
                let png = png_bytes([picture.width, picture.height], &picture.rgba8, None).ok()?;
                let view = self.view(&png, None);
                self.images
                    .push(json!({ "name": name, "bufferView": view, "mimeType": "image/png" }));
                self.images.len() - 1
            }
        };
        let [wrap_s, wrap_t] = place.wrap.map(|wrap| match wrap {
            Wrap::Repeat => 10497,
            Wrap::MirroredRepeat => 33648,
            Wrap::ClampToEdge => 33071,
        });
        let filter = if place.filter == crate::scene::Filter::Nearest {
            9728
        } else {
            9729
        };
        let sampler = placed(
            &mut self.samplers,
            json!({ "magFilter": filter, "wrapS": wrap_s, "wrapT": wrap_t }),
        );
        Some(placed(
            &mut self.textures,
            json!({ "sampler": sampler, "source": image }),
        ))
    }

    /// One primitive a slot, over shared vertices.
    fn primitives(&mut self, model: &Model, materials: &[Json]) -> Vec<Json> {
        let mut mesh = model.whole_mesh().into_owned();
        mesh.split_flat();
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.as_vec3().to_array()).collect();
        let normals: Vec<[f32; 3]> = mesh
            .normals
            .iter()
            // Of vertices that no triangle uses it may still be 0, which the format forbids.
            .map(|n| n.normalize_or(glam::Vec3::Y).to_array())
            .collect();
        let mut attributes = Map::new();
        attributes.insert("POSITION".to_owned(), self.floats(&positions, true).into());
        attributes.insert("NORMAL".to_owned(), self.floats(&normals, false).into());
        let uvs = |uvs: &[glam::Vec2]| uvs.iter().map(|uv| uv.to_array()).collect::<Vec<_>>();
        attributes.insert("TEXCOORD_0".to_owned(), self.floats(&uvs(&mesh.uvs), false).into());
        if !mesh.second_uvs.is_empty() {
            attributes.insert(
                "TEXCOORD_1".to_owned(),
                self.floats(&uvs(&mesh.second_uvs), false).into(),
            );
        }
        if !mesh.colors.is_empty() {
            attributes.insert("COLOR_0".to_owned(), self.floats(&mesh.colors, false).into());
        }
        let needs_tangents =
            |material: &Json| !material["normalTexture"].is_null() || !material["extensions"][ANISOTROPY].is_null();
        if materials.iter().any(needs_tangents) {
            let tangents: Vec<[f32; 4]> = mesh.tangents.iter().map(|t| t.to_array()).collect();
            attributes.insert("TANGENT".to_owned(), self.floats(&tangents, false).into());
        }
        let of_slot = |slot: usize| {
            let of_slot = mesh.triangles.iter().zip(&mesh.slots);
            let chosen = of_slot.filter(move |(_, of)| **of as usize == slot);
            chosen.flat_map(|(triangle, _)| *triangle).collect::<Vec<u32>>()
        };
        let mut primitives = Vec::new();
        for slot in 0..materials.len() {
            let indices = of_slot(slot);
            if !indices.is_empty() {
                primitives
                    .push(json!({ "attributes": attributes, "indices": self.indices(&indices), "material": slot }));
            }
        }
        primitives
    }

    /// The whole JSON; the buffer's name is still to be said.
    fn document(&mut self, name: &str, primitives: Vec<Json>, materials: Vec<Json>) -> Json {
        let mut document = json!({
            "asset": { "version": "2.0", "generator": concat!("Glossmith ", env!("CARGO_PKG_VERSION")) },
            "scene": 0,
            "scenes": [{ "nodes": [0] }],
            "nodes": [{ "mesh": 0, "name": name }],
            "meshes": [{ "primitives": primitives, "name": name }],
        });
        let used = extensions_used(&materials);
        let lists = [
            ("materials", materials),
            ("accessors", std::mem::take(&mut self.accessors)),
            ("bufferViews", std::mem::take(&mut self.views)),
            ("images", std::mem::take(&mut self.images)),
            ("samplers", std::mem::take(&mut self.samplers)),
            ("textures", std::mem::take(&mut self.textures)),
            ("extensionsUsed", used),
        ];
        // An empty list is against the rules of the format.
        for (key, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
            document[key] = Json::Array(list);
        }
        document["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        document
    }
}

/// The mean of the roughness that a slot's texture has.
fn mean_of_roughness(model: &Model, slot: &Slot) -> Option<f32> {
    let place = slot.texture(TextureTarget::Roughness)?;
    Some(texture_mean(model.textures.get(place.texture)?).codes[1])
}

/// The place of a value in a list, where it is added unless it is there.
fn placed(list: &mut Vec<Json>, value: Json) -> usize {
    list.iter().position(|known| *known == value).unwrap_or_else(|| {
        list.push(value);
        list.len() - 1
    })
}

/// One file, or JSON with the numbers beside it.
fn packed(
    path: &Path,
    mut json: Json,
    mut numbers: Vec<u8>,
    is_binary: bool,
    materials: Vec<super::report::MaterialReport>,
) -> Written {
    if !is_binary {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let name = format!("{stem}.bin");
        // Names are URIs there.
        json["buffers"][0]["uri"] = name.replace('%', "%25").replace(' ', "%20").replace('#', "%23").into();
        return Written {
            bytes: format!("{json:#}\n").into_bytes(),
            beside: vec![(name, numbers)],
            materials,
        };
    }
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    numbers.resize(numbers.len().next_multiple_of(4), 0);
    let length = 12 + 8 + text.len() + 8 + numbers.len();
    let mut bytes = b"glTF".to_vec();
    let word = |x: usize| (x as u32).to_le_bytes();
    bytes.extend([word(2), word(length), word(text.len())].concat());
    bytes.extend(b"JSON");
    bytes.extend(text);
    bytes.extend(word(numbers.len()));
    bytes.extend(b"BIN\0");
    bytes.extend(numbers);
    Written {
        bytes,
        beside: Vec::new(),
        materials,
    }
}
