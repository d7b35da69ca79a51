//! Thin films: closed values of Airy's sum, joins with what has no film, the furnace, and both engines.

use std::f64::consts::TAU;

use glossmith::compile::compile;
use glossmith::document::{Document, MaterialSettings, assign};
use glossmith::optics::fresnel::{Fresnel, FresnelTerms, fresnel, fresnel_metal};
use glossmith::optics::material::Material;
use glossmith::optics::real::Scalar;
use glossmith::optics::thin_film::{FilmTerms, WAVELENGTHS_NM, film_path, index_of_colors};
use glossmith::optics::vector::{Vec3, vec3};
use glossmith::render::{EngineChoice, Precision};
use glossmith::scene::texture::TextureTarget;
use glossmith::store::preset::{load_material, material_by_name};
use glossmith::store::save_material;
use glossmith::study::evaluate::Evaluator;

use crate::cli_support::Workplace;
use crate::gltf_builder::Folder;
use crate::own_textures::coated_on_a_box;

const CPU: (EngineChoice, Precision) = (EngineChoice::Cpu, Precision::Single);
const EXACT: (EngineChoice, Precision) = (EngineChoice::Cpu, Precision::Double);
/// The GPU, which compiles a kernel for each material that is asked about: for few of them.
const GPU: (EngineChoice, Precision) = (EngineChoice::Gpu, Precision::Single);

/// Fresnel terms without tints.
fn terms<T: Scalar>(model: Fresnel, ior: f64, [eta, k]: [f64; 2], film: FilmTerms<T>) -> FresnelTerms<T> {
    let white = Vec3::splat(T::one());
    let splat = |x: f64| Vec3::splat(T::from_f64(x));
    FresnelTerms {
        model,
        metal_f0: white,
        metalness: T::zero(),
        edge_tint: white,
        tint: white,
        metal_tint: white,
        weight: T::one(),
        ior: T::from_f64(ior),
        eta: splat(eta),
        k: splat(k),
        has_film: true,
        film,
    }
}

/// A film of weight 1 for one wavelength.
fn film_for<T: Scalar>(ior: f64, thickness_nm: f64, wavelength_nm: f64) -> FilmTerms<T> {
    FilmTerms {
        weight: T::one(),
        ior: T::from_f64(ior),
        path: Vec3::splat(T::from_f64(TAU * thickness_nm / wavelength_nm)),
    }
}

/// A material from assignments.
fn material(assignments: &[&str]) -> MaterialSettings {
    let mut material = MaterialSettings::default();
    for assignment in assignments {
        assign(&mut material, assignment).unwrap();
    }
    material
}

const DIFFUSE: [&str; 3] = ["base.metalness=0", "base.color=1,1,1", "specular.fresnel=dielectric"];
const METAL: [&str; 2] = ["base.metalness=1", "base.color=1,1,1"];
const GLASS: [&str; 2] = ["base.metalness=0", "transmission.weight=1"];

fn filmed(base: &[&str], more: &[&str]) -> MaterialSettings {
    material(&[base, &["thin_film.weight=1", "thin_film.ior=2"], more].concat())
}

/// A ball with a thin film whose thickness a picture on a box gives.
pub fn filmed_on_a_box(folder: &Folder) -> Document {
    let mut document = coated_on_a_box(folder);
    let material = &mut document.materials[0];
    let picture = material.user_textures.get(TextureTarget::Coat).cloned();
    material.user_textures.set(TextureTarget::Coat, None);
    material.put_texture(TextureTarget::FilmThickness, picture.unwrap());
    (material.coat_weight, material.film_weight, material.film_ior) = (0.0, 1.0, 2.5);
    document
}

