//! What calls for an effect: for each of the registry the least that does, one channel and one place at a time.

use glossmith::document::effect::{EFFECTS, EffectSwitches, Switch};
use glossmith::document::{
    AreaLight, AreaLightShape, Background, CoatLobe, Denoise, Document, GroundKind, MaterialSettings, Strategy,
    TextureUse,
};
use glossmith::job::effect::{ANY, EffectId};
use glossmith::job::plan::Plan;
use glossmith::optics::curve::Curve;
use glossmith::optics::fresnel::Fresnel;
use glossmith::optics::lobe::{Horizon, Lobe};
use glossmith::render::{EngineChoice, Session};
use glossmith::scene::ModelSource;
use glossmith::scene::environment::EnvironmentSource;
use glossmith::scene::texture::{TextureProjection, TextureTarget, UserTexture};

use crate::gltf_builder::Folder;
use crate::own_textures::own_texture;
use crate::plan::{job, job_in};
use crate::random_documents::small;
use crate::textures::all_at_once;

/// A weight that is hardly there.
const LEAST: f32 = 1e-6;
/// One that lacks as little.
const MOST: f32 = 1.0 - LEAST;

/// Changes a document, with a channel where there is a colour.
type Edit = fn(&mut Document, usize);

/// A document that does not call for an effect, and edits each of which makes it do so.
struct Calls {
    without: fn() -> Document,
    edits: &'static [Edit],
}

/// A sphere of metal, rough all over, alone in a furnace: it calls for nothing that can be left out but its lobe.
fn metal() -> Document {
    let mut document = Document {
        model: ModelSource::Sphere,
        materials: vec![MaterialSettings {
            metalness: 1.0,
            roughness: 0.4,
            lobe: Lobe::Geometric,
            fresnel: Fresnel::Schlick,
            ..MaterialSettings::default()
        }],
        ..small(Document::default())
    };
    document.lighting.environment = EnvironmentSource::Furnace;
    document
}

/// The same, black and not metal: nothing is reflected.
fn black() -> Document {
    let mut document = metal();
    let material = &mut document.materials[0];
    (material.metalness, material.specular_weight, material.base_color) = (0.0, 0.0, [0.0; 3]);
    document
}

/// Clear glass.
fn glass() -> Document {
    let mut document = metal();
    let material = &mut document.materials[0];
    (material.metalness, material.transmission_weight) = (0.0, 1.0);
    (material.transmission_color, material.transmission_depth) = ([1.0; 3], 0.5);
    document
}

/// Two metals on a model of two parts.
fn two_metals() -> Document {
    let mut document = metal();
    document.model = ModelSource::Shaderball;
    document.materials.push(document.materials[0].clone());
    document
}

/// Under an uneven environment a mirror: its light is met in one direction only.
fn mirror() -> Document {
    let mut document = metal();
    document.lighting.environment = EnvironmentSource::Studio;
    document.materials[0].roughness = 0.0;
    document
}

/// A rectangle that is metal, with a texture of every kind that is not looked up.
fn textured(folder: &Folder) -> Document {
    let mut document = small(all_at_once(folder));
    document.ground = false;
    document.lighting.environment = EnvironmentSource::Furnace;
    let material = &mut document.materials[0];
    material.textures = TextureUse::default();
    (material.metalness, material.emission_strength) = (1.0, 0.0);
    let coat = UserTexture {
        projection: TextureProjection::First,
        ..own_texture(folder)
    };
    for target in [
        TextureTarget::Coat,
        TextureTarget::CoatColor,
        TextureTarget::CoatNormal,
        TextureTarget::Film,
        TextureTarget::FilmThickness,
        TextureTarget::Fuzz,
        TextureTarget::FuzzColor,
        TextureTarget::FuzzRoughness,
    ] {
        material.user_textures.set(target, Some(coat.clone()));
    }
    document
}

fn one(channel: usize, value: f32, others: f32) -> [f32; 3] {
    let mut color = [others; 3];
    color[channel] = value;
    color
}

