//! Multiple scattering between facets: single scattering loses the light that meets a second facet. A factor of the view
//! gives it back, so that no new direction is needed (Turquin, "Practical multiple scattering compensation for microfacet
//! models", 2019). How much, and whether it is reflected or refracted, is fitted to random walks between facets (Heitz,
//! Hanika, d'Eon and Dachsbacher, "Multiple-scattering microfacet BSDFs with the Smith model", 2016).
//!
//! A metal's lobe is multiplied by 1 + x (1 − E)/E, E being the energy that the lobe keeps with F = 1: a white metal
//! reflects all light. What a clear interface loses goes on; from within most of it is reflected, by the facets as far as that
//! doubles what they reflect once, beyond in all directions. The base below a dielectric takes what its lobe loses, so that
//! needs no factor.

use super::{
    albedo::{
        ALBEDO_LENGTH, ALBEDO_NODES, ROUGH_ALBEDO_LENGTH, ROUGHNESS_NODES, albedo_number, node_turn,
        rough_albedo_number, table_row, view_at,
    },
    frame::local_from_world,
    fresnel::{FresnelTerms, fresnel, fresnel_dielectric, fresnel_f0, fresnel_parts, fresnel_transmitted},
    lanes::{InLanes, in_lanes},
    lobe::{LobeShape, ggx::visible_normal, microfacet_alpha, stretch_from_anisotropy},
    material::{COMPENSATES, Material, Surface},
    microfacet::{Alpha, smith_g1_over_cosine, smith_g2_over_cosine},
    random::even_point,
    refraction::refracted,
    thin_film::film_passed,
};
use crate::optics::prelude::*;
use crate::{instructions::level, parallel};

