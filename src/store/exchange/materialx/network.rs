//! A surface and its textures as nodes, which a document of MaterialX has as elements and USD as shaders.

use glam::{DAffine2, DVec2};

use super::{read::normal_target, read::target_of, surfaces, table};
use crate::{
    import::{FileParameter, USD_PREVIEW_SURFACE},
    scene::texture::{TextureProjection, TextureTarget},
    store::exchange::{
        surface::Surface,
        textures::{Carried, mapping, scale},
        xml::{element, escaped, numbers},
    },
};

/// What an input of a node is worth.
pub enum Worth {
    Value(String),
    /// A file beside the document, and the space of its values.
    File(String, &'static str),
    /// A node's output.
    Of(String, &'static str),
}

/// A node with one output.
pub struct Node {
    pub name: String,
    pub kind: &'static str,
    /// Type and name of its output.
    pub output: [&'static str; 2],
    /// Name, type and worth of each input.
    pub inputs: Vec<(&'static str, &'static str, Worth)>,
}

impl Node {
    /// It as an element of a document.
    pub fn element(&self) -> String {
        let input = |(name, of, worth): &(&str, &str, Worth)| {
            let worth = match worth {
                Worth::Value(value) => format!("value=\"{value}\""),
                Worth::File(file, space) => format!("value=\"{}\" colorspace=\"{space}\"", escaped(file)),
                Worth::Of(node, _) => format!("nodename=\"{node}\""),
            };
            format!("<input name=\"{name}\" type=\"{of}\" {worth} />\n")
        };
        let inputs: String = self.inputs.iter().map(input).collect();
        let Self { name, kind, output, .. } = self;
        element(&format!("{kind} name=\"{name}\" type=\"{}\"", output[0]), &inputs)
    }
}

type Textures<'a> = [Carried<'a, String>];
type Texture<'a> = Carried<'a, String>;

/// A kind of surface that is written.
pub struct Form {
    /// Name of its node, and of that one's output.
    kind: [&'static str; 2],
    rows: &'static [FileParameter],
    /// What the names of rows begin with that are not written.
    without: &'static [&'static str],
    /// The type of its inputs for normals.
    normal: &'static str,
    /// The numbers that its inputs have for a surface.
    numbers: fn(&Surface) -> Surface,
    /// Adds nodes, the last of which is a texture multiplied by a value.
    texture: fn(&Texture<'_>, &mut Chain, [f32; 3]),
}

pub const OPEN_PBR: Form = Form {
    kind: ["open_pbr_surface", "out"],
    rows: table::OPEN_PBR,
    without: &[],
    normal: "vector3",
    numbers: surfaces::as_open_pbr,
    texture: image,
};
pub const STANDARD_SURFACE: Form = Form {
    kind: ["standard_surface", "out"],
    rows: table::STANDARD_SURFACE,
    // It is another one.
    without: &["sheen"],
    normal: "vector3",
    numbers: surfaces::as_standard_surface,
    texture: image,
};
pub const PREVIEW_SURFACE: Form = Form {
    kind: ["UsdPreviewSurface", "surface"],
    rows: USD_PREVIEW_SURFACE,
    without: &[
        "useSpecularWorkflow",
        "specularColor",
        "opacityMode",
        "opacityThreshold",
    ],
    normal: "normal3f",
    numbers: surfaces::as_preview_surface,
    texture: uv_texture,
};

impl Form {
    fn rows(&self) -> impl Iterator<Item = &'static FileParameter> {
        let is_written = |row: &&FileParameter| !self.without.iter().any(|name| row.place.starts_with(name));
        self.rows.iter().filter(is_written)
    }

    /// Whether it has an input for a texture.
    pub fn takes(&self, target: TextureTarget) -> bool {
        self.rows().any(|row| varied_by(row) == Some(target))
    }

    /// A surface as a node of this name, and the nodes that it is connected to.
    pub fn nodes(&self, surface: &Surface, name: &str, textures: &Textures<'_>) -> Vec<Node> {
        let (mut inputs, mut others, shown) = (Vec::new(), Vec::new(), (self.numbers)(surface));
        let mut connected = |row: &FileParameter, of: &str, value| {
            let texture = textures.iter().find(|texture| varied_by(row) == Some(texture.target))?;
            let target = texture.target.name().replace('-', "_");
            let mut chain = Chain {
                name: format!("{name}_{target}"),
                nodes: Vec::new(),
            };
            (self.texture)(texture, &mut chain, value);
            if of == "color3" && texture.target.is_number() {
                chain.then(["convert", "color"], ["color3", "out"], ["in", "float"], Vec::new());
            }
            let last = chain.last();
            others.extend(chain.nodes);
            last
        };
        for row in self.rows() {
            if normal_target(row.place).is_some() {
                inputs.extend(connected(row, self.normal, [1.0; 3]).map(|worth| (row.place, self.normal, worth)));
            } else if let Some(value) = surfaces::written(row, &shown) {
                let (of, count) = if row.is_list() { ("color3", 3) } else { ("float", 1) };
                let plain = || Worth::Value(numbers(&value[..count]));
                inputs.push((row.place, of, connected(row, of, value).unwrap_or_else(plain)));
            }
        }
        let (_, rotation_deg) = surface.ratio_and_rotation();
        if self.rows.iter().any(|row| row.place == "geometry_tangent")
            && surface.anisotropy != 0.0
            && rotation_deg != 0.0
        {
            let turned = turned_tangent(name, rotation_deg);
            inputs.push(("geometry_tangent", "vector3", Worth::Of(turned[2].name.clone(), "out")));
            others.extend(turned);
        }
        if self.kind[0] == "UsdPreviewSurface" && surface.transmission_weight == 0.0 {
            // Else what is not stopped is refracted.
            inputs.push(("opacityMode", "token", Worth::Value("presence".to_owned())));
        }
        let surface = Node {
            name: name.to_owned(),
            kind: self.kind[0],
            output: ["surfaceshader", self.kind[1]],
            inputs,
        };
        std::iter::once(surface).chain(others).collect()
    }
}

/// What a texture on an input varies.
fn varied_by(row: &FileParameter) -> Option<TextureTarget> {
    let opacity = (row.place == "opacity").then_some(TextureTarget::Opacity);
    target_of(row).or(normal_target(row.place)).or(opacity)
}

/// The tangent turned about the normal, where the highlight is stretched in another direction.
fn turned_tangent(name: &str, rotation_deg: f32) -> [Node; 3] {
    let node = |part: &str, kind, inputs| Node {
        name: format!("{name}_{part}"),
        kind,
        output: ["vector3", "out"],
        inputs,
    };
    let world = || vec![("space", "string", Worth::Value("world".to_owned()))];
    let of = |part: &str| Worth::Of(format!("{name}_{part}"), "out");
    let turn = vec![
        ("in", "vector3", of("along")),
        ("amount", "float", Worth::Value(rotation_deg.to_string())),
        ("axis", "vector3", of("up")),
    ];
    [
        node("along", "tangent", world()),
        node("up", "normal", world()),
        node("turned", "rotate3d", turn),
    ]
}

/// Nodes each of which takes the one before.
pub struct Chain {
    /// What their names begin with.
    name: String,
    nodes: Vec<Node>,
}

impl Chain {
    /// The output of the last node.
    fn last(&self) -> Option<Worth> {
        let last = self.nodes.last()?;
        Some(Worth::Of(last.name.clone(), last.output[1]))
    }

    /// Adds a node that takes the one before, if there is one, through an input of this name and type.
    fn then(
        &mut self,
        [kind, ending]: [&'static str; 2],
        output: [&'static str; 2],
        [through, of]: [&'static str; 2],
        inputs: Vec<(&'static str, &'static str, Worth)>,
    ) {
        let before = self.last();
        self.nodes.push(Node {
            name: format!("{}_{ending}", self.name),
            kind,
            output,
            inputs: before
                .map(|before| (through, of, before))
                .into_iter()
                .chain(inputs)
                .collect(),
        });
    }
}

fn pair(pair: DVec2) -> Worth {
    Worth::Value(numbers(&pair.as_vec2().to_array()))
}

fn space(texture: &Texture<'_>, names: [&'static str; 2]) -> &'static str {
    names[usize::from(texture.texture.is_srgb(texture.target))]
}

/// A texture by MaterialX's own nodes.
fn image(texture: &Texture<'_>, chain: &mut Chain, value: [f32; 3]) {
    let is_normal = texture.target.is_normal();
    let of = match texture.target {
        target if target.is_color() => "color3",
        _ if is_normal => "vector3",
        _ => "float",
    };
    let number = |value: f32| Worth::Value(value.to_string());
    if texture.texture.projection == TextureProjection::Second {
        let index = vec![("index", "integer", number(1.0))];
        chain.then(["texcoord", "coordinates"], ["vector2", "out"], [""; 2], index);
    }
    let mapping = mapping(texture.texture);
    if mapping != DAffine2::IDENTITY {
        let offset = DVec2::from(texture.texture.offset.map(f64::from));
        let inputs = vec![
            ("pivot", "vector2", pair(DVec2::splat(0.5))),
            ("scale", "vector2", pair(scale(texture.texture).recip())),
            ("rotate", "float", number(texture.texture.rotation_deg)),
            ("offset", "vector2", pair(mapping.matrix2.inverse() * offset)),
            // Moved, turned, scaled.
            ("operationorder", "integer", number(1.0)),
        ];
        chain.then(
            ["place2d", "place"],
            ["vector2", "out"],
            ["texcoord", "vector2"],
            inputs,
        );
    }
    let read = match of {
        "float" if texture.channel == 3 => "color4",
        "float" => "color3",
        of => of,
    };
    let file = Worth::File(texture.made.clone(), space(texture, ["none", "srgb_texture"]));
    chain.then(
        ["image", "image"],
        [read, "out"],
        ["texcoord", "vector2"],
        vec![("file", "filename", file)],
    );
    if of == "float" {
        let index = vec![("index", "integer", number(texture.channel as f32))];
        chain.then(["extract", "channel"], [of, "out"], ["in", read], index);
    }
    let [scale, offset] = texture.affine(1.0).map(|by| [0, 1, 2].map(|i| by[i] * value[i]));
    let operand = |value: [f32; 3]| {
        let value = &value[..if of == "float" { 1 } else { 3 }];
        vec![("in2", of, Worth::Value(numbers(value)))]
    };
    if scale != [1.0; 3] {
        chain.then(["multiply", "factor"], [of, "out"], ["in1", of], operand(scale));
    }
    if offset != [0.0; 3] {
        chain.then(["add", "sum"], [of, "out"], ["in1", of], operand(offset));
    }
    if is_normal {
        let scale = vec![("scale", "float", number(texture.steepness))];
        chain.then(["normalmap", "normal"], [of, "out"], ["in", of], scale);
    }
}

/// A texture by USD's nodes.
fn uv_texture(texture: &Texture<'_>, chain: &mut Chain, value: [f32; 3]) {
    let word = |word: &str| Worth::Value(word.to_owned());
    let set = match texture.texture.projection {
        TextureProjection::Second => "st1",
        _ => "st",
    };
    let coordinates = ["float2", "result"];
    let name = vec![("varname", "string", word(set))];
    chain.then(["UsdPrimvarReader", "coordinates"], coordinates, [""; 2], name);
    let mapping = mapping(texture.texture);
    if mapping != DAffine2::IDENTITY {
        let mut turn = vec![(
            "rotation",
            "float",
            Worth::Value((0.0 - texture.texture.rotation_deg).to_string()),
        )];
        let through = ["in", "float2"];
        if texture.texture.stretch != 1.0 && texture.texture.rotation_deg != 0.0 {
            // A node scales before it turns.
            chain.then(
                ["UsdTransform2d", "turn"],
                coordinates,
                through,
                std::mem::take(&mut turn),
            );
        }
        turn.push(("scale", "float2", pair(scale(texture.texture))));
        turn.push(("translation", "float2", pair(mapping.translation)));
        chain.then(["UsdTransform2d", "place"], coordinates, through, turn);
    }
    let [mut scale, mut offset] = texture.affine(texture.steepness);
    if texture.target.is_normal() {
        // Directions from −1 to 1.
        (scale, offset) = (scale.map(|x| 2.0 * x), offset.map(|x| 2.0 * x - 1.0));
    }
    let four = |by: [f32; 3], alpha: f32| {
        let [r, g, b] = [0, 1, 2].map(|i| by[i] * value[i]);
        let alpha = if texture.target.is_number() { r } else { alpha };
        Worth::Value(numbers(&[r, g, b, alpha]))
    };
    let output = match texture.target.is_number() {
        true => ["float", ["r", "g", "b", "a"][texture.channel]],
        false => ["float3", "rgb"],
    };
    let inputs = vec![
        ("file", "asset", Worth::File(texture.made.clone(), "")),
        ("sourceColorSpace", "token", word(space(texture, ["raw", "sRGB"]))),
        ("wrapS", "token", word("repeat")),
        ("wrapT", "token", word("repeat")),
        ("scale", "float4", four(scale, 1.0)),
        ("bias", "float4", four(offset, 0.0)),
    ];
    chain.then(["UsdUVTexture", "texture"], output, ["st", "float2"], inputs);
}
