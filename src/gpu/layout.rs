//! The structures that the GPU reads, byte for byte as in `shaders/scene/layout.wgsl` and `shaders/pass/path_trace.wgsl`; a
//! test compares the two.

use crate::job::{BackgroundKind, Settings, plain};
use crate::scene::{Geometry, Part, camera::Camera, medium::NO_MEDIUM};

/// Tiles in a row of the texture that lists them.
pub const TILE_COLUMNS: u32 = 256;

/// The kinds of background by their names in WGSL; the shaders know them by their places here.
pub const BACKGROUNDS: [&str; 4] = ["ENVIRONMENT", "TRANSPARENT", "COLOR", "BLURRED"];

plain! {
    /// The uniforms of a job.
    struct Globals {
        /// See [`Camera`].
        camera: Camera<f32>,
        /// Width and height in pixels.
        image_size: [u32; 2],
        /// Reflections a path may have.
        bounces: u32,
        sequence: u32,
        /// Linear background colour; for a blurred environment (sine of the blur angle, 0, 0).
        background: [f32; 3],
        /// 0 environment, 1 transparent, 2 colour, 3 environment blurred.
        background_kind: u32,
        /// Cosine and sine of the rotation.
        environment_rotation: [f32; 2],
        /// Columns and rows of the environment's cells.
        environment_cells_size: [u32; 2],
        /// Factor of the environment's radiance.
        environment_strength: f32,
        strategy: u32,
        /// Changes all random numbers.
        seed: u32,
        /// Number of nodes; 0 for an empty scene.
        node_count: u32,
        /// Columns and rows of the table of emitting triangles.
        light_cells_size: [u32; 2],
        /// Probability that the environment is sampled, not an emitting triangle.
        environment_probability: f32,
        /// Density per area of the emitting triangles over the luminance of their emission.
        density_per_luminance: f32,
        /// The largest radiance of an indirect contribution.
        firefly_clamp: f32,
        /// Slot of the shadow catcher; no material's without one.
        catcher_slot: u32,
        /// Slot of the catcher's reflection; no material's without a catcher.
        catcher_reflection_slot: u32,
        /// Start of the catcher's table.
        catcher_table: u32,
        /// Light that was reflected less often does not count.
        least_reflections: u32,
        /// First node of the surroundings' hierarchy; 0 without one.
        around_root: u32,
        /// First triangle of the surroundings.
        around_triangle: u32,
        /// Slot of the medium around the camera, or [`NO_MEDIUM`].
        camera_medium: u32,
        /// See [`Settings::first_hidden_slot`].
        first_hidden_slot: u32,
        /// See [`Settings::light_groups`].
        light_groups: u32,
        /// 1: coarse triangles are rounded according to their normals.
        rounds_surfaces: u32,
        /// Early roulette is played below this throughput alone.
        roulette_floor: f32,
    }
}

plain! {
    /// A tile of a dispatch.
    #[derive(Default)]
    struct Tile {
        /// Top left pixel.
        origin: [u32; 2],
        /// Index of the first sample.
        first_sample: u32,
        /// Samples per pixel.
        sample_count: u32,
    }
}

plain! {
    /// Sums of a pixel's colours since the host last took them.
    struct PixelColors {
        /// Linear red, green, blue and the coverage.
        all: [f32; 4],
        /// Red, green and blue of the odd samples, and how many of these are in the sums.
        odd: [f32; 4],
    }

    /// Other sums over the samples of a pixel since the host last took them.
    struct PixelStatistics {
        /// Sum of the squared luminance, and of that of the odd samples.
        luminance_squared: [f32; 2],
        /// Samples in the sums, and samples that were not sound.
        kept_dropped: [f32; 2],
        /// Rays traced, and luminance that limiting fireflies took.
        rays_clamped: [f32; 2],
        /// Luminance of the throughput of paths that ended at their last bounce.
        cut: f32,
        /// To a multiple of 8 bytes.
        unused: f32,
    }
}

/// [`Globals::node_count`], [`Globals::around_root`] and [`Globals::around_triangle`].
pub fn hierarchies(geometry: &Geometry) -> [u32; 3] {
    let parts = geometry.whole_parts();
    let [model, around] = parts.map(|(part, _)| part.compressed().nodes.len() as u32);
    let root = if around == 0 { 0 } else { model };
    [model + around, root, parts[1].1 as u32]
}

impl Globals {
    /// The uniforms of a job.
    pub fn new(settings: &Settings, geometry: &Geometry, environment_cells_size: [u32; 2]) -> Self {
        let (background_kind, background) = match settings.background {
            BackgroundKind::Environment => (0, [0.0; 3]),
            BackgroundKind::Transparent => (1, [0.0; 3]),
            BackgroundKind::Color(color) => (2, color),
            BackgroundKind::Blurred(sine) => (3, [sine as f32, 0.0, 0.0]),
        };
        let [node_count, around_root, around_triangle] = hierarchies(geometry);
        let [catcher_slot, catcher_reflection_slot, catcher_table] =
            settings.catcher.map_or([u32::MAX, u32::MAX, 0], |catcher| {
                [catcher.slot, catcher.reflection_slot, catcher.table]
            });
        Self {
            camera: settings.camera.cast(),
            image_size: settings.image_size,
            bounces: settings.bounces,
            sequence: settings.sequence as u32,
            background,
            background_kind,
            environment_rotation: settings.environment_rotation.map(|x| x as f32),
            environment_cells_size,
            environment_strength: settings.environment_strength as f32,
            strategy: settings.strategy as u32,
            seed: settings.seed,
            node_count,
            light_cells_size: settings.light_choice.cells_size,
            environment_probability: settings.light_choice.environment_probability as f32,
            density_per_luminance: settings.light_choice.density_per_luminance as f32,
            firefly_clamp: settings.firefly_clamp.min(f64::from(f32::MAX)) as f32,
            catcher_slot,
            catcher_reflection_slot,
            catcher_table,
            least_reflections: settings.least_reflections,
            around_root,
            around_triangle,
            camera_medium: settings.camera_medium.unwrap_or(NO_MEDIUM),
            first_hidden_slot: settings.first_hidden_slot,
            light_groups: settings.light_groups,
            rounds_surfaces: u32::from(settings.rounds_surfaces),
            roulette_floor: settings.roulette_floor as f32,
        }
    }
}

plain! {
    /// A triangle to intersect: corner positions, each with the corner's vertex index.
    struct Triangle {
        /// x, y, z as bits, then the index.
        corners: [[u32; 4]; 3],
    }
}

/// The triangle at a place in the order of [`Compressed::triangles`](crate::scene::Compressed).
pub fn triangle(part: &Part, place: usize) -> Triangle {
    let triangle = part.compressed().triangles[place];
    Triangle {
        corners: part.triangles[triangle as usize].map(|vertex: u32| {
            let [x, y, z] = part.positions[vertex as usize].map(f32::to_bits);
            [x, y, z, vertex]
        }),
    }
}
