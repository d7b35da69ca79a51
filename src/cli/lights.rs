//! Lights as options of the command line.

use std::ops::RangeInclusive;

use super::parse::{number_in, numbers_in};
use crate::{
    document::{
        AreaLight, AreaLightShape, GroupName, LIGHT_PARAMETERS, LightMix, Parameter, ProfileFile, group_name::NAME_MAX,
        parameter::parse_color, range,
    },
    import::{light_profile, light_profile::LightProfileError},
    optics::blackbody::{TEMPERATURES_K, blackbody_color},
    scene::path_text::path_of_text,
};

/// Luminous flux of a light in lumens, or illuminance of a sun in lux.
const POWER: RangeInclusive<f64> = 0.0..=1e12;

/// A light as an option says it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightArgument {
    light: AreaLight,
    /// See [`AreaLight::power`]: replaces the strength.
    power: Option<f64>,
}

impl LightArgument {
    /// The light in a scene whose bounding radius measures this many metres.
    pub fn in_scene(&self, radius_m: f64) -> AreaLight {
        let mut light = self.light;
        if let Some(power) = self.power {
            light.set_power(power, radius_m);
        }
        light
    }

    /// Whether its profile can be read.
    pub fn check_profile(&self) -> Result<(), LightProfileError> {
        let profile = self.light.profile;
        profile.map_or(Ok(()), |file| light_profile::load(file.path()).map(drop))
    }
}

/// A rectangle, triangle, disc or sphere: six numbers, then words; white where no colour is given.
pub fn area_light(text: &str) -> Result<LightArgument, String> {
    let length = range::AREA_LENGTH;
    let ranges = [
        range::YAW_DEG,
        range::PITCH_DEG,
        length.clone(),
        length.clone(),
        length,
        range::STRENGTH,
    ];
    let end = text.match_indices(',').nth(5).map_or(text.len(), |(end, _)| end);
    let (numbers, words) = text.split_at(end);
    let [yaw_deg, pitch_deg, distance, width, height, strength] = numbers_in(ranges)(numbers)?;
    let light = AreaLight {
        yaw_deg,
        pitch_deg,
        distance,
        width,
        height,
        strength: strength as f32,
        ..AreaLight::default()
    };
    with_words(light, words.trim_start_matches(','))
}

/// A spot, all of whose numbers may be left out.
pub fn spot(text: &str) -> Result<LightArgument, String> {
    with_words(AreaLight::spot(), text)
}

/// The same for a sun.
pub fn sun(text: &str) -> Result<LightArgument, String> {
    with_words(AreaLight::sun(), text)
}

/// The light as words with commas between them change it; what has no `=` goes on with the value before it.
fn with_words(light: AreaLight, text: &str) -> Result<LightArgument, String> {
    let mut argument = LightArgument { light, power: None };
    let mut words: Vec<String> = Vec::new();
    for word in text.split(',').filter(|word| !word.is_empty()) {
        match words.last_mut() {
            Some(last) if last.contains('=') && is_number(word) => *last = format!("{last},{word}"),
            _ => words.push(word.trim().to_owned()),
        }
    }
    for word in &words {
        put_word(&mut argument, word)?;
    }
    if argument.light.profile.is_some() && !argument.light.is_sphere() {
        return Err("profile: only a sphere has one; give --area-light with the word sphere".to_owned());
    }
    Ok(argument)
}

fn is_number(word: &str) -> bool {
    word.trim().parse::<f64>().is_ok()
}

fn put_word(argument: &mut LightArgument, word: &str) -> Result<(), String> {
    let light = &mut argument.light;
    let Some((word, value)) = word.split_once('=') else {
        match word {
            "triangle" => light.shape = AreaLightShape::Triangle,
            "disc" => light.shape = AreaLightShape::Disc,
            "sphere" => light.shape = AreaLightShape::Sphere,
            color if color.starts_with('#') || color.ends_with('K') => light.color = color_of(color)?,
            other => return Err(format!("{other}: {}", expected(light))),
        }
        return Ok(());
    };
    match word {
        "temperature" => light.color = color_of_temperature(value)?,
        "group" => light.group = group_name(value)?,
        "profile" => light.profile = Some(ProfileFile::new(&path_of_text(value))),
        "power" => {
            let power = number_in(POWER)(value).map_err(|expected| format!("power={value}: {expected}"))?;
            argument.power = Some(power);
        }
        _ => {
            let parameter = words_of(light).find(|parameter| parameter.word() == word);
            let parameter = parameter.ok_or_else(|| format!("{word}: {}", expected(light)))?;
            let value = parameter.parse(value).map_err(crate::in_words)?;
            parameter.set(light, value).map_err(crate::in_words)?;
        }
    }
    Ok(())
}

/// The parameters that have an effect on a light, but for its shape.
fn words_of(light: &AreaLight) -> impl Iterator<Item = &'static Parameter<AreaLight>> + use<> {
    let light = *light;
    let has_word =
        move |parameter: &&Parameter<AreaLight>| parameter.word() != "shape" && (parameter.idle)(&light).is_none();
    LIGHT_PARAMETERS.iter().filter(has_word)
}

fn expected(light: &AreaLight) -> String {
    let shapes = match light.shape {
        AreaLightShape::Spot | AreaLightShape::Sun => "",
        _ => "triangle, disc, sphere, ",
    };
    format!(
        "give {shapes}#rrggbb, a temperature such as 3200K, or WORD=VALUE with one of {}, temperature, power, group{}",
        crate::named::joined(words_of(light).map(Parameter::word), ", "),
        if light.is_sphere() { ", profile" } else { "" }
    )
}

/// The name of a light group.
fn group_name(text: &str) -> Result<GroupName, String> {
    let name = GroupName::new(text);
    if name.is_empty() || name.as_str() != text {
        return Err(format!(
            "{text}: give a group's name of at most {NAME_MAX} letters, digits, - and _"
        ));
    }
    Ok(name)
}

/// A group's name, a factor of its light, and perhaps a colour or its temperature.
pub fn light_mix(text: &str) -> Result<LightMix, String> {
    let (name, factors) = text
        .split_once('=')
        .ok_or_else(|| format!("{text}: write GROUP=FACTOR, such as key=0.5 or key=0.5,3200K"))?;
    let (factor, color) = factors.split_once(',').unwrap_or((factors, ""));
    let color = match color {
        "" => [1.0; 3],
        color => color_of(color)?,
    };
    let factor = number_in(range::LIGHT_MIX)(factor).map_err(|expected| format!("{factor}: {expected}"))?;
    Ok(LightMix {
        group: group_name(name)?,
        factor: factor as f32,
        color,
    })
}

/// The colour of a body that shines at a temperature, as in 3200K.
fn color_of(text: &str) -> Result<[f32; 3], String> {
    match text.ends_with('K') {
        true => color_of_temperature(text),
        false => parse_color(text).map_err(crate::in_words),
    }
}

fn color_of_temperature(text: &str) -> Result<[f32; 3], String> {
    let [coldest, hottest] = TEMPERATURES_K;
    let temperature_k = number_in(coldest..=hottest)(text.trim_end_matches('K'));
    temperature_k
        .map(|temperature_k| blackbody_color(temperature_k).map(|x| x as f32))
        .map_err(|expected| format!("{text}: {expected}, followed by K"))
}
