//! Tables of colours: by the command line and in projects.

use super::{cli_support::Workplace, renders::adjust};
use glossmith::{
    document::Document,
    optics::{tone::Lut, vector::vec3},
    scene::ModelSource,
    store::lut::load,
};

/// Black for white and white for black.
const NEGATIVE: &str = "TITLE \"negative\"\nLUT_1D_SIZE 2\n1 1 1\n0 0 0\n";

#[test]
fn a_picture_goes_through_a_table_last() {
    let place = Workplace::new();
    place.write("negative.cube", NEGATIVE);
    let scene = "--model sphere --engine cpu --size 12x12 --samples 2";
    let codes = |name: &str| image::open(place.path(name)).unwrap().to_rgb8().into_raw();
    place.done(&format!("render {scene} --output plain.png"));
    place.done(&format!("render {scene} --output negative.png --lut negative.cube"));
    for (plain, negative) in std::iter::zip(codes("plain.png"), codes("negative.png")) {
        near!(i32::from(plain) + i32::from(negative), 255, 1);
    }
    // Light stays light.
    place.done(&format!("render {scene} --output plain.exr"));
    place.done(&format!("render {scene} --output negative.exr --lut negative.cube"));
    let light = |name: &str| super::cli_support::read_exr(&place.path(name));
    assert!(light("plain.exr") == light("negative.exr"));
    place.write("broken.cube", b"LUT_3D_SIZE 2\n0 0 0\n");
    place.refused(
        1,
        &format!("render {scene} --output a.png --lut broken.cube"),
        &["broken.cube: not a table of colours: it has 1 of 8 entries"],
    );
    place.refused(
        1,
        &format!("render {scene} --output a.png --lut gone.cube"),
        &["gone.cube: cannot be read"],
    );
    // A project names it relative to itself; where it is missing that is told, and the picture is made.
    let mut document = Document {
        model: ModelSource::Sphere,
        ..Document::default()
    };
    document.view.lut = Some(place.path("negative.cube"));
    adjust(&mut document, "render.width=12 render.height=12 render.samples=2");
    place.save_document("p.json", &document);
    assert!(
        place.read("p.json").contains("\"lut\": \"negative.cube\""),
        "{}",
        place.read("p.json")
    );
    assert_eq!(place.document("p.json"), document);
    place.done("render p.json --engine cpu --output saved.png");
    assert_eq!(codes("saved.png"), codes("negative.png"));
    std::fs::remove_file(place.path("negative.cube")).unwrap();
    let run = place.done("render p.json --engine cpu --output without.png");
    assert!(run.stderr.contains("negative.cube: cannot be read"), "{}", run.stderr);
    assert_eq!(codes("without.png"), codes("plain.png"));
}

/// A cube that swaps red and blue, with a bend in green, on a domain of its own.
#[test]
fn a_cube_is_linear_between_its_entries() {
    let size = 3;
    let at = |i: usize| i as f32 / 2.0;
    let entries = (0..27).map(|i| {
        let [r, g, b] = [at(i % size), at(i / size % size), at(i / 9)];
        [b, g * g, r]
    });
    let lut = Lut {
        before: None,
        size,
        is_one_dimensional: false,
        domain: [[0.0; 3], [2.0; 3]],
        entries: entries.collect(),
    };
    let found = lut.apply(vec3(0.5, 0.5, 1.7)).to_f32();
    // Half way between 0 and 0.5², as the table is linear there.
    let expected = [0.85, 0.125, 0.25];
    assert!(
        std::iter::zip(found, expected).all(|(a, b)| (a - b).abs() < 1e-6),
        "{found:?}"
    );
    assert_eq!(lut.apply(vec3(9.0, -1.0, f32::NAN)).to_f32(), [0.0, 0.0, 1.0]);
    let curves = Lut {
        before: None,
        size: 2,
        is_one_dimensional: true,
        domain: [[0.0; 3], [1.0; 3]],
        entries: vec![[1.0, 0.0, 0.5], [0.0, 1.0, 0.5]],
    };
    assert_eq!(curves.apply(vec3(0.25, 0.25, 0.25)).to_f32(), [0.75, 0.25, 0.5]);
}

#[test]
fn tables_are_read_as_programs_write_them() {
    let place = Workplace::new();
    let read = |text: &str| {
        place.write("a.cube", text);
        load(&place.path("a.cube")).map_err(|error| error.to_string())
    };
    let curve = "# by hand\n\nLUT_1D_SIZE 2\nDOMAIN_MIN 0 0 0\nDOMAIN_MAX 1 1 2\n 0 0 0\n1 1\t1\r\n";
    let lut = read(curve).expect("a table");
    assert!(lut.is_one_dimensional && lut.domain[1] == [1.0, 1.0, 2.0]);
    let cube = format!(
        "\u{feff}TITLE \"a\"\nLUT_3D_SIZE 2\nLUT_3D_INPUT_RANGE 0.0 4.0\n{}",
        "0.5 0.5 0.5\n".repeat(8)
    );
    assert_eq!(read(&cube).expect("a cube").domain, [[0.0; 3], [4.0; 3]]);
    // Curves that halve, then the negative as a cube: each with a range of its own.
    let corner = |i: usize| format!("{} {} {}\n", 1 - i % 2, 1 - i / 2 % 2, 1 - i / 4);
    let both = format!(
        "LUT_1D_SIZE 2\nLUT_1D_INPUT_RANGE 0 2\nLUT_3D_SIZE 2\nLUT_3D_INPUT_RANGE 0 1\n0 0 0\n1 1 1\n{}",
        (0..8).map(corner).collect::<String>()
    );
    let found = read(&both).expect("two tables").apply(vec3(0.5, 0.25, 2.0)).to_f32();
    assert_eq!(found, [0.75, 0.875, 0.0]);
    for (text, words) in [
        ("", "does not say its size"),
        ("LUT_3D_SIZE 2\n0 0 0\n", "1 of 8 entries"),
        ("LUT_3D_SIZE 999\n", "line 1"),
        ("LUT_1D_SIZE 2\n0 0\n", "line 2"),
        ("LUT_1D_SIZE 2\n0 0 nan\n", "line 2"),
        ("LUT_1D_SIZE 2\nDOMAIN_MAX 0 0 0\n0 0 0\n0 0 0\n", "domain is empty"),
        ("LUT_3D_SIZE 2\nLUT_3D_SIZE 2\n", "two tables"),
        ("LUT_1D_SIZE 2\nLUT_3D_SIZE 2\n0 0 0\n1 1 1\n", "2 of 10 entries"),
    ] {
        let error = read(text).expect_err(text);
        assert!(error.contains(words), "{text}: {error}");
    }
}
