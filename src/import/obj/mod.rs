//! Wavefront OBJ files with their materials (.mtl), by the tobj crate.
//!
//! The format is Y up, like ours, with texture coordinates upwards. Its materials are of the 1990s: their exponent becomes
//! a roughness, and the additions of later exporters (`Pr`, `Pm`, `norm`, …) are taken where they are.

mod lines;
mod map;
mod table;

use std::cell::RefCell;
use std::io::BufReader;
use std::path::Path;

pub use self::table::MTL_PARAMETERS;

use self::map::Map;
use glam::{DVec3, Vec2, Vec3, Vec4};
use tobj::{LoadOptions, LoadResult, Material};

use crate::files::Files;
use crate::model_error::ModelError;
use crate::panics::contained;
use crate::picture::Encoded;
use crate::scene::mesh::Mesh;
use crate::scene::report::{Fate, ImportReport};
use crate::scene::texture::TextureTarget;
use crate::scene::{AlphaMode, Filter, Model, ModelObject, ModelOptions, Slot, Texture, TextureRef, Wrap};

/// Loads the contents of an OBJ file.
pub(super) fn load(path: &Path, files: &Files, bytes: &[u8], options: &ModelOptions) -> Result<Model, ModelError> {
    let invalid = |reason: String| ModelError::invalid(path, reason);
    let text = lines::of_model(bytes);
    let (read, mut report) = parse(&text, files);
    files.import.loading.check()?;
    let read = read.ok_or_else(|| invalid("its faces contradict each other".to_owned()))?;
    let (parts, materials) = read.map_err(|error| invalid(error.to_string()))?;
    let materials = materials.unwrap_or_default();
    let mut slots = Slots::new(files, options, &materials);
    let mut mesh = Mesh::default();
    let mut objects: Vec<ModelObject> = Vec::new();
    for (place, part) in parts.iter().enumerate() {
        files
            .import
            .loading
            .step(format!("mesh {} of {}", place + 1, parts.len()))?;
        let slot = slots.slot(part.mesh.material_id, &mut report);
        let normal_texture = slots.slots[slot as usize].texture(TextureTarget::Normal);
        let mut read = read_part(&part.mesh, slot);
        repair(&mut read, &part.name, &mut report);
        let texture_from_uv = normal_texture.map_or(IDENTITY, |texture| texture.texture_from_mesh_uv);
        read.make_tangents(texture_from_uv, normal_texture.is_some(), &files.import.loading);
        if !read.colors.is_empty() {
            slots.slots[slot as usize].color_by_vertices();
            report.note(Fate::Used, "vertex colours", &part.name);
        }
        let vertices = part.mesh.positions.len() / 3;
        for (what, numbers, width) in [
            ("texture coordinates", &part.mesh.texcoords, 2),
            ("normals", &part.mesh.normals, 3),
        ] {
            if !numbers.is_empty() && numbers.len() != width * vertices {
                report.note(Fate::Ignored, format!("{what} that only some faces have"), &part.name);
            }
        }
        let first = mesh.triangles.len();
        mesh.append(read);
        let triangles = first..mesh.triangles.len();
        match objects.last_mut() {
            // A part for each of its materials.
            Some(last) if last.name == part.name => last.triangles.end = triangles.end,
            _ => objects.push(ModelObject {
                name: part.name.clone(),
                triangles,
            }),
        }
    }
    report.count(Fate::Used, "meshes", "", parts.len());
    Ok(Model {
        mesh,
        slots: slots.slots,
        textures: slots.textures,
        objects,
        report,
        ..Model::default()
    })
}

/// Parts and materials of prepared lines, and the report on its libraries; `None` if the crate panics, as it does for some
/// malformed faces.
fn parse(text: &[u8], files: &Files) -> (Option<LoadResult>, ImportReport) {
    let report = RefCell::new(ImportReport::default());
    let options = LoadOptions {
        single_index: true,
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
    };
    let read = contained(|| {
        let mut lines = BufReader::new(files.import.loading.watched(text));
        tobj::load_obj_buf(&mut lines, &options, |library| read_library(files, library, &report))
    });
    (read, report.into_inner())
}

/// Materials of a library; empty if it is missing.
fn read_library(files: &Files, library: &Path, report: &RefCell<ImportReport>) -> tobj::MTLLoadResult {
    let name = library.to_string_lossy();
    match files.read(&name) {
        Ok(bytes) => {
            let lines = lines::of_library(&bytes, &name, &mut report.borrow_mut());
            tobj::load_mtl_buf(&mut lines.as_slice())
        }
        Err(error) => {
            let mut report = report.borrow_mut();
            report.note(
                Fate::Missing,
                format!("a library of materials, grey instead ({error})"),
                &name,
            );
            Ok(Default::default())
        }
    }
}

