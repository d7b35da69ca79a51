//! Check of a document's numbers against their ranges.

use std::ops::RangeInclusive;

use super::parameter::{LIGHT_PARAMETERS, ParameterError, SETTINGS, Stage};
use super::{AreaLight, Background, Document, range};

/// A setting out of its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettingError {
    /// Of the table.
    #[error(transparent)]
    Setting(#[from] ParameterError),
    /// Of a bookmark's camera.
    #[error("bookmark {0}: {1}")]
    Bookmark(String, ParameterError),
    /// A number of a list.
    #[error("{name} is {value}; it must lie between {low} and {high}")]
    Range {
        name: &'static str,
        value: f64,
        low: f64,
        high: f64,
    },
}

/// See [`Document::check`].
pub(super) fn check(document: &Document) -> Result<(), SettingError> {
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
    let number = (
        "the number of lighting.area_lights",
        lights.len() as f64,
        range::AREA_LIGHTS,
    );
    let background = match document.lighting.background {
        Background::Color(color) => color.map(f64::from),
        _ => [0.0; 3],
    };
    let background = background.map(|value| ("lighting.background", value, range::COLOR));
    let sides = render_region(document);
    let numbers = lights
        .iter()
        .flat_map(numbers)
        .chain(background)
        .chain(sides)
        .chain([number]);
    for (name, value, range) in numbers {
        if !range.contains(&value) {
            let (low, high) = range.into_inner();
            return Err(SettingError::Range { name, value, low, high });
        }
    }
    Ok(())
}

/// What an area light is checked for.
fn numbers(light: &AreaLight) -> impl Iterator<Item = (&'static str, f64, RangeInclusive<f64>)> {
    let numbers = LIGHT_PARAMETERS.iter().flat_map(|parameter| parameter.numbers(light));
    numbers.map(|(key, value, [low, high])| (key, value, low..=high))
}

/// The sides of the rendered part: within the image, and not empty.
fn render_region(document: &Document) -> [(&'static str, f64, RangeInclusive<f64>); 4] {
    let [left, top, right, bottom] = document.render.region.unwrap_or([0.0, 0.0, 1.0, 1.0]);
    let far = |near: f64| near.next_up()..=1.0;
    [
        ("render.region", left, range::REGION),
        ("render.region", top, range::REGION),
        ("render.region", right, far(left)),
        ("render.region", bottom, far(top)),
    ]
}
