//! Models in other formats than glTF: OBJ with its materials, FBX, PLY, STL; folders and archives.

use super::gltf_extensions::says;
use super::{
    cli_support::Workplace,
    gltf_builder::{glb, png, square},
};
use glam::{DVec3, Vec2, Vec3};
use glossmith::{
    document::{ImportLobe, of_model::materials_of},
    import::load,
    scene::{Fate, Geometry, Model, ModelSource, Wrap, texture::TextureTarget},
    store::exchange::{self, ReadOptions},
};
use std::io::Write;

const OBJ: &str = "mtllib paint.mtl\no Plate\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                   usemtl Paint\nf 1/1 2/2 3/3 4/4\nusemtl Bare\nf 1 3 4\n";
const MTL: &str = "newmtl Paint\nKd 0.5 0.25 1\nKs 0.5 0.5 0.5\nNs 30\nmap_Kd -s 1 1 1 Textures\\Wood.PNG\nd 0.75\nKe 1 2 3\n\
                   newmtl Bare\nKd 0 0 0\nPm 1\nPr 0.25\nmap_Kd gone.png\n";

#[test]
fn obj_files_come_with_their_materials() {
    let folder = Workplace::new();
    folder.write("Paint.mtl", MTL);
    // Another name by its case, and not in the folder that is named.
    folder.write("wood.png", png());
    let model = folder.load("plate.obj", OBJ.as_bytes()).expect("loads");
    assert_eq!((model.name.as_str(), model.mesh.triangles.len()), ("plate", 3));
    // v grows downwards here.
    let first = model.mesh.positions.iter().position(|place| *place == DVec3::ZERO);
    assert_eq!(model.mesh.uvs[first.expect("the first corner")], Vec2::new(0.0, 1.0));
    // It has none: triangles are flat.
    assert!(model.mesh.normals.iter().all(|normal| *normal == Vec3::ZERO));
    let [paint, bare] = &model.slots[..] else {
        panic!("{:?}", model.slots)
    };
    assert_eq!(
        (
            paint.name.as_str(),
            paint.color("base.color"),
            paint.number("geometry.opacity")
        ),
        ("Paint", [0.5, 0.25, 1.0], 0.75)
    );
    assert_eq!(
        (
            paint.color("emission.color"),
            paint.number("base.metalness"),
            paint.number("specular.roughness")
        ),
        ([1.0, 2.0, 3.0], 0.0, 0.5)
    );
    assert_eq!(
        model.textures[paint.texture(TextureTarget::BaseColor).expect("wood").texture].width,
        2
    );
    assert_eq!(
        (
            bare.number("base.metalness"),
            bare.number("specular.roughness"),
            bare.texture(TextureTarget::BaseColor)
        ),
        (1.0, 0.25, None)
    );
    let missing: Vec<_> = model.report.of(Fate::Missing).collect();
    assert_eq!(
        (missing.len(), missing[0].names[0].as_str()),
        (1, "gone.png"),
        "{missing:?}"
    );

    std::fs::remove_file(folder.path("Paint.mtl")).unwrap();
    let grey = folder
        .load("plate.obj", OBJ.as_bytes())
        .expect("a missing library stops nothing");
    assert!(
        grey.report.of(Fate::Missing).any(|entry| entry.names == ["paint.mtl"]),
        "{:?}",
        grey.report
    );
}

/// A square, its lines ended in ways that other programs write.
const ODD: &str = "# C:\\models\\\nmtllib odd.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                   usemtl\tClear\nf 1/1 2/2 \\\n 3/3 4/4\nusemtl \nf 1 2 3\n";
const ODD_MTL: &str = "newmtl Clear\nKd 0 0 1\nKs spectral steel.rfl\nTr 0.75\nTf 0.5 1 1\n\
                       map_Kd -s 4 2 1 -o 0.25 0 0 -clamp on -imfchan r four columns.png\nnewmtl\nKd 1 0 0\n";

/// Nothing of an OBJ file is refused for a line: it goes on after a `\\`, `usemtl` may be without a name, `vt` without v.
#[test]
fn odd_lines_of_obj_files_cost_themselves_alone() {
    let folder = Workplace::new();
    folder.write("odd.mtl", [ODD_MTL.as_bytes(), b"# \xe9t\xe9\n"].concat());
    folder.write("four columns.png", png());
    let model = folder.load("odd.obj", ODD.as_bytes()).expect("loads");
    assert_eq!(
        (model.mesh.triangles.len(), model.slots.len()),
        (3, 2),
        "{:?}",
        model.slots
    );
    let [clear, unnamed] = &model.slots[..] else {
        panic!("{:?}", model.slots)
    };
    assert_eq!((clear.name.as_str(), clear.number("geometry.opacity")), ("Clear", 0.25));
    assert_eq!(unnamed.color("base.color"), [1.0, 0.0, 0.0]);
    let texture = clear.texture(TextureTarget::BaseColor).expect("a name with a space");
    assert_eq!(texture.texture_from_mesh_uv, [4.0, 0.0, 0.25, 0.0, 2.0, -1.0]);
    assert_eq!(texture.wrap, [Wrap::ClampToEdge; 2]);
    for words in ["-imfchan r", "passes through (Tf)", "Ks spectral steel.rfl"] {
        says(&model, Fate::Ignored, words);
    }
    // Grey, not white.
    std::fs::remove_file(folder.path("four columns.png")).unwrap();
    let mtl = "newmtl Clear\nKd 1 1 0\nKe 1 1 1\nmap_Kd four columns.png\nmap_Ke gone.png\n";
    folder.write("odd.mtl", mtl);
    let grey = folder.load("odd.obj", ODD.as_bytes()).expect("loads");
    assert_eq!(grey.slots[0].color("base.color"), [0.5, 0.5, 0.0]);
    assert_eq!(grey.slots[0].color("emission.color"), [0.0; 3]);
    says(&grey, Fate::Missing, "a texture, grey instead");
}

