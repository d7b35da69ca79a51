//! Handles of area lights: where they are in the image, and what pulling one makes of the light.

use glam::{DVec2, DVec3};

use super::motion::{Pull, View, move_along, move_in_plane, put_at, vector};
use crate::document::{AreaLight, range};
use crate::named::named;

/// Degrees to which angles snap.
const SNAP_DEG: f64 = 15.0;
/// Bounding radii to which lengths snap.
const SNAP_LENGTH: f64 = 0.1;
/// Points over which a distance or a cone's angle changes by a factor of e.
const POINTS_PER_E: f64 = 120.0;
/// Least distance between the middles of two handles, points.
const APART: f64 = 20.0;
/// A step along an axis that says where its handle is, in distances of the light from its target; and how far that is at
/// least in the image for it to have one, points.
const AXIS_STEP: f64 = 0.1;
const AXIS_SEEN: f64 = 3.0;
/// From the light's middle to handles that stand for no place, points.
const ARM: f64 = 46.0;

named! {
    /// A part of a light that can be taken hold of.
    LightHandle {
        Direction, "direction", "Move", "Moves the light around its target, or away from it where it is pulled farther; with ctrl in steps of 15°, with shift finely.";
        Width, "width", "Width", "Makes the light wider or narrower; the sun larger.";
        Height, "height", "Height", "Makes the light higher or lower.";
        Distance, "distance", "Distance", "Moves the light to its target or away from it.";
        Turn, "turn", "Turn", "Turns the light about the line to its target.";
        Cone, "cone", "Cone", "Opens or closes the cone of a spot.";
        InPlane, "in the plane", "In the plane", "Moves the light in the plane of the image. It goes on looking at its target.";
        AlongX, "along x", "Along x", "Moves the light along x, to the right of the model. It goes on looking at its target.";
        AlongY, "along y", "Along y", "Moves the light up or down. It goes on looking at its target.";
        AlongZ, "along z", "Along z", "Moves the light along z, before the model. It goes on looking at its target.";
    }
}

impl LightHandle {
    /// The axis along which it moves the light, if it does.
    pub fn axis(self) -> Option<DVec3> {
        match self {
            Self::AlongX => Some(DVec3::X),
            Self::AlongY => Some(DVec3::Y),
            Self::AlongZ => Some(DVec3::Z),
            _ => None,
        }
    }

    /// What it is called of a light.
    pub fn full_name(self, light: &str) -> String {
        match self {
            Self::Direction => format!("Move {light}"),
            Self::InPlane | Self::AlongX | Self::AlongY | Self::AlongZ => format!("Move {light} {}", self.name()),
            _ => format!("{} handle of {light}", self.label()),
        }
    }
}

/// The handles of a light and where they are: one alone, at the image's edge, where the light is not in the image.
pub fn handles(light: &AreaLight, view: &View, margin: f64) -> Vec<(LightHandle, DVec2)> {
    let shape = light.shape();
    let frame = shape.frame();
    let Some(middle) = view.seen_inside(frame.middle) else {
        return vec![(LightHandle::Direction, view.edge_towards(frame.middle, margin))];
    };
    let towards = |place: DVec3, otherwise: DVec2| {
        let arm = view.seen(place).unwrap_or(middle) - middle;
        (arm.try_normalize().unwrap_or(otherwise), arm.length())
    };
    let (across, half_width) = towards(frame.middle + 0.5 * shape.width * frame.across, DVec2::X);
    let (up, half_height) = towards(frame.middle + 0.5 * shape.height * frame.up, DVec2::NEG_Y);
    let (ahead, _) = towards(shape.target.into(), DVec2::Y);
    let mut placed = vec![(LightHandle::Direction, middle)];
    let mut put = |handle, along: DVec2, length: f64| {
        let mut length = length.max(APART);
        while placed
            .iter()
            .any(|(_, at)| at.distance(middle + length * along) < APART)
        {
            length += 0.25 * APART;
        }
        placed.push((handle, middle + length * along));
    };
    put(LightHandle::Width, across, half_width);
    if !light.is_sun() {
        if !light.is_sphere() {
            put(LightHandle::Height, up, half_height);
        }
        put(LightHandle::Distance, ahead, ARM);
        put(LightHandle::Turn, -up, half_height.max(APART) + APART);
    }
    if light.is_spot() {
        put(LightHandle::Cone, ahead.perp(), ARM);
    }
    if !light.is_sun() {
        for handle in [LightHandle::AlongX, LightHandle::AlongY, LightHandle::AlongZ] {
            let axis = handle.axis().unwrap_or_default();
            let (along, length) = towards(frame.middle + AXIS_STEP * shape.distance * axis, DVec2::ZERO);
            // Towards the viewer there is nothing to be pulled.
            if length > AXIS_SEEN {
                put(handle, along, ARM);
            }
        }
        put(LightHandle::InPlane, DVec2::ONE.normalize(), APART);
    }
    placed
}

