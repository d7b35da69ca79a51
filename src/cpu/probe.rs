//! Single functions asked about inputs of one's own. Twin of `shaders/pass/probe.wgsl`; the material in f64, too, as the
//! oracle.

use crate::optics::prelude::*;
use crate::{
    job::probe::{
        DrawAnswer, DrawQuestion, FresnelQuestion, LobeAnswer, LobeQuestion, MaterialQuestion, MaterialView, NO_HIT,
        ProbeScene, RandomQuestion, RayAnswer, RayQuestion,
    },
    optics::{
        curve::Curve,
        frame::{Frame, frame_from_normal},
        fresnel::{Fresnel, FresnelTerms, fresnel, fresnel_conductor, fresnel_dielectric},
        layer::{MaterialNumbers, material_density, material_evaluate, material_layers, material_sample},
        lobe::{Horizon, Lobe, LobeShape, lobe_evaluate, lobe_sample},
        material::{Material, Surface},
        random::{Sequence, random_pair_bits, random_state},
        thin_film::FilmTerms,
    },
    parallel,
};

fn by_number<E: Copy>(all: &[E], number: u32) -> E {
    all[(number as usize).min(all.len() - 1)]
}

/// A direction drawn from a lobe, and its value and density there and elsewhere.
pub fn probe_lobe(scene: &ProbeScene<'_>, questions: &[LobeQuestion]) -> Vec<LobeAnswer> {
    let answer = |q: &LobeQuestion| {
        let shape = LobeShape {
            lobe: by_number(Lobe::ALL, q.lobe),
            curve: by_number(Curve::ALL, q.curve),
            horizon: by_number(Horizon::ALL, q.horizon),
            roughness: q.roughness,
            anisotropy: q.anisotropy,
            eta: q.eta,
            table: &scene.tables[q.table as usize..],
        };
        let frame = frame_from_normal(q.shading);
        let drawn = lobe_sample(&shape, &frame, q.normal, q.wo, q.xi);
        LobeAnswer {
            wi: drawn.wi,
            weight: drawn.weight,
            drawn: lobe_evaluate(&shape, &frame, q.normal, q.wo, drawn.wi),
            given: lobe_evaluate(&shape, &frame, q.normal, q.wo, q.wi),
        }
    };
    parallel::map_each(questions, answer)
}

/// The share reflected by a dielectric or a conductor.
pub fn probe_fresnel(questions: &[FresnelQuestion]) -> Vec<f32> {
    let answer = |q: &FresnelQuestion| match q.model {
        1 => fresnel_conductor(q.cosine, q.eta, q.k),
        2 => filmed_share(q, Fresnel::Dielectric),
        3 => filmed_share(q, Fresnel::Conductor),
        _ => fresnel_dielectric(q.cosine, q.eta),
    };
    questions.iter().map(answer).collect()
}

/// The share reflected under a thin film.
fn filmed_share(q: &FresnelQuestion, model: Fresnel) -> f32 {
    let white = Vec3::splat(1.0);
    let [weight, ior, path] = q.film;
    let terms = FresnelTerms {
        model,
        metal_f0: white,
        metalness: 0.0,
        edge_tint: white,
        tint: white,
        metal_tint: white,
        weight: 1.0,
        ior: q.eta,
        eta: Vec3::splat(q.eta),
        k: Vec3::splat(q.k),
        before: 1.0,
        has_film: true,
        film: FilmTerms {
            weight,
            ior,
            path: Vec3::splat(path),
            ..FilmTerms::none_over(q.eta)
        },
    };
    fresnel(&terms, q.cosine).x
}

/// The bits of pairs of random numbers.
pub fn probe_random(questions: &[RandomQuestion]) -> Vec<[u32; 2]> {
    let answer = |q: &RandomQuestion| {
        let sequence = by_number(&[Sequence::Sobol, Sequence::Independent], q.sequence);
        random_pair_bits(
            random_state(q.pixel[0], q.pixel[1], q.seed, q.sample, sequence),
            q.dimension,
        )
    };
    parallel::map_each(questions, answer)
}

