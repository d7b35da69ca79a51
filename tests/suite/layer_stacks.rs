//! Stacks of layers one setting away from the defaults, against closed forms: energy, indices under coats and films,
//! stretched lobes, weights that come in, and light that the bounce limit cuts.

use glossmith::{
    compile::compile,
    document::{MaterialSettings, PARAMETERS, assign},
    optics::material::COMPENSATES,
    render::{EngineChoice, Precision},
    scene::{ModelSource, environment::EnvironmentSource},
    study::evaluate::{Albedo, Evaluator},
};

use super::renders::{document, material, render};
use super::support::Random;

const BLACK: &str = "base.metalness=0 base.color=0,0,0 specular.fresnel=dielectric";
const GLASS: &str = "base.metalness=0 base.color=1,1,1 specular.fresnel=dielectric transmission.weight=1";

fn albedo(material: &MaterialSettings, cosine: f64, count: u32) -> Albedo {
    let evaluator = Evaluator::open(material, EngineChoice::Cpu, Precision::Single).unwrap();
    evaluator.albedo(cosine, count, 1).unwrap()
}

fn sums(albedo: &Albedo) -> [f64; 3] {
    std::array::from_fn(|channel| albedo.reflected[channel] + albedo.transmitted[channel])
}

/// Fresnel's equations between two media of which one may be complex (Born and Wolf, section 1.5); the cosine is that of the
/// first.
fn reflectance(cosine: f64, before: f64, [eta, k]: [f64; 2]) -> f64 {
    glossmith::optics::fresnel::fresnel_conductor(cosine, eta / before, k / before)
}

/// Rough glass never makes light, whatever the tint of what it reflects.
#[test]
fn no_glass_makes_light() {
    for lobe in ["ggx", "ggx-2018", "geometric"] {
        for (roughness, ior) in [(0.3, 1.5), (0.6, 2.5), (1.0, 1.5), (1.0, 4.0)] {
            for reflection in ["specular.color=0,0,0", "specular.color=0,1,0"] {
                let own =
                    format!("specular.lobe={lobe} specular.roughness={roughness} specular.ior={ior} {reflection}");
                let glass = material(&format!("{GLASS} {own}"));
                for cosine in [1.0, 0.5, 0.1, -0.8, -0.3] {
                    let found = sums(&albedo(&glass, cosine, 1 << 14));
                    assert!(found.iter().all(|&sum| sum < 1.006), "{own} at {cosine}: {found:?}");
                    if cosine < 0.0 {
                        assert!(found.iter().all(|&sum| sum > 0.99), "{own} at {cosine}: {found:?}");
                    }
                }
            }
        }
    }
}

/// A tint is the reflection's alone: what goes through black reflections is (1 − F), as under white ones.
#[test]
fn a_tint_leaves_what_goes_through() {
    let white = "base.metalness=0 base.color=1,1,1 specular.fresnel=dielectric";
    let through = |below: &str, color: &str| {
        let own = material(&format!("{below} specular.roughness=0 specular.color={color}"));
        let found = albedo(&own, 0.1, 1 << 14);
        [found.reflected[1], found.transmitted[1]]
    };
    let [_, plain] = through(GLASS, "1,1,1");
    let [reflected, transmitted] = through(GLASS, "0,0,0");
    assert!(
        reflected < 1e-6 && (transmitted - plain).abs() < 0.004,
        "{transmitted} for {plain}"
    );
    let [under_black, _] = through(white, "0,0,0");
    near!(under_black, plain, 0.004);
}

/// Beyond the critical angle of a smooth reflection a rougher refraction still lets light through, and is drawn.
#[test]
fn extra_roughness_of_refraction_is_drawn_beyond_the_critical_angle() {
    let frosted = material(&format!(
        "{GLASS} specular.lobe=ggx specular.roughness=0.05 transmission.roughness=0.3"
    ));
    for (cosine, through) in [(-0.7, 0.1746), (-0.6, 0.0615), (-0.4, 0.0211)] {
        let found = albedo(&frosted, cosine, 1 << 16).transmitted[1];
        near!(found, through, 0.002, "at {cosine}");
    }
}

