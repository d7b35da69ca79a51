//! What inputs of a MaterialX document are worth: constants, images by their mean, and what the usual nodes compute of these.

use std::{cell::Cell, collections::HashSet, path::PathBuf};

use glam::{DAffine2, DVec2};
use roxmltree::Node;

use super::{images::Images, spaces::Space, surfaces::SurfaceKind};
use crate::{
    scene::texture::{TextureChannel, TextureProjection, TextureSpace, UserTexture},
    store::exchange::textures::place,
};

/// Deepest chain of nodes that is followed.
const DEPTH_MAX: usize = 64;
/// Most inputs that are followed for one value: nodes that each use the one before twice would be as many as 2 to their number.
const STEPS_MAX: usize = 1 << 16;
/// Weights of red, green and blue in a luminance where a node gives none: MaterialX's, of ACEScg.
const LUMINANCE: [f32; 3] = [0.2722287, 0.6740818, 0.0536895];

/// What an input is worth everywhere.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Worth {
    /// The value; one number stands in all four places.
    pub value: [f32; 4],
    /// The images of whose means it is made.
    pub pictures: Vec<PathBuf>,
    /// Something was computed of these means.
    pub is_computed: bool,
    /// The image that it is, where it is one, what that is multiplied by and what is added then.
    texture: Option<UserTexture>,
    factor: [f32; 4],
    bias: [f32; 4],
    /// The unit that it is written in.
    pub unit: Option<String>,
    /// What of it was not understood.
    pub notes: Vec<String>,
}

impl Worth {
    fn of(value: [f32; 4]) -> Self {
        Self {
            value,
            factor: [1.0; 4],
            ..Self::default()
        }
    }

    pub fn color(&self) -> [f32; 3] {
        let [r, g, b, _] = self.value;
        [r, g, b]
    }

    /// What is computed of values: of one image that is multiplied and added to, that image.
    fn take_affine(&mut self, of: &[Self], compute: &Compute) {
        let mut images = (0..of.len()).filter(|&place| !of[place].pictures.is_empty());
        let (Some(place), None) = (images.next(), images.next()) else {
            return;
        };
        let at = |x: f32| {
            let mut values: Vec<[f32; 4]> = of.iter().map(|one| one.value).collect();
            values[place] = std::array::from_fn(|i| of[place].factor[i] * x + of[place].bias[i]);
            compute(&values)
        };
        let [zero, quarter, half, one] = [0.0, 0.25, 0.5, 1.0].map(at);
        let is_between = |found: f32, i: usize, x: f32| (found - zero[i] - x * (one[i] - zero[i])).abs() < 1e-5;
        if (0..4).all(|i| is_between(quarter[i], i, 0.25) && is_between(half[i], i, 0.5)) {
            self.texture.clone_from(&of[place].texture);
            (self.factor, self.bias) = (std::array::from_fn(|i| one[i] - zero[i]), zero);
            self.is_computed = of[place].is_computed;
        }
    }

    /// The texture that it is, and what that multiplies; none where more is added than its strength says.
    pub fn as_texture(&self) -> Option<(UserTexture, [f32; 3])> {
        let (texture, [scale, bias]) = (self.texture.clone()?, [self.factor, self.bias]);
        let inverted = (0..3).any(|i| scale[i] < 0.0);
        let factor = [0, 1, 2].map(|i| if inverted { bias[i] } else { scale[i] + bias[i] });
        let varied = (0..3).find(|&i| scale[i] != 0.0);
        let strength = varied.map_or(1.0, |i| scale[i].abs() / factor[i]);
        let is_it = |i: usize| (scale[i].abs() - strength * factor[i]).abs() <= 1e-5 * (1.0 + factor[i].abs());
        let is_whole = (strength - 1.0).abs() < 1e-5;
        let texture = UserTexture {
            inverted,
            strength: if is_whole { 1.0 } else { strength },
            ..texture
        };
        (strength < 1.0 + 1e-5 && (0..3).all(is_it)).then_some((texture, factor))
    }