/// The triangles of one part.
fn read_part(source: &tobj::Mesh, slot: u32) -> Mesh {
    let positions = source.positions.as_chunks::<3>().0;
    let count = positions.len();
    let normals = source.normals.as_chunks::<3>().0;
    let uvs = source.texcoords.as_chunks::<2>().0;
    let colors = source.vertex_color.as_chunks::<3>().0;
    let in_range = |triangle: &&[u32; 3]| triangle.iter().all(|&vertex| (vertex as usize) < count);
    let triangles: Vec<[u32; 3]> = source
        .indices
        .as_chunks::<3>()
        .0
        .iter()
        .filter(in_range)
        .copied()
        .collect();
    let has_uvs = uvs.len() == count;
    let mut mesh = Mesh {
        positions: positions.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect(),
        normals: vec![Vec3::ZERO; count],
        uvs: (0..count)
            .map(|vertex| {
                if has_uvs {
                    Vec2::new(uvs[vertex][0], 1.0 - uvs[vertex][1])
                } else {
                    Vec2::ZERO
                }
            })
            .collect(),
        tangents: vec![Vec4::W; count],
        slots: vec![slot; triangles.len()],
        triangles,
        ..Mesh::default()
    };
    if colors.len() == count {
        mesh.colors = colors.iter().map(|[r, g, b]| [*r, *g, *b, 1.0]).collect();
    }
    if normals.len() == count {
        mesh.normals = normals.iter().map(|normal| Vec3::from_array(*normal)).collect();
    }
    mesh
}

/// Replaces texture coordinates and normals that are no finite numbers.
fn repair(mesh: &mut Mesh, name: &str, report: &mut ImportReport) {
    let broken = mesh.uvs.iter_mut().filter(|uv| !uv.is_finite());
    let uvs = broken.map(|uv| *uv = Vec2::ZERO).count();
    report.count(Fate::Ignored, "texture coordinates that are not finite", name, uvs);
    if mesh.normals.iter().any(|normal| *normal != Vec3::ZERO) {
        let normals = mesh.repair_normals();
        let what = "normals without a length, taken from triangles";
        report.count(Fate::Approximated, what, name, normals);
    }
}

/// Texture coordinates as they are.
const IDENTITY: [f32; 6] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// Converter of materials to slots with textures.
struct Slots<'a> {
    files: &'a Files,
    side_max: u32,
    materials: &'a [Material],
    /// Slot of each material; the last one is for faces without a material.
    slot_of: Vec<Option<u32>>,
    slots: Vec<Slot>,
    textures: Vec<Texture>,
}

impl<'a> Slots<'a> {
    fn new(files: &'a Files, options: &ModelOptions, materials: &'a [Material]) -> Self {
        Self {
            files,
            side_max: options.texture_side_max,
            materials,
            slot_of: vec![None; materials.len() + 1],
            slots: Vec::new(),
            textures: Vec::new(),
        }
    }

    fn slot(&mut self, material: Option<usize>, report: &mut ImportReport) -> u32 {
        let place = material
            .filter(|&m| m < self.materials.len())
            .unwrap_or(self.materials.len());
        if let Some(slot) = self.slot_of[place] {
            return slot;
        }
        let slot = match self.materials.get(place) {
            Some(material) => self.read(material, report),
            None => Slot::clay(),
        };
        self.slots.push(slot);
        let index = self.slots.len() as u32 - 1;
        self.slot_of[place] = Some(index);
        index
    }

