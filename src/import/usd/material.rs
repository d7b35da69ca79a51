//! Materials of a stage as slots: UsdPreviewSurface with its textures; of other surfaces the colour, metalness and roughness.

use std::collections::HashMap;

use glam::{DAffine2, DVec2};
use openusd::{sdf::FromValueCast, sdf::Value, usd::Prim, usd::Stage};

use super::{End, Known, end, text_of};
use crate::{
    USD_PREVIEW_SURFACE,
    files::Files,
    maps::{Maps, Part},
    optics::fresnel::fresnel_f0,
    scene::{
        AlphaMode, Filter, ModelOptions, Slot, Texture, TextureRef, Wrap,
        report::{Fate, ImportReport},
        texture::{TextureTarget, texture_mean},
    },
};

/// What other surfaces call what is read of them.
const OTHERS: [(&str, &str); 16] = [
    ("base_color", "base.color"),
    ("baseColor", "base.color"),
    ("base_metalness", "base.metalness"),
    ("metalness", "base.metalness"),
    ("metallic", "base.metalness"),
    ("specular_roughness", "specular.roughness"),
    ("roughness", "specular.roughness"),
    ("specular_ior", "specular.ior"),
    ("specular_IOR", "specular.ior"),
    ("ior", "specular.ior"),
    ("transmission_weight", "transmission.weight"),
    ("transmission", "transmission.weight"),
    ("coat_weight", "coat.weight"),
    ("coat", "coat.weight"),
    ("clearcoat", "coat.weight"),
    ("coat_roughness", "coat.roughness"),
];

/// Most transforms of a texture that are followed.
const TRANSFORMS_MAX: usize = 16;

/// A slot with the sets of texture coordinates that it looks up, by name.
type Painted = (Slot, [Option<String>; 2]);

/// Slots of the materials that meshes have asked for so far.
pub struct Slots<'a> {
    maps: Maps<'a>,
    read: &'a Known,
    /// Slot of a material by its path; none for faces without one.
    slot_of: HashMap<Option<String>, u32>,
    painted: Vec<Painted>,
}

impl<'a> Slots<'a> {
    pub fn new(files: &'a Files, read: &'a Known, options: &ModelOptions) -> Self {
        Self {
            maps: Maps::new(files, options),
            read,
            slot_of: HashMap::new(),
            painted: Vec::new(),
        }
    }

    pub fn slot(&mut self, path: Option<&str>, stage: &Stage, report: &mut ImportReport) -> (u32, [Option<String>; 2]) {
        let known = self.slot_of.get(&path.map(str::to_owned)).copied();
        let slot = known.unwrap_or_else(|| {
            let painted = match path {
                Some(path) => {
                    let prim = stage.prim(path);
                    let mut painter = Painter {
                        name: prim.path().name().unwrap_or_default().to_owned(),
                        maps: &mut self.maps,
                        read: self.read,
                        report,
                        slot: Slot::default(),
                        uv_sets: [None, None],
                        parts: Vec::new(),
                    };
                    painter.paint(&prim);
                    (painter.slot, painter.uv_sets)
                }
                None => {
                    report.note(Fate::Used, "surfaces without a material, as clay", "");
                    (Slot::clay(), [None, None])
                }
            };
            self.painted.push(painted);
            let slot = self.painted.len() as u32 - 1;
            self.slot_of.insert(path.map(str::to_owned), slot);
            slot
        });
        (slot, self.painted[slot as usize].1.clone())
    }

    pub fn get(&mut self, slot: u32) -> &mut Slot {
        &mut self.painted[slot as usize].0
    }

    pub fn finish(self) -> (Vec<Slot>, Vec<Texture>) {
        let mut slots: Vec<Slot> = self.painted.into_iter().map(|(slot, _)| slot).collect();
        let textures = self.maps.finish(&mut slots);
        (slots, textures)
    }
}

struct Painter<'a, 'b> {
    name: String,
    maps: &'a mut Maps<'b>,
    read: &'a Known,
    report: &'a mut ImportReport,
    slot: Slot,
    uv_sets: [Option<String>; 2],
    parts: Vec<Part>,
}

/// The value of an input without a texture.
fn constant<T: FromValueCast>(shader: &Prim, input: &str) -> Option<T> {
    let End::Value(attribute) = end(shader.attribute(format!("inputs:{input}")))? else {
        return None;
    };
    attribute.get::<Value>().ok()??.cast().ok()
}

/// A number three times, or a colour.
fn color(shader: &Prim, input: &str) -> Option<[f32; 3]> {
    let number = || constant::<f64>(shader, input).map(|x| [x; 3]);
    let found = constant::<[f64; 3]>(shader, input).or_else(number)?;
    Some(found.map(|x| if x.is_finite() { x as f32 } else { 0.0 }))
}

impl Painter<'_, '_> {
    fn note(&mut self, fate: Fate, what: impl Into<String>) {
        self.report.note(fate, what, &self.name);
    }

