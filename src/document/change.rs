//! What differs between two documents, and what follows from it.

use super::{AreaLight, Document, PARAMETERS, RenderSettings};

/// What differs between two documents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Change {
    /// Tone curve or exposure: how what has been rendered is shown.
    pub display: bool,
    /// The camera.
    pub camera: bool,
    /// Width or height of the picture.
    pub size: bool,
    /// Another environment map.
    pub environment: bool,
    /// Rotation or strength of the environment, or the background.
    pub lighting: bool,
    /// A material, or the colour of the ground or of an area light.
    pub materials: bool,
    /// The model, whether there is a ground, or the place of an area light.
    pub geometry: bool,
    /// Bounces, sequence, strategy, seed, pixel filter, effects switched on or off, the part that is rendered.
    pub sampling: bool,
    /// What is to be reached: samples, seconds, noise, of the samples or of the denoised picture, and how samples are
    /// shared out on the way.
    pub target: bool,
}

impl Change {
    /// What differs from `old` in `new`. Names and whatever else no picture depends on do not count.
    pub fn between(old: &Document, new: &Document) -> Self {
        let (light, other_light) = (&old.lighting, &new.lighting);
        let (render, other) = (&old.render, &new.render);
        Self {
            display: old.view != new.view,
            camera: old.camera != new.camera,
            size: (render.width, render.height) != (other.width, other.height),
            environment: (&light.environment, light.environment_encoding)
                != (&other_light.environment, other_light.environment_encoding),
            lighting: (
                light.rotation_deg,
                light.strength,
                light.background,
                light.background_blur_deg,
            ) != (
                other_light.rotation_deg,
                other_light.strength,
                other_light.background,
                other_light.background_blur_deg,
            ),
            materials: light.ground_color != other_light.ground_color
                || !look_alike(old, new)
                || !emit_alike(&light.area_lights, &other_light.area_lights),
            geometry: (&old.model, &old.import, old.ground) != (&new.model, &new.import, new.ground)
                || !have_same_shapes(&light.area_lights, &other_light.area_lights),
            sampling: (
                render.bounces,
                render.firefly_clamp,
                render.sequence,
                render.strategy,
                render.seed,
                render.filter,
                render.effects,
                render.region,
            ) != (
                other.bounces,
                other.firefly_clamp,
                other.sequence,
                other.strategy,
                other.seed,
                other.filter,
                other.effects,
                other.region,
            ),
            target: aim(render) != aim(other) || old.view.denoise != new.view.denoise,
        }
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

    /// True where the picture and the way to it stay as they are.
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

fn aim(render: &RenderSettings) -> impl PartialEq {
    let RenderSettings {
        samples,
        time_s,
        noise,
        min_samples,
        ..
    } = *render;
    (samples, time_s, noise, min_samples, render.is_adaptive())
}

fn emit_alike(old: &[AreaLight], new: &[AreaLight]) -> bool {
    let emission = |light: &AreaLight| (light.color, light.strength);
    old.iter().map(emission).eq(new.iter().map(emission))
}

fn have_same_shapes(old: &[AreaLight], new: &[AreaLight]) -> bool {
    old.iter().map(AreaLight::shape).eq(new.iter().map(AreaLight::shape))
}

fn look_alike(old: &Document, new: &Document) -> bool {
    old.materials.len() == new.materials.len()
        && std::iter::zip(&old.materials, &new.materials).all(|(old, new)| {
            PARAMETERS
                .iter()
                .all(|parameter| parameter.get(old) == parameter.get(new))
        })
}
