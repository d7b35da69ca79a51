//! What becomes of each input of the surfaces that are read: the tables in docs/FORMATS.md, by which surfaces are read and written, and
//! the report lists what is left out or out of range.

use crate::import::{FileParameter, file_parameters};

const RADIANS_PER_DEGREE: f32 = std::f32::consts::PI / 180.0;
const TURNS_PER_DEGREE: f32 = 1.0 / 360.0;

const DISPERSION: &str = "dispersion is not shown yet";
const NORMALS: &str = "only a map of normals that is an image is shown";
const OCCLUSION: &str = "path tracing needs no occlusion";
const COAT_ALONG: &str = "the coat's highlight lies along the tangent";
const SCATTERING: &str = "nothing is scattered inside";
const SUBSURFACE: &str = "subsurface scattering is not shown yet";
const THIN: &str = "what transmits is a solid";

pub const OPEN_PBR: &[FileParameter] = file_parameters! { "" {
    "base_weight" = "1" "0.5" => share "base.weight";
    "base_color" = "0.8, 0.8, 0.8" "0.5, 0.25, 0.125" => share "base.color";
    "base_diffuse_roughness" = "0" "0.25" => share "base.diffuse_roughness";
    "base_metalness" = "0" "0.5" => share "base.metalness";
    "specular_weight" = "1" "0.5" => share "specular.weight";
    "specular_color" = "1, 1, 1" "0.5, 0.25, 0.125" => share "specular.color, or base.edge_tint where the metalness is above 0.5";
    "specular_roughness" = "0.3" "0.5" => share "specular.roughness";
    "specular_ior" = "1.5" "1.25" => to "specular.ior" in 1.0..4.0;
    "specular_roughness_anisotropy" = "0" "0.5" => share "specular.anisotropy";
    "transmission_weight" = "0" "0.5" => share "transmission.weight";
    "transmission_color" = "1, 1, 1" "0.5, 0.25, 0.125" => share "transmission.color" of "transmission_weight";
    "transmission_depth" = "0" "0.5" => to "transmission.depth" in 0.0..1000.0 of "transmission_weight";
    "transmission_scatter" = "0, 0, 0" "0.5, 0.25, 0.125" => nowhere SCATTERING of "transmission_weight";
    "transmission_scatter_anisotropy" = "0" "0.5" => nowhere SCATTERING of "transmission_scatter";
    "transmission_dispersion_scale" = "0" "0.5" => nowhere DISPERSION of "transmission_weight";
    "transmission_dispersion_abbe_number" = "20" "40" => nowhere DISPERSION of "transmission_dispersion_scale";
    "subsurface_weight" = "0" "0.5" => nowhere SUBSURFACE;
    "subsurface_color" = "0.8, 0.8, 0.8" "0.5, 0.25, 0.125" => nowhere SUBSURFACE of "subsurface_weight";
    "subsurface_radius" = "1" "0.5" => nowhere SUBSURFACE of "subsurface_weight";
    "subsurface_radius_scale" = "1, 0.5, 0.25" "0.5, 0.25, 0.125" => nowhere SUBSURFACE of "subsurface_weight";
    "subsurface_scatter_anisotropy" = "0" "0.5" => nowhere SUBSURFACE of "subsurface_weight";
    "fuzz_weight" = "0" "0.5" => share "fuzz.weight";
    "fuzz_color" = "1, 1, 1" "0.5, 0.25, 0.125" => share "fuzz.color" of "fuzz_weight";
    "fuzz_roughness" = "0.5" "0.25" => share "fuzz.roughness" of "fuzz_weight";
    "coat_weight" = "0" "0.5" => share "coat.weight";
    "coat_color" = "1, 1, 1" "0.5, 0.25, 0.125" => share "coat.color" of "coat_weight";
    "coat_roughness" = "0" "0.5" => share "coat.roughness" of "coat_weight";
    "coat_roughness_anisotropy" = "0" "0.5" => share "coat.anisotropy" of "coat_weight";
    "coat_ior" = "1.6" "1.25" => to "coat.ior" in 1.0..4.0 of "coat_weight";
    "coat_darkening" = "1" "0.5" => share "coat.darkening" of "coat_weight";
    "thin_film_weight" = "0" "0.5" => share "thin_film.weight";
    "thin_film_thickness" = "0.5" "0.25" => to "thin_film.thickness" in 0.0..10.0 of "thin_film_weight";
    "thin_film_ior" = "1.4" "1.25" => to "thin_film.ior" in 1.0..3.0 of "thin_film_weight";
    "emission_luminance" = "0" / 1000.0 "500" => to "emission.strength": "1000 nits are radiance 1" in 0.0..1e9;
    "emission_color" = "1, 1, 1" "0.5, 0.25, 0.125" => to "emission.color" in 0.0..1e6 of "emission_luminance";
    "geometry_opacity" = "1" "0.5" => share "geometry.opacity";
    "geometry_thin_walled" = "false" "true" => nowhere THIN;
    "geometry_normal" "graph" => nowhere NORMALS;
    "geometry_coat_normal" "graph" => nowhere NORMALS;
    "geometry_tangent" "graph" => to "specular.rotation": "the turn of a `rotate3d`";
    "geometry_coat_tangent" "graph" => nowhere COAT_ALONG;
} };

