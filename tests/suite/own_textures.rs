//! Pictures of the user's own: where they lie, what of them counts, that both engines see the same, and that files keep them.

use std::path::Path;
use std::sync::Arc;

use glossmith::compile::compile_textured;
use glossmith::document::{Document, PixelFilter, texture_assignments};
use glossmith::job::effect::EffectId;
use glossmith::optics::tone::linear_from_srgb;
use glossmith::optics::vector::Vec3;
use glossmith::render::{EngineChoice, Session};
use glossmith::scene::environment::EnvironmentSource;
use glossmith::scene::texture::{
    Pack, TextureAssignment, TextureChannel, TextureProjection, TextureSpace, TextureTarget, Textures, UserTexture,
    mapped_normal, texture_lookup, uvs_at,
};
use glossmith::scene::{Geometry, Model, ModelSource, Texture};
use glossmith::store::{PRESETS, load_document, load_material, save_document, save_material};
use image::{Rgba, RgbaImage};
use serde_json::json;

use crate::cli_support::{Workplace, read_exr};
use crate::gltf_builder::Folder;
use crate::random_documents::of_material;
use crate::renders::{assert_same_picture, render};
use crate::textures::{four_texels, textured_square};

/// The picture of [`four_texels`] in a file.
pub fn own_texture(folder: &Folder) -> UserTexture {
    let path = folder.path("own.png");
    four_texels().save(&path).unwrap();
    UserTexture::of(path)
}

/// A ball whose coat has the weight that a picture on a box gives it.
pub fn coated_on_a_box(folder: &Folder) -> Document {
    let mut document = of_material(ModelSource::Shaderball, PRESETS[0].clone());
    let coat = UserTexture {
        projection: TextureProjection::Box,
        ..own_texture(folder)
    };
    document.materials[0].put_texture(TextureTarget::Coat, coat);
    document
}

fn linear(code: u8) -> f64 {
    linear_from_srgb(Vec3::<f64>::splat(f64::from(code) / 255.0)).x
}

/// A square with texture coordinates and no textures.
fn square() -> Model {
    let (buffer, document) = textured_square(&json!({"name": "Square"}), &[], &json!({}));
    Folder::new().load_glb(&document, &buffer).unwrap()
}

/// A model's textures with one picture of the user's own on its first slot.
fn with(model: &Model, target: TextureTarget, texture: &UserTexture, picture: &RgbaImage) -> Textures {
    let read = |_: &Path, _: bool| {
        Ok(Arc::new(Texture {
            name: "own".into(),
            width: picture.width(),
            height: picture.height(),
            rgba8: picture.as_raw().clone(),
            rgba16: Vec::new(),
        }))
    };
    let assigned = [TextureAssignment {
        slot: 0,
        target,
        texture: texture.clone(),
    }];
    Pack::new(model, &assigned, &read).textures(model, &assigned)
}

/// Red, green, blue and alpha at these texture coordinates.
fn found(target: TextureTarget, texture: &UserTexture, uv: [f64; 2]) -> [f64; 4] {
    let textures = with(&square(), target, texture, &four_texels());
    let record = textures.slots[0].record(target);
    let (color, alpha) = texture_lookup::<f64>(&textures, record, [uv, [9.0; 2], [9.0; 2]]);
    let [r, g, b] = color.to_f64();
    [r, g, b, alpha]
}

#[track_caller]
fn assert_near(found: [f64; 4], expected: [f64; 4]) {
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < 1e-5, "{found:?}, expected {expected:?}");
    }
}

