//! Details of what other programs' formats hold: each parameter where it belongs, and nothing said that is not so.

use glossmith::{
    document::{Document, ImportLobe, MaterialSettings, assign},
    import::gltf_from_widths,
    import::load,
    optics::fresnel::Fresnel,
    optics::lobe::Lobe,
    scene::ModelSource,
    scene::texture::{TextureTarget, UserTexture},
    store::exchange::{ReadOptions, Subject, by_name, prepare, read, report::Entry},
};
use serde_json::Value as Json;

use crate::{
    cli_support::Workplace,
    gltf_meaning::shining_by_vertices,
    renders::{material, set},
    textures::all_at_once,
};

/// What a format writes of a material.
fn written(place: &Workplace, material: &MaterialSettings, format: &str, ending: &str) -> String {
    place.save_material("a.json", material);
    place.done(&format!("convert a.json a.{ending} --to {format}"));
    place.read(&format!("a.{ending}"))
}

const METAL: &str = "specular.lobe=ggx base.metalness=1 specular.fresnel=conductor specular.roughness=0.3";

fn metal() -> MaterialSettings {
    material(METAL)
}

fn glass() -> MaterialSettings {
    material(
        "specular.lobe=ggx base.metalness=0 specular.fresnel=dielectric specular.roughness=0.3 transmission.weight=1",
    )
}

#[test]
fn mitsuba_gets_the_surface_that_a_material_is() {
    let place = Workplace::new();
    for (base, assignments, expected) in [
        (metal(), "specular.fresnel=conductor", "roughconductor"),
        (metal(), "specular.fresnel=schlick", "principled"),
        (metal(), "base.metalness=0.5", "principled"),
        (metal(), "coat.weight=0.5", "principled"),
        (glass(), "transmission.weight=1", "roughdielectric"),
        (glass(), "specular.roughness=0", "dielectric"),
        (glass(), "transmission.weight=0.5", "principled"),
    ] {
        let mut material = base;
        assign(&mut material, assignments).unwrap();
        let text = written(&place, &material, "mitsuba", "xml");
        for kind in [
            "roughconductor",
            "dielectric",
            "roughdielectric",
            "principled",
            "diffuse",
        ] {
            let has = text.contains(&format!("<bsdf type=\"{kind}\""));
            assert_eq!(has, kind == expected, "{assignments}: {kind}");
        }
    }
}

/// OpenPBR's coat comes back as it went, and one that leaves the base as it is does not without a word.
#[test]
fn what_a_coat_does_to_the_base_is_in_open_pbr() {
    let place = Workplace::new();
    let coated = material(&format!(
        "{METAL} coat.weight=0.5 coat.darkening=0.25 coat.anisotropy=0.5 coat.lobe=ggx coat.roughness=0.3"
    ));
    let report_of = |material: &MaterialSettings, ending: &str| {
        place.save_material("a.json", material);
        place.done(&format!("convert a.json a.{ending} --report -")).stdout
    };
    assert!(!report_of(&coated, "mtlx").contains("share in the base"));
    place.done("convert a.mtlx b.json --without-exact --import-lobe ggx");
    let back = place.material("b.json");
    let coat = |m: &MaterialSettings| (m.coat_on_base, m.coat_darkening, m.coat_lobe);
    assert_eq!(coat(&back), coat(&coated));
    near!(back.coat_anisotropy, 0.5, 0.0001);
    near!(back.coat_roughness, 0.3, 0.0001);
    // glTF has it in a draft, and the clearcoat beside it.
    report_of(&coated, "glb");
    place.done("convert a.glb b.json --without-exact --import-lobe ggx");
    let back = place.material("b.json");
    assert_eq!(coat(&back), coat(&coated));
    near!(back.coat_anisotropy, 0.5, 0.0001);
    assert!(report_of(&coated, "xml").contains("what the coat changes below it"));
    let mut plain = coated;
    plain.keep_below_coat();
    assert!(report_of(&plain, "mtlx").contains("share in the base"));
    assert!(!report_of(&plain, "xml").contains("what the coat changes below it"));
}

#[test]
fn what_a_material_lacks_is_not_reported() {
    let place = Workplace::new();
    let told = |material: &MaterialSettings, word: &str| {
        place.save_material("a.json", material);
        let report = place.done("convert a.json a.mtlx --report -").stdout;
        report.contains(&format!("\"what\": \"{word}\""))
    };
    for word in [
        "refraction",
        "absorption inside",
        "coat",
        "anisotropy",
        "extra roughness of the refraction",
    ] {
        assert!(!told(&metal(), word), "{word}");
    }
    assert!(told(&glass(), "refraction"));
}

/// The format multiplies no emission by them: they stand on an unlit material.
#[test]
fn colours_of_vertices_that_shine_travel_in_gltf() {
    let folder = Workplace::new();
    let place = Workplace::new();
    place.save_document("scene.json", &shining_by_vertices(&folder));
    let run = place.done("convert scene.json scene.glb");
    assert!(!run.stderr.contains("vertex colours"), "{}", run.stderr);
    let model = load(&place.model("scene.glb")).unwrap();
    let slot = &model.slots[0];
    assert!(
        slot.is_unlit && slot.has_vertex_colors && !model.mesh.colors.is_empty(),
        "{slot:?}"
    );
    assert_eq!(slot.color("emission.color"), [1.0; 3]);
    let run = place.done("convert scene.glb back.json");
    assert!(!run.stderr.contains("changed since"), "{}", run.stderr);
}

