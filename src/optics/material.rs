//! The material as the integrators see it: a specular lobe over a base that is Lambertian, or refracts, or is a mixture
//! of both.
//!
//! The specular lobe reflects the Fresnel share; what it leaves over reaches the base. How much that is on average over
//! the lobe, its albedo, is tabulated for each material ([`albedo_table`]), so that a white base under any lobe reflects
//! or transmits all light: the layering neither loses nor makes energy. A material that transmits has a second table for
//! views from within. Lobes made of facets refract at each facet what that facet does not reflect.

use super::albedo::{albedo_lookup, albedo_place, rough_albedo, rough_albedo_lookup};
use super::coat::{coat_evaluate, coat_probability, coat_sample, coat_shape, coat_share, coat_transmittance};
use super::curve::Curve;
use super::frame::Frame;
use super::fresnel::{Fresnel, FresnelTerms, fresnel, fresnel_left, half_vector_cosine};
use super::lobe::{Horizon, Lobe, LobeSample, LobeShape, is_mirror, lobe_evaluate, lobe_sample, refracts_at_facets};
use super::numeric::sampled_share;
use super::real::{Mask, Real};
use super::refraction::refracting_cosines;
use super::vector::Vec3;

/// The number of a texture that is not there.
pub const NO_TEXTURE: u32 = u32::MAX;
/// Nodes of the table that has a lobe's roughness for that of GGX.
pub const MATCHED_NODES: usize = 17;

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
    /// Tint at each refraction, linear RGB in [0, 1].
    pub transmission_tint: Vec3<T>,
    /// Share of the base that refracts, in [0, 1].
    pub transmission_weight: T,
    /// What a length of 1 of the interior absorbs, as the negative logarithm of what it lets through; linear RGB.
    pub absorption: Vec3<T>,
    /// Roughness of the refraction in [0, 1].
    pub transmission_roughness: T,
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
    /// Where the albedo table for views from within begins.
    pub inner_albedo_table: u32,
    /// What the metal's reflection is multiplied by near 82 degrees, linear RGB in [0, 1].
    pub edge_tint: Vec3<T>,
    /// Share of light that the surface stops, in [0, 1].
    pub opacity: T,
    /// What a coat of weight 1 leaves of the light that crosses it twice, linear RGB in [0, 1].
    pub coat_color: Vec3<T>,
    /// Share of the surface that has a coat, in [0, 1].
    pub coat_weight: T,
    /// Roughness of the coat in [0, 1].
    pub coat_roughness: T,
    /// Index of refraction of the coat.
    pub coat_ior: T,
    /// Where the coat's albedo table begins.
    pub coat_table: u32,
    /// The luminance by which the surface is sampled as a light: the mean over its emission texture.
    pub light_luminance: T,
    /// Textures of base colour, roughness, normal, emission; [`NO_TEXTURE`] where there is none.
    pub textures: [u32; 4],
    /// The texture whose alpha multiplies the opacity, or [`NO_TEXTURE`].
    pub opacity_texture: u32,
    /// The surface is there where its opacity reaches this; negative where the opacity is a share.
    pub alpha_cutoff: T,
    /// Scales the slopes of the normal texture.
    pub normal_strength: T,
    /// 1 where the surface is metal in part or changes from point to point: the albedo tables go over the roughness too
    /// ([`rough_albedo_table`](super::albedo::rough_albedo_table)).
    pub has_rough_tables: u32,
    /// The roughness that the texture multiplies: that of GGX where `roughness_table` is there.
    pub texture_roughness: T,
    /// Where the table begins that has the lobe's roughness for that of GGX; [`NO_TEXTURE`] where both are the same.
    pub roughness_table: u32,
    /// 1 where the colours at the vertices multiply the base colour.
    pub has_vertex_colors: u32,
    /// With `spot_offset`: the ramp of a spot's share over the cosine to the way it faces
    /// ([`spot_share`](crate::scene::light::spot_share)); 0 and 1 where the surface shines into all directions.
    pub spot_scale: T,
    /// See `spot_scale`.
    pub spot_offset: T,
    /// The texture of the metalness, or [`NO_TEXTURE`].
    pub metalness_texture: u32,
    /// The texture that multiplies the weight of the coat, or [`NO_TEXTURE`].
    pub coat_texture: u32,
    /// 1 where a texture lies on the surface as on a box.
    pub has_box_projection: u32,
}

