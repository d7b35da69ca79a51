//! Documents of MaterialX, read: the surfaces of five models with one value for each input. Pictures are taken by their mean.
//! What a graph computes is computed ([`super::graph`]) or baked ([`super::bake`]), else named in the report.

use std::collections::HashMap;
use std::path::Path;

use roxmltree::{Document, Node};

use super::artistic::edge_tint;
use super::bake::Baker;
use super::graph::{Unknown, child, shaders, source_of, worth};
use super::include::whole_text;
use super::{CARRIER, MaterialX};
use crate::document::MaterialSettings;
use crate::optics::fresnel::Fresnel;
use crate::optics::lobe::anisotropy_from_ratio;
use crate::scene::{Loading, widths_from_gltf};
use crate::store::exchange::open_pbr::{NITS, widening};
use crate::store::exchange::report::Entry;
use crate::store::exchange::surface::Surface;
use crate::store::exchange::xml;
use crate::store::exchange::{ExchangeError, Format as _, ReadOptions, Subject, carried};

/// Inputs that vary over the surface or have no meaning in one value: nothing of a graph is taken for them.
const DIRECTIONS: [&str; 6] = [
    "normal",
    "coat_normal",
    "geometry_normal",
    "geometry_coat_normal",
    "clearcoat_normal",
    "displacement",
];

/// The materials of a document.
///
/// # Errors
/// What is wrong with it.
pub(super) fn read(path: &Path, options: ReadOptions) -> Result<Subject, ExchangeError> {
    let bytes = crate::store::file::read(path)?;
    let wrong = |reason: String| ExchangeError::Contents {
        path: path.to_owned(),
        format: "MaterialX",
        reason,
    };
    let text = whole_text(path, String::from_utf8_lossy(&bytes).into_owned(), &options.loading).map_err(wrong)?;
    let document = xml::parse(&text).map_err(wrong)?;
    let root = document.root_element();
    if !root.has_tag_name("materialx") {
        return Err(wrong("it has no <materialx>".to_owned()));
    }
    let mut subject = Subject::default();
    let mut refused = Vec::new();
    let mut baker = Baker::of(path);
    for (shader, material) in shaders(root) {
        match read_surface(shader, material, (path, &options.loading), &mut baker) {
            Ok((surface, losses)) => {
                let (material, losses) = exact_or_shown(&surface, losses, material, shader, &options);
                subject.materials.push(material);
                subject.losses.push(losses);
            }
            Err(reason) => refused.push(reason),
        }
    }
    if subject.materials.is_empty() {
        let reason = match refused.is_empty() {
            true => "it has no <surfacematerial>".to_owned(),
            false => refused.join("; "),
        };
        return Err(ExchangeError::NoMaterial {
            path: path.to_owned(),
            reason,
        });
    }
    if let Some(losses) = subject.losses.first_mut() {
        losses.extend(refused.into_iter().map(|reason| Entry::dropped("a material", reason)));
    }
    Ok(subject)
}

/// The exact parameters where the file has them and shows what they would show; else what it shows.
fn exact_or_shown(
    surface: &Surface,
    mut losses: Vec<Entry>,
    material: Option<Node<'_, '_>>,
    shader: Node<'_, '_>,
    options: &ReadOptions,
) -> (MaterialSettings, Vec<Entry>) {
    let text = material.and_then(|material| material.attribute(CARRIER));
    if let Some(exact) = text.filter(|_| !options.is_plain).and_then(carried::from_text) {
        if shown_by(&exact, shader.has_tag_name("standard_surface")).is_some_and(|shown| is_near(&shown, surface)) {
            return (exact, Vec::new());
        }
        losses.push(Entry::dropped(
            "the exact parameters",
            "the file was changed since it was exported",
        ));
    }
    let mut material = surface.material(options.lobe);
    if reflects_exactly(shader) && material.metalness < 1.0 {
        material.fresnel = Fresnel::Dielectric;
    }
    (material, losses)
}

/// Whether a surface's dielectric reflects by the exact equations; the others' by Schlick's approximation.
fn reflects_exactly(shader: Node<'_, '_>) -> bool {
    let exact = ["open_pbr_surface", "standard_surface", "disney_principled"];
    exact.iter().any(|kind| shader.has_tag_name(*kind))
}

