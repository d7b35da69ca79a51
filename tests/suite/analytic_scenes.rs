//! The table of scenes whose picture is known in closed form. The camera looks along one ray, nearly: every pixel has the
//! same value.

use std::f64::consts::PI;

use glam::{DVec3, Vec2};
use glossmith::{
    analysis::quadrature::{gauss_legendre, integrate},
    document::{AreaLight, AreaLightShape, Background, Document, MaterialSettings, Strategy},
    optics::random::Sequence,
    render::Assets,
    scene::{
        Model, ModelSource, Slot, Texture, TextureRef, Wrap,
        environment::{Environment, EnvironmentSource},
        mesh::Mesh,
        texture::TextureTarget,
    },
};

use crate::{
    analytic_bodies::cubes,
    analytic_lobes::lobes,
    analytic_media::media,
    lights::{corners, irradiance},
    renders::{adjust, document, set},
};

/// A row of the table.
pub struct Case {
    pub name: String,
    pub document: Document,
    model: Option<Model>,
    environment: Option<Environment>,
    /// Linear RGB.
    pub expected: [f64; 3],
    /// Those that find the light with an honest variance; the first one is tried in every way.
    pub strategies: &'static [Strategy],
    /// Samples per pixel of a picture of 16 × 16.
    samples: u32,
    /// How many times as many the lobe takes alone, where it finds a light by chance.
    chance: u32,
}

/// Every strategy.
pub const ALL: &[Strategy] = &[Strategy::Mis, Strategy::Lobe, Strategy::Light];
/// One for all: where directions are not drawn from lights, strategies draw the same.
pub const MIS: &[Strategy] = &[Strategy::Mis];
const LOBE: &[Strategy] = &[Strategy::Lobe];
const BY_LOBE: &[Strategy] = &[Strategy::Lobe, Strategy::Mis];
/// Those that look for lights.
pub const BY_LIGHT: &[Strategy] = &[Strategy::Mis, Strategy::Light];

/// A grey base alone.
const GREY: &str = "base.metalness=0 specular.weight=0 base.weight=1 base.color=0.8,0.8,0.8";
/// Only the base.
pub const MATT: &str = "base.metalness=0 specular.weight=0 base.weight=1";
const MIRROR: &str = "base.metalness=1 specular.roughness=0 specular.fresnel=none";
/// Glass without roughness.
pub const CLEAR: &str = "base.metalness=0 transmission.weight=1 specular.roughness=0";

impl Case {
    /// A square seen from straight above in an environment of radiance 1.
    pub fn new(name: impl Into<String>, assignments: &[&str], expected: [f64; 3]) -> Self {
        let mut document = document(ModelSource::Plane, EnvironmentSource::Furnace, assignments);
        document.lighting.background = Background::Transparent;
        document.render.sequence = Sequence::Sobol;
        let mut case = Self {
            name: name.into(),
            document,
            model: None,
            environment: None,
            expected,
            strategies: ALL,
            samples: 64,
            chance: 1,
        };
        case.look([0.0, 3.0, 0.0], [0.0; 3]);
        case
    }

    fn look(&mut self, from: [f64; 3], at: [f64; 3]) {
        let camera = &mut self.document.camera;
        (camera.position, camera.target, camera.fov_deg) = (Some(from), Some(at), 0.1);
    }

    pub fn seen(mut self, from: [f64; 3], at: [f64; 3]) -> Self {
        self.look(from, at);
        self
    }

    pub fn by(mut self, strategies: &'static [Strategy], samples: u32) -> Self {
        (self.strategies, self.samples) = (strategies, samples);
        self
    }

    fn by_chance(mut self, chance: u32) -> Self {
        self.chance = chance;
        self
    }

    /// Takes so many samples that it is rendered by each strategy and in no other way.
    pub fn is_dear(&self) -> bool {
        self.samples > 1280
    }

    /// Samples per pixel.
    pub fn samples_of(&self, strategy: Strategy) -> u32 {
        self.samples * if strategy == Strategy::Lobe { self.chance } else { 1 }
    }

    pub fn of(mut self, mesh: Mesh) -> Self {
        let slots = 1 + mesh.slots.iter().max().copied().unwrap_or(0) as usize;
        self.model = Some(Model {
            name: self.name.clone(),
            mesh,
            slots: vec![Slot::neutral("part"); slots],
            ..Model::default()
        });
        self.document.model = ModelSource::File(self.name.clone().into());
        self
    }

