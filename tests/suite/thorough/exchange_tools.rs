//! Exported materials judged by the formats' own tools, which `scripts/setup test` installs.

use std::{path::PathBuf, process::Command};

use glossmith::{
    document::MaterialSettings,
    optics::lobe::Lobe,
    scene::texture::{TextureTarget, UserTexture},
    store::{PRESETS, preset::command_line_name, save_material},
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

/// A material of textures in a format, exported into the folder of that name: placed, turned, weakened, inverted.
fn textured(place: &Workplace, format: &str, ending: &str) -> PathBuf {
    let picture = image::RgbImage::from_fn(8, 8, |x, y| image::Rgb([30 * x as u8, 30 * y as u8, 200]));
    picture.save(place.path("t.png")).unwrap();
    let mut material = MaterialSettings {
        name: "Painted".to_owned(),
        specular_weight: 0.0,
        metalness: 0.0,
        base_color: [0.9, 0.5, 0.25],
        ..MaterialSettings::default()
    };
    let placed = UserTexture {
        scale: 2.0,
        stretch: 1.5,
        rotation_deg: 30.0,
        offset: [0.125, 0.25],
        ..UserTexture::of(place.path("t.png"))
    };
    let weak = UserTexture {
        strength: 0.5,
        inverted: true,
        ..placed.clone()
    };
    for (target, texture) in [
        (TextureTarget::BaseColor, placed),
        (TextureTarget::Roughness, weak.clone()),
        (TextureTarget::Opacity, weak.clone()),
        (TextureTarget::Coat, weak),
        (TextureTarget::Normal, UserTexture::of(place.path("t.png"))),
    ] {
        // Elsewhere normals and opacity are looked up otherwise; that renderer is asked for the colour.
        if format == "mitsuba" && target != TextureTarget::BaseColor {
            continue;
        }
        material.user_textures.set(target, Some(texture));
        material.textures[target] = true;
    }
    place.save_material("painted.json", &material);
    std::fs::create_dir_all(place.path(format)).unwrap();
    let name = format!("{format}/painted.{ending}");
    place.done(&format!("convert painted.json {name} --to {format}"));
    place.path(&name)
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
        place.save_material("turned.json", &turned);
        place.done(&format!("convert turned.json {format}/turned.mtlx --to {format}"));
        files.push(place.path(&format!("{format}/turned.mtlx")));
        files.push(textured(&place, format, "mtlx"));
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
    let mut files = exported(&place, "usd", "usda");
    files.push(textured(&place, "usd", "usda"));
    judged("usd", &files);
}

/// What the script asks Blender for is there as far as can be told without it.
#[test]
fn scripts_for_blender_run_and_find_their_images() {
    let place = Workplace::new();
    let mut files = exported(&place, "blender", "py");
    files.push(textured(&place, "blender", "py"));
    let told = judged("blender", &files);
    assert!(told.trim_end().ends_with(" 5"), "{told}");
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
    textured(&place, "mitsuba", "xml");
    let painted = place.material("painted.json");
    for (name, material) in [("metal", &aluminium), ("matt", &matt), ("painted", &painted)] {
        save_material(&place.path(&format!("{name}.json")), material).unwrap();
        place.done(&format!("convert {name}.json {name}.xml"));
        let told = judged("mitsuba-means", &[place.path(&format!("{name}.xml"))]);
        let theirs: Vec<f64> = told
            .split_whitespace()
            .skip(1)
            .take(12)
            .map(|x| x.parse().unwrap())
            .collect();
        crate::cli_support::write_hdr(&place.path("white.hdr"), 8, 4, |_, _| [1.0; 3]);
        let picture = place.picture(&format!(
            "--model sphere --material {name}.json --environment white.hdr --camera-position 0,0,4 --fov 35 --size 64x64 --samples 64"
        ));
        let quarter = |[left, top]: [usize; 2], channel: usize| {
            let places = (top..top + 8).flat_map(|y| (left..left + 8).map(move |x| (x, y)));
            places.map(|(x, y)| f64::from(picture.at(x, y)[channel])).sum::<f64>() / 64.0
        };
        let quarters = [[24, 24], [32, 24], [24, 32], [32, 32]];
        let all = quarters
            .iter()
            .flat_map(|place| [0, 1, 2].map(|channel| quarter(*place, channel)));
        for (ours, theirs) in all.zip(theirs) {
            let apart = (ours - theirs).abs();
            assert!(apart < 0.002 + 0.01 * theirs, "{name}: {ours} and {theirs}");
        }
    }
}
