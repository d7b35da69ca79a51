//! The curves D(ξ) and the Fresnel factor, for every entry of their registries.

use glossmith::optics::{
    curve::{Curve, curve_distance, curve_distance_max, curve_h},
    fresnel::{
        Fresnel, FresnelTerms, fresnel, fresnel_conductor, fresnel_dielectric, fresnel_f0, fresnel_left,
        fresnel_schlick, half_vector_cosine,
    },
    thin_film::FilmTerms,
};

use super::bench::{CUSTOM_CURVES, SCENE};
use super::harness::{Case, Output, Rng, Value, check, inputs, twin};

#[test]
fn curves_agree() {
    let mut distance = Case::new(
        "curve_distance",
        "curve table xi",
        "",
        twin!(|row| {
            let (curve, table) = (Curve::ALL[row.bits() as usize], row.bits());
            let xi = row.number();
            row.put(curve_distance(curve, &SCENE.tables[table as usize..], xi));
        }),
    )
    .number("curve_distance(curve, table, xi)", 0.0);
    let mut distance_max = Case::new(
        "curve_distance_max",
        "curve table",
        "",
        twin!(|row| {
            let (curve, table) = (Curve::ALL[row.bits() as usize], row.bits());
            row.put(curve_distance_max(curve, &SCENE.tables[table as usize..]));
        }),
    )
    .number("curve_distance_max(curve, table)", 0.0);
    let mut h = Case::new(
        "curve_h",
        "curve table distance",
        "",
        twin!(|row| {
            let (curve, table) = (Curve::ALL[row.bits() as usize], row.bits());
            let distance = row.number();
            row.put(curve_h(curve, &SCENE.tables[table as usize..], distance));
        }),
    )
    .number("curve_h(curve, table, distance)", 0.0);
    for &curve in Curve::ALL {
        let table = |rng: &mut Rng| SCENE.curves[rng.below(CUSTOM_CURVES)];
        distance = distance.group(curve.name(), move |rng, _| {
            inputs![curve as u32, table(rng), Value::Unit(rng.unit())]
        });
        distance_max = distance_max.group(curve.name(), move |rng, _| inputs![curve as u32, table(rng)]);
        h = h.group(curve.name(), move |rng, _| {
            let table = table(rng);
            let max: f32 = curve_distance_max(curve, &SCENE.tables[table as usize..]);
            let distance = if rng.chance(0.1) {
                rng.log_range(1e-7, 0.1)
            } else {
                rng.unit() * max
            };
            inputs![curve as u32, table, distance]
        });
    }
    check(&["optics/curve/registry"], &[distance, distance_max, h]);
}

/// An index of refraction from water under glass to diamond.
fn ior(rng: &mut Rng) -> f32 {
    rng.range(0.4, 2.5)
}

#[test]
fn fresnel_factors_agree() {
    // Differences below a reflectance of 1 % are told in parts of it.
    let (share, shares) = (Output::Number(0.01), Output::Vector(0.01));
    let mut all = Case::new(
        "fresnel",
        "model metal_f0 metalness edge_tint tint metal_tint weight ior eta k coat has_film film_weight film_ior film_behind film_path has_bands cosine \
         behind",
        "let terms = FresnelTerms(model, metal_f0, metalness, edge_tint, tint, metal_tint, weight, ior, eta, k, \
         coat, has_film == 1u, FilmTerms(film_weight, film_ior, film_behind, film_path, has_bands == 1u));",
        twin!(|row| {
            let terms = FresnelTerms {
                model: Fresnel::ALL[row.bits() as usize],
                metal_f0: row.vector(),
                metalness: row.number(),
                edge_tint: row.vector(),
                tint: row.vector(),
                metal_tint: row.vector(),
                weight: row.number(),
                ior: row.number(),
                eta: row.vector(),
                k: row.vector(),
                before: row.number(),
                has_film: row.bits() == 1,
                film: FilmTerms {
                    weight: row.number(),
                    ior: row.number(),
                    behind: row.number(),
                    path: row.vector(),
                    has_bands: row.bits() == 1,
                },
            };
            let (cosine, behind) = (row.number(), row.number());
            row.put_vector(fresnel(&terms, cosine));
            row.put_vector(fresnel_left(&terms, cosine, behind));
        }),
    )
    .output("fresnel(terms, cosine)", shares)
    .output("fresnel_left(terms, cosine, behind)", shares);
    let films = Fresnel::ALL
        .iter()
        .flat_map(|&model| [0, 1, 2].map(|films| (model, films)));
    for (model, films) in films {
        let name = format!(
            "{}{}",
            model.name(),
            ["", ", filmed", ", thickly filmed"][films as usize]
        );
        all = all.group(&name, move |rng, _| {
            let mut color = |high: f32| Value::Vector([(); 3].map(|()| high * rng.unit()));
            let (f0, tint, eta, k) = (color(1.0), color(1.0), color(4.0), color(8.0));
            let [edge_tint, metal_tint] = [color(1.0), color(1.0)];
            let (metalness, weight) = (rng.unit(), rng.unit());
            inputs![
                model as u32,
                f0,
                metalness,
                edge_tint,
                tint,
                metal_tint,
                weight,
                ior(rng),
                eta,
                k,
                rng.range(1.0, 2.0),
                u32::from(films > 0),
                rng.unit(),
                rng.range(0.8, 3.0),
                rng.range(0.7, 2.5),
                Value::Vector([(); 3].map(|()| if films == 2 { 60.0 } else { 14.0 } * rng.unit())),
                u32::from(films == 2),
                Value::Unit(rng.unit()),
                Value::Unit(rng.unit())
            ]
        });
    }
    check(
        &["optics/fresnel"],
        &[
            all,
            Case::new(
                "half_vector_cosine",
                "wo wi",
                "",
                twin!(vector wo, vector wi => put(half_vector_cosine(wo, wi))),
            )
            .number("half_vector_cosine(wo, wi)", 0.1)
            .group("", |rng, _| inputs![rng.direction(), rng.direction()]),
            Case::new("fresnel_f0", "ior", "", twin!(number ior => put(fresnel_f0(ior))))
                .output("fresnel_f0(ior)", share)
                .group("", |rng, _| inputs![ior(rng)]),
            Case::new(
                "fresnel_schlick",
                "f0 cosine",
                "",
                twin!(vector f0, number cosine => put_vector(fresnel_schlick(f0, cosine))),
            )
            .output("fresnel_schlick(f0, cosine)", shares)
            .group("", |rng, _| {
                inputs![Value::Vector([(); 3].map(|()| rng.unit())), Value::Unit(rng.unit())]
            }),
            Case::new(
                "fresnel_dielectric",
                "cosine ior",
                "",
                twin!(numbers [cosine, ior] => put(fresnel_dielectric(cosine, ior))),
            )
            .output("fresnel_dielectric(cosine, ior)", share)
            .group("", |rng, _| inputs![Value::Unit(rng.unit()), ior(rng)]),
            Case::new(
                "fresnel_conductor",
                "cosine eta k",
                "",
                twin!(numbers [cosine, eta, k] => put(fresnel_conductor(cosine, eta, k))),
            )
            .output("fresnel_conductor(cosine, eta, k)", share)
            .group("metals", |rng, _| {
                inputs![Value::Unit(rng.unit()), rng.range(0.05, 4.0), rng.range(0.5, 9.0)]
            })
            .group("without absorption", |rng, _| {
                inputs![Value::Unit(rng.unit()), rng.range(1.1, 4.0), 0.0f32]
            }),
        ],
    );
}
