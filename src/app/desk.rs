//! What the parts of the window work on: the document, the renderer's state, a queue of actions, and what they share.

use std::path::{Path, PathBuf};

use egui::{Response, Ui};

use crate::{
    actions::Action,
    actions::Command,
    document::{Document, ImportLobe, MaterialSettings, PARAMETERS, Parameter, SETTINGS, setting},
    kit::{icons, icons::Icon, parameter_row, widgets, widgets::Name, widgets::NumberStyle},
    render::{queue::Queue, worker::Scene, worker::Snapshot},
    scene::{
        environment::{BUILT_IN, BuiltIn, EnvironmentSource},
        path_text::file_name,
        texture::TextureTarget,
    },
    services::{
        compare::Compare,
        edits::Edits,
        library::Library,
        library::Snapshots,
        look::Look,
        messages::LogEntry,
        pictures::Pictures,
        recent::Recent,
        reference::ReferenceImage,
        selection::Selection,
        selection::Thing,
        shelves::Shelves,
        viewing::{Pick, Rendering, Viewing},
    },
};

/// What panels work on.
pub struct Desk<'a> {
    pub document: &'a mut Document,
    pub snapshot: &'a Snapshot,
    pub edits: &'a mut Edits,
    pub actions: &'a mut Vec<Action>,
    pub shared: &'a mut Shared,
}

/// What the parts of the window share that is no part of the document: what is selected and shown, and the services.
pub struct Shared {
    /// What is edited, chosen and lit up.
    pub selection: Selection,
    /// What was said, oldest first.
    pub messages: Vec<LogEntry>,
    /// Thumbnails of materials and environments.
    pub pictures: Pictures,
    /// The files opened and saved last.
    pub recent: Recent,
    /// The lobe of the materials of models that are opened.
    pub import_lobe: ImportLobe,
    /// The engine, and when it rests.
    pub rendering: Rendering,
    /// How the viewport shows the render.
    pub viewing: Viewing,
    /// The pixel that is looked at closely.
    pub look: Look,
    /// The window may offer to download what it lacks.
    pub offers_downloads: bool,
    /// The angle between view and normal in plots of lobes and of their samples, degrees.
    pub view_angle_deg: f32,
    /// The file of a measured material, to compare lobes with.
    pub measured: Option<PathBuf>,
    /// The materials to choose from.
    pub library: Library,
    /// What the browser keeps, and the folders that it watches.
    pub shelves: Shelves,
    pub snapshots: Snapshots,
    /// The comparison of the document with something else.
    pub compare: Compare,
    /// Renders that go on beside the window.
    pub queue: Queue,
    /// What is shown beside the render.
    pub reference: ReferenceImage,
}

/// The environments that are chosen for their light: the palette alone finds the furnace, which tests energy.
pub fn lights() -> impl Iterator<Item = &'static BuiltIn> {
    BUILT_IN
        .iter()
        .filter(|built_in| built_in.source != EnvironmentSource::Furnace)
}

/// The angle in plots of lobes at first, degrees.
pub const VIEW_ANGLE_DEG: f32 = 45.0;
/// The group of the settings that only count where the viewport has the image's size.
pub const PICTURE_SIZE: &str = "Image size";

