//! The parameters of a material.

use std::sync::LazyLock;

use super::{
    Choice, Kind, Parameter, Stage, Value,
    accessors::{choice, color, field, own, rows, share, toggle},
    line::single,
};
use crate::{
    document::{
        CoatLobe, Conductor, MaterialSettings, SPECULAR_COLOR_MAX, custom_curve::CustomCurve,
        material::FILM_THICKNESS_MAX,
    },
    optics::{curve::Curve, fresnel::Fresnel, lobe::Horizon, lobe::Lobe},
    scene::texture::TextureTarget as On,
};

/// Every parameter, in the order of the panels. In files they are read in this order too: a conductor before the η and
/// k that may replace its own.
pub static PARAMETERS: LazyLock<Vec<Parameter>> = LazyLock::new(|| {
    rows! {
        "base.weight" "Weight" "Darkens the base: its colour is multiplied by it." share(base_weight);
        "base.color" "Colour" "Colour of the diffuse base; of a metal, its reflection seen head-on." color(base_color)
            .idle(of_indices);
        "base.color_texture" "Colour texture" "Multiplies the colour by a texture, the model's or one of your own." toggle(textures[On::BaseColor]);
        "base.diffuse_roughness" "Diffuse roughness" "Scatters more of the base's light back to where it comes from: plaster, clay, cloth. 0 is Lambert's base." share(diffuse_roughness)
            .applies(|material| material.metalness < 1.0);
        "base.metalness" "Metalness" "0: a dielectric, its reflection over a diffuse base. 1: a metal, no base, the reflection coloured." share(metalness);
        "specular.weight" "Weight" "How much of the reflection is kept; at 0 only the base is left." share(specular_weight)
            .applies(|_| true);
        "specular.weight_texture" "Weight texture" "Multiplies the weight by a texture, at every angle." toggle(textures[On::Specular]);
        "specular.weight_in_index" "Weight by index" "The weight scales a dielectric's reflectance head-on, through the index, as in OpenPBR; off, at every angle, as in glTF." toggle(specular_in_index)
            .applies(may_weigh_index);
        "specular.on_metal" "Metals too" "Weight and tint are a metal's too; off, they are the dielectric's alone, as in glTF." toggle(specular_on_metal)
            .applies(|material| material.metalness > 0.0 && has_metalness(material));
        "specular.lobe" "Lobe" "The model of how reflected light is spread." choice(Lobe lobe);
        "specular.roughness" "Roughness" "0 is a mirror; 1 is fully diffuse for the geometric lobe." share(roughness)
            .symbol("R").applies(|material| has_specular(material) && material.lobe.has_roughness());
        "specular.roughness_texture" "Roughness texture" "Multiplies roughness and metalness by textures." toggle(textures[On::Roughness]);
        "specular.multiple_scattering" "Multiple scattering" "Keeps the light that meets a second facet of rough GGX: metals and clear glass. Off, they darken with roughness." toggle(multiple_scattering)
            .applies(|material| has_specular(material) && material.lobe.traits().loses_light);
        "specular.curve" "Curve" "The profile of the geometric lobe's highlight, from its middle to its edge." choice(Curve curve)
            .symbol("D(ξ)").applies(has_curves);
        "specular.custom_curve" "Custom curve" "Custom quantile function D(ξ)." own(custom_curve)
            .symbol("D(ξ)").applies(|material| has_curves(material) && material.curve.has_table());
        "specular.anisotropy" "Anisotropy" "Stretches the highlight along the surface's tangent, below 0 across it: brushed metal, hair, satin." field(anisotropy, single(-1.0..=1.0, ""))
            .symbol("Rx, Ry").bar(-1.0, 1.0).applies(|material| has_specular(material) && material.lobe.is_anisotropic());
        "specular.rotation" "Rotation" "Turns the direction of the stretch about the normal, anticlockwise seen from outside." field(rotation_deg, single(-360.0..=360.0, "°"))
            .bar(-180.0, 180.0).decimals(1).applies(|material| has_specular(material) && material.lobe.is_anisotropic() && material.anisotropy != 0.0);
        "specular.horizon" "Below horizon" "What happens to samples that point into the surface." choice(Horizon horizon)
            .applies(|material| has_specular(material) && !material.lobe.is_hemispherical());
        "specular.fresnel" "Fresnel" "How the share of reflected light grows towards grazing angles. A material that transmits light follows the exact equations of a dielectric." choice(Fresnel fresnel)
            .symbol("F").applies(|material| has_specular(material) && !transmits(material));
        "specular.ior" "Index of refraction" "How strongly the dielectric reflects and refracts: water 1.33, plastic and glass 1.5, diamond 2.4." field(ior, single(1.0..=4.0, ""))
            .symbol("n").bar(1.0, 2.5).applies(has_index);
        "specular.color" "Tint" "Colours the reflection. Above 1 it raises Schlick's reflectance of a dielectric seen head-on, up to 1." field(specular_color, Kind::Color { most: SPECULAR_COLOR_MAX });
        "specular.edge_tint" "Edge tint" "Colours a metal's reflection towards the edge, strongest at 82° (F82 tint); white leaves it alone." color(edge_tint)
            .applies(|material| has_specular(material) && has_metalness(material) && material.metalness > 0.0);
        "specular.conductor" "Metal" "Takes the index of refraction of a measured metal." own(conductor)
            .applies(is_conductor);
        "specular.eta" "η" "Real part of the metal's index of refraction for red, green and blue, as measured unless changed." own(eta)
            .symbol("η").applies(is_conductor);
        "specular.k" "k" "Imaginary part: how strongly the metal absorbs red, green and blue, as measured unless changed." own(k)
            .symbol("k").applies(is_conductor);
        "coat.weight" "Weight" "A layer of clear lacquer over everything else." share(coat_weight)
            .applies(|_| true);
        "coat.weight_texture" "Weight texture" "Multiplies the weight by a texture." toggle(textures[On::Coat]);
        "coat.lobe" "Lobe" "The model of how the coat spreads reflected light." choice(CoatLobe coat_lobe);
        "coat.roughness" "Roughness" "How far the coat spreads its reflection." share(coat_roughness)
            .symbol("R");
        "coat.roughness_texture" "Roughness texture" "Multiplies GGX's roughness of the coat by a texture." toggle(textures[On::CoatRoughness]);
        "coat.anisotropy" "Anisotropy" "Stretches the coat's reflection along the tangent of what lies below, or across it below 0." field(coat_anisotropy, single(-1.0..=1.0, ""));
        "coat.ior" "Index of refraction" "How strongly the coat reflects: lacquer 1.5, oil 1.4, at 1 nothing." field(coat_ior, single(1.0..=4.0, ""))
            .symbol("n").bar(1.0, 2.5);
        "coat.color" "Colour" "Colours what is seen through the coat." color(coat_color);
        "coat.color_texture" "Colour texture" "Multiplies the colour of the coat by a texture." toggle(textures[On::CoatColor]);
        "coat.darkening" "Darkening" "How much darker a base gets by light that the coat reflects back onto it: varnish on wood. A white base stays white." share(coat_darkening);
        "coat.on_base" "On the base" "The coat changes what lies below, as in OpenPBR: its reflection, roughness, emission and colour by angle. Off, as in glTF, it does not." toggle(coat_on_base);
        "coat.normal_strength" "Normal strength" "Scales the slopes of the coat's normal texture." field(coat_normal_strength, single(-10.0..=10.0, ""))
            .applies(|material| material.coat_weight > 0.0 && material.textures[On::CoatNormal]).bar(0.0, 2.0);
        "coat.normal_texture" "Normal texture" "Bends the coat's normal by a texture." toggle(textures[On::CoatNormal]);
        "fuzz.weight" "Weight" "A layer of small fibres over everything else, brightest at the edge: velvet, peach, dust." share(fuzz_weight)
            .applies(|_| true);
        "fuzz.weight_texture" "Weight texture" "Multiplies the weight by a texture." toggle(textures[On::Fuzz]);
        "fuzz.color" "Colour" "Colours what the fibres reflect; what lies below loses as much light of every colour." color(fuzz_color);
        "fuzz.color_texture" "Colour texture" "Multiplies the colour by a texture." toggle(textures[On::FuzzColor]);
        "fuzz.roughness" "Roughness" "How far the fibres spread the light: low only at the edge, high as dust all over." share(fuzz_roughness)
            .symbol("R");
        "fuzz.roughness_texture" "Roughness texture" "Multiplies the roughness by a texture." toggle(textures[On::FuzzRoughness]);
        "thin_film.weight" "Weight" "A film that is thin as light's wavelength: soap, oil, oxide on hot steel. What its sides reflect interferes in colours." share(film_weight)
            .applies(|material| has_specular(material) && material.fresnel_model() != Fresnel::None);
        "thin_film.weight_texture" "Weight texture" "Multiplies the weight by a texture." toggle(textures[On::Film]);
        "thin_film.thickness" "Thickness" "Decides the colours: oxide on steel is straw at 0.02 and blue at 0.05, soap films have 0.1 to 1." field(film_thickness, single(0.0..=FILM_THICKNESS_MAX.into(), "µm"))
            .symbol("d").bar(0.0, 1.0);
        "thin_film.thickness_texture" "Thickness texture" "Multiplies the thickness by a texture." toggle(textures[On::FilmThickness]);
        "thin_film.ior" "Index of refraction" "How strongly the film reflects: soap 1.33, oil 1.47, oxide of steel 2.4; at the base's own there is none to see." field(film_ior, single(1.0..=3.0, ""))
            .symbol("n").bar(1.0, 3.0);
        "thin_film.bands" "Bands" "Blurs the fine fringes of films thicker than four wavelengths, as a band of wavelengths does. Off, each channel is one wavelength." toggle(film_bands);
        "transmission.weight" "Weight" "How much of the base is clear instead of diffuse: glass, water, amber. The surface must be closed." share(transmission_weight)
            .applies(|material| material.metalness < 1.0);
        "transmission.weight_texture" "Weight texture" "Multiplies the weight by a texture." toggle(textures[On::Transmission]);
        "transmission.color" "Colour" "Colours what is seen through: at each passage through the surface or, where there is a depth, on the way inside." color(transmission_color);
        "transmission.depth" "Depth" "Distance at which white light reaches this colour, in bounding radii of the model. 0 tints the surface instead." field(transmission_depth, single(0.0..=1000.0, ""))
            .bar(0.0, 2.0);
        "transmission.roughness" "Transmission roughness offset" "Added to the roughness of the reflection for what is seen through: at 0 both are equally rough." field(transmission_roughness, single(-1.0..=1.0, ""))
            .symbol("R").bar(-1.0, 1.0);
        "emission.color" "Colour" "Colour of the light that the surface gives off." color(emission_color)
            .applies(|material| material.emission_strength > 0.0);
        "emission.color_texture" "Colour texture" "Multiplies the emission by a texture, the model's or one of your own." toggle(textures[On::Emission]);
        "emission.strength" "Strength" "Radiance of the light that the surface gives off; at 1, white looks as bright as the furnace." field(emission_strength, single(0.0..=1e6, ""))
            .bar(0.0, 20.0).applies(|_| true);
        "geometry.opacity" "Opacity" "The share of light that the surface stops; the rest goes straight on, as if nothing were there." share(opacity);
        "geometry.opacity_texture" "Opacity texture" "Multiplies the opacity by a texture, such as the alpha of the model's colour texture, honouring the model's alpha cutoff." toggle(textures[On::Opacity]);
        "geometry.normal_strength" "Normal strength" "How steep the normal texture's bumps are; at 0 the surface is smooth, below 0 dents are bumps." field(normal_strength, single(-10.0..=10.0, ""))
            .bar(0.0, 2.0).applies(|material| material.textures[On::Normal]);
        "geometry.normal_texture" "Normal texture" "Bends the surface's normal by a texture." toggle(textures[On::Normal]);
    }
});

