//! Layers of a material that lie over its base: coat, fuzz, thin film.

use serde_json::Value as Json;

use super::pictures::PictureKey;
use super::{IOR_MAX, Materials, SheenTextures, not_negative, unit};
use crate::gltf::anisotropy::widths_from_gltf;
use crate::gltf::material_extensions::{Coat, Fuzz, Iridescence, Sheen, TextureInfo, extension};
use crate::optics::layer::fuzz::fuzz_of_sheen;
use crate::scene::report::Fate;
use crate::scene::texture::TextureTarget;
use crate::scene::{Slot, TextureRef};

impl Materials<'_> {
    pub(super) fn read_coat(&mut self, coat: &Coat, read: &mut Slot, sets: &mut [Option<u32>; 2]) {
        read.coat = unit(coat.coat_factor);
        let widths = widths_from_gltf(unit(coat.coat_roughness_factor), unit(coat.coat_anisotropy_strength));
        (read.coat_roughness, read.coat_anisotropy) = (widths.roughness, widths.stretch);
        read.coat_ior = coat.coat_ior.clamp(1.0, IOR_MAX);
        read.coat_color = coat.coat_color_factor.map(unit);
        (read.coat_on_base, read.coat_darkening) = (coat.is_on_base, unit(coat.coat_darkening_factor));
        if read.coat == 0.0 {
            return;
        }
        if coat.is_on_base {
            let what = "a coat of the draft KHR_materials_coat, as OpenPBR has it";
            self.report.note(Fate::Approximated, what, &read.name);
        }
        let normal = coat.coat_normal_texture.as_ref();
        let textures = [
            (TextureTarget::Coat, coat.coat_texture.as_ref()),
            (TextureTarget::CoatRoughness, coat.coat_roughness_texture.as_ref()),
            (TextureTarget::CoatColor, coat.coat_color_texture.as_ref()),
            (TextureTarget::CoatNormal, normal.map(|normal| &normal.info)),
        ];
        self.put_textures(&textures, read, sets);
        read.coat_normal_scale = normal.map_or(1.0, |normal| normal.scale);
    }

    fn put_textures(
        &mut self,
        textures: &[(TextureTarget, Option<&TextureInfo>)],
        read: &mut Slot,
        sets: &mut [Option<u32>; 2],
    ) {
        for (target, texture) in textures {
            *read.texture_mut(*target) = self.texture(texture.map(TextureInfo::reference), sets, &read.name);
        }
    }

    /// Fuzz; the draft takes precedence over a sheen, whose fibres are of another model.
    pub(super) fn read_fuzz(&mut self, raw: &Json, slot: usize, read: &mut Slot, sets: &mut [Option<u32>; 2]) {
        if let Some(fuzz) = extension::<Fuzz>(raw, "KHR_materials_fuzz") {
            (read.fuzz, read.fuzz_roughness) = (unit(fuzz.fuzz_factor), unit(fuzz.fuzz_roughness_factor));
            read.fuzz_color = fuzz.fuzz_color_factor.map(unit);
            let textures = [
                (TextureTarget::Fuzz, fuzz.fuzz_texture.as_ref()),
                (TextureTarget::FuzzColor, fuzz.fuzz_color_texture.as_ref()),
                (TextureTarget::FuzzRoughness, fuzz.fuzz_roughness_texture.as_ref()),
            ];
            if read.fuzz > 0.0 {
                self.put_textures(&textures, read, sets);
            }
        } else if let Some(sheen) = extension::<Sheen>(raw, "KHR_materials_sheen") {
            self.read_sheen(&sheen, slot, read, sets);
        }
    }

    /// A sheen, with textures that are turned into those of fuzz.
    fn read_sheen(&mut self, sheen: &Sheen, slot: usize, read: &mut Slot, sets: &mut [Option<u32>; 2]) {
        let root_of_alpha = unit(sheen.sheen_roughness_factor);
        (read.fuzz, read.fuzz_color, read.fuzz_roughness) =
            fuzz_of_sheen(sheen.sheen_color_factor.map(unit), root_of_alpha);
        if read.fuzz == 0.0 {
            return;
        }
        let what = "a sheen, as fuzz of about its albedo";
        self.report.note(Fate::Approximated, what, &read.name);
        let textures = [&sheen.sheen_color_texture, &sheen.sheen_roughness_texture];
        let mut converted = SheenTextures {
            slot,
            tint: read.fuzz_color,
            root_of_alpha,
            images: [None; 2],
        };
        let turned: [&[(TextureTarget, PictureKey)]; 2] = [
            &[
                (TextureTarget::Fuzz, PictureKey::FuzzWeight(slot)),
                (TextureTarget::FuzzColor, PictureKey::FuzzColor(slot)),
            ],
            &[(TextureTarget::FuzzRoughness, PictureKey::FuzzRoughness(slot))],
        ];
        for ((texture, turned), image) in textures.into_iter().zip(turned).zip(&mut converted.images) {
            let reference = texture.as_ref().map(TextureInfo::reference);
            let Some(placed) = self.texture(reference, sets, &read.name) else {
                continue;
            };
            if let PictureKey::Image(found) = self.pictures[placed.texture] {
                *image = Some(found);
            }
            for (target, key) in turned {
                self.pictures.push(*key);
                let texture = self.pictures.len() - 1;
                *read.texture_mut(*target) = Some(TextureRef { texture, ..placed });
            }
        }
        self.sheens.push(converted);
    }

    /// A thin film. Without a texture it has the largest thickness.
    pub(super) fn read_film(&mut self, film: &Iridescence, read: &mut Slot, sets: &mut [Option<u32>; 2]) {
        read.film = unit(film.iridescence_factor);
        read.film_ior = film.iridescence_ior.max(1.0);
        let thicknesses = [film.iridescence_thickness_minimum, film.iridescence_thickness_maximum];
        [read.film_thickness_min, read.film_thickness] = thicknesses.map(|nm| 1e-3 * not_negative(nm));
        if read.film > 0.0 {
            let textures = [
                (TextureTarget::Film, film.iridescence_texture.as_ref()),
                (
                    TextureTarget::FilmThickness,
                    film.iridescence_thickness_texture.as_ref(),
                ),
            ];
            self.put_textures(&textures, read, sets);
        }
    }
}
