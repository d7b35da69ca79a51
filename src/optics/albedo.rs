//! Tabulated albedo of a lobe over the view angle; the rest reaches the layer below.
//!
//! If roughness, metalness or colour vary over the surface, or the surface is partly metal, the table extends over roughness
//! too. It then holds the four integrals of which every Fresnel factor's albedo is a sum ([`rough_albedo`]), for the whole
//! and for the dielectric alone, which covers the base.

use super::{
    frame::{Frame, frame_from_normal},
    fresnel::{
        Fresnel, FresnelTerms, edge_darkening, edge_shape, fresnel, fresnel_dielectric, fresnel_f0, fresnel_schlick,
        half_vector_cosine,
    },
    lobe::{LobeShape, lobe_sample, stretch_from_anisotropy},
    material::{Material, Surface},
    random::even_point,
    refraction::refracted_square,
    table::{NODE_LENGTH, look_up_number, node_below},
    thin_film::{film_change_of_dielectric, film_change_of_metal, mean_facet},
};
use crate::optics::prelude::*;
use crate::parallel;

/// Nodes of an albedo table, equidistant in the cosine of the view.
pub const ALBEDO_NODES: usize = 64;
/// Nodes of a table for views from within that lie below the critical angle, where reflection is total.
pub const TOTAL_NODES: usize = 16;
/// Numbers of an albedo table: red, green, blue and 0 a node.
pub const ALBEDO_LENGTH: usize = NODE_LENGTH * ALBEDO_NODES;
/// Nodes of a rough albedo table over the roughness, equidistant in it.
pub const ROUGHNESS_NODES: usize = 17;
/// Numbers of a rough albedo table: [`ROUGHNESS_NODES`] times the nodes of an albedo table, each four integrals.
pub const ROUGH_ALBEDO_LENGTH: usize = NODE_LENGTH * ROUGHNESS_NODES * ALBEDO_NODES;

inlined! {
    /// Specular albedo, then 0, at position `place` in [0, 1] of a table, linear between its nodes: the view's cosine from outside,
    /// [`albedo_place`] from within.
    pub fn albedo_lookup<T: Real>(tables: &[f32], albedo_table: u32, place: T) -> [T; 4] {
        mapped!([0, 1, 2, 3], |number| albedo_number(tables, albedo_table, number, place))
    }

    /// Table position of a view, in [0, 1]. At the critical angle the albedo of a smooth interface has a vertical tangent: below
    /// it the nodes are equidistant in the view's cosine, above it in that of the refracted direction.
    pub fn albedo_place<T: Real>(cosine: T, eta: T) -> T {
        let critical = (-refracted_square(T::ZERO, eta)).safe_sqrt();
        let share = T::from_f64(TOTAL_NODES as f64 / (ALBEDO_NODES as f64 - 1.0));
        let is_total_somewhere = critical.above_zero();
        if !is_total_somewhere.any() {
            return cosine;
        }
        let square = refracted_square(cosine, eta);
        let above = share + (T::ONE - share) * (square.safe_sqrt() / eta);
        let below = share * (cosine.max(T::ZERO) / critical);
        let place = T::select(square.below_zero(), below, above);
        T::select(is_total_somewhere, place, cosine)
    }
}

/// One number of [`albedo_lookup`].
#[inline(always)]
pub fn albedo_number<T: Real>(tables: &[f32], albedo_table: u32, number: usize, place: T) -> T {
    let [low, beyond] = node_below(place, ALBEDO_NODES);
    let table = &tables[albedo_table as usize..];
    let [left, right] = mapped!([table, &table[NODE_LENGTH..]], |nodes| {
        look_up_number(nodes, number, low)
    });
    left + (right - left) * beyond
}

/// The view's cosine at a node of a table, or between two: [`albedo_place`] backwards.
fn node_cosine(node: f64, eta: f64) -> f64 {
    let [last, total] = [ALBEDO_NODES - 1, TOTAL_NODES].map(|count| count as f64);
    let critical_square = (1.0 - eta * eta).max(0.0);
    if critical_square == 0.0 {
        return node / last;
    }
    if node < total {
        return critical_square.sqrt() * node / total;
    }
    let refracted = (node - total) / (last - total);
    (critical_square + (eta * refracted).powi(2)).sqrt().min(1.0)
}

/// Table of the specular lobe's albedo over the view's cosine, from within or outside, for [`albedo_lookup`]; of a stretched
/// lobe over its azimuth too, for [`rough_albedo_lookup`]. `samples` per node.
pub fn albedo_table(material: &Material<f64>, tables: &[f32], samples: u32, is_inside: bool) -> Vec<f32> {
    let terms = material.fresnel_terms(is_inside);
    table_of(material, tables, samples, is_inside, |cosine| {
        color_node(fresnel(&terms, cosine))
    })
}

