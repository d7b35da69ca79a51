//! Denoised pictures where it is hard: mirrors, glass, blur, turntables, a library that goes, work that is called off.

use std::time::{Duration, Instant};

use glossmith::{
    analysis::halves::Halves,
    document::{Background, Denoise, Document, turntable::Turn, turntable::turned},
    job::film::Image,
    render::{
        EngineChoice, Session, StepDenoiser,
        denoise::{Denoiser, Library, Noisy},
        worker::Pace,
        worker::Worker,
    },
    scene::ModelSource,
};

use super::renders::{adjust, render};

fn sphere_on_ground(assignments: &str) -> Document {
    let mut document = Document {
        model: ModelSource::Sphere,
        ground: true,
        ..Document::default()
    };
    adjust(&mut document, "render.width=64 render.height=64");
    document.view.denoise = Denoise::High;
    adjust(&mut document, assignments);
    document
}

const GLASS: &str = "specular.lobe=ggx specular.roughness=0.3 base.metalness=0 transmission.weight=1";

/// A mirror, rough glass, and a lens wide open: nearer to the truth than the samples, and the error that is told is the true
/// one within a factor of two (one render each; its band is 20 to 60 % wide).
#[test]
fn mirrors_glass_and_blur_come_out_nearer_to_the_truth() {
    let mirror = sphere_on_ground("specular.roughness=0 specular.lobe=ggx base.metalness=1");
    let glass = sphere_on_ground(GLASS);
    let mut blurred = sphere_on_ground("base.metalness=0");
    blurred.camera.aperture = 0.2;
    let mut denoiser = Denoiser::open().unwrap_or_else(|error| panic!("{error}"));
    for (name, mut document) in [("mirror", mirror), ("glass", glass), ("blurred", blurred)] {
        // Its own noise is taken out by its halves; what is left is 1 % of the error.
        adjust(&mut document, "render.samples=256 render.seed=7");
        let reference = Halves::of(&render(EngineChoice::Cpu, &document));
        adjust(&mut document, "render.samples=8 render.seed=1");
        let noisy = Noisy::of(&render(EngineChoice::Cpu, &document), None);
        let done = denoiser.denoise(&noisy, Denoise::High).unwrap();
        let [samples, clean] = [&noisy.image, &done.image].map(|image| reference.error_of(&image.luminance()).value);
        let estimate = done.error.unwrap().value;
        println!("{name}: samples {samples:.4}, denoised {clean:.4}, estimate {estimate:.4}");
        assert!(clean < 0.9 * samples, "{name}: {clean} {samples}");
        assert!((0.5..2.0).contains(&(estimate / clean)), "{name}: {estimate} {clean}");
    }
}

fn denoised(session: &mut Session, document: &Document) -> [Image; 2] {
    let mut step_denoiser = StepDenoiser::new(document);
    session.submit(document).unwrap();
    while !session.step(Duration::from_millis(100)).unwrap().is_done {}
    let done = step_denoiser.finish(session).unwrap().unwrap();
    [session.image().unwrap(), Image::clone(&done.image)]
}

fn apart(a: &Image, b: &Image) -> f64 {
    let squares = std::iter::zip(a.luminance(), b.luminance()).map(|(a, b)| (a - b).powi(2));
    (squares.sum::<f64>() / a.pixels.len() as f64).sqrt()
}

/// A ball that turns looks the same from frame to frame. As all frames draw the same random numbers, what noise is left
/// stays nearly where it is: frames differ less than pictures with other numbers.
#[test]
fn what_stands_still_in_a_turntable_does_not_boil() {
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    let mut document = sphere_on_ground("specular.lobe=ggx specular.roughness=0.5 base.metalness=0");
    document.render.samples = 4;
    let frames = [0, 1, 2].map(|frame| {
        let document = turned(&document, Turn::Model, frame, 36, [0.0; 3]);
        denoised(&mut session, &document)
    });
    document.render.seed = 99;
    let [other_noisy, other] = denoised(&mut session, &document);
    let [noise, boiling] = [apart(&frames[0][0], &other_noisy), apart(&frames[0][1], &other)];
    let still = apart(&frames[0][1], &frames[1][1]).max(apart(&frames[1][1], &frames[2][1]));
    println!("noise {noise:.4}, denoised with other numbers {boiling:.4}, from frame to frame {still:.4}");
    assert!(boiling < 0.7 * noise, "denoised: {boiling} {noise}");
    // Frames with numbers of their own would be 1 ± 0.1 times as far apart as pictures with other numbers are: what is left
    // in a denoised picture is smooth over some ten pixels.
    assert!(still < 0.7 * boiling, "{still} {boiling}");
}

/// A window that closes does not wait for a picture of a million pixels that is being denoised.
#[test]
fn a_worker_that_is_dropped_does_not_wait_for_the_denoiser() {
    let _ = Library::get().unwrap_or_else(|error| panic!("{error}"));
    let mut document = sphere_on_ground("");
    adjust(&mut document, "render.width=1024 render.height=1024 render.samples=1");
    document.view.denoise = Denoise::High;
    let worker = Worker::spawn(EngineChoice::Cpu, || {}).unwrap();
    worker.submit(&document, Pace::Still);
    let begun = Instant::now();
    while worker.snapshot().progress.samples_per_pixel == 0 && begun.elapsed() < Duration::from_secs(600) {
        std::thread::sleep(Duration::from_millis(1));
    }
    let begun = Instant::now();
    drop(worker);
    // As long as dropping waits for a worker in the middle of something else.
    assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", begun.elapsed());
}

/// Where something is seen through holes of a transparent picture, opacities stay within bounds and the holes empty.
#[test]
fn holes_of_transparent_pictures_stay_holes() {
    let mut document = sphere_on_ground("geometry.opacity=0.5");
    document.ground = false;
    document.lighting.background = Background::Transparent;
    document.render.samples = 8;
    let film = render(EngineChoice::Cpu, &document);
    let noisy = Noisy::of(&film, None);
    let mut denoiser = Denoiser::open().unwrap_or_else(|error| panic!("{error}"));
    for how in [Denoise::Fast, Denoise::High, Denoise::Auto] {
        let done = denoiser.denoise(&noisy, how).unwrap();
        assert!(done.image.pixels.iter().flatten().all(|x| x.is_finite() && *x >= 0.0));
        let alpha = |x: usize, y: usize| done.image.pixels[y * 64 + x][3];
        assert!(done.image.pixels.iter().all(|pixel| pixel[3] <= 1.0));
        assert!(alpha(0, 0) < 0.02 && alpha(63, 63) < 0.02, "{how:?}: nothing is there");
        let middle: f32 = (0..256).map(|i| alpha(24 + i % 16, 24 + i / 16)).sum::<f32>() / 256.0;
        // A ray passes two sides: 1 − 0.5², and 1 − (1 − 0.5)² of the pixels' samples see something.
        near!(middle, 0.75, 0.05, "{how:?}");
    }
}
