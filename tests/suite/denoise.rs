//! Denoised pictures: what they keep, what is told of them, and what happens where there is no denoiser.

use std::path::Path;

use glossmith::{
    analysis::halves::Halves,
    document::{Denoise, Document},
    job::film::{Extras, Film, Image},
    job::guides::GuideSums,
    render::EngineChoice,
    render::denoise::{Denoised, Denoiser, Noisy, fetch::fetch_into},
    scene::ModelSource,
};

use super::{
    cli_support::Workplace,
    cli_support::read_exr,
    renders::{adjust, render},
    support::Random,
};

fn denoiser() -> Denoiser {
    Denoiser::open().unwrap_or_else(|error| panic!("{error}"))
}

/// A film of some samples per pixel: `seen` gives a pixel's albedo and true colour, which the samples scatter around by
/// `noise` times themselves.
fn film(size: [u32; 2], samples: u32, noise: f32, seen: impl Fn(u32, u32) -> [[f32; 3]; 2]) -> Film {
    let extras = Extras {
        guides: 2,
        ..Extras::default()
    };
    let mut film = Film::keeping(size[0], size[1], extras);
    let mut random = Random::new(5);
    for pixel in 0..(size[0] * size[1]) as usize {
        let [albedo, color] = seen(pixel as u32 % size[0], pixel as u32 / size[0]);
        for sample in 0..samples {
            let factor = 1.0 + noise * (2.0 * random.unit() - 1.0);
            let [r, g, b] = color.map(|x| f64::from(factor * x));
            film.add(pixel, sample, [r, g, b, 1.0]);
            let seen = GuideSums {
                albedo,
                hits: 1.0,
                normal: [0.0, 0.0, 1.0],
                depth: 1.0,
            };
            film.add_guides(pixel, sample as usize, &seen);
        }
    }
    film
}

fn denoised(film: &Film, how: Denoise) -> Denoised {
    denoiser().denoise(&Noisy::of(film, None), how).unwrap()
}

fn brightest(image: &Image) -> f32 {
    image
        .pixels
        .iter()
        .flat_map(|pixel| pixel[..3].to_vec())
        .fold(0.0, f32::max)
}

#[test]
fn one_colour_black_and_one_pixel_stay_what_they_are() {
    let grey = denoised(&film([32, 24], 2, 0.0, |_, _| [[0.5; 3], [0.25; 3]]), Denoise::High);
    let mean = grey.image.luminance().iter().sum::<f64>() / f64::from(32 * 24);
    near!(mean / 0.25, 1.0, 0.01);
    for pixel in &grey.image.pixels {
        assert!(pixel[..3].iter().all(|x| (x - 0.25).abs() < 0.02), "{pixel:?}");
    }
    let estimate = grey.error.unwrap();
    assert!(estimate.value < 0.05, "{estimate:?}");
    let black = denoised(&film([16, 16], 2, 0.0, |_, _| [[0.0; 3]; 2]), Denoise::Auto);
    assert!(brightest(&black.image) < 0.0001);
    assert!(black.error.unwrap().value.is_finite());
    let one = Noisy::of(&film([1, 1], 4, 0.0, |_, _| [[0.5; 3], [2.0; 3]]), None).as_one();
    let one = denoiser().denoise(&one, Denoise::Fast).unwrap();
    near!(one.image.pixels[0][0], 2.0, 0.5);
    assert!(one.error.is_none());
    // Nothing has been rendered: nothing is done.
    let empty = denoised(&Film::new(4, 4), Denoise::High);
    assert_eq!((brightest(&empty.image), empty.error), (0.0, None));
}

/// The library smears such a sun's light over the dark around it; what is kept is that the numbers stay sound and the sun
/// where it is.
#[test]
fn a_sun_in_one_pixel_is_no_trouble() {
    let sunny = film([48, 48], 4, 0.3, |x, y| {
        let color = if (x, y) == (24, 24) { 1e6 } else { 0.2 };
        [[0.5; 3], [color; 3]]
    });
    for how in [Denoise::High, Denoise::Auto] {
        let done = denoised(&sunny, how);
        assert!(done.image.pixels.iter().flatten().all(|x| x.is_finite() && *x >= 0.0));
        let luminances = done.image.luminance();
        let brightest = (0..luminances.len()).max_by(|a, b| luminances[*a].total_cmp(&luminances[*b]));
        assert_eq!(brightest, Some(24 * 48 + 24));
        assert!(done.error.unwrap().high.is_finite());
    }
}

