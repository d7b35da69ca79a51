//! What asks for large work by its size alone, or by many files together: it ends within seconds and a gigabyte, or with a
//! message. Inputs are made here.

use super::{cli_support::Workplace, gltf_builder::square};
use serde_json::{Value as Json, json};
use std::{fmt::Write as _, io::Write as _};
use zip::{ZipWriter, write::SimpleFileOptions};

const MANY: usize = 100_000;
const QUICK: &str = "--engine cpu --size 8x8 --samples 1 --output a.exr";

/// What a run took.
struct Taken {
    code: Option<i32>,
    /// Of the processor; the tests' program is slower than a release, and others run beside it.
    seconds: f64,
    peak_mib: i64,
    said: String,
}

/// Runs the program, and measures it.
fn run(place: &Workplace, arguments: &str, memory_mib: Option<u64>) -> Taken {
    let words = std::fs::File::create(place.path("words.txt")).unwrap();
    let mut command = std::process::Command::new(crate::program());
    command.args(arguments.split_whitespace()).current_dir(place.path(""));
    command
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("RUST_LOG");
    command
        .env("XDG_RUNTIME_DIR", place.path(""))
        .stdout(std::process::Stdio::null())
        .stderr(words);
    if let Some(mib) = memory_mib {
        command.env("GLOSSMITH_MEMORY", mib.to_string());
    }
    #[expect(clippy::zombie_processes, reason = "wait4 waits for it, and gives what it used")]
    let child = command.spawn().unwrap();
    let mut status = 0;
    // SAFETY: all zeros are a usage.
    let mut usage: libc::rusage = unsafe { std::mem::zeroed() };
    // SAFETY: it writes into what it is given; nobody else waits for this child.
    let ended = unsafe { libc::wait4(child.id() as i32, &raw mut status, 0, &raw mut usage) };
    assert_eq!(ended, child.id() as i32);
    let seconds = |time: libc::timeval| time.tv_sec as f64 + 1e-6 * time.tv_usec as f64;
    Taken {
        code: libc::WIFEXITED(status).then(|| libc::WEXITSTATUS(status)),
        seconds: seconds(usage.ru_utime) + seconds(usage.ru_stime),
        peak_mib: usage.ru_maxrss >> 10,
        said: place.read("words.txt"),
    }
}

/// Runs the program, which must be done within bounds.
fn done(place: &Workplace, arguments: &str) -> String {
    let taken = run(place, arguments, None);
    assert_eq!(taken.code, Some(0), "{arguments}\n{}", taken.said);
    assert!(taken.seconds < 10.0, "{arguments}: {} s", taken.seconds);
    // A hundred thousand materials take 1100 MiB.
    assert!(taken.peak_mib < 1536, "{arguments}: {} MiB", taken.peak_mib);
    taken.said
}

/// A file of the square, changed.
fn write_square(place: &Workplace, name: &str, change: impl FnOnce(&mut Json)) {
    let (buffer, mut document) = square();
    document["buffers"][0]["uri"] = json!("square.bin");
    place.write("square.bin", &buffer.bytes);
    change(&mut document);
    place.write(name, document.to_string());
}

#[test]
fn a_polygon_of_a_hundred_thousand_corners_is_loaded_in_seconds() {
    let place = Workplace::new();
    let corner = |i: usize| (std::f64::consts::TAU * i as f64 / MANY as f64).sin_cos();
    let (mut obj, mut face) = (String::new(), "f".to_owned());
    let mut ply = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {MANY}\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list uint int vertex_indices\nend_header\n"
    )
    .into_bytes();
    for i in 0..MANY {
        let (y, x) = corner(i);
        writeln!(obj, "v {x:.9} {y:.9} 0").unwrap();
        write!(face, " {}", i + 1).unwrap();
        [x, y, 0.0]
            .into_iter()
            .for_each(|x| ply.extend((x as f32).to_le_bytes()));
    }
    ply.extend((MANY as u32).to_le_bytes());
    (0..MANY as u32).for_each(|i| ply.extend(i.to_le_bytes()));
    place.write("gon.obj", obj + &face + "\n");
    place.write("gon.ply", &ply);
    done(&place, &format!("render gon.obj {QUICK}"));
    done(&place, &format!("render gon.ply {QUICK}"));
}

