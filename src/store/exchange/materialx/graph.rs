//! What inputs of a MaterialX document are worth: constants, images by their mean, and what the usual nodes compute of these.

use std::cell::Cell;
use std::path::PathBuf;

use roxmltree::Node;

use super::images::Images;
use crate::optics::tone::linear_from_srgb;
use crate::optics::vector::Vec3;

/// Deepest chain of nodes that is followed.
const DEPTH_MAX: usize = 64;
/// Most inputs that are followed for one value: nodes that each use the one before twice would be as many as 2 to their number.
const STEPS_MAX: usize = 1 << 16;
/// Weights of red, green and blue in a luminance where a node gives none: MaterialX's, of ACEScg.
const LUMINANCE: [f32; 3] = [0.2722287, 0.6740818, 0.0536895];

/// What an input is worth everywhere.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Worth {
    /// The value; one number stands in all four places.
    pub(super) value: [f32; 4],
    /// The images of whose means it is made.
    pub(super) pictures: Vec<PathBuf>,
    /// Something was computed of these means.
    pub(super) is_computed: bool,
}

impl Worth {
    fn of(value: [f32; 4]) -> Self {
        Self {
            value,
            pictures: Vec::new(),
            is_computed: false,
        }
    }

    pub(super) fn color(&self) -> [f32; 3] {
        let [r, g, b, _] = self.value;
        [r, g, b]
    }
}

/// Why the value of an input is unknown.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Unknown {
    /// A node of this kind computes it.
    Computed(String),
    /// Something is missing, or wrong.
    Missing(String),
}

impl Unknown {
    fn missing(what: &str) -> Self {
        Self::Missing(what.to_owned())
    }
}

/// The input of that name.
pub(super) fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    let is_meant = |child: &Node<'_, '_>| child.has_tag_name("input") && child.attribute("name") == Some(name);
    node.children().find(is_meant)
}

/// The element of that name beside a node.
pub(super) fn sibling<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    let is_meant = |other: &Node<'_, '_>| other.attribute("name") == Some(name);
    node.parent()?.children().find(is_meant)
}

/// The surface shaders with the materials that name them; those that no material names where there is no material.
pub(super) fn shaders<'a>(root: Node<'a, 'a>) -> Vec<(Node<'a, 'a>, Option<Node<'a, 'a>>)> {
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

/// A node, and which of its outputs is taken.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) node: Node<'a, 'a>,
    output: Option<&'a str>,
}

/// What an input or an output of a graph is connected to.
pub(super) fn source_of<'a>(place: Node<'a, 'a>) -> Option<Source<'a>> {
    let beside = if place.has_tag_name("input") {
        place.parent()?
    } else {
        place
    };
    let output = place.attribute("output");
    if let Some(name) = place.attribute("nodename") {
        let node = sibling(beside, name)?;
        return Some(Source { node, output });
    }
    let graph = sibling(beside, place.attribute("nodegraph")?)?;
    let is_meant = |node: &Node<'_, '_>| {
        node.has_tag_name("output") && output.is_none_or(|name| node.attribute("name") == Some(name))
    };
    source_of(graph.children().find(is_meant)?)
}

/// The input of the graph around a place that stands behind a name.
fn of_interface<'a>(place: Node<'a, 'a>) -> Option<Node<'a, 'a>> {
    let name = place.attribute("interfacename")?;
    let graph = place.ancestors().find(|node| node.has_tag_name("nodegraph"))?;
    child(graph, name)
}

/// What an input is worth; nothing where it has no value of its own.
pub(super) fn worth(input: Node<'_, '_>, images: &Images<'_>) -> Result<Option<Worth>, Unknown> {
    let steps = Cell::new(0);
    Graph { images, steps }.input(input, 0)
}

/// A document's nodes, followed.
struct Graph<'p> {
    images: &'p Images<'p>,
    /// How many inputs were followed.
    steps: Cell<usize>,
}

