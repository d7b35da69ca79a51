//! What a coat does to what lies below it, as OpenPBR 1.1 has it: darkening, roughness, absorption and emission by closed
//! forms, and files from before.

use std::path::Path;

use glossmith::{
    compile::compile,
    document::{Background, CoatLobe, MaterialSettings},
    optics::{fresnel::fresnel_dielectric, layer::coat::inner_reflection},
    render::{EngineChoice, Precision},
    scene::{ModelSource, environment::EnvironmentSource},
    store::preset::parse_material,
    study::evaluate::Evaluator,
};

use super::renders::{document, material, render};

const EXACT: (EngineChoice, Precision) = (EngineChoice::Cpu, Precision::Double);
const ENGINES: [(EngineChoice, Precision); 2] = [(EngineChoice::Cpu, Precision::Single), EXACT];
const COSINES: [f64; 4] = [1.0, 0.6, 0.3, 0.1];

/// A coat of weight 1 over a matt base.
fn coated(base: f64, more: &str) -> MaterialSettings {
    material(&format!(
        "base.metalness=0 specular.weight=0 specular.fresnel=dielectric coat.weight=1 coat.roughness=0 \
         base.color={base},{base},{base} {more}"
    ))
}

/// Its albedos at the cosines.
fn albedos(material: &MaterialSettings, (engine, precision): (EngineChoice, Precision)) -> [f64; 4] {
    let evaluator = Evaluator::open(material, engine, precision).unwrap();
    COSINES.map(|cosine| evaluator.albedo(cosine, 1 << 12, 1).unwrap().reflected[1])
}

/// The review of the physics, part 3.4: K of index 1.5, and what three bases keep.
#[test]
fn a_coat_darkens_a_matt_base_by_the_closed_form() {
    let inner = inner_reflection(1.5);
    near!(inner, 0.5963, 0.0001);
    for (base, expected) in [(0.8, 0.7719), (0.5, 0.5751), (0.2, 0.4583), (1.0, 1.0)] {
        for engine in ENGINES {
            let albedo = |darkening: f64| {
                let more = format!("coat.ior=1.5 coat.darkening={darkening}");
                albedos(&coated(base, &more), engine)
            };
            let (whole, half, none) = (albedo(1.0), albedo(0.5), albedo(0.0));
            for (i, cosine) in COSINES.into_iter().enumerate() {
                // The smooth coat is a mirror: its own light and that of the base.
                let of_coat = fresnel_dielectric(cosine, 1.5);
                let kept = [none[i], half[i], whole[i]].map(|albedo| (albedo - of_coat) / (1.0 - of_coat) / base);
                let what = format!("{engine:?}, base {base}, {cosine}: {kept:?}");
                // Tables of the coat's albedo are linear between 64 cosines.
                let near = |found: f64, expected: f64| (found - expected).abs() < 0.003;
                assert!(near(kept[0], 1.0), "{what}");
                assert!(near(kept[1], 0.5 + 0.5 * expected), "{what}");
                assert!(near(kept[2], expected), "{what} for {expected}");
            }
        }
    }
}

#[test]
fn a_rough_coat_blurs_what_is_below() {
    for (lobe, weight, expected) in [("ggx", 1.0, 0.604), ("ggx", 0.5, 0.452), ("geometric", 1.0, 0.604)] {
        let more = format!(
            "specular.weight=1 specular.lobe={lobe} specular.roughness=0.3 transmission.roughness=0.125 coat.lobe=ggx coat.roughness=0.5 \
             coat.weight={weight}"
        );
        let mut settings = coated(0.0, &more);
        if lobe == "geometric" {
            settings.roughness = glossmith::document::import::geometric_from_ggx(0.3);
        }
        let (materials, _) = compile(std::slice::from_ref(&settings));
        let found = settings.ggx_roughness(materials[0].roughness);
        near!(found, expected, 0.002, "{lobe} {weight}");
        near!(
            materials[0].transmission_roughness - materials[0].roughness,
            0.125,
            1e-6
        );
    }
    // A smooth coat leaves it as it is, to the bit.
    let (materials, _) = compile(&[coated(0.0, "specular.weight=1 specular.roughness=0.3")]);
    assert_eq!(materials[0].roughness, 0.3);
}

/// A coat dims what shines below it by its way to the viewer: seen from above, by the root of its colour.
#[test]
fn a_coloured_coat_dims_the_emission() {
    for choice in [EngineChoice::Cpu, EngineChoice::Gpu] {
        let assignments = "base.metalness=0 base.weight=0 specular.weight=0 emission.strength=2 coat.ior=1 \
                           coat.color=0.81,0.25,0.04";
        for (weight, expected) in [(0.0, [2.0, 2.0, 2.0]), (1.0, [1.8, 1.0, 0.4]), (0.5, [1.9, 1.5, 1.2])] {
            let weight = format!("coat.weight={weight}");
            let all = [assignments, &weight];
            let mut document = document(ModelSource::Plane, EnvironmentSource::Furnace, &all);
            document.lighting.strength = 0.0;
            document.lighting.background = Background::Transparent;
            // From straight above the way is one thickness.
            let camera = &mut document.camera;
            (camera.position, camera.target, camera.fov_deg) = (Some([0.0, 3.0, 0.0]), Some([0.0; 3]), 0.1);
            document.render.samples = 4;
            let film = render(choice, &document);
            let middle = film.colors().next().unwrap();
            for channel in 0..3 {
                let found = middle[channel] / middle[3];
                near!(
                    found,
                    expected[channel],
                    0.01,
                    "{choice:?}, {weight}: {middle:?} for {expected:?}"
                );
            }
        }
    }
}

/// A coat of no weight is none, to the bit, whatever else is said of it.
#[test]
fn no_coat_changes_nothing() {
    let rich = "coat.ior=3 coat.roughness=1 coat.color=0,0,0 coat.anisotropy=1 coat.lobe=ggx";
    let [plain, other] = ["", rich].map(|more| {
        let more = format!("specular.weight=1 coat.weight=0 {more}");
        albedos(&coated(0.5, &more), ENGINES[0])
    });
    assert_eq!(plain, other);
}

/// Files from before OpenPBR's coat keep their picture; what says so has it.
#[test]
fn coats_of_older_files_leave_the_base_as_it_is() {
    let read = |material: &str| {
        let text = format!("{{\"glossmith\": 1, \"name\": \"a\", \"material\": {{{material}}}}}");
        parse_material(Path::new("a.json"), text.as_bytes()).unwrap().value
    };
    let coat = |material: MaterialSettings| (material.coat_on_base, material.coat_darkening, material.coat_lobe);
    assert_eq!(coat(read("\"coat.weight\": 0.5")), (false, 0.0, CoatLobe::Geometric));
    assert_eq!(
        coat(read(
            "\"coat.weight\": 0.5, \"coat.on_base\": true, \"coat.darkening\": 0.5"
        )),
        (true, 0.5, CoatLobe::Geometric)
    );
    // Without a coat there is no picture to keep.
    assert_eq!(
        coat(read("\"specular.roughness\": 0.5")),
        (true, 1.0, CoatLobe::Geometric)
    );
}