/// What calls for the effect of this name. An effect that is new says so here.
fn calls_for(effect: &str) -> Calls {
    let (without, edits): (fn() -> Document, &'static [Edit]) = match effect {
        "environment" => (
            || {
                let mut document = metal();
                document.lighting.strength = 0.0;
                document
            },
            &[|d, _| d.lighting.strength = LEAST],
        ),
        "light-sampling" => (
            mirror,
            &[
                |d, _| d.materials[0].roughness = 0.002,
                |d, _| (d.materials[0].roughness, d.lighting.strength) = (0.4, LEAST),
                |d, _| (d.materials[0].roughness, d.render.strategy) = (0.4, Strategy::Light),
                |d, c| (d.materials[0].metalness, d.materials[0].base_color) = (MOST, one(c, LEAST, 0.0)),
                |d, _| (d.materials[0].coat_weight, d.materials[0].coat_roughness) = (LEAST, 0.002),
                |d, _| {
                    let material = &mut d.materials[0];
                    (material.metalness, material.transmission_weight) = (0.0, 1.0);
                    material.transmission_roughness = 0.01;
                },
            ],
        ),
        "emitter-sampling" => (
            mirror,
            &[
                |d, c| {
                    d.materials[0].roughness = 0.002;
                    d.lighting.area_lights.push(AreaLight {
                        color: one(c, 1.0, 0.0),
                        strength: LEAST,
                        ..AreaLight::default()
                    });
                },
                |d, c| {
                    let material = &mut d.materials[0];
                    (material.roughness, material.coat_weight, material.coat_roughness) = (0.0, LEAST, 0.002);
                    (material.emission_color, material.emission_strength) = (one(c, LEAST, 0.0), 1.0);
                },
            ],
        ),
        "spot" => (
            metal,
            &[|d, _| {
                d.lighting.area_lights.push(AreaLight {
                    shape: AreaLightShape::Spot,
                    ..AreaLight::default()
                });
            }],
        ),
        "area-lights" => (metal, &[|d, _| d.lighting.area_lights.push(AreaLight::default())]),
        "emission" => (
            metal,
            &[
                |d, c| (d.materials[0].emission_color, d.materials[0].emission_strength) = (one(c, LEAST, 0.0), 1.0),
                |d, c| (d.materials[0].emission_color, d.materials[0].emission_strength) = (one(c, 1.0, 0.0), LEAST),
                |d, c| {
                    d.lighting.area_lights.push(AreaLight {
                        color: one(c, LEAST, 0.0),
                        ..AreaLight::default()
                    });
                },
            ],
        ),
        "background" => (
            || {
                let mut document = metal();
                document.lighting.background = Background::Transparent;
                document
            },
            &[|d, _| d.lighting.background = Background::Environment],
        ),
        "ground" => (metal, &[|d, _| d.ground = true]),
        "shadow-catcher" => (
            || {
                let mut document = metal();
                document.ground = true;
                document
            },
            &[|d, _| d.lighting.ground.kind = GroundKind::ShadowCatcher],
        ),
        "interreflection" => (
            metal,
            &[
                |d, _| d.ground = true,
                |d, _| (d.ground, d.render.bounces) = (true, 1),
                |d, _| d.lighting.area_lights.push(AreaLight::default()),
                |d, _| d.model = ModelSource::Shaderball,
            ],
        ),
        "base" => (
            || {
                let mut document = metal();
                document.materials[0].base_weight = 0.5;
                document
            },
            &[
                |d, c| (d.materials[0].metalness, d.materials[0].base_color) = (MOST, one(c, LEAST, 0.0)),
                |d, _| (d.materials[0].metalness, d.materials[0].base_weight) = (0.0, LEAST),
                |d, _| (d.materials[0].metalness, d.materials[0].transmission_weight) = (0.0, MOST),
                |d, c| {
                    d.ground = true;
                    d.lighting.ground_color = one(c, LEAST, 0.0);
                },
            ],
        ),
        "specular" => (
            black,
            &[
                |d, _| d.materials[0].specular_weight = LEAST,
                |d, _| d.materials[0].transmission_weight = LEAST,
            ],
        ),
        "lobe" => (two_metals, &[|d, _| d.materials[1].lobe = Lobe::Ggx]),
        "curve" => (
            two_metals,
            &[
                |d, _| d.materials[1].curve = Curve::LongTail,
                |d, _| d.materials[0].curve = Curve::Custom,
            ],
        ),
        "anisotropy" => (
            metal,
            &[
                |d, _| d.materials[0].anisotropy = LEAST,
                |d, _| d.materials[0].anisotropy = -LEAST,
                |d, _| (d.materials[0].coat_weight, d.materials[0].coat_anisotropy) = (LEAST, LEAST),
            ],
        ),
        "horizon" => (two_metals, &[|d, _| d.materials[1].horizon = Horizon::Absorb]),
        "fresnel" => (two_metals, &[|d, _| d.materials[1].fresnel = Fresnel::Conductor]),
        "edge-tint" => (
            metal,
            &[
                |d, c| d.materials[0].edge_tint = one(c, MOST, 1.0),
                |d, c| d.materials[0].edge_tint = one(c, 0.0, 1.0),
            ],
        ),
        "diffuse-roughness" => (
            metal,
            &[|d, _| (d.materials[0].metalness, d.materials[0].diffuse_roughness) = (0.0, LEAST)],
        ),
        "multiple-scattering" => (
            metal,
            &[
                |d, _| d.materials[0].lobe = Lobe::Ggx,
                |d, _| (d.materials[0].lobe, d.materials[0].metalness) = (Lobe::GgxNdf, LEAST),
            ],
        ),
        "fuzz" => (metal, &[|d, _| d.materials[0].fuzz_weight = LEAST]),
        "thin-film" => (metal, &[|d, _| d.materials[0].film_weight = LEAST]),
        "coat" => (metal, &[|d, _| d.materials[0].coat_weight = LEAST]),
        "coat-ggx" => (
            metal,
            &[|d, _| (d.materials[0].coat_weight, d.materials[0].coat_lobe) = (LEAST, CoatLobe::Ggx)],
        ),
        "coat-darkening" => (
            metal,
            &[|d, _| (d.materials[0].coat_weight, d.materials[0].coat_darkening) = (LEAST, LEAST)],
        ),
        "coat-absorption" => (
            metal,
            &[
                |d, c| (d.materials[0].coat_weight, d.materials[0].coat_color) = (LEAST, one(c, MOST, 1.0)),
                |d, c| (d.materials[0].coat_weight, d.materials[0].coat_color) = (LEAST, one(c, 0.0, 1.0)),
            ],
        ),
        "transmission" => (
            metal,
            &[
                |d, _| (d.materials[0].metalness, d.materials[0].transmission_weight) = (0.0, LEAST),
                |d, _| (d.materials[0].metalness, d.materials[0].transmission_weight) = (MOST, 1.0),
            ],
        ),
        "absorption" => (
            glass,
            &[
                |d, c| d.materials[0].transmission_color = one(c, MOST, 1.0),
                |d, c| {
                    let material = &mut d.materials[0];
                    (material.transmission_color, material.transmission_weight) = (one(c, 0.0, 1.0), LEAST);
                },
            ],
        ),
        "color-texture" => (metal, &[|d, _| d.materials[0].textures.color = true]),
        "roughness-texture" => (metal, &[|d, _| d.materials[0].textures.roughness = true]),
        "rough-tables" => (
            metal,
            &[
                |d, _| d.materials[0].metalness = LEAST,
                |d, c| (d.materials[0].metalness, d.materials[0].base_color) = (MOST, one(c, LEAST, 0.0)),
                |d, _| (d.materials[0].metalness, d.materials[0].transmission_weight) = (LEAST, 1.0),
            ],
        ),
        "normal-map" => (metal, &[|d, _| d.materials[0].textures.normal = true]),
        "emission-texture" => (metal, &[|d, _| d.materials[0].textures.emission = true]),
        // What vertices say comes with a model: its own tests are in gltf_meaning.rs.
        "vertex-colors" => (metal, &[]),
        "coat-texture" => (
            metal,
            &[
                |d, _| (d.materials[0].textures.coat, d.materials[0].coat_weight) = (true, LEAST),
                |d, _| (d.materials[0].textures.coat_color, d.materials[0].coat_weight) = (true, LEAST),
            ],
        ),
        "coat-normal-map" => (
            metal,
            &[|d, _| (d.materials[0].textures.coat_normal, d.materials[0].coat_weight) = (true, LEAST)],
        ),
        "film-texture" => (
            metal,
            &[
                |d, _| (d.materials[0].textures.film, d.materials[0].film_weight) = (true, LEAST),
                |d, _| (d.materials[0].textures.film_thickness, d.materials[0].film_weight) = (true, LEAST),
            ],
        ),
        "fuzz-texture" => (
            metal,
            &[
                |d, _| (d.materials[0].textures.fuzz, d.materials[0].fuzz_weight) = (true, LEAST),
                |d, _| (d.materials[0].textures.fuzz_color, d.materials[0].fuzz_weight) = (true, LEAST),
                |d, _| (d.materials[0].textures.fuzz_roughness, d.materials[0].fuzz_weight) = (true, LEAST),
            ],
        ),
        "box-projection" => (
            metal,
            &[|d, _| {
                let material = &mut d.materials[0];
                (material.textures.coat, material.coat_weight) = (true, LEAST);
                material.user_textures.get_mut(TextureTarget::Coat).unwrap().projection = TextureProjection::Box;
            }],
        ),
        "alpha" => (metal, &[|d, _| d.materials[0].opacity = MOST]),
        "depth-of-field" => (metal, &[|d, _| d.camera.aperture = f64::from(LEAST)]),
        "firefly-clamp" => (metal, &[|d, _| d.render.firefly_clamp = Some(1e6)]),
        "light-groups" => (metal, &[|d, _| d.lighting.light_groups = true]),
        "adaptive-sampling" => (
            metal,
            &[
                |d, _| d.render.adaptive = Some(true),
                |d, _| d.render.noise = Some(1e-3),
            ],
        ),
        "denoising" | "guides" => (metal, &[|d, _| d.view.denoise = Denoise::Fast]),
        // A file's triangles do: `terminator.rs`.
        "shadow-terminator" => (metal, &[]),
        // Always there.
        "variance" => (metal, &[]),
        // Only where layers are written, which no document says.
        "picture-layers" => (metal, &[]),
        other => panic!("say here what calls for {other}, at its least"),
    };
    Calls { without, edits }
}

