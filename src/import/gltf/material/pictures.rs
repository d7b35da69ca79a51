//! Textures of slots: images in use, their placement, and replacements of missing ones.

use std::collections::HashMap;

use gltf::json;
use json::extensions::texture::TextureTransform;
use json::texture::WrappingMode;
use json::validation::Checked;

use super::{Materials, Reference};
use crate::files::Import;
use crate::gltf::image;
use crate::parallel;
use crate::picture::{Encoded, Wanted};
use crate::scene::report::Fate;
use crate::scene::texture::TextureTarget;
use crate::scene::{Filter, Slot, Texture, TextureRef, Wrap};

/// An image used by slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum PictureKey {
    /// An image of the file.
    Image(usize),
    /// The base colour that a material of the specular-glossiness workflow is turned into.
    BaseColor(usize),
    /// Its metalness and roughness channels.
    Surface(usize),
    /// The weight of the fuzz that a slot's sheen is turned into.
    FuzzWeight(usize),
    FuzzColor(usize),
    FuzzRoughness(usize),
}

impl Materials<'_> {
    /// Decodes images up to the size limit, within the import's budget. Failures are reported.
    pub(super) fn decode(&mut self, images: Vec<usize>) -> HashMap<usize, Texture> {
        let (document, count) = (self.document, images.len());
        let Import { budget, loading, .. } = &document.files.import;
        let mut decoded = HashMap::new();
        let mut beside: Vec<(usize, Encoded<'_>)> = Vec::new();
        let mut cost = 0;
        for (place, image) in images.into_iter().enumerate() {
            if loading.step(format!("texture {} of {count}", place + 1)).is_err() {
                break;
            }
            match image::encoded(document, image) {
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
            let wanted = Wanted { is_color, side_max };
            let scaled = loading.check().map_err(|cancelled| cancelled.to_string());
            (image, scaled.and_then(|()| encoded.texture(wanted, budget)))
        };
        let results: Vec<_> = parallel::map_into(pictures, decode);
        for (image, result) in results {
            let kept = result.and_then(|scaled| {
                let taken = budget.take(scaled.texture.bytes() as u64);
                taken.map_err(|over| over.to_string()).map(|()| scaled)
            });
            match kept {
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
        }) || self.sheens.iter().any(|sheen| sheen.images[0] == Some(image))
    }

    /// Reports an unreadable image.
    fn miss(&mut self, image: usize, reason: &str) {
        let what = format!("a texture, grey instead ({reason})");
        self.report
            .note(Fate::Missing, what, &image::name(self.document, image));
    }

    /// The image of a texture.
    pub(super) fn image(&mut self, texture: usize) -> Option<usize> {
        let image = self
            .document
            .root
            .textures
            .get(texture)
            .map(|texture| texture.source.value());
        let found = image.filter(|&image| image < self.document.root.images.len());
        if found.is_none() {
            self.report.note(
                Fate::Missing,
                "a texture without an image",
                &format!("texture {texture}"),
            );
        }
        found
    }

    /// A reference to a texture's image; `None` if the texture is missing.
    pub(super) fn texture(
        &mut self,
        reference: Option<Reference>,
        sets: &mut [Option<u32>; 2],
        owner: &str,
    ) -> Option<TextureRef> {
        let (texture, set, transform) = reference?;
        let set = transform
            .as_ref()
            .and_then(|transform| transform.tex_coord)
            .unwrap_or(set);
        let place = sets.iter().position(|known| known.is_none_or(|known| known == set));
        let Some(uv_set) = place else {
            let what = format!("a texture on TEXCOORD_{set}: its material looks up two other sets already");
            self.report.note(Fate::Ignored, what, owner);
            return None;
        };
        let image = self.image(texture)?;
        sets[uv_set] = Some(set);
        let key = PictureKey::Image(image);
        let place = self.pictures.iter().position(|known| *known == key).unwrap_or_else(|| {
            self.pictures.push(key);
            self.pictures.len() - 1
        });
        let sampler = self.document.root.textures[texture].sampler;
        let sampler = sampler.and_then(|sampler| self.document.root.samplers.get(sampler.value()));
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

    /// The crate knows no KHR_texture_transform on normal textures.
    pub(super) fn normal_transform(&self, material: usize) -> Option<TextureTransform> {
        let extensions = &self.document.raw["materials"][material]["normalTexture"]["extensions"];
        serde_json::from_value(extensions.get("KHR_texture_transform")?.clone()).ok()
    }
}

/// The existing textures, with the slots' references to them; missing ones become plain grey.
pub(super) fn without_missing(slots: &mut [Slot], textures: Vec<Option<Texture>>) -> Vec<Texture> {
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
            match target {
                TextureTarget::BaseColor => slot.base_color = slot.base_color.map(|factor| 0.5 * factor),
                TextureTarget::Roughness => (slot.metalness, slot.roughness) = (0.0, 0.5 * slot.roughness),
                TextureTarget::Emission => slot.emission = [0.0; 3],
                TextureTarget::CoatRoughness => slot.coat_roughness *= 0.5,
                _ => {}
            }
        }
    }
    textures.into_iter().flatten().collect()
}

fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::ClampToEdge,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::MirroredRepeat,
        _ => Wrap::Repeat,
    }
}

/// Offset · rotation · scale, as KHR_texture_transform defines them.
pub(super) fn affine(transform: &TextureTransform) -> [f32; 6] {
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
