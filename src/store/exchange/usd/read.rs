//! Materials of USD's text: each UsdPreviewSurface with its inputs, and the exact parameters where they are carried.

use crate::document::MaterialSettings;
use crate::import::Goes;
use crate::store::exchange::carried;
use crate::store::exchange::materialx::{Inputs, SurfaceKind};
use crate::store::exchange::report::Entry;
use crate::store::exchange::surface::Surface;

use super::unquoted;

/// The kind of surface that is read.
const PREVIEW: &str = "UsdPreviewSurface";

/// A material as the file has it.
#[derive(Default)]
pub(super) struct Read {
    name: String,
    exact: Option<MaterialSettings>,
    /// Inputs of its preview surface with what is written for them; none where it has no such surface.
    preview: Option<Vec<(String, String)>>,
}

/// What a `{` that is not closed yet belongs to.
#[derive(Clone, Copy, PartialEq)]
enum Open {
    Material,
    Shader,
    Other,
}

/// The materials of a text.
pub(super) fn materials(text: &str) -> Vec<Read> {
    let mut lines = Lines {
        found: Vec::new(),
        open: Vec::new(),
        next: Open::Other,
        inputs: Vec::new(),
        is_preview: false,
    };
    for line in text.lines().map(str::trim) {
        if let Some((kind, name)) = definition(line) {
            lines.begin(kind, name);
        }
        lines.brackets(&without_strings(line));
        lines.attribute(line);
    }
    lines.found
}

/// A text that is read line by line.
struct Lines {
    found: Vec<Read>,
    open: Vec<Open>,
    /// What the next `{` belongs to.
    next: Open,
    /// Inputs of the shader that is open, and whether it is a preview surface.
    inputs: Vec<(String, String)>,
    is_preview: bool,
}

impl Lines {
    fn begin(&mut self, kind: Open, name: String) {
        self.next = kind;
        match kind {
            Open::Material => self.found.push(Read {
                name,
                ..Read::default()
            }),
            Open::Shader => (self.inputs, self.is_preview) = (Vec::new(), false),
            Open::Other => {}
        }
    }

    fn brackets(&mut self, bare: &str) {
        for bracket in bare.chars() {
            match bracket {
                // A `{` after an `=` is a dictionary of the metadata.
                '{' if bare.contains('=') => self.open.push(Open::Other),
                '{' => self.open.push(std::mem::replace(&mut self.next, Open::Other)),
                '}' => {
                    let is_preview = self.open.pop() == Some(Open::Shader) && self.is_preview;
                    if let Some(material) = self.found.last_mut().filter(|_| is_preview) {
                        material.preview = Some(std::mem::take(&mut self.inputs));
                    }
                }
                _ => {}
            }
        }
    }

    fn attribute(&mut self, line: &str) {
        let Some((left, value)) = line.split_once('=') else {
            return;
        };
        let (left, value) = (left.trim(), value.trim());
        let inside = self.open.last().copied();
        if inside == Some(Open::Shader) {
            self.is_preview |= left.ends_with("info:id") && value.contains(&format!("\"{PREVIEW}\""));
            if let Some((_, name)) = left.split_once(" inputs:") {
                self.inputs.push((name.to_owned(), value.to_owned()));
            }
        } else if let Some(material) = self.found.last_mut() {
            if left == format!("string {}", carried::MARK) {
                material.exact = unquoted(value).and_then(|text| carried::from_text(&text));
            } else if inside == Some(Open::Material)
                && left.ends_with("ui:displayName")
                && let Some(name) = unquoted(value)
            {
                material.name = name;
            }
        }
    }
}

/// The kind and the name of the prim that a line begins.
fn definition(line: &str) -> Option<(Open, String)> {
    let rest = ["def ", "over ", "class "]
        .iter()
        .find_map(|word| line.strip_prefix(word))?;
    let (kind, name) = rest.split_once('"').unwrap_or((rest, ""));
    let name = name.split('"').next().unwrap_or_default().to_owned();
    let kind = match kind.trim() {
        "Material" => Open::Material,
        "Shader" => Open::Shader,
        _ => Open::Other,
    };
    Some((kind, name))
}

