//! The layered material with real albedo tables, for every lobe.

use glossmith::{
    optics::{
        albedo::{albedo_lookup, albedo_place, rough_albedo, rough_albedo_lookup},
        layer::{Layer, MaterialNumbers, material_evaluate, material_layers, material_sample},
        lobe::{Lobe, lobe_sample, raw_sample},
        material::{Material, Surface},
        real::Scalar,
        vector::vec3,
    },
    scene::surface::bent_normal,
};

use super::{
    bench::SCENE,
    harness::{Case, Output, Rng, Row, Value, check, inputs, twin},
    lobes::{View, read_view},
};

/// Colours that a material multiplies by are about 1.
const COLOUR: Output = Output::Vector(0.1);

fn read_material_and_surface<T: Scalar>(row: &mut Row<'_, T>) -> (Material<T>, Surface<T>) {
    let material = SCENE.material(row.bits());
    let (frame, normal, wo) = read_view(row);
    let coat_normal = row.vector();
    let is_inside = row.bits() == 1;
    let surface = Surface {
        frame,
        normal,
        wo,
        coat_normal,
        is_inside,
    };
    (material, surface)
}

/// The normal of the coat, not far from the other one; and seen from within one time in two.
fn coat_and_side(rng: &mut Rng, view: &View) -> [Value; 2] {
    let normal = bent_normal((view.frame.normal + rng.direction() * 0.3).normalize(), view.wo);
    [normal.into(), (rng.bits() & 1).into()]
}

/// A material of this lobe.
fn random_index(rng: &mut Rng, lobe: Lobe) -> u32 {
    let of_lobe: Vec<u32> = (0..)
        .zip(&SCENE.materials)
        .filter(|(_, m)| m.lobe == lobe as u32)
        .map(|(i, _)| i)
        .collect();
    of_lobe[rng.below(of_lobe.len())]
}

const SURFACE: &str = "let surface = Surface(Frame(tangent, bitangent, shading), normal, wo, coat_normal, inside == 1u); \
     let of_slot = material_at(material);";

