//! What becomes of each input of the surfaces that are read: the tables in docs/FORMATS.md, by which the report lists what
//! is left out or out of range.

use crate::import::FileParameter;
use crate::import::Goes::{self, Nowhere, To};

const DISPERSION: Goes = Nowhere("dispersion is not shown yet");
const NORMALS: Goes = Nowhere("textures travel with models; here each parameter has one value");
const OCCLUSION: Goes = Nowhere("path tracing needs no occlusion");
const COAT_ALONG: Goes = Nowhere("the coat's highlight lies along the tangent");
const SCATTERING: Goes = Nowhere("nothing is scattered inside");
const SUBSURFACE: Goes = Nowhere("subsurface scattering is not shown yet");
const THIN: Goes = Nowhere("what transmits is a solid");
const TURN: Goes = To("specular.rotation");

/// The most radiance that a material emits.
const RADIANCE_MAX: f32 = 1e6;

const fn row(place: &'static str, default: &'static str, example: &'static str, goes: Goes) -> FileParameter {
    FileParameter::new(place, default, example, goes)
}

/// An input between 0 and 1.
const fn unit(place: &'static str, default: &'static str, example: &'static str, goes: Goes) -> FileParameter {
    row(place, default, example, goes).within(0.0, 1.0)
}

const fn ior(place: &'static str, default: &'static str, goes: Goes) -> FileParameter {
    row(place, default, "1.25", goes).within(1.0, 4.0)
}

const fn film_ior(place: &'static str, default: &'static str) -> FileParameter {
    row(place, default, "1.25", To("thin_film.ior")).within(1.0, 3.0)
}

/// A direction that a graph gives, and which is else the surface's own.
const fn direction(place: &'static str, goes: Goes) -> FileParameter {
    row(place, "", "graph", goes)
}

const COLOR: &str = "0.5, 0.25, 0.125";
const WHITE: &str = "1, 1, 1";
const BLACK: &str = "0, 0, 0";

pub(super) const OPEN_PBR: &[FileParameter] = &[
    unit("base_weight", "1", "0.5", To("base.color")),
    unit("base_color", "0.8, 0.8, 0.8", COLOR, To("base.color")),
    unit("base_diffuse_roughness", "0", "0.25", To("base.diffuse_roughness")),
    unit("base_metalness", "0", "0.5", To("base.metalness")),
    unit("specular_weight", "1", "0.5", To("specular.weight")),
    unit(
        "specular_color",
        WHITE,
        COLOR,
        To("specular.color, or base.edge_tint where the metalness is above 0.5"),
    ),
    unit("specular_roughness", "0.3", "0.5", To("specular.roughness")),
    ior("specular_ior", "1.5", To("specular.ior")),
    unit("specular_roughness_anisotropy", "0", "0.5", To("specular.anisotropy")),
    unit("transmission_weight", "0", "0.5", To("transmission.weight")),
    unit("transmission_color", WHITE, COLOR, To("transmission.color")).of("transmission_weight"),
    row("transmission_depth", "0", "0.5", To("transmission.depth"))
        .within(0.0, 1000.0)
        .of("transmission_weight"),
    row("transmission_scatter", BLACK, COLOR, SCATTERING).of("transmission_weight"),
    row("transmission_scatter_anisotropy", "0", "0.5", SCATTERING).of("transmission_scatter"),
    row("transmission_dispersion_scale", "0", "0.5", DISPERSION).of("transmission_weight"),
    row("transmission_dispersion_abbe_number", "20", "40", DISPERSION).of("transmission_dispersion_scale"),
    row("subsurface_weight", "0", "0.5", SUBSURFACE),
    row("subsurface_color", "0.8, 0.8, 0.8", COLOR, SUBSURFACE).of("subsurface_weight"),
    row("subsurface_radius", "1", "0.5", SUBSURFACE).of("subsurface_weight"),
    row("subsurface_radius_scale", "1, 0.5, 0.25", COLOR, SUBSURFACE).of("subsurface_weight"),
    row("subsurface_scatter_anisotropy", "0", "0.5", SUBSURFACE).of("subsurface_weight"),
    unit("fuzz_weight", "0", "0.5", To("fuzz.weight")),
    unit("fuzz_color", WHITE, COLOR, To("fuzz.color")).of("fuzz_weight"),
    unit("fuzz_roughness", "0.5", "0.25", To("fuzz.roughness")).of("fuzz_weight"),
    unit("coat_weight", "0", "0.5", To("coat.weight")),
    unit("coat_color", WHITE, COLOR, To("coat.color")).of("coat_weight"),
    unit("coat_roughness", "0", "0.5", To("coat.roughness")).of("coat_weight"),
    unit("coat_roughness_anisotropy", "0", "0.5", To("coat.anisotropy")).of("coat_weight"),
    ior("coat_ior", "1.6", To("coat.ior")).of("coat_weight"),
    unit("coat_darkening", "1", "0.5", To("coat.darkening")).of("coat_weight"),
    unit("thin_film_weight", "0", "0.5", To("thin_film.weight")),
    row("thin_film_thickness", "0.5", "0.25", To("thin_film.thickness"))
        .within(0.0, 10.0)
        .of("thin_film_weight"),
    film_ior("thin_film_ior", "1.4").of("thin_film_weight"),
    row("emission_luminance", "0", "500", To("emission.strength"))
        .within(0.0, 1000.0 * RADIANCE_MAX)
        .with_note("1000 nits are radiance 1"),
    row("emission_color", WHITE, COLOR, To("emission.color"))
        .within(0.0, RADIANCE_MAX)
        .of("emission_luminance"),
    unit("geometry_opacity", "1", "0.5", To("geometry.opacity")),
    row("geometry_thin_walled", "false", "true", THIN),
    direction("geometry_normal", NORMALS),
    direction("geometry_coat_normal", NORMALS),
    direction("geometry_tangent", TURN).with_note("the turn of a `rotate3d`"),
    direction("geometry_coat_tangent", COAT_ALONG),
];

