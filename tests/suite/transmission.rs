//! Glass: energy, absorption, invisibility, and the strategies and engines against each other.

use std::sync::Arc;
use std::time::Duration;

use glossmith::compile::compile;
use glossmith::cpu::CpuEngine;
use glossmith::document::{Background, Document, ImportLobe, MaterialSettings, Strategy};
use glossmith::job::Job;
use glossmith::job::film::Film;
use glossmith::optics::fresnel::Fresnel;
use glossmith::render::{EngineChoice, Session};
use glossmith::scene::environment::EnvironmentSource;
use glossmith::scene::{Geometry, Model, ModelSource, Slot};

use super::renders::{beyond_three_sigma, document, render, with_strategy};

const ENGINES: [EngineChoice; 2] = [EngineChoice::Cpu, EngineChoice::Gpu];

/// A sphere of clear glass, but for the assignments.
fn glass(light: EnvironmentSource, assignments: &[&str]) -> Document {
    let clear = ["base.metalness=0", "transmission.weight=1", "specular.roughness=0"];
    let mut document = document(ModelSource::Sphere, light, &[&clear, assignments].concat());
    document.lighting.background = Background::Transparent;
    document
}

/// Mean colour of what the camera sees of the model.
fn mean(film: &Film) -> [f64; 3] {
    let alpha: f64 = film.colors().map(|color| color[3]).sum();
    [0, 1, 2].map(|i| film.colors().map(|color| color[i]).sum::<f64>() / alpha)
}

/// What goes in comes out: a surface that absorbs nothing can't be seen where light is equally bright from everywhere.
#[test]
fn what_absorbs_nothing_is_white_in_the_furnace() {
    for choice in ENGINES {
        for assignments in [
            &["specular.ior=1.5"][..],
            &["specular.ior=2.4"],
            &["specular.roughness=0.3"],
            &["specular.roughness=0.7", "specular.curve=long-tail"],
            &["specular.roughness=0.4", "specular.anisotropy=0.6"],
            // Were the reflection smoother and the refraction rough, total reflection would keep some of the light inside
            // for more bounces than there are.
            &["specular.roughness=0.3", "transmission.roughness=-0.15"],
            &["transmission.weight=0.5", "base.color=1,1,1", "specular.roughness=0.6"],
            // The tint and the weight of the reflection leave more to refract.
            &[
                "specular.roughness=0.3",
                "specular.color=0.3,0.3,0.3",
                "specular.weight=0.5",
            ],
            // White metal beside glass, and beside white under a dielectric.
            &["base.metalness=0.5", "base.color=1,1,1", "specular.roughness=0.3"],
            &[
                "base.metalness=0.5",
                "base.color=1,1,1",
                "transmission.weight=0",
                "specular.roughness=0.03",
            ],
            &[
                "base.metalness=0.5",
                "base.color=1,1,1",
                "transmission.weight=0",
                "specular.roughness=0.45",
            ],
            &[
                "base.metalness=0.2",
                "base.color=1,1,1",
                "transmission.weight=0",
                "specular.fresnel=schlick",
                "specular.roughness=0.8",
            ],
        ] {
            let film = render(choice, &glass(EnvironmentSource::Furnace, assignments));
            assert_eq!(film.dropped(), 0);
            for value in mean(&film) {
                assert!((value - 1.0).abs() < 3e-3, "{choice:?}, {assignments:?}: {value}");
            }
        }
    }
}

/// A white base mixed with refraction keeps all light: what the base scatters from within gets out again. At a high index
/// some paths are still within at the last bounce: what they are cut off from is told, and makes up the rest.
#[test]
fn a_white_base_beside_refraction_is_white_in_the_furnace() {
    let mut off = Vec::new();
    for choice in ENGINES {
        for ior in ["1.1", "1.5", "2.4"] {
            for (weight, roughness) in [
                ("0.1", "0"),
                ("0.1", "0.1"),
                ("0.1", "0.3"),
                ("0.5", "0"),
                ("0.5", "0.1"),
                ("0.5", "0.3"),
                ("0.9", "0"),
                ("0.9", "0.1"),
                ("0.9", "0.3"),
            ] {
                let assignments = [
                    &format!("specular.ior={ior}")[..],
                    &format!("transmission.weight={weight}"),
                    &format!("specular.roughness={roughness}"),
                    "base.color=1,1,1",
                ];
                let mut document = glass(EnvironmentSource::Furnace, &assignments);
                (document.render.width, document.render.height, document.render.samples) = (24, 24, 32);
                let film = render(choice, &document);
                let [value, ..] = mean(&film);
                let cut = film.cut_share();
                println!("{choice:?} {assignments:?}: {value:.4}, cut {cut:.5}");
                let (lost, least) = if ior == "2.4" { (cut, 0.99) } else { (0.0, 0.995) };
                if (value + lost - 1.0).abs() > 5e-3 || value < least {
                    off.push(format!("{choice:?} {assignments:?}: {value}"));
                }
            }
        }
    }
    assert!(off.is_empty(), "{off:#?}");
}