// SAFETY: f32 and u32 fields without padding (16 × 16 bytes); any bit pattern is valid.
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
            transmission_tint: vector(self.transmission_tint),
            transmission_weight: number(self.transmission_weight),
            absorption: vector(self.absorption),
            transmission_roughness: number(self.transmission_roughness),
            rotation_rad: number(self.rotation_rad),
            lobe: self.lobe,
            curve: self.curve,
            horizon: self.horizon,
            fresnel: self.fresnel,
            curve_table: self.curve_table,
            albedo_table: self.albedo_table,
            inner_albedo_table: self.inner_albedo_table,
            edge_tint: vector(self.edge_tint),
            opacity: number(self.opacity),
            coat_color: vector(self.coat_color),
            coat_weight: number(self.coat_weight),
            coat_roughness: number(self.coat_roughness),
            coat_ior: number(self.coat_ior),
            coat_table: self.coat_table,
            light_luminance: number(self.light_luminance),
            textures: self.textures,
            opacity_texture: self.opacity_texture,
            alpha_cutoff: number(self.alpha_cutoff),
            normal_strength: number(self.normal_strength),
            has_rough_tables: self.has_rough_tables,
            texture_roughness: number(self.texture_roughness),
            roughness_table: self.roughness_table,
            has_vertex_colors: self.has_vertex_colors,
            spot_scale: number(self.spot_scale),
            spot_offset: number(self.spot_offset),
            metalness_texture: self.metalness_texture,
            coat_texture: self.coat_texture,
            has_box_projection: self.has_box_projection,
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
            eta: T::zero(),
            table: tables.get(self.curve_table as usize..).unwrap_or_default(),
        }
    }

    /// The refracting lobe, seen from within or without.
    #[inline(always)]
    pub fn transmission_shape<'a>(&self, tables: &'a [f32], is_inside: bool) -> LobeShape<'a, T> {
        LobeShape {
            roughness: self.transmission_roughness,
            eta: self.ior_ahead(is_inside),
            ..self.shape(tables)
        }
    }

    /// The index of refraction behind the surface over that before it: inverted where a material that transmits is seen
    /// from within.
    #[inline(always)]
    pub fn ior_ahead(&self, is_inside: bool) -> T {
        if is_inside && self.transmits() {
            T::one() / self.ior
        } else {
            self.ior
        }
    }

    /// The Fresnel factor's terms. From within, weight and tint have no effect: the interface is the bare dielectric, so
    /// that what is reflected totally keeps its energy.
    #[inline(always)]
    pub fn fresnel_terms(&self, is_inside: bool) -> FresnelTerms<T> {
        let is_bare = is_inside && self.transmits();
        FresnelTerms {
            model: by_index(Fresnel::ALL, self.fresnel),
            metal_f0: self.base_color,
            metalness: self.metalness,
            edge_tint: self.edge_tint,
            tint: if is_bare {
                Vec3::splat(T::one())
            } else {
                self.specular_color
            },
            weight: if is_bare { T::one() } else { self.specular_weight },
            ior: self.ior_ahead(is_inside),
            eta: self.eta,
            k: self.k,
        }
    }

    /// The material where its textures make it the least metallic: what calls for a base or for transmission.
    pub fn least_metallic(&self) -> Self {
        let is_fixed = self.metalness_texture == NO_TEXTURE;
        let metalness = if is_fixed { self.metalness } else { T::zero() };
        Self { metalness, ..*self }
    }

    /// True where a texture is looked up.
    #[inline(always)]
    pub fn is_textured(&self) -> bool {
        let others = [self.opacity_texture, self.metalness_texture, self.coat_texture];
        others != [NO_TEXTURE; 3] || self.textures != [NO_TEXTURE; 4]
    }

    /// True where some light may go straight on, as if the surface were not there.
    #[inline(always)]
    pub fn has_holes(&self) -> bool {
        let is_masked = self.alpha_cutoff.to_f64() > self.opacity.to_f64();
        let is_clear = self.alpha_cutoff.to_f64() < 0.0 && self.opacity.to_f64() < 1.0;
        is_masked || is_clear || self.opacity_texture != NO_TEXTURE
    }

    /// True where a Lambertian base shows.
    #[inline(always)]
    pub fn has_base(&self) -> bool {
        let is_opaque = self.transmission_weight.to_f64() < 1.0;
        is_opaque && self.metalness.to_f64() < 1.0 && self.base_color.max_component().to_f64() > 0.0
    }

    /// True where light goes through the surface.
    #[inline(always)]
    pub fn transmits(&self) -> bool {
        self.transmission_weight.to_f64() > 0.0 && self.metalness.to_f64() < 1.0
    }

    /// True where every direction that it can draw is weighed as a mirror's.
    pub fn is_mirror(&self) -> bool {
        let through = self.transmission_shape(&[], false);
        let reflects_alike = !self.has_specular() || is_mirror(&self.shape(&[])).any();
        let is_coat_alike = self.coat_weight.to_f64() <= 0.0 || is_mirror(&coat_shape(self)).any();
        !self.has_base() && reflects_alike && is_coat_alike && (!self.transmits() || is_mirror(&through).any())
    }

    /// True where the specular lobe reflects anything: if not from without, then from within.
    #[inline(always)]
    pub fn has_specular(&self) -> bool {
        self.specular_weight.to_f64() > 0.0 || self.transmits()
    }
}

