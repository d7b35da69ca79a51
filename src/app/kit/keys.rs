//! Where keys go that are typed before anything has them: to a row that was asked for, to the search of a panel.

use egui::*;

/// A row that is to have the keys as soon as it is shown.
#[derive(Clone, Default)]
pub struct FocusRequest {
    pub group: &'static str,
    row: String,
    /// Its control, once it has been seen. It is given the keys before it is shown again: what is typed then replaces all
    /// of a number.
    control: Option<Id>,
    frame: u64,
    /// What was typed meanwhile.
    typed: Vec<Event>,
    /// The control was given the keys, and has selected what it shows.
    is_given: bool,
}

/// For how many frames a request stands: a panel that was brought to the front appears in the next one.
const REQUEST_FRAMES: u64 = 4;

/// Reads or changes the request.
fn request<R>(ctx: &Context, of: impl FnOnce(&mut Option<FocusRequest>) -> R) -> R {
    ctx.data_mut(|data| of(data.get_temp_mut_or_default(Id::unique("requested focus"))))
}

pub fn requested(ui: &Ui) -> Option<FocusRequest> {
    let frame = ui.ctx().cumulative_frame_nr();
    let requested = request(ui.ctx(), |requested| requested.clone());
    requested.filter(|requested| frame <= requested.frame + REQUEST_FRAMES)
}

/// Gives the row of this name (see [`Name::full`](super::widgets::Name::full)) the keys, and opens its group.
pub fn focus_row(ctx: &Context, group: &'static str, row: String) {
    let requested = FocusRequest {
        group,
        row,
        frame: ctx.cumulative_frame_nr(),
        ..FocusRequest::default()
    };
    request(ctx, |request| *request = Some(requested));
    ctx.request_repaint();
}

/// What is typed before the row has the keys waits for it: at the start of each frame it is removed from the input, and put
/// back once the row's number is selected, which it then replaces.
pub fn hold_typing(ctx: &Context) {
    let frame = ctx.cumulative_frame_nr();
    let Some(mut requested) = request(ctx, Option::take) else {
        return;
    };
    if requested.is_given || frame > requested.frame + REQUEST_FRAMES {
        ctx.input_mut(|input| input.events.splice(0..0, requested.typed).count());
        return;
    }
    let is_typed = |event: &mut Event| match event {
        Event::Text(_) => true,
        Event::Key { modifiers, .. } => !modifiers.command && !modifiers.alt,
        _ => false,
    };
    ctx.input_mut(|input| requested.typed.extend(input.events.extract_if(.., is_typed)));
    request(ctx, |request| *request = Some(requested));
    ctx.request_repaint();
}

/// Gives the row's control the keys where that was requested and it has been seen; true where it is still to be seen.
pub fn fulfil_request(ui: &Ui, row: &str) -> bool {
    let Some(requested) = requested(ui).filter(|requested| requested.row == row && !requested.is_given) else {
        return false;
    };
    let Some(control) = requested.control else { return true };
    request(ui.ctx(), |request| {
        request.iter_mut().for_each(|request| request.is_given = true)
    });
    ui.memory_mut(|memory| memory.request_focus(control));
    ui.ctx().request_repaint();
    log::debug!("the keys go to {row}");
    false
}

pub fn note_requested(ui: &Ui, control: &Response) {
    let id = Some(control.id);
    request(ui.ctx(), |request| {
        request.iter_mut().for_each(|request| request.control = id)
    });
    control.scroll_to_me(Some(Align::Center));
    ui.ctx().request_repaint();
}

fn search_id() -> Id {
    Id::unique("search under the pointer")
}

/// Keeps the arrow keys for a control that has the focus, across or up and down: else they would move the focus.
pub fn hold_arrows(ui: &Ui, response: &Response, horizontal_arrows: bool, vertical_arrows: bool) {
    let filter = EventFilter {
        horizontal_arrows,
        vertical_arrows,
        ..Default::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
}

/// A field to search a panel with. Letters that are typed while the pointer is over the panel and nothing has the keys
/// are meant for it, see [`take_search`].
pub fn search_field(ui: &mut Ui, text: &mut String, hint: &str, name: &str) -> Response {
    let field = TextEdit::singleline(text)
        .hint_text(hint)
        .desired_width(f32::INFINITY)
        .margin(Vec2::new(6.0, 4.0));
    let response = ui.add(field).accessible_name(name);
    if ui.rect_contains_pointer(ui.clip_rect()) {
        let meant = (response.id, ui.ctx().cumulative_frame_nr());
        ui.data_mut(|data| data.insert_temp(search_id(), meant));
    }
    response
}

/// Gives the search field of the panel under the pointer the keys where a word is begun; true where that was done.
pub fn take_search(ctx: &Context) -> bool {
    let meant: Option<(Id, u64)> = ctx.data(|data| data.get_temp(search_id()));
    let is_word = |event: &Event| matches!(event, Event::Text(text) if !text.trim().is_empty());
    let Some((field, frame)) = meant.filter(|_| ctx.input(|input| input.events.iter().any(is_word))) else {
        return false;
    };
    // Of the frame before this one: the panel may be gone by now.
    let is_there = frame + 1 >= ctx.cumulative_frame_nr();
    if is_there {
        ctx.memory_mut(|memory| memory.request_focus(field));
    }
    is_there
}
