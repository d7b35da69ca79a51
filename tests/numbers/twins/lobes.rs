//! What the microfacet lobes share, and every lobe × curve × anisotropy: raw, and with what happens at the horizon.

use glossmith::optics::{
    curve::Curve,
    frame::{Frame, frame_from_tangent},
    fresnel::half_vector_cosine,
    lobe::{
        Horizon, Lobe, LobeShape, alpha_from_roughness, is_mirror, isotropic_alpha, lobe_evaluate, lobe_sample,
        microfacet_alpha, raw_density, raw_sample, raw_weight, stretch_from_anisotropy,
    },
    microfacet::{
        Alpha, Facet, distribution_weight, facet, ggx_distribution, smith_g1_over_cosine, smith_g2_over_cosine,
        smith_length, visible_density, visible_weight,
    },
    real::Scalar,
    vector::{Vec3, vec3},
};

use super::bench::{CUSTOM_CURVES, SCENE, random_roughness};
use super::harness::{Case, Output, Rng, Row, Value, check, inputs, twin};

/// Densities and evaluated lobes: differences below the sphere's uniform density, 1/(4π), are told in parts of it.
pub const DENSITY: Output = Output::Number(0.08);
/// Weights are about 1.
pub const WEIGHT: Output = Output::Number(0.1);
const UNIT: Output = Output::Vector(1.0);

/// A surface seen from somewhere: shading frame, geometric normal, direction to the viewer above both.
#[derive(Clone, Copy)]
pub struct View {
    pub frame: Frame<f32>,
    pub normal: Vec3<f32>,
    pub wo: Vec3<f32>,
}

impl View {
    pub fn random(rng: &mut Rng) -> Self {
        let shading = rng.direction();
        let frame = frame_from_tangent(shading, rng.direction(), 0.0);
        // Up to 45° apart; one in four not at all.
        let lean = if rng.chance(0.25) { 0.0 } else { rng.unit() };
        let normal = (shading + frame.tangent * lean).normalize();
        loop {
            let wo = rng.direction();
            // The shading normal is never further away from the viewer than surface_at lets it.
            if wo.dot(shading) > 1e-3 && wo.dot(normal) > 0.0 {
                return Self { frame, normal, wo };
            }
        }
    }

    /// Inputs for [`VIEW`].
    pub fn inputs(&self) -> [Value; 5] {
        [
            self.frame.tangent,
            self.frame.bitangent,
            self.frame.normal,
            self.normal,
            self.wo,
        ]
        .map(Value::from)
    }
}

/// What [`read_view`] takes: the frame, the geometric normal, the direction to the viewer.
pub fn read_view<T: Scalar>(row: &mut Row<'_, T>) -> (Frame<T>, Vec3<T>, Vec3<T>) {
    let frame = Frame {
        tangent: row.vector(),
        bitangent: row.vector(),
        normal: row.vector(),
    };
    (frame, row.vector(), row.vector())
}

/// The numbers of a shape.
#[derive(Clone, Copy)]
pub struct Shape {
    pub lobe: Lobe,
    pub curve: Curve,
    pub horizon: Horizon,
    pub table: u32,
    pub roughness: f32,
    pub anisotropy: f32,
    /// 0 in half of them: they reflect.
    pub eta: f32,
}

impl Shape {
    pub fn inputs(&self) -> [Value; 7] {
        let Self {
            lobe,
            curve,
            horizon,
            table,
            roughness,
            anisotropy,
            eta,
        } = *self;
        [
            (lobe as u32).into(),
            (curve as u32).into(),
            (horizon as u32).into(),
            table.into(),
            roughness.into(),
            anisotropy.into(),
            eta.into(),
        ]
    }
    pub fn lobe_shape(&self) -> LobeShape<'static, f32> {
        LobeShape {
            lobe: self.lobe,
            curve: self.curve,
            horizon: self.horizon,
            roughness: self.roughness,
            anisotropy: self.anisotropy,
            eta: self.eta,
            table: &SCENE.tables[self.table as usize..],
        }
    }
}