impl Desk<'_> {
    pub fn act(&mut self, command: Command) {
        self.actions.push(Action::Do(command));
    }

    pub fn button(&mut self, ui: &mut Ui, command: Command) {
        if widgets::pressed(ui, command.label(), command.help()) {
            self.act(command);
        }
    }

    /// The row of a file: its name with a button that takes it away, whether that was pressed; else a button to choose one.
    pub fn file_row(
        &mut self,
        ui: &mut Ui,
        name: [&str; 3],
        file: Option<&Path>,
        choose: Action,
        (remove, help): (&str, &str),
    ) -> bool {
        let mut is_removed = false;
        widgets::row(ui, name, |ui| {
            let Some(file) = file else {
                let button = ui.button("Choose…");
                if button.clicked() {
                    self.actions.push(choose);
                }
                return button;
            };
            is_removed = icons::button(ui, Icon::Close, remove, help).clicked();
            ui.add(egui::Label::new(file_name(file)).truncate())
                .on_hover_text(file.display().to_string())
        });
        is_removed
    }

    /// A button that says what the next click in the viewport is for, until it is pressed again.
    pub fn pick_toggle(&mut self, ui: &mut Ui, pick: Pick, text: &str, help: &str) -> Response {
        let is_on = self.shared.viewing.picks == Some(pick);
        let response = ui.add(egui::Button::new(text).selected(is_on)).on_hover_text(help);
        if response.clicked() {
            self.shared.viewing.picks = (!is_on).then_some(pick);
        }
        response
    }

    /// The environments to choose from: those that come with the program, and so many files, the one in use and those opened
    /// last.
    pub fn environments(&self, files_max: usize) -> Vec<EnvironmentSource> {
        let current = std::iter::once(self.document.lighting.environment.clone());
        let mut sources: Vec<_> = lights().map(|built_in| built_in.source.clone()).collect();
        let shipped = sources.len();
        for source in current.chain(self.shared.recent.environments()) {
            if !sources.contains(&source) && sources.len() < shipped + files_max {
                sources.push(source);
            }
        }
        sources
    }

    /// The scene being rendered, where it is of the document's model.
    pub fn scene(&self) -> Option<&Scene> {
        self.snapshot
            .scene
            .as_deref()
            .filter(|scene| scene.document.model == self.document.model)
    }

    /// What an object of the model is called.
    pub fn object_name(&self, object: usize) -> Option<String> {
        let own = self.document.object_names.get(&object).cloned();
        own.or_else(|| Some(self.scene()?.model.objects.get(object)?.name.clone()))
    }

    /// The material of the selected slot.
    pub fn material(&self) -> MaterialSettings {
        self.document.material(self.shared.selection.slot)
    }

    /// Gives a slot a material that was dropped on it.
    pub fn drop_on(&mut self, slot: usize, material: &MaterialSettings) {
        let material = Box::new(material.clone());
        self.actions
            .extend([Action::SelectSlot(slot), Action::UseMaterial(material)]);
    }

    /// Lights up in the viewport what a line under the pointer stands for, and a line what the pointer is over there.
    pub fn light_up(&mut self, ui: &Ui, response: &Response, thing: Thing) {
        if response.hovered() {
            self.shared.selection.hovered = Some(thing);
        } else if self.shared.selection.lit == Some(thing) {
            widgets::frame(ui, response.rect);
        }
    }

    /// The slots of the model whose materials are as asked for.
    pub fn slots_where(&self, is_wanted: impl Fn(&MaterialSettings) -> bool) -> Vec<usize> {
        let count = self.scene().map_or(0, |scene| scene.model.slots.len());
        (0..count)
            .filter(|slot| is_wanted(&self.document.material(*slot)))
            .collect()
    }

    /// Replaces the material of the selected slot; slots before it keep what they show. What is another in it becomes the
    /// same in the materials that are chosen beside it.
    pub fn set_material(&mut self, material: MaterialSettings) {
        let before = self.material();
        for slot in self.shared.selection.slots().into_iter().skip(1) {
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
        *self.document.material_mut(self.shared.selection.slot) = material;
    }

    /// The rows of a group of settings; those that have no effect are grey, so that none moves under the pointer.
    pub fn settings(&mut self, ui: &mut Ui, group: &str) {
        let is_shown = |setting: &&Parameter<Document>| setting.group == group && parameter_row::has_row(setting);
        for setting in SETTINGS.iter().filter(is_shown) {
            let applies = (setting.applies)(self.document);
            ui.add_enabled_ui(applies, |ui| self.setting(ui, setting));
        }
    }

    /// The row of a setting.
    fn setting(&mut self, ui: &mut Ui, setting: &'static Parameter<Document>) {
        let full = setting.full_name();
        if parameter_row::edit(ui, setting, &full, self.document, None) {
            self.edits.note(full, setting.key);
        }
    }

    /// The control of the setting of this key without its row, under a name of its own; a double click resets it.
    pub fn setting_control(&mut self, ui: &mut Ui, key: &str, name: &str) {
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

    /// The row of a part of the document; edits are noted under its name.
    pub fn row<T: Clone>(
        &mut self,
        ui: &mut Ui,
        name: [&'static str; 3],
        field: fn(&mut Document) -> &mut T,
        control: impl FnOnce(&mut Ui, &mut T) -> Response,
    ) {
        let default = field(&mut Document::default()).clone();
        if widgets::value_row(ui, name, field(self.document), default, control) {
            self.edits.note(name[0], name[0]);
        }
    }

    /// The row of the angle that the plots of lobes and their samples share.
    pub fn view_angle_row(&mut self, ui: &mut Ui) {
        let style = NumberStyle::plain(0.0..=89.9, "°", 0.5, 1).with_bar([0.0, 89.9]);
        let name = Name {
            full: "Samples view angle",
            label: "View angle",
            symbol: "θ",
            help: "Between the view and the normal.",
        };
        let angle = &mut self.shared.view_angle_deg;
        widgets::value_row(ui, name, angle, VIEW_ANGLE_DEG, |ui, angle| {
            widgets::number(ui, angle, &style)
        });
        let help = "The next click in the viewport takes the angle of the place there.";
        self.pick_toggle(ui, Pick::Angle, "Pick angle", help);
    }

    /// What A and B are called.
    pub fn compared_names(&self) -> [String; 2] {
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
