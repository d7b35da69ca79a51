//! Documents of MaterialX, read: the surfaces of several models with one value for each input. Images are taken by their mean.
//! What a graph computes is computed ([`super::graph`]), else named in the report.

use std::path::Path;

use roxmltree::{Document, Node};

use super::{
    CARRIER,
    graph::{Shader, Unknown, Worth, child, shaders, source_of, worth},
    images::Images,
    include::whole_text,
    inputs::Inputs,
    network::{self, OPEN_PBR, PREVIEW_SURFACE, STANDARD_SURFACE},
    surfaces::SurfaceKind,
    units,
};
use crate::{
    document::{ImportLobe, MaterialSettings, PARAMETERS, Parameter},
    import::{FileParameter, Goes},
    optics::fresnel::Fresnel,
    scene::Loading,
    scene::texture::{SHIPPED, TextureChannel, TextureTarget, UserTexture},
    store::exchange::{ExchangeError, ReadOptions, Subject, carried, report::Entry, surface::Surface, xml},
};

/// The materials of a document.
pub fn read(path: &Path, options: ReadOptions) -> Result<Subject, ExchangeError> {
    let bytes = crate::store::file::read(path)?;
    let wrong = |reason: String| ExchangeError::Contents {
        path: path.to_owned(),
        format: "MaterialX",
        reason,
    };
    let text = whole_text(path, String::from_utf8_lossy(&bytes).into_owned(), &options.loading).map_err(wrong)?;
    let document = xml::parse(&text).map_err(wrong)?;
    if !document.root_element().has_tag_name("materialx") {
        return Err(wrong("it has no <materialx>".to_owned()));
    }
    read_document(path, &document, Vec::new(), options)
}