pub(super) const STANDARD_SURFACE: &[FileParameter] = file_parameters! { "" {
    "base" = "1" "0.5" => share "base.weight";
    "base_color" = "0.8, 0.8, 0.8" "0.5, 0.25, 0.125" => share "base.color";
    "diffuse_roughness" = "0" "0.25" => share "base.diffuse_roughness";
    "metalness" = "0" "0.5" => share "base.metalness";
    "specular" = "1" "0.5" => share "specular.weight, or base.edge_tint where the metalness is above 0.5";
    "specular_color" = "1, 1, 1" "0.5, 0.25, 0.125" => share "specular.color, or base.edge_tint where the metalness is above 0.5";
    "specular_roughness" = "0.2" "0.5" => share "specular.roughness";
    "specular_IOR" = "1.5" "1.25" => to "specular.ior" in 1.0..4.0;
    "specular_anisotropy" = "0" "0.5" => to "specular.anisotropy" in 0.0..0.98;
    "specular_rotation" = "0" / TURNS_PER_DEGREE "0.125" => to "specular.rotation" in -1.0..1.0 of "specular_anisotropy";
    "transmission" = "0" "0.5" => share "transmission.weight";
    "transmission_color" = "1, 1, 1" "0.5, 0.25, 0.125" => share "transmission.color" of "transmission";
    "transmission_depth" = "0" "0.5" => to "transmission.depth" in 0.0..1000.0 of "transmission";
    "transmission_scatter" = "0, 0, 0" "0.5, 0.25, 0.125" => nowhere SCATTERING of "transmission";
    "transmission_scatter_anisotropy" = "0" "0.5" => nowhere SCATTERING of "transmission_scatter";
    "transmission_dispersion" = "0" "40" => nowhere DISPERSION of "transmission";
    "transmission_extra_roughness" = "0" "0.25" => nowhere "what is refracted is as rough as what is reflected" of "transmission";
    "subsurface" = "0" "0.5" => nowhere SUBSURFACE;
    "subsurface_color" = "1, 1, 1" "0.5, 0.25, 0.125" => nowhere SUBSURFACE of "subsurface";
    "subsurface_radius" = "1, 1, 1" "0.5, 0.25, 0.125" => nowhere SUBSURFACE of "subsurface";
    "subsurface_scale" = "1" "0.5" => nowhere SUBSURFACE of "subsurface";
    "subsurface_anisotropy" = "0" "0.5" => nowhere SUBSURFACE of "subsurface";
    "sheen" = "0" "0.5" => share "fuzz.weight": "as fuzz of about its albedo";
    "sheen_color" = "1, 1, 1" "0.5, 0.25, 0.125" => share "fuzz.color" of "sheen";
    "sheen_roughness" = "0.3" "0.5" => share "fuzz.roughness" of "sheen";
    "coat" = "0" "0.5" => share "coat.weight";
    "coat_color" = "1, 1, 1" "0.5, 0.25, 0.125" => share "coat.color" of "coat";
    "coat_roughness" = "0.1" "0.5" => share "coat.roughness" of "coat";
    "coat_anisotropy" = "0" "0.5" => share "coat.anisotropy" of "coat";
    "coat_rotation" = "0" "0.125" => nowhere COAT_ALONG of "coat_anisotropy";
    "coat_IOR" = "1.5" "1.25" => to "coat.ior" in 1.0..4.0 of "coat";
    "coat_normal" "graph" => nowhere NORMALS;
    "coat_affect_color" = "0" "0.5" => nowhere "the base keeps its colour under a coat" of "coat";
    "coat_affect_roughness" = "0" "0.5" => nowhere "the base keeps its roughness under a coat" of "coat";
    "thin_film_thickness" = "0" / 1000.0 "500" => to "thin_film.thickness, thin_film.weight": "above 0 the weight is 1" in 0.0..10000.0;
    "thin_film_IOR" = "1.5" "1.25" => to "thin_film.ior" in 1.0..3.0 of "thin_film_thickness";
    "emission" = "0" "0.5" => to "emission.strength" in 0.0..1e6;
    "emission_color" = "1, 1, 1" "0.5, 0.25, 0.125" => to "emission.color" in 0.0..1e6 of "emission";
    "opacity" = "1, 1, 1" "0.5, 0.25, 0.125" => share "geometry.opacity": "the luminance of a colour";
    "thin_walled" = "false" "true" => nowhere THIN;
    "normal" "graph" => nowhere NORMALS;
    "tangent" "graph" => to "specular.rotation": "the turn of a `rotate3d`";
} };

