//! UsdPreviewSurface, which both USD and MaterialX have.

use crate::{FileParameter, file_parameters};

/// Every input of the surface.
#[rustfmt::skip]
pub const USD_PREVIEW_SURFACE: &[FileParameter] = file_parameters! { "" {
    "diffuseColor" = "0.18, 0.18, 0.18" "0.5, 0.25, 0.125" => share "base.color";
    "emissiveColor" = "0, 0, 0" "0.5, 0.25, 0.125" => to "emission.color, emission.strength" in 0.0..1e6;
    "useSpecularWorkflow" = "0" "1" => to "base.metalness, specular.color";
    "specularColor" = "0, 0, 0" "0.5, 0.25, 0.125" => share "specular.color" of "useSpecularWorkflow";
    "metallic" = "0" "0.5" => share "base.metalness";
    "roughness" = "0.5" "0.25" => share "specular.roughness";
    "clearcoat" = "0" "0.5" => share "coat.weight";
    "clearcoatRoughness" = "0.01" "0.5" => share "coat.roughness" of "clearcoat";
    "opacity" = "1" "0.5" => share "transmission.weight, or geometry.opacity of what is cut out or there in part";
    "opacityMode" = "0" "1" => to "geometry.opacity" of "opacity";
    "opacityThreshold" = "0" "0.5" => share "geometry.opacity" of "opacity";
    "ior" = "1.5" "1.25" => to "specular.ior" in 1.0..4.0;
    "normal" "graph" => nowhere "only a map of normals that is an image is shown";
    "displacement" = "0" "0.5" => nowhere "nothing is displaced";
    "occlusion" = "1" "0.5" => nowhere "path tracing needs no occlusion";
} };
