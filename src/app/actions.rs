//! What can be done, declared once: menus, shortcuts and the command palette read the table.

use std::path::PathBuf;

use egui::{Key, KeyboardShortcut, Modifiers};

use crate::{
    document::{ImportLobe, MaterialSettings},
    kit::keys,
    named::named,
    pane::Pane,
    render::{EngineChoice, shown::Shown},
    scene::{ModelOptions, ModelSource, environment::EnvironmentSource, texture::TextureTarget},
    services::{compare::Rival, library::Change, workspaces},
};

/// Something for the app to do after the panels have been shown.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// A command without arguments.
    Do(Command),
    /// Opens a file by its ending.
    Open(PathBuf),
    /// Takes files that were dropped on the window together: images are assigned to the selected material, anything else is
    /// opened.
    Drop(Vec<PathBuf>),
    /// Takes text that was pasted into the window: names of files.
    Paste(String),
    /// Says what to do with an image that was pasted.
    PastePicture,
    /// Cancels what is being loaded or prepared.
    CancelLoading,
    UseModel(ModelSource),
    /// Reloads a model's file to show another scene, variant or pose of it.
    ImportModel(ModelSource, ModelOptions),
    UseEnvironment(EnvironmentSource),
    /// Replaces the selected material, keeping nothing of it.
    UseMaterial(Box<MaterialSettings>),
    /// Asks for a table of colours for the image.
    ChooseLut,
    /// Asks for the profile of the area light of this number.
    ChooseProfile(usize),
    /// Asks for a reference image.
    ChooseReference,
    /// Asks for an image to assign to the selected material.
    ChooseTexture(TextureTarget),
    /// Asks where to write a material for another program.
    Export(Box<MaterialSettings>),
    /// Copies a material to the clipboard, as the text of a format of this name.
    CopyAs(Box<MaterialSettings>, &'static str),
    /// Selects a material slot.
    SelectSlot(usize),
    /// Selects several material slots, the first of which is shown.
    SelectSlots(Vec<usize>),
    /// Shows everything that made a sample (from 0) of a pixel of the image.
    Explain([u32; 2], u32),
    /// Changes the user's folder of materials.
    ChangeLibrary(Change),
    /// Changes the pinned states.
    ChangeSnapshots(Change),
    /// Brings the pinned state of a file back as the document.
    UseSnapshot(PathBuf),
    /// Compares the document with something.
    CompareWith(Rival),
    /// Looks from a direction: yaw and pitch in degrees.
    LookFrom(f64, f64),
    UseEngine(EngineChoice),
    /// Shows the image or a map of its error or samples.
    Show(Shown),
    /// Looks from a bookmark of the camera, by number.
    UseBookmark(usize),
    /// Opens an example, by number.
    OpenExample(usize),
    /// Brings a panel to the front.
    Reveal(Pane),
    Close(Pane),
    /// Changes the workspaces, or which is shown.
    ChangeWorkspaces(workspaces::Change),
    /// Shows a parameter of the selected material and gives it the keys.
    Edit(&'static str),
    /// Which lobe the materials of models get that are opened from now on.
    ImportAs(ImportLobe),
}

named! {
    /// Where a command stands in the menus, from left to right.
    Menu {
        File, "file", "File", "";
        Edit, "edit", "Edit", "";
        View, "view", "View", "";
        Render, "render", "Render", "";
        Help, "help", "Help", "";
    }
}

macro_rules! commands {
    ($($name:ident, $menu:ident, $label:literal, $help:literal, $shortcut:expr, $group:literal;)*) => {
        /// What can be done without saying with what.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Command {
            $(#[doc = $help] $name,)*
        }

        impl Command {
            /// Every command, in the order of the menus.
            pub const ALL: &'static [Command] = &[$(Command::$name),*];

            pub fn menu(self) -> Menu {
                match self { $(Self::$name => Menu::$menu,)* }
            }
            /// What it is called.
            pub fn label(self) -> &'static str {
                match self { $(Self::$name => $label,)* }
            }
            pub fn help(self) -> &'static str {
                match self { $(Self::$name => $help,)* }
            }
            pub fn shortcut(self) -> Option<KeyboardShortcut> {
                match self { $(Self::$name => $shortcut,)* }
            }
            /// Commands of a menu with the same number stand together; from 4 on in a menu of their own, or in the palette alone.
            pub fn group(self) -> u32 {
                match self { $(Self::$name => $group,)* }
            }
        }
    };
}

