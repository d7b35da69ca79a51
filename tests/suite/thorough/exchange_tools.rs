//! Exported materials judged by the formats' own tools, which `scripts/setup test` installs.

use std::{path::PathBuf, process::Command};

use glossmith::{
    document::MaterialSettings,
    optics::lobe::Lobe,
    store::{PRESETS, load_material, preset::command_line_name, save_material},
};

use crate::cli_support::Workplace;

/// The folder of the tools.
pub fn tools() -> PathBuf {
    let data = || {
        let home = || std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".local/share"));
        let folder = std::env::var_os("XDG_DATA_HOME").map(PathBuf::from).or_else(home);
        folder.unwrap_or_default().join("glossmith/format-tools")
    };
    let folder = std::env::var_os("GLOSSMITH_TOOLS").map_or_else(data, PathBuf::from);
    assert!(
        folder.join("complete").is_file(),
        "the formats' tools are not in {}: run scripts/setup test",
        folder.display()
    );
    folder
}

/// Every shipped material in a format, exported into a folder of that name.
fn exported(place: &Workplace, format: &str, ending: &str) -> Vec<PathBuf> {
    let names: Vec<String> = PRESETS
        .iter()
        .map(|material| command_line_name(&material.name))
        .collect();
    place.done(&format!("convert {} {format} --to {format}", names.join(" ")));
    names
        .iter()
        .map(|name| place.path(&format!("{format}/{name}.{ending}")))
        .collect()
}

/// What a tool says of files, which it must find right.
fn judged(format: &str, files: &[PathBuf]) -> String {
    let scripts = PathBuf::from(crate::ROOT).join("tests/tools");
    let tools = tools();
    let mut command = if format == "gltf" {
        let mut node = Command::new(tools.join("bin/node"));
        node.arg(scripts.join("check_gltf.js")).arg(tools.join("node_modules"));
        node
    } else {
        let mut python = Command::new(tools.join("bin/python"));
        python.arg(scripts.join("check_formats.py")).arg(format);
        python
    };
    let output = command.args(files).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success(),
        "{format}:\n{text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    text
}

#[test]
fn materialx_finds_its_documents_valid_and_makes_shaders_of_them() {
    let place = Workplace::new();
    for format in ["materialx", "standard-surface"] {
        let mut files = exported(&place, format, "mtlx");
        let turned = MaterialSettings {
            name: "4 – \"turned\" & <brushed>".to_owned(),
            anisotropy: -0.6,
            rotation_deg: 25.0,
            ..MaterialSettings::default()
        };
        save_material(&place.path("turned.json"), &turned).unwrap();
        place.done(&format!("convert turned.json {format}/turned.mtlx --to {format}"));
        files.push(place.path(&format!("{format}/turned.mtlx")));
        judged("materialx", &files);
    }
}

#[test]
fn the_validator_of_gltf_finds_nothing_wrong() {
    let place = Workplace::new();
    let mut files = exported(&place, "gltf", "glb");
    place.done("convert gold gold.gltf");
    files.push(place.path("gold.gltf"));
    judged("gltf", &files);
}

#[test]
fn usd_opens_its_files_and_finds_them_right() {
    let place = Workplace::new();
    judged("usd", &exported(&place, "usd", "usda"));
}

#[test]
fn mitsuba_renders_what_we_render() {
    let place = Workplace::new();
    judged("mitsuba", &exported(&place, "mitsuba", "xml"));
    let aluminium = MaterialSettings {
        lobe: Lobe::Ggx,
        roughness: 0.5,
        fresnel: glossmith::optics::fresnel::Fresnel::Conductor,
        // Mitsuba's facets scatter once.
        multiple_scattering: false,
        ..MaterialSettings::default()
    };
    let matt = MaterialSettings::diffuse("matt", [0.8, 0.4, 0.2]);
    for (name, material) in [("metal", &aluminium), ("matt", &matt)] {
        save_material(&place.path(&format!("{name}.json")), material).unwrap();
        place.done(&format!("convert {name}.json {name}.xml"));
        let told = judged("mitsuba-means", &[place.path(&format!("{name}.xml"))]);
        let theirs: Vec<f64> = told
            .split_whitespace()
            .skip(1)
            .take(3)
            .map(|x| x.parse().unwrap())
            .collect();
        crate::cli_support::write_hdr(&place.path("white.hdr"), 8, 4, |_, _| [1.0; 3]);
        let picture = place.picture(&format!(
            "--model sphere --material {name}.json --environment white.hdr --camera-position 0,0,4 --fov 35 --size 64x64 --samples 64"
        ));
        let middle = |channel: usize| {
            let places = (24..40).flat_map(|y| (24..40).map(move |x| (x, y)));
            places.map(|(x, y)| f64::from(picture.at(x, y)[channel])).sum::<f64>() / 256.0
        };
        for channel in 0..3 {
            let (ours, theirs) = (middle(channel), theirs[channel]);
            assert!(
                (ours / theirs - 1.0).abs() < 0.01,
                "{name}, channel {channel}: {ours} and {theirs}"
            );
        }
    }
}