inlined! {
    /// A view of this cosine to the normal, in the surface's frame; turned about the normal by a share of a whole turn.
    pub fn view_at<T: Real>(cosine: T, turn: T) -> Vec3<T> {
        let sine = (T::ONE - cosine * cosine).safe_sqrt();
        let azimuth_rad = T::TAU * turn;
        vec3(sine * azimuth_rad.cos(), sine * azimuth_rad.sin(), cosine)
    }

    /// Table position of a view's azimuth over a stretched lobe, in [0, 1]: the lobe's width towards the view, between the
    /// least and the largest. What the lobe keeps goes with that width.
    pub fn azimuth_place<T: Real>(anisotropy: T, frame: &Frame<T>, wo: Vec3<T>) -> T {
        let stretch = stretch_from_anisotropy(anisotropy);
        let [wide, narrow] = [stretch * stretch, T::ONE / (stretch * stretch)];
        let [x, y] = mapped!([frame.tangent.dot(wo), frame.bitangent.dot(wo)], |x| x * x);
        let width = ((x * wide + y * narrow) / (x + y).max(T::from_f64(1e-30))).sqrt();
        let [least, most] = [wide.min(narrow).sqrt(), wide.max(narrow).sqrt()];
        (width - least) / (most - least).max(T::from_f64(1e-6))
    }

    /// The row of a material's tables that extend over roughness or azimuth, in [0, 1].
    pub fn table_row<T: Real>(material: &Material<T>, surface: &Surface<T>) -> T {
        match material.is_over_azimuth() {
        true => azimuth_place(material.anisotropy, &surface.frame, surface.wo),
        false => material.roughness,
    }
    }
}

/// The share of a turn at a step of such a table: [`azimuth_place`] backwards.
pub fn node_turn(step: usize, anisotropy: f64) -> f64 {
    let stretch = stretch_from_anisotropy(anisotropy);
    let [least, most] = [stretch.min(1.0 / stretch), stretch.max(1.0 / stretch)];
    let width = least + (most - least) * step as f64 / (ROUGHNESS_NODES - 1) as f64;
    let along = (width * width - 1.0 / (stretch * stretch)) / (stretch * stretch - 1.0 / (stretch * stretch));
    along.clamp(0.0, 1.0).sqrt().acos() / std::f64::consts::TAU
}

/// Mean over a lobe, at a table node, of its weight times `factors` of the half vector's cosine; of a stretched lobe at this
/// turn of the view, or over all.
fn node_means(
    node: f64,
    turn: Option<f64>,
    is_inside: bool,
    material: &Material<f64>,
    shape: &LobeShape<'_, f64>,
    samples: u32,
    factors: impl Fn(f64) -> [f64; 4],
) -> [f64; 4] {
    let normal = vec3(0.0, 0.0, 1.0);
    let frame = frame_from_normal(normal);
    let eta = if is_inside { material.ior_ahead(true) } else { 1.0 };
    // At exactly grazing the microfacet lobes are 0/0.
    let cosine = node_cosine(node, eta).max(0.001);
    let is_stretched = shape.anisotropy != 0.0;
    let mut sums = [0.0; 4];
    for i in 0..samples {
        let [a, b, c, any_turn] = even_point(i);
        let wo = view_at(cosine, if is_stretched { turn.unwrap_or(any_turn) } else { 0.0 });
        let drawn = lobe_sample(shape, &frame, normal, wo, [a, b, c]);
        let factors = factors(half_vector_cosine(wo, drawn.wi));
        for (sum, factor) in sums.iter_mut().zip(factors) {
            *sum += factor * drawn.weight;
        }
    }
    sums.map(|sum| sum / f64::from(samples))
}

/// Table of a material with varying roughness, metalness or base colour, for [`rough_albedo_lookup`]; `samples` per node.
pub fn rough_albedo_table(material: &Material<f64>, tables: &[f32], samples: u32, is_inside: bool) -> Vec<f32> {
    let terms = material.fresnel_terms(is_inside);
    table_of(material, tables, samples, is_inside, |cosine| {
        fresnel_basis(&terms, cosine)
    })
}

/// Table of what a thin film changes of the dielectric's albedo, untinted, beside that of [`rough_albedo_table`].
pub fn film_table(material: &Material<f64>, tables: &[f32], samples: u32, is_inside: bool) -> Vec<f32> {
    let terms = FresnelTerms {
        tint: Vec3::ONE,
        weight: 1.0,
        ..material.fresnel_terms(is_inside).of_dielectric()
    };
    table_of(material, tables, samples, is_inside, |cosine| {
        color_node(film_change_of_dielectric(&terms, cosine))
    })
}

fn color_node(color: Vec3<f64>) -> [f64; 4] {
    [color.x, color.y, color.z, 0.0]
}

