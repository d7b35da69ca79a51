//! What of the scene is chosen and what the pointer is over, in the tree and in the viewport alike.

use std::collections::BTreeSet;

use crate::{document::MaterialSettings, scene::ModelSource, scene::texture::TextureTarget};

/// A part of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Thing {
    /// An object of the model, by number.
    Object(usize),
    Slot(usize),
}

/// The slot that is edited, what is chosen beside it, and what is lit up.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// The material slot that is edited.
    pub slot: usize,
    /// The slots that were selected of other models, for when undo or redo brings them back.
    slots_of: Vec<(ModelSource, usize)>,
    /// The tree was shown in this frame, and in the one before: objects are picked.
    pub is_shown: bool,
    pub was_shown: bool,
    /// The user has chosen something of this model: what is edited at first is not outlined.
    pub is_made: bool,
    pub objects: BTreeSet<usize>,
    /// Slots that are edited together with the selected one.
    pub also: BTreeSet<usize>,
    /// What the pointer is over in this frame, and what it was over in the one before.
    pub hovered: Option<Thing>,
    pub lit: Option<Thing>,
    /// The area light whose handles are shown.
    pub light: Option<usize>,
    /// The list of lights was shown in this frame, and in the one before: lights are marked in the viewport.
    pub shows_lights: bool,
    pub showed_lights: bool,
    /// The place of a texture that the pointer is over in this frame: an image that is dropped goes there.
    pub texture: Option<TextureTarget>,
    /// The material that was copied.
    pub copied: Option<MaterialSettings>,
}

impl Selection {
    /// What the parts of the window say about this frame comes after what they said about the last one.
    pub fn begin_frame(&mut self) {
        self.was_shown = std::mem::take(&mut self.is_shown);
        self.showed_lights = std::mem::take(&mut self.shows_lights);
        self.lit = self.hovered.take();
        self.texture = None;
    }

    /// Whether the next frame shows something else without anything else happening.
    pub fn is_news(&self) -> bool {
        self.hovered != self.lit || self.is_shown != self.was_shown || self.shows_lights != self.showed_lights
    }

    /// Nothing is chosen of another model.
    pub fn forget(&mut self) {
        self.objects.clear();
        self.also.clear();
        self.hovered = None;
        self.is_made = false;
    }

    /// Another model takes a model's place: the slot is the one that was selected of it last.
    pub fn change_model(&mut self, left: ModelSource, model: &ModelSource) {
        self.forget();
        self.slots_of.retain(|(of, _)| *of != left);
        self.slots_of.push((left, self.slot));
        let known = self.slots_of.iter().find(|(of, _)| of == model);
        self.slot = known.map_or(0, |(_, slot)| *slot);
    }

    /// The slots that are edited: the selected one first.
    pub fn slots(&self) -> Vec<usize> {
        let others = self.also.iter().copied().filter(|slot| *slot != self.slot);
        std::iter::once(self.slot).chain(others).collect()
    }

    /// Chooses an object alone, or takes it in or out beside the others.
    pub fn choose_object(&mut self, object: usize, beside_others: bool) {
        self.is_made = true;
        toggle(&mut self.objects, object, beside_others);
    }

    /// Takes a slot in beside the selected one, or out.
    pub fn choose_also(&mut self, slot: usize) {
        toggle(&mut self.also, slot, true);
    }
}

fn toggle(chosen: &mut BTreeSet<usize>, number: usize, beside_others: bool) {
    if beside_others && chosen.remove(&number) {
        return;
    }
    if !beside_others {
        chosen.clear();
    }
    chosen.insert(number);
}
