//! What a lens does to an image before it is shown: glare and vignette. The render itself is left alone.

use crate::{document::ViewSettings, job::film::Image, parallel};

/// The widest glow as a share of the image's shorter side, and how many there are, each half as wide as the one before.
const WIDEST: f64 = 0.25;
const GLOWS: u32 = 5;

/// The image with the view's glare and vignette; `None` where both are off.
pub fn applied(image: &Image, view: &ViewSettings) -> Option<Image> {
    let (has_glare, has_vignette) = (view.glare > 0.0, view.vignette > 0.0);
    if !has_glare && !has_vignette {
        return None;
    }
    let mut result = image.clone();
    if has_glare {
        add_glare(&mut result, view.glare.min(1.0));
    }
    if has_vignette {
        darken_corners(&mut result, view.vignette);
    }
    Some(result)
}

/// Spreads a share of each pixel's light over glows of several widths; within the image none of it is lost.
fn add_glare(image: &mut Image, share: f32) {
    let [width, height] = [image.width as usize, image.height as usize];
    let shorter = width.min(height) as f64;
    let radii = (0..GLOWS).map(|glow| (WIDEST * shorter * 0.5_f64.powi(glow as i32 + 1)).round() as usize);
    let radii: Vec<usize> = radii.filter(|radius| *radius > 0).collect();
    if radii.is_empty() {
        return;
    }
    let weight = share / radii.len() as f32;
    let sharp = image.pixels.clone();
    for pixel in &mut image.pixels {
        *pixel = scaled(*pixel, 1.0 - share);
    }
    for radius in radii {
        // Two passes of a box each way are near a bell.
        let mut glow = sharp.clone();
        for _ in 0..2 {
            glow = transposed_box(&glow, width, radius);
            glow = transposed_box(&glow, height, radius);
        }
        for (pixel, glow) in image.pixels.iter_mut().zip(&glow) {
            *pixel = std::array::from_fn(|i| pixel[i] + weight * glow[i]);
        }
    }
}

fn scaled(pixel: [f32; 4], by: f32) -> [f32; 4] {
    pixel.map(|x| by * x)
}

/// The mean over boxes of 2 · `radius` + 1 pixels along the rows of `width` pixels, transposed: twice gives both ways. At an
/// end the box is mirrored, so that the sum over a row stays.
fn transposed_box(pixels: &[[f32; 4]], width: usize, radius: usize) -> Vec<[f32; 4]> {
    let height = pixels.len() / width.max(1);
    let blurred = parallel::map(height, |row| box_mean(&pixels[row * width..][..width], radius));
    (0..width)
        .flat_map(|x| (0..height).map(move |y| (x, y)))
        .map(|(x, y)| blurred[y][x])
        .collect()
}

fn box_mean(row: &[[f32; 4]], radius: usize) -> Vec<[f32; 4]> {
    let count = row.len() as isize;
    let at = |x: isize| {
        // Mirrored about the ends as often as it takes.
        let place = x.rem_euclid(2 * count);
        row[place.min(2 * count - 1 - place) as usize].map(f64::from)
    };
    let radius = radius as isize;
    let norm = 1.0 / (2 * radius + 1) as f64;
    let mut sum = [0.0; 4];
    for x in -radius..=radius {
        sum = add(sum, at(x), 1.0);
    }
    let mut means = Vec::with_capacity(row.len());
    for x in 0..count {
        means.push(sum.map(|value| (norm * value).max(0.0) as f32));
        sum = add(add(sum, at(x + radius + 1), 1.0), at(x - radius), -1.0);
    }
    means
}

fn add(a: [f64; 4], b: [f64; 4], sign: f64) -> [f64; 4] {
    std::array::from_fn(|i| a[i] + sign * b[i])
}

/// Less light towards the corners by cos⁴ of the angle to the axis, whose tangent's square is `strength` there.
fn darken_corners(image: &mut Image, strength: f32) {
    let [width, height] = [image.width as f32, image.height as f32];
    let diagonal = 0.25 * (width * width + height * height);
    let columns = image.width as usize;
    parallel::for_rows(&mut image.pixels, columns, |y, row| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let [dx, dy] = [x as f32 + 0.5 - 0.5 * width, y as f32 + 0.5 - 0.5 * height];
            let tangent = 1.0 + strength * (dx * dx + dy * dy) / diagonal;
            let [r, g, b, alpha] = *pixel;
            let kept = 1.0 / (tangent * tangent);
            *pixel = [kept * r, kept * g, kept * b, alpha];
        }
    });
}
