//! What kernels leave out shows nowhere: on the processor by taking it out of the job, on the GPU by its kernels.

use std::{collections::HashSet, sync::Arc, time::Duration};

use glossmith::{
    cpu::CpuEngine,
    document::{AreaLight, Document, GroundKind, effect::EFFECTS},
    gpu::{AdapterKind, GpuDevice, GpuEngine},
    job::{Job, Settings, effect::ANY, effect::Decision, film::Film, plan::Plan},
    optics::material::{
        COAT_ABSORBS, COAT_IS_GGX, COMPENSATES, FILM_BANDS, HAS_BOX, HAS_PROFILE, Material, NO_TEXTURE, OVER_AZIMUTH,
        SPARES_METAL, VERTEX_BASE, VERTEX_EMISSION, VERTEX_OPACITY,
    },
    optics::vector::Vec3,
    render::EngineChoice,
    render::Session,
    scene::ModelSource,
    scene::texture::TextureTarget as On,
    store::PRESETS,
};

use crate::{
    cli_support::Workplace,
    fuzz_layer::fuzzy_on_a_box,
    gltf_meaning::shining_by_vertices,
    own_textures::coated_on_a_box,
    plan::job_in,
    random_documents::{apart, of_material, random_document, small},
    renders::adjust,
    support::Random,
    terminator::coarse,
    textures::{all_at_once, coated_all_over},
    thin_film::filmed_on_a_box,
};

/// Takes the textures off these targets.
fn plain(material: &mut Material<f32>, targets: &[On]) {
    for target in targets {
        material.textures[*target as usize] = NO_TEXTURE;
    }
}

/// Takes out of a job what the kernel does without whose constant for this effect has this value.
fn take_out(effect: &str, value: u32, settings: &mut Settings, materials: &mut [Material<f32>]) {
    let without: fn(&mut Material<f32>, u32) = match effect {
        // Their code is guarded on both engines: the processor reads the plan, too.
        "light-sampling" | "emitter-sampling" | "interreflection" | "firefly-clamp" | "guides" => return,
        "light-groups" => return settings.light_groups = 0,
        "depth-of-field" => return settings.camera.lens_radius = 0.0,
        "shadow-catcher" => return settings.catcher = None,
        "shadow-terminator" => return settings.rounds_surfaces = false,
        "lobe" => |material, lobe| material.lobe = lobe,
        "curve" => |material, curve| material.curve = curve,
        "horizon" => |material, horizon| material.horizon = horizon,
        "fresnel" => |material, fresnel| material.fresnel = fresnel,
        "anisotropy" => |material, _| (material.anisotropy, material.coat_anisotropy) = (0.0, 0.0),
        "base" => |material, _| {
            let is_metal = material.metalness >= 1.0 && !material.has_texture(&[On::Metalness]);
            // A metal's colour is that of its reflection.
            if !is_metal && material.transmission_weight < 1.0 {
                material.base_color = Vec3::ZERO;
            }
        },
        "specular" => |material, _| {
            material.specular_weight = 0.0;
            material.flags &= !SPARES_METAL;
        },
        "emission" => |material, _| material.emission = Vec3::ZERO,
        "spot" => |material, _| {
            (material.spot_scale, material.spot_offset) = (0.0, 1.0);
            material.flags &= !HAS_PROFILE;
        },
        "transmission" => |material, _| material.transmission_weight = 0.0,
        "absorption" => |material, _| material.absorption = Vec3::ZERO,
        "edge-tint" => |material, _| material.edge_tint = Vec3::splat(1.0),
        "multiple-scattering" => |material, _| material.flags &= !COMPENSATES,
        "fuzz" => |material, _| material.fuzz_weight = 0.0,
        "thin-film" => |material, _| material.has_film = 0,
        "film-bands" => |material, _| material.flags &= !FILM_BANDS,
        "coat" => |material, _| (material.coat_weight, material.reflecting_ior) = (0.0, material.ior),
        "coat-ggx" => |material, _| material.flags &= !COAT_IS_GGX,
        "coat-darkening" => |material, _| material.coat_darkening = 0.0,
        "coat-absorption" => |material, _| material.flags &= !COAT_ABSORBS,
        "color-texture" => |material, _| {
            plain(material, &[On::BaseColor]);
            material.flags &= !VERTEX_BASE;
        },
        "roughness-texture" => |material, _| plain(material, On::OF_ROUGHNESS),
        "normal-map" => |material, _| plain(material, &[On::Normal]),
        "emission-texture" => |material, _| plain(material, &[On::Emission]),
        "vertex-colors" => |material, _| material.flags &= !(VERTEX_EMISSION | VERTEX_OPACITY),
        "coat-texture" => |material, _| plain(material, On::OF_COAT),
        "coat-normal-map" => |material, _| plain(material, &[On::CoatNormal]),
        "film-texture" => |material, _| plain(material, On::OF_FILM),
        "fuzz-texture" => |material, _| plain(material, On::OF_FUZZ),
        "box-projection" => |material, _| material.flags &= !HAS_BOX,
        "diffuse-roughness" => |material, _| material.diffuse_roughness = 0.0,
        "rough-tables" => |material, _| material.has_rough_tables &= OVER_AZIMUTH,
        "alpha" => |material, _| {
            (material.opacity, material.alpha_cutoff) = (1.0, -1.0);
            plain(material, &[On::Opacity]);
            material.flags &= !VERTEX_OPACITY;
        },
        other => panic!("say here what a kernel reads that does without {other}"),
    };
    materials.iter_mut().for_each(|material| without(material, value));
}

