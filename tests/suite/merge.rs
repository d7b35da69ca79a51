//! One picture's samples rendered apart and joined.

use std::{collections::HashMap, path::Path};

use exr::prelude::{FlatSamples, ReadChannels as _, ReadLayers as _, read};

use crate::cli_support::{Workplace, channels, read_exr};

const SCENE: &str = "--engine cpu --model sphere --material car-paint-red --size 40x24 --background transparent";

/// All channels of a film, the sums to the bit.
fn bits(path: &Path) -> HashMap<String, Vec<u32>> {
    let reader = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes();
    let channels = reader.from_file(path).unwrap().layer_data.channel_data.list;
    let bits = |samples: FlatSamples| match samples {
        FlatSamples::U32(words) => words,
        FlatSamples::F32(numbers) => numbers.into_iter().map(f32::to_bits).collect(),
        FlatSamples::F16(_) => panic!("no half floats are written"),
    };
    channels
        .into_iter()
        .map(|channel| (channel.name.to_string(), bits(channel.sample_data)))
        .collect()
}

/// Colours, coverage and counts are the same to the bit. Deviations are those of the parts put together, by another formula than
/// one after the other; what is seen first is summed in f32, in another order.
fn assert_joined(joined: &HashMap<String, Vec<u32>>, whole: &HashMap<String, Vec<u32>>) {
    assert_eq!(joined.len(), whole.len());
    for (channel, expected) in whole {
        if channel.starts_with("sums.guides.") && !channel.ends_with("samples") {
            for (a, b) in joined[channel].iter().zip(expected) {
                let (a, b) = (f32::from_bits(*a), f32::from_bits(*b));
                near!(a, b, 1e-5 * (1.0 + a.abs()), "{channel}");
            }
        } else if !channel.ends_with("deviations") {
            assert!(joined[channel] == *expected, "{channel}");
        }
    }
}

#[test]
fn parts_of_the_samples_joined_are_the_picture_of_one_run() {
    let place = Workplace::new();
    place.done(&format!("render {SCENE} --samples 32 --keep-sums --output whole.exr"));
    for (from, to) in [(0, 7), (7, 20), (20, 32)] {
        place.done(&format!(
            "render {SCENE} --samples-from {from} --samples-to {to} --keep-sums --output {from}.exr"
        ));
    }
    assert!(place.path("7.exr").is_file());
    // In any order, and in two steps.
    place.done("merge 20.exr 0.exr 7.exr --output joined.exr --output joined.png");
    place.done("merge 7.exr 0.exr --output first.exr");
    place.done("merge first.exr 20.exr --output steps.exr");
    let whole = bits(&place.path("whole.exr"));
    for name in ["joined.exr", "steps.exr"] {
        assert_joined(&bits(&place.path(name)), &whole);
    }
    let part = read_exr(&place.path("7.exr"));
    assert!(
        part.difference(&read_exr(&place.path("whole.exr"))) > 0.01,
        "other samples"
    );
    assert!(place.path("joined.png").is_file());
}

/// Renders a scene as a whole, and in two parts that are joined.
fn render_whole_and_joined(place: &Workplace, scene: &str) {
    for (samples, name) in [
        ("--samples 9", "whole"),
        ("--samples-to 4", "a"),
        ("--samples-from 4 --samples-to 9", "b"),
    ] {
        place.done(&format!("render {scene} {samples} --keep-sums --output {name}.exr"));
    }
    place.done("merge a.exr b.exr --output joined.exr");
}

/// Light groups: the sums of each and the mix.
#[test]
fn light_groups_join_with_their_mix() {
    let place = Workplace::new();
    let scene = format!("{SCENE} --light-groups --area-light 20,30,3,1,1,10,group=key --light-mix key=0.25,#ff8000");
    render_whole_and_joined(&place, &scene);
    let [joined, whole] = ["joined.exr", "whole.exr"].map(|name| bits(&place.path(name)));
    assert!(whole.contains_key("light.key.R") && whole.contains_key("sums.light.key.odd.B.low"));
    assert_joined(&joined, &whole);
    place.done(&format!(
        "render {SCENE} --samples-from 4 --samples-to 9 --keep-sums --output b.exr"
    ));
    place.refused(1, "merge a.exr b.exr --output x.exr", &["b.exr", "another image"]);
}