/// The materials of a document whose images are seen from the file at `path`; `lost` is what the first lost on its way into that.
pub fn read_document(
    path: &Path,
    document: &Document<'_>,
    mut lost: Vec<Entry>,
    options: ReadOptions,
) -> Result<Subject, ExchangeError> {
    let mut subject = Subject::default();
    let mut refused = Vec::new();
    let images = Images::in_folder(path.parent().unwrap_or(Path::new(".")), &options.loading);
    for shader in shaders(document.root_element()) {
        match read_surface(&shader, &images) {
            Ok((surface, mut losses)) => {
                losses.append(&mut lost);
                let (material, losses) = exact_or_shown(&surface, losses, &shader, &options);
                subject.materials.push(material);
                subject.losses.push(losses);
            }
            Err(reason) => refused.push(reason),
        }
    }
    if subject.materials.is_empty() {
        let reason = if refused.is_empty() {
            "it has no <surfacematerial>".to_owned()
        } else {
            refused.join("; ")
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
    shader: &Shader<'_>,
    options: &ReadOptions,
) -> (MaterialSettings, Vec<Entry>) {
    let text = shader.material.and_then(|material| material.attribute(CARRIER));
    if let Some(mut exact) = text.filter(|_| !options.is_plain).and_then(carried::from_text) {
        let shown = shown_by(&exact, shader.node.tag_name().name()).map(|shown| Surface {
            textures: surface.textures,
            normal_strength: surface.normal_strength,
            coat_normal_strength: surface.coat_normal_strength,
            ..shown
        });
        let mut textures = surface.user_textures.iter();
        let has_all = textures.all(|(target, found)| {
            let own = exact.user_textures.get(target);
            own.is_some_and(|own| std::iter::zip(own.picture_from_uv(), found.picture_from_uv()).all(are_near))
        });
        if has_all && shown.is_some_and(|shown| is_near(&shown, surface)) {
            // The copies lie beside the file, wherever that is now.
            for (target, texture) in surface.user_textures.iter() {
                if let Some(own) = exact.user_textures.get_mut(target)
                    && !own.file.starts_with(SHIPPED)
                {
                    own.file.clone_from(&texture.file);
                }
            }
            return (exact, Vec::new());
        }
        losses.push(Entry::dropped(
            "the exact parameters",
            "the file was changed since it was exported",
        ));
    }
    let mut material = surface.clone().with_lobe(options.lobe, 1.0);
    let varies = |target| surface.user_textures.get(target).is_some();
    if varies(TextureTarget::CoatRoughness) {
        // The texture is meant for GGX.
        material.set_coat_ggx_roughness(surface.coat_roughness, ImportLobe::Ggx);
    }
    if reflects_exactly(shader.node) && (material.metalness < 1.0 || varies(TextureTarget::Metalness)) {
        material.fresnel = Fresnel::Dielectric;
    }
    (material, losses)
}

/// Whether a surface's dielectric reflects by the exact equations; the others' by Schlick's approximation.
fn reflects_exactly(shader: Node<'_, '_>) -> bool {
    let exact = ["open_pbr_surface", "standard_surface", "disney_principled"];
    exact.iter().any(|kind| shader.has_tag_name(*kind))
}

/// What a surface of this kind would show into which a material is written.
fn shown_by(material: &MaterialSettings, kind: &str) -> Option<Surface> {
    let form = match kind {
        "standard_surface" => STANDARD_SURFACE,
        "UsdPreviewSurface" => PREVIEW_SURFACE,
        _ => OPEN_PBR,
    };
    // Of textures the factors are compared.
    let nodes = form.nodes(&Surface::of(material).0, "surface", &[]);
    let text = format!(
        "<materialx colorspace=\"lin_rec709\">{}</materialx>",
        nodes.iter().map(network::Node::element).collect::<String>()
    );
    let document = Document::parse(&text).ok()?;
    let shader = shaders(document.root_element()).into_iter().next()?;
    let (nowhere, loading) = (Path::new(""), Loading::default());
    let images = Images::in_folder(nowhere, &loading);
    let (surface, _) = read_surface(&shader, &images).ok()?;
    Some(surface)
}

/// Whether two surfaces are the same but for the digits that other programs write.
fn is_near(a: &Surface, b: &Surface) -> bool {
    let is_same = |parameter: &Parameter| match (parameter.rgb(a), parameter.rgb(b)) {
        (Some(a), Some(b)) => std::iter::zip(a, b).all(are_near),
        _ => parameter.get(a) == parameter.get(b),
    };
    PARAMETERS.iter().all(is_same)
}

fn are_near((a, b): (f32, f32)) -> bool {
    (a - b).abs() <= 0.0001 * (1.0 + a.abs())
}

fn read_surface(shader: &Shader<'_>, images: &Images<'_>) -> Result<(Surface, Vec<Entry>), String> {
    let named = shader.material.unwrap_or(shader.node);
    let name = named
        .attribute("uiname")
        .or(named.attribute("name"))
        .unwrap_or("material");
    let node = shader.node.tag_name().name();
    let kind = SurfaceKind::named(node).ok_or_else(|| format!("{name} is a {node}"))?;
    let mut inputs = kind.unset();
    let (turn_deg, textures) = read_inputs(shader, images, &mut inputs);
    inputs
        .losses
        .extend(shader.maker.into_iter().flat_map(others_of_material));
    let (mut surface, losses) = kind.surface(inputs);
    surface.name = name.to_owned();
    surface.rotation_deg += turn_deg;
    for (target, texture, strength) in textures {
        match target {
            TextureTarget::Normal => surface.normal_strength = strength,
            TextureTarget::CoatNormal => surface.coat_normal_strength = strength,
            _ => {}
        }
        surface.user_textures.set(target, Some(texture));
        surface.textures[target] = true;
    }
    Ok((surface, losses))
}

/// What a material has besides its surface: a back, a displacement.
fn others_of_material<'a>(material: Node<'a, 'a>) -> impl Iterator<Item = Entry> + 'a {
    let inputs = material.children().filter(|node| node.has_tag_name("input"));
    let names = inputs.filter_map(|input| input.attribute("name"));
    let others = names.filter(|name| *name != "surfaceshader");
    others.map(|name| Entry::dropped(name, "of a material its surface alone is read"))
}

/// Fills in the inputs that have a value, in any way, and gives the turn of the tangent in degrees and the textures.
fn read_inputs(
    shader: &Shader<'_>,
    images: &Images<'_>,
    inputs: &mut Inputs,
) -> (f32, Vec<(TextureTarget, UserTexture, f32)>) {
    let (mut turn_deg, mut textures) = (0.0, Vec::new());
    for input in shader.node.children().filter(|node| node.has_tag_name("input")) {
        let Some(name) = input.attribute("name") else { continue };
        let row = inputs.row(name);
        if let Some(direction) = row.filter(|row| row.default.is_empty()) {
            if let Some((found, normals)) = normal_map(input, shader, images) {
                let told = |note| Entry::approximated(name, note, None);
                inputs.losses.extend(found.notes.into_iter().map(told));
                textures.push(normals);
                continue;
            }
            let is_connected = ["nodegraph", "nodename", "interfacename"]
                .iter()
                .any(|by| input.has_attribute(*by));
            match (direction.goes, source_of(input).and_then(|source| turn_of(source.node))) {
                (Goes::Nowhere(why), _) if is_connected => inputs.losses.push(Entry::dropped(name, why)),
                (Goes::To(_), Some(turn)) => turn_deg = turn,
                _ if is_connected => inputs.losses.push(Entry::dropped(name, "what a graph computes")),
                _ => {}
            }
            continue;
        }
        match worth(input, &shader.within, images) {
            Ok(Some(found)) => {
                let mut value = found.color();
                for note in &found.notes {
                    inputs.losses.push(Entry::approximated(name, note, None));
                }
                if let Some(unit) = &found.unit {
                    match row.and_then(|row| units::factor(unit, row)) {
                        Some(factor) => value = value.map(|x| x * factor),
                        None => {
                            let detail = format!("the unit {unit} is not known; the number is taken as it is");
                            inputs.losses.push(Entry::approximated(name, detail, None));
                        }
                    }
                }
                // One channel as a colour is its mean.
                let is_whole = |texture: &UserTexture| texture.channel == TextureChannel::Auto;
                let opacity = (name == "opacity" && is_presence(shader.node)).then_some(TextureTarget::Opacity);
                let target = row.and_then(target_of).or(opacity);
                let is_taken = |(texture, _): &(UserTexture, _)| {
                    is_whole(texture) || target.is_some_and(|target| !target.is_color())
                };
                if let (Some(target), Some((mut texture, factor))) = (target, found.as_texture().filter(is_taken)) {
                    if target.is_number() && is_whole(&texture) {
                        texture.channel = TextureChannel::Red;
                    }
                    inputs.set(name, factor);
                    textures.push((target, texture, 1.0));
                    continue;
                }
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
                inputs.set(name, value);
            }
            Ok(None) => {}
            Err(Unknown::Computed(kind)) => {
                let detail = format!("what a graph computes ({kind})");
                inputs.losses.push(Entry::dropped(name, detail));
            }
            Err(Unknown::Missing(what)) => inputs.losses.push(Entry::dropped(name, what)),
        }
    }
    (turn_deg, textures)
}

/// Whether what the opacity of a UsdPreviewSurface does not stop goes straight through.
fn is_presence(surface: Node<'_, '_>) -> bool {
    let mode = child(surface, "opacityMode").and_then(|input| input.attribute("value"));
    matches!(mode, Some("presence" | "1"))
}

/// An input for normals: what is said of it, and what its image bends, and how steeply.
fn normal_map<'a>(
    input: Node<'a, 'a>,
    shader: &Shader<'a>,
    images: &Images<'_>,
) -> Option<(Worth, (TextureTarget, UserTexture, f32))> {
    let target = normal_target(input.attribute("name")?)?;
    let node = source_of(input)?.node;
    let (place, strength) = match node.tag_name().name() {
        "normalmap" => (
            child(node, "in")?,
            child(node, "scale").and_then(|input| input.attribute("value")),
        ),
        "UsdUVTexture" => (input, None),
        _ => return None,
    };
    let strength = strength.map_or(Some(1.0), |text| text.trim().parse().ok())?;
    let found = worth(place, &shader.within, images).ok()??;
    let (texture, steepness) = found.as_normals(place != input)?;
    Some((found, (target, texture, steepness * strength)))
}

/// What an input for normals bends.
pub fn normal_target(name: &str) -> Option<TextureTarget> {
    Some(match name {
        "normal" | "geometry_normal" => TextureTarget::Normal,
        "coat_normal" | "geometry_coat_normal" | "clearcoat_normal" => TextureTarget::CoatNormal,
        _ => return None,
    })
}

/// What an image on an input varies here.
pub fn target_of(row: &FileParameter) -> Option<TextureTarget> {
    let target = TextureTarget::of_key(row.keys()[0], "").filter(|_| row.per == 1.0)?;
    // An opacity that holds in one mode alone is a number, as is what has another scale or is an opacity too.
    let is_number = target == TextureTarget::Opacity && !row.layer.is_empty();
    let is_converted = row.range == Some([0.0, 0.5]) || row.keys()[1].contains("geometry.");
    (!is_number && !is_converted).then_some(target)
}

/// The turn of a tangent by a node `rotate3d`, degrees.
fn turn_of(source: Node<'_, '_>) -> Option<f32> {
    let turn = source
        .has_tag_name("rotate3d")
        .then(|| child(source, "amount"))
        .flatten()?;
    turn.attribute("value")?.trim().parse().ok()
}
