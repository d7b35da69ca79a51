//! A layer of small fibres over everything else: OpenPBR's fuzz. Source: Zeltner, Burley and Chiang, "Practical multiple-scattering
//! sheen using linearly transformed cosines" (2022), with the rational fits of MaterialX 1.39 in place of its table.
//!
//! Its lobe is a cosine that a matrix of the view stretches, drawn exactly; its albedo R is fitted. What it does not reflect
//! reaches the layers below: fuzz + (1 − R) · below, so that no energy is created. It is absent from within a solid.

use super::base::base_shape;
use super::*;
use crate::optics::{
    frame::{frame_from_tangent, local_from_world, world_from_local},
    lobe::raw_sample,
    numeric::normalize_or,
};
use std::f64::consts::{FRAC_1_PI, TAU};

/// The least roughness that the fits are for.
pub const FUZZ_ROUGHNESS_MIN: f64 = 0.01;

/// The fuzz that a sheen of Charlie's distribution looks like, glTF's and Standard Surface's: weight, tint and roughness of
/// its colour, linear RGB in [0, 1], and the root of its α. Least squares over the albedos of views from 0° to 87°, which
/// differ by at most 0.1 from a root of 0.3.
pub fn fuzz_of_sheen(color: [f32; 3], root_of_alpha: f32) -> (f32, [f32; 3], f32) {
    let weight = color.iter().fold(0.0, |most: f32, x| most.max(*x)).min(1.0);
    let tint = color.map(|x| {
        if weight > 0.0 {
            (x / weight).clamp(0.0, 1.0)
        } else {
            1.0
        }
    });
    let [least, slope] = SHEEN_MATCH;
    (weight, tint, (least + slope * root_of_alpha).clamp(0.0, 1.0))
}

/// The root of the α of the sheen that looks like a fuzz: [`fuzz_of_sheen`] backwards.
pub fn sheen_of_fuzz(roughness: f32) -> f32 {
    let [least, slope] = SHEEN_MATCH;
    ((roughness - least) / slope).clamp(0.0, 1.0)
}

/// Roughness of the fuzz at a root of α of 0, and its slope.
const SHEEN_MATCH: [f32; 2] = [0.29, 0.52];

#[derive(Debug)]
pub struct Fuzz;

impl<T: Real> LayerModel<T> for Fuzz {
    const LAYER: Layer = Layer::Fuzz;
    const IS_COVER: bool = true;

    inlined! {
        fn is_there(material: &Material<T>, surface: &Surface<T>) -> T::Mask {
            material.fuzz_weight.above_zero() & !surface.is_within(material)
        }

        /// Lambert's lobe, whose samples the matrix turns.
        fn lobe<'a>(material: &Material<T>, _: &'a [f32], surface: &Surface<T>) -> LayerLobe<'a, T> {
            LayerLobe {
                shape: base_shape(),
                frame: fuzz_frame(material, surface),
            }
        }

        fn albedo(material: &Material<T>, _: &[f32], surface: &Surface<T>, _: Vec3<T>) -> LayerAlbedo<T> {
            let share = material.fuzz_weight * fuzz_reflectance(material, fuzz_normal(material, surface).dot(surface.wo));
            LayerAlbedo {
                reflected: material.fuzz_color * share,
                transmittance: Vec3::splat(T::ONE - share),
            }
        }

        fn toward(_: &Material<T>, layers: &Layers<T>, _: &Surface<T>, _: &LobeShape<'_, T>, _: Vec3<T>) -> LayerToward<T> {
            let share = &layers[Layer::Fuzz];
            LayerToward {
                color: share.albedo,
                probability: share.probability,
            }
        }

        fn refined_sample(material: &Material<T>, surface: &Surface<T>, xi: [T; 3], _: LobeSample<T>) -> LobeSample<T> {
            let frame = fuzz_frame(material, surface);
            let [stretch, lean] = fuzz_matrix(material, frame.normal.dot(surface.wo));
            let cosine = local_from_world(&frame, raw_sample(&base_shape(), &frame, surface.wo, xi));
            let up = vec3(T::ZERO, T::ZERO, T::ONE);
            let bent = normalize_or(
                vec3((cosine.x - lean * cosine.z) / stretch, cosine.y / stretch, cosine.z),
                up,
            );
            let raw = world_from_local(&frame, bent);
            let below = surface.normal.dot(raw).below_zero();
            LobeSample {
                wi: Vec3::select(below, raw.reflected_at_plane(surface.normal), raw),
                weight: T::ONE,
            }
        }

        fn refined(material: &Material<T>, surface: &Surface<T>, wi: Vec3<T>, _: [T; 2]) -> [T; 2] {
            let frame = fuzz_frame(material, surface);
            let matrix = fuzz_matrix(material, frame.normal.dot(surface.wo));
            let folded = wi.reflected_at_plane(surface.normal);
            let [there, folded] = mapped!([wi, folded], |light| fuzz_density(matrix, local_from_world(&frame, light)));
            let is_above = surface.normal.dot(wi).above_zero();
            let density = (there + folded).masked(is_above);
            [density; 2]
        }
    }
}