/// Means at the nodes of a table, in rows over the roughness or the azimuth where the material's tables are.
fn table_of(
    material: &Material<f64>,
    tables: &[f32],
    samples: u32,
    is_inside: bool,
    factors: impl Fn(f64) -> [f64; 4] + Sync,
) -> Vec<f32> {
    let steps = if material.has_rough_tables == 0 {
        1
    } else {
        ROUGHNESS_NODES
    };
    // Middles between the nodes, too, where a film makes fringes.
    let parts = if material.has_film == 1 { 2 } else { 1 };
    let places = parts * (ALBEDO_NODES - 1) + 1;
    let means = |index: usize| {
        let mut shape = material.shape(tables);
        let step = index / places;
        let turn = material.is_over_azimuth().then(|| node_turn(step, shape.anisotropy));
        if steps > 1 && turn.is_none() {
            shape.roughness = step as f64 / (ROUGHNESS_NODES - 1) as f64;
        }
        let node = (index % places) as f64 / parts as f64;
        node_means(node, turn, is_inside, material, &shape, samples, &factors)
    };
    let means = parallel::map(steps * places, means);
    let rows = means.chunks(places).flat_map(|row| raised_nodes(row, parts));
    rows.flatten().map(|x| x as f32).collect()
}

/// The nodes of a row of means at every part of a node. Where a middle lies above the line between two nodes, both are
/// raised: what the line leaves out is given to the layers below, which would make light.
fn raised_nodes(row: &[[f64; 4]], parts: usize) -> impl Iterator<Item = [f64; 4]> {
    let above = move |middle: usize, number: usize| match row.get(middle.wrapping_sub(1)..middle.saturating_add(2)) {
        Some([left, there, right]) if parts == 2 => there[number] - 0.5 * (left[number] + right[number]),
        _ => 0.0,
    };
    (0..row.len()).step_by(parts).map(move |node| {
        std::array::from_fn(|number| {
            let rise = above(node.wrapping_sub(1), number).max(above(node + 1, number));
            row[node][number] + rise.max(0.0)
        })
    })
}

/// Basis of the Fresnel factor for any metalness and base colour: the exact dielectric, Schlick's two terms and the
/// darkening towards the edge; or the untinted factor of each channel, then 0.
fn fresnel_basis(terms: &FresnelTerms<f64>, cosine: f64) -> [f64; 4] {
    if !terms.has_parts() {
        let untinted = FresnelTerms {
            tint: Vec3::splat(1.0),
            weight: 1.0,
            ..*terms
        };
        let [r, g, b] = fresnel(&untinted, cosine).to_f64();
        return [r, g, b, 0.0];
    }
    let grazing = fresnel_schlick(Vec3::ZERO, cosine).x;
    [
        fresnel_dielectric(cosine, terms.ior),
        1.0 - grazing,
        grazing,
        edge_shape(cosine),
    ]
}

inlined! {
    /// The four integrals at a `place` as in [`albedo_lookup`] and a roughness, linear between the nodes.
    pub fn rough_albedo_lookup<T: Real>(tables: &[f32], albedo_table: u32, place: T, roughness: T) -> [T; 4] {
        mapped!([0, 1, 2, 3], |number| {
            rough_albedo_number(tables, albedo_table, number, [place, roughness])
        })
    }

    /// One of them.
    pub fn rough_albedo_number<T: Real>(tables: &[f32], albedo_table: u32, number: usize, [place, roughness]: [T; 2]) -> T {
        let [step, beyond_step] = node_below(roughness, ROUGHNESS_NODES);
        let [low, beyond] = node_below(place, ALBEDO_NODES);
        let first = step * T::from_f64(ALBEDO_NODES as f64) + low;
        let table = &tables[albedo_table as usize..];
        let row = &table[NODE_LENGTH * ALBEDO_NODES..];
        let [a, b, c, d] = mapped!([table, &table[NODE_LENGTH..], row, &row[NODE_LENGTH..]], |nodes| {
            look_up_number(nodes, number, first)
        });
        let (smooth, rough) = (a + (b - a) * beyond, c + (d - c) * beyond);
        smooth + (rough - smooth) * beyond_step
    }

    /// The albedo under a Fresnel factor, from its integrals, and the film's of the dielectric where they are known.
    pub fn rough_albedo<T: Real>(terms: &FresnelTerms<T>, integrals: [T; 4], film: Option<Vec3<T>>) -> Vec3<T> {
        let [first, constant, grazing, edge] = integrals;
        if !terms.has_parts() {
            return vec3(first, constant, grazing) * terms.tint * terms.weight;
        }
        let dielectric = if terms.model == Fresnel::Schlick {
            terms.tint * fresnel_f0(terms.ior) * constant + Vec3::splat(grazing)
        } else {
            terms.tint * first
        };
        let darkening = edge_darkening(terms.metal_f0, terms.edge_tint) * edge;
        let metal = terms.metal_f0 * constant + Vec3::splat(grazing);
        let mut metal = (metal - darkening).at_least_zero() * terms.metal_tint;
        let mut dielectric = dielectric * terms.weight;
        if terms.has_film {
            // No table has every thickness or metal: the lobe counts as its mean facet.
            let [cosine, energy] = mean_facet([constant, grazing]);
            let change = match film {
                Some(change) => change * terms.tint.map(|x| x.min(T::ONE)) * terms.weight,
                None => film_change_of_dielectric(terms, cosine) * energy,
            };
            dielectric = (dielectric + change).at_least_zero();
            metal = (metal + film_change_of_metal(terms, cosine) * energy).at_least_zero();
        }
        dielectric.mix(metal, terms.metalness)
    }
}