impl Graph<'_> {
    fn input(&self, input: Node<'_, '_>, depth: usize) -> Result<Option<Worth>, Unknown> {
        self.steps.update(|steps| steps + 1);
        if depth > DEPTH_MAX || self.steps.get() > STEPS_MAX {
            return Err(Unknown::Missing(format!(
                "a graph that has a circle, more than {DEPTH_MAX} nodes in a row or more than {STEPS_MAX} steps"
            )));
        }
        if let Some(value) = input.attribute("value") {
            return Ok(value_of(input, value).map(Worth::of));
        }
        if input.attribute("interfacename").is_some() {
            return of_interface(input).map_or(Ok(None), |of_graph| self.input(of_graph, depth + 1));
        }
        let is_plain = input.attribute("nodename").or(input.attribute("nodegraph")).is_none();
        match source_of(input) {
            Some(source) => self.node(source, depth + 1),
            None if is_plain => Ok(None),
            None => Err(Unknown::missing("a node that is not there")),
        }
    }

    /// An input of a node, or what stands in where it has none.
    fn or(&self, node: Node<'_, '_>, name: &str, default: f32, depth: usize) -> Result<Worth, Unknown> {
        let found = child(node, name).map_or(Ok(None), |input| self.input(input, depth + 1));
        found.map(|found| found.unwrap_or(Worth::of([default; 4])))
    }

    fn node(&self, source: Source<'_>, depth: usize) -> Result<Option<Worth>, Unknown> {
        let node = source.node;
        let kind = node.tag_name().name();
        match kind {
            "image" | "tiledimage" | "gltf_image" | "gltf_colorimage" | "UsdUVTexture" => {
                let mut found = self.picture(node)?;
                if let Some(channel) = source.output.and_then(channel_of_output) {
                    found.value = [found.value[channel]; 4];
                }
                return Ok(Some(found));
            }
            "constant" | "dot" | "convert" => {
                let name = if kind == "constant" { "value" } else { "in" };
                return child(node, name).map_or(Ok(None), |input| self.input(input, depth + 1));
            }
            _ => {}
        }
        let Some((inputs, compute)) = operation(source) else {
            return Err(Unknown::Computed(kind.to_owned()));
        };
        let mut values = Vec::new();
        let mut found = Worth::of([0.0; 4]);
        for input in inputs.split(' ') {
            let (name, default) = input.split_once('=').unwrap_or((input, "0"));
            let input = self.or(node, name, default.parse().unwrap_or_default(), depth)?;
            values.push(input.value);
            found.pictures.extend(input.pictures);
        }
        found.value = compute(&values).map(|x| if x.is_finite() { x } else { 0.0 });
        found.is_computed = !found.pictures.is_empty();
        found.pictures.dedup();
        Ok(Some(found))
    }

    /// The mean of an image.
    fn picture(&self, node: Node<'_, '_>) -> Result<Worth, Unknown> {
        let Some(input) = child(node, "file") else {
            return Err(Unknown::missing("an image without a file"));
        };
        let input = of_interface(input).unwrap_or(input);
        let name = input.attribute("value").unwrap_or_default();
        // Prefixes add up from the outside inwards.
        let prefixes: Vec<&str> = input
            .ancestors()
            .filter_map(|node| node.attribute("fileprefix"))
            .collect();
        let prefix: String = prefixes.into_iter().rev().collect();
        let file = PathBuf::from(format!("{prefix}{name}"));
        let mean = self
            .images
            .mean(&file)
            .map_err(|reason| Unknown::Missing(format!("{}: {reason}", file.display())))?;
        let is_encoded = colorspace(input).is_some_and(|space| space.starts_with("srgb"));
        let [r, g, b, a] = mean.codes;
        let [r, g, b] = if is_encoded { mean.linear } else { [r, g, b] };
        Ok(Worth {
            pictures: vec![file],
            ..Worth::of([r, g, b, a])
        })
    }
}

/// Which of a value's four numbers an output is.
fn channel_of_output(name: &str) -> Option<usize> {
    channel(name.strip_prefix("out")?.chars().next()?)
}

/// Which of a value's four numbers a letter stands for.
fn channel(letter: char) -> Option<usize> {
    "xyzw".find(letter).or("rgba".find(letter))
}

type Values<'a> = &'a [[f32; 4]];
type Compute = Box<dyn Fn(Values<'_>) -> [f32; 4]>;

/// What a node computes: the inputs that it takes, with what stands in for each where that is not 0, and how.
fn operation(source: Source<'_>) -> Option<(&'static str, Compute)> {
    let node = source.node;
    if let Some((_, inputs, compute)) = ELEMENTWISE.iter().find(|(kind, ..)| node.has_tag_name(*kind)) {
        let each = move |values: Values<'_>| {
            std::array::from_fn(|i| {
                let of_place: Vec<f32> = values.iter().map(|value| value[i]).collect();
                compute(&of_place)
            })
        };
        return Some((inputs, Box::new(each)));
    }
    let number = |name: &str| -> Option<f32> { child(node, name)?.attribute("value")?.trim().parse().ok() };
    let weights = child(node, "lumacoeffs").and_then(|input| value_of(input, input.attribute("value")?));
    let luminance = move |color: [f32; 4]| {
        let weights = weights.map_or(LUMINANCE, |[r, g, b, _]| [r, g, b]);
        (0..3).map(|i| weights[i] * color[i]).sum::<f32>()
    };
    Some(match node.tag_name().name() {
        "separate2" | "separate3" | "separate4" => {
            let channel = channel_of_output(source.output?)?;
            ("in", Box::new(move |values| [values[0][channel]; 4]))
        }
        "extract" => {
            let channel = number("index").unwrap_or(0.0).clamp(0.0, 3.0) as usize;
            ("in", Box::new(move |values| [values[0][channel]; 4]))
        }
        "swizzle" => {
            let letters = child(node, "channels")?.attribute("value")?;
            let channels: Vec<usize> = letters.chars().map(channel).collect::<Option<_>>()?;
            let last = *channels.last()?;
            let pick = move |i: usize| channels.get(i).copied().unwrap_or(last);
            (
                "in",
                Box::new(move |values| std::array::from_fn(|i| values[0][pick(i)])),
            )
        }
        "combine2" | "combine3" | "combine4" => (
            "in1 in2 in3 in4=1",
            Box::new(|values| std::array::from_fn(|i| values[i][0])),
        ),
        "luminance" => ("in", Box::new(move |values| [luminance(values[0]); 4])),
        "saturate" => (
            "in amount=1",
            Box::new(move |values| {
                let grey = luminance(values[0]);
                std::array::from_fn(|i| grey + (values[0][i] - grey) * values[1][0])
            }),
        ),
        "dotproduct" => {
            let is_in_plane = child(node, "in1")?.attribute("type") == Some("vector2");
            let places = if is_in_plane { 2 } else { 3 };
            let product = move |values: Values<'_>| (0..places).map(|i| values[0][i] * values[1][i]).sum::<f32>();
            ("in1 in2", Box::new(move |values| [product(values); 4]))
        }
        _ => return None,
    })
}

