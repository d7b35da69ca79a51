//! The textures of the selected material, each at its parameter: the model's, and those of the user's own in their place.

use std::sync::LazyLock;

use super::*;
use crate::{
    document::TEXTURE_PARAMETERS,
    scene::{Model, Texture, texture::TextureTarget},
};

/// Most texels to a side of the small copy that is shown.
const SMALL_SIDE: u32 = 64;

/// An image that a target looks up.
enum Picture {
    /// One of the model's.
    OfModel(Arc<Model>, usize),
    /// One of the user's own: `None` until it is loaded, or why it can't be.
    Own(String, Option<Result<Arc<Texture>, String>>),
}

/// The parameters of a target's texture.
struct TextureParameters {
    /// Where it stands: `base.color` for `base.color_map`. That of the normal has no number beside it, and stands at its
    /// switch.
    at: Option<&'static Parameter>,
    /// Its switch, where it has one of its own: metalness has that of the roughness.
    switch: Option<&'static Parameter>,
}

/// The places of all targets, in their order.
static PLACES: LazyLock<Vec<TextureParameters>> = LazyLock::new(|| {
    let of_key = |key: &str| PARAMETERS.iter().find(|parameter| parameter.key == key);
    let place = |target: &TextureTarget| {
        let key = target.map_key().trim_end_matches("_map");
        let switch = of_key(&format!("{key}_texture"));
        let at = of_key(key).or(switch);
        TextureParameters { at, switch }
    };
    TextureTarget::ALL.iter().map(place).collect()
});

/// The targets whose textures stand at parameters of a kind.
fn targets(is_it: impl Fn(&Parameter) -> bool) -> impl Iterator<Item = TextureTarget> {
    let is_it = move |target: &TextureTarget| PLACES[*target as usize].at.is_some_and(&is_it);
    TextureTarget::ALL.iter().copied().filter(is_it)
}

/// The target whose texture stands at a parameter.
pub fn target_of(key: &str) -> Option<TextureTarget> {
    targets(|parameter| parameter.key == key).next()
}

/// The targets of a group of parameters.
pub fn of_group(group: &str) -> impl Iterator<Item = TextureTarget> {
    targets(move |parameter| parameter.group == group)
}

/// Whether the selected slot has a texture there.
pub fn is_there(desk: &Desk, target: TextureTarget) -> bool {
    picture(desk, target).is_some()
}

/// The square beside a parameter that has no texture: pressed to choose one, and a place to drop one.
pub fn empty_slot(ui: &mut Ui, target: TextureTarget) -> Response {
    let choose = "Choose an image of your own, or drop one on the window.";
    icons::button(
        ui,
        Icon::Texture,
        &name(target),
        &format!("{}\n{choose}", target.help()),
    )
}

fn name(target: TextureTarget) -> String {
    format!("Texture of the {}", target.label().to_lowercase())
}

/// The texture's row, with how a user's own one is mapped. One that is not there has its place beside the parameter, but
/// for that of the normal, which has a row.
pub fn show(ui: &mut Ui, desk: &mut Desk, target: TextureTarget, material: &mut MaterialSettings) {
    let picture = picture(desk, target);
    if picture.is_some() || target.is_normal() {
        let top = ui.cursor().min;
        let place = Rect::from_min_size(top, vec2(ui.available_width(), theme::ROW_HEIGHT));
        if ui.rect_contains_pointer(place) {
            desk.shared.selection.texture = Some(target);
        }
        row(ui, desk, target, picture.as_ref(), material);
        placement(ui, desk, target, material);
    }
}

fn row(
    ui: &mut Ui,
    desk: &mut Desk,
    target: TextureTarget,
    picture: Option<&Picture>,
    material: &mut MaterialSettings,
) {
    let switch = PLACES[target as usize].switch.filter(|_| picture.is_some());
    let full = switch.map_or_else(|| name(target), Parameter::full_name);
    let help = switch.map_or(target.help(), |parameter| parameter.help);
    let is_switched = widgets::row(ui, [&full, target.label(), help], |ui| {
        let Some(picture) = picture else {
            let help = "Assigns a texture of your own; or drop one on the window";
            let response = ui.button("Choose…").on_hover_text(help);
            if response.clicked() {
                desk.actions.push(Action::ChooseTexture(target));
            }
            return response;
        };
        let switch = switch.map(|_| ui.checkbox(&mut material.textures[target], ""));
        // Its small copy comes later, and the button behind stays the one that it is.
        let shown = widgets::comes_and_goes(ui, |ui| picture.show(ui));
        menu(ui, desk, target, material);
        switch.unwrap_or(shown)
    });
    if let Some(parameter) = switch.filter(|_| is_switched) {
        let key = format!("{}/{}", desk.shared.selection.slot, parameter.key);
        desk.edits.note(parameter.full_name(), key);
    }
}

fn menu(ui: &mut Ui, desk: &mut Desk, target: TextureTarget, material: &mut MaterialSettings) {
    let of_target = target.label().to_lowercase();
    let name = format!("Menu of the {of_target} texture");
    let more = icons::button(ui, Icon::More, &name, "Replace, remove");
    Popup::menu(&more).show(|ui| {
        if widgets::pressed(ui, "Replace…", "Another texture of your own") {
            desk.actions.push(Action::ChooseTexture(target));
        }
        let is_own = material.user_textures.get(target).is_some();
        let help = "The model's texture comes back, where it has one";
        let why_not = "It is the model's; its switch leaves it out";
        if widgets::pressed_if(ui, is_own, "Remove", help, why_not) {
            material.user_textures.set(target, None);
            desk.edits.did(format!("Remove the {of_target} texture"));
        }
    });
}

