//! Materials of FBX files as slots, by the maps that the ufbx crate makes of each program's own: Arnold, Stingray, 3ds Max's physical
//! material, OpenPBR, glTF's in 3ds Max, Blender's, and the format's Lambert and Phong.

use std::collections::HashSet;

use glam::DVec3;
use ufbx::{MaterialMap, ShaderType, TextureType, Vec4, WrapMode};

use crate::{
    file_parameter::{FileParameter, Goes},
    maps::{Maps, Part, grey, holds_heights, opacity_of},
    scene::{
        AlphaMode, Filter, Slot, TextureRef, Wrap,
        report::{Fate, ImportReport},
        texture::{TextureTarget, texture_mean},
    },
};

use Goes::Nowhere;

/// Reads a map of a material.
type Reader = fn(&ufbx::Material) -> &MaterialMap;

/// Rows of the table in docs/FORMATS.md by the crate's names, and how each is read.
macro_rules! maps {
    ($($map:ident $goes:ident $to:literal $(/ $per:literal)? $(in $least:literal..$most:literal)? $(: $note:literal)?;)*) => {
        /// Every map of a material in an FBX file that is known.
        pub const FBX_PARAMETERS: &[FileParameter] = &[$(
            FileParameter::$goes(stringify!($map), "", "", $to)
                $(.per($per))? $(.within($least, $most))? $(.with_note($note))?
        ),*];
        const READERS: &[Reader] = &[$(|material| &material.pbr.$map),*];
    };
}

maps! {
    base_factor to "base.color": "a factor";
    base_color to "base.color" in 0.0..1.0;
    roughness to "specular.roughness" in 0.0..1.0: "of Phong by its exponent";
    metalness to "base.metalness" in 0.0..1.0;
    diffuse_roughness to "base.diffuse_roughness" in 0.0..1.0;
    specular_factor to "specular.weight" in 0.0..1.0: "of Phong 1 where it reflects at all";
    specular_color to "specular.color" in 0.0..1.0;
    specular_ior to "specular.ior" in 1.0..4.0;
    transmission_factor to "transmission.weight" in 0.0..1.0;
    transmission_color to "transmission.color" in 0.0..1.0: "without a depth the base colour";
    transmission_depth to "transmission.depth" in 0.0..1e6;
    sheen_factor to "fuzz.weight" in 0.0..1.0;
    sheen_color to "fuzz.color" in 0.0..1.0;
    sheen_roughness to "fuzz.roughness" in 0.0..1.0;
    coat_factor to "coat.weight" in 0.0..1.0;
    coat_color to "coat.color" in 0.0..1.0;
    coat_roughness to "coat.roughness" in 0.0..1.0;
    coat_ior to "coat.ior" in 1.0..4.0;
    coat_normal to "coat.normal";
    thin_film_factor to "thin_film.weight" in 0.0..1.0;
    thin_film_thickness to "thin_film.thickness" / 1000.0;
    thin_film_ior to "thin_film.ior" in 1.0..3.0;
    emission_factor to "emission.strength" in 0.0..1e6;
    emission_color to "emission.color" in 0.0..1e6;
    opacity to "geometry.opacity" in 0.0..1.0: "of Lambert and Phong by `Opacity`, else by what is transparent";
    normal_map to "geometry.normal": "heights are ignored";
    specular_anisotropy nowhere "a stretched highlight";
    transmission_scatter nowhere "scattering inside what transmits";
    transmission_dispersion nowhere "dispersion";
    transmission_extra_roughness nowhere "a roughness of transmission alone";
    subsurface_factor nowhere "scattering below the surface";
    coat_anisotropy nowhere "a stretched highlight of the coat";
    tangent_map nowhere "a map of tangents";
    displacement_map nowhere "a displacement";
    matte_factor nowhere "a matte surface";
    ambient_occlusion nowhere "an occlusion map, which path tracing needs none of";
}

/// A material with the sets of texture coordinates that it looks up, by name; the first of a mesh has none.
#[derive(Clone, Default)]
pub struct Painted {
    pub slot: Slot,
    pub uv_sets: [Option<String>; 2],
}