/// Kind, inputs with what stands in for each, and what is computed of each place of their values.
type Elementwise = (&'static str, &'static str, fn(&[f32]) -> f32);

const ELEMENTWISE: &[Elementwise] = &[
    ("add", "in1 in2", |x| x[0] + x[1]),
    ("subtract", "in1 in2", |x| x[0] - x[1]),
    ("multiply", "in1 in2=1", |x| x[0] * x[1]),
    ("divide", "in1 in2=1", |x| x[0] / x[1]),
    ("modulo", "in1 in2=1", |x| x[0] - x[1] * (x[0] / x[1]).floor()),
    ("min", "in1 in2", |x| x[0].min(x[1])),
    ("max", "in1 in2", |x| x[0].max(x[1])),
    ("power", "in1 in2=1", |x| x[0].powf(x[1])),
    ("safepower", "in1 in2=1", |x| x[0].abs().powf(x[1]).copysign(x[0])),
    ("invert", "in amount=1", |x| x[1] - x[0]),
    ("absval", "in", |x| x[0].abs()),
    ("sign", "in", |x| if x[0] == 0.0 { 0.0 } else { x[0].signum() }),
    ("floor", "in", |x| x[0].floor()),
    ("ceil", "in", |x| x[0].ceil()),
    ("round", "in", |x| x[0].round()),
    ("sqrt", "in", |x| x[0].sqrt()),
    ("exp", "in", |x| x[0].exp()),
    ("ln", "in=1", |x| x[0].ln()),
    ("sin", "in", |x| x[0].sin()),
    ("cos", "in", |x| x[0].cos()),
    ("clamp", "in low high=1", |x| x[0].max(x[1]).min(x[2])),
    ("mix", "bg fg mix", |x| x[0] + (x[1] - x[0]) * x[2]),
    ("smoothstep", "in low high=1", |x| {
        let t = ((x[0] - x[1]) / (x[2] - x[1])).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }),
    ("remap", "in inlow inhigh=1 outlow outhigh=1", |x| {
        x[3] + (x[0] - x[1]) * (x[4] - x[3]) / (x[2] - x[1])
    }),
    ("contrast", "in amount=1 pivot=0.5", |x| (x[0] - x[2]) * x[1] + x[2]),
];

fn colorspace<'a>(node: Node<'a, 'a>) -> Option<&'a str> {
    node.ancestors().find_map(|node| node.attribute("colorspace"))
}

/// A value as text; one number stands for all.
pub(super) fn value_of(input: Node<'_, '_>, text: &str) -> Option<[f32; 4]> {
    match text {
        "true" => return Some([1.0; 4]),
        "false" => return Some([0.0; 4]),
        _ => {}
    }
    let numbers: Option<Vec<f32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let numbers = numbers?.into_iter().map(|x| if f32::is_finite(x) { x } else { 0.0 });
    Some(match numbers.collect::<Vec<_>>()[..] {
        [x] => [x; 4],
        [x, y] => [x, y, 0.0, 1.0],
        [r, g, b, ref alpha @ ..] => {
            let is_encoded = input.attribute("type").is_some_and(|kind| kind.starts_with("color"))
                && colorspace(input).is_some_and(|space| space.starts_with("srgb"));
            let [r, g, b] = if is_encoded {
                linear_from_srgb(Vec3::<f32>::from_f32([r, g, b])).to_f32()
            } else {
                [r, g, b]
            };
            [r, g, b, alpha.first().copied().unwrap_or(1.0)]
        }
        _ => return None,
    })
}