/// Whether the kernel's code for an effect is whole; of what has none, whether it is simulated.
fn is_whole(plan: &Plan, name: &str) -> bool {
    let (effect, decision) = plan.table().find(|(effect, _)| effect.name() == name).unwrap();
    match effect.constant() {
        Some(constant) => decision.value == constant.general,
        None => decision.is_on,
    }
}

#[test]
fn the_least_of_an_effect_calls_for_it() {
    let folder = Folder::new();
    let textures = textured(&folder);
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    let mut plan = |document: &Document| job_in(&mut session, document).plan;
    for effect in EFFECTS {
        let name = effect.name();
        let calls = calls_for(name);
        let is_of_texture =
            name.ends_with("-texture") || ["normal-map", "coat-normal-map", "box-projection"].contains(&name);
        let without = if is_of_texture {
            textures.clone()
        } else {
            (calls.without)()
        };
        let is_always = name == "variance";
        assert_eq!(
            is_whole(&plan(&without), name),
            is_always,
            "{name} where nothing calls for it"
        );
        for (number, edit) in calls.edits.iter().enumerate() {
            for channel in 0..3 {
                let mut document = without.clone();
                edit(&mut document, channel);
                assert!(
                    is_whole(&plan(&document), name),
                    "{name} is left out where edit {number} of channel {channel} calls for it"
                );
            }
        }
    }
}

