//! Wavefront OBJ files, by the ufbx crate, with their materials (.mtl), which are read here: a library is lines of a keyword
//! and its numbers.
//!
//! The format is Y up, like ours, with texture coordinates upwards. Its materials are of the 1990s: their exponent becomes
//! a roughness, and the additions of later exporters (`Pr`, `Pm`, `norm`, …) are taken where they are.

mod lines;
mod map;
mod table;

use std::{collections::HashMap, path::Path};

pub use self::table::MTL_PARAMETERS;

use self::{lines::Material, map::Map};
use crate::{
    fbx::{
        options_of,
        polygons::{Broken, Look, Polygons},
        progress_of, report_warnings, unread,
    },
    files::Files,
    maps::{Maps, Part, grey, holds_heights, opacity_of},
    model_error::ModelError,
    scene::{
        AlphaMode, Filter, Model, ModelObject, ModelOptions, Slot, TextureRef, Wrap,
        mesh::Mesh,
        report::{Fate, ImportReport},
        texture::TextureTarget,
    },
};

/// Loads the contents of an OBJ file.
pub fn load(path: &Path, files: &Files, bytes: &[u8], options: &ModelOptions) -> Result<Model, ModelError> {
    let loading = &files.import.loading;
    let source = lines::of_model(bytes);
    let mut report = ImportReport::default();
    let progress = progress_of(loading);
    let scene = ufbx::load_memory(
        source.text.as_bytes(),
        ufbx::LoadOpts {
            file_format: ufbx::FileFormat::Obj,
            // Objects are told apart here: for the crate each has all vertices.
            obj_merge_objects: true,
            obj_merge_groups: true,
            ..options_of(&files.import, &progress)
        },
    );
    loading.check()?;
    let scene = scene.map_err(|error| match lines::broken(&source.text) {
        Some(reason) if error.type_ == ufbx::ErrorType::Unknown => ModelError::invalid(path, reason),
        _ => unread(path, &files.import, &error),
    })?;
    report_warnings(&scene, &mut report);
    let mut slots = Slots {
        library: libraries(files, &source.libraries, &mut report),
        maps: Maps::new(files, options),
        slot_of: HashMap::new(),
        slots: Vec::new(),
    };
    let (mut mesh, mut objects) = (Mesh::default(), Vec::<ModelObject>::new());
    let mut broken = Broken::default();
    // All faces are in one mesh.
    let all = scene
        .nodes
        .as_ref()
        .iter()
        .find_map(|node| Some((node, node.mesh.as_ref()?)));
    if let Some((node, all)) = all {
        let polygons = Polygons::new(all, &source.groups, loading);
        let ends = source
            .objects
            .iter()
            .skip(1)
            .map(|(start, _)| *start)
            .chain([all.faces.len()]);
        for ((start, name), end) in source.objects.iter().zip(ends) {
            loading.step(format!("object {} of {}", objects.len() + 1, source.objects.len()))?;
            let first = mesh.triangles.len();
            for (material, faces) in by_material(*start..end, &all.face_material) {
                let name = material.and_then(|material| node.materials.as_ref().get(material as usize));
                let slot = slots.slot(name.map(|material| &*material.element.name), &mut report);
                let place = slots.slots[slot as usize].texture(TextureTarget::Normal);
                let has_colors = all.vertex_color.exists;
                let look = Look {
                    slot,
                    uvs: [Some(&all.vertex_uv), None],
                    colors: has_colors.then_some(&all.vertex_color),
                    normal_texture_from_uv: place.map(|place| place.texture_from_mesh_uv),
                };
                if has_colors {
                    slots.slots[slot as usize].color_by_vertices();
                }
                mesh.append(polygons.read(&faces, &look, &mut broken, loading));
            }
            let triangles = first..mesh.triangles.len();
            if !triangles.is_empty() {
                let name = name.clone();
                objects.push(ModelObject { name, triangles });
            }
        }
        if all.vertex_color.exists {
            report.note(Fate::Used, "vertex colours", "");
        }
    }
    if broken.faces > 0 {
        return Err(ModelError::invalid(path, "a face has a vertex that is not there"));
    }
    broken.report("", &mut report);
    if let [only] = &objects[..]
        && only.name.is_empty()
    {
        // The whole has the file's name.
        objects.clear();
    }
    for object in objects.iter_mut().filter(|object| object.name.is_empty()) {
        object.name = "unnamed".to_owned();
    }
    report.count(Fate::Used, "meshes", "", objects.len().max(1));
    Ok(Model {
        mesh,
        textures: slots.maps.finish(&mut slots.slots),
        slots: slots.slots,
        objects,
        report,
        ..Model::default()
    })
}

