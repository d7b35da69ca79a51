//! Environment, area lights, background and ground.

use std::sync::Arc;

use egui::{ColorImage, TextureHandle, TextureOptions, Ui, vec2};

use super::{Desk, area_lights};
use crate::app::actions::{Action, Command};
use crate::app::theme;
use crate::app::widgets::{self, Name, NumberStyle};
use crate::document::{Background, range};
use crate::scene::environment::{Environment, EnvironmentSource, thumbnail};

/// Size of the environment's small picture.
const THUMBNAIL: [u32; 2] = [256, 128];

/// The small picture of an environment.
#[derive(Clone, Default)]
pub(in crate::app) struct Thumbnail {
    of: Option<Arc<Environment>>,
    texture: Option<TextureHandle>,
}

impl std::fmt::Debug for Thumbnail {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "Thumbnail({:?})",
            self.of.as_ref().map(|environment| &environment.name)
        )
    }
}

impl Thumbnail {
    fn texture(&mut self, ctx: &egui::Context, environment: &Arc<Environment>) -> TextureHandle {
        let is_same = self.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, environment));
        if let Some(texture) = self.texture.as_ref().filter(|_| is_same) {
            return texture.clone();
        }
        let [width, height] = THUMBNAIL;
        let pixels = thumbnail(environment, width, height).concat();
        let image = ColorImage::from_rgba_premultiplied(THUMBNAIL.map(|n| n as usize), &pixels);
        let texture = ctx.load_texture("environment", image, TextureOptions::LINEAR);
        (self.of, self.texture) = (Some(environment.clone()), Some(texture.clone()));
        texture
    }
}

/// The environments that come with the program.
pub(in crate::app) const BUILT_IN: [(&str, &str, EnvironmentSource); 3] = [
    ("Studio", "Soft boxes in a dark room.", EnvironmentSource::Studio),
    ("Sky", "A clear sky with its sun.", EnvironmentSource::Sky),
    (
        "Furnace",
        "White light from everywhere: a material that keeps all light vanishes.",
        EnvironmentSource::Furnace,
    ),
];

/// What to call an environment in a menu.
pub(in crate::app) fn environment_label(source: &EnvironmentSource) -> String {
    let built_in = BUILT_IN.iter().find(|(.., of)| of == source);
    match (built_in, source) {
        (Some((label, ..)), _) => (*label).to_owned(),
        (None, EnvironmentSource::File(path)) => path.file_name().map_or_else(
            || path.display().to_string(),
            |name| name.to_string_lossy().into_owned(),
        ),
        (None, other) => other.to_string(),
    }
}

pub(in crate::app) fn show(ui: &mut Ui, desk: &mut Desk<'_>) {
    widgets::group(ui, "Environment", |ui| {
        if let Some(scene) = desk.snapshot.scene.clone() {
            let texture = desk.state.thumbnail.texture(ui.ctx(), &scene.job.environment);
            let width = ui.available_width();
            let image = egui::Image::new(&texture)
                .fit_to_exact_size(vec2(width, 0.5 * width))
                .corner_radius(3.0);
            let name = &scene.job.environment.name;
            let size = [scene.job.environment.width, scene.job.environment.height];
            ui.add(image.alt_text("The environment"))
                .on_hover_text(format!("{name}, {} × {}", size[0], size[1]));
        }
        sources(ui, desk);
        numbers(ui, desk);
    });
    widgets::group(ui, "Area lights", |ui| area_lights::show(ui, desk));
    widgets::group(ui, "Background", |ui| background(ui, desk));
    widgets::group(ui, "Ground", |ui| {
        let name = Name::new(
            "Ground",
            "Ground plane",
            "A matt plane under the model that catches its shadow.",
        );
        let response = widgets::row(ui, name, |ui| ui.checkbox(&mut desk.document.ground, ""));
        desk.edited(response, "Ground", |document| &mut document.ground);
        if desk.document.ground {
            let name = Name::new("Ground colour", "Colour", "Share of light that the ground gives back.");
            let color = &mut desk.document.lighting.ground_color;
            let response = widgets::row(ui, name, |ui| widgets::color(ui, "Ground colour", color));
            desk.edited(response, "Ground colour", |document| {
                &mut document.lighting.ground_color
            });
        }
    });
}

