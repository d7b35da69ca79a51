// What the passes read: the twins of the structures in src/gpu/layout.rs and src/optics/material.rs, and the bindings.
#import "scene/environment"

struct Camera {
    // In the geometry's units.
    origin: vec3f,
    // Share of the lens that is open, radius in the geometry's units.
    lens_radius: f32,
    forward: vec3f,
    focus_distance: f32,
    // Half the picture's width and height at distance 1.
    right: vec3f,
    filter_kind: u32,
    up: vec3f,
    reserved: u32,
}

struct Globals {
    camera: Camera,
    image_size: vec2u,
    bounces: u32,
    sequence: u32,
    // Its colour; where the environment is blurred, the sine of the angle.
    background: vec3f,
    background_kind: u32,
    // Cosine and sine.
    environment_rotation: vec2f,
    environment_cells_size: vec2u,
    environment_strength: f32,
    strategy: u32,
    seed: u32,
    node_count: u32,
    // Columns and rows of the table of emitting triangles.
    light_cells_size: vec2u,
    // Probability that the environment is sampled, not an emitting triangle.
    environment_probability: f32,
    // Density per area of the emitting triangles over the luminance of their emission.
    density_per_luminance: f32,
    // The largest radiance of an indirect contribution.
    firefly_clamp: f32,
    reserved: u32,
    reserved_pair: vec2u,
}

// What a dispatch renders of one tile.
struct Tile {
    // Its top left pixel.
    origin: vec2u,
    first_sample: u32,
    sample_count: u32,
}

// Sums of a pixel's colours since the host last took them.
struct PixelColors {
    // With the coverage.
    all: vec4f,
    // The same of the odd samples alone: one of two independent halves.
    odd: vec3f,
    odd_kept: f32,
}

// Other sums over the samples of a pixel since the host last took them; scalars, so that the stride is 24 bytes.
struct PixelStatistics {
    luminance_squared: f32,
    // Samples in the sums.
    kept: f32,
    odd_luminance_squared: f32,
    // Samples that were not sound.
    dropped: f32,
    rays: f32,
    // Luminance that limiting fireflies took.
    clamped: f32,
}

// Sums over a pixel's first samples of what they saw first.
struct GuideSums {
    // Each times what mirrors and glass before it leave of the light.
    albedo: vec3f,
    // How many samples met something.
    hits: f32,
    normal: vec3f,
    // Along the camera's axis, in the geometry's units.
    depth: f32,
}

struct Material {
    base_color: vec3f,
    metalness: f32,
    specular_color: vec3f,
    specular_weight: f32,
    eta: vec3f,
    ior: f32,
    k: vec3f,
    roughness: f32,
    emission: vec3f,
    anisotropy: f32,
    transmission_tint: vec3f,
    transmission_weight: f32,
    // For a length of 1 in the geometry's units.
    absorption: vec3f,
    transmission_roughness: f32,
    rotation_rad: f32,
    lobe: u32,
    curve: u32,
    horizon: u32,
    fresnel: u32,
    curve_table: u32,
    albedo_table: u32,
    inner_albedo_table: u32,
    edge_tint: vec3f,
    opacity: f32,
    coat_color: vec3f,
    coat_weight: f32,
    coat_roughness: f32,
    coat_ior: f32,
    coat_table: u32,
    light_luminance: f32,
    // Base colour, metalness and roughness, normal, emission.
    textures: vec4u,
    opacity_texture: u32,
    alpha_cutoff: f32,
    normal_strength: f32,
    has_rough_tables: u32,
    texture_roughness: f32,
    roughness_table: u32,
    has_vertex_colors: u32,
    reserved: u32,
}

// One use of a picture.
struct TextureRecord {
    u_from_uv: vec3f,
    first_texel: u32,
    v_from_uv: vec3f,
    width: u32,
    height: u32,
    wrap: array<u32, 2>,
    flags: u32,
}

// A triangle to intersect: corner positions as bits, with the corner's vertex index in w.
struct Triangle {
    corners: array<vec4u, 3>,
}

// What shading needs of a vertex besides its position; scalars, so that the stride is 52 bytes.
struct Vertex {
    normal: array<f32, 3>,
    uv: array<f32, 2>,
    second_uv: array<f32, 2>,
    tangent: array<f32, 4>,
    // Linear red and green, then blue and 1, as 16-bit fractions.
    color: array<u32, 2>,
}

// An entry of the alias table over the triangles that emit.
struct LightCell {
    threshold: f32,
    alias_index: u32,
    triangle: u32,
}

@group(0) @binding(0) var<uniform> globals: Globals;
// Five vec4u a node (80 bytes, CWBVH).
@group(0) @binding(1) var<storage, read> nodes: array<vec4u>;
@group(0) @binding(2) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(3) var<storage, read> vertices: array<Vertex>;
@group(0) @binding(4) var<storage, read> triangle_slots: array<u32>;
@group(0) @binding(5) var<storage, read> materials: array<Material>;
// Custom curves and albedo tables.
@group(0) @binding(6) var<storage, read> tables: array<f32>;
@group(0) @binding(7) var environment_map: texture_2d<f32>;
@group(0) @binding(8) var<storage, read> environment_cells: array<AliasCell>;
// Sums over the samples of a pixel since the host last took them: red, green, blue, alpha.
@group(0) @binding(9) var<storage, read_write> color_sums: array<PixelColors>;
@group(0) @binding(10) var<storage, read_write> statistics: array<PixelStatistics>;
@group(0) @binding(11) var<storage, read> light_cells: array<LightCell>;
// What this dispatch renders.
@group(0) @binding(12) var<storage, read> tiles: array<Tile>;
@group(0) @binding(13) var<storage, read> texture_records: array<TextureRecord>;
// The linear values of the 256 sRGB codes as bits, then texels of 4 x 8 bits.
@group(0) @binding(14) var<storage, read> texture_words: array<u32>;

// Pixels along the side of a tile, which is a workgroup.
const TILE_SIDE: u32 = 8u;
@group(0) @binding(15) var<storage, read_write> guide_sums: array<GuideSums>;