#[test]
fn films_have_the_closed_values() {
    let sixty = 0.5;
    // Cosine, film's index, nm, wavelength, index below as η and k, the share reflected.
    let rows = [
        // A quarter wave.
        (1.0, 1.38, 550.0 / (4.0 * 1.38), 550.0, [1.52, 0.0], 0.012_601),
        // A free film at its maximum.
        (1.0, 1.33, 550.0 / (4.0 * 1.33), 550.0, [1.0, 0.0], 0.077_113),
        (1.0, 1.33, 0.0, 550.0, [1.5, 0.0], 0.04),
        (1.0, 1.33, 400.0, 650.0, [1.5, 0.0], 0.012_71),
        (1.0, 1.33, 400.0, 550.0, [1.5, 0.0], 0.038_66),
        (1.0, 1.33, 400.0, 450.0, [1.5, 0.0], 0.012_60),
        (sixty, 1.33, 400.0, 650.0, [1.5, 0.0], 0.065_28),
        (sixty, 1.33, 400.0, 550.0, [1.5, 0.0], 0.035_67),
        (sixty, 1.33, 400.0, 450.0, [1.5, 0.0], 0.071_28),
        // On gold.
        (1.0, 1.33, 300.0, 550.0, [0.375, 2.386], 0.724_25),
    ];
    for (cosine, ior, thickness, wavelength, index, expected) in rows {
        let model = if index[1] > 0.0 {
            Fresnel::Conductor
        } else {
            Fresnel::Dielectric
        };
        let exact = fresnel(
            &terms(model, index[0], index, film_for::<f64>(ior, thickness, wavelength)),
            cosine,
        );
        let single = fresnel(
            &terms(model, index[0], index, film_for::<f32>(ior, thickness, wavelength)),
            cosine as f32,
        );
        let what = format!("{ior}, {thickness} nm at {wavelength} nm, {cosine}: {exact:?} for {expected}");
        assert!((exact.x - expected).abs() < 6e-6, "{what}");
        assert!(
            (f64::from(single.x) - exact.x).abs() < 1e-3 * exact.x,
            "{what}, {single:?}"
        );
    }
}

#[test]
fn the_basis_is_three_wavelengths() {
    for (found, wavelength) in film_path(0.5).to_f64().into_iter().zip(WAVELENGTHS_NM) {
        assert!((found - TAU * 500.0 / wavelength).abs() < 1e-5);
    }
}

/// A film that has no thickness, or the index of one side, changes nothing, whatever the model.
#[test]
fn films_join_what_has_none() {
    for &model in Fresnel::ALL {
        for metalness in [0.0, 0.3, 1.0] {
            let film = FilmTerms {
                weight: 1.0,
                ior: 1.7,
                path: Vec3::zero(),
            };
            let filmed = FresnelTerms {
                metal_f0: vec3(0.95, 0.6, 0.1),
                edge_tint: vec3(0.9, 0.4, 1.0),
                metalness,
                tint: vec3(0.9, 1.0, 0.5),
                ..terms(model, 1.5, [0.4, 2.4], film)
            };
            let matched = FilmTerms {
                ior: 1.0,
                path: Vec3::splat(7.0),
                ..film
            };
            for cosine in [0.0, 1e-4, 0.1, 0.4, 0.8, 1.0] {
                let of = |has_film, film| {
                    fresnel(
                        &FresnelTerms {
                            has_film,
                            film,
                            ..filmed
                        },
                        cosine,
                    )
                };
                let bare = of(false, film);
                for other in [of(true, film), of(true, matched)] {
                    let off = (other - bare).map(f64::abs).max_component();
                    assert!(off < 1e-9, "{model:?}, {metalness}, {cosine}: {other:?} for {bare:?}");
                }
            }
        }
    }
}

/// A metal of colours loses as much more or less as the metal of the complex index that has these colours.
#[test]
fn films_on_metals_of_colours_follow_their_index() {
    for (f0, edge) in [(0.5, 1.0), (0.95, 0.9), (0.3, 0.2), (1.0, 1.0)] {
        let [eta, k] = index_of_colors(f0, edge);
        for (cosine, thickness) in [(1.0, 60.0), (0.6, 300.0), (0.2, 450.0), (0.05, 1000.0)] {
            let film = film_for::<f64>(1.6, thickness, 540.0);
            let of_index = terms(Fresnel::Conductor, 1.5, [eta, k], film);
            let bare = FresnelTerms {
                has_film: false,
                ..of_index
            };
            let ratio = (1.0 - fresnel(&of_index, cosine).x) / (1.0 - fresnel(&bare, cosine).x);
            let colours = FresnelTerms {
                metalness: 1.0,
                metal_f0: Vec3::splat(f0),
                edge_tint: Vec3::splat(edge),
                ..terms(Fresnel::Schlick, 1.5, [1.0, 0.0], film)
            };
            let lost = 1.0 - fresnel_metal(Vec3::splat(f0), Vec3::splat(edge), cosine).x;
            let (found, expected) = (fresnel(&colours, cosine).x, (1.0 - lost * ratio).max(0.0));
            assert!(
                (found - expected).abs() < 1e-6,
                "{f0}, {edge}, {cosine}: {found} for {expected}"
            );
            assert!((0.0..=1.0).contains(&found));
        }
    }
    // At normal incidence the complex index has the metal's colour.
    let [eta, k] = index_of_colors(0.7_f64, 0.6);
    let found = glossmith::optics::fresnel::fresnel_conductor(1.0, eta, k);
    assert!((found - 0.7).abs() < 1e-9, "{found}");
}

