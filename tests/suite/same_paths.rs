//! Sample by sample, both engines on the same random numbers: a number that one of them uses twice, a bounce that it alone
//! limits, a lobe that it alone gets wrong shows in most pixels, where a comparison of noisy pictures would let it pass.

use glossmith::cpu::recorder::Event;
use glossmith::document::{Document, Strategy};
use glossmith::optics::random::Sequence;
use glossmith::scene::ModelSource;
use glossmith::scene::environment::EnvironmentSource;

use crate::coat::COATED;
use crate::gltf_builder::Folder;
use crate::lights::lit_scenes;
use crate::parting::Pair;
use crate::paths::scenes;
use crate::renders::document;
use crate::textures::all_at_once;

/// How many pixels of one sample may be off, and the whole by how much: rounding decides now and then otherwise which way
/// a path goes.
const ONE_SAMPLE: [f64; 2] = [5e-3, 1e-3];
/// The same in a bright room, of which one pixel of forty bounces is 2e-3 of the whole.
const ONE_SAMPLE_OF_A_ROOM: [f64; 2] = [5e-3, 3e-3];

#[test]
fn engines_trace_the_same_paths() {
    let mut pair = Pair::open();
    for scene in scenes() {
        pair.keep(&scene.document.model, scene.model.clone());
        let limits = if scene.name == "room" {
            ONE_SAMPLE_OF_A_ROOM
        } else {
            ONE_SAMPLE
        };
        for strategy in Strategy::ALL {
            for sequence in Sequence::ALL {
                let mut document = scene.document.clone();
                document.render.strategy = *strategy;
                document.render.sequence = *sequence;
                let what = format!("{}, {strategy:?}, {sequence:?}", scene.name);
                pair.assert_same_paths(&document, limits, &what);
            }
        }
        let mut limited = scene.document.clone();
        limited.render.firefly_clamp = Some(0.2);
        pair.assert_same_paths(&limited, ONE_SAMPLE, &format!("{}, limited", scene.name));
    }
    for (name, mut document) in lit_scenes() {
        document.render.samples = 1;
        for strategy in Strategy::ALL {
            document.render.strategy = *strategy;
            pair.assert_same_paths(&document, ONE_SAMPLE, &format!("{name}, {strategy:?}"));
        }
    }
    let folder = Folder::new();
    let mut textured = all_at_once(&folder);
    textured.render.samples = 1;
    pair.assert_same_paths(&textured, ONE_SAMPLE, "textures");
}

const CLEAR: &[&str] = &["base.metalness=0", "transmission.weight=1"];

/// Materials on the teapot, in which light is reflected often.
fn materials() -> Vec<(String, Document, [f64; 2])> {
    let of = |assignments: &[&str]| {
        let mut document = document(ModelSource::Teapot, EnvironmentSource::Studio, assignments);
        document.render.samples = 4;
        document
    };
    let opaque: [&[&str]; 5] = [
        &["specular.roughness=0.4", "base.metalness=1"],
        &[
            "specular.roughness=0.2",
            "base.metalness=0",
            "specular.fresnel=dielectric",
        ],
        &[
            "specular.lobe=ggx",
            "specular.anisotropy=0.6",
            "specular.fresnel=conductor",
        ],
        &["specular.curve=long-tail", "specular.horizon=absorb"],
        &COATED,
    ];
    let glass: [&[&str]; 3] = [
        &[
            "specular.roughness=0",
            "transmission.color=0.8,0.4,0.2",
            "transmission.depth=0.5",
        ],
        &["specular.roughness=0.4", "transmission.color=0.5,0.9,0.7"],
        &[
            "specular.lobe=ggx-ndf",
            "specular.roughness=0.5",
            "transmission.roughness=-0.2",
        ],
    ];
    let opaque = opaque.map(|material| (material.join(" "), of(material), ONE_SAMPLE));
    let glass = glass.map(|material| (material.join(" "), of(&[CLEAR, material].concat()), [0.02, 2e-3]));
    opaque.into_iter().chain(glass).collect()
}

#[test]
fn engines_agree_on_materials() {
    let mut pair = Pair::open();
    for (what, document, limits) in materials() {
        pair.assert_same_paths(&document, limits, &what);
    }
}

/// A GPU that limits light that was reflected twice: the report names the bounce at which there is some.
#[test]
fn where_engines_part_is_told() {
    let mut pair = Pair::open();
    let glass = scenes().remove(0).document;
    let same = pair.parting(&glass, [16, 16]);
    assert!(same.contains("are the same"), "{same}");
    let account = pair.account(&glass, [16, 16], 0);
    let first = account.events.iter().find_map(|event| match event {
        Event::Contribution { reflections, .. } if *reflections > 1 => Some(*reflections),
        _ => None,
    });
    pair.tamper = |document| document.render.firefly_clamp = Some(1e-6);
    let told = pair.parting(&glass, [16, 16]);
    let place = format!("they part at bounce {} of sample 0", first.unwrap() - 1);
    assert!(
        told.contains(&place) && told.contains("contribution"),
        "{told}, not {place}"
    );
}
