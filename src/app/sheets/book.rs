//! The manual: pages of the [`book`](crate::book) in a window beside the panels, so that one can follow a tutorial.

use egui_commonmark::{CommonMarkCache, CommonMarkViewer};

use super::*;
use crate::book::{self, CONTENTS, Pages, SCHEME, Section};

/// Size of the window at first, points.
const SIZE: [f32; 2] = [480.0, 560.0];
/// Where the panels on the right begin, a share of the window's width: it opens beside them.
const BEFORE_PANELS: f32 = 0.74;
/// For how many frames a heading is brought into view: texts above it are laid out in the first.
const SCROLL_FRAMES: u32 = 3;

fn asked_id() -> Id {
    Id::unique("asked page of the manual")
}

/// Opens the manual at an address in this frame.
pub fn ask(ctx: &Context, address: &'static str) {
    ctx.data_mut(|data| data.insert_temp(asked_id(), address));
}

/// A button that opens the manual at an address.
pub fn help_button(ui: &mut Ui, about: &str, address: &'static str) {
    let button = ui.add(Button::new("?").frame(false));
    let button = button.accessible_name(format!("Manual: {about}"));
    if button.on_hover_text("Opens the manual at this page (F1).").clicked() {
        ask(ui.ctx(), address);
    }
}

/// The heading of a sheet, with the button behind it.
pub fn heading(ui: &mut Ui, title: &str, address: &'static str) {
    ui.horizontal(|ui| {
        ui.heading(title);
        help_button(ui, title, address);
    });
}

/// The window.
#[derive(Default)]
pub struct Manual {
    pages: Pages,
    /// Addresses that were opened, the shown one last; empty if it is closed.
    addresses: Vec<String>,
    sections: Vec<Section>,
    cache: CommonMarkCache,
    /// Frames that are left to bring the anchor into view.
    scrolls: u32,
}

impl Manual {
    pub fn new(pages: Pages) -> Self {
        Self {
            pages,
            ..Self::default()
        }
    }

    fn open(&mut self, address: String) {
        let (page, _) = book::parts(&address);
        self.sections = book::sections(self.pages, page);
        self.cache = CommonMarkCache::default();
        let links = self
            .sections
            .iter()
            .flat_map(|section| section.text.split("](").skip(1));
        for link in links {
            let target = link.split(')').next().unwrap_or_default();
            if target.starts_with(SCHEME) {
                self.cache.add_link_hook(target);
            }
        }
        self.scrolls = SCROLL_FRAMES;
        self.addresses.push(address);
    }

    /// Shows it where it is open, over the sheets if one covers the window.
    pub fn show(&mut self, ctx: &Context, is_covered: bool) {
        if let Some(address) = ctx.data_mut(|data| data.remove_temp::<&'static str>(asked_id())) {
            self.open(address.to_owned());
        }
        let Some(address) = self.addresses.last().cloned() else {
            return;
        };
        let mut is_open = true;
        let area = ctx.content_rect();
        let shown = Window::new("Manual")
            .open(&mut is_open)
            .order(if is_covered { Order::Tooltip } else { Order::Middle })
            .default_size(SIZE)
            .default_pos(pos2(
                area.left() + BEFORE_PANELS * area.width() - SIZE[0],
                area.top() + 64.0,
            ))
            .show(ctx, |ui| self.page(ui, &address));
        if let Some(address) = shown.and_then(|shown| shown.inner.flatten()) {
            self.open(address);
        }
        let is_left = !is_covered && ctx.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape));
        if !is_open || is_left {
            self.addresses.clear();
        }
    }

    /// The page; the address that was chosen on it.
    fn page(&mut self, ui: &mut Ui, address: &str) -> Option<String> {
        let mut next = None;
        ui.horizontal(|ui| {
            if ui.button("Contents").clicked() {
                next = Some(CONTENTS.to_owned());
            }
            let has_before = self.addresses.len() > 1;
            if widgets::pressed_if(ui, has_before, "Back", "Goes to the page before.", "") {
                self.addresses.pop();
                next = self.addresses.pop();
            }
        });
        ui.separator();
        let (page, anchor) = book::parts(address);
        let scrolls = self.scrolls > 0;
        self.scrolls = self.scrolls.saturating_sub(1);
        ScrollArea::vertical()
            .id_salt((page, self.addresses.len()))
            .auto_shrink(false)
            .show(ui, |ui| {
                for (number, section) in self.sections.iter().enumerate() {
                    ui.push_id(number, |ui| {
                        let size = [20.0, 16.0, 14.0][(section.level - 1).min(2)];
                        let heading = ui.label(RichText::new(&section.heading).heading().size(size));
                        if scrolls && !anchor.is_empty() && section.anchor == anchor {
                            heading.scroll_to_me(Some(Align::TOP));
                            ui.ctx().request_repaint();
                        }
                        CommonMarkViewer::new().show(ui, &mut self.cache, &section.text);
                        let clicked = self.cache.link_hooks().iter().find(|(_, is_clicked)| **is_clicked);
                        if let Some((link, _)) = clicked {
                            next = Some(link.trim_start_matches(SCHEME).to_owned());
                        }
                        ui.add_space(theme::GAP);
                    });
                }
            });
        next
    }
}
