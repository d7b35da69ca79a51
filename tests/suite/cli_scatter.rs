//! `glossmith scatter`: the samples as a table and as a picture.

use glossmith::optics::lobe::Lobe;

use crate::cli_support::Workplace;

/// The rows of a table, whose head is checked.
fn rows(place: &Workplace, name: &str) -> Vec<[f64; 4]> {
    let text = place.read(name);
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("x,y,z,density"));
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        <[f64; 4]>::try_from(numbers).unwrap()
    };
    lines.map(row).collect()
}

fn scatter(place: &Workplace, arguments: &str) -> Vec<[f64; 4]> {
    place.done(&format!("scatter --output s.csv {arguments}"));
    rows(place, "s.csv")
}

#[test]
fn every_lobe_gives_unit_vectors_and_densities() {
    let place = Workplace::new();
    for lobe in Lobe::ALL {
        let rows = scatter(&place, &format!("--lobe {} --engine cpu --count 500", lobe.name()));
        assert!(rows.len() > 400, "{}: {} rows", lobe.name(), rows.len());
        for [x, y, z, density] in rows {
            assert!(
                ((x * x + y * y + z * z).sqrt() - 1.0).abs() < 1e-5,
                "{}: {x} {y} {z}",
                lobe.name()
            );
            assert!(density.is_finite() && density > 0.0, "{}: {density}", lobe.name());
            assert!(z >= 0.0, "{}: {z}", lobe.name());
        }
    }
}

#[test]
fn the_mirror_direction_is_in_the_xz_half_plane() {
    let place = Workplace::new();
    for engine in ["cpu", "gpu"] {
        for view_deg in [0.0_f64, 30.0, 60.0] {
            let rows = scatter(
                &place,
                &format!("--lobe geometric --roughness 0.01 --view-angle {view_deg} --count 300 --engine {engine}"),
            );
            let mirror = [view_deg.to_radians().sin(), 0.0, view_deg.to_radians().cos()];
            for [x, y, z, _] in rows {
                let cos = x * mirror[0] + y * mirror[1] + z * mirror[2];
                assert!(cos > 0.999, "{engine} at {view_deg}°: {x} {y} {z}");
            }
        }
    }
}

/// Refracted samples lie below the surface, about the direction of Snell's law; under total reflection they stay above.
#[test]
fn refracted_samples_follow_snells_law() {
    let place = Workplace::new();
    for engine in ["cpu", "gpu"] {
        for (lobe, roughness) in [("geometric", 0.02), ("phong", 0.05), ("ggx", 0.05)] {
            let common = format!("--lobe {lobe} --roughness {roughness} --engine {engine} --count 2000");
            let rows = scatter(&place, &format!("{common} --view-angle 50 --ior 1.5"));
            assert!(rows.len() > 1900, "{} rows", rows.len());
            assert!(rows.iter().all(|row| row[2] < 0.0 && row[3] > 0.0));
            let x = rows.iter().map(|row| row[0]).sum::<f64>() / rows.len() as f64;
            let expected = 50.0_f64.to_radians().sin() / 1.5;
            assert!((x - expected).abs() < 5e-3, "{engine} {lobe}: {x}, expected {expected}");
        }
        let total = scatter(
            &place,
            &format!("--lobe geometric --engine {engine} --roughness 0.02 --view-angle 60 --ior 0.5"),
        );
        assert!(total.iter().all(|row| row[2] > 0.0));
    }
    place.refused(
        2,
        "scatter --lobe ggx --ior 0 --output s.csv",
        &["--ior", "give a number from 0.2 to 5"],
    );
    place.done("scatter --lobe geometric --ior 1.5 --count 3000 --engine cpu --output s.png");
}