pub(super) const STANDARD_SURFACE: &[FileParameter] = &[
    unit("base", "1", "0.5", To("base.color")),
    unit("base_color", "0.8, 0.8, 0.8", COLOR, To("base.color")),
    unit("diffuse_roughness", "0", "0.25", To("base.diffuse_roughness")),
    unit("metalness", "0", "0.5", To("base.metalness")),
    unit(
        "specular",
        "1",
        "0.5",
        To("specular.weight, or base.edge_tint where the metalness is above 0.5"),
    ),
    unit(
        "specular_color",
        WHITE,
        COLOR,
        To("specular.color, or base.edge_tint where the metalness is above 0.5"),
    ),
    unit("specular_roughness", "0.2", "0.5", To("specular.roughness")),
    ior("specular_IOR", "1.5", To("specular.ior")),
    row("specular_anisotropy", "0", "0.5", To("specular.anisotropy")).within(0.0, 0.98),
    row("specular_rotation", "0", "0.125", TURN)
        .within(-1.0, 1.0)
        .of("specular_anisotropy"),
    unit("transmission", "0", "0.5", To("transmission.weight")),
    unit("transmission_color", WHITE, COLOR, To("transmission.color")).of("transmission"),
    row("transmission_depth", "0", "0.5", To("transmission.depth"))
        .within(0.0, 1000.0)
        .of("transmission"),
    row("transmission_scatter", BLACK, COLOR, SCATTERING).of("transmission"),
    row("transmission_scatter_anisotropy", "0", "0.5", SCATTERING).of("transmission_scatter"),
    row("transmission_dispersion", "0", "40", DISPERSION).of("transmission"),
    row(
        "transmission_extra_roughness",
        "0",
        "0.25",
        Nowhere("what is refracted is as rough as what is reflected"),
    )
    .of("transmission"),
    row("subsurface", "0", "0.5", SUBSURFACE),
    row("subsurface_color", WHITE, COLOR, SUBSURFACE).of("subsurface"),
    row("subsurface_radius", WHITE, COLOR, SUBSURFACE).of("subsurface"),
    row("subsurface_scale", "1", "0.5", SUBSURFACE).of("subsurface"),
    row("subsurface_anisotropy", "0", "0.5", SUBSURFACE).of("subsurface"),
    unit("sheen", "0", "0.5", To("fuzz.weight")).with_note("as fuzz of about its albedo"),
    unit("sheen_color", WHITE, COLOR, To("fuzz.color")).of("sheen"),
    unit("sheen_roughness", "0.3", "0.5", To("fuzz.roughness")).of("sheen"),
    unit("coat", "0", "0.5", To("coat.weight")),
    unit("coat_color", WHITE, COLOR, To("coat.color")).of("coat"),
    unit("coat_roughness", "0.1", "0.5", To("coat.roughness")).of("coat"),
    unit("coat_anisotropy", "0", "0.5", To("coat.anisotropy")).of("coat"),
    row("coat_rotation", "0", "0.125", COAT_ALONG).of("coat_anisotropy"),
    ior("coat_IOR", "1.5", To("coat.ior")).of("coat"),
    direction("coat_normal", NORMALS),
    row(
        "coat_affect_color",
        "0",
        "0.5",
        Nowhere("the base keeps its colour under a coat"),
    )
    .of("coat"),
    row(
        "coat_affect_roughness",
        "0",
        "0.5",
        Nowhere("the base keeps its roughness under a coat"),
    )
    .of("coat"),
    row(
        "thin_film_thickness",
        "0",
        "500",
        To("thin_film.thickness, thin_film.weight"),
    )
    .within(0.0, 10_000.0)
    .with_note("above 0 the weight is 1"),
    film_ior("thin_film_IOR", "1.5").of("thin_film_thickness"),
    row("emission", "0", "0.5", To("emission.strength")).within(0.0, RADIANCE_MAX),
    row("emission_color", WHITE, COLOR, To("emission.color"))
        .within(0.0, RADIANCE_MAX)
        .of("emission"),
    unit("opacity", WHITE, COLOR, To("geometry.opacity")).with_note("the luminance of a colour"),
    row("thin_walled", "false", "true", THIN),
    direction("normal", NORMALS),
    direction("tangent", TURN).with_note("the turn of a `rotate3d`"),
];

