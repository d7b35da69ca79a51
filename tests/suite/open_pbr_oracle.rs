//! OpenPBR surfaces, read from MaterialX, against numbers of an independent implementation (`open_pbr_oracle.csv`).
//!
//! Its masking is separable, that of Glossmith's GGX is height-correlated: values are compared with the other's form. Light
//! that facets scatter more than once is a lobe of its own there and a factor here, so peaks are compared without it, and
//! albedos with it.

use std::{collections::BTreeMap, fmt::Write as _};

use glossmith::{
    document::{ImportLobe, MaterialSettings, assign},
    optics::{
        fresnel::{fresnel_dielectric, fresnel_f0},
        layer::coat::inner_reflection,
        vector::Vec3,
    },
    render::{EngineChoice, Precision},
    store::exchange::{ReadOptions, find},
    study::evaluate::{Albedo, Evaluator},
};

use crate::cli_support::Workplace;

const NUMBERS: &str = include_str!("open_pbr_oracle.csv");

/// Rows of a kind: material, its inputs, and the cells after them.
fn rows(kind: &str) -> impl Iterator<Item = (&'static str, &'static str, Vec<&'static str>)> {
    let lines = NUMBERS.lines().filter(|line| !line.starts_with('#'));
    let cells = lines.map(|line| line.split(',').collect::<Vec<_>>());
    cells
        .filter(move |cells| cells[0] == kind)
        .map(|cells| (cells[1], cells[2], cells[3..].to_vec()))
}

/// The material of a MaterialX file with these inputs, `name=value;…`.
fn material(place: &Workplace, inputs: &str, is_single: bool) -> MaterialSettings {
    let mut text = String::new();
    // Of an input that is said twice the last counts.
    let said: BTreeMap<&str, &str> = inputs.split(';').filter_map(|input| input.split_once('=')).collect();
    for (name, value) in said {
        let of_type = if value.contains(' ') { "color3" } else { "float" };
        let value = value.replace(' ', ", ");
        let _ = writeln!(text, "<input name=\"{name}\" type=\"{of_type}\" value=\"{value}\"/>");
    }
    let file = format!(
        "<?xml version=\"1.0\"?>\n<materialx version=\"1.39\">\n<open_pbr_surface name=\"s\" type=\"surfaceshader\">\n{text}\
         </open_pbr_surface>\n<surfacematerial name=\"m\" type=\"material\">\n<input name=\"surfaceshader\" \
         type=\"surfaceshader\" nodename=\"s\"/>\n</surfacematerial>\n</materialx>\n"
    );
    place.write("surface.mtlx", file);
    let options = ReadOptions {
        lobe: ImportLobe::Ggx,
        ..ReadOptions::default()
    };
    let mut found = find(place.path("surface.mtlx").to_str().unwrap(), options)
        .unwrap()
        .value;
    if is_single {
        assign(&mut found, "specular.multiple_scattering=off").unwrap();
    }
    found
}

fn direction(theta_deg: f64, phi_deg: f64) -> Vec3<f32> {
    let (sine, cosine) = theta_deg.to_radians().sin_cos();
    let (across, along) = phi_deg.to_radians().sin_cos();
    Vec3::from_f64([sine * along, sine * across, cosine])
}

/// Separable masking over height-correlated masking, at GGX's α.
fn separable_over_correlated(alpha: f64, cosines: [f64; 2]) -> f64 {
    let length = |cosine: f64| (cosine * cosine + alpha * alpha * (1.0 - cosine * cosine)).sqrt();
    let [o, i] = cosines;
    let separable = 4.0 * o * i / ((o + length(o)) * (i + length(i)));
    let correlated = 2.0 * o * i / (o * length(i) + i * length(o));
    separable / correlated
}

