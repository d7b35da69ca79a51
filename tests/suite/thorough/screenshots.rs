//! Makes the screenshots of the book: of the whole window, each with its document inside, and of every panel with
//! something in it for docs/PANELS.md. No tests: `scripts/pictures window panels` runs them.

use std::{path::Path, time::Duration, time::Instant};

use egui::{Vec2, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use glossmith::{
    app::actions::{Action, Command},
    app::layout::Pane,
    app::workspaces::{Change, LOOK},
    document::{Denoise, Document, GroundKind},
    scene::texture::TextureTarget,
    store::{examples::EXAMPLES, material_by_name, picture::png_bytes, save_document},
};

use super::{
    docs::root,
    ui::{Editor, window_of},
    ui_study::race_strategies,
};

/// What is docked together, and what the page is called.
const PAGES: [(&str, &[Pane]); 5] = [
    ("start", &[Pane::Presets, Pane::Lighting, Pane::Material, Pane::Curve]),
    ("scene", &[Pane::Scene, Pane::Camera, Pane::Material, Pane::Lobe]),
    ("cost", &[Pane::Snapshots, Pane::Effects, Pane::Check, Pane::Samples]),
    ("race", &[Pane::Queue, Pane::Race, Pane::Material, Pane::Inspector]),
    ("error", &[Pane::Presets, Pane::Race, Pane::Log, Pane::Convergence]),
];
/// Width and height of the window, pixels.
const SIZES: [[u32; 2]; 2] = [[1920, 1080], [1366, 768]];
const THEMES: [&str; 2] = ["dark", "light"];
/// Of 100.
const JPEG_QUALITY: u8 = 88;

/// Width and height of a screenshot of the whole window, pixels.
const WINDOW: [u32; 2] = [1440, 900];

fn path(page: &str, [width, height]: [u32; 2], theme: &str) -> String {
    format!("pictures/panels/{page}-{width}x{height}-{theme}.jpg")
}

/// Shows small pictures for as long as they take.
fn rest(harness: &mut Editor, seconds: f64) {
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs_f64(seconds) {
        std::thread::sleep(Duration::from_millis(50));
        harness.step();
    }
}

/// A window in which something has been done in every panel.
fn worked_in(folder: &Path, size: [u32; 2]) -> Editor {
    let mut document = (EXAMPLES[0].document)();
    document.render.samples = 12;
    document.view.denoise = Denoise::High;
    let mut harness = window_of(document, folder, size);
    harness.command(Command::Pin);
    rest(&mut harness, 1.0);
    harness.request(Action::LookFrom(60.0, 15.0));
    harness.settle();
    harness.command(Command::Pin);
    rest(&mut harness, 1.0);
    harness.command(Command::Undo);
    harness.settle();
    let oak = folder.join("oak_rough.png");
    image::RgbImage::from_fn(64, 64, |x, y| image::Rgb([120 + ((x / 4 + y / 16) % 8 * 12) as u8; 3]))
        .save(&oak)
        .expect("a picture");
    harness.request(Action::ChooseTexture(TextureTarget::Roughness));
    harness.type_path(&oak, "Open");
    harness.settle();
    race_strategies(&mut harness, 0.5);
    harness.see_label("Run the race");
    harness.command(Command::Measure);
    harness.see("the ledger", |harness| {
        harness.tells("ms for one sample of every pixel")
    });
    harness.request(Action::Reveal(Pane::Check));
    harness.run_steps(2);
    harness.press("Check this machine");
    harness.see("the checks", |harness| harness.tells("checks passed"));
    harness.command(Command::QueuePicture);
    harness.type_path(&folder.join("teapot.exr"), "Save");
    harness.command(Command::Turntable);
    harness.run_steps(3);
    harness.press("Add to the queue");
    harness.click(Role::CheckBox, "Pause the queue");
    let viewport = harness.get_by_label("Viewport").rect();
    harness.hover_at(viewport.center() + Vec2::new(-0.04 * viewport.width(), 0.0));
    harness.run_steps(3);
    harness.command(Command::Inspect);
    harness.settle();
    harness
}

fn write(harness: &mut Editor, to: &Path) {
    let window = harness
        .render()
        .expect("a Vulkan driver: apt install mesa-vulkan-drivers");
    let window = image::DynamicImage::ImageRgba8(window).into_rgb8();
    std::fs::create_dir_all(to.parent().expect("it lies in a folder")).expect("a folder");
    let file = std::fs::File::create(to).expect("a file");
    let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(file, JPEG_QUALITY);
    window.write_with_encoder(encoder).expect("written");
}

#[test]
#[ignore = "makes screenshots"]
fn panels() {
    // The name of the folder is seen in the pictures.
    std::env::set_current_dir(root()).expect("it is there");
    let folder = Path::new("target/panels");
    let _ = std::fs::remove_dir_all(folder);
    std::fs::create_dir_all(folder).expect("a folder");
    // The work takes minutes: it is done once.
    let mut harness = worked_in(folder, SIZES[0]);
    for size in SIZES {
        harness.set_size(size.map(|side| side as f32).into());
        harness.settle();
        for theme in THEMES {
            for (page, panes) in PAGES {
                for pane in panes {
                    harness.request(Action::Reveal(*pane));
                }
                harness.hover_at(egui::pos2(-10.0, -10.0));
                rest(&mut harness, 3.0);
                write(&mut harness, &root().join("docs").join(path(page, size, theme)));
            }
            harness.command(Command::ToggleTheme);
        }
    }
}

fn car_paint() -> Document {
    let mut document = Document {
        ground: true,
        materials: vec![material_by_name("car-paint-red").expect("a preset").clone()],
        ..Document::default()
    };
    document.camera.yaw_deg = 20.0;
    document.camera.pitch_deg = 12.0;
    document.camera.fov_deg = 24.0;
    document.camera.target = Some([0.2, 1.3, 0.0]);
    // A floor that bends up into a wall has no edge in sight.
    document.lighting.ground.kind = GroundKind::Cyclorama;
    document.lighting.ground.yaw_deg = document.camera.yaw_deg;
    clean(document)
}

fn clean(mut document: Document) -> Document {
    document.view.denoise = Denoise::High;
    document.render.samples = 12;
    document
}

fn reveal(harness: &mut Editor, panes: &[Pane]) {
    for pane in panes {
        harness.request(Action::Reveal(*pane));
    }
    harness.settle();
    // Thumbnails and plots come after the render.
    rest(harness, 3.0);
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
    save_document(text.path(), harness.document()).expect("saved");
    let text = std::fs::read_to_string(text.path()).expect("the text");
    let bytes = png_bytes(size, &window.into_raw(), Some(&text)).expect("an image");
    std::fs::write(root().join(format!("docs/pictures/{name}.png")), bytes).expect("written");
}

#[test]
#[ignore = "makes screenshots"]
fn windows() {
    // The name of the folder is seen in a screenshot.
    std::env::set_current_dir(root()).expect("it is there");
    let folder = Path::new("target/windows");
    let _ = std::fs::remove_dir_all(folder);
    std::fs::create_dir_all(folder).expect("a folder");
    let mut harness = window_of(clean((EXAMPLES[0].document)()), folder, WINDOW);
    harness.request(Action::ChangeWorkspaces(Change::Use(LOOK.to_owned())));
    reveal(&mut harness, &[]);
    take(&mut harness, "window");
    drop(harness);
    let mut harness = window_of(car_paint(), folder, WINDOW);
    harness.command(Command::ToggleTheme);
    reveal(&mut harness, &[Pane::Samples, Pane::Camera]);
    take(&mut harness, "window-light");
    harness.command(Command::ToggleTheme);
    harness.command(Command::Measure);
    harness.see("the ledger", |harness| {
        harness.tells("ms for one sample of every pixel")
    });
    reveal(&mut harness, &[Pane::Effects, Pane::Curve]);
    take(&mut harness, "window-effects");
    harness.command(Command::Compare);
    harness.wait("B", |app| app.rms_difference().is_some());
    reveal(&mut harness, &[Pane::Lobe, Pane::Lighting]);
    take(&mut harness, "window-compare");
    harness.command(Command::Compare);
    harness.settle();
    harness.command(Command::Export);
    harness.type_path(&folder.join("car-paint.mtlx"), "Save");
    harness.see_label("Write the file");
    take(&mut harness, "window-export");
}
