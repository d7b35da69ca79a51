//! What actions and commands do, and what the palette finds beside them.

use std::time::Instant;

use crate::{
    App,
    actions::{Action, Command},
    desk::PICTURE_SIZE,
    document::{CameraSettings, Denoise, Document, History, MaterialSettings, PARAMETERS, parameter, setting},
    handlers::pictures::Destination,
    is_dragging,
    kit::keys,
    layout,
    layout::Pane,
    scene::{
        ModelOptions,
        camera::{Projection, framing_distance},
        environment::{BUILT_IN, EnvironmentSource},
        path_text::file_name,
    },
    services::{
        library,
        shelves::{environment_key, environment_label, preset_key},
        viewing::Resolution,
    },
    sheets::{book, dialogs::Purpose, menu::Sheet, palette, palette::Findable, turntable::Preview, unsaved::Then},
    store::PRESETS,
    store::examples::{EXAMPLES, Example},
    study::explain::explain,
    workspaces::Change,
};

/// How many times larger one step of magnification shows the image.
const MAGNIFICATION: f32 = 2.0;

impl App {
    pub fn apply(&mut self, ctx: &egui::Context, action: Action) {
        self.autosave.witness.note(format!("{action:?}"));
        match action {
            Action::Do(command) => self.command(ctx, command),
            Action::Open(path) => {
                self.open(path);
            }
            Action::Drop(paths) => self.drop_files(paths),
            Action::CancelLoading => self.worker.loading().cancel(),
            Action::Paste(text) => self.paste(&text),
            Action::PastePicture => {
                self.warn("the clipboard holds an image: save it as a file, and open or drop that");
            }
            Action::UseModel(source) => self.open_model(source, ModelOptions::default()),
            Action::ImportModel(source, options) => self.open_model(source, options),
            Action::UseEnvironment(source) => self.worker.open_environment(source),
            Action::ImportAs(lobe) => self.shared.import_lobe = lobe,
            Action::UseMaterial(material) => self.use_material(*material),
            Action::ChooseLut => self.ask(ctx, Purpose::OpenLut),
            Action::ChooseProfile(light) => self.ask(ctx, Purpose::LightProfile(light)),
            Action::ChooseReference => self.ask(ctx, Purpose::Reference),
            Action::ChooseTexture(target) => self.ask(ctx, Purpose::Texture(target)),
            Action::Export(material) => self.ask_export(ctx, Some(*material)),
            Action::CopyAs(material, format) => self.copy_as(*material, format),
            Action::SelectSlot(slot) => self.select_slots(&[slot]),
            Action::SelectSlots(slots) => {
                self.shared.selection.objects.clear();
                self.select_slots(&slots);
            }
            Action::Explain(pixel, sample) => self.explain(pixel, sample),
            Action::ChangeLibrary(change) => self.change_library(change),
            Action::ChangeSnapshots(change) => self.change_snapshots(change),
            Action::UseSnapshot(path) => self.use_snapshot(&path),
            Action::CompareWith(rival) => {
                let compare = &mut self.shared.compare;
                (compare.rival, compare.is_on, compare.is_chosen) = (rival, true, true);
            }
            Action::LookFrom(yaw_deg, pitch_deg) => self.look_from(yaw_deg, pitch_deg),
            Action::OpenExample(number) => self.open_example(number),
            Action::UseBookmark(number) => {
                if let Some(bookmark) = self.document.bookmarks.get(number) {
                    self.document.camera = bookmark.camera;
                    self.edits.did("Apply bookmark");
                }
            }
            Action::Reveal(pane) => self.reveal(pane),
            Action::Close(pane) => layout::close(&mut self.layout, pane),
            Action::ChangeWorkspaces(change) => {
                self.maximise(false);
                self.workspaces.change(change, &mut self.layout);
            }
            Action::Edit(key) => self.edit_parameter(ctx, key),
            Action::UseEngine(choice) => {
                (self.shared.rendering.engine, self.shared.rendering.kept_engine) = (choice, choice);
                self.worker.use_engine(choice);
            }
            Action::Show(shown) => {
                self.shared.viewing.shown = shown;
                self.worker.show(shown);
            }
        }
    }