/// Two squares with one line changed: what exporters write is read, and what none writes is refused.
#[test]
fn lines_of_an_obj_file_are_read_or_refused() {
    let folder = Workplace::new();
    let good = "v 0 0 0\nv 1 0 \\\n0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n\
                f 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/1/1\nf 2/1/1 5/2/1 6/3/1\n";
    let load = |from: &str, to: &str| {
        let text = good.replace(from, to);
        assert_ne!(text, good, "{from}");
        folder.load("bad.obj", text.as_bytes())
    };
    for (from, to) in [
        ("v 2 0 0", "v 2 0 0 # a corner"),
        ("v 2 0 0", "v 2 0 0 # in red and white"),
        ("vt 1 0", "vt 1 0 # half"),
        ("6/3/1", "6/3/1 # a face"),
        ("f 1/1/1 2", "l 1 2 3\nl 3 4\nf 1/1/1 2"),
    ] {
        let model = load(from, to).expect(to);
        assert!(model.report.is_clean(), "{to}: {:?}", model.report);
        assert_eq!((model.mesh.triangles.len(), model.mesh.colors.len()), (3, 0), "{to}");
    }
    for (from, to, fate, words) in [
        ("vn 0 0 1", "vn 0 0 nan", Fate::Approximated, "normals without a length"),
        (
            "vn 0 0 1",
            "vn -1.#IND 0 0",
            Fate::Approximated,
            "normals without a length",
        ),
        (
            "vn 0 0 1",
            "vn 0 -nan(ind) 0",
            Fate::Approximated,
            "normals without a length",
        ),
        (
            "vt 1 0",
            "vt 1e999 0",
            Fate::Ignored,
            "texture coordinates that are not finite",
        ),
        ("v 2 0 0", "v 2 0 1e999", Fate::Ignored, "a corner that is not finite"),
        (
            "f 2/1/1 5/2/1 6/3/1",
            "f 2/1/1 5/2/1 6/3/1\nf",
            Fate::Ignored,
            "Empty face",
        ),
    ] {
        let model = load(from, to).expect(to);
        says(&model, fate, words);
        assert!(model.mesh.uvs.iter().all(|uv| uv.is_finite()), "{to}");
    }
    for (from, to) in [
        ("v 2 0 0", "v 2 0 x"),
        ("v 2 0 0", "v 2 0"),
        ("vt 1 0", "vt 1 ?"),
        ("vn 0 0 1", "vn 0 0"),
        ("5/2/1", "7/2/1"),
        ("5/2/1", "0/2/1"),
        ("5/2/1", "-9/2/1"),
    ] {
        let error = load(from, to).expect_err(to).to_string();
        let is_plain = error.contains("bad.obj: damaged: ")
            && !error.contains("Failed to load")
            && error.ends_with("; export the model again");
        assert!(is_plain && !error.contains('\n'), "{to}: {error}");
    }
}

/// Area of a model in the plane z = 0, with its sign.
fn area(model: &Model) -> f64 {
    let mesh = &model.mesh;
    let doubled = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).z;
    (0..mesh.triangles.len()).map(|i| doubled(mesh.corners(i)) / 2.0).sum()
}

/// What the dialects of the format have: each file with the area that it covers, and the normals at its start and end.
#[test]
fn dialects_of_obj_files_are_read() {
    let folder = Workplace::new();
    let roof = "v -1 -1 -.5\nv 0 -1 0\nv 1 -1 -.5\nv -1 1 -.5\nv 0 1 0\nv 1 1 -.5\n";
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    for (name, text, covered, middle) in [
        // A fan from the first corner would reach outside.
        (
            "concave",
            "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 2 1 0\nv 0 3 0\nf 1 2 3 4 5\n".to_owned(),
            8.0,
            Vec3::ZERO,
        ),
        (
            "carriage returns",
            format!("{square}f 1 2 3 4\n").replace('\n', "\r"),
            1.0,
            Vec3::ZERO,
        ),
        ("smooth", format!("{roof}s 3\nf 1 2 5 4\nf 2 3 6 5\n"), 4.0, Vec3::Z),
        (
            "two groups",
            format!("{roof}s 3\nf 1 2 5 4\ns 4\nf 2 3 6 5\n"),
            4.0,
            Vec3::NAN,
        ),
        (
            "off",
            format!("{roof}s 3\ns off\nf 1 2 5 4\nf 2 3 6 5\n"),
            4.0,
            Vec3::ZERO,
        ),
        (
            "mixed",
            format!("{roof}vt 0 0\nvn 0 0 1\nf 1/1 2/1 5/1\nf 2//1 3//1 6//1 5//1\nf 1 5 4\n"),
            4.0,
            Vec3::NAN,
        ),
    ] {
        let model = folder.load("a.obj", text.as_bytes()).expect(name);
        near!(area(&model), covered, 1e-9, "{name}");
        let on_edge = |place: &DVec3| place.x == 0.0 && place.z == 0.0;
        let mut edge = model
            .mesh
            .positions
            .iter()
            .zip(&model.mesh.normals)
            .filter(|(place, _)| on_edge(place));
        assert!(middle.is_nan() || edge.all(|(_, normal)| *normal == middle), "{name}");
        let kinds = model
            .mesh
            .normals
            .iter()
            .map(|normal| normal.to_array().map(f32::to_bits));
        let kinds = kinds.collect::<std::collections::HashSet<_>>().len();
        assert!(!middle.is_nan() || kinds == 2, "{name}: {kinds}");
    }
}

