//! Elementary functions, random numbers, warps and frames.

use glossmith::optics::{
    frame::{Frame, frame_from_normal, frame_from_tangent, local_from_world, world_from_local},
    numeric::{expm1, log1p, normalize_or, sampled_share},
    random::{
        RandomState, Sequence, hash_bits, path_state, random_bits, random_pair, random_pair_bits, random_state,
        scramble_from_low, sobol_second_reversed, unit_from_bits,
    },
    real::Scalar,
    warp::{split, uniform_disc, uniform_sphere},
};

use super::harness::{Case, Output, Rng, Row, Value, check, inputs, twin};

/// A number of either sign, uniform in its logarithm.
fn signed(rng: &mut Rng, low: f32, high: f32) -> f32 {
    rng.sign() * rng.log_range(low, high)
}

#[test]
fn elementary_functions_agree() {
    // Relative to the result alone: these are the functions that must not cancel.
    let relative = Output::Number(0.0);
    check(
        &["optics/numeric"],
        &[
            Case::new("expm1", "x", "", twin!(number x => put(expm1(x))))
                .output("expm1(x)", relative)
                .group("small", |rng, _| inputs![signed(rng, 1e-9, 0.02)])
                .group("large", |rng, _| inputs![rng.range(-40.0, 20.0)]),
            Case::new("log1p", "x", "", twin!(number x => put(log1p(x))))
                .output("log1p(x)", relative)
                .group("small", |rng, _| inputs![signed(rng, 1e-9, 0.02)])
                .group("large", |rng, _| inputs![rng.log_range(0.01, 1e9)])
                .group("negative", |rng, _| inputs![-rng.range(0.005, 0.995)]),
            Case::new(
                "sampled_share",
                "share",
                "",
                twin!(number share => put(sampled_share(share))),
            )
            .output("sampled_share(share)", relative)
            .group("any", |rng, _| inputs![rng.unit()])
            .group("small", |rng, _| inputs![rng.log_range(1e-9, 0.1)]),
            Case::new("arctan2", "y x", "", twin!(numbers [y, x] => put(y.atan2(x))))
                .output("arctan2(y, x)", relative)
                .group("", |rng, _| inputs![signed(rng, 1e-6, 1e3), signed(rng, 1e-6, 1e3)])
                .group("directions", |rng, _| {
                    let d = rng.direction();
                    inputs![d.y, d.x + 1e-9]
                }),
            Case::new(
                "unit_circle",
                "turns",
                "",
                twin!(|row| {
                    let angle_rad = row.number() * T::from_f64(std::f64::consts::TAU);
                    row.put(angle_rad.cos());
                    row.put(angle_rad.sin());
                }),
            )
            .number("unit_circle(turns).x", 1.0)
            .number("unit_circle(turns).y", 1.0)
            .group("a turn", |rng, _| inputs![rng.range(-1.0, 1.0)])
            .group("small", |rng, _| inputs![signed(rng, 1e-9, 0.1)]),
            Case::new("safe_sqrt", "x", "", twin!(number x => put(x.safe_sqrt())))
                .output("safe_sqrt(x)", relative)
                .group("", |rng, _| inputs![signed(rng, 1e-12, 1e6)]),
            Case::new("luminance", "colour", "", twin!(vector v => put(v.luminance())))
                .number("luminance(colour)", 0.01)
                .group("", |rng, _| {
                    inputs![Value::Vector([rng.unit(), rng.unit(), rng.unit()])]
                }),
            Case::new(
                "normalize_or",
                "x y z fallback",
                "",
                twin!(
                    numbers [x, y, z], vector fallback =>
                    put_vector(normalize_or(glossmith::optics::vector::vec3(x, y, z), fallback))
                ),
            )
            .output("normalize_or(vec3f(x, y, z), fallback)", Output::Vector(1.0))
            .group("usable", |rng, _| {
                let size = rng.log_range(1e-14, 1e14);
                let d = rng.direction() * size;
                inputs![d.x, d.y, d.z, rng.direction()]
            })
            // Too short for a direction: the fallback.
            .group("short", |rng, _| {
                let size = rng.log_range(1e-24, 1e-16);
                let d = rng.direction() * size;
                inputs![d.x, d.y, d.z, rng.direction()]
            }),
        ],
    );
}

fn put_state<T: Scalar>(row: &mut Row<'_, T>, state: RandomState) {
    for bits in [state.key, state.sample, state.sequence as u32] {
        row.put_bits(bits);
    }
}

/// Counters as they come, and any bits.
fn counter(rng: &mut Rng) -> u32 {
    if rng.chance(0.5) { rng.bits() >> 20 } else { rng.bits() }
}