    /// The texture of normals that it is, and how steep; `is_packed` where they lie in [0, 1].
    pub fn as_normals(&self, is_packed: bool) -> Option<(UserTexture, f32)> {
        let (texture, [mut scale, mut bias]) = (self.texture.clone()?, [self.factor, self.bias]);
        if is_packed || bias == [0.0; 4] {
            (scale, bias) = (scale.map(|x| 2.0 * x), bias.map(|x| 2.0 * x - 1.0));
        }
        let inverted = scale[1] < 0.0;
        let slopes = [scale[0], if inverted { -scale[0] } else { scale[0] }, 2.0];
        let is_it = |i: usize| (scale[i] - slopes[i]).abs() < 1e-5 && (bias[i] + 0.5 * slopes[i]).abs() < 1e-5;
        let texture = UserTexture { inverted, ..texture };
        (0..3).all(is_it).then_some((texture, 0.5 * scale[0]))
    }

    /// These channels of it; one stands for all.
    fn picked(mut self, channels: &[usize]) -> Self {
        let pick = |[r, g, b, a]: [f32; 4]| {
            let of_place = |i| [r, g, b, a, 0.0, 1.0][*channels.get(i).unwrap_or(&channels[channels.len() - 1])];
            std::array::from_fn(of_place)
        };
        (self.value, self.factor, self.bias) = (pick(self.value), pick(self.factor), pick(self.bias));
        self.texture = self.texture.and_then(|texture| match (channels, texture.channel) {
            (&[channel @ 0..4], TextureChannel::Auto) => Some(UserTexture {
                channel: TextureChannel::ALL[channel + 1],
                ..texture
            }),
            ([0, 1, 2, ..], _) => Some(texture),
            _ => None,
        });
        self
    }
}

/// Why the value of an input is unknown.
#[derive(Clone, Debug, PartialEq)]
pub enum Unknown {
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
pub fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    let is_meant = |child: &Node<'_, '_>| child.has_tag_name("input") && child.attribute("name") == Some(name);
    node.children().find(is_meant)
}

/// The element of that name beside a node.
fn sibling<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    let is_meant = |other: &Node<'_, '_>| other.attribute("name") == Some(name);
    node.parent()?.children().find(is_meant)
}

/// Nodes of the document's own kinds that are looked into, the outermost first: what their graphs are given.
type Within<'n, 'a> = &'n [Node<'a, 'a>];

/// The definition and the graph of a node whose kind the document itself defines.
fn definition<'a>(node: Node<'a, 'a>) -> Option<(Node<'a, 'a>, Node<'a, 'a>)> {
    let elements = || node.document().root_element().children();
    let kind = node.tag_name().name();
    let named = node.attribute("nodedef");
    let is_meant = |other: &Node<'_, '_>| {
        let is_it = named.is_none_or(|name| other.attribute("name") == Some(name));
        other.has_tag_name("nodedef") && other.attribute("node") == Some(kind) && is_it
    };
    elements().filter(is_meant).find_map(|nodedef| {
        let name = nodedef.attribute("name")?;
        let implements = |other: &Node<'_, '_>| other.attribute("nodedef") == Some(name);
        let mut graphs = elements()
            .filter(implements)
            .filter_map(|found| match found.tag_name().name() {
                "nodegraph" => Some(found),
                "implementation" => sibling(found, found.attribute("nodegraph")?),
                _ => None,
            });
        Some((nodedef, graphs.next()?))
    })
}

/// A material's surface, and where it is.
pub struct Shader<'a> {
    pub node: Node<'a, 'a>,
    /// The material as the document has it; none where the surface stands alone.
    pub material: Option<Node<'a, 'a>>,
    /// The `surfacematerial` that names the surface.
    pub maker: Option<Node<'a, 'a>>,
    pub within: Vec<Node<'a, 'a>>,
}

impl<'a> Shader<'a> {
    /// The surface of a material or of a surface, looked for in the document's own kinds.
    fn behind(start: Node<'a, 'a>) -> Option<Self> {
        let (mut node, mut output, mut maker, mut within) = (start, None, None, Vec::new());
        for _ in 0..DEPTH_MAX {
            let next = if node.has_tag_name("surfacematerial") {
                maker = Some(node);
                let mut place = child(node, "surfaceshader")?;
                while let Some((outer, around)) = of_interface(place, &within) {
                    within.truncate(around);
                    place = outer;
                }
                source_of(place)?
            } else if node.has_tag_name("output") {
                source_of(node)?
            } else if SurfaceKind::named(node.tag_name().name()).is_some() {
                break;
            } else if let Some((_, graph)) = definition(node) {
                within.push(node);
                source_of(output_of(graph, output)?)?
            } else {
                break;
            };
            (node, output) = (next.node, next.output);
        }
        let material = (start.attribute("type") != Some("surfaceshader")).then_some(start);
        Some(Self {
            node,
            material,
            maker,
            within,
        })
    }
}