const CTRL: Modifiers = Modifiers::COMMAND;
const CTRL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

const fn keys(modifiers: Modifiers, key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(modifiers, key))
}

const fn key(key: Key) -> Option<KeyboardShortcut> {
    keys(Modifiers::NONE, key)
}

commands! {
    New, File, "New", "Starts again, with the default model, light and material.", keys(CTRL, Key::N), 0;
    Open, File, "Open…", "Opens a project, a material, a model or an environment.", keys(CTRL, Key::O), 0;
    OpenMeasured, File, "Open measured material…", "Opens a measured material (.binary of the MERL database) to match looks with.", None, 9;
    ModelFile, File, "Model file…", "What became of the parts of the model's file; its scenes, variants and poses.", None, 9;
    Reload, File, "Reload files", "Reads model and environment again.", keys(CTRL, Key::R), 9;
    TypePaths, File, "Type file names", "Files are chosen by typing their paths in the window; or again in the system's dialog.", None, 9;
    Save, File, "Save project", "Saves materials, light, camera and settings (.glossmith.json).", keys(CTRL, Key::S), 1;
    SaveAs, File, "Save project as…", "Saves the project under another name.", keys(CTRL_SHIFT, Key::S), 1;
    SaveMaterial, File, "Save material…", "Saves the selected material (.json).", None, 1;
    WatchFolder, File, "Watch a folder…", "Shows the materials and environments of a folder among the presets, as they come and go.", None, 9;
    SaveToMyPresets, File, "Save to my presets", "Adds the selected material to your own presets.", None, 1;
    Export, File, "Export…", "Exports with a preview of what the format cannot represent.", None, 1;
    SavePicture, File, "Save image…", "Saves what has been rendered so far (.png with the document inside, .exr, .hdr).", keys(CTRL, Key::E), 1;
    SaveLayers, File, "Save image with layers…", "Saves albedo, normal, depth, samples and variance beside the colour (.exr).", None, 1;
    CopyPicture, File, "Copy image", "Copies what has been rendered so far to the clipboard.", keys(CTRL_SHIFT, Key::C), 1;
    SaveWindow, File, "Save screenshot…", "Saves the window as it is shown, panels and all (.png).", None, 1;
    Quit, File, "Quit", "Closes the window.", keys(CTRL, Key::Q), 2;
    Undo, Edit, "Undo", "Undoes the last change.", keys(CTRL, Key::Z), 0;
    Redo, Edit, "Redo", "Redoes the change undone last.", keys(CTRL_SHIFT, Key::Z), 0;
    ResetMaterial, Edit, "Reset material", "Gives the selected material its defaults, keeping its name.", None, 1;
    ResetCamera, Edit, "Reset camera", "Puts the camera where it was at first.", None, 1;
    CopyMaterial, Edit, "Copy material", "Copies the selected material, to be pasted onto others.", None, 1;
    PasteMaterial, Edit, "Paste material", "Gives the selected materials what was copied.", None, 1;
    FrameAll, View, "Frame all", "Moves the camera so that the whole model is seen.", key(Key::F), 4;
    FrameSelected, View, "Frame selected", "Moves the camera so that the selected objects are seen, or the surfaces of the selected material.", keys(Modifiers::SHIFT, Key::F), 4;
    FrontView, View, "Front view", "Looks from the front, in parallel rays.", key(Key::Num1), 4;
    SideView, View, "Side view", "Looks from the right side, in parallel rays.", key(Key::Num3), 4;
    TopView, View, "Top view", "Looks from above, in parallel rays.", key(Key::Num7), 4;
    ToggleProjection, View, "Perspective or orthographic", "Changes between a perspective and parallel rays.", key(Key::Num5), 4;
    ShowObjects, View, "Show all objects", "Shows the objects again that were hidden.", None, 4;
    Compare, View, "Compare A and B", "Shows the material beside another one, or beside another lobe.", key(Key::C), 5;
    SwapCompared, View, "Swap A and B", "Makes B the document, and what the document was B.", key(Key::X), 5;
    TakeCompared, View, "Replace A with B", "Applies B's materials and stops comparing.", None, 5;
    Inspect, View, "Pin the pixel", "Explains the pixel under the pointer: the inspector stays at it, or follows the pointer again.", key(Key::I), 6;
    ZoomIn, View, "Magnify the image", "Shows the pixels of the image larger. In the viewport: ctrl and the wheel.", key(Key::Plus), 6;
    ZoomOut, View, "Less magnified", "Shows the pixels of the image smaller, down to the whole image.", key(Key::Minus), 6;
    ZoomFit, View, "Whole image", "Shows the whole image again, as large as it fits.", key(Key::Num0), 6;
    Denoise, View, "Denoise on or off", "Toggles denoising. How and when: Camera & image.", key(Key::D), 0;
    PreviewTurn, View, "Turntable preview", "Previews a turntable. Esc stops.", key(Key::T), 0;
    Pin, View, "Pin a snapshot", "Saves material, light and camera with a thumbnail, to come back to.", key(Key::P), 0;
    Maximise, View, "Viewport only", "Hides the panels, or shows them again.", key(Key::F11), 1;
    ToggleTheme, View, "Switch theme", "Changes between the light and the dark theme.", None, 1;
    ResetLayout, View, "Reset layout", "Puts the panels of this workspace back to where they were at first.", None, 1;
    Pause, Render, "Pause / resume", "Stops rendering, or goes on with it.", key(Key::Space), 0;
    Restart, Render, "Restart render", "Restarts the render.", None, 0;
    Region, Render, "Render region", "Drag a rectangle to render only that part.", key(Key::B), 1;
    ClearRegion, Render, "Clear the render region", "Renders the whole image again. In the viewport: Esc.", None, 1;
    Measure, Render, "Profile features", "Renders with and without each feature and setting, and reports what each costs.", None, 2;
    Race, Render, "Run the race", "Compares techniques on this view: time to a given noise, and bias.", None, 2;
    QueuePicture, Render, "Render to a file…", "Renders the document as it is, at its own size and with all its samples, into a file (.png, .exr, .hdr), in the background.", None, 3;
    Turntable, Render, "Render a turntable…", "Renders a turn of camera, model or light as a video (.mp4, .gif) or as numbered images, in the background.", None, 3;
    Palette, Help, "Find a command…", "Lists every command, panel, parameter, material, environment and recent file; type to search.", keys(CTRL, Key::K), 0;
    Manual, Help, "Manual", "Opens the manual at the page about the panel under the pointer.", key(Key::F1), 0;
    Shortcuts, Help, "Keys and mouse", "Lists shortcuts of keys and mouse.", keys(Modifiers::SHIFT, Key::F1), 0;
    About, Help, "About Glossmith", "Version, licence and the paper to cite.", None, 1;
}

