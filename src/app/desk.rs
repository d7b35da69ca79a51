//! What the parts of the window work on: the document, the renderer's state, a queue of actions, and what they share.

use std::path::PathBuf;

use egui::{Response, Ui};
use serde::{Deserialize, Serialize};

use crate::app::actions::{Action, Command};
use crate::app::kit::parameter_row;
use crate::app::kit::widgets::{self, Name, NumberStyle, RowResponse};
use crate::app::services::compare::Compare;
use crate::app::services::edits::Edits;
use crate::app::services::environments::Environments;
use crate::app::services::library::Library;
use crate::app::services::look::Look;
use crate::app::services::messages::Entry;
use crate::app::services::recent::Recent;
use crate::app::services::reference::ReferenceImage;
use crate::app::services::selection::Selection;
use crate::app::services::shelves::Shelves;
use crate::app::services::snapshots::Snapshots;
use crate::document::{Document, ImportLobe, MaterialSettings, PARAMETERS, Parameter, SETTINGS, setting};
use crate::render::queue::Queue;
use crate::render::shown::Shown;
use crate::render::worker::{Scene, Snapshot};
use crate::render::{EngineChoice, RayQueries};
use crate::scene::ModelSource;
use crate::scene::environment::EnvironmentSource;
use crate::scene::texture::TextureTarget;
use crate::study::references::ReferenceCache;

/// What panels work on.
pub(super) struct Desk<'a> {
    pub(super) document: &'a mut Document,
    pub(super) snapshot: &'a Snapshot,
    pub(super) edits: &'a mut Edits,
    pub(super) actions: &'a mut Vec<Action>,
    pub(super) shared: &'a mut Shared,
}

/// What the parts of the window share that is no part of the document: what is selected and shown, and the services.
pub(super) struct Shared {
    /// The material slot that is edited.
    pub(super) slot: usize,
    /// What is chosen beside it, and what is lit up.
    pub(super) selection: Selection,
    /// The slots that were selected of other models, for when undo or redo brings them back.
    pub(super) slots_of: Vec<(ModelSource, usize)>,
    /// What was said, oldest first.
    pub(super) messages: Vec<Entry>,
    /// Thumbnails of environments.
    pub(super) environments: Environments,
    /// The files opened and saved last.
    pub(super) recent: Recent,
    /// The lobe of the materials of models that are opened.
    pub(super) import_lobe: ImportLobe,
    /// The engine that was asked for, and the one that is remembered: the command line's is not.
    pub(super) engine: EngineChoice,
    pub(super) kept_engine: EngineChoice,
    /// Whether the GPU's engine uses ray queries, as it is remembered.
    pub(super) kept_ray_queries: RayQueries,
    /// How large the image is.
    pub(super) resolution: Resolution,
    /// What of the render the viewport shows.
    pub(super) shown: Shown,
    /// The pixel that is looked at closely.
    pub(super) look: Look,
    /// How many of the hints for new users are over.
    pub(super) hints_seen: usize,
    /// The window may offer to download what it lacks.
    pub(super) offers_downloads: bool,
    /// The angle between view and normal in the plots of lobes and their samples, degrees.
    pub(super) view_angle_deg: f32,
    /// The file of a measured material, to compare lobes with.
    pub(super) measured: Option<PathBuf>,
    /// What the next click in the viewport is for.
    pub(super) picks: Option<Pick>,
    /// What every screen shows is marked in the viewport.
    pub(super) shows_safe_frames: bool,
    /// Rendering was stopped by hand.
    pub(super) is_paused: bool,
    /// A study measures, for which the viewport's renderer rests.
    pub(super) is_measuring: bool,
    /// Converged images to measure against.
    pub(super) references: ReferenceCache,
    /// The materials to choose from.
    pub(super) library: Library,
    /// What the browser keeps, and the folders that it watches.
    pub(super) shelves: Shelves,
    /// The pinned states.
    pub(super) snapshots: Snapshots,
    /// The comparison of the document with something else.
    pub(super) compare: Compare,
    /// Renders that go on beside the window.
    pub(super) queue: Queue,
    /// What is shown beside the render.
    pub(super) reference: ReferenceImage,
}

/// What a click in the viewport can be for instead of choosing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pick {
    /// It says what is sharp.
    Focus,
    /// It says where the highlight of the area light with this number is seen.
    Highlight(usize),
}

/// The angle between view and normal at first, degrees.
pub(super) const VIEW_ANGLE_DEG: f32 = 45.0;

/// How large the image is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Resolution {
    /// It fills the viewport: with the screen's pixels on a hardware GPU, else with one a point.
    #[default]
    Auto,
    /// It fills the viewport with the screen's pixels.
    Native,
    /// It fills the viewport with half as many pixels each way.
    Half,
    /// Width and height as in the document, shown with its own shape.
    Document,
}

/// The sizes of the image to choose from: (value, label, help).
pub(super) const RESOLUTIONS: [(Resolution, &str, &str); 4] = [
    (
        Resolution::Auto,
        "Fill",
        "Fills the viewport: with the screen's pixels on a GPU, with fewer on the CPU.",
    ),
    (
        Resolution::Native,
        "Fill, native",
        "Fills the viewport with the screen's own pixels.",
    ),
    (
        Resolution::Half,
        "Fill, half",
        "Fills the viewport with half as many pixels each way.",
    ),
    (
        Resolution::Document,
        "Image size",
        "Width and height as set below, for any shape of the viewport.",
    ),
];

/// The group of the settings that only count where the viewport has the image's size.
pub(super) const PICTURE_SIZE: &str = "Image size";