#[test]
fn textures_travel_in_gltf() {
    let folder = Workplace::new();
    let mut document = all_at_once(&folder);
    let place = Workplace::new();
    place.save_document("scene.json", &document);
    place.done("convert scene.json scene.glb");
    let [before, after] = [document.model.clone(), place.model("scene.glb")].map(|source| load(&source).unwrap());
    assert_eq!(after.textures.len(), before.textures.len());
    let [old, new] = [&before, &after].map(|model| &model.slots[0]);
    let pixels = |model: &glossmith::scene::Model, target| {
        let place = model.slots[0].texture(target).expect("a texture");
        let picture = &model.textures[place.texture];
        (picture.width, picture.height, picture.rgba8.clone())
    };
    let maps = [
        TextureTarget::BaseColor,
        TextureTarget::Roughness,
        TextureTarget::Normal,
        TextureTarget::Emission,
    ];
    for target in maps {
        assert_eq!(pixels(&before, target), pixels(&after, target));
    }
    assert_eq!((old.alpha_mode, old.alpha_cutoff), (new.alpha_mode, new.alpha_cutoff));
    assert_eq!(
        old.number("geometry.normal_strength"),
        new.number("geometry.normal_strength")
    );
    assert!(
        (0.0..=1.0).contains(&new.number("specular.roughness")),
        "{}",
        new.number("specular.roughness")
    );
    // What a file has one number for is that of the texture's mean.
    let mean = {
        let (width, height, rgba8) = pixels(&before, TextureTarget::Roughness);
        let greens = rgba8.chunks(4).map(|texel| f32::from(texel[1]));
        greens.sum::<f32>() / (255 * width * height) as f32
    };
    (document.materials[0].lobe, document.materials[0].anisotropy) = (Lobe::Ggx, 0.5);
    place.save_document("scene.json", &document);
    let wanted = gltf_from_widths(document.materials[0].roughness * mean, 0.5).stretch;
    place.done("convert scene.json scene.gltf");
    let json: Json = place.json("scene.gltf");
    let found = json["materials"][0]["extensions"]["KHR_materials_anisotropy"]["anisotropyStrength"].as_f64();
    let found = found.unwrap_or_else(|| panic!("{json:#}"));
    assert!(
        (found - f64::from(wanted)).abs() < 0.001 && wanted > 0.05,
        "{found} {wanted}"
    );
}

/// A node's kind, with the output that is taken where it has several, its inputs, and the colour that it has.
type Node<'a> = (&'a str, &'a str, [f32; 3]);

/// The nodes of MaterialX that are computed. None of these goes beyond [0, 1], where colours end.
const NODES: &[Node<'_>] = &[
    ("constant", "value=0.1,0.2,0.3", [0.1, 0.2, 0.3]),
    ("dot", "in=0.2,0.4,0.9", [0.2, 0.4, 0.9]),
    ("convert", "in=0.3", [0.3; 3]),
    ("add", "in1=0.25,0.5,0.75; in2=0.25", [0.5, 0.75, 1.0]),
    ("subtract", "in1=0.25,0.5,0.75; in2=0.25", [0.0, 0.25, 0.5]),
    ("multiply", "in1=0.25,0.5,0.75; in2=0.25", [0.0625, 0.125, 0.1875]),
    ("multiply", "in1=0.25,0.5,0.75", [0.25, 0.5, 0.75]),
    ("divide", "in1=0.25,0.5,0.75; in2=2", [0.125, 0.25, 0.375]),
    ("divide", "in1=0.25,0.5,0.75; in2=0", [0.0; 3]),
    ("modulo", "in1=0.25,0.5,0.75; in2=0.5", [0.25, 0.0, 0.25]),
    ("min", "in1=0.25,0.5,0.75; in2=0.5", [0.25, 0.5, 0.5]),
    ("max", "in1=0.25,0.5,0.75; in2=0.5", [0.5, 0.5, 0.75]),
    ("power", "in1=0.25,0.5,0.75; in2=2", [0.0625, 0.25, 0.5625]),
    ("safepower", "in1=0.5; in2=2", [0.25; 3]),
    ("invert", "in=0.2,0.4,0.9", [0.8, 0.6, 0.1]),
    ("absval", "in=-0.5", [0.5; 3]),
    ("sign", "in=0,0.5,3", [0.0, 1.0, 1.0]),
    ("floor", "in=1.7", [1.0; 3]),
    ("ceil", "in=0.2", [1.0; 3]),
    ("round", "in=0.7", [1.0; 3]),
    ("sqrt", "in=0.25", [0.5; 3]),
    ("exp", "in=-1", [0.367_879_45; 3]),
    ("ln", "in=2", [std::f32::consts::LN_2; 3]),
    ("sin", "in=0.5", [0.479_425_54; 3]),
    ("cos", "in=0.5", [0.877_582_55; 3]),
    ("clamp", "in=0.2,0.4,0.9; low=0.3; high=0.5", [0.3, 0.4, 0.5]),
    ("mix", "bg=0.2; fg=0.6; mix=0.25", [0.3; 3]),
    ("smoothstep", "in=0.25", [0.15625; 3]),
    ("remap", "in=0.5; outlow=0.2; outhigh=0.4", [0.3; 3]),
    ("contrast", "in=0.75; amount=1.5", [0.875; 3]),
    ("separate3.outg", "in=0.2,0.4,0.9", [0.4; 3]),
    ("separate3.outz", "in=0.2,0.4,0.9", [0.9; 3]),
    ("extract", "in=0.2,0.4,0.9; index=2", [0.9; 3]),
    ("swizzle", "in=0.2,0.4,0.9; channels=bgr", [0.9, 0.4, 0.2]),
    ("combine3", "in1=0.1; in2=0.2; in3=0.3", [0.1, 0.2, 0.3]),
    ("luminance", "in=0.2,0.4,0.9; lumacoeffs=0.5,0.25,0.25", [0.425; 3]),
    ("saturate", "in=0.2,0.4,0.9; amount=0; lumacoeffs=1,0,0", [0.2; 3]),
    ("dotproduct", "in1=0.1,0.2,0.3; in2=0.5,0.5,1", [0.45; 3]),
];