/// A texture's alpha and its mask make holes, a roughness texture has tables over the roughness.
#[test]
fn textures_call_for_what_they_are_the_cause_of() {
    let folder = Folder::new();
    let mut holes = textured(&folder);
    holes.materials[0].textures.opacity = true;
    assert!(job(&holes).plan.has(EffectId::Alpha));
    assert!(!job(&textured(&folder)).plan.has(EffectId::Alpha));
    let mut rough = textured(&folder);
    rough.materials[0].textures.roughness = true;
    let plan = job(&rough).plan;
    // The texture may make it less metallic anywhere.
    assert!(plan.has(EffectId::RoughTables) && plan.has(EffectId::Base));
    rough.materials[0].transmission_weight = LEAST;
    assert!(job(&rough).plan.has(EffectId::Transmission));
}

/// Where materials share a choice the kernel is made for it, where they do not for any.
#[test]
fn choices_are_those_of_the_materials() {
    let value = |document: &Document, name: &str| {
        let plan = job(document).plan;
        let (_, decision) = plan.table().find(|(effect, _)| effect.name() == name).unwrap();
        decision.value
    };
    let mut document = two_metals();
    for lobe in Lobe::ALL {
        document.materials.iter_mut().for_each(|material| material.lobe = *lobe);
        assert_eq!(value(&document, "lobe"), *lobe as u32);
    }
    for fresnel in Fresnel::ALL {
        document
            .materials
            .iter_mut()
            .for_each(|material| material.fresnel = *fresnel);
        assert_eq!(value(&document, "fresnel"), *fresnel as u32);
    }
    // What reflects nothing has no say, what only transmits has.
    let mut document = two_metals();
    let other = &mut document.materials[1];
    (other.lobe, other.specular_weight, other.metalness) = (Lobe::Ggx, 0.0, 0.0);
    assert_eq!(value(&document, "lobe"), Lobe::Geometric as u32);
    document.materials[1].transmission_weight = LEAST;
    assert_eq!(value(&document, "lobe"), ANY);
}

