//! The parameters of a material.

use std::sync::LazyLock;

use super::accessors::{choice, field};
use super::{Choice, Kind, Parameter, RowStyle, Stage, Value, choices};
use crate::document::custom_curve::CustomCurve;
use crate::document::material::FILM_THICKNESS_MAX;
use crate::document::{Conductor, MaterialSettings, SPECULAR_COLOR_MAX};
use crate::optics::curve::Curve;
use crate::optics::fresnel::Fresnel;
use crate::optics::lobe::{Horizon, Lobe};

type Get = fn(&MaterialSettings) -> Value;
type Set = fn(&mut MaterialSettings, Value);

/// Every parameter, in the order of the panels. In files they are read in this order too: a conductor before the η and
/// k that may replace its own.
pub static PARAMETERS: LazyLock<Vec<Parameter>> = LazyLock::new(|| {
    let mut all = base();
    all.extend(specular_shape());
    all.extend(specular_fresnel());
    all.extend(coat());
    all.extend(fuzz());
    all.extend(thin_film());
    all.extend(transmission());
    all.extend(emission());
    all.extend(geometry());
    all
});

fn base() -> Vec<Parameter> {
    vec![
        Parameter {
            label: "Weight",
            help: "Darkens the base: its colour is multiplied by it.",
            ..of("base.weight", unit_number(), field!(Number base_weight))
        },
        Parameter {
            label: "Colour",
            help: "Colour of the diffuse base; of a metal, its reflection seen head-on.",
            idle: |material| {
                let of_indices = is_conductor(material) && material.metalness >= 1.0;
                of_indices.then_some(
                    "The metal's colour follows from its measured η and k. Edit as colours, below Metal, gives it colours to pick.",
                )
            },
            ..of("base.color", Kind::Color, field!(Color base_color))
        },
        Parameter {
            label: "Colour texture",
            help: "Multiplies the colour by a texture, the model's or one of your own.",
            ..of("base.color_texture", Kind::Toggle, field!(Toggle textures.color))
        },
        Parameter {
            label: "Diffuse roughness",
            help: "Scatters more of the base's light back to where it comes from: plaster, clay, cloth. 0 is Lambert's base.",
            applies: |material| material.metalness < 1.0,
            ..of(
                "base.diffuse_roughness",
                unit_number(),
                field!(Number diffuse_roughness),
            )
        },
        Parameter {
            label: "Metalness",
            help: "0: a dielectric, its reflection over a diffuse base. 1: a metal, no base, the reflection coloured.",
            ..of("base.metalness", unit_number(), field!(Number metalness))
        },
    ]
}