/// The base colours of a document's surfaces.
fn base_colors(place: &Workplace, elements: &str) -> Vec<[f32; 3]> {
    place.write(
        "a.mtlx",
        format!("<materialx colorspace=\"lin_rec709\">{elements}</materialx>"),
    );
    let subject = read(&place.path("a.mtlx"), ReadOptions::default()).unwrap();
    subject.materials.iter().map(|material| material.base_color).collect()
}

/// A surface whose base colour is connected so.
fn surface(number: usize, connection: &str) -> String {
    format!(
        "<standard_surface name=\"s{number}\" type=\"surfaceshader\"><input name=\"base\" type=\"float\" value=\"1\"/>\
         <input name=\"base_color\" type=\"color3\" {connection}/></standard_surface>"
    )
}

#[test]
fn the_usual_nodes_of_materialx_are_computed() {
    let place = Workplace::new();
    let element = |(number, (kind, inputs, _)): (usize, &Node<'_>)| {
        let (kind, output) = kind.split_once('.').unwrap_or((kind, "out"));
        let input = |input: &str| {
            let (name, value) = input.split_once('=').unwrap();
            let kind = ["float", "color3"][usize::from(value.contains(','))];
            format!("<input name=\"{name}\" type=\"{kind}\" value=\"{value}\"/>")
        };
        let inputs: String = inputs.split("; ").map(input).collect();
        let surface = surface(number, &format!("nodename=\"n{number}\" output=\"{output}\""));
        format!("<{kind} name=\"n{number}\" type=\"color3\">{inputs}</{kind}>{surface}")
    };
    let found = base_colors(&place, &NODES.iter().enumerate().map(element).collect::<String>());
    assert_eq!(found.len(), NODES.len());
    for (found, (kind, .., expected)) in found.iter().zip(NODES) {
        assert!(distance(*found, *expected) < 1e-5, "{kind}: {found:?} and {expected:?}");
    }
}

fn distance(found: [f32; 3], expected: [f32; 3]) -> f32 {
    let apart = |(found, expected): (f32, f32)| (found - expected).abs();
    found.into_iter().zip(expected).map(apart).fold(0.0, f32::max)
}

#[test]
fn graphs_of_materialx_are_followed_through_their_outputs_and_interfaces() {
    let place = Workplace::new();
    let picture = image::RgbaImage::from_fn(4, 4, |x, _| image::Rgba([if x < 2 { 255 } else { 0 }, 51, 255, 102]));
    picture.save(place.path("a.png")).unwrap();
    // A comment that is no XML, and a name in angle brackets, as MaterialX has them.
    let document = "<!-- a<b:c \" --><image name=\"u\"><input name=\"file\" type=\"filename\" value=\"g.<UDIM>.png\"/></image>\
        <nodegraph name=\"g\"><input name=\"amount\" type=\"float\" value=\"0.5\"/><multiply name=\"half\">\
        <input name=\"in1\" type=\"color3\" value=\"0.5, 1, 0\"/><input name=\"in2\" type=\"float\" interfacename=\"amount\"/></multiply>\
        <separate3 name=\"parts\"><input name=\"in\" nodename=\"half\"/></separate3>\
        <output name=\"a\" nodename=\"half\"/><output name=\"b\" nodename=\"parts\" output=\"outg\"/></nodegraph>\
        <gltf_colorimage name=\"p\"><input name=\"file\" type=\"filename\" value=\"a.png\"/></gltf_colorimage>\
        <invert name=\"i\"><input name=\"in\" nodename=\"p\"/></invert>\
        <power name=\"s\"><input name=\"in1\" nodename=\"p\"/><input name=\"in2\" value=\"2\"/></power>\
        <image name=\"c\" type=\"color3\"><input name=\"file\" type=\"filename\" value=\"a.png\" colorspace=\"srgb_texture\"/></image>\
        <power name=\"t\"><input name=\"in1\" nodename=\"c\"/><input name=\"in2\" value=\"2\"/></power>";
    let connections = [
        ("nodegraph=\"g\" output=\"a\"", [0.25, 0.5, 0.0]),
        ("nodegraph=\"g\" output=\"b\"", [0.5; 3]),
        ("nodegraph=\"g\"", [0.25, 0.5, 0.0]),
        // A texture of its own, which multiplies white.
        ("nodename=\"p\" output=\"outcolor\"", [1.0; 3]),
        ("nodename=\"p\" output=\"outa\"", [0.4; 3]),
        // So does it inverted; what is no multiple of it is computed of its mean.
        ("nodename=\"i\"", [1.0; 3]),
        ("nodename=\"s\"", [0.25, 0.04, 1.0]),
        ("nodename=\"t\"", [0.25, 0.001096, 1.0]),
    ];
    let surfaces = connections
        .iter()
        .enumerate()
        .map(|(number, (connection, _))| surface(number, connection));
    let found = base_colors(&place, &[document.to_owned(), surfaces.collect()].concat());
    for (found, (connection, expected)) in found.iter().zip(connections) {
        assert!(distance(*found, expected) < 1e-5, "{connection}: {found:?}");
    }
}