/// The surfaces of the materials; those that no material names where there is no material.
pub fn shaders<'a>(root: Node<'a, 'a>) -> Vec<Shader<'a>> {
    let is_defining = |outer: Node<'_, '_>| outer.has_tag_name("nodegraph") && outer.has_attribute("nodedef");
    let is_material = |node: &Node<'a, 'a>| {
        let is_own = node.attribute("type") == Some("material") && definition(*node).is_some();
        is_own || node.has_tag_name("surfacematerial") && !node.ancestors().any(is_defining)
    };
    let named: Vec<_> = root
        .descendants()
        .filter(is_material)
        .filter_map(Shader::behind)
        .collect();
    if !named.is_empty() {
        return named;
    }
    let is_shader = |node: &Node<'_, '_>| {
        let is_graph = ["input", "nodegraph"].iter().any(|kind| node.has_tag_name(*kind));
        node.attribute("type") == Some("surfaceshader") && !is_graph
    };
    let mut known = HashSet::new();
    let alone = root.children().filter(is_shader).filter_map(Shader::behind);
    alone.filter(|shader| known.insert(shader.node.id())).collect()
}

/// A node, and which of its outputs is taken, and which channels of that.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    pub node: Node<'a, 'a>,
    output: Option<&'a str>,
    channels: Option<&'a str>,
}

/// The output of that name of a graph; its first without a name.
fn output_of<'a>(graph: Node<'a, 'a>, name: Option<&str>) -> Option<Node<'a, 'a>> {
    let is_meant = |node: &Node<'_, '_>| {
        node.has_tag_name("output") && name.is_none_or(|name| node.attribute("name") == Some(name))
    };
    graph.children().find(is_meant)
}

/// What an input or an output of a graph is connected to. A graph goes before a node.
pub fn source_of<'a>(place: Node<'a, 'a>) -> Option<Source<'a>> {
    let beside = if place.has_tag_name("input") {
        place.parent()?
    } else {
        place
    };
    let output = place.attribute("output");
    let node = sibling(beside, place.attribute("nodegraph").or(place.attribute("nodename"))?)?;
    if !node.has_tag_name("nodegraph") {
        let channels = None;
        return Some(Source { node, output, channels });
    }
    let inner = output_of(node, output)?;
    Some(Source {
        channels: inner.attribute("channels"),
        ..source_of(inner)?
    })
}

/// The input behind the name that a place has for it, and how many of `within` that is still in: of the graph around it, of the node whose
/// kind the graph defines, of that kind's definition, or of the document.
fn of_interface<'a>(place: Node<'a, 'a>, within: Within<'_, 'a>) -> Option<(Node<'a, 'a>, usize)> {
    let name = place.attribute("interfacename")?;
    let root = place.document().root_element();
    let graph = place.ancestors().find(|node| node.has_tag_name("nodegraph"));
    if let Some(own) = graph.and_then(|graph| child(graph, name)) {
        return Some((own, within.len()));
    }
    let given = within.split_last().and_then(|(node, outer)| {
        let is_set = |input: &Node<'_, '_>| {
            input
                .attributes()
                .any(|attribute| OF_VALUES.contains(&attribute.name()))
        };
        Some((child(*node, name).filter(is_set)?, outer.len()))
    });
    let of_definition = || {
        let named = graph?.attribute("nodedef");
        let nodedef = match within.last() {
            Some(node) => definition(*node)?.0,
            None => root
                .children()
                .find(|node| node.has_tag_name("nodedef") && node.attribute("name") == named)?,
        };
        child(nodedef, name)
    };
    given.or_else(|| Some((of_definition().or_else(|| child(root, name))?, 0)))
}

/// The attributes by which an input has a value, or is connected.
const OF_VALUES: [&str; 4] = ["nodegraph", "nodename", "interfacename", "value"];

