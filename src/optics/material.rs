//! The material as the integrators see it: a specular lobe over a base, which is Lambertian, refracts, or mixes both; covers
//! lie over all. [`layer`](super::layer) describes each layer.
//!
//! The specular lobe reflects the Fresnel share; the rest reaches the base. Its mean over the lobe, the albedo, is tabulated
//! per material ([`albedo_table`]), so that a white base under any lobe reflects or transmits all light: layering conserves
//! energy. A material that transmits has a second table for views from within, because the base's light is refracted into
//! the solid and must get out again. Microfacet lobes refract at each facet the share that it does not reflect.

use bytemuck::{Pod, Zeroable};

use super::{
    curve::Curve,
    frame::{Frame, frame_from_normal},
    fresnel::{Fresnel, FresnelTerms, fresnel_f0},
    lobe::{Horizon, Lobe, LobeShape},
    target::{TARGETS, TextureTarget},
    thin_film::FilmTerms,
};
use crate::optics::prelude::*;

/// Textures of a [`Material`] in whole rows of 16 bytes.
pub const TEXTURES: usize = TARGETS.next_multiple_of(4);
/// The number of a texture that is not there.
pub const NO_TEXTURE: u32 = u32::MAX;
/// Bit of [`Material::has_rough_tables`]: the tables hold the integrals of [`rough_albedo`](super::albedo::rough_albedo).
pub const HOLDS_INTEGRALS: u32 = 1;
/// Bit of [`Material::has_rough_tables`]: the tables extend over the azimuth of the view, as the lobe is stretched.
pub const OVER_AZIMUTH: u32 = 2;
/// Bit of [`Material::has_rough_tables`]: what the thin film changes follows in a table of its own, as no texture varies it.
pub const HOLDS_FILM: u32 = 4;
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
/// Flag: the lobe gets back what multiple scattering between its facets reflects ([`super::scattering`]).
pub const COMPENSATES: u32 = 16;
/// Flag: the dielectric's index has the weight of the reflection in it, and only a metal's is multiplied by it.
pub const WEIGHS_INDEX: u32 = 64;
/// Flag: the coat changes what lies below it, by its index and its roughness.
pub const COATS_BASE: u32 = 128;
/// Flag: the coat takes more light of some colour the longer the way through it.
pub const COAT_ABSORBS: u32 = 256;
/// Flag: the coat's lobe is GGX, not the geometric lobe.
pub const COAT_IS_GGX: u32 = 512;
/// Flag: a texture uses box projection.
pub const HAS_BOX: u32 = 32;
/// Flag: what it emits depends on the direction as the profile at `lobe_table` says.
pub const HAS_PROFILE: u32 = 1024;
/// Flag: where the thin film is thick, each channel is a band of wavelengths.
pub const FILM_BANDS: u32 = 2048;
/// The flags' bits from here on: the light group of what the material emits, see [`Material::light_group`].
pub const LIGHT_GROUP_SHIFT: u32 = 24;

/// A field's value in another precision.
trait Cast<U> {
    type Output;
    fn cast(self) -> Self::Output;
}

impl<T: Scalar, U: Real> Cast<U> for T {
    type Output = U;
    #[inline(always)]
    fn cast(self) -> U {
        U::from_f64(self.to_f64())
    }
}

impl<T: Scalar, U: Real> Cast<U> for Vec3<T> {
    type Output = Vec3<U>;
    #[inline(always)]
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

impl<U, const N: usize> Cast<U> for [u32; N] {
    type Output = Self;
    fn cast(self) -> Self {
        self
    }
}

/// A field of [`Material`] as the GPU reads it.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Name of the field.
    pub name: &'static str,
    /// Rust type, with numbers of type `T`.
    pub of_type: &'static str,
    /// Offset in bytes.
    pub offset: usize,
    /// Size in bytes.
    pub size: usize,
}

macro_rules! material {
    ($(#[$doc:meta])* Material { $($(#[$of_field:meta])* $field:ident: $type:ty $(= $absent:expr)?,)* }) => {
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
            #[inline(always)]
            pub fn cast<U: Real>(&self) -> Material<U> {
                Material { $($field: Cast::<U>::cast(self.$field),)* }
            }
        }

        /// A material without anything: what is not there is 0, or what its line in the table says.
        impl Default for Material<f32> {
            fn default() -> Self {
                let mut material: Self = Zeroable::zeroed();
                $($(material.$field = $absent;)?)*
                material
            }
        }
    };
}

