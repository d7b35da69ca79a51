//! A material's own textures on their way into other formats: their files, where they lie, what is done to their values, and
//! what is said of each.

use std::{collections::HashMap, path::Path, path::PathBuf};

use glam::{DAffine2, DVec2};

use super::report::{Entry, MaterialReport};
use crate::{
    document::MaterialSettings,
    import::{Budget, picture::mean_of_file},
    optics::{tone::linear_from_srgb, vector::Vec3, vector::vec3},
    scene::texture::{TextureProjection, TextureTarget, UserTexture},
};

/// Files that are written beside a document.
pub struct Files {
    /// What their names begin with, so that they replace nobody's.
    stem: String,
    /// Names of copies, by where they come from.
    names: HashMap<PathBuf, String>,
    pub(super) contents: Vec<(String, Vec<u8>)>,
}

/// A name without the marks that stand for something else in a format: USD's `@`, Mitsuba's `$`, MaterialX's `<UDIM>`.
fn plain(name: &str) -> String {
    name.replace(['@', '$', '<', '>'], "_")
}

impl Files {
    pub(super) fn of(path: &Path) -> Self {
        Self {
            stem: plain(&path.file_stem().unwrap_or_default().to_string_lossy()),
            names: HashMap::new(),
            contents: Vec::new(),
        }
    }

    /// The name beside the document of a file's copy.
    pub(super) fn copy(&mut self, file: &Path) -> Result<String, String> {
        if let Some(known) = self.names.get(file) {
            return Ok(known.clone());
        }
        let bytes = crate::store::file::read(file).map_err(crate::in_words)?;
        let name = self.add(&file.file_name().unwrap_or_default().to_string_lossy(), bytes);
        self.names.insert(file.to_owned(), name.clone());
        Ok(name)
    }

    /// The name beside the document of a file with these contents.
    pub(super) fn add(&mut self, own: &str, bytes: Vec<u8>) -> String {
        let mut name = format!("{}_{}", self.stem, plain(own));
        while self.contents.iter().any(|(other, _)| *other == name) {
            name.insert(self.stem.len(), '_');
        }
        self.contents.push((name.clone(), bytes));
        name
    }
}

/// A texture that goes into a file.
pub struct Carried<'a, T> {
    pub target: TextureTarget,
    pub texture: &'a UserTexture,
    /// Channel of a number, 0 to 3.
    pub channel: usize,
    /// How steep the bumps of normals are; 1 of others.
    pub steepness: f32,
    /// What was made of it: the name of a file beside the document, or its image.
    pub made: T,
}

/// Takes a material's own textures over that a format has a place for, and reports what becomes of all.
pub fn carry<'a, T>(
    material: &'a MaterialSettings,
    report: &mut MaterialReport,
    (has_place, has_second_set): (impl Fn(TextureTarget) -> bool, bool),
    mut make: impl FnMut(TextureTarget, &UserTexture) -> Result<T, String>,
) -> Vec<Carried<'a, T>> {
    let mut all = Vec::new();
    let own = material.user_textures.iter();
    for (target, texture) in own.filter(|(target, _)| material.textures[*target]) {
        let what = format!("texture of {}", target.label());
        let made = match has_place(target) {
            true => make(target, texture),
            false => Err("the surface has no input for it".to_owned()),
        };
        match made {
            Err(why) => report.entries.push(Entry::dropped(what, why)),
            Ok(made) => {
                report.entries.push(match missed(target, texture, has_second_set) {
                    "" => Entry::exact(what),
                    missed => Entry::approximated(what, missed, None),
                });
                if let Some([_, look]) = report.looks.as_deref_mut() {
                    look.user_textures.set(target, Some(texture.clone()));
                    look.textures[target] = true;
                    look.normal_strength = material.normal_strength;
                    look.coat_normal_strength = material.coat_normal_strength;
                }
                all.push(Carried::of(material, (target, texture), made));
            }
        }
    }
    all
}

