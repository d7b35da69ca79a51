//! Wavefront OBJ files with their materials (.mtl), by the tobj crate.
//!
//! The format is Y up, like ours, with texture coordinates upwards. Its materials are of the 1990s: their exponent becomes
//! a roughness, and the additions of later exporters (`Pr`, `Pm`, `norm`, …) are taken where they are.

use std::cell::RefCell;
use std::io::BufReader;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3, Vec4};
use tobj::{LoadError, LoadOptions, Material};

use super::files::Files;
use super::mesh::Mesh;
use super::model::{AlphaMode, Filter, Model, ModelError, ModelObject, ModelOptions, Slot, Texture, TextureRef, Wrap};
use super::picture::decode_bytes;
use super::report::{Fate, ImportReport};
use super::texture::scale::scaled_to;
use crate::panics::contained;

/// Loads the contents of an OBJ file.
pub(super) fn load(path: &Path, files: &Files, bytes: &[u8], options: &ModelOptions) -> Result<Model, ModelError> {
    let report = RefCell::new(ImportReport::default());
    let load_options = LoadOptions {
        single_index: true,
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
    };
    // Some malformed faces make the crate panic.
    let loaded = contained(|| {
        tobj::load_obj_buf(&mut BufReader::new(bytes), &load_options, |library| {
            read_library(files, library, &report)
        })
    });
    let invalid = |reason: String| ModelError::Invalid {
        path: path.to_owned(),
        reason,
    };
    let (parts, materials) = loaded
        .ok_or_else(|| invalid("its faces contradict each other".to_owned()))?
        .map_err(|error: LoadError| invalid(error.to_string()))?;
    let materials = materials.unwrap_or_default();
    let mut report = report.into_inner();
    let mut slots = Slots::new(files, options, &materials);
    let mut mesh = Mesh::default();
    let mut objects: Vec<ModelObject> = Vec::new();
    for (place, part) in parts.iter().enumerate() {
        files.loading.step(format!("mesh {} of {}", place + 1, parts.len()))?;
        let slot = slots.slot(part.mesh.material_id, &mut report);
        let is_exact = slots.slots[slot as usize].normal_texture.is_some();
        let read = read_part(&part.mesh, slot, is_exact);
        if !read.colors.is_empty() {
            slots.slots[slot as usize].has_vertex_colors = true;
            report.note(Fate::Used, "vertex colours", &part.name);
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

/// The materials of a library; none where it is not there.
fn read_library(files: &Files, library: &Path, report: &RefCell<ImportReport>) -> tobj::MTLLoadResult {
    let name = library.to_string_lossy();
    match files.read(&name) {
        Ok(bytes) => tobj::load_mtl_buf(&mut BufReader::new(bytes.as_slice())).or_else(|error| {
            let mut report = report.borrow_mut();
            report.note(
                Fate::Missing,
                format!("a library of materials, grey instead ({error})"),
                &name,
            );
            Ok(Default::default())
        }),
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
fn read_part(source: &tobj::Mesh, slot: u32, is_exact: bool) -> Mesh {
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
        mesh.repair_normals();
    }
    mesh.make_tangents(IDENTITY, is_exact);
    mesh
}

/// Texture coordinates as they are.
const IDENTITY: [f32; 6] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// The materials as slots, with their pictures.
struct Slots<'a> {
    files: &'a Files,
    side_max: u32,
    materials: &'a [Material],
    /// Slot of a material; the last one of what has none.
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
            None => Slot::neutral("default"),
        };
        self.slots.push(slot);
        let index = self.slots.len() as u32 - 1;
        self.slot_of[place] = Some(index);
        index
    }

    fn read(&mut self, material: &Material, report: &mut ImportReport) -> Slot {
        report.note(Fate::Used, "materials", &material.name);
        let unit = |color: [f32; 3]| color.map(|x| x.clamp(0.0, 1.0));
        let number = |key: &str| {
            material
                .unknown_param
                .get(key)?
                .split_whitespace()
                .next()?
                .parse::<f32>()
                .ok()
        };
        let shininess = material.shininess.unwrap_or(0.0).max(0.0);
        // Blinn-Phong's exponent as the α of a microfacet distribution: Walter et al. 2007.
        let alpha = (2.0 / (shininess + 2.0)).sqrt();
        let specular = material.specular.unwrap_or([0.0; 3]);
        let opacity = material.dissolve.unwrap_or(1.0).clamp(0.0, 1.0);
        let mut slot = Slot {
            name: material.name.clone(),
            base_color: unit(material.diffuse.unwrap_or([0.6; 3])),
            metalness: number("Pm").unwrap_or(0.0).clamp(0.0, 1.0),
            roughness: number("Pr").unwrap_or(alpha.sqrt()).clamp(0.0, 1.0),
            emission: material.emissive.unwrap_or([0.0; 3]).map(|x| x.max(0.0)),
            opacity,
            alpha_mode: if opacity < 1.0 {
                AlphaMode::Blend
            } else {
                AlphaMode::Opaque
            },
            double_sided: true,
            ior: material.optical_density.filter(|ior| *ior >= 1.0).unwrap_or(1.5),
            specular: if specular.iter().any(|x| *x > 0.0) || number("Pr").is_some() {
                1.0
            } else {
                0.0
            },
            coat: number("Pc").unwrap_or(0.0).clamp(0.0, 1.0),
            coat_roughness: number("Pcr").unwrap_or(0.0).clamp(0.0, 1.0),
            ..Slot::default()
        };
        slot.base_color_texture = self.texture(material.diffuse_texture.as_deref(), true, report);
        if slot.base_color_texture.is_some() && slot.base_color == [0.0; 3] {
            // Many exporters write black beside a texture and mean white.
            slot.base_color = [1.0; 3];
        }
        if material.dissolve_texture.is_some() && material.dissolve_texture == material.diffuse_texture {
            slot.alpha_mode = AlphaMode::Blend;
        } else if material.dissolve_texture.is_some() {
            report.note(Fate::Ignored, "a texture of opacity of its own", &material.name);
        }
        let normal = material.unknown_param.get("norm").or(material.normal_texture.as_ref());
        slot.normal_texture = self.texture(normal.map(String::as_str), false, report);
        if let Some(reference) = slot.normal_texture
            && is_height(&self.textures[reference.texture])
        {
            report.note(Fate::Ignored, "a bump texture, which holds heights", &material.name);
            slot.normal_texture = None;
        }
        let emissive = material.unknown_param.get("map_Ke");
        slot.emissive_texture = self.texture(emissive.map(String::as_str), true, report);
        if slot.emissive_texture.is_some() && slot.emission == [0.0; 3] {
            slot.emission = [1.0; 3];
        }
        let others = [
            ("map_Ks", material.specular_texture.is_some()),
            ("map_Ns", material.shininess_texture.is_some()),
            ("map_Pr", material.unknown_param.contains_key("map_Pr")),
            ("map_Pm", material.unknown_param.contains_key("map_Pm")),
        ];
        for (key, _) in others.iter().filter(|(_, is_there)| *is_there) {
            report.note(Fate::Ignored, format!("a texture given by {key}"), &material.name);
        }
        report.note(
            Fate::Approximated,
            "a .mtl material, as metalness and roughness",
            &material.name,
        );
        slot
    }

    /// A picture that a line of the library names, after its options.
    fn texture(&mut self, line: Option<&str>, is_color: bool, report: &mut ImportReport) -> Option<TextureRef> {
        let line = line?.trim();
        let last = line.rsplit_once(char::is_whitespace).map_or(line, |(_, last)| last);
        // Names may have spaces; options come first and begin with a hyphen.
        let name = if line.starts_with('-') { last } else { line };
        let known = self.textures.iter().position(|texture| texture.name == name);
        let texture = known.or_else(|| {
            let decoded = self
                .files
                .read(name)
                .map_err(|error| error.to_string())
                .and_then(|bytes| decode_bytes(name.to_owned(), &bytes));
            match decoded {
                Ok(texture) => {
                    report.note(Fate::Used, "textures", name);
                    let (texture, scaled_from) = scaled_to(texture.texture(is_color), self.side_max, is_color);
                    if let Some([width, height]) = scaled_from {
                        let what = format!(
                            "a picture of {width} × {height}, used at {} × {}",
                            texture.width, texture.height
                        );
                        report.note(Fate::Approximated, what, name);
                    }
                    self.textures.push(texture);
                    Some(self.textures.len() - 1)
                }
                Err(reason) => {
                    report.note(Fate::Missing, format!("a texture ({reason})"), name);
                    None
                }
            }
        })?;
        Some(TextureRef {
            texture,
            uv_set: 0,
            texture_from_mesh_uv: IDENTITY,
            wrap: [Wrap::Repeat; 2],
            filter: Filter::Linear,
        })
    }
}

/// Whether a picture is grey all over, as heights are and normals are not.
fn is_height(texture: &Texture) -> bool {
    let grey = |texel: &[u8; 4]| texel[0].abs_diff(texel[2]) < 8 && texel[1].abs_diff(texel[2]) < 8;
    texture.rgba8.as_chunks::<4>().0.iter().all(grey)
}
