//! `glossmith evaluate`: values, densities and albedos of a material as tables.

use std::f64::consts::FRAC_1_PI;

use crate::cli_support::Workplace;

/// A white surface without reflection.
const MATT: &str = "--set base.color=#ffffff --set base.metalness=0 --set specular.weight=0";
/// Every way to compute.
const ENGINES: [&str; 3] = ["--engine cpu", "--engine gpu", "--engine cpu --precision f64"];

/// The columns of a table by name, and its rows.
pub struct Table {
    head: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    pub fn column(&self, name: &str) -> Vec<f64> {
        let place = self.head.iter().position(|column| column == name).unwrap();
        self.rows.iter().map(|row| row[place]).collect()
    }
}

/// What the command writes with these arguments.
pub fn evaluate(place: &Workplace, arguments: &str) -> Table {
    place.done(&format!("evaluate --output out.csv {arguments}"));
    let text = place.read("out.csv");
    let mut lines = text.lines();
    let head = lines.next().unwrap().split(',').map(str::to_owned).collect();
    let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
    Table {
        head,
        rows: lines.map(row).collect(),
    }
}

#[track_caller]
fn assert_near(values: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(values.len(), expected.len(), "{what}");
    for (row, (value, expected)) in values.iter().zip(expected).enumerate() {
        near!(
            value,
            expected,
            tolerance * expected.abs().max(0.001),
            "{what}, row {row}"
        );
    }
}

#[test]
fn a_matt_surface_has_the_values_of_lambert() {
    let place = Workplace::new();
    let table =
        "# any comment\nname,phi_i,theta_i,theta_o,phi_o\na,0,0,0,0\nb,90,60,30,10\nc,180,80,89,0\nd,0,120,30,0\n";
    place.write("pairs.csv", table);
    let expected: Vec<f64> = [0.0_f64, 60.0, 80.0]
        .map(|theta| theta.to_radians().cos() * FRAC_1_PI)
        .into_iter()
        .chain([0.0])
        .collect();
    for engine in ENGINES {
        let values = evaluate(
            &place,
            &format!("--material Porcelain {MATT} --directions pairs.csv {engine}"),
        );
        assert_eq!(
            values.head,
            ["name", "phi_i", "theta_i", "theta_o", "phi_o", "r", "g", "b", "density"]
        );
        for column in ["r", "g", "b", "density"] {
            assert_near(&values.column(column), &expected, 1e-5, &format!("{column}, {engine}"));
        }
    }
    assert!(
        place
            .read("out.csv")
            .lines()
            .nth(2)
            .unwrap()
            .starts_with("b,90,60,30,10,")
    );
}

/// Sums over a grid, whose light directions stand for equal steps of both angles, are the albedo.
#[test]
fn values_add_up_to_the_albedo() {
    let place = Workplace::new();
    let steps = 48;
    let view_deg = |view: usize| 90.0 / steps as f64 * (view as f64 + 0.5);
    let step = (90.0 / steps as f64).to_radians();
    let material = "--material Glass --set specular.lobe=ggx --set specular.roughness=0.7";
    for side in ["above", "below"] {
        let values = evaluate(&place, &format!("{material} --grid {steps} --side {side} --engine cpu"));
        let cosines: Vec<f64> = [4, 24, 36].map(|view| view_deg(view).to_radians().cos()).to_vec();
        let list: Vec<_> = cosines.iter().map(f64::to_string).collect();
        let albedos = evaluate(
            &place,
            &format!(
                "{material} --albedo {} --side {side} --engine cpu --count 65536",
                list.join(",")
            ),
        );
        let [theta_o, theta_i] = ["theta_o", "theta_i"].map(|column| values.column(column));
        for (index, view) in [4, 24, 36].into_iter().enumerate() {
            let sum = |column: &[f64], is_below: bool| -> f64 {
                let rows = (0..theta_o.len()).filter(|row| (theta_o[*row] - view_deg(view)).abs() < 1e-9);
                let rows = rows.filter(|row| (theta_i[*row] > 90.0) == is_below);
                rows.map(|row| column[row] * theta_i[row].to_radians().sin() * step * 2.0 * step)
                    .sum()
            };
            let green = values.column("g");
            let [reflected, transmitted] = ["R_g", "T_g"].map(|column| albedos.column(column)[index]);
            let what = format!("{material}, {side}, view {view}");
            near!(sum(&green, false), reflected, 0.01, "{what}");
            near!(sum(&green, true), transmitted, 0.01, "{what}");
        }
    }
}

/// A file's angles count from the normal on the side that is named; above 90 degrees they are on the other one.
#[test]
fn the_side_turns_the_angles_over() {
    let place = Workplace::new();
    place.write("in.csv", b"theta_o,phi_o,theta_i,phi_i\n150,0,50,180\n150,20,140,200\n");
    place.write(
        "turned.csv",
        b"theta_o,phi_o,theta_i,phi_i\n30,0,130,180\n30,20,40,200\n",
    );
    let material = "--material Glass --set specular.roughness=0.3 --engine cpu";
    let of = |arguments: &str| evaluate(&place, &format!("{material} {arguments}")).column("r");
    let above = of("--directions in.csv");
    assert_near(&of("--directions turned.csv --side below"), &above, 1e-5, "turned");
    assert!(above.iter().all(|value| *value > 0.0), "{above:?}");
    assert_ne!(of("--directions turned.csv"), above, "glass has two sides");
}

#[test]
fn what_is_wrong_is_named() {
    let place = Workplace::new();
    place.write("short.csv", b"theta_o,phi_o,theta_i\n1,2,3\n");
    place.write("cells.csv", b"theta_o,phi_o,theta_i,phi_i\n1,2,3,4\n1,2,3\n");
    place.write("word.csv", b"theta_o,phi_o,theta_i,phi_i\n\n1,2,steep,4\n");
    place.write("taken.csv", b"theta_o,phi_o,theta_i,phi_i,r\n1,2,3,4,5\n");
    place.write("empty.csv", b"# nothing\n");
    place.write("head.csv", b"theta_o,phi_o,theta_i,phi_i\n");
    let gold = "evaluate --material Gold --engine cpu --output out.csv";
    for (file, words) in [
        ("short.csv", ["no column phi_i", "theta_o,phi_o"]),
        ("cells.csv", ["line 3", "3 cells"]),
        ("word.csv", ["line 3", "steep"]),
        ("taken.csv", ["column r", "rename"]),
        ("empty.csv", ["empty.csv", "empty"]),
        ("head.csv", ["head.csv", "no directions"]),
        ("missing.csv", ["missing.csv", "cannot be read"]),
    ] {
        place.refused(1, &format!("{gold} --directions {file}"), &words);
    }
    place.refused(1, "evaluate --material Nothing --grid --output out.csv", &["Nothing"]);
    place.refused(1, &format!("{gold} --grid --set camera.fov=40"), &["camera.fov"]);
    let of_gpu = "evaluate --material Gold --output out.csv --grid --engine gpu --precision f64";
    place.refused(1, of_gpu, &["--precision f64", "--engine cpu"]);
    for arguments in [
        "",
        "--grid --albedo 1",
        "--grid 0",
        "--albedo 0",
        "--albedo 1,2",
        "--albedo 1 --count 3",
        "--grid --precision f16",
        "--grid --side beside",
    ] {
        place.refused(2, &format!("{gold} {arguments}"), &[]);
    }
}