inlined! {
    /// The normal between the coat's and that of what lies below, by the coat's weight (OpenPBR 1.1).
    fn fuzz_normal<T: Real>(material: &Material<T>, surface: &Surface<T>) -> Vec3<T> {
        let normal = surface.frame.normal;
        let mixed = normalize_or(normal.mix(surface.coat_normal, material.coat_weight), normal);
        Vec3::select(material.coat_weight.above_zero(), mixed, normal)
    }

    /// The frame with the view in the half plane of the tangent.
    fn fuzz_frame<T: Real>(material: &Material<T>, surface: &Surface<T>) -> Frame<T> {
        frame_from_tangent(fuzz_normal(material, surface), surface.wo, T::ZERO)
    }

    /// What the matrix stretches the tangent plane by, and what it adds of the height along the view.
    fn fuzz_matrix<T: Real>(material: &Material<T>, cosine: T) -> [T; 2] {
        let number = T::from_f64;
        let (x, y) = (cosine.clamp(T::ZERO, T::ONE), material.fuzz_roughness);
        let stretch = (number(2.58126) * x + number(0.813703) * y) * y
            / (T::ONE + number(0.310327) * x * x + number(2.60994) * x * y);
        let divisor = number(0.0000254053) + number(1.71228) * x - number(1.71506) * x * y + number(1.34174) * y;
        let lean = (T::ONE - x).safe_sqrt() * (y - T::ONE) * y * y * y / divisor;
        [stretch, lean]
    }

    /// Density of the lobe in a direction in the frame of [`fuzz_frame`].
    fn fuzz_density<T: Real>([stretch, lean]: [T; 2], wi: Vec3<T>) -> T {
        let straight = vec3(stretch * wi.x + lean * wi.z, stretch * wi.y, wi.z);
        let ratio = stretch / straight.dot(straight);
        wi.z.max(T::ZERO) * T::from_f64(FRAC_1_PI) * ratio * ratio
    }

    /// Albedo R of fuzz of weight 1 for a view.
    fn fuzz_reflectance<T: Real>(material: &Material<T>, cosine: T) -> T {
        let [middle, width, floor] = fuzz_bell(material.fuzz_roughness);
        let off = (cosine.clamp(T::ZERO, T::ONE) - middle) / width;
        let bell = (T::from_f64(-0.5) * off * off).exp() / (width * T::from_f64(TAU.sqrt()));
        (bell + floor).clamp(T::ZERO, T::ONE)
    }

    /// Middle, width and floor of the albedo's bell over the view's cosine, by the roughness.
    fn fuzz_bell<T: Real>(y: T) -> [T; 3] {
        let number = T::from_f64;
        let square = number(1.7932) - number(0.95943) * y * y;
        let middle = y * (number(-0.193854) + y * (number(-1.14885) + y * square)) / (number(0.046391) + y);
        let width = y * (number(0.0206607) + number(1.58491) * y) / (number(0.0379424) + y * (number(1.32227) + y));
        let floor = y * (number(0.000654023) + (number(-0.0207818) + number(0.119681) * y) * y)
            / (number(1.26264) + y * (number(-1.92021) + y));
        [middle, width, floor]
    }
}