fn specular_shape() -> Vec<Parameter> {
    vec![
        Parameter {
            label: "Weight",
            help: "How much of the reflection is kept; at 0 only the base is left.",
            applies: |_| true,
            ..of("specular.weight", unit_number(), field!(Number specular_weight))
        },
        Parameter {
            label: "Weight by index",
            help: "The weight scales a dielectric's reflectance head-on, through the index, as in OpenPBR; off, at every angle, as in glTF.",
            applies: |material| {
                let is_weighed = material.specular_weight < 1.0 && material.metalness < 1.0;
                is_weighed && has_specular(material) && has_metalness(material) && !transmits(material)
            },
            ..of(
                "specular.weight_in_index",
                Kind::Toggle,
                field!(Toggle specular_in_index),
            )
        },
        Parameter {
            label: "Metals too",
            help: "Weight and tint are a metal's too; off, they are the dielectric's alone, as in glTF.",
            applies: |material| material.metalness > 0.0 && has_metalness(material),
            ..of("specular.on_metal", Kind::Toggle, field!(Toggle specular_on_metal))
        },
        Parameter {
            label: "Lobe",
            help: "The model of how reflected light is spread.",
            ..of("specular.lobe", choices::<Lobe>(), choice!(lobe))
        },
        Parameter {
            label: "Roughness",
            symbol: "R",
            help: "0 is a mirror; 1 is fully diffuse for the geometric lobe.",
            applies: |material| has_specular(material) && material.lobe.has_roughness(),
            ..of("specular.roughness", unit_number(), field!(Number roughness))
        },
        Parameter {
            label: "Roughness texture",
            help: "Multiplies roughness and metalness by textures.",
            ..of(
                "specular.roughness_texture",
                Kind::Toggle,
                field!(Toggle textures.roughness),
            )
        },
        Parameter {
            label: "Multiple scattering",
            help: "Keeps the light that meets a second facet of rough GGX: metals and clear glass. Off, they darken with roughness.",
            applies: |material| has_specular(material) && material.lobe.traits().loses_light,
            ..of(
                "specular.multiple_scattering",
                Kind::Toggle,
                field!(Toggle multiple_scattering),
            )
        },
        Parameter {
            label: "Curve",
            symbol: "D(ξ)",
            help: "The profile of the geometric lobe's highlight, from its middle to its edge.",
            applies: has_curves,
            ..of("specular.curve", choices::<Curve>(), choice!(curve))
        },
        Parameter {
            label: "Custom curve",
            symbol: "D(ξ)",
            help: "Custom quantile function D(ξ).",
            applies: |material| has_curves(material) && material.curve.has_table(),
            ..of("specular.custom_curve", Kind::Curve, custom_curve())
        },
        Parameter {
            label: "Anisotropy",
            symbol: "Rx, Ry",
            help: "Stretches the highlight along the surface's tangent, below 0 across it: brushed metal, hair, satin.",
            applies: |material| has_specular(material) && material.lobe.is_anisotropic(),
            row: bar(-1.0, 1.0),
            ..of(
                "specular.anisotropy",
                number([-1.0, 1.0], ""),
                field!(Number anisotropy),
            )
        },
        Parameter {
            label: "Rotation",
            help: "Turns the direction of the stretch about the normal, anticlockwise seen from outside.",
            applies: |material| has_specular(material) && material.lobe.is_anisotropic() && material.anisotropy != 0.0,
            row: RowStyle {
                decimals: 1,
                ..bar(-180.0, 180.0)
            },
            ..of(
                "specular.rotation",
                number([-360.0, 360.0], "°"),
                field!(Number rotation_deg),
            )
        },
        Parameter {
            label: "Below horizon",
            help: "What happens to samples that point into the surface.",
            applies: |material| has_specular(material) && !material.lobe.is_hemispherical(),
            ..of("specular.horizon", choices::<Horizon>(), choice!(horizon))
        },
    ]
}

fn specular_fresnel() -> Vec<Parameter> {
    vec![
        Parameter {
            label: "Fresnel",
            symbol: "F",
            help: "How the share of reflected light grows towards grazing angles. A material that transmits light follows the exact equations of a dielectric.",
            applies: |material| has_specular(material) && !transmits(material),
            ..of("specular.fresnel", choices::<Fresnel>(), choice!(fresnel))
        },
        Parameter {
            label: "Index of refraction",
            symbol: "n",
            help: "How strongly the dielectric reflects and refracts: water 1.33, plastic and glass 1.5, diamond 2.4.",
            applies: |material| {
                if transmits(material) {
                    return true;
                }
                let of_dielectric = matches!(material.fresnel, Fresnel::Schlick | Fresnel::Dielectric);
                has_specular(material) && of_dielectric && material.metalness < 1.0
            },
            row: bar(1.0, 2.5),
            ..of("specular.ior", number([1.0, 4.0], ""), field!(Number ior))
        },
        Parameter {
            label: "Tint",
            help: "Colours the reflection. Above 1 it raises Schlick's reflectance of a dielectric seen head-on, up to 1.",
            ..of(
                "specular.color",
                Kind::Tint {
                    most: SPECULAR_COLOR_MAX,
                },
                field!(Color specular_color),
            )
        },
        Parameter {
            label: "Edge tint",
            help: "Colours a metal's reflection towards the edge, strongest at 82° (F82 tint); white leaves it alone.",
            applies: |material| has_specular(material) && has_metalness(material) && material.metalness > 0.0,
            ..of("specular.edge_tint", Kind::Color, field!(Color edge_tint))
        },
        Parameter {
            label: "Metal",
            help: "Takes the index of refraction of a measured metal.",
            applies: is_conductor,
            ..of("specular.conductor", conductor_choices(), conductor())
        },
        Parameter {
            label: "η",
            symbol: "η",
            help: "Real part of the metal's index of refraction for red, green and blue, as measured unless changed.",
            applies: is_conductor,
            ..of("specular.eta", Kind::Triple { range: [0.0, 20.0] }, eta())
        },
        Parameter {
            label: "k",
            symbol: "k",
            help: "Imaginary part: how strongly the metal absorbs red, green and blue, as measured unless changed.",
            applies: is_conductor,
            ..of("specular.k", Kind::Triple { range: [0.0, 20.0] }, k())
        },
    ]
}