/// The registry's entry with this index; the first one where there is none.
#[inline(always)]
fn by_index<E: Copy>(all: &[E], index: u32) -> E {
    all[(index as usize).min(all.len() - 1)]
}

/// A layer of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Layer {
    /// The coat.
    Coat,
    /// The specular lobe.
    Specular,
    /// The Lambertian base.
    Base,
    /// The refracting lobe.
    Refraction,
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
    /// The layer that was chosen: for accounts of paths, nothing is computed from it.
    pub layer: Layer,
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
    /// The shading normal without the normal texture, on the side of the viewer: a coat is smooth over it.
    pub coat_normal: Vec3<T>,
    /// True where the viewer is on the back of the triangle: within the solid, if its mesh is closed.
    pub is_inside: bool,
}

/// The shares of the layers for one view direction.
#[derive(Clone, Copy, Debug)]
pub struct Layers<T> {
    /// Albedo of the Lambertian base after what the specular lobe took.
    pub base: Vec3<T>,
    /// What is refracted, on average over the lobe.
    pub transmission: Vec3<T>,
    /// Probability of sampling the specular lobe, where the coat is not sampled.
    pub specular_probability: T,
    /// Probability of sampling the refracting lobe, where the coat is not sampled.
    pub transmission_probability: T,
    /// Probability of sampling the coat.
    pub coat_probability: T,
    /// What the coat leaves of everything below it.
    pub below_coat: Vec3<T>,
}

impl<T: Real> Layers<T> {
    /// Probability of sampling the Lambertian base, where the coat is not sampled.
    #[inline(always)]
    pub fn base_probability(&self) -> T {
        T::one() - self.specular_probability - self.transmission_probability
    }
}

/// What the base is left with, and how often each layer is sampled: in proportion to the luminance it reflects or
/// transmits, the specular lobe as [`sampled_share`] says.
pub fn material_layers<T: Real>(material: &Material<T>, tables: &[f32], surface: &Surface<T>) -> Layers<T> {
    let (zero, one) = (T::zero(), T::one());
    let coat = coat_share(material, tables, surface);
    if !material.has_base() && !material.transmits() {
        let below = if material.has_specular() { one } else { zero };
        return Layers {
            base: Vec3::zero(),
            transmission: Vec3::zero(),
            specular_probability: one,
            transmission_probability: zero,
            coat_probability: coat_probability(coat, below),
            below_coat: coat_transmittance(material, surface, coat),
        };
    }
    let [taken, by_dielectric] = if material.has_specular() {
        specular_albedos(material, tables, surface)
    } else {
        [Vec3::zero(); 2]
    };
    // Under the metal's share there is nothing; the rest lies under the dielectric alone.
    let left = (Vec3::splat(one) - by_dielectric).map(|x| x.max(zero)) * (one - material.metalness);
    let base = material.base_color * left * (one - material.transmission_weight);
    let transmission = material.transmission_tint * left * material.transmission_weight;
    let (specular, below, through) = (taken.luminance(), base.luminance(), transmission.luminance());
    let rest = below + through;
    let tiny = T::from_f64(1e-9);
    let share = sampled_share(specular / (specular + rest).max(tiny));
    let share = T::select(zero.less(rest), share, one);
    // What is passed on is what was not reflected, no estimate.
    let share = if passes_on(material) { specular.min(one) } else { share };
    Layers {
        base,
        transmission,
        specular_probability: share,
        transmission_probability: (one - share) * (through / rest.max(tiny)),
        coat_probability: coat_probability(coat, specular + rest),
        below_coat: coat_transmittance(material, surface, coat),
    }
}