/// Grey of a checker of squares of this side.
fn checker(side: u32, x: u32, y: u32) -> f32 {
    if (x / side + y / side).is_multiple_of(2) {
        0.8
    } else {
        0.2
    }
}

/// Root mean square difference from a checker of 64 × 64 pixels.
fn checker_error(image: &Image, side: u32) -> f64 {
    let squares = image.pixels.iter().enumerate().map(|(pixel, color)| {
        let truth = checker(side, pixel as u32 % 64, pixel as u32 / 64);
        f64::from(color[0] - truth).powi(2)
    });
    (squares.sum::<f64>() / image.pixels.len() as f64).sqrt()
}

/// A checker of 4 × 4 pixels under 50 % of noise stays, because the albedo shows it. One of single pixels the library
/// takes for noise: the told error says so, and the mixture has the samples instead.
#[test]
fn a_fine_texture_is_not_eaten_or_the_error_says_so() {
    let textured = |side: u32, samples: u32| film([64, 64], samples, 0.5, |x, y| [[checker(side, x, y); 3]; 2]);
    let coarse = textured(4, 4);
    let done = denoised(&coarse, Denoise::High);
    let (clean, noisy) = (checker_error(&done.image, 4), checker_error(&coarse.image(), 4));
    // Nearer to the truth than the samples beyond doubt: by three standard errors of a root mean square over so many pixels.
    let doubt = 3.0 / (2.0 * coarse.pixel_count() as f64).sqrt();
    assert!(clean < (1.0 - doubt) * noisy, "{clean} {noisy}");
    for samples in [4, 16, 64, 256] {
        let fine = textured(1, samples);
        let [high, auto] = [Denoise::High, Denoise::Auto].map(|how| denoised(&fine, how));
        let eaten = checker_error(&high.image, 1);
        // Over the mean luminance of 0.5.
        let estimate = 0.5 * high.error.unwrap().value;
        near!(estimate / eaten, 1.0, 0.2, "{samples}");
        let (kept, noisy) = (checker_error(&auto.image, 1), checker_error(&fine.image(), 1));
        println!("{samples} samples: noise {noisy:.4}, eaten {eaten:.4}, mixed {kept:.4}");
        assert!(kept < 1.02 * noisy, "{samples}: {kept} {noisy} {eaten}");
    }
}

#[test]
fn a_picture_in_bands_has_no_seams() {
    let size = [64, 900];
    let ramp = film(size, 2, 0.6, |x, y| [[0.5; 3], [0.1 + 0.002 * (x + y) as f32; 3]]);
    let noisy = Noisy::of(&ramp, None);
    let whole = denoiser().denoise(&noisy, Denoise::High).unwrap().image;
    let banded = denoiser()
        .in_bands_of(64 * 600)
        .denoise(&noisy, Denoise::High)
        .unwrap()
        .image;
    // What the picture is wrong by, anyhow. Bands that do not overlap by what the library says change rows by more than that;
    // with it, by nothing but rounding.
    let truth = |pixel: usize| 0.1 + 0.002 * (pixel % 64 + pixel / 64) as f64;
    let rms = |squares: &mut dyn Iterator<Item = f64>| (squares.sum::<f64>() / (64.0 * 900.0)).sqrt();
    let red = |image: &Image, pixel: usize| f64::from(image.pixels[pixel][0]);
    let error = rms(&mut (0..64 * 900).map(|pixel| (red(&whole, pixel) - truth(pixel)).powi(2)));
    for y in 0..900 {
        let row = (64 * y..64 * (y + 1)).map(|pixel| (red(&whole, pixel) - red(&banded, pixel)).abs());
        let change = row.sum::<f64>() / 64.0;
        assert!(
            change < 0.01 * error,
            "row {y} changes by {change}, of an error of {error}"
        );
    }
}

fn studio(model: ModelSource) -> Document {
    let mut document = Document {
        model,
        ..Document::default()
    };
    adjust(&mut document, "render.width=64 render.height=64");
    document
}

/// Root mean square error over the mean luminance, the reference's own noise taken out.
fn true_error(image: &Image, reference: &Halves) -> f64 {
    reference.error_of(&image.luminance()).value
}