/// What a file would show into which a material is written.
fn shown_by(material: &MaterialSettings, is_standard: bool) -> Option<Surface> {
    let format = MaterialX { is_standard };
    let written = format.write(&Subject::of(material.clone()), Path::new("")).ok()?;
    let text = String::from_utf8(written.bytes).ok()?;
    let document = Document::parse(&text).ok()?;
    let (shader, material) = shaders(document.root_element()).into_iter().next()?;
    let nowhere = Path::new("");
    Some(
        read_surface(
            shader,
            material,
            (nowhere, &Loading::default()),
            &mut Baker::of(nowhere),
        )
        .ok()?
        .0,
    )
}

/// Whether two surfaces are the same but for the digits that other programs write.
fn is_near(a: &Surface, b: &Surface) -> bool {
    let numbers = |s: &Surface| {
        let mut all = vec![
            s.metalness,
            s.specular_weight,
            s.ior,
            s.roughness,
            s.anisotropy,
            s.rotation_deg,
            s.transmission_weight,
            s.transmission_depth,
            s.coat_weight,
            s.coat_roughness,
            s.coat_ior,
            s.opacity,
        ];
        let colors = [
            s.base_color,
            s.specular_color,
            s.edge_tint,
            s.transmission_color,
            s.coat_color,
            s.emission,
        ];
        all.extend(colors.into_iter().flatten());
        all
    };
    let near = |(a, b): (f32, f32)| (a - b).abs() <= 1e-4 * (1.0 + a.abs());
    numbers(a).into_iter().zip(numbers(b)).all(near)
}

/// The inputs of a shader that are written there, and what became of the others.
struct Inputs {
    values: HashMap<String, [f32; 3]>,
    losses: Vec<Entry>,
}

impl Inputs {
    fn color(&self, name: &str, default: [f32; 3]) -> [f32; 3] {
        self.values.get(name).copied().unwrap_or(default)
    }

    fn number(&self, name: &str, default: f32) -> f32 {
        self.values.get(name).map_or(default, |value| value[0])
    }

    /// Notes layers that have no place here, by the input that is `neutral` where there is none.
    fn drop_layers(&mut self, layers: &[(&str, f32)]) {
        for (name, neutral) in layers {
            if self
                .values
                .get(*name)
                .is_some_and(|value| value.iter().any(|x| x != neutral))
            {
                self.losses.push(Entry::dropped(*name, "Glossmith has none yet"));
            }
        }
    }
}

fn read_surface(
    shader: Node<'_, '_>,
    material: Option<Node<'_, '_>>,
    (path, loading): (&Path, &Loading),
    baker: &mut Baker<'_>,
) -> Result<(Surface, Vec<Entry>), String> {
    let mut inputs = Inputs {
        values: HashMap::new(),
        losses: Vec::new(),
    };
    let named = material.unwrap_or(shader);
    let own_name = named.attribute("name").unwrap_or("material");
    let turn_deg = read_inputs(shader, (path, loading), &mut inputs, &mut |input| {
        baker.mean(own_name, input)
    });
    let name = named.attribute("uiname").unwrap_or(own_name);
    let mut surface = match shader.tag_name().name() {
        "open_pbr_surface" => open_pbr(&mut inputs),
        "standard_surface" => standard_surface(&mut inputs),
        "gltf_pbr" => gltf_pbr(&mut inputs),
        "UsdPreviewSurface" => usd_preview_surface(&mut inputs),
        "disney_principled" => disney_principled(&mut inputs),
        other => return Err(format!("{name} is a {other}")),
    };
    surface.name = name.to_owned();
    surface.rotation_deg += turn_deg;
    Ok((surface, inputs.losses))
}

