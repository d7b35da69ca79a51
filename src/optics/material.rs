//! The material as the integrators see it: a specular lobe over a base that is Lambertian, or refracts, or is a mixture
//! of both, and covers over all. What each layer does with light is said in [`layer`](super::layer).
//!
//! The specular lobe reflects the Fresnel share; what it leaves over reaches the base. How much that is on average over
//! the lobe, its albedo, is tabulated for each material ([`albedo_table`]), so that a white base under any lobe reflects
//! or transmits all light: the layering neither loses nor makes energy. A material that transmits has a second table for
//! views from within, from where the base's light is refracted into the solid, so that all of it gets out again. Lobes made
//! of facets refract at each facet what that facet does not reflect.

use super::curve::Curve;
use super::frame::{Frame, frame_from_normal};
use super::fresnel::{Fresnel, FresnelTerms};
use super::lobe::{Horizon, Lobe, LobeShape};
use super::real::{Mask, Real, Scalar};
use super::vector::{Vec3, vec3};

/// The number of a texture that is not there.
pub const NO_TEXTURE: u32 = u32::MAX;
/// Nodes of the table that has a lobe's roughness for that of GGX.
pub const MATCHED_NODES: usize = 17;

/// Flag: the colours at the vertices multiply the base colour.
pub const VERTEX_BASE: u32 = 1;
/// Flag: the colours at the vertices multiply the emission.
pub const VERTEX_EMISSION: u32 = 2;
/// Flag: the alpha at the vertices multiplies the opacity.
pub const VERTEX_OPACITY: u32 = 4;
/// Flag: weight and tint of the reflection are the dielectric's alone.
pub const SPARES_METAL: u32 = 8;

/// A field's value in another precision.
trait Cast<U> {
    type Output;
    fn cast(self) -> Self::Output;
}

impl<T: Scalar, U: Real> Cast<U> for T {
    type Output = U;
    fn cast(self) -> U {
        U::from_f64(self.to_f64())
    }
}

impl<T: Scalar, U: Real> Cast<U> for Vec3<T> {
    type Output = Vec3<U>;
    fn cast(self) -> Vec3<U> {
        Vec3::from_f64(self.to_f64())
    }
}

impl<U> Cast<U> for u32 {
    type Output = Self;
    fn cast(self) -> Self {
        self
    }
}

impl<U> Cast<U> for [u32; 4] {
    type Output = Self;
    fn cast(self) -> Self {
        self
    }
}

/// A field of [`Material`] as the GPU reads it.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// Its type in Rust, whose numbers are `T`.
    pub of_type: &'static str,
    /// Where it begins, bytes.
    pub offset: usize,
    /// Its length, bytes.
    pub size: usize,
}

