//! USD's text as prims, and its materials as documents of MaterialX, by whose tables they are read.

use std::collections::{BTreeSet, HashMap};
use std::fmt::Write as _;

use super::unquoted;
use crate::document::MaterialSettings;
use crate::store::exchange::carried;
use crate::store::exchange::materialx::SurfaceKind;
use crate::store::exchange::report::Entry;
use crate::store::exchange::xml::escaped;

/// Deepest nesting that is read, and longest chain of connections.
const DEPTH_MAX: usize = 64;
/// Outputs of a material that name its surface. The first that is known is read.
const SURFACES: [&str; 2] = ["outputs:surface.connect", "outputs:mtlx:surface.connect"];

/// A property with its value as it is written; empty without one.
struct Property<'t> {
    kind: &'t str,
    name: &'t str,
    value: &'t str,
    metadata: &'t str,
}

/// A thing of the file.
pub(super) struct Prim<'t> {
    path: String,
    kind: &'t str,
    metadata: &'t str,
    properties: Vec<Property<'t>>,
}

impl<'t> Prim<'t> {
    fn property(&self, name: &str) -> Option<&Property<'t>> {
        self.properties.iter().find(|property| property.name == name)
    }

    /// The exact parameters, where they are carried.
    pub fn exact(&self) -> Option<MaterialSettings> {
        carried::from_text(&unquoted(setting(self.metadata, carried::MARK)?)?)
    }

    /// The node that a shader is in MaterialX, and the type of its output.
    fn node(&self) -> (String, &'static str) {
        let id = self
            .property("info:id")
            .and_then(|id| unquoted(id.value))
            .unwrap_or_default();
        let Some(definition) = id.strip_prefix("ND_") else {
            let kind = id.split_once("_float").map_or(&id[..], |(kind, _)| kind);
            return (kind.to_owned(), "");
        };
        let parts: Vec<&str> = definition.split('_').collect();
        let type_of = |part: &&str| TYPES.iter().find(|kind| part.starts_with(**kind));
        let is_name = |part: &&&str| type_of(part).is_none() && part.parse::<u32>().is_err();
        let named = parts.iter().take_while(is_name).copied().collect::<Vec<_>>().join("_");
        let kind = parts.iter().rev().find_map(type_of);
        (named, kind.copied().unwrap_or_default())
    }
}

/// Types by which names of MaterialX's definitions end.
const TYPES: &[&str] = &[
    "float",
    "color3",
    "color4",
    "vector2",
    "vector3",
    "vector4",
    "integer",
    "boolean",
    "string",
    "filename",
    "matrix33",
    "matrix44",
    "surfaceshader",
    "displacementshader",
    "volumeshader",
    "material",
    "BSDF",
    "EDF",
];

/// What stands at the end of a connection.
enum End<'s, 't> {
    Node(&'s Prim<'t>, &'t str),
    Value(&'s Property<'t>),
}

/// The prims of a file.
#[derive(Default)]
pub(super) struct Stage<'t> {
    prims: Vec<Prim<'t>>,
    places: HashMap<String, usize>,
}

impl<'t> Stage<'t> {
    pub fn of(text: &'t str) -> Self {
        let mut stage = Self::default();
        let mut reader = Reader { text, at: 0 };
        stage.body(&mut reader, None, 0);
        stage
    }