/// Places of the picture that are seen at places of the coordinates, told as the guide tells it.
#[test]
fn a_picture_is_scaled_turned_and_moved() {
    let base = TextureTarget::BaseColor;
    let plain = UserTexture::default();
    let at = |texture: &UserTexture, uv: [f64; 2]| found(base, texture, uv);
    let here = |uv: [f64; 2]| found(base, &UserTexture::default(), uv);
    let uv = [0.3, 0.15];
    // Twice as many: what is a quarter from the middle is seen an eighth from it.
    let smaller = UserTexture {
        scale: 2.0,
        ..plain.clone()
    };
    assert_near(
        at(&smaller, uv),
        here([0.5 + 2.0 * (uv[0] - 0.5), 0.5 + 2.0 * (uv[1] - 0.5)]),
    );
    let stretched = UserTexture {
        stretch: 3.0,
        ..plain.clone()
    };
    assert_near(at(&stretched, uv), here([uv[0], 0.5 + 3.0 * (uv[1] - 0.5)]));
    // A quarter counterclockwise: what was right is above.
    let turned = UserTexture {
        rotation_deg: 90.0,
        ..plain.clone()
    };
    assert_near(at(&turned, [0.5, 0.2]), here([0.8, 0.5]));
    assert_near(at(&turned, [0.2, 0.5]), here([0.5, 0.2]));
    // Further right and further up: what is seen lay further left and further down.
    let moved = UserTexture {
        offset: [0.1, 0.2],
        ..plain.clone()
    };
    assert_near(at(&moved, uv), here([uv[0] - 0.1, uv[1] + 0.2]));
    let second = UserTexture {
        projection: TextureProjection::Second,
        ..plain
    };
    assert_near(at(&second, uv), here([9.0, 9.0]));
}

#[test]
fn channels_spaces_strength_and_inversion_are_what_they_say() {
    let plain = UserTexture::default();
    // The lower left texel: (0, 200, 0, 64); the upper right one: (100, 0, 0, 128).
    let (lower_left, upper_right) = ([0.25, 0.75], [0.75, 0.25]);
    let green = UserTexture {
        channel: TextureChannel::Green,
        ..plain.clone()
    };
    let share = 200.0 / 255.0;
    assert_near(found(TextureTarget::Roughness, &green, lower_left), [share; 4]);
    let codes = UserTexture {
        space: TextureSpace::Srgb,
        ..green.clone()
    };
    assert_near(found(TextureTarget::Roughness, &codes, lower_left), [linear(200); 4]);
    let inverted = UserTexture {
        inverted: true,
        ..green.clone()
    };
    assert_near(found(TextureTarget::Roughness, &inverted, lower_left), [1.0 - share; 4]);
    // Half of it: half way to doing nothing.
    let half = UserTexture {
        strength: 0.5,
        ..green.clone()
    };
    assert_near(
        found(TextureTarget::Metalness, &half, lower_left),
        [0.5 + 0.5 * share; 4],
    );
    let both = UserTexture {
        strength: 0.5,
        inverted: true,
        ..green
    };
    assert_near(found(TextureTarget::Coat, &both, lower_left), [1.0 - 0.5 * share; 4]);
    // By itself: red, but the alpha of an opacity; what is named for several has roughness in green, metalness in blue.
    assert_near(found(TextureTarget::Coat, &plain, upper_right), [100.0 / 255.0; 4]);
    assert_near(
        found(TextureTarget::FilmThickness, &plain, upper_right),
        [100.0 / 255.0; 4],
    );
    assert_near(found(TextureTarget::Opacity, &plain, upper_right), [128.0 / 255.0; 4]);
    let packed = UserTexture::of("rock_arm_1k.png".into());
    assert_near(found(TextureTarget::Roughness, &packed, lower_left), [share; 4]);
    assert_near(found(TextureTarget::Metalness, &packed, lower_left), [0.0; 4]);
    // Colours are of sRGB unless they are said not to be.
    assert_near(
        found(TextureTarget::Emission, &plain, lower_left)[..3]
            .try_into()
            .map(|[r, g, b]: [f64; 3]| [r, g, b, 0.0])
            .unwrap(),
        [0.0, linear(200), 0.0, 0.0],
    );
    let numbers = UserTexture {
        space: TextureSpace::Linear,
        ..plain
    };
    let [_, number, ..] = found(TextureTarget::Emission, &numbers, lower_left);
    assert!((number - share).abs() < 1e-6);
}

