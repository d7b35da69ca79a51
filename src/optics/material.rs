//! The material as the integrators see it: a specular lobe over a Lambertian base.
//!
//! The specular lobe reflects the Fresnel share; what it leaves over reaches the base. How much that is on average over
//! the lobe, its albedo, is tabulated for each material ([`albedo_table`]), so that a white base under any lobe reflects
//! all light: the layering neither loses nor makes energy.

use super::curve::Curve;
use super::frame::Frame;
use super::fresnel::{Fresnel, FresnelTerms, fresnel, half_vector_cosine};
use super::lobe::{Horizon, Lobe, LobeShape, is_mirror, lobe_evaluate, lobe_sample};
use super::random::{Sequence, random_pair, random_state};
use super::real::{Mask, Real};
use super::vector::{Vec3, vec3};

/// Nodes of an albedo table, equidistant in the cosine of the view.
pub const ALBEDO_NODES: usize = 64;
/// Numbers of an albedo table: red, green and blue a node.
pub const ALBEDO_LENGTH: usize = 3 * ALBEDO_NODES;

/// A material with its tables' places. The f32 form is what the GPU reads, byte for byte (`shaders/optics/material.wgsl`).
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Material<T> {
    /// Albedo of the Lambertian base, or reflectance of the metal at normal incidence; linear RGB in [0, 1].
    pub base_color: Vec3<T>,
    /// 0: dielectric over a diffuse base; 1: metal.
    pub metalness: T,
    /// Tint of the specular reflection, linear RGB.
    pub specular_color: Vec3<T>,
    /// Share of the specular reflection that is kept, in [0, 1].
    pub specular_weight: T,
    /// Real part of the conductor's index of refraction.
    pub eta: Vec3<T>,
    /// The dielectric's index of refraction.
    pub ior: T,
    /// Imaginary part of the conductor's index of refraction.
    pub k: Vec3<T>,
    /// Roughness in [0, 1].
    pub roughness: T,
    /// Emitted radiance, linear RGB.
    pub emission: Vec3<T>,
    /// Stretch of the lobe in [−1, 1].
    pub anisotropy: T,
    /// Turn of the tangent, radians.
    pub rotation_rad: T,
    /// [`Lobe`] as a number.
    pub lobe: u32,
    /// [`Curve`] as a number.
    pub curve: u32,
    /// [`Horizon`] as a number.
    pub horizon: u32,
    /// [`Fresnel`] as a number.
    pub fresnel: u32,
    /// Where the custom curve's table begins.
    pub curve_table: u32,
    /// Where the albedo table begins.
    pub albedo_table: u32,
    /// Fills the last 16 bytes.
    pub reserved: u32,
}

// SAFETY: f32 and u32 fields without padding (4 × 4 × 5 + 8 × 4 bytes); any bit pattern is valid.
unsafe impl bytemuck::Zeroable for Material<f32> {}
// SAFETY: as above.
unsafe impl bytemuck::Pod for Material<f32> {}

impl<T: Real> Material<T> {
    /// The same material in another precision.
    pub fn cast<U: Real>(&self) -> Material<U> {
        let number = |x: T| U::from_f64(x.to_f64());
        let vector = |v: Vec3<T>| Vec3::from_f64(v.to_f64());
        Material {
            base_color: vector(self.base_color),
            metalness: number(self.metalness),
            specular_color: vector(self.specular_color),
            specular_weight: number(self.specular_weight),
            eta: vector(self.eta),
            ior: number(self.ior),
            k: vector(self.k),
            roughness: number(self.roughness),
            emission: vector(self.emission),
            anisotropy: number(self.anisotropy),
            rotation_rad: number(self.rotation_rad),
            lobe: self.lobe,
            curve: self.curve,
            horizon: self.horizon,
            fresnel: self.fresnel,
            curve_table: self.curve_table,
            albedo_table: self.albedo_table,
            reserved: self.reserved,
        }
    }

