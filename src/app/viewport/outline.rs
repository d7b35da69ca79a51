//! Thin lines around what is chosen and what the pointer is over.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::sync::Arc;

use egui::{Color32, ColorImage, Rect, Ui};

use super::Shown;
use crate::app::desk::Desk;
use crate::app::kit::theme;
use crate::app::services::selection::Thing;
use crate::job::Job;
use crate::render::seen_map::{self, SeenMap, SeenMaps};

/// The line as it is shown.
#[derive(Default)]
pub(super) struct Outline {
    maps: Option<SeenMaps>,
    /// What the latest map was asked of.
    asked: Option<Arc<Job>>,
    shown: Shown,
}

impl Outline {
    /// Paints the lines over the image at `place`, once it is known what is seen where.
    pub(super) fn show(&mut self, ui: &Ui, area: Rect, place: Rect, job: &Arc<Job>, desk: &Desk<'_>) {
        let chosen = chosen(desk);
        let lit = desk.shared.selection.lit;
        if chosen.is_empty() && lit.is_none() {
            return;
        }
        if self.maps.is_none() {
            let ctx = ui.ctx().clone();
            self.maps = seen_map::spawn(move || ctx.request_repaint()).ok();
        }
        let Some(maps) = &self.maps else { return };
        if !self.asked.as_ref().is_some_and(|asked| Arc::ptr_eq(asked, job)) {
            maps.ask(job.clone());
            self.asked = Some(job.clone());
        }
        // Nothing of another view, as while the camera turns.
        let Some(map) = maps.latest().filter(|map| Arc::ptr_eq(&map.job, job)) else {
            return;
        };
        let mut hasher = DefaultHasher::new();
        (&chosen, lit, ui.visuals().dark_mode, Arc::as_ptr(&map) as usize).hash(&mut hasher);
        let accent = theme::accent(ui.visuals().dark_mode);
        self.shown.upload(ui, [u64::MAX - 1, hasher.finish()], || {
            let lit: Vec<Thing> = lit.into_iter().collect();
            picture(&map, [(&chosen, accent), (&lit, Color32::WHITE)])
        });
        self.shown.show(ui, area.intersect(place), place);
    }
}

/// What is outlined because it is chosen where that is seen: objects, else slots where there is more than one.
fn chosen(desk: &Desk<'_>) -> Vec<Thing> {
    let selection = &desk.shared.selection;
    if !selection.is_shown && !selection.was_shown {
        return Vec::new();
    }
    if !selection.objects.is_empty() {
        return selection.objects.iter().copied().map(Thing::Object).collect();
    }
    let count = desk.scene().map_or(0, |scene| scene.model.slots.len());
    let slots = selection.slots(desk.shared.slot);
    slots.into_iter().filter(|_| count > 1).map(Thing::Slot).collect()
}

/// The edges of some things in a colour each, over nothing.
fn picture(map: &SeenMap, kinds: [(&Vec<Thing>, Color32); 2]) -> ColorImage {
    let mut image = ColorImage::filled([map.width as usize, map.height as usize], Color32::TRANSPARENT);
    for (things, color) in kinds.into_iter().filter(|(things, _)| !things.is_empty()) {
        let is_chosen = |[object, slot]: [u32; 2]| {
            things.iter().any(|thing| match thing {
                Thing::Object(number) => object as usize == *number,
                Thing::Slot(number) => slot as usize == *number,
            })
        };
        let edges = map.edges(is_chosen);
        let pixels = image.pixels.iter_mut().zip(edges);
        pixels
            .filter(|(_, is_edge)| *is_edge)
            .for_each(|(pixel, _)| *pixel = color);
    }
    image
}
