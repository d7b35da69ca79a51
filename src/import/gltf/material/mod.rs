//! Conversion of materials to slots.

mod pictures;
mod sheen;
mod table;

use std::collections::HashMap;

use serde_json::Value as Json;

use self::pictures::{Made, Make, PictureKey, Reference, affine, without_missing};
pub use self::table::{GLTF_PARAMETERS, kept_keys};
use super::{
    anisotropy::{convert_widths, widths_from_gltf},
    container::Document,
    json::Primitive,
    specular_glossiness::{DIELECTRIC, Factors, convert, convert_textures},
};
use crate::{
    optics::layer::fuzz::fuzz_of_sheen,
    parallel,
    scene::{
        AlphaMode, ModelOptions, Slot, Texture, TextureRef,
        report::{Fate, ImportReport},
        texture::{TextureMean, TextureTarget, texture_mean},
    },
};

/// Largest index of refraction of a material.
const IOR_MAX: f32 = 4.0;

/// Texture coordinates used by a slot's textures.
#[derive(Clone, Copy, Debug)]
pub struct UvUse {
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
            normal_texture_from_uv: affine(&Json::Null),
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

/// Textures of which the mean is taken: where they stand, what the report says, what the mean does.
const MEANS: [(&str, &str, Apply); 2] = [
    (
        "/extensions/KHR_materials_specular/specularColorTexture",
        SPECULAR_COLOR,
        |slot, mean| slot.multiply("specular.color", mean.linear),
    ),
    (
        "/extensions/KHR_materials_anisotropy/anisotropyTexture",
        "an anisotropy texture, by its mean",
        |slot, mean| {
            let [x, y] = [0, 1].map(|i| 2.0_f32 * mean.codes[i] - 1.0);
            slot.multiply("specular.anisotropy", [mean.codes[2] * mean_strength(x.hypot(y)); 3]);
            let rotation_deg = slot.number("specular.rotation") + y.atan2(x).to_degrees();
            slot.set("specular.rotation", rotation_deg);
        },
    ),
];
const SPECULAR_COLOR: &str = "a specular colour texture, by its mean";
/// The workflow that goes before metalness and roughness.
const SPECULAR_GLOSSINESS: &str = "/extensions/KHR_materials_pbrSpecularGlossiness";

/// The materials that primitives have asked for so far.
pub struct Materials<'a> {
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
    made: Vec<Made>,
    report: ImportReport,
}

impl<'a> Materials<'a> {
    pub fn new(document: &'a Document, options: &ModelOptions) -> Self {
        let mut report = ImportReport::default();
        let wanted = options.variant.as_deref();
        let names = document.root.extensions["KHR_materials_variants"]["variants"].as_array();
        let variant = names
            .into_iter()
            .flatten()
            .position(|variant| variant["name"].as_str() == wanted);
        let variant = variant.filter(|_| wanted.is_some()).map(|index| index as u64);
        if let (Some(wanted), None) = (wanted, variant) {
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
            made: Vec::new(),
            report,
        }
    }

