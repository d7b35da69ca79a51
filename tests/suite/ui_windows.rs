//! The book's screenshots of the whole window, each with its document inside; `UPDATE_DOCS=1 cargo test ui_windows` takes
//! them. And what holds for every picture of the book.

use std::path::{Path, PathBuf};

use egui_kittest::kittest::Queryable as _;
use glossmith::app::actions::{Action, Command};
use glossmith::app::layout::Pane;
use glossmith::document::{Denoise, Document};
use glossmith::store::material_by_name;
use glossmith::store::picture::{load_picture_document, png_bytes};
use glossmith::store::save_document;

use super::docs::{pages, root, text_of};
use super::ui::{Editor, request, see, see_label, settle, wait, window_of};
use super::ui_hands::type_path;

/// Width and height of the window, pixels.
const SIZE: [u32; 2] = [1440, 900];
/// Least width of an image that a reader looks at, and that of the small ones for comparing noise at its own size.
const LEAST_WIDTH: u32 = 640;
const NOISE_WIDTH: u32 = 480;
const HERO_WIDTH: u32 = 1600;
/// Drawings, which have no document.
const DRAWN: [&str; 9] = [
    "beside-blender",
    "scatter-",
    "race",
    "materialx-examples",
    "fig1-",
    "fig2",
    "fig3",
    "fig9",
    "fig10",
];

fn pictures() -> PathBuf {
    root().join("docs/pictures")
}

fn document() -> Document {
    let mut document = Document {
        ground: true,
        materials: vec![material_by_name("car-paint-red").expect("a preset").clone()],
        ..Document::default()
    };
    document.camera.yaw_deg = 20.0;
    document.camera.pitch_deg = 12.0;
    document.camera.fov_deg = 24.0;
    document.camera.target = Some([0.2, 1.3, 0.0]);
    document.view.denoise = Denoise::High;
    document.render.samples = 12;
    document
}

fn window(folder: &Path) -> Editor {
    window_of(document(), folder, SIZE)
}

fn reveal(harness: &mut Editor, panes: &[Pane]) {
    for pane in panes {
        request(harness, Action::Reveal(*pane));
    }
    settle(harness);
    // Thumbnails and plots come after the render.
    for _ in 0..60 {
        std::thread::sleep(std::time::Duration::from_millis(50));
        harness.step();
    }
}

/// Writes the window as it is, with its document inside.
fn take(harness: &mut Editor, name: &str) {
    harness.hover_at(egui::pos2(-10.0, -10.0));
    harness.run_steps(4);
    let window = harness
        .render()
        .expect("a Vulkan driver: apt install mesa-vulkan-drivers");
    let size = [window.width(), window.height()];
    let text = tempfile::NamedTempFile::new().expect("a temporary file");
    save_document(text.path(), harness.state().document()).expect("saved");
    let text = std::fs::read_to_string(text.path()).expect("the text");
    let bytes = png_bytes(size, &window.into_raw(), Some(&text)).expect("an image");
    std::fs::write(pictures().join(format!("{name}.png")), bytes).expect("written");
}

fn take_all() {
    // Its name is seen in a screenshot.
    let folder = Path::new("target/windows");
    let _ = std::fs::remove_dir_all(folder);
    std::fs::create_dir_all(folder).expect("a folder");
    let mut harness = window(folder);
    reveal(
        &mut harness,
        &[Pane::Presets, Pane::Lighting, Pane::Material, Pane::Curve],
    );
    take(&mut harness, "window");
    request(&mut harness, Action::Do(Command::ToggleTheme));
    reveal(&mut harness, &[Pane::Samples, Pane::Camera]);
    take(&mut harness, "window-light");
    request(&mut harness, Action::Do(Command::ToggleTheme));
    request(&mut harness, Action::Do(Command::Measure));
    see(&mut harness, "the ledger", |harness| {
        harness
            .query_by_label_contains("ms for one sample of every pixel")
            .is_some()
    });
    reveal(&mut harness, &[Pane::Effects, Pane::Curve]);
    take(&mut harness, "window-effects");
    request(&mut harness, Action::Do(Command::Compare));
    wait(&mut harness, "B", |app| app.rms_difference().is_some());
    reveal(&mut harness, &[Pane::Lobe, Pane::Lighting]);
    take(&mut harness, "window-compare");
    request(&mut harness, Action::Do(Command::Compare));
    settle(&mut harness);
    request(&mut harness, Action::Do(Command::Export));
    type_path(&mut harness, &folder.join("car-paint.mtlx"), "Save");
    see_label(&mut harness, "Write the file");
    take(&mut harness, "window-export");
}

/// The image is wide enough, a page shows it, and if it is a render or a screenshot it has its document.
fn check(path: &Path, book: &str) {
    let name = path.file_name().expect("a name").to_string_lossy().into_owned();
    assert!(book.contains(&format!("/{name})")), "no page shows {name}");
    let (width, _) = image::image_dimensions(path).expect("an image");
    let least = match name.split('-').next() {
        Some("denoise") => NOISE_WIDTH,
        Some("hero.png") => HERO_WIDTH,
        _ => LEAST_WIDTH,
    };
    assert!(width >= least, "{name} is {width} pixels wide");
    if !DRAWN.iter().any(|start| name.starts_with(start)) {
        let document = load_picture_document(path);
        assert!(document.is_ok(), "{name} has no document: run make pictures");
    }
}

#[test]
fn every_picture_has_its_document_and_is_shown() {
    if std::env::var_os("UPDATE_DOCS").is_some() {
        take_all();
    }
    let book: String = pages().iter().map(|page| text_of(page)).collect();
    let mut count = 0;
    for folder in [pictures(), pictures().join("figures")] {
        let entries = std::fs::read_dir(folder).expect("the folder");
        for path in entries.map(|entry| entry.expect("an entry").path()) {
            if path.extension().is_some_and(|ending| ending == "png") {
                check(&path, &book);
                count += 1;
            }
        }
    }
    assert!(count > 60, "{count} pictures");
}
