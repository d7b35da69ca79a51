//! Documents of MaterialX, read: the surfaces of four models with constant inputs, pictures by their mean. What a graph
//! would compute is named in the report.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use roxmltree::{Document, Node};

use super::materialx::{CARRIER, MaterialX};
use super::open_pbr::{NITS, widening};
use super::report::Entry;
use super::surface::Surface;
use super::{ExchangeError, Format as _, ReadOptions, Subject, carried};
use crate::document::MaterialSettings;
use crate::optics::lobe::anisotropy_from_ratio;
use crate::optics::tone::linear_from_srgb;
use crate::optics::vector::Vec3;
use crate::scene::texture::mean_of_file;
use crate::scene::widths_from_gltf;

/// Deepest chain of nodes that is followed.
const DEPTH_MAX: usize = 64;

/// The materials of a document.
///
/// # Errors
/// What is wrong with it.
pub(super) fn read(path: &Path, options: ReadOptions) -> Result<Subject, ExchangeError> {
    let bytes = crate::store::file::read(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let wrong = |reason: String| ExchangeError::Contents {
        path: path.to_owned(),
        format: "MaterialX",
        reason,
    };
    let document = Document::parse(&text).map_err(|error| wrong(error.to_string()))?;
    let root = document.root_element();
    if !root.has_tag_name("materialx") {
        return Err(wrong("it has no <materialx>".to_owned()));
    }
    let mut subject = Subject::default();
    let mut refused = Vec::new();
    for (shader, material) in shaders(root) {
        let folder = path.parent().unwrap_or(Path::new("."));
        match read_surface(shader, material, folder) {
            Ok((surface, losses)) => {
                let (material, losses) = exact_or_shown(&surface, losses, material, shader, options);
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

/// The surface shaders with the materials that name them; those that no material names where there is no material.
fn shaders<'a>(root: Node<'a, 'a>) -> Vec<(Node<'a, 'a>, Option<Node<'a, 'a>>)> {
    let materials = root.descendants().filter(|node| node.has_tag_name("surfacematerial"));
    let named: Vec<_> = materials
        .filter_map(|material| {
            let place = child(material, "surfaceshader")?;
            let shader = sibling(material, place.attribute("nodename")?)?;
            Some((shader, Some(material)))
        })
        .collect();
    if !named.is_empty() {
        return named;
    }
    let is_shader =
        |node: &Node<'_, '_>| node.attribute("type") == Some("surfaceshader") && !node.has_tag_name("input");
    let alone = root.children().filter(is_shader);
    alone.map(|shader| (shader, None)).collect()
}

/// The input of that name.
fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    let is_meant = |child: &Node<'_, '_>| child.has_tag_name("input") && child.attribute("name") == Some(name);
    node.children().find(is_meant)
}

/// The element of that name beside a node.
fn sibling<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.parent()?
        .children()
        .find(|other| other.attribute("name") == Some(name))
}

/// The exact parameters where the file has them and shows what they would show; else what it shows.
fn exact_or_shown(
    surface: &Surface,
    mut losses: Vec<Entry>,
    material: Option<Node<'_, '_>>,
    shader: Node<'_, '_>,
    options: ReadOptions,
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
    (surface.material(options.lobe), losses)
}

/// What a file would show into which a material is written.
fn shown_by(material: &MaterialSettings, is_standard: bool) -> Option<Surface> {
    let format = MaterialX { is_standard };
    let written = format.write(&Subject::of(material.clone()), Path::new("")).ok()?;
    let text = String::from_utf8(written.bytes).ok()?;
    let document = Document::parse(&text).ok()?;
    let (shader, material) = shaders(document.root_element()).into_iter().next()?;
    Some(read_surface(shader, material, Path::new("")).ok()?.0)
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
    folder: &Path,
) -> Result<(Surface, Vec<Entry>), String> {
    let mut inputs = Inputs {
        values: HashMap::new(),
        losses: Vec::new(),
    };
    let turn_deg = read_inputs(shader, folder, &mut inputs);
    let named = material.unwrap_or(shader);
    let name = named
        .attribute("uiname")
        .or(named.attribute("name"))
        .unwrap_or("material");
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

/// Fills in the inputs that have a value, by whatever way, and gives the turn of the tangent in degrees.
fn read_inputs(shader: Node<'_, '_>, folder: &Path, inputs: &mut Inputs) -> f32 {
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
        match constant(input, folder, 0) {
            Ok(Constant::Value(value)) => {
                inputs.values.insert(name.to_owned(), value);
            }
            Ok(Constant::Mean(value, file)) => {
                let detail = format!("the mean of {}", file.display());
                inputs.losses.push(Entry::approximated(name, detail, None));
                inputs.values.insert(name.to_owned(), value);
            }
            Ok(Constant::Nothing) => {}
            Err(reason) => inputs.losses.push(Entry::dropped(name, reason)),
        }
    }
    turn_deg
}

/// The turn of a tangent by a node `rotate3d`, degrees.
fn turned_tangent(input: Node<'_, '_>) -> Option<f32> {
    let source = source_of(input)?;
    let turn = source
        .has_tag_name("rotate3d")
        .then(|| child(source, "amount"))
        .flatten()?;
    turn.attribute("value")?.trim().parse().ok()
}

/// What an input is worth everywhere.
enum Constant {
    /// It says so.
    Value([f32; 3]),
    /// The mean of a picture.
    Mean([f32; 3], PathBuf),
    /// It has no value of its own.
    Nothing,
}

fn constant(input: Node<'_, '_>, folder: &Path, depth: usize) -> Result<Constant, String> {
    if depth > DEPTH_MAX {
        return Err("a graph that goes in a circle".to_owned());
    }
    if let Some(value) = input.attribute("value") {
        return Ok(value_of(input, value).map_or(Constant::Nothing, Constant::Value));
    }
    if let Some(name) = input.attribute("interfacename") {
        let graph = input.ancestors().find(|node| node.has_tag_name("nodegraph"));
        let of_graph = graph.and_then(|graph| child(graph, name));
        return of_graph.map_or(Ok(Constant::Nothing), |of_graph| constant(of_graph, folder, depth + 1));
    }
    let Some(source) = source_of(input) else {
        let is_plain = input.attribute("nodename").or(input.attribute("nodegraph")).is_none();
        return if is_plain {
            Ok(Constant::Nothing)
        } else {
            Err("a node that is not there".to_owned())
        };
    };
    match source.tag_name().name() {
        "image" | "tiledimage" | "gltf_image" | "gltf_colorimage" | "UsdUVTexture" => picture(source, folder),
        "constant" => child(source, "value").map_or(Ok(Constant::Nothing), |value| constant(value, folder, depth + 1)),
        "dot" | "convert" => {
            child(source, "in").map_or(Ok(Constant::Nothing), |inner| constant(inner, folder, depth + 1))
        }
        other => Err(format!("what a graph computes ({other})")),
    }
}

/// The node that an input is connected to.
fn source_of<'a>(input: Node<'a, 'a>) -> Option<Node<'a, 'a>> {
    let node = input.parent()?;
    if let Some(name) = input.attribute("nodename") {
        return sibling(node, name);
    }
    let graph = sibling(node, input.attribute("nodegraph")?)?;
    let is_meant = |output: &Node<'_, '_>| {
        output.has_tag_name("output")
            && input
                .attribute("output")
                .is_none_or(|name| output.attribute("name") == Some(name))
    };
    let name = graph.children().find(is_meant)?.attribute("nodename")?;
    graph.children().find(|node| node.attribute("name") == Some(name))
}

/// The mean of a picture.
fn picture(node: Node<'_, '_>, folder: &Path) -> Result<Constant, String> {
    let Some(input) = child(node, "file") else {
        return Err("a picture without a file".to_owned());
    };
    let of_graph = input.attribute("interfacename").and_then(|name| {
        let graph = input.ancestors().find(|node| node.has_tag_name("nodegraph"))?;
        child(graph, name)
    });
    let input = of_graph.unwrap_or(input);
    let name = input.attribute("value").unwrap_or_default();
    // Prefixes add up from the outside inwards.
    let prefixes: Vec<&str> = input
        .ancestors()
        .filter_map(|node| node.attribute("fileprefix"))
        .collect();
    let prefix: String = prefixes.into_iter().rev().collect();
    let file = PathBuf::from(format!("{prefix}{name}"));
    let mean = mean_of_file(&folder.join(&file)).map_err(|reason| format!("{}: {reason}", file.display()))?;
    let is_encoded = colorspace(input).is_some_and(|space| space.starts_with("srgb"));
    let [r, g, b, _] = mean.codes;
    Ok(Constant::Mean(if is_encoded { mean.linear } else { [r, g, b] }, file))
}

fn colorspace<'a>(node: Node<'a, 'a>) -> Option<&'a str> {
    node.ancestors().find_map(|node| node.attribute("colorspace"))
}

/// A value as text; one number stands for three.
fn value_of(input: Node<'_, '_>, text: &str) -> Option<[f32; 3]> {
    match text {
        "true" => return Some([1.0; 3]),
        "false" => return Some([0.0; 3]),
        _ => {}
    }
    let numbers: Option<Vec<f32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let numbers = numbers?.into_iter().map(|x| if f32::is_finite(x) { x } else { 0.0 });
    match numbers.collect::<Vec<_>>()[..] {
        [x] => Some([x; 3]),
        [r, g, b, ..] => {
            let is_encoded = input.attribute("type").is_some_and(|kind| kind.starts_with("color"))
                && colorspace(input).is_some_and(|space| space.starts_with("srgb"));
            Some(if is_encoded {
                linear_from_srgb(Vec3::<f32>::from_f32([r, g, b])).to_f32()
            } else {
                [r, g, b]
            })
        }
        _ => None,
    }
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
        coat_color: inputs.color("coat_color", [1.0; 3]),
        emission: weighted(
            inputs.color("emission_color", [1.0; 3]),
            inputs.number("emission_luminance", 0.0) / NITS,
        ),
        opacity: luminance(inputs.color("geometry_opacity", [1.0; 3])),
        ..Surface::default()
    }
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
    Surface {
        base_color: weighted(inputs.color("base_color", [0.8; 3]), inputs.number("base", 1.0)),
        metalness: inputs.number("metalness", 0.0),
        specular_weight: inputs.number("specular", 1.0),
        specular_color: inputs.color("specular_color", [1.0; 3]),
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
    Surface {
        base_color: inputs.color("diffuseColor", [0.18; 3]),
        metalness: inputs.number("metallic", 0.0),
        ior: inputs.number("ior", 1.5),
        roughness: inputs.number("roughness", 0.5),
        coat_weight: inputs.number("clearcoat", 0.0),
        coat_roughness: inputs.number("clearcoatRoughness", 0.01),
        emission: inputs.color("emissiveColor", [0.0; 3]),
        opacity: inputs.number("opacity", 1.0),
        ..Surface::default()
    }
}
