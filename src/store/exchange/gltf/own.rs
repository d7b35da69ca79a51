//! Textures of the user's own as images of a glTF file, as far as the format can say how they are mapped.

use crate::{
    document::MaterialSettings,
    import::{Budget, picture::read_texture},
    optics::tone::srgb_from_linear,
    scene::{
        Filter, Model, Texture, TextureRef, Wrap,
        texture::{TextureProjection, TextureTarget, TextureValues, UserTexture, slots_with_coordinates},
    },
    store::exchange::{report::Entry, textures::Carried},
};

/// Puts a material's own textures into the model's slot where the file can have them, within the budget, and takes them
/// from the material; what became of each.
pub fn hand_over(model: &mut Model, slot: usize, material: &mut MaterialSettings, budget: &Budget) -> Vec<Entry> {
    let mut entries = Vec::new();
    // An image for each target that can be had and said.
    let mut pictures: Vec<(TextureTarget, UserTexture, Texture)> = Vec::new();
    for &target in TextureTarget::ALL {
        let Some(texture) = material.user_textures.get(target).filter(|_| material.textures[target]) else {
            continue;
        };
        match picture(model, slot, (material, target, texture), budget) {
            Ok(picture) => pictures.push((target, texture.clone(), picture)),
            Err(why) => entries.push(dropped(target, &why)),
        }
    }
    let taken = |target: TextureTarget| pictures.iter().position(|(of, ..)| *of == target);
    // Roughness and metalness are channels of one image.
    match (taken(TextureTarget::Roughness), taken(TextureTarget::Metalness)) {
        (Some(roughness), Some(metalness)) => {
            let [(_, rough, a), (_, metal, b)] = [&pictures[roughness], &pictures[metalness]];
            if rough.picture_from_uv() == metal.picture_from_uv() && [a.width, a.height] == [b.width, b.height] {
                let metalness = b.rgba8.clone();
                let joined = &mut pictures[roughness].2.rgba8;
                for (texel, other) in joined.chunks_exact_mut(4).zip(metalness.chunks_exact(4)) {
                    texel[2] = other[2];
                }
            } else {
                let why =
                    "it has another size or place than that of the roughness, and the format has one texture for both";
                entries.push(dropped(TextureTarget::Metalness, why));
            }
        }
        (None, None) => {}
        _ if model.slots[slot].texture(TextureTarget::Roughness).is_some()
            && material.textures[TextureTarget::Roughness] =>
        {
            let why = "the format has one texture for roughness and metalness, and one of them is the model's";
            pictures.retain(|(target, ..)| {
                let is_half = [TextureTarget::Roughness, TextureTarget::Metalness].contains(target);
                if is_half {
                    entries.push(dropped(*target, why));
                }
                !is_half
            });
        }
        _ => {}
    }
    let is_dropped = |entries: &[Entry], target| entries.iter().any(|entry| entry.what == words(target));
    let in_file: Vec<TextureTarget> = pictures.iter().map(|(target, ..)| *target).collect();
    for (target, texture, picture) in pictures {
        if is_dropped(&entries, target) {
            continue;
        }
        let place = TextureRef {
            texture: model.textures.len(),
            uv_set: usize::from(texture.projection == TextureProjection::Second),
            texture_from_mesh_uv: texture.picture_from_uv(),
            wrap: [Wrap::Repeat; 2],
            filter: Filter::Linear,
        };
        if target == TextureTarget::FilmThickness {
            model.slots[slot].thinnest = 0.0;
        }
        // What shares another's image is joined to it.
        if target.home() == target || !in_file.contains(&target.home()) {
            *model.slots[slot].texture_mut(target) = Some(place);
        }
        model.textures.push(picture);
        material.user_textures.set(target, None);
        entries.push(Entry::exact(words(target)));
    }
    entries
}

fn words(target: TextureTarget) -> String {
    format!("your texture of the {}", target.label().to_lowercase())
}

fn dropped(target: TextureTarget, why: &str) -> Entry {
    Entry::dropped(words(target), why)
}

/// An image with all that is done to its numbers done.
fn picture(
    model: &Model,
    slot: usize,
    (material, target, texture): (&MaterialSettings, TextureTarget, &UserTexture),
    budget: &Budget,
) -> Result<Texture, String> {
    let has_coordinates = slots_with_coordinates(model).get(slot).copied().unwrap_or(false);
    let is_box = texture.projection == TextureProjection::Box
        || (texture.projection == TextureProjection::Auto && !has_coordinates);
    if is_box {
        return Err("the format has no projection from the sides of a box".to_owned());
    }
    if target == TextureTarget::Opacity {
        return Err("the format has opacity in the texture of the base colour alone".to_owned());
    }
    if target.is_normal() && texture.rotation_deg != 0.0 {
        return Err("the format does not turn normals with their texture".to_owned());
    }
    let [a, b, _, c, d, _] = texture.picture_from_uv();
    if (a * b + c * d).abs() > 0.0001 * (a * a + b * b + c * c + d * d) {
        return Err("the format stretches a texture before it turns it, not after".to_owned());
    }
    if target == TextureTarget::CoatColor {
        return Err("the format has a coat's colour in a draft alone".to_owned());
    }
    let read = read_texture(&texture.file, target.is_color(), u32::MAX, budget)?;
    let carried = Carried::of(material, (target, texture), ());
    let changed = |texel: &[u8; 4]| changed(&carried, *texel);
    Ok(Texture {
        rgba8: read.rgba8.as_chunks::<4>().0.iter().flat_map(changed).collect(),
        rgba16: Vec::new(),
        ..read
    })
}

/// A texel of a file: sRGB codes of a colour, a normal, or a number in the channel that it has there.
fn changed(texture: &Carried<'_, ()>, texel: [u8; 4]) -> [u8; 4] {
    let value = texture.value(texel.map(|code| f64::from(code) / 255.0), 1.0);
    let code = |x: f64| (255.0 * x).round().clamp(0.0, 255.0) as u8;
    // What shares the image with it is left as it is.
    let mut changed = [255; 4];
    match texture.target.values() {
        TextureValues::Number(channel) => changed[channel] = code(value.x),
        TextureValues::Color => changed[..3].copy_from_slice(&srgb_from_linear(value).to_f64().map(code)),
        TextureValues::Vector => changed[..3].copy_from_slice(&value.to_f64().map(code)),
    }
    changed
}