/// Light that paths are cut off from at their last bounce is missing from the picture, and told.
#[test]
fn light_cut_at_the_last_bounce_is_told() {
    for choice in ENGINES {
        let cut = |bounces: u32, weight: &str| {
            let white = ["base.color=1,1,1", weight];
            let mut document = glass(EnvironmentSource::Furnace, &white);
            document.lighting.background = Background::Environment;
            (document.render.width, document.render.height) = (32, 32);
            document.render.bounces = bounces;
            let film = render(choice, &document);
            let [value, ..] = mean(&film);
            (1.0 - value, film.cut_share())
        };
        let (missing, estimate) = cut(3, "transmission.weight=0.5");
        assert!(missing > 0.02, "{choice:?}: {missing}");
        assert!(
            (estimate - missing).abs() < 1e-3,
            "{choice:?}: {estimate} estimate, {missing} missing"
        );
        let (missing, estimate) = cut(64, "transmission.weight=1");
        assert!(
            missing.abs() < 1e-3 && estimate < 1e-3,
            "{choice:?}: {estimate} estimate, {missing} missing"
        );
    }
}

/// Mirrors and clear glass do not count towards the bounces from which on Russian roulette is played: what is behind a clear
/// pane has no noise in even light.
#[test]
fn no_albedo_is_gambled_for_behind_clear_glass() {
    let mut document = glass(EnvironmentSource::Furnace, &["specular.ior=1"]);
    document.ground = true;
    document.lighting.ground_color = [0.3, 0.2, 0.1];
    (document.render.width, document.render.height, document.render.samples) = (32, 32, 8);
    for choice in ENGINES {
        let mut without = document.clone();
        without.materials[0].transmission_weight = 0.0;
        without.materials[0].opacity = 0.0;
        let [seen, expected] = [&document, &without].map(|document| spread(&render(choice, document)));
        assert!(seen < 1.05 * expected + 1e-6, "{choice:?}: {seen} against {expected}");
    }
}

/// The sum of the variances of a picture's pixels.
fn spread(film: &Film) -> f64 {
    film.variance_of_mean().iter().sum()
}

/// Single scattering loses what facets shadow, and makes nothing. Multiple scattering keeps it.
#[test]
fn rough_ggx_glass_keeps_its_light() {
    for choice in ENGINES {
        for (roughness, least) in [("0.02", 0.999), ("0.3", 0.93), ("0.6", 0.64), ("0.9", 0.35)] {
            let roughness = format!("specular.roughness={roughness}");
            let of = |scattering: &str| {
                let assignments = ["specular.lobe=ggx", &roughness, scattering];
                mean(&render(choice, &glass(EnvironmentSource::Furnace, &assignments)))[0]
            };
            let [single, all] = ["off", "on"].map(|which| of(&format!("specular.multiple_scattering={which}")));
            println!("{choice:?} {roughness} {single} {all}");
            assert!((least..1.001).contains(&single), "{choice:?}, {roughness}: {single}");
            assert!((all - 1.0).abs() < 0.005, "{choice:?}, {roughness}: {all}");
        }
    }
}

