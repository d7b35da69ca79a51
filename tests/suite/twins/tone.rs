//! The tone curves, and sRGB's encoding.

use glossmith::optics::tone::{ToneCurve, linear_from_srgb, srgb_from_linear, tone_map};

use super::harness::{Case, Output, Rng, Value, check, inputs, twin};

/// A display-referred channel: differences below a two-hundred-and-fiftieth are told in parts of it.
const DISPLAY: Output = Output::Vector(0.004);

/// A colour of any exposure.
fn scene_color(rng: &mut Rng) -> Value {
    let exposure = rng.log_range(1e-3, 1e3);
    Value::Vector([(); 3].map(|()| exposure * rng.unit()))
}

fn display_color(rng: &mut Rng) -> Value {
    Value::Vector([(); 3].map(|()| rng.unit()))
}

#[test]
fn tone_curves_agree() {
    let mut map = Case::new(
        "tone_map",
        "curve color",
        "",
        twin!(|row| {
            let curve = ToneCurve::ALL[row.bits() as usize];
            let color = row.vector();
            row.put_vector(tone_map(curve, color));
        }),
    )
    .output("tone_map(curve, color)", DISPLAY);
    for &curve in ToneCurve::ALL {
        map = map.group_of(curve.name(), 18_000, move |rng, _| {
            inputs![curve as u32, scene_color(rng)]
        });
    }
    check(
        &["optics/tone"],
        &[
            map,
            Case::new(
                "srgb_from_linear",
                "color",
                "",
                twin!(|row| {
                    let color = row.vector();
                    row.put_vector(srgb_from_linear(color));
                }),
            )
            .output("srgb_from_linear(color)", DISPLAY)
            .group("", |rng, _| inputs![display_color(rng)]),
            Case::new(
                "linear_from_srgb",
                "color",
                "",
                twin!(|row| {
                    let color = row.vector();
                    row.put_vector(linear_from_srgb(color));
                }),
            )
            .output("linear_from_srgb(color)", DISPLAY)
            .group("", |rng, _| inputs![display_color(rng)]),
        ],
    );
}