/// Libraries in the words of many exporters.
#[test]
fn dialects_of_libraries_are_read() {
    let folder = Workplace::new();
    folder.write("picture.png", png());
    folder.write("other.mtl", "newmtl other\nKd 1 0 0\n");
    let obj = "mtllib\tother.mtl m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";
    for (library, color, texture) in [
        ("newmtl m\nkd 0.5 0.25 0\n", [0.5, 0.25, 0.0], false),
        ("newmtl m\rKd 0.5 0.25 0\r", [0.5, 0.25, 0.0], false),
        ("NEWMTL m\nKD 0.5\nMAP_KD C:\\export 2\\Picture.PNG\n", [0.5; 3], true),
        ("newmtl m\nKd xyz 0.9505 1 1.089\n", [1.0; 3], false),
        ("newmtl m\nKd 1 1 1\nmap_d picture.png\n", [1.0; 3], true),
    ] {
        folder.write("m.mtl", library);
        let model = folder.load("m.obj", obj.as_bytes()).expect("loads");
        let [slot] = &model.slots[..] else {
            panic!("{library}: one slot")
        };
        let apart = |i: usize| (slot.color("base.color")[i] - color[i]).abs();
        assert!(
            (0..3).all(|i| apart(i) < 0.001),
            "{library}: {:?}",
            slot.color("base.color")
        );
        assert_eq!(slot.texture(TextureTarget::BaseColor).is_some(), texture, "{library}");
        let is_mask = library.contains("map_d");
        assert_eq!(slot.texture(TextureTarget::Opacity).is_some(), is_mask, "{library}");
    }
}

/// A square metre in the ground, of centimetres and Z up, moved by a node and inside it, with Phong's red.
const FBX: &str = r#"; FBX 7.4.0 project file
FBXHeaderExtension:  {
    FBXVersion: 7400
}
GlobalSettings:  {
    Properties70:  {
        P: "UpAxis", "int", "Integer", "",2
        P: "UpAxisSign", "int", "Integer", "",1
        P: "FrontAxis", "int", "Integer", "",1
        P: "FrontAxisSign", "int", "Integer", "",-1
        P: "CoordAxis", "int", "Integer", "",0
        P: "CoordAxisSign", "int", "Integer", "",1
        P: "UnitScaleFactor", "double", "Number", "",1
    }
}
Objects:  {
    Geometry: 10, "Geometry::Plate", "Mesh" {
        Vertices: *12 {
            a: 0,0,0,100,0,0,100,100,0,0,100,0
        }
        PolygonVertexIndex: *4 {
            a: 0,1,2,-4
        }
        LayerElementMaterial: 0 {
            MappingInformationType: "AllSame"
            ReferenceInformationType: "IndexToDirect"
            Materials: *1 {
                a: 0
            }
        }
        Layer: 0 {
            LayerElement:  {
                Type: "LayerElementMaterial"
                TypedIndex: 0
            }
        }
    }
    Model: 20, "Model::Plate", "Mesh" {
        Properties70:  {
            P: "Lcl Translation", "Lcl Translation", "", "A",0,0,300
            P: "GeometricTranslation", "Vector3D", "Vector", "",500,0,0
        }
    }
    Model: 21, "Model::Other", "Mesh" {
    }
    Material: 30, "Material::Red", "" {
        ShadingModel: "phong"
        Properties70:  {
            P: "DiffuseColor", "Color", "", "A",0.5,0.25,0
            P: "SpecularColor", "Color", "", "A",1,1,1
            P: "Shininess", "double", "Number", "",30
            P: "Opacity", "double", "Number", "",0.75
        }
    }
}
Connections:  {
    C: "OO",20,0
    C: "OO",21,0
    C: "OO",10,20
    C: "OO",10,21
    C: "OO",30,20
    C: "OO",30,21
}
"#;

const GLOSSY: &str = r#"P: "3dsMax|ClassIDa", "int", "Integer", "",-804315648
            P: "3dsMax|ClassIDb", "int", "Integer", "",31173939
            P: "3dsMax|main|useGlossiness", "int", "Integer", "",1
            P: "3dsMax|main|glossiness", "float", "", "A",1
            P: "Opacity""#;
