//! A scene for Mitsuba 3: a ball with the material in even light, its material to be taken from there.

use std::{collections::HashMap, path::Path};

use super::{
    ExchangeError, Subject, Written, carried, shown,
    surface::{Law, Surface, Takes},
    textures::{Carried, Files, carry},
    xml::{HEAD, element, escaped, identifier, numbers},
};
use crate::{
    document::MaterialSettings,
    import::{Budget, endings::has_ending, picture::read_texture},
    optics::{fresnel::Fresnel, lobe::stretch_from_anisotropy, vector::Vec3},
    scene::{Texture, texture::TextureTarget as On},
};

/// The material that stands for another one there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// `diffuse`.
    Diffuse,
    /// `roughconductor` with η and k.
    Conductor,
    /// `roughdielectric`, or `dielectric` where it is smooth.
    Glass,
    /// `principled`, Disney's.
    Principled,
}

impl Kind {
    fn of(material: &MaterialSettings) -> Self {
        let varies = |target| material.textures[target] && material.user_textures.get(target).is_some();
        let is_bare = material.coat_weight == 0.0 && !varies(On::Metalness) && !varies(On::Transmission);
        if is_bare
            && material.specular_weight == 0.0
            && material.transmission_weight == 0.0
            && material.metalness == 0.0
        {
            Self::Diffuse
        } else if is_bare && material.metalness == 1.0 && material.fresnel == Fresnel::Conductor {
            Self::Conductor
        } else if is_bare && material.metalness == 0.0 && material.transmission_weight == 1.0 {
            Self::Glass
        } else {
            Self::Principled
        }
    }

    /// The parameters that textures vary there.
    fn textured(self) -> &'static [On] {
        match self {
            Self::Diffuse => &[On::BaseColor],
            Self::Conductor => &[On::Roughness, On::Specular],
            Self::Glass => &[On::Roughness, On::Specular, On::BaseColor],
            Self::Principled => &[
                On::BaseColor,
                On::Metalness,
                On::Roughness,
                On::Transmission,
                On::Coat,
                On::CoatRoughness,
            ],
        }
    }

    fn takes(self) -> Takes {
        let is_principled = self == Self::Principled;
        Takes {
            law: if is_principled { Law::Schlick } else { Law::Exact },
            widths: if is_principled {
                Surface::disney_widths
            } else {
                Surface::widths
            },
            lacks: [
                "base.diffuse_roughness base.color_texture specular.multiple_scattering specular.weight_in_index \
                 specular.edge_tint specular.on_metal coat.ior coat.color coat.anisotropy coat.on_base coat.darkening \
                 fuzz.weight thin_film.weight thin_film.thickness transmission.depth transmission.roughness",
                match self {
                    Self::Diffuse => "specular.eta specular.weight specular.color coat.weight",
                    Self::Conductor => "specular.weight specular.color coat.weight",
                    Self::Glass => "specular.eta coat.weight",
                    Self::Principled => "specular.eta specular.weight specular.color",
                },
            ],
        }
    }
}

pub fn write(subject: &Subject, path: &Path) -> Result<Written, ExchangeError> {
    let material = subject.only(path)?;
    let kind = Kind::of(material);
    let (surface, mut report) = shown(material, &kind.takes());
    report.entries.splice(0..0, surface.rotation_loss());
    let name = identifier(&material.name, &mut HashMap::new());
    let always = [On::Normal, On::Opacity, On::Emission];
    let has_place = |target| kind.textured().contains(&target) || always.contains(&target);
    let budget = Budget::of_import();
    let textures = carry(material, &mut report, (has_place, false), |target, texture| {
        read_texture(&texture.file, target.is_color(), u32::MAX, &budget)
    });
    let files = Files::of(path);
    let mut maps = Maps { textures, files };
    let (kind_name, parameters) = match kind {
        Kind::Diffuse => ("diffuse", maps.rgb("reflectance", On::BaseColor, surface.base_color)),
        Kind::Conductor => ("roughconductor", conductor(material, &surface, &mut maps)),
        Kind::Glass => glass(&surface, &mut maps),
        Kind::Principled => ("principled", principled(&surface, &mut maps)),
    };
    let (mut head, mut inside) = (format!("bsdf type=\"{kind_name}\""), parameters);
    let mut put_into = |kind: &str, more: String| {
        inside = more + &element(&head, &inside);
        head = format!("bsdf type=\"{kind}\"");
    };
    if maps.has(On::Normal) {
        put_into("normalmap", maps.rgb("normalmap", On::Normal, [1.0; 3]));
    }
    if kind != Kind::Glass && !(kind == Kind::Principled && surface.transmission_weight > 0.0) {
        put_into("twosided", String::new());
    }
    if surface.opacity < 1.0 || maps.has(On::Opacity) {
        put_into("mask", maps.float("opacity", On::Opacity, surface.opacity, |x| x));
    }
    let bsdf = element(&format!("{head} id=\"{name}\""), &inside);
    let mut ball = format!("<ref name=\"bsdf\" id=\"{name}\" />\n{UPRIGHT}");
    if surface.emission().iter().any(|x| *x > 0.0) {
        let radiance = maps.rgb("radiance", On::Emission, surface.emission());
        ball += &element("emitter type=\"area\"", &radiance);
    }
    let ball = element("shape type=\"sphere\"", &ball);
    let inside = format!("<integrator type=\"path\" />\n{bsdf}{SENSOR}{ball}{LIGHT}");
    let scene = element("scene version=\"3.0.0\"", &inside);
    let text = format!("{HEAD}<!-- {} -->\n{scene}", carried::comment(material));
    Ok(Written {
        beside: maps.files.contents,
        ..Written::text(text, vec![report])
    })
}

