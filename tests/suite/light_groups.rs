//! Light groups: their light adds up to all light on both engines, each is the light of its sources alone, and their mix
//! needs no new samples.

use super::{
    cli_support::Workplace,
    cli_support::channels,
    lights::lit_scenes,
    renders::{adjust, document, render},
};
use glossmith::{
    document::{AreaLight, Background, Document, GroundKind, GroupName, LightMix, light_groups::emission_group},
    job::film::Film,
    render::{EngineChoice, Session},
    scene::{ModelSource, environment::EnvironmentSource},
};
use std::collections::BTreeSet;

/// Scenes whose groups are summed apart: with lights, emission and a shadow catcher, of few samples.
fn scenes() -> Vec<(&'static str, Document)> {
    let mut scenes = lit_scenes();
    for kind in [Background::Environment, Background::Transparent] {
        let mut caught = document(ModelSource::Teapot, EnvironmentSource::Sky, &["base.metalness=0"]);
        caught.ground = true;
        (caught.lighting.ground.kind, caught.lighting.ground.reflection) = (GroundKind::ShadowCatcher, 0.5);
        caught.lighting.background = kind;
        caught.lighting.area_lights = vec![AreaLight::default()];
        scenes.push(("shadow catcher", caught));
    }
    for (_, document) in &mut scenes {
        adjust(document, "render.width=24 render.height=24 render.samples=6");
        document.lighting.light_groups = true;
        if let Some(light) = document.lighting.area_lights.first_mut() {
            light.group = GroupName::new("key");
        }
    }
    scenes
}

/// Sums of a group over the image, or of all light.
fn total(film: &Film, group: Option<usize>) -> f64 {
    let of_pixel = |pixel: usize| match group {
        Some(group) => film.lights(pixel)[group].as_flattened().iter().sum(),
        None => film.color(pixel)[..3].iter().sum::<f64>(),
    };
    (0..film.pixel_count()).map(of_pixel).sum()
}

#[test]
fn the_groups_are_all_light_on_both_engines() {
    for (name, document) in scenes() {
        let films = [EngineChoice::Cpu, EngineChoice::Gpu].map(|engine| render(engine, &document));
        let groups = document.light_groups();
        for film in &films {
            assert_eq!(film.light_groups(), groups.len(), "{name}");
            for pixel in 0..film.pixel_count() {
                for (number, half) in film.pixels[pixel].iter().enumerate() {
                    for channel in 0..3 {
                        let parts: f64 = film.lights(pixel).iter().map(|sums| sums[number][channel]).sum();
                        let whole = half.color[channel];
                        near!(parts, whole, 1e-5 * (1.0 + whole), "{name}");
                    }
                }
            }
        }
        let [cpu, gpu] = &films;
        for (group, name) in groups.iter().enumerate() {
            let [on_cpu, on_gpu] = [cpu, gpu].map(|film| total(film, Some(group)));
            let whole = total(cpu, None);
            println!("{name}: {on_cpu} and {on_gpu} of {whole}");
            // Rounding sends a few paths elsewhere.
            near!(on_cpu, on_gpu, 0.02 * whole, "{name}");
        }
    }
}

#[test]
fn groups_change_no_bit_of_the_image() {
    for (name, document) in scenes() {
        let mut together = document.clone();
        together.lighting.light_groups = false;
        let [apart, together] = [&document, &together].map(|document| render(EngineChoice::Cpu, document));
        assert_eq!(together.light_groups(), 0);
        for pixel in 0..apart.pixel_count() {
            assert_eq!(apart.pixels[pixel], together.pixels[pixel], "{name}, pixel {pixel}");
            assert_eq!(apart.color(pixel), together.color(pixel), "{name}, pixel {pixel}");
        }
    }
}

/// A group's light is that of a render in which nothing else shines.
#[test]
fn a_group_is_the_light_of_its_sources() {
    let (_, mut document) = lit_scenes().swap_remove(0);
    document.lighting.light_groups = true;
    let [key, rim] = ["key", "rim"].map(GroupName::new);
    document.lighting.area_lights.truncate(1);
    let mut other = AreaLight {
        yaw_deg: 120.0,
        ..document.lighting.area_lights[0]
    };
    (document.lighting.area_lights[0].group, other.group) = (key, rim);
    document.lighting.area_lights.push(other);
    document.render.samples = 256;
    let film = render(EngineChoice::Cpu, &document);
    let names: BTreeSet<String> = document.light_groups().into_iter().map(String::from).collect();
    assert_eq!(names.len(), 3);
    for (group, name) in document.light_groups().into_iter().enumerate() {
        let mut alone = document.clone();
        alone.lighting.light_groups = false;
        for light in &mut alone.lighting.area_lights {
            // It still shadows, but sends no light.
            light.strength *= f32::from(u8::from(light.group == name));
        }
        if group > 0 {
            alone.lighting.strength = 0.0;
        }
        let (apart, alone) = (
            total(&film, Some(group)),
            total(&render(EngineChoice::Cpu, &alone), None),
        );
        println!("{name}: {apart} and {alone}");
        near!(apart / alone, 1.0, 0.02, "{name}");
    }
}