inlined! {
    /// The share that single scattering has of what a clear interface refracts, linear RGB; or the last number of its table,
    /// see [`scattering_table`]. A film shares the light otherwise in each channel.
    pub fn interface_kept<T: Real>(
        material: &Material<T>,
        surface: &Surface<T>,
        shape: &LobeShape<'_, T>,
        is_reflected: bool,
    ) -> Vec3<T> {
        if !material.has_flag(COMPENSATES) {
            return Vec3::ONE;
        }
        let first = channel_kept(material, surface, shape, is_reflected, 0);
        if material.has_film == 0 {
            return Vec3::splat(first);
        }
        let [second, third] = mapped!([1, 2], |channel| channel_kept(
            material,
            surface,
            shape,
            is_reflected,
            channel
        ));
        vec3(first, second, third)
    }

    fn channel_kept<T: Real>(
        material: &Material<T>,
        surface: &Surface<T>,
        shape: &LobeShape<'_, T>,
        is_reflected: bool,
        channel: usize,
    ) -> T {
        if is_reflected {
            return kept_energy_of(material, surface, shape, [channel, 3]);
        }
        let [outside, inside] = mapped!([1, 2], |number| {
            kept_energy_of(material, surface, shape, [channel, number])
        });
        T::select(surface.is_within(material), inside, outside)
    }

    /// Lanes where what facets reflect more than once goes back into the solid in all directions, by the lobe of the base.
    pub fn scatters_within<T: Real>(material: &Material<T>, surface: &Surface<T>) -> T::Mask {
        T::Mask::splat(material.has_flag(COMPENSATES)) & surface.is_within(material)
    }

    /// The share of light that [`scatters_within`], linear RGB.
    pub fn scattered_within<T: Real>(
        material: &Material<T>,
        surface: &Surface<T>,
        shape: &LobeShape<'_, T>,
    ) -> Vec3<T> {
        let again = Vec3::ONE - interface_kept(material, surface, shape, true) * T::TWO;
        again.at_least_zero().masked(scatters_within(material, surface))
    }

    /// The share that the specular lobe reflects at a half vector, linear RGB, with what its facets scatter more than once;
    /// `once` is its Fresnel factor.
    pub fn scattered_again<T: Real>(
        material: &Material<T>,
        surface: &Surface<T>,
        shape: &LobeShape<'_, T>,
        terms: &FresnelTerms<T>,
        cosine: T,
        once: Vec3<T>,
    ) -> Vec3<T> {
        if !material.has_flag(COMPENSATES) {
            return once;
        }
        out_of_line!(T, compensated(material, surface, shape, terms, cosine))
    }

    /// [`scattered_again`] of a lobe that is compensated.
    fn compensated<T: Real>(
        material: &Material<T>,
        surface: &Surface<T>,
        shape: &LobeShape<'_, T>,
        terms: &FresnelTerms<T>,
        cosine: T,
    ) -> Vec3<T> {
        let (white, one) = (Vec3::ONE, T::ONE);
        let kept = kept_energy_of(material, surface, shape, [0, 0]);
        let gain = |head_on, grazing| facet_gain(head_on, grazing, kept, surface.view_cosine());
        if !terms.has_parts() {
            return fresnel(terms, cosine) * white.mix(gain(fresnel(terms, one), terms.metal_tint), terms.metalness);
        }
        let [dielectric, metal] = fresnel_parts(terms, cosine);
        let mut head_on = terms.metal_f0 * terms.metal_tint;
        if terms.has_film {
            head_on = fresnel_parts(terms, one)[1];
        }
        // The refracting share of a dielectric is clear; the rest lies over a base. An index of 1 lets all else go straight on.
        let is_within = surface.is_within(material);
        let mut clear = gain(Vec3::splat(fresnel_f0(terms.ior)), white);
        if is_within.any() {
            let within = interface_kept(material, surface, shape, true).map(|kept| one / kept.max(T::HALF));
            clear = Vec3::select(is_within, within, clear);
        }
        let share = material.transmission_weight.masked(material.ior.differs(one));
        let dielectric = dielectric * white.mix(clear, share);
        dielectric.mix(metal * gain(head_on, terms.metal_tint), terms.metalness)
    }

    /// Factor by which facets reflect more than once does, where they keep this share of the light with F = 1; `head_on` and
    /// `grazing` reflectances, the view's cosine. Of the light that meets facets again a part leaves each time.
    pub fn facet_gain<T: Real>(head_on: Vec3<T>, grazing: Vec3<T>, kept: T, cosine: T) -> Vec3<T> {
        let (one, leaves) = (T::ONE, kept.sqrt());
        let slant = T::from_f64(0.45) - T::from_f64(0.2) * cosine;
        // A tint may be above 1.
        let mean = head_on.mix(grazing, kept * leaves * slant).map(|mean| mean.min(one));
        let again = mean.map(|mean| mean * leaves / (one - mean * (one - leaves)));
        Vec3::ONE + again * ((one - kept) / kept)
    }

    /// The cosine at which a lobe's table is read: of a table over the roughness of a stretched lobe, which is a mean over
    /// azimuths, that of a view to which the mean lobe is as wide as this one is to this view. Facets hide others by that.
    fn kept_cosine<T: Real>(material: &Material<T>, surface: &Surface<T>) -> T {
        if material.is_over_azimuth() || !material.anisotropy.differs(T::ZERO).any() {
            return surface.view_cosine();
        }
        let stretch = stretch_from_anisotropy(material.anisotropy);
        let [wide, narrow] = [stretch, T::ONE / stretch];
        let wo = local_from_world(&surface.frame, surface.wo);
        vec3(wo.x * wide, wo.y * narrow, wo.z * T::HALF * (wide + narrow)).normalize().z
    }

    /// A share that single scattering has of the light for a view: a number in a channel's table, as in [`scattering_table`].
    fn kept_energy_of<T: Real>(
        material: &Material<T>,
        surface: &Surface<T>,
        shape: &LobeShape<'_, T>,
        [channel, number]: [usize; 2],
    ) -> T {
        let place = kept_cosine(material, surface).safe_sqrt();
        if material.has_rough_tables != 0 {
            let table = (channel * ROUGH_ALBEDO_LENGTH) as u32;
            return rough_albedo_number(shape.table, table, number, [place, table_row(material, surface)]);
        }
        albedo_number(shape.table, (channel * ALBEDO_LENGTH) as u32, number, place)
    }
}