/// The job as the kernel of its plan reads it: without whatever that kernel has no code for.
fn as_its_kernel_reads(job: &Job) -> Job {
    let mut read = job.clone();
    let mut materials = job.materials.to_vec();
    for (effect, decision) in job.plan.table() {
        if effect
            .constant()
            .is_some_and(|constant| constant.general != decision.value)
        {
            take_out(effect.name(), decision.value, &mut read.settings, &mut materials);
        }
    }
    read.materials = Arc::new(materials);
    read
}

/// The job with a kernel that leaves nothing out.
fn generally(job: &Job) -> Job {
    Job {
        plan: Plan::general(),
        ..job.clone()
    }
}

/// Four samples per pixel on the processor.
fn on_cpu(job: Job) -> Film {
    let mut engine = CpuEngine::default();
    engine.submit(Arc::new(job));
    engine.step(Duration::from_secs(1000), 4);
    engine.film().clone()
}

/// The same on the GPU: the engine keeps the kernels that it has compiled.
fn on_gpu(engine: &mut GpuEngine, job: Job) -> Film {
    engine.submit(Arc::new(job)).unwrap();
    engine.step(Duration::from_secs(1000), 4).unwrap();
    engine.film().unwrap().clone()
}

fn gpu() -> GpuEngine {
    GpuEngine::new(GpuDevice::open(AdapterKind::Any).unwrap()).unwrap()
}

/// The two pictures of the same random numbers, bit for bit.
fn assert_same_bits(specialised: &Film, general: &Film, what: &str) {
    let differing = (0..general.pixel_count()).filter(|pixel| specialised.color(*pixel) != general.color(*pixel));
    assert_eq!(differing.count(), 0, "{what}: pixels differ");
    assert_eq!(specialised.dropped(), general.dropped(), "{what}");
}

/// The share of pixels that rounding may move by more than 0.001, and how far it may move the whole image.
pub const ROUNDED_PIXELS: f64 = 0.01;
pub const ROUNDED_WHOLE: f64 = 0.001;