    /// Opens an example, as an edit that can be undone, and shows the panel about it.
    fn open_example(&mut self, number: usize) {
        let Some(Example {
            label, panel, document, ..
        }) = EXAMPLES.get(number)
        else {
            return;
        };
        let mut document = document();
        document.view.denoise = self.document.view.denoise;
        self.shared.selection.forget();
        self.replace_document(document, format!("Open the example {label}"));
        if let Some(pane) = Pane::ALL.into_iter().find(|pane| pane.title() == *panel) {
            self.reveal(pane);
        }
    }

    /// Lays the account of a path of the image in progress over the window.
    fn explain(&mut self, pixel: [u32; 2], sample: u32) {
        if let Some(scene) = self.scene() {
            // In full size, also while a smaller image is shown.
            let (render, mut job) = (&scene.document.render, (*scene.job).clone());
            let shown = std::mem::replace(&mut job.settings.image_size, [render.width, render.height]);
            let full = |i: usize| (pixel[i] * job.settings.image_size[i] + shown[i] / 2) / shown[i].max(1);
            let account = explain(&scene.document, &scene.model, &job, [full(0), full(1)], sample);
            self.sheet = Sheet::Path {
                text: account.to_string(),
            };
        }
    }

    /// Brings the parameter's row to the front and gives it the keys.
    fn edit_parameter(&mut self, ctx: &egui::Context, key: &str) {
        if let Ok(parameter) = parameter(key) {
            self.reveal(Pane::Material);
            // A row that does not apply comes with the first of its group that does, such as the weight.
            let material = self.desk_material();
            let of_group = PARAMETERS.iter().filter(|of| of.group == parameter.group);
            let mut rows = std::iter::once(parameter).chain(of_group);
            let row = rows.find(|row| (row.applies)(&material)).unwrap_or(parameter);
            keys::focus_row(ctx, row.group, row.full_name());
        } else if let Some(setting) = setting(key) {
            let is_light = key.starts_with("lighting.") || key == "scene.ground";
            self.reveal(if is_light { Pane::Lighting } else { Pane::Camera });
            let (mut group, mut name) = (setting.group, setting.full_name());
            if key == "camera.aperture" {
                // The f-number stands for it.
                (group, name) = ("Lens", "f-number".to_owned());
            } else if group == PICTURE_SIZE {
                // Rows that are shown where the viewport has the image's size.
                self.shared.viewing.resolution = Resolution::Document;
                group = "Image";
            }
            keys::focus_row(ctx, group, name);
        }
    }

