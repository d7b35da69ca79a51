//! Thin films: closed values of Airy's sum, joins with what has no film, and a soap film.

use std::f64::consts::TAU;

use glossmith::{
    document::Document,
    optics::{
        fresnel::{Fresnel, FresnelTerms, fresnel, fresnel_metal},
        real::Scalar,
        thin_film::{BAND_WIDTH, FilmTerms, UNBANDED_PHASE, WAVELENGTHS_NM, film_path, index_of_colors},
        vector::{Vec3, vec3},
    },
    scene::texture::TextureTarget,
};

use crate::{cli_support::Workplace, own_textures::coated_on_a_box};

/// Fresnel terms without tints.
fn terms<T: Scalar>(model: Fresnel, ior: f64, [eta, k]: [f64; 2], film: FilmTerms<T>) -> FresnelTerms<T> {
    let white = Vec3::ONE;
    let splat = |x: f64| Vec3::splat(T::from_f64(x));
    FresnelTerms {
        model,
        metal_f0: white,
        metalness: T::ZERO,
        edge_tint: white,
        tint: white,
        metal_tint: white,
        weight: T::ONE,
        ior: T::from_f64(ior),
        eta: splat(eta),
        k: splat(k),
        before: T::ONE,
        has_film: true,
        film: FilmTerms {
            behind: T::from_f64(ior),
            ..film
        },
    }
}

/// A film of weight 1 for one wavelength.
fn film_for<T: Scalar>(ior: f64, thickness_nm: f64, wavelength_nm: f64) -> FilmTerms<T> {
    FilmTerms {
        weight: T::ONE,
        ior: T::from_f64(ior),
        path: Vec3::splat(T::from_f64(TAU * thickness_nm / wavelength_nm)),
        ..FilmTerms::none_over(T::ONE)
    }
}

/// A ball with a thin film whose thickness a picture on a box gives.
pub fn filmed_on_a_box(folder: &Workplace) -> Document {
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
        near!(exact.x, expected, 6e-6, "{what}");
        near!(f64::from(single.x), exact.x, 0.001 * exact.x, "{what}, {single:?}");
    }
}

#[test]
fn the_basis_is_three_wavelengths() {
    for (found, wavelength) in film_path(0.5).to_f64().into_iter().zip(WAVELENGTHS_NM) {
        near!(found, TAU * 500.0 / wavelength, 1e-5);
    }
}

/// Bands are means over Lorentz's, whose width opens beyond four wavelengths; up to there nothing changes, to the bit.
#[test]
fn bands_are_means_over_wavelengths() {
    let film = |phase: f64, has_bands| FilmTerms {
        weight: 1.0,
        ior: 1.6,
        path: Vec3::splat(phase / 1.6),
        has_bands,
        ..FilmTerms::none_over(1.5)
    };
    for (model, index) in [(Fresnel::Dielectric, [2.4, 0.0]), (Fresnel::Conductor, [0.4, 2.4])] {
        for phase in [5.0, UNBANDED_PHASE, 27.0, 40.0, 150.0] {
            for cosine in [1.0, 0.6, 0.2] {
                let of = |film| fresnel(&terms(model, index[0], index, film), cosine).x;
                let found = of(film(phase, true));
                let crossed = phase * (1.0 - (1.0 - cosine * cosine) / (1.6 * 1.6)).sqrt();
                if crossed <= UNBANDED_PHASE {
                    assert_eq!(found, of(film(phase, false)));
                    continue;
                }
                let width = BAND_WIDTH * (1.0 - UNBANDED_PHASE / crossed);
                let at = |step: i32| {
                    let part = (f64::from(step) + 0.5) / 20_000.0 - 0.5;
                    (phase * (1.0 + width * (0.5 * TAU * part).tan())).abs()
                };
                let mean = (0..20_000).map(|step| of(film(at(step), false))).sum::<f64>() / 20_000.0;
                near!(found, mean, 0.001, "{model:?}, {phase} at {cosine}");
            }
        }
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
                path: Vec3::ZERO,
                ..FilmTerms::none_over(1.5)
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
            for cosine in [0.0, 0.0001, 0.1, 0.4, 0.8, 1.0] {
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
            near!(found, expected, 1e-6, "{f0}, {edge}, {cosine}");
            assert!((0.0..=1.0).contains(&found));
        }
    }
    // At normal incidence the complex index has the metal's colour.
    let [eta, k] = index_of_colors(0.7_f64, 0.6);
    let found = glossmith::optics::fresnel::fresnel_conductor(1.0, eta, k);
    near!(found, 0.7, 1e-9);
}