/// The light after a pull of a handle that began when it was as given.
pub fn pulled(light: &AreaLight, handle: LightHandle, view: &View, pull: &Pull) -> AreaLight {
    let mut moved = *light;
    let middle = view.seen_inside(light.shape().frame().middle);
    let at = handles(light, view, 0.0).into_iter().find(|(of, _)| *of == handle);
    let arm = match (middle, at) {
        (Some(middle), Some((_, at))) => at - middle,
        _ => DVec2::ZERO,
    };
    let by = pull.to - pull.from;
    let along = by.dot(arm.normalize_or_zero());
    // How far the handle was pulled, in lengths of its arm.
    let factor = (1.0 + along / arm.length().max(1.0)).max(0.01);
    let length = |length: f64| {
        let (least, most) = range::AREA_LENGTH.into_inner();
        snapped(length, SNAP_LENGTH, pull.snaps).clamp(least, most)
    };
    match handle {
        LightHandle::Direction => move_around(&mut moved, view, middle, pull),
        LightHandle::InPlane => move_in_plane(&mut moved, view, pull),
        LightHandle::AlongX | LightHandle::AlongY | LightHandle::AlongZ => {
            move_along(&mut moved, handle.axis().unwrap_or_default(), view, pull);
        }
        LightHandle::Width if light.is_sun() => {
            let (least, most) = range::SUN_ANGLE_DEG.into_inner();
            moved.angle_deg = snapped(light.angle_deg * factor, SNAP_LENGTH, pull.snaps).clamp(least, most);
        }
        LightHandle::Width => moved.width = length(light.width * factor),
        LightHandle::Height => moved.height = length(light.height * factor),
        LightHandle::Distance => moved.distance = length(light.distance * (-along / POINTS_PER_E).exp()),
        LightHandle::Turn => {
            let Some(middle) = middle else { return moved };
            let angle_deg = (pull.from - middle).angle_to(pull.to - middle).to_degrees();
            let sign = if faces_viewer(light, view) { 1.0 } else { -1.0 };
            moved.turn_deg = wrapped_deg(snapped(light.turn_deg + sign * angle_deg, SNAP_DEG, pull.snaps));
        }
        LightHandle::Cone => {
            let (least, most) = range::CONE_DEG.into_inner();
            let cone_deg = light.cone_deg * (along / POINTS_PER_E).exp();
            moved.cone_deg = snapped(cone_deg, 0.1 * SNAP_DEG, pull.snaps).clamp(least, most);
        }
    }
    moved
}