const GLOSS_MAP: &str = r#"    Texture: 40, "Texture::Gloss", "" {
        Type: "TextureVideoClip"
        RelativeFilename: "gloss.png"
    }
}
Connections:  {
    C: "OP",40,30, "3dsMax|main|glossiness_map""#;

#[test]
fn fbx_files_come_in_metres_with_y_up() {
    let folder = Workplace::new();
    let model = folder.load("plate.fbx", FBX.as_bytes()).expect("loads");
    let names: Vec<&str> = model.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!((names, model.mesh.triangles.len()), (vec!["Plate", "Other"], 4));
    let bound = |least: fn(DVec3, DVec3) -> DVec3| model.mesh.positions.iter().copied().reduce(least).unwrap();
    assert!(
        (bound(DVec3::min) - DVec3::new(0.0, 0.0, -1.0)).length() < 1e-9,
        "{}",
        bound(DVec3::min)
    );
    assert!(
        (bound(DVec3::max) - DVec3::new(6.0, 3.0, 0.0)).length() < 1e-9,
        "{}",
        bound(DVec3::max)
    );
    assert!(
        model
            .mesh
            .normals
            .iter()
            .all(|normal| (*normal - Vec3::Y).length() < 1e-6)
    );
    let [red] = &model.slots[..] else {
        panic!("{:?}", model.slots)
    };
    let numbers = ["specular.roughness", "geometry.opacity", "base.metalness"].map(|key| red.number(key));
    assert_eq!((red.color("base.color"), numbers), ([0.5, 0.25, 0.0], [0.5, 0.75, 0.0]));
    says(&model, Fate::Approximated, "Phong");
    // What 3ds Max has for its glossiness.
    std::fs::write(folder.path("gloss.png"), png()).unwrap();
    let glossy = FBX
        .replace("ShadingModel: \"phong\"", "ShadingModel: \"max\"")
        .replace("P: \"Opacity\"", GLOSSY)
        .replace("}\nConnections:  {", GLOSS_MAP);
    let model = folder.load("glossy.fbx", glossy.as_bytes()).expect("loads");
    let map = model.slots[0].texture(TextureTarget::Roughness).expect("a map").texture;
    assert_eq!(model.textures[map].rgba8[1], 235);
    // Visibility was a percentage, which the crate takes for 0.
    let old = "; FBX 5.0.0 project file\nModel: \"Model::Plate\" {\n Vertices: 0,0,0,100,0,0,100,100,0\n PolygonVertexIndex: 0,1,-3\n MaterialAssignation: \"AllSame\"\n \
               Channel: \"Visibility\" {\n Default: SHARE\n }\n}\n";
    for (share, is_shown) in [("100", true), ("0", false)] {
        let model = folder.load("old.fbx", old.replace("SHARE", share).as_bytes());
        assert_eq!(
            model.is_ok_and(|model| model.mesh.triangles.len() == 1),
            is_shown,
            "{share}"
        );
    }
    for (contents, words) in [
        (&FBX[..FBX.len() / 2], "plate.fbx"),
        ("no FBX", "plate.fbx"),
        ("", "no FBX file"),
    ] {
        let error = folder
            .load("plate.fbx", contents.as_bytes())
            .expect_err(words)
            .to_string();
        assert!(error.contains(words) && error.contains(';'), "{error}");
    }
}

/// Surfaces without a material are clay in every format. What is coloured by its vertices has no other colour.
#[test]
fn surfaces_without_a_material_are_clay() {
    let folder = Workplace::new();
    let (mut buffer, bare) = square();
    let mut colored = bare.clone();
    colored["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = buffer.floats(&[[1.0, 0.5, 0.0]; 4]).into();
    for key in ["bufferViews", "accessors", "buffers"] {
        colored[key] = buffer.document(bare["meshes"][0]["primitives"].clone())[key].clone();
    }
    let obj = |color: &str| {
        let corners = ["0 0 0", "1 0 0", "0 1 0"].map(|place| format!("v {place}{color}\n"));
        format!("{}f 1 2 3\n", corners.concat()).into_bytes()
    };
    let stl = b"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
    let ply = |color: &str, value: &str| {
        let corners = ["0 0 0", "1 0 0", "0 1 0"]
            .map(|place| format!("{place}{value}\n"))
            .concat();
        let places = "property float x\nproperty float y\nproperty float z\n";
        let faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
        format!("ply\nformat ascii 1.0\nelement vertex 3\n{places}{color}{faces}{corners}3 0 1 2\n").into_bytes()
    };
    let channels = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    for (name, bytes, is_colored) in [
        ("bare.glb", glb(&bare, &buffer.bytes), false),
        ("colored.glb", glb(&colored, &buffer.bytes), true),
        ("bare.obj", obj(""), false),
        ("colored.obj", obj(" 1 0.5 0"), true),
        ("bare.stl", stl.to_vec(), false),
        ("bare.ply", ply("", ""), false),
        ("colored.ply", ply(channels, " 255 128 0"), true),
    ] {
        let model = folder.load(name, &bytes).expect(name);
        let [material] = &materials_of(&model, ImportLobe::Ggx)[..] else {
            panic!("{name}: one material")
        };
        let color = if is_colored { [1.0; 3] } else { [0.6; 3] };
        let found = (material.name.as_str(), material.metalness, material.base_color);
        assert_eq!(found, ("Clay", 0.0, color), "{name}");
        assert_eq!(model.slots[0].has_vertex_colors, is_colored, "{name}");
    }
}

fn ply_header(format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment a square\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n\
         property list uchar int vertex_indices\nend_header\n"
    )
}

fn assert_colored_square(model: &Model) {
    assert_eq!(
        (model.mesh.triangles.len(), model.mesh.positions[2]),
        (2, DVec3::new(1.0, 1.0, 0.0))
    );
    assert!(model.mesh.normals.iter().all(|normal| *normal == Vec3::Z));
    assert!(
        model.slots[0].has_vertex_colors && model.report.is_clean(),
        "{:?}",
        model.report
    );
    let [red, green, blue, _] = model.mesh.colors[1];
    // 188 is the sRGB code of a half.
    assert!(
        (red - 0.503).abs() < 0.001 && green == 0.0 && blue == 1.0,
        "{red} {green} {blue}"
    );
}

#[test]
fn ply_files_may_be_text_or_bytes() {
    let folder = Workplace::new();
    let places = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mut text = ply_header("ascii");
    for [x, y, z] in places {
        text.push_str(&format!("{x} {y} {z} 188 0 255\n"));
    }
    text.push_str("4 0 1 2 3\n");
    assert_colored_square(&folder.load("square.ply", text.as_bytes()).expect("loads"));
    for (format, is_little) in [("binary_little_endian", true), ("binary_big_endian", false)] {
        let mut bytes = ply_header(format).into_bytes();
        for place in places {
            let order = |x: f32| if is_little { x.to_le_bytes() } else { x.to_be_bytes() };
            bytes.extend(place.into_iter().flat_map(order));
            bytes.extend([188, 0, 255]);
        }
        bytes.push(4);
        let order = |x: i32| if is_little { x.to_le_bytes() } else { x.to_be_bytes() };
        bytes.extend((0..4).flat_map(order));
        assert_colored_square(&folder.load("square.ply", &bytes).expect("loads"));
        assert!(folder.load("cut.ply", &bytes[..bytes.len() - 3]).is_err(), "{format}");
    }
}

/// Numbers of a text PLY file are those of C; a row that is no row of its element, and a file that is cut short, are refused.
#[test]
fn rows_of_a_ply_file_are_read_or_refused() {
    let folder = Workplace::new();
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n\
                  property list uchar int vertex_indices\nend_header\n";
    let body = "0 0 0 9 9 9\n1 0 0 9 9 9\n1 1 0 9 9 9\n0 1 0 9 8 9\n3 0 1 2\n3 0 2 3\n";
    let load = |from: &str, to: &str| {
        let text = [header, &body.replace(from, to)].concat();
        folder.load("bad.ply", text.as_bytes())
    };
    for (to, left) in [
        ("0 1 0 9 8 9", 2),
        (".0 1. -0.0 9 8 9", 2),
        ("0 nan 0 9 8 9", 1),
        ("0 -inf 0 9 8 9", 1),
    ] {
        let model = load("0 1 0 9 8 9", to).expect(to);
        assert_eq!(Geometry::build(&model, false).triangle_count(), left, "{to}");
    }
    for (from, to) in [
        ("0 1 0 9 8 9", "0 x 0 9 8 9"),
        ("0 1 0 9 8 9", "0 1"),
        ("0 1 0 9 8 9", "0 1 0 red 8 9"),
        ("3 0 2 3", "3 0 2"),
        ("3 0 2 3", "x 0 2 3"),
        ("3 0 2 3", "3 0 2 1.5"),
        ("3 0 2 3\n", ""),
    ] {
        let error = load(from, to).expect_err(to).to_string();
        let is_plain = error.contains("bad.ply: damaged: ") && error.ends_with("; export the model again");
        assert!(is_plain && !error.contains('\n'), "{to}: {error}");
    }
}

#[test]
fn stl_files_may_be_text_or_bytes() {
    let folder = Workplace::new();
    let text = "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 5\nendloop\nendfacet\nendsolid one\n";
    let mut bytes = vec![0; 80];
    bytes.extend(1u32.to_le_bytes());
    let numbers = [[0.0f32, 0.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 5.0]];
    bytes.extend(numbers.iter().flatten().flat_map(|x| x.to_le_bytes()));
    bytes.extend([0, 0]);
    for contents in [text.as_bytes(), &bytes] {
        let model = folder.load("one.stl", contents).expect("loads");
        // Z up becomes Y up.
        assert_eq!(
            model.mesh.corners(0),
            [DVec3::ZERO, DVec3::X, DVec3::new(0.0, 5.0, -1.0)]
        );
    }
}

/// Text is known by what it contains; all its solids are read, and loops of more corners than three.
#[test]
fn text_of_stl_files_is_read_as_programs_write_it() {
    let folder = Workplace::new();
    let corners = |places: &[&str]| -> String { places.iter().map(|place| format!("vertex {place}\n")).collect() };
    let facet = |places: &[&str]| format!("facet normal 0 0 1\nouter loop\n{}endloop\nendfacet\n", corners(places));
    let one = facet(&["0 0 0", "1 0 0", "0 1 0"]);
    let solid = format!("solid a b\n{one}endsolid a b\n");
    for (text, triangles) in [
        (format!("{solid}{solid}"), 2),
        (format!("solid\n{one}endsolid\n").replace('\n', "\r\n"), 1),
        (format!("solid\tname\n{one}endsolid\n").replace('\n', "\r"), 1),
        (format!("\u{feff}\n{solid}").to_uppercase(), 1),
        (
            format!("solid\n{}endsolid\n", facet(&["0 0 0", "2 0 0", "1 0.5 0", "0 2 0"])),
            2,
        ),
    ] {
        let model = folder.load("one.stl", text.as_bytes()).expect(&text);
        assert!(
            model.mesh.triangles.len() == triangles && model.report.is_clean(),
            "{text}: {:?}",
            model.report
        );
    }
    let cut = folder.load(
        "cut.stl",
        format!("{solid}solid\n{}", &one[..one.len() - 17]).as_bytes(),
    );
    says(&cut.expect("loads"), Fate::Missing, "a facet has no end");
    let error = folder
        .load("cut.stl", b"solid\nfacet\nvertex 0 x 0\n")
        .expect_err("refused")
        .to_string();
    assert!(error.contains("\"vertex 0 x 0\" is no corner"), "{error}");
}

/// What a PLY file has beside vertices with colours and convex faces: lengths of its mesh, the third corner's coordinates and
/// colour, the area.
#[test]
fn parts_of_ply_files_are_read_under_all_their_names() {
    let folder = Workplace::new();
    folder.write("wood.png", png());
    let load = |vertices: &str, values: [&str; 6], faces: &str, rows: &str| {
        let places = ["-1 -1 0", "1 -1 0", "1 1 0", "-1 1 0", "0 0 0", "0 0 0"];
        let body: String = places
            .iter()
            .zip(values)
            .map(|(place, value)| format!("{place} {value}\n"))
            .collect();
        let text = format!(
            "ply\nformat ascii 1.0\ncomment TextureFile wood.png\nelement vertex 6\nproperty float x\nproperty float y\n\
             property float z\n{vertices}element {faces}end_header\n{body}{rows}"
        );
        // A texture would hide colours.
        let has_uvs = vertices.contains("float") || faces.contains("texcoord");
        let text = if has_uvs {
            text
        } else {
            text.replace("comment TextureFile wood.png\n", "")
        };
        folder.load("parts.ply", text.as_bytes()).expect("loads")
    };
    let list = "property list uchar int vertex_indices\n";
    let area = |model: &Model| -> f64 {
        let doubled = (0..model.mesh.triangles.len()).map(|triangle| {
            let [a, b, c] = model.mesh.corners(triangle);
            (b - a).cross(c - a).length()
        });
        0.5 * doubled.sum::<f64>()
    };
    let uvs = ["0 0", "1 0", "1 0.75", "0 1", "0 0", "0 0"];
    for [u, v] in [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]] {
        let names = format!("property float {u}\nproperty float {v}\n");
        let model = load(&names, uvs, &format!("face 1\n{list}"), "4 0 1 2 3\n");
        assert_eq!(
            (model.mesh.uvs[2], model.textures.len()),
            (Vec2::new(1.0, 0.25), 1),
            "{u}"
        );
        assert!(
            model.slots[0].texture(TextureTarget::BaseColor).is_some() && model.report.is_clean(),
            "{u}"
        );
    }
    let wedges = format!("face 2\n{list}property list uchar float texcoord\n");
    let model = load(
        "",
        [""; 6],
        &wedges,
        "3 0 1 2 6 0 0 1 0 1 0.75\n3 0 2 3 6 0.5 0 1 1 0 1\n",
    );
    let at = |triangle: usize, corner: usize| model.mesh.uvs[model.mesh.triangles[triangle][corner] as usize];
    assert_eq!([at(0, 2), at(1, 0)], [Vec2::new(1.0, 0.25), Vec2::new(0.5, 1.0)]);
    assert!((area(&model) - 4.0).abs() < 1e-9 && model.textures.len() == 1);
    let colored = format!("face 2\n{list}property uchar red\nproperty uchar green\nproperty uchar blue\n");
    let model = load("", [""; 6], &colored, "3 0 1 2 255 0 0\n3 0 2 3 0 255 0\n");
    let color = |triangle: usize| model.mesh.colors[model.mesh.triangles[triangle][0] as usize];
    assert_eq!([color(0), color(1)], [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0]]);
    assert!(
        model.slots[0].has_vertex_colors && model.report.is_clean(),
        "{:?}",
        model.report
    );
    // A dent at its fourth corner, which a fan from the first would fill.
    let model = load("", [""; 6], &format!("face 1\n{list}"), "5 1 2 3 0 4\n");
    near!(area(&model), 3.0, 1e-9);
    let strips = load(
        "",
        [""; 6],
        "tristrips 1\nproperty list int int vertex_indices\n",
        "8 0 1 3 2 -1 0 1 4\n",
    );
    assert_eq!((strips.mesh.triangles.len(), area(&strips)), (3, 5.0));
    for triangle in 0..3 {
        let [a, b, c] = strips.mesh.corners(triangle);
        assert!((b - a).cross(c - a).z > 0.0, "{triangle}");
    }
    let other = load(
        "property int quality\n",
        ["7"; 6],
        &format!("face 1\n{list}"),
        "4 0 1 2 3\n",
    );
    says(&other, Fate::Ignored, "the property quality of each vertex");
}

