//! What the GPU refuses: only a lost device ends it, anything else leaves what was there.

use std::time::{Duration, Instant};

use glossmith::{
    document::Document,
    gpu::{AdapterKind, GpuDevice, GpuError},
    job::film::Image,
    render::{Assets, EngineChoice, EngineKind, Session, SessionError},
    scene::environment::{Environment, EnvironmentSource},
};
use wgpu::{BufferUsages, util::BufferInitDescriptor, util::DeviceExt};

use super::{renders::adjust, worker::small_document};

const STEP: Duration = Duration::from_millis(20);
/// On a machine that has other things to do.
const PATIENCE: Duration = Duration::from_secs(600);
/// More steps than any render here takes.
const STEPS: usize = 3000;

fn gpu() -> Session {
    Session::open(EngineChoice::Gpu).expect("a Vulkan driver: apt install mesa-vulkan-drivers")
}

pub fn render(session: &mut Session) {
    for _ in 0..STEPS {
        if session.step(STEP).expect("nothing fails here").is_done {
            return;
        }
    }
    panic!("it spins: {:?}", session.progress());
}

/// Where the GPU's sums are taken over depends on the clock, and with it their rounding.
pub fn is_alike(a: &Image, b: &Image) -> bool {
    let is_near = |(a, b): (&[f32; 4], &[f32; 4])| {
        let channels = a.iter().zip(b);
        channels
            .into_iter()
            .all(|(a, b)| (a - b).abs() <= 0.0001 * (a + b + 0.01))
    };
    a.pixels.iter().zip(&b.pixels).all(is_near)
}

/// Wider than any adapter's textures: files are made smaller when they are read.
fn too_wide(assets: &Assets) -> EnvironmentSource {
    let width = 1 << 17;
    let texels = vec![[1.0; 4]; width as usize];
    let source = EnvironmentSource::File("wide.hdr".into());
    let environment = Environment::from_texels("wide.hdr".to_owned(), width, 1, texels).expect("texels");
    assets.keep_environment(source.clone(), environment);
    source
}

#[test]
fn a_refused_command_is_told_once_and_the_device_goes_on() {
    let gpu = GpuDevice::open(AdapterKind::Any).expect("a Vulkan driver: apt install mesa-vulkan-drivers");
    let buffer = gpu.device.create_buffer_init(&BufferInitDescriptor {
        label: None,
        contents: &[1; 64],
        usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(&buffer, 0, &buffer, 0, 1 << 20);
    gpu.queue.submit([encoder.finish()]);
    let refused = gpu.wait().expect_err("there are no such bytes");
    assert!(matches!(refused, GpuError::Refused(_)), "{refused}");
    assert!(!refused.is_lost());
    assert_eq!(gpu.read::<u8>(&buffer, 0..64).expect("told already"), [1; 64]);
    gpu.device.destroy();
    for _ in 0..2 {
        assert!(gpu.wait().is_err_and(|error| error.is_lost()));
    }
}

#[test]
fn what_the_adapter_cannot_hold_leaves_the_old_picture_in_the_making() {
    let mut document = small_document();
    document.render.samples = 40;
    let mut undisturbed = gpu();
    undisturbed.submit(&document).expect("a sphere");
    render(&mut undisturbed);
    let mut session = gpu();
    session.submit(&document).expect("a sphere");
    let begun = session
        .step(Duration::ZERO)
        .expect("nothing fails here")
        .samples_per_pixel;
    assert!(begun < 40, "{begun}");
    let wide = too_wide(session.assets());
    let mut refused = document.clone();
    refused.lighting.environment = wide;
    let mut large = document.clone();
    // Not even a row of tiles has room.
    adjust(&mut large, "render.width=8000 render.height=8");
    session.device().expect("it renders").limit_buffers(1 << 20);
    for refused in [&refused, &large] {
        let error = session.submit(refused).expect_err("the adapter can't");
        assert!(
            matches!(error, SessionError::Gpu(ref error) if !error.is_lost()),
            "{error}"
        );
        assert_eq!(session.progress().samples_per_pixel, begun);
    }
    render(&mut session);
    let expected = undisturbed.image().expect("it is done");
    assert!(is_alike(&session.image().expect("it goes on"), &expected));
    // Finished, it stays as well, and the next edit is rendered.
    session.submit(&large).expect_err("the adapter can't");
    assert!(session.step(STEP).expect("nothing to do").is_done);
    assert!(is_alike(&session.image().expect("it stays"), &expected));
    session.device().expect("it renders").limit_buffers(u64::MAX);
    document.materials[0].roughness = 0.9;
    session.submit(&document).expect("another sphere");
    render(&mut session);
    assert_eq!(session.engine().kind, EngineKind::Gpu);
    assert!(!is_alike(&session.image().expect("it is there"), &expected));
}

/// A model in textures and a picture in bands are what an adapter of small bindings has of them.
#[test]
fn small_bindings_show_the_same_picture() {
    let mut document = Document::default();
    adjust(&mut document, "render.width=120 render.height=90 render.samples=4");
    let picture_within = |bytes| {
        let mut session = gpu();
        session.device().expect("it is open").limit_buffers(bytes);
        session.submit(&document).expect("the default scene");
        render(&mut session);
        session.image().expect("it is done")
    };
    let whole = picture_within(u64::MAX);
    assert!(is_alike(&picture_within(100 << 10), &whole));
}

/// Where the processor draws until the kernel is there, it finishes what the GPU can't take.
#[test]
fn the_processor_finishes_what_the_gpu_cannot_take_over() {
    let assets = Assets::default();
    let mut session = Session::open_fluid(EngineChoice::Gpu, assets.clone()).expect("a Vulkan driver");
    let mut document = small_document();
    document.render.samples = 20_000;
    let plain = document.clone();
    document.lighting.environment = too_wide(&assets);
    session.submit(&document).expect("the processor takes it");
    let mut told = Vec::new();
    let begun = Instant::now();
    while told.is_empty() && begun.elapsed() < PATIENCE {
        told.extend(session.step(STEP).err());
    }
    assert!(
        matches!(told.as_slice(), [SessionError::Gpu(GpuError::Unfit { .. })]),
        "{told:?}"
    );
    let before = session.progress();
    assert!(!before.is_fallback && !before.is_done, "{before:?}");
    let after = session.step(10 * STEP).expect("told once");
    assert!(after.samples_per_pixel > before.samples_per_pixel, "it goes on");
    session.submit(&plain).expect("a sphere");
    let begun = Instant::now();
    while session.device().is_none() && begun.elapsed() < PATIENCE {
        session.step(STEP).expect("the GPU can");
    }
    assert!(session.device().is_some(), "the next edit gives the GPU its chance");
}
