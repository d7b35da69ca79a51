//! Environment, area lights, background and ground.

mod area_lights;
mod groups;
mod preview;

use self::preview::Preview;
use super::*;
use crate::{
    document::{Background, GroundKind},
    kit::tile::Tile,
    render::thumbnails::Subject,
    scene::environment::EnvironmentSource,
    services::pictures::Part,
    services::shelves::{environment_key, environment_label},
};

/// Most files in the list.
const FILES_MAX: usize = 6;

/// Environment, area lights, background and ground.
#[derive(Default)]
pub struct LightingPanel {
    preview: Preview,
}

impl Panel for LightingPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk) {
        widgets::group(ui, "Environment", |ui| {
            widgets::comes_and_goes(ui, |ui| self.preview.show(ui, desk));
            sources(ui, desk);
            desk.settings(ui, "Environment");
        });
        widgets::group(ui, "Area lights", |ui| area_lights::show(ui, desk));
        widgets::group(ui, "Light groups", |ui| groups::show(ui, desk));
        widgets::group(ui, "Background", |ui| background(ui, desk));
        widgets::group(ui, "Ground", |ui| ground(ui, desk));
    }
}

fn ground(ui: &mut Ui, desk: &mut Desk) {
    desk.settings(ui, "Ground");
    let has_wall = desk.document.ground && desk.document.lighting.ground.kind == GroundKind::Cyclorama;
    let help = "The camera looks straight at the wall.";
    if widgets::pressed_if(ui, has_wall, "Turn the wall away from the camera", help, "") {
        desk.document.lighting.ground.yaw_deg = desk.document.camera.yaw_deg;
        desk.edits.did("Cyclorama turned");
    }
}

/// All there are to choose from: those that come with the program, and files, the one in use and those opened last.
fn sources(ui: &mut Ui, desk: &mut Desk) {
    let sources = desk.environments(FILES_MAX);
    let subject = |source: &EnvironmentSource| (environment_key(source), Subject::Environment(source.clone()));
    desk.shared.pictures.want(Part::Light, sources.iter().map(subject));
    ui.add_space(2.0);
    widgets::comes_and_goes(ui, |ui| rows(ui, desk, &sources));
    ui.add_space(2.0);
    if widgets::pressed(ui, "Open a file…", Command::Open.help()) {
        desk.act(Command::Open);
    }
    ui.add_space(0.5 * theme::GAP);
}

fn rows(ui: &mut Ui, desk: &mut Desk, sources: &[EnvironmentSource]) {
    let current = desk.document.lighting.environment.clone();
    for source in sources {
        let is_current = *source == current;
        let (pictures, key) = (&desk.shared.pictures, environment_key(source));
        let label = environment_label(source);
        let row = Tile {
            name: &label,
            full_name: &label,
            picture: pictures.texture(&key),
            size: vec2(48.0, 24.0),
            color: ui.visuals().extreme_bg_color,
            is_current,
        };
        let help = match source {
            EnvironmentSource::File(path) if pictures.is_missing(&key) => {
                format!("{}: not there any more, or not to be read", path.display())
            }
            EnvironmentSource::File(path) => path.display().to_string(),
            other => other.built_in().map_or("", |built_in| built_in.help).to_owned(),
        };
        if row.row(ui).on_hover_text(help).clicked() && !is_current {
            desk.actions.push(Action::UseEnvironment(source.clone()));
        }
    }
}

fn background(ui: &mut Ui, desk: &mut Desk) {
    // What it begins with; else it is the one there is.
    let mut of_color = Background::Color([0.18; 3]);
    if let Background::Color(_) = desk.document.lighting.background {
        of_color = desk.document.lighting.background;
    }
    #[rustfmt::skip]
    let choices = [
        (Background::Environment, "Environment", "The environment itself."),
        (Background::Transparent, "Transparent", "Nothing: the image's opacity is 0 there."),
        (of_color, "Colour", "One colour, in any light; reflections still show the environment."),
    ];
    desk.row(
        ui,
        ["Background", "Background", "What is seen beside the model."],
        |document| &mut document.lighting.background,
        |ui, background| widgets::choice(ui, "background", background, &choices),
    );
    desk.settings(ui, "Background");
    if let Background::Color(color) = &mut desk.document.lighting.background {
        let full = "Background colour";
        let name = [full, "Colour", "Linear: exposure and tone map apply to it, too."];
        if widgets::value_row(ui, name, color, [0.18; 3], |ui, color| widgets::color(ui, full, color)) {
            desk.edits.note(full, full);
        }
    }
}
