//! Multiple scattering against the truth that it stands for: random walks between the facets of a Smith surface of GGX. Source:
//! Heitz, Hanika, d'Eon and Dachsbacher, "Multiple-scattering microfacet BSDFs with the Smith model" (2016).

use std::f64::consts::TAU;

use glossmith::{
    document::{MaterialSettings, assign},
    optics::{
        fresnel::{fresnel_dielectric, fresnel_schlick},
        refraction::refracted,
        vector::{Vec3, vec3},
    },
    render::{EngineChoice, Precision},
    study::evaluate::Evaluator,
};

use super::support::Random;

const IS_THOROUGH: bool = cfg!(feature = "thorough");
/// Walks of a view, whose share that is reflected so has a standard error of at most 0.002, or 0.001.
const WALKS: u32 = if IS_THOROUGH { 300_000 } else { 60_000 };
const ROUGHNESS: &[f64] = if IS_THOROUGH {
    &[0.2, 0.3, 0.4, 0.6, 0.8, 1.0]
} else {
    &[0.3, 0.6, 1.0]
};
const COSINES: &[f64] = if IS_THOROUGH {
    &[1.0, 0.7, 0.4, 0.2, 0.1]
} else {
    &[1.0, 0.4, 0.1]
};
const INDICES: &[f64] = if IS_THOROUGH {
    &[1.3, 1.5, 2.0, 2.5]
} else {
    &[1.3, 2.5]
};

fn random(rng: &mut Random) -> f64 {
    f64::from(rng.unit())
}

fn unit(v: Vec3<f64>) -> Vec3<f64> {
    v * (1.0 / v.length())
}

/// A ray between facets: its direction, and the share of the surface's heights below it.
struct Walk {
    along: Vec3<f64>,
    below: f64,
}

impl Walk {
    /// One that arrives from a view of this cosine.
    fn from_view(cosine: f64) -> Self {
        let along = -vec3((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        Self { along, below: 1.0 }
    }

    /// Goes on to the next facet; `false` where it leaves the surface.
    fn meets(&mut self, alpha: f64, u: f64) -> bool {
        let z = self.along.z;
        if z.abs() < 1e-9 {
            return true;
        }
        let length = (z * z + alpha * alpha * (1.0 - z * z)).sqrt() / z.abs();
        let lambda = 0.5 * (length * z.signum() - 1.0);
        if z > 0.0 && u >= 1.0 - self.below.powf(lambda) {
            return false;
        }
        self.below = (self.below * (1.0 - u).powf(-1.0 / lambda)).min(1.0);
        true
    }

    /// The facet that it meets, by visible normals.
    fn facet(&self, alpha: f64, [u, v]: [f64; 2]) -> Vec3<f64> {
        let wo = -self.along;
        let stretched = unit(vec3(wo.x * alpha, wo.y * alpha, wo.z));
        let z = (1.0 - u) * (1.0 + stretched.z) - stretched.z;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let cap = vec3(radius * (TAU * v).cos(), radius * (TAU * v).sin(), z) + stretched;
        unit(vec3(cap.x * alpha, cap.y * alpha, cap.z.max(0.0)))
    }

    /// Passes to the other side, whose heights are depths.
    fn turn_over(&mut self) {
        self.along = vec3(self.along.x, self.along.y, -self.along.z);
        self.below = 1.0 - self.below;
    }
}

/// What a metal of these reflectances head-on reflects.
fn of_metal(alpha: f64, cosine: f64, f0: Vec3<f64>, rng: &mut Random) -> Vec3<f64> {
    let mut sum = Vec3::ZERO;
    for _ in 0..WALKS {
        let mut walk = Walk::from_view(cosine);
        let mut color = Vec3::ONE;
        while walk.meets(alpha, random(rng)) && color.max_component() > 1e-4 {
            let h = walk.facet(alpha, [random(rng), random(rng)]);
            color = color * fresnel_schlick(f0, -walk.along.dot(h));
            walk.along = (-walk.along).mirrored_about(h);
        }
        sum += color;
    }
    sum * (1.0 / f64::from(WALKS))
}

/// What a clear interface of this relative index reflects.
fn of_glass(alpha: f64, cosine: f64, ior: f64, rng: &mut Random) -> f64 {
    let mut reflected = 0;
    for _ in 0..WALKS {
        let mut walk = Walk::from_view(cosine);
        let mut ahead = ior;
        for _ in 0..200 {
            if !walk.meets(alpha, random(rng)) {
                break;
            }
            let h = walk.facet(alpha, [random(rng), random(rng)]);
            if random(rng) < fresnel_dielectric(-walk.along.dot(h), ahead) {
                walk.along = (-walk.along).mirrored_about(h);
            } else {
                walk.along = refracted(-walk.along, h, ahead).wi;
                walk.turn_over();
                ahead = 1.0 / ahead;
            }
        }
        reflected += u32::from(ahead == ior);
    }
    f64::from(reflected) / f64::from(WALKS)
}

/// Reflected shares of a material of GGX for each view.
fn reflected(own: &[&str], roughness: f64, side: f64) -> Vec<[f64; 3]> {
    let mut material = MaterialSettings::default();
    let roughness = format!("specular.roughness={roughness}");
    for assignment in ["specular.lobe=ggx", &roughness].iter().chain(own) {
        assign(&mut material, assignment).unwrap();
    }
    let evaluator = Evaluator::open(&material, EngineChoice::Cpu, Precision::Single).unwrap();
    let of = |cosine: &f64| evaluator.albedo(side * cosine, 1 << 16, 1).unwrap().reflected;
    COSINES.iter().map(of).collect()
}

#[test]
fn metals_reflect_what_walks_do() {
    let mut rng = Random::new(3);
    for &roughness in ROUGHNESS {
        // White, gold and copper.
        for f0 in [[1.0, 1.0, 1.0], [1.0, 0.77, 0.34], [0.95, 0.64, 0.54]] {
            let color = format!("base.color={},{},{}", f0[0], f0[1], f0[2]);
            let all = reflected(
                &["base.metalness=1", "specular.fresnel=schlick", &color],
                roughness,
                1.0,
            );
            for (found, &cosine) in all.into_iter().zip(COSINES) {
                let truth = of_metal(roughness * roughness, cosine, Vec3::from_f64(f0), &mut rng).to_f64();
                for (found, truth) in found.into_iter().zip(truth) {
                    let off = (found - truth).abs();
                    assert!(
                        off < 0.02,
                        "{f0:?}, roughness {roughness} at {cosine}: {found} for {truth}"
                    );
                }
            }
        }
    }
}

/// Within 0.02 at any roughness, from outside and from within, but for the noise of the walks.
#[test]
fn glass_reflects_what_walks_do() {
    let mut rng = Random::new(5);
    let glass = [
        "base.metalness=0",
        "transmission.weight=1",
        "specular.fresnel=dielectric",
    ];
    for &roughness in ROUGHNESS {
        for &ior in INDICES {
            for side in [1.0, -1.0] {
                let index = format!("specular.ior={ior}");
                let all = reflected(&[&glass[..], &[&index]].concat(), roughness, side);
                for ([found, ..], &cosine) in all.into_iter().zip(COSINES) {
                    let truth = of_glass(roughness * roughness, cosine, ior.powf(side), &mut rng);
                    let off = (found - truth).abs();
                    let noise = (truth * (1.0 - truth) / f64::from(WALKS)).sqrt();
                    assert!(
                        off < 0.02 + 2.0 * noise,
                        "{ior}, roughness {roughness} at {}: {found} for {truth}",
                        side * cosine
                    );
                }
            }
        }
    }
}
