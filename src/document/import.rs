//! The materials of a model's file as materials of ours: glTF's roughness is that of GGX, and other lobes get the
//! roughness at which they look alike.

use std::sync::LazyLock;

use super::{CoatLobe, MaterialSettings};
use crate::named::named;
use crate::optics::lobe::{Lobe, Width};
use crate::optics::material::MATCHED_NODES;
use crate::optics::table::table_lookup;
use crate::scene::texture::TextureTarget;
use crate::scene::{AlphaMode, Slot};

named! {
    /// The lobe that a model's materials get.
    #[derive(Default)]
    ImportLobe {
        #[default]
        Geometric, "geometric", "Geometric",
            "The geometric lobe, its roughness matched to the look of GGX; GGX itself where it is rougher than 0.7.";
        Ggx, "ggx", "GGX", "GGX with the roughness of the file.";
    }
}

impl ImportLobe {
    /// The lobe of a slot's material: GGX where any of it is rougher than the geometric lobe can be. Of a textured slot the
    /// texels count, if the factor is 1, which alone is a factor that the geometric lobe has beyond its reach.
    pub fn of_slot(self, slot: &Slot) -> Self {
        if slot.specular.max(slot.metalness).max(slot.transmission) == 0.0 {
            return self;
        }
        let is_whole = slot.roughness == 1.0;
        self.at_roughest(if is_whole { slot.roughest_texel } else { slot.roughness })
    }

    /// The lobe of a material that is as rough as this at its roughest: beyond [`ROUGHNESS_MAX`] it is GGX.
    pub fn at_roughest(self, roughest: f32) -> Self {
        if roughest > ROUGHNESS_MAX { Self::Ggx } else { self }
    }

    /// Gives a material that has the roughness of a file this lobe.
    pub fn apply(self, material: &mut MaterialSettings) {
        match self {
            Self::Geometric => {
                material.lobe = Lobe::Geometric;
                material.roughness = geometric_from_ggx(material.roughness);
            }
            Self::Ggx => material.lobe = Lobe::Ggx,
        }
    }
}

impl MaterialSettings {
    /// GGX's roughness that looks like the lobe of this one.
    pub fn ggx_roughness(&self, roughness: f32) -> f32 {
        match self.lobe.traits().width {
            Width::Roughness => ggx_from_geometric(roughness),
            Width::Fixed | Width::Alpha => roughness,
        }
    }

    /// GGX's roughness that looks like the coat's.
    pub fn coat_ggx_roughness(&self) -> f32 {
        match self.coat_lobe {
            CoatLobe::Geometric => ggx_from_geometric(self.coat_roughness),
            CoatLobe::Ggx => self.coat_roughness,
        }
    }

    /// Gives the coat GGX's roughness of a file: by this lobe, or by GGX where it is rougher than the other can be.
    pub fn set_coat_ggx_roughness(&mut self, roughness: f32, lobe: ImportLobe) {
        (self.coat_lobe, self.coat_roughness) = match lobe.at_roughest(roughness) {
            ImportLobe::Geometric => (CoatLobe::Geometric, geometric_from_ggx(roughness)),
            ImportLobe::Ggx => (CoatLobe::Ggx, roughness),
        };
    }