/// Reader of one material.
pub struct Painter<'a, 'b> {
    pub material: &'a ufbx::Material,
    pub maps: &'a mut Maps<'b>,
    pub report: &'a mut ImportReport,
    /// Model's file name without its ending: a folder of images may be called by it.
    pub stem: &'a str,
    painted: Painted,
    /// Textures that are read, by their number.
    read: HashSet<u32>,
    parts: Vec<Part>,
}

impl<'a, 'b> Painter<'a, 'b> {
    pub fn new(
        material: &'a ufbx::Material,
        maps: &'a mut Maps<'b>,
        report: &'a mut ImportReport,
        stem: &'a str,
    ) -> Self {
        Self {
            material,
            maps,
            report,
            stem,
            painted: Painted::default(),
            read: HashSet::new(),
            parts: Vec::new(),
        }
    }

    pub fn paint(mut self) -> Painted {
        let material = self.material;
        self.note(Fate::Used, "materials");
        let is_classic = matches!(
            material.shader_type,
            ShaderType::Unknown | ShaderType::FbxLambert | ShaderType::FbxPhong
        );
        self.painted.slot = Slot {
            name: material.element.name.to_string(),
            double_sided: true,
            ..Slot::default()
        }
        .with(&[
            ("base.metalness", 0.0),
            ("specular.roughness", 0.5),
            ("geometry.opacity", 1.0),
        ]);
        // The set of the normals comes first, since tangents follow it.
        self.read_normal();
        for (row, reader) in FBX_PARAMETERS.iter().zip(READERS) {
            let is_of_classic = matches!(row.place, "base_color" | "emission_color" | "emission_factor");
            if !is_classic || is_of_classic {
                self.read_row(row, reader(material));
            }
        }
        if is_classic {
            self.read_classic();
        }
        let base_factor = &material.pbr.base_factor;
        if base_factor.has_value {
            self.painted
                .slot
                .multiply("base.color", [base_factor.value_vec4.x as f32; 3]);
        }
        if material.features.roughness_as_glossiness.enabled {
            self.read_glossiness();
        }
        self.maps.put(&self.parts, &mut self.painted.slot, self.report);
        self.finish()
    }

    fn note(&mut self, fate: Fate, what: impl Into<String>) {
        self.report.note(fate, what, &self.material.element.name);
    }

    fn read_row(&mut self, row: &FileParameter, map: &MaterialMap) {
        let [key, _] = row.keys();
        let texture = map.texture.as_ref().filter(|_| map.texture_enabled);
        if let Nowhere(what) = row.goes {
            let is_set = map.has_value && rgb(&map.value_vec4, 1).x != 0.0;
            if is_set || texture.is_some() {
                self.note(Fate::Ignored, what);
            }
            texture.map(|texture| self.read.insert(texture.element.element_id));
            return;
        }
        if row.place == "base_factor" || TextureTarget::of_key(key, "").is_some_and(TextureTarget::is_normal) {
            return;
        }
        if map.has_value {
            let found = rgb(&map.value_vec4, map.value_components).as_vec3() * row.per.recip();
            let [least, most] = row.range.unwrap_or([f32::MIN, f32::MAX]);
            let within = |x: f32| if x.is_nan() { 0.0 } else { x.clamp(least, most) };
            let shown = found.to_array().map(within);
            if shown != found.to_array() {
                self.note(Fate::Approximated, format!("{} beyond {least} to {most}", row.place));
            }
            self.painted.slot.set_color(key, shown);
        }
        if let Some(texture) = texture {
            match TextureTarget::of_key(key, "") {
                Some(target) => self.read_texture(texture, key, target),
                None => self.read_mean(texture, row.place, key),
            }
            self.read.insert(texture.element.element_id);
        }
    }

    /// A texture in the place of a number or colour.
    fn read_texture(&mut self, texture: &ufbx::Texture, key: &'static str, target: TextureTarget) {
        match self.texture(texture, target.is_color()) {
            Some(place) => {
                self.painted.slot.set(key, 1.0);
                let is_mask = target == TextureTarget::Opacity;
                let code = if is_mask {
                    opacity_of(self.maps.get(place.texture))
                } else {
                    grey
                };
                self.parts.push((target, place, code));
            }
            None if target == TextureTarget::BaseColor => self.painted.slot.set(key, 0.5),
            None => {}
        }
    }