/// A direction moved by so many roundings of f32 along two tangents.
pub fn moved_direction<T: Real>(wi: Vec3<T>, moved: [f64; 2]) -> Vec3<T> {
    if moved == [0.0; 2] {
        return wi;
    }
    let around = frame_from_normal(wi);
    let [along, across] = moved.map(|by| T::from_f64(by * f64::from(f32::EPSILON)));
    wi + around.tangent * along + around.bitangent * across
}

/// A vector in the precision `T`.
fn vector<T: Scalar>(v: Vec3<f32>) -> Vec3<T> {
    Vec3::from_f64(v.to_f64())
}

/// The surface point of a view.
fn seen<T: Scalar>(view: &MaterialView) -> Surface<T> {
    let (normal, tangent) = (vector(view.shading), vector(view.tangent));
    Surface {
        frame: Frame {
            tangent,
            bitangent: normal.cross(tangent),
            normal,
        },
        normal: vector(view.normal),
        coat_normal: normal,
        wo: vector(view.wo),
        is_inside: view.is_inside == 1,
    }
}

/// A material's evaluate for light from a direction that was drawn with some density, in the precision `T`; the direction
/// is moved as by [`moved_direction`].
pub fn probe_material<T: Scalar>(scene: &ProbeScene<'_>, question: &MaterialQuestion, moved: [f64; 2]) -> Vec3<T> {
    let material: Material<T> = scene.materials[question.view.material as usize].cast();
    let surface = seen(&question.view);
    let wi = moved_direction(vector(question.wi), moved);
    let [density, competing] = [question.light_density, question.competing].map(|x| T::from_f64(f64::from(x)));
    let layers = material_layers(&material, scene.tables, &surface);
    material_evaluate(&material, scene.tables, &surface, &layers, wi, density, competing)
}

/// Materials' values in the precision `T`.
pub fn probe_materials<T: Scalar>(scene: &ProbeScene<'_>, questions: &[MaterialQuestion]) -> Vec<Vec3<T>> {
    let answer = |q: &MaterialQuestion| probe_material(scene, q, [0.0; 2]);
    parallel::map_each(questions, answer)
}

/// Densities with which materials draw directions, in the precision `T`.
pub fn probe_density<T: Scalar>(scene: &ProbeScene<'_>, questions: &[MaterialQuestion]) -> Vec<T> {
    let answer = |q: &MaterialQuestion| {
        let material: Material<T> = scene.materials[q.view.material as usize].cast();
        let surface = seen(&q.view);
        let layers = material_layers(&material, scene.tables, &surface);
        material_density(&material, scene.tables, &surface, &layers, vector(q.wi))
    };
    parallel::map_each(questions, answer)
}

/// Directions drawn from materials, computed in the precision `T`.
pub fn probe_draw<T: Scalar>(scene: &ProbeScene<'_>, questions: &[DrawQuestion]) -> Vec<DrawAnswer> {
    let answer = |q: &DrawQuestion| {
        let material: Material<T> = scene.materials[q.view.material as usize].cast();
        let surface = seen(&q.view);
        let number = |x: f32| T::from_f64(f64::from(x));
        let numbers = MaterialNumbers {
            lobe: q.lobe.map(number),
            facet: number(q.facet),
            below: q.below.map(number),
        };
        let layers = material_layers(&material, scene.tables, &surface);
        let drawn = material_sample(&material, scene.tables, &surface, &layers, numbers, false);
        DrawAnswer {
            wi: Vec3::from_f64(drawn.wi.to_f64()),
            throughput: Vec3::from_f64(drawn.throughput.to_f64()),
        }
    };
    parallel::map_each(questions, answer)
}

/// The nearest triangles on rays.
pub fn probe_ray(scene: &ProbeScene<'_>, questions: &[RayQuestion]) -> Vec<RayAnswer> {
    let answer = |q: &RayQuestion| {
        let hit = scene.geometry.and_then(|g| g.intersect(q.origin, q.direction, q.t_max));
        RayAnswer {
            triangle: hit.map_or(NO_HIT, |hit| hit.triangle),
            t: hit.map_or(q.t_max, |hit| hit.t),
        }
    };
    parallel::map_each(questions, answer)
}