    pub fn materials(&self) -> impl Iterator<Item = &Prim<'t>> {
        self.prims.iter().filter(|prim| prim.kind == "Material")
    }

    /// What stands between brackets, up to the closing one: properties of a prim, and prims.
    fn body(&mut self, reader: &mut Reader<'t>, owner: Option<usize>, depth: usize) {
        while let Some(token) = reader.next() {
            match token {
                Token::Mark("}") => return,
                Token::Mark("(" | "[" | "{") => reader.skip_group(),
                Token::Word("def" | "over" | "class") => self.prim(reader, owner, depth),
                Token::Word("variantSet") => self.variants(reader, owner, depth),
                Token::Word(first) => {
                    if let (Some(property), Some(owner)) = (reader.property(first), owner) {
                        let known = &mut self.prims[owner].properties;
                        if known.iter().all(|other| other.name != property.name) {
                            known.push(property);
                        }
                    }
                }
                _ => {}
            }
        }
    }

    fn prim(&mut self, reader: &mut Reader<'t>, owner: Option<usize>, depth: usize) {
        let mut kind = "";
        let mut token = reader.next();
        if let Some(Token::Word(word)) = token {
            kind = word;
            token = reader.next();
        }
        let Some(Token::Text(name)) = token else { return };
        let above = owner.map_or("", |owner| &self.prims[owner].path);
        let path = format!("{above}/{}", unquoted(name).unwrap_or_default());
        let metadata = reader.group_after_lines("(").unwrap_or_default();
        let place = self.prims.len();
        self.places.entry(path.clone()).or_insert(place);
        self.prims.push(Prim {
            path,
            kind,
            metadata,
            properties: Vec::new(),
        });
        self.inside(reader, place, depth);
    }

    /// The body that comes next, if it is not too deep.
    fn inside(&mut self, reader: &mut Reader<'t>, owner: usize, depth: usize) {
        if depth >= DEPTH_MAX {
            reader.group_after_lines("{");
        } else if reader.is_after_lines("{") {
            self.body(reader, Some(owner), depth + 1);
        }
    }

    /// Of a set of variants the one that is chosen, or the first.
    fn variants(&mut self, reader: &mut Reader<'t>, owner: Option<usize>, depth: usize) {
        let (Some(Token::Text(set)), Some(owner)) = (reader.next(), owner) else {
            return;
        };
        let name = unquoted(set).unwrap_or_default();
        let mut chosen = setting(self.prims[owner].metadata, &name);
        if reader.next() != Some(Token::Mark("=")) || !reader.is_after_lines("{") {
            return;
        }
        while let Some(token) = reader.next() {
            match token {
                Token::Mark("}") => return,
                Token::Text(variant) => {
                    reader.group_after_lines("(");
                    if unquoted(chosen.get_or_insert(variant)) == unquoted(variant) {
                        self.inside(reader, owner, depth);
                    } else {
                        reader.group_after_lines("{");
                    }
                }
                _ => {}
            }
        }
    }

    /// What a connection leads to, by way of the inputs and outputs of graphs and materials.
    fn end(&self, target: &'t str) -> Option<End<'_, 't>> {
        let mut target = target;
        for _ in 0..DEPTH_MAX {
            let path = target.split_once('<')?.1.split('>').next()?;
            let (prim, property) = path.split_once('.')?;
            let prim = &self.prims[*self.places.get(prim)?];
            if prim.kind == "Shader" {
                return Some(End::Node(prim, property.strip_prefix("outputs:")?));
            }
            match prim.property(&format!("{property}.connect")) {
                Some(next) => target = next.value,
                None => return prim.property(property).map(End::Value),
            }
        }
        None
    }

    /// A material as a document of MaterialX, and what of it is not read; none if it has no surface.
    pub fn document(&self, material: &Prim<'t>) -> Option<(String, Vec<Entry>)> {
        let connected = SURFACES
            .iter()
            .filter_map(|name| match self.end(material.property(name)?.value)? {
                End::Node(shader, _) => Some(shader),
                End::Value(_) => None,
            });
        let inside = format!("{}/", material.path);
        let is_known = |shader: &&Prim<'_>| SurfaceKind::named(&shader.node().0).is_some();
        let loose = self
            .prims
            .iter()
            .filter(|prim| prim.kind == "Shader" && prim.path.starts_with(&inside));
        let all: Vec<&Prim<'t>> = connected.chain(loose.filter(is_known)).collect();
        let surface = *all.iter().find(|shader| is_known(shader)).or(all.first())?;
        let mut losses = Vec::new();
        for shader in all.iter().filter(|other| is_known(other) && other.path != surface.path) {
            let why = format!("the material's {} is read", surface.node().0);
            if losses.is_empty() {
                losses.push(Entry::dropped(shader.node().0, why));
            }
        }
        for word in ["references", "payload", "inherits", "specializes"] {
            if setting(material.metadata, word).is_some() {
                losses.push(Entry::dropped(word, "one file is read by itself"));
            }
        }
        let (mut nodes, mut next, mut known) = (String::new(), vec![surface], BTreeSet::new());
        while let Some(shader) = next.pop() {
            if known.insert(&shader.path) {
                nodes += &self.element(shader, &mut next);
            }
        }
        let name = material.path.rsplit('/').next().unwrap_or_default();
        let label = material
            .property("ui:displayName")
            .and_then(|label| unquoted(label.value));
        let (name, label) = (escaped(name), escaped(label.as_deref().unwrap_or(name)));
        let text = format!(
            "<materialx version=\"1.39\" colorspace=\"lin_rec709\">{nodes}<surfacematerial name=\"{name}\" type=\"material\" \
             uiname=\"{label}\"><input name=\"surfaceshader\" type=\"surfaceshader\" nodename=\"{}\"/></surfacematerial></materialx>",
            escaped(&surface.path)
        );
        Some((text, losses))
    }

    /// A shader as a node, with those that it is connected to added to `next`.
    fn element<'s>(&'s self, shader: &Prim<'t>, next: &mut Vec<&'s Prim<'t>>) -> String {
        let (node, kind) = shader.node();
        let is_name = node.starts_with(|c: char| c.is_ascii_alphabetic())
            && node.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let node = if is_name { &node } else { "unknown" };
        let kind = match SurfaceKind::named(node) {
            Some(_) => "surfaceshader",
            None => kind,
        };
        let mut text = format!("<{node} name=\"{}\" type=\"{kind}\">", escaped(&shader.path));
        for property in &shader.properties {
            let Some(name) = property.name.strip_prefix("inputs:") else {
                continue;
            };
            let is_connected = shader.property(&format!("{}.connect", property.name)).is_some();
            let (name, value) = match name.strip_suffix(".connect") {
                Some(name) => match self.end(property.value) {
                    Some(End::Node(source, output)) => {
                        next.push(source);
                        (
                            name,
                            format!("nodename=\"{}\" output=\"{}\"", escaped(&source.path), escaped(output)),
                        )
                    }
                    Some(End::Value(property)) => (name, value(property)),
                    None => (name, format!("nodename=\"{}\"", escaped(property.value))),
                },
                None if is_connected || property.value.is_empty() => continue,
                None => (name, value(property)),
            };
            let _ = write!(text, "<input name=\"{}\" {value}/>", escaped(name));
        }
        if node == "UsdUVTexture" && !text.contains("<input name=\"sourceColorSpace\"") {
            text += "<input name=\"sourceColorSpace\" value=\"auto\"/>";
        }
        format!("{text}</{node}>")
    }
}