/// With the index of the air around it and no roughness, the sphere is not there.
#[test]
fn glass_with_the_index_of_air_is_invisible() {
    for (lobe, share) in [("geometric", 1e-3), ("ggx", 0.01)] {
        let lobe = format!("specular.lobe={lobe}");
        let mut document = glass(EnvironmentSource::Studio, &["specular.ior=1", &lobe]);
        document.lighting.background = Background::Environment;
        document.render.samples = 16;
        let mut session = Session::open(EngineChoice::Cpu).unwrap();
        session.submit(&document).unwrap();
        let mut engine = CpuEngine::default();
        engine.submit(Arc::new(Job {
            geometry: Arc::new(Geometry::build(&Model::default(), false)),
            ..Job::clone(session.job().unwrap())
        }));
        engine.step(Duration::from_secs(100), 16);
        let empty = engine.film().image();
        for choice in ENGINES {
            let film = render(choice, &document);
            // The sphere is there, and was met: a path through it has more than one ray.
            assert!(
                film.total_rays() > 16 * 64 * 64 * 2,
                "{choice:?} {lobe}: {} rays",
                film.total_rays()
            );
            for (i, (seen, expected)) in film.image().pixels.iter().zip(&empty.pixels).enumerate() {
                for (a, b) in seen.iter().zip(expected) {
                    // GGX's narrowest lobe shadows a little at the edge.
                    let limit = share * (b.abs() + 1.0);
                    assert!(
                        (a - b).abs() < limit,
                        "{choice:?} {lobe}: pixel {i}: {seen:?}, {expected:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn strategies_agree_on_rough_glass() {
    for assignments in [
        &["specular.roughness=0.5"][..],
        &["specular.roughness=0.6", "specular.lobe=ggx", "specular.ior=1.33"],
        &[
            "specular.roughness=0.5",
            "transmission.weight=0.6",
            "base.color=0.8,0.2,0.1",
        ],
    ] {
        let mut document = glass(EnvironmentSource::Studio, assignments);
        // So many that the sums of rare bright paths are near to normal.
        document.render.samples = 1024;
        (document.render.width, document.render.height) = (32, 32);
        let mis = render(EngineChoice::Cpu, &document);
        let lobe = render(EngineChoice::Cpu, &with_strategy(&document, Strategy::Lobe, 2));
        let what = format!("mis against lobe, {assignments:?}");
        let off = mis.difference_in_sigma(&lobe);
        assert!(off.abs() < 4.0, "{what}: {off:.1} sigma");
        let beyond = beyond_three_sigma(&mis, &lobe);
        assert!(
            beyond < 0.02,
            "{what}: {:.2} % of pixels beyond 3 sigma",
            100.0 * beyond
        );
        // Light sampling alone has the rare bright paths of light reflected inside: its pixels are skewed, its sum is not.
        let light = render(EngineChoice::Cpu, &with_strategy(&document, Strategy::Light, 1));
        let off = mis.difference_in_sigma(&light);
        assert!(off.abs() < 4.0, "mis against light, {assignments:?}: {off:.1} sigma");
    }
}

/// The plan leaves out what no material calls for, and a clear material follows the exact equations.
#[test]
fn transmission_is_compiled_in_where_it_is_called_for() {
    let plan = |assignments: &[&str]| {
        let mut session = Session::open(EngineChoice::Cpu).unwrap();
        session.submit(&glass(EnvironmentSource::Furnace, assignments)).unwrap();
        let effects = session.job().unwrap().plan.effects();
        ["transmission", "absorption"].map(|name| effects.contains(&name))
    };
    assert_eq!(plan(&["transmission.weight=0"]), [false, false]);
    assert_eq!(plan(&["base.metalness=1"]), [false, false]);
    assert_eq!(plan(&["transmission.color=0.5,0.5,0.5"]), [true, false]);
    assert_eq!(
        plan(&["transmission.color=0.5,0.5,0.5", "transmission.depth=1"]),
        [true, true]
    );

    let clear = MaterialSettings {
        metalness: 0.0,
        transmission_weight: 1.0,
        transmission_color: [0.25, 1.0, 0.0],
        ..MaterialSettings::default()
    };
    let ([tinted], _) = parts(&clear);
    assert_eq!(tinted.fresnel, Fresnel::Dielectric as u32);
    assert_eq!((tinted.transmission_tint.x, tinted.absorption.x), (0.25, 0.0));
    let deep = MaterialSettings {
        transmission_depth: 2.0,
        ..clear
    };
    let ([deep], _) = parts(&deep);
    assert_eq!(deep.transmission_tint.x, 1.0);
    assert!((deep.absorption.x - 0.5 * 4.0_f32.ln()).abs() < 1e-6 && deep.absorption.y == 0.0);
    assert!(
        deep.absorption.z.is_finite() && deep.absorption.z > 4.0,
        "black absorbs much, not infinitely"
    );
}

fn parts(material: &MaterialSettings) -> ([glossmith::optics::material::Material<f32>; 1], Vec<f32>) {
    let (materials, tables) = compile(std::slice::from_ref(material));
    ([materials[0]], tables)
}

/// glTF: the base colour tints what is transmitted, unless the volume does.
#[test]
fn slots_that_transmit_become_glass() {
    let slot = Slot {
        transmission: 0.875,
        base_color: [0.5, 0.25, 1.0],
        metalness: 0.0,
        ior: 1.75,
        ..Slot::default()
    };
    let material = MaterialSettings::from_slot(&slot, ImportLobe::Ggx);
    assert_eq!((material.transmission_weight, material.ior), (0.875, 1.75));
    assert_eq!(
        (material.transmission_color, material.transmission_depth),
        ([0.5, 0.25, 1.0], 0.0)
    );
    let material = MaterialSettings::from_slot(
        &Slot {
            attenuation_color: [0.1, 0.2, 0.3],
            attenuation_distance: 2.5,
            ..slot
        },
        ImportLobe::Ggx,
    );
    assert_eq!(
        (material.transmission_color, material.transmission_depth),
        ([0.1, 0.2, 0.3], 2.5)
    );
    let opaque = MaterialSettings::from_slot(&Slot::neutral("wall"), ImportLobe::Ggx);
    assert_eq!((opaque.transmission_weight, opaque.transmission_color), (0.0, [1.0; 3]));
}