#[test]
fn a_hundred_thousand_materials_are_loaded_in_seconds_or_refused() {
    let place = Workplace::new();
    let names = || (0..MANY).map(|i| format!("m{i}"));
    place.write(
        "m.mtl",
        names()
            .map(|name| format!("newmtl {name}\nKd 0.5 0.5 0.5\n"))
            .collect::<String>(),
    );
    let faces: String = names().map(|name| format!("usemtl {name}\nf 1 2 3\n")).collect();
    place.write("m.obj", format!("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}"));
    done(&place, &format!("render m.obj {QUICK}"));
    write_square(&place, "m.gltf", |document| {
        document["materials"] = names().map(|name| json!({"name": name})).collect();
        let primitive = document["meshes"][0]["primitives"][0].clone();
        let with = |material: usize| {
            let mut primitive = primitive.clone();
            primitive["material"] = json!(material);
            primitive
        };
        document["meshes"][0]["primitives"] = (0..MANY).map(with).collect();
    });
    done(&place, &format!("render m.gltf {QUICK}"));
    let project = json!({"glossmith-document": 1, "materials": vec![json!({}); MANY]});
    place.write("m.json", project.to_string());
    place.refused(
        1,
        &format!("render m.json {QUICK}"),
        &["m.json", "100000 materials", "at most 65536"],
    );
    // A picture of the model has no room for a document of so many; it is saved, and that is told.
    let said = done(
        &place,
        "render m.gltf --engine cpu --size 8x8 --samples 1 --output a.png",
    );
    assert!(
        said.contains("without its document") && said.contains("100000 materials"),
        "{said}"
    );
    assert!(place.path("a.png").is_file());
}

#[test]
fn extras_of_any_size_are_passed_over() {
    let place = Workplace::new();
    write_square(&place, "m.gltf", |document| {
        document["nodes"][0]["extras"] = json!("HERE")
    });
    let numbers = format!("[0{}]", ",0".repeat(20_000_000));
    place.write("m.gltf", place.read("m.gltf").replace("\"HERE\"", &numbers));
    done(&place, &format!("render m.gltf {QUICK}"));
    done(&place, "convert m.gltf out.json");
}

#[test]
fn a_chain_of_a_million_nodes_is_followed_to_its_end_and_a_circle_is_told() {
    let place = Workplace::new();
    let chain: String = (1..=1_000_000)
        .map(|next| format!("{{\"children\":[{next}]}},"))
        .collect();
    for (name, last) in [
        ("chain.gltf", "{\"mesh\":0}"),
        ("circle.gltf", "{\"mesh\":0,\"children\":[5]}"),
    ] {
        write_square(&place, name, |document| document["nodes"] = json!("HERE"));
        let nodes = format!("[{chain}{last}]");
        place.write(name, place.read(name).replace("\"HERE\"", &nodes));
        let said = done(&place, &format!("render {name} {QUICK}"));
        assert_eq!(said.contains("its own ancestor"), name == "circle.gltf", "{said}");
    }
}

/// Each node uses the one before twice: followed step by step they would be 2 to the number of the nodes.
#[test]
fn a_graph_whose_nodes_are_used_twice_is_not_followed_for_ever() {
    let place = Workplace::new();
    let node = |i: usize| {
        let input = |name: &str| format!("<input name=\"{name}\" type=\"color3\" nodename=\"n{}\"/>", i - 1);
        format!(
            "<multiply name=\"n{i}\" type=\"color3\">{}{}</multiply>",
            input("in1"),
            input("in2")
        )
    };
    let nodes: String = (1..31).map(node).collect();
    let text = format!(
        "<materialx version=\"1.39\"><nodegraph name=\"g\"><constant name=\"n0\" type=\"color3\"><input name=\"value\" \
         type=\"color3\" value=\"0.5,0.5,0.5\"/></constant>{nodes}<output name=\"out\" type=\"color3\" nodename=\"n30\"/>\
         </nodegraph><standard_surface name=\"s\" type=\"surfaceshader\"><input name=\"base_color\" type=\"color3\" \
         nodegraph=\"g\" output=\"out\"/></standard_surface></materialx>"
    );
    place.write("m.mtlx", text);
    let said = done(&place, "convert m.mtlx out.json");
    assert!(said.contains("more than 65536 steps"), "{said}");
}

/// A square for each picture, and what a file says of them.
fn with_pictures(names: &[String]) -> impl FnOnce(&mut Json) + '_ {
    move |document: &mut Json| {
        let primitive = document["meshes"][0]["primitives"][0].clone();
        let with = |index: usize| {
            let mut primitive = primitive.clone();
            primitive["material"] = json!(index);
            primitive
        };
        let material = |index: usize| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": index}}});
        document["meshes"][0]["primitives"] = (0..names.len()).map(with).collect();
        document["materials"] = (0..names.len()).map(material).collect();
        document["textures"] = (0..names.len()).map(|index| json!({"source": index})).collect();
        document["images"] = names.iter().map(|name| json!({"uri": name})).collect();
    }
}