/// What the specular lobe reflects of this view, and what it would if nothing of it were metal.
fn specular_albedos<T: Real>(material: &Material<T>, tables: &[f32], surface: &Surface<T>) -> [Vec3<T>; 2] {
    let mut place = surface.frame.normal.dot(surface.wo);
    let mut first = material.albedo_table;
    if surface.is_inside && material.transmits() {
        place = albedo_place(place, material.ior_ahead(true));
        first = material.inner_albedo_table;
    }
    if material.has_rough_tables == 1 {
        let integrals = rough_albedo_lookup(tables, first, place, material.roughness);
        let terms = material.fresnel_terms(surface.is_inside);
        return [terms, terms.of_dielectric()].map(|terms| rough_albedo(&terms, integrals));
    }
    // What is metal in part has the other table.
    [albedo_lookup(tables, first, place); 2]
}

/// The share of the light from everywhere that reaches the viewer by all layers, in [0, 1] for each colour: where there
/// is only the specular lobe, its Fresnel term at the view's angle.
pub fn material_albedo<T: Real>(material: &Material<T>, tables: &[f32], surface: &Surface<T>) -> Vec3<T> {
    let specular = if !material.has_specular() {
        Vec3::zero()
    } else if material.has_base() || material.transmits() {
        specular_albedos(material, tables, surface)[0]
    } else {
        let cosine = surface.frame.normal.dot(surface.wo);
        fresnel(&material.fresnel_terms(surface.is_inside), cosine)
    };
    let layers = material_layers(material, tables, surface);
    specular + layers.base + layers.transmission
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
        eta: T::zero(),
        table: &[],
    }
}

/// A number in [0, 1) that was not below `share`, stretched to [0, 1) again.
#[inline(always)]
fn rescaled<T: Real>(number: T, share: T) -> T {
    let stretched = (number - share) / (T::one() - share).max(T::from_f64(1e-20));
    stretched.min(T::from_f64(1.0 - 1.0 / 16_777_216.0))
}

/// The numbers that a sample of a material takes, each in [0, 1).
#[derive(Clone, Copy, Debug)]
pub struct MaterialNumbers<T> {
    /// Draws the direction.
    pub lobe: [T; 3],
    /// Chooses the layer.
    pub layer: T,
    /// Draws the direction where the specular lobe passed it on to what is below.
    pub below: [T; 3],
}

/// True where a mirrored direction is drawn first and what it does not reflect is passed on: then all weights are 1
/// however often light is reflected inside. It takes a lobe whose own weights are 1.
#[inline(always)]
fn passes_on<T: Real>(material: &Material<T>) -> bool {
    material.transmits() && by_index(Lobe::ALL, material.lobe).traits().weighs_one
}