material! {
    /// A material with the positions of its tables. The GPU reads the f32 form, byte for byte. Each vector is followed by a
    /// number or an index, and the whole fills rows of 16 bytes.
    Material {
        /// Albedo of the diffuse base, or reflectance of the metal at normal incidence; linear RGB in [0, 1].
        base_color: Vec3<T>,
        /// 0: dielectric over a diffuse base; 1: metal.
        metalness: T,
        /// Tint of the specular reflection, linear RGB.
        specular_color: Vec3<T> = Vec3::splat(1.0),
        /// Share of the specular reflection that is kept, in [0, 1].
        specular_weight: T,
        /// Real part of the conductor's index of refraction.
        eta: Vec3<T>,
        /// The dielectric's index of refraction.
        ior: T = 1.0,
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
        /// Absorption coefficient of the interior per unit of length, linear RGB.
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
        /// Start of the lobe's table: the custom curve's, or the energies of GGX ([`scattering_table`](super::scattering::scattering_table)); that of the
        /// profile of a light with [`HAS_PROFILE`], which has no lobe.
        lobe_table: u32,
        /// Start of the albedo table.
        albedo_table: u32,
        /// Start of the albedo table for views from within.
        inner_albedo_table: u32,
        /// Factor of a metal's reflection near 82 degrees, linear RGB in [0, 1].
        edge_tint: Vec3<T> = Vec3::splat(1.0),
        /// Share of light that the surface stops, in [0, 1].
        opacity: T,
        /// Transmittance of a coat of weight 1 in and out, linear RGB in [0, 1].
        coat_color: Vec3<T> = Vec3::splat(1.0),
        /// Share of the surface that has a coat, in [0, 1].
        coat_weight: T,
        /// Roughness of the coat in [0, 1].
        coat_roughness: T,
        /// Index of refraction of the coat.
        coat_ior: T = 1.0,
        /// Start of the coat's albedo table.
        coat_table: u32,
        /// The luminance by which the surface is sampled as a light: the mean over its emission texture.
        light_luminance: T,
        /// The texture of each [`TextureTarget`], or [`NO_TEXTURE`]; the rest fills a row.
        textures: [u32; TEXTURES] = [NO_TEXTURE; TEXTURES],
        /// Opacity cutoff of a masked material; negative for blended opacity.
        alpha_cutoff: T = -1.0,
        /// Scales the slopes of the normal texture.
        normal_strength: T,
        /// [`HOLDS_INTEGRALS`] if the surface is partly metal or varies
        /// ([`rough_albedo_table`](super::albedo::rough_albedo_table)), [`OVER_AZIMUTH`] if the lobe is stretched and of one
        /// roughness, [`HOLDS_FILM`]. 0: tables over the view's cosine alone; 1: over the roughness too.
        has_rough_tables: u32,
        /// Start of the table from GGX's roughness to the lobe's, or [`NO_TEXTURE`] if both are the same.
        roughness_table: u32 = NO_TEXTURE,
        /// [`VERTEX_BASE`] and the others.
        flags: u32,
        /// Slope of a spot's ramp over the cosine to its axis ([`spot_share`](crate::scene::light::spot_share)); 0 for
        /// emission in all directions.
        spot_scale: T,
        /// Offset of a spot's ramp; 1 for emission in all directions.
        spot_offset: T = 1.0,
        /// Roughness of the diffuse base in [0, 1]; 0 is Lambert's.
        diffuse_roughness: T,
        /// Tint of the fuzz, linear RGB in [0, 1].
        fuzz_color: Vec3<T> = Vec3::splat(1.0),
        /// Share of the surface that has fuzz, in [0, 1].
        fuzz_weight: T,
        /// Roughness of the fuzz in [0, 1].
        fuzz_roughness: T,
        /// The dielectric's index for what it reflects, seen from outside: relative to the coat over it.
        reflecting_ior: T = 1.0,
        /// The dielectric's index without a coat, and its weight not in it.
        bare_ior: T = 1.0,
        /// The same over or below that of a coat, at least 1.
        coated_ior: T = 1.0,
        /// What a coat of weight 1 adds to the fourth power of GGX's roughness below it.
        coat_blur: T,
        /// GGX's roughness of the specular lobe without a coat, which a texture multiplies.
        ggx_roughness: T,
        /// How much of the coat's darkening of what lies below shows, in [0, 1].
        coat_darkening: T,
        /// What the coat reflects back inside of light in all directions.
        coat_inner: T,
        /// Stretch of the coat's lobe in [−1, 1].
        coat_anisotropy: T,
        /// Scales the slopes of the coat's normal texture.
        coat_normal_strength: T,
        /// Index of refraction of the thin film.
        film_ior: T = 1.0,
        /// 1 if there is a thin film ([`has_film`](super::thin_film::has_film)).
        has_film: u32,
        /// Phase of a crossing of the thin film at normal incidence over its index, by channel
        /// ([`film_path`](super::thin_film::film_path)).
        film_path: Vec3<T>,
        /// Share of the surface that has a thin film, in [0, 1].
        film_weight: T,
    }
}