fn coat() -> Vec<Parameter> {
    vec![
        Parameter {
            label: "Weight",
            help: "A layer of clear lacquer over everything else, by the geometric lobe.",
            applies: |_| true,
            ..of("coat.weight", unit_number(), field!(Number coat_weight))
        },
        Parameter {
            label: "Weight texture",
            help: "Multiplies the weight by a texture.",
            ..of("coat.weight_texture", Kind::Toggle, field!(Toggle textures.coat))
        },
        Parameter {
            label: "Roughness",
            symbol: "R",
            help: "How far the coat spreads its reflection; what is seen through it stays as sharp as it is.",
            ..of("coat.roughness", unit_number(), field!(Number coat_roughness))
        },
        Parameter {
            label: "Index of refraction",
            symbol: "n",
            help: "How strongly the coat reflects: lacquer 1.5, oil 1.4, at 1 nothing.",
            row: bar(1.0, 2.5),
            ..of("coat.ior", number([1.0, 4.0], ""), field!(Number coat_ior))
        },
        Parameter {
            label: "Colour",
            help: "Colours what is seen through the coat.",
            ..of("coat.color", Kind::Color, field!(Color coat_color))
        },
    ]
}

fn fuzz() -> Vec<Parameter> {
    vec![
        Parameter {
            label: "Weight",
            help: "A layer of small fibres over everything else, brightest at the edge: velvet, peach, dust.",
            applies: |_| true,
            ..of("fuzz.weight", unit_number(), field!(Number fuzz_weight))
        },
        Parameter {
            label: "Colour",
            help: "Colours what the fibres reflect; what lies below loses as much light of every colour.",
            ..of("fuzz.color", Kind::Color, field!(Color fuzz_color))
        },
        Parameter {
            label: "Roughness",
            symbol: "R",
            help: "How far the fibres spread the light: low only at the edge, high as dust all over.",
            ..of("fuzz.roughness", unit_number(), field!(Number fuzz_roughness))
        },
    ]
}

