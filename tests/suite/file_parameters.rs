//! Tables of what becomes of a file's parameters: none of them is dropped in silence.

use glossmith::{
    document::{ImportLobe, MaterialSettings},
    import::{FileParameter, Goes, MTL_PARAMETERS},
    scene::Model,
    store::exchange::{ReadOptions, SURFACES, read, report::Entry},
};

use crate::{cli_support::Workplace, gltf_builder::png};

/// Parameters with their values.
type Values = Vec<(&'static str, &'static str)>;

/// The layers that a parameter is part of, each at its example.
fn layers(table: &[FileParameter], parameter: &FileParameter) -> Values {
    let mut all = Values::new();
    let mut layer = parameter.layer;
    // Some count only with each other.
    let is_new =
        |all: &Values, row: &FileParameter| row.place != parameter.place && !all.contains(&(row.place, row.example));
    while let Some(row) = table.iter().find(|row| row.place == layer && is_new(&all, row)) {
        all.push((row.place, row.example));
        layer = row.layer;
    }
    all
}

/// The same with the parameter at its example.
fn with(values: &Values, parameter: &FileParameter) -> Values {
    let own = [(parameter.place, parameter.example)];
    values.iter().copied().chain(own).collect()
}

fn materialx(kind: &str, values: &Values) -> String {
    let turned =
        "rotate3d name=\"turned\" type=\"vector3\"><input name=\"amount\" type=\"float\" value=\"30\"/></rotate3d>";
    let input = |(name, value): &(&str, &str)| match *value {
        "graph" => format!("<input name=\"{name}\" type=\"vector3\" nodename=\"turned\"/>"),
        _ => format!("<input name=\"{name}\" type=\"float\" value=\"{value}\"/>"),
    };
    let inputs: String = values.iter().map(input).collect();
    format!(
        "<materialx version=\"1.39\"><{turned}<{kind} name=\"s\" type=\"surfaceshader\">{inputs}</{kind}>\
         <surfacematerial name=\"M\" type=\"material\"><input name=\"surfaceshader\" type=\"surfaceshader\" \
         nodename=\"s\"/></surfacematerial></materialx>"
    )
}

fn usd(kind: &str, values: &Values) -> String {
    let input = |(name, value): &(&str, &str)| match *value {
        "graph" => format!("normal3f inputs:{name}.connect = </M/N.outputs:rgb>\n"),
        value if value.contains(',') => format!("color3f inputs:{name} = ({value})\n"),
        value => format!("float inputs:{name} = {value}\n"),
    };
    let inputs: String = values.iter().map(input).collect();
    format!(
        "#usda 1.0\ndef Material \"M\"\n{{\ndef Shader \"S\"\n{{\nuniform token info:id = \"{kind}\"\n{inputs}}}\n}}\n"
    )
}

/// What a document of one material is read as.
fn surface(place: &Workplace, name: &str, text: &str) -> (MaterialSettings, Vec<Entry>) {
    place.write(name, text);
    let options = ReadOptions {
        lobe: ImportLobe::Ggx,
        is_plain: true,
        ..ReadOptions::default()
    };
    let mut subject = read(&place.path(name), options).expect("is read");
    (subject.materials.remove(0), subject.losses.remove(0))
}

/// Each input of each kind of surface, off its default, changes the material; or the report names it.
#[test]
fn no_input_of_a_surface_is_dropped_in_silence() {
    let place = Workplace::new();
    let mut count = 0;
    for kind in SURFACES {
        for row in kind.inputs {
            let mut plain = layers(kind.inputs, row);
            if row.place == "anisotropy_strength" {
                // A roughness of 1, the default there, cannot be stretched.
                plain.push(("roughness", "0.25"));
            }
            let mut formats = vec![("s.mtlx", materialx as fn(&str, &Values) -> String)];
            if kind.name == "UsdPreviewSurface" {
                formats.push(("s.usda", usd));
            }
            for (file, text) in formats {
                let shown = |values: &Values| surface(&place, file, &text(kind.name, values));
                let (before, after) = (shown(&plain), shown(&with(&plain, row)));
                let names = |losses: &[Entry]| losses.iter().any(|entry| entry.what == row.place);
                match row.goes {
                    Goes::Nowhere(_) => assert!(names(&after.1), "{} {file}: {:?}", row.place, after.1),
                    _ => assert!(before.0 != after.0, "{} {}: {after:?}", kind.name, row.place),
                }
                assert!(
                    !names(&before.1),
                    "{} is told though it is not set: {:?}",
                    row.place,
                    before.1
                );
            }
            count += 1;
        }
    }
    assert!(count > 140, "{count}");
}

