//! A scene for Mitsuba 3: a ball with the material in even light, its material to be taken from there.

use std::collections::HashMap;
use std::path::Path;

use super::surface::{Law, Surface, Takes};
use super::xml::{Element, identifier, numbers};
use super::{ExchangeError, Format, Subject, Written, carried, shown};
use crate::document::MaterialSettings;
use crate::optics::fresnel::Fresnel;

/// Scenes for Mitsuba 3.
pub struct Mitsuba;

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
                &[
                    "base.diffuse_roughness",
                    "base.color_texture",
                    "specular.multiple_scattering",
                    "specular.weight_in_index",
                    "specular.edge_tint",
                    "specular.on_metal",
                    "coat.ior",
                    "coat.color",
                    "coat.anisotropy",
                    "coat.on_base",
                    "coat.darkening",
                    "fuzz.weight",
                    "thin_film.weight",
                    "thin_film.thickness",
                    "transmission.depth",
                    "transmission.roughness",
                ],
                match self {
                    Self::Diffuse => &["specular.eta", "specular.weight", "specular.color", "coat.weight"],
                    Self::Conductor => &["specular.weight", "specular.color", "coat.weight"],
                    Self::Glass => &["specular.eta", "coat.weight"],
                    Self::Principled => &["specular.eta", "specular.weight", "specular.color"],
                },
            ],
        }
    }
}

impl Format for Mitsuba {
    fn write(&self, subject: &Subject, path: &Path) -> Result<Written, ExchangeError> {
        let material = subject.only(path)?;
        let kind = Kind::of(material);
        let (surface, mut report) = shown(material, &kind.takes());
        report.entries.splice(0..0, surface.rotation_loss());
        let name = identifier(&material.name, &mut HashMap::new());
        let mut bsdf = match kind {
            Kind::Diffuse => bsdf("diffuse").child(rgb("reflectance", surface.base_color)),
            Kind::Conductor => conductor(material, &surface),
            Kind::Glass => glass(&surface),
            Kind::Principled => principled(&surface),
        };
        if kind != Kind::Glass && !(kind == Kind::Principled && surface.transmission_weight > 0.0) {
            bsdf = Element::new("bsdf").with("type", "twosided").child(bsdf);
        }
        if surface.opacity < 1.0 {
            bsdf = Element::new("bsdf")
                .with("type", "mask")
                .child(float("opacity", surface.opacity))
                .child(bsdf);
        }
        let scene = scene(bsdf.with("id", name.clone()), &name, surface.emission());
        let text = scene.document(Some(&carried::comment(material)));
        Ok(Written::text(text, vec![report]))
    }
}

fn bsdf(kind: &'static str) -> Element {
    Element::new("bsdf").with("type", kind)
}

fn rgb(name: &'static str, value: [f32; 3]) -> Element {
    Element::new("rgb").with("name", name).with("value", numbers(&value))
}

fn float(name: &'static str, value: f32) -> Element {
    Element::new("float")
        .with("name", name)
        .with("value", value.to_string())
}

fn text(name: &'static str, value: &'static str) -> Element {
    Element::new("string").with("name", name).with("value", value)
}

fn conductor(material: &MaterialSettings, surface: &Surface) -> Element {
    let [along, across] = surface.alphas();
    let tint = material.specular_color.map(|x| x * material.specular_weight);
    bsdf("roughconductor")
        .child(text("distribution", "ggx"))
        .child(float("alpha_u", along.max(1e-4)))
        .child(float("alpha_v", across.max(1e-4)))
        .child(rgb("eta", material.eta))
        .child(rgb("k", material.k))
        .child(rgb("specular_reflectance", tint))
}

fn glass(surface: &Surface) -> Element {
    let [along, across] = surface.alphas();
    let is_smooth = along < 1e-3;
    let mut glass = if is_smooth {
        bsdf("dielectric")
    } else {
        bsdf("roughdielectric").child(text("distribution", "ggx"))
    };
    if !is_smooth {
        glass.push(float("alpha_u", along));
        glass.push(float("alpha_v", across));
    }
    let tint = surface.specular_color.map(|x| x * surface.specular_weight);
    let through = if surface.transmission_depth > 0.0 {
        [1.0; 3]
    } else {
        surface.transmission_color
    };
    glass
        .child(float("int_ior", surface.ior.max(1.0001)))
        .child(float("ext_ior", 1.0))
        .child(rgb("specular_reflectance", tint))
        .child(rgb("specular_transmittance", through))
}

fn principled(surface: &Surface) -> Element {
    let principled = bsdf("principled")
        .child(rgb("base_color", surface.base_color))
        .child(float("metallic", surface.metalness))
        .child(float("roughness", surface.roughness))
        .child(float("anisotropic", surface.disney_anisotropy()))
        .child(float("spec_trans", surface.transmission_weight))
        .child(float("clearcoat", surface.coat_weight))
        .child(float("clearcoat_gloss", 1.0 - surface.coat_roughness));
    principled.child(float("eta", surface.ior.max(1.0001)))
}

fn scene(bsdf: Element, name: &str, emission: [f32; 3]) -> Element {
    let look = Element::new("lookat")
        .with("origin", "0, 0, 4")
        .with("target", "0, 0, 0")
        .with("up", "0, 1, 0");
    let film = Element::new("film")
        .with("type", "hdrfilm")
        .child(Element::new("integer").with("name", "width").with("value", "256"))
        .child(Element::new("integer").with("name", "height").with("value", "256"));
    let sampler = Element::new("sampler")
        .with("type", "independent")
        .child(Element::new("integer").with("name", "sample_count").with("value", "64"));
    let sensor = Element::new("sensor")
        .with("type", "perspective")
        .child(float("fov", 35.0))
        .child(Element::new("transform").with("name", "to_world").child(look))
        .child(film)
        .child(sampler);
    let mut ball = Element::new("shape")
        .with("type", "sphere")
        .child(Element::new("ref").with("name", "bsdf").with("id", name));
    if emission.iter().any(|x| *x > 0.0) {
        ball.push(
            Element::new("emitter")
                .with("type", "area")
                .child(rgb("radiance", emission)),
        );
    }
    Element::new("scene")
        .with("version", "3.0.0")
        .child(Element::new("integrator").with("type", "path"))
        .child(bsdf)
        .child(sensor)
        .child(ball)
        .child(
            Element::new("emitter")
                .with("type", "constant")
                .child(rgb("radiance", [1.0; 3])),
        )
}
