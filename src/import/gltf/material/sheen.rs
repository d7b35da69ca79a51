//! Textures of KHR_materials_sheen as those of the fuzz that looks like it ([`fuzz_of_sheen`]).

use crate::{
    optics::{layer::fuzz::fuzz_of_sheen, tone::linear_from_srgb, tone::srgb_from_linear, vector::Vec3},
    scene::Texture,
};

/// The weight, in all channels, and the colour of the fuzz that a texture of a sheen's colour gives, whose factor has this
/// tint, at most 1.
pub fn weight_and_color(sheen: &Texture, tint: [f32; 3]) -> [Texture; 2] {
    let of_fuzz = |[r, g, b, _]: [u8; 4]| {
        let codes = [r, g, b].map(|code| f64::from(code) / 255.0);
        let linear = linear_from_srgb(Vec3::<f64>::from_f64(codes)).to_f64();
        let (weight, tint, _) = fuzz_of_sheen([0, 1, 2].map(|i| tint[i] * linear[i] as f32), 0.0);
        let [r, g, b] = srgb_from_linear(Vec3::<f64>::from_f32(tint)).to_f64().map(code);
        (f64::from(weight), [r, g, b, 255])
    };
    let texels = || sheen.rgba8.as_chunks::<4>().0.iter();
    // Dark sheens are of little weight, of which eight bits would be few.
    let fine = |texel: &[u8; 4]| [(65535.0 * of_fuzz(*texel).0).round() as u16; 4];
    let weight = Texture {
        rgba16: texels().flat_map(fine).collect(),
        ..changed(sheen, "weight of the fuzz", |texel| [code(of_fuzz(texel).0); 4])
    };
    [weight, changed(sheen, "colour of the fuzz", |texel| of_fuzz(texel).1)]
}

/// The alpha that multiplies the fuzz's roughness, which is that of the sheen's factor, by the alpha of the sheen's.
pub fn roughness(sheen: &Texture, factor: f32) -> Texture {
    let of_fuzz = |root: f32| fuzz_of_sheen([1.0; 3], root).2;
    changed(sheen, "roughness of the fuzz", |[r, g, b, a]| {
        let share = of_fuzz(factor * f32::from(a) / 255.0) / of_fuzz(factor);
        [r, g, b, code(share.into())]
    })
}

fn code(share: f64) -> u8 {
    (255.0 * share).round().clamp(0.0, 255.0) as u8
}

fn changed(texture: &Texture, what: &str, change: impl Fn([u8; 4]) -> [u8; 4]) -> Texture {
    Texture {
        name: format!("{} ({what})", texture.name),
        rgba8: texture
            .rgba8
            .as_chunks::<4>()
            .0
            .iter()
            .flat_map(|texel| change(*texel))
            .collect(),
        rgba16: Vec::new(),
        ..*texture
    }
}
