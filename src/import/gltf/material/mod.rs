//! Conversion of materials to slots.

mod layers;
mod pictures;
mod table;

use std::collections::HashMap;

use gltf::json;
use json::extensions::texture::TextureTransform;
use json::material::Material;
use json::mesh::Primitive;
use json::validation::Checked;
use serde_json::Value as Json;

use self::pictures::{PictureKey, affine, without_missing};
pub use self::table::GLTF_PARAMETERS;
use super::anisotropy::convert_widths;
use super::container::Document;
use super::material_extensions::{
    Anisotropy, DiffuseRoughness, Iridescence, Specular, SpecularGlossiness, TextureInfo, Transmission, Volume, coat,
    extension, kept, unreadable,
};
use super::sheen;
use super::specular_glossiness::{DIELECTRIC, Factors, convert, convert_textures};
use crate::parallel;
use crate::scene::report::{Fate, ImportReport};
use crate::scene::texture::{TextureMean, TextureTarget, texture_mean};
use crate::scene::{AlphaMode, ModelOptions, Slot, Texture, TextureRef};

/// Largest index of refraction of a material.
const IOR_MAX: f32 = 4.0;

/// Texture coordinates used by a slot's textures.
#[derive(Clone, Copy, Debug)]
pub(super) struct UvUse {
    /// Indices of the first set, and of the second if used.
    pub sets: [Option<u32>; 2],
    /// Transform of the normal texture, which tangents follow.
    pub normal_texture_from_uv: [f32; 6],
    /// Whether tangents must match a normal texture.
    pub has_normal_texture: bool,
}

impl Default for UvUse {
    fn default() -> Self {
        Self {
            sets: [Some(0), None],
            normal_texture_from_uv: affine(&TextureTransform::default()),
            has_normal_texture: false,
        }
    }
}

/// A texture of which a slot uses only the mean: the image, and its effect.
struct MeanUse {
    slot: usize,
    image: usize,
    what: &'static str,
    apply: Apply,
}

/// Effect of a texture's mean on a slot.
type Apply = fn(&mut Slot, &TextureMean);

/// A use of a texture's mean, if the texture exists.
fn mean(info: &Option<TextureInfo>, what: &'static str, apply: Apply) -> Option<(usize, &'static str, Apply)> {
    Some((info.as_ref()?.index, what, apply))
}

/// A material of the specular-glossiness workflow that has textures.
struct Conversion {
    material: usize,
    factors: Factors,
    diffuse: Option<usize>,
    specular: Option<usize>,
}

/// Textures of a slot's sheen, which are turned into those of fuzz.
struct SheenTextures {
    slot: usize,
    /// What the colour's texture multiplies, at most 1.
    tint: [f32; 3],
    /// What the roughness's texture multiplies.
    root_of_alpha: f32,
    /// The images of colour and roughness.
    images: [Option<usize>; 2],
}

impl SheenTextures {
    /// The textures of the fuzz.
    fn converted(&self, decoded: &HashMap<usize, Texture>) -> Vec<(PictureKey, Texture)> {
        let [color, root] = self.images.map(|image| decoded.get(&image?));
        let mut all = Vec::new();
        if let Some(color) = color {
            let [weight, color] = sheen::weight_and_color(color, self.tint);
            all.push((PictureKey::FuzzWeight(self.slot), weight));
            all.push((PictureKey::FuzzColor(self.slot), color));
        }
        if let Some(root) = root {
            let roughness = sheen::roughness(root, self.root_of_alpha);
            all.push((PictureKey::FuzzRoughness(self.slot), roughness));
        }
        all
    }
}

/// A texture with its set of coordinates and its transform.
type Reference = (usize, u32, Option<TextureTransform>);

