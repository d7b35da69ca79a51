//! A thin film over the surface that the specular lobe reflects at. What its two sides reflect interferes.
//!
//! Each channel is light of one wavelength ([`WAVELENGTHS_NM`]), for which Airy's sum over all reflections within the film
//! is exact: every share lies in [0, 1], so that no channel has to be clipped. The film absorbs nothing: what is not
//! reflected goes on. Of a film of many wavelengths each channel may be the mean over a band: Lorentz's, which damps the
//! terms of Airy's sum as a geometric series, so that it keeps its closed form. Written as what enters the medium behind, by admittances (Born and Wolf, "Principles of Optics",
//! section 1.6), because that does not cancel, neither at grazing angles nor at the critical one.
//!
//! What is not given as an index takes the film's effect from one that is: Schlick's dielectric from its index, a metal
//! known by colours from the complex index that has them (Gulbrandsen, "Artist friendly metallic Fresnel", 2014). A film of
//! no thickness so changes nothing.

pub use super::fresnel_terms::FilmTerms;
use super::fresnel_terms::{Fresnel, FresnelTerms, fresnel_metal};
use super::refraction::refracted_square;
use crate::optics::prelude::*;

/// The wavelengths of red, green and blue in nm.
pub const WAVELENGTHS_NM: [f64; 3] = [620.0, 540.0, 450.0];
/// The largest reflectance at normal incidence for which a complex index is sought.
pub const LARGEST_FILM_F0: f64 = 0.999;
/// The phase of a crossing up to which a film has no bands: four wavelengths. Beyond, they open with the phase.
pub const UNBANDED_PHASE: f64 = 4.0 * std::f64::consts::TAU;
/// The half-width that the bands go towards, over the wavelength: 45 nm in the green.
pub const BAND_WIDTH: f64 = 1.0 / 12.0;
/// The least cosine: at 0 a film over the index before it would be 0/0.
pub const LEAST_FILM_COSINE: f64 = 1e-15;
/// Below it a denominator counts as this.
pub const FILM_TINY: f64 = 1e-36;

/// Admittances of a medium behind a film for both polarisations, each as real and imaginary part.
#[derive(Clone, Copy)]
struct Behind<T> {
    perpendicular: [T; 2],
    parallel: [T; 2],
}

/// Phase of a crossing at normal incidence of a film of index 1, by channel; thickness in µm.
pub fn film_path(thickness_um: f32) -> Vec3<f32> {
    let phase = |wavelength: f64| std::f64::consts::TAU * 1e3 * f64::from(thickness_um) / wavelength;
    Vec3::from_f64(WAVELENGTHS_NM.map(phase))
}

