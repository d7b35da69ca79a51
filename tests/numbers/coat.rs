//! The edge tint in closed form.

use glossmith::optics::fresnel::{fresnel_metal, fresnel_schlick};
use glossmith::optics::vector::{Vec3, vec3};

/// At a cosine of 1/7 the tint is what is left of Schlick's reflectance; head-on and at grazing angles nothing changes.
#[test]
fn the_edge_tint_is_what_is_left_at_82_degrees() {
    let (f0, tint) = (vec3(0.9, 0.5, 0.2), vec3(0.3, 0.8, 1.0));
    let seventh = 1.0 / 7.0;
    let expected = fresnel_schlick(f0, seventh) * tint;
    let found = fresnel_metal(f0, tint, seventh);
    for (a, b) in found.to_f64().into_iter().zip(expected.to_f64()) {
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
    assert_eq!(fresnel_metal(f0, tint, 1.0), f0);
    assert_eq!(fresnel_metal(f0, tint, 0.0), Vec3::splat(1.0));
    for i in 0..=100 {
        let value = fresnel_metal(vec3(0.0, 0.04, 1.0), Vec3::ZERO, f64::from(i) / 100.0);
        assert!(value.to_f64().iter().all(|x| (0.0..=1.0).contains(x)), "{value:?}");
    }
}
