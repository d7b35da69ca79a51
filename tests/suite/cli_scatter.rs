//! `glossmith scatter`: the samples as a table and as a picture.

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
    near!(absorbed as f64 / 4000.0, 0.101, 0.024);
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
            near!(found, expected, 1e-5, "{through:?} became {mirrored:?}");
        }
    }
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