    /// The mean of a texture in the place of a number or colour that no texture varies here.
    fn read_mean(&mut self, texture: &ufbx::Texture, map: &str, key: &'static str) {
        let is_color = key.ends_with(".color");
        if let Some(place) = self.texture(texture, is_color) {
            let mean = texture_mean(self.maps.get(place.texture));
            let [code, ..] = mean.codes;
            self.painted
                .slot
                .set_color(key, if is_color { mean.linear } else { [code; 3] });
            self.note(Fate::Approximated, format!("a texture of {map}, by its mean"));
        }
    }

    /// A glossiness is what a roughness lacks to 1.
    fn read_glossiness(&mut self) {
        let map = &self.material.pbr.glossiness;
        let roughness = 1.0 - map.value_vec4.x as f32;
        self.painted.slot.set("specular.roughness", roughness.clamp(0.0, 1.0));
        let texture = map.texture.as_ref().filter(|_| map.texture_enabled);
        if let Some(place) = texture.and_then(|texture| self.texture(texture, false)) {
            self.painted.slot.set("specular.roughness", 1.0);
            self.parts
                .push((TextureTarget::Roughness, place, |texel| 255 - grey(texel)));
        }
    }

    /// What Lambert and Phong have in other words.
    fn read_classic(&mut self) {
        let (fbx, slot) = (&self.material.fbx, &mut self.painted.slot);
        let exponent = fbx.specular_exponent.value_vec4.x.max(0.0);
        // As of a microfacet distribution: Walter et al. 2007.
        let alpha = (2.0 / (exponent + 2.0)).sqrt() as f32;
        let reflected = rgb(&fbx.specular_color.value_vec4, 3) * fbx.specular_factor.value_vec4.x;
        let is_shiny = self.material.shader_type == ShaderType::FbxPhong && reflected != DVec3::ZERO;
        slot.set("specular.roughness", alpha.sqrt());
        slot.set("specular.weight", f32::from(u8::from(is_shiny)));
        self.parts.retain(|(target, ..)| *target != TextureTarget::Specular);
        let [color, factor] = [&fbx.transparency_color, &fbx.transparency_factor];
        let opacity = self.material.element.props.find_prop("Opacity");
        let opacity = opacity.map(|opacity| opacity.value_vec4.x).unwrap_or_else(|| {
            let color = if color.has_value {
                rgb(&color.value_vec4, 3)
            } else {
                DVec3::ONE
            };
            1.0 - color.element_sum() / 3.0 * factor.value_vec4.x
        });
        slot.set("geometry.opacity", opacity.clamp(0.0, 1.0) as f32);
        let texture = [color, factor].into_iter().find_map(|map| map.texture.as_ref());
        if let Some(texture) = texture
            && let Some(place) = self.texture(texture, false)
        {
            self.painted.slot.set("geometry.opacity", 1.0);
            let transparency: fn([u8; 4]) -> u8 = |texel| 255 - grey(texel);
            let is_mask = self.maps.get(place.texture).is_translucent();
            let code = if is_mask {
                |texel: [u8; 4]| texel[3]
            } else {
                transparency
            };
            self.parts.push((TextureTarget::Opacity, place, code));
        }
        self.note(
            Fate::Approximated,
            "a Lambert or Phong material, as metalness and roughness",
        );
    }

    fn read_normal(&mut self) {
        let (pbr, fbx) = (&self.material.pbr, &self.material.fbx);
        let of_base = [&pbr.normal_map, &fbx.normal_map, &fbx.bump];
        for (maps, target) in [
            (&of_base[..], TextureTarget::Normal),
            (&[&pbr.coat_normal], TextureTarget::CoatNormal),
        ] {
            let Some(texture) = maps.iter().find_map(|map| map.texture.as_ref()) else {
                continue;
            };
            let Some(place) = self.texture(texture, false) else {
                continue;
            };
            if holds_heights(self.maps.get(place.texture)) {
                self.note(Fate::Ignored, "a bump texture, which holds heights");
            } else {
                *self.painted.slot.texture_mut(target) = Some(place);
            }
        }
    }