/// Draws a direction: from the specular lobe, the base or the refracting lobe. `wants_density` is false where no other
/// strategy competes: then the geometric lobe never computes its density.
pub fn material_sample<T: Real>(
    material: &Material<T>,
    tables: &[f32],
    surface: &Surface<T>,
    numbers: MaterialNumbers<T>,
    wants_density: bool,
) -> MaterialSample<T> {
    let layers = material_layers(material, tables, surface);
    let base = layers.base_probability();
    let through = layers.transmission_probability;
    let mut layer = numbers.layer;
    if material.has_coat(surface) {
        if layer.less(layers.coat_probability).any() {
            return coat_sample(material, surface, numbers.lobe, layers.coat_probability, wants_density);
        }
        layer = rescaled(layer, layers.coat_probability);
    }
    let below = T::one() - layers.coat_probability;
    let draw = |shape: &LobeShape<'_, T>, xi| lobe_sample(shape, &surface.frame, surface.normal, surface.wo, xi);
    let finish = |layer, shape: &LobeShape<'_, T>, drawn: LobeSample<T>, color: Vec3<T>, probability: T| {
        let is_mirror = is_mirror(shape).any();
        let density = if wants_density && !is_mirror {
            below * probability * lobe_evaluate(shape, &surface.frame, surface.normal, surface.wo, drawn.wi)[1]
        } else {
            T::zero()
        };
        let scale = drawn.weight / (below * probability).max(T::from_f64(1e-20));
        MaterialSample {
            wi: drawn.wi,
            throughput: color * layers.below_coat * scale,
            density,
            is_mirror,
            layer,
        }
    };
    let mut xi = numbers.lobe;
    let mut specular = layers.specular_probability;
    let is_passed_on = passes_on(material);
    if is_passed_on || layer.less(specular).any() {
        let shape = material.shape(tables);
        let drawn = draw(&shape, xi);
        let terms = material.fresnel_terms(surface.is_inside);
        let color = fresnel(&terms, half_vector_cosine(surface.wo, drawn.wi));
        if is_passed_on {
            specular = T::select(T::zero().less(drawn.weight), color.luminance(), T::zero());
            xi = numbers.below;
        }
        if layer.less(specular).any() {
            return finish(Layer::Specular, &shape, drawn, color, specular);
        }
    }
    let base_end = specular + (T::one() - specular) * (base / (base + through).max(T::from_f64(1e-20)));
    if layer.less(base_end).any() || !T::zero().less(through).any() {
        let shape = base_shape();
        return finish(Layer::Base, &shape, draw(&shape, xi), layers.base, base);
    }
    let shape = material.transmission_shape(tables, surface.is_inside);
    let drawn = draw(&shape, xi);
    let color = transmission_color(material, &layers, &shape, surface, drawn.wi);
    finish(Layer::Refraction, &shape, drawn, color, through)
}

/// What is refracted into a direction: of lobes made of facets what the facet does not reflect, of others what the
/// specular lobe leaves over on average.
fn transmission_color<T: Real>(
    material: &Material<T>,
    layers: &Layers<T>,
    shape: &LobeShape<'_, T>,
    surface: &Surface<T>,
    wi: Vec3<T>,
) -> Vec3<T> {
    if !refracts_at_facets(shape) {
        return layers.transmission;
    }
    let [cosine, behind] = refracting_cosines(surface.wo, wi, shape.eta);
    let left = fresnel_left(&material.fresnel_terms(surface.is_inside), cosine, behind);
    material.transmission_tint * left * (material.transmission_weight * (T::one() - material.metalness))
}

/// The material's evaluate (cosine included) for light from `wi` that was drawn with density `light_density`, each layer
/// multiplied by its share under multiple importance sampling (Veach 1997, balance heuristic): light_density/
/// (light_density + `competing` × density of that layer). `competing` is 1, or 0 where light sampling works alone.
/// Layers weighed as mirrors give nothing: only sampling the lobe finds what they reflect or refract.
pub fn material_evaluate<T: Real>(
    material: &Material<T>,
    tables: &[f32],
    surface: &Surface<T>,
    wi: Vec3<T>,
    light_density: T,
    competing: T,
) -> Vec3<T> {
    let layers = material_layers(material, tables, surface);
    let below = T::one() - layers.coat_probability;
    let mut sum = Vec3::zero();
    let mut add = |shape: &LobeShape<'_, T>, probability: T, color: Vec3<T>| {
        if !is_mirror(shape).any() {
            let [value, density] = lobe_evaluate(shape, &surface.frame, surface.normal, surface.wo, wi);
            let share = light_density / (light_density + competing * below * probability * density);
            sum += color * layers.below_coat * (value * share);
        }
    };
    if material.has_specular() {
        let terms = material.fresnel_terms(surface.is_inside);
        let color = fresnel(&terms, half_vector_cosine(surface.wo, wi));
        let probability = if passes_on(material) {
            color.luminance()
        } else {
            layers.specular_probability
        };
        add(&material.shape(tables), probability, color);
    }
    if material.has_base() {
        add(&base_shape(), layers.base_probability(), layers.base);
    }
    if material.transmits() {
        let shape = material.transmission_shape(tables, surface.is_inside);
        let color = transmission_color(material, &layers, &shape, surface, wi);
        add(&shape, layers.transmission_probability, color);
    }
    if material.has_coat(surface) {
        let [value, density] = coat_evaluate(material, surface, wi);
        let share = light_density / (light_density + competing * layers.coat_probability * density);
        sum += Vec3::splat(value * share);
    }
    sum
}