/// A scene with Z up: a mesh with a subset, two more of it as instances, a lamp of 100 nits and a camera; alone and in a package.
#[test]
fn usd_files_come_with_instances_lights_and_cameras() {
    let folder = Workplace::new();
    let text = std::fs::read_to_string(std::path::Path::new(crate::ROOT).join("fuzz/corpus/usd/quad.usd")).unwrap();
    let mut package = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let stored = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    package.start_file("quad.usda", stored).unwrap();
    package.write_all(text.as_bytes()).unwrap();
    let package = package.finish().unwrap().into_inner();
    for (name, bytes) in [("quad.usd", text.as_bytes()), ("quad.usdz", &package)] {
        let model = folder.load(name, bytes).unwrap();
        let [red] = &model.slots[..] else {
            panic!("{name}: {:?}", model.slots)
        };
        assert_eq!(
            (model.triangle_count(), red.name.as_str(), red.color("base.color")),
            (9, "Red", [0.8, 0.1, 0.1]),
            "{name}"
        );
        let (low, high) = model
            .mesh
            .positions
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), place| {
                (low.min(*place), high.max(*place))
            });
        assert!(low.abs_diff_eq(DVec3::new(0.0, 2.0, -1.0), 1e-9), "{name}: {low}");
        assert!(high.abs_diff_eq(DVec3::new(5.0, 3.0, 0.0), 1e-9), "{name}: {high}");
        let ([lamp], [camera]) = (&model.lights[..], &model.cameras[..]) else {
            panic!("{name}: {:?} {:?}", model.lights, model.cameras)
        };
        near!(lamp.intensity, 100.0 * std::f32::consts::PI / 4.0, 0.001);
        near!(camera.position[2], 4.0, 1e-9);
    }
    // The second instance is turned half, and the cage is smooth across the edge of both faces.
    let turns = "quath[] orientations = [(1, 0, 0, 0), (0, 0, 0, 1)]\npoint3f[] positions";
    let turned = text
        .replace("\"none\"", "\"catmullClark\"")
        .replace("point3f[] positions", turns);
    let mesh = folder.load("turned.usd", turned.as_bytes()).unwrap().mesh;
    let high = mesh.positions.iter().copied().reduce(DVec3::max).unwrap();
    assert!(high.abs_diff_eq(DVec3::new(4.0, 3.0, 1.0), 1e-6), "{high}");
    let mean = Vec3::new(1.0, 2.0, 0.0).normalize();
    assert!(mesh.normals.iter().any(|normal| normal.abs_diff_eq(mean, 1e-6)));
    let deep = format!("#usda 1.0\n{}", "def \"a\" {".repeat(1000));
    let error = folder
        .load("deep.usd", deep.as_bytes())
        .expect_err("too deep")
        .to_string();
    assert!(error.contains("nested"), "{error}");
}

