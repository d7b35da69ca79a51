//! Light profiles: the light below a lamp is that of its file's intensities on both engines; files and names on the
//! command line and in projects. The files are built here.

use super::{
    cli_support::Workplace,
    cli_support::read_exr,
    renders::{adjust, document, render},
};
use glam::DVec3;
use glossmith::{
    document::{AreaLight, AreaLightShape, Background, Document, ProfileFile},
    import::light_profile,
    optics::vector::Vec3,
    render::EngineChoice,
    scene::{
        AreaFrame, AreaShape, ModelSource, Outline,
        environment::EnvironmentSource,
        light_profile::{LightProfile, profile_share},
    },
};
use std::f64::consts::PI;

/// A lamp that shines along its width, hardly along its height, and not upwards.
pub const LAMP: &str =
    "IESNA:LM-63-2002\n[TEST] built by a test\nTILT=NONE\n1 1000 2.0 2 2 1 2 0 0 0\n1 1 20\n0 90\n0 90\n50 20\n50 0\n";

/// Its intensity in candela in a direction in units of its axis, width and height.
fn candela([axis, width, height]: [f64; 3]) -> f64 {
    let vertical_deg = width.hypot(height).atan2(axis).to_degrees();
    let quadrant_deg = height.abs().atan2(width.abs()).to_degrees();
    let at_side = 40.0 * (1.0 - quadrant_deg / 90.0);
    100.0 + (at_side - 100.0) * vertical_deg / 90.0
}

const SIDE: usize = 16;

/// Height of lamp and camera above the floor, half its side.
const LAMP_HEIGHT: f64 = 0.8;
const CAMERA_HEIGHT: f64 = 3.0;

/// A white floor below a small lamp with a file's profile and its lumens, seen from above.
pub fn floor(file: &std::path::Path) -> (Document, AreaLight, f64) {
    let matt = ["base.metalness=0", "specular.weight=0", "base.color=1,1,1"];
    let mut document = document(ModelSource::Plane, EnvironmentSource::Furnace, &matt);
    document.lighting.strength = 0.0;
    document.lighting.background = Background::Transparent;
    // The corner of the floor is a bounding radius away.
    let radius = 2.0_f64.sqrt();
    let mut lamp = AreaLight {
        shape: AreaLightShape::Sphere,
        profile: Some(ProfileFile::new(file)),
        yaw_deg: 0.0,
        pitch_deg: 90.0,
        turn_deg: 25.0,
        distance: LAMP_HEIGHT / radius,
        width: 0.02,
        is_hidden: true,
        ..AreaLight::default()
    };
    lamp.set_power(light_profile::load(file).unwrap().lumens(), radius);
    document.lighting.area_lights = vec![lamp];
    document.camera.position = Some([0.0, CAMERA_HEIGHT, 0.0]);
    document.camera.fov_deg = 30.0;
    (document.render.width, document.render.height) = (SIDE as u32, SIDE as u32);
    adjust(&mut document, "render.samples=256 render.filter=box render.bounces=1");
    (document, lamp, radius)
}

#[test]
fn a_floor_is_lit_by_the_intensities_of_the_file() {
    let place = Workplace::new();
    place.write("lamp.ies", LAMP);
    let (document, lamp, _) = floor(&place.path("lamp.ies"));
    let frame = lamp.shape().frame();
    let half = (15.0_f64).to_radians().tan() * CAMERA_HEIGHT;
    // Luminance of a place on the floor, which is white: the illuminance over π.
    let luminance = |x: f64, z: f64| {
        let towards = DVec3::new(x, -LAMP_HEIGHT, z);
        let direction = towards.normalize();
        let along = [-frame.outwards, frame.across, frame.up].map(|axis| axis.dot(direction));
        candela(along) * LAMP_HEIGHT / towards.length().powi(3) / PI
    };
    for engine in [EngineChoice::Cpu, EngineChoice::Gpu] {
        let film = render(engine, &document);
        // Blocks of 4 × 4 pixels, each of 4 × 4 places.
        for block in 0..16 {
            let (mut found, mut expected) = (0.0, 0.0);
            for pixel in 0..16 {
                let [column, row] = [4 * (block % 4) + pixel % 4, 4 * (block / 4) + pixel / 4];
                found += film.luminance_of(row * SIDE + column);
                for place in 0..16 {
                    let at = |index: usize, part: usize| ((4 * index + part) as f64 + 0.5) / (2 * SIDE) as f64 - 1.0;
                    expected += luminance(half * at(column, place % 4), half * at(row, place / 4)) / 16.0;
                }
            }
            println!("{engine:?}, block {block}: {found:.2} for {expected:.2}");
            // Half of the samples are of the lamp's far side: 1.6 % of noise in a block.
            near!(found / expected, 1.0, 0.06, "{engine:?}, block {block}");
        }
    }
}

