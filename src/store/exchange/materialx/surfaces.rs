//! The kinds of surfaces that are read, each with its inputs as a surface of Glossmith's.

use super::{artistic::edge_color, artistic::edge_tint, inputs::Inputs, table};
use crate::{
    document::parameter,
    import::{FileParameter, USD_PREVIEW_SURFACE, widths_from_gltf},
    optics::{fresnel::fresnel_f0, layer::fuzz::fuzz_of_sheen, lobe::anisotropy_from_ratio},
    store::exchange::report::Entry,
    store::exchange::surface::{Law, Surface, Takes},
};

/// A kind of surface that is read.
#[derive(Debug)]
pub struct SurfaceKind {
    /// Name of its node.
    pub name: &'static str,
    /// Every input that it has, and what becomes of it.
    pub inputs: &'static [FileParameter],
    /// Takes what is no number of one parameter over from the inputs.
    read: fn(&mut Inputs, &mut Surface),
}

/// Every kind: name, inputs, how it is read.
pub static SURFACES: &[SurfaceKind] = &[
    kind("open_pbr_surface", table::OPEN_PBR, open_pbr),
    kind("standard_surface", table::STANDARD_SURFACE, standard_surface),
    kind("gltf_pbr", table::GLTF_PBR, gltf_pbr),
    kind("UsdPreviewSurface", USD_PREVIEW_SURFACE, usd_preview_surface),
    kind("disney_principled", table::DISNEY_PRINCIPLED, disney_principled),
    kind("surface_unlit", table::SURFACE_UNLIT, surface_unlit),
];

const fn kind(
    name: &'static str,
    inputs: &'static [FileParameter],
    read: fn(&mut Inputs, &mut Surface),
) -> SurfaceKind {
    SurfaceKind { name, inputs, read }
}

impl SurfaceKind {
    /// The kind of that name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SURFACES.iter().find(|kind| kind.name == name)
    }

    pub fn unset(&self) -> Inputs {
        Inputs::new(self.name, self.inputs)
    }

    /// The surface of these inputs, with what is lost of them.
    pub fn surface(&self, mut inputs: Inputs) -> (Surface, Vec<Entry>) {
        inputs.settle();
        let mut surface = inputs.direct();
        (self.read)(&mut inputs, &mut surface);
        (surface, inputs.losses)
    }
}

fn weighted(color: [f32; 3], weight: f32) -> [f32; 3] {
    color.map(|x| x * weight)
}

fn luminance(color: [f32; 3]) -> f32 {
    0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2]
}

/// The anisotropy for a highlight whose widths differ by the share that a format's number says.
fn stretched(number: f32, most: f32) -> f32 {
    anisotropy_from_ratio(f64::from(1.0 - number.clamp(0.0, most))) as f32
}

fn open_pbr(inputs: &mut Inputs, s: &mut Surface) {
    if s.metalness > 0.5 {
        s.edge_tint = std::mem::replace(&mut s.specular_color, [1.0; 3]);
    }
    s.specular_in_index = s.specular_weight != 1.0;
    // The weight is a metal's too, the tint is not: where both are, neither.
    s.specular_on_metal = s.specular_color == [1.0; 3];
    for (roughness, anisotropy) in [
        (&mut s.roughness, &mut s.anisotropy),
        (&mut s.coat_roughness, &mut s.coat_anisotropy),
    ] {
        *roughness /= widening(1.0 - anisotropy.clamp(0.0, 0.999));
        *anisotropy = stretched(*anisotropy, 0.999);
    }
    s.coat_on_base = true;
    s.opacity = luminance(inputs.color("geometry_opacity"));
}

/// The numbers that OpenPBR's inputs have for a surface.
pub fn as_open_pbr(surface: &Surface) -> Surface {
    let mut s = surface.clone();
    s.counter_coat();
    s.specular_color = s.tint();
    (s.roughness, s.anisotropy) = roughness_and_anisotropy(&s);
    let coat_ratio = s.coat_ratio();
    s.coat_roughness = (s.coat_roughness * widening(coat_ratio)).min(1.0);
    s.coat_anisotropy = 1.0 - coat_ratio;
    (s.emission_strength, s.emission_color) = s.strength_and_color();
    s
}

fn standard_surface(inputs: &mut Inputs, s: &mut Surface) {
    let root = inputs.number("sheen_roughness").max(0.0).sqrt();
    let color = weighted(inputs.color("sheen_color"), inputs.number("sheen"));
    put_sheen(inputs, s, color, root);
    s.anisotropy = stretched(s.anisotropy, 0.98);
    s.coat_anisotropy = stretched(s.coat_anisotropy, 0.98);
    if s.metalness > 0.5 {
        // A metal has it towards its edge.
        let color = weighted(s.specular_color, s.specular_weight);
        s.edge_tint = edge_tint(weighted(s.base_color, s.base_weight), color);
        (s.specular_weight, s.specular_color) = (1.0, [1.0; 3]);
    }
    // Every thickness but 0 is a film.
    s.film_weight = f32::from(s.film_thickness > 0.0);
    s.opacity = luminance(inputs.color("opacity"));
}

/// The numbers that Standard Surface's inputs have for a surface.
pub fn as_standard_surface(surface: &Surface) -> Surface {
    let (ratio, rotation_deg) = surface.ratio_and_rotation();
    let (emission_strength, emission_color) = surface.strength_and_color();
    Surface {
        specular_color: if surface.metalness > 0.5 {
            edge_color(surface.base_color, surface.edge_tint)
        } else {
            surface.tint()
        },
        anisotropy: 1.0 - ratio,
        rotation_deg: rotation_deg.rem_euclid(360.0),
        coat_anisotropy: 1.0 - surface.coat_ratio(),
        film_thickness: if surface.film_weight > 0.0 {
            surface.film_thickness
        } else {
            0.0
        },
        emission_strength,
        emission_color,
        ..surface.clone()
    }
}

