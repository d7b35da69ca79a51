//! The kinds of surfaces that are read, each with its inputs as a surface of Glossmith's.

use super::artistic::edge_tint;
use super::inputs::Inputs;
use super::table;
use crate::import::{FileParameter, widths_from_gltf};
use crate::optics::fresnel::fresnel_f0;
use crate::optics::layer::fuzz::fuzz_of_sheen;
use crate::optics::lobe::anisotropy_from_ratio;
use crate::store::exchange::open_pbr::{NITS, widening};
use crate::store::exchange::report::Entry;
use crate::store::exchange::surface::Surface;

/// A kind of surface that is read.
#[derive(Debug)]
pub struct SurfaceKind {
    /// Name of its node.
    pub name: &'static str,
    /// Every input that it has, and what becomes of it.
    pub inputs: &'static [FileParameter],
    read: fn(&mut Inputs) -> Surface,
}

/// Every kind: name, inputs, how it is read.
pub static SURFACES: &[SurfaceKind] = &[
    kind("open_pbr_surface", table::OPEN_PBR, open_pbr),
    kind("standard_surface", table::STANDARD_SURFACE, standard_surface),
    kind("gltf_pbr", table::GLTF_PBR, gltf_pbr),
    kind("UsdPreviewSurface", table::USD_PREVIEW_SURFACE, usd_preview_surface),
    kind("disney_principled", table::DISNEY_PRINCIPLED, disney_principled),
    kind("surface_unlit", table::SURFACE_UNLIT, surface_unlit),
];

const fn kind(name: &'static str, inputs: &'static [FileParameter], read: fn(&mut Inputs) -> Surface) -> SurfaceKind {
    SurfaceKind { name, inputs, read }
}

impl SurfaceKind {
    /// The kind of that name.
    pub(in crate::store::exchange) fn named(name: &str) -> Option<&'static Self> {
        SURFACES.iter().find(|kind| kind.name == name)
    }

    pub(in crate::store::exchange) fn unset(&self) -> Inputs {
        Inputs::new(self.name, self.inputs)
    }

    /// The surface of these inputs, with what is lost of them.
    pub(in crate::store::exchange) fn surface(&self, mut inputs: Inputs) -> (Surface, Vec<Entry>) {
        inputs.settle();
        let surface = (self.read)(&mut inputs);
        (surface, inputs.losses)
    }
}

fn weighted(color: [f32; 3], weight: f32) -> [f32; 3] {
    color.map(|x| x * weight)
}

fn luminance(color: [f32; 3]) -> f32 {
    0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2]
}

fn open_pbr(inputs: &mut Inputs) -> Surface {
    let metalness = inputs.number("base_metalness");
    let specular_color = inputs.color("specular_color");
    let (tint, edge_tint) = if metalness > 0.5 {
        ([1.0; 3], specular_color)
    } else {
        (specular_color, [1.0; 3])
    };
    let [ratio, coat_ratio] = ["specular_roughness_anisotropy", "coat_roughness_anisotropy"]
        .map(|input| 1.0 - inputs.number(input).clamp(0.0, 0.999));
    Surface {
        base_color: weighted(inputs.color("base_color"), inputs.number("base_weight")),
        specular_in_index: inputs.number("specular_weight") != 1.0,
        specular_color: tint,
        // The weight is a metal's too, the tint is not: where both are, neither.
        specular_on_metal: tint == [1.0; 3],
        edge_tint,
        roughness: inputs.number("specular_roughness") / widening(ratio),
        anisotropy: anisotropy_from_ratio(f64::from(ratio)) as f32,
        coat_roughness: inputs.number("coat_roughness") / widening(coat_ratio),
        coat_anisotropy: anisotropy_from_ratio(f64::from(coat_ratio)) as f32,
        coat_on_base: true,
        emission_strength: 1.0,
        emission_color: weighted(
            inputs.color("emission_color"),
            inputs.number("emission_luminance") / NITS,
        ),
        opacity: luminance(inputs.color("geometry_opacity")),
        ..inputs.direct()
    }
}

fn standard_surface(inputs: &mut Inputs) -> Surface {
    let (fuzz_weight, fuzz_color, fuzz_roughness) = sheen(
        inputs,
        [Some("sheen"), Some("sheen_color"), Some("sheen_roughness")],
        false,
    );
    let [ratio, coat_ratio] =
        ["specular_anisotropy", "coat_anisotropy"].map(|input| 1.0 - inputs.number(input).clamp(0.0, 0.98));
    let base_color = weighted(inputs.color("base_color"), inputs.number("base"));
    let metalness = inputs.number("metalness");
    let (weight, color) = (inputs.number("specular"), inputs.color("specular_color"));
    // A metal has it towards its edge.
    let (specular_weight, specular_color, edge_tint) = match metalness > 0.5 {
        true => (1.0, [1.0; 3], edge_tint(base_color, weighted(color, weight))),
        false => (weight, color, [1.0; 3]),
    };
    Surface {
        base_color,
        specular_weight,
        specular_color,
        edge_tint,
        anisotropy: anisotropy_from_ratio(f64::from(ratio)) as f32,
        rotation_deg: 360.0 * inputs.number("specular_rotation"),
        coat_anisotropy: anisotropy_from_ratio(f64::from(coat_ratio)) as f32,
        fuzz_weight,
        fuzz_color,
        fuzz_roughness,
        // Every thickness but 0 is a film.
        film_weight: f32::from(inputs.number("thin_film_thickness") > 0.0),
        film_thickness: 1e-3 * inputs.number("thin_film_thickness"),
        emission_strength: 1.0,
        emission_color: weighted(inputs.color("emission_color"), inputs.number("emission")),
        opacity: luminance(inputs.color("opacity")),
        ..inputs.direct()
    }
}