inlined! {
    /// The change by the film of what the dielectric of a surface reflects, tint included.
    pub fn film_change_of_dielectric<T: Real>(terms: &FresnelTerms<T>, cosine: T) -> Vec3<T> {
        if !terms.metalness.less(T::ONE).any() {
            return Vec3::ZERO;
        }
        let passed = out_of_line!(T, film_passed(terms, cosine, None));
        -(terms.tint.map(|x| x.min(T::ONE)) * passed) * terms.weight
    }

    /// The change by the film of what the metal of a surface reflects, tint included.
    pub fn film_change_of_metal<T: Real>(terms: &FresnelTerms<T>, cosine: T) -> Vec3<T> {
        if !terms.metalness.above_zero().any() {
            return Vec3::ZERO;
        }
        let changed = out_of_line!(T, film_on_metal(terms, terms.cosine_in_coat(cosine).max(T::from_f64(LEAST_FILM_COSINE))));
        changed * terms.metal_tint
    }

    /// The change by the film of what a dielectric lets through. `height`, where it is known: its relative index times the
    /// cosine behind it, in air.
    pub fn film_passed<T: Real>(terms: &FresnelTerms<T>, cosine: T, height: Option<T>) -> Vec3<T> {
        let film = &terms.film;
        let cosine = terms.cosine_in_coat(cosine).max(T::from_f64(LEAST_FILM_COSINE));
        let mut beyond = refracted_square(cosine, film.behind).safe_sqrt();
        if let Some(height) = height {
            beyond = T::select(terms.before.differs(T::ONE), beyond, height);
        }
        let behind = Behind {
            perpendicular: [beyond, T::ZERO],
            parallel: [beyond / (film.behind * film.behind), T::ZERO],
        };
        let bare = entered_bare(cosine, behind);
        (entered(film, cosine, [behind; 3]) - Vec3::splat(bare)) * film.weight
    }

    /// The share reflected by a film on a conductor of `eta` and `k`, untinted.
    pub fn film_on_conductor<T: Real>(terms: &FresnelTerms<T>, cosine: T, bare: Vec3<T>) -> Vec3<T> {
        out_of_line!(T, {
            let cosine = cosine.max(T::from_f64(LEAST_FILM_COSINE));
            let (eta, k) = (terms.eta, terms.k);
            let behind = mapped!([(eta.x, k.x), (eta.y, k.y), (eta.z, k.z)], |(eta, k)| admittances(cosine, eta, k));
            let filmed = Vec3::ONE - entered(&terms.film, cosine, behind);
            bare.mix(filmed.at_least_zero(), terms.film.weight)
        })
    }

    /// The change by the film of what a metal known by its colours reflects: its loss is scaled as that of the complex index.
    fn film_on_metal<T: Real>(terms: &FresnelTerms<T>, cosine: T) -> Vec3<T> {
        let (f0, edge) = (terms.metal_f0, terms.edge_tint);
        let behind = mapped!([(f0.x, edge.x), (f0.y, edge.y), (f0.z, edge.z)], |(f0, edge)| {
            let [eta, k] = index_of_colors(f0, edge);
            admittances(cosine, eta, k)
        });
        let filmed = entered(&terms.film, cosine, behind);
        let [x, y, z] = mapped!([behind[0], behind[1], behind[2]], |behind| {
            entered_bare(cosine, behind).max(T::from_f64(FILM_TINY))
        });
        let scale = vec3(filmed.x / x, filmed.y / y, filmed.z / z);
        let reflected = fresnel_metal(f0, edge, cosine);
        let lost = Vec3::ONE - reflected;
        ((lost - lost * scale) * terms.film.weight + reflected).at_least_zero() - reflected
    }

    /// Real and imaginary part of the index of a metal that reflects `f0` at normal incidence, with the edge's tint.
    pub fn index_of_colors<T: Real>(f0: T, edge: T) -> [T; 2] {
        let one = T::ONE;
        let r = f0.min(T::from_f64(LARGEST_FILM_F0));
        let root = r.sqrt();
        let eta = edge * (one - r) / (one + r) + (one - edge) * (one + root) / (one - root);
        let square = ((eta + one) * (eta + one) * r - (eta - one) * (eta - one)) / (one - r);
        [eta, square.safe_sqrt()]
    }

    /// Admittances of a medium of a complex index.
    fn admittances<T: Real>(cosine: T, eta: T, k: T) -> Behind<T> {
        let two = T::TWO;
        let [x, y] = [refracted_square(cosine, eta) - k * k, two * eta * k];
        // The root of x + iy, without cancellation.
        let leg = (T::HALF * ((x * x + y * y).sqrt() + x.abs())).sqrt();
        let other = T::HALF * y / leg.max(T::from_f64(FILM_TINY));
        let is_below = x.below_zero();
        let [re, im] = [T::select(is_below, other, leg), T::select(is_below, leg, other)];
        // Over the squared index for the other polarisation.
        let [square, twice] = [(eta - k) * (eta + k), two * eta * k];
        let size = eta * eta + k * k;
        let scale = T::ONE / (size * size).max(T::from_f64(FILM_TINY));
        Behind {
            perpendicular: [re, im],
            parallel: [
                ((re * square + im * twice) * scale).max(T::ZERO),
                (im * square - re * twice) * scale,
            ],
        }
    }

    /// The share of unpolarised light that enters the media behind a film, by channel.
    fn entered<T: Real>(film: &FilmTerms<T>, cosine: T, behind: [Behind<T>; 3]) -> Vec3<T> {
        // Beyond the film's own critical angle it counts as one that light just grazes.
        let square = refracted_square(cosine, film.ior).max(T::ZERO);
        let (height, index_square) = (square.sqrt(), film.ior * film.ior);
        let channel = |path: T, behind: Behind<T>| {
            vectorized!(T, {
                let phase = path * height;
                let is_small = phase.less(T::from_f64(0.0001));
                let across = path * T::select(is_small, T::ONE, phase.sin() / phase.max(T::from_f64(FILM_TINY)));
                let along = phase.cos();
                let mut damping = T::ONE;
                if film.has_bands {
                    let beyond = (phase - T::from_f64(UNBANDED_PHASE)).max(T::ZERO);
                    damping = (beyond * T::from_f64(-2.0 * BAND_WIDTH)).exp();
                }
                let perpendicular = entered_polarised(cosine, behind.perpendicular, square, [along, across], damping);
                let square = square / (index_square * index_square);
                let across = across * index_square;
                let parallel = entered_polarised(cosine, behind.parallel, square, [along, across], damping);
                T::HALF * (perpendicular + parallel)
            })
        };
        let [x, y, z] = behind;
        vec3(
            channel(film.path.x, x),
            channel(film.path.y, y),
            channel(film.path.z, z),
        )
    }

    /// The same without a film.
    fn entered_bare<T: Real>(cosine: T, behind: Behind<T>) -> T {
        let (zero, one) = (T::ZERO, T::ONE);
        let [perpendicular, parallel] =
            mapped!([behind.perpendicular, behind.parallel], |behind| {
                entered_polarised(cosine, behind, zero, [one, zero], one)
            });
        T::HALF * (perpendicular + parallel)
    }

    /// The share of one polarisation that enters. `film_square` is the film's squared admittance; then the cosine of its phase,
    /// and its sine over the admittance; last the damping of each further way there and back, 1 for one wavelength.
    fn entered_polarised<T: Real>(
        before: T,
        behind: [T; 2],
        film_square: T,
        [along, across]: [T; 2],
        damping: T,
    ) -> T {
        let [re, im] = behind;
        let [sum, product] = [before + re, before * re + film_square];
        let x = sum * along + before * im * across;
        let y = im * along - product * across;
        let square = x * x + y * y;
        let entered = T::from_f64(4.0) * before * re;
        let sharp = entered / square.max(T::from_f64(FILM_TINY));
        let is_damped = damping.less(T::ONE);
        if !is_damped.any() {
            return sharp;
        }
        // The mean of the square over all phases, and of the share's denominator.
        let far = before * im;
        let level = T::HALF * (sum * sum + im * im + (product * product + far * far) / film_square);
        let mean = (sum * product + far * im) / film_square.sqrt();
        let [lost, fade] = [T::ONE - damping, T::ONE - damping * damping];
        let denominator = T::TWO * damping * square + lost * lost * level + fade * mean;
        T::select(is_damped, entered * (fade * level / mean + T::TWO - fade) / denominator, sharp)
    }

    /// The cosine at which a facet reflects as a lobe does on average, from its albedo under the factors 1 − (1 − c)⁵ and
    /// (1 − c)⁵; and its albedo under 1.
    pub fn mean_facet<T: Real>([constant, grazing]: [T; 2]) -> [T; 2] {
        let energy = constant + grazing;
        let share = (grazing / energy.max(T::from_f64(FILM_TINY))).clamp(T::ZERO, T::ONE);
        let cosine = T::ONE - share.max(T::from_f64(FILM_TINY)).powf(T::from_f64(0.2));
        [cosine, energy]
    }
}

/// True where a film changes what a model reflects: not where everything is reflected at any angle.
pub fn has_film(model: Fresnel, weight: f32, thickness_um: f32) -> bool {
    model != Fresnel::None && weight > 0.0 && thickness_um > 0.0
}