/// The case of a path's numbers, whose inputs are x, y, seed and sample.
fn of_state(case: Case) -> Case {
    let outputs = case.exact("s.key").exact("s.sample").exact("s.sequence");
    outputs.group("", |rng, _| {
        inputs![rng.bits() >> 16, rng.bits() >> 16, counter(rng), counter(rng)]
    })
}

/// Any state, its sequence the given one.
fn state<T: Scalar>(row: &mut Row<'_, T>) -> RandomState {
    let [key, sample, sequence] = [(); 3].map(|()| row.bits());
    let sequence = if sequence == 0 {
        Sequence::Sobol
    } else {
        Sequence::Independent
    };
    RandomState { key, sample, sequence }
}

#[test]
fn random_numbers_are_equal_to_the_bit() {
    let draws = |sequence: Sequence| {
        move |rng: &mut Rng, _: usize| inputs![rng.bits(), counter(rng), sequence as u32, rng.bits() >> 8]
    };
    check(
        &["optics/random"],
        &[
            Case::new("hash_bits", "bits", "", twin!(bits x => put_bits(hash_bits(x))))
                .exact("hash_bits(bits)")
                .group("", |rng, _| inputs![counter(rng)]),
            Case::new(
                "unit_from_bits",
                "bits",
                "",
                twin!(|row| {
                    let unit: T = unit_from_bits(row.bits());
                    row.put_bits((unit.to_f64() as f32).to_bits());
                }),
            )
            .exact("bitcast<u32>(unit_from_bits(bits))")
            .group("", |rng, index| inputs![if index == 0 { u32::MAX } else { rng.bits() }]),
            Case::new(
                "random_bits",
                "key sample dimension",
                "",
                twin!(|row| {
                    let [key, sample, dimension] = [(); 3].map(|()| row.bits());
                    row.put_bits(random_bits(key, sample, dimension));
                }),
            )
            .exact("random_bits(key, sample, dimension)")
            .group("", |rng, _| inputs![rng.bits(), counter(rng), counter(rng)]),
            Case::new(
                "scramble_from_low",
                "bits seed",
                "",
                twin!(|row| {
                    let [bits, seed] = [(); 2].map(|()| row.bits());
                    row.put_bits(scramble_from_low(bits, seed));
                }),
            )
            .exact("scramble_from_low(bits, seed)")
            .group("", |rng, _| inputs![counter(rng), rng.bits()]),
            Case::new(
                "sobol_second_reversed",
                "index",
                "",
                twin!(bits x => put_bits(sobol_second_reversed(x))),
            )
            .exact("sobol_second_reversed(index)")
            .group("", |rng, _| inputs![counter(rng)]),
            of_state(Case::new(
                "random_state",
                "x y seed sample",
                "let s = random_state(x, y, seed, sample, 1u);",
                twin!(|row| {
                    let [x, y, seed, sample] = [(); 4].map(|()| row.bits());
                    put_state(row, random_state(x, y, seed, sample, Sequence::Independent));
                }),
            )),
            of_state(Case::new(
                "path_state",
                "x y seed sample",
                "let s = path_state(x, y, seed, sample, 0u);",
                twin!(|row| {
                    let [x, y, seed, sample] = [(); 4].map(|()| row.bits());
                    put_state(row, path_state(x, y, seed, sample, Sequence::Sobol));
                }),
            )),
            Case::new(
                "random_pair_bits",
                "key sample sequence dimension",
                "let pair = random_pair_bits(RandomState(key, sample, sequence), dimension);",
                twin!(|row| {
                    let state = state(row);
                    let pair = random_pair_bits(state, row.bits());
                    pair.into_iter().for_each(|bits| row.put_bits(bits));
                }),
            )
            .exact("pair.x")
            .exact("pair.y")
            .group("sobol", draws(Sequence::Sobol))
            .group("independent", draws(Sequence::Independent)),
            Case::new(
                "random_pair",
                "key sample sequence dimension",
                "let pair = bitcast<vec2u>(random_pair(RandomState(key, sample, sequence), dimension));",
                twin!(|row| {
                    let state = state(row);
                    let pair: [T; 2] = random_pair(state, row.bits());
                    pair.into_iter()
                        .for_each(|unit| row.put_bits((unit.to_f64() as f32).to_bits()));
                }),
            )
            .exact("pair.x")
            .exact("pair.y")
            .group("sobol", draws(Sequence::Sobol))
            .group("independent", draws(Sequence::Independent)),
        ],
    );
}

