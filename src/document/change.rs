//! What differs between two documents, and what follows from it.

use super::{AreaLight, Document, PARAMETERS, Parameter, SETTINGS, Stage};

/// What differs between two documents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Change {
    /// Tone curve or exposure: how what has been rendered is shown.
    pub display: bool,
    pub camera: bool,
    /// Width or height of the image.
    pub size: bool,
    pub environment: bool,
    /// Rotation or strength of the environment, or the background.
    pub lighting: bool,
    /// A material, or the colour of the ground or of an area light.
    pub materials: bool,
    /// The model, the shape of the ground, or the place of an area light.
    pub geometry: bool,
    /// Bounces, sequence, strategy, seed, pixel filter, effects switched on or off, the part that is rendered.
    pub sampling: bool,
    /// What is to be reached: samples, seconds, noise, of the samples or of the denoised image, and how samples are
    /// shared out on the way.
    pub target: bool,
}

impl Change {
    /// What differs from `old` in `new`. Names and what else no image depends on do not count.
    pub fn between(old: &Document, new: &Document) -> Self {
        let mut change = Self::default();
        for setting in SETTINGS.iter() {
            if setting.get(old) != setting.get(new) {
                *change.at(setting.stage) = true;
            }
        }
        change.beside_settings(old, new);
        change
    }

    /// What a change of a setting of this stage calls for.
    fn at(&mut self, stage: Stage) -> &mut bool {
        match stage {
            Stage::Display => &mut self.display,
            Stage::Goal => &mut self.target,
            Stage::Camera => &mut self.camera,
            Stage::Size => &mut self.size,
            Stage::Sampling => &mut self.sampling,
            Stage::Lighting => &mut self.lighting,
            Stage::Materials => &mut self.materials,
            Stage::Geometry => &mut self.geometry,
        }
    }

    /// What differs in all that is no setting of its own: files, lists, materials.
    fn beside_settings(&mut self, old: &Document, new: &Document) {
        let (light, other_light) = (&old.lighting, &new.lighting);
        let [lights, other_lights] = [light, other_light].map(|light| light.shining().copied().collect::<Vec<_>>());
        let (lights, other_lights) = (&lights[..], &other_lights[..]);
        let (render, other) = (&old.render, &new.render);
        self.environment |= (&light.environment, light.environment_encoding)
            != (&other_light.environment, other_light.environment_encoding);
        self.display |= old.view.lut != new.view.lut || light.light_mix != other_light.light_mix;
        self.lighting |= light.background != other_light.background;
        let are_regrouped = new.lighting.light_groups && !are_grouped_alike(lights, other_lights);
        self.materials |= !look_alike(old, new) || !emit_alike(lights, other_lights) || are_regrouped;
        self.geometry |= (&old.model, &old.import, &old.hidden_objects)
            != (&new.model, &new.import, &new.hidden_objects)
            || !have_same_shapes(lights, other_lights);
        self.sampling |=
            (render.effects, render.region, render.first_sample) != (other.effects, other.region, other.first_sample);
    }

    /// As if nothing had been rendered yet.
    pub fn everything() -> Self {
        Self {
            display: true,
            camera: true,
            size: true,
            environment: true,
            lighting: true,
            materials: true,
            geometry: true,
            sampling: true,
            target: true,
        }
    }

    /// True where the image and the way to it stay as they are.
    pub fn is_none(self) -> bool {
        self == Self::default()
    }

    /// True where what has been rendered no longer counts.
    pub fn restarts(self) -> bool {
        let stays = Self {
            display: self.display,
            target: self.target,
            ..Self::default()
        };
        self != stays
    }
}

fn emit_alike(old: &[AreaLight], new: &[AreaLight]) -> bool {
    old.iter().map(AreaLight::shine).eq(new.iter().map(AreaLight::shine))
}

fn are_grouped_alike(old: &[AreaLight], new: &[AreaLight]) -> bool {
    let groups = |lights: &[AreaLight]| lights.iter().map(AreaLight::group_name).collect::<Vec<_>>();
    groups(old) == groups(new)
}

fn have_same_shapes(old: &[AreaLight], new: &[AreaLight]) -> bool {
    // Hidden ones stand behind the others.
    let placed = |light: &AreaLight| (light.shape(), light.is_hidden);
    old.iter().map(placed).eq(new.iter().map(placed))
}

fn look_alike(old: &Document, new: &Document) -> bool {
    old.materials.len() == new.materials.len()
        && std::iter::zip(&old.materials, &new.materials).all(|(old, new)| {
            let is_same = |parameter: &Parameter| parameter.get(old) == parameter.get(new);
            old.user_textures == new.user_textures && PARAMETERS.iter().all(is_same)
        })
}