fn sources(ui: &mut Ui, desk: &mut Desk<'_>) {
    let current = desk.document.lighting.environment.clone();
    ui.horizontal_wrapped(|ui| {
        for (label, help, source) in &BUILT_IN {
            let item = ui.selectable_label(current == *source, *label).on_hover_text(*help);
            if item.clicked() && current != *source {
                desk.actions.push(Action::UseEnvironment(source.clone()));
            }
        }
        let is_file = matches!(current, EnvironmentSource::File(_));
        if ui
            .selectable_label(is_file, "File…")
            .on_hover_text(Command::OpenEnvironment.help())
            .clicked()
        {
            desk.act(Command::OpenEnvironment);
        }
    });
    if let EnvironmentSource::File(path) = &current {
        let name = environment_label(&current);
        ui.add(egui::Label::new(name).truncate())
            .on_hover_text(path.display().to_string());
    }
    ui.add_space(0.5 * theme::GAP);
}

fn numbers(ui: &mut Ui, desk: &mut Desk<'_>) {
    let lighting = &mut desk.document.lighting;
    let style = NumberStyle {
        range: -3600.0..=3600.0,
        bar: Some([-180.0, 180.0]),
        unit: "°",
        speed: 1.0,
        decimals: 1,
    };
    let name = Name::new(
        "Environment rotation",
        "Rotation",
        "Turns the light about the vertical axis. In the viewport: drag with shift.",
    );
    let response = widgets::row(ui, name, |ui| widgets::number(ui, &mut lighting.rotation_deg, &style));
    desk.edited(response, "Environment rotation", |document| {
        &mut document.lighting.rotation_deg
    });
    let style = NumberStyle {
        range: 0.0..=1e6,
        bar: Some([0.0, 4.0]),
        unit: "",
        speed: 0.01,
        decimals: 3,
    };
    let name = Name::new(
        "Environment strength",
        "Strength",
        "Multiplies the environment's light.",
    );
    let strength = &mut desk.document.lighting.strength;
    let response = widgets::row(ui, name, |ui| widgets::number(ui, strength, &style));
    desk.edited(response, "Environment strength", |document| {
        &mut document.lighting.strength
    });
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
            "Nothing: the picture's opacity is 0 there.",
        ),
        (
            Kind::Color,
            "Colour",
            "One colour, whatever the light; reflections still show the environment.",
        ),
    ];
    let mut kind = match desk.document.lighting.background {
        Background::Environment => Kind::Environment,
        Background::Transparent => Kind::Transparent,
        Background::Color(_) => Kind::Color,
    };
    let name = Name::new("Background", "Shows", "What is seen beside the model.");
    let response = widgets::row(ui, name, |ui| widgets::choice(ui, "background", &mut kind, &choices));
    if response.changed {
        desk.document.lighting.background = match kind {
            Kind::Environment => Background::Environment,
            Kind::Transparent => Background::Transparent,
            Kind::Color => Background::Color([0.18; 3]),
        };
    }
    desk.edited(response, "Background", |document| &mut document.lighting.background);
    if desk.document.lighting.background == Background::Environment {
        let style = NumberStyle {
            range: range::BACKGROUND_BLUR_DEG,
            bar: Some([0.0, 45.0]),
            unit: "°",
            speed: 0.5,
            decimals: 1,
        };
        let blur = &mut desk.document.lighting.background_blur_deg;
        let name = Name::new(
            "Background blur",
            "Blur",
            "Averages the environment over this angle where it is seen; light and reflections stay sharp.",
        );
        let response = widgets::row(ui, name, |ui| widgets::number(ui, blur, &style));
        desk.edited(response, "Background blur", |document| {
            &mut document.lighting.background_blur_deg
        });
    }
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