pub(super) const GLTF_PBR: &[FileParameter] = file_parameters! { "" {
    "base_color" = "1, 1, 1" "0.5, 0.25, 0.125" => share "base.color";
    "metallic" = "1" "0.5" => share "base.metalness";
    "roughness" = "1" "0.5" => share "specular.roughness";
    "normal" "graph" => nowhere NORMALS;
    "tangent" "graph" => to "specular.rotation": "the turn of a `rotate3d`";
    "occlusion" = "1" "0.5" => nowhere OCCLUSION;
    "transmission" = "0" "0.5" => share "transmission.weight";
    "specular" = "1" "0.5" => share "specular.weight, without metals";
    "specular_color" = "1, 1, 1" "0.5, 0.25, 0.125" => to "specular.color, without metals": "at most 1 in what transmits" in 0.0..1000.0;
    "ior" = "1.5" "1.25" => to "specular.ior" in 1.0..4.0;
    "alpha" = "1" "0.25" => share "geometry.opacity" of "alpha_mode";
    "alpha_mode" = "0" "1" => to "geometry.opacity" in 0.0..2.0 of "alpha";
    "alpha_cutoff" = "0.5" "0.125" => share "geometry.opacity" of "alpha";
    "iridescence" = "0" "0.5" => share "thin_film.weight";
    "iridescence_ior" = "1.3" "1.25" => to "thin_film.ior" in 1.0..3.0 of "iridescence";
    "iridescence_thickness" = "100" / 1000.0 "500" => to "thin_film.thickness" in 0.0..10000.0 of "iridescence";
    "sheen_color" = "0, 0, 0" "0.5, 0.25, 0.125" => share "fuzz.weight, fuzz.color": "as fuzz of about its albedo";
    "sheen_roughness" = "0" "0.5" => share "fuzz.roughness" of "sheen_color";
    "clearcoat" = "0" "0.5" => share "coat.weight";
    "clearcoat_roughness" = "0" "0.5" => share "coat.roughness" of "clearcoat";
    "clearcoat_normal" "graph" => nowhere NORMALS;
    "emissive" = "0, 0, 0" "0.5, 0.25, 0.125" => to "emission.color, emission.strength" in 0.0..1e6;
    "emissive_strength" = "1" "2" => to "emission.strength" in 0.0..1e6 of "emissive";
    "thickness" = "0" "0.5" => nowhere "solids are as thick as they are" of "transmission";
    "attenuation_distance" = "0" "0.5" => to "transmission.depth" in 0.0..1000.0 of "transmission";
    "attenuation_color" = "1, 1, 1" "0.5, 0.25, 0.125" => share "transmission.color" of "attenuation_distance";
    "anisotropy_strength" = "0" "0.5" => share "specular.anisotropy, specular.roughness": "stretched at most 19 : 1";
    "anisotropy_rotation" = "0" / RADIANS_PER_DEGREE "0.5" => to "specular.rotation" in -6.3..6.3 of "anisotropy_strength";
    "dispersion" = "0" "0.5" => nowhere DISPERSION of "transmission";
} };

pub(super) const USD_PREVIEW_SURFACE: &[FileParameter] = file_parameters! { "" {
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
    "normal" "graph" => nowhere NORMALS;
    "displacement" = "0" "0.5" => nowhere "nothing is displaced";
    "occlusion" = "1" "0.5" => nowhere OCCLUSION;
} };

pub(super) const DISNEY_PRINCIPLED: &[FileParameter] = file_parameters! { "" {
    "baseColor" = "0.16, 0.16, 0.16" "0.5, 0.25, 0.125" => share "base.color";
    "metallic" = "0" "0.5" => share "base.metalness";
    "roughness" = "0.5" "0.25" => share "specular.roughness";
    "anisotropic" = "0" "0.5" => to "specular.anisotropy" in 0.0..0.98;
    "specular" = "0.5" "0.25" => to "specular.weight" in 0.0..0.5;
    "specularTint" = "0" "0.5" => nowhere "reflections of a dielectric are white";
    "sheen" = "0" "0.5" => share "fuzz.weight": "as fuzz of about its albedo";
    "sheenTint" = "0.5" "0.25" => share "fuzz.color" of "sheen";
    "clearcoat" = "0" "0.5" => share "coat.weight";
    "clearcoatGloss" = "1" "0.5" => share "coat.roughness" of "clearcoat";
    "specTrans" = "0" "0.5" => share "transmission.weight";
    "ior" = "1.5" "1.25" => to "specular.ior" in 1.0..4.0;
    "subsurface" = "0" "0.5" => nowhere SUBSURFACE;
    "subsurfaceDistance" = "1, 1, 1" "0.5, 0.25, 0.125" => nowhere SUBSURFACE of "subsurface";
} };

pub(super) const SURFACE_UNLIT: &[FileParameter] = file_parameters! { "" {
    "emission" = "1" "0.5" => to "emission.strength" in 0.0..1e6;
    "emission_color" = "1, 1, 1" "0.5, 0.25, 0.125" => to "emission.color" in 0.0..1e6;
    "transmission" = "0" "0.5" => nowhere "what shines lets nothing through but by its opacity";
    "transmission_color" = "1, 1, 1" "0.5, 0.25, 0.125" => nowhere "what shines lets nothing through but by its opacity" of "transmission";
    "opacity" = "1" "0.5" => share "geometry.opacity";
} };
