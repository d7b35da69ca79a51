//! Meshes that many nodes of a file show: in memory once, and seen as if each node had a mesh of its own.

use glam::{DMat4, DQuat, DVec3, EulerRot};
use glossmith::{
    document::{Document, ImportLobe, of_model::materials_of},
    import::load,
    render::{EngineChoice, Session, SessionError},
    scene::{Geometry, Loading, Model, ModelSource, NO_OBJECT, environment::EnvironmentSource, teapot},
};
use serde_json::{Value, json};

use super::renders::{adjust, assert_same_picture, document, render};
use super::{cli_support::Workplace, gltf_builder::Buffer};

/// Nodes: enough for their triangles to be kept as instances.
const NODES: usize = 20;

/// Turned, stretched and mirrored in every way.
fn place(node: usize) -> DMat4 {
    let turn = node as f64;
    let mirrored = if node.is_multiple_of(3) { -1.0 } else { 1.0 };
    let size = DVec3::new(mirrored, 0.6 + 0.1 * (turn % 5.0), 1.0 + 0.3 * (turn % 3.0));
    let [column, row] = [node % 5, node / 5].map(|step| step as f64);
    DMat4::from_scale_rotation_translation(
        size,
        DQuat::from_euler(EulerRot::XYZ, 0.3 * turn, turn, 0.1 * turn),
        DVec3::new(12.0 * column, 12.0 * row, (7.0 * turn) % 5.0),
    )
}

/// The file of teapots of a material: all of one mesh, or of a mesh for each node.
fn teapots(folder: &Workplace, material: &Value, is_shared: bool) -> ModelSource {
    let mut buffer = Buffer::default();
    let mut primitive = buffer.mesh(&teapot::mesh(16));
    primitive["material"] = json!(0);
    let mut file = buffer.document(json!([primitive]));
    let one = file["meshes"][0].clone();
    if !is_shared {
        file["meshes"] = vec![one; NODES].into();
    }
    let node = |node: usize| {
        let mesh = if is_shared { 0 } else { node };
        json!({"name": format!("pot {node}"), "mesh": mesh, "matrix": place(node).to_cols_array()})
    };
    file["nodes"] = (0..NODES).map(node).collect();
    file["scenes"] = json!([{"nodes": (0..NODES).collect::<Vec<_>>()}]);
    file["materials"] = json!([material]);
    folder.glb(if is_shared { "shared.glb" } else { "apart.glb" }, &file, &buffer)
}

/// The same teapots as instances and one by one.
fn both(folder: &Workplace, material: &Value) -> [(ModelSource, Model); 2] {
    [true, false].map(|is_shared| {
        let source = teapots(folder, material, is_shared);
        let model = load(&source).expect("loads");
        (source, model)
    })
}

#[test]
fn a_mesh_of_many_nodes_is_in_memory_once() {
    let folder = Workplace::new();
    let [(_, shared), (_, apart)] = both(&folder, &json!({"doubleSided": true}));
    assert_eq!((shared.repeated.len(), shared.instances.len()), (1, NODES));
    assert!(shared.mesh.triangles.is_empty() && apart.repeated.is_empty());
    assert_eq!(shared.triangle_count(), apart.mesh.triangles.len());
    assert_eq!(
        shared.whole_mesh().triangles,
        apart.mesh.triangles,
        "exports write all of them"
    );
    assert_eq!(shared.whole_mesh().positions, apart.mesh.positions);
    assert!(
        10 * shared.bytes() < apart.bytes(),
        "{} and {}",
        shared.bytes(),
        apart.bytes()
    );
    assert_eq!((shared.center, shared.radius), (apart.center, apart.radius));
    assert!(shared.report.is_clean(), "{:?}", shared.report);
    let [shared, apart] = [shared, apart].map(|model| Geometry::build(&model, false));
    for geometry in [&shared, &apart] {
        geometry.prepare();
    }
    assert!(
        8 * shared.bytes() < apart.bytes(),
        "{} and {}",
        shared.bytes(),
        apart.bytes()
    );
    let dropped = [&shared, &apart].map(|geometry| geometry.dropped_no_area);
    assert_eq!(
        shared.triangle_count() + dropped[0],
        apart.triangle_count() + dropped[1]
    );
}