/// The materials that primitives have asked for so far.
pub(super) struct Materials<'a> {
    document: &'a Document,
    /// The variant that is shown (KHR_materials_variants).
    variant: Option<u64>,
    texture_side_max: u32,
    /// Slot of a material, none for the default one.
    slot_of: HashMap<Option<usize>, u32>,
    slots: Vec<(Slot, UvUse)>,
    /// Images in use; a texture's index is its position here.
    pictures: Vec<PictureKey>,
    means: Vec<MeanUse>,
    conversions: Vec<Conversion>,
    sheens: Vec<SheenTextures>,
    report: ImportReport,
}

impl<'a> Materials<'a> {
    pub fn new(document: &'a Document, options: &ModelOptions) -> Self {
        let names = &document.raw["extensions"]["KHR_materials_variants"]["variants"];
        let mut report = ImportReport::default();
        let variant = options.variant.as_ref().and_then(|wanted| {
            let names = names.as_array()?.iter();
            let found = names
                .clone()
                .position(|variant| variant["name"].as_str() == Some(wanted.as_str()));
            found.map(|index| index as u64)
        });
        if let (Some(wanted), None) = (&options.variant, variant) {
            report.note(Fate::Missing, format!("the variant \"{wanted}\""), "");
        }
        Self {
            document,
            variant,
            texture_side_max: options.texture_side_max,
            slot_of: HashMap::new(),
            slots: Vec::new(),
            pictures: Vec::new(),
            means: Vec::new(),
            conversions: Vec::new(),
            sheens: Vec::new(),
            report,
        }
    }

    /// The material of a primitive in the variant that is shown.
    pub fn of_primitive(&self, primitive: &Primitive, raw: &Json) -> Option<usize> {
        let mappings = raw["extensions"]["KHR_materials_variants"]["mappings"].as_array();
        let mapped = self.variant.zip(mappings).and_then(|(variant, mappings)| {
            let has_variant = |mapping: &&Json| {
                let variants = mapping["variants"].as_array();
                variants.is_some_and(|variants| variants.iter().any(|index| index.as_u64() == Some(variant)))
            };
            mappings.iter().find(has_variant)?["material"].as_u64()
        });
        let material = mapped.map(|index| index as usize);
        material.or(primitive.material.map(|material| material.value()))
    }

    /// The slot of a material, or of the default material.
    pub fn slot(&mut self, material: Option<usize>) -> u32 {
        let material = material.filter(|&index| {
            let is_there = index < self.document.root.materials.len();
            if !is_there {
                let what = "a material that is out of bounds";
                self.report.note(Fate::Missing, what, &format!("material {index}"));
            }
            is_there
        });
        if let Some(&slot) = self.slot_of.get(&material) {
            return slot;
        }
        let slot = self.slots.len();
        self.slots.push((Slot::clay(), UvUse::default()));
        if let Some(index) = material {
            self.slots[slot] = self.read(index, slot);
            self.report.note(Fate::Used, "materials", &self.slots[slot].0.name);
        } else {
            self.report.note(Fate::Used, "surfaces without a material, as clay", "");
        }
        self.slot_of.insert(material, slot as u32);
        slot as u32
    }

    /// Texture coordinates used by a slot.
    pub fn uvs(&self, slot: u32) -> UvUse {
        self.slots[slot as usize].1
    }

    /// Whether the material of a slot is seen from its front alone, as the file has it.
    pub fn is_one_sided(&self, slot: u32) -> bool {
        let is_default = self.slot_of.get(&None) == Some(&slot);
        !is_default && !self.slots[slot as usize].0.double_sided
    }

    /// Says that a mesh with this slot has colours at its vertices, with an alpha below 1 or without.
    pub fn has_vertex_colors(&mut self, slot: u32, has_alpha: bool) {
        let slot = &mut self.slots[slot as usize].0;
        slot.color_by_vertices();
        slot.has_vertex_alpha |= has_alpha;
    }