/// Faces of an object by their material, in its order.
fn by_material(faces: std::ops::Range<usize>, material: &[u32]) -> Vec<(Option<u32>, Vec<u32>)> {
    let mut parts: Vec<(Option<u32>, Vec<u32>)> = Vec::new();
    let mut places = HashMap::new();
    for face in faces {
        let material = material.get(face).copied();
        let place = *places.entry(material).or_insert_with(|| {
            parts.push((material, Vec::new()));
            parts.len() - 1
        });
        parts[place].1.push(face as u32);
    }
    parts
}

/// Materials of a model's libraries. A line names one, whose name may have spaces, or several.
fn libraries(files: &Files, lines: &[String], report: &mut ImportReport) -> HashMap<String, Material> {
    let mut library = HashMap::new();
    let read = |name| (name, files.read(name));
    for line in lines {
        let mut contents = vec![read(line.as_str())];
        if contents[0].1.is_err() && line.contains(char::is_whitespace) {
            contents = line.split_whitespace().map(read).collect();
        }
        for (name, contents) in contents {
            match contents {
                Ok(bytes) => library.extend(lines::of_library(&bytes).into_iter().map(|one| (one.name.clone(), one))),
                Err(error) => {
                    let what = format!("a library of materials, grey instead ({error})");
                    report.note(Fate::Missing, what, name);
                }
            }
        }
    }
    library
}

/// Slots of the materials that faces have asked for so far.
struct Slots<'a> {
    library: HashMap<String, Material>,
    maps: Maps<'a>,
    /// Slot of a material; none for faces without one.
    slot_of: HashMap<Option<String>, u32>,
    slots: Vec<Slot>,
}

impl Slots<'_> {
    fn slot(&mut self, name: Option<&str>, report: &mut ImportReport) -> u32 {
        let material = name.and_then(|name| self.library.get(name));
        let known = self.slot_of.entry(material.map(|material| material.name.clone()));
        *known.or_insert_with(|| {
            self.slots
                .push(material.map_or_else(Slot::clay, |material| read(material, &mut self.maps, report)));
            self.slots.len() as u32 - 1
        })
    }
}

fn read(material: &Material, maps: &mut Maps<'_>, report: &mut ImportReport) -> Slot {
    report.note(Fate::Used, "materials", &material.name);
    // NaN counts as 0.
    let within = |x: f32, most: f32| if x.is_nan() { 0.0 } else { x.clamp(0.0, most) };
    let number = |key: &str| material.number(key);
    let color = |key: &str, default: f32, most: f32| {
        let color = material.color(key).unwrap_or([default; 3]);
        color.map(|x| within(x, most))
    };
    let shininess = number("Ns").unwrap_or(0.0).max(0.0);
    // Blinn-Phong's exponent as the α of a microfacet distribution: Walter et al. 2007.
    let alpha = (2.0 / (shininess + 2.0)).sqrt();
    let is_matte = matches!(number("illum"), Some(0.0 | 1.0));
    let is_shiny = color("Ks", 0.0, 1.0) != [0.0; 3] || number("Pr").is_some() || material.text("map_Pr").is_some();
    let opacity = number("d").or_else(|| Some(1.0 - number("Tr")?));
    let opacity = opacity.map_or(1.0, |opacity| within(opacity, 1.0));
    let mut slot = Slot {
        name: material.name.clone(),
        alpha_mode: if opacity < 1.0 {
            AlphaMode::Blend
        } else {
            AlphaMode::Opaque
        },
        double_sided: true,
        ..Slot::default()
    }
    .with(&[
        ("base.metalness", number("Pm").unwrap_or(0.0)),
        ("specular.roughness", number("Pr").unwrap_or(alpha.sqrt())),
        ("specular.ior", number("Ni").filter(|ior| *ior >= 1.0).unwrap_or(1.5)),
        ("specular.weight", f32::from(u8::from(is_shiny && !is_matte))),
        ("coat.weight", number("Pc").unwrap_or(0.0)),
        ("coat.roughness", number("Pcr").unwrap_or(0.0)),
        ("geometry.opacity", opacity),
    ]);
    slot.set_color("base.color", color("Kd", 0.6, 1.0));
    slot.set_color("emission.color", color("Ke", 0.0, 1e6));
    let mut looks = Looks {
        material,
        maps,
        report,
        parts: Vec::new(),
    };
    looks.read_color(&mut slot);
    looks.read_roughness(&mut slot);
    looks.read_normal(&mut slot);
    match looks.texture("map_Ke", true) {
        Picture::Found(texture) => {
            *slot.texture_mut(TextureTarget::Emission) = Some(texture);
            if slot.color("emission.color") == [0.0; 3] {
                slot.set("emission.color", 1.0);
            }
        }
        Picture::Missing => slot.set("emission.color", 0.0),
        Picture::Unnamed => {}
    }
    looks.maps.put(&looks.parts, &mut slot, looks.report);
    table::report_unread(material, report);
    report.note(
        Fate::Approximated,
        "a .mtl material, as metalness and roughness",
        &material.name,
    );
    slot
}

