//! The parameters of a material.

mod coat;

use std::sync::LazyLock;

use super::accessors::{choice, field};
use super::{Choice, Kind, Parameter, Stage, Value, choices};
use crate::document::custom_curve::CustomCurve;
use crate::document::material::FILM_THICKNESS_MAX;
use crate::document::{Conductor, MaterialSettings, SPECULAR_COLOR_MAX};
use crate::optics::curve::Curve;
use crate::optics::fresnel::Fresnel;
use crate::optics::lobe::{Horizon, Lobe};
use crate::scene::texture::TextureTarget as On;

type Accessors = super::Accessors<MaterialSettings>;

/// Every parameter, in the order of the panels. In files they are read in this order too: a conductor before the η and
/// k that may replace its own.
pub static PARAMETERS: LazyLock<Vec<Parameter>> = LazyLock::new(|| {
    let mut all = base();
    all.extend(specular_shape());
    all.extend(specular_fresnel());
    all.extend(coat::parameters());
    all.extend(fuzz());
    all.extend(thin_film());
    all.extend(transmission());
    all.extend(emission());
    all.extend(geometry());
    all
});

#[rustfmt::skip]
fn base() -> Vec<Parameter> {
    vec![
        of("base.weight", "Weight", "Darkens the base: its colour is multiplied by it.", unit_number(), field!(Number base_weight)),
        of("base.color", "Colour", "Colour of the diffuse base; of a metal, its reflection seen head-on.", Kind::Color, field!(Color base_color))
            .idle(of_indices),
        of("base.color_texture", "Colour texture", "Multiplies the colour by a texture, the model's or one of your own.", Kind::Toggle, field!(Toggle textures[On::BaseColor])),
        of("base.diffuse_roughness", "Diffuse roughness", "Scatters more of the base's light back to where it comes from: plaster, clay, cloth. 0 is Lambert's base.", unit_number(), field!(Number diffuse_roughness))
            .applies(|material| material.metalness < 1.0),
        of("base.metalness", "Metalness", "0: a dielectric, its reflection over a diffuse base. 1: a metal, no base, the reflection coloured.", unit_number(), field!(Number metalness)),
    ]
}

#[rustfmt::skip]
fn specular_shape() -> Vec<Parameter> {
    vec![
        of("specular.weight", "Weight", "How much of the reflection is kept; at 0 only the base is left.", unit_number(), field!(Number specular_weight))
            .applies(|_| true),
        of("specular.weight_in_index", "Weight by index", "The weight scales a dielectric's reflectance head-on, through the index, as in OpenPBR; off, at every angle, as in glTF.", Kind::Toggle, field!(Toggle specular_in_index))
            .applies(may_weigh_index),
        of("specular.on_metal", "Metals too", "Weight and tint are a metal's too; off, they are the dielectric's alone, as in glTF.", Kind::Toggle, field!(Toggle specular_on_metal))
            .applies(|material| material.metalness > 0.0 && has_metalness(material)),
        of("specular.lobe", "Lobe", "The model of how reflected light is spread.", choices::<Lobe>(), choice!(lobe)),
        of("specular.roughness", "Roughness", "0 is a mirror; 1 is fully diffuse for the geometric lobe.", unit_number(), field!(Number roughness))
            .symbol("R").applies(|material| has_specular(material) && material.lobe.has_roughness()),
        of("specular.roughness_texture", "Roughness texture", "Multiplies roughness and metalness by textures.", Kind::Toggle, field!(Toggle textures[On::Roughness])),
        of("specular.multiple_scattering", "Multiple scattering", "Keeps the light that meets a second facet of rough GGX: metals and clear glass. Off, they darken with roughness.", Kind::Toggle, field!(Toggle multiple_scattering))
            .applies(|material| has_specular(material) && material.lobe.traits().loses_light),
        of("specular.curve", "Curve", "The profile of the geometric lobe's highlight, from its middle to its edge.", choices::<Curve>(), choice!(curve))
            .symbol("D(ξ)").applies(has_curves),
        of("specular.custom_curve", "Custom curve", "Custom quantile function D(ξ).", Kind::Curve, custom_curve())
            .symbol("D(ξ)").applies(|material| has_curves(material) && material.curve.has_table()),
        of("specular.anisotropy", "Anisotropy", "Stretches the highlight along the surface's tangent, below 0 across it: brushed metal, hair, satin.", number([-1.0, 1.0], ""), field!(Number anisotropy))
            .symbol("Rx, Ry").bar(-1.0, 1.0).applies(|material| has_specular(material) && material.lobe.is_anisotropic()),
        of("specular.rotation", "Rotation", "Turns the direction of the stretch about the normal, anticlockwise seen from outside.", number([-360.0, 360.0], "°"), field!(Number rotation_deg))
            .bar(-180.0, 180.0).decimals(1).applies(|material| has_specular(material) && material.lobe.is_anisotropic() && material.anisotropy != 0.0),
        of("specular.horizon", "Below horizon", "What happens to samples that point into the surface.", choices::<Horizon>(), choice!(horizon))
            .applies(|material| has_specular(material) && !material.lobe.is_hemispherical()),
    ]
}