#[test]
fn an_instance_is_picked_and_hidden_as_its_node() {
    let folder = Workplace::new();
    let [(_, model), _] = both(&folder, &json!({}));
    let names: Vec<&str> = model.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names.len(), NODES);
    assert_eq!((names[0], names[7]), ("pot 0", "pot 7"));
    assert_eq!(model.slots_of(7), [0]);
    let geometry = Geometry::build(&model, true);
    let without = Geometry::of_model(&model, &[7], &Loading::default()).expect("not cancelled");
    let on_triangles = |object: u32| {
        let triangles = 0..geometry.triangle_count();
        triangles
            .filter(|&triangle| geometry.object(triangle) == object)
            .count()
    };
    assert_eq!(on_triangles(NO_OBJECT), 2, "the ground");
    assert_eq!(on_triangles(7), on_triangles(3));
    assert_eq!(
        without.triangle_count() + 2 + on_triangles(7),
        geometry.triangle_count()
    );
    let (center, radius) = geometry
        .sphere_around(|triangle| geometry.object(triangle) == 7)
        .expect("it is there");
    let center = geometry.world_from_units(center);
    let middle = place(7).transform_point3(DVec3::new(0.0, 1.5, 0.0));
    assert!(
        center.distance(middle) < 2.0 && radius * geometry.world_units_per_unit < 7.0,
        "{center}"
    );
    let place_of = geometry.places();
    assert!((0..geometry.triangle_count() as u32).all(|triangle| geometry.triangle_at(place_of(triangle)) == triangle));
    // A ray at the object meets it or what is before it, never the hidden one.
    let origin = geometry
        .units_from_world(middle + DVec3::new(0.0, 0.0, 60.0))
        .as_vec3()
        .to_array();
    let hit = geometry
        .intersect(origin, [0.0, 0.0, -1.0], f32::MAX)
        .expect("a teapot");
    assert_eq!(geometry.object(hit.triangle as usize), 7);
    let behind = without.intersect(origin, [0.0, 0.0, -1.0], f32::MAX);
    assert!(behind.is_none_or(|behind| without.object(behind.triangle as usize) != 7));
}

/// A GPU has the triangles of instances one by one: what does not fit is refused before it is made.
#[test]
fn instances_that_do_not_fit_a_gpu_are_refused_with_the_remedy() {
    let folder = Workplace::new();
    let source = teapots(&folder, &json!({}), true);
    let mut document = document(source, EnvironmentSource::Studio, &[]);
    adjust(&mut document, "render.width=16 render.height=16 render.samples=1");
    let submitted = |engine: EngineChoice, mib: u64| {
        let mut session = Session::open(engine).expect("opens");
        session.memory_limit = Some(mib << 20);
        session.submit(&document).map(|_| ())
    };
    submitted(EngineChoice::Cpu, 60).expect("each mesh once");
    let refused = submitted(EngineChoice::Gpu, 60).expect_err("one by one");
    assert!(matches!(refused, SessionError::TooLarge(_)), "{refused}");
    let text = refused.to_string();
    for words in ["triangles of the model's instances", "60 MiB are free", "--engine cpu"] {
        assert!(text.contains(words), "{text}");
    }
    submitted(EngineChoice::Gpu, 400).expect("one by one");
}

/// Brushed metal shows normals and tangents; shining plaster shows that all triangles are sampled.
#[test]
fn instances_look_as_meshes_of_their_own_do_on_both_engines() {
    let folder = Workplace::new();
    let brushed = json!({
        "pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": 0.4},
        "extensions": {"KHR_materials_anisotropy": {"anisotropyStrength": 0.8, "anisotropyRotation": 0.6}},
    });
    let shining = json!({"pbrMetallicRoughness": {"metallicFactor": 0}, "emissiveFactor": [0.3, 0.2, 0.1]});
    for (name, material) in [("brushed", brushed), ("shining", shining)] {
        let seen = |(source, model): &(ModelSource, Model), engine: EngineChoice| {
            let mut document = Document {
                materials: materials_of(model, ImportLobe::Ggx),
                ..document(source.clone(), EnvironmentSource::Studio, &[])
            };
            adjust(
                &mut document,
                "render.width=48 render.height=32 render.samples=32 render.bounces=4",
            );
            let film = render(engine, &document);
            assert_eq!(film.dropped(), 0, "{name}");
            film
        };
        let [shared, apart] = both(&folder, &material);
        let expected = seen(&apart, EngineChoice::Cpu);
        let lit = expected
            .luminance()
            .iter()
            .filter(|&&luminance| luminance > 0.01)
            .count();
        assert!(lit > 300, "{name}: {lit} pixels are lit");
        assert_same_picture(&seen(&shared, EngineChoice::Cpu), &expected, &format!("{name}, CPU"));
        assert_same_picture(&seen(&shared, EngineChoice::Gpu), &expected, &format!("{name}, GPU"));
    }
}