/// The least energy of a table: no lobe keeps less, but few samples may find none, and the gain is one over it.
const LEAST_KEPT: f64 = 0.01;

/// Table of the shares that single scattering has of a material's light, over the root of the view's cosine, and over the
/// roughness or the azimuth if its albedo tables are: of what a white metal reflects, of what a clear interface refracts from
/// outside and from within, and of what that reflects from within. Facets there reflect up to twice as much as once. If that
/// is not all, the last number is a half less half the share that [`scatters_within`]. One for each channel follows the
/// other where a film shares the light of an interface. `samples` per node.
pub fn scattering_table(material: &Material<f64>, samples: u32) -> Vec<f32> {
    let is_over_azimuth = material.is_over_azimuth();
    let is_rough = material.has_rough_tables != 0 && !is_over_azimuth;
    let steps = if material.has_rough_tables == 0 {
        1
    } else {
        ROUGHNESS_NODES
    };
    let offset = material.transmission_roughness - material.roughness;
    let points = Points::new(samples);
    let energies = |index: usize| {
        let (step, node) = (index / ALBEDO_NODES, index % ALBEDO_NODES);
        let roughness = match is_rough {
            true => step as f64 / (ROUGHNESS_NODES - 1) as f64,
            false => material.roughness,
        };
        let material = Material {
            roughness,
            transmission_roughness: (roughness + offset).clamp(0.0, 1.0),
            ..*material
        };
        let place = node as f64 / (ALBEDO_NODES - 1) as f64;
        // At exactly grazing the microfacet lobes are 0/0.
        let cosine = (place * place).max(0.0001);
        let means = in_lanes(
            level(),
            Kept {
                alpha: microfacet_alpha(&material.shape(&[])),
                clear: material.transmits().then_some(&material),
                cosine,
                turn: is_over_azimuth.then(|| node_turn(step, material.anisotropy)),
                points: &points,
            },
        );
        [0, 1, 2].map(|channel| kept_shares(&material, cosine, means.map(|sums| sums.to_f64()[channel])))
    };
    let energies: Vec<_> = parallel::map(steps * ALBEDO_NODES, energies);
    let channels = if material.has_film == 1 && material.transmits() {
        3
    } else {
        1
    };
    let table = |channel: usize| energies.iter().flat_map(move |of_node| of_node[channel]);
    (0..channels).flat_map(table).collect()
}

/// The numbers of [`scattering_table`] from the means of [`Kept`].
fn kept_shares(
    material: &Material<f64>,
    cosine: f64,
    [metal, passed, outer, inner_passed, inner, met]: [f64; 6],
) -> [f32; 4] {
    // From within, facets let through what they refract and a part of what is lost; the rest is reflected.
    let lost = (1.0 - inner - inner_passed).max(0.0);
    let again = 2.0 * inner_passed.powf(1.4) - 2.23 * met.powf(0.75) * (1.0 - met).powf(2.3);
    let through = inner_passed + material.roughness.powf(3.3) * lost * again;
    let through = through.max(0.665 * inner_passed);
    let reflected = match material.ior == 1.0 {
        true => inner,
        false => (1.0 - through).max(inner / (inner + inner_passed).max(1.0)),
    };
    let head_on = Vec3::splat(fresnel_f0(material.fresnel_terms(false).ior));
    let outer = outer * facet_gain(head_on, Vec3::ONE, metal.max(LEAST_KEPT), cosine).x;
    let tiny = f64::MIN_POSITIVE;
    let shares = [
        metal,
        passed / (1.0 - outer).max(tiny),
        inner_passed / (1.0 - reflected).max(tiny),
    ];
    let [metal, outside, inside] = shares.map(|share| share.max(LEAST_KEPT));
    let within = match reflected > 2.0 * inner {
        true => 0.5 * (1.0 + 2.0 * inner - reflected),
        false => inner.max(tiny) / reflected.max(tiny),
    };
    [metal, outside, inside, within].map(|x| x as f32)
}