    /// The slots with decoded textures; missing ones become grey.
    pub fn finish(mut self, report: &mut ImportReport) -> (Vec<Slot>, Vec<Texture>) {
        let mut images: Vec<usize> = self.means.iter().map(|mean| mean.image).collect();
        images.extend(
            self.conversions
                .iter()
                .flat_map(|conversion| [conversion.diffuse, conversion.specular])
                .flatten(),
        );
        images.extend(self.pictures.iter().filter_map(|key| match key {
            PictureKey::Image(image) => Some(*image),
            _ => None,
        }));
        images.sort_unstable();
        images.dedup();
        let decoded: HashMap<usize, Texture> = self.decode(images);
        let mut slots: Vec<Slot> = self.slots.into_iter().map(|(slot, _)| slot).collect();
        for mean in &self.means {
            if let Some(texture) = decoded.get(&mean.image) {
                (mean.apply)(&mut slots[mean.slot], &texture_mean(texture));
                self.report.note(Fate::Approximated, mean.what, &slots[mean.slot].name);
            }
        }
        let converted: HashMap<usize, [Texture; 2]> = parallel::map_each(&self.conversions, |conversion| {
            let image = |image: Option<usize>| decoded.get(&image?);
            let name = format!("material {}", conversion.material);
            let [diffuse, specular] = [conversion.diffuse, conversion.specular].map(image);
            (
                conversion.material,
                convert_textures(&name, conversion.factors, diffuse, specular),
            )
        })
        .into_iter()
        .collect();
        let of_sheens = parallel::map_each(&self.sheens, |sheen| sheen.converted(&decoded));
        let of_sheens: HashMap<PictureKey, Texture> = of_sheens.into_iter().flatten().collect();
        for sheen in &self.sheens {
            if of_sheens.contains_key(&PictureKey::FuzzColor(sheen.slot)) {
                // Its tint is in the texture.
                slots[sheen.slot].fuzz_color = [1.0; 3];
            }
        }
        let textures = self.pictures.iter().map(|key| match key {
            PictureKey::Image(image) => decoded.get(image).cloned(),
            PictureKey::BaseColor(material) => converted.get(material).map(|[color, _]| color.clone()),
            PictureKey::Surface(material) => converted.get(material).map(|[_, surface]| surface.clone()),
            of_sheen => of_sheens.get(of_sheen).cloned(),
        });
        let mut textures = without_missing(&mut slots, textures.collect());
        for slot in slots.iter_mut().filter(|slot| slot.anisotropy > 0.0) {
            if !convert_widths(slot, &mut textures) {
                let what = "a highlight stretched more than 19 : 1, taken as 19 : 1";
                self.report.note(Fate::Approximated, what, &slot.name);
            }
        }
        report.append(self.report);
        (slots, textures)
    }