#[test]
fn absorbed_samples_are_left_out_and_counted() {
    let place = Workplace::new();
    let common = "scatter --lobe geometric --curve sqrt --roughness 0.6 --view-angle 80 --count 4000 --engine cpu";
    let run = place.done(&format!("{common} --horizon absorb --output absorb.csv"));
    let absorbed: usize = run.stderr.split_whitespace().next().unwrap().parse().unwrap();
    let kept = rows(&place, "absorb.csv");
    assert_eq!(kept.len() + absorbed, 4000);
    assert!(kept.iter().all(|row| row[2] >= 0.0));
    // The share below the horizon that was measured for this case: 10.1 %, five standard deviations around it.
    assert!((absorbed as f64 / 4000.0 - 0.101).abs() < 0.024, "{absorbed} absorbed");
    let run = place.done(&format!("{common} --horizon mirror --output mirror.csv"));
    assert!(!run.stderr.contains("absorbed"));
    let mirrored = rows(&place, "mirror.csv");
    assert_eq!(mirrored.len(), 4000);
    assert!(mirrored.iter().all(|row| row[2] >= 0.0));
    place.done(&format!("{common} --horizon none --output none.csv"));
    let all = rows(&place, "none.csv");
    assert_eq!(all.iter().filter(|row| row[2] < 0.0).count(), absorbed);
    // What the mirror does to the very same samples.
    for (through, mirrored) in all.iter().zip(&mirrored) {
        let [x, y, z, _] = through;
        for (found, expected) in mirrored.iter().zip([*x, *y, z.abs()]) {
            assert!((found - expected).abs() < 1e-5, "{through:?} became {mirrored:?}");
        }
    }
}

#[test]
fn the_same_seed_draws_the_same_samples() {
    let place = Workplace::new();
    let draw = |arguments: &str| {
        place.done(&format!("scatter --lobe ggx --count 200 --output s.csv {arguments}"));
        place.read("s.csv")
    };
    for engine in ["cpu", "gpu"] {
        let first = draw(&format!("--seed 5 --engine {engine}"));
        assert_eq!(first, draw(&format!("--seed 5 --engine {engine}")));
        assert_ne!(first, draw(&format!("--seed 6 --engine {engine}")));
    }
    let near = |a: &[f64; 4], b: &[f64; 4]| a.iter().zip(b).all(|(x, y)| (x - y).abs() <= 1e-3 * y.abs().max(1.0));
    let [cpu, gpu] = ["cpu", "gpu"].map(|engine| {
        draw(&format!("--seed 5 --engine {engine}"));
        rows(&place, "s.csv")
    });
    assert_eq!(cpu.len(), gpu.len());
    let agreeing = cpu.iter().zip(&gpu).filter(|(a, b)| near(a, b)).count();
    assert!(
        agreeing * 100 >= cpu.len() * 99,
        "{agreeing} of {} samples agree",
        cpu.len()
    );
}

#[test]
fn options_change_the_samples() {
    let place = Workplace::new();
    let spread = |arguments: &str| {
        let rows = scatter(&place, &format!("--view-angle 0 --count 2000 --engine cpu {arguments}"));
        rows.iter().map(|row| row[0].hypot(row[1])).sum::<f64>() / rows.len() as f64
    };
    // At normal incidence the distance from the axis tells the curves and the roughness apart.
    let [linear, smooth, sqrt, cbrt] =
        ["linear", "smooth", "sqrt", "cbrt"].map(|curve| spread(&format!("--lobe geometric --curve {curve}")));
    assert!(
        linear < sqrt && smooth < sqrt && sqrt < cbrt,
        "{linear} {smooth} {sqrt} {cbrt}"
    );
    assert!(spread("--lobe phong --roughness 0.2") < spread("--lobe phong --roughness 0.5"));
}

#[test]
fn a_picture_shows_the_samples() {
    let place = Workplace::new();
    place.done("scatter --lobe geometric --count 3000 --engine cpu --output s.PNG");
    let picture = image::open(place.path("s.PNG")).unwrap().into_rgb8();
    assert!(picture.width() >= 400 && picture.height() >= 400);
    let is_dot = |pixel: &&image::Rgb<u8>| pixel.0[2] > pixel.0[0].saturating_add(40);
    let dots = picture.pixels().filter(is_dot).count();
    assert!(dots > 2000, "{dots} pixels have the samples' colour");
}