/// Albedos of a white material at some views, each channel: what is reflected and transmitted together.
fn sums(
    material: &MaterialSettings,
    (engine, precision): (EngineChoice, Precision),
    cosines: &[f64],
    count: u32,
) -> Vec<[f64; 3]> {
    let evaluator = Evaluator::open(material, engine, precision).unwrap();
    let of = |&cosine: &f64| {
        let found = evaluator.albedo(cosine, count, 1).unwrap();
        [0, 1, 2].map(|i| found.reflected[i] + found.transmitted[i])
    };
    cosines.iter().map(of).collect()
}

/// The furnace: what a film does not reflect goes on.
#[test]
fn films_keep_all_light() {
    let above = [1.0, 0.7, 0.4, 0.15];
    let both = [1.0, 0.5, 0.2, -1.0, -0.85, -0.6];
    let shapes = [
        vec!["specular.lobe=geometric", "specular.roughness=0.3"],
        vec!["specular.roughness=0", "thin_film.ior=1.33", "thin_film.thickness=0.3"],
        vec!["specular.roughness=0.2"],
        vec![
            "specular.roughness=0.2",
            "thin_film.weight=0.5",
            "thin_film.thickness=1",
        ],
        vec!["specular.roughness=0.5", "thin_film.ior=1.33"],
    ];
    let mut worst = 0.0_f64;
    for (base, cosines) in [(&DIFFUSE[..], &above[..]), (&METAL, &above), (&GLASS, &both)] {
        for shape in &shapes {
            let material = filmed(base, &[&["specular.lobe=ggx"], &shape[..]].concat());
            for engine in [CPU, EXACT] {
                for (found, cosine) in sums(&material, engine, cosines, 1 << 15).iter().zip(cosines) {
                    let off = found.map(|x| (x - 1.0).abs()).into_iter().fold(0.0, f64::max);
                    assert!(off < 2e-3, "{base:?}, {shape:?} at {cosine}: {found:?}");
                    worst = worst.max(off);
                }
            }
        }
    }
    println!("{worst:.2e} off at most");
}

/// Where the surface is partly metal, or a texture varies it, the base takes what the mean facet leaves.
#[test]
fn films_over_what_varies_keep_light_to_a_few_percent() {
    let mut worst = 0.0_f64;
    let films = [(1.4, 0.5), (2.0, 0.5), (2.0, 0.2)];
    let lobes = [("geometric", 0.3), ("ggx", 0.05), ("ggx", 0.3), ("ggx", 0.5)];
    // Glass that is metal in part has energies over the roughness, in each channel.
    let cases = films.iter().flat_map(|film| {
        lobes
            .iter()
            .flat_map(move |lobe| [0, 1].map(|clear| (film, lobe, clear)))
    });
    for ((ior, thickness), (lobe, roughness), clear) in cases {
        let material = material(&[
            "base.metalness=0.5",
            "base.color=1,1,1",
            "specular.fresnel=dielectric",
            "thin_film.weight=1",
            &format!("transmission.weight={clear}"),
            &format!("thin_film.ior={ior}"),
            &format!("thin_film.thickness={thickness}"),
            &format!("specular.lobe={lobe}"),
            &format!("specular.roughness={roughness}"),
        ]);
        let mut of_case = 0.0_f64;
        for found in sums(&material, CPU, &[1.0, 0.7, 0.4, 0.15], 1 << 14).concat() {
            of_case = of_case.max((found - 1.0).abs());
        }
        println!("{ior}, {thickness}, {lobe} {roughness}, clear {clear}: {of_case:.4}");
        worst = worst.max(of_case);
    }
    assert!(worst < 0.03, "{worst}");
}