    fn command(&mut self, ctx: &egui::Context, command: Command) {
        log::debug!("{}", command.label());
        match command {
            Command::Undo => self.step(ctx, History::undo),
            Command::Redo => self.step(ctx, History::redo),
            Command::ResetMaterial => {
                let name = self.desk_material().name;
                let default = MaterialSettings::default();
                self.use_material(MaterialSettings { name, ..default });
            }
            Command::ResetCamera => {
                self.document.camera = CameraSettings::default();
                self.edits.did("Reset the camera");
            }
            Command::FrameAll => {
                self.frame_all();
                self.edits.did("Frame all");
            }
            Command::FrontView => self.look_along(0.0, 0.0),
            Command::SideView => self.look_along(90.0, 0.0),
            Command::TopView => self.look_along(0.0, 90.0),
            Command::ToggleProjection => {
                let projection = &mut self.document.camera.projection;
                *projection = match *projection {
                    Projection::Perspective => Projection::Orthographic,
                    Projection::Orthographic => Projection::Perspective,
                };
                self.edits.note("Projection", "camera.projection");
            }
            Command::Inspect => {
                let look = &mut self.shared.look;
                look.is_pinned = look.at.is_some() && !look.is_pinned;
                self.reveal(Pane::Inspector);
            }
            Command::ZoomIn => self.viewport.magnify(MAGNIFICATION),
            Command::ZoomOut => self.viewport.magnify(1.0 / MAGNIFICATION),
            Command::ZoomFit => self.viewport.magnify(0.0),
            Command::Denoise => {
                let denoise = &mut self.document.view.denoise;
                *denoise = match *denoise {
                    Denoise::Off => Denoise::Auto,
                    _ => Denoise::Off,
                };
                self.edits.note("Denoise", "view.denoise");
            }
            Command::FrameSelected => self.frame_selected(),
            Command::CopyMaterial => self.shared.selection.copied = Some(self.desk_material()),
            Command::PasteMaterial => {
                if let Some(material) = self.shared.selection.copied.clone() {
                    self.use_material(material);
                }
            }
            Command::ShowObjects => {
                self.document.hidden_objects.clear();
                self.edits.did("Show all objects");
            }
            Command::Maximise => {
                self.maximise(!self.is_maximised);
            }
            Command::ToggleTheme => {
                self.theme = match ctx.theme() {
                    egui::Theme::Dark => egui::ThemePreference::Light,
                    egui::Theme::Light => egui::ThemePreference::Dark,
                };
                ctx.set_theme(self.theme);
            }
            Command::Region => self.viewport.draw_region(),
            Command::ClearRegion => {
                self.document.render.region = None;
                self.edits.did("Clear the render region");
            }
            Command::ResetLayout => {
                self.layout = self.workspaces.at_first();
                self.is_maximised = false;
            }
            Command::Pause => {
                self.shared.rendering.is_paused = !self.shared.rendering.is_paused;
                self.worker.pause(self.shared.rendering.is_paused);
            }
            Command::Reload => {
                self.reload();
                self.restart_rival();
            }
            Command::Restart => {
                self.worker.restart();
                self.restart_rival();
                // With the viewport's size, where the image had been kept at another.
                self.submitted = None;
            }
            Command::Compare => self.toggle_compare(),
            Command::SwapCompared => self.swap_compared(),
            Command::TakeCompared => self.take_compared(),
            Command::Pin => {
                self.change_snapshots(library::Change::Add);
                // The panels stay hidden where they are.
                layout::reveal(&mut self.layout, Pane::Snapshots);
            }
            Command::Measure | Command::Race => {
                self.panels.on_command(command);
                self.reveal(if command == Command::Race {
                    Pane::Race
                } else {
                    Pane::Effects
                });
            }
            Command::Turntable => self.open_turntable(),
            Command::PreviewTurn => {
                let (since, camera) = (Instant::now(), self.document.camera);
                let preview = &mut self.turntable.preview;
                *preview = preview.is_none().then_some(Preview { since, camera });
            }
            Command::Palette => {
                palette::focus(ctx);
                self.sheet = Sheet::Palette {
                    search: String::new(),
                    selected: 0,
                    things: self.things(),
                };
            }
            Command::Manual => book::ask(ctx, self.topic(ctx)),
            Command::Shortcuts => self.sheet = Sheet::Shortcuts,
            Command::ModelFile => self.sheet = Sheet::ModelFile,
            Command::About => self.sheet = Sheet::About,
            Command::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            Command::SaveToMyPresets => self.change_library(library::Change::Add),
            Command::New => self.unless_unsaved(ctx, Then::New),
            Command::Open => self.ask(ctx, Purpose::Open),
            Command::OpenMeasured => self.ask(ctx, Purpose::OpenMeasured),
            Command::WatchFolder => self.ask(ctx, Purpose::WatchFolder),
            Command::TypePaths => self.toggle_typed_paths(),
            Command::Save => self.save_or_ask(ctx),
            Command::SaveAs => self.ask(ctx, Purpose::SaveProject),
            Command::SaveMaterial => self.ask(ctx, Purpose::SaveMaterial),
            Command::Export => self.ask_export(ctx, None),
            Command::SavePicture => self.ask(ctx, Purpose::SavePicture),
            Command::SaveLayers => self.ask(ctx, Purpose::SaveLayers),
            Command::SaveWindow => self.ask(ctx, Purpose::SaveWindow),
            Command::CopyPicture => self.want_picture(None, Destination::Clipboard),
            Command::QueuePicture => self.ask(ctx, Purpose::QueuePicture),
        }
    }

    fn select_slots(&mut self, slots: &[usize]) {
        let [first, rest @ ..] = slots else { return };
        let selection = &mut self.shared.selection;
        (selection.slot, selection.is_made) = (*first, true);
        selection.also = rest.iter().copied().collect();
        self.edits.history.seal();
    }

    pub fn frame_all(&mut self) {
        let camera = &mut self.document.camera;
        (camera.target, camera.distance, camera.position) = (None, None, None);
    }

