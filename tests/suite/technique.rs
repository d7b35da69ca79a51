//! Techniques of a race: as text and back, and what they change.

use glossmith::{
    document::{Document, MaterialSettings, Strategy},
    job::plan::Plan,
    optics::fresnel::Fresnel,
    scene::texture::TextureTarget,
    study::technique::{GROUPS, Technique, converged},
};

#[test]
fn every_technique_is_read_as_it_is_written() {
    for group in GROUPS {
        for technique in group.members(&Plan::general()) {
            let text = technique.to_string();
            assert_eq!(text.parse(), Ok(technique), "{text}");
            assert!(text.starts_with(group.name), "{text}");
        }
    }
    let both: Technique = "strategy=lobe, bounces=4".parse().expect("two settings");
    assert_eq!(both.to_string(), "strategy=lobe,bounces=4");
    let changed = both.apply(&Document::default());
    assert_eq!((changed.render.strategy, changed.render.bounces), (Strategy::Lobe, 4));
    assert_eq!("as-is".parse(), Ok(Technique::as_is()));
}

#[test]
fn what_is_no_technique_is_refused_with_what_would_be_one() {
    for (text, word) in [
        ("colour=red", "strategy"),
        ("lobe=velvet", "ggx-2018"),
        ("scattering=twice", "single"),
        ("bounces=0", "64"),
        ("effect=-lobe", "+NAME"),
        ("effect=ground", "-NAME"),
        ("curve=custom", "drawn"),
    ] {
        let error = text.parse::<Technique>().expect_err(text).to_string();
        assert!(error.contains(word), "{text}: {error}");
    }
}

#[test]
fn settings_that_change_no_picture_share_what_they_converge_to() {
    let document = Document::default();
    let same = |text: &str| {
        let technique: Technique = text.parse().expect(text);
        converged(&technique.apply(&document)) == converged(&document)
    };
    assert!(same("strategy=light") && same("sequence=independent") && same("adaptive=on"));
    assert!(same("effect=-light-sampling") && same("effect=+anisotropy"));
    assert!(!same("bounces=1") && !same("fresnel=exact") && !same("lobe=ggx") && !same("effect=-background"));
}

#[test]
fn exact_and_approximate_fresnel_agree_along_the_normal() {
    let apply = |text: &str, material: &MaterialSettings| {
        let document = Document {
            materials: vec![material.clone()],
            ..Document::default()
        };
        text.parse::<Technique>().expect(text).apply(&document).materials[0].clone()
    };
    let metal = MaterialSettings {
        metalness: 1.0,
        fresnel: Fresnel::Schlick,
        ..MaterialSettings::default()
    };
    for f0 in [0.0, 0.04, 0.3, 0.8, 0.95, 0.998] {
        for eta in [0.1, 1.0, 2.5, 20.0] {
            let exact = apply(
                "fresnel=exact",
                &MaterialSettings {
                    base_color: [f0; 3],
                    eta: [eta; 3],
                    ..metal.clone()
                },
            );
            assert_eq!(exact.fresnel, Fresnel::Conductor);
            let back = apply("fresnel=schlick", &exact);
            assert!(
                back.base_color.iter().all(|found| (found - f0).abs() < 0.0001),
                "{f0} {eta}: {back:?}"
            );
        }
    }
    // A texture of the colour has no index.
    let mut textured = metal.clone();
    textured.textures[TextureTarget::BaseColor] = true;
    assert_eq!(apply("fresnel=exact", &textured), textured);
    let plain = apply(
        "fresnel=exact",
        &MaterialSettings {
            metalness: 0.0,
            ..metal
        },
    );
    assert_eq!(plain.fresnel, Fresnel::Dielectric);
    let back = apply("fresnel=schlick", &plain);
    assert_eq!((back.fresnel, back.ior), (Fresnel::Schlick, 1.5));
}