/// The told error of denoised pictures of twelve renders is the true one in the mean, and lies in the band; the mixture is
/// no worse than the samples nor than the denoised picture by much; both are better than the samples.
#[test]
fn the_error_told_of_a_denoised_picture_is_the_true_one() {
    const RENDERS: u32 = 12;
    let mut document = studio(ModelSource::Sphere);
    document.ground = true;
    document.view.denoise = Denoise::High;
    // Its own noise is taken out by its halves.
    adjust(&mut document, "render.samples=512 render.seed=77");
    let reference = Halves::of(&render(EngineChoice::Cpu, &document));
    document.render.samples = 16;
    let mut denoiser = denoiser();
    let (mut squares, mut inside) = ([0.0; 4], 0);
    for seed in 0..RENDERS {
        document.render.seed = seed;
        let noisy = Noisy::of(&render(EngineChoice::Cpu, &document), None);
        let high = denoiser.denoise(&noisy, Denoise::High).unwrap();
        let auto = denoiser.denoise(&noisy, Denoise::Auto).unwrap();
        let [samples, truth, mixed] =
            [&noisy.image, &high.image, &auto.image].map(|image| true_error(image, &reference));
        let estimate = high.error.unwrap();
        inside += u32::from((estimate.low..=estimate.high).contains(&truth));
        std::iter::zip(&mut squares, [samples, truth, estimate.value, mixed]).for_each(|(sum, x)| *sum += x * x);
    }
    let [samples, truth, estimate, mixed] = squares.map(|sum: f64| (sum / f64::from(RENDERS)).sqrt());
    println!("samples {samples:.4}, denoised {truth:.4}, estimate {estimate:.4}, mixed {mixed:.4}, inside {inside}");
    assert!(truth < 0.7 * samples, "{truth} {samples}");
    near!(estimate / truth, 1.0, 0.2);
    assert!(inside >= RENDERS - 2, "{inside} of {RENDERS}");
    assert!(
        mixed < 1.02 * samples && mixed < 1.05 * truth,
        "{mixed} {samples} {truth}"
    );
}

/// In a mirror the guides are those of what is seen there, on either engine.
#[test]
fn guides_follow_mirrors_and_are_alike_on_both_engines() {
    let mut document = studio(ModelSource::Sphere);
    document.ground = true;
    adjust(
        &mut document,
        "specular.lobe=ggx specular.roughness=0 specular.fresnel=none base.metalness=1",
    );
    document.lighting.ground_color = [0.1, 0.5, 0.9];
    document.render.samples = 16;
    document.view.denoise = Denoise::High;
    let [cpu, gpu] = [EngineChoice::Cpu, EngineChoice::Gpu].map(|engine| render(engine, &document));
    // Low on the ball: what is seen is the ground.
    let place = 44 * 64 + 32;
    // Of either half.
    for seen in cpu.guides_of(place) {
        let [r, g, b] = seen.albedo.map(|sum| sum / seen.hits);
        assert!(
            (r - 0.1).abs() < 0.02 && (g - 0.5).abs() < 0.02 && (b - 0.9).abs() < 0.02,
            "{r} {g} {b}"
        );
        assert!(seen.normal[1] > 7.5, "the ground's: {seen:?}");
    }
    let numbers = |film: &Film| -> Vec<f64> {
        let of = |s: &GuideSums| [&s.albedo[..], &s.normal[..], &[s.hits]].concat();
        film.guides.iter().flat_map(of).map(f64::from).collect()
    };
    let (a, b) = (numbers(&cpu), numbers(&gpu));
    let difference: f64 = std::iter::zip(&a, &b).map(|(a, b)| (a - b).abs()).sum();
    assert!(
        difference < 0.002 * a.iter().map(|a| a.abs()).sum::<f64>(),
        "{difference}"
    );
}