pub(super) const GLTF_PBR: &[FileParameter] = &[
    unit("base_color", WHITE, COLOR, To("base.color")),
    unit("metallic", "1", "0.5", To("base.metalness")),
    unit("roughness", "1", "0.5", To("specular.roughness")),
    direction("normal", NORMALS),
    direction("tangent", TURN).with_note("the turn of a `rotate3d`"),
    row("occlusion", "1", "0.5", OCCLUSION),
    unit("transmission", "0", "0.5", To("transmission.weight")),
    unit("specular", "1", "0.5", To("specular.weight, without metals")),
    row("specular_color", WHITE, COLOR, To("specular.color, without metals"))
        .within(0.0, 1000.0)
        .with_note("at most 1 in what transmits"),
    ior("ior", "1.5", To("specular.ior")),
    unit("alpha", "1", "0.25", To("geometry.opacity")).of("alpha_mode"),
    row("alpha_mode", "0", "1", To("geometry.opacity"))
        .within(0.0, 2.0)
        .of("alpha"),
    unit("alpha_cutoff", "0.5", "0.125", To("geometry.opacity")).of("alpha"),
    unit("iridescence", "0", "0.5", To("thin_film.weight")),
    film_ior("iridescence_ior", "1.3").of("iridescence"),
    row("iridescence_thickness", "100", "500", To("thin_film.thickness"))
        .within(0.0, 10_000.0)
        .of("iridescence"),
    unit("sheen_color", BLACK, COLOR, To("fuzz.weight, fuzz.color")).with_note("as fuzz of about its albedo"),
    unit("sheen_roughness", "0", "0.5", To("fuzz.roughness")).of("sheen_color"),
    unit("clearcoat", "0", "0.5", To("coat.weight")),
    unit("clearcoat_roughness", "0", "0.5", To("coat.roughness")).of("clearcoat"),
    direction("clearcoat_normal", NORMALS),
    row("emissive", BLACK, COLOR, To("emission.color, emission.strength")).within(0.0, RADIANCE_MAX),
    row("emissive_strength", "1", "2", To("emission.strength"))
        .within(0.0, RADIANCE_MAX)
        .of("emissive"),
    row("thickness", "0", "0.5", Nowhere("solids are as thick as they are")).of("transmission"),
    row("attenuation_distance", "0", "0.5", To("transmission.depth"))
        .within(0.0, 1000.0)
        .of("transmission"),
    unit("attenuation_color", WHITE, COLOR, To("transmission.color")).of("attenuation_distance"),
    unit(
        "anisotropy_strength",
        "0",
        "0.5",
        To("specular.anisotropy, specular.roughness"),
    )
    .with_note("stretched at most 19 : 1"),
    row("anisotropy_rotation", "0", "0.5", TURN)
        .within(-6.3, 6.3)
        .of("anisotropy_strength"),
    row("dispersion", "0", "0.5", DISPERSION).of("transmission"),
];