pub fn read_shape<T: Scalar>(row: &mut Row<'_, T>) -> LobeShape<'static, T> {
    let [lobe, curve, horizon, table] = [(); 4].map(|()| row.bits() as usize);
    LobeShape {
        lobe: Lobe::ALL[lobe],
        curve: Curve::ALL[curve],
        horizon: Horizon::ALL[horizon],
        roughness: row.number(),
        anisotropy: row.number(),
        eta: row.number(),
        table: &SCENE.tables[table..],
    }
}

/// Every lobe with every curve that it reads, isotropic and, where it can, stretched.
fn kinds() -> Vec<(String, Lobe, Curve, bool)> {
    let mut kinds = Vec::new();
    for &lobe in Lobe::ALL {
        let curves = if lobe == Lobe::Geometric {
            Curve::ALL
        } else {
            &[Curve::Sqrt]
        };
        for &curve in curves {
            for stretched in [false, true] {
                if stretched && !lobe.is_anisotropic() {
                    continue;
                }
                let curve_name = if lobe == Lobe::Geometric { curve.name() } else { "" };
                let name = format!(
                    "{} {curve_name}{}",
                    lobe.name(),
                    if stretched { " stretched" } else { "" }
                );
                kinds.push((name, lobe, curve, stretched));
            }
        }
    }
    kinds
}

pub fn random_shape(rng: &mut Rng, lobe: Lobe, curve: Curve, stretched: bool) -> Shape {
    Shape {
        lobe,
        curve,
        horizon: Horizon::ALL[rng.below(Horizon::ALL.len())],
        table: SCENE.curves[rng.below(CUSTOM_CURVES)],
        roughness: random_roughness(rng),
        anisotropy: if stretched { rng.range(-1.0, 1.0) } else { 0.0 },
        eta: match rng.below(4) {
            0 => rng.range(1.05, 2.5),
            1 => 1.0 / rng.range(1.05, 2.5),
            _ => 0.0,
        },
    }
}

fn units(rng: &mut Rng) -> [f32; 3] {
    [(); 3].map(|()| rng.unit())
}

/// Rows of shape, view and the three numbers of a sample, for every kind.
fn with_numbers(mut case: Case) -> Case {
    for (name, lobe, curve, stretched) in kinds() {
        case = case.group_of(&name, 16_000, move |rng, _| {
            let (shape, view) = (random_shape(rng, lobe, curve, stretched), View::random(rng));
            let xi = units(rng).map(Value::Unit);
            [&shape.inputs()[..], &view.inputs(), &xi].concat()
        });
    }
    case
}

/// Rows of shape, view and a direction: of the lobe's samples half the time, else anywhere.
fn with_direction(mut case: Case) -> Case {
    for (name, lobe, curve, stretched) in kinds() {
        case = case.group_of(&name, 16_000, move |rng, index| {
            let (shape, view) = (random_shape(rng, lobe, curve, stretched), View::random(rng));
            let wi = match index % 4 {
                0 => raw_sample(&shape.lobe_shape(), &view.frame, view.wo, units(rng)),
                1 => lobe_sample(&shape.lobe_shape(), &view.frame, view.normal, view.wo, units(rng)).wi,
                _ => rng.direction(),
            };
            [&shape.inputs()[..], &view.inputs(), &[wi.into()]].concat()
        });
    }
    case
}

pub const SHAPE_AND_VIEW: &str = "let shape = LobeShape(lobe, curve, horizon, table, roughness, anisotropy, eta); \
    let frame = Frame(tangent, bitangent, shading);";

macro_rules! shape_and_view {
    ($last:literal) => {
        concat!(
            "lobe curve horizon table roughness anisotropy eta tangent bitangent shading normal wo ",
            $last
        )
    };
}
pub(crate) use shape_and_view;

#[test]
fn lobes_agree() {
    check(
        &["optics/lobe/registry"],
        &[
            with_numbers(
                Case::new(
                    "raw_sample",
                    shape_and_view!("a b c"),
                    SHAPE_AND_VIEW,
                    twin!(|row| {
                        let shape = read_shape(row);
                        let (frame, _, wo) = read_view(row);
                        let xi = row.numbers();
                        row.put_vector(raw_sample(&shape, &frame, wo, xi));
                    }),
                )
                .output("raw_sample(shape, frame, wo, vec3f(a, b, c))", UNIT),
            ),
            with_direction(
                Case::new(
                    "raw_density, raw_weight",
                    shape_and_view!("wi"),
                    SHAPE_AND_VIEW,
                    twin!(|row| {
                        let shape = read_shape(row);
                        let (frame, _, wo) = read_view(row);
                        let wi = row.vector();
                        row.put(raw_density(&shape, &frame, wo, wi));
                        row.put(raw_weight(&shape, &frame, wo, wi));
                    }),
                )
                .output("raw_density(shape, frame, wo, wi)", DENSITY)
                .output("raw_weight(shape, frame, wo, wi)", WEIGHT),
            ),
            with_numbers(
                Case::new(
                    "lobe_sample",
                    shape_and_view!("a b c"),
                    concat!(
                        "let shape = LobeShape(lobe, curve, horizon, table, roughness, anisotropy, eta); ",
                        "let frame = Frame(tangent, bitangent, shading); ",
                        "let drawn = lobe_sample(shape, frame, normal, wo, vec3f(a, b, c));"
                    ),
                    twin!(|row| {
                        let shape = read_shape(row);
                        let (frame, normal, wo) = read_view(row);
                        let drawn = lobe_sample(&shape, &frame, normal, wo, row.numbers());
                        row.put_vector(drawn.wi);
                        row.put(drawn.weight);
                    }),
                )
                .output("drawn.wi", UNIT)
                .output("drawn.weight", WEIGHT),
            ),
            with_direction(
                Case::new(
                    "lobe_evaluate",
                    shape_and_view!("wi"),
                    concat!(
                        "let shape = LobeShape(lobe, curve, horizon, table, roughness, anisotropy, eta); ",
                        "let frame = Frame(tangent, bitangent, shading); ",
                        "let found = lobe_evaluate(shape, frame, normal, wo, wi);"
                    ),
                    twin!(|row| {
                        let shape = read_shape(row);
                        let (frame, normal, wo) = read_view(row);
                        let wi = row.vector();
                        row.put_numbers(lobe_evaluate(&shape, &frame, normal, wo, wi));
                    }),
                )
                .output("found.x", DENSITY)
                .output("found.y", DENSITY),
            ),
        ],
    );
}

#[test]
fn shapes_agree() {
    let mut mirror = Case::new(
        "is_mirror",
        "lobe curve horizon table roughness anisotropy eta",
        "let shape = LobeShape(lobe, curve, horizon, table, roughness, anisotropy, eta);",
        twin!(|row| {
            let shape = read_shape(row);
            row.put(T::select(is_mirror(&shape), T::ONE, T::ZERO));
        }),
    )
    .number("f32(is_mirror(shape))", 1.0);
    for &lobe in Lobe::ALL {
        mirror = mirror.group(lobe.name(), move |rng, _| {
            let shape = random_shape(rng, lobe, Curve::Sqrt, true);
            Shape {
                roughness: rng.log_range(1e-4, 1.0),
                ..shape
            }
            .inputs()
            .into()
        });
    }
    check(
        &["optics/lobe/registry"],
        &[
            mirror,
            Case::new(
                "alpha_from_roughness",
                "roughness",
                "",
                twin!(number r => put(alpha_from_roughness(r))),
            )
            .number("alpha_from_roughness(roughness)", 0.0)
            .group("", |rng, _| inputs![rng.log_range(1e-3, 1.0)]),
            Case::new(
                "stretch_from_anisotropy",
                "anisotropy",
                "",
                twin!(number s => put(stretch_from_anisotropy(s))),
            )
            .number("stretch_from_anisotropy(anisotropy)", 0.0)
            .group("", |rng, _| inputs![rng.range(-1.2, 1.2)]),
        ],
    );
}

fn read_alpha<T: Scalar>(row: &mut Row<'_, T>) -> Alpha<T> {
    Alpha {
        x: row.number(),
        y: row.number(),
    }
}

/// Widths and two local directions.
fn widths_and_directions(rng: &mut Rng) -> Vec<Value> {
    let mut alpha = || rng.log_range(0.01, 2.0);
    let (x, y) = (alpha(), alpha());
    inputs![x, y, upper(rng), rng.direction()]
}

/// A direction above the horizon.
fn upper(rng: &mut Rng) -> Vec3<f32> {
    let d = rng.direction();
    vec3(d.x, d.y, d.z.abs().max(1e-3))
}

#[test]
fn microfacets_agree() {
    let shape_of = |name: &'static str, wgsl, twin| {
        Case::new(name, shape_and_view!("wi"), wgsl, twin).group_of("", 16_000, |rng, _| {
            let (shape, view) = (random_shape(rng, Lobe::Ggx, Curve::Sqrt, true), View::random(rng));
            [&shape.inputs()[..], &view.inputs(), &[rng.direction().into()]].concat()
        })
    };
    let of_widths = |name: &'static str, expression, output, twin| {
        Case::new(name, "x y w h", "", twin)
            .output(expression, output)
            .group("", |rng, _| widths_and_directions(rng))
    };
    const SHAPE: &str = "let shape = LobeShape(lobe, curve, horizon, table, roughness, anisotropy, eta); \
        let alpha = microfacet_alpha(shape); let equal = isotropic_alpha(shape);";
    check(
        &["optics/lobe/lobe"],
        &[
            shape_of(
                "microfacet_alpha",
                SHAPE,
                twin!(|row| {
                    let shape = read_shape(row);
                    read_view(row);
                    row.vector();
                    for alpha in [microfacet_alpha(&shape), isotropic_alpha(&shape)] {
                        row.put(alpha.x);
                        row.put(alpha.y);
                    }
                }),
            )
            .number("alpha.x", 0.0)
            .number("alpha.y", 0.0)
            .number("equal.x", 0.0)
            .number("equal.y", 0.0),
            shape_of(
                "facet",
                "let f = facet(Frame(tangent, bitangent, shading), wo, wi);",
                twin!(|row| {
                    read_shape(row);
                    let (frame, _, wo) = read_view(row);
                    let facet = facet(&frame, wo, row.vector());
                    for v in [facet.wo, facet.wi, facet.h] {
                        row.put_vector(v);
                    }
                    row.put(facet.cosine);
                }),
            )
            .output("f.wo", UNIT)
            .output("f.wi", UNIT)
            .output("f.h", UNIT)
            .number("f.cosine", 1.0),
            of_widths(
                "ggx_distribution",
                "ggx_distribution(vec2f(x, y), h)",
                DENSITY,
                twin!(|row| {
                    let a = read_alpha(row);
                    row.vector();
                    let h = row.vector();
                    row.put(ggx_distribution(a, h));
                }),
            ),
            of_widths(
                "smith_length",
                "smith_length(vec2f(x, y), h)",
                Output::Number(0.0),
                twin!(|row| {
                    let a = read_alpha(row);
                    row.vector();
                    let h = row.vector();
                    row.put(smith_length(a, h));
                }),
            ),
            of_widths(
                "smith_g1_over_cosine",
                "smith_g1_over_cosine(vec2f(x, y), h)",
                Output::Number(0.0),
                twin!(|row| {
                    let a = read_alpha(row);
                    row.vector();
                    let h = row.vector();
                    row.put(smith_g1_over_cosine(a, h));
                }),
            ),
            of_widths(
                "smith_g2_over_cosine",
                "smith_g2_over_cosine(vec2f(x, y), w, h)",
                WEIGHT,
                twin!(|row| {
                    let a = read_alpha(row);
                    let (wo, wi) = (row.vector(), row.vector());
                    row.put(smith_g2_over_cosine(a, wo, wi));
                }),
            ),
            of_widths(
                "distribution_weight",
                "distribution_weight(vec2f(x, y), Facet(w, h, normalize(w + h), 0.5 * length(w + h)))",
                WEIGHT,
                twin!(|row| {
                    let a = read_alpha(row);
                    let (wo, wi) = (row.vector(), row.vector());
                    row.put(distribution_weight(
                        a,
                        Facet {
                            wo,
                            wi,
                            h: (wo + wi).normalize(),
                            cosine: half_vector_cosine(wo, wi),
                        },
                    ));
                }),
            ),
            shape_of(
                "visible_density, _weight",
                SHAPE_AND_VIEW,
                twin!(|row| {
                    let shape = read_shape(row);
                    let (frame, _, wo) = read_view(row);
                    let wi = row.vector();
                    row.put(visible_density(microfacet_alpha(&shape), &frame, wo, wi));
                    row.put(visible_weight(microfacet_alpha(&shape), &frame, wo, wi));
                }),
            )
            .output("visible_density(microfacet_alpha(shape), frame, wo, wi)", DENSITY)
            .output("visible_weight(microfacet_alpha(shape), frame, wo, wi)", WEIGHT),
        ],
    );
}