    fn paint(&mut self, material: &Prim) {
        self.note(Fate::Used, "materials");
        self.slot = Slot {
            name: text_of(&material.attribute("ui:displayName")).unwrap_or_else(|| self.name.clone()),
            double_sided: true,
            ..Slot::default()
        }
        .with(&[
            ("base.metalness", 0.0),
            ("specular.roughness", 0.5),
            ("geometry.opacity", 1.0),
        ]);
        let outputs = ["outputs:surface", "outputs:mtlx:surface"];
        let shaders = outputs
            .into_iter()
            .filter_map(|output| match end(material.attribute(output))? {
                End::Node(shader, _) => Some((text_of(&shader.attribute("info:id"))?, shader)),
                End::Value(_) => None,
            });
        let shaders: Vec<(String, Prim)> = shaders.collect();
        let preview = shaders.iter().find(|(id, _)| id.contains("UsdPreviewSurface"));
        match (preview, shaders.first()) {
            (Some((_, shader)), _) => self.preview_surface(shader),
            (None, Some((id, shader))) => {
                for (input, key) in OTHERS {
                    self.input(shader, input, key, None);
                }
                self.normal(shader, "normal");
                self.normal(shader, "geometry_normal");
                let what =
                    format!("a surface of {id}, by its colour, metalness, roughness, index, transmission and coat");
                self.note(Fate::Approximated, what);
            }
            (None, None) => self.note(Fate::Missing, "the surface of a material"),
        }
        let mode = self.slot.alpha_mode;
        self.maps.put(&self.parts, &mut self.slot, self.report);
        if mode == AlphaMode::Mask {
            self.slot.alpha_mode = mode;
        }
    }

    fn preview_surface(&mut self, shader: &Prim) {
        let number = |input: &str, default: f64| constant::<f64>(shader, input).unwrap_or(default);
        let (threshold, has_mode) = (number("opacityThreshold", 0.0), number("opacityMode", 0.0) > 0.0);
        let is_presence = has_mode || text_of(&shader.attribute("inputs:opacityMode")).as_deref() == Some("presence");
        let is_specular = number("useSpecularWorkflow", 0.0) != 0.0;
        self.normal(shader, "normal");
        for row in USD_PREVIEW_SURFACE {
            let [key, _] = row.keys();
            match row.place {
                "useSpecularWorkflow" | "opacityMode" | "opacityThreshold" | "normal" | "opacity" => {}
                "specularColor" if !is_specular => {}
                "metallic" if is_specular => {}
                "displacement" | "occlusion" => {
                    if let Some(End::Node(..)) = end(shader.attribute(format!("inputs:{}", row.place))) {
                        self.note(Fate::Ignored, format!("the {} of a material", row.place));
                    }
                }
                "specularColor" => self.input(shader, row.place, "specular.color", row.default_value()),
                place => self.input(shader, place, key, row.default_value()),
            }
        }
        if is_specular {
            // The reflection head-on is a colour by itself: what the index has it is multiplied by.
            let f0 = fresnel_f0(self.slot.number("specular.ior")).max(1e-3);
            self.slot.multiply("specular.color", [1.0 / f0; 3]);
        }
        self.slot.set("emission.strength", 1.0);
        let is_textured = matches!(end(shader.attribute("inputs:opacity")), Some(End::Node(..)));
        self.input(shader, "opacity", "geometry.opacity", Some([1.0; 3]));
        if threshold > 0.0 {
            (self.slot.alpha_mode, self.slot.alpha_cutoff) = (AlphaMode::Mask, threshold as f32);
        } else if is_presence || is_textured {
            self.slot.alpha_mode = AlphaMode::Blend;
        } else {
            // What is not stopped is refracted.
            let opacity = self.slot.number("geometry.opacity").clamp(0.0, 1.0);
            self.slot.set("geometry.opacity", 1.0);
            self.slot.set("transmission.weight", 1.0 - opacity);
        }
    }

    /// Puts an input in the place of a parameter: a value, or a texture with its scale.
    fn input(&mut self, shader: &Prim, input: &str, key: &'static str, default: Option<[f32; 3]>) {
        let node = match end(shader.attribute(format!("inputs:{input}"))) {
            Some(End::Node(node, output)) => Some((node, output)),
            _ => None,
        };
        let Some((node, output)) = node else {
            if let Some(found) = color(shader, input).or(default) {
                self.slot.set_color(key, found);
            }
            return;
        };
        if key == "base.color" && text_of(&node.attribute("inputs:varname")).as_deref() == Some("displayColor") {
            self.slot.set(key, 1.0);
            return self.slot.color_by_vertices();
        }
        let target = TextureTarget::of_key(key, "");
        let is_color = target.map_or(key.ends_with(".color"), TextureTarget::is_color);
        let Some(place) = self.texture(&node, is_color) else {
            let fallback = color(&node, "fallback").or(default);
            self.slot.set_color(key, fallback.unwrap_or([0.5; 3]));
            return;
        };
        let scale = color4(&node, "scale", 1.0);
        if color4(&node, "bias", 0.0) != [0.0; 4] {
            self.note(Fate::Ignored, format!("the bias of a texture of {input}"));
        }
        let channel = "rgba".find(&*output).unwrap_or(0);
        match target {
            Some(target) => {
                let factor = if is_color {
                    [scale[0], scale[1], scale[2]]
                } else {
                    [scale[channel]; 3]
                };
                self.slot.set_color(key, factor);
                let code: [fn([u8; 4]) -> u8; 4] = [|t| t[0], |t| t[1], |t| t[2], |t| t[3]];
                self.parts.push((target, place, code[channel]));
            }
            None => {
                let mean = texture_mean(self.maps.get(place.texture));
                let value = if is_color {
                    mean.linear
                } else {
                    [mean.codes[channel]; 3]
                };
                self.slot.set_color(key, [0, 1, 2].map(|i| value[i] * scale[i]));
                self.note(Fate::Approximated, format!("a texture of {input}, by its mean"));
            }
        }
    }