/// The values of a kind of rows within a tolerance of their own size, the masking converted where the lobe reflects.
fn assert_values(kind: &str, tolerance: f64, reflects: bool) {
    let place = Workplace::new();
    let (mut count, mut worst) = (0, 0.0_f64);
    let mut last: Option<(&str, MaterialSettings, Evaluator)> = None;
    for (name, inputs, cells) in rows(kind) {
        if last.as_ref().is_none_or(|(of, ..)| *of != name) {
            let material = material(&place, inputs, true);
            let evaluator = Evaluator::open(&material, EngineChoice::Cpu, Precision::Double).unwrap();
            last = Some((name, material, evaluator));
        }
        let (_, material, evaluator) = last.as_ref().unwrap();
        let numbers: Vec<f64> = cells.iter().map(|cell| cell.parse().unwrap()).collect();
        let [wo, wi] = [[0, 1], [2, 3]].map(|[theta, phi]| direction(numbers[theta], numbers[phi]));
        let found = evaluator.evaluate(&[[wo, wi]]).unwrap()[0].value;
        let alpha = f64::from(if kind == "coat" {
            material.coat_roughness
        } else {
            material.roughness
        })
        .powi(2);
        let masking = match reflects {
            true => separable_over_correlated(alpha, [f64::from(wo.z), f64::from(wi.z)]),
            false => 1.0,
        };
        for (value, expected) in found.iter().zip(&numbers[4..]) {
            let off = (value * masking - expected).abs() / expected.abs().max(1e-6);
            worst = worst.max(off);
            assert!(
                off < tolerance,
                "{kind} {name} at {cells:?}: {} for {expected}, {:.2} % off",
                value * masking,
                100.0 * off
            );
        }
        count += 1;
    }
    println!("{kind}: {count} rows, {:.3} % off at most", 100.0 * worst);
    assert!(count >= 4, "{kind}: {count} rows");
}

#[test]
fn bases_gloss_films_peaks_and_coats_have_the_oracle_s_values() {
    for (kind, tolerance, reflects) in [
        ("diffuse", 0.003, false),
        ("gloss", 0.003, true),
        // By the same three wavelengths.
        ("film", 0.003, true),
        ("peak", 0.003, true),
        ("refracted", 0.005, false),
        ("coat", 0.003, true),
    ] {
        assert_values(kind, tolerance, reflects);
    }
}

/// What a coat is held to where the oracle leaves the specification (its notes list nine such places).
enum Coated {
    /// The oracle's own albedos.
    Oracle,
    /// The darkening by the specification's closed form: the oracle takes averages of the Fresnel factor, for a smooth base
    /// too, and blends the index around a coat in part before the ratio.
    Darkening,
    /// The oracle's reflection, and all other light let through, by the colour of the way in, twice: the oracle's glass
    /// below a coat lets through up to 0.014 more than there is, and here refracted light finds no coat on its way out.
    Refracted,
    /// The oracle's way of what lies below: it takes off the albedo of a coat that is not stretched, and gains or loses light.
    Stretched,
    /// The fuzz over what is below it: the oracle's table of fuzz is a fit here.
    Fuzz,
}

fn held_to(name: &str) -> Coated {
    match name {
        _ if name.contains("w0.5") => Coated::Darkening,
        "coat_ior2.0" | "coat_metal" | "coat_metal_rough_coat" | "coat_r1" => Coated::Darkening,
        "coat_aniso" => Coated::Stretched,
        "trans_coat_color" | "furnace_coat_trans" => Coated::Refracted,
        _ if name.starts_with("fuzz") => Coated::Fuzz,
        _ => Coated::Oracle,
    }
}

/// The albedo of a surface for a view of this cosine, negative from within, and its material.
fn albedo(place: &Workplace, inputs: &str, is_single: bool, cosine: f64) -> (Albedo, MaterialSettings) {
    let material = material(place, inputs, is_single);
    let evaluator = Evaluator::open(&material, EngineChoice::Cpu, Precision::Single).unwrap();
    (evaluator.albedo(cosine, 1 << 14, 1).unwrap(), material)
}

