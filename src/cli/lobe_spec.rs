//! A lobe written as one word: `ggx:0.1`, `ggx:alpha=0.01`, `geometric:0.3/sqrt`.

use crate::{
    optics::curve::Curve,
    optics::lobe::{Lobe, Width, model::LobeModel, model::roughness_min},
};

use super::names::choice;

/// Roughness where none is given.
const ROUGHNESS_DEFAULT: f64 = 0.3;

/// The lobe that `NAME[:ROUGHNESS][/CURVE]` describes. `:alpha=A` stands for the roughness √A, A being the width of the
/// microfacet lobes.
pub fn lobe_model(text: &str) -> Result<LobeModel, String> {
    let (front, curve_name) = parted(text, '/');
    let (name, number) = parted(front, ':');
    let lobe = choice::<Lobe>(name)?;
    let curve = match curve_name {
        None => Curve::Smooth,
        Some(_) if !lobe.has_curves() => return Err(format!("only the geometric lobe has curves, not {name}")),
        Some(name) => choice::<Curve>(name)?,
    };
    if curve.has_table() {
        return Err("the custom curve has no points here; name another, or give its material by --material".to_owned());
    }
    let roughness = number.map_or(Ok(ROUGHNESS_DEFAULT), |number| roughness(lobe, number))?;
    let model = LobeModel::new(lobe, roughness, curve);
    if model.has_density() {
        Ok(model)
    } else {
        Err(format!(
            "{name} at roughness {roughness} is a mirror, which has no density; give at least {}",
            roughness_min(lobe)
        ))
    }
}

fn parted(text: &str, separator: char) -> (&str, Option<&str>) {
    text.split_once(separator)
        .map_or((text, None), |(front, rest)| (front, Some(rest)))
}

/// A roughness in [0, 1], or the root of an α.
fn roughness(lobe: Lobe, text: &str) -> Result<f64, String> {
    let in_range = |text: &str| text.parse().ok().filter(|x: &f64| (0.0..=1.0).contains(x));
    let value = match text.strip_prefix("alpha=") {
        Some(_) if lobe.traits().width == Width::Roughness => {
            return Err(format!(
                "the {} lobe has no α; give its roughness R as a plain number",
                lobe.name()
            ));
        }
        Some(alpha) => in_range(alpha).map(f64::sqrt),
        None => in_range(text),
    };
    value.ok_or_else(|| format!("{text} is no roughness; give a number from 0 to 1, or alpha=A"))
}