#[test]
fn the_command_line_and_projects_name_profiles() {
    let place = Workplace::new();
    place.write("lamp.ies", LAMP);
    place.write("broken.ies", b"TILT=NONE\n1 1 1 2 1 1 1 0 0 0 1 1 1 0 90 0 1");
    let light = "--area-light 0,60,2,0.1,0.1,50,sphere";
    let scene = "--model sphere --engine cpu --size 12x12 --samples 4 --environment-strength 0";
    place.done(&format!("render {scene} {light} --output even.exr"));
    place.done(&format!(
        "render {scene} {light},profile=lamp.ies --output lamp.exr --output lamp.png"
    ));
    assert!(read_exr(&place.path("even.exr")) != read_exr(&place.path("lamp.exr")));
    place.refused(
        1,
        &format!("render {scene} {light},profile=broken.ies"),
        &["broken.ies: not a light profile: it ends too early", ".ies"],
    );
    place.refused(
        1,
        &format!("render {scene} {light},profile=gone.ies"),
        &["gone.ies: cannot be read"],
    );
    place.refused(2, "render --spot profile=lamp.ies", &["only a sphere has one"]);
    // A project names the file relative to itself; where it is missing that is reported, and the light is even.
    let mut document = Document::default();
    document.lighting.area_lights = vec![AreaLight {
        shape: AreaLightShape::Sphere,
        profile: Some(ProfileFile::new(&place.path("lamp.ies"))),
        ..AreaLight::default()
    }];
    place.save_document("p.json", &document);
    assert!(
        place.read("p.json").contains("\"profile\": \"lamp.ies\""),
        "{}",
        place.read("p.json")
    );
    assert_eq!(place.document("p.json"), document);
    assert!(
        document.pictures().any(|file| file.ends_with("lamp.ies")),
        "batches look after it"
    );
    std::fs::remove_file(place.path("lamp.ies")).unwrap();
    let run = place.done("render lamp.png --engine cpu --output without.exr");
    assert!(run.stderr.contains("lamp.ies: cannot be read"), "{}", run.stderr);
    assert!(read_exr(&place.path("without.exr")) == read_exr(&place.path("even.exr")));
}

fn lamp_frame() -> AreaFrame {
    AreaShape {
        target: [0.0; 3],
        yaw_deg: 30.0,
        pitch_deg: 50.0,
        distance: 2.0,
        width: 0.1,
        height: 0.1,
        turn_deg: 20.0,
        outline: Outline::Sphere,
    }
    .frame()
}

/// The direction of two angles.
fn direction(frame: &AreaFrame, [vertical_deg, horizontal_deg]: [f64; 2]) -> Vec3<f64> {
    let (sine, cosine) = vertical_deg.to_radians().sin_cos();
    let (up, across) = horizontal_deg.to_radians().sin_cos();
    let direction = -frame.outwards * cosine + sine * (frame.across * across + frame.up * up);
    Vec3::from_f64(direction.to_array())
}

fn share(profile: &LightProfile, angles: [f64; 2]) -> f64 {
    let frame = lamp_frame();
    profile_share(&profile.table(&frame), direction(&frame, angles)) * profile.lumens() / (4.0 * PI)
}

