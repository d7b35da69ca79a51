//! `glossmith explain`: a path in words and as JSON, against the picture that the same scene renders.

use crate::cli_support::{Workplace, read_exr};

const SCENE: &str = "--model sphere --ground --material gold --size 24x24 --seed 5";

/// Red, green and blue of a JSON array, as the engine has them.
fn color(value: &serde_json::Value) -> [f32; 3] {
    serde_json::from_value(value.clone()).unwrap()
}

#[test]
fn a_path_is_told_in_words_and_as_json() {
    let place = Workplace::new();
    let explain = format!("explain {SCENE} --pixel 12,12");
    let words = place.done(&format!("{explain} --json path.json")).stdout;
    for told in [
        "camera",
        "bounce 0",
        "material Gold",
        "to light",
        "MIS weight",
        "scattered",
        "end",
        "sum",
    ] {
        assert!(words.contains(told), "{told} is missing:\n{words}");
    }
    let account: serde_json::Value = place.json("path.json");
    let printed = place.done(&format!("{explain} --json -")).stdout;
    assert_eq!(serde_json::from_str::<serde_json::Value>(&printed).unwrap(), account);
    let events = account["events"].as_array().unwrap();
    let added = events.iter().filter(|event| event["event"] == "contribution");
    let sum = added.fold([0.0_f32; 3], |sum, event| {
        let added = color(&event["added"]);
        [0, 1, 2].map(|i| sum[i] + added[i])
    });
    assert_eq!(sum, color(&account["radiance"]));
    // One sample of the picture is that sum, but for the digits of the file.
    place.done(&format!("render --engine cpu {SCENE} --samples 1 --output one.exr"));
    let [r, g, b, _] = read_exr(&place.path("one.exr")).at(12, 12);
    for (rendered, told) in [r, g, b].into_iter().zip(sum) {
        near!(rendered, told, 0.001 * told);
    }
}

#[test]
fn a_pixel_outside_the_picture_is_refused() {
    let place = Workplace::new();
    let at = |pixel: &str| format!("explain {SCENE} --pixel {pixel}");
    place.refused(1, &at("24,3"), &["24,3", "24 x 24", "--size"]);
    place.refused(2, &at("middle"), &["column", "row"]);
}