/// A picture of one value is a number, with all that is done to it.
#[test]
fn own_pictures_of_one_value_are_numbers() {
    let grey = RgbaImage::from_pixel(2, 2, Rgba([64, 128, 200, 255]));
    let half = UserTexture {
        strength: 0.5,
        inverted: true,
        ..UserTexture::default()
    };
    let slot = with(&square(), TextureTarget::Roughness, &half, &grey).slots[0];
    let [value, ..] = slot.constant(TextureTarget::Roughness).unwrap();
    assert!((value - (1.0 - 0.5 * 64.0 / 255.0)).abs() < 1e-6, "{value}");
    let colour = with(&square(), TextureTarget::BaseColor, &UserTexture::default(), &grey).slots[0];
    let [r, ..] = colour.constant(TextureTarget::BaseColor).unwrap();
    assert!((f64::from(r) - linear(64)).abs() < 1e-6);
}

/// A bump to the right of a picture that is turned a quarter is a bump upwards; upside down, it is one downwards.
#[test]
fn normals_turn_with_their_picture() {
    let tilted = RgbaImage::from_fn(2, 2, |_, _| Rgba([217, 128, 217, 255]));
    let bent = |texture: &UserTexture| {
        let textures = with(&square(), TextureTarget::Normal, texture, &tilted);
        let mut settings = glossmith::document::MaterialSettings::default();
        settings.textures.normal = true;
        let (materials, _) = compile_textured(&[settings], &textures.slots);
        let (x, z) = (Vec3::from_f64([1.0, 0.0, 0.0]), Vec3::from_f64([0.0, 0.0, 1.0]));
        mapped_normal::<f64>(
            &textures,
            (materials[0].textures[2], materials[0].normal_strength.into()),
            [[0.5; 2]; 3],
            [z, x, z],
            1.0,
        )
        .to_f64()
    };
    let plain = UserTexture::default();
    let [x, y, z] = bent(&plain);
    assert!(x > 0.6 && y.abs() < 0.01 && z > 0.6, "{x} {y} {z}");
    let [x, y, _] = bent(&UserTexture {
        rotation_deg: 90.0,
        ..plain.clone()
    });
    assert!(y > 0.6 && x.abs() < 0.01, "{x} {y}");
    let both = UserTexture {
        rotation_deg: 90.0,
        projection: TextureProjection::Box,
        ..plain
    };
    let [x, y, _] = bent(&both);
    assert!(y > 0.6 && x.abs() < 0.01, "on a box: {x} {y}");
    // Green points up, unless the picture is said to have it the other way.
    let up = RgbaImage::from_fn(2, 2, |_, _| Rgba([128, 217, 217, 255]));
    let direction = |inverted: bool| {
        let texture = UserTexture {
            inverted,
            ..UserTexture::default()
        };
        let textures = with(&square(), TextureTarget::Normal, &texture, &up);
        let (color, _) = texture_lookup::<f64>(
            &textures,
            textures.slots[0].record(TextureTarget::Normal),
            [[0.5; 2]; 3],
        );
        2.0 * color.y - 1.0
    };
    assert!(direction(false) > 0.6 && direction(true) < -0.6);
}