/// The energy that single scattering of GGX keeps with F = 1, for a view of this cosine to the normal.
pub fn kept_energy(alpha: Alpha<f64>, cosine: f64, samples: u32) -> f64 {
    let points = &Points::new(samples);
    let kept = Kept {
        alpha,
        clear: None,
        cosine,
        turn: None,
        points,
    };
    in_lanes(level(), kept)[0].x
}

/// Points of the unit cube, coordinate by coordinate, in f32 as lanes load them.
struct Points([Vec<f32>; 3]);

impl Points {
    /// As many as asked for, filled up to whole lanes: two for the facets, one for the view's azimuth.
    fn new(samples: u32) -> Self {
        const LANES_MAX: u32 = 16;
        let count = samples.next_multiple_of(LANES_MAX);
        let of = |number: usize| (0..count).map(|index| even_point(index)[number] as f32).collect();
        Self([of(0), of(1), of(3)])
    }
}

/// Energies that single scattering of GGX keeps for a view of this cosine, linear RGB: of a white metal; what a clear
/// interface refracts and reflects from outside, and from within; what the facets met from within reflect, seen or not.
struct Kept<'a> {
    alpha: Alpha<f64>,
    /// The material of the clear interface, where there is one.
    clear: Option<&'a Material<f64>>,
    cosine: f64,
    /// Share of a turn of the view over a stretched lobe; `None` for the mean over all.
    turn: Option<f64>,
    points: &'a Points,
}

impl InLanes for Kept<'_> {
    type Output = [Vec3<f64>; 6];

    fn run<T: Single>(self) -> Self::Output {
        vectorized!(T, self.means::<T>())
    }
}

impl Kept<'_> {
    #[inline(always)]
    fn means<T: Single>(&self) -> [Vec3<f64>; 6] {
        let Points([across, up, azimuths]) = self.points;
        let count = across.len();
        let alpha = cast::<T>(self.alpha);
        let is_stretched = self.alpha.x != self.alpha.y;
        let interface = self.clear.map(Interface::<T>::of);
        let cosine = T::from_f64(self.cosine);
        let mut sums = [Vec3::ZERO; 6];
        let mut first = 0;
        while first < count {
            let xi = [T::load(&across[first..]), T::load(&up[first..]), T::ZERO];
            let wo = match (is_stretched, self.turn) {
                (true, None) => view_at(cosine, T::load(&azimuths[first..])),
                (_, turn) => view_at(cosine, T::from_f64(turn.unwrap_or(0.0))),
            };
            let h = visible_normal(alpha, wo, xi);
            let wi = wo.mirrored_about(h);
            let mirrored = smith_g2_over_cosine(alpha, wo, wi) / smith_g1_over_cosine(alpha, wo);
            add(&mut sums[0], Vec3::splat(mirrored));
            if let Some(Interface {
                through,
                sides,
                is_apart,
            }) = &interface
            {
                let refracting = if *is_apart { visible_normal(*through, wo, xi) } else { h };
                for (number, side) in sides.iter().enumerate() {
                    let film = side.film(wo.dot(h));
                    let met = side.reflected(wo.dot(h), film);
                    let film = if *is_apart { side.film(wo.dot(refracting)) } else { film };
                    add(
                        &mut sums[1 + 2 * number],
                        side.let_through(*through, wo, refracting, film),
                    );
                    add(&mut sums[2 + 2 * number], met * mirrored);
                    if number == 1 {
                        add(&mut sums[5], met);
                    }
                }
            }
            first += T::LANES;
        }
        sums.map(|sum| sum * (1.0 / count as f64))
    }
}