/// Measured metals under a smooth coat are the exact stack of both interfaces.
#[test]
fn metals_under_a_coat_meet_its_index() {
    const COAT: f64 = 1.5;
    for metal in ["iron", "titanium", "gold", "copper", "aluminium", "platinum"] {
        let coated = material(&format!(
            "base.metalness=1 specular.lobe=ggx specular.roughness=0 specular.fresnel=conductor \
             specular.conductor={metal} coat.weight=1 coat.lobe=ggx coat.roughness=0 coat.ior=1.5"
        ));
        for cosine in [1.0, 0.8, 0.5, 0.2] {
            let found = albedo(&coated, cosine, 1 << 12).reflected;
            let outer = reflectance(cosine, 1.0, [COAT, 0.0]);
            let within = (1.0 - (1.0 - cosine * cosine) / (COAT * COAT)).sqrt();
            for channel in 0..3 {
                let index = [coated.eta[channel], coated.k[channel]].map(f64::from);
                let inner = reflectance(within, COAT, index);
                let exact = outer + (1.0 - outer).powi(2) * inner / (1.0 - outer * inner);
                let found = found[channel];
                near!(found, exact, 0.01, "{metal} at {cosine}");
            }
        }
    }
}

/// A film under a coat meets the light that the coat has refracted (complex Airy sums, review of the layers, fault 7).
#[test]
fn films_under_a_coat_meet_its_angle() {
    let filmed = material(&format!(
        "{BLACK} specular.lobe=ggx specular.roughness=0 thin_film.weight=1 thin_film.thickness=0.5 thin_film.ior=1.33 \
         coat.weight=1 coat.lobe=ggx coat.roughness=0 coat.darkening=0"
    ));
    for (cosine, exact) in [(0.5, 0.103), (0.342, 0.187)] {
        let [red, ..] = albedo(&filmed, cosine, 1 << 12).reflected;
        near!(red, exact, 0.015, "at {cosine}");
    }
}

/// The weight of the reflection is in the index of what is refracted too: 0 is not there, and does not bend.
#[test]
fn the_weight_in_the_index_holds_for_glass() {
    for (weight, cosine, reflected) in [(0.3, 0.104528, 0.4932), (0.0, 0.1, 0.0), (0.0, 0.7, 0.0)] {
        let glass = material(&format!(
            "{GLASS} specular.roughness=0 specular.weight_in_index=on specular.weight={weight}"
        ));
        let found = albedo(&glass, cosine, 1 << 14);
        near!(found.reflected[1], reflected, 0.002, "{weight}");
        near!(found.transmitted[1], (1.0 - reflected), 0.002, "{weight}");
    }
    let film = material(&format!(
        "{BLACK} specular.roughness=0.1 specular.weight_in_index=on specular.weight=0 thin_film.weight=1 \
         thin_film.thickness=0.5 thin_film.ior=1.8"
    ));
    let found = albedo(&film, 1.0, 1 << 12).reflected[1];
    near!(found, 0.225, 0.004, "a film without an index below it");
}

/// Fringes of thick films are finer than the nodes of a table: bands blur them, so that white stacks stay white.
#[test]
fn thick_films_keep_all_light() {
    let white = "base.metalness=0 base.color=1,1,1 specular.fresnel=dielectric";
    for below in [white, GLASS] {
        for lobe in ["ggx", "geometric"] {
            for film in [
                "0 thin_film.thickness=2",
                "0 thin_film.thickness=10",
                "0.3 thin_film.thickness=10",
                "0 thin_film.ior=1.4 thin_film.thickness=0.5 specular.ior=1.0001",
                "0.37 specular.ior=2 specular.weight_in_index=on thin_film.ior=1 thin_film.thickness=0.5 coat.weight=0.33 \
                 coat.ior=1.5 coat.roughness=1 coat.lobe=ggx coat.on_base=on coat.darkening=0 transmission.roughness=-0.3",
                "0 thin_film.weight=0 specular.ior=1.0001 transmission.roughness=0.3",
            ] {
                let own = format!("specular.lobe={lobe} thin_film.weight=1 thin_film.ior=2 specular.roughness={film}");
                let filmed = material(&format!("{below} {own}"));
                for cosine in [1.0, 0.6, 0.3, 0.148, 0.1] {
                    let found = sums(&albedo(&filmed, cosine, 1 << 14));
                    assert!(
                        found.iter().all(|sum| (sum - 1.0).abs() < 0.008),
                        "{own} at {cosine}: {found:?}"
                    );
                }
            }
        }
    }
}