#[test]
fn a_denoised_picture_stands_beside_the_samples_and_its_error_in_the_report() {
    let place = Workplace::new();
    let plain = place.picture("--model sphere --samples 8");
    let report = place.report("--model sphere --samples 8 --denoise high");
    let number = |key: &str| report[key].as_f64().unwrap_or_else(|| panic!("{key}: {report}"));
    assert_eq!(report["denoised"], "high");
    assert!(number("denoise_seconds") > 0.0);
    assert!(number("denoised_error_low") <= number("denoised_error"));
    assert!(number("denoised_error") <= number("denoised_error_high"));
    assert!(number("denoised_error_high") < 2.0 * number("noise"), "{report}");
    assert!(report["effects"].as_array().unwrap().contains(&"denoising".into()));
    let quick = place.path("quick.exr");
    assert!(read_exr(&quick) == plain, "the samples are untouched");
    let channels = channel_names(&quick);
    for name in ["denoised.R", "denoised.G", "denoised.B", "R", "A"] {
        assert!(channels.contains(&name.to_owned()), "{channels:?}");
    }
    place.done("render --engine cpu --size 24x24 --samples 4 --aovs --denoise fast --output layers.exr");
    let channels = channel_names(&place.path("layers.exr"));
    assert!(
        channels.contains(&"denoised.G".to_owned()) && channels.contains(&"albedo.G".to_owned()),
        "{channels:?}"
    );
    let off = place.report("--model sphere");
    assert!(off["denoised"].is_null() && off["denoised_error"].is_null(), "{off}");
}

fn channel_names(path: &Path) -> Vec<String> {
    let meta = exr::meta::MetaData::read_from_file(path, false).unwrap();
    meta.headers[0]
        .channels
        .list
        .iter()
        .map(|channel| channel.name.to_string())
        .collect()
}

#[test]
fn rendering_stops_where_the_denoised_picture_is_as_exact_as_was_asked_for() {
    let place = Workplace::new();
    let scene = "--model sphere --ground --size 64x64 --samples 100000 --min-samples 2 --noise 0.15";
    let of = |denoise: &str| place.report(&format!("{scene} --denoise {denoise}"));
    let (plain, auto) = (of("off"), of("auto"));
    assert_eq!(
        (&plain["stopped_by"], &auto["stopped_by"]),
        (&"noise".into(), &"noise".into())
    );
    assert!(auto["denoised_error"].as_f64().unwrap() <= 0.15, "{auto}");
    let samples = |report: &serde_json::Value| report["mean_samples_per_pixel"].as_f64().unwrap();
    assert!(samples(&auto) < 0.7 * samples(&plain), "{auto} {plain}");
}

/// Installers as pip is called: `install --no-deps --target FOLDER PACKAGE`. What they do, whether someone stops them at the
/// first share that is not 0, and what is said.
#[cfg(unix)]
const INSTALLERS: [(&str, bool, Result<(), &str>); 5] = [
    (
        "mkdir -p $4/pyoidn/oidn/lib; cd $4/pyoidn/oidn/lib; touch libtbb.so.12 libOpenImageDenoise_core.so.2 \
         libOpenImageDenoise_device_cpu.so.2 libOpenImageDenoise.so.2",
        false,
        Ok(()),
    ),
    (
        "head -c 9000000 /dev/zero > $TMPDIR/wheel; exec sleep 600",
        true,
        Err("was stopped"),
    ),
    ("echo 'ERROR: no network' >&2; exit 1", false, Err("ERROR: no network")),
    (
        "echo 'No module named pip' >&2; exit 1",
        false,
        Err("install python3-pip"),
    ),
    ("true", false, Err("has no libtbb.so.12")),
];

/// The denoiser comes whole or not at all, and a stopped download leaves nothing behind.
#[cfg(unix)]
#[test]
fn the_denoiser_is_fetched_or_nothing_is() {
    for (script, stops, expected) in INSTALLERS {
        let folder = Workplace::new();
        let to = folder.path("glossmith");
        let shares = std::cell::RefCell::new(vec![0.0]);
        let outcome = fetch_into(&to, &[&["no-such-installer"], &["sh", "-c", script, "sh"]], &|share| {
            shares.borrow_mut().push(share);
            !stops || share == 0.0
        });
        match (&outcome, expected) {
            (Ok(()), Ok(())) => {}
            (Err(why), Err(part)) if why.contains(part) => {}
            _ => panic!("{script}: {outcome:?}"),
        }
        assert!(shares.borrow().is_sorted(), "{script}: {shares:?}");
        assert_eq!(
            stops,
            shares.borrow().iter().any(|share| *share > 0.0),
            "{script}: {shares:?}"
        );
        let files = std::fs::read_dir(&to).expect("made").count();
        assert_eq!(files, if outcome.is_ok() { 4 } else { 0 }, "{script}");
    }
}
