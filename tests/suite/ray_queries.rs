//! Ray queries: the same pictures as by our own traversal but for rounding, and the switch. Where the adapter has none, what
//! stands in is seen to.

use std::{sync::Arc, time::Duration};

use glossmith::{
    document::{AreaLight, Document},
    gpu::{AdapterKind, GpuAdapter, GpuEngine, Traversal},
    job::{Job, film::Film},
    render::{EngineChoice, Session},
};

use super::{cli_support::Workplace, cli_support::read_exr, plan::job_in, random_documents::apart, renders::adjust};

/// The share of pixels that may be off by more than a thousandth, and how far the whole image may be: rays at edges meet
/// the triangle on the other side, after which a path goes elsewhere. All other hits have the same numbers, as these are
/// computed by the same arithmetic once the triangle is known.
const PARTED_PIXELS: f64 = 0.005;
const PARTED_WHOLE: f64 = 0.001;

fn adapter() -> GpuAdapter {
    GpuAdapter::find(AdapterKind::Any).expect("an adapter: install mesa-vulkan-drivers")
}

/// An engine with ray queries; where the adapter has none, it says so and an engine without takes its place.
fn with_queries(adapter: &GpuAdapter) -> GpuEngine {
    let opened = adapter.open(Traversal::RayQueries);
    if adapter.has_ray_queries() {
        return GpuEngine::new(opened.expect("it has them")).expect("the shader compiles");
    }
    let refused = opened.expect_err("it has none").to_string();
    println!("{} has no ray queries, and says so: {refused}", adapter.info.name);
    assert!(refused.contains(&adapter.info.name), "{refused}");
    without_queries(adapter)
}

fn without_queries(adapter: &GpuAdapter) -> GpuEngine {
    let device = adapter.open(Traversal::Own).expect("any adapter will do");
    assert!(
        !device
            .device
            .features()
            .contains(wgpu::Features::EXPERIMENTAL_RAY_QUERY),
        "nothing is asked for that is not used"
    );
    GpuEngine::new(device).expect("the shader compiles")
}

fn film(engine: &mut GpuEngine, job: &Arc<Job>) -> Film {
    engine.submit(job.clone()).expect("the adapter holds it");
    engine.step(Duration::from_secs(1000), 8).expect("nothing fails");
    engine.film().expect("nothing fails").clone()
}

/// The teapot on the ground under the sky and a light from a side, and holes in it or none.
fn lit(yaw_deg: f64, opacity: f32) -> Document {
    let mut document = Document::default();
    adjust(&mut document, "render.width=64 render.height=48 render.bounces=4");
    document.ground = true;
    document.materials[0].opacity = opacity;
    document.lighting.area_lights = vec![AreaLight {
        yaw_deg,
        ..AreaLight::default()
    }];
    document
}

/// The jobs of documents, which share the model where they have the same.
fn jobs<const N: usize>(documents: [Document; N]) -> [Arc<Job>; N] {
    let mut session = Session::open(EngineChoice::Cpu).expect("the processor");
    documents.map(|document| Arc::new(job_in(&mut session, &document)))
}

fn assert_same(a: &Film, b: &Film, what: &str) {
    let [off, whole] = apart(&a.luminance(), &b.luminance());
    println!("{what}: {:.2} % of pixels off, the whole by {whole:.1e}", 100.0 * off);
    assert!(off <= PARTED_PIXELS, "{what}: {:.2} % of pixels are off", 100.0 * off);
    assert!(whole <= PARTED_WHOLE, "{what}: the whole is off by {whole:.1e}");
    assert_eq!([a.dropped(), b.dropped()], [0, 0], "{what}");
}

#[test]
fn pictures_are_those_of_our_own_traversal() {
    let adapter = adapter();
    let [solid, holed] = jobs([lit(0.0, 1.0), lit(0.0, 0.5)]);
    let (mut queried, mut own) = (with_queries(&adapter), without_queries(&adapter));
    let [of_solid, of_holed] = [(&solid, "solid"), (&holed, "with holes")].map(|(job, what)| {
        let by_query = film(&mut queried, job);
        assert_same(&by_query, &film(&mut own, job), what);
        by_query
    });
    let [off, _] = apart(&of_solid.luminance(), &of_holed.luminance());
    assert!(off > 0.1, "the holes are seen");
}

/// What is around the model is built anew alone, in the place of what was there.
#[test]
fn a_light_that_is_moved_shines_from_where_it_is() {
    let adapter = adapter();
    let [before, after] = jobs([lit(0.0, 1.0), lit(90.0, 1.0)]);
    assert!(Arc::ptr_eq(&before.geometry.model, &after.geometry.model));
    let mut queried = with_queries(&adapter);
    let first = film(&mut queried, &before);
    let moved = film(&mut queried, &after);
    assert_same(&moved, &film(&mut without_queries(&adapter), &after), "moved");
    let [off, _] = apart(&first.luminance(), &moved.luminance());
    assert!(off > 0.1, "the light is seen to move");
    // And back: what was there for the first picture is not what is there now.
    assert_same(&film(&mut queried, &before), &first, "moved back");
}

/// A model that is too large for the bindings lies in textures, over which nothing is built.
#[test]
fn a_model_in_textures_goes_without() {
    let adapter = adapter();
    let [job] = jobs([lit(0.0, 1.0)]);
    let mut queried = with_queries(&adapter);
    queried.device().limit_buffers(100 << 10);
    assert_same(
        &film(&mut queried, &job),
        &film(&mut without_queries(&adapter), &job),
        "in textures",
    );
}

#[test]
fn the_switch_holds_and_is_told() {
    let place = Workplace::new();
    let adapter = adapter();
    let render = |switch: &str| {
        let arguments = format!("--model sphere --ground --samples 16 --engine gpu --ray-queries {switch}");
        let report = place.report(&arguments);
        let traversal = report["traversal"].as_str().expect("a word").to_owned();
        (traversal, read_exr(&place.path("quick.exr")))
    };
    let ((on, with), (off, without)) = (render("on"), render("off"));
    let expected = if adapter.has_ray_queries() {
        "ray-queries"
    } else {
        "own"
    };
    assert_eq!([on.as_str(), off.as_str()], [expected, "own"]);
    let difference = with.difference(&without);
    assert!(difference < 0.001, "the pictures differ by {difference}");
    let told = |switch: &str| {
        let arguments = "render --engine gpu --size 8x8 --samples 1 --output told.exr --ray-queries";
        place.done(&format!("{arguments} {switch}")).stderr
    };
    let words = if adapter.has_ray_queries() {
        ["with ray queries, chosen by you", "without ray queries, chosen by you"]
    } else {
        ["which the adapter does not have", "chosen by you"]
    };
    for (switch, words) in std::iter::zip(["on", "off"], words) {
        assert!(told(switch).contains(words), "{switch}: {}", told(switch));
    }
    assert_eq!(place.report("--engine cpu --ray-queries on")["traversal"], "own");
    place.refused(2, "render --ray-queries perhaps", &["expected one of auto, on, off"]);
}

/// Rays along axes, at tiny triangles and needles, from afar. What is aimed at edges of a closed mesh is the adapter's: see
/// docs/STABILITY.md.
#[test]
fn hard_rays_hold_by_query() {
    let place = Workplace::new();
    for case in [
        "triangles-of-a-millionth",
        "needles",
        "rays-along-axes-and-in-planes",
        "seen-from-afar",
        "rays-leave-their-surface",
    ] {
        place.done(&format!("check --hard --only {case} --engine gpu --ray-queries on"));
    }
}
