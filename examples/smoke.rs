use glossmith::document::{job::*, plan::Plan};
use glossmith::optics::{material::Material, random::Sequence, vector::vec3};
use glossmith::scene::{self, Geometry, ModelSource, camera::*, environment};
use std::{sync::Arc, time::*};
fn main() {
    let model = scene::load(&ModelSource::Teapot).unwrap();
    let t = Instant::now();
    let geometry = Arc::new(Geometry::build(&model, false));
    println!("bvh {:?} tris {}", t.elapsed(), geometry.triangles.len());
    let env_source = std::env::args().nth(1).unwrap_or("studio".into());
    let environment = Arc::new(environment::load(&env_source.parse().unwrap()).unwrap());
    let rough: f32 = std::env::args().nth(2).map_or(0.3, |x| x.parse().unwrap());
    let fresnel: u32 = std::env::args().nth(3).map_or(1, |x| x.parse().unwrap());
    let size: u32 = std::env::args().nth(4).map_or(256, |x| x.parse().unwrap());
    let strategy = match std::env::args().nth(5).as_deref() {
        Some("lobe") => Strategy::Lobe,
        Some("light") => Strategy::Light,
        _ => Strategy::Mis,
    };
    let m = Material::<f32> {
        base_color: vec3(0.8, 0.6, 0.3),
        metalness: 1.0,
        specular_color: vec3(1., 1., 1.),
        specular_weight: 1.,
        eta: vec3(1., 1., 1.),
        ior: 1.5,
        k: vec3(0., 0., 0.),
        roughness: rough,
        emission: vec3(0., 0., 0.),
        anisotropy: 0.,
        rotation_rad: 0.,
        lobe: 0,
        curve: 3,
        horizon: 0,
        fresnel,
        curve_table: 0,
        albedo_table: 0,
        reserved: 0,
    };
    let materials = Arc::new(vec![m]);
    let plan = Plan::new(&materials, &environment, 0.0);
    let (y, p): (f64, f64) = (25f64.to_radians(), 20f64.to_radians());
    let d = 1.05 / 15f64.to_radians().sin();
    let settings = Settings {
        image_size: [size, size],
        camera: Camera::look_at(
            [d * p.cos() * y.sin(), d * p.sin(), d * p.cos() * y.cos()],
            [0.; 3],
            30.,
            1.,
            PixelFilter::Box,
        ),
        background: BackgroundKind::Environment,
        environment_rotation: [1., 0.],
        environment_strength: 1.,
        bounces: std::env::var("B").map_or(16, |b| b.parse().unwrap()),
        sequence: Sequence::Sobol,
        strategy,
        seed: 0,
    };
    let job = Arc::new(Job {
        geometry,
        environment,
        materials,
        tables: Arc::new(vec![0.]),
        settings,
        plan,
    });
    let n = 16;
    let save = |film: &glossmith::analysis::film::Film, name: &str, s: f64| {
        let img = film.image();
        let mean = img.pixels.iter().map(|p| (p[0] + p[1] + p[2]) as f64 / 3.).sum::<f64>() / img.pixels.len() as f64;
        let (lo, hi) = img
            .pixels
            .iter()
            .fold((f32::MAX, 0f32), |a, p| (a.0.min(p[1]), a.1.max(p[1])));
        println!(
            "{name}: mean {mean} min {lo} max {hi} dropped {} rays {} {:.2} Mrays/s {:.2} Msamples/s in {s:.2}s",
            film.dropped,
            film.rays,
            film.rays as f64 / s / 1e6,
            film.samples() as f64 / s / 1e6
        );
        let bytes: Vec<u8> = img
            .pixels
            .iter()
            .flat_map(|p| [0, 1, 2].map(|i| (p[i].clamp(0., 1.).powf(1. / 2.2) * 255.) as u8))
            .collect();
        image::save_buffer(
            format!("out/{name}.png"),
            &bytes,
            img.width,
            img.height,
            image::ColorType::Rgb8,
        )
        .unwrap();
    };
    std::fs::create_dir_all("out").unwrap();
    let mut cpu = glossmith::cpu::CpuEngine::default();
    cpu.submit(job.clone());
    let t = Instant::now();
    cpu.step(Duration::from_secs(100), n);
    save(cpu.film(), "cpu", t.elapsed().as_secs_f64());
    let t = Instant::now();
    let gpu = glossmith::gpu::GpuDevice::open(glossmith::gpu::AdapterKind::Any).unwrap();
    println!("{} {} {:?}", gpu.info.name, gpu.driver(), t.elapsed());
    let mut gpu = glossmith::gpu::GpuEngine::new(gpu).unwrap();
    println!("engine {:?}", t.elapsed());
    gpu.submit(job.clone()).unwrap();
    gpu.step(Duration::from_secs(100), 1).unwrap();
    println!("first {:?}", t.elapsed());
    gpu.submit(job.clone()).unwrap();
    let t = Instant::now();
    gpu.step(Duration::from_secs(100), n).unwrap();
    let film = gpu.film().unwrap().clone();
    save(&film, "gpu", t.elapsed().as_secs_f64());
}
