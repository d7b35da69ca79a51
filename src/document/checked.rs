//! Check of a document's numbers against their ranges.

use std::ops::RangeInclusive;

use super::{
    Background, Document,
    parameter::{LIGHT_PARAMETERS, ParameterError, SETTINGS, Stage},
    range,
};

/// A setting out of its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettingError {
    #[error(transparent)]
    Setting(#[from] ParameterError),
    /// Of a bookmark's camera.
    #[error("bookmark {0}: {1}")]
    Bookmark(String, ParameterError),
}

/// See [`Document::check`].
pub fn check(document: &Document) -> Result<(), SettingError> {
    for setting in SETTINGS.iter() {
        setting.check(&setting.get(document))?;
    }
    for bookmark in &document.bookmarks {
        let seen = Document {
            camera: bookmark.camera,
            ..Document::default()
        };
        for setting in SETTINGS.iter().filter(|setting| setting.stage == Stage::Camera) {
            let checked = setting.check(&setting.get(&seen));
            checked.map_err(|error| SettingError::Bookmark(bookmark.name.clone(), error))?;
        }
    }
    let lights = &document.lighting.area_lights;
    for (light, parameter) in lights
        .iter()
        .flat_map(|light| LIGHT_PARAMETERS.iter().map(move |row| (light, row)))
    {
        parameter.check(&parameter.get(light))?;
    }
    within("lighting.area_lights", lights.len() as f64, range::AREA_LIGHTS)?;
    if let Background::Color(color) = document.lighting.background {
        color
            .into_iter()
            .try_for_each(|x| within("lighting.background", x.into(), range::COLOR))?;
    }
    // The sides of the rendered part: within the image, and not empty.
    let [left, top, right, bottom] = document.render.region.unwrap_or([0.0, 0.0, 1.0, 1.0]);
    let far = |near: f64| near.next_up()..=1.0;
    let sides = [
        (left, range::REGION),
        (top, range::REGION),
        (right, far(left)),
        (bottom, far(top)),
    ];
    Ok(sides
        .into_iter()
        .try_for_each(|(side, range)| within("render.region", side, range))?)
}

/// Whether a number that has no parameter lies in its range.
fn within(key: &'static str, value: f64, range: RangeInclusive<f64>) -> Result<(), ParameterError> {
    if range.contains(&value) {
        return Ok(());
    }
    let (low, high) = range.into_inner();
    Err(ParameterError::Invalid {
        key,
        value: value.to_string(),
        expected: format!("give a number from {low} to {high}"),
    })
}
