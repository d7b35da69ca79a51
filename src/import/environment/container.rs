//! Environments in the containers of GPUs, KTX2 and DDS: cube maps and panoramas.

use super::canvas::Canvas;
use super::decoded::{Picture, Source};
use super::display_referred::Codes;
use super::error::EnvironmentError;
use crate::picture::gpu::{self, Face, Refusal, Texels};
use crate::scene::environment::MAX_WIDTH;

/// The longest side of a cube's face that is of use: four of them are as wide as the widest map.
const FACE_MAX: u32 = MAX_WIDTH / 4;

/// Reads a cube as a strip of its six faces, a flat image unchanged.
pub(super) fn read(source: Source<'_>) -> Result<Picture, EnvironmentError> {
    let path = source.path;
    let bytes = source.bytes()?;
    if !gpu::is_container(&bytes) {
        return Err(EnvironmentError::WrongContent {
            path: path.to_owned(),
            expected: "a KTX2 or DDS",
        });
    }
    source.check_decoding(&bytes)?;
    source.loading.step("decoding texels")?;
    let faces = gpu::decode(&bytes, [MAX_WIDTH, FACE_MAX]);
    let faces = faces.map_err(|refusal| {
        let path = path.to_owned();
        match refusal {
            Refusal::Damaged(detail) => EnvironmentError::Damaged { path, detail },
            Refusal::NotRead(feature) => EnvironmentError::Unsupported {
                path,
                feature,
                remedy: "save it with floats, halves, 8 bits a channel or BC6H",
            },
        }
    })?;
    let codes = Codes::new(source.encoding);
    if let [picture] = faces.as_slice() {
        let mut canvas = Canvas::new(source, picture.width.into(), picture.height.into())?;
        for (place, color) in (0..).zip(colors(picture, &codes)) {
            canvas.add_color(place % picture.width, place / picture.width, color);
        }
        return Ok(with_warning(canvas.finish(), picture, &codes));
    }
    let first = &faces[0];
    let texels = faces.iter().flat_map(|face| colors(face, &codes));
    let strip = Picture {
        width: first.width,
        height: 6 * first.height,
        texels: texels.map(|[r, g, b]| [r, g, b, 1.0]).collect(),
        warnings: Vec::new(),
        is_cube: false,
    };
    Ok(with_warning(strip, first, &codes))
}

fn with_warning(mut picture: Picture, face: &Face, codes: &Codes) -> Picture {
    if matches!(face.texels, Texels::Codes(_)) {
        picture.warnings.extend(codes.warning());
    }
    picture
}

/// Linear colours, row by row.
fn colors<'a>(face: &'a Face, codes: &'a Codes) -> Box<dyn Iterator<Item = [f32; 3]> + 'a> {
    match &face.texels {
        Texels::Codes(texels) => {
            let color = |[r, g, b, _]: &[u8; 4]| [*r, *g, *b].map(|code| codes.of_8(code));
            Box::new(texels.as_chunks::<4>().0.iter().map(color))
        }
        Texels::Light(texels) => Box::new(texels.as_chunks::<4>().0.iter().map(|[r, g, b, _]| [*r, *g, *b])),
    }
}