    /// The specular lobe. `tables` holds all materials' tables.
    #[inline(always)]
    pub fn shape<'a>(&self, tables: &'a [f32]) -> LobeShape<'a, T> {
        LobeShape {
            lobe: by_index(Lobe::ALL, self.lobe),
            curve: by_index(Curve::ALL, self.curve),
            horizon: by_index(Horizon::ALL, self.horizon),
            roughness: self.roughness,
            anisotropy: self.anisotropy,
            table: tables.get(self.curve_table as usize..).unwrap_or_default(),
        }
    }

    /// The Fresnel factor's terms.
    #[inline(always)]
    pub fn fresnel_terms(&self) -> FresnelTerms<T> {
        FresnelTerms {
            model: by_index(Fresnel::ALL, self.fresnel),
            metal_f0: self.base_color,
            metalness: self.metalness,
            tint: self.specular_color,
            weight: self.specular_weight,
            ior: self.ior,
            eta: self.eta,
            k: self.k,
        }
    }

    /// True where a Lambertian base shows.
    #[inline(always)]
    pub fn has_base(&self) -> bool {
        self.metalness.to_f64() < 1.0 && self.base_color.max_component().to_f64() > 0.0
    }

    /// True where the specular lobe reflects anything.
    #[inline(always)]
    pub fn has_specular(&self) -> bool {
        self.specular_weight.to_f64() > 0.0
    }
}

/// The registry's entry with this index; the first one where there is none.
#[inline(always)]
fn by_index<E: Copy>(all: &[E], index: u32) -> E {
    all[(index as usize).min(all.len() - 1)]
}

/// A direction drawn from a material.
#[derive(Clone, Copy, Debug)]
pub struct MaterialSample<T> {
    /// Towards the light.
    pub wi: Vec3<T>,
    /// What the path's throughput is multiplied by; 0 where the sample was absorbed.
    pub throughput: Vec3<T>,
    /// Density of the lobe that was chosen times the probability of choosing it, per steradian; 0 where that lobe is
    /// weighed as a mirror (or the strategy asks for no density).
    pub density: T,
    /// True where the lobe is weighed as a mirror: light sampling has no share in this direction.
    pub is_mirror: bool,
}

/// How a surface point is lit and seen.
#[derive(Clone, Copy, Debug)]
pub struct Surface<T> {
    /// The shading frame, on the side of the viewer.
    pub frame: Frame<T>,
    /// The geometric normal, on the side of the viewer.
    pub normal: Vec3<T>,
    /// Towards the viewer.
    pub wo: Vec3<T>,
}

/// The shares of the layers for one view direction.
#[derive(Clone, Copy, Debug)]
pub struct Layers<T> {
    /// Albedo of the base after what the specular lobe took.
    pub base: Vec3<T>,
    /// Probability of sampling the specular lobe.
    pub specular_probability: T,
}

/// What the base is left with, and how often each layer is sampled: in proportion to the luminance it reflects, each at
/// least one time in twenty.
pub fn material_layers<T: Real>(material: &Material<T>, tables: &[f32], surface: &Surface<T>) -> Layers<T> {
    if !material.has_base() {
        return Layers {
            base: Vec3::zero(),
            specular_probability: T::one(),
        };
    }
    let diffuse = material.base_color * (T::one() - material.metalness);
    if !material.has_specular() {
        return Layers {
            base: diffuse,
            specular_probability: T::zero(),
        };
    }
    let taken = albedo_lookup(tables, material.albedo_table, surface.frame.normal.dot(surface.wo));
    let base = diffuse * (Vec3::splat(T::one()) - taken).map(|x| x.max(T::zero()));
    let (specular_luminance, base_luminance) = (taken.luminance(), base.luminance());
    let share = specular_luminance / (specular_luminance + base_luminance).max(T::from_f64(1e-9));
    Layers {
        base,
        specular_probability: share.clamp(T::from_f64(0.05), T::from_f64(0.95)),
    }
}

/// The base's lobe: Lambert's, its rare samples below the geometric surface mirrored.
#[inline(always)]
fn base_shape<'a, T: Real>() -> LobeShape<'a, T> {
    LobeShape {
        lobe: Lobe::Lambert,
        curve: Curve::Sqrt,
        horizon: Horizon::Mirror,
        roughness: T::one(),
        anisotropy: T::zero(),
        table: &[],
    }
}