    fn read(&mut self, material: &Material, report: &mut ImportReport) -> Slot {
        report.note(Fate::Used, "materials", &material.name);
        // NaN counts as 0.
        let within = |x: f32, most: f32| if x.is_nan() { 0.0 } else { x.clamp(0.0, most) };
        let unit = |x: f32| within(x, 1.0);
        let number = |key: &str| -> Option<f32> {
            let word = material.unknown_param.get(key)?.split_whitespace().next()?;
            word.parse().ok().filter(|x: &f32| x.is_finite())
        };
        let shininess = material.shininess.unwrap_or(0.0).max(0.0);
        // Blinn-Phong's exponent as the α of a microfacet distribution: Walter et al. 2007.
        let alpha = (2.0 / (shininess + 2.0)).sqrt();
        let is_matte = matches!(material.illumination_model, Some(0 | 1));
        let is_shiny = material.specular.is_some_and(|color| color.iter().any(|x| *x > 0.0)) || number("Pr").is_some();
        let opacity = material.dissolve.or_else(|| Some(1.0 - number("Tr")?));
        let opacity = opacity.map_or(1.0, unit);
        let ior = material.optical_density.filter(|ior| *ior >= 1.0);
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
            ("specular.ior", ior.unwrap_or(1.5)),
            ("specular.weight", f32::from(u8::from(is_shiny && !is_matte))),
            ("coat.weight", number("Pc").unwrap_or(0.0)),
            ("coat.roughness", number("Pcr").unwrap_or(0.0)),
            ("geometry.opacity", opacity),
        ]);
        slot.set_color("base.color", material.diffuse.unwrap_or([0.6; 3]).map(unit));
        slot.set_color(
            "emission.color",
            material.emissive.unwrap_or([0.0; 3]).map(|x| within(x, 1e6)),
        );
        self.read_color(material, &mut slot, report);
        let normal = material.unknown_param.get("norm").or(material.normal_texture.as_ref());
        let normal = normal.map(|line| Map::parse(line));
        *slot.texture_mut(TextureTarget::Normal) = self.texture(normal.as_ref(), false, report).found();
        slot.set("geometry.normal_strength", normal.map_or(1.0, |map| map.strength));
        if let Some(reference) = slot.texture(TextureTarget::Normal)
            && is_height(&self.textures[reference.texture])
        {
            report.note(Fate::Ignored, "a bump texture, which holds heights", &material.name);
            *slot.texture_mut(TextureTarget::Normal) = None;
        }
        let emissive = material.unknown_param.get("map_Ke").map(|line| Map::parse(line));
        match self.texture(emissive.as_ref(), true, report) {
            Picture::Found(texture) => {
                *slot.texture_mut(TextureTarget::Emission) = Some(texture);
                if slot.color("emission.color") == [0.0; 3] {
                    slot.set("emission.color", 1.0);
                }
            }
            Picture::Missing => slot.set("emission.color", 0.0),
            Picture::Unnamed => {}
        }
        table::report_unread(material, report);
        report.note(
            Fate::Approximated,
            "a .mtl material, as metalness and roughness",
            &material.name,
        );
        slot
    }

    /// The base colour map, and whether it has opacity.
    fn read_color(&mut self, material: &Material, slot: &mut Slot, report: &mut ImportReport) {
        let [color, opacity] =
            [&material.diffuse_texture, &material.dissolve_texture].map(|line| line.as_deref().map(Map::parse));
        let texture = self.texture(color.as_ref(), true, report);
        if texture != Picture::Unnamed && slot.color("base.color") == [0.0; 3] {
            // Many exporters write black beside a texture and mean white.
            slot.set("base.color", 1.0);
        }
        if texture == Picture::Missing {
            slot.multiply("base.color", [0.5; 3]);
        }
        *slot.texture_mut(TextureTarget::BaseColor) = texture.found();
        let Some(opacity) = opacity else { return };
        if color.is_some_and(|color| color.name == opacity.name) {
            slot.alpha_mode = AlphaMode::Blend;
        } else {
            report.note(Fate::Ignored, "a texture of opacity of its own", &material.name);
        }
    }

    /// The texture of a line of the library.
    fn texture(&mut self, map: Option<&Map<'_>>, is_color: bool, report: &mut ImportReport) -> Picture {
        let Some(map) = map else { return Picture::Unnamed };
        for option in &map.ignored {
            report.note(Fate::Ignored, format!("the option {option} of a texture"), map.name);
        }
        let known = self.textures.iter().position(|texture| texture.name == map.name);
        let Some(texture) = known.or_else(|| self.read_picture(map.name, is_color, report)) else {
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

    /// Adds a texture file to the model and returns its index.
    fn read_picture(&mut self, name: &str, is_color: bool, report: &mut ImportReport) -> Option<usize> {
        let budget = &self.files.import.budget;
        let read = self.files.read(name).map_err(|error| error.to_string());
        let scaled = read.and_then(|bytes| {
            let (name, bytes) = (name.to_owned(), bytes.into());
            let scaled = Encoded { name, bytes }.texture(is_color, self.side_max, budget)?;
            let taken = budget.take(scaled.texture.bytes() as u64);
            taken.map_err(|over| over.to_string()).map(|()| scaled)
        });
        match scaled {
            Ok(scaled) => {
                scaled.report(report);
                self.textures.push(scaled.texture);
                Some(self.textures.len() - 1)
            }
            Err(reason) => {
                report.note(Fate::Missing, format!("a texture, grey instead ({reason})"), name);
                None
            }
        }
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

/// Whether a map is grey everywhere: a height map, not a normal map.
fn is_height(texture: &Texture) -> bool {
    let grey = |texel: &[u8; 4]| texel[0].abs_diff(texel[2]) < 8 && texel[1].abs_diff(texel[2]) < 8;
    texture.rgba8.as_chunks::<4>().0.iter().all(grey)
}
