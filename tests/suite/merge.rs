//! One picture's samples rendered apart and joined.

use std::collections::HashMap;
use std::path::Path;

use exr::prelude::{FlatSamples, ReadChannels as _, ReadLayers as _, read};

use crate::cli_support::{Workplace, read_exr};

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
        let joined = bits(&place.path(name));
        assert_eq!(joined.len(), whole.len());
        for (channel, expected) in &whole {
            // Deviations are those of the parts put together, by another formula than one after the other.
            if !channel.ends_with("deviations") {
                assert!(joined[channel] == *expected, "{name}: {channel}");
            }
        }
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

#[test]
fn a_region_of_a_picture_joins_like_the_whole() {
    let place = Workplace::new();
    let scene = format!("{SCENE} --region 0.25,0.1,0.7,0.8");
    render_whole_and_joined(&place, &scene);
    let (whole, joined) = (bits(&place.path("whole.exr")), bits(&place.path("joined.exr")));
    for (channel, expected) in &whole {
        if !channel.ends_with("deviations") {
            assert!(joined[channel] == *expected, "{channel}");
        }
    }
    // Another region is another picture.
    place.done(&format!(
        "render {SCENE} --samples-from 4 --samples-to 9 --keep-sums --output b.exr"
    ));
    place.refused(1, "merge a.exr b.exr --output x.exr", &["b.exr", "another picture"]);
}

/// The GPU sums in f32 before it hands over: pictures agree to its rounding.
#[test]
fn films_of_the_gpu_join_to_rounding() {
    let place = Workplace::new();
    let scene = SCENE.replace("--engine cpu", "--engine gpu");
    render_whole_and_joined(&place, &scene);
    let (whole, joined) = (read_exr(&place.path("whole.exr")), read_exr(&place.path("joined.exr")));
    for (pixel, (a, b)) in whole.pixels.iter().zip(&joined.pixels).enumerate() {
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() <= 2e-6 * (1.0 + a.abs()), "pixel {pixel}: {a} and {b}");
        }
    }
}

#[test]
fn films_with_unequal_pixels_are_not_kept() {
    let place = Workplace::new();
    for (more, word) in [
        ("--adaptive on --noise 0.2", "adaptive"),
        ("--adaptive off --noise 0.2", "noise"),
        ("--time 1", "time"),
    ] {
        place.refused(
            1,
            &format!("render {SCENE} {more} --keep-sums --output a.exr"),
            &["equally many samples", word],
        );
    }
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
        &["c.exr", "a.exr", "another picture"],
    );
    place.refused(1, "merge a.exr plain.exr --output x.exr", &["plain.exr", "--keep-sums"]);
    place.refused(1, "render --samples-from 4 --samples-to 4", &["--samples-to 4"]);
    place.refused(1, "render --keep-sums --output a.png", &["--keep-sums", ".exr"]);
}