    /// The material that a model's file gives one of its slots, which looks up the textures that the slot has. What is
    /// out of range is brought into it. The lobe's roughness is the one that looks like the file's.
    pub fn from_slot(slot: &Slot, lobe: ImportLobe) -> Self {
        let unit = |x: f32| x.clamp(0.0, 1.0);
        let strength = slot.emission.into_iter().fold(0.0_f32, f32::max);
        let mut material = Self {
            name: slot.name.clone(),
            base_color: slot.base_color,
            diffuse_roughness: slot.diffuse_roughness,
            metalness: slot.metalness,
            roughness: unit(slot.roughness),
            ior: slot.ior,
            specular_weight: slot.specular,
            specular_on_metal: false,
            specular_color: slot.specular_color,
            anisotropy: slot.anisotropy,
            extra: slot.kept.clone(),
            ..Self::default()
        };
        lobe.of_slot(slot).apply(&mut material);
        for &target in TextureTarget::ALL {
            material.textures[target] |= slot.texture(target).is_some();
        }
        material.textures[TextureTarget::BaseColor] |= slot.has_vertex_colors && !slot.is_unlit;
        material.textures[TextureTarget::Emission] |= slot.has_vertex_colors && slot.is_unlit;
        material.textures[TextureTarget::Opacity] = slot.alpha_mode != AlphaMode::Opaque;
        material.normal_strength = slot.normal_scale;
        if slot.alpha_mode != AlphaMode::Opaque {
            material.opacity = slot.opacity;
        }
        material.coat_weight = slot.coat;
        material.coat_ior = slot.coat_ior;
        material.coat_normal_strength = slot.coat_normal_scale;
        if slot.coat > 0.0 {
            material.set_coat_ggx_roughness(unit(slot.coat_roughness), lobe);
            (material.coat_on_base, material.coat_darkening) = (slot.coat_on_base, slot.coat_darkening);
            (material.coat_color, material.coat_anisotropy) = (slot.coat_color, slot.coat_anisotropy);
        }
        (material.fuzz_weight, material.fuzz_color) = (slot.fuzz, slot.fuzz_color);
        material.fuzz_roughness = slot.fuzz_roughness;
        material.film_weight = slot.film;
        material.film_thickness = slot.film_thickness;
        material.film_ior = slot.film_ior;
        material.transmission_weight = slot.transmission;
        if slot.attenuation_distance.is_finite() {
            material.transmission_color = slot.attenuation_color;
            material.transmission_depth = slot.attenuation_distance;
        } else if slot.transmission > 0.0 {
            material.transmission_color = material.base_color;
        }
        if strength > 0.0 {
            material.emission_color = slot.emission.map(|x| x / strength);
            material.emission_strength = strength;
        }
        material.bring_into_range();
        // A turn may be several.
        material.rotation_deg = slot.anisotropy_rotation_rad.to_degrees();
        material
    }
}

/// The roughest GGX that the geometric lobe can be as wide as.
pub const ROUGHNESS_MAX: f32 = 0.7;

/// The angle in degrees within which half of what GGX of this roughness mirrors lies, under a view along the normal: half
/// the facets that mirror upwards are tilted by less than half of it.
fn ggx_median_deg(roughness: f64) -> f64 {
    let square = roughness.powi(4);
    2.0 * (square / (1.0 + 2.0 * square)).sqrt().atan().to_degrees()
}

/// The geometric lobe's roughness at which half of what it mirrors lies within the same angle as of GGX, at
/// [`MATCHED_NODES`] roughnesses of GGX from 0 to 1, for the curve of new materials (mathematics, section 9).
pub static MATCHED: LazyLock<[f32; MATCHED_NODES]> = LazyLock::new(|| {
    std::array::from_fn(|node| {
        let median = ggx_median_deg(node as f64 / (MATCHED_NODES - 1) as f64) / 45.0;
        // The root of median = R (3 + 4 R)/7.
        (((9.0 + 112.0 * median).sqrt() - 3.0) / 8.0).min(1.0) as f32
    })
});

/// The geometric lobe's roughness that looks like this one of GGX, both in [0, 1].
pub fn geometric_from_ggx(roughness: f32) -> f32 {
    table_lookup(&*MATCHED, 0, MATCHED_NODES, roughness)
}

/// The least roughness of GGX that looks like this one of the geometric lobe; 1 where none is rough enough.
pub fn ggx_from_geometric(roughness: f32) -> f32 {
    let last = (MATCHED_NODES - 1) as f32;
    let Some(node) = MATCHED.iter().position(|matched| *matched >= roughness) else {
        return 1.0;
    };
    let Some(before) = node.checked_sub(1) else { return 0.0 };
    let (low, high) = (MATCHED[before], MATCHED[node]);
    (before as f32 + (roughness - low) / (high - low)) / last
}

/// The roughness of GGX that a texture multiplies where the geometric lobe has this one: all of it at 1, so that no texel is
/// cut off.
pub fn ggx_under_texture(roughness: f32) -> f32 {
    if roughness >= 1.0 {
        1.0
    } else {
        ggx_from_geometric(roughness)
    }
}