/// Seen from each of six sides a picture is upright and not mirrored.
#[test]
fn on_a_box_a_picture_is_upright_from_every_side() {
    let model = glossmith::import::load(&ModelSource::Sphere).unwrap();
    let geometry = Geometry::build(&model, false);
    // Outwards, to the right and up as seen from outside.
    let sides = [
        ([1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]),
        ([-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
        ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ([0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ([0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]),
        ([0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
    ];
    let mut seen = [0; 6];
    for triangle in 0..geometry.triangle_count() {
        let corners = geometry.corners(triangle).map(Vec3::<f64>::from_f32);
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let facing = sides
            .iter()
            .position(|(out, ..)| middle.dot(Vec3::from_f64(*out)) > 0.8);
        let Some(side) = facing else { continue };
        let (_, right, up) = sides[side];
        let [_, _, on_box] = uvs_at::<f64>(&geometry, triangle, [1.0 / 3.0; 3], true);
        let wanted = [
            0.5 + 0.5 * middle.dot(Vec3::from_f64(right)),
            0.5 - 0.5 * middle.dot(Vec3::from_f64(up)),
        ];
        for (found, wanted) in on_box.iter().zip(wanted) {
            assert!(
                (found - wanted).abs() < 1e-6,
                "side {side}: {on_box:?} in place of {wanted:?}"
            );
        }
        seen[side] += 1;
    }
    assert!(seen.iter().all(|count| *count > 20), "{seen:?}");
    // A model without coordinates gets the box by itself, one with them does not.
    let plain = UserTexture::default();
    let flags = |model: &Model| with(model, TextureTarget::Coat, &plain, &four_texels()).slots[0].on_box;
    assert!(!flags(&square())[TextureTarget::Coat as usize]);
    let mut bare = square();
    bare.mesh.uvs.iter_mut().for_each(|uv| *uv = Default::default());
    assert!(flags(&bare)[TextureTarget::Coat as usize]);
}

/// A shaderball with a picture on everything.
fn dressed(folder: &Folder) -> Document {
    let mut document = Document {
        model: ModelSource::Shaderball,
        ..Document::default()
    };
    document.lighting.environment = EnvironmentSource::Studio;
    let render = &mut document.render;
    (render.width, render.height, render.samples, render.filter) = (48, 48, 64, PixelFilter::Box);
    let own = own_texture(folder);
    let bumps = RgbaImage::from_fn(4, 4, |x, y| {
        Rgba([128 + 20 * (x % 2) as u8, 128 + 20 * (y % 2) as u8, 240, 255])
    });
    let bumpy = folder.path("bumps.png");
    bumps.save(&bumpy).unwrap();
    let material = &mut document.material_mut(0);
    for (number, &target) in TextureTarget::ALL.iter().enumerate() {
        let texture = UserTexture {
            file: if target == TextureTarget::Normal {
                bumpy.clone()
            } else {
                own.file.clone()
            },
            projection: [TextureProjection::Box, TextureProjection::First][number % 2],
            channel: [TextureChannel::Red, TextureChannel::Green][number % 2],
            scale: 1.0 + number as f32,
            rotation_deg: 20.0 * number as f32,
            strength: 0.4 + 0.5 * number as f32 / TextureTarget::ALL.len() as f32,
            inverted: number % 3 == 1,
            ..UserTexture::default()
        };
        material.put_texture(target, texture);
    }
    (material.metalness, material.emission_strength) = (0.8, 0.2);
    document
}

#[test]
fn both_engines_show_pictures_of_ones_own() {
    let folder = Folder::new();
    let document = dressed(&folder);
    let cpu = render(EngineChoice::Cpu, &document);
    let gpu = render(EngineChoice::Gpu, &document);
    assert_same_picture(&cpu, &gpu, "everything");
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    session.submit(&document).unwrap();
    let plan = session.job().unwrap().plan.clone();
    assert!(plan.has(EffectId::CoatTexture) && plan.has(EffectId::BoxProjection));
    // Each of them shows.
    for &target in TextureTarget::ALL {
        let mut other = document.clone();
        let texture = other.materials[0].user_textures.get_mut(target).unwrap();
        (texture.rotation_deg, texture.scale) = (texture.rotation_deg + 90.0, 2.5);
        let turned = render(EngineChoice::Cpu, &other);
        let difference: f64 = std::iter::zip(turned.luminance(), cpu.luminance())
            .map(|(a, b)| (a - b).abs())
            .sum();
        assert!(difference > 0.0, "{} is not seen", target.name());
    }
}

/// Editing how a picture lies packs none of it anew.
#[test]
fn turning_a_picture_keeps_its_texels() {
    let folder = Folder::new();
    let mut document = dressed(&folder);
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    session.submit(&document).unwrap();
    let before = session.job().unwrap().textures.clone();
    document.materials[0]
        .user_textures
        .get_mut(TextureTarget::BaseColor)
        .unwrap()
        .rotation_deg = 77.0;
    session.submit(&document).unwrap();
    let after = session.job().unwrap().textures.clone();
    assert!(before.records != after.records);
    assert!(Arc::ptr_eq(&before.words, &after.words));
}

#[test]
fn files_keep_pictures_by_relative_paths() {
    let folder = Folder::new();
    let document = dressed(&folder);
    let path = folder.path("project.json");
    save_document(&path, &document).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("\"file\": \"own.png\""), "{text}");
    assert_eq!(load_document(&path).unwrap().value.materials, document.materials);
    let preset = folder.path("preset.json");
    save_material(&preset, &document.materials[0]).unwrap();
    assert!(
        std::fs::read_to_string(&preset)
            .unwrap()
            .contains("\"file\": \"own.png\"")
    );
    assert_eq!(load_material(&preset).unwrap().value, document.materials[0]);
    // The folder is moved, and all goes on there.
    let moved = Folder::new();
    for name in ["project.json", "own.png", "bumps.png"] {
        std::fs::copy(folder.path(name), moved.path(name)).unwrap();
    }
    let there = load_document(&moved.path("project.json")).unwrap().value;
    let assigned = texture_assignments(&there.materials);
    assert!(assigned.iter().all(|one| one.texture.file.starts_with(moved.0.path())));
    // A value out of range is refused by name.
    let broken = text.replace("\"scale\": 2.0", "\"scale\": -2.0");
    assert_ne!(broken, text);
    std::fs::write(&path, broken).unwrap();
    let error = load_document(&path).unwrap_err().to_string();
    assert!(error.contains("scale") && error.contains("-2"), "{error}");
}

/// Projects of before had pictures beside the model.
#[test]
fn projects_of_before_keep_their_pictures() {
    let folder = Folder::new();
    own_texture(&folder);
    let path = folder.path("old.json");
    let old = json!({"glossmith-document": 1, "model": "sphere", "import": {"pictures": [{"slot": 0, "file": "own.png"}]},
        "materials": [{"name": "Wood", "material": {"base.color_texture": true}}]});
    std::fs::write(&path, old.to_string()).unwrap();
    let document = load_document(&path).unwrap().value;
    let own = document.materials[0]
        .user_textures
        .get(TextureTarget::BaseColor)
        .unwrap();
    assert_eq!(own.file, folder.path("own.png"));
    save_document(&path, &document).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(!text.contains("\"pictures\""), "{text}");
}

#[test]
fn the_command_line_puts_pictures_on_materials() {
    let place = Workplace::new();
    let save = |name: &str, picture: RgbaImage| picture.save(place.path(name)).unwrap();
    save(
        "red.png",
        RgbaImage::from_fn(2, 2, |x, y| Rgba([255 * ((x + y) % 2) as u8, 0, 0, 255])),
    );
    std::fs::create_dir(place.path("wood")).unwrap();
    save(
        "wood/wood_basecolor.png",
        RgbaImage::from_pixel(2, 2, Rgba([0, 255, 0, 255])),
    );
    save("wood/wood_rough.png", RgbaImage::from_pixel(2, 2, Rgba([200; 4])));
    let scene = "--model sphere --environment furnace --set base.metalness=0 --set specular.weight=0";
    let picture = |options: &str| {
        place.done(&format!(
            "render --engine cpu --size 24x24 --samples 16 --output t.exr {scene} {options}"
        ));
        read_exr(&place.path("t.exr"))
    };
    // Half of a checkerboard of red and black, wherever it lies.
    let checkered =
        picture("--texture base-color=red.png --set base.color_map.projection=box --set base.color_map.scale=4");
    let plain = picture("--set base.color=1,1,1");
    let [red, green] = [0, 1].map(|channel| checkered.mean(channel) / plain.mean(channel));
    assert!(red > 0.5 && red < 0.9 && green < red - 0.2, "{red} {green}");
    let turned = picture(
        "--texture base-color=red.png --set base.color_map.projection=box --set base.color_map.scale=4 \
         --set base.color_map.rotation=45",
    );
    assert!(turned.difference(&checkered) > 0.01);
    // A folder by the names in it; a slot by number and by name.
    let set = picture("--texture wood");
    assert!(
        set.at(12, 12)[1] > 0.5 && set.at(12, 12)[0] < 0.1,
        "{:?}",
        set.at(12, 12)
    );
    picture("--texture 1:base-color=red.png");
    place.refused(
        1,
        &format!("render {scene} --output t.exr --texture nowhere:base-color=red.png"),
        &["no material nowhere"],
    );
    place.refused(
        2,
        "render --texture base-color=gone.png --output t.exr",
        &["gone.png: there is no such file"],
    );
    place.refused(
        2,
        "render --texture shine=red.png --output t.exr",
        &["shine takes no texture"],
    );
    place.refused(
        2,
        "render --texture red.png --output t.exr",
        &["red.png: no name here says"],
    );
    place.refused(
        1,
        "render --output t.exr --set base.color_map.scale=2",
        &["there is no such texture"],
    );
    place.refused(
        2,
        "render --output t.exr --texture base-color=red.png --set base.color_map.scale=0",
        &["does not take 0"],
    );
    place.refused(
        2,
        "render --output t.exr --texture base-color=red.png --set base.color_map.glow=0",
        &["glow", "rotation"],
    );
    // What is missing later is told, and the rest goes on.
    let mut document = Document {
        model: ModelSource::Sphere,
        ..Document::default()
    };
    document.materials[0].put_texture(
        TextureTarget::Roughness,
        UserTexture::of(place.path("wood/wood_rough.png")),
    );
    (document.render.width, document.render.height, document.render.samples) = (8, 8, 1);
    save_document(&place.path("p.json"), &document).unwrap();
    std::fs::remove_file(place.path("wood/wood_rough.png")).unwrap();
    let run = place.done("render p.json --engine cpu --output t.exr");
    assert!(
        run.stderr
            .contains("wood_rough.png: the roughness texture can't be had"),
        "{}",
        run.stderr
    );
}

/// What a glTF file can say of them goes with it, and looks the same there; what it can't is told.
#[test]
fn pictures_of_ones_own_travel_in_gltf() {
    let folder = Folder::new();
    let place = Workplace::new();
    let (buffer, json) = textured_square(&json!({"name": "Square"}), &[], &json!({}));
    std::fs::write(place.path("square.glb"), crate::gltf_builder::glb(&json, &buffer.bytes)).unwrap();
    let own = own_texture(&folder);
    let mut document = Document {
        model: ModelSource::File(place.path("square.glb")),
        ..Document::default()
    };
    document.lighting.environment = EnvironmentSource::Studio;
    (document.camera.yaw_deg, document.camera.pitch_deg) = (20.0, 15.0);
    (document.render.width, document.render.height, document.render.samples) = (32, 32, 128);
    let material = document.material_mut(0);
    material.lobe = glossmith::optics::lobe::Lobe::Ggx;
    for (target, channel) in [
        (TextureTarget::BaseColor, TextureChannel::Auto),
        (TextureTarget::Roughness, TextureChannel::Green),
        (TextureTarget::Metalness, TextureChannel::Red),
        (TextureTarget::Emission, TextureChannel::Auto),
        (TextureTarget::Fuzz, TextureChannel::Auto),
        (TextureTarget::FuzzColor, TextureChannel::Auto),
        (TextureTarget::FuzzRoughness, TextureChannel::Green),
    ] {
        let texture = UserTexture {
            channel,
            scale: 2.0,
            rotation_deg: 30.0,
            strength: 0.6,
            inverted: target == TextureTarget::Roughness,
            ..own.clone()
        };
        material.put_texture(target, texture);
    }
    let boxed = UserTexture {
        projection: TextureProjection::Box,
        ..own
    };
    material.put_texture(TextureTarget::Coat, boxed);
    (material.coat_weight, material.emission_strength) = (0.0, 0.3);
    material.textures.coat = true;
    save_document(&place.path("scene.json"), &document).unwrap();
    place.done("convert scene.json scene.glb --report losses.json");
    let told = place.read("losses.json");
    assert!(told.contains("your texture of the roughness") && told.contains("your texture of the metalness"));
    assert!(told.contains("no projection from the sides of a box"), "{told}");
    let mut there = document.clone();
    there.model = ModelSource::File(place.path("scene.glb"));
    let model = glossmith::import::load(&there.model).unwrap();
    assert_eq!(model.textures.len(), 6, "{:?}", model.slots[0]);
    there.materials = glossmith::document::of_model::materials_of(&model, glossmith::document::ImportLobe::Ggx);
    there.materials[0].fresnel = document.materials[0].fresnel;
    let [here, there] = [&document, &there].map(|document| render(EngineChoice::Cpu, document));
    let means = [here, there].map(|film| film.luminance().iter().sum::<f64>());
    assert!((means[0] / means[1] - 1.0).abs() < 0.02, "{means:?}");
}
