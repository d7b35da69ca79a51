//! Conversion of the specular-glossiness workflow to metallic-roughness.
//!
//! Source: Khronos, KHR_materials_pbrSpecularGlossiness, "conversion between the workflows". The metalness is chosen so that
//! both have the same brightness of diffuse and specular reflection, with dielectrics at 4 %.

use crate::{
    optics::tone::{linear_from_srgb, srgb_from_linear},
    optics::vector::{Vec3, vec3},
    scene::Texture,
};

/// Reflectance of dielectrics at normal incidence.
pub const DIELECTRIC: f64 = 0.04;
/// Below this share a quotient would be noise.
const EPSILON: f64 = 1e-6;

/// Factors of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors {
    pub diffuse: [f32; 4],
    pub specular: [f32; 3],
    pub glossiness: f32,
}

/// The same in the other workflow, linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Converted {
    pub base_color: [f32; 3],
    pub metalness: f32,
    pub roughness: f32,
}

/// Brightness as the eye has it (HSP model), which the conversion compares.
fn brightness(color: Vec3<f64>) -> f64 {
    (color * color).dot(vec3(0.299, 0.587, 0.114)).sqrt()
}

/// The metalness at which diffuse and specular reflection have these brightnesses.
fn metalness(diffuse: f64, specular: f64, strongest: f64) -> f64 {
    if specular < DIELECTRIC {
        return 0.0;
    }
    let b = diffuse * (1.0 - strongest) / (1.0 - DIELECTRIC) + specular - 2.0 * DIELECTRIC;
    let c = DIELECTRIC - specular;
    let root = (b * b - 4.0 * DIELECTRIC * c).max(0.0).sqrt();
    ((root - b) / (2.0 * DIELECTRIC)).clamp(0.0, 1.0)
}

/// Converts linear colours.
pub fn convert(diffuse: [f32; 3], specular: [f32; 3], glossiness: f32) -> Converted {
    let diffuse = Vec3::<f64>::from_f32(diffuse);
    let specular = Vec3::<f64>::from_f32(specular);
    let strongest = specular.x.max(specular.y).max(specular.z);
    let metalness = metalness(brightness(diffuse), brightness(specular), strongest);
    let as_dielectric = diffuse * ((1.0 - strongest) / (1.0 - DIELECTRIC) / (1.0 - metalness).max(EPSILON));
    let as_metal = (specular - Vec3::splat(DIELECTRIC * (1.0 - metalness))) * metalness.max(EPSILON).recip();
    let color = as_dielectric.mix(as_metal, metalness * metalness);
    Converted {
        base_color: color.to_f64().map(|x| x.clamp(0.0, 1.0) as f32),
        metalness: metalness as f32,
        roughness: (1.0 - glossiness).clamp(0.0, 1.0),
    }
}

/// The textures of base colour (with opacity) and of metalness and roughness, of the larger of both sizes.
pub fn convert_textures(
    name: &str,
    factors: Factors,
    diffuse: Option<&Texture>,
    specular: Option<&Texture>,
) -> [Texture; 2] {
    let sizes = [diffuse, specular].into_iter().flatten();
    let [width, height] = sizes.fold([1, 1], |[w, h], texture| [w.max(texture.width), h.max(texture.height)]);
    let empty = |what: &str| Texture {
        name: format!("{name} ({what})"),
        width,
        height,
        rgba8: Vec::with_capacity(4 * width as usize * height as usize),
        rgba16: Vec::new(),
    };
    let mut color = empty("base colour");
    let mut surface = empty("metalness and roughness");
    let code = |value: f64| (255.0 * value).round().clamp(0.0, 255.0) as u8;
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let texel = |texture: Option<&Texture>| {
            let texture = texture?;
            let (column, row) = (x * texture.width / width, y * texture.height / height);
            let place = 4 * (row * texture.width + column) as usize;
            let [r, g, b, a] = [0, 1, 2, 3].map(|channel| f64::from(texture.rgba8[place + channel]) / 255.0);
            Some((linear_from_srgb(vec3(r, g, b)).to_f64(), a))
        };
        let (diffuse_color, opacity) = texel(diffuse).unwrap_or(([1.0; 3], 1.0));
        let (specular_color, glossiness) = texel(specular).unwrap_or(([1.0; 3], 1.0));
        let times = |color: [f64; 3], factor: [f32; 3]| [0, 1, 2].map(|i| color[i] as f32 * factor[i]);
        let [r, g, b, a] = factors.diffuse;
        let converted = convert(
            times(diffuse_color, [r, g, b]),
            times(specular_color, factors.specular),
            glossiness as f32 * factors.glossiness,
        );
        let encoded = srgb_from_linear(Vec3::<f64>::from_f32(converted.base_color)).to_f64();
        color.rgba8.extend(encoded.map(code));
        color.rgba8.push(code(opacity * f64::from(a)));
        let [roughness, metalness] = [converted.roughness, converted.metalness].map(|x| code(f64::from(x)));
        surface.rgba8.extend([255, roughness, metalness, 255]);
    }
    [color, surface]
}