/// A soap bubble's wall: a film with air on both sides reflects as Airy says and lets the rest go straight on.
#[test]
fn a_soap_film_reflects_and_lets_through() {
    let material = material(&[
        "base.metalness=0",
        "transmission.weight=1",
        "specular.ior=1",
        "specular.roughness=0",
        "thin_film.weight=1",
        "thin_film.ior=1.33",
        "thin_film.thickness=0.3",
    ]);
    for (engine, precision) in [CPU, EXACT, GPU] {
        let evaluator = Evaluator::open(&material, engine, precision).unwrap();
        for cosine in [1.0_f64, 0.5, -0.5] {
            let found = evaluator.albedo(cosine, 1 << 13, 1).unwrap();
            for (i, wavelength) in WAVELENGTHS_NM.into_iter().enumerate() {
                let film = film_for::<f64>(1.33, 300.0, wavelength);
                let expected = fresnel(&terms(Fresnel::Dielectric, 1.0, [1.0, 0.0], film), cosine.abs()).x;
                let (reflected, transmitted) = (found.reflected[i], found.transmitted[i]);
                let what = format!("{engine:?} at {cosine}: {reflected} and {transmitted} for {expected}");
                assert!((reflected - expected).abs() < 2e-3, "{what}");
                assert!((reflected + transmitted - 1.0).abs() < 2e-3, "{what}");
            }
        }
    }
}

#[test]
fn both_engines_have_the_same_film() {
    let directions = [
        [0.6, 0.0, 0.8],
        [-0.6, 0.48, 0.64],
        [-0.5, 0.0, 0.866_025_4],
        [0.0, 0.96, 0.28],
    ];
    let directions = directions.map(Vec3::from_f64);
    for material in [
        filmed(
            &DIFFUSE,
            &["specular.lobe=ggx", "specular.roughness=0.4", "thin_film.weight=0.7"],
        ),
        filmed(
            &["base.metalness=0.6"],
            &["specular.edge_tint=0.4,0.9,1", "specular.roughness=0.5"],
        ),
        filmed(
            &["specular.fresnel=conductor"],
            &["thin_film.thickness=0.07", "specular.roughness=0.5"],
        ),
        filmed(
            &GLASS,
            &["specular.lobe=ggx", "specular.roughness=0.4", "coat.weight=0.5"],
        ),
    ] {
        let pairs: Vec<_> = directions
            .iter()
            .flat_map(|&wo| {
                directions
                    .map(|wi| [wo, wi])
                    .into_iter()
                    .chain(directions.map(|wi| [wo, -wi]))
            })
            .collect();
        let [exact, cpu, gpu] = [EXACT, CPU, GPU].map(|(engine, precision)| {
            let evaluator = Evaluator::open(&material, engine, precision).unwrap();
            evaluator.evaluate(&pairs).unwrap()
        });
        for (single, engine) in [(cpu, "CPU"), (gpu, "GPU")] {
            for (exact, found) in exact.iter().zip(&single) {
                let apart = |i: usize| (exact.value[i] - found.value[i]).abs() / exact.value[i].max(1e-3);
                let worst = apart(0).max(apart(1)).max(apart(2));
                let dense = (exact.density - found.density).abs() / exact.density.max(1e-3);
                assert!(worst.max(dense) < 1e-3, "{engine}: {found:?} for {exact:?}");
            }
        }
    }
}