/// A value as the attributes of an input.
fn value(property: &Property<'_>) -> String {
    let text = property.value;
    let plain = match text.chars().next() {
        Some('"' | '\'') => unquoted(text).unwrap_or_default(),
        _ => text.trim_matches(['(', ')', '@']).to_owned(),
    };
    let kind = property.kind.trim_end_matches(['f', 'h', 'd']);
    let kind = if kind.starts_with("color") { kind } else { "" };
    let space = setting(property.metadata, "colorSpace").and_then(unquoted);
    let space = space.map_or_else(String::new, |space| format!(" colorspace=\"{}\"", escaped(&space)));
    format!("type=\"{kind}\" value=\"{}\"{space}", escaped(&plain))
}

/// What is set equal to a name in metadata or one of its dictionaries.
fn setting<'t>(metadata: &'t str, name: &str) -> Option<&'t str> {
    let mut reader = Reader { text: metadata, at: 0 };
    while let Some(token) = reader.next() {
        if token == Token::Word(name) && reader.next() == Some(Token::Mark("=")) {
            return reader.value();
        }
    }
    None
}

/// A piece of the text. Texts, files and paths have their marks.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Token<'t> {
    Word(&'t str),
    Text(&'t str),
    Other(&'t str),
    Mark(&'t str),
    Line,
}

struct Reader<'t> {
    text: &'t str,
    at: usize,
}

impl<'t> Reader<'t> {
    fn next(&mut self) -> Option<Token<'t>> {
        let rest = &self.text[self.at..];
        let rest = rest.trim_start_matches([' ', '\t', '\r', '\u{feff}', ',']);
        self.at = self.text.len() - rest.len();
        let first = rest.chars().next()?;
        let until = |mark: &str, from: usize| {
            rest[from..]
                .find(mark)
                .map_or(rest.len(), |end| from + end + mark.len())
        };
        let (length, token): (usize, fn(&'t str) -> Token<'t>) = match first {
            '#' => (rest.find('\n').unwrap_or(rest.len()), |_| Token::Line),
            '\n' | ';' => (1, |_| Token::Line),
            '"' | '\'' => (text_length(rest, first), Token::Text),
            '@' if rest.starts_with("@@@") => (until("@@@", 3), Token::Other),
            '@' => (until("@", 1), Token::Other),
            '<' => (until(">", 1), Token::Other),
            '(' | ')' | '[' | ']' | '{' | '}' | '=' => (1, Token::Mark),
            _ => {
                let ends = |c: char| c.is_whitespace() || "()[]{}=,;\"'@<#".contains(c);
                let end = rest.find(ends).unwrap_or(rest.len()).max(first.len_utf8());
                // `float[]` is a word.
                (end + if rest[end..].starts_with("[]") { 2 } else { 0 }, Token::Word)
            }
        };
        self.at += length;
        Some(token(&rest[..length]))
    }

    /// Goes on behind the bracket that closes the one before.
    fn skip_group(&mut self) {
        let mut depth = 1;
        while depth > 0 {
            match self.next() {
                Some(Token::Mark("(" | "[" | "{")) => depth += 1,
                Some(Token::Mark(")" | "]" | "}")) => depth -= 1,
                Some(_) => {}
                None => return,
            }
        }
    }

    /// Whether this bracket comes next, behind which it goes on then.
    fn is_after_lines(&mut self, bracket: &str) -> bool {
        let start = self.at;
        loop {
            match self.next() {
                Some(Token::Line) => {}
                Some(Token::Mark(mark)) if mark == bracket => return true,
                _ => {
                    self.at = start;
                    return false;
                }
            }
        }
    }

    /// What is between brackets, where this one comes next.
    fn group_after_lines(&mut self, bracket: &str) -> Option<&'t str> {
        self.is_after_lines(bracket).then(|| {
            let start = self.at;
            self.skip_group();
            &self.text[start..self.at]
        })
    }

    /// A value with its brackets or marks.
    fn value(&mut self) -> Option<&'t str> {
        let token = self.next()?;
        match token {
            Token::Word(text) | Token::Text(text) | Token::Other(text) => Some(text),
            Token::Mark("(" | "[" | "{") => {
                let start = self.at - 1;
                self.skip_group();
                Some(&self.text[start..self.at])
            }
            _ => None,
        }
    }

    /// The property that begins with a word.
    fn property(&mut self, first: &'t str) -> Option<Property<'t>> {
        let mut property = Property {
            kind: "",
            name: first,
            value: "",
            metadata: "",
        };
        loop {
            let before = self.at;
            match self.next() {
                Some(Token::Word(word)) => (property.kind, property.name) = (property.name, word),
                Some(Token::Mark("=")) => property.value = self.value()?,
                Some(Token::Mark("(")) => {
                    let start = self.at;
                    self.skip_group();
                    property.metadata = &self.text[start..self.at];
                }
                Some(Token::Line) | None => return Some(property),
                _ => {
                    self.at = before;
                    return Some(property);
                }
            }
        }
    }
}

/// The length of the text in quotation marks that begins here.
fn text_length(text: &str, mark: char) -> usize {
    let three: String = [mark; 3].iter().collect();
    let mark = if text.starts_with(&three) {
        three
    } else {
        mark.to_string()
    };
    let mut at = mark.len();
    while at < text.len() {
        let rest = &text[at..];
        if rest.starts_with(&mark) {
            return at + mark.len();
        }
        let letter = rest.chars().next().map_or(1, char::len_utf8);
        at += letter;
        if rest.starts_with('\\') {
            at += text[at..].chars().next().map_or(0, char::len_utf8);
        }
    }
    text.len()
}