fn units(rng: &mut Rng) -> [Value; 2] {
    [(); 2].map(|()| Value::Unit(rng.unit()))
}

#[test]
fn warps_agree() {
    check(
        &["optics/warp"],
        &[
            Case::new(
                "uniform_sphere",
                "a b",
                "",
                twin!(numbers xi => put_vector(uniform_sphere(xi))),
            )
            .output("uniform_sphere(vec2f(a, b))", Output::Vector(1.0))
            .group("", |rng, _| units(rng).into()),
            Case::new(
                "uniform_disc",
                "a b",
                "let place = uniform_disc(vec2f(a, b));",
                twin!(numbers xi => put_numbers(uniform_disc(xi))),
            )
            .number("place.x", 1.0)
            .number("place.y", 1.0)
            .group("", |rng, _| units(rng).into()),
            Case::new(
                "split",
                "a b",
                "let part = split(a, b);",
                twin!(|row| {
                    let [number, share] = row.numbers();
                    let (is_below, stretched) = split(number, share);
                    row.put_bits(is_below.into());
                    row.put_numbers([stretched]);
                }),
            )
            .exact("u32(part.is_below)")
            .number("part.remapped", 1.0)
            .group("", |rng, _| units(rng).into())
            .group("ends", |rng, row| {
                let share = [0.0, 1.0, 1e-6, 0.999_999][row % 4];
                vec![Value::Unit(rng.unit()), Value::Number(share)]
            }),
        ],
    );
}

fn put_frame<T: Scalar>(row: &mut Row<'_, T>, frame: Frame<T>) {
    row.put_vector(frame.tangent);
    row.put_vector(frame.bitangent);
    row.put_vector(frame.normal);
}

#[test]
fn frames_agree() {
    let unit = Output::Vector(1.0);
    let change = |name, wgsl, twin| {
        Case::new(name, "tangent bitangent normal world", wgsl, twin)
            .output("changed", unit)
            .group("", |rng, _| {
                let frame = frame_from_normal(rng.direction());
                inputs![frame.tangent, frame.bitangent, frame.normal, rng.direction()]
            })
    };
    check(
        &["optics/frame"],
        &[
            Case::new(
                "frame_from_normal",
                "normal",
                "let f = frame_from_normal(normal);",
                twin!(|row| {
                    let frame = frame_from_normal(row.vector());
                    put_frame(row, frame);
                }),
            )
            .output("f.tangent", unit)
            .output("f.bitangent", unit)
            .output("f.normal", unit)
            .group("", |rng, _| inputs![rng.direction()]),
            Case::new(
                "frame_from_tangent",
                "normal tangent rotation_rad",
                "let f = frame_from_tangent(normal, tangent, rotation_rad);",
                twin!(|row| {
                    let (normal, tangent, rotation_rad) = (row.vector(), row.vector(), row.number());
                    put_frame(row, frame_from_tangent(normal, tangent, rotation_rad));
                }),
            )
            .output("f.tangent", unit)
            .output("f.bitangent", unit)
            .output("f.normal", unit)
            .group("", |rng, _| {
                inputs![rng.direction(), rng.direction(), rng.range(-3.2, 3.2)]
            }),
            change(
                "local_from_world",
                "let changed = local_from_world(Frame(tangent, bitangent, normal), world);",
                twin!(|row| {
                    let frame = Frame {
                        tangent: row.vector(),
                        bitangent: row.vector(),
                        normal: row.vector(),
                    };
                    let changed = local_from_world(&frame, row.vector());
                    row.put_vector(changed);
                }),
            ),
            change(
                "world_from_local",
                "let changed = world_from_local(Frame(tangent, bitangent, normal), world);",
                twin!(|row| {
                    let frame = Frame {
                        tangent: row.vector(),
                        bitangent: row.vector(),
                        normal: row.vector(),
                    };
                    let changed = world_from_local(&frame, row.vector());
                    row.put_vector(changed);
                }),
            ),
            Case::new(
                "mirrored_about",
                "direction axis",
                "",
                twin!(vector d, vector axis => put_vector(d.mirrored_about(axis))),
            )
            .output("mirrored_about(direction, axis)", unit)
            .group("", |rng, _| inputs![rng.direction(), rng.direction()]),
            Case::new(
                "reflected_at_plane",
                "direction normal",
                "",
                twin!(vector d, vector n => put_vector(d.reflected_at_plane(n))),
            )
            .output("reflected_at_plane(direction, normal)", unit)
            .group("", |rng, _| inputs![rng.direction(), rng.direction()]),
        ],
    );
}