/// Shapes by half their extents and volume; other types of prims are named.
#[test]
fn usd_shapes_become_meshes() {
    use std::f64::consts::PI;
    let folder = Workplace::new();
    for (shape, half, volume) in [
        (
            "Sphere \"S\" {\n double radius = 2\n}",
            [2.0, 2.0, 2.0],
            32.0 * PI / 3.0,
        ),
        ("Cube \"S\" {\n double size = 3\n}", [1.5, 1.5, 1.5], 27.0),
        (
            "Cylinder \"S\" {\n uniform token axis = \"X\"\n double height = 6\n}",
            [3.0, 1.0, 1.0],
            6.0 * PI,
        ),
        ("Cone \"S\" {\n double height = 4\n}", [1.0, 1.0, 2.0], 4.0 * PI / 3.0),
    ] {
        let text = format!("#usda 1.0\n(metersPerUnit = 1)\ndef {shape}\ndef BasisCurves \"Hair\" {{\n}}\n");
        let model = folder.load("shape.usd", text.as_bytes()).expect(shape);
        let high = model.mesh.positions.iter().copied().reduce(DVec3::max).unwrap();
        assert!(high.abs_diff_eq(DVec3::from_array(half), 1e-9), "{shape}: {high}");
        let found = model.mesh.signed_volume();
        near!(found, volume, 0.01 * volume, "{shape}");
        says(&model, Fate::Ignored, "BasisCurves");
    }
}

