//! Light groups: lights under a name, whose light is summed apart and mixed after rendering.

use serde::{Deserialize, Serialize};

use super::group_name::GroupName;
use super::{AreaLight, Document, MaterialSettings};
use crate::job::light_sums::LIGHT_GROUPS_MAX;

/// What a group's light is multiplied by after rendering.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LightMix {
    /// The group.
    pub group: GroupName,
    /// Factor of its light, at least 0.
    pub factor: f32,
    /// Linear RGB in [0, 1], another factor.
    pub color: [f32; 3],
}

impl Default for LightMix {
    fn default() -> Self {
        Self::of(GroupName::default())
    }
}

impl LightMix {
    /// The mix that leaves a group's light as it is.
    pub fn of(group: GroupName) -> Self {
        Self {
            group,
            factor: 1.0,
            color: [1.0; 3],
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_has_what_a_layer_may_be_called() {
        for (text, name) in [
            ("key", "key"),
            ("Rim light 2", "Rim-light-2"),
            ("a.b/ä", "ab"),
            ("", ""),
            ("0123456789012345678901234567", "012345678901234567890123"),
        ] {
            assert_eq!(GroupName::new(text).as_str(), name);
        }
    }

    #[test]
    fn groups_are_those_of_what_shines() {
        let mut document = Document::default();
        assert!(document.light_groups().is_empty());
        document.lighting.light_groups = true;
        let key = AreaLight {
            group: GroupName::new("key"),
            ..AreaLight::default()
        };
        let muted = AreaLight {
            is_muted: true,
            group: GroupName::new("muted"),
            ..key
        };
        document.lighting.area_lights = vec![AreaLight::default(), key, muted, AreaLight::sun(), AreaLight::spot()];
        let names: Vec<_> = document.light_groups().into_iter().map(String::from).collect();
        assert_eq!(names, ["environment", "lights", "key", "sun"]);
        document.materials[0].emission_strength = 1.0;
        assert_eq!(document.light_groups()[1], emission_group());
        document.set_light_mix(LightMix {
            factor: 0.5,
            color: [1.0, 0.5, 0.0],
            ..LightMix::of(key.group)
        });
        assert_eq!(document.light_factors()[3], [0.5, 0.25, 0.0]);
        document.set_light_mix(LightMix::of(key.group));
        assert!(document.lighting.light_mix.is_empty());
    }

    #[test]
    fn groups_beyond_the_last_share_it() {
        let mut document = Document::default();
        document.lighting.light_groups = true;
        let light = |number: usize| AreaLight {
            group: GroupName::new(&number.to_string()),
            ..AreaLight::default()
        };
        document.lighting.area_lights = (0..40).map(light).collect();
        assert_eq!(document.light_groups().len(), LIGHT_GROUPS_MAX);
    }
}
