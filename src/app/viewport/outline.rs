//! Thin lines around what is chosen and what the pointer is over.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::sync::Arc;

use super::*;
use crate::{render::seen_map, render::seen_map::SeenMap, services::beside::Beside, services::selection::Thing};

/// The line as it is shown.
#[derive(Default)]
pub struct Outline {
    maps: Beside<(Arc<Job>, [u32; 2]), Arc<SeenMap>>,
    /// What the latest map was asked of, and in what size.
    asked: Option<(Arc<Job>, [u32; 2])>,
    shown: ShownTexture,
}

impl Outline {
    /// Paints the lines over the image at `place`, once it is known what is seen where.
    pub fn show(&mut self, ui: &Ui, area: Rect, place: Rect, job: &Arc<Job>, desk: &Desk) {
        let chosen = chosen(desk);
        let lit = desk.shared.selection.lit;
        if chosen.is_empty() && lit.is_none() {
            return;
        }
        // In the screen's pixels, at any size of the image.
        let pixels = place.size() * ui.ctx().pixels_per_point();
        let size = [pixels.x, pixels.y].map(|side| (side.round() as u32).max(1));
        // Nothing of another view, as while the camera turns.
        let map = self.maps.latest().filter(|map| map.is_of(job));
        let is_asked =
            |(of, in_size): &(Arc<Job>, [u32; 2])| *in_size == size && (map.is_some() || Arc::ptr_eq(of, job));
        if !self.asked.as_ref().is_some_and(is_asked) {
            self.maps
                .ask_again(ui.ctx(), "outlines", (job.clone(), size), seen_map::answer);
            self.asked = Some((job.clone(), size));
        }
        let Some(map) = map else { return };
        let surface = (!desk.shared.selection.objects.is_empty()).then_some(desk.shared.selection.slot);
        let mut hasher = DefaultHasher::new();
        let of_map = (Arc::as_ptr(&map) as usize, ui.visuals().dark_mode);
        (&chosen, surface, lit, of_map).hash(&mut hasher);
        let accent = theme::accent(ui);
        self.shown.upload(ui, [u64::MAX - 1, hasher.finish()], || {
            let lit: Vec<Thing> = lit.into_iter().collect();
            picture(&map, [(&chosen, accent, surface), (&lit, Color32::WHITE, None)])
        });
        self.shown.show(ui, area.intersect(place), place);
    }
}

/// What is outlined because the user chose it: objects, else slots where there is more than one.
fn chosen(desk: &Desk) -> Vec<Thing> {
    let selection = &desk.shared.selection;
    if !selection.is_made {
        return Vec::new();
    }
    if !selection.objects.is_empty() {
        return selection.objects.iter().copied().map(Thing::Object).collect();
    }
    let count = desk.scene().map_or(0, |scene| scene.model.slots.len());
    let slots = selection.slots();
    slots.into_iter().filter(|_| count > 1).map(Thing::Slot).collect()
}

/// The edges of some things in a colour each, over nothing. Where a slot is given, they are those of the parts with it, if
/// any is seen: its material is what is edited of an object.
fn picture(map: &SeenMap, kinds: [(&Vec<Thing>, Color32, Option<usize>); 2]) -> ColorImage {
    let mut image = ColorImage::filled([map.width as usize, map.height as usize], Color32::TRANSPARENT);
    for (things, color, surface) in kinds.into_iter().filter(|(things, ..)| !things.is_empty()) {
        let is_chosen = |[object, slot]: [u32; 2]| {
            things.iter().any(|thing| match thing {
                Thing::Object(number) => object as usize == *number,
                Thing::Slot(number) => slot as usize == *number,
            })
        };
        let is_surface = |seen: [u32; 2]| is_chosen(seen) && surface.is_some_and(|slot| seen[1] as usize == slot);
        let edges = match map.seen.iter().any(|seen| is_surface(*seen)) {
            true => map.edges(is_surface),
            false => map.edges(is_chosen),
        };
        for (pixel, is_edge) in image.pixels.iter_mut().zip(edges) {
            if is_edge {
                *pixel = color;
            }
        }
    }
    image
}
