// What the passes read: the twins of the structures in src/gpu/layout.rs and src/optics/material/mod.rs, and the bindings.
#import "scene/texels"

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
    // The slots of the shadow catcher and of what it reflects with, and where its table begins.
    catcher_slot: u32,
    catcher_reflection_slot: u32,
    catcher_table: u32,
    // Light that was reflected less often does not count.
    least_reflections: u32,
    // Where the hierarchy of what is around the model begins; 0 where there is no second one.
    around_root: u32,
    // Where the triangles of what is around the model begin.
    around_triangle: u32,
    // The slot of the solid around the camera.
    camera_medium: u32,
    // To a multiple of 16 bytes.
    unused: vec2u,
    // 1: coarse triangles are taken as the round surfaces that their normals tell of.
    rounds_surfaces: u32,
    // Paths of few bounces at what is no mirror or clear glass play roulette below this throughput alone.
    roulette_floor: f32,
}

// Bits of a material's flags: what vertices say, and whether weight and tint of the reflection leave metals alone.
const VERTEX_BASE: u32 = 1u;
const VERTEX_EMISSION: u32 = 2u;
const VERTEX_OPACITY: u32 = 4u;
const SPARES_METAL: u32 = 8u;

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
    // Base colour, roughness, normal, emission.
    textures: vec4u,
    opacity_texture: u32,
    alpha_cutoff: f32,
    normal_strength: f32,
    has_rough_tables: u32,
    texture_roughness: f32,
    roughness_table: u32,
    // VERTEX_BASE and the others.
    flags: u32,
    // The ramp of a spot's share over the cosine to the way it faces.
    spot_scale: f32,
    spot_offset: f32,
    metalness_texture: u32,
    coat_texture: u32,
    has_box_projection: u32,
}

// A triangle to intersect: corner positions as bits, with the corner's vertex index in w.
struct Triangle {
    corners: array<vec4u, 3>,
}

// What shading needs of a vertex besides its position.
struct Vertex {
    normal: vec3f,
    // Linear red and green, as 16-bit fractions.
    red_green: u32,
    tangent: vec3f,
    // Blue; alpha in 15 bits; and which side of the tangent the bitangent is on: 0 or 1, for -1 and 1.
    blue_side: u32,
    // Both sets of texture coordinates.
    uvs: vec4f,
}

// Everything that a pass reads of a scene: three storage buffers, which leaves five of WebGPU's eight for what it writes.
// What is loaded together is a vector: some drivers make a branch of each lane's load from a buffer, and of each of its words.
@group(0) @binding(0) var<uniform> globals: Globals;
// Five vec4u a node (80 bytes, CWBVH).
@group(0) @binding(1) var<storage, read> nodes: array<vec4u>;
@group(0) @binding(2) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(3) var<storage, read> materials: array<Material>;
@group(0) @binding(4) var environment_map: texture_2d<f32>;
// From here on arrays whose elements lie at texel_place: first the materials' tables, four numbers a texel as bits
// (src/optics/table.rs).
@group(0) @binding(5) var table_texels: texture_2d_array<u32>;
@group(0) @binding(6) var environment_cells: texture_2d_array<u32>;
@group(0) @binding(7) var light_cells: texture_2d_array<u32>;
@group(0) @binding(8) var triangle_slots: texture_2d_array<u32>;
@group(0) @binding(9) var texture_records: texture_2d_array<u32>;
// The linear values of the 256 sRGB codes as bits, then texels of 4 x 8 bits, or two words each of 4 x 16.
@group(0) @binding(10) var texture_words: texture_2d_array<u32>;
// What the buffers of the same names hold, where one of them would be larger than a binding may be.
@group(0) @binding(11) var node_texels: texture_2d_array<u32>;
@group(0) @binding(12) var triangle_texels: texture_2d_array<u32>;
// Three texels a vertex.
@group(0) @binding(13) var vertex_texels: texture_2d_array<u32>;

// The materials where there are no more than these: no driver tests every lane's load from here.
@group(0) @binding(14) var<uniform> few_materials: array<Material, FEW_MATERIALS>;

// 1: nodes and triangles are in the textures.
override GEOMETRY_IN_TEXTURES: u32 = 0u;
// 1: the materials are in the storage buffer.
override HAS_MANY_MATERIALS: u32 = 0u;

fn material_at(slot: u32) -> Material {
    if HAS_MANY_MATERIALS == 1u {
        return materials[slot];
    }
    return few_materials[slot];
}

// The numbers of a node of a table that begins at this number.
fn table_numbers(table: u32, node: u32) -> vec4f {
    let place = texel_place(table / 4u + node);
    return bitcast<vec4f>(textureLoad(table_texels, place.xy, place.z, 0));
}

// One number of a table.
fn table_number(table: u32, index: u32) -> f32 {
    return table_numbers(table, index / 4u)[index % 4u];
}

// A vec4u of the nodes.
fn node_words(index: u32) -> vec4u {
    if GEOMETRY_IN_TEXTURES == 0u {
        return nodes[index];
    }
    let place = texel_place(index);
    return textureLoad(node_texels, place.xy, place.z, 0);
}

fn triangle_at(index: u32) -> Triangle {
    if GEOMETRY_IN_TEXTURES == 0u {
        return triangles[index];
    }
    var corners: array<vec4u, 3>;
    for (var i = 0u; i < 3u; i++) {
        let place = texel_place(3u * index + i);
        corners[i] = textureLoad(triangle_texels, place.xy, place.z, 0);
    }
    return Triangle(corners);
}

fn vertex_at(index: u32) -> Vertex {
    var words: array<vec4u, 3>;
    for (var i = 0u; i < 3u; i++) {
        let place = texel_place(3u * index + i);
        words[i] = textureLoad(vertex_texels, place.xy, place.z, 0);
    }
    let normal = bitcast<vec3f>(words[0].xyz);
    let tangent = bitcast<vec3f>(words[1].xyz);
    return Vertex(normal, words[0].w, tangent, words[1].w, bitcast<vec4f>(words[2]));
}

// The material slot of a triangle.
fn slot_at(index: u32) -> u32 {
    let place = texel_place(index);
    return textureLoad(triangle_slots, place.xy, place.z, 0).x;
}