/// What an input is worth; nothing where it has no value of its own.
pub fn worth<'a>(input: Node<'a, 'a>, within: Within<'_, 'a>, images: &Images<'_>) -> Result<Option<Worth>, Unknown> {
    let steps = Cell::new(0);
    Graph { images, steps }.input(input, within, 0)
}

/// A document's nodes, followed.
struct Graph<'p> {
    images: &'p Images<'p>,
    /// How many inputs were followed.
    steps: Cell<usize>,
}

impl Graph<'_> {
    fn step(&self, depth: usize) -> Result<(), Unknown> {
        self.steps.update(|steps| steps + 1);
        if depth > DEPTH_MAX || self.steps.get() > STEPS_MAX {
            return Err(Unknown::Missing(format!(
                "a graph that has a circle, more than {DEPTH_MAX} nodes in a row or more than {STEPS_MAX} steps"
            )));
        }
        Ok(())
    }

    /// What an input is connected to goes before its own value.
    fn input<'a>(&self, input: Node<'a, 'a>, within: Within<'_, 'a>, depth: usize) -> Result<Option<Worth>, Unknown> {
        self.step(depth)?;
        let mut found = if input.has_attribute("nodegraph") || input.has_attribute("nodename") {
            let source = source_of(input).ok_or(Unknown::missing("a node that is not there"))?;
            self.node(source, within, depth + 1)?
        } else if let Some((outer, around)) = of_interface(input, within) {
            self.input(outer, &within[..around], depth + 1)?
        } else {
            return match input.attribute("value").map(str::trim) {
                None | Some("") if input.has_attribute("interfacename") => {
                    Err(Unknown::missing("an interfacename that no input has"))
                }
                None | Some("") => Ok(None),
                Some(text) => value_of(input, text).map(Some),
            };
        };
        if let Some(letters) = input.attribute("channels") {
            let channels = channels(letters)?;
            found = found.map(|found| found.picked(&channels));
        }
        Ok(found)
    }

    /// An input of a node, or what stands in where it has none.
    fn or<'a>(
        &self,
        (node, within): (Node<'a, 'a>, Within<'_, 'a>),
        name: &str,
        default: f32,
        depth: usize,
    ) -> Result<Worth, Unknown> {
        let found = child(node, name).map_or(Ok(None), |input| self.input(input, within, depth + 1));
        found.map(|found| found.unwrap_or(Worth::of([default; 4])))
    }

    fn node<'a>(&self, source: Source<'a>, within: Within<'_, 'a>, depth: usize) -> Result<Option<Worth>, Unknown> {
        self.step(depth)?;
        let Source { node, output, .. } = source;
        let kind = node.tag_name().name();
        let input = |name: &str, default: f32| self.or((node, within), name, default, depth);
        let number = |name: &str, default: f32| input(name, default).map(|found| found.value[0]);
        let given = |name: &str| child(node, name).map_or(Ok(None), |input| self.input(input, within, depth + 1));
        let found = match kind {
            "image" | "tiledimage" | "gltf_image" | "gltf_colorimage" | "UsdUVTexture" => {
                let found = self.picture(node, within, depth)?;
                Some(match output.and_then(channel_of_output) {
                    Some(channel) => found.picked(&[channel]),
                    None => found,
                })
            }
            "constant" => given("value")?,
            "dot" | "convert" => given("in")?,
            "ifgreater" | "ifgreatereq" | "ifequal" => {
                let (a, b) = (number("value1", 1.0)?, number("value2", 0.0)?);
                let is_so = match kind {
                    "ifgreater" => a > b,
                    "ifgreatereq" => a >= b,
                    _ => a == b,
                };
                Some(input(if is_so { "in1" } else { "in2" }, 0.0)?)
            }
            "switch" => Some(input(
                &format!("in{}", number("which", 0.0)?.max(0.0).floor() + 1.0),
                0.0,
            )?),
            "swizzle" => {
                let letters = child(node, "channels").and_then(|input| input.attribute("value"));
                Some(input("in", 0.0)?.picked(&channels(letters.unwrap_or_default())?))
            }
            "extract" => Some(input("in", 0.0)?.picked(&[number("index", 0.0)?.clamp(0.0, 3.0) as usize])),
            "separate2" | "separate3" | "separate4" => {
                let channel = output.and_then(channel_of_output);
                Some(input("in", 0.0)?.picked(&[channel.ok_or(Unknown::missing("an output that its node has not"))?]))
            }
            _ => match operation(node) {
                Some((inputs, compute)) => {
                    let of_input = |named: &str| {
                        let (name, default) = named.split_once('=').unwrap_or((named, "0"));
                        input(name, default.parse().unwrap_or_default())
                    };
                    let all: Vec<Worth> = inputs.split(' ').map(of_input).collect::<Result<_, _>>()?;
                    let values: Vec<[f32; 4]> = all.iter().map(|one| one.value).collect();
                    let mut found = Worth::of(compute(&values).map(|x| if x.is_finite() { x } else { 0.0 }));
                    for one in &all {
                        found.pictures.extend_from_slice(&one.pictures);
                        found.notes.extend_from_slice(&one.notes);
                        found.unit = found.unit.or_else(|| one.unit.clone());
                    }
                    found.pictures.dedup();
                    found.is_computed = !found.pictures.is_empty();
                    if ELEMENTWISE.iter().any(|(other, ..)| *other == kind) {
                        found.take_affine(&all, &compute);
                    }
                    Some(found)
                }
                None => {
                    let computed = || Unknown::Computed(kind.to_owned());
                    let (_, graph) = definition(node).ok_or_else(computed)?;
                    let inner = output_of(graph, output).and_then(source_of).ok_or_else(computed)?;
                    self.node(inner, &[within, &[node]].concat(), depth + 1)?
                }
            },
        };
        match (found, source.channels) {
            (Some(found), Some(letters)) => Ok(Some(found.picked(&channels(letters)?))),
            (found, _) => Ok(found),
        }
    }

    /// The mean of an image; what the node says stands in where there is none.
    fn picture<'a>(&self, node: Node<'a, 'a>, within: Within<'_, 'a>, depth: usize) -> Result<Worth, Unknown> {
        let mut input = child(node, "file").ok_or(Unknown::missing("an image without a file"))?;
        let mut around = within;
        for _ in 0..DEPTH_MAX {
            let Some((outer, fewer)) = of_interface(input, around) else {
                break;
            };
            (input, around) = (outer, &around[..fewer]);
        }
        let name = input.attribute("value").unwrap_or_default();
        // Prefixes add up from the outside inwards.
        let prefixes: Vec<&str> = input
            .ancestors()
            .filter_map(|node| node.attribute("fileprefix"))
            .collect();
        let prefix: String = prefixes.into_iter().rev().collect();
        let file = PathBuf::from(format!("{prefix}{name}"));
        let read = match self.images.mean(&file) {
            Ok(read) => read,
            Err(reason) => {
                let reason = format!("{}: {reason}", file.display());
                for stand_in in ["default", "fallback"].into_iter().filter_map(|name| child(node, name)) {
                    if let Some(mut found) = self.input(stand_in, within, depth + 1)? {
                        found.notes.push(format!(
                            "{reason}; the image's {} stands in",
                            stand_in.attribute("name").unwrap_or_default()
                        ));
                        return Ok(found);
                    }
                }
                return Err(Unknown::Missing(reason));
            }
        };
        let is_of_color = !node
            .attribute("type")
            .is_some_and(|kind| kind.starts_with("float") || kind.starts_with("vector"));
        let of_usd = child(node, "sourceColorSpace").and_then(|input| input.attribute("value"));
        let (space, mut notes) = match of_usd {
            Some("auto") => space_of(if read.is_of_screen { "sRGB" } else { "raw" }),
            Some(name) => space_of(name),
            None if is_of_color => space_of(colorspace(input)),
            None => space_of("none"),
        };
        let [r, g, b] = space.rec709_of_mean(&read.mean);
        let mut found = Worth::of([r, g, b, read.mean.codes[3]]);
        found.texture = space.is_srgb().map(|is_srgb| UserTexture {
            space: if is_srgb {
                TextureSpace::Srgb
            } else {
                TextureSpace::Linear
            },
            ..UserTexture::of(self.images.path(&file))
        });
        if node.has_tag_name("UsdUVTexture") {
            let [scale, bias] =
                [("scale", 1.0), ("bias", 0.0)].map(|(name, default)| self.or((node, within), name, default, depth));
            let (scale, bias) = (scale?.value, bias?.value);
            found.value = std::array::from_fn(|i| found.value[i] * scale[i] + bias[i]);
            (found.factor, found.bias) = (scale, bias);
        }
        found.notes.append(&mut notes);
        if read.is_even {
            // It is that colour everywhere.
            (found.texture, found.is_computed) = (None, false);
            return Ok(found);
        }
        found.pictures.push(file);
        if let Some(mut texture) = found.texture.take() {
            found.notes.extend(node.children().filter_map(of_place));
            let (mapping, is_read) = self.mapping(node, &mut texture, within, depth)?;
            if !is_read {
                found.notes.push("the image's coordinates are not read".to_owned());
            }
            found.texture = place(&mut texture, mapping).then_some(texture);
        }
        Ok(found)
    }

    /// What is done to the texture coordinates of an image, v pointing upwards, and whether all of it is known; their set goes into the
    /// texture.
    fn mapping<'a>(
        &self,
        image: Node<'a, 'a>,
        texture: &mut UserTexture,
        within: Within<'_, 'a>,
        depth: usize,
    ) -> Result<(DAffine2, bool), Unknown> {
        let pair = |node: Node<'a, 'a>, name: &str, default: f32| {
            let found = self.or((node, within), name, default, depth)?.value;
            Ok(DVec2::new(found[0].into(), found[1].into()))
        };
        let moved = DAffine2::from_translation;
        let tiling = DAffine2::from_scale(pair(image, "uvtiling", 1.0)?);
        let mut mapping = moved(-pair(image, "uvoffset", 0.0)?) * tiling;
        let mut place = ["texcoord", "st"].into_iter().find_map(|name| child(image, name));
        for _ in 0..DEPTH_MAX {
            let Some(Source { node, .. }) = place.and_then(source_of) else {
                return Ok((mapping, true));
            };
            let text = |name: &str| child(node, name)?.attribute("value");
            place = match node.tag_name().name() {
                "UsdTransform2d" => {
                    let angle = pair(node, "rotation", 0.0)?.x.to_radians();
                    let turned = DAffine2::from_scale_angle_translation(
                        pair(node, "scale", 1.0)?,
                        angle,
                        pair(node, "translation", 0.0)?,
                    );
                    mapping *= turned;
                    child(node, "in")
                }
                "place2d" => {
                    let turn = DAffine2::from_angle(-pair(node, "rotate", 0.0)?.x.to_radians());
                    let scale = DAffine2::from_scale(pair(node, "scale", 1.0)?.recip());
                    let offset = moved(-pair(node, "offset", 0.0)?);
                    let pivot = pair(node, "pivot", 0.0)?;
                    let placed = match text("operationorder") {
                        Some("1") => scale * turn * offset,
                        _ => offset * turn * scale,
                    };
                    mapping *= moved(pivot) * placed * moved(-pivot);
                    child(node, "texcoord")
                }
                "texcoord" | "geompropvalue" | "UsdPrimvarReader" => {
                    if text("index") == Some("1") || text("varname") == Some("st1") {
                        texture.projection = TextureProjection::Second;
                    }
                    return Ok((mapping, true));
                }
                _ => return Ok((mapping, false)),
            };
        }
        Ok((mapping, false))
    }
}

