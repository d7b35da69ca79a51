//! `--texture`: images of one's own on materials.

use std::{ffi::OsStr, path::Path, path::PathBuf};

use anyhow::bail;
use clap::builder::{OsStringValueParser, TypedValueParser};

use super::names::names;
use crate::{
    document::Document,
    import::endings,
    named::Named as _,
    scene::{
        Model,
        path_text::path_of_bytes,
        texture::{TextureTarget, UserTexture, set},
    },
};

/// Images, and the material that they are assigned to.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureArgument {
    /// Name or number of the slot; every material where none is given.
    slot: Option<String>,
    textures: Vec<(TextureTarget, UserTexture)>,
}

/// What the option is for.
pub fn help() -> String {
    let names = names::<TextureTarget>();
    format!(
        "Put an image on a material, for one of {names}. SLOT is a material's name or number, without it every one. A file or \
         a folder of files whose names say what they are for needs no USE. How it lies there: --set base.color_map.scale=3, \
         .rotation, .projection=box and more. May be repeated"
    )
}

/// `[SLOT:]USE=FILE`, or `[SLOT:]FILE` or `[SLOT:]FOLDER` where names of files say what they are for.
pub fn argument() -> impl TypedValueParser<Value = TextureArgument> {
    OsStringValueParser::new().try_map(|argument| texture(&argument))
}

/// The text before a place, and the path after the byte there.
fn around(argument: &OsStr, place: Option<usize>) -> Option<(&str, PathBuf)> {
    let (left, right) = argument.as_encoded_bytes().split_at_checked(place?)?;
    let path = path_of_bytes(right.get(1..)?.to_vec());
    Some((std::str::from_utf8(left).ok()?, path))
}

fn texture(argument: &OsStr) -> Result<TextureArgument, String> {
    let bytes = argument.as_encoded_bytes();
    if let Some((left, file)) = around(argument, bytes.iter().position(|byte| *byte == b'=')) {
        let (slot, name) = match left.rsplit_once(':') {
            Some((slot, name)) => (Some(slot.to_owned()), name),
            None => (None, left),
        };
        let target = TextureTarget::by_name(name)
            .ok_or_else(|| format!("{name} takes no texture; give one of {}", names::<TextureTarget>()))?;
        let file = existing(file)?;
        let named = set::targets_of(&file).into_iter().find(|(known, _)| *known == target);
        let texture = named.map_or_else(|| UserTexture::of(file), |(_, texture)| texture);
        return Ok(TextureArgument {
            slot,
            textures: vec![(target, texture)],
        });
    }
    let (slot, path) = match around(argument, bytes.iter().rposition(|byte| *byte == b':')) {
        Some((slot, path)) if !Path::new(argument).exists() => (Some(slot.to_owned()), path),
        _ => (None, argument.into()),
    };
    let path = existing(path)?;
    let (textures, _) = match path.is_dir() {
        true => set::recognised(&endings::pictures_in(&path)),
        false => set::recognised(std::slice::from_ref(&path)),
    };
    if textures.is_empty() {
        return Err(format!(
            "{}: no name here says what a texture is for, as wood_basecolor.png does; write USE={0}, with one of {}",
            path.display(),
            names::<TextureTarget>()
        ));
    }
    Ok(TextureArgument { slot, textures })
}

fn existing(path: PathBuf) -> Result<PathBuf, String> {
    match path.exists() {
        true => Ok(path),
        false => Err(format!("{}: there is no such file", path.display())),
    }
}

impl TextureArgument {
    /// The images.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.textures.iter().map(|(_, texture)| &texture.file)
    }

    /// Puts the images on the materials of a document.
    ///
    /// # Errors
    /// Where the model has no such slot.
    pub fn apply(&self, document: &mut Document, model: &Model) -> anyhow::Result<()> {
        let slots = match &self.slot {
            None => 0..document.materials.len().max(1),
            Some(slot) => {
                let place = slot_of(slot, model)?;
                place..place + 1
            }
        };
        for slot in slots {
            let material = document.material_mut(slot);
            for (target, texture) in &self.textures {
                material.put_texture(*target, texture.clone());
            }
        }
        Ok(())
    }
}

/// The number of a slot by its name, or by its number from 1.
fn slot_of(text: &str, model: &Model) -> anyhow::Result<usize> {
    let named = model.slots.iter().position(|slot| slot.name == text);
    let numbered = text
        .parse()
        .ok()
        .filter(|number| (1..=model.slots.len()).contains(number));
    if let Some(slot) = named.or(numbered.map(|number| number - 1)) {
        return Ok(slot);
    }
    let names: Vec<_> = model.slots.iter().map(|slot| slot.name.as_str()).collect();
    bail!(
        "--texture: the model has no material {text}; it has {} (or 1 to {})",
        names.join(", "),
        names.len()
    )
}