macro_rules! material {
    ($(#[$doc:meta])* Material { $($(#[$of_field:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[repr(C)]
        pub struct Material<T> {
            $($(#[$of_field])* pub $field: $type,)*
        }

        /// The fields of [`Material`] in their order: the shaders' structure is made of them.
        pub const FIELDS: &[Field] = {
            type T = f32;
            &[$(Field {
                name: stringify!($field),
                of_type: stringify!($type),
                offset: std::mem::offset_of!(Material<T>, $field),
                size: size_of::<$type>(),
            }),*]
        };

        impl<T: Scalar> Material<T> {
            /// The same material in another precision.
            pub fn cast<U: Real>(&self) -> Material<U> {
                Material { $($field: Cast::<U>::cast(self.$field),)* }
            }
        }
    };
}

material! {
    /// A material with its tables' places. The f32 form is what the GPU reads, byte for byte. A vector is followed by a
    /// number or an index, and the whole fills rows of 16 bytes.
    Material {
        /// Albedo of the Lambertian base, or reflectance of the metal at normal incidence; linear RGB in [0, 1].
        base_color: Vec3<T>,
        /// 0: dielectric over a diffuse base; 1: metal.
        metalness: T,
        /// Tint of the specular reflection, linear RGB.
        specular_color: Vec3<T>,
        /// Share of the specular reflection that is kept, in [0, 1].
        specular_weight: T,
        /// Real part of the conductor's index of refraction.
        eta: Vec3<T>,
        /// The dielectric's index of refraction.
        ior: T,
        /// Imaginary part of the conductor's index of refraction.
        k: Vec3<T>,
        /// Roughness in [0, 1].
        roughness: T,
        /// Emitted radiance, linear RGB.
        emission: Vec3<T>,
        /// Stretch of the lobe in [−1, 1].
        anisotropy: T,
        /// Tint at each refraction, linear RGB in [0, 1].
        transmission_tint: Vec3<T>,
        /// Share of the base that refracts, in [0, 1].
        transmission_weight: T,
        /// What a length of 1 of the interior absorbs, as the negative logarithm of what it lets through; linear RGB.
        absorption: Vec3<T>,
        /// Roughness of the refraction in [0, 1].
        transmission_roughness: T,
        /// Turn of the tangent, radians.
        rotation_rad: T,
        /// [`Lobe`] as a number.
        lobe: u32,
        /// [`Curve`] as a number.
        curve: u32,
        /// [`Horizon`] as a number.
        horizon: u32,
        /// [`Fresnel`] as a number.
        fresnel: u32,
        /// Where the custom curve's table begins.
        curve_table: u32,
        /// Where the albedo table begins.
        albedo_table: u32,
        /// Where the albedo table for views from within begins.
        inner_albedo_table: u32,
        /// What the metal's reflection is multiplied by near 82 degrees, linear RGB in [0, 1].
        edge_tint: Vec3<T>,
        /// Share of light that the surface stops, in [0, 1].
        opacity: T,
        /// What a coat of weight 1 leaves of the light that crosses it twice, linear RGB in [0, 1].
        coat_color: Vec3<T>,
        /// Share of the surface that has a coat, in [0, 1].
        coat_weight: T,
        /// Roughness of the coat in [0, 1].
        coat_roughness: T,
        /// Index of refraction of the coat.
        coat_ior: T,
        /// Where the coat's albedo table begins.
        coat_table: u32,
        /// The luminance by which the surface is sampled as a light: the mean over its emission texture.
        light_luminance: T,
        /// Textures of base colour, roughness, normal, emission; [`NO_TEXTURE`] where there is none.
        textures: [u32; 4],
        /// The texture whose alpha multiplies the opacity, or [`NO_TEXTURE`].
        opacity_texture: u32,
        /// The surface is there where its opacity reaches this; negative where the opacity is a share.
        alpha_cutoff: T,
        /// Scales the slopes of the normal texture.
        normal_strength: T,
        /// 1 where the surface is metal in part or changes from point to point: the albedo tables go over the roughness too
        /// ([`rough_albedo_table`](super::albedo::rough_albedo_table)).
        has_rough_tables: u32,
        /// The roughness that the texture multiplies: that of GGX where `roughness_table` is there.
        texture_roughness: T,
        /// Where the table begins that has the lobe's roughness for that of GGX; [`NO_TEXTURE`] where both are the same.
        roughness_table: u32,
        /// [`VERTEX_BASE`] and the others.
        flags: u32,
        /// With `spot_offset`: the ramp of a spot's share over the cosine to the way it faces
        /// ([`spot_share`](crate::scene::light::spot_share)); 0 and 1 where the surface shines into all directions.
        spot_scale: T,
        /// See `spot_scale`.
        spot_offset: T,
        /// The texture of the metalness, or [`NO_TEXTURE`].
        metalness_texture: u32,
        /// The texture that multiplies the weight of the coat, or [`NO_TEXTURE`].
        coat_texture: u32,
        /// 1 where a texture lies on the surface as on a box.
        has_box_projection: u32,
    }
}

// SAFETY: f32 and u32 fields without padding, which `has_no_padding` checks; any bit pattern is valid.
unsafe impl bytemuck::Zeroable for Material<f32> {}
// SAFETY: as above.
unsafe impl bytemuck::Pod for Material<f32> {}

/// The fields fill the structure, and the structure fills rows of 16 bytes.
const fn has_no_padding() -> bool {
    let (mut end, mut index) = (0, 0);
    while index < FIELDS.len() {
        if FIELDS[index].offset != end {
            return false;
        }
        end += FIELDS[index].size;
        index += 1;
    }
    end == size_of::<Material<f32>>() && end.is_multiple_of(16)
}
const _: () = assert!(has_no_padding());

impl<T: Real> Material<T> {
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
    pub fn transmission_shape<'a>(&self, tables: &'a [f32], is_inside: T::Mask) -> LobeShape<'a, T> {
        LobeShape {
            roughness: self.transmission_roughness,
            eta: self.ior_ahead(is_inside),
            ..self.shape(tables)
        }
    }

    /// The index of refraction behind the surface over that before it: inverted where a material that transmits is seen
    /// from within.
    #[inline(always)]
    pub fn ior_ahead(&self, is_inside: T::Mask) -> T {
        T::select(is_inside & self.transmits(), T::one() / self.ior, self.ior)
    }

    /// The Fresnel factor's terms. From within, weight and tint have no effect: the interface is the bare dielectric, so
    /// that what is reflected totally keeps its energy.
    #[inline(always)]
    pub fn fresnel_terms(&self, is_inside: T::Mask) -> FresnelTerms<T> {
        let is_bare = is_inside & self.transmits();
        let white = Vec3::splat(T::one());
        let tint = Vec3::select(is_bare, white, self.specular_color);
        let weight = T::select(is_bare, T::one(), self.specular_weight);
        let spares_metal = self.has_flag(SPARES_METAL);
        FresnelTerms {
            model: by_index(Fresnel::ALL, self.fresnel),
            metal_f0: self.base_color,
            metalness: self.metalness,
            edge_tint: self.edge_tint,
            tint,
            metal_tint: if spares_metal { white } else { tint * weight },
            weight,
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
        let is_masked = self.opacity.less(self.alpha_cutoff);
        let is_clear = self.alpha_cutoff.less(T::zero()) & self.opacity.less(T::one());
        let is_varied = self.opacity_texture != NO_TEXTURE || self.has_flag(VERTEX_OPACITY);
        is_masked.any() || is_clear.any() || is_varied
    }

    /// True where this flag is set.
    #[inline(always)]
    pub fn has_flag(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }

    /// True where it changes from point to point: by a texture, or between the vertices.
    #[inline(always)]
    pub fn is_varied(&self) -> bool {
        self.is_textured() || self.has_flag(VERTEX_BASE | VERTEX_EMISSION)
    }

    /// True where a Lambertian base shows.
    #[inline(always)]
    pub fn has_base(&self) -> T::Mask {
        let is_opaque = self.transmission_weight.less(T::one());
        is_opaque & self.metalness.less(T::one()) & T::zero().less(self.base_color.max_component())
    }

    /// True where light goes through the surface.
    #[inline(always)]
    pub fn transmits(&self) -> T::Mask {
        T::zero().less(self.transmission_weight) & self.metalness.less(T::one())
    }

    /// True where the specular lobe reflects anything: if not from without, then from within.
    #[inline(always)]
    pub fn has_specular(&self) -> T::Mask {
        let is_spared = T::Mask::splat(self.has_flag(SPARES_METAL));
        let may_be_metal = T::zero().less(self.metalness) | T::Mask::splat(self.metalness_texture != NO_TEXTURE);
        T::zero().less(self.specular_weight) | (is_spared & may_be_metal) | self.transmits()
    }
}

/// The registry's entry with this index; the first one where there is none.
#[inline(always)]
pub(super) fn by_index<E: Copy>(all: &[E], index: u32) -> E {
    all[(index as usize).min(all.len() - 1)]
}

/// How a surface point is lit and seen.
#[derive(Clone, Copy, Debug)]
pub struct Surface<T: Real> {
    /// The shading frame, on the side of the viewer.
    pub frame: Frame<T>,
    /// The geometric normal, on the side of the viewer.
    pub normal: Vec3<T>,
    /// Towards the viewer.
    pub wo: Vec3<T>,
    /// The shading normal without the normal texture, on the side of the viewer: a coat is smooth over it.
    pub coat_normal: Vec3<T>,
    /// True where the viewer is on the back of the triangle: within the solid, if its mesh is closed.
    pub is_inside: T::Mask,
}

impl<T: Real> Surface<T> {
    /// A surface whose normal is z, seen from without along `wo`.
    pub fn upwards(wo: Vec3<T>) -> Self {
        let normal = vec3(T::zero(), T::zero(), T::one());
        Self {
            frame: frame_from_normal(normal),
            normal,
            wo,
            coat_normal: normal,
            is_inside: T::Mask::splat(false),
        }
    }
}
