//! Paths one by one: their accounts add up to what the engine adds, and no random number serves twice.

use std::{collections::HashSet, time::Duration};

use glossmith::{
    cpu::{
        integrator::PathResult,
        oracle::{PathTracer, TileSamples, trace_tile},
        recorder::{Event, Purpose},
    },
    document::{AreaLight, Document, MaterialSettings, Strategy, effect::EffectSwitches},
    job::tiles::TileGrid,
    optics::{layer::decides_by_facet, lobe::Lobe, random::Sequence},
    render::{EngineChoice, Session},
    scene::{Model, ModelSource, Slot, environment::EnvironmentSource},
    study::explain::explain,
};

use crate::{
    analytic_media::ball_with_inserts,
    analytic_scenes::room,
    lights::lit_scenes,
    random_documents::random_document,
    renders::{adjust, document},
    support::{Random, sets},
};

/// A document and the model that it names, where that is not built in.
pub struct Scene {
    pub name: &'static str,
    pub document: Document,
    pub model: Option<Model>,
}

fn scene(name: &'static str, model: ModelSource, light: EnvironmentSource, assignments: &[&str]) -> Scene {
    let mut document = document(model, light, assignments);
    adjust(&mut document, "render.width=32 render.height=32 render.samples=1");
    Scene {
        name,
        document,
        model: None,
    }
}

fn lit(document: &mut Document) {
    document.lighting.area_lights = vec![AreaLight {
        width: 1.5,
        height: 1.5,
        strength: 6.0,
        ..AreaLight::default()
    }];
}

/// Scenes in which paths do everything there is to do.
pub fn scenes() -> Vec<Scene> {
    let tinted = [
        "base.metalness=0 transmission.weight=0.8 transmission.color=0.8,0.5,0.3 transmission.depth=1 specular.roughness=0.4 specular.ior=1.8",
    ];
    let mut glass = scene("glass", ModelSource::Sphere, EnvironmentSource::Studio, &tinted);
    glass.document.ground = true;
    lit(&mut glass.document);
    let coated =
        ["base.metalness=0.4 specular.roughness=0.5 coat.weight=0.7 coat.roughness=0.4 coat.color=0.9,0.7,0.5"];
    let mut coat = scene("coat", ModelSource::Shaderball, EnvironmentSource::Sky, &coated);
    coat.document.ground = true;
    coat.document.camera.aperture = 0.1;
    let mut holes = scene(
        "holes",
        ModelSource::Shaderball,
        EnvironmentSource::Studio,
        &["geometry.opacity=0.6 base.metalness=0 specular.roughness=0.6"],
    );
    holes.document.lighting.background_blur_deg = 20.0;
    lit(&mut holes.document);
    let shining = ["base.metalness=0.3 base.color=0.9,0.7,0.5 specular.roughness=0.7 emission.strength=1"];
    let mut closed = scene(
        "room",
        ModelSource::File("room".into()),
        EnvironmentSource::Studio,
        &shining,
    );
    closed.document.camera.position = Some([0.3, 0.2, 0.1]);
    closed.document.camera.target = Some([-0.4, 0.1, 0.9]);
    closed.document.camera.fov_deg = 60.0;
    closed.model = Some(Model {
        name: "room".to_owned(),
        mesh: room(),
        slots: vec![Slot::neutral("walls")],
        ..Model::default()
    });
    vec![glass, coat, holes, closed, amber(&tinted)]
}

/// A ball that absorbs and refracts, with something matt and something that shines in it.
fn amber(tinted: &[&str]) -> Scene {
    let mut amber = scene(
        "amber",
        ModelSource::File("amber".into()),
        EnvironmentSource::Studio,
        tinted,
    );
    let shining = MaterialSettings {
        emission_strength: 3.0,
        ..MaterialSettings::diffuse("shining", [0.2; 3])
    };
    amber
        .document
        .materials
        .extend([MaterialSettings::diffuse("matt", [0.8; 3]), shining]);
    amber.model = Some(Model {
        name: "amber".to_owned(),
        mesh: ball_with_inserts(),
        slots: ["ball", "plate", "zone"].map(Slot::neutral).into(),
        ..Model::default()
    });
    amber
}

