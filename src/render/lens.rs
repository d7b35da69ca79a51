//! What a lens does to an image before it is shown: glare and vignette. The render itself is left alone.

use crate::document::ViewSettings;
use crate::job::film::Image;
use crate::parallel;

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
    let column = |x: usize| (0..height).map(move |y| (x, y));
    (0..width).flat_map(column).map(|(x, y)| blurred[y][x]).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    /// One bright pixel amid nothing.
    fn spark(width: u32, height: u32) -> Image {
        let mut pixels = vec![[0.0, 0.0, 0.0, 1.0]; (width * height) as usize];
        pixels[(height / 2 * width + width / 3) as usize] = [90.0, 60.0, 30.0, 1.0];
        Image { width, height, pixels }
    }

    fn view(glare: f32, vignette: f32) -> ViewSettings {
        ViewSettings {
            glare,
            vignette,
            ..ViewSettings::default()
        }
    }

    fn light(image: &Image) -> f64 {
        image.pixels.iter().map(|pixel| f64::from(pixel[0])).sum()
    }

    #[test]
    fn a_lens_without_faults_is_left_out() {
        assert!(applied(&spark(9, 7), &view(0.0, 0.0)).is_none());
    }

    /// A share of the light moves, none is made or lost, and it falls off with the distance.
    #[test]
    fn glare_spreads_light_and_keeps_it() {
        let sharp = spark(64, 48);
        let glowing = applied(&sharp, &view(0.3, 0.0)).expect("it is on");
        assert!(
            (light(&glowing) / light(&sharp) - 1.0).abs() < 1e-4,
            "{}",
            light(&glowing)
        );
        let at = |x: usize, y: usize| glowing.pixels[y * 64 + x][0];
        let [middle, near, far] = [at(21, 24), at(24, 24), at(30, 24)];
        assert!(middle > 0.7 * 90.0 && middle < 0.8 * 90.0, "{middle}");
        assert!(near > far && far > 0.0, "{near} and {far}");
        assert!(
            glowing.pixels.iter().all(|pixel| (pixel[3] - 1.0).abs() < 1e-4),
            "alpha"
        );
        // An image of one tone has nothing to spread.
        let even = Image {
            width: 31,
            height: 17,
            pixels: vec![[0.4, 0.3, 0.2, 1.0]; 31 * 17],
        };
        let same = applied(&even, &view(0.5, 0.0)).expect("it is on");
        assert!(same.pixels.iter().all(|pixel| (pixel[0] - 0.4).abs() < 1e-5));
    }

    #[test]
    fn the_corners_keep_what_the_vignette_says() {
        let even = Image {
            width: 101,
            height: 101,
            pixels: vec![[1.0; 4]; 101 * 101],
        };
        let dark = applied(&even, &view(0.0, 1.0)).expect("it is on");
        let at = |x: usize, y: usize| dark.pixels[y * 101 + x];
        assert_eq!(at(50, 50), [1.0; 4]);
        let corner = at(0, 0);
        assert!((corner[0] - 0.25).abs() < 0.01 && corner[3] == 1.0, "{corner:?}");
    }
}
