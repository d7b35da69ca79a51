//! Documents of MaterialX, read: the surfaces of several models with one value for each input. Images are taken by their mean.
//! What a graph computes is computed ([`super::graph`]) or baked ([`super::bake`]), else named in the report.

use std::path::Path;

use roxmltree::{Document, Node};

use super::bake::Baker;
use super::graph::{Unknown, child, shaders, source_of, worth};
use super::images::Images;
use super::include::whole_text;
use super::inputs::Inputs;
use super::surfaces::SurfaceKind;
use super::{CARRIER, write};
use crate::document::{MaterialSettings, PARAMETERS, Parameter};
use crate::import::Goes;
use crate::optics::fresnel::Fresnel;
use crate::scene::Loading;
use crate::store::exchange::report::Entry;
use crate::store::exchange::surface::Surface;
use crate::store::exchange::{ExchangeError, ReadOptions, Subject, carried, xml};

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
    let root = document.root_element();
    if !root.has_tag_name("materialx") {
        return Err(wrong("it has no <materialx>".to_owned()));
    }
    let mut subject = Subject::default();
    let mut refused = Vec::new();
    let mut baker = Baker::of(path);
    let images = Images::in_folder(path.parent().unwrap_or(Path::new(".")), &options.loading);
    for (shader, material) in shaders(root) {
        match read_surface(shader, material, &images, &mut baker) {
            Ok((surface, losses)) => {
                let (material, losses) = exact_or_shown(&surface, losses, material, shader, &options);
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
    let mut material = surface.clone().with_lobe(options.lobe, 1.0);
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
    let written = write(&Subject::of(material.clone()), is_standard).ok()?;
    let text = String::from_utf8(written.bytes).ok()?;
    let document = Document::parse(&text).ok()?;
    let (shader, material) = shaders(document.root_element()).into_iter().next()?;
    let (nowhere, loading) = (Path::new(""), Loading::default());
    let images = Images::in_folder(nowhere, &loading);
    let (surface, _) = read_surface(shader, material, &images, &mut Baker::of(nowhere)).ok()?;
    Some(surface)
}

/// Whether two surfaces are the same but for the digits that other programs write.
fn is_near(a: &Surface, b: &Surface) -> bool {
    let near = |a: f32, b: f32| (a - b).abs() <= 1e-4 * (1.0 + a.abs());
    let are_near = |parameter: &Parameter| match (parameter.rgb(a), parameter.rgb(b)) {
        (Some(a), Some(b)) => (0..3).all(|i| near(a[i], b[i])),
        _ => parameter.get(a) == parameter.get(b),
    };
    PARAMETERS.iter().all(are_near)
}

fn read_surface(
    shader: Node<'_, '_>,
    material: Option<Node<'_, '_>>,
    images: &Images<'_>,
    baker: &mut Baker<'_>,
) -> Result<(Surface, Vec<Entry>), String> {
    let named = material.unwrap_or(shader);
    let own_name = named.attribute("name").unwrap_or("material");
    let name = named.attribute("uiname").unwrap_or(own_name);
    let node = shader.tag_name().name();
    let kind = SurfaceKind::named(node).ok_or_else(|| format!("{name} is a {node}"))?;
    let mut inputs = kind.unset();
    let turn_deg = read_inputs(shader, images, &mut inputs, &mut |input| baker.mean(own_name, input));
    inputs.losses.extend(material.into_iter().flat_map(others_of_material));
    let (mut surface, losses) = kind.surface(inputs);
    surface.name = name.to_owned();
    surface.rotation_deg += turn_deg;
    Ok((surface, losses))
}

/// What a material has besides its surface: a back, a displacement.
fn others_of_material<'a>(material: Node<'a, 'a>) -> impl Iterator<Item = Entry> + 'a {
    let inputs = material.children().filter(|node| node.has_tag_name("input"));
    let names = inputs.filter_map(|input| input.attribute("name"));
    let others = names.filter(|name| *name != "surfaceshader");
    others.map(|name| Entry::dropped(name, "of a material its surface alone is read"))
}

/// Fills in the inputs that have a value, in any way, and gives the turn of the tangent in degrees. `baked` is asked for
/// what is not computed here.
fn read_inputs(
    shader: Node<'_, '_>,
    images: &Images<'_>,
    inputs: &mut Inputs,
    baked: &mut dyn FnMut(&str) -> Result<[f32; 3], String>,
) -> f32 {
    let mut turn_deg = 0.0;
    for input in shader.children().filter(|node| node.has_tag_name("input")) {
        let Some(name) = input.attribute("name") else { continue };
        if let Some(direction) = inputs.row(name).filter(|row| row.default.is_empty()) {
            match (direction.goes, source_of(input)) {
                (_, None) => {}
                (Goes::Nowhere(why), Some(_)) => inputs.losses.push(Entry::dropped(name, why)),
                (_, Some(source)) => match turn_of(source.node) {
                    Some(turn) => turn_deg = turn,
                    None => inputs.losses.push(Entry::dropped(name, "what a graph computes")),
                },
            }
            continue;
        }
        match worth(input, images) {
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
                inputs.set(name, found.color());
            }
            Ok(None) => {}
            Err(Unknown::Computed(kind)) => match baked(name) {
                Ok(mean) => {
                    let detail = format!("what a graph computes ({kind}): its mean, baked by MaterialX");
                    inputs.losses.push(Entry::approximated(name, detail, None));
                    inputs.set(name, mean);
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
fn turn_of(source: Node<'_, '_>) -> Option<f32> {
    let turn = source
        .has_tag_name("rotate3d")
        .then(|| child(source, "amount"))
        .flatten()?;
    turn.attribute("value")?.trim().parse().ok()
}