    /// The material of a primitive in the variant that is shown.
    pub fn of_primitive(&self, primitive: &Primitive) -> Option<usize> {
        let mappings = primitive.extensions["KHR_materials_variants"]["mappings"].as_array();
        let mut mappings = mappings.into_iter().flatten();
        let mapping = mappings.find(|mapping| {
            let mut variants = mapping["variants"].as_array().into_iter().flatten();
            variants.any(|index| self.variant.is_some() && index.as_u64() == self.variant)
        });
        let mapped = mapping.and_then(|mapping| mapping["material"].as_u64());
        mapped.map(|index| index as usize).or(primitive.material)
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
        images.extend(self.made.iter().flat_map(|made| made.images).flatten());
        images.extend(self.pictures.iter().filter_map(|key| match key {
            PictureKey::Image(image) => Some(*image),
            PictureKey::Made(..) => None,
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
        for slot in slots.iter_mut().filter(|slot| is_beyond(slot.number("specular.ior"))) {
            let what = "an index of refraction above 4, as metalness";
            self.report.note(Fate::Approximated, what, &slot.name);
            make_metal(slot);
        }
        let made = parallel::map_each(&self.made, |made| {
            (made.make)(made.images.map(|image| decoded.get(&image?)))
        });
        let textures = self.pictures.iter().map(|key| match key {
            PictureKey::Image(image) => decoded.get(image).cloned(),
            PictureKey::Made(number, part) => made[*number][*part].clone(),
        });
        let mut textures = without_missing(&mut slots, textures.collect());
        for slot in slots.iter_mut().filter(|slot| slot.number("specular.anisotropy") > 0.0) {
            if !convert_widths(slot, &mut textures) {
                let what = "a highlight stretched more than 19 : 1, taken as 19 : 1";
                self.report.note(Fate::Approximated, what, &slot.name);
            }
        }
        report.append(self.report);
        (slots, textures)
    }

    /// A material and its texture coordinates; textures on a third set are dropped.
    fn read(&mut self, index: usize, slot: usize) -> (Slot, UvUse) {
        let root = &self.document.root;
        let raw = &root.materials[index];
        let name = raw["name"].as_str().filter(|name| !name.is_empty());
        let mut read = Slot {
            name: name.map_or_else(|| format!("material {index}"), str::to_owned),
            file_material: Some(index),
            alpha_mode: match raw["alphaMode"].as_str() {
                Some("MASK") => AlphaMode::Mask,
                Some("BLEND") => AlphaMode::Blend,
                _ => AlphaMode::Opaque,
            },
            alpha_cutoff: number(&raw["alphaCutoff"]).unwrap_or(0.5),
            double_sided: raw["doubleSided"] == true,
            ..Slot::default()
        };
        let opacity = number(&raw["pbrMetallicRoughness"]["baseColorFactor"][3]);
        read.set("geometry.opacity", opacity.unwrap_or(1.0));
        let mut uvs = Uvs::default();
        // The normal texture's set of coordinates comes first, since tangents follow it, then that of the base colour.
        self.read_rows(|place| place == "/normalTexture", raw, &mut read, &mut uvs);
        let is_base = |place: &str| place.starts_with("/pbrMetallicRoughness");
        match raw.pointer(SPECULAR_GLOSSINESS) {
            Some(workflow) => self.read_specular_glossiness((index, slot), workflow, &mut read, &mut uvs),
            None => self.read_rows(is_base, raw, &mut read, &mut uvs),
        }
        let is_other = |place: &str| place != "/normalTexture" && !is_base(place);
        self.read_rows(is_other, raw, &mut read, &mut uvs);
        self.read_layers(raw, &mut read, &mut uvs);
        self.read_interior(raw, &mut read);
        for (place, what, apply) in MEANS {
            self.add_mean(slot, raw.pointer(place).and_then(Reference::of), what, apply);
        }
        if raw.pointer("/extensions/KHR_materials_unlit").is_some() {
            make_unlit(&mut read);
            self.report
                .note(Fate::Approximated, "an unlit material, which shines", &read.name);
        }
        table::report_unread(raw, &root.extensions_used, &read.name, &mut self.report);
        table::keep(raw, &mut read, &mut self.report);
        // Tangents follow the coat's texture where there is no other.
        let of_normals = [TextureTarget::Normal, TextureTarget::CoatNormal];
        let followed = of_normals.into_iter().find_map(|target| read.texture(target));
        let uv_use = UvUse {
            sets: [uvs[0].or(Some(0)), uvs[1]],
            normal_texture_from_uv: followed.map_or(affine(&Json::Null), |texture| texture.texture_from_mesh_uv),
            has_normal_texture: followed.is_some(),
        };
        (read, uv_use)
    }

    /// What the table has a parameter for, at some of its places.
    fn read_rows(&mut self, is_asked: impl Fn(&str) -> bool, raw: &Json, read: &mut Slot, uvs: &mut Uvs) {
        for row in GLTF_PARAMETERS
            .iter()
            .filter(|row| is_asked(row.place) && table::is_read(row, raw))
        {
            let [key, second] = row.keys();
            let value = raw.pointer(row.place);
            if let Some(default) = row.default_value() {
                let found = value.map(|value| numbers(value).filter(|_| value.is_array() == row.is_list()));
                if found == Some(None) {
                    let what = format!("{}, whose value is not of the kind that it has", row.place);
                    self.report.note(Fate::Ignored, what, &read.name);
                }
                let value = found.flatten().unwrap_or(default);
                read.set_color(key, value.map(|x| x * row.per.recip()));
            } else if let (Some(value), Some(target)) = (value, TextureTarget::of_key(key, "_texture")) {
                // A layer without weight looks nothing up.
                let layer = key.split('.').next();
                let mut values = read.values.iter();
                let weight = values.find(|(key, _)| key.strip_suffix(".weight") == layer);
                let is_seen = row.example.starts_with('{') && weight.is_none_or(|(_, weight)| weight[0] != 0.0);
                let Some(reference) = Reference::of(value).filter(|_| is_seen) else {
                    continue;
                };
                *read.texture_mut(target) = self.texture(&reference, uvs, &read.name);
                if target.is_normal() {
                    read.set(second, reference.scale);
                }
            }
        }
    }

    /// Textures that are made of others: of what, how, and the targets that each is for.
    fn put_made(
        &mut self,
        made: Made,
        placed: Option<TextureRef>,
        targets: &[(TextureTarget, usize)],
        read: &mut Slot,
    ) {
        for (target, part) in targets {
            self.pictures.push(PictureKey::Made(self.made.len(), *part));
            let texture = self.pictures.len() - 1;
            *read.texture_mut(*target) = placed.map(|placed| TextureRef { texture, ..placed });
        }
        self.made.push(made);
    }

    /// The old workflow of diffuse and specular colours.
    fn read_specular_glossiness(
        &mut self,
        (material, slot): (usize, usize),
        workflow: &Json,
        read: &mut Slot,
        uvs: &mut Uvs,
    ) {
        let diffuse = &workflow["diffuseFactor"];
        let color = |key: &str| numbers(&workflow[key]).unwrap_or([1.0; 3]);
        let [red, green, blue] = color("diffuseFactor");
        let opacity = number(&diffuse[3]).unwrap_or(1.0);
        let factors = Factors {
            diffuse: [red, green, blue, opacity],
            specular: color("specularFactor"),
            glossiness: number(&workflow["glossinessFactor"]).unwrap_or(1.0),
        };
        let what = "specular-glossiness, as metalness and roughness";
        self.report.note(Fate::Approximated, what, &read.name);
        let [of_diffuse, of_specular] = ["diffuseTexture", "specularGlossinessTexture"];
        if factors.specular.iter().all(|x| f64::from(*x) < DIELECTRIC) {
            // All dielectric, and of less reflectance than the other workflow's dielectrics have by themselves.
            read.set_color(
                "specular.color",
                factors.specular.map(|x| x.max(0.0) / DIELECTRIC as f32),
            );
            let texture = Reference::of(&workflow[of_specular]);
            self.add_mean(slot, texture, SPECULAR_COLOR, |slot, mean| {
                slot.multiply("specular.color", mean.linear);
            });
        }
        let textures = [of_diffuse, of_specular].map(|key| Reference::of(&workflow[key]));
        let images = textures.each_ref().map(|texture| self.image(texture.as_ref()?.texture));
        let Some(first) = textures.iter().flatten().next() else {
            let converted = convert([red, green, blue], factors.specular, factors.glossiness);
            read.set_color("base.color", converted.base_color);
            read.set("base.metalness", converted.metalness);
            read.set("specular.roughness", converted.roughness);
            read.set("geometry.opacity", opacity);
            return;
        };
        read.set("geometry.opacity", 1.0);
        let placed = self.texture(first, uvs, &read.name);
        let name = format!("material {material}");
        let make = move |[diffuse, specular]: [Option<&Texture>; 2]| {
            convert_textures(&name, factors, diffuse, specular).map(Some).into()
        };
        let targets = [(TextureTarget::BaseColor, 0), (TextureTarget::Roughness, 1)];
        self.put_made(
            Made {
                images,
                make: Box::new(make),
            },
            placed,
            &targets,
            read,
        );
    }

    /// What of the layers is no number of one parameter.
    fn read_layers(&mut self, raw: &Json, read: &mut Slot, uvs: &mut Uvs) {
        let extension = |name: &str| raw.pointer(&format!("/extensions/KHR_materials_{name}"));
        if extension("coat").is_some() {
            read.set("coat.on_base", 1.0);
            let widths = widths_from_gltf(read.number("coat.roughness"), read.number("coat.anisotropy"));
            read.set("coat.roughness", widths.roughness);
            read.set("coat.anisotropy", widths.stretch);
            if read.number("coat.weight") > 0.0 {
                let what = "a coat of the draft KHR_materials_coat, as OpenPBR has it";
                self.report.note(Fate::Approximated, what, &read.name);
            }
        }
        let thickness = read.number("thin_film.thickness");
        if let (Some(film), true) = (extension("iridescence"), thickness > 0.0) {
            let thinnest_nm = film["iridescenceThicknessMinimum"]
                .as_f64()
                .map_or(100.0, |nm| (nm as f32).min(1e9));
            read.thinnest = 0.001 * thinnest_nm.max(0.0) / thickness;
        }
        if let (Some(sheen), None) = (extension("sheen"), extension("fuzz")) {
            self.read_sheen(sheen, read, uvs);
        }
    }

    /// A sheen as fuzz of about its albedo, with textures that are turned into those of fuzz.
    fn read_sheen(&mut self, sheen: &Json, read: &mut Slot, uvs: &mut Uvs) {
        let factor = |key: &str| numbers(&sheen[key]).unwrap_or_default().map(|x| x.clamp(0.0, 1.0));
        let [root_of_alpha, ..] = factor("sheenRoughnessFactor");
        let (weight, tint, roughness) = fuzz_of_sheen(factor("sheenColorFactor"), root_of_alpha);
        read.set("fuzz.weight", weight);
        read.set_color("fuzz.color", tint);
        read.set("fuzz.roughness", roughness);
        if weight == 0.0 {
            return;
        }
        self.report
            .note(Fate::Approximated, "a sheen, as fuzz of about its albedo", &read.name);
        let mut put = |part: usize, key: &str, targets: &[(TextureTarget, usize)], make: Make| {
            let texture = Reference::of(&sheen[key])?;
            let placed = self.texture(&texture, uvs, &read.name)?;
            let mut images = [None; 2];
            images[part] = self.image(texture.texture);
            self.put_made(Made { images, make }, Some(placed), targets, read);
            Some(())
        };
        let of_color = move |[color, _]: [Option<&Texture>; 2]| match color {
            Some(color) => sheen::weight_and_color(color, tint).map(Some).into(),
            None => vec![None; 2],
        };
        let of_roughness =
            move |[_, root]: [Option<&Texture>; 2]| vec![root.map(|root| sheen::roughness(root, root_of_alpha))];
        let on_color = [(TextureTarget::Fuzz, 0), (TextureTarget::FuzzColor, 1)];
        let has_color = put(0, "sheenColorTexture", &on_color, Box::new(of_color)).is_some();
        let on_roughness = [(TextureTarget::FuzzRoughness, 0)];
        put(1, "sheenRoughnessTexture", &on_roughness, Box::new(of_roughness));
        if has_color {
            // Its tint is in the texture.
            read.set("fuzz.color", 1.0);
        }
    }

    /// Index of refraction, transmission and absorption.
    fn read_interior(&mut self, raw: &Json, read: &mut Slot) {
        let ior = read.number("specular.ior");
        if is_beyond(ior) {
            // Converted at the end, with the means of textures.
            return;
        }
        let shown = ior.max(1.0);
        if shown != ior {
            let what = format!("an index of refraction of {ior}, taken as {shown}");
            self.report.note(Fate::Approximated, what, &read.name);
            read.set("specular.ior", shown);
        }
        if read.number("transmission.weight") <= 0.0 {
            return;
        }
        let thickness = raw.pointer("/extensions/KHR_materials_volume/thicknessFactor");
        if thickness
            .and_then(Json::as_f64)
            .is_none_or(|thickness| thickness <= 0.0)
        {
            let what = if read.number("coat.weight") == 0.0 {
                "a thin wall, which mirrors as a coat on the outside and bends nothing".to_owned()
            } else {
                format!("a thin wall of index {shown} under a coat, which alone mirrors; it bends nothing")
            };
            make_thin(read);
            self.report.note(Fate::Approximated, what, &read.name);
        }
        if read.number("transmission.depth") > 0.0 && read.color("base.color") != [1.0; 3] {
            let what = "a base colour under a volume, which colours what is seen through instead";
            self.report.note(Fate::Approximated, what, &read.name);
        }
        if read.color("specular.color").iter().any(|factor| *factor > 1.0) {
            let what = "a specular colour above 1 of what transmits, taken as 1";
            self.report.note(Fate::Approximated, what, &read.name);
        }
    }

    fn add_mean(&mut self, slot: usize, texture: Option<Reference>, what: &'static str, apply: Apply) {
        if let Some(image) = texture.and_then(|texture| self.image(texture.texture)) {
            self.means.push(MeanUse {
                slot,
                image,
                what,
                apply,
            });
        }
    }
}

/// Sets of texture coordinates that a material looks up.
type Uvs = [Option<u32>; 2];

fn number(value: &Json) -> Option<f32> {
    value.as_f64().map(|x| x as f32).filter(|x| x.is_finite())
}

/// A number, or the first three of a list.
fn numbers(json: &Json) -> Option<[f32; 3]> {
    match json {
        Json::Array(list) => {
            let list: Option<Vec<f32>> = list.iter().map(number).collect();
            list?.first_chunk().copied()
        }
        json => number(json).map(|x| [x; 3]),
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

/// Whether an index of refraction is above what a material takes; 0 is infinite.
fn is_beyond(ior: f32) -> bool {
    ior == 0.0 || ior > IOR_MAX
}

/// A dielectric of so high an index, which reflects as a metal of its specular colour, as far as it is none yet.
fn make_metal(slot: &mut Slot) {
    let (ior, metalness) = (slot.number("specular.ior"), slot.number("base.metalness"));
    let reflectance = if ior == 0.0 {
        1.0
    } else {
        ((ior - 1.0) / (ior + 1.0)).powi(2)
    };
    let share = reflectance * slot.number("specular.weight");
    let specular = slot
        .color("specular.color")
        .map(|factor| (share * factor).clamp(0.0, 1.0));
    let own = slot.color("base.color");
    let converted = convert(own, specular, 0.0);
    let mix = |own: f32, other: f32| other + metalness * (own - other);
    slot.set_color("base.color", [0, 1, 2].map(|i| mix(own[i], converted.base_color[i])));
    slot.set("base.metalness", mix(1.0, converted.metalness));
    // A texture of the weight is the metal's then.
    let is_varied = slot.texture(TextureTarget::Specular).is_some();
    slot.set("specular.on_metal", f32::from(u8::from(is_varied)));
    slot.set("specular.ior", 1.5);
    slot.set("specular.weight", 1.0);
    slot.set("specular.color", 1.0);
}

/// An unlit material: it emits its colour and reflects nothing.
fn make_unlit(slot: &mut Slot) {
    slot.is_unlit = true;
    slot.set_color("emission.color", slot.color("base.color"));
    *slot.texture_mut(TextureTarget::Emission) = slot.texture(TextureTarget::BaseColor);
    for target in [TextureTarget::Roughness, TextureTarget::Normal, TextureTarget::Specular] {
        *slot.texture_mut(target) = None;
    }
    slot.set("emission.strength", 1.0);
    for key in [
        "base.color",
        "base.metalness",
        "specular.weight",
        "coat.weight",
        "transmission.weight",
    ] {
        slot.set(key, 0.0);
    }
}

/// A thin-walled material: light passes straight through without absorption. Its reflection is a coat, which does not
/// refract either; the material's own coat takes precedence.
fn make_thin(slot: &mut Slot) {
    if slot.number("coat.weight") == 0.0 {
        slot.set(
            "coat.weight",
            slot.number("specular.weight") * (1.0 - slot.number("base.metalness")),
        );
        slot.set("coat.ior", slot.number("specular.ior"));
        slot.set("coat.roughness", slot.number("specular.roughness"));
    }
    slot.set("specular.ior", 1.0);
    slot.set("transmission.depth", 0.0);
}
