// Inputs of the passes: twins of the structures in src/gpu/layout.rs, and the bindings. Material is generated from
// src/optics/material.rs.
#import "scene/material"
#import "scene/texels"

struct Camera {
    // In the geometry's units.
    origin: vec3f,
    // Share of the lens that is open, radius in the geometry's units.
    lens_radius: f32,
    forward: vec3f,
    focus_distance: f32,
    // Half the image's width and height at distance 1; with parallel rays themselves.
    right: vec3f,
    filter_kind: u32,
    up: vec3f,
    // How far behind the camera parallel rays start, which is where the origin is; 0 for a perspective.
    parallel_from: f32,
}

struct Globals {
    camera: Camera,
    image_size: vec2u,
    bounces: u32,
    sequence: u32,
    // Background colour; for a blurred environment, x is the sine of the blur angle.
    background: vec3f,
    background_kind: u32,
    // Cosine and sine of the rotation.
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
    // Slots of the shadow catcher and of its reflection, and the start of its table.
    catcher_slot: u32,
    catcher_reflection_slot: u32,
    catcher_table: u32,
    // Light that was reflected less often does not count.
    least_reflections: u32,
    // First node of the surroundings' hierarchy; 0 without one.
    around_root: u32,
    // First triangle of the surroundings.
    around_triangle: u32,
    // The slot of the solid around the camera.
    camera_medium: u32,
    // From this slot on the camera does not see surfaces.
    first_hidden_slot: u32,
    // Light groups that are summed apart.
    light_groups: u32,
    // 1: coarse triangles are rounded according to their normals.
    rounds_surfaces: u32,
    // Throughput limit of Russian roulette for paths with few rough bounces.
    roulette_floor: f32,
}

// Bits of a material's flags: vertex attributes, whether the reflection's weight and tint spare metals,
// whether multiple scattering between facets is compensated, whether a texture uses box projection,
// whether the dielectric's index has the weight in it, and whether the coat changes what lies below it, absorbs by the way of
// the light and is GGX; whether the emission has a profile.
const VERTEX_BASE: u32 = 1u;
const VERTEX_EMISSION: u32 = 2u;
const VERTEX_OPACITY: u32 = 4u;
const SPARES_METAL: u32 = 8u;
const COMPENSATES: u32 = 16u;
const HAS_BOX: u32 = 32u;
const WEIGHS_INDEX: u32 = 64u;
const COATS_BASE: u32 = 128u;
const COAT_ABSORBS: u32 = 256u;
const COAT_IS_GGX: u32 = 512u;
const HAS_PROFILE: u32 = 1024u;
// The bits above hold the light group of what the material emits.
const LIGHT_GROUP_SHIFT: u32 = 24u;

// A triangle to intersect: corner positions as bits, with the corner's vertex index in w.
struct Triangle {
    corners: array<vec4u, 3>,
}

// Shading attributes of a vertex.
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

// The scene's bindings. Three storage buffers leave five of WebGPU's eight for the pass's outputs. Data that is loaded
// together is a vector, because some drivers branch per lane and per word of a buffer load.
@group(0) @binding(0) var<uniform> globals: Globals;
// Five vec4u a node (80 bytes, CWBVH).
@group(0) @binding(1) var<storage, read> nodes: array<vec4u>;
@group(0) @binding(2) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(3) var<storage, read> materials: array<Material>;
@group(0) @binding(4) var environment_map: texture_2d<f32>;
// From here on, arrays with elements at texel_place. First the materials' tables, four numbers per texel as bits
// (src/optics/table.rs).
@group(0) @binding(5) var table_texels: texture_2d_array<u32>;
@group(0) @binding(6) var environment_cells: texture_2d_array<u32>;
@group(0) @binding(7) var light_cells: texture_2d_array<u32>;
@group(0) @binding(8) var triangle_slots: texture_2d_array<u32>;
@group(0) @binding(9) var texture_records: texture_2d_array<u32>;
// The linear values of the 256 sRGB codes as bits, then texels of 4 x 8 bits, or two words each of 4 x 16.
@group(0) @binding(10) var texture_words: texture_2d_array<u32>;
// The buffers of the same names, if too large for a buffer binding.
@group(0) @binding(11) var node_texels: texture_2d_array<u32>;
@group(0) @binding(12) var triangle_texels: texture_2d_array<u32>;
// Three texels a vertex.
@group(0) @binding(13) var vertex_texels: texture_2d_array<u32>;

// The materials if there are few: no driver checks bounds per lane here.
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