/// Without weight or thickness there is no film to the bit; at both ends of index, thickness and view all is finite.
#[test]
fn both_ends_of_films_are_finite() {
    for base in [&DIFFUSE[..], &METAL, &GLASS, &["specular.fresnel=conductor"]] {
        let bare = compile(&[material(base)]).0[0];
        for none in ["thin_film.weight=0", "thin_film.thickness=0"] {
            let (without, _) = compile(&[filmed(base, &[none])]);
            assert_eq!(without[0].has_film, 0, "{none}");
            let kept = Material {
                film_path: bare.film_path,
                film_weight: bare.film_weight,
                film_ior: bare.film_ior,
                ..without[0]
            };
            assert_eq!(kept, bare, "{none}");
        }
        for more in [
            ["thin_film.weight=1e-6", "thin_film.ior=1"],
            ["thin_film.thickness=1e-6", "thin_film.ior=3"],
            ["thin_film.thickness=1", "thin_film.ior=1"],
            ["thin_film.thickness=10", "thin_film.ior=3"],
        ] {
            let material = filmed(base, &more);
            for (engine, precision) in [CPU, EXACT] {
                let evaluator = Evaluator::open(&material, engine, precision).unwrap();
                for cosine in [1.0, 0.3, 1e-3] {
                    let found = evaluator.albedo(cosine, 1 << 10, 1).unwrap();
                    for x in found.reflected.into_iter().chain(found.transmitted) {
                        assert!((-1e-6..1.02).contains(&x), "{base:?}, {more:?}, {cosine}: {found:?}");
                    }
                }
                let grazing = Vec3::from_f64([1.0, 0.0, 1e-7]);
                let values = evaluator.evaluate(&[[grazing, grazing]]).unwrap()[0];
                assert!(values.value[0].is_finite() && values.density.is_finite(), "{values:?}");
            }
        }
    }
}

/// What docs/reference/materials.md says of the presets with a film.
#[test]
fn presets_with_a_film_reflect_as_told() {
    for (name, head_on, at_sixty) in [
        ("tempered-steel", [0.025, 0.090, 0.294], [0.085, 0.112, 0.280]),
        ("soap-film", [0.004, 0.032, 0.060], [0.191, 0.152, 0.001]),
    ] {
        let (materials, _) = compile(std::slice::from_ref(material_by_name(name).unwrap()));
        let terms = materials[0].cast::<f64>().fresnel_terms(false);
        for (cosine, expected) in [(1.0, head_on), (0.5, at_sixty)] {
            let found = fresnel(&terms, cosine).to_f64();
            for (found, expected) in found.into_iter().zip(expected) {
                assert!(
                    (found - expected).abs() < 6e-4,
                    "{name} at {cosine}: {found} for {expected}"
                );
            }
        }
    }
}

/// Formats that have a place for a film show it without the exact parameters; the report tells of what has none.
#[test]
fn films_come_back_from_other_formats() {
    let place = Workplace::new();
    let film = filmed(
        &DIFFUSE,
        &[
            "specular.lobe=ggx",
            "thin_film.weight=0.5",
            "thin_film.thickness=0.25",
            "thin_film.ior=1.75",
        ],
    );
    save_material(&place.path("a.json"), &film).unwrap();
    for (format, ending, weight) in [
        ("materialx", "mtlx", 0.5),
        ("standard-surface", "mtlx", 1.0),
        ("gltf", "glb", 0.5),
    ] {
        let report = place.done(&format!("convert a.json a.{ending} --to {format} --report -"));
        place.done(&format!("convert a.{ending} b.json --without-exact --import-lobe ggx"));
        let back = load_material(&place.path("b.json")).unwrap().value;
        let numbers = |m: &MaterialSettings| [m.film_thickness, m.film_ior];
        for (a, b) in numbers(&film).into_iter().zip(numbers(&back)) {
            assert!((a - b).abs() < 1e-5, "{format}: {a} came back as {b}");
        }
        assert!(
            (back.film_weight - weight).abs() < 1e-5,
            "{format}: {}",
            back.film_weight
        );
        let is_told = report.stdout.contains("the format's film is everywhere");
        assert_eq!(is_told, weight == 1.0, "{format}: {}", report.stdout);
    }
    let blender = place.done("convert a.json a.py --to blender --report -");
    assert!(
        blender.stdout.contains("the format's film is everywhere"),
        "{}",
        blender.stdout
    );
    let script = std::fs::read_to_string(place.path("a.py")).unwrap();
    assert!(script.contains("\"Thin Film Thickness\": 250") && script.contains("\"Thin Film IOR\": 1.75"));
    let mitsuba = place.done("convert a.json a.xml --to mitsuba --report -");
    assert!(mitsuba.stdout.contains("thin film"), "{}", mitsuba.stdout);
}