/// Films that end at a noise or with a time, whose pixels have as many samples as they have: each pixel's mean is that of all
/// of its samples.
#[test]
fn films_with_unequal_pixels_join_sample_by_sample() {
    let place = Workplace::new();
    for (more, name) in [
        ("--adaptive on --noise 0.05 --min-samples 2 --samples-to 40", "a"),
        ("--time 0.2 --samples-from 1000 --samples-to 2000", "b"),
    ] {
        place.done(&format!("render {SCENE} {more} --keep-sums --output {name}.exr"));
    }
    let told = place
        .done("merge b.exr a.exr --output joined.exr --aovs --json -")
        .stdout;
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    assert_eq!(told["samples"][1][0], 1000);
    let [a, b, joined] = ["a", "b", "joined"].map(|name| channels(&place.path(format!("{name}.exr"))));
    let [counts_a, counts_b] = [&a, &b].map(|film| {
        let both = film["sums.even.samples"].iter().zip(&film["sums.odd.samples"]);
        both.map(|(even, odd)| even + odd).collect::<Vec<f32>>()
    });
    assert!(counts_a.iter().any(|n| *n != counts_a[0]), "all pixels have as many");
    for (pixel, (n, m)) in counts_a.iter().zip(&counts_b).enumerate() {
        assert_eq!(joined["samples.Y"][pixel], n + m);
        let mean =
            (f64::from(a["R"][pixel]) * f64::from(*n) + f64::from(b["R"][pixel]) * f64::from(*m)) / f64::from(n + m);
        let found = f64::from(joined["R"][pixel]);
        near!(found, mean, 1e-6 * (1.0 + mean), "{pixel}");
    }
}

/// What is seen first travels with the sums.
#[test]
fn joined_films_have_the_layers_and_the_denoised_picture_of_one_run() {
    let place = Workplace::new();
    place.done(&format!(
        "render {SCENE} --samples 96 --aovs --denoise high --output whole.exr"
    ));
    for (from, to) in [(0, 5), (5, 80), (80, 96)] {
        place.done(&format!(
            "render {SCENE} --samples-from {from} --samples-to {to} --keep-sums --output {from}.exr"
        ));
    }
    // In two steps: what was joined has them as well.
    place.done("merge 0.exr 5.exr --output first.exr");
    let told =
        place.done("merge first.exr 80.exr --aovs --denoise high --output joined.exr --output joined.png --json -");
    let told: serde_json::Value = serde_json::from_str(&told.stdout).unwrap();
    assert!(told["denoised_error"].as_f64().is_some(), "{told}");
    let [whole, joined] = ["whole", "joined"].map(|name| channels(&place.path(format!("{name}.exr"))));
    for (name, expected) in &whole {
        let tolerance = match name.as_str() {
            "variance.Y" => 0.0001,
            name if name.starts_with("denoised") => 0.002,
            _ => 1e-5,
        };
        for (pixel, (a, b)) in expected.iter().zip(&joined[name]).enumerate() {
            let is_near = a == b || (a - b).abs() <= tolerance * (1.0 + a.abs());
            assert!(is_near, "{name}, pixel {pixel}: {a} and {b}");
        }
    }
    // The first samples are needed.
    let words = ["first samples", "begins at 0"];
    place.refused(1, "merge 80.exr --denoise fast --output x.exr", &words);
    place.refused(1, "merge 80.exr --aovs --output x.exr", &words);
    place.refused(1, "merge 0.exr --aovs --output x.png", &["--aovs", ".exr"]);
}

#[test]
fn films_that_do_not_belong_together_are_refused() {
    let place = Workplace::new();
    let film = |arguments: &str, name: &str| {
        place.done(&format!("render {SCENE} {arguments} --keep-sums --output {name}"));
    };
    film("--samples-to 2", "a.exr");
    film("--samples-from 1 --samples-to 3", "b.exr");
    film("--samples-from 2 --samples-to 3 --seed 1", "c.exr");
    place.done(&format!("render {SCENE} --samples 2 --output plain.exr"));
    place.refused(
        1,
        "merge a.exr b.exr --output x.exr",
        &["b.exr", "a.exr", "samples 1 to 3"],
    );
    place.refused(
        1,
        "merge a.exr c.exr --output x.exr",
        &["c.exr", "a.exr", "another image"],
    );
    place.refused(1, "merge a.exr plain.exr --output x.exr", &["plain.exr", "--keep-sums"]);
    place.refused(1, "render --samples-from 4 --samples-to 4", &["--samples-to 4"]);
    place.refused(1, "render --keep-sums --output a.png", &["--keep-sums", ".exr"]);
    place.refused(
        1,
        &format!("render {SCENE} --samples-from 4 --denoise fast"),
        &["--samples-from 4", "denoiser"],
    );
}