#[test]
fn a_mix_is_the_weighed_sum_and_starts_nothing_over() {
    let (_, mut document) = scenes().swap_remove(0);
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    let before = super::plan::film(&mut session, &document);
    document.set_light_mix(LightMix {
        factor: 3.0,
        color: [1.0, 0.5, 0.0],
        ..LightMix::of(GroupName::new("key"))
    });
    let change = session.submit(&document).unwrap();
    assert!(change.display && !change.restarts());
    let number = document.light_groups().iter().position(|name| name.as_str() == "key");
    let number = number.expect("it shines");
    let mixed = session.image().unwrap();
    for (pixel, found) in mixed.pixels.iter().enumerate() {
        let samples = before.samples_of(pixel);
        for (channel, factor) in [3.0, 1.5, 0.0].into_iter().enumerate() {
            let [even, odd] = before.lights(pixel)[number];
            let of_key = (even[channel] + odd[channel]) / samples;
            let expected = before.mean(pixel)[channel] + (factor - 1.0) * of_key;
            let found = f64::from(found[channel]);
            near!(found, expected, 1e-5 * (1.0 + expected));
        }
    }
    // The denoiser gets the mix as well.
    assert_eq!(session.noisy().unwrap().image.pixels, mixed.pixels);
    let layers = session.layers().unwrap();
    assert_eq!(layers.image.pixels, mixed.pixels);
    assert_eq!(layers.lights.len(), document.light_groups().len());
    assert_eq!(layers.lights[number].1.pixels, before.light_image(number).pixels);
    assert_eq!(session.progress().samples_per_pixel, document.render.samples);
}

#[test]
fn the_command_line_writes_and_mixes_groups() {
    let place = Workplace::new();
    let scene = "--model sphere --size 16x16 --samples 4 --light-groups --area-light 20,30,3,1,1,10,group=key \
                 --spot yaw=-60,power=3 --sun strength=2";
    place.done(&format!("render {scene} --engine cpu --output cpu.exr --output a.png"));
    let layers = channels(&place.path("cpu.exr"));
    let written: BTreeSet<&str> = layers.keys().filter_map(|name| name.strip_prefix("light.")).collect();
    let names = ["environment", "key", "lights", "sun"];
    let expected = names
        .iter()
        .flat_map(|name| ["R", "G", "B"].map(|channel| format!("{name}.{channel}")));
    assert_eq!(
        written,
        expected.collect::<BTreeSet<_>>().iter().map(String::as_str).collect()
    );
    // The image keeps its groups and their mix; the layers stay as they were rendered.
    place.done("render a.png --engine cpu --light-mix key=0 --light-mix sun=2,#ff0000 --output b.exr --output b.png");
    let [before, after] = ["cpu.exr", "b.exr"].map(|name| channels(&place.path(name)));
    assert_eq!(before["light.key.R"], after["light.key.R"]);
    for (channel, sun) in [("R", 2.0), ("G", 0.0)] {
        for (pixel, found) in after[channel].iter().enumerate() {
            let of = |name: &str| before[&format!("light.{name}.{channel}")][pixel];
            let expected = of("environment") + of("lights") + sun * of("sun");
            near!(found, expected, 1e-5 * (1.0 + expected));
        }
    }
    place.done("render b.png --engine cpu --output c.exr");
    assert_eq!(channels(&place.path("c.exr")), after);
    place.refused(1, "render --light-mix key=1 --output x.png", &["key", "--light-groups"]);
    place.refused(
        1,
        &format!("render {scene} --light-mix rim=1"),
        &["rim", "environment, key, lights, sun"],
    );
    place.refused(2, "render --light-mix key", &["GROUP=FACTOR"]);
    place.refused(2, "render --light-mix key=-1", &["-1", "0 to 1000"]);
    place.refused(2, "render --spot group=a.b", &["a.b", "letters"]);
}

#[test]
fn a_name_has_what_a_layer_may_be_called() {
    for (text, name) in [
        ("key", "key"),
        ("Rim light 2", "Rim-light-2"),
        ("a.b/ä", "ab"),
        ("", ""),
        ("0123456789012345678901234567", "012345678901234567890123"),
    ] {
        assert_eq!(GroupName::new(text).as_str(), name);
    }
}

#[test]
fn groups_are_those_of_what_shines() {
    let mut document = Document::default();
    assert!(document.light_groups().is_empty());
    document.lighting.light_groups = true;
    let key = AreaLight {
        group: GroupName::new("key"),
        ..AreaLight::default()
    };
    let muted = AreaLight {
        is_muted: true,
        group: GroupName::new("muted"),
        ..key
    };
    document.lighting.area_lights = vec![AreaLight::default(), key, muted, AreaLight::sun(), AreaLight::spot()];
    let names: Vec<_> = document.light_groups().into_iter().map(String::from).collect();
    assert_eq!(names, ["environment", "lights", "key", "sun"]);
    document.materials[0].emission_strength = 1.0;
    assert_eq!(document.light_groups()[1], emission_group());
    document.set_light_mix(LightMix {
        factor: 0.5,
        color: [1.0, 0.5, 0.0],
        ..LightMix::of(key.group)
    });
    assert_eq!(document.light_factors()[3], [0.5, 0.25, 0.0]);
    document.set_light_mix(LightMix::of(key.group));
    assert!(document.lighting.light_mix.is_empty());
}