    fn under(mut self, environment: Environment) -> Self {
        self.document.lighting.environment = EnvironmentSource::File(self.name.clone().into());
        self.environment = Some(environment);
        self
    }

    pub fn in_the_dark(mut self) -> Self {
        self.document.lighting.strength = 0.0;
        self
    }

    pub fn with(mut self, change: impl FnOnce(&mut Document)) -> Self {
        change(&mut self.document);
        self
    }

    /// Makes what the document names available.
    pub fn keep(&self, assets: &Assets) {
        if let Some(model) = &self.model {
            assets.keep_model(self.document.model.clone(), model.clone());
        }
        if let Some(environment) = &self.environment {
            assets.keep_environment(self.document.lighting.environment.clone(), environment.clone());
        }
    }
}

/// A rectangle of two triangles that faces `half_v` × `half_u`.
pub fn add_rectangle(mesh: &mut Mesh, center: DVec3, half_u: DVec3, half_v: DVec3, slot: u32) {
    let normal = half_v.cross(half_u).normalize().as_vec3();
    let tangent = half_u.normalize().as_vec3().extend(1.0);
    let [a, b, c, d] = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)]
        .map(|(u, v)| mesh.push_vertex(center + u * half_u + v * half_v, normal, Vec2::ZERO, tangent));
    mesh.push_triangle([a, b, c], slot);
    mesh.push_triangle([a, c, d], slot);
}

/// The six faces of a box, facing outwards or inwards.
pub fn add_box(mesh: &mut Mesh, center: DVec3, half: DVec3, faces_inwards: bool) {
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let along = |axis: usize| DVec3::AXES[axis % 3] * half[axis % 3];
            let (u, v) = (along(axis + 2), along(axis + 1) * side);
            let (u, v) = if faces_inwards { (v, u) } else { (u, v) };
            add_rectangle(mesh, center + side * along(axis), u, v, 0);
        }
    }
}

fn slab(thickness: f64, middles: &[f64]) -> Mesh {
    let mut mesh = Mesh::default();
    for &middle in middles {
        add_box(
            &mut mesh,
            middle * DVec3::Y,
            DVec3::new(1.0, 0.5 * thickness, 1.0),
            false,
        );
    }
    mesh
}

/// Every case.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    cases.extend(planes());
    cases.extend(skies());
    cases.extend(lights());
    cases.extend(rooms());
    cases.extend(glass());
    cases.extend(lobes());
    cases.extend(lens());
    cases.extend(tilts());
    cases.extend(cubes());
    cases.extend(media());
    cases
}

/// Matt, coated and clamped surfaces that see the environment alone.
fn planes() -> Vec<Case> {
    let colored = "base.color=0.6,0.3,0.1";
    // A coat that leaves what is below it as it is; the other has its closed forms in coat_base.rs.
    let coated = "base.color=1,1,1 coat.weight=0.5 coat.color=0.2,0.5,0.8 coat.on_base=off coat.darkening=0";
    // What the coat reflects of this view is lost to what is below it: seen from above by an ior of 1.5, 4 %.
    let coat = |share: f64| [0.2, 0.5, 0.8].map(|color| share + (1.0 - share) * (0.5 + 0.5 * color));
    vec![
        Case::new("matt plane", &[MATT, colored], [1.2, 0.6, 0.2]).with(|document| document.lighting.strength = 2.0),
        Case::new(
            "half a coat that only colours",
            &[MATT, coated, "coat.ior=1"],
            coat(0.0),
        ),
        Case::new(
            "half a smooth coat",
            &[MATT, coated, "coat.ior=1.5 coat.roughness=0"],
            coat(0.02),
        )
        .by(ALL, 256),
    ]
}

/// A map of 16 × 8 texels.
fn map(radiance: impl Fn(u32, u32) -> f32) -> Environment {
    let texels = (0..128)
        .map(|i| [radiance(i % 16, i / 16); 3])
        .map(|[r, g, b]| [r, g, b, 1.0]);
    Environment::from_texels("map", 16, 8, texels.collect()).unwrap()
}

/// The irradiance of a horizontal plane under one row of such a map of radiance 1, all around: its bilinear tent.
fn row_irradiance(row: f64) -> f64 {
    let rule = gauss_legendre(16);
    let tent = |v: f64| (1.0 - (8.0 * v - row - 0.5).abs()).max(0.0);
    let part = |from: f64| {
        integrate(&rule, from / 8.0, (from + 1.0) / 8.0, |v| {
            tent(v) * (PI * v).cos() * (PI * v).sin() * PI
        })
    };
    2.0 * PI * (part(row - 0.5) + part(row + 0.5))
}