/// A line without what stands in quotation marks or after a `#`.
fn without_strings(line: &str) -> String {
    let (mut bare, mut letters, mut mark) = (String::new(), line.chars(), None);
    while let Some(letter) = letters.next() {
        match (letter, mark) {
            ('\\', Some(_)) => {
                letters.next();
            }
            (_, Some(open)) if letter == open => mark = None,
            (_, Some(_)) => {}
            ('"' | '\'', None) => mark = Some(letter),
            ('#', None) => break,
            _ => bare.push(letter),
        }
    }
    bare
}

impl Read {
    /// The exact parameters where they are there and show what the preview shows; else what that shows. `shown_by` says
    /// what the preview of exact parameters is.
    pub fn material(
        self,
        lobe: crate::document::ImportLobe,
        is_plain: bool,
        shown_by: impl Fn(&MaterialSettings) -> Vec<(String, String)>,
    ) -> Option<(MaterialSettings, Vec<Entry>)> {
        let exact = self.exact.filter(|_| !is_plain || self.preview.is_none());
        let Some(preview) = self.preview else {
            return exact.map(|exact| (exact, Vec::new()));
        };
        let mut lost = Vec::new();
        if let Some(exact) = exact {
            if is_near(&shown_by(&exact), &preview) {
                return Some((exact, Vec::new()));
            }
            let why = "the file was changed since it was exported";
            lost.push(Entry::dropped("the exact parameters", why));
        }
        let (mut surface, losses) = surface_of(&preview)?;
        surface.name = self.name;
        lost.extend(losses);
        Some((surface.with_lobe(lobe, 1.0), lost))
    }
}

/// Whether the same inputs have the same numbers, but for digits that other programs leave out.
fn is_near(ours: &[(String, String)], theirs: &[(String, String)]) -> bool {
    let near = |(a, b): (f32, f32)| (a - b).abs() <= 1e-4 * (1.0 + a.abs());
    ours.len() == theirs.len()
        && ours.iter().all(|(name, value)| {
            let other = theirs.iter().find(|(other, _)| other == name);
            match (numbers(value), other.and_then(|(_, value)| numbers(value))) {
                (Some(a), Some(b)) => a.into_iter().zip(b).all(near),
                _ => false,
            }
        })
}

fn surface_of(preview: &[(String, String)]) -> Option<(Surface, Vec<Entry>)> {
    let kind = SurfaceKind::named(PREVIEW)?;
    let mut inputs: Inputs = kind.unset();
    for (name, value) in preview {
        if let Some(name) = name.strip_suffix(".connect") {
            let why = match inputs.row(name).map(|row| row.goes) {
                Some(Goes::Nowhere(why)) => why,
                _ => "textures and graphs of USD are not read",
            };
            inputs.losses.push(Entry::dropped(name, why));
            continue;
        }
        // A normal without a texture is the surface's own.
        if inputs.row(name).is_some_and(|row| row.default.is_empty()) {
            continue;
        }
        match numbers(value) {
            Some(value) => inputs.set(name, value),
            None => inputs
                .losses
                .push(Entry::dropped(name.as_str(), format!("{value} is no number"))),
        }
    }
    Some(kind.surface(inputs))
}

/// A value as three numbers: `0.5`, `(1, 0.5, 0.25)`, or the word of an opacity's mode.
fn numbers(text: &str) -> Option<[f32; 3]> {
    let number = |text: &str| match text.trim() {
        "\"transparent\"" => Some(0.0),
        "\"presence\"" => Some(1.0),
        text => text.parse().ok().filter(|x: &f32| x.is_finite()),
    };
    // Metadata may follow a value.
    let text = text.trim();
    let text = match text.strip_prefix('(') {
        Some(inner) => inner.split(')').next()?,
        None => text.split('(').next()?,
    };
    let all: Option<Vec<f32>> = text.split(',').map(number).collect();
    match all?[..] {
        [x] => Some([x; 3]),
        [r, g, b] => Some([r, g, b]),
        _ => None,
    }
}