/// The command whose keys were pressed, removed from the input. Keys without modifiers belong to what has the focus,
/// unless that is the viewport; digits to what has the focus or the pointer.
pub fn pressed(ctx: &egui::Context, viewport: Option<egui::Id>) -> Option<Command> {
    let focused = ctx.memory(|memory| memory.focused());
    let is_typing = match focused {
        Some(_) if focused != viewport => true,
        _ => keys::take_search(ctx),
    };
    let all = Command::ALL
        .iter()
        .filter_map(|command| Some((*command, command.shortcut()?)));
    let all = all.chain([(Command::Redo, KeyboardShortcut::new(CTRL, Key::Y))]);
    let is_at_viewport = || {
        let response = viewport.and_then(|id| ctx.read_response(id));
        focused.is_some() || response.is_some_and(|response| response.contains_pointer())
    };
    let is_free = |(_, shortcut): &(Command, KeyboardShortcut)| match shortcut.logical_key {
        _ if shortcut.modifiers.any() => true,
        // Function keys type nothing.
        Key::F1 | Key::F11 => true,
        // May be meant for a number that was left by Enter.
        Key::Num0 | Key::Num1 | Key::Num3 | Key::Num5 | Key::Num7 => !is_typing && is_at_viewport(),
        _ => !is_typing,
    };
    let (first, then): (Vec<_>, Vec<_>) = all.filter(is_free).partition(|(_, shortcut)| shortcut.modifiers.shift);
    // A shortcut without shift would match with it, too.
    let mut free = first.into_iter().chain(then);
    let pressed = ctx.input_mut(|input| free.find(|(_, shortcut)| input.consume_shortcut(shortcut)));
    pressed.map(|(command, _)| command)
}

/// What is chosen by the keyboard closes the menu as well, for which egui waits for a click.
pub fn do_and_close(ui: &egui::Ui, actions: &mut Vec<Action>, action: Action) {
    actions.push(action);
    ui.close();
}