fn skies() -> Vec<Case> {
    let reflected = |irradiance: f64| [0.8 / PI * irradiance; 3];
    vec![
        Case::new(
            "plane under one texel",
            &[GREY],
            reflected(50.0 * row_irradiance(1.0) / 16.0),
        )
        .under(map(|x, y| if (x, y) == (5, 1) { 50.0 } else { 0.0 }))
        .by(BY_LIGHT, 3072),
        Case::new("plane under a ring", &[GREY], reflected(row_irradiance(2.0)))
            .under(map(|_, y| if y == 2 { 1.0 } else { 0.0 }))
            .by(ALL, 1280)
            .by_chance(8),
    ]
}

/// The radiance of a horizontal surface of albedo 0.8 under a rectangle of radiance 5.
fn lit(place: DVec3, rectangle: &[DVec3; 4]) -> [f64; 3] {
    [5.0 * 0.8 / PI * irradiance(place, DVec3::Y, rectangle); 3]
}

fn lights() -> Vec<Case> {
    let above = |distance: f64, width: f64, height: f64| AreaLight {
        yaw_deg: 0.0,
        pitch_deg: 90.0,
        distance,
        width,
        height,
        strength: 5.0,
        ..AreaLight::default()
    };
    // The square's bounding radius is √2: light and place in its units.
    let mut cases = Vec::new();
    for (name, light, strategies, samples) in [
        ("small light", above(1.2, 0.8, 0.5), BY_LIGHT, 256),
        ("large light", above(1.2, 3.0, 3.0), ALL, 512),
        ("far light", above(700.0, 300.0, 500.0), BY_LIGHT, 256),
    ] {
        let case = Case::new(name, &[GREY], lit(DVec3::ZERO, &corners(&light)));
        let case = case
            .in_the_dark()
            .with(|document| document.lighting.area_lights = vec![light]);
        cases.push(
            case.seen([4.0, 3.0, 0.0], [0.0; 3])
                .by(strategies, samples)
                .by_chance(8),
        );
    }
    cases.extend(backs(above(0.25, 0.6, 0.6)));
    cases.extend(round_lights(above(1.2, 1.0, 1.0)));
    cases
}

/// A disc, a spot and a sun above a plane of albedo 0.8.
fn round_lights(above: AreaLight) -> Vec<Case> {
    let case = |name: &'static str, irradiance: f64, light: AreaLight, place: [f64; 3]| {
        Case::new(name, &[GREY], [0.8 / PI * irradiance; 3])
            .in_the_dark()
            .with(|document| document.lighting.area_lights = vec![light])
            .seen([4.0, 3.0, 0.0], place)
            .by(BY_LIGHT, 256)
    };
    let disc = AreaLight {
        shape: AreaLightShape::Disc,
        ..above
    };
    let of_disc = PI * 5.0 * 0.5_f64.powi(2) / (0.5_f64.powi(2) + 1.2_f64.powi(2));
    // Half an angle of 20°, bright within 10°; seen from where its light falls under some 16°.
    let spot = AreaLight {
        shape: AreaLightShape::Spot,
        width: 0.002,
        height: 0.002,
        cone_deg: 40.0,
        softness: 0.5,
        strength: 5e5,
        ..above
    };
    let of_spot = |beside: f64| {
        let distance = beside.hypot(1.2);
        let cosine = 1.2 / distance;
        let [inner, outer] = [10.0_f64, 20.0].map(|angle| angle.to_radians().cos());
        let share = ((cosine - outer) / (inner - outer)).clamp(0.0, 1.0).powi(2);
        5e5 * PI * 0.001_f64.powi(2) * share * (cosine / distance).powi(2)
    };
    let sun = AreaLight {
        pitch_deg: 60.0,
        ..AreaLight::sun()
    };
    // Places in the world, where the bounding radius of the square is √2.
    let beside = 0.5;
    let mut edge = case(
        "edge of a spot",
        of_spot(beside / 2.0_f64.sqrt()),
        spot,
        [0.0, 0.0, beside],
    );
    // It falls off within the picture otherwise.
    edge.document.camera.fov_deg = 0.005;
    vec![
        case("disc", of_disc, disc, [0.0; 3]),
        case("spot", of_spot(0.0), spot, [0.0; 3]),
        edge,
        case("sun", PI * 60.0_f64.to_radians().sin(), sun, [0.3, 0.0, 0.3]),
    ]
}