/// Different code orders and fuses the same arithmetic differently, so that last bits differ, and now and then a decision
/// of a path with them: nearly all pixels agree to 0.001, and the whole image does.
pub fn assert_same_but_for_rounding(a: &Film, b: &Film, what: &str) {
    let [off, whole] = apart(&a.luminance(), &b.luminance());
    println!("{:.2} % of pixels off, the whole by {whole:.1e}", 100.0 * off);
    assert!(off < ROUNDED_PIXELS, "{what}: {:.1} % of pixels are off", 100.0 * off);
    assert!(whole < ROUNDED_WHOLE, "{what}: the whole is off by {whole:.1e}");
    assert_eq!(a.dropped(), b.dropped(), "{what}");
}

/// Jobs of documents whose materials and settings call for this and that, most of it at small weights and in one colour: by
/// chance, always the same.
fn random_jobs(count: usize) -> impl Iterator<Item = (Document, Job)> {
    let mut random = Random::new(7);
    let matt = PRESETS.iter().find(|preset| preset.name == "Lambert white");
    let matt = matt.expect("a material without a specular lobe");
    jobs((0..count).map(move |i| {
        let mut document = random_document(&mut random);
        // Few of the materials that are drawn from have no specular lobe.
        if i % 20 == 19 {
            document.materials = vec![matt.clone()];
        }
        document
    }))
}

/// Random documents that are rendered on the processor.
const JOBS: usize = if cfg!(feature = "thorough") { 200 } else { 60 };

/// The jobs that documents are compiled to.
fn jobs(documents: impl IntoIterator<Item = Document>) -> impl Iterator<Item = (Document, Job)> {
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    documents.into_iter().map(move |document| {
        let job = job_in(&mut session, &document);
        (document, job)
    })
}

#[test]
fn what_kernels_leave_out_shows_nowhere() {
    let mut plans = HashSet::new();
    let mut left_out = vec![0; EFFECTS.len()];
    for (document, job) in random_jobs(JOBS) {
        plans.insert(job.plan.specialisation());
        for (count, (effect, decision)) in left_out.iter_mut().zip(job.plan.table()) {
            *count += usize::from(
                effect
                    .constant()
                    .is_some_and(|constant| constant.general != decision.value),
            );
        }
        let specialised = on_cpu(as_its_kernel_reads(&job));
        let general = on_cpu(generally(&job));
        assert_same_bits(&specialised, &general, &format!("{document:?}"));
    }
    assert!(plans.len() > JOBS / 5, "only {} plans were met", plans.len());
    for (effect, count) in EFFECTS.iter().zip(left_out) {
        // No built-in model has textures, colours at vertices or coarse triangles, and hardly a film is thick: theirs are
        // the next test's.
        let of_models = [
            "film-bands",
            "normal-map",
            "coat-normal-map",
            "light-groups",
            "box-projection",
            "vertex-colors",
            "shadow-terminator",
        ];
        let is_of_model = effect.name().ends_with("-texture") || of_models.contains(&effect.name());
        let Some(constant) = effect.id.constant().filter(|_| !is_of_model) else {
            continue;
        };
        // One material reflects in each of them: a choice is always narrowed down.
        let most = if constant.general == ANY { JOBS } else { JOBS - 1 };
        assert!(
            (1..=most).contains(&count),
            "{} is left out of {count} plans",
            effect.name()
        );
    }
}

