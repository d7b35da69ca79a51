//! Environment, area lights, background and ground.

mod area_lights;
mod groups;
mod preview;

use egui::{Ui, vec2};

use self::preview::Preview;
use super::Panel;
use crate::app::actions::{Action, Command};
use crate::app::desk::Desk;
use crate::app::kit::theme;
use crate::app::kit::widgets::{self, Name, PictureRow};
use crate::app::services::environments::environment_label;
use crate::document::{Background, GroundKind};
use crate::scene::environment::{BUILT_IN, EnvironmentSource};

/// Size of an environment's image in the list, points.
const PICTURE: egui::Vec2 = vec2(48.0, 24.0);
/// Most files in the list.
const FILES_MAX: usize = 6;

/// Environment, area lights, background and ground.
#[derive(Default)]
pub struct LightingPanel {
    preview: Preview,
}

impl Panel for LightingPanel {
    fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
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

fn ground(ui: &mut Ui, desk: &mut Desk<'_>) {
    desk.settings(ui, "Ground");
    if !desk.document.ground || desk.document.lighting.ground.kind != GroundKind::Cyclorama {
        return;
    }
    if widgets::pressed(
        ui,
        "Turn the wall away from the camera",
        "The camera looks straight at the wall.",
    ) {
        desk.document.lighting.ground.yaw_deg = desk.document.camera.yaw_deg;
        desk.edits.note("Cyclorama turned", "");
    }
}

/// All there are to choose from: those that come with the program, and files, the one in use and those opened last.
fn sources(ui: &mut Ui, desk: &mut Desk<'_>) {
    let current = desk.document.lighting.environment.clone();
    let mut sources: Vec<EnvironmentSource> = BUILT_IN.iter().map(|built_in| built_in.source.clone()).collect();
    for source in std::iter::once(current).chain(desk.shared.recent.environments()) {
        if !sources.contains(&source) && sources.len() < BUILT_IN.len() + FILES_MAX {
            sources.push(source);
        }
    }
    desk.make_environment_pictures(ui.ctx(), "light", &sources);
    ui.add_space(2.0);
    widgets::comes_and_goes(ui, |ui| rows(ui, desk, &sources));
    ui.add_space(2.0);
    if widgets::pressed(ui, "Open a file…", Command::OpenEnvironment.help()) {
        desk.act(Command::OpenEnvironment);
    }
    ui.add_space(0.5 * theme::GAP);
}

fn rows(ui: &mut Ui, desk: &mut Desk<'_>, sources: &[EnvironmentSource]) {
    let current = desk.document.lighting.environment.clone();
    for source in sources {
        let is_current = *source == current;
        let environments = &desk.shared.environments;
        let row = PictureRow {
            name: &environment_label(source),
            full_name: &environment_label(source),
            picture: environments.picture(source),
            size: PICTURE,
            color: ui.visuals().extreme_bg_color,
            is_current,
        };
        let help = match source {
            EnvironmentSource::File(path) if environments.is_missing(source) => {
                format!("{}: not there any more, or not to be read", path.display())
            }
            EnvironmentSource::File(path) => path.display().to_string(),
            other => other.built_in().map_or("", |built_in| built_in.help).to_owned(),
        };
        if row.show(ui).on_hover_text(help).clicked() && !is_current {
            desk.actions.push(Action::UseEnvironment(source.clone()));
        }
    }
}

fn background(ui: &mut Ui, desk: &mut Desk<'_>) {
    #[derive(Clone, Copy, PartialEq)]
    enum Kind {
        Environment,
        Transparent,
        Color,
    }
    let choices = [
        (Kind::Environment, "Environment", "The environment itself."),
        (
            Kind::Transparent,
            "Transparent",
            "Nothing: the image's opacity is 0 there.",
        ),
        (
            Kind::Color,
            "Colour",
            "One colour, in any light; reflections still show the environment.",
        ),
    ];
    let mut kind = match desk.document.lighting.background {
        Background::Environment => Kind::Environment,
        Background::Transparent => Kind::Transparent,
        Background::Color(_) => Kind::Color,
    };
    let name = Name::new("Background", "Background", "What is seen beside the model.");
    let response = widgets::row(ui, name, |ui| widgets::choice(ui, "background", &mut kind, &choices));
    if response.changed {
        desk.document.lighting.background = match kind {
            Kind::Environment => Background::Environment,
            Kind::Transparent => Background::Transparent,
            Kind::Color => Background::Color([0.18; 3]),
        };
    }
    desk.edited(response, "Background", |document| &mut document.lighting.background);
    desk.settings(ui, "Background");
    if let Background::Color(color) = &mut desk.document.lighting.background {
        let name = Name::new(
            "Background colour",
            "Colour",
            "Linear: exposure and tone map apply to it, too.",
        );
        let response = widgets::row(ui, name, |ui| widgets::color(ui, "Background colour", color));
        if response.reset {
            *color = [0.18; 3];
        }
        if response.changed || response.reset {
            desk.edits.note("Background colour", "Background colour");
        }
    }
}
