//! Textures: every wrap mode, filter and set of coordinates, and what they do to a material.

use glossmith::{
    optics::{
        material::{FIELDS, Field, Material},
        real::Scalar,
        vector::Vec3,
    },
    scene::texture::{TextureTarget, Uvs, mapped_normal, opacity_at, texture_lookup, textured_material, wrapped},
};

use super::bench::SCENE;
use super::harness::{Case, Output, Rng, Row, Value, check, inputs, twin};

const SHARE: Output = Output::Number(0.1);
const COLOUR: Output = Output::Vector(0.1);
const UVS: &str = "let uvs = Uvs(vec4f(u, v, second_u, second_v), vec2f(box_u, box_v));";

fn uvs<T: Scalar>(row: &mut Row<'_, T>) -> Uvs<T> {
    [row.numbers(), row.numbers(), row.numbers()]
}

fn random_uvs(rng: &mut Rng) -> [Value; 6] {
    [(); 6].map(|()| rng.range(-3.0, 3.0).into())
}

fn with_uvs(rng: &mut Rng, first: u32) -> Vec<Value> {
    [&[first.into()][..], &random_uvs(rng)].concat()
}

/// A material of the scene, with textures or without.
fn any_material(rng: &mut Rng) -> u32 {
    rng.below(SCENE.materials.len()) as u32
}

#[test]
fn textures_agree() {
    let mut lookup = Case::new(
        "texture_lookup",
        "index u v second_u second_v box_u box_v",
        "let uvs = Uvs(vec4f(u, v, second_u, second_v), vec2f(box_u, box_v)); let t = texture_lookup(index, uvs);",
        twin!(|row| {
            let index = row.bits();
            let (color, alpha) = texture_lookup(&SCENE.textures, index, uvs(row));
            row.put_vector(color);
            row.put(alpha);
        }),
    )
    .output("t.xyz", COLOUR)
    .output("t.w", SHARE);
    for index in 0..SCENE.textures.records.len() as u32 {
        lookup = lookup.group(&format!("record {index}"), move |rng, _| with_uvs(rng, index));
    }
    let mut wrap = Case::new(
        "wrapped",
        "wrap place",
        "",
        twin!(bits wrap, number place => put(wrapped(place, wrap))),
    )
    .output("wrapped(place, wrap)", SHARE);
    for mode in 0..3u32 {
        wrap = wrap.group(&format!("mode {mode}"), move |rng, _| {
            inputs![mode, rng.range(-4.0, 4.0)]
        });
    }
    check(&["scene/texture"], &[lookup, wrap]);
}

/// What textures of every target change, and what follows from it.
fn varied() -> impl Iterator<Item = &'static Field> {
    let of_targets = TextureTarget::ALL.iter().flat_map(|target| target.fields());
    let names: Vec<_> = of_targets
        .chain(&["roughness", "transmission_roughness", "reflecting_ior"])
        .collect();
    FIELDS.iter().filter(move |field| names.contains(&&field.name))
}

#[test]
fn textured_materials_agree() {
    let with_output = |case: Case, field: &Field| {
        let kind = if field.size == 4 { SHARE } else { COLOUR };
        case.output(format!("m.{}", field.name), kind)
    };
    check(
        &["scene/texture"],
        &[
            varied().fold(Case::new(
                "textured_material",
                "material u v second_u second_v box_u box_v",
                "let uvs = Uvs(vec4f(u, v, second_u, second_v), vec2f(box_u, box_v)); \
                 let m = textured_material(material_at(material), uvs, vec3f(0.5, 0.75, 0.25));",
                twin!(|row| {
                    let material: Material<T> = SCENE.material(row.bits());
                    let tint = Vec3::from_f32([0.5, 0.75, 0.25]);
                    let m = textured_material(&SCENE.textures, &SCENE.tables, &material, &T::each(|_| uvs(row)), tint);
                    let bytes = m.cast::<f32>();
                    let number = |place: usize| {
                        let number = bytemuck::bytes_of(&bytes)[place..place + 4].try_into();
                        T::from_f64(f64::from(f32::from_ne_bytes(number.unwrap())))
                    };
                    for field in varied() {
                        (0..field.size / 4).for_each(|i| row.put(number(field.offset + 4 * i)));
                    }
                }),
            ), with_output)
            .group("", |rng, _| {
                let material = any_material(rng);
                with_uvs(rng, material)
            }),
            Case::new(
                "opacity_at",
                "material u v second_u second_v box_u box_v",
                UVS,
                twin!(|row| {
                    let material: Material<T> = SCENE.material(row.bits());
                    let uvs = uvs(row);
                    row.put(opacity_at(&SCENE.textures, &material, uvs, T::from_f64(0.75)));
                }),
            )
            .output("opacity_at(material_at(material), uvs, 0.75)", SHARE)
            .group("", |rng, _| {
                let material = any_material(rng);
                with_uvs(rng, material)
            }),
            Case::new(
                "mapped_normal",
                "material normal tangent outward sign u v second_u second_v box_u box_v",
                UVS,
                twin!(|row| {
                    let material: Material<T> = SCENE.material(row.bits());
                    let frame = [row.vector(), row.vector(), row.vector()];
                    let sign = row.number();
                    let uvs = uvs(row);
                    let map = (material.texture(TextureTarget::Normal), material.normal_strength);
                    row.put_vector(mapped_normal(&SCENE.textures, map, uvs, frame, sign));
                }),
            )
            .output(
                "mapped_normal(material_at(material).normal_texture, material_at(material).normal_strength, uvs, normal, \
                 vec4f(tangent, sign), outward)",
                Output::Vector(1.0),
            )
            .group("", |rng, _| {
                let mapped: Vec<u32> = (0..)
                    .zip(&SCENE.materials)
                    .filter(|(_, material)| material.has_texture(&[TextureTarget::Normal]))
                    .map(|(number, _)| number)
                    .collect();
                let start = inputs![
                    mapped[rng.below(mapped.len())],
                    rng.direction(),
                    rng.direction(),
                    rng.direction(),
                    rng.sign()
                ];
                [&start[..], &random_uvs(rng)].concat()
            }),
        ],
    );
}