// SAFETY: f32 and u32 fields without padding, which `has_no_padding` checks; any bit pattern is valid.
unsafe impl Zeroable for Material<f32> {}
// SAFETY: as above.
unsafe impl Pod for Material<f32> {}

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
    inlined! {
        /// The specular lobe. `tables` holds all materials' tables.
        pub fn shape<'a>(&self, tables: &'a [f32]) -> LobeShape<'a, T> {
            LobeShape {
                lobe: by_index(Lobe::ALL, self.lobe),
                curve: by_index(Curve::ALL, self.curve),
                horizon: by_index(Horizon::ALL, self.horizon),
                roughness: self.roughness,
                anisotropy: self.anisotropy,
                eta: T::ZERO,
                table: tables.get(self.lobe_table as usize..).unwrap_or_default(),
            }
        }

        /// The refracting lobe, seen from within or without.
        pub fn transmission_shape<'a>(&self, tables: &'a [f32], is_inside: T::Mask) -> LobeShape<'a, T> {
            LobeShape {
                roughness: self.transmission_roughness,
                eta: self.ior_ahead(is_inside),
                ..self.shape(tables)
            }
        }

        /// Relative index of refraction, behind over before the surface: inverted if a transmitting material is seen from
        /// within.
        pub fn ior_ahead(&self, is_inside: T::Mask) -> T {
            T::select(is_inside & self.transmits(), T::ONE / self.ior, self.ior)
        }

        /// Relative index of refraction of what is reflected: as [`Self::ior_ahead`], but from outside under the coat.
        fn reflecting_ior_ahead(&self, is_inside: T::Mask) -> T {
            T::select(is_inside & self.transmits(), T::ONE / self.ior, self.reflecting_ior)
        }

        /// The index of what is reflected under a coat of this weight (OpenPBR 1.1, "Coat"): between the index over air and over
        /// the coat, whose ratio is inverted where the coat's index is the greater one.
        pub fn ior_under_coat(&self, weight: T) -> T {
            let one = T::ONE;
            let ior = self.bare_ior + (self.coated_ior - self.bare_ior) * weight;
            if !self.has_flag(WEIGHS_INDEX) {
                return ior;
            }
            let root = (fresnel_f0(ior) * self.specular_weight)
                .min(T::from_f64(0.99))
                .safe_sqrt();
            (one + root) / (one - root)
        }

        /// GGX's roughness under a coat of this weight: facets of both spread the light (OpenPBR 1.1, "Roughening").
        pub fn roughness_under_coat(&self, roughness: T, weight: T) -> T {
            let square = roughness * roughness;
            let blurred = (square * square + self.coat_blur).min(T::ONE).sqrt().sqrt();
            roughness + (blurred - roughness) * weight
        }

        /// Lets what lies below a coat follow the textures of the coat, once they are multiplied.
        pub fn follow_coat(&mut self) {
            if self.has_coated_table() {
                self.reflecting_ior = self.ior_under_coat(self.coat_weight);
            }
            if self.has_texture(&[TextureTarget::CoatRoughness]) && self.coat_blur.above_zero().any() {
                self.coat_blur = coat_blur(self.coat_roughness);
            }
        }

        /// True if its albedo table is followed by that under a whole coat, because a texture varies the coat.
        pub fn has_coated_table(&self) -> bool {
            let has_index = self.fresnel != Fresnel::Conductor as u32;
            has_index && self.has_flag(COATS_BASE) && self.has_texture(&[TextureTarget::Coat])
        }

        /// True if its albedo tables hold the integrals of any Fresnel factor.
        pub fn holds_integrals(&self) -> bool {
            self.has_rough_tables & HOLDS_INTEGRALS != 0
        }

        /// True if its tables extend over the azimuth of the view.
        pub fn is_over_azimuth(&self) -> bool {
            self.has_rough_tables & OVER_AZIMUTH != 0
        }

        /// True if its albedo tables are followed by those of its thin film.
        pub fn has_film_table(&self) -> bool {
            self.has_rough_tables & HOLDS_FILM != 0
        }

        /// True where textures change how the coat changes the roughness below it.
        pub fn has_varied_blur(&self) -> bool {
            let varying = [
                TextureTarget::Roughness,
                TextureTarget::Coat,
                TextureTarget::CoatRoughness,
            ];
            self.has_texture(&varying) && self.coat_blur.above_zero().any()
        }

        /// Terms of the Fresnel factor. From within, weight and tint have no effect: the interface is the bare dielectric, so
        /// that total reflection conserves energy.
        pub fn fresnel_terms(&self, is_inside: T::Mask) -> FresnelTerms<T> {
            let is_bare = is_inside & self.transmits();
            let white = Vec3::ONE;
            let tint = Vec3::select(is_bare, white, self.specular_color);
            let weight = T::select(is_bare, T::ONE, self.specular_weight);
            let spares_metal = self.has_flag(SPARES_METAL);
            let is_in_index = self.has_flag(WEIGHS_INDEX);
            let model = by_index(Fresnel::ALL, self.fresnel);
            let [mut eta, mut k] = [self.eta, self.k];
            let mut before = T::ONE;
            if model == Fresnel::Conductor || self.has_film == 1 {
                before = T::select(is_bare, before, self.ior_of_coat());
                [eta, k] = [eta / before, k / before];
            }
            FresnelTerms {
                model,
                metal_f0: self.base_color,
                metalness: self.metalness,
                edge_tint: self.edge_tint,
                tint,
                metal_tint: if spares_metal { white } else { tint * weight },
                weight: if is_in_index { T::ONE } else { weight },
                ior: self.reflecting_ior_ahead(is_inside),
                eta,
                k,
                before,
                has_film: self.has_film == 1,
                film: self.film_terms(is_bare, before),
            }
        }

        /// The index before the specular interface: of the coat as far as it counts, or air.
        fn ior_of_coat(&self) -> T {
            if !self.has_flag(COATS_BASE) {
                return T::ONE;
            }
            T::ONE + (self.coat_ior - T::ONE) * self.coat_weight
        }

        fn film_terms(&self, within: T::Mask, outside: T) -> FilmTerms<T> {
            if self.has_film == 0 {
                return FilmTerms::none_over(self.ior);
            }
            let [before, behind] = [T::select(within, self.ior, outside), T::select(within, T::ONE, self.ior)];
            FilmTerms {
                weight: self.film_weight,
                ior: self.film_ior / before,
                behind: behind / before,
                path: self.film_path * before,
                has_bands: self.has_flag(FILM_BANDS),
            }
        }
    }

    /// The material where its textures leave the most of base and transmission.
    pub fn least_metallic(&self) -> Self {
        let share = |target, varied: T, plain: T| if self.has_texture(&[target]) { varied } else { plain };
        let half = self.transmission_weight * T::HALF;
        Self {
            metalness: share(TextureTarget::Metalness, T::ZERO, self.metalness),
            transmission_weight: share(TextureTarget::Transmission, half, self.transmission_weight),
            ..*self
        }
    }

    inlined! {
        /// True if textured.
        pub fn is_textured(&self) -> bool {
            self.textures != [NO_TEXTURE; TEXTURES]
        }

        /// The record of a target's texture, or [`NO_TEXTURE`].
        pub fn texture(&self, target: TextureTarget) -> u32 {
            self.textures[target as usize]
        }

        /// True if one of the targets has a texture.
        pub fn has_texture(&self, targets: &[TextureTarget]) -> bool {
            targets.iter().any(|target| self.texture(*target) != NO_TEXTURE)
        }

        /// True if some light may pass straight through the surface.
        pub fn has_holes(&self) -> bool {
            let is_masked = self.opacity.less(self.alpha_cutoff);
            let is_clear = self.alpha_cutoff.below_zero() & self.opacity.less(T::ONE);
            let is_varied = self.has_texture(&[TextureTarget::Opacity]) || self.has_flag(VERTEX_OPACITY);
            is_masked.any() || is_clear.any() || is_varied
        }

        /// True if the flag is set.
        pub fn has_flag(&self, flag: u32) -> bool {
            self.flags & flag != 0
        }

        /// Number of the light group of what it emits.
        pub fn light_group(&self) -> u32 {
            self.flags >> LIGHT_GROUP_SHIFT
        }

        /// True if it varies over the surface: by a texture or vertex colours.
        pub fn is_varied(&self) -> bool {
            self.is_textured() || self.has_flag(VERTEX_BASE | VERTEX_EMISSION)
        }

        /// Lanes with a visible Lambertian base.
        pub fn has_base(&self) -> T::Mask {
            let is_opaque = self.transmission_weight.less(T::ONE);
            is_opaque & self.metalness.less(T::ONE) & self.base_color.max_component().above_zero()
        }

        pub fn transmits(&self) -> T::Mask {
            self.transmission_weight.above_zero() & self.metalness.less(T::ONE)
        }

        /// Lanes where the specular lobe reflects, from outside or from within.
        pub fn has_specular(&self) -> T::Mask {
            let is_spared = T::Mask::splat(self.has_flag(SPARES_METAL));
            let is_varied = self.has_texture(&[TextureTarget::Metalness]);
            let may_be_metal = self.metalness.above_zero() | T::Mask::splat(is_varied);
            // A film reflects in its own right where the index below it is as if it were not there.
            let is_film = T::Mask::splat(self.has_film == 1 && self.has_flag(WEIGHS_INDEX));
            self.specular_weight.above_zero() | (is_spared & may_be_metal) | self.transmits() | is_film
        }
    }
}