/// The colours of a prim without a material, and of one whose material asks for them.
#[test]
fn usd_colours_of_prims_are_those_of_vertices() {
    let folder = Workplace::new();
    let look = "def Material \"M\"\n{\n token outputs:surface.connect = </M/S.outputs:surface>\n def Shader \"S\"\n {\n uniform token info:id = \
                \"UsdPreviewSurface\"\n color3f inputs:diffuseColor.connect = </M/R.outputs:result>\n token outputs:surface\n }\n def Shader \
                \"R\"\n {\n uniform token info:id = \"UsdPrimvarReader_float3\"\n string inputs:varname = \"displayColor\"\n float3 \
                outputs:result\n }\n}\n";
    for binding in ["", "rel material:binding = </M>"] {
        let text = format!(
            "#usda 1.0\n{look}def Cube \"C\"\n{{\n color3f[] primvars:displayColor = [(0.5, 0.25, 0)]\n {binding}\n}}\n"
        );
        let model = folder.load("cube.usd", text.as_bytes()).expect("loads");
        assert_eq!(model.slots[0].color("base.color"), [1.0; 3], "{binding}");
        assert!(model.slots[0].has_vertex_colors, "{binding}");
        assert!(model.mesh.colors.iter().all(|color| *color == [0.5, 0.25, 0.0, 1.0]) && !model.mesh.colors.is_empty());
    }
}

