//! The highlight of a material as other programs know it: that of GGX.

use super::rounded;
use crate::document::MaterialSettings;
use crate::document::import::ggx_under_texture;
use crate::matching::{lobe_of_material, nearest_ggx};
use crate::optics::lobe::{Lobe, Width};
use crate::store::exchange::report::{Entry, Residual};

/// The roughness of GGX that looks like a material's highlight, and how near it comes.
pub(super) fn highlight(material: &MaterialSettings) -> (f32, Entry) {
    let what = "highlight";
    if !material.reflects() {
        return (material.roughness, Entry::exact("no highlight"));
    }
    if matches!(material.lobe, Lobe::Ggx | Lobe::Ggx2018 | Lobe::GgxNdf) {
        return (material.roughness, Entry::exact(what));
    }
    let model = lobe_of_material(material);
    if !model.has_density() {
        return (0.0, Entry::exact("highlight, a mirror's"));
    }
    let nearest = nearest_ggx(&model);
    let is_matched = material.textures.roughness && material.lobe.traits().width == Width::Roughness;
    let roughness = match is_matched {
        // What its texture multiplies here.
        true => ggx_under_texture(material.roughness),
        false => nearest.roughness as f32,
    };
    let roughness = rounded(roughness);
    let detail = format!(
        "GGX of roughness {roughness} stands for the {} lobe of {}",
        material.lobe.name(),
        material.roughness
    );
    let residual = Residual::total_variation(nearest.total_variation);
    (roughness, Entry::approximated(what, detail, Some(residual)))
}