/// Area lights and emitters shine to both sides.
fn backs(light: AreaLight) -> Vec<Case> {
    let (unit_u, unit_v) = (DVec3::X, DVec3::Z);
    // What keeps the middle of the model where the light looks at: black, and small.
    let mut floor = Mesh::default();
    add_rectangle(&mut floor, -DVec3::Y, unit_u, unit_v, 0);
    add_rectangle(&mut floor, DVec3::Y, 0.01 * unit_u, 0.01 * unit_v, 1);
    let radius = 3.0_f64.sqrt();
    let below = AreaLight {
        pitch_deg: -90.0,
        ..light
    };
    let seen_from_floor = corners(&below).map(|corner| corner * radius);
    let back_lit = Case::new("lit by a light's back", &[GREY], lit(-DVec3::Y, &seen_from_floor))
        .of(floor.clone())
        .in_the_dark()
        .with(|document| {
            document.materials.push(MaterialSettings::diffuse("black", [0.0; 3]));
            document.lighting.area_lights = vec![below];
        })
        .seen([3.0, 1.0, 0.0], [0.0, -1.0, 0.0]);
    let back_seen = Case::new("a light's back", &[GREY], [5.0; 3])
        .of(floor)
        .in_the_dark()
        .with(|document| document.lighting.area_lights = vec![below])
        .seen([0.3, -0.9, 0.0], [0.0, -0.25 * radius, 0.0]);
    let mut under_emitter = Mesh::default();
    add_rectangle(&mut under_emitter, DVec3::ZERO, unit_u, unit_v, 0);
    // Faces upwards, away from the floor.
    add_rectangle(&mut under_emitter, 0.8 * DVec3::Y, 0.4 * unit_u, 0.4 * unit_v, 1);
    let emitter = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let emitter = emitter.map(|(u, v)| DVec3::new(0.4 * u, 0.8, 0.4 * v));
    let under = Case::new("lit by an emitter's back", &[GREY], lit(DVec3::ZERO, &emitter))
        .of(under_emitter)
        .in_the_dark()
        .with(|document| {
            let mut shining = MaterialSettings::diffuse("shining", [0.0; 3]);
            set(&mut shining, "emission.strength=5 specular.weight=0");
            document.materials.push(shining);
        })
        .seen([4.0, 3.0, 0.0], [0.0; 3]);
    vec![
        back_lit.by(BY_LIGHT, 256),
        back_seen.by(ALL, 4),
        under.by(BY_LIGHT, 256),
    ]
}

/// A closed room, seen from within.
pub fn room() -> Mesh {
    let mut mesh = Mesh::default();
    add_box(&mut mesh, DVec3::ZERO, DVec3::ONE, true);
    mesh
}

/// Closed rooms whose walls shine: every path meets the same light at every bounce, so that the picture is a geometric
/// series. From the fourth bounce on Russian roulette decides.
fn rooms() -> Vec<Case> {
    let inside = |case: Case| case.of(room()).in_the_dark().seen([0.3, 0.2, 0.1], [-0.4, 0.1, 0.9]);
    let series = |albedo: f64| (1.0 - albedo.powi(65)) / (1.0 - albedo);
    let shining = "emission.color=1,1,1 emission.strength=1";
    let matt = Case::new(
        "matt room",
        &[MATT, shining, "base.color=0.6,0.4,0.2"],
        [0.6, 0.4, 0.2].map(series),
    );
    let metal = Case::new(
        "metal room",
        &[
            "base.metalness=1 specular.fresnel=none specular.roughness=0.4 specular.color=0.6,0.4,0.2",
            shining,
        ],
        [0.6, 0.4, 0.2].map(series),
    );
    // Reflected once nothing is taken, twice and three times half of 1 is left.
    let clamped = Case::new(
        "room with fireflies limited",
        &[GREY, shining],
        [1.0 + 0.8 + 0.5 + 0.5; 3],
    )
    .with(|document| {
        adjust(document, "render.bounces=3 render.firefly_clamp=0.5");
    });
    vec![
        inside(matt).by(BY_LOBE, 1024),
        inside(metal).by(BY_LOBE, 1024),
        inside(clamped).by(LOBE, 4),
    ]
}