/// Puts on the fuzz that a sheen of a colour and the root of its α looks like.
fn put_sheen(inputs: &mut Inputs, s: &mut Surface, color: [f32; 3], root_of_alpha: f32) {
    (s.fuzz_weight, s.fuzz_color, s.fuzz_roughness) = fuzz_of_sheen(color, root_of_alpha);
    if s.fuzz_weight > 0.0 {
        let detail = "fuzz of about its albedo stands for it";
        inputs.losses.push(Entry::approximated("sheen", detail, None));
    }
}

fn gltf_pbr(inputs: &mut Inputs, s: &mut Surface) {
    let (sheen, root) = (inputs.color("sheen_color"), inputs.number("sheen_roughness"));
    put_sheen(inputs, s, sheen, root);
    let widths = widths_from_gltf(s.roughness, s.anisotropy);
    if !widths.is_exact {
        let detail = "the highlight is stretched no more than 19 : 1";
        let entry = Entry::approximated("anisotropy_strength", detail, None);
        inputs.losses.push(entry);
    }
    (s.roughness, s.anisotropy) = (widths.roughness, widths.stretch);
    if s.transmission_depth <= 0.0 {
        s.transmission_color = s.base_color;
    }
    // By its alpha mode: 0 all of it is there, 1 all or nothing, 2 the share that alpha says.
    let alpha = inputs.number("alpha");
    s.opacity = match inputs.number("alpha_mode") {
        0.0 => 1.0,
        1.0 => f32::from(alpha >= inputs.number("alpha_cutoff")),
        _ => alpha,
    };
}

fn disney_principled(inputs: &mut Inputs, s: &mut Surface) {
    // The node has a sheen of no roughness of its own.
    let sheen = [inputs.number("sheen"); 3];
    put_sheen(inputs, s, sheen, 0.5);
    let tint = inputs.number("sheenTint").clamp(0.0, 1.0);
    s.fuzz_color = s.base_color.map(|x| 1.0 + tint * (x - 1.0));
    s.transmission_color = s.base_color;
    // 0.5 leaves the reflectance of the index as it is.
    s.specular_in_index = s.specular_weight != 0.5;
    s.specular_weight *= 2.0;
    // MaterialX has the anisotropy of Standard Surface there.
    s.anisotropy = stretched(s.anisotropy, 0.98);
    s.coat_roughness = 1.0 - inputs.number("clearcoatGloss");
}

fn usd_preview_surface(inputs: &mut Inputs, s: &mut Surface) {
    let (opacity, threshold) = (inputs.number("opacity"), inputs.number("opacityThreshold"));
    // What is not stopped is refracted, unless the surface is cut out or is said to be there in part.
    (s.opacity, s.transmission_weight) = match inputs.number("opacityMode") > 0.0 {
        _ if threshold > 0.0 => (f32::from(opacity >= threshold), 0.0),
        true => (opacity, 0.0),
        false => (1.0, 1.0 - opacity),
    };
    if inputs.number("useSpecularWorkflow") == 0.0 {
        s.specular_color = [1.0; 3];
    } else {
        // The reflection head-on is a colour by itself: what the index has it is multiplied by.
        s.metalness = 0.0;
        s.specular_color = weighted(s.specular_color, fresnel_f0(s.ior).max(0.001).recip());
    }
    s.emission_strength = 1.0;
}

/// The numbers that the inputs of a UsdPreviewSurface have for a surface.
pub fn as_preview_surface(surface: &Surface) -> Surface {
    Surface {
        emission_color: surface.emission(),
        // Refraction is thin there: what opacity does not stop is seen behind.
        transmission_weight: surface.opacity * (1.0 - surface.transmission_weight * (1.0 - surface.metalness)),
        ..surface.clone()
    }
}

fn surface_unlit(_inputs: &mut Inputs, s: &mut Surface) {
    (s.base_color, s.specular_weight) = ([0.0; 3], 0.0);
}

/// The number or colour that an input has for a surface; none where it has none.
pub fn written(row: &FileParameter, shown: &Surface) -> Option<[f32; 3]> {
    let parameter = parameter(row.keys()[0]).ok().filter(|_| !row.default.is_empty());
    Some(parameter?.rgb(shown)?.map(|x| x * row.per))
}

/// OpenPBR's roughness and anisotropy a: α's along and across are r² √(2/(1 + (1 − a)²)) and (1 − a) times that.
fn roughness_and_anisotropy(surface: &Surface) -> (f32, f32) {
    let (ratio, _) = surface.ratio_and_rotation();
    let roughness = surface.roughness * widening(ratio);
    (roughness.min(1.0), 1.0 - ratio)
}

/// Its roughness over the one of the mean of both widths, by their ratio.
fn widening(ratio: f32) -> f32 {
    ((1.0 + ratio * ratio) / (2.0 * ratio)).powf(0.25)
}

/// The widths that are shown: roughness is 1 at most.
fn widths(surface: &Surface) -> [f32; 2] {
    let (roughness, anisotropy) = roughness_and_anisotropy(surface);
    let ratio = 1.0 - anisotropy;
    let along = roughness * roughness * (2.0 / (1.0 + ratio * ratio)).sqrt();
    [along, along * ratio]
}

impl Takes {
    /// What OpenPBR has a place for.
    pub const OPEN_PBR: Self = Self {
        law: Law::Exact,
        widths,
        lacks: ["specular.eta base.color_texture transmission.roughness", ""],
    };
}