fn thin_film() -> Vec<Parameter> {
    vec![
        Parameter {
            label: "Weight",
            help: "A film that is thin as light's wavelength: soap, oil, oxide on hot steel. What its sides reflect interferes in colours.",
            applies: |material| has_specular(material) && material.fresnel_model() != Fresnel::None,
            ..of("thin_film.weight", unit_number(), field!(Number film_weight))
        },
        Parameter {
            label: "Weight texture",
            help: "Multiplies the weight by a texture.",
            ..of("thin_film.weight_texture", Kind::Toggle, field!(Toggle textures.film))
        },
        Parameter {
            label: "Thickness",
            symbol: "d",
            help: "Decides the colours: oxide on steel is straw at 0.02 and blue at 0.05, soap films have 0.1 to 1.",
            row: bar(0.0, 1.0),
            ..of(
                "thin_film.thickness",
                number([0.0, FILM_THICKNESS_MAX], "µm"),
                field!(Number film_thickness),
            )
        },
        Parameter {
            label: "Thickness texture",
            help: "Multiplies the thickness by a texture.",
            ..of(
                "thin_film.thickness_texture",
                Kind::Toggle,
                field!(Toggle textures.film_thickness),
            )
        },
        Parameter {
            label: "Index of refraction",
            symbol: "n",
            help: "How strongly the film reflects: soap 1.33, oil 1.47, oxide of steel 2.4; at the base's own there is none to see.",
            row: bar(1.0, 3.0),
            ..of("thin_film.ior", number([1.0, 3.0], ""), field!(Number film_ior))
        },
    ]
}

fn transmission() -> Vec<Parameter> {
    vec![
        Parameter {
            label: "Weight",
            help: "How much of the base is clear instead of diffuse: glass, water, amber. The surface must be closed.",
            applies: |material| material.metalness < 1.0,
            ..of("transmission.weight", unit_number(), field!(Number transmission_weight))
        },
        Parameter {
            label: "Colour",
            help: "Colours what is seen through: at each passage through the surface or, where there is a depth, on the way inside.",
            ..of("transmission.color", Kind::Color, field!(Color transmission_color))
        },
        Parameter {
            label: "Depth",
            help: "Distance at which white light reaches this colour, in bounding radii of the model. 0 tints the surface instead.",
            row: bar(0.0, 2.0),
            ..of(
                "transmission.depth",
                number([0.0, 1000.0], ""),
                field!(Number transmission_depth),
            )
        },
        Parameter {
            label: "Transmission roughness offset",
            symbol: "R",
            help: "Added to the roughness of the reflection for what is seen through: at 0 both are equally rough.",
            row: bar(-1.0, 1.0),
            ..of(
                "transmission.roughness",
                number([-1.0, 1.0], ""),
                field!(Number transmission_roughness),
            )
        },
    ]
}

fn emission() -> Vec<Parameter> {
    vec![
        Parameter {
            label: "Colour",
            help: "Colour of the light that the surface gives off.",
            applies: |material| material.emission_strength > 0.0,
            ..of("emission.color", Kind::Color, field!(Color emission_color))
        },
        Parameter {
            label: "Colour texture",
            help: "Multiplies the emission by a texture, the model's or one of your own.",
            ..of("emission.color_texture", Kind::Toggle, field!(Toggle textures.emission))
        },
        Parameter {
            label: "Strength",
            help: "Radiance of the light that the surface gives off; at 1, white looks as bright as the furnace.",
            applies: |_| true,
            row: bar(0.0, 20.0),
            ..of(
                "emission.strength",
                number([0.0, 1e6], ""),
                field!(Number emission_strength),
            )
        },
    ]
}

fn geometry() -> Vec<Parameter> {
    vec![
        Parameter {
            label: "Opacity",
            help: "The share of light that the surface stops; the rest goes straight on, as if nothing were there.",
            ..of("geometry.opacity", unit_number(), field!(Number opacity))
        },
        Parameter {
            label: "Opacity texture",
            help: "Multiplies the opacity by a texture, such as the alpha of the model's colour texture, honouring the model's alpha cutoff.",
            ..of(
                "geometry.opacity_texture",
                Kind::Toggle,
                field!(Toggle textures.opacity),
            )
        },
        Parameter {
            label: "Normal strength",
            help: "How steep the normal texture's bumps are; at 0 the surface is smooth, below 0 dents are bumps.",
            applies: |material| material.textures.normal,
            row: bar(0.0, 2.0),
            ..of(
                "geometry.normal_strength",
                number([-10.0, 10.0], ""),
                field!(Number normal_strength),
            )
        },
        Parameter {
            label: "Normal texture",
            help: "Bends the surface's normal by a texture.",
            ..of("geometry.normal_texture", Kind::Toggle, field!(Toggle textures.normal))
        },
    ]
}