#[test]
fn brackets_in_strings_and_dictionaries_of_usd_open_no_shader() {
    let place = Workplace::new();
    let text = "#usda 1.0\ndef Material \"A\" (\n customData = {\n string x = \"}{ # \\\" }\"\n }\n)\n{\n def Shader \"S\"\n {\n \
                uniform token info:id = \"UsdPreviewSurface\" # a { comment\n float inputs:roughness = 0.25 (\n \
                doc = \"}\"\n )\n color3f inputs:diffuseColor = (1, 0.5, 0.25)\n }\n}\n";
    reads_as(&place, "a.usda", text, [1.0, 0.5, 0.25], "");
}

/// A file whose first material has this base colour and says these words; the surface is `S` of MaterialX, or whatever the file has.
fn reads_as(place: &Workplace, name: &str, text: &str, expected: [f32; 3], words: &str) {
    place.write(name, text);
    let options = ReadOptions {
        lobe: ImportLobe::Ggx,
        ..ReadOptions::default()
    };
    let subject = read(&place.path(name), options).unwrap_or_else(|error| panic!("{text}: {error}"));
    let (found, told) = (subject.materials[0].base_color, format!("{:?}", subject.losses[0]));
    assert!(
        distance(found, expected) < 0.0002,
        "{text}: {found:?}, not {expected:?}"
    );
    assert_eq!(
        told.contains(words),
        !words.is_empty() || told == "[]",
        "{text}: {told}"
    );
}

/// Values by the primaries of the spaces' specifications, adapted by Bradford's transform.
#[test]
fn colour_spaces_of_the_standard_are_those_of_document_graph_and_input() {
    let place = Workplace::new();
    let spaces = [
        ("acescg", [0.478831, 0.288029, 0.182302]),
        ("lin_ap1", [0.478831, 0.288029, 0.182302]),
        ("lin_ap1_scene", [0.478831, 0.288029, 0.182302]),
        ("lin_ap0", [0.590924, 0.281976, 0.181627]),
        ("lin_rec2020", [0.473334, 0.28838, 0.186312]),
        ("lin_displayp3", [0.422494, 0.295794, 0.188209]),
        ("srgb_displayp3", [0.146281, 0.070731, 0.02799]),
        ("lin_adobergb", [0.439836, 0.3, 0.195707]),
        ("srgb_texture", [0.132868, 0.073239, 0.033105]),
        ("g18_rec709", [0.19218, 0.114503, 0.055189]),
        ("g22_rec709", [0.133209, 0.07074, 0.028991]),
        ("gamma22", [0.133209, 0.07074, 0.028991]),
        ("rec709_display", [0.110903, 0.055602, 0.021012]),
        ("g22_ap1", [0.180728, 0.063044, 0.021105]),
        ("lin_rec709", [0.4, 0.3, 0.2]),
        ("none", [0.4, 0.3, 0.2]),
        ("acme_log", [0.4, 0.3, 0.2]),
    ];
    for (space, expected) in spaces {
        let named = format!("colorspace=\"{space}\"");
        let words = if space == "acme_log" { space } else { "" };
        for [document, graph, input] in [
            [&named[..], "", ""],
            ["", &named, ""],
            ["colorspace=\"acescg\"", "", &named],
        ] {
            let text = format!(
                "<materialx {document}><nodegraph name=\"g\" {graph}><constant name=\"c\" type=\"color3\"><input name=\"value\" \
                 type=\"color3\" value=\"0.4, 0.3, 0.2\" {input}/></constant><output name=\"o\" nodename=\"c\"/></nodegraph>{}</materialx>",
                surface(0, "nodegraph=\"g\"")
            );
            reads_as(&place, "a.mtlx", &text, expected, words);
        }
    }
}