    /// A material and its texture coordinates. The normal texture's set comes first, since tangents follow it; textures on a
    /// third set are dropped.
    fn read(&mut self, index: usize, slot: usize) -> (Slot, UvUse) {
        let root = &self.document.root;
        let material = &root.materials[index];
        let raw = &self.document.raw["materials"][index];
        let pbr = &material.pbr_metallic_roughness;
        let [red, green, blue, opacity] = pbr.base_color_factor.0;
        let extensions = material.extensions.as_ref();
        let strength = extensions
            .and_then(|e| e.emissive_strength.as_ref())
            .map_or(1.0, |e| e.emissive_strength.0);
        let name = material.name.clone().filter(|name| !name.is_empty());
        let mut read = Slot {
            name: name.unwrap_or_else(|| format!("material {index}")),
            file_material: Some(index),
            base_color: [red, green, blue].map(unit),
            metalness: unit(pbr.metallic_factor.0),
            roughness: unit(pbr.roughness_factor.0),
            emission: material.emissive_factor.0.map(|factor| not_negative(factor * strength)),
            opacity: unit(opacity),
            alpha_mode: alpha_mode(material),
            alpha_cutoff: material.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0),
            double_sided: material.double_sided,
            ..Slot::default()
        };
        let mut sets = [None; 2];
        let info = |info: &Option<json::texture::Info>| {
            let info = info.as_ref()?;
            let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.clone());
            Some((info.index.value(), info.tex_coord, transform))
        };
        let mut uv_use = UvUse::default();
        if let Some(normal) = &material.normal_texture {
            let reference = (normal.index.value(), normal.tex_coord, self.normal_transform(index));
            *read.texture_mut(TextureTarget::Normal) = self.texture(Some(reference), &mut sets, &read.name);
            read.normal_scale = normal.scale;
            if let Some(texture) = read.texture(TextureTarget::Normal) {
                uv_use.normal_texture_from_uv = texture.texture_from_mesh_uv;
                uv_use.has_normal_texture = true;
            }
        }
        match extension::<SpecularGlossiness>(raw, "KHR_materials_pbrSpecularGlossiness") {
            Some(workflow) => self.read_specular_glossiness((index, slot), &workflow, &mut read, &mut sets),
            None => {
                *read.texture_mut(TextureTarget::BaseColor) =
                    self.texture(info(&pbr.base_color_texture), &mut sets, &read.name);
                *read.texture_mut(TextureTarget::Roughness) =
                    self.texture(info(&pbr.metallic_roughness_texture), &mut sets, &read.name);
            }
        }
        *read.texture_mut(TextureTarget::Emission) =
            self.texture(info(&material.emissive_texture), &mut sets, &read.name);
        self.read_layers(raw, slot, &mut read, &mut sets);
        self.read_interior(material, raw, slot, &mut read);
        if let Some(base) = extension::<DiffuseRoughness>(raw, "KHR_materials_diffuse_roughness") {
            read.diffuse_roughness = unit(base.diffuse_roughness_factor);
        }
        if raw["extensions"].get("KHR_materials_unlit").is_some() {
            make_unlit(&mut read);
            self.report
                .note(Fate::Approximated, "an unlit material, which shines", &read.name);
        }
        table::report_unread(raw, &root.extensions_used, &read.name, &mut self.report);
        for extension in unreadable(raw) {
            let what = format!("{extension}, whose values are not of the kinds that it has");
            self.report.note(Fate::Ignored, what, &read.name);
        }
        let (kept, names) = kept(raw);
        for what in names {
            self.report
                .note(Fate::Ignored, format!("{what}, kept in the material"), &read.name);
        }
        read.kept = kept;
        if let (Some(texture), false) = (read.texture(TextureTarget::CoatNormal), uv_use.has_normal_texture) {
            // Tangents follow the coat's texture where there is no other.
            uv_use.normal_texture_from_uv = texture.texture_from_mesh_uv;
            uv_use.has_normal_texture = true;
        }
        uv_use.sets = [sets[0].or(Some(0)), sets[1]];
        (read, uv_use)
    }

    /// The old workflow of diffuse and specular colours.
    fn read_specular_glossiness(
        &mut self,
        (material, slot): (usize, usize),
        workflow: &SpecularGlossiness,
        read: &mut Slot,
        sets: &mut [Option<u32>; 2],
    ) {
        let factors = Factors {
            diffuse: workflow.diffuse_factor,
            specular: workflow.specular_factor,
            glossiness: workflow.glossiness_factor,
        };
        self.report.note(
            Fate::Approximated,
            "specular-glossiness, as metalness and roughness",
            &read.name,
        );
        let [red, green, blue, opacity] = factors.diffuse;
        read.opacity = unit(opacity);
        if factors.specular.iter().all(|x| f64::from(*x) < DIELECTRIC) {
            // All dielectric, and of less reflectance than the other workflow's dielectrics have by themselves.
            read.specular_color = factors.specular.map(|x| x.max(0.0) / DIELECTRIC as f32);
            let what = "a specular colour texture, by its mean";
            let applied = mean(&workflow.specular_glossiness_texture, what, |slot, mean| {
                slot.specular_color = [0, 1, 2].map(|i| slot.specular_color[i] * mean.linear[i]);
            });
            self.add_means(slot, applied.into_iter().collect());
        }
        let textures = [&workflow.diffuse_texture, &workflow.specular_glossiness_texture];
        let images = textures.map(|info| self.image(info.as_ref()?.index));
        let Some(placed) = textures.into_iter().flatten().next() else {
            let converted = convert([red, green, blue], factors.specular, factors.glossiness);
            read.base_color = converted.base_color;
            (read.metalness, read.roughness) = (converted.metalness, converted.roughness);
            return;
        };
        (read.base_color, read.metalness, read.roughness, read.opacity) = ([1.0; 3], 1.0, 1.0, 1.0);
        let placed = self.texture(Some(placed.reference()), sets, &read.name);
        let place = |key: PictureKey, pictures: &mut Vec<PictureKey>| {
            pictures.push(key);
            placed.map(|placed| TextureRef {
                texture: pictures.len() - 1,
                ..placed
            })
        };
        *read.texture_mut(TextureTarget::BaseColor) = place(PictureKey::BaseColor(material), &mut self.pictures);
        *read.texture_mut(TextureTarget::Roughness) = place(PictureKey::Surface(material), &mut self.pictures);
        self.conversions.push(Conversion {
            material,
            factors,
            diffuse: images[0],
            specular: images[1],
        });
    }

    /// Specular reflection, coat and anisotropy.
    fn read_layers(&mut self, raw: &Json, slot: usize, read: &mut Slot, sets: &mut [Option<u32>; 2]) {
        let mut means = Vec::new();
        if let Some(specular) = extension::<Specular>(raw, "KHR_materials_specular") {
            read.specular = unit(specular.specular_factor);
            read.specular_color = specular.specular_color_factor.map(not_negative);
            means.extend(mean(
                &specular.specular_texture,
                "a specular texture, by its mean",
                |slot, mean| {
                    slot.specular *= mean.codes[3];
                },
            ));
            means.extend(mean(
                &specular.specular_color_texture,
                "a specular colour texture, by its mean",
                |slot, mean| {
                    slot.specular_color = [0, 1, 2].map(|i| slot.specular_color[i] * mean.linear[i]);
                },
            ));
        }
        if let Some(coat) = coat(raw) {
            self.read_coat(&coat, read, sets);
        }
        if let Some(film) = extension::<Iridescence>(raw, "KHR_materials_iridescence") {
            self.read_film(&film, read, sets);
        }
        self.read_fuzz(raw, slot, read, sets);
        if let Some(anisotropy) = extension::<Anisotropy>(raw, "KHR_materials_anisotropy") {
            read.anisotropy = unit(anisotropy.anisotropy_strength);
            read.anisotropy_rotation_rad = anisotropy.anisotropy_rotation;
            means.extend(mean(
                &anisotropy.anisotropy_texture,
                "an anisotropy texture, by its mean",
                |slot, mean| {
                    let [x, y] = [0, 1].map(|i| 2.0_f32 * mean.codes[i] - 1.0);
                    slot.anisotropy *= mean.codes[2] * mean_strength(x.hypot(y));
                    slot.anisotropy_rotation_rad += y.atan2(x);
                },
            ));
        }
        self.add_means(slot, means);
    }

    /// Index of refraction, transmission and absorption.
    fn read_interior(&mut self, material: &Material, raw: &Json, slot: usize, read: &mut Slot) {
        let extensions = material.extensions.as_ref();
        let ior = extensions.and_then(|e| e.ior.as_ref()).map_or(1.5, |e| e.ior.0);
        // 0 means a mirror.
        let ior = if ior == 0.0 { f32::INFINITY } else { ior };
        read.ior = ior.clamp(1.0, IOR_MAX);
        if read.ior != ior {
            let what = format!("an index of refraction of {ior}, taken as {}", read.ior);
            self.report.note(Fate::Approximated, what, &read.name);
        }
        let transmission = extensions.and_then(|e| e.transmission.as_ref());
        read.transmission = transmission.map_or(0.0, |e| unit(e.transmission_factor.0));
        let volume = extensions.and_then(|e| e.volume.as_ref());
        if let Some(volume) = volume {
            read.attenuation_color = volume.attenuation_color.0.map(unit);
            let distance = volume.attenuation_distance.0;
            if distance.is_finite() && distance > 0.0 {
                read.attenuation_distance = distance;
            }
        }
        if read.transmission == 0.0 {
            return;
        }
        let thickness = extension::<Volume>(raw, "KHR_materials_volume").map_or(0.0, |volume| volume.thickness_factor);
        if thickness <= 0.0 {
            let what = if read.coat == 0.0 {
                "a thin wall, which mirrors as a coat on the outside and bends nothing".to_owned()
            } else {
                format!(
                    "a thin wall of index {} under a coat, which alone mirrors; it bends nothing",
                    read.ior
                )
            };
            make_thin(read);
            self.report.note(Fate::Approximated, what, &read.name);
        }
        let [red, green, blue] = read.base_color;
        if read.attenuation_distance.is_finite() && [red, green, blue] != [1.0; 3] {
            let what = "a base colour under a volume, which colours what is seen through instead";
            self.report.note(Fate::Approximated, what, &read.name);
        }
        if read.specular_color.iter().any(|factor| *factor > 1.0) {
            let what = "a specular colour above 1 of what transmits, taken as 1";
            self.report.note(Fate::Approximated, what, &read.name);
        }
        let transmission = extension::<Transmission>(raw, "KHR_materials_transmission").unwrap_or_default();
        let what = "a transmission texture, by its mean";
        let applied = mean(&transmission.transmission_texture, what, |slot, mean| {
            slot.transmission *= mean.codes[0];
        });
        self.add_means(slot, applied.into_iter().collect());
    }

    fn add_means(&mut self, slot: usize, means: Vec<(usize, &'static str, Apply)>) {
        for (texture, what, apply) in means {
            if let Some(image) = self.image(texture) {
                self.means.push(MeanUse {
                    slot,
                    image,
                    what,
                    apply,
                });
            }
        }
    }
}