type Applies = fn(&MaterialSettings) -> bool;
type Takes = super::Takes<MaterialSettings>;

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

fn of(key: &'static str, label: &'static str, help: &'static str, takes: Takes) -> Parameter {
    let prefix = key.split('.').next();
    let group = GROUPS.iter().find(|(of_keys, ..)| Some(*of_keys) == prefix);
    let &(_, group, applies) = group.expect("a parameter's key begins with that of a group");
    Parameter::plain(key, label, help, takes, Stage::Materials)
        .group(group)
        .applies(applies)
        .bar(0.0, 1.0)
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

fn conductor() -> Takes {
    let choice = |conductor: Conductor| Choice {
        name: conductor.name(),
        label: conductor.name(),
        help: match conductor {
            Conductor::Custom => "η and k of your own.",
            Conductor::Metal(_) => "η and k as measured.",
        },
    };
    (
        Kind::Choice(Conductor::all().map(choice).collect()),
        (
            |material| Value::Choice(material.conductor.name()),
            |material, value| {
                if let Value::Choice(name) = value {
                    material.set_conductor(Conductor::named(name));
                }
            },
        ),
    )
}

const INDEX: Kind = Kind::Triple { range: [0.0, 20.0] };

fn eta() -> Takes {
    (
        INDEX,
        (
            |material| Value::Triple(material.eta),
            |material, value| {
                if let Value::Triple(eta) = value {
                    material.set_eta_and_k(eta, material.k);
                }
            },
        ),
    )
}

fn k() -> Takes {
    (
        INDEX,
        (
            |material| Value::Triple(material.k),
            |material, value| {
                if let Value::Triple(k) = value {
                    material.set_eta_and_k(material.eta, k);
                }
            },
        ),
    )
}

fn custom_curve() -> Takes {
    (
        Kind::Curve,
        (
            |material| Value::Curve(material.custom_curve.points().to_vec()),
            |material, value| {
                if let Value::Curve(points) = value
                    && let Ok(curve) = CustomCurve::try_from(points)
                {
                    material.custom_curve = curve;
                }
            },
        ),
    )
}
