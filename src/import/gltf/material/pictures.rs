//! Textures of slots: images in use, their placement, and replacements of missing ones.

use std::{borrow::Cow, collections::HashMap};

use serde_json::Value as Json;

use super::{Materials, Uvs, number};
use crate::{
    files::Import,
    gltf::container::Document,
    parallel,
    picture::Encoded,
    scene::{Filter, Slot, Texture, TextureRef, Wrap, report::Fate, texture::TextureTarget},
};

/// An image used by slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureKey {
    /// An image of the file.
    Image(usize),
    /// The number of what is [`Made`], and the part of it.
    Made(usize, usize),
}

/// Makes textures of others, as far as these are there.
pub type Make = Box<dyn Fn([Option<&Texture>; 2]) -> Vec<Option<Texture>> + Sync>;

/// Textures that are made of images, the first of them a colour.
pub struct Made {
    pub images: [Option<usize>; 2],
    pub make: Make,
}

/// A material's reference to a texture.
pub struct Reference {
    pub texture: usize,
    set: u32,
    texture_from_mesh_uv: [f32; 6],
    /// Of a texture of normals.
    pub scale: f32,
}

impl Reference {
    pub fn of(info: &Json) -> Option<Self> {
        let transform = &info["extensions"]["KHR_texture_transform"];
        let set = transform["texCoord"].as_u64().or(info["texCoord"].as_u64());
        Some(Self {
            texture: info["index"].as_u64()? as usize,
            set: set.unwrap_or(0) as u32,
            texture_from_mesh_uv: affine(transform),
            scale: number(&info["scale"]).unwrap_or(1.0),
        })
    }
}

impl Materials<'_> {
    /// Decodes images up to the size limit, within the import's budget. Failures are reported.
    pub fn decode(&mut self, images: Vec<usize>) -> HashMap<usize, Texture> {
        let (document, count) = (self.document, images.len());
        let Import { budget, loading, .. } = &document.files.import;
        let mut decoded = HashMap::new();
        let mut beside: Vec<(usize, Encoded<'_>)> = Vec::new();
        let mut cost = 0;
        for (place, image) in images.into_iter().enumerate() {
            if loading.step(format!("texture {} of {count}", place + 1)).is_err() {
                break;
            }
            match encoded(document, image) {
                Ok(encoded) => {
                    let of_this = encoded.cost();
                    if cost + of_this > budget.left() {
                        self.decode_beside(std::mem::take(&mut beside), &mut decoded);
                        cost = 0;
                    }
                    cost += of_this;
                    beside.push((image, encoded));
                }
                Err(reason) => self.miss(image, &reason),
            }
        }
        self.decode_beside(beside, &mut decoded);
        decoded
    }

    /// Decodes images in parallel, as many as fit into the budget together.
    fn decode_beside(&mut self, pictures: Vec<(usize, Encoded<'_>)>, decoded: &mut HashMap<usize, Texture>) {
        let Import { budget, loading, .. } = &self.document.files.import;
        let side_max = self.texture_side_max;
        let decode = |(image, encoded): (usize, Encoded<'_>)| {
            let is_color = self.is_color(image);
            let scaled = loading.check().map_err(|cancelled| cancelled.to_string());
            (image, scaled.and_then(|()| encoded.texture(is_color, side_max, budget)))
        };
        let results: Vec<_> = parallel::map_into(pictures, decode);
        for (image, result) in results {
            match result.and_then(|scaled| scaled.within(budget)) {
                Ok(scaled) => {
                    scaled.report(&mut self.report);
                    decoded.insert(image, scaled.texture);
                }
                Err(reason) => self.miss(image, &reason),
            }
        }
    }

    /// Whether a slot looks an image up for colours.
    fn is_color(&self, image: usize) -> bool {
        let is_it = |place: &TextureRef| self.pictures[place.texture] == PictureKey::Image(image);
        let mut slots = self.slots.iter();
        let of_colors = || TextureTarget::ALL.iter().filter(|target| target.is_color());
        slots.any(|(slot, _)| {
            of_colors()
                .filter_map(|target| slot.texture(*target))
                .any(|place| is_it(&place))
        }) || self.made.iter().any(|made| made.images[0] == Some(image))
    }

    /// Reports an unreadable image.
    fn miss(&mut self, image: usize, reason: &str) {
        let what = format!("a texture, grey instead ({reason})");
        self.report.note(Fate::Missing, what, &image_name(self.document, image));
    }

    /// The image of a texture.
    pub fn image(&mut self, texture: usize) -> Option<usize> {
        let found = self.document.root.textures.get(texture);
        let found = found.and_then(|texture| self.document.image_of(texture));
        if found.is_none() {
            let name = format!("texture {texture}");
            self.report.note(Fate::Missing, "a texture without an image", &name);
        }
        found
    }

    /// A reference to a texture's image; `None` if the texture is missing.
    pub fn texture(&mut self, reference: &Reference, uvs: &mut Uvs, owner: &str) -> Option<TextureRef> {
        let set = reference.set;
        let Some(uv_set) = uvs.iter().position(|known| known.is_none_or(|known| known == set)) else {
            let what = format!("a texture on TEXCOORD_{set}: its material looks up two other sets already");
            self.report.note(Fate::Ignored, what, owner);
            return None;
        };
        let key = PictureKey::Image(self.image(reference.texture)?);
        uvs[uv_set] = Some(set);
        let place = self.pictures.iter().position(|known| *known == key).unwrap_or_else(|| {
            self.pictures.push(key);
            self.pictures.len() - 1
        });
        let root = &self.document.root;
        let sampler = root.textures[reference.texture]
            .sampler
            .and_then(|sampler| root.samplers.get(sampler));
        let is_nearest = sampler.is_some_and(|sampler| sampler.mag_filter == NEAREST);
        Some(TextureRef {
            texture: place,
            uv_set,
            filter: if is_nearest { Filter::Nearest } else { Filter::Linear },
            texture_from_mesh_uv: reference.texture_from_mesh_uv,
            wrap: sampler.map_or([Wrap::Repeat; 2], |sampler| [sampler.wrap_s, sampler.wrap_t].map(wrap)),
        })
    }
}

/// The format's number of filtering by the nearest texel.
const NEAREST: u32 = 9728;

/// Name of an image: its name, its file or its index.
fn image_name(document: &Document, index: usize) -> String {
    let image = document.root.images.get(index);
    let name = image.and_then(|image| image.name.as_deref().filter(|name| !name.is_empty()));
    let file = || image?.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
    name.or_else(file)
        .map_or_else(|| format!("image {index}"), str::to_owned)
}

/// An encoded image.
fn encoded(document: &Document, index: usize) -> Result<Encoded<'_>, String> {
    let image = document.root.images.get(index).ok_or("it is out of bounds")?;
    let name = image_name(document, index);
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => Cow::Owned(document.read_uri(uri)?),
        (None, Some(view)) => document.view(view)?,
        (None, None) => return Err("it has no data".to_owned()),
    };
    Ok(Encoded { name, bytes })
}