/// Strength for the mean of directions with this length: an isotropic mean has none. Below an 8-bit step, and within one of
/// 1, it is rounding.
fn mean_strength(length: f32) -> f32 {
    const STEP: f32 = 2.0 / 255.0;
    match length {
        none if none < STEP => 0.0,
        whole if whole > 1.0 - STEP => 1.0,
        part => part,
    }
}

/// An unlit material: it emits its colour and reflects nothing.
fn make_unlit(slot: &mut Slot) {
    slot.is_unlit = true;
    slot.emission = slot.base_color;
    *slot.texture_mut(TextureTarget::Emission) = slot.texture(TextureTarget::BaseColor);
    slot.base_color = [0.0; 3];
    (slot.metalness, slot.specular) = (0.0, 0.0);
    *slot.texture_mut(TextureTarget::Roughness) = None;
    *slot.texture_mut(TextureTarget::Normal) = None;
    (slot.coat, slot.transmission) = (0.0, 0.0);
}

/// A thin-walled material: light passes straight through without absorption. Its reflection is a coat, which does not
/// refract either; the material's own coat takes precedence.
fn make_thin(slot: &mut Slot) {
    if slot.coat == 0.0 {
        slot.coat = slot.specular * (1.0 - slot.metalness);
        (slot.coat_ior, slot.coat_roughness) = (slot.ior, slot.roughness);
    }
    slot.ior = 1.0;
    slot.attenuation_distance = f32::INFINITY;
}

fn unit(value: f32) -> f32 {
    value.clamp(0.0, 1.0)
}

fn not_negative(value: f32) -> f32 {
    if value.is_finite() { value.max(0.0) } else { 0.0 }
}

fn alpha_mode(material: &Material) -> AlphaMode {
    match material.alpha_mode {
        Checked::Valid(json::material::AlphaMode::Mask) => AlphaMode::Mask,
        Checked::Valid(json::material::AlphaMode::Blend) => AlphaMode::Blend,
        _ => AlphaMode::Opaque,
    }
}