#[test]
fn between_the_angles_intensities_are_linear() {
    let down = [
        (0.0, 100.0),
        (15.0, 70.0),
        (30.0, 40.0),
        (60.0, 25.0),
        (89.9, 10.05),
        (91.0, 0.0),
    ];
    let quarter = [
        (0.0, 8.0),
        (45.0, 5.0),
        (90.0, 2.0),
        (150.0, 6.0),
        (180.0, 8.0),
        (300.0, 4.0),
    ];
    let sides = [
        (90.0, 1.0),
        (135.0, 2.0),
        (0.0, 3.0),
        (45.0, 2.0),
        (270.0, 5.0),
        (315.0, 4.0),
    ];
    let around = |angles: [(f64, f64); 6]| angles.map(|(horizontal, expected)| ([60.0, horizontal], expected));
    for (profile, rows) in [
        (
            LightProfile::new(vec![0.0, 30.0, 90.0], &[0.0], &[100.0, 40.0, 10.0]),
            down.map(|(vertical, expected)| ([vertical, 77.0], expected)),
        ),
        (
            LightProfile::new(vec![0.0, 180.0], &[0.0, 90.0], &[8.0, 8.0, 2.0, 2.0]),
            around(quarter),
        ),
        (
            LightProfile::new(vec![0.0, 180.0], &[90.0, 180.0, 270.0], &[1.0, 1.0, 3.0, 3.0, 5.0, 5.0]),
            around(sides),
        ),
    ] {
        let profile = profile.expect("a profile");
        for (angles, expected) in rows {
            let found = share(&profile, angles);
            near!(found, expected, 0.01, "{angles:?}");
        }
    }
}

#[test]
fn the_mean_is_that_of_all_directions() {
    let even = LightProfile::new(vec![0.0, 180.0], &[0.0], &[7.0, 7.0]).expect("a profile");
    near!(even.lumens(), 28.0 * PI, 1e-9);
    let half = LightProfile::new(vec![0.0, 90.0], &[0.0, 180.0], &[6.0, 6.0, 2.0, 2.0]).expect("a profile");
    near!(half.lumens(), 8.0 * PI, 1e-9);
}

const HEAD: &str = "IESNA:LM-63-2002\r\n[TEST] built by a test\r\nTILT=NONE\r\n";

fn parsed(place: &Workplace, text: &str) -> Result<LightProfile, String> {
    place.write("lamp.ies", text);
    light_profile::load(&place.path("lamp.ies")).map_err(|error| error.to_string())
}

#[test]
fn profiles_are_read_as_programs_write_them() {
    let place = Workplace::new();
    let plain = parsed(
        &place,
        &format!("{HEAD}1 1000 2 3 1 1 2 0 0 0\n1 1 20\n0 45 90\n0\n50 50\n 50\n"),
    );
    near!(plain.expect("a profile").lumens(), 200.0 * PI, 0.001);
    let tilted = "TILT=INCLUDE\n1\n2\n0 90\n1,0.9\n1 -1 1 2 1 1 1 0 0 0 0.5 1 20 0 180 0 10 10";
    near!(parsed(&place, tilted).expect("a profile").lumens(), 20.0 * PI, 1e-6);
}

#[test]
fn damaged_profiles_are_refused_in_words() {
    let place = Workplace::new();
    for (text, words) in [
        ("", "TILT="),
        ("TILT=NONE", "ends too early"),
        ("TILT=lamp.tlt\n1", "its tilt is in lamp.tlt"),
        ("TILT=NONE\n1 1 1 1e9 1 1", "vertical angles"),
        ("TILT=NONE\n1 1 1 2.5 1 1", "vertical angles"),
        ("TILT=NONE\n1 1 1 2 -1 1", "horizontal angles"),
        ("TILT=NONE\n1 1 1 2 1 3 1 0 0 0", "type A"),
        ("TILT=NONE\n1 1 one", "\"one\" is no number"),
        ("TILT=NONE\n1 1 nan", "no number"),
        ("TILT=INCLUDE\n1 1e30", "tilt angles"),
        ("TILT=NONE\n1 1 1 2 1 1 1 0 0 0 1 1 1 0 90 0 1", "ends too early"),
        ("TILT=NONE\n1 1 1 2 1 1 1 0 0 0 1 1 1 90 0 0 1 1", "do not ascend"),
        ("TILT=NONE\n1 1 1 2 1 1 1 0 0 0 1 1 1 0 90 0 1 -1", "negative"),
        ("TILT=NONE\n1 1 1e38 2 1 1 1 0 0 0 1e38 1 1 0 90 0 1 1", "above 1e9"),
    ] {
        let error = parsed(&place, text).expect_err(text);
        assert!(error.contains(words), "{text}: {error}");
    }
}