/// With its pole upwards and the texture's seam in front, as the ball has it here.
const UPRIGHT: &str = r#"<transform name="to_world">
  <rotate x="1" angle="-90" />
  <rotate y="1" angle="-90" />
</transform>
"#;

const SENSOR: &str = r#"<sensor type="perspective">
  <float name="fov" value="35" />
  <transform name="to_world">
    <lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0" />
  </transform>
  <film type="hdrfilm">
    <integer name="width" value="256" />
    <integer name="height" value="256" />
  </film>
  <sampler type="independent">
    <integer name="sample_count" value="64" />
  </sampler>
</sensor>
"#;
const LIGHT: &str = r#"<emitter type="constant">
  <rgb name="radiance" value="1, 1, 1" />
</emitter>"#;
const GGX: &str = "<string name=\"distribution\" value=\"ggx\" />\n";

fn rgb(name: &str, value: [f32; 3]) -> String {
    format!("<rgb name=\"{name}\" value=\"{}\" />\n", numbers(&value))
}

fn float(name: &str, value: f32) -> String {
    format!("<float name=\"{name}\" value=\"{value}\" />\n")
}

/// The textures, each parameter's in a file of its own: the format looks them up as they are.
struct Maps<'a> {
    textures: Vec<Carried<'a, Texture>>,
    files: Files,
}

impl Maps<'_> {
    fn has(&self, target: On) -> bool {
        self.textures.iter().any(|texture| texture.target == target)
    }

    /// A number that `of` makes of a value which a texture may multiply.
    fn float(&mut self, name: &str, target: On, value: f32, of: impl Fn(f32) -> f32) -> String {
        let map = self.map(name, target, &[value], &of);
        map.unwrap_or_else(|| float(name, of(value)))
    }

    /// A colour that a texture may multiply.
    fn rgb(&mut self, name: &str, target: On, value: [f32; 3]) -> String {
        let map = self.map(name, target, &value, &|x| x);
        map.unwrap_or_else(|| rgb(name, value))
    }

    fn map(&mut self, name: &str, target: On, value: &[f32], of: &dyn Fn(f32) -> f32) -> Option<String> {
        let texture = self.textures.iter().find(|texture| texture.target == target)?;
        let copied = match is_as_it_is(texture, value, of) {
            true => self.files.copy(&texture.texture.file).ok(),
            false => None,
        };
        let is_color = target.is_color();
        let file = copied.unwrap_or_else(|| self.files.add(&format!("{name}.pfm"), pfm(texture, value, of)));
        let mut inside = format!(
            "<string name=\"filename\" value=\"{}\" />\n<boolean name=\"raw\" value=\"{}\" />\n",
            escaped(&file),
            !is_color
        );
        let [uu, uv, u1, vu, vv, v1] = texture.texture.picture_from_uv();
        if [uu, uv, u1, vu, vv, v1] != [1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
            // A map of space, of which the plane is taken: of nine numbers the offset would be lost.
            let rows = [
                [uu, uv, 0.0, u1],
                [vu, vv, 0.0, v1],
                [0.0, 0.0, 1.0, 0.0],
                [0.0, 0.0, 0.0, 1.0],
            ];
            let rows = numbers(rows.as_flattened());
            inside += &element("transform name=\"to_uv\"", &format!("<matrix value=\"{rows}\" />"));
        }
        Some(element(&format!("texture type=\"bitmap\" name=\"{name}\""), &inside))
    }
}

/// Images that the format reads.
const READ: &[&str] = &["png", "jpg", "jpeg", "bmp", "tga"];