type Applies = fn(&MaterialSettings) -> bool;

/// The groups of the panel by the first part of their parameters' keys, and when the rows of a group apply.
const GROUPS: [(&str, &str, Applies); 8] = [
    ("base", "Base", |_| true),
    ("specular", "Specular", has_specular),
    ("coat", "Coat", |material| material.coat_weight > 0.0),
    ("fuzz", "Fuzz", |material| material.fuzz_weight > 0.0),
    ("thin_film", "Thin film", |material| material.film_weight > 0.0),
    ("transmission", "Transmission", transmits),
    ("emission", "Emission", |_| true),
    ("geometry", "Geometry", |_| true),
];

/// A parameter that still needs its words.
fn of(key: &'static str, kind: Kind, (get, set): (Get, Set)) -> Parameter {
    let prefix = key.split('.').next();
    let group = GROUPS.iter().find(|(of_keys, ..)| Some(*of_keys) == prefix);
    let &(_, group, applies) = group.expect("a parameter's key begins with that of a group");
    Parameter {
        key,
        group,
        label: "",
        name: "",
        flag: None,
        symbol: "",
        help: "",
        kind,
        row: bar(0.0, 1.0),
        stage: Stage::Materials,
        applies,
        idle: |_| None,
        get,
        set,
    }
}

fn number(range: [f32; 2], unit: &'static str) -> Kind {
    Kind::Number { range, unit }
}

fn unit_number() -> Kind {
    number([0.0, 1.0], "")
}

/// A bar from `low` to `high`, with three decimals.
fn bar(low: f64, high: f64) -> RowStyle {
    RowStyle {
        bar: Some([low, high]),
        step: 0.01,
        decimals: 3,
        is_percent: false,
    }
}

fn has_specular(material: &MaterialSettings) -> bool {
    material.reflects()
}

fn transmits(material: &MaterialSettings) -> bool {
    material.transmits()
}

/// True where the Fresnel model distinguishes metals from dielectrics.
fn has_metalness(material: &MaterialSettings) -> bool {
    !matches!(material.fresnel, Fresnel::None | Fresnel::Conductor) || transmits(material)
}

fn has_curves(material: &MaterialSettings) -> bool {
    has_specular(material) && material.lobe.has_curves()
}

fn is_conductor(material: &MaterialSettings) -> bool {
    has_specular(material) && material.fresnel == Fresnel::Conductor
}

fn conductor_choices() -> Kind {
    let choice = |conductor: Conductor| Choice {
        name: conductor.name(),
        label: conductor.name(),
        help: match conductor {
            Conductor::Custom => "η and k of your own.",
            Conductor::Metal(_) => "η and k as measured.",
        },
    };
    Kind::Choice(Conductor::all().map(choice).collect())
}

fn conductor() -> (Get, Set) {
    (
        |material| Value::Choice(material.conductor.name()),
        |material, value| {
            if let Value::Choice(name) = value {
                material.set_conductor(Conductor::named(name));
            }
        },
    )
}

fn eta() -> (Get, Set) {
    (
        |material| Value::Triple(material.eta),
        |material, value| {
            if let Value::Triple(eta) = value {
                material.set_eta_and_k(eta, material.k);
            }
        },
    )
}

fn k() -> (Get, Set) {
    (
        |material| Value::Triple(material.k),
        |material, value| {
            if let Value::Triple(k) = value {
                material.set_eta_and_k(material.eta, k);
            }
        },
    )
}

fn custom_curve() -> (Get, Set) {
    (
        |material| Value::Curve(material.custom_curve.points().to_vec()),
        |material, value| {
            if let Value::Curve(points) = value
                && let Ok(curve) = CustomCurve::try_from(points)
            {
                material.custom_curve = curve;
            }
        },
    )
}