/// The light after steps of the arrow keys, to the right and upwards, on a handle: degrees, or hundredths of a length.
pub fn nudged(light: &AreaLight, handle: LightHandle, steps: DVec2) -> AreaLight {
    let mut moved = *light;
    let sum = steps.x + steps.y;
    let scaled = |value: f64, range: std::ops::RangeInclusive<f64>| {
        let (least, most) = range.into_inner();
        (value * 1.01_f64.powf(sum)).clamp(least, most)
    };
    match handle {
        LightHandle::Direction => {
            moved.yaw_deg = wrapped_deg(light.yaw_deg + steps.x);
            moved.pitch_deg = (light.pitch_deg + steps.y).clamp(-90.0, 90.0);
        }
        LightHandle::Width if light.is_sun() => moved.angle_deg = scaled(light.angle_deg, range::SUN_ANGLE_DEG),
        LightHandle::Width => moved.width = scaled(light.width, range::AREA_LENGTH),
        LightHandle::Height => moved.height = scaled(light.height, range::AREA_LENGTH),
        LightHandle::Distance => moved.distance = scaled(light.distance, range::AREA_LENGTH),
        LightHandle::Turn => moved.turn_deg = wrapped_deg(light.turn_deg + sum),
        LightHandle::Cone => moved.cone_deg = scaled(light.cone_deg, range::CONE_DEG),
        LightHandle::InPlane => put_at(&mut moved, light.shape().frame().middle + 0.01 * steps.extend(0.0)),
        LightHandle::AlongX | LightHandle::AlongY | LightHandle::AlongZ => {
            let axis = handle.axis().unwrap_or_default();
            put_at(&mut moved, light.shape().frame().middle + 0.01 * sum * axis);
        }
    }
    moved
}

/// Moves a light so that it is under the pointer: over the sphere around its target, on the side that it was on, or where
/// the pointer is beside that sphere, farther away from the target. One that was not in the image comes into it.
fn move_around(light: &mut AreaLight, view: &View, middle: Option<DVec2>, pull: &Pull) {
    let shape = light.shape();
    let (frame, distance) = (shape.frame(), shape.distance);
    let target = frame.middle - distance * frame.outwards;
    // Along the ray through a point: where the target is beside it, and how far from there the sphere is.
    let nearest = |at: DVec2| {
        let [origin, along] = view.ray(at);
        let half = (target - origin).dot(along);
        (
            origin,
            along,
            half,
            half * half - (origin - target).length_squared() + distance * distance,
        )
    };
    let is_far = match middle {
        Some(middle) => {
            let (origin, _, half, _) = nearest(middle);
            frame.middle.distance(origin) > half
        }
        None => frame.outwards.dot(vector(view.camera.forward.to_f64())) > 0.0,
    };
    let (origin, along, half, below_root) = nearest(middle.unwrap_or(pull.from) + pull.to - pull.from);
    let root = below_root.max(0.0).sqrt();
    let hits_sphere = below_root >= 0.0;
    let (t, is_on_sphere) = match half - root {
        near if near > 0.0 && !is_far => (near, hits_sphere),
        // It was behind the camera: it stays on the viewer's side of the target.
        _ if !is_far && half > 0.0 && !light.is_sun() => (0.5 * half, false),
        _ => (half + root, hits_sphere),
    };
    // With the target behind the camera nothing that is seen is nearest to it.
    let (t, is_on_sphere) = if t > 0.0 { (t, is_on_sphere) } else { (distance, false) };
    let away = origin + t * along - target;
    light.look_from(away.normalize_or(frame.outwards));
    // On the sphere the distance is what it was, to the last digit.
    if !light.is_sun() && !is_on_sphere {
        let (least, most) = range::AREA_LENGTH.into_inner();
        light.distance = away.length().clamp(least, most);
    }
    light.yaw_deg = snapped(light.yaw_deg, SNAP_DEG, pull.snaps);
    light.pitch_deg = snapped(light.pitch_deg, SNAP_DEG, pull.snaps);
}

/// Whether the viewer sees the side of a light that looks at its target.
fn faces_viewer(light: &AreaLight, view: &View) -> bool {
    let frame = light.shape().frame();
    (vector(view.camera.origin.to_f64()) - frame.middle).dot(frame.outwards) < 0.0
}

fn snapped(value: f64, step: f64, snaps: bool) -> f64 {
    if snaps { (value / step).round() * step } else { value }
}