/// What formats do not have of a texture's mapping, in words.
fn missed(target: TextureTarget, texture: &UserTexture, has_second_set: bool) -> &'static str {
    match texture.projection {
        TextureProjection::Box => "by texture coordinates, not from the sides of a box",
        TextureProjection::Second if !has_second_set => "by the first set of texture coordinates",
        _ if target.is_normal() && texture.rotation_deg != 0.0 => "its normals do not turn with it",
        _ => "",
    }
}

impl<'a, T> Carried<'a, T> {
    pub fn of(material: &MaterialSettings, (target, texture): (TextureTarget, &'a UserTexture), made: T) -> Self {
        let has_alpha = target == TextureTarget::Opacity
            && mean_of_file(&texture.file, &Budget::of_import()).is_ok_and(|read| read.mean.codes[3] < 1.0);
        Self {
            target,
            texture,
            channel: texture.channel_of(target, has_alpha) as usize,
            steepness: match target {
                TextureTarget::Normal => material.normal_strength,
                TextureTarget::CoatNormal => material.coat_normal_strength,
                _ => 1.0,
            },
            made,
        }
    }

    /// What values are multiplied by, and what is added then; normals as they lie in [0, 1], this steep.
    pub fn affine(&self, steepness: f32) -> [[f32; 3]; 2] {
        let UserTexture { strength, inverted, .. } = *self.texture;
        match (self.target.is_normal(), inverted) {
            (true, _) => {
                let slopes = [steepness, if inverted { -steepness } else { steepness }, 1.0];
                [slopes, slopes.map(|slope| 0.5 * (1.0 - slope))]
            }
            (false, true) => [[-strength; 3], [1.0; 3]],
            (false, false) => [[strength; 3], [1.0 - strength; 3]],
        }
    }

    /// What a texel is worth: linear light, a normal in [0, 1] with slopes as steep as they are here times `steepness`, or a number
    /// in all three places.
    pub fn value(&self, [r, g, b, a]: [f64; 4], steepness: f32) -> Vec3<f64> {
        let mut value = vec3(r, g, b);
        if self.texture.is_srgb(self.target) && !self.target.is_normal() {
            value = linear_from_srgb(value);
        }
        if self.target.is_number() {
            value = Vec3::splat([value.x, value.y, value.z, a][self.channel]);
        }
        let [scale, offset] = self.affine(steepness).map(Vec3::from_f32);
        value * scale + offset
    }
}

/// Repetitions along u and v.
pub fn scale(texture: &UserTexture) -> DVec2 {
    f64::from(texture.scale) * DVec2::new(1.0, f64::from(texture.stretch))
}

/// What a texture does to coordinates whose v points upwards: turned about the middle, then scaled, then moved.
pub fn mapping(texture: &UserTexture) -> DAffine2 {
    let middle = DVec2::splat(0.5);
    DAffine2::from_translation(middle - DVec2::from(texture.offset.map(f64::from)))
        * DAffine2::from_scale(scale(texture))
        * DAffine2::from_angle(-f64::from(texture.rotation_deg).to_radians())
        * DAffine2::from_translation(-middle)
}

/// Places a texture so, the inverse of [`mapping`]; false where it would be sheared or mirrored.
pub fn place(texture: &mut UserTexture, mapping: DAffine2) -> bool {
    let [along, up] = [0, 1].map(|row| mapping.matrix2.row(row));
    let is_square = along.dot(up).abs() <= 0.0001 * along.length() * up.length();
    let is_placed = is_square && mapping.matrix2.determinant() > 0.0;
    if is_placed {
        let middle = DVec2::splat(0.5);
        texture.scale = along.length() as f32;
        texture.stretch = (up.length() / along.length()) as f32;
        texture.rotation_deg = along.y.atan2(along.x).to_degrees() as f32;
        texture.offset = (middle - mapping.transform_point2(middle)).as_vec2().to_array();
    }
    is_placed
}