inlined! {
    /// Widths in another precision.
    fn cast<T: Real>(alpha: Alpha<f64>) -> Alpha<T> {
        Alpha {
            x: T::from_f64(alpha.x),
            y: T::from_f64(alpha.y),
        }
    }

    /// Adds lanes one by one in f64: what is summed does not depend on their number.
    fn add<T: Single>(sum: &mut Vec3<f64>, energy: Vec3<T>) {
        let [r, g, b] = [energy.x.to_each(), energy.y.to_each(), energy.z.to_each()];
        for lane in 0..T::LANES {
            *sum += Vec3::from_f32([r[lane], g[lane], b[lane]]);
        }
    }
}

/// A clear interface.
struct Interface<T> {
    /// The widths of what it refracts, …
    through: Alpha<T>,
    /// … and whether they differ from those of what it reflects.
    is_apart: bool,
    /// From outside, and from within.
    sides: [Side<T>; 2],
}

impl<T: Real> Interface<T> {
    #[inline(always)]
    fn of(material: &Material<f64>) -> Self {
        Self {
            through: cast(microfacet_alpha(&material.transmission_shape(&[], false))),
            is_apart: material.transmission_roughness != material.roughness,
            sides: [Side::of(material, false), Side::of(material, true)],
        }
    }
}

/// A clear interface, seen from one side.
struct Side<T> {
    terms: FresnelTerms<T>,
    eta: T,
    /// Under a cover the reflection has another index than the refraction.
    has_one_index: bool,
}

impl<T: Real> Side<T> {
    inlined! {
        fn of(material: &Material<f64>, is_inside: bool) -> Self {
            let has_one_index = material.fresnel_terms(is_inside).ior == material.ior_ahead(is_inside);
            let (material, is_inside) = (material.cast::<T>(), T::Mask::splat(is_inside));
            Self {
                terms: FresnelTerms {
                    tint: Vec3::ONE,
                    ..material.fresnel_terms(is_inside)
                },
                eta: material.ior_ahead(is_inside),
                has_one_index,
            }
        }

        /// What a film lets through more, by channel.
        fn film(&self, cosine: T) -> Vec3<T> {
            if !self.terms.has_film {
                return Vec3::ZERO;
            }
            film_passed(&self.terms, cosine, None)
        }

        /// The share that a facet reflects, under a film that lets this much more through; within [0, 1], as the lobes have it.
        fn reflected(&self, cosine: T, film: Vec3<T>) -> Vec3<T> {
            let share = (Vec3::splat(fresnel_dielectric(cosine, self.terms.ior)) - film) * self.terms.weight;
            share.map(|share| share.clamp(T::ZERO, T::ONE))
        }

        /// The share that a facet with the normal `h` refracts, as far as it is seen behind.
        fn let_through(&self, through: Alpha<T>, wo: Vec3<T>, h: Vec3<T>, film: Vec3<T>) -> Vec3<T> {
            let refracted = refracted(wo, h, self.eta);
            let (zero, one) = (T::ZERO, T::ONE);
            let [before, behind] = [wo.dot(h).clamp(zero, one), (-refracted.wi.dot(h)).clamp(zero, one)];
            let share = match self.has_one_index {
                true => {
                    let passed = Vec3::splat(fresnel_transmitted(before, behind, self.eta)) + film;
                    Vec3::splat(one - self.terms.weight) + passed * self.terms.weight
                }
                false => Vec3::splat(one) - self.reflected(before, film),
            };
            let seen = smith_g1_over_cosine(through, refracted.wi) * refracted.wi.z.abs();
            let is_lost = refracted.is_total | !refracted.wi.z.below_zero();
            share * T::select(is_lost, zero, seen)
        }
    }
}