/// The existing textures, with the slots' references to them; missing ones become plain grey.
pub fn without_missing(slots: &mut [Slot], textures: Vec<Option<Texture>>) -> Vec<Texture> {
    let mut place = 0;
    let places: Vec<Option<usize>> = textures
        .iter()
        .map(|texture| {
            texture.as_ref().map(|_| {
                place += 1;
                place - 1
            })
        })
        .collect();
    let keep = |reference: &mut Option<TextureRef>| {
        let Some(texture) = reference.as_mut() else { return true };
        match places[texture.texture] {
            Some(place) => texture.texture = place,
            None => *reference = None,
        }
        reference.is_some()
    };
    for slot in slots {
        for &target in TextureTarget::ALL.iter().filter(|target| target.home() == **target) {
            if keep(slot.texture_mut(target)) {
                continue;
            }
            // Dark, where it shone.
            let by = if target == TextureTarget::Emission { 0.0 } else { 0.5 };
            slot.multiply(target.map_key().trim_end_matches("_map"), [by; 3]);
            if target == TextureTarget::Roughness {
                slot.set("base.metalness", 0.0);
            }
        }
    }
    textures.into_iter().flatten().collect()
}

/// By the format's number.
fn wrap(mode: u32) -> Wrap {
    match mode {
        33071 => Wrap::ClampToEdge,
        33648 => Wrap::MirroredRepeat,
        _ => Wrap::Repeat,
    }
}

/// Offset · rotation · scale, as KHR_texture_transform defines them.
pub fn affine(transform: &Json) -> [f32; 6] {
    let pair = |key: &str, default: f32| [0, 1].map(|i| number(&transform[key][i]).unwrap_or(default));
    let (sin, cos) = number(&transform["rotation"]).unwrap_or(0.0).sin_cos();
    let ([scale_u, scale_v], [offset_u, offset_v]) = (pair("scale", 1.0), pair("offset", 0.0));
    [
        cos * scale_u,
        sin * scale_v,
        offset_u,
        -sin * scale_u,
        cos * scale_v,
        offset_v,
    ]
}