#[test]
fn documents_of_materialx_are_read_as_they_are_meant() {
    let place = Workplace::new();
    let constant = |name: &str, value: &str| {
        format!(
            "<constant name=\"{name}\" type=\"color3\"><input name=\"value\" type=\"color3\" value=\"{value}\"/></constant>"
        )
    };
    let graph = format!(
        "<nodegraph name=\"g\">{}<output name=\"o\" nodename=\"k\"/></nodegraph>",
        constant("k", "0, 1, 0")
    );
    let shared = format!(
        "{}{}{graph}<input name=\"top\" type=\"color3\" value=\"1, 0.25, 0\"/>",
        constant("a", "0.1, 0.2, 0.3"),
        constant("b", "0, 0, 1")
    );
    let choice = |kind: &str, inputs: &str| {
        let all = format!("{inputs}<input name=\"in1\" nodename=\"a\"/><input name=\"in2\" nodename=\"b\"/>");
        format!("<{kind} name=\"n\" type=\"color3\">{all}</{kind}>")
    };
    let values =
        |a: f32, b: f32| format!("<input name=\"value1\" value=\"{a}\"/><input name=\"value2\" value=\"{b}\"/>");
    let (first, second) = ([0.1, 0.2, 0.3], [0.0, 0.0, 1.0]);
    let cases = [
        ("value=\"1, 0, 0\" nodename=\"b\"", String::new(), second, ""),
        ("value=\"1, 0, 0\" nodename=\"b\" nodegraph=\"g\" output=\"o\"", String::new(), [0.0, 1.0, 0.0], ""),
        ("nodename=\"a\" channels=\"bgr\"", String::new(), [0.3, 0.2, 0.1], ""),
        ("nodename=\"a\" channels=\"g\"", String::new(), [0.2; 3], ""),
        ("interfacename=\"top\"", String::new(), [1.0, 0.25, 0.0], ""),
        ("interfacename=\"nowhere\"", String::new(), [0.8; 3], "interfacename"),
        ("nodename=\"n\"", "<wobble name=\"n\" type=\"color3\"/>".to_owned(), [0.8; 3], "wobble"),
        ("value=\"red\"", String::new(), [0.8; 3], "red is no number"),
        ("nodename=\"n\"", choice("ifgreater", &values(2.0, 1.0)), first, ""),
        ("nodename=\"n\"", choice("ifgreater", &values(1.0, 1.0)), second, ""),
        ("nodename=\"n\"", choice("ifgreatereq", &values(1.0, 1.0)), first, ""),
        ("nodename=\"n\"", choice("ifequal", &values(1.0, 2.0)), second, ""),
        ("nodename=\"n\"", choice("switch", "<input name=\"which\" type=\"integer\" value=\"1\"/>"), second, ""),
        // A node of the document's own kind, given one input, with the other by default.
        (
            "nodename=\"n\"",
            "<nodedef name=\"ND\" node=\"mine\"><input name=\"x\" type=\"color3\" value=\"1, 1, 1\"/><input name=\"y\" \
             type=\"color3\" value=\"0.5, 0.25, 0\"/></nodedef><nodegraph name=\"i\" nodedef=\"ND\"><add name=\"s\"><input \
             name=\"in1\" interfacename=\"x\"/><input name=\"in2\" interfacename=\"y\"/></add><output name=\"out\" \
             nodename=\"s\"/></nodegraph><mine name=\"n\"><input name=\"x\" type=\"color3\" nodename=\"a\"/></mine>"
                .to_owned(),
            [0.6, 0.45, 0.3],
            "",
        ),
    ];
    for (connection, node, expected, words) in cases {
        let text = format!("<materialx>{shared}{node}{}</materialx>", surface(0, connection));
        reads_as(&place, "a.mtlx", &text, expected, words);
    }
    // A material of a kind of its own.
    let graph = surface(0, "interfacename=\"paint\"").replace("s0", "s");
    let text = format!(
        "<materialx><nodedef name=\"ND\" node=\"mine\"><input name=\"paint\" type=\"color3\" value=\"0, 0.5, 0\"/></nodedef>\
         <nodegraph name=\"i\" nodedef=\"ND\">{graph}<surfacematerial name=\"m\" type=\"material\"><input name=\"surfaceshader\" \
         nodename=\"s\"/></surfacematerial><output name=\"out\" type=\"material\" nodename=\"m\"/></nodegraph>\
         <mine name=\"A\" type=\"material\"/></materialx>"
    );
    reads_as(&place, "a.mtlx", &text, [0.0, 0.5, 0.0], "");
    for (unit, thickness, words) in [
        ("micron", 0.25, ""),
        ("nanometer", 250.0, ""),
        ("parsec", 250.0, "parsec"),
    ] {
        let film = format!(
            "name=\"thin_film_thickness\" type=\"float\" value=\"{thickness}\" unittype=\"distance\" unit=\"{unit}\""
        );
        let text = format!(
            "<materialx>{}</materialx>",
            surface(0, "value=\"1, 1, 1\"").replace("name=\"base\" type=\"float\" value=\"1\"", &film)
        );
        reads_as(&place, "a.mtlx", &text, [1.0; 3], words);
        let subject = read(&place.path("a.mtlx"), ReadOptions::default()).unwrap();
        near!(subject.materials[0].film_thickness, 0.25, 1e-6, "{unit}");
    }
}

