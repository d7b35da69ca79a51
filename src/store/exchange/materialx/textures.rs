//! A material's own textures as nodes of MaterialX, and the files that go with a document.

use std::{collections::HashMap, path::Path, path::PathBuf};

use super::read::{normal_target, target_of};
use crate::{
    document::MaterialSettings,
    import::{Budget, FileParameter, picture::mean_of_file},
    scene::texture::{TextureProjection, TextureTarget, UserTexture},
    store::exchange::{
        report::{Entry, MaterialReport, OWN_TEXTURES},
        xml::element,
        xml::escaped,
    },
};

/// Files that are written beside a document, by where they come from.
pub(super) struct Files {
    /// What their names begin with, so that they replace nobody's.
    stem: String,
    pub(super) names: HashMap<PathBuf, String>,
    pub(super) contents: Vec<(String, Vec<u8>)>,
}

impl Files {
    pub(super) fn of(path: &Path) -> Self {
        Self {
            stem: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            names: HashMap::new(),
            contents: Vec::new(),
        }
    }

    /// The name beside the document of a file's copy.
    fn name(&mut self, file: &Path) -> Result<String, String> {
        if let Some(known) = self.names.get(file) {
            return Ok(known.clone());
        }
        let bytes = crate::store::file::read(file).map_err(crate::in_words)?;
        let own = file.file_name().unwrap_or_default().to_string_lossy();
        let mut name = format!("{}_{own}", self.stem);
        while self.contents.iter().any(|(other, _)| *other == name) {
            name.insert(self.stem.len(), '_');
        }
        self.names.insert(file.to_owned(), name.clone());
        self.contents.push((name.clone(), bytes));
        Ok(name)
    }
}

/// The textures of a material that can be written: nodes, and the node's name by the target.
#[derive(Default)]
pub(super) struct Nodes {
    pub(super) text: String,
    names: Vec<(TextureTarget, String)>,
}

impl Nodes {
    /// Of a material whose surface has this name. What becomes of its textures is reported.
    pub(super) fn of(
        material: &MaterialSettings,
        (surface, rows): (&str, &[FileParameter]),
        files: &mut Files,
        report: &mut MaterialReport,
    ) -> Self {
        let mut nodes = Self::default();
        let has_place = |target| {
            let takes = |row: &FileParameter| target_of(row).or(normal_target(row.place)) == Some(target);
            rows.iter().any(takes)
        };
        for (target, texture) in material
            .user_textures
            .iter()
            .filter(|(target, _)| material.textures[*target])
        {
            let what = format!("texture of {}", target.label());
            let added = match has_place(target) {
                true => nodes.add(material, target, texture, surface, files),
                false => Err("the surface has no input for it".to_owned()),
            };
            report.entries.push(match added {
                Err(why) => Entry::dropped(what, why),
                Ok(()) if is_plain(texture) => Entry::exact(what),
                Ok(()) => Entry::approximated(what, "without its turn, strength, inversion and projection", None),
            });
            if let Some([_, look]) = report.looks.as_deref_mut()
                && nodes.names.last().is_some_and(|(last, _)| *last == target)
            {
                look.user_textures.set(target, Some(texture.clone()));
                look.textures[target] = true;
            }
        }
        report.entries.retain(|entry| entry.what != OWN_TEXTURES);
        nodes
    }

    fn add(
        &mut self,
        material: &MaterialSettings,
        target: TextureTarget,
        texture: &UserTexture,
        surface: &str,
        files: &mut Files,
    ) -> Result<(), String> {
        let file = files.name(&texture.file)?;
        let name = format!("{surface}_{}", target.name().replace('-', "_"));
        let space = ["none", "srgb_texture"][usize::from(texture.is_srgb(target))];
        let kind = ["color3", "vector3"][usize::from(target.is_normal())];
        let [along, up] = [texture.scale, texture.scale * texture.stretch];
        // About the origin there, about the middle here.
        let offset = [0, 1].map(|i| texture.offset[i] - 0.5 * (1.0 - [along, up][i]));
        let mut inputs = input(
            "file",
            "filename",
            &format!("value=\"{}\" colorspace=\"{space}\"", escaped(&file)),
        );
        inputs += &input("uvtiling", "vector2", &format!("value=\"{along}, {up}\""));
        inputs += &input(
            "uvoffset",
            "vector2",
            &format!("value=\"{}, {}\"", offset[0], offset[1]),
        );
        let mut node = |name: &str, kind: &str, of: &str, inputs: &str| {
            self.text += &element(&format!("{kind} name=\"{name}\" type=\"{of}\""), inputs);
        };
        if target.is_color() {
            node(&name, "tiledimage", kind, &inputs);
        } else {
            let image = format!("{name}_image");
            let source = format!("nodename=\"{image}\"");
            if target.is_normal() {
                node(&image, "tiledimage", kind, &inputs);
                let strength = match target {
                    TextureTarget::CoatNormal => material.coat_normal_strength,
                    _ => material.normal_strength,
                };
                let scale = input("scale", "float", &format!("value=\"{strength}\""));
                node(&name, "normalmap", kind, &(input("in", kind, &source) + &scale));
            } else {
                let has_alpha = target == TextureTarget::Opacity
                    && mean_of_file(&texture.file, &Budget::of_import()).is_ok_and(|read| read.mean.codes[3] < 1.0);
                let channel = texture.channel_of(target, has_alpha);
                let kind = if channel == 3 { "color4" } else { kind };
                node(&image, "tiledimage", kind, &inputs);
                let index = input("index", "integer", &format!("value=\"{channel}\""));
                node(&name, "extract", "float", &(input("in", kind, &source) + &index));
            }
        }
        self.names.push((target, name));
        Ok(())
    }

    /// How an input is connected whose texture varies it by this value, where there is such a texture.
    pub(super) fn connection(&mut self, target: Option<TextureTarget>, kind: &str, value: &str) -> Option<String> {
        let (_, name) = self.names.iter().find(|(other, _)| Some(*other) == target)?;
        let factor = format!("{name}_factor");
        let inputs =
            input("in1", kind, &format!("nodename=\"{name}\"")) + &input("in2", kind, &format!("value=\"{value}\""));
        self.text += &element(&format!("multiply name=\"{factor}\" type=\"{kind}\""), &inputs);
        Some(format!("nodename=\"{factor}\""))
    }

    /// The node of a texture of normals.
    pub(super) fn normal(&self, target: TextureTarget) -> Option<&str> {
        let found = self.names.iter().find(|(other, _)| *other == target);
        found.map(|(_, name)| &name[..])
    }
}

/// An input with what it is worth.
fn input(name: &str, kind: &str, worth: &str) -> String {
    format!("<input name=\"{name}\" type=\"{kind}\" {worth} />\n")
}

/// Whether a texture is no more than a place, a space and a channel.
fn is_plain(texture: &UserTexture) -> bool {
    let is_by_coordinates = matches!(texture.projection, TextureProjection::Auto | TextureProjection::First);
    is_by_coordinates && !texture.inverted && texture.strength == 1.0 && texture.rotation_deg == 0.0
}