/// Reader of a material's textures.
struct Looks<'a, 'b> {
    material: &'a Material,
    maps: &'a mut Maps<'b>,
    report: &'a mut ImportReport,
    parts: Vec<Part>,
}

/// The number that a texel stands for.
type Code = fn([u8; 4]) -> u8;

impl Looks<'_, '_> {
    fn note(&mut self, fate: Fate, what: impl Into<String>) {
        self.report.note(fate, what, &self.material.name);
    }

    /// The texture of a keyword.
    fn texture(&mut self, keyword: &str, is_color: bool) -> Picture {
        let Some(text) = self.material.text(keyword) else {
            return Picture::Unnamed;
        };
        let map = Map::parse(text);
        for option in &map.ignored {
            let what = format!("the option {option} of a texture");
            self.report.note(Fate::Ignored, what, map.name);
        }
        let Some(texture) = self.maps.image(&[map.name], None, is_color, self.report) else {
            return Picture::Missing;
        };
        Picture::Found(TextureRef {
            texture,
            uv_set: 0,
            texture_from_mesh_uv: map.texture_from_mesh_uv(),
            wrap: [if map.is_clamped {
                Wrap::ClampToEdge
            } else {
                Wrap::Repeat
            }; 2],
            filter: Filter::Linear,
        })
    }

    /// The base colour map, and whether it has opacity.
    fn read_color(&mut self, slot: &mut Slot) {
        let color = self.texture("map_Kd", true);
        if color != Picture::Unnamed && slot.color("base.color") == [0.0; 3] {
            // Many exporters write black beside a texture and mean white.
            slot.set("base.color", 1.0);
        }
        if color == Picture::Missing {
            slot.multiply("base.color", [0.5; 3]);
        }
        let own = |texel: [u8; 4]| texel[3];
        let color = color.found();
        self.parts
            .extend(color.map(|place| (TextureTarget::BaseColor, place, own as Code)));
        let name = |key: &str| self.material.text(key).map(|text| Map::parse(text).name);
        if name("map_d").is_some() && name("map_d") == name("map_Kd") {
            slot.alpha_mode = AlphaMode::Blend;
        } else if let Picture::Found(mask) = self.texture("map_d", false) {
            let code = opacity_of(self.maps.get(mask.texture));
            self.parts.push((TextureTarget::Opacity, mask, code));
        }
    }

    fn read_roughness(&mut self, slot: &mut Slot) {
        for (target, keyword, number, key) in [
            (TextureTarget::Roughness, "map_Pr", "Pr", "specular.roughness"),
            (TextureTarget::Metalness, "map_Pm", "Pm", "base.metalness"),
        ] {
            let Some(place) = self.texture(keyword, false).found() else {
                continue;
            };
            self.parts.push((target, place, grey));
            // A map without a number, or beside 0, is meant as it is.
            if self.material.number(number).is_none_or(|number| number == 0.0) {
                slot.set(key, 1.0);
            }
        }
    }

    fn read_normal(&mut self, slot: &mut Slot) {
        let keyword = if self.material.text("norm").is_some() {
            "norm"
        } else {
            "bump"
        };
        let Some(place) = self.texture(keyword, false).found() else {
            return;
        };
        if holds_heights(self.maps.get(place.texture)) {
            return self.note(Fate::Ignored, "a bump texture, which holds heights");
        }
        *slot.texture_mut(TextureTarget::Normal) = Some(place);
        let strength = self
            .material
            .text(keyword)
            .map_or(1.0, |text| Map::parse(text).strength);
        slot.set("geometry.normal_strength", strength);
    }
}

/// Result of reading a texture.
#[derive(Clone, Copy, PartialEq)]
enum Picture {
    Unnamed,
    Missing,
    Found(TextureRef),
}

impl Picture {
    fn found(self) -> Option<TextureRef> {
        match self {
            Self::Found(texture) => Some(texture),
            _ => None,
        }
    }
}
