//! A scene for Mitsuba 3: a ball with the material in even light, its material to be taken from there.

use std::{collections::HashMap, path::Path};

use super::{
    ExchangeError, Subject, Written, carried, shown,
    surface::{Law, Surface, Takes},
    xml::{HEAD, element, identifier, numbers},
};
use crate::{document::MaterialSettings, optics::fresnel::Fresnel};

/// The material that stands for another one there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// `diffuse`.
    Diffuse,
    /// `roughconductor` with η and k.
    Conductor,
    /// `roughdielectric`, or `dielectric` where it is smooth.
    Glass,
    /// `principled`, Disney's.
    Principled,
}

impl Kind {
    fn of(material: &MaterialSettings) -> Self {
        let is_bare = material.coat_weight == 0.0;
        if is_bare
            && material.specular_weight == 0.0
            && material.transmission_weight == 0.0
            && material.metalness == 0.0
        {
            Self::Diffuse
        } else if is_bare && material.metalness == 1.0 && material.fresnel == Fresnel::Conductor {
            Self::Conductor
        } else if is_bare && material.metalness == 0.0 && material.transmission_weight == 1.0 {
            Self::Glass
        } else {
            Self::Principled
        }
    }

    fn takes(self) -> Takes {
        let is_principled = self == Self::Principled;
        Takes {
            law: if is_principled { Law::Schlick } else { Law::Exact },
            widths: if is_principled {
                Surface::disney_widths
            } else {
                Surface::widths
            },
            lacks: [
                "base.diffuse_roughness base.color_texture specular.multiple_scattering specular.weight_in_index \
                 specular.edge_tint specular.on_metal coat.ior coat.color coat.anisotropy coat.on_base coat.darkening \
                 fuzz.weight thin_film.weight thin_film.thickness transmission.depth transmission.roughness",
                match self {
                    Self::Diffuse => "specular.eta specular.weight specular.color coat.weight",
                    Self::Conductor => "specular.weight specular.color coat.weight",
                    Self::Glass => "specular.eta coat.weight",
                    Self::Principled => "specular.eta specular.weight specular.color",
                },
            ],
        }
    }
}

pub fn write(subject: &Subject, path: &Path) -> Result<Written, ExchangeError> {
    let material = subject.only(path)?;
    let kind = Kind::of(material);
    let (surface, mut report) = shown(material, &kind.takes());
    report.entries.splice(0..0, surface.rotation_loss());
    let name = identifier(&material.name, &mut HashMap::new());
    let (kind_name, parameters) = match kind {
        Kind::Diffuse => ("diffuse", rgb("reflectance", surface.base_color)),
        Kind::Conductor => ("roughconductor", conductor(material, &surface)),
        Kind::Glass => glass(&surface),
        Kind::Principled => ("principled", principled(&surface)),
    };
    let (mut head, mut inside) = (format!("bsdf type=\"{kind_name}\""), parameters);
    if kind != Kind::Glass && !(kind == Kind::Principled && surface.transmission_weight > 0.0) {
        (head, inside) = ("bsdf type=\"twosided\"".to_owned(), element(&head, &inside));
    }
    if surface.opacity < 1.0 {
        inside = float("opacity", surface.opacity) + &element(&head, &inside);
        head = "bsdf type=\"mask\"".to_owned();
    }
    let bsdf = element(&format!("{head} id=\"{name}\""), &inside);
    let mut ball = format!("<ref name=\"bsdf\" id=\"{name}\" />\n");
    if surface.emission().iter().any(|x| *x > 0.0) {
        ball += &element("emitter type=\"area\"", &rgb("radiance", surface.emission()));
    }
    let ball = element("shape type=\"sphere\"", &ball);
    let inside = format!("<integrator type=\"path\" />\n{bsdf}{SENSOR}{ball}{LIGHT}");
    let scene = element("scene version=\"3.0.0\"", &inside);
    let text = format!("{HEAD}<!-- {} -->\n{scene}", carried::comment(material));
    Ok(Written::text(text, vec![report]))
}

const SENSOR: &str = r#"<sensor type="perspective">
  <float name="fov" value="35" />
  <transform name="to_world">
    <lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0" />
  </transform>
  <film type="hdrfilm">
    <integer name="width" value="256" />
    <integer name="height" value="256" />
  </film>
  <sampler type="independent">
    <integer name="sample_count" value="64" />
  </sampler>
</sensor>
"#;
const LIGHT: &str = r#"<emitter type="constant">
  <rgb name="radiance" value="1, 1, 1" />
</emitter>"#;
const GGX: &str = "<string name=\"distribution\" value=\"ggx\" />\n";

fn rgb(name: &str, value: [f32; 3]) -> String {
    format!("<rgb name=\"{name}\" value=\"{}\" />\n", numbers(&value))
}

fn float(name: &str, value: f32) -> String {
    format!("<float name=\"{name}\" value=\"{value}\" />\n")
}

fn conductor(material: &MaterialSettings, surface: &Surface) -> String {
    let [along, across] = surface.alphas();
    let tint = material.specular_color.map(|x| x * material.specular_weight);
    [
        GGX.to_owned(),
        float("alpha_u", along.max(1e-4)),
        float("alpha_v", across.max(1e-4)),
        rgb("eta", material.eta),
        rgb("k", material.k),
        rgb("specular_reflectance", tint),
    ]
    .concat()
}

fn glass(surface: &Surface) -> (&'static str, String) {
    let [along, across] = surface.alphas();
    let tint = surface.specular_color.map(|x| x * surface.specular_weight);
    let through = if surface.transmission_depth > 0.0 {
        [1.0; 3]
    } else {
        surface.transmission_color
    };
    let smooth = [
        float("int_ior", surface.ior.max(1.0001)),
        float("ext_ior", 1.0),
        rgb("specular_reflectance", tint),
        rgb("specular_transmittance", through),
    ]
    .concat();
    if along < 1e-3 {
        return ("dielectric", smooth);
    }
    let rough = [GGX, &float("alpha_u", along), &float("alpha_v", across), &smooth].concat();
    ("roughdielectric", rough)
}

fn principled(surface: &Surface) -> String {
    let floats = [
        ("metallic", surface.metalness),
        ("roughness", surface.roughness),
        ("anisotropic", surface.disney_anisotropy()),
        ("spec_trans", surface.transmission_weight),
        ("clearcoat", surface.coat_weight),
        ("clearcoat_gloss", 1.0 - surface.coat_roughness),
        ("eta", surface.ior.max(1.0001)),
    ];
    let floats: String = floats.into_iter().map(|(name, value)| float(name, value)).collect();
    rgb("base_color", surface.base_color) + &floats
}