    /// The texture of normals comes first, since tangents follow its coordinates.
    fn normal(&mut self, shader: &Prim, input: &str) {
        let Some(End::Node(mut node, _)) = end(shader.attribute(format!("inputs:{input}"))) else {
            return;
        };
        // MaterialX has a node between.
        if let Some(End::Node(image, _)) = end(node.attribute("inputs:in")) {
            node = image;
        }
        if let Some(place) = self.texture(&node, false) {
            *self.slot.texture_mut(TextureTarget::Normal) = Some(place);
        }
    }

    /// The image of a node, and where it lies; `None`, and reported, if there is none.
    fn texture(&mut self, node: &Prim, is_color: bool) -> Option<TextureRef> {
        let file = match end(node.attribute("inputs:file")) {
            Some(End::Value(attribute)) => attribute.get::<Value>().ok().flatten(),
            _ => None,
        };
        let Some(Value::AssetPath(file)) = file else {
            let id = text_of(&node.attribute("info:id")).unwrap_or_default();
            self.note(Fate::Ignored, format!("a {id} in the place of an image"));
            return None;
        };
        let space = text_of(&node.attribute("inputs:sourceColorSpace"));
        if space.is_some_and(|space| space != "auto" && (space == "sRGB") != is_color) {
            self.note(
                Fate::Approximated,
                "the colour space of a texture, as is usual for its use",
            );
        }
        let (mut mapping, mut set) = (DAffine2::IDENTITY, None);
        if let Some(End::Node(mut place, _)) = end(node.attribute("inputs:st")) {
            for _ in 0..TRANSFORMS_MAX {
                if text_of(&place.attribute("info:id")).as_deref() != Some("UsdTransform2d") {
                    break;
                }
                mapping *= transform_of(&place);
                if let Some(End::Node(reader, _)) = end(place.attribute("inputs:in")) {
                    place = reader;
                }
            }
            if let Some(End::Value(name)) = end(place.attribute("inputs:varname")) {
                set = text_of(&name);
            }
        }
        let set = set.unwrap_or_else(|| "st".to_owned());
        let is_it = |known: &Option<String>| known.is_none() || known.as_deref() == Some(&set);
        let Some(uv_set) = self.uv_sets.iter().position(is_it) else {
            self.note(Fate::Ignored, "a texture on a third set of coordinates");
            return None;
        };
        self.uv_sets[uv_set] = Some(set);
        let name = file.resolved_path().unwrap_or(file.asset_path());
        let found = self.read.borrow().get(name).cloned();
        let texture = self.maps.image(&[name], found.as_deref(), is_color, self.report)?;
        let mut wrap = |input: &str| match text_of(&node.attribute(format!("inputs:{input}"))).as_deref() {
            Some("mirror") => Wrap::MirroredRepeat,
            Some("clamp" | "black") => Wrap::ClampToEdge,
            _ => Wrap::Repeat,
        };
        // v points downwards here, upwards there.
        let [[a, b], [c, d]] = mapping.matrix2.transpose().to_cols_array_2d();
        let [x, y] = mapping.translation.to_array();
        Some(TextureRef {
            texture,
            uv_set,
            texture_from_mesh_uv: [a, -b, b + x, -c, d, 1.0 - d - y].map(|x| x as f32),
            wrap: ["wrapS", "wrapT"].map(&mut wrap),
            filter: Filter::Linear,
        })
    }
}

/// Four numbers of an input.
fn color4(node: &Prim, input: &str, default: f32) -> [f32; 4] {
    let found = constant::<[f64; 4]>(node, input);
    found.map_or([default; 4], |found| found.map(|x| x as f32))
}

/// `UsdTransform2d`: scaled, turned counterclockwise, moved; v is upwards there on both sides.
fn transform_of(node: &Prim) -> DAffine2 {
    let pair = |input: &str, default: f64| {
        match end(node.attribute(format!("inputs:{input}"))) {
            Some(End::Value(attribute)) => attribute.get::<[f32; 2]>().ok().flatten(),
            _ => None,
        }
        .map_or(DVec2::splat(default), |found| DVec2::from(found.map(f64::from)))
    };
    let angle = constant::<f64>(node, "rotation").unwrap_or(0.0).to_radians();
    DAffine2::from_scale_angle_translation(pair("scale", 1.0), angle, pair("translation", 0.0))
}