    /// The image of a texture, and where it lies; `None`, and reported, if it can't be looked up.
    fn texture(&mut self, texture: &ufbx::Texture, is_color: bool) -> Option<TextureRef> {
        self.read.insert(texture.element.element_id);
        let Some(file) = texture.file_textures.as_ref().first() else {
            self.note(
                Fate::Ignored,
                format!("the texture {}, which has no image", texture.element.name),
            );
            return None;
        };
        if texture.type_ != TextureType::File {
            self.note(Fate::Approximated, "layers or a graph of textures, by the first image");
        }
        let set = &*texture.uv_set;
        // "default" and "UVMap" of those that name none mean the first.
        let set = (!set.is_empty() && set != "default").then(|| set.to_owned());
        let known = self.painted.uv_sets.iter().position(|known| *known == set);
        let is_first = self.painted.slot.textures.iter().all(Option::is_none) && self.parts.is_empty();
        let uv_set = match (known, is_first) {
            (_, true) => {
                self.painted.uv_sets = [set, None];
                0
            }
            (Some(0), _) => 0,
            (_, false) if self.painted.uv_sets[1].is_none() || self.painted.uv_sets[1] == set => {
                self.painted.uv_sets[1] = set;
                1
            }
            _ => {
                self.note(Fate::Ignored, "a texture on a third set of coordinates");
                return None;
            }
        };
        let (relative, absolute) = (&*file.relative_filename, &*file.absolute_filename);
        let last = |path: &str| path.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
        let base = last(if relative.is_empty() { absolute } else { relative });
        let beside =
            ["textures", "../textures", &format!("{}.fbm", self.stem)].map(|folder| format!("{folder}/{base}"));
        let names = [relative, absolute, &beside[0], &beside[1], &beside[2]];
        let names: Vec<&str> = names.into_iter().filter(|name| !name.is_empty()).collect();
        let embedded = Some(&*file.content).filter(|content| !content.is_empty());
        let index = self.maps.image(&names, embedded, is_color, self.report)?;
        let wrap = |mode| match mode {
            WrapMode::Repeat => Wrap::Repeat,
            WrapMode::Clamp => Wrap::ClampToEdge,
        };
        let m = &texture.uv_to_texture;
        Some(TextureRef {
            texture: index,
            uv_set,
            // v is upwards there on both sides.
            texture_from_mesh_uv: [m.m00, -m.m01, m.m01 + m.m03, -m.m10, m.m11, 1.0 - m.m11 - m.m13].map(|x| x as f32),
            wrap: [wrap(file.wrap_u), wrap(file.wrap_v)],
            filter: Filter::Linear,
        })
    }

    /// What depends on several maps, and the report on what is left.
    fn finish(mut self) -> Painted {
        let features = &self.material.features;
        for (is_there, what) in [
            (features.unlit.enabled, "a material without light"),
            (features.thin_walled.enabled, "a thin wall, as a solid"),
        ] {
            if is_there {
                self.note(Fate::Ignored, what);
            }
        }
        let slot = &mut self.painted.slot;
        if slot.number("geometry.opacity") < 1.0 {
            slot.alpha_mode = AlphaMode::Blend;
        }
        let weight = slot.number("transmission.weight");
        if weight > 0.0 {
            let is_deep = slot.number("transmission.depth") > 0.0;
            let inside = if is_deep {
                [1.0; 3]
            } else {
                slot.color("transmission.color")
            };
            let base = slot.color("base.color");
            slot.set_color(
                "base.color",
                [0, 1, 2].map(|i| base[i] + weight * (inside[i] - base[i])),
            );
        }
        for texture in &self.material.textures {
            if !self.read.contains(&texture.texture.element.element_id) {
                let what = format!("a texture given by {}", &*texture.material_prop);
                self.report.note(Fate::Ignored, what, &self.material.element.name);
            }
        }
        self.painted
    }
}

/// The first three components; a single one stands for all.
fn rgb(value: &Vec4, components: u8) -> DVec3 {
    match components {
        0 | 1 => DVec3::splat(value.x),
        _ => DVec3::new(value.x, value.y, value.z),
    }
}