/// What is said of an image's input that places it, where that is not read.
fn of_place(input: Node<'_, '_>) -> Option<String> {
    let name = input.attribute("name").filter(|_| input.has_tag_name("input"))?;
    let value = input.attribute("value").unwrap_or_default().trim();
    let is_read = match name {
        "uaddressmode" | "vaddressmode" | "wrapS" | "wrapT" => {
            matches!(value, "" | "periodic" | "repeat" | "useMetadata" | "black")
        }
        "scale" | "bias" | "fallback" | "sourceColorSpace" => input.parent()?.has_tag_name("UsdUVTexture"),
        "file" | "default" | "texcoord" | "st" | "uvtiling" | "uvoffset" | "filtertype" | "layer" => true,
        _ => false,
    };
    (!is_read).then(|| format!("the image's {name} is not read"))
}

/// Which of a value's four numbers an output is.
fn channel_of_output(name: &str) -> Option<usize> {
    let name = name.strip_prefix("out").unwrap_or(name);
    let letter = name.chars().next().filter(|_| !matches!(name, "rgb" | "rgba"))?;
    channel(letter).filter(|channel| *channel < 4)
}

/// Which of a value's four numbers a letter stands for, or 0 or 1 after them.
fn channel(letter: char) -> Option<usize> {
    "rgba01".find(letter).or("xyzw".find(letter))
}