#[test]
fn coats_over_bases_have_the_oracle_s_albedo() {
    let place = Workplace::new();
    let (mut worst, mut faults) = ((0.0_f64, ""), Vec::new());
    for (name, inputs, cells) in rows("coated") {
        let numbers: Vec<f64> = cells[1..].iter().map(|cell| cell.parse().unwrap()).collect();
        let cosine = numbers[0];
        let with = |more: &str| albedo(&place, &format!("{inputs}{more}"), false, cosine);
        let (found, material) = with("");
        let of_coat = |more: &str| {
            let black = format!("{more};base_color=0 0 0;specular_weight=0;base_metalness=0");
            with(&black).0.reflected[0]
        };
        let mut near = |found: f64, expected: f64, tolerance: f64| {
            let off = (found - expected).abs();
            if off >= tolerance {
                faults.push(format!("{name} at {cosine}: {found} for {expected}"));
            }
            off
        };
        match held_to(name) {
            Coated::Oracle => {
                let all = found.reflected.into_iter().chain(found.transmitted);
                for (value, expected) in all.zip(&numbers[1..]) {
                    let off = near(value, *expected, 0.01);
                    worst = if off > worst.0 { (off, name) } else { worst };
                }
            }
            Coated::Darkening => {
                let bright = with(";coat_darkening=0").0.reflected;
                let black = of_coat("");
                let kept = darkened(&material, cosine);
                for channel in 0..3 {
                    let below = bright[channel] - black;
                    near(found.reflected[channel], black + kept[channel] * below, 0.003);
                }
            }
            Coated::Refracted => {
                let behind = (1.0 - (1.0 - cosine * cosine) / f64::from(material.coat_ior).powi(2)).sqrt();
                let white = with(";coat_color=1 1 1").0;
                for channel in 0..3 {
                    near(found.reflected[channel], numbers[1 + channel], 0.01);
                    near(white.reflected[channel] + white.transmitted[channel], 1.0, 0.002);
                    let twice = f64::from(material.coat_color[channel]).powf(1.0 / behind);
                    near(found.transmitted[channel], twice * white.transmitted[channel], 0.002);
                }
            }
            Coated::Stretched => {
                let [stretched, plain] = [of_coat(""), of_coat(";coat_roughness_anisotropy=0")];
                // What passes is the mean over all azimuths, which a white base shows.
                let white = with(";base_weight=1;base_color=1 1 1;specular_weight=0;base_metalness=0");
                let passed = white.0.reflected[0] - stretched;
                for channel in 0..3 {
                    let below = (found.reflected[channel] - stretched) * (1.0 - plain) / passed;
                    near(stretched + below, numbers[1 + channel], 0.01);
                }
            }
            Coated::Fuzz => {
                let closed = under_fuzz(&place, inputs, cosine);
                for channel in 0..3 {
                    near(found.reflected[channel], closed[channel], 0.003);
                    near(found.reflected[channel], numbers[1 + channel], 0.015);
                }
            }
        }
    }
    println!("coats: {} off at most, {}", worst.0, worst.1);
    assert!(faults.is_empty(), "{faults:#?}");
}

/// The specification's mixture of fuzz with what is below it, by the albedo of the fits alone.
fn under_fuzz(place: &Workplace, inputs: &str, cosine: f64) -> [f64; 3] {
    let none = ";base_color=0 0 0;specular_weight=0;base_metalness=0;coat_weight=0;transmission_weight=0";
    let alone = albedo(
        place,
        &format!("{inputs}{none};fuzz_weight=1;fuzz_color=1 1 1"),
        false,
        cosine,
    );
    let below = albedo(place, &format!("{inputs};fuzz_weight=0"), false, cosine)
        .0
        .reflected;
    let material = material(place, inputs, false);
    let share = f64::from(material.fuzz_weight) * alone.0.reflected[0];
    [0, 1, 2].map(|channel| share * f64::from(material.fuzz_color[channel]) + (1.0 - share) * below[channel])
}

/// The specification's darkening of a base under a coat (OpenPBR 1.1, "Darkening").
fn darkened(material: &MaterialSettings, cosine: f64) -> [f64; 3] {
    let [of_coat, of_base] = [material.coat_ior, material.ior].map(f64::from);
    let weight = f64::from(material.coat_weight);
    let ratio = of_coat.max(of_base) / of_coat.min(of_base);
    let head_on = fresnel_f0(of_base + (ratio - of_base) * weight);
    let (roughness, metalness) = (f64::from(material.roughness), f64::from(material.metalness));
    let of_gloss = 1.0 + (roughness - 1.0) * head_on;
    let spread = of_gloss + (roughness - of_gloss) * metalness;
    let smooth = fresnel_dielectric(cosine, of_coat);
    let inner = smooth + (inner_reflection(of_coat) - smooth) * spread;
    material.base_color.map(|color| {
        let color = f64::from(color * material.base_weight);
        let base = (head_on + (1.0 - head_on) * color) * (1.0 - metalness) + color * metalness;
        1.0 + ((1.0 - inner) / (1.0 - base * inner) - 1.0) * weight
    })
}