pub(super) const USD_PREVIEW_SURFACE: &[FileParameter] = &[
    unit("diffuseColor", "0.18, 0.18, 0.18", COLOR, To("base.color")),
    row("emissiveColor", BLACK, COLOR, To("emission.color, emission.strength")).within(0.0, RADIANCE_MAX),
    row("useSpecularWorkflow", "0", "1", To("base.metalness, specular.color")),
    unit("specularColor", BLACK, COLOR, To("specular.color")).of("useSpecularWorkflow"),
    unit("metallic", "0", "0.5", To("base.metalness")),
    unit("roughness", "0.5", "0.25", To("specular.roughness")),
    unit("clearcoat", "0", "0.5", To("coat.weight")),
    unit("clearcoatRoughness", "0.01", "0.5", To("coat.roughness")).of("clearcoat"),
    unit(
        "opacity",
        "1",
        "0.5",
        To("transmission.weight, or geometry.opacity of what is cut out or there in part"),
    ),
    row("opacityMode", "0", "1", To("geometry.opacity")).of("opacity"),
    unit("opacityThreshold", "0", "0.5", To("geometry.opacity")).of("opacity"),
    ior("ior", "1.5", To("specular.ior")),
    direction("normal", NORMALS),
    row("displacement", "0", "0.5", Nowhere("nothing is displaced")),
    row("occlusion", "1", "0.5", OCCLUSION),
];

pub(super) const DISNEY_PRINCIPLED: &[FileParameter] = &[
    unit("baseColor", "0.16, 0.16, 0.16", COLOR, To("base.color")),
    unit("metallic", "0", "0.5", To("base.metalness")),
    unit("roughness", "0.5", "0.25", To("specular.roughness")),
    row("anisotropic", "0", "0.5", To("specular.anisotropy")).within(0.0, 0.98),
    row("specular", "0.5", "0.25", To("specular.weight")).within(0.0, 0.5),
    row(
        "specularTint",
        "0",
        "0.5",
        Nowhere("reflections of a dielectric are white"),
    ),
    unit("sheen", "0", "0.5", To("fuzz.weight")).with_note("as fuzz of about its albedo"),
    unit("sheenTint", "0.5", "0.25", To("fuzz.color")).of("sheen"),
    unit("clearcoat", "0", "0.5", To("coat.weight")),
    unit("clearcoatGloss", "1", "0.5", To("coat.roughness")).of("clearcoat"),
    unit("specTrans", "0", "0.5", To("transmission.weight")),
    ior("ior", "1.5", To("specular.ior")),
    row("subsurface", "0", "0.5", SUBSURFACE),
    row("subsurfaceDistance", WHITE, COLOR, SUBSURFACE).of("subsurface"),
];

pub(super) const SURFACE_UNLIT: &[FileParameter] = &[
    row("emission", "1", "0.5", To("emission.strength")).within(0.0, RADIANCE_MAX),
    row("emission_color", WHITE, COLOR, To("emission.color")).within(0.0, RADIANCE_MAX),
    row(
        "transmission",
        "0",
        "0.5",
        Nowhere("what shines lets nothing through but by its opacity"),
    ),
    row(
        "transmission_color",
        WHITE,
        COLOR,
        Nowhere("what shines lets nothing through but by its opacity"),
    )
    .of("transmission"),
    unit("opacity", "1", "0.5", To("geometry.opacity")),
];