/// So are inputs that a kind does not have, numbers out of range, and what a material has besides its surface.
#[test]
fn inputs_that_no_table_has_and_numbers_out_of_range_are_told() {
    let place = Workplace::new();
    let values = vec![
        ("porosity", "0.5"),
        ("specular_ior", "6"),
        ("base_color", "2, 0.5, 0.5"),
    ];
    let text = materialx("open_pbr_surface", &values);
    let bump = "nodename=\"s\"/><input name=\"displacementshader\" type=\"displacementshader\" nodename=\"d\"/>";
    let (material, losses) = surface(&place, "s.mtlx", &text.replace("nodename=\"s\"/>", bump));
    assert_eq!((material.ior, material.base_color), (4.0, [1.0, 0.5, 0.5]));
    let mut named: Vec<&str> = losses.iter().map(|entry| entry.what.as_str()).collect();
    named.sort_unstable();
    assert_eq!(named, ["base_color", "displacementshader", "porosity", "specular_ior"]);
}

/// What glTF's surface in MaterialX lets through is what its alpha mode says.
#[test]
fn the_alpha_mode_of_a_gltf_surface_decides() {
    let place = Workplace::new();
    for (mode, opacity) in [("0", 1.0), ("1", 0.0), ("2", 0.25)] {
        let values = vec![("alpha", "0.25"), ("alpha_mode", mode)];
        let (material, losses) = surface(&place, "s.mtlx", &materialx("gltf_pbr", &values));
        assert_eq!((material.opacity, losses.len()), (opacity, 0), "{mode}: {losses:?}");
    }
}

/// The specular workflow has a colour of its own head-on, here 0.2, five times as much as the index reflects.
#[test]
fn a_preview_surface_reflects_its_specular_color() {
    let place = Workplace::new();
    let values = vec![
        ("useSpecularWorkflow", "1"),
        ("specularColor", "0.2, 0.04, 0"),
        ("metallic", "1"),
    ];
    for (file, text) in [
        ("s.mtlx", materialx("UsdPreviewSurface", &values)),
        ("s.usda", usd("UsdPreviewSurface", &values)),
    ] {
        let (material, losses) = surface(&place, file, &text);
        assert_eq!((material.metalness, losses.len()), (0.0, 0), "{losses:?}");
        let apart = |(found, right): (f32, f32)| (found - right).abs();
        let worst = material
            .specular_color
            .into_iter()
            .zip([5.0, 1.0, 0.0])
            .map(apart)
            .fold(0.0, f32::max);
        assert!(worst < 0.0001, "{:?}", material.specular_color);
    }
}

/// A triangle with a library of these lines.
fn painted(folder: &Workplace, lines: &[String]) -> Model {
    let library = format!("newmtl m\n{}\n", lines.join("\n"));
    folder.write("m.mtl", library);
    let obj = "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    folder.load("m.obj", obj.as_bytes()).expect("loads")
}

/// Each keyword of a library, off its default, changes the material or the report.
#[test]
fn no_keyword_of_a_library_is_dropped_in_silence() {
    let folder = Workplace::new();
    folder.write("picture.png", png());
    for row in MTL_PARAMETERS {
        let shiny = vec![("Ks", "0.5 0.5 0.5"), ("Ns", "10")];
        let mut plain: Values = shiny.into_iter().filter(|(key, _)| *key != row.place).collect();
        plain.extend(layers(MTL_PARAMETERS, row));
        let shown = |values: &Values| {
            let lines: Vec<String> = values.iter().map(|(key, value)| format!("{key} {value}")).collect();
            let model = painted(&folder, &lines);
            let told: Vec<_> = model.report.entries.iter().map(|entry| entry.what.clone()).collect();
            (format!("{:?}", model.slots[0]), told)
        };
        let (before, after) = (shown(&plain), shown(&with(&plain, row)));
        assert!(before != after, "{} leaves no trace: {before:?}", row.place);
        if let Goes::Nowhere(what) = row.goes {
            assert!(after.1.iter().any(|said| said == what), "{}: {:?}", row.place, after.1);
        }
    }
}