    /// Turns the camera about its target.
    fn look_from(&mut self, yaw_deg: f64, pitch_deg: f64) {
        let camera = &mut self.document.camera;
        (camera.yaw_deg, camera.pitch_deg, camera.position) = (yaw_deg, pitch_deg, None);
        self.edits.did("Look from a side");
    }

    /// The same in parallel rays.
    fn look_along(&mut self, yaw_deg: f64, pitch_deg: f64) {
        self.document.camera.projection = Projection::Orthographic;
        self.look_from(yaw_deg, pitch_deg);
    }

    /// Goes to another step of the history. Where that has another model, the slot is the one that was selected of it last.
    fn step(&mut self, ctx: &egui::Context, step: fn(&mut History<Document>) -> Option<&Document>) {
        // What was edited in this very frame is a step, too.
        self.record(is_dragging(ctx));
        let Some(document) = step(&mut self.edits.history).cloned() else {
            return;
        };
        if document.model != self.document.model {
            let left = self.document.model.clone();
            self.shared.selection.change_model(left, &document.model);
        }
        self.document = document;
    }

    pub fn use_material(&mut self, material: MaterialSettings) {
        let label = format!("Use {}", material.name);
        for slot in self.shared.selection.slots() {
            *self.document.material_mut(slot) = material.clone();
        }
        self.edits.did(label);
    }

    /// Looks at the chosen objects, or the surfaces of the selected slots, from where the camera is.
    fn frame_selected(&mut self) {
        let Some(scene) = self.scene() else { return };
        let geometry = &scene.job.geometry;
        let selection = &self.shared.selection;
        let slots = selection.slots();
        let is_chosen = |triangle: usize| match selection.objects.is_empty() {
            true => slots.contains(&(geometry.slot(triangle) as usize)),
            false => selection.objects.contains(&(geometry.object(triangle) as usize)),
        };
        let Some((center, radius)) = geometry.sphere_around(is_chosen) else {
            return;
        };
        let size = scene.job.settings.image_size.map(f64::from);
        let camera = &mut self.document.camera;
        let distance = framing_distance(camera.fov_deg, size[0] / size[1].max(1.0)) * radius;
        camera.target = Some(geometry.world_from_units(center).to_array());
        camera.distance = Some(distance * geometry.world_units_per_unit);
        camera.position = None;
        self.edits.did("Frame selected");
    }

    /// Materials, environments, views of the camera, workspaces and recent files.
    pub fn things(&self) -> Vec<Findable> {
        let shipped = PRESETS
            .iter()
            .map(|material| self.material(preset_key(material), material));
        let own = self.shared.library.entries.iter().filter_map(|own| {
            let material = own.material.as_ref().ok()?;
            Some(self.material(own.path.display().to_string(), material))
        });
        let built_in = BUILT_IN.iter().map(|built_in| built_in.source.clone());
        let sources = built_in.chain(self.shared.recent.environments());
        let environments = sources.map(|source: EnvironmentSource| {
            let label = format!("Environment {}", environment_label(&source));
            self.of_browser(environment_key(&source), label, Action::UseEnvironment(source))
        });
        let mut things = vec![Findable::new("f-number".to_owned(), Action::Edit("camera.aperture"))];
        things.extend(shipped.chain(own).chain(environments));
        for (number, view) in self.document.bookmarks.iter().enumerate() {
            things.push(Findable::new(
                format!("View {}", view.name),
                Action::UseBookmark(number),
            ));
        }
        for name in self.workspaces.names() {
            let action = Action::ChangeWorkspaces(Change::Use(name.to_owned()));
            things.push(Findable::new(format!("Workspace {name}"), action));
        }
        for path in &self.shared.recent.paths {
            things.push(Findable::new(
                format!("Open {}", file_name(path)),
                Action::Open(path.clone()),
            ));
        }
        things
    }

    fn material(&self, key: String, material: &MaterialSettings) -> Findable {
        let action = Action::UseMaterial(Box::new(material.clone()));
        let mut found = self.of_browser(key, format!("Material {}", material.name), action);
        for word in material.look_words() {
            found.tags += &format!(" {word}");
        }
        found
    }

    /// With whether it is a favourite in the browser.
    fn of_browser(&self, key: String, label: String, action: Action) -> Findable {
        Findable {
            is_favourite: self.shared.shelves.kept.favourites.contains(&key),
            ..Findable::new(label, action)
        }
    }
}
