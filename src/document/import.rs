//! The materials of a model's file as materials of ours: glTF's roughness is that of GGX, and other lobes get the
//! roughness at which they look alike.

use std::sync::LazyLock;

use super::{CoatLobe, MaterialSettings, parameter};
use crate::{
    named::named,
    optics::{lobe::Lobe, lobe::Width, material::MATCHED_NODES, table::table_lookup},
    scene::{AlphaMode, Slot, texture::TextureTarget},
};

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

    /// GGX's roughness that looks like that of [`MaterialSettings::coat_lobe`].
    pub fn coat_ggx_roughness(&self) -> f32 {
        match self.coat_lobe {
            CoatLobe::Geometric => ggx_from_geometric(self.coat_roughness),
            CoatLobe::Ggx => self.coat_roughness,
        }
    }

    /// Sets `coat_roughness` from GGX's of a file: by this lobe, or by GGX where it is rougher than the other can be.
    pub fn set_coat_ggx_roughness(&mut self, roughness: f32, lobe: ImportLobe) {
        (self.coat_lobe, self.coat_roughness) = match lobe.at_roughest(roughness) {
            ImportLobe::Geometric => (CoatLobe::Geometric, geometric_from_ggx(roughness)),
            ImportLobe::Ggx => (CoatLobe::Ggx, roughness),
        };
    }

    /// The material of a file that says nothing of it: other programs know GGX alone.
    pub fn of_file() -> Self {
        Self {
            name: String::new(),
            metalness: 0.0,
            specular_on_metal: false,
            lobe: Lobe::Ggx,
            roughness: 0.5,
            coat_lobe: CoatLobe::Ggx,
            coat_roughness: 0.0,
            coat_on_base: false,
            coat_darkening: 0.0,
            ..Self::default()
        }
    }

    /// The material that a model's file gives one of its slots, which looks up the textures that the slot has. What is
    /// out of range is brought into it. The lobe's roughness is the one that looks like the file's.
    pub fn from_slot(slot: &Slot, lobe: ImportLobe) -> Self {
        let mut material = Self {
            name: slot.name.clone(),
            extra: slot.kept.clone(),
            ..Self::of_file()
        };
        for (key, value) in &slot.values {
            if let Ok(parameter) = parameter(key) {
                parameter.put_rgb(&mut material, *value);
            }
        }
        let uses = &mut material.textures;
        for &target in TextureTarget::ALL {
            uses[target] |= slot.texture(target).is_some();
        }
        uses[TextureTarget::BaseColor] |= slot.has_vertex_colors && !slot.is_unlit;
        uses[TextureTarget::Emission] |= slot.has_vertex_colors && slot.is_unlit;
        uses[TextureTarget::Opacity] = slot.alpha_mode != AlphaMode::Opaque;
        if slot.alpha_mode == AlphaMode::Opaque {
            material.opacity = 1.0;
        }
        if material.transmission_weight > 0.0 && material.transmission_depth == 0.0 {
            material.transmission_color = material.base_color;
        }
        // A turn may be several.
        material.rotation_deg %= 360.0;
        material.with_lobe(lobe, slot.roughest_texel)
    }

    /// A file's material in range, by a lobe that looks like its GGX. GGX it stays where any of it is rougher than the geometric lobe
    /// can be. Of a textured one the roughest texel counts, if the factor is 1, which alone is a factor that the geometric lobe
    /// has beyond its reach.
    pub fn with_lobe(mut self, lobe: ImportLobe, roughest_texel: f32) -> Self {
        (self.emission_strength, self.emission_color) = self.strength_and_color();
        self.bring_into_range();
        let is_seen = self.specular_weight.max(self.metalness).max(self.transmission_weight) > 0.0;
        let roughest = match self.roughness {
            1.0 => roughest_texel,
            roughness => roughness,
        };
        let of_base = if is_seen { lobe.at_roughest(roughest) } else { lobe };
        of_base.apply(&mut self);
        if self.coat_weight > 0.0 {
            self.set_coat_ggx_roughness(self.coat_roughness, lobe);
        } else {
            // That of a new material.
            let new = Self::default();
            (self.coat_lobe, self.coat_roughness) = (new.coat_lobe, new.coat_roughness);
            (self.coat_on_base, self.coat_darkening) = (new.coat_on_base, new.coat_darkening);
        }
        self
    }

    /// Emitted radiance.
    pub fn emission(&self) -> [f32; 3] {
        self.emission_color.map(|x| (x * self.emission_strength).min(f32::MAX))
    }

    /// The brightest channel of the emission and the colour that makes the emission of it; white where there is none.
    pub fn strength_and_color(&self) -> (f32, [f32; 3]) {
        let emission = self.emission();
        let brightest = emission.into_iter().fold(0.0_f32, f32::max);
        let color = emission.map(|x| if brightest > 0.0 { x / brightest } else { 1.0 });
        (brightest, color)
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