/// A session of the processor with this scene submitted.
fn submitted(scene: &Scene, document: &Document) -> Session {
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    if let Some(model) = &scene.model {
        session.assets().keep_model(document.model.clone(), model.clone());
    }
    session.submit(document).unwrap();
    session
}

/// Where fireflies are limited.
const LIMIT: f32 = 0.5;

#[test]
fn an_account_adds_up_to_what_the_engine_adds() {
    for scene in scenes() {
        for strategy in Strategy::ALL {
            let mut document = scene.document.clone();
            (document.render.samples, document.render.strategy) = (2, *strategy);
            document.render.firefly_clamp = Some(LIMIT);
            let mut session = submitted(&scene, &document);
            while !session.step(Duration::from_secs(1)).unwrap().is_done {}
            let (job, film) = (session.job().unwrap().clone(), session.film().unwrap().clone());
            let model = session.assets().model(&document.model, &document.import).unwrap();
            for index in (0..film.pixel_count()).step_by(7) {
                let pixel = [index as u32 % film.width, index as u32 / film.width];
                let accounts = [0, 1].map(|sample| explain(&document, &model, &job, pixel, sample));
                for account in &accounts {
                    assert_eq!(account.sum(), account.radiance, "{}: {account}", scene.name);
                    let fault = unlimited(&account.events);
                    assert!(fault.is_none(), "{}: {fault:?}\n{account}", scene.name);
                }
                let [even, odd] = accounts.map(|account| account.radiance.map(f64::from));
                let sum = [0, 1, 2].map(|i| even[i] + odd[i]);
                assert_eq!(sum, film.color(index)[..3], "{} {strategy:?} {pixel:?}", scene.name);
            }
        }
    }
}

/// A contribution of a path whose reflections are not those of the bounce that it is found at, or that is not limited.
fn unlimited(events: &[Event]) -> Option<&Event> {
    let (mut bounce_here, mut reflections_here) = (0, 0);
    events.iter().find(|event| match event {
        Event::Hit { bounce, .. } => {
            (bounce_here, reflections_here) = (*bounce, *bounce);
            false
        }
        // Towards a light, or on the way on, it is reflected here.
        Event::Light { .. } | Event::Scattered { .. } => {
            reflections_here = bounce_here + 1;
            false
        }
        Event::Contribution { reflections, added, .. } => {
            let is_limited = *reflections <= 1 || added.iter().all(|x| *x <= LIMIT * 1.000_01);
            *reflections != reflections_here || !is_limited
        }
        _ => false,
    })
}

/// What is wrong with the numbers of a path: one that is drawn twice, or an event that was not given its own.
/// `decides_by_facet` tells of which slots the number that chooses a layer is drawn: elsewhere the lobe's numbers choose it.
fn misdrawn(events: &[Event], decides_by_facet: impl Fn(u32) -> bool) -> Option<String> {
    let mut slot_here = 0;
    let mut drawn = HashSet::new();
    let mut fresh: Vec<(Purpose, f32)> = Vec::new();
    for event in events {
        let count = |purpose| fresh.iter().filter(|(of, _)| *of == purpose).count();
        let wanted = match event {
            Event::Number {
                dimension,
                half,
                value,
                purpose,
            } => {
                if !drawn.insert((*dimension, *half)) {
                    return Some(format!(
                        "number {half} of pair {dimension} is drawn again, for {purpose:?}"
                    ));
                }
                fresh.push((*purpose, *value));
                continue;
            }
            Event::Camera { .. } => count(Purpose::Pixel) == 2,
            Event::Light { .. } => count(Purpose::Light) == 3,
            Event::CatcherHit { .. } => count(Purpose::Catcher) == 1,
            Event::Scattered { .. } => {
                let layers = usize::from(decides_by_facet(slot_here));
                count(Purpose::Lobe) == 3 && count(Purpose::Layer) == layers
            }
            Event::Roulette { number, .. } => fresh == [(Purpose::Roulette, *number)],
            Event::Hit { slot, .. } => {
                slot_here = *slot;
                continue;
            }
            _ => continue,
        };
        if !wanted {
            return Some(format!("{event:?} was given {fresh:?}"));
        }
        fresh.clear();
    }
    None
}