impl Desk<'_> {
    pub(super) fn act(&mut self, command: Command) {
        self.actions.push(Action::Do(command));
    }

    /// A button that says what the next click in the viewport is for, until it is pressed again.
    pub(super) fn pick_toggle(&mut self, ui: &mut Ui, pick: Pick, text: &str, help: &str) -> Response {
        let is_on = self.shared.picks == Some(pick);
        let response = ui.add(egui::Button::new(text).selected(is_on)).on_hover_text(help);
        if response.clicked() {
            self.shared.picks = (!is_on).then_some(pick);
        }
        response
    }

    /// Asks for the images of the environments that a part of the window shows, and takes those that are there.
    pub(super) fn make_environment_pictures(
        &mut self,
        ctx: &egui::Context,
        shown_by: &'static str,
        shown: &[EnvironmentSource],
    ) {
        let scene = self.snapshot.scene.as_deref();
        let loaded = scene.map(|scene| (&scene.document.lighting.environment, &scene.job.environment));
        self.shared.environments.make_pictures(ctx, (shown_by, shown), loaded);
    }

    /// The scene being rendered, where it is of the document's model.
    pub(super) fn scene(&self) -> Option<&Scene> {
        self.snapshot
            .scene
            .as_deref()
            .filter(|scene| scene.document.model == self.document.model)
    }

    /// What an object of the model is called.
    pub(super) fn object_name(&self, object: usize) -> Option<String> {
        let own = self.document.object_names.get(&object).cloned();
        own.or_else(|| Some(self.scene()?.model.objects.get(object)?.name.clone()))
    }

    /// The material of the selected slot.
    pub(super) fn material(&self) -> MaterialSettings {
        self.document.material(self.shared.slot)
    }

    /// The slots of the model whose materials are as asked for.
    pub(super) fn slots_where(&self, is_wanted: impl Fn(&MaterialSettings) -> bool) -> Vec<usize> {
        let count = self.scene().map_or(0, |scene| scene.model.slots.len());
        (0..count)
            .filter(|slot| is_wanted(&self.document.material(*slot)))
            .collect()
    }

    /// Replaces the material of the selected slot; slots before it keep what they show. What is another in it becomes the
    /// same in the materials that are chosen beside it.
    pub(super) fn set_material(&mut self, material: MaterialSettings) {
        let before = self.material();
        for slot in self.shared.selection.slots(self.shared.slot).into_iter().skip(1) {
            let other = self.document.material_mut(slot);
            for parameter in PARAMETERS.iter() {
                let value = parameter.get(&material);
                if value != parameter.get(&before)
                    && let Err(error) = parameter.set(other, value)
                {
                    // A picker's colour may be out of range for a frame.
                    log::debug!("{error}");
                }
            }
            for &target in TextureTarget::ALL {
                let texture = material.user_textures.get(target);
                if texture != before.user_textures.get(target) {
                    other.user_textures.set(target, texture.cloned());
                }
            }
        }
        *self.document.material_mut(self.shared.slot) = material;
    }

    /// The rows of a group of settings, those that have an effect.
    pub(super) fn settings(&mut self, ui: &mut Ui, group: &str) {
        for setting in SETTINGS.iter().filter(|setting| setting.group == group) {
            widgets::comes_and_goes(ui, |ui| {
                if parameter_row::has_row(setting) && (setting.applies)(self.document) {
                    self.setting(ui, setting);
                }
            });
        }
    }

    /// The row of a setting.
    fn setting(&mut self, ui: &mut Ui, setting: &'static Parameter<Document>) {
        let mut value = setting.get(self.document);
        if parameter_row::show(ui, setting, &mut value) && setting.set(self.document, value).is_ok() {
            self.edits.note(setting.full_name(), setting.key);
        }
    }

    /// The control of the setting of this key without its row, under a name of its own; a double click resets it.
    pub(super) fn setting_control(&mut self, ui: &mut Ui, key: &str, name: &str) {
        let Some(setting) = setting(key) else { return };
        let mut value = setting.get(self.document);
        let response = parameter_row::control(ui, setting, name, &mut value);
        if response.double_clicked() {
            value = setting.default_value();
        }
        let is_other = response.changed() || response.double_clicked();
        if is_other && setting.set(self.document, value).is_ok() {
            self.edits.note(setting.full_name(), setting.key);
        }
        response.accessible_name(name).on_hover_text(setting.help);
    }

    /// Notes an edit of a setting, and resets it where that was asked for.
    pub(super) fn edited<T: PartialEq + Clone>(
        &mut self,
        response: RowResponse,
        label: &'static str,
        field: impl Fn(&mut Document) -> &mut T,
    ) {
        if response.reset {
            let default = field(&mut Document::default()).clone();
            *field(self.document) = default;
        }
        if response.changed || response.reset {
            self.edits.note(label, label);
        }
    }

    /// The row of the angle that the plots of lobes and their samples share.
    pub(super) fn view_angle_row(&mut self, ui: &mut Ui) {
        let style = NumberStyle::plain(0.0..=89.9, "°", 0.5, 1).with_bar([0.0, 89.9]);
        let name = Name {
            full: "Samples view angle",
            label: "View angle",
            symbol: "θ",
            help: "Between the view and the normal. A click in the viewport takes the angle of the place there.",
        };
        let angle = &mut self.shared.view_angle_deg;
        if widgets::row(ui, name, |ui| widgets::number(ui, angle, &style)).reset {
            self.shared.view_angle_deg = VIEW_ANGLE_DEG;
        }
    }

    /// What A and B are called.
    pub(super) fn compared_names(&self) -> [String; 2] {
        let material = self.material();
        let name = format!(
            "{}, {} R {:.3}",
            material.name,
            material.lobe.label(),
            material.roughness
        );
        [name, self.shared.compare.name(&material)]
    }
}
