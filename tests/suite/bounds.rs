//! Small files that ask for large work end soon, or with a message: each of these once took a minute or for ever.

use super::cli_support::Workplace;
use serde_json::json;

const QUICK: &str = "--engine cpu --size 8x8 --samples 1 --output a.exr";

#[test]
fn elements_of_a_ply_file_without_properties_are_passed_over() {
    let place = Workplace::new();
    let header = "ply\nformat binary_little_endian 1.0\nelement nothing 18446744073709551615\nelement vertex 3\n\
                  property float x\nproperty float y\nproperty float z\nelement face 1\n\
                  property list uchar int vertex_indices\nend_header\n";
    let mut bytes = header.as_bytes().to_vec();
    for number in [0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.push(3);
    for corner in [0_i32, 1, 2] {
        bytes.extend(corner.to_le_bytes());
    }
    place.write("m.ply", &bytes);
    place.done(&format!("render m.ply {QUICK} --import-report r.json"));
    assert!(
        place.read("r.json").contains("elements called nothing"),
        "{}",
        place.read("r.json")
    );
}

#[test]
fn an_element_with_a_hundred_thousand_attributes_is_refused() {
    let place = Workplace::new();
    let attributes: String = (0..100_000).map(|number| format!(" a{number}=\"\"")).collect();
    place.write("m.mtlx", format!("<materialx version=\"1.39\"{attributes}/>"));
    place.refused(1, "convert m.mtlx out.json", &["m.mtlx", "more than 1000 attributes"]);
}

/// 80 bytes that made 65 536 materials.
#[test]
fn a_picture_of_a_slot_that_no_model_has_is_passed_over() {
    let place = Workplace::new();
    let text = json!({"glossmith-document": 1, "import": {"pictures": [{"slot": 65535, "file": "x.png"}]}});
    place.write("p.json", text.to_string());
    place.done("convert p.json out.json");
    assert!(place.path("out.json").metadata().unwrap().len() < 1 << 20);
}

/// A picture that does not fit what a process may take is refused, as one that does not fit the memory.
#[cfg(target_os = "linux")]
#[test]
fn a_limit_of_the_process_is_seen() {
    let place = Workplace::new();
    let command = format!(
        "ulimit -v 3000000; exec '{}' render --model sphere --engine cpu --size 16000x16000 --samples 1 --output a.exr",
        crate::program()
    );
    let output = std::process::Command::new("sh")
        .args(["-c", &command])
        .current_dir(place.path(""))
        .output()
        .unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("MiB are free for it"), "{told}");
}

/// Names that are no Unicode are written as they are read.
#[cfg(target_os = "linux")]
#[test]
fn names_that_are_no_unicode_are_written() {
    use std::os::unix::ffi::OsStrExt as _;
    let place = Workplace::new();
    let render = "render --model sphere --engine cpu --size 8x8 --samples 1";
    let frames = "turntable --model sphere --engine cpu --size 16x16 --samples 1 --frames 2";
    for (command, option, bytes) in [
        (render, "--output", &b"a\xff.exr"[..]),
        (render, "--report", &b"r\xff.json"[..]),
        (frames, "--video", &b"v\xff.gif"[..]),
        ("convert --without-exact", "gold", &b"c\xff.mtlx"[..]),
    ] {
        let name = std::ffi::OsStr::from_bytes(bytes);
        let output = std::process::Command::new(crate::program())
            .args(command.split_whitespace())
            .arg(option)
            .arg(name)
            .current_dir(place.path(""))
            .output()
            .unwrap();
        assert!(
            output.status.success(),
            "{command}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
        assert!(place.path("").join(name).is_file(), "{command} {option}");
    }
}

#[cfg(unix)]
#[test]
fn each_path_has_a_text_of_its_own_that_leads_back() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt as _;
    use std::path::Path;

    use glossmith::scene::path_text::{path_of_text, path_text};

    let names: [&[u8]; 6] = [
        b"a.png",
        b"/t/a\xff b.png",
        b"/t/a\xfe b.png",
        b"file:///t/a%FF.png",
        b"/t/%ff",
        "ä".as_bytes(),
    ];
    let paths = names.map(|name| Path::new(OsStr::from_bytes(name)));
    let texts = paths.map(path_text);
    for (place, text) in texts.iter().enumerate() {
        assert!(!texts[..place].contains(text), "{text}");
        let whole = if text.starts_with("file:") {
            std::path::absolute(paths[place]).expect("a folder")
        } else {
            paths[place].to_owned()
        };
        assert_eq!(path_of_text(text), whole);
    }
    assert_eq!(
        path_of_text("file:///my%20models/%c3%a4.glb"),
        Path::new("/my models/ä.glb")
    );
    assert_eq!(path_of_text("file:///100%"), Path::new("/100%"));
    assert_eq!(texts[1], "file:///t/a%FF%20b.png");
    assert_eq!([&texts[0], &texts[5]], ["a.png", "ä"]);
}