/// What a coat of this roughness, that of GGX, adds to the fourth power of the roughness below it: light crosses it twice.
#[inline(always)]
pub fn coat_blur<T: Real>(roughness: T) -> T {
    let square = roughness * roughness;
    T::TWO * square * square
}

/// The registry's entry with this index, or the first one.
pub fn by_index<E: Copy>(all: &[E], index: u32) -> E {
    all[(index as usize).min(all.len() - 1)]
}

/// Geometry of shading at a surface point.
#[derive(Clone, Copy, Debug)]
pub struct Surface<T: Real> {
    /// The shading frame, on the side of the viewer.
    pub frame: Frame<T>,
    /// The geometric normal, on the side of the viewer.
    pub normal: Vec3<T>,
    /// Unit direction to the viewer.
    pub wo: Vec3<T>,
    /// The coat's shading normal, on the side of the viewer: it does not follow the normal texture of what lies below.
    pub coat_normal: Vec3<T>,
    /// True if the viewer is on the triangle's back: inside the solid, for a closed mesh.
    pub is_inside: T::Mask,
}

impl<T: Real> Surface<T> {
    /// A surface whose normal is z, seen from without along `wo`.
    pub fn upwards(wo: Vec3<T>) -> Self {
        let normal = vec3(T::ZERO, T::ZERO, T::ONE);
        Self {
            frame: frame_from_normal(normal),
            normal,
            wo,
            coat_normal: normal,
            is_inside: T::Mask::splat(false),
        }
    }

    inlined! {
        /// The cosine between the view and the shading normal.
        pub fn view_cosine(&self) -> T {
            self.frame.normal.dot(self.wo)
        }

        /// Lanes where the viewer is within a solid that light passes through.
        pub fn is_within(&self, material: &Material<T>) -> T::Mask {
            self.is_inside & material.transmits()
        }
    }
}