/// Whether the file of a texture holds just the numbers that are looked up.
fn is_as_it_is(texture: &Carried<'_, Texture>, value: &[f32], of: &dyn Fn(f32) -> f32) -> bool {
    let is_plain = texture.affine(texture.steepness) == [[1.0; 3], [0.0; 3]] && value.iter().all(|x| *x == 1.0);
    let is_encoded = texture.texture.is_srgb(texture.target) == texture.target.is_color();
    let is_number = texture.target.is_number();
    let is_grey = || {
        let mut texels = texture.made.rgba8.as_chunks::<4>().0.iter();
        texels.all(|[r, g, b, _]| r == g && g == b)
    };
    is_plain
        && is_encoded
        && [0.25, 0.75].into_iter().all(|x| of(x) == x)
        && (!is_number || (texture.channel < 3 && is_grey()))
        && has_ending(&texture.texture.file, READ)
}

/// A texture with everything done to its numbers, as a portable float map: from the last row to the first, in linear light.
fn pfm(texture: &Carried<'_, Texture>, value: &[f32], of: &dyn Fn(f32) -> f32) -> Vec<u8> {
    let Texture {
        width,
        height,
        rgba8,
        rgba16,
        ..
    } = &texture.made;
    let mark = if value.len() == 1 { "Pf" } else { "PF" };
    let mut bytes = format!("{mark}\n{width} {height}\n-1.0\n").into_bytes();
    let width = *width as usize;
    for place in (0..*height as usize)
        .rev()
        .flat_map(|row| row * width..(row + 1) * width)
    {
        let texel = match rgba16.as_chunks::<4>().0.get(place) {
            Some(deep) => deep.map(|code| f64::from(code) / 65535.0),
            None => rgba8.as_chunks::<4>().0[place].map(|code| f64::from(code) / 255.0),
        };
        let found: Vec3<f64> = texture.value(texel, texture.steepness);
        let numbers = found.to_f32().into_iter().zip(value).map(|(x, value)| of(x * value));
        bytes.extend(numbers.flat_map(f32::to_le_bytes));
    }
    bytes
}

/// GGX's α along the tangent and across, of the roughness that a texture may multiply.
fn alphas(surface: &Surface, least: f32, maps: &mut Maps<'_>) -> String {
    let stretch = stretch_from_anisotropy(surface.anisotropy);
    let mut alpha =
        |name, stretch: f32| maps.float(name, On::Roughness, surface.roughness, |r| (r * r * stretch).max(least));
    GGX.to_owned() + &alpha("alpha_u", stretch) + &alpha("alpha_v", stretch.recip())
}

fn conductor(material: &MaterialSettings, surface: &Surface, maps: &mut Maps<'_>) -> String {
    let tint = material.specular_color.map(|x| x * material.specular_weight);
    [
        alphas(surface, 0.0001, maps),
        rgb("eta", material.eta),
        rgb("k", material.k),
        maps.rgb("specular_reflectance", On::Specular, tint),
    ]
    .concat()
}

fn glass(surface: &Surface, maps: &mut Maps<'_>) -> (&'static str, String) {
    let tint = surface.specular_color.map(|x| x * surface.specular_weight);
    let through = if surface.transmission_depth > 0.0 {
        [1.0; 3]
    } else {
        surface.transmission_color
    };
    let smooth = [
        float("int_ior", surface.ior.max(1.0001)),
        float("ext_ior", 1.0),
        maps.rgb("specular_reflectance", On::Specular, tint),
        maps.rgb("specular_transmittance", On::BaseColor, through),
    ]
    .concat();
    if surface.alphas()[0] < 0.001 {
        return ("dielectric", smooth);
    }
    ("roughdielectric", alphas(surface, 1e-4, maps) + &smooth)
}

fn principled(surface: &Surface, maps: &mut Maps<'_>) -> String {
    let plain = [
        ("anisotropic", surface.disney_anisotropy()),
        ("eta", surface.ior.max(1.0001)),
    ];
    let varied = [
        ("metallic", On::Metalness, surface.metalness),
        ("roughness", On::Roughness, surface.roughness),
        ("spec_trans", On::Transmission, surface.transmission_weight),
        ("clearcoat", On::Coat, surface.coat_weight),
    ];
    let mut text = maps.rgb("base_color", On::BaseColor, surface.base_color);
    text.extend(plain.map(|(name, value)| float(name, value)));
    text.extend(varied.map(|(name, target, value)| maps.float(name, target, value, |x| x)));
    text + &maps.float("clearcoat_gloss", On::CoatRoughness, surface.coat_roughness, |x| {
        1.0 - x
    })
}
