// Inputs of the passes: twins of the structures in src/gpu/layout.rs, and the bindings. Material is generated from
// src/optics/material.rs.
#import "scene/material"
#import "scene/structures"
#import "scene/texels"

// A triangle to intersect: corner positions as bits, with the corner's vertex index in w.
struct Triangle {
    corners: array<vec4u, 3>,
}

fn corners(triangle: Triangle) -> mat3x3f {
    let words = triangle.corners;
    return mat3x3f(bitcast<vec3f>(words[0].xyz), bitcast<vec3f>(words[1].xyz), bitcast<vec3f>(words[2].xyz));
}

fn vertices(triangle: Triangle) -> vec3u {
    return vec3u(triangle.corners[0].w, triangle.corners[1].w, triangle.corners[2].w);
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
// The cells of the distribution row by row, the rows after them. Of each: the first of the numbers that draw it and the number
// after the last; first and last entry that numbers of this guide slot may select, in 16 bits each; the density per
// steradian as bits.
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
    return bitcast<vec4f>(texel_at(table_texels, table / 4u + node));
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
    return texel_at(node_texels, index);
}

fn triangle_at(index: u32) -> Triangle {
    if GEOMETRY_IN_TEXTURES == 0u {
        return triangles[index];
    }
    return Triangle(three_texels(triangle_texels, index));
}

fn vertex_at(index: u32) -> Vertex {
    let words = three_texels(vertex_texels, index);
    let normal = bitcast<vec3f>(words[0].xyz);
    let tangent = bitcast<vec3f>(words[1].xyz);
    return Vertex(normal, words[0].w, tangent, words[1].w, bitcast<vec4f>(words[2]));
}

// The material slot of a triangle.
fn slot_at(index: u32) -> u32 {
    return texel_at(triangle_slots, index).x;
}