/// Weak and coloured: documents in which every effect of the materials takes part in the picture, but hardly.
fn weak_documents([folder, of_coat]: [&Workplace; 2]) -> Vec<Document> {
    let mut metals = of_material(ModelSource::Shaderball, PRESETS[0].clone());
    adjust(
        &mut metals,
        "base.metalness=1 specular.fresnel=schlick specular.roughness=0.3 specular.edge_tint=1,0.6,1 \
         specular.anisotropy=0.1 coat.weight=0.04 coat.roughness=0.3 emission.color=0,0,0.02 \
         emission.strength=1 geometry.opacity=0.96",
    );
    let mut rough = of_material(ModelSource::Shaderball, PRESETS[0].clone());
    adjust(
        &mut rough,
        "base.metalness=0.5 base.diffuse_roughness=0.5 fuzz.weight=0.2 thin_film.weight=0.3 thin_film.thickness=2 \
         specular.lobe=ggx specular.roughness=0.5",
    );
    let mut glass = of_material(ModelSource::Shaderball, PRESETS[0].clone());
    adjust(
        &mut glass,
        "base.metalness=0.04 base.color=0,0,0.9 specular.roughness=0.2 transmission.weight=0.5 \
         transmission.color=1,1,0.6 transmission.depth=0.5",
    );
    let mut coated = of_material(ModelSource::Shaderball, PRESETS[0].clone());
    adjust(
        &mut coated,
        "coat.weight=0.5 coat.lobe=ggx coat.roughness=0.5 coat.color=0.9,0.6,0.3 coat.on_base=on",
    );
    glass.camera.aperture = 0.05;
    glass.lighting.area_lights.push(AreaLight::spot());
    glass.ground = true;
    glass.lighting.ground.kind = GroundKind::ShadowCatcher;
    vec![
        metals,
        rough,
        glass,
        coated,
        small(coated_all_over(of_coat)),
        small(all_at_once(folder)),
        coated_on_a_box(folder),
        filmed_on_a_box(folder),
        fuzzy_on_a_box(folder),
        small(coarse(folder)),
        small(shining_by_vertices(folder)),
    ]
}

/// What the kernels of weak effects do without: nothing that shows. Shown on the processor to be seen where it does.
#[test]
fn weak_effects_are_in_their_kernels() {
    // Both write a model of one name.
    let folders = [Workplace::new(), Workplace::new()];
    let mut engine = gpu();
    let mut seen = HashSet::new();
    for (number, (document, job)) in jobs(weak_documents(folders.each_ref())).enumerate() {
        let general = on_cpu(generally(&job));
        for (effect, decision) in job.plan.table() {
            let Some(constant) = effect.constant().filter(|constant| constant.general != ANY) else {
                continue;
            };
            if decision.value == constant.general {
                let plan = job.plan.clone().with(effect, Decision::off("left out on purpose"));
                let without = on_cpu(as_its_kernel_reads(&Job { plan, ..job.clone() }));
                let [off, whole] = apart(&without.luminance(), &general.luminance());
                println!(
                    "without {}: {:.0} % of pixels off, {whole:.1e}",
                    effect.name(),
                    100.0 * off
                );
                if off > 0.05 {
                    seen.insert(effect.name());
                }
            }
        }
        // A kernel takes seconds to compile on a processor.
        if number % 4 > 0 && !cfg!(feature = "thorough") {
            continue;
        }
        let what = format!("{document:?}");
        let [specialised, of_gpu] = [job.clone(), generally(&job)].map(|job| on_gpu(&mut engine, job));
        assert_same_but_for_rounding(&specialised, &of_gpu, &what);
        assert_same_but_for_rounding(&general, &of_gpu, &what);
    }
    // Where emitters and clamp are, nothing interreflects or groups are summed, other tests look.
    for effect in EFFECTS
        .iter()
        .filter(|effect| effect.id.constant().is_some_and(|c| c.general != ANY))
    {
        let elsewhere = [
            "light-sampling",
            "emitter-sampling",
            "interreflection",
            "firefly-clamp",
            "guides",
            "light-groups",
        ];
        assert!(
            seen.contains(effect.name()) || elsewhere.contains(&effect.name()),
            "{} shows in no document",
            effect.name()
        );
    }
}

/// The same paths on both engines: the GPU's by the kernel that leaves nothing out, the processor's without what the plan
/// leaves out. One kernel serves all documents.
#[test]
fn the_general_kernel_draws_what_the_plan_says() {
    let mut engine = gpu();
    let folder = Workplace::new();
    let textured = small(all_at_once(&folder));
    for (document, job) in random_jobs(12).chain(jobs([textured])) {
        let planned = on_cpu(as_its_kernel_reads(&job));
        let general = on_gpu(&mut engine, generally(&job));
        assert_same_but_for_rounding(&planned, &general, &format!("{document:?}"));
    }
}