/// Fills in the inputs that have a value, by whatever way, and gives the turn of the tangent in degrees. `baked` is asked for
/// what is not computed here.
fn read_inputs(
    shader: Node<'_, '_>,
    (path, loading): (&Path, &Loading),
    inputs: &mut Inputs,
    baked: &mut dyn FnMut(&str) -> Result<[f32; 3], String>,
) -> f32 {
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut turn_deg = 0.0;
    for input in shader.children().filter(|node| node.has_tag_name("input")) {
        let Some(name) = input.attribute("name") else { continue };
        if name == "geometry_tangent" || name == "tangent" {
            let turned = turned_tangent(input);
            turn_deg = turned.unwrap_or_default();
            if turned.is_none() {
                inputs.losses.push(Entry::dropped(name, "what a graph computes"));
            }
            continue;
        }
        if DIRECTIONS.contains(&name) {
            if source_of(input).is_some() {
                let reason = "textures travel with models; here each parameter has one value";
                inputs.losses.push(Entry::dropped(name, reason));
            }
            continue;
        }
        match worth(input, folder, loading) {
            Ok(Some(found)) => {
                let pictures: Vec<String> = found.pictures.iter().map(|file| file.display().to_string()).collect();
                let of = if found.is_computed {
                    "computed of the mean of"
                } else {
                    "the mean of"
                };
                if !pictures.is_empty() {
                    let detail = format!("{of} {}", pictures.join(", "));
                    inputs.losses.push(Entry::approximated(name, detail, None));
                }
                inputs.values.insert(name.to_owned(), found.color());
            }
            Ok(None) => {}
            Err(Unknown::Computed(kind)) => match baked(name) {
                Ok(mean) => {
                    let detail = format!("what a graph computes ({kind}): its mean, baked by MaterialX");
                    inputs.losses.push(Entry::approximated(name, detail, None));
                    inputs.values.insert(name.to_owned(), mean);
                }
                Err(why) => {
                    let detail = format!("what a graph computes ({kind}); {why}");
                    inputs.losses.push(Entry::dropped(name, detail));
                }
            },
            Err(Unknown::Missing(what)) => inputs.losses.push(Entry::dropped(name, what)),
        }
    }
    turn_deg
}

/// The turn of a tangent by a node `rotate3d`, degrees.
fn turned_tangent(input: Node<'_, '_>) -> Option<f32> {
    let source = source_of(input)?.node;
    let turn = source
        .has_tag_name("rotate3d")
        .then(|| child(source, "amount"))
        .flatten()?;
    turn.attribute("value")?.trim().parse().ok()
}

fn weighted(color: [f32; 3], weight: f32) -> [f32; 3] {
    color.map(|x| x * weight)
}

fn luminance(color: [f32; 3]) -> f32 {
    0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2]
}

fn open_pbr(inputs: &mut Inputs) -> Surface {
    inputs.drop_layers(&[
        ("base_diffuse_roughness", 0.0),
        ("transmission_scatter", 0.0),
        ("transmission_dispersion_scale", 0.0),
        ("subsurface_weight", 0.0),
        ("fuzz_weight", 0.0),
        ("thin_film_weight", 0.0),
        ("coat_roughness_anisotropy", 0.0),
        ("geometry_thin_walled", 0.0),
    ]);
    let metalness = inputs.number("base_metalness", 0.0);
    let specular_color = inputs.color("specular_color", [1.0; 3]);
    let (tint, edge_tint) = if metalness > 0.5 {
        ([1.0; 3], specular_color)
    } else {
        (specular_color, [1.0; 3])
    };
    let ratio = 1.0 - inputs.number("specular_roughness_anisotropy", 0.0).clamp(0.0, 0.999);
    Surface {
        base_color: weighted(inputs.color("base_color", [0.8; 3]), inputs.number("base_weight", 1.0)),
        metalness,
        specular_weight: inputs.number("specular_weight", 1.0),
        specular_color: tint,
        // The weight is a metal's too, the tint is not: where both are, neither.
        specular_on_metal: tint == [1.0; 3],
        edge_tint,
        ior: inputs.number("specular_ior", 1.5),
        roughness: inputs.number("specular_roughness", 0.3) / widening(ratio),
        anisotropy: anisotropy_from_ratio(f64::from(ratio)) as f32,
        transmission_weight: inputs.number("transmission_weight", 0.0),
        transmission_color: inputs.color("transmission_color", [1.0; 3]),
        transmission_depth: inputs.number("transmission_depth", 0.0),
        coat_weight: inputs.number("coat_weight", 0.0),
        coat_roughness: inputs.number("coat_roughness", 0.0),
        coat_ior: inputs.number("coat_ior", 1.6),
        coat_color: darkening_coat_color(inputs),
        emission: weighted(
            inputs.color("emission_color", [1.0; 3]),
            inputs.number("emission_luminance", 0.0) / NITS,
        ),
        opacity: luminance(inputs.color("geometry_opacity", [1.0; 3])),
        ..Surface::default()
    }
}

