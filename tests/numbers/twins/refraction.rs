//! Snell's law, and what facets refract.

use glossmith::optics::{
    curve::Curve,
    lobe::{Lobe, facet_weight, lobe_sample, lobe_view},
    real::Mask,
    refraction::{
        facet_density_factor, facet_mirror, facet_refracted, refracted, refracted_square, refracting_cosines,
        refracting_normal,
    },
    vector::Vec3,
};

use super::harness::{Case, Output, Rng, Value, check, inputs, twin};
use super::lobes::{DENSITY, SHAPE_AND_VIEW, Shape, View, WEIGHT, random_shape, read_shape, read_view, shape_and_view};

const UNIT: Output = Output::Vector(1.0);

/// Into a denser or a thinner medium.
fn random_eta(rng: &mut Rng) -> f32 {
    let ior = rng.range(1.05, 2.5);
    if rng.chance(0.5) { ior } else { 1.0 / ior }
}

/// Two directions on the same side of a normal that is halfway, and an index.
fn mirrored_directions(rng: &mut Rng) -> Vec<Value> {
    let (wo, h) = (rng.direction(), rng.direction());
    let h = if wo.dot(h) < 0.0 { -h } else { h };
    inputs![wo, wo.mirrored_about(h), random_eta(rng)]
}

/// A lobe that refracts at its facets, a view and a direction, half of them the lobe's own samples.
fn refracting(rng: &mut Rng, index: usize) -> (Shape, View, Vec3<f32>) {
    let lobe = [Lobe::Ggx, Lobe::GgxNdf, Lobe::BlinnPhong][rng.below(3)];
    let shape = Shape {
        eta: random_eta(rng),
        ..random_shape(rng, lobe, Curve::Sqrt, lobe.is_anisotropic())
    };
    let view = View::random(rng);
    let xi = [(); 3].map(|()| rng.unit());
    let wi = if index.is_multiple_of(2) {
        lobe_sample(&shape.lobe_shape(), &view.frame, view.normal, view.wo, xi).wi
    } else {
        rng.direction()
    };
    (shape, view, wi)
}

#[test]
fn refraction_agrees() {
    let of_facets = |name: &'static str, wgsl, twin| {
        Case::new(name, shape_and_view!("wi"), wgsl, twin).group_of("", 16_000, |rng, index| {
            let (shape, view, wi) = refracting(rng, index);
            [&shape.inputs()[..], &view.inputs(), &[wi.into()]].concat()
        })
    };
    check(
        &["optics/lobe/registry"],
        &[
            Case::new(
                "refracted, refracted_square",
                "wo axis eta",
                "let r = refracted(wo, axis, eta);",
                twin!(|row| {
                    let (wo, axis, eta) = (row.vector(), row.vector(), row.number());
                    let found = refracted(wo, axis, eta);
                    row.put_vector(found.wi);
                    row.put(if found.is_total.any() { T::ONE } else { T::ZERO });
                    row.put(refracted_square(wo.dot(axis), eta));
                }),
            )
            .output("r.wi", UNIT)
            .number("f32(r.is_total)", 1.0)
            .number("refracted_square(dot(wo, axis), eta)", 1.0)
            .group("", |rng, _| inputs![rng.direction(), rng.direction(), random_eta(rng)]),
            Case::new(
                "facet_refracted",
                "wo mirrored eta",
                "",
                twin!(vector wo, vector mirrored, number eta => put_vector(facet_refracted(wo, mirrored, eta).wi)),
            )
            .output("facet_refracted(wo, mirrored, eta).wi", UNIT)
            .group_of("", 16_000, |rng, _| mirrored_directions(rng)),
            Case::new(
                "refracting_normal, refracting_cosines",
                "wo wi eta",
                "",
                twin!(|row| {
                    let (wo, wi, eta) = (row.vector(), row.vector(), row.number());
                    row.put_vector(refracting_normal(wo, wi, eta));
                    for cosine in refracting_cosines(wo, wi, eta) {
                        row.put(cosine);
                    }
                }),
            )
            .output("refracting_normal(wo, wi, eta)", UNIT)
            .number("refracting_cosines(wo, wi, eta).x", 1.0)
            .number("refracting_cosines(wo, wi, eta).y", 1.0)
            .group("", |rng, _| inputs![rng.direction(), rng.direction(), random_eta(rng)]),
            of_facets(
                "facet_mirror, facet_density_factor, facet_weight",
                SHAPE_AND_VIEW,
                twin!(|row| {
                    let shape = read_shape(row);
                    let (frame, _, wo) = read_view(row);
                    let wi = row.vector();
                    let along = refracting_normal(wo, wi, shape.eta);
                    row.put(facet_density_factor(&frame, wo, wi, shape.eta, along));
                    let mirrored = facet_mirror(&frame, wo, wi, shape.eta);
                    row.put(facet_weight(&shape, &frame, wo, wi, mirrored));
                }),
            )
            .output(
                "facet_density_factor(frame, wo, wi, eta, refracting_normal(wo, wi, eta))",
                DENSITY,
            )
            .output(
                "facet_weight(shape, frame, wo, wi, facet_mirror(frame, wo, wi, eta))",
                WEIGHT,
            ),
            Case::new(
                "lobe_view",
                shape_and_view!(""),
                "let shape = LobeShape(lobe, curve, horizon, table, roughness, anisotropy, eta); \
                 let view = lobe_view(shape, Frame(tangent, bitangent, shading), normal, wo);",
                twin!(|row| {
                    let shape = read_shape(row);
                    let (frame, normal, wo) = read_view(row);
                    let view = lobe_view(&shape, &frame, normal, wo);
                    for v in [view.frame.bitangent, view.frame.normal, view.normal, view.wo] {
                        row.put_vector(v);
                    }
                    row.put(view.roughness);
                }),
            )
            .output("view.frame.bitangent", UNIT)
            .output("view.frame.normal", UNIT)
            .output("view.normal", UNIT)
            .output("view.wo", UNIT)
            .number("view.seen.roughness", 1.0)
            .group_of("", 16_000, |rng, _| {
                let lobe = [Lobe::Geometric, Lobe::Phong, Lobe::Ggx][rng.below(3)];
                let shape = random_shape(rng, lobe, Curve::Sqrt, false);
                [&shape.inputs()[..], &View::random(rng).inputs()].concat()
            }),
        ],
    );
}
