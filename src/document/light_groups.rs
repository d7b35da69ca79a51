//! Light groups: lights under a name, whose light is summed apart and mixed after rendering.

use serde::{Deserialize, Serialize};

use super::{AreaLight, Document, MaterialSettings, group_name::GroupName};
use crate::{job::light_sums::LIGHT_GROUPS_MAX, named::with_defaults};

with_defaults! {
    /// What a group's light is multiplied by after rendering.
    #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default)]
    pub struct LightMix {
        pub group: GroupName,
        /// Factor of its light, at least 0.
        pub factor: f32 = 1.0,
        /// Linear RGB in [0, 1], another factor.
        pub color: [f32; 3] = [1.0; 3],
    }
}

impl LightMix {
    /// The mix that leaves a group's light as it is.
    pub fn of(group: GroupName) -> Self {
        Self {
            group,
            ..Self::default()
        }
    }
}

impl AreaLight {
    /// The name of its group: its own, or by its kind `sun` or `lights`.
    pub fn group_name(&self) -> GroupName {
        match (self.group.is_empty(), self.is_sun()) {
            (false, _) => self.group,
            (true, true) => GroupName::new("sun"),
            (true, false) => GroupName::new("lights"),
        }
    }
}

impl Document {
    /// The names of the light groups by number; none unless they are summed apart. First `environment`, then `emission`
    /// where a material emits, then those of the lights that shine. The last of more than [`LIGHT_GROUPS_MAX`] has the light
    /// of those that follow.
    pub fn light_groups(&self) -> Vec<GroupName> {
        if !self.lighting.light_groups {
            return Vec::new();
        }
        let mut names = vec![GroupName::new("environment")];
        if self.materials.iter().any(MaterialSettings::is_emissive) {
            names.push(emission_group());
        }
        for name in self.lighting.shining().map(AreaLight::group_name) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names.truncate(LIGHT_GROUPS_MAX);
        names
    }

    /// What a group's light is multiplied by.
    pub fn light_mix(&self, group: GroupName) -> LightMix {
        let mix = self.lighting.light_mix.iter().find(|mix| mix.group == group);
        mix.copied().unwrap_or(LightMix::of(group))
    }

    /// Sets what a group's light is multiplied by.
    pub fn set_light_mix(&mut self, mix: LightMix) {
        let all = &mut self.lighting.light_mix;
        all.retain(|other| other.group != mix.group);
        if mix != LightMix::of(mix.group) {
            all.push(mix);
        }
    }

    /// The factor per channel of each light group.
    pub fn light_factors(&self) -> Vec<[f64; 3]> {
        let factors = |group: GroupName| {
            let mix = self.light_mix(group);
            mix.color.map(|channel| f64::from(mix.factor) * f64::from(channel))
        };
        self.light_groups().into_iter().map(factors).collect()
    }
}

/// The group of what materials emit.
pub fn emission_group() -> GroupName {
    GroupName::new("emission")
}