/// The coat's color, with what the coat takes besides by reflecting back what comes out of the base (`coat_darkening`).
fn darkening_coat_color(inputs: &Inputs) -> [f32; 3] {
    let color = inputs.color("coat_color", [1.0; 3]);
    let weight = inputs.number("coat_weight", 0.0).clamp(0.0, 1.0);
    let darkening = inputs.number("coat_darkening", 1.0).clamp(0.0, 1.0);
    if weight * darkening == 0.0 {
        return color;
    }
    let ior = inputs.number("coat_ior", 1.6);
    let head_on = ((ior - 1.0) / (ior + 1.0)).powi(2);
    let kept_inside = 1.0 - (1.0 - head_on) / (ior * ior);
    let metalness = inputs.number("base_metalness", 0.0);
    let of_metal = 1.0 + (inputs.number("specular_weight", 1.0) - 1.0) * metalness;
    let base = weighted(inputs.color("base_color", [0.8; 3]), of_metal);
    std::array::from_fn(|i| {
        let darkened = (1.0 - kept_inside) / (1.0 - base[i] * kept_inside);
        let left = (1.0 + (color[i] - 1.0) * weight) * (1.0 + (darkened - 1.0) * weight * darkening);
        (1.0 + (left - 1.0) / weight).clamp(0.0, 1.0)
    })
}

fn standard_surface(inputs: &mut Inputs) -> Surface {
    inputs.drop_layers(&[
        ("diffuse_roughness", 0.0),
        ("transmission_scatter", 0.0),
        ("transmission_dispersion", 0.0),
        ("transmission_extra_roughness", 0.0),
        ("subsurface", 0.0),
        ("sheen", 0.0),
        ("thin_film_thickness", 0.0),
        ("thin_walled", 0.0),
        ("coat_anisotropy", 0.0),
        ("coat_affect_color", 0.0),
        ("coat_affect_roughness", 0.0),
    ]);
    let ratio = 1.0 - inputs.number("specular_anisotropy", 0.0).clamp(0.0, 0.98);
    let base_color = weighted(inputs.color("base_color", [0.8; 3]), inputs.number("base", 1.0));
    let metalness = inputs.number("metalness", 0.0);
    let (weight, color) = (inputs.number("specular", 1.0), inputs.color("specular_color", [1.0; 3]));
    // A metal has it towards its edge.
    let (specular_weight, specular_color, edge_tint) = match metalness > 0.5 {
        true => (1.0, [1.0; 3], edge_tint(base_color, weighted(color, weight))),
        false => (weight, color, [1.0; 3]),
    };
    Surface {
        base_color,
        metalness,
        specular_weight,
        specular_color,
        edge_tint,
        ior: inputs.number("specular_IOR", 1.5),
        roughness: inputs.number("specular_roughness", 0.2),
        anisotropy: anisotropy_from_ratio(f64::from(ratio)) as f32,
        rotation_deg: 360.0 * inputs.number("specular_rotation", 0.0),
        transmission_weight: inputs.number("transmission", 0.0),
        transmission_color: inputs.color("transmission_color", [1.0; 3]),
        transmission_depth: inputs.number("transmission_depth", 0.0),
        coat_weight: inputs.number("coat", 0.0),
        coat_roughness: inputs.number("coat_roughness", 0.1),
        coat_ior: inputs.number("coat_IOR", 1.5),
        coat_color: inputs.color("coat_color", [1.0; 3]),
        emission: weighted(inputs.color("emission_color", [1.0; 3]), inputs.number("emission", 0.0)),
        opacity: luminance(inputs.color("opacity", [1.0; 3])),
        ..Surface::default()
    }
}