/// How an image of the user's own lies on the material.
fn placement(ui: &mut Ui, desk: &mut Desk, target: TextureTarget, material: &mut MaterialSettings) {
    let Some(mut texture) = material.user_textures.get(target).cloned() else {
        return;
    };
    let title = format!("Placement of the {} texture", target.label().to_lowercase());
    CollapsingHeader::new(RichText::new("Placement").weak())
        .id_salt(&title)
        .show(ui, |ui| {
            for parameter in TEXTURE_PARAMETERS.iter() {
                let has_effect = match parameter.key {
                    "channel" => target.is_number(),
                    // Bumps have a strength of their own, and are never colours.
                    "strength" | "color_space" => !target.is_normal(),
                    _ => true,
                };
                let full = format!("{} texture {}", target.label(), parameter.label.to_lowercase());
                if has_effect && parameter_row::edit(ui, parameter, &full, &mut texture, None) {
                    let key = format!("{}/{}/{}", desk.shared.selection.slot, target.name(), parameter.key);
                    desk.edits.note(full, key);
                    material.user_textures.set(target, Some(texture.clone()));
                }
            }
        })
        .header_response
        .accessible_name(title);
}

/// What a target of the selected slot looks up.
fn picture(desk: &Desk, target: TextureTarget) -> Option<Picture> {
    let scene = desk.scene();
    if let Some(own) = desk.material().user_textures.get(target) {
        let name = own.file.file_name().unwrap_or(own.file.as_os_str()).to_string_lossy();
        let mut known = scene.iter().flat_map(|scene| &scene.job.textures.user_textures);
        let known = known.find(|known| known.file == own.file);
        return Some(Picture::Own(
            name.into_owned(),
            known.map(|known| known.picture.clone()),
        ));
    }
    let scene = scene?;
    let slot = scene.model.slots.get(desk.shared.selection.slot)?;
    let reference = slot.texture(target)?;
    Some(Picture::OfModel(scene.model.clone(), reference.texture))
}

impl Picture {
    /// Its name, size and a small copy, which is made once.
    fn show(&self, ui: &mut Ui) -> Response {
        let (name, about) = match self {
            Self::OfModel(model, texture) => {
                let picture = &model.textures[*texture];
                (picture.name.as_str(), about(picture))
            }
            Self::Own(name, Some(Ok(picture))) => (name.as_str(), about(picture)),
            Self::Own(name, None) => (name.as_str(), "loading".to_owned()),
            Self::Own(name, Some(Err(why))) => {
                let text = RichText::new(format!("{name}: missing")).color(ui.visuals().warn_fg_color);
                let help = format!("{why}\nPut the file there, or choose another.");
                return widgets::line(ui, text).on_hover_text(help);
            }
        };
        if let Some((picture, id)) = self.texels() {
            let known = ui.memory(|memory| memory.data.get_temp::<TextureHandle>(id));
            let handle = known.unwrap_or_else(|| {
                let options = TextureOptions::LINEAR;
                let handle = ui.ctx().load_texture(name, small_copy(picture), options);
                ui.memory_mut(|memory| memory.data.insert_temp(id, handle.clone()));
                handle
            });
            let side = Vec2::splat(theme::ROW_HEIGHT - 2.0);
            ui.add(Image::new((handle.id(), side)).alt_text(name))
                .on_hover_text(&about);
        }
        let width = (ui.available_width() - theme::ROW_HEIGHT - ui.spacing().item_spacing.x).max(0.0);
        let label = Label::new(name).truncate();
        widgets::sized(ui, width, |ui| ui.add(label).on_hover_text(about))
    }

    /// The image, where it is there, and what its small copy is remembered by.
    fn texels(&self) -> Option<(&Texture, Id)> {
        match self {
            Self::OfModel(model, texture) => {
                let id = ("texture", Arc::as_ptr(model) as usize, *texture);
                Some((&model.textures[*texture], Id::unique(id)))
            }
            Self::Own(_, Some(Ok(picture))) => {
                let id = ("own texture", Arc::as_ptr(picture) as usize);
                Some((picture, Id::unique(id)))
            }
            Self::Own(..) => None,
        }
    }
}

fn about(picture: &Texture) -> String {
    format!("{}\n{} × {}", picture.name, picture.width, picture.height)
}

/// An image reduced to at most [`SMALL_SIDE`] texels a side, by the nearest texel.
fn small_copy(picture: &Texture) -> ColorImage {
    let [width, height] = [picture.width, picture.height].map(|side| side.clamp(1, SMALL_SIDE));
    let pixels = (0..width * height).map(|i| {
        let (x, y) = (i % width * picture.width / width, i / width * picture.height / height);
        let place = 4 * (y * picture.width + x) as usize;
        match picture.rgba8.get(place..place + 3) {
            Some(&[r, g, b]) => Color32::from_rgb(r, g, b),
            _ => Color32::BLACK,
        }
    });
    ColorImage::new([width as usize, height as usize], pixels.collect())
}