/// In [−180, 180).
fn wrapped_deg(angle: f64) -> f64 {
    (angle + 180.0).rem_euclid(360.0) - 180.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::AreaLightShape;
    use crate::scene::camera::{Camera, PixelFilter};

    fn view() -> View {
        View {
            camera: Camera::look_at([0.0, 0.0, 8.0], [0.0; 3], 60.0, 1.5, PixelFilter::Box),
            size: DVec2::new(600.0, 400.0),
        }
    }

    fn pull(from: DVec2, by: DVec2) -> Pull {
        Pull {
            from,
            to: from + by,
            snaps: false,
        }
    }

    fn middle(light: &AreaLight) -> Option<DVec2> {
        view().seen_inside(light.shape().frame().middle)
    }

    #[test]
    fn a_light_stays_under_the_pointer_in_front_and_behind() {
        for yaw_deg in [-30.0, 10.0, 160.0, 200.0] {
            let light = AreaLight {
                yaw_deg,
                pitch_deg: 20.0,
                ..AreaLight::default()
            };
            let at = middle(&light).expect("it is in the image");
            // Wherever on the mark it was taken hold of.
            let grabbed = at + DVec2::new(3.0, -2.0);
            let by = DVec2::new(25.0, -30.0);
            let moved = pulled(&light, LightHandle::Direction, &view(), &pull(grabbed, by));
            let now = middle(&moved).expect("it still is");
            assert!(now.distance(at + by) < 1e-6, "yaw {yaw_deg}: {at} to {now}");
            assert_eq!(moved.distance, light.distance);
            assert_eq!(
                pulled(&light, LightHandle::Direction, &view(), &pull(grabbed, DVec2::ZERO)).width,
                light.width
            );
        }
    }

    #[test]
    fn a_light_stays_under_the_pointer_in_parallel_rays() {
        let view = View {
            camera: view().camera.orthographic(1.0),
            ..view()
        };
        for (yaw_deg, distance) in [(-30.0, 3.0), (160.0, 2.0)] {
            let light = AreaLight {
                yaw_deg,
                distance,
                ..AreaLight::default()
            };
            let at = view
                .seen_inside(light.shape().frame().middle)
                .expect("it is in the image");
            let by = DVec2::new(25.0, -30.0);
            let moved = pulled(&light, LightHandle::Direction, &view, &pull(at, by));
            let now = view.seen_inside(moved.shape().frame().middle).expect("it still is");
            assert!(now.distance(at + by) < 1e-6, "yaw {yaw_deg}: {at} to {now}");
        }
    }

    #[test]
    fn a_light_beside_the_picture_comes_to_the_pointer() {
        for yaw_deg in [60.0, 120.0] {
            let light = AreaLight {
                yaw_deg,
                distance: 30.0,
                ..AreaLight::default()
            };
            assert_eq!(middle(&light), None);
            let [(handle, at)] = handles(&light, &view(), 12.0)[..] else {
                panic!("one handle")
            };
            assert!(
                at.x > 400.0 && at.x <= 588.0 + 1e-6 && at.y >= 12.0 - 1e-6,
                "at an edge, to the right: {at}"
            );
            let by = DVec2::new(-60.0, 20.0);
            let moved = pulled(&light, handle, &view(), &pull(at, by));
            let now = middle(&moved).expect("it is in the image");
            assert!(now.distance(at + by) < 1e-6, "{now} instead of {}", at + by);
            assert_eq!(moved.yaw_deg.abs() > 90.0, yaw_deg > 90.0, "{yaw_deg}: {moved:?}");
        }
    }

    #[test]
    fn a_light_behind_the_camera_comes_before_it_and_stays_on_its_side() {
        let light = AreaLight {
            yaw_deg: 0.0,
            pitch_deg: 10.0,
            distance: 30.0,
            ..AreaLight::default()
        };
        assert_eq!(middle(&light), None);
        let [(handle, at)] = handles(&light, &view(), 12.0)[..] else {
            panic!("one handle")
        };
        let by = DVec2::new(40.0, 60.0);
        let moved = pulled(&light, handle, &view(), &pull(at, by));
        assert!(middle(&moved).expect("it is in the image").distance(at + by) < 1e-6);
        assert!(moved.yaw_deg.abs() < 90.0 && moved.distance < 8.0, "{moved:?}");
    }

    #[test]
    fn a_light_pulled_beside_its_sphere_goes_away_from_its_target() {
        let light = AreaLight {
            yaw_deg: 20.0,
            pitch_deg: 0.0,
            distance: 1.0,
            ..AreaLight::default()
        };
        let at = middle(&light).expect("it is in the image");
        let by = DVec2::new(200.0, -90.0);
        let moved = pulled(&light, LightHandle::Direction, &view(), &pull(at, by));
        assert!(middle(&moved).expect("it still is").distance(at + by) < 1e-6);
        assert!(moved.distance > 1.5, "{moved:?}");
    }

    fn place_of_handle(light: &AreaLight, handle: LightHandle) -> DVec2 {
        let of_light = handles(light, &view(), 0.0).into_iter();
        of_light
            .filter(|(of, _)| *of == handle)
            .map(|(_, at)| at)
            .next()
            .expect("it has one")
    }

    #[test]
    fn the_edge_of_a_light_follows_its_handle() {
        let light = AreaLight {
            yaw_deg: 0.0,
            pitch_deg: 0.0,
            distance: 2.0,
            turn_deg: 20.0,
            ..AreaLight::default()
        };
        for handle in [LightHandle::Width, LightHandle::Height] {
            let at = place_of_handle(&light, handle);
            let arm = at - middle(&light).expect("it is there");
            let larger = pulled(&light, handle, &view(), &pull(at, 0.5 * arm));
            let sizes = |light: &AreaLight| match handle {
                LightHandle::Width => (light.width, light.height),
                _ => (light.height, light.width),
            };
            assert!(
                (sizes(&larger).0 - 1.5).abs() < 1e-9 && sizes(&larger).1 == 1.0,
                "{handle:?}: {larger:?}"
            );
            let now = place_of_handle(&larger, handle);
            assert!(now.distance(at + 0.5 * arm) < 1e-6, "{handle:?} is at {now}");
            // Through the middle it does not turn inside out.
            assert!(sizes(&pulled(&light, handle, &view(), &pull(at, -3.0 * arm))).0 > 0.0);
        }
    }

    #[test]
    fn turns_distances_and_cones_follow_their_handles() {
        let light = AreaLight {
            yaw_deg: 180.0,
            pitch_deg: 0.0,
            ..AreaLight::spot()
        };
        let center = middle(&light).expect("it is there");
        // Seen from the target's side, a quarter clockwise.
        let quarter = Pull {
            from: center + 30.0 * DVec2::NEG_Y,
            to: center + 30.0 * DVec2::X,
            snaps: false,
        };
        assert!((pulled(&light, LightHandle::Turn, &view(), &quarter).turn_deg - 90.0).abs() < 1e-9);
        let front = AreaLight { yaw_deg: 0.0, ..light };
        assert!((pulled(&front, LightHandle::Turn, &view(), &quarter).turn_deg + 90.0).abs() < 1e-9);
        let of = |handle| place_of_handle(&light, handle);
        for (handle, value) in [
            (
                LightHandle::Distance,
                (|light| -light.distance) as fn(&AreaLight) -> f64,
            ),
            (LightHandle::Cone, |light| light.cone_deg),
        ] {
            let arm = of(handle) - center;
            let out = pulled(&light, handle, &view(), &pull(of(handle), arm));
            assert!(value(&out) > value(&light), "{handle:?}: {out:?}");
        }
        let tip = handles(&light, &view(), 0.0);
        for (index, (_, a)) in tip.iter().enumerate() {
            assert!(tip[..index].iter().all(|(_, b)| a.distance(*b) >= 12.0), "{tip:?}");
        }
    }

    #[test]
    fn lights_snap_to_round_numbers() {
        let light = AreaLight {
            yaw_deg: 7.0,
            pitch_deg: 11.0,
            ..AreaLight::default()
        };
        let at = middle(&light).expect("it is there");
        let snap = Pull {
            snaps: true,
            ..pull(at, DVec2::new(9.0, 5.0))
        };
        let moved = pulled(&light, LightHandle::Direction, &view(), &snap);
        assert_eq!((moved.yaw_deg % 15.0, moved.pitch_deg % 15.0), (0.0, 0.0));
    }

    #[test]
    fn a_sun_has_two_handles_and_turns_around_the_model() {
        let sun = AreaLight {
            yaw_deg: 180.0,
            pitch_deg: 5.0,
            ..AreaLight::sun()
        };
        let at = handles(&sun, &view(), 0.0);
        assert_eq!(at.len(), 2, "{at:?}");
        let moved = pulled(
            &sun,
            LightHandle::Direction,
            &view(),
            &pull(at[0].1, DVec2::new(40.0, 0.0)),
        );
        assert!(
            middle(&moved)
                .expect("it is there")
                .distance(at[0].1 + DVec2::new(40.0, 0.0))
                < 0.5
        );
        let larger = pulled(&sun, LightHandle::Width, &view(), &pull(at[1].1, at[1].1 - at[0].1));
        assert!((larger.angle_deg - 2.0 * sun.angle_deg).abs() < 1e-9);
        assert_eq!(larger.shape, AreaLightShape::Sun);
    }

    fn place_of(light: &AreaLight) -> DVec3 {
        light.shape().frame().middle
    }

    /// The light stays under the pointer, in the plane or on the line, and looks at its target.
    #[test]
    fn a_light_follows_the_pointer_in_its_plane_and_along_its_axes() {
        let camera = Camera::look_at([2.0, 3.0, 8.0], [0.0; 3], 60.0, 1.5, PixelFilter::Box);
        for camera in [camera, camera.orthographic(1.0)] {
            let view = View {
                camera,
                size: DVec2::new(600.0, 400.0),
            };
            let light = AreaLight {
                yaw_deg: 20.0,
                target: [0.1, 0.2, 0.0],
                ..AreaLight::default()
            };
            let seen = |light: &AreaLight| view.seen(place_of(light)).expect("it is before the camera");
            for (handle, from) in handles(&light, &view, 0.0) {
                let arm = from - seen(&light);
                let pull = Pull {
                    from: seen(&light),
                    to: seen(&light) + 0.5 * arm,
                    snaps: false,
                };
                let moved = pulled(&light, handle, &view, &pull);
                let by = place_of(&moved) - place_of(&light);
                let forward = DVec3::from_array(view.camera.forward.to_f64());
                match handle {
                    LightHandle::InPlane => assert!(by.dot(forward).abs() < 1e-9 && by.length() > 0.01, "{by}"),
                    _ if handle.axis().is_some() => {
                        let axis = handle.axis().unwrap_or_default();
                        assert!(
                            by.dot(axis) > 0.01 && by.cross(axis).length() < 1e-9,
                            "{handle:?}: {by}"
                        );
                    }
                    _ => continue,
                }
                assert!(
                    seen(&moved).distance(pull.to) < 1e-6,
                    "{handle:?} is not under the pointer"
                );
                assert_eq!((moved.target, moved.width), (light.target, light.width));
            }
        }
    }

    #[test]
    fn keys_do_what_pulls_do() {
        let light = AreaLight::default();
        let right = nudged(&light, LightHandle::Direction, DVec2::new(1.0, -2.0));
        assert_eq!((right.yaw_deg, right.pitch_deg), (-34.0, 38.0));
        for handle in LightHandle::ALL {
            let there = nudged(&AreaLight::spot(), *handle, DVec2::new(2.0, 0.0));
            assert_ne!(there, AreaLight::spot(), "{handle:?}");
            let back = nudged(&there, *handle, DVec2::new(-2.0, 0.0));
            assert!((back.width - 0.3).abs() + (back.yaw_deg + 35.0).abs() + (back.cone_deg - 40.0).abs() < 1e-9);
        }
    }
}
