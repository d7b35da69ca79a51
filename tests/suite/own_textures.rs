//! Pictures of the user's own: where they lie, what of them counts, that both engines see the same, and that files keep them.

use std::{path::Path, sync::Arc};

use glossmith::{
    compile::compile_textured,
    document::{Document, PixelFilter},
    import::{Budget, picture::read_texture},
    optics::{tone::linear_from_srgb, vector::Vec3},
    scene::{
        Geometry, Model, ModelSource, Texture,
        environment::EnvironmentSource,
        texture::{
            Pack, TextureChannel, TextureProjection, TextureSpace, TextureTarget, Textures, UserTexture, UserTextures,
            mapped_normal, texture_lookup, uvs_at,
        },
    },
    store::{PRESETS, load_document, load_material, save_document, save_material},
};
use image::{Rgba, RgbaImage};
use serde_json::json;

use crate::{
    cli_support::Workplace,
    gltf_extensions::load_plain,
    random_documents::of_material,
    textures::{four_texels, textured_square},
};

/// The picture of [`four_texels`] in a file.
pub fn own_texture(folder: &Workplace) -> UserTexture {
    let path = folder.path("own.png");
    four_texels().save(&path).unwrap();
    UserTexture::of(path)
}

/// A ball whose coat has the weight that a picture on a box gives it.
pub fn coated_on_a_box(folder: &Workplace) -> Document {
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
    load_plain(&document, &buffer)
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
    let mut assigned = [UserTextures::default()];
    assigned[0].set(target, Some(texture.clone()));
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
        near!(a, b, 1e-5, "{found:?}, expected {expected:?}");
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
    near!(number, share, 1e-6);
}

/// A bump to the right of a picture that is turned a quarter is a bump upwards; upside down, it is one downwards.
#[test]
fn normals_turn_with_their_picture() {
    let tilted = RgbaImage::from_fn(2, 2, |_, _| Rgba([217, 128, 217, 255]));
    let bent = |texture: &UserTexture| {
        let textures = with(&square(), TextureTarget::Normal, texture, &tilted);
        let mut settings = glossmith::document::MaterialSettings::default();
        settings.textures[TextureTarget::Normal] = true;
        let (materials, _) = compile_textured(&[settings], &textures.slots);
        let (x, z) = (Vec3::from_f64([1.0, 0.0, 0.0]), Vec3::from_f64([0.0, 0.0, 1.0]));
        mapped_normal::<f64>(
            &textures,
            (
                materials[0].texture(TextureTarget::Normal),
                materials[0].normal_strength.into(),
            ),
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
            near!(found, wanted, 1e-6, "side {side}: {on_box:?} in place of {wanted:?}");
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
pub fn dressed(folder: &Workplace) -> Document {
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
fn files_keep_pictures_by_relative_paths() {
    let folder = Workplace::new();
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
    let moved = Workplace::new();
    for name in ["project.json", "own.png", "bumps.png"] {
        std::fs::copy(folder.path(name), moved.path(name)).unwrap();
    }
    let there = moved.document("project.json");
    let mut own = there
        .materials
        .iter()
        .flat_map(|material| material.user_textures.iter());
    assert!(own.all(|(_, texture)| texture.file.starts_with(moved.root())));
    // A value out of range is refused by name.
    let broken = text.replace("\"scale\": 2.0", "\"scale\": -2.0");
    assert_ne!(broken, text);
    std::fs::write(&path, broken).unwrap();
    let error = load_document(&path).unwrap_err().to_string();
    assert!(error.contains("scale") && error.contains("-2"), "{error}");
}

#[test]
fn maps_of_shipped_materials_are_in_the_program_and_stay_named() {
    let with_maps = PRESETS
        .iter()
        .filter(|material| material.user_textures.iter().next().is_some());
    let folder = Workplace::new();
    let mut count = 0;
    for material in with_maps {
        count += 1;
        for (target, texture) in material.user_textures.iter() {
            read_texture(&texture.file, target.is_color(), u32::MAX, &Budget::of_import()).unwrap();
        }
        let document = of_material(ModelSource::Sphere, material.clone());
        assert_eq!(document.pictures().count(), 0, "no file to watch");
        let path = folder.path("project.json");
        save_document(&path, &document).unwrap();
        let loaded = load_document(&path).unwrap();
        assert_eq!(
            (loaded.value.materials, loaded.warnings),
            (document.materials, Vec::new())
        );
    }
    assert_eq!(count, 8);
}