fn gltf_pbr(inputs: &mut Inputs) -> Surface {
    inputs.drop_layers(&[("iridescence", 0.0), ("sheen_color", 0.0), ("dispersion", 0.0)]);
    let distance = inputs.number("attenuation_distance", 0.0);
    let inside = inputs.color("attenuation_color", [1.0; 3]);
    let color = inputs.color("base_color", [1.0; 3]);
    let strength = inputs.number("anisotropy_strength", 0.0);
    let widths = widths_from_gltf(inputs.number("roughness", 1.0), strength);
    if !widths.is_exact {
        let detail = "the highlight is stretched no more than 19 : 1";
        inputs
            .losses
            .push(Entry::approximated("anisotropy_strength", detail, None));
    }
    Surface {
        base_color: color,
        metalness: inputs.number("metallic", 1.0),
        specular_weight: inputs.number("specular", 1.0),
        specular_color: inputs.color("specular_color", [1.0; 3]),
        ior: inputs.number("ior", 1.5),
        roughness: widths.roughness,
        anisotropy: widths.stretch,
        rotation_deg: inputs.number("anisotropy_rotation", 0.0).to_degrees(),
        transmission_weight: inputs.number("transmission", 0.0),
        transmission_color: if distance > 0.0 { inside } else { color },
        transmission_depth: distance,
        coat_weight: inputs.number("clearcoat", 0.0),
        coat_roughness: inputs.number("clearcoat_roughness", 0.0),
        emission: weighted(
            inputs.color("emissive", [0.0; 3]),
            inputs.number("emissive_strength", 1.0),
        ),
        opacity: inputs.number("alpha", 1.0),
        ..Surface::default()
    }
}

fn disney_principled(inputs: &mut Inputs) -> Surface {
    inputs.drop_layers(&[("sheen", 0.0), ("subsurface", 0.0), ("specularTint", 0.0)]);
    let base_color = inputs.color("baseColor", [0.16; 3]);
    let specular = inputs.number("specular", 0.5);
    if specular > 0.5 {
        let detail = "no more is reflected than the index has it";
        inputs.losses.push(Entry::approximated("specular", detail, None));
    }
    // MaterialX has the anisotropy of Standard Surface there.
    let ratio = 1.0 - inputs.number("anisotropic", 0.0).clamp(0.0, 0.98);
    Surface {
        base_color,
        metalness: inputs.number("metallic", 0.0),
        // 0.5 leaves the reflectance of the index as it is.
        specular_weight: 2.0 * specular,
        ior: inputs.number("ior", 1.5),
        roughness: inputs.number("roughness", 0.5),
        anisotropy: anisotropy_from_ratio(f64::from(ratio)) as f32,
        transmission_weight: inputs.number("specTrans", 0.0),
        transmission_color: base_color,
        coat_weight: inputs.number("clearcoat", 0.0),
        coat_roughness: 1.0 - inputs.number("clearcoatGloss", 1.0),
        ..Surface::default()
    }
}

fn usd_preview_surface(inputs: &mut Inputs) -> Surface {
    inputs.drop_layers(&[("useSpecularWorkflow", 0.0), ("displacement", 0.0)]);
    let (opacity, threshold) = (inputs.number("opacity", 1.0), inputs.number("opacityThreshold", 0.0));
    let is_presence = inputs.number("opacityMode", 0.0) > 0.0;
    // What is not stopped is refracted, unless the surface is cut out or is said to be there in part.
    let (presence, transmission_weight) = match is_presence {
        _ if threshold > 0.0 => (f32::from(opacity >= threshold), 0.0),
        true => (opacity, 0.0),
        false => (1.0, 1.0 - opacity),
    };
    Surface {
        base_color: inputs.color("diffuseColor", [0.18; 3]),
        metalness: inputs.number("metallic", 0.0),
        ior: inputs.number("ior", 1.5),
        roughness: inputs.number("roughness", 0.5),
        coat_weight: inputs.number("clearcoat", 0.0),
        coat_roughness: inputs.number("clearcoatRoughness", 0.01),
        emission: inputs.color("emissiveColor", [0.0; 3]),
        transmission_weight,
        opacity: presence,
        ..Surface::default()
    }
}