/// Random documents, of every lobe with each of its curves.
fn random_scenes(seed: u64) -> impl Iterator<Item = Scene> {
    let mut random = Random::new(seed);
    let lobes = Lobe::ALL
        .iter()
        .flat_map(|lobe| lobe.curves().iter().map(move |curve| (*lobe, *curve)));
    lobes.map(move |(lobe, curve)| {
        let mut document = random_document(&mut random);
        (document.materials[0].lobe, document.materials[0].curve) = (lobe, curve);
        Scene {
            name: "random",
            document,
            model: None,
        }
    })
}

#[test]
fn no_number_of_a_path_is_drawn_twice() {
    let mut met = HashSet::new();
    for mut scene in scenes().into_iter().chain(random_scenes(3)) {
        scene.document.render.effects = EffectSwitches::all_on();
        for sequence in Sequence::ALL {
            scene.document.render.sequence = *sequence;
            let session = submitted(&scene, &scene.document);
            let job = session.job().unwrap();
            let tracer = PathTracer::new(job);
            let [width, height] = job.settings.image_size;
            for index in (0..width * height).step_by(17) {
                let mut events = Vec::new();
                tracer.record([index % width, index / width], index % 3, &mut events);
                let fault = misdrawn(&events, |slot| decides_by_facet(&job.materials[slot as usize]));
                assert!(fault.is_none(), "{}, {sequence:?}: {fault:?}\n{events:#?}", scene.name);
                met.extend(events.iter().filter_map(|event| match event {
                    Event::Number { purpose, .. } => Some(*purpose),
                    _ => None,
                }));
            }
        }
    }
    assert_eq!(met.len(), 10, "of ten purposes only {met:?} were met");
}

/// All numbers of a path, as bits.
fn bits(path: &PathResult) -> Vec<u32> {
    let guides = &path.guides;
    let numbers = [path.alpha, path.clamped, guides.hits, guides.depth];
    let colors = [path.radiance.to_f32(), guides.albedo, guides.normal];
    let numbers = numbers.into_iter().chain(colors.into_iter().flatten());
    numbers.map(f32::to_bits).chain([path.rays]).collect()
}

/// The engine has the paths of a tile go on together, in lanes of any instruction set: each must find what it finds alone,
/// as it is told of by `explain`. So lobes give the same bits in lanes as alone.
#[test]
fn paths_find_the_same_together_as_alone_to_the_last_bit() {
    let lit = lit_scenes().into_iter().map(|(name, document)| Scene {
        name,
        document,
        model: None,
    });
    let mut rays = 0;
    for scene in scenes().into_iter().chain(random_scenes(29)).chain(lit) {
        let session = submitted(&scene, &scene.document);
        let job = session.job().unwrap();
        let tracer = PathTracer::new(job);
        let [width, height] = job.settings.image_size;
        let grid = TileGrid { width, height };
        for tile in (0..grid.tiles()).step_by(3) {
            let [left, top] = grid.origin(tile);
            // Two tiles, where there are.
            let size = [(width - left).min(16), grid.size(tile)[1]];
            let [first, count] = [tile as u32 % 3, 1 + tile as u32 / 3 % 8];
            let pixels = size[0] * size[1];
            let place = |pixel: u32| [left + pixel % size[0], top + pixel / size[0]];
            let alone = |path: u32| tracer.trace(place(path % pixels), first + path / pixels);
            let alone: Vec<_> = (0..count * pixels).map(alone).collect();
            for (set, level) in sets() {
                let (origin, samples) = ([left, top], [first, count]);
                let together = trace_tile(job, level, TileSamples { origin, size, samples });
                for (path, alone) in together.iter().zip(&alone) {
                    assert_eq!(
                        bits(path),
                        bits(alone),
                        "{} under {set}, {size:?} pixels from {origin:?}, samples {samples:?}: {path:?} for {alone:?}: {:?}",
                        scene.name,
                        scene.document
                    );
                    rays += path.rays;
                }
            }
        }
    }
    assert!(rays > 10_000, "{rays} rays tell nothing");
}
