//! What a glTF file says beside its shapes and materials, as pictures: lights in candela and lux, cameras, hidden nodes,
//! thin walls.

use std::f64::consts::PI;

use glossmith::{
    document::{AreaLightShape, Document, ImportLobe, of_model::materials_of},
    import::load,
    render::{EngineChoice, Session},
    scene::{Fate, Model, camera::Projection, environment::EnvironmentSource},
};
use serde_json::{Value, json};

use super::{
    cli_support::Workplace,
    gltf_builder::{Buffer, square},
    gltf_extensions::says,
    renders::{adjust, document, render},
};

const ENGINES: [EngineChoice; 2] = [EngineChoice::Cpu, EngineChoice::Gpu];

/// A white matt square [0, 1]² that faces +Z, with nodes beside it and lights for them.
fn lit(nodes: &[Value], lights: &[Value]) -> (Buffer, Value) {
    let (buffer, mut document) = square();
    document["materials"] = json!([{
        "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 1},
        "extensions": {"KHR_materials_specular": {"specularFactor": 0}},
    }]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    document["extensions"] = json!({"KHR_lights_punctual": {"lights": lights}});
    document["nodes"] = [&[json!({"mesh": 0})], nodes].concat().into();
    document["scenes"][0]["nodes"] = (0..=nodes.len()).collect();
    (buffer, document)
}

/// The scene of a file in the dark but for its own lights.
fn opened(folder: &Workplace, (buffer, file): &(Buffer, Value)) -> (Document, Model) {
    let source = folder.glb("scene.glb", file, buffer);
    let model = load(&source).unwrap();
    let mut document = document(source, EnvironmentSource::Furnace, &[]);
    document.materials = materials_of(&model, ImportLobe::Ggx);
    document.lighting.strength = 0.0;
    assert_eq!(document.add_lights_and_cameras(&model), 0);
    document.check().expect("in range");
    (document, model)
}

/// The radiance of a place of the square, seen from aside.
fn seen(document: &Document, engine: EngineChoice, [x, y]: [f64; 2]) -> f64 {
    let mut document = document.clone();
    document.camera.position = Some([0.5, -0.8, 0.9]);
    document.camera.target = Some([x, y, 0.0]);
    document.camera.fov_deg = 0.2;
    adjust(
        &mut document,
        "render.width=8 render.height=8 render.samples=512 render.bounces=1 render.sequence=sobol",
    );
    let luminance = render(engine, &document).luminance();
    luminance.iter().sum::<f64>() / luminance.len() as f64
}

const MIDDLE: [f64; 2] = [0.5, 0.5];
const ASIDE: [f64; 2] = [0.9, 0.5];

/// 25 cd at a distance of 1, or 25 lx: the radiance is 25 / π.
#[test]
fn candela_and_lux_of_a_file_are_right() {
    let spot = json!({"type": "spot", "intensity": 25, "spot": {"innerConeAngle": 0.19, "outerConeAngle": 0.2}});
    let straight = 25.0 / PI;
    let above = json!([0.5, 0.5, 1.0]);
    let placed = |rotation: Value| json!({"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": above, "rotation": rotation});
    let ahead = json!([0.0, 0.0, 0.0, 1.0]);
    let of_point = straight / 1.16_f64.powf(1.5);
    for (name, light, rotation, expected) in [
        ("spot", &spot, &ahead, [straight, 0.0]),
        ("spot that looks away", &spot, &json!([0.0, 1.0, 0.0, 0.0]), [0.0, 0.0]),
        (
            "point",
            &json!({"type": "point", "intensity": 25}),
            &ahead,
            [straight, of_point],
        ),
        (
            "sun",
            &json!({"type": "directional", "intensity": 25}),
            &ahead,
            [straight; 2],
        ),
    ] {
        let folder = Workplace::new();
        let (document, _) = opened(&folder, &lit(&[placed(rotation.clone())], std::slice::from_ref(light)));
        for engine in ENGINES {
            for (place, expected) in [MIDDLE, ASIDE].into_iter().zip(expected) {
                let found = seen(&document, engine, place);
                // Half of the samples of a ball go to its far side: 32 768 of them are right to 0.7 % (1σ). A unit that is
                // wrong is off by far more.
                near!(found, expected, 0.03 * expected, "{name} at {place:?}, {engine:?}");
            }
        }
    }
}

/// A spot's cone and direction, whatever the middle of the model; its intensity, however small the model.
#[test]
fn spots_keep_their_cone_and_direction() {
    for scale in [1.0, 0.001] {
        let node = json!({"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [2.0 * scale, 0, scale]});
        let spot = json!({"type": "spot", "intensity": 100, "color": [4, 2, 0], "range": 3,
            "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}});
        let (buffer, mut file) = lit(&[node], &[spot]);
        file["nodes"][0]["scale"] = json!([scale, scale, scale]);
        let folder = Workplace::new();
        let (document, model) = opened(&folder, &(buffer, file));
        let light = document.lighting.area_lights[0];
        assert_eq!(light.shape, AreaLightShape::Spot);
        assert!((light.cone_deg - 1.0_f64.to_degrees()).abs() < 0.0001 && (light.softness - 0.5).abs() < 1e-6);
        let frame = light.shape().frame();
        assert!(frame.outwards.distance(glam::DVec3::Z) < 1e-6, "{:?}", frame.outwards);
        let place = frame.middle * model.radius + glam::DVec3::from_array(model.center);
        let expected = glam::dvec3(2.0 * scale, 0.0, scale);
        assert!(place.distance(expected) < 1e-6 * scale, "{place}, not {expected}");
        let area = 0.25 * PI * (light.width * model.radius).powi(2);
        let intensity = f64::from(light.strength) * area;
        near!(intensity / 400.0, 1.0, 1e-5);
        assert_eq!(light.color, [1.0, 0.5, 0.0]);
        says(&model, Fate::Ignored, "the range of a light");
    }
}

/// A camera keeps what is up; an orthographic one sees as much; one on a hidden node is there.
#[test]
fn cameras_keep_their_roll_and_hidden_nodes_are_not_seen() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let nodes = [
        json!({"camera": 0, "name": "rolled", "translation": [0.5, 0.5, 3.0], "rotation": [0.0, 0.0, half, half]}),
        json!({"camera": 1, "name": "flat", "translation": [0.5, 0.5, 2.0],
            "extensions": {"KHR_node_visibility": {"visible": false}}, "children": [3]}),
        json!({"mesh": 0, "translation": [5, 0, 0], "extensions": {"KHR_node_visibility": {"visible": true}}}),
    ];
    let (buffer, mut file) = lit(&nodes, &[]);
    file["scenes"][0]["nodes"] = json!([0, 1, 2]);
    file["cameras"] = json!([
        {"type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.01, "aspectRatio": 1.5}},
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 0.25, "znear": 0.01, "zfar": 10}},
    ]);
    let folder = Workplace::new();
    let (mut document, model) = opened(&folder, &(buffer, file));
    assert_eq!(model.mesh.triangles.len(), 2);
    says(&model, Fate::Used, "hidden nodes");
    says(&model, Fate::Ignored, "aspect ratio");
    document.add_lights_and_cameras(&model);
    let [rolled, flat] = &document.bookmarks[..] else {
        panic!("{:?}", document.bookmarks)
    };
    assert!((rolled.camera.roll_deg + 90.0).abs() < 1e-6 && flat.camera.roll_deg == 0.0);
    let position = flat.camera.position.expect("a place");
    let seen = 2.0 * position[2] * (0.5 * flat.camera.fov_deg.to_radians()).tan();
    near!(seen, 0.5, 1e-6);
    assert_eq!(flat.camera.projection, Projection::Orthographic);
    document.camera = rolled.camera;
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    session.submit(&document).unwrap();
    let camera = session.job().unwrap().settings.camera;
    let [up, right] = [camera.up, camera.right].map(|axis| glam::DVec3::from_array(axis.to_f64()).normalize());
    assert!(
        up.distance(glam::DVec3::NEG_X) < 1e-6 && right.distance(glam::DVec3::Y) < 1e-6,
        "{up} {right}"
    );
}

/// A pane without thickness has the index around it, which goes straight on, and mirrors as a coat.
#[test]
fn thin_walls_bend_nothing() {
    let (buffer, mut file) = square();
    file["materials"] = json!([
        {"name": "pane", "doubleSided": true, "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0, "baseColorFactor": [1, 0, 0, 1]},
            "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}},
    ]);
    file["meshes"][0]["primitives"][0]["material"] = json!(0);
    let folder = Workplace::new();
    let (_, model) = opened(&folder, &(buffer, file));
    let pane = &model.slots[0];
    assert_eq!(
        (
            pane.number("specular.ior"),
            pane.number("coat.weight"),
            pane.number("coat.ior")
        ),
        (1.0, 1.0, 1.5),
        "it mirrors as a coat"
    );
    says(&model, Fate::Approximated, "a thin wall");
    assert_eq!(model.report.of(Fate::Approximated).count(), 1, "{:?}", model.report);
}
