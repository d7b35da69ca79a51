//! What the Fresnel factor is computed from, and the reflectances of metals known by colours: what films on them need too.

use super::refraction::refracted_square;
use crate::named::named;
use crate::optics::prelude::*;

named! {
    Fresnel {
        None = 0, "none", "None", "Every sample counts fully: F = 1 at any angle, tinted by the specular colour.";
        Schlick = 1, "schlick", "Schlick", "Schlick's approximation from the reflectance at normal incidence.";
        Dielectric = 2, "dielectric", "Dielectric", "The exact equations for glass, water, plastic, lacquer, from the index of refraction.";
        Conductor = 3, "conductor", "Conductor", "The exact equations for metals, from η and k of each colour channel.";
    }
}

/// Parameters of the Fresnel factor, besides the angle.
#[derive(Clone, Copy, Debug)]
pub struct FresnelTerms<T> {
    /// Equation of the Fresnel factor.
    pub model: Fresnel,
    /// Reflectance at normal incidence of the metal, linear RGB.
    pub metal_f0: Vec3<T>,
    /// 0 for a dielectric, 1 for a metal.
    pub metalness: T,
    /// Tint, linear RGB: of the reflectance at normal incidence in Schlick's model for a dielectric, else of the whole
    /// factor; what goes through is untinted.
    pub tint: Vec3<T>,
    /// Factor of a metal's reflection: tint times weight, or 1 if those spare metals.
    pub metal_tint: Vec3<T>,
    /// Factor of a metal's reflection near 82 degrees; 1 for none.
    pub edge_tint: Vec3<T>,
    /// Share of the reflection that is kept at any angle, in [0, 1]; a metal's is in `metal_tint`.
    pub weight: T,
    /// Relative index of refraction of the dielectric.
    pub ior: T,
    /// Conductor: real part of the index of refraction a channel.
    pub eta: Vec3<T>,
    /// Conductor: imaginary part a channel, not negative.
    pub k: Vec3<T>,
    /// Index of what lies over a conductor or a film, into which light from outside is refracted first; 1 of air.
    pub before: T,
    /// True where the surface has a thin film.
    pub has_film: bool,
    pub film: FilmTerms<T>,
}

impl<T: Real> FresnelTerms<T> {
    /// True where a dielectric and a metal are mixed.
    pub fn has_parts(&self) -> bool {
        matches!(self.model, Fresnel::Schlick | Fresnel::Dielectric)
    }

    inlined! {
        /// The cosine at which light meets a conductor or a film: within what lies over it.
        pub fn cosine_in_coat(&self, cosine: T) -> T {
            let there = (refracted_square(cosine, self.before).safe_sqrt() / self.before).min(T::ONE);
            T::select(self.before.differs(T::ONE), there, cosine)
        }

        /// The same without a tint of the exact equations, which is the reflection's alone. Schlick's tint is the reflectance
        /// head-on itself.
        pub fn untinted(&self) -> Self {
            let tint = if self.model == Fresnel::Dielectric { Vec3::ONE } else { self.tint };
            Self { tint, ..*self }
        }

        /// The same without metal.
        pub fn of_dielectric(&self) -> Self {
            let metalness = T::ZERO;
            Self { metalness, ..*self }
        }
    }
}

/// A film as the Fresnel factor sees it.
#[derive(Clone, Copy, Debug)]
pub struct FilmTerms<T> {
    /// Share of the surface that has the film.
    pub weight: T,
    /// Index of refraction over that of the medium before it.
    pub ior: T,
    /// Index of the dielectric behind it over that of the medium before it.
    pub behind: T,
    /// Phase of a crossing at normal incidence over the relative index, by channel.
    pub path: Vec3<T>,
    /// Whether each channel is a band of wavelengths where the film is thick.
    pub has_bands: bool,
}

impl<T: Real> FilmTerms<T> {
    /// None, in air over a dielectric of this index.
    #[inline(always)]
    pub fn none_over(behind: T) -> Self {
        Self {
            weight: T::ZERO,
            ior: T::ONE,
            behind,
            path: Vec3::ZERO,
            has_bands: false,
        }
    }
}

inlined! {
    /// Schlick's approximation (1994).
    pub fn fresnel_schlick<T: Real>(f0: Vec3<T>, cosine: T) -> Vec3<T> {
        let x = (T::ONE - cosine).clamp(T::ZERO, T::ONE);
        let x2 = x * x;
        let grazing = x2 * x2 * x;
        f0 + (Vec3::ONE - f0) * grazing
    }

    /// The reflectance of a metal that is `f0` at normal incidence: Schlick's, darkened near 82 degrees by `edge_tint` (the
    /// F82-tint model: Kutz, Hasan and Edmondson, "Novel aspects of the Adobe Standard Material", 2021; OpenPBR 1.1).
    pub fn fresnel_metal<T: Real>(f0: Vec3<T>, edge_tint: Vec3<T>, cosine: T) -> Vec3<T> {
        let plain = fresnel_schlick(f0, cosine);
        let is_tinted = (edge_tint.x + edge_tint.y + edge_tint.z).less(T::from_f64(3.0));
        if !is_tinted.any() {
            return plain;
        }
        let darkening = edge_darkening(f0, edge_tint) * edge_shape(cosine);
        Vec3::select(is_tinted, (plain - darkening).at_least_zero(), plain)
    }

    /// Factor of [`edge_shape`] that leaves exactly the tint at a cosine of 1/7.
    pub fn edge_darkening<T: Real>(f0: Vec3<T>, edge_tint: Vec3<T>) -> Vec3<T> {
        let seventh = T::from_f64(1.0 / 7.0);
        let white = Vec3::ONE;
        fresnel_schlick(f0, seventh) * (white - edge_tint) * (T::ONE / edge_shape(seventh))
    }

    /// Angular shape of the darkening towards the edge: cosθ (1 − cosθ)⁶, largest at a cosine of 1/7.
    pub fn edge_shape<T: Real>(cosine: T) -> T {
        let c = cosine.clamp(T::ZERO, T::ONE);
        let x = T::ONE - c;
        let x2 = x * x;
        c * x2 * x2 * x2
    }
}
