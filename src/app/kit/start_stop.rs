//! A button that starts work beside the window and, while that is under way, one that stops it.

use egui::*;

#[derive(Default, PartialEq)]
pub enum Pressed {
    #[default]
    Nothing,
    Start,
    Stop,
}

/// Shows the button that starts, as it is dressed by `dress`, or the one that stops beside a spinner.
pub fn start_or_stop(
    ui: &mut Ui,
    label: &str,
    is_busy: bool,
    is_enabled: bool,
    dress: impl FnOnce(Response) -> Response,
) -> Pressed {
    if !is_busy {
        let is_clicked = dress(ui.add_enabled(is_enabled, Button::new(label))).clicked();
        return if is_clicked { Pressed::Start } else { Pressed::Nothing };
    }
    // Another control than the one that starts it: a click under way when it ends must not start it again.
    let stop = ui.push_id(("stop", label), |ui| ui.button("Stop")).inner;
    ui.add(Spinner::new().size(12.0));
    if stop.clicked() {
        Pressed::Stop
    } else {
        Pressed::Nothing
    }
}