#[test]
fn materials_of_usd_are_read_by_way_of_their_connections() {
    let place = Workplace::new();
    image::RgbImage::from_pixel(2, 2, image::Rgb([128, 64, 255]))
        .save(place.path("t.png"))
        .unwrap();
    let preview =
        |inputs: &str| format!("def Shader \"S\" {{\n uniform token info:id = \"UsdPreviewSurface\"\n{inputs}\n}}\n");
    let texture = |inputs: &str, output: &str| {
        let connected = preview(&format!(
            "color3f inputs:diffuseColor.connect = </M/T.outputs:{output}>"
        ));
        format!("def Shader \"T\"\n{{\nuniform token info:id = \"UsdUVTexture\"\n{inputs}\n}}\n{connected}")
    };
    let to_preview = "token outputs:surface.connect = </M/S.outputs:surface>\n";
    let to_mtlx = "token outputs:mtlx:surface.connect = </M/S.outputs:out>\n";
    let file = "asset inputs:file = @./t.png@\n";
    let mtlx = |id: &str, input: &str| {
        format!(
            "def Shader \"S\" {{\n uniform token info:id = \"ND_{id}_surfaceshader\"\n{input} = (0.4, 0.3, 0.2)\n}}\n"
        )
    };
    let (red, linear) = ([0.8, 0.0, 0.0], [0.21586, 0.051269, 1.0]);
    let raw = "token inputs:sourceColorSpace = \"raw\"\n";
    let cases = [
        (
            to_preview,
            preview(
                "# color3f inputs:diffuseColor = (0, 1, 0)\n color3f inputs:diffuseColor = (0.8, 0, 0) (doc = \"}\"); int inputs:x",
            ),
            red,
            "",
        ),
        (
            "color3f inputs:paint = (0.8, 0, 0)\n",
            preview("color3f inputs:diffuseColor.connect = </M.inputs:paint>"),
            red,
            "",
        ),
        (
            to_preview,
            format!(
                "variantSet \"look\" = {{\n\"a\" {{\n{}}}\n\"b\" {{\n}}\n}}\n",
                preview("color3f inputs:diffuseColor = (0.8, 0, 0)")
            ),
            red,
            "",
        ),
        (
            to_mtlx,
            mtlx("UsdPreviewSurface", "color3f inputs:diffuseColor"),
            [0.4, 0.3, 0.2],
            "",
        ),
        (
            to_mtlx,
            mtlx("standard_surface", "float inputs:base = 1; color3f inputs:base_color"),
            [0.4, 0.3, 0.2],
            "",
        ),
        (to_preview, texture(file, "rgb"), linear, ""),
        (
            to_preview,
            texture(&format!("{file}{raw}"), "rgb"),
            [0.50196, 0.25098, 1.0],
            "",
        ),
        (to_preview, texture(&format!("{file}{raw}"), "g"), [0.25098; 3], ""),
        (
            to_preview,
            texture(
                &format!("{file}{raw}float4 inputs:scale = (0.5, 1, 1, 1)\nfloat4 inputs:bias = (0.1, 0, 0, 0)"),
                "rgb",
            ),
            [0.35098, 0.25098, 1.0],
            "",
        ),
        (
            to_preview,
            texture(
                "asset inputs:file = @./none.png@\nfloat4 inputs:fallback = (0.2, 0.4, 0.6, 1)",
                "rgb",
            ),
            [0.2, 0.4, 0.6],
            "none.png",
        ),
        (
            to_preview,
            preview("color3f inputs:diffuseColor.connect = </M/Gone.outputs:rgb>"),
            [0.18; 3],
            "not there",
        ),
    ];
    for (outputs, shaders, expected, words) in cases {
        let text = format!(
            "#usda 1.0\n(\n \"\"\"a }} word\"\"\"\n defaultPrim = \"M\"\n)\ndef Material \"M\" (\n prepend variantSets = \"look\"\n variants = {{\n \
             string look = \"a\"\n }}\n)\n{{\n{outputs}{shaders}}}\n"
        );
        reads_as(&place, "a.usda", &text, expected, words);
    }
}

/// A material with textures that are placed, weakened and inverted, and the folder that it goes to.
fn textured(place: &Workplace) -> MaterialSettings {
    let picture = image::RgbImage::from_fn(4, 4, |x, y| image::Rgb([60 * x as u8, 60 * y as u8, 200]));
    picture.save(place.path("t.png")).unwrap();
    std::fs::create_dir(place.path("out")).unwrap();
    let mut material = glass();
    for target in [
        TextureTarget::BaseColor,
        TextureTarget::Roughness,
        TextureTarget::Opacity,
        TextureTarget::Normal,
    ] {
        let texture = UserTexture::of(place.path("t.png"));
        material.user_textures.set(target, Some(texture));
        material.textures[target] = true;
    }
    set(
        &mut material,
        "base.color=0.5,0.25,1 specular.roughness=0.5 geometry.normal_strength=0.5 transmission.weight=0 \
         base.color_map.scale=2 base.color_map.stretch=1.5 base.color_map.offset_u=0.25 base.color_map.offset_v=-0.5 \
         base.color_map.rotation=30 specular.roughness_map.channel=green specular.roughness_map.strength=0.75 \
         specular.roughness_map.inverted=on geometry.opacity_map.channel=red geometry.opacity_map.strength=0.5 \
         geometry.normal_map.scale=2 geometry.normal_map.stretch=1.5 geometry.normal_map.offset_u=0.25 \
         geometry.normal_map.offset_v=-0.5 geometry.normal_map.inverted=on",
    );
    place.save_material("a.json", &material);
    material
}