#[rustfmt::skip]
fn specular_fresnel() -> Vec<Parameter> {
    vec![
        of("specular.fresnel", "Fresnel", "How the share of reflected light grows towards grazing angles. A material that transmits light follows the exact equations of a dielectric.", choices::<Fresnel>(), choice!(fresnel))
            .symbol("F").applies(|material| has_specular(material) && !transmits(material)),
        of("specular.ior", "Index of refraction", "How strongly the dielectric reflects and refracts: water 1.33, plastic and glass 1.5, diamond 2.4.", number([1.0, 4.0], ""), field!(Number ior))
            .symbol("n").bar(1.0, 2.5).applies(has_index),
        of("specular.color", "Tint", "Colours the reflection. Above 1 it raises Schlick's reflectance of a dielectric seen head-on, up to 1.", Kind::Tint { most: SPECULAR_COLOR_MAX }, field!(Color specular_color)),
        of("specular.edge_tint", "Edge tint", "Colours a metal's reflection towards the edge, strongest at 82° (F82 tint); white leaves it alone.", Kind::Color, field!(Color edge_tint))
            .applies(|material| has_specular(material) && has_metalness(material) && material.metalness > 0.0),
        of("specular.conductor", "Metal", "Takes the index of refraction of a measured metal.", conductor_choices(), conductor())
            .applies(is_conductor),
        of("specular.eta", "η", "Real part of the metal's index of refraction for red, green and blue, as measured unless changed.", Kind::Triple { range: [0.0, 20.0] }, eta())
            .symbol("η").applies(is_conductor),
        of("specular.k", "k", "Imaginary part: how strongly the metal absorbs red, green and blue, as measured unless changed.", Kind::Triple { range: [0.0, 20.0] }, k())
            .symbol("k").applies(is_conductor),
    ]
}

#[rustfmt::skip]
fn fuzz() -> Vec<Parameter> {
    vec![
        of("fuzz.weight", "Weight", "A layer of small fibres over everything else, brightest at the edge: velvet, peach, dust.", unit_number(), field!(Number fuzz_weight))
            .applies(|_| true),
        of("fuzz.weight_texture", "Weight texture", "Multiplies the weight by a texture.", Kind::Toggle, field!(Toggle textures[On::Fuzz])),
        of("fuzz.color", "Colour", "Colours what the fibres reflect; what lies below loses as much light of every colour.", Kind::Color, field!(Color fuzz_color)),
        of("fuzz.color_texture", "Colour texture", "Multiplies the colour by a texture.", Kind::Toggle, field!(Toggle textures[On::FuzzColor])),
        of("fuzz.roughness", "Roughness", "How far the fibres spread the light: low only at the edge, high as dust all over.", unit_number(), field!(Number fuzz_roughness))
            .symbol("R"),
        of("fuzz.roughness_texture", "Roughness texture", "Multiplies the roughness by a texture.", Kind::Toggle, field!(Toggle textures[On::FuzzRoughness])),
    ]
}

#[rustfmt::skip]
fn thin_film() -> Vec<Parameter> {
    vec![
        of("thin_film.weight", "Weight", "A film that is thin as light's wavelength: soap, oil, oxide on hot steel. What its sides reflect interferes in colours.", unit_number(), field!(Number film_weight))
            .applies(|material| has_specular(material) && material.fresnel_model() != Fresnel::None),
        of("thin_film.weight_texture", "Weight texture", "Multiplies the weight by a texture.", Kind::Toggle, field!(Toggle textures[On::Film])),
        of("thin_film.thickness", "Thickness", "Decides the colours: oxide on steel is straw at 0.02 and blue at 0.05, soap films have 0.1 to 1.", number([0.0, FILM_THICKNESS_MAX], "µm"), field!(Number film_thickness))
            .symbol("d").bar(0.0, 1.0),
        of("thin_film.thickness_texture", "Thickness texture", "Multiplies the thickness by a texture.", Kind::Toggle, field!(Toggle textures[On::FilmThickness])),
        of("thin_film.ior", "Index of refraction", "How strongly the film reflects: soap 1.33, oil 1.47, oxide of steel 2.4; at the base's own there is none to see.", number([1.0, 3.0], ""), field!(Number film_ior))
            .symbol("n").bar(1.0, 3.0),
    ]
}

