//! Materials as slots, and their pictures.

use std::collections::HashMap;
use std::io::Cursor;

use gltf::json;
use image::ImageReader;
use json::extensions::texture::TextureTransform;
use json::material::Material;
use json::texture::WrappingMode;
use json::validation::Checked;

use super::container::Document;
use crate::scene::model::{AlphaMode, Filter, ModelError, Slot, Texture, TextureRef, Wrap};

/// The texture coordinates that a slot's pictures look up.
#[derive(Clone, Copy, Debug)]
pub(super) struct UvUse {
    /// The number of the first set, and that of the second where there is one.
    pub sets: [Option<u32>; 2],
    /// How the normal texture is placed: tangents follow it.
    pub normal_texture_from_uv: [f32; 6],
}

impl Default for UvUse {
    fn default() -> Self {
        Self {
            sets: [Some(0), None],
            normal_texture_from_uv: affine(&TextureTransform::default()),
        }
    }
}

/// The materials that primitives have asked for so far.
pub(super) struct Materials<'a> {
    document: &'a Document,
    /// Slot of a material, none for the default one.
    slot_of: HashMap<Option<usize>, u32>,
    slots: Vec<(Slot, UvUse)>,
    /// The images in use; a texture's number is its place here.
    images: Vec<usize>,
    /// What was left out.
    pub warnings: Vec<String>,
}

impl<'a> Materials<'a> {
    pub fn new(document: &'a Document) -> Self {
        Self {
            document,
            slot_of: HashMap::new(),
            slots: Vec::new(),
            images: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// The slot of a material, or of the default material.
    pub fn slot(&mut self, material: Option<usize>) -> u32 {
        if let Some(&slot) = self.slot_of.get(&material) {
            return slot;
        }
        let read = match material {
            Some(index) => self.read(index),
            None => (Slot::default(), UvUse::default()),
        };
        let slot = self.slots.len() as u32;
        self.slots.push(read);
        self.slot_of.insert(material, slot);
        slot
    }

    /// Which texture coordinates a slot's pictures use.
    pub fn uvs(&self, slot: u32) -> UvUse {
        self.slots[slot as usize].1
    }

    /// The slots with their pictures decoded; forgets the warnings.
    pub fn finish(self) -> Result<(Vec<Slot>, Vec<Texture>), ModelError> {
        let textures = self
            .images
            .iter()
            .map(|&image| decode(self.document, image))
            .collect::<Result<_, _>>()?;
        Ok((self.slots.into_iter().map(|(slot, _)| slot).collect(), textures))
    }

    /// A material and the texture coordinates of its pictures: the normal texture's are the first set, since tangents
    /// follow it; pictures on a third set are left out.
    fn read(&mut self, index: usize) -> (Slot, UvUse) {
        let root = &self.document.root;
        let material = &root.materials[index];
        let pbr = &material.pbr_metallic_roughness;
        let extensions = material.extensions.as_ref();
        let [red, green, blue, opacity] = pbr.base_color_factor.0;
        let strength = extensions
            .and_then(|e| e.emissive_strength.as_ref())
            .map_or(1.0, |e| e.emissive_strength.0);
        let volume = extensions.and_then(|e| e.volume.as_ref());
        let transmission = extensions
            .and_then(|e| e.transmission.as_ref())
            .map_or(0.0, |e| unit(e.transmission_factor.0));
        let attenuation_distance = volume
            .map(|volume| volume.attenuation_distance.0)
            .filter(|distance| distance.is_finite() && *distance > 0.0);
        if transmission > 0.0 && attenuation_distance.is_some() && [red, green, blue] != [1.0; 3] {
            self.warnings.push(format!(
                "material {index}: its volume colours what is seen through, not its base colour"
            ));
        }
        let mut sets = [None; 2];
        let info = |info: &Option<json::texture::Info>| {
            let info = info.as_ref()?;
            let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.clone());
            Some((info.index.value(), info.tex_coord, transform))
        };
        let normal = material.normal_texture.as_ref();
        let normal_texture = self.texture(
            normal.map(|normal| (normal.index.value(), normal.tex_coord, self.normal_transform(index))),
            &mut sets,
        );
        let mut uv_use = UvUse::default();
        if let Some(texture) = &normal_texture {
            uv_use.normal_texture_from_uv = texture.texture_from_mesh_uv;
        }
        let [coat, coat_roughness] = self.coat(index);
        let slot = Slot {
            name: material.name.clone().unwrap_or_else(|| format!("material {index}")),
            base_color: [red, green, blue].map(unit),
            metalness: unit(pbr.metallic_factor.0),
            roughness: unit(pbr.roughness_factor.0),
            emission: material.emissive_factor.0.map(|factor| not_negative(factor * strength)),
            opacity: unit(opacity),
            alpha_mode: alpha_mode(material),
            alpha_cutoff: material.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0),
            double_sided: material.double_sided,
            ior: extensions
                .and_then(|e| e.ior.as_ref())
                .map_or(1.5, |e| e.ior.0.clamp(1.0, 100.0)),
            transmission,
            coat,
            coat_roughness,
            attenuation_color: volume.map_or([1.0; 3], |volume| volume.attenuation_color.0.map(unit)),
            attenuation_distance: attenuation_distance.unwrap_or(f32::INFINITY),
            base_color_texture: self.texture(info(&pbr.base_color_texture), &mut sets),
            metallic_roughness_texture: self.texture(info(&pbr.metallic_roughness_texture), &mut sets),
            normal_texture,
            normal_scale: normal.map_or(1.0, |normal| normal.scale),
            emissive_texture: self.texture(info(&material.emissive_texture), &mut sets),
        };
        uv_use.sets = [sets[0].or(Some(0)), sets[1]];
        (slot, uv_use)
    }