/// The numbers that say where a texture lies and what is done to its values.
fn mapping(texture: &UserTexture) -> [f32; 7] {
    let UserTexture {
        scale,
        stretch,
        rotation_deg,
        offset: [right, up],
        strength,
        inverted,
        ..
    } = *texture;
    [scale, stretch, rotation_deg, right, up, strength, f32::from(inverted)]
}

/// Textures of a material go beside the document and come back from there, with the exact parameters and without.
#[test]
fn textures_of_a_material_travel_and_come_back() {
    let place = Workplace::new();
    let material = textured(&place);
    for (format, name) in [
        ("materialx", "a.mtlx"),
        ("standard-surface", "a.mtlx"),
        ("usd", "a.usda"),
    ] {
        let run = place.done(&format!("convert a.json out/{name} --to {format} --report -"));
        assert!(run.stdout.contains("texture of Base colour"), "{}", run.stdout);
        assert!(!run.stdout.contains("dropped"), "{}", run.stdout);
        for is_plain in [false, true] {
            let options = ReadOptions {
                lobe: ImportLobe::Ggx,
                is_plain,
                ..ReadOptions::default()
            };
            let subject = read(&place.path("out").join(name), options).unwrap();
            let (back, losses) = (&subject.materials[0], &subject.losses[0]);
            let is_said = |entry: &&Entry| !entry.detail.contains("is read");
            assert_eq!(losses.iter().find(is_said), None, "{format}");
            let numbers = |m: &MaterialSettings| {
                (
                    m.base_color,
                    m.roughness,
                    m.normal_strength,
                    m.opacity,
                    m.transmission_weight,
                )
            };
            assert_eq!(numbers(back), numbers(&material), "{format}");
            for (target, texture) in material.user_textures.iter() {
                let found = back.user_textures.get(target).expect("is there");
                assert_eq!(found.file, place.path("out/a_t.png"));
                let apart = std::iter::zip(mapping(found), mapping(texture)).map(|(a, b)| (a - b).abs());
                assert!(apart.fold(0.0, f32::max) < 1e-5, "{format}: {found:?} and {texture:?}");
                assert_eq!(
                    (found.channel, found.is_srgb(target)),
                    (texture.channel, target.is_color())
                );
            }
        }
    }
}

#[test]
fn a_texture_that_was_placed_elsewhere_lies_as_it_was_placed() {
    let place = Workplace::new();
    textured(&place);
    for (name, from, to) in [
        ("a.usda", "inputs:scale = (2, 3)", "inputs:scale = (4, 3)"),
        (
            "a.mtlx",
            "name=\"scale\" type=\"vector2\" value=\"0.5, ",
            "name=\"scale\" type=\"vector2\" value=\"0.25, ",
        ),
    ] {
        place.done(&format!("convert a.json {name}"));
        let text = place.read(name);
        assert!(text.contains(from), "{text}");
        place.write(name, text.replace(from, to));
        let subject = read(&place.path(name), ReadOptions::default()).unwrap();
        let told = format!("{:?}", subject.losses[0]);
        assert!(told.contains("changed since"), "{name}: {told}");
        let found = subject.materials[0].user_textures.get(TextureTarget::Normal).unwrap();
        near!(found.scale, 4.0, 1e-5, "{name}");
    }
}

/// Materials of USD lie on a model as they lay on a ball: a stretched texture that is turned has two transforms.
#[test]
fn textures_of_an_exported_material_lie_on_a_model_of_usd() {
    let place = Workplace::new();
    let material = textured(&place);
    place.done("convert a.json out/a.usda");
    let text = place.read("out/a.usda");
    let name = text
        .split("def Material \"")
        .nth(1)
        .and_then(|rest| rest.split('"').next())
        .unwrap();
    let quad = format!(
        "def Mesh \"Quad\" (\n prepend apiSchemas = [\"MaterialBindingAPI\"]\n)\n{{\n int[] faceVertexCounts = [4]\n \
         int[] faceVertexIndices = [0, 1, 2, 3]\n point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]\n \
         texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (\n interpolation = \"faceVarying\"\n )\n \
         rel material:binding = </Materials/{name}>\n}}\n"
    );
    place.write("out/a.usd", text.clone() + &quad);
    let model = load(&place.model("out/a.usd")).unwrap();
    for target in [
        TextureTarget::BaseColor,
        TextureTarget::Roughness,
        TextureTarget::Normal,
    ] {
        let found = model.slots[0].texture(target).expect("is there").texture_from_mesh_uv;
        let wanted = material.user_textures.get(target).unwrap().picture_from_uv();
        let apart = std::iter::zip(found, wanted).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f32::max) < 1e-5, "{target:?}: {found:?} and {wanted:?}");
    }
}