/// Weight, tint and roughness of the fuzz that a sheen looks like, by its strength, colour and the root of its α.
fn sheen(
    inputs: &mut Inputs,
    [strength, color, roughness]: [Option<&str>; 3],
    is_squared: bool,
) -> (f32, [f32; 3], f32) {
    let strength = strength.map_or(1.0, |name| inputs.number(name));
    let color = color.map_or([1.0; 3], |name| inputs.color(name)).map(|x| x * strength);
    let root = roughness.map_or(0.5, |name| inputs.number(name));
    let fuzz = fuzz_of_sheen(color, if is_squared { root } else { root.max(0.0).sqrt() });
    if fuzz.0 > 0.0 {
        let detail = "fuzz of about its albedo stands for it";
        inputs.losses.push(Entry::approximated("sheen", detail, None));
    }
    fuzz
}

fn gltf_pbr(inputs: &mut Inputs) -> Surface {
    let (fuzz_weight, fuzz_color, fuzz_roughness) =
        sheen(inputs, [None, Some("sheen_color"), Some("sheen_roughness")], true);
    let distance = inputs.number("attenuation_distance");
    let inside = inputs.color("attenuation_color");
    let color = inputs.color("base_color");
    let strength = inputs.number("anisotropy_strength");
    let widths = widths_from_gltf(inputs.number("roughness"), strength);
    if !widths.is_exact {
        let detail = "the highlight is stretched no more than 19 : 1";
        inputs
            .losses
            .push(Entry::approximated("anisotropy_strength", detail, None));
    }
    Surface {
        specular_weight: inputs.number("specular"),
        specular_color: inputs.color("specular_color"),
        roughness: widths.roughness,
        anisotropy: widths.stretch,
        rotation_deg: inputs.number("anisotropy_rotation").to_degrees(),
        transmission_color: if distance > 0.0 { inside } else { color },
        fuzz_weight,
        fuzz_color,
        fuzz_roughness,
        film_thickness: 1e-3 * inputs.number("iridescence_thickness"),
        emission_strength: 1.0,
        emission_color: weighted(inputs.color("emissive"), inputs.number("emissive_strength")),
        opacity: gltf_opacity(inputs),
        ..inputs.direct()
    }
}

/// What is there of a surface by its alpha mode: 0 all of it, 1 all or nothing, 2 the share that alpha says.
fn gltf_opacity(inputs: &Inputs) -> f32 {
    let alpha = inputs.number("alpha");
    match inputs.number("alpha_mode") {
        0.0 => 1.0,
        1.0 => f32::from(alpha >= inputs.number("alpha_cutoff")),
        _ => alpha,
    }
}

fn disney_principled(inputs: &mut Inputs) -> Surface {
    // The node has a sheen of no roughness of its own.
    let (fuzz_weight, _, fuzz_roughness) = sheen(inputs, [Some("sheen"), None, None], true);
    let tint = inputs.number("sheenTint").clamp(0.0, 1.0);
    let fuzz_color = inputs.color("baseColor").map(|x| 1.0 + tint * (x - 1.0));
    let base_color = inputs.color("baseColor");
    let specular = inputs.number("specular");
    // MaterialX has the anisotropy of Standard Surface there.
    let ratio = 1.0 - inputs.number("anisotropic").clamp(0.0, 0.98);
    Surface {
        // 0.5 leaves the reflectance of the index as it is.
        specular_weight: 2.0 * specular,
        specular_in_index: specular != 0.5,
        anisotropy: anisotropy_from_ratio(f64::from(ratio)) as f32,
        transmission_color: base_color,
        coat_roughness: 1.0 - inputs.number("clearcoatGloss"),
        fuzz_weight,
        fuzz_color,
        fuzz_roughness,
        ..inputs.direct()
    }
}

fn usd_preview_surface(inputs: &mut Inputs) -> Surface {
    let ior = inputs.number("ior");
    let (opacity, threshold) = (inputs.number("opacity"), inputs.number("opacityThreshold"));
    let is_presence = inputs.number("opacityMode") > 0.0;
    // What is not stopped is refracted, unless the surface is cut out or is said to be there in part.
    let (presence, transmission_weight) = match is_presence {
        _ if threshold > 0.0 => (f32::from(opacity >= threshold), 0.0),
        true => (opacity, 0.0),
        false => (1.0, 1.0 - opacity),
    };
    let (metalness, specular_color) = match inputs.number("useSpecularWorkflow") {
        0.0 => (inputs.number("metallic"), [1.0; 3]),
        // The reflection head-on is a colour by itself: what the index has it is multiplied by.
        _ => (
            0.0,
            weighted(inputs.color("specularColor"), fresnel_f0(ior).max(1e-3).recip()),
        ),
    };
    Surface {
        metalness,
        specular_color,
        emission_strength: 1.0,
        emission_color: inputs.color("emissiveColor"),
        transmission_weight,
        opacity: presence,
        ..inputs.direct()
    }
}

fn surface_unlit(inputs: &mut Inputs) -> Surface {
    Surface {
        base_color: [0.0; 3],
        specular_weight: 0.0,
        emission_strength: 1.0,
        emission_color: weighted(inputs.color("emission_color"), inputs.number("emission")),
        ..inputs.direct()
    }
}