/// Slabs seen along their normal.
fn glass() -> Vec<Case> {
    const THICKNESS: f64 = 0.4;
    let radius = (2.0 + 0.25 * THICKNESS * THICKNESS).sqrt();
    let colors = [0.9, 0.6, 0.3];
    let mut cases = Vec::new();
    for (ior, depth, samples) in [(1.0, 0.2, 16), (1.5, 0.2, 2048), (4.0, 0.3, 2048)] {
        let reflected = f64::powi((ior - 1.0) / (ior + 1.0), 2);
        // Reflections between front and back add up to a geometric series.
        let expected = colors.map(|color: f64| {
            let passed = color.powf(THICKNESS / radius / depth);
            reflected + (1.0 - reflected).powi(2) * passed / (1.0 - reflected * passed)
        });
        let tinted = format!("transmission.color=0.9,0.6,0.3 specular.ior={ior} transmission.depth={depth}");
        let case = Case::new(format!("slab of {ior}"), &[CLEAR, &tinted], expected);
        cases.push(case.of(slab(THICKNESS, &[0.0])).by(MIS, samples));
    }
    // Four faces, each of which reflects 36 %: light from above is reflected, from below there is none.
    let one = 0.36;
    let stack = 4.0 * one / (1.0 + 3.0 * one);
    let panes = Case::new("two panes", &[CLEAR, "specular.ior=4"], [stack; 3]);
    let panes = panes
        .of(slab(0.1, &[-0.4, 0.4]))
        .under(map(|_, y| if y < 4 { 1.0 } else { 0.0 }));
    cases.push(panes.by(MIS, 3072));
    cases
}

/// A square that shines in the middle of its circle of confusion, in models of two scales: the share of the lens that sees
/// it.
fn lens() -> Vec<Case> {
    const HALF: f64 = 0.1;
    const BLUR: f64 = 0.16;
    let case = |scale: f64| {
        let expected = (2.0 * HALF).powi(2) / (PI * BLUR * BLUR);
        let mut mesh = Mesh::default();
        let half = HALF * scale;
        add_rectangle(&mut mesh, DVec3::ZERO, half * DVec3::X, half * DVec3::Z, 0);
        let shining = "base.color=0,0,0 emission.color=1,1,1 emission.strength=1";
        Case::new(
            format!("out of focus at scale {scale}"),
            &[MATT, shining],
            [expected; 3],
        )
        .of(mesh)
        .in_the_dark()
        .with(|document| {
            // Twice as far as what is sharp, a place is as blurred as the lens is wide.
            document.camera.focus_distance = Some(2.0 * scale);
            document.camera.aperture = BLUR / (HALF * 2.0_f64.sqrt());
        })
        .seen([0.0, 4.0 * scale, 0.0], [0.0; 3])
        .by(MIS, 4096)
    };
    vec![case(1.0), case(37.0)]
}

/// A mirror whose normals a texture tilts, under radiance 1.5 + x: the strength scales the slope.
fn tilts() -> Vec<Case> {
    let texel = |i: u32| {
        let (u, v) = ((f64::from(i % 512) + 0.5) / 512.0, (f64::from(i / 512) + 0.5) / 256.0);
        let x = (PI * v).sin() * (2.0 * PI * u).sin();
        [(1.5 + x) as f32, 1.5, 1.5, 1.0]
    };
    let map = Environment::from_texels("slope", 512, 256, (0..512 * 256).map(texel).collect()).unwrap();
    let mut model = glossmith::import::load(&ModelSource::Plane).unwrap();
    let codes = [204_u8, 128, 230];
    model.textures = vec![Texture {
        name: "tilt".to_owned(),
        width: 2,
        height: 2,
        rgba8: [codes[0], codes[1], codes[2], 255].repeat(4),
        rgba16: Vec::new(),
    }];
    *model.slots[0].texture_mut(TextureTarget::Normal) = Some(TextureRef {
        texture: 0,
        uv_set: 0,
        texture_from_mesh_uv: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        wrap: [Wrap::Repeat; 2],
        filter: Default::default(),
    });
    let [x, across, up] = codes.map(|code| f64::from(code) / 127.5 - 1.0);
    let case = |strength: f64| {
        let normal = DVec3::new(strength * x, up, -strength * across).normalize();
        let mirrored = 2.0 * normal.y * normal - DVec3::Y;
        let set = format!("geometry.normal_strength={strength}");
        let mut case = Case::new(
            format!("normals tilted by {strength}"),
            &[MIRROR, &set],
            [1.5 + mirrored.x, 1.5, 1.5],
        );
        case.model = Some(model.clone());
        case.document.model = ModelSource::File("tilted".into());
        case.document.materials[0].textures[TextureTarget::Normal] = true;
        case.under(map.clone()).by(ALL, 4)
    };
    [0.0, 0.5, 1.0].map(case).into()
}