/// The entries of the import's report.
fn entries(place: &Workplace) -> Vec<Json> {
    let report: Json = place.json("report.json");
    report["entries"].as_array().unwrap().clone()
}

fn textures_of_fate(place: &Workplace, fate: &str) -> Json {
    let is_it = |entry: &Json| entry["fate"] == fate && entry["what"].as_str().unwrap().contains("texture");
    entries(place).into_iter().find(is_it).unwrap_or_default()
}

/// A square image of many colours.
fn gradient(side: u32, shade: u8) -> image::RgbImage {
    image::RgbImage::from_fn(side, side, |x, y| image::Rgb([(x / 8) as u8, (y / 8) as u8, shade]))
}

/// 8 pictures of 16 MiB each from small files, where 100 MiB are allowed: as many as fit are shown, the others are left out,
/// the same in each run, and it is told why and what to do.
#[test]
fn pictures_share_the_budget_of_their_import() {
    let place = Workplace::new();
    let names: Vec<String> = (0..8).map(|i| format!("p{i}.png")).collect();
    for (i, name) in names.iter().enumerate() {
        gradient(2048, 20 * i as u8).save(place.path(name)).unwrap();
    }
    write_square(&place, "m.gltf", with_pictures(&names));
    for _ in 0..2 {
        let taken = run(
            &place,
            &format!("render m.gltf {QUICK} --import-report report.json"),
            Some(100),
        );
        assert_eq!(taken.code, Some(0), "{}", taken.said);
        let used = textures_of_fate(&place, "used");
        let count = used["count"].as_u64().unwrap() as usize;
        assert!((2..=6).contains(&count), "{used}");
        assert_eq!(used["names"], json!(names[..count]));
        let missing = textures_of_fate(&place, "missing");
        assert_eq!(missing["names"], json!(names[count..]));
        for words in ["it takes 48 MiB", "are left of the 100 MiB", "GLOSSMITH_MEMORY"] {
            assert!(missing["what"].as_str().unwrap().contains(words), "{missing}");
        }
    }
    // The user's own are of the same import.
    let own = format!("render --texture base-color=p1.png {QUICK}");
    let taken = run(&place, &own, Some(16));
    assert_eq!(taken.code, Some(1), "{}", taken.said);
    for words in ["p1.png", "it takes", "of the 16 MiB", "GLOSSMITH_MEMORY"] {
        assert!(taken.said.contains(words), "{}", taken.said);
    }
    // And so is a model's own file.
    place.write("large.obj", &vec![b'#'; 17 << 20]);
    let taken = run(&place, &format!("render large.obj {QUICK}"), Some(16));
    assert_eq!(taken.code, Some(1), "{}", taken.said);
    assert!(
        taken.said.contains("large.obj") && taken.said.contains("it takes 17 MiB"),
        "{}",
        taken.said
    );
}

fn write_zip(place: &Workplace, name: &str, files: &[(String, Vec<u8>)]) {
    let mut zip = ZipWriter::new(std::fs::File::create(place.path(name)).unwrap());
    for (name, bytes) in files {
        zip.start_file(name, SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap();
}

#[test]
fn archives_of_many_names_and_of_nothing_but_zeros_end_soon() {
    let place = Workplace::new();
    let inside = |names: &[String]| {
        write_square(&place, "m.gltf", with_pictures(names));
        let model = ["m.gltf", "square.bin"].map(|name| (name.to_owned(), place.bytes(name)));
        model.to_vec()
    };
    let names: Vec<String> = (0..5000).map(|i| format!("p{i}.png")).collect();
    let mut files = inside(&names);
    files.extend((0..20_000).map(|i| (format!("other{i}.txt"), b"x".to_vec())));
    write_zip(&place, "names.zip", &files);
    let taken = run(&place, &format!("render names.zip {QUICK}"), None);
    assert_eq!(taken.code, Some(0), "{}", taken.said);
    assert!(
        taken.said.contains("5000 missing") && taken.seconds < 5.0,
        "{} s: {}",
        taken.seconds,
        taken.said
    );
    let mut files = inside(&["z.png".to_owned()]);
    files.push(("z.png".to_owned(), vec![0; 128 << 20]));
    write_zip(&place, "bomb.zip", &files);
    done(&place, &format!("render bomb.zip {QUICK} --import-report report.json"));
    let missing = textures_of_fate(&place, "missing");
    assert!(
        missing["what"].as_str().unwrap().contains("unpack the archive"),
        "{missing}"
    );
}