#[test]
fn what_is_left_out_is_counted() {
    let plan = job(&metal()).plan;
    let kernels = EFFECTS.iter().filter(|effect| effect.id.constant().is_some());
    let left_out = kernels.filter(|effect| !is_whole(&plan, effect.name())).count();
    assert!(left_out > 10, "{left_out}");
    assert_eq!(plan.left_out(), left_out);
    assert_eq!(Plan::general().left_out(), 0);
}

#[test]
fn what_cannot_be_switched_is_told_for_its_own_reason() {
    for effect in EFFECTS {
        let name = effect.name();
        for (sign, switch, words) in [
            ('+', Switch::On, "no code that could run"),
            ('-', Switch::Off, "nothing can be rendered"),
        ] {
            let read = format!("{sign}{name}").parse::<EffectSwitches>();
            match read {
                Ok(switches) => assert_eq!(switches.get(effect.id), switch, "{sign}{name}"),
                Err(error) => {
                    assert!(!effect.can_be(switch), "{sign}{name}: {error}");
                    assert!(error.to_string().contains(words), "{sign}{name}: {error}");
                }
            }
        }
    }
}

#[test]
fn a_switch_that_makes_no_difference_stays_automatic() {
    for effect in EFFECTS {
        for &switch in Switch::ALL {
            let mut switches = EffectSwitches::default();
            switches.set(effect.id, switch);
            let expected = if effect.can_be(switch) { switch } else { Switch::Auto };
            assert_eq!(switches.get(effect.id), expected, "{} {switch:?}", effect.name());
        }
    }
}