/// A material of a MaterialX layer through a graph's interface and an image, for a model and as a material.
#[test]
fn usd_refers_to_layers_of_materialx() {
    let folder = Workplace::new();
    let picture = image::RgbImage::from_pixel(2, 2, image::Rgb([255, 0, 0]));
    picture.save(folder.path("red.png")).unwrap();
    let layer = r#"<materialx version="1.38" colorspace="lin_rec709">
      <nodegraph name="g">
        <input name="rough" type="float" value="0.25"/>
        <image name="i" type="color3"><input name="file" type="filename" value="red.png" colorspace="srgb_texture"/></image>
        <output name="color" type="color3" nodename="i"/>
        <output name="roughness" type="float" interfacename="rough"/>
      </nodegraph>
      <standard_surface name="s" type="surfaceshader">
        <input name="base_color" type="color3" nodegraph="g" output="color"/>
        <input name="specular_roughness" type="float" nodegraph="g" output="roughness"/>
        <input name="metalness" type="float" value="0.5"/>
        <input name="specular_IOR" type="float" value="1.75"/>
      </standard_surface>
      <surfacematerial name="look" type="material">
        <input name="surfaceshader" type="surfaceshader" nodename="s"/>
      </surfacematerial>
    </materialx>"#;
    folder.write("look.mtlx", layer);
    let text = "#usda 1.0\ndef Sphere \"Ball\" (\n prepend apiSchemas = [\"MaterialBindingAPI\"]\n)\n{\n rel material:binding = </M>\n}\n\
                def Material \"M\" (\n prepend references = @./look.mtlx@</MaterialX/Materials/look>\n)\n{\n}\n";
    let model = folder.load("ball.usda", text.as_bytes()).unwrap();
    let [slot] = &model.slots[..] else {
        panic!("{:?}", model.slots)
    };
    let numbers = ["base.metalness", "specular.roughness", "specular.ior"].map(|key| slot.number(key));
    assert_eq!(
        (numbers, model.textures.len()),
        ([0.5, 0.25, 1.75], 1),
        "{:?}",
        model.report
    );
    says(&model, Fate::Approximated, "ND_standard_surface_surfaceshader");
    let subject = exchange::read(&folder.path("ball.usda"), ReadOptions::default()).unwrap();
    let material = &subject.materials[0];
    // An image of one colour is that colour.
    let color = (material.base_color, material.metalness, material.ior);
    assert_eq!(color, ([1.0, 0.0, 0.0], 0.5, 1.75));
}

#[test]
fn folders_and_archives_are_searched_for_a_model() {
    let folder = Workplace::new();
    let (buffer, mut document) = square();
    document["buffers"][0]["uri"] = serde_json::json!("../data/square.bin");
    let archive = folder.path("pack.zip");
    let mut writer = zip::ZipWriter::new(std::fs::File::create(&archive).unwrap());
    let files = [
        ("pack/readme.txt", b"Dear reader".as_slice()),
        ("pack/model/square.gltf", document.to_string().as_bytes()),
        ("pack\\data\\square.bin", &buffer.bytes),
        ("__MACOSX/pack/model/._square.gltf", b"junk"),
        ("._square.gltf", b"junk"),
    ]
    .map(|(name, bytes)| (name, bytes.to_vec()));
    for (name, bytes) in &files {
        writer
            .start_file(*name, zip::write::SimpleFileOptions::default())
            .unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap();
    let model = load(&ModelSource::File(archive.clone())).expect("loads");
    assert_eq!((model.name.as_str(), model.mesh.triangles.len()), ("pack", 2));
    assert!(
        model
            .report
            .of(Fate::Used)
            .any(|entry| entry.names == ["pack/model/square.gltf"])
    );
    assert!(model.report.is_clean(), "{:?}", model.report);

    let inside = folder.path("things");
    std::fs::create_dir(&inside).unwrap();
    std::fs::write(inside.join("b.stl"), "solid nothing").unwrap();
    let (buffer, document) = square();
    std::fs::write(inside.join("a.glb"), glb(&document, &buffer.bytes)).unwrap();
    let model = load(&ModelSource::File(inside)).expect("loads");
    assert_eq!((model.name.as_str(), model.mesh.triangles.len()), ("things", 2));
    assert!(
        model
            .report
            .of(Fate::Ignored)
            .any(|entry| entry.what.contains("other models"))
    );

    let empty = folder.path("empty.zip");
    zip::ZipWriter::new(std::fs::File::create(&empty).unwrap())
        .finish()
        .unwrap();
    let error = load(&ModelSource::File(empty)).expect_err("no model").to_string();
    assert!(error.contains("empty.zip") && error.contains("no model"), "{error}");
    // Cut short.
    let bytes = std::fs::read(&archive).unwrap();
    let error = folder
        .load("cut.zip", &bytes[..bytes.len() / 2])
        .expect_err("damaged")
        .to_string();
    assert!(error.contains("cut.zip"), "{error}");
}
