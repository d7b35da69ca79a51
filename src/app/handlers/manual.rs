//! What the manual opens at.

use egui::{Context, Order, Pos2};

use crate::app::App;
use crate::app::book::{CONTENTS, EXPLAIN, EXPORT, KEYS, MODEL_FILE, TURNTABLE, UNSAVED};
use crate::app::layout::{self, Pane};
use crate::app::sheets::menu::Sheet;

impl App {
    /// The address in the book of what the user is at: the sheet that is open, the panel of the focused control, or the
    /// panel under the pointer.
    pub fn topic(&self, ctx: &Context) -> &'static str {
        let is_asked = self.unsaved.is_open() || !self.leftovers.is_empty();
        let is_searching = matches!(self.sheet, Sheet::Palette { .. } | Sheet::Shortcuts);
        let sheets = [
            (self.sheet == Sheet::ModelFile, MODEL_FILE),
            (matches!(self.sheet, Sheet::Path { .. }), EXPLAIN),
            (is_searching || self.dialogs.is_open(), KEYS),
            (self.export.is_open(), EXPORT),
            (self.turntable.is_open, TURNTABLE),
            (is_asked, UNSAVED),
        ];
        let open = sheets.into_iter().find(|(is_open, _)| *is_open);
        let pane = || layout::pane_at(&self.layout, self.looked_at(ctx)?);
        open.map_or_else(|| pane().map_or(CONTENTS, Pane::manual), |(_, address)| address)
    }

    /// The middle of the focused control, else the pointer; `None` over menus, which are no part of the panels below.
    fn looked_at(&self, ctx: &Context) -> Option<Pos2> {
        let focused = ctx.memory(|memory| memory.focused());
        let control = focused.filter(|id| Some(*id) != self.viewport.id());
        let control = control.and_then(|id| Some(ctx.read_response(id)?.rect.center()));
        let at = control.or(ctx.pointer_latest_pos())?;
        let is_panel = ctx.layer_id_at(at).is_none_or(|layer| layer.order == Order::Background);
        is_panel.then_some(at)
    }
}