/// What comes in with a weight of a millionth changes nothing that is seen: on random stacks, for each weight.
#[test]
fn weights_come_in_without_a_jump() {
    const WEIGHTS: [&str; 10] = [
        "base.weight",
        "base.diffuse_roughness",
        "base.metalness",
        "specular.weight",
        "coat.weight",
        "coat.darkening",
        "fuzz.weight",
        "thin_film.weight",
        "thin_film.thickness",
        "transmission.weight",
    ];
    let mut rng = Random::new(7);
    for number in 0..8 {
        let mut stack = MaterialSettings {
            fresnel: glossmith::optics::fresnel::Fresnel::Dielectric,
            specular_in_index: number % 2 == 0,
            ..MaterialSettings::default()
        };
        for id in PARAMETERS.iter().map(|parameter| parameter.key) {
            let is_drawn = ["roughness", "ior", "thickness", "darkening"]
                .iter()
                .any(|part| id.ends_with(part));
            if is_drawn && id != "transmission.roughness" || WEIGHTS.contains(&id) {
                let part = rng.unit();
                let value = match id {
                    _ if id.ends_with("ior") => 1.0 + part,
                    _ if WEIGHTS.contains(&id) && part < 0.3 => 0.0,
                    _ => part,
                };
                assign(&mut stack, &format!("{id}={value}")).unwrap();
            }
        }
        for weight in WEIGHTS {
            let [without, with] = ["0", "0.000001"].map(|value| {
                let mut stack = stack.clone();
                assign(&mut stack, &format!("{weight}={value}")).unwrap();
                [1.0, 0.5, 0.15].map(|cosine| sums(&albedo(&stack, cosine, 1 << 14)))
            });
            for (without, with) in without.as_flattened().iter().zip(with.as_flattened()) {
                // Both draw the same numbers; what is drawn by another table may differ by its noise.
                near!(without, with, 0.012, "stack {number}, {weight}");
            }
        }
    }
}

/// What the bounce limit cuts is told in any scene, by what the last surface would have scattered on.
#[test]
fn cut_light_is_told_without_refraction() {
    let matt = |albedo: f64| {
        let own = format!("base.metalness=0 specular.weight=0 base.color={albedo},{albedo},{albedo}");
        let mut document = document(ModelSource::default(), EnvironmentSource::default(), &[&own]);
        document.render.bounces = 1;
        render(EngineChoice::Cpu, &document).cut_share()
    };
    let [white, black] = [1.0, 0.0].map(matt);
    assert!(
        white > 0.001 && black == 0.0,
        "cut {white} of white and {black} of black"
    );
}

/// Light that is lost between white facets meets others until it leaves, and each takes the colour once more.
#[test]
fn a_coloured_metal_takes_its_colour_each_time() {
    let metal = material(
        "specular.lobe=ggx specular.fresnel=none specular.color=0.5,0.5,0.5 base.metalness=1 specular.roughness=0.8",
    );
    for (cosine, kept) in [
        (1.0, 0.5552),
        (0.8, 0.5699),
        (0.6, 0.5988),
        (0.4, 0.6513),
        (0.2, 0.7489),
        (0.1, 0.8331),
    ] {
        let [found, ..] = albedo(&metal, cosine, 1 << 16).reflected;
        let leaves = f64::sqrt(kept);
        let again = 0.5 * leaves / (1.0 - 0.5 * (1.0 - leaves));
        let expected = 0.5 * (kept + again * (1.0 - kept));
        near!(found, expected, 0.002, "at {cosine}");
    }
}

/// Without facets, without roughness or over a base nothing is to be given back, and no table is made.
#[test]
fn what_loses_nothing_does_not_pay() {
    for (assignments, expected) in [
        ("specular.lobe=geometric base.metalness=1", false),
        ("specular.lobe=ggx specular.roughness=0.01", false),
        ("specular.lobe=ggx specular.multiple_scattering=off", false),
        ("specular.lobe=ggx base.metalness=0", false),
        ("specular.lobe=ggx specular.roughness=0.1", true),
    ] {
        let (materials, tables) = compile(&[material(assignments)]);
        let is_metal = !assignments.contains("base.metalness=0");
        assert_eq!(materials[0].has_flag(COMPENSATES), expected, "{assignments}");
        assert!(!is_metal || tables.is_empty() != expected, "{assignments}");
    }
}