/// Scenes and scripts name the files beside them, with what their programs do to the numbers.
#[test]
fn textures_of_a_material_travel_to_what_is_only_written() {
    let place = Workplace::new();
    textured(&place);
    let told = place.done("convert a.json out/a.xml --report -").stdout;
    assert!(
        told.contains("texture of Roughness") && !told.contains("the surface has no input"),
        "{told}"
    );
    let text = place.read("out/a.xml");
    let scene = roxmltree::Document::parse(&text).unwrap();
    let maps = scene.descendants().filter(|node| node.has_tag_name("texture"));
    let mut files = Vec::new();
    for map in maps {
        let value = |of: &str| {
            let named = |node: &roxmltree::Node<'_, '_>| node.attribute("name") == Some(of);
            map.descendants().find(named).and_then(|node| node.attribute("value"))
        };
        let is_raw = value("raw") == Some("true");
        assert_eq!(is_raw, map.attribute("name") != Some("base_color"));
        let file = value("filename").unwrap();
        assert!(place.path("out").join(file).is_file(), "{file}");
        files.push(file.to_owned());
    }
    files.sort();
    assert_eq!(
        files,
        [
            "a_base_color.pfm",
            "a_normalmap.pfm",
            "a_opacity.pfm",
            "a_roughness.pfm"
        ]
    );
    // 0.5 (1 − 0.75 g) in the last row, which comes first.
    let bytes = place.bytes("out/a_roughness.pfm");
    let rest = bytes.strip_prefix(b"Pf\n4 4\n-1.0\n").expect("a header");
    let first = f32::from_le_bytes(*rest.first_chunk().unwrap());
    near!(first, 0.5 * (1.0 - 0.75 * 180.0 / 255.0), 1e-6);
    let script = written(&place, &place.material("a.json"), "blender", "py");
    assert!(place.path("a_t.png").is_file());
    for words in [
        "\"Base Color\": (\"a_t.png\", \"sRGB\", \"Color\", ",
        ", 30.0, (0.5, 0.33333334), (0.5, 0.25, 1.0), (0.0, 0.0, 0.0))",
        "\"Roughness\": (\"a_t.png\", \"Non-Color\", \"Green\", (0.0, 0.0), 0.0, (1.0, 1.0), (-0.375, -0.375, -0.375), (0.5, 0.5, 0.5))",
        "(0.5, -0.5, 1.0), (0.25, 0.75, 0.0))",
    ] {
        assert!(script.contains(words), "{words}: {script}");
    }
}

/// What the report says a file shows is what is drawn of the file, read without the exact parameters.
#[test]
fn a_file_opened_again_gives_the_picture_that_was_told() {
    let place = Workplace::new();
    let mut material = textured(&place);
    // glTF has opacity in the colour's texture alone, and Schlick's approximation.
    material.user_textures.set(TextureTarget::Opacity, None);
    material.textures[TextureTarget::Opacity] = false;
    material.fresnel = Fresnel::Schlick;
    for (format, name) in [("materialx", "out/a.mtlx"), ("usd", "out/a.usda")] {
        let format = by_name(format).unwrap();
        let prepared = prepare(&Subject::of(material.clone()), "a", &place.path(name), format).unwrap();
        prepared.save().unwrap();
        let [_, mut shown] = prepared.report.materials[0].looks.as_deref().unwrap().clone();
        if name.ends_with("usda") {
            // Of the two surfaces that one is read which has Schlick's approximation.
            shown.fresnel = Fresnel::Schlick;
        }
        place.save_material("shown.json", &shown);
        place.done(&format!("convert {name} found.json --without-exact --import-lobe ggx"));
        let picture = |of: &str| place.picture(&format!("--model sphere --size 48x48 --samples 16 --material {of}"));
        let apart = picture("shown.json").difference(&picture("found.json"));
        assert!(apart < 0.01, "{name}: {apart}");
    }
    // glTF stretches before it turns.
    place.save_material("a.json", &material);
    let told = place.done("convert a.json a.glb").stderr;
    assert!(told.contains("stretches a texture before it turns it"), "{told}");
    material
        .user_textures
        .get_mut(TextureTarget::BaseColor)
        .unwrap()
        .stretch = 1.0;
    let scenes = Workplace::new();
    let painted = shining_by_vertices(&scenes);
    let ball = Document {
        model: ModelSource::Sphere,
        materials: vec![material],
        ..Document::default()
    };
    for (what, document) in [("textures", ball), ("vertex colours", painted)] {
        place.save_document("scene.json", &document);
        place.done("convert scene.json scene.glb");
        let picture = |of: &str| place.picture(&format!("--size 48x48 --samples 16 {of}"));
        let apart = picture("scene.json").difference(&picture("--model scene.glb --import-lobe ggx"));
        assert!(apart < 0.02, "{what}: {apart}");
    }
}