fn channels(letters: &str) -> Result<Vec<usize>, Unknown> {
    let channels: Option<Vec<usize>> = letters.trim().chars().map(channel).collect();
    let found = channels.filter(|channels| !channels.is_empty());
    found.ok_or_else(|| Unknown::Missing(format!("channels {letters:?}, which no value has")))
}

type Values<'a> = &'a [[f32; 4]];
type Compute = Box<dyn Fn(Values<'_>) -> [f32; 4]>;

/// What a node computes: the inputs that it takes, with what stands in for each where that is not 0, and how.
fn operation(node: Node<'_, '_>) -> Option<(&'static str, Compute)> {
    if let Some((_, inputs, compute)) = ELEMENTWISE.iter().find(|(kind, ..)| node.has_tag_name(*kind)) {
        let each = move |values: Values<'_>| {
            std::array::from_fn(|i| {
                let of_place: Vec<f32> = values.iter().map(|value| value[i]).collect();
                compute(&of_place)
            })
        };
        return Some((inputs, Box::new(each)));
    }
    let weights = child(node, "lumacoeffs").and_then(|input| value_of(input, input.attribute("value")?).ok());
    let luminance = move |color: [f32; 4]| {
        let weights = weights.as_ref().map_or(LUMINANCE, Worth::color);
        (0..3).map(|i| weights[i] * color[i]).sum::<f32>()
    };
    Some(match node.tag_name().name() {
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
    ("tan", "in", |x| x[0].tan()),
    ("fract", "in", |x| x[0] - x[0].floor()),
    ("plus", "bg fg mix=1", |x| x[0] + x[1] * x[2]),
    ("minus", "bg fg mix=1", |x| x[0] - x[1] * x[2]),
    ("difference", "bg fg mix=1", |x| {
        x[0] + ((x[0] - x[1]).abs() - x[0]) * x[2]
    }),
    ("screen", "bg fg mix=1", |x| x[0] + x[1] * (1.0 - x[0]) * x[2]),
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

fn colorspace<'a>(node: Node<'a, 'a>) -> &'a str {
    let named = node.ancestors().find_map(|node| node.attribute("colorspace"));
    named.unwrap_or_default()
}

/// The space of that name, and what is said where it is not known.
fn space_of(name: &str) -> (Space, Vec<String>) {
    let note = || format!("the colour space {name} is not known; the numbers are taken as linear Rec. 709");
    Space::named(name).map_or_else(|| (Space::working(), vec![note()]), |space| (space, Vec::new()))
}

/// A value as text; one number stands for all.
fn value_of(input: Node<'_, '_>, text: &str) -> Result<Worth, Unknown> {
    let number = |text: &str| match text.trim() {
        "true" | "presence" => Some(1.0),
        "false" | "transparent" => Some(0.0),
        text => text.parse().ok().map(|x: f32| if x.is_finite() { x } else { 0.0 }),
    };
    let wrong = || Unknown::Missing(format!("{text} is no number"));
    let numbers: Vec<f32> = text.split(',').map(number).collect::<Option<_>>().ok_or_else(wrong)?;
    let mut found = Worth::of(match numbers[..] {
        [x] => [x; 4],
        [x, y] => [x, y, 0.0, 1.0],
        [r, g, b, ref alpha @ ..] => [r, g, b, alpha.first().copied().unwrap_or(1.0)],
        [] => return Err(wrong()),
    });
    if input.attribute("type").is_some_and(|kind| kind.starts_with("color")) {
        let (space, notes) = space_of(colorspace(input));
        let [r, g, b] = space.rec709(found.color());
        found = Worth {
            value: [r, g, b, found.value[3]],
            notes,
            ..found
        };
    }
    found.unit = input.attribute("unit").map(str::to_owned);
    Ok(found)
}
