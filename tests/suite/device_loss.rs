//! A GPU that is lost, at every moment at which it can be: opened again three times, then the CPU goes on.

use std::time::{Duration, Instant};

use glossmith::{
    document::{Document, MaterialSettings},
    gpu::{AdapterKind, GpuAdapter, Moment, Traversal},
    job::film::Image,
    render::{
        EngineChoice, EngineKind, MachineOptions, RayQueries, Session, SessionError,
        worker::{Event, Level, Pace, Worker},
    },
};

use super::cli_support::passes_alone;
use super::worker::{finished, small_document, wait};

const MOMENTS: &[Moment] = if cfg!(feature = "thorough") {
    &[Moment::Compiling, Moment::Uploading, Moment::Rendering, Moment::Reading]
} else {
    &[Moment::Rendering]
};
/// On a machine that has other things to do.
const PATIENCE: Duration = Duration::from_secs(600);

/// Whose kernel is quickly compiled.
fn matt_document(albedo: f32) -> Document {
    let mut document = small_document();
    document.materials = vec![MaterialSettings::diffuse("matt", [albedo; 3])];
    document
}

/// More than the processor has rendered when the kernel is ready.
fn long_document() -> Document {
    let mut document = matt_document(0.5);
    document.render.samples = 1_000_000;
    document
}

/// The warnings that come until one contains `last`.
fn warnings_until(worker: &Worker, last: &str) -> Vec<String> {
    let begun = Instant::now();
    let mut told: Vec<String> = Vec::new();
    while !told.iter().any(|text| text.contains(last)) {
        assert!(begun.elapsed() < PATIENCE, "{last:?} was not told: {told:?}");
        let warning = |event| match event {
            Event::Message(Level::Warning, text) => Some(text),
            _ => None,
        };
        told.extend(worker.take_events().into_iter().filter_map(warning));
        std::thread::sleep(Duration::from_millis(2));
    }
    told
}

/// What is submitted then is rendered as if nothing had been.
fn renders_as_ever(worker: &Worker, kind: EngineKind) {
    let document = matt_document(0.9);
    let picture = finished(worker, worker.submit(&document, Pace::Still));
    let alone = Worker::spawn(EngineChoice::Cpu, || {}).expect("a thread");
    let expected = finished(&alone, alone.submit(&document, Pace::Still));
    let [mean, wanted] = [&picture.image, &expected.image].map(|image| mean(image));
    near!(mean / wanted, 1.0, 0.001);
    let snapshot = worker.snapshot();
    let engine = snapshot.engine.as_ref().expect("it renders");
    assert_eq!(engine.kind, kind);
    if MachineOptions::get().ray_queries == RayQueries::On {
        let adapter = GpuAdapter::find(AdapterKind::Any).expect("there was one");
        let is_asked = kind == EngineKind::Gpu && adapter.has_ray_queries();
        assert_eq!(engine.traversal == Traversal::RayQueries, is_asked);
    }
}

fn mean(image: &Image) -> f64 {
    let sum: f64 = image.pixels.iter().map(|[r, g, b, _]| f64::from(r + g + b)).sum();
    sum / image.pixels.len() as f64
}

fn gpu_worker() -> Worker {
    let worker = Worker::spawn(EngineChoice::Gpu, || {}).expect("a thread");
    let snapshot = wait(&worker, "an engine", |snapshot| snapshot.engine.is_some());
    let kind = snapshot.engine.as_ref().expect("waited for").kind;
    assert_eq!(
        kind,
        EngineKind::Gpu,
        "a Vulkan driver is needed: apt install mesa-vulkan-drivers"
    );
    worker
}

#[test]
fn a_lost_device_is_opened_anew() {
    for &moment in MOMENTS {
        let worker = gpu_worker();
        worker.lose_device(moment, 1);
        worker.submit(&long_document(), Pace::Still);
        let told = warnings_until(&worker, "opened again (1 of 3 times)");
        assert_eq!(told.len(), 1, "{moment:?}: {told:?}");
        wait(&worker, "the GPU's picture", |snapshot| {
            snapshot.picture.is_some() && !snapshot.progress.is_fallback && snapshot.progress.samples_per_pixel > 0
        });
        renders_as_ever(&worker, EngineKind::Gpu);
    }
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "thorough")]
fn what_is_lost_again_and_again_is_left_to_the_processor() {
    for &moment in MOMENTS {
        let worker = gpu_worker();
        worker.lose_device(moment, 4);
        worker.submit(&long_document(), Pace::Still);
        let told = warnings_until(&worker, "going on with the CPU");
        for time in 1..=3 {
            let word = format!("({time} of 3 times)");
            assert!(told.iter().any(|text| text.contains(&word)), "{moment:?}: {told:?}");
        }
        renders_as_ever(&worker, EngineKind::Cpu);
    }
}

/// What the GPU had handed over is not rendered again.
#[test]
fn what_was_read_back_counts() {
    let mut document = matt_document(0.5);
    document.render.samples = 64;
    let mut session = Session::open(EngineChoice::Gpu).expect("a Vulkan driver: apt install mesa-vulkan-drivers");
    session.submit(&document).expect("a sphere");
    while session.progress().samples_per_pixel < 8 {
        session.step(Duration::ZERO).expect("nothing fails yet");
    }
    session.film().expect("nothing fails yet");
    let had = session.progress().samples_per_pixel;
    session.lose_when(Moment::Rendering, 1);
    let lost = match session.step(Duration::from_secs(60)) {
        Err(SessionError::Gpu(lost)) if lost.is_lost() => lost,
        other => panic!("{other:?}"),
    };
    let told = session.recover(&lost);
    assert!(told.contains("opened again"), "{told}");
    assert_eq!(session.progress().samples_per_pixel, had);
    while !session.step(Duration::from_secs(1)).expect("it is whole again").is_done {}
    let mut alone = Session::open(EngineChoice::Cpu).expect("always");
    alone.submit(&document).expect("a sphere");
    while !alone.step(Duration::from_secs(1)).expect("always").is_done {}
    let [mean, wanted] = [session, alone].map(|mut session| mean(&session.image().expect("it is done")));
    near!(mean / wanted, 1.0, 0.001);
}

#[test]
#[ignore = "the child of the test below: the choice holds for the whole process"]
fn with_ray_queries() {
    MachineOptions::set(RayQueries::On, Default::default());
    a_lost_device_is_opened_anew();
    what_was_read_back_counts();
}

/// The adapter's own hierarchies are lost with it, and built again.
#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "thorough")]
fn a_lost_device_comes_back_with_its_ray_queries() {
    passes_alone("device_loss::with_ray_queries");
}