/// Draws a direction: the specular lobe or the base, chosen by `xi_layer`. `wants_density` is false where no other
/// strategy competes: then the geometric lobe never computes its density.
pub fn material_sample<T: Real>(
    material: &Material<T>,
    tables: &[f32],
    surface: &Surface<T>,
    xi: [T; 3],
    xi_layer: T,
    wants_density: bool,
) -> MaterialSample<T> {
    let layers = material_layers(material, tables, surface);
    let is_specular = xi_layer.less(layers.specular_probability).any();
    let shape = if is_specular {
        material.shape(tables)
    } else {
        base_shape()
    };
    let drawn = lobe_sample(&shape, &surface.frame, surface.normal, surface.wo, xi);
    let (color, probability) = if is_specular {
        let cosine = half_vector_cosine(surface.wo, drawn.wi);
        (fresnel(&material.fresnel_terms(), cosine), layers.specular_probability)
    } else {
        (layers.base, T::one() - layers.specular_probability)
    };
    let is_mirror = is_mirror(&shape).any();
    let density = if wants_density && !is_mirror {
        probability * lobe_evaluate(&shape, &surface.frame, surface.normal, surface.wo, drawn.wi)[1]
    } else {
        T::zero()
    };
    MaterialSample {
        wi: drawn.wi,
        throughput: color * (drawn.weight / probability),
        density,
        is_mirror,
    }
}

/// The material's evaluate (cosine included) for light from `wi` that was drawn with density `light_density`, each layer
/// multiplied by its share under multiple importance sampling (Veach 1997, balance heuristic): light_density/
/// (light_density + `competing` × density of that layer). `competing` is 1, or 0 where light sampling works alone.
/// Layers weighed as mirrors give nothing: only sampling the lobe finds what they reflect.
pub fn material_evaluate<T: Real>(
    material: &Material<T>,
    tables: &[f32],
    surface: &Surface<T>,
    wi: Vec3<T>,
    light_density: T,
    competing: T,
) -> Vec3<T> {
    let layers = material_layers(material, tables, surface);
    let share = |probability: T, density: T| light_density / (light_density + competing * probability * density);
    let mut sum = Vec3::zero();
    let shape = material.shape(tables);
    if material.has_specular() && !is_mirror(&shape).any() {
        let [value, density] = lobe_evaluate(&shape, &surface.frame, surface.normal, surface.wo, wi);
        let color = fresnel(&material.fresnel_terms(), half_vector_cosine(surface.wo, wi));
        sum += color * (value * share(layers.specular_probability, density));
    }
    if material.has_base() {
        let [value, density] = lobe_evaluate(&base_shape(), &surface.frame, surface.normal, surface.wo, wi);
        sum += layers.base * (value * share(T::one() - layers.specular_probability, density));
    }
    sum
}

/// The specular albedo for a view whose cosine is `cosine`, linear between the table's nodes.
pub fn albedo_lookup<T: Real>(tables: &[f32], albedo_table: u32, cosine: T) -> Vec3<T> {
    let last = T::from_f64(ALBEDO_NODES as f64 - 1.0);
    let position = cosine.clamp(T::zero(), T::one()) * last;
    let low = position.floor().min(last - T::one());
    let first = albedo_table as usize + 3 * low.to_f64() as usize;
    let number = |i: usize| T::from_f64(f64::from(tables[i]));
    let node = |i: usize| vec3(number(i), number(i + 1), number(i + 2));
    node(first).mix(node(first + 3), position - low)
}

/// The specular lobe's albedo against the view's cosine: what [`albedo_lookup`] reads. `samples` a node.
pub fn albedo_table(material: &Material<f64>, tables: &[f32], samples: u32) -> Vec<f32> {
    let normal = vec3(0.0, 0.0, 1.0);
    let frame = super::frame::frame_from_normal(normal);
    let shape = material.shape(tables);
    let terms = material.fresnel_terms();
    let mut table = Vec::with_capacity(ALBEDO_LENGTH);
    for node in 0..ALBEDO_NODES {
        // At exactly grazing the microfacet lobes are 0/0.
        let cosine = (node as f64 / (ALBEDO_NODES as f64 - 1.0)).max(1e-3);
        let wo = vec3((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        let mut sum = Vec3::zero();
        for i in 0..samples {
            let state = random_state(node as u32, 0, 0, i, Sequence::Sobol);
            let [a, b] = random_pair(state, 0);
            let [c, _] = random_pair(state, 1);
            let drawn = lobe_sample(&shape, &frame, normal, wo, [a, b, c]);
            sum += fresnel(&terms, half_vector_cosine(wo, drawn.wi)) * drawn.weight;
        }
        table.extend((sum / f64::from(samples)).to_f32());
    }
    table
}