    /// A reference to the picture of a texture, given as (texture, set of coordinates, transform).
    fn texture(
        &mut self,
        reference: Option<(usize, u32, Option<TextureTransform>)>,
        sets: &mut [Option<u32>; 2],
    ) -> Option<TextureRef> {
        let (texture, set, transform) = reference?;
        let set = transform
            .as_ref()
            .and_then(|transform| transform.tex_coord)
            .unwrap_or(set);
        let place = sets.iter().position(|known| known.is_none_or(|known| known == set));
        let Some(uv_set) = place else {
            self.warnings.push(format!(
                "a texture on TEXCOORD_{set} is left out: its material looks up two other sets already"
            ));
            return None;
        };
        sets[uv_set] = Some(set);
        let texture = &self.document.root.textures[texture];
        let image = texture.source.value();
        let place = self.images.iter().position(|&known| known == image).unwrap_or_else(|| {
            self.images.push(image);
            self.images.len() - 1
        });
        let sampler = texture
            .sampler
            .map(|sampler| &self.document.root.samplers[sampler.value()]);
        let wrap = sampler.map_or([Wrap::Repeat; 2], |sampler| {
            [wrap(sampler.wrap_s), wrap(sampler.wrap_t)]
        });
        let is_nearest = sampler.is_some_and(|sampler| {
            matches!(
                sampler.mag_filter,
                Some(Checked::Valid(json::texture::MagFilter::Nearest))
            )
        });
        Some(TextureRef {
            texture: place,
            uv_set,
            filter: if is_nearest { Filter::Nearest } else { Filter::Linear },
            texture_from_mesh_uv: affine(&transform.unwrap_or_default()),
            wrap,
        })
    }

    /// Weight and roughness of the coat (KHR_materials_clearcoat), which the crate does not know.
    fn coat(&mut self, material: usize) -> [f32; 2] {
        let coat = &self.document.raw["materials"][material]["extensions"]["KHR_materials_clearcoat"];
        let kinds = [
            "clearcoatTexture",
            "clearcoatRoughnessTexture",
            "clearcoatNormalTexture",
        ];
        if kinds.iter().any(|kind| coat.get(kind).is_some()) {
            self.warnings
                .push(format!("material {material}: the textures of its coat are left out"));
        }
        ["clearcoatFactor", "clearcoatRoughnessFactor"].map(|key| {
            coat.get(key)
                .and_then(serde_json::Value::as_f64)
                .map_or(0.0, |x| unit(x as f32))
        })
    }

    /// The crate knows no KHR_texture_transform on normal textures.
    fn normal_transform(&self, material: usize) -> Option<TextureTransform> {
        let extensions = &self.document.raw["materials"][material]["normalTexture"]["extensions"];
        serde_json::from_value(extensions.get("KHR_texture_transform")?.clone()).ok()
    }
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

fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::ClampToEdge,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::MirroredRepeat,
        _ => Wrap::Repeat,
    }
}

/// Offset · rotation · scale, as KHR_texture_transform defines them.
fn affine(transform: &TextureTransform) -> [f32; 6] {
    let (sin, cos) = transform.rotation.0.sin_cos();
    let ([scale_u, scale_v], [offset_u, offset_v]) = (transform.scale.0, transform.offset.0);
    [
        cos * scale_u,
        sin * scale_v,
        offset_u,
        -sin * scale_u,
        cos * scale_v,
        offset_v,
    ]
}

/// A picture of the file or beside it, as 8-bit RGBA.
fn decode(document: &Document, index: usize) -> Result<Texture, ModelError> {
    let image = &document.root.images[index];
    let external = image.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
    let name = image
        .name
        .clone()
        .or(external.map(str::to_owned))
        .unwrap_or_else(|| format!("image {index}"));
    let owned;
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => {
            owned = document.read_uri(&name, uri)?;
            &owned
        }
        (None, Some(view)) => document.view(view.value())?,
        (None, None) => return Err(document.invalid(format!("{name} has no data"))),
    };
    let picture = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(image::ImageError::from);
    let picture = picture
        .and_then(ImageReader::decode)
        .map_err(|error| document.resource(&name, error))?
        .into_rgba8();
    Ok(Texture {
        name,
        width: picture.width(),
        height: picture.height(),
        rgba8: picture.into_raw(),
    })
}