#[rustfmt::skip]
fn transmission() -> Vec<Parameter> {
    vec![
        of("transmission.weight", "Weight", "How much of the base is clear instead of diffuse: glass, water, amber. The surface must be closed.", unit_number(), field!(Number transmission_weight))
            .applies(|material| material.metalness < 1.0),
        of("transmission.color", "Colour", "Colours what is seen through: at each passage through the surface or, where there is a depth, on the way inside.", Kind::Color, field!(Color transmission_color)),
        of("transmission.depth", "Depth", "Distance at which white light reaches this colour, in bounding radii of the model. 0 tints the surface instead.", number([0.0, 1000.0], ""), field!(Number transmission_depth))
            .bar(0.0, 2.0),
        of("transmission.roughness", "Transmission roughness offset", "Added to the roughness of the reflection for what is seen through: at 0 both are equally rough.", number([-1.0, 1.0], ""), field!(Number transmission_roughness))
            .symbol("R").bar(-1.0, 1.0),
    ]
}

#[rustfmt::skip]
fn emission() -> Vec<Parameter> {
    vec![
        of("emission.color", "Colour", "Colour of the light that the surface gives off.", Kind::Color, field!(Color emission_color))
            .applies(|material| material.emission_strength > 0.0),
        of("emission.color_texture", "Colour texture", "Multiplies the emission by a texture, the model's or one of your own.", Kind::Toggle, field!(Toggle textures[On::Emission])),
        of("emission.strength", "Strength", "Radiance of the light that the surface gives off; at 1, white looks as bright as the furnace.", number([0.0, 1e6], ""), field!(Number emission_strength))
            .bar(0.0, 20.0).applies(|_| true),
    ]
}

#[rustfmt::skip]
fn geometry() -> Vec<Parameter> {
    vec![
        of("geometry.opacity", "Opacity", "The share of light that the surface stops; the rest goes straight on, as if nothing were there.", unit_number(), field!(Number opacity)),
        of("geometry.opacity_texture", "Opacity texture", "Multiplies the opacity by a texture, such as the alpha of the model's colour texture, honouring the model's alpha cutoff.", Kind::Toggle, field!(Toggle textures[On::Opacity])),
        of("geometry.normal_strength", "Normal strength", "How steep the normal texture's bumps are; at 0 the surface is smooth, below 0 dents are bumps.", number([-10.0, 10.0], ""), field!(Number normal_strength))
            .bar(0.0, 2.0).applies(|material| material.textures[On::Normal]),
        of("geometry.normal_texture", "Normal texture", "Bends the surface's normal by a texture.", Kind::Toggle, field!(Toggle textures[On::Normal])),
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

fn of(key: &'static str, label: &'static str, help: &'static str, kind: Kind, accessors: Accessors) -> Parameter {
    let prefix = key.split('.').next();
    let group = GROUPS.iter().find(|(of_keys, ..)| Some(*of_keys) == prefix);
    let &(_, group, applies) = group.expect("a parameter's key begins with that of a group");
    Parameter::plain(key, label, help, kind, Stage::Materials, accessors)
        .group(group)
        .applies(applies)
        .bar(0.0, 1.0)
}

fn number(range: [f32; 2], unit: &'static str) -> Kind {
    Kind::Number { range, unit }
}

fn unit_number() -> Kind {
    number([0.0, 1.0], "")
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

fn of_indices(material: &MaterialSettings) -> Option<&'static str> {
    let is_measured = is_conductor(material) && material.metalness >= 1.0;
    is_measured.then_some(
        "The metal's colour follows from its measured η and k. Edit as colours, below Metal, gives it colours to pick.",
    )
}

fn may_weigh_index(material: &MaterialSettings) -> bool {
    let is_weighed = material.specular_weight < 1.0 && material.metalness < 1.0;
    is_weighed && has_specular(material) && has_metalness(material) && !transmits(material)
}

fn has_index(material: &MaterialSettings) -> bool {
    let of_dielectric = matches!(material.fresnel, Fresnel::Schlick | Fresnel::Dielectric);
    transmits(material) || (has_specular(material) && of_dielectric && material.metalness < 1.0)
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

fn conductor() -> Accessors {
    (
        |material| Value::Choice(material.conductor.name()),
        |material, value| {
            if let Value::Choice(name) = value {
                material.set_conductor(Conductor::named(name));
            }
        },
    )
}

fn eta() -> Accessors {
    (
        |material| Value::Triple(material.eta),
        |material, value| {
            if let Value::Triple(eta) = value {
                material.set_eta_and_k(eta, material.k);
            }
        },
    )
}

fn k() -> Accessors {
    (
        |material| Value::Triple(material.k),
        |material, value| {
            if let Value::Triple(k) = value {
                material.set_eta_and_k(material.eta, k);
            }
        },
    )
}

fn custom_curve() -> Accessors {
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