#[test]
fn materials_agree() {
    let mut layers = Case::new(
        "material_layers",
        "material tangent bitangent shading normal wo coat_normal inside",
        "let surface = Surface(Frame(tangent, bitangent, shading), normal, wo, coat_normal, inside == 1u); \
         let l = material_layers(material_at(material), surface);",
        twin!(|row| {
            let (material, surface) = read_material_and_surface(row);
            let layers = material_layers(&material, &SCENE.tables, &surface);
            for layer in Layer::ALL {
                let share = &layers[*layer];
                row.put_vector(share.albedo);
                row.put_vector(share.transmittance);
                row.put(share.reached);
                row.put(share.probability);
            }
        }),
    );
    for layer in Layer::ALL {
        let share = |field: &str| format!("l.{}.{field}", layer.name());
        layers = layers
            .output(share("albedo"), COLOUR)
            .output(share("transmittance"), COLOUR)
            .number(share("reached"), 0.05)
            .number(share("probability"), 0.05);
    }
    let mut sample = Case::new(
        "material_sample",
        "material tangent bitangent shading normal wo coat_normal inside a b c facet d e f needs_density",
        "let surface = Surface(Frame(tangent, bitangent, shading), normal, wo, coat_normal, inside == 1u); \
         let of_slot = material_at(material); \
         let s = material_sample(of_slot, surface, material_layers(of_slot, surface), \
         MaterialNumbers(vec3f(a, b, c), facet, vec3f(d, e, f)), needs_density == 1u);",
        twin!(|row| {
            let (material, surface) = read_material_and_surface(row);
            let numbers = MaterialNumbers {
                lobe: row.numbers(),
                facet: row.number(),
                below: row.numbers(),
            };
            let needs_density = row.bits() == 1;
            let layers = material_layers(&material, &SCENE.tables, &surface);
            let drawn = material_sample(&material, &SCENE.tables, &surface, &layers, numbers, needs_density);
            row.put_vector(drawn.wi);
            row.put_vector(drawn.throughput);
            row.put(drawn.density.sqrt());
            row.put(if drawn.is_mirror { T::ONE } else { T::ZERO });
        }),
    )
    .output("s.wi", Output::Vector(1.0))
    .output("s.throughput", COLOUR)
    // Of a direction that rounding moved. By its root: a density is over two dimensions, so its error is twice a direction's.
    .number("sqrt(s.density)", 0.5)
    .number("f32(s.is_mirror)", 1.0);
    let mut evaluate = Case::new(
        "material_evaluate",
        "material tangent bitangent shading normal wo coat_normal inside wi light_density competing",
        SURFACE,
        twin!(|row| {
            let (material, surface) = read_material_and_surface(row);
            let (wi, [light_density, competing]) = (row.vector(), row.numbers());
            let tables = &SCENE.tables;
            let layers = material_layers(&material, tables, &surface);
            let value = material_evaluate(&material, tables, &surface, &layers, wi, light_density, competing);
            row.put_vector(value);
        }),
    )
    // As of a density.
    .output(
        "material_evaluate(of_slot, surface, material_layers(of_slot, surface), wi, light_density, competing)",
        Output::Vector(0.08),
    );
    for &lobe in Lobe::ALL {
        layers = layers.group(lobe.name(), move |rng, _| {
            let start = [random_index(rng, lobe).into()];
            let view = View::random(rng);
            [&start[..], &view.inputs(), &coat_and_side(rng, &view)].concat()
        });
        sample = sample.group_of(lobe.name(), 16_000, move |rng, _| {
            // At the ends the density has a peak that is infinite: the lobes' own tests go there.
            let xi = [(); 7].map(|()| Value::Unit(rng.range(1e-3, 0.999)));
            let start = [random_index(rng, lobe).into()];
            let view = View::random(rng);
            let sides = coat_and_side(rng, &view);
            [&start[..], &view.inputs(), &sides, &xi, &[(rng.bits() & 1).into()]].concat()
        });
        evaluate = evaluate.group_of(lobe.name(), 16_000, move |rng, index| {
            let (material, view) = (random_index(rng, lobe), View::random(rng));
            let (sides, xi) = (coat_and_side(rng, &view), [(); 3].map(|()| rng.unit()));
            let is_inside = matches!(sides[1], Value::Bits(1));
            let of_material = &SCENE.materials[material as usize];
            let wi = match index % 4 {
                0 => raw_sample(&of_material.shape(&SCENE.tables), &view.frame, view.wo, xi),
                1 => {
                    let shape = of_material.transmission_shape(&SCENE.tables, is_inside);
                    lobe_sample(&shape, &view.frame, view.normal, view.wo, xi).wi
                }
                _ => rng.direction(),
            };
            let competing: f32 = if rng.chance(0.5) { 1.0 } else { 0.0 };
            let last = inputs![wi, rng.log_range(1e-3, 1e3), competing];
            [&[material.into()][..], &view.inputs(), &sides, &last].concat()
        });
    }
    check(
        &["optics/layer/scatter"],
        &[
            layers,
            sample,
            evaluate,
            Case::new(
                "albedo_lookup",
                "material cosine",
                "",
                twin!(|row| {
                    let material: Material<T> = SCENE.material(row.bits());
                    let cosine = row.number();
                    let [r, g, b, _] = albedo_lookup(&SCENE.tables, material.albedo_table, cosine);
                    row.put_vector(vec3(r, g, b));
                }),
            )
            .output("rough_albedo_lookup(material_at(material).albedo_table, cosine, 0.0).xyz", COLOUR)
            .group("", |rng, _| {
                inputs![rng.below(SCENE.materials.len()) as u32, Value::Unit(rng.unit())]
            }),
            Case::new(
                "rough_albedo",
                "material cosine roughness",
                "let integrals = rough_albedo_lookup(material_at(material).albedo_table, cosine, roughness); \
                 let albedo = rough_albedo(material_fresnel_terms(material_at(material), false), integrals, vec4f(0.0));",
                twin!(|row| {
                    let material: Material<T> = SCENE.material(row.bits());
                    let [cosine, roughness] = row.numbers();
                    let integrals = rough_albedo_lookup(&SCENE.tables, material.albedo_table, cosine, roughness);
                    row.put_numbers(integrals);
                    row.put_vector(rough_albedo(&material.fresnel_terms(false), integrals, None));
                }),
            )
            .number("integrals.x", 0.1)
            .number("integrals.y", 0.1)
            .number("integrals.z", 0.1)
            .number("integrals.w", 0.1)
            .output("albedo", COLOUR)
            .group("", |rng, _| {
                let rough: Vec<u32> = (0..)
                    .zip(&SCENE.materials)
                    .filter(|(_, material)| material.holds_integrals())
                    .map(|(number, _)| number)
                    .collect();
                inputs![
                    rough[rng.below(rough.len())],
                    Value::Unit(rng.unit()),
                    Value::Unit(rng.unit())
                ]
            }),
            Case::new(
                "albedo_place",
                "cosine eta",
                "",
                twin!(numbers [cosine, eta] => put(albedo_place(cosine, eta))),
            )
            .number("albedo_place(cosine, eta)", 0.1)
            .group("", |rng, _| inputs![Value::Unit(rng.unit()), rng.range(0.4, 1.5)]),
        ],
    );
}
