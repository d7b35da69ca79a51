// The pictures of a model: filtered by hand, so that both engines find the same numbers. Twin of src/scene/texture.rs.
#import "optics/frame"
#import "optics/material"
#import "scene/layout"

const WRAP_REPEAT: u32 = 0u;
const WRAP_MIRRORED: u32 = 1u;
const WRAP_CLAMP: u32 = 2u;
const IS_SRGB: u32 = 1u;
const IS_NEAREST: u32 = 2u;
const IS_SECOND_SET: u32 = 4u;
const IS_FINE: u32 = 8u;

// One use of a picture.
struct TextureRecord {
    u_from_uv: vec3f,
    first_texel: u32,
    v_from_uv: vec3f,
    width: u32,
    height: u32,
    wrap: vec2u,
    flags: u32,
}

fn texture_record(index: u32) -> TextureRecord {
    var words: array<vec4u, 3>;
    for (var i = 0u; i < 3u; i++) {
        let place = texel_place(3u * index + i);
        words[i] = textureLoad(texture_records, place.xy, place.z, 0);
    }
    return TextureRecord(
        bitcast<vec3f>(words[0].xyz), words[0].w, bitcast<vec3f>(words[1].xyz), words[1].w,
        words[2].x, words[2].yz, words[2].w,
    );
}

fn texture_word(index: u32) -> u32 {
    let place = texel_place(index);
    return textureLoad(texture_words, place.xy, place.z, 0).x;
}

// Red, green, blue (linear) and alpha. uvs holds both sets of texture coordinates.
fn texture_lookup(index: u32, uvs: vec4f) -> vec4f {
    let record = texture_record(index);
    let uv = select(uvs.xy, uvs.zw, (record.flags & IS_SECOND_SET) != 0u);
    let u = record.u_from_uv.x * uv.x + record.u_from_uv.y * uv.y + record.u_from_uv.z;
    let v = record.v_from_uv.x * uv.x + record.v_from_uv.y * uv.y + record.v_from_uv.z;
    let x = wrapped(u, record.wrap[0]) * f32(record.width);
    let y = wrapped(v, record.wrap[1]) * f32(record.height);
    if (record.flags & IS_NEAREST) != 0u {
        return texel(record, min(u32(x), record.width - 1u), min(u32(y), record.height - 1u));
    }
    let left = floor(x - 0.5);
    let top = floor(y - 0.5);
    let columns = neighbours(left, record.width, record.wrap[0]);
    let rows = neighbours(top, record.height, record.wrap[1]);
    let fx = x - 0.5 - left;
    let above = mix_texels(texel(record, columns.x, rows.x), texel(record, columns.y, rows.x), fx);
    let below = mix_texels(texel(record, columns.x, rows.y), texel(record, columns.y, rows.y), fx);
    return mix_texels(above, below, y - 0.5 - top);
}

fn mix_texels(a: vec4f, b: vec4f, t: f32) -> vec4f {
    return a + (b - a) * t;
}

fn wrapped(place: f32, wrap: u32) -> f32 {
    if wrap == WRAP_CLAMP {
        return clamp(place, 0.0, 1.0);
    }
    if wrap == WRAP_MIRRORED {
        let turn = place - 2.0 * floor(place / 2.0);
        return min(turn, 2.0 - turn);
    }
    return place - floor(place);
}

fn neighbours(low: f32, size: u32, wrap: u32) -> vec2u {
    let last = size - 1u;
    let is_first = low < 0.0;
    let left = min(u32(max(low, 0.0)), last);
    let right = select(min(left + 1u, last), 0u, is_first);
    if wrap == WRAP_REPEAT {
        return vec2u(select(left, last, is_first), select(right, 0u, left == last && !is_first));
    }
    return vec2u(left, right);
}

fn texel(record: TextureRecord, column: u32, row: u32) -> vec4f {
    let place = row * record.width + column;
    if (record.flags & IS_FINE) != 0u {
        let first = record.first_texel + 2u * place;
        let rg = texture_word(first);
        let ba = texture_word(first + 1u);
        return vec4f(vec4u(rg & 0xffffu, rg >> 16u, ba & 0xffffu, ba >> 16u)) / 65535.0;
    }
    let word = texture_word(record.first_texel + place);
    let codes = vec4u(word & 0xffu, (word >> 8u) & 0xffu, (word >> 16u) & 0xffu, word >> 24u);
    if (record.flags & IS_SRGB) == 0u {
        return vec4f(codes) / 255.0;
    }
    return vec4f(
        bitcast<f32>(texture_word(codes.x)), bitcast<f32>(texture_word(codes.y)),
        bitcast<f32>(texture_word(codes.z)), f32(codes.w) / 255.0,
    );
}

fn textured_material(material: Material, uvs: vec4f, vertex_color: vec3f) -> Material {
    if PLAN_COLOR_TEXTURES + PLAN_ROUGHNESS_TEXTURES + PLAN_EMISSION_TEXTURES == 0u {
        return material;
    }
    // A loop, so that the look-up's code is there once.
    var found = array<vec4f, 3>(vec4f(1.0), vec4f(1.0), vec4f(1.0));
    let indices = array<u32, 3>(material.textures.x, material.textures.y, material.textures.w);
    for (var kind = 0u; kind < 3u; kind++) {
        let index = indices[kind];
        if index != NO_TEXTURE {
            found[kind] = texture_lookup(index, uvs);
        }
    }
    var at_point = material;
    if PLAN_COLOR_TEXTURES == 1u {
        let color = vertex_color * found[0].xyz;
        at_point.base_color = material.base_color * color;
        at_point.transmission_tint = material.transmission_tint * color;
    }
    if PLAN_ROUGHNESS_TEXTURES == 1u && material.textures.y != NO_TEXTURE {
        let values = found[1];
        at_point.metalness = material.metalness * values.z;
        at_point.roughness = material.texture_roughness * values.y;
        if material.roughness_table != NO_TEXTURE {
            at_point.roughness = table_lookup(material.roughness_table, MATCHED_NODES, at_point.roughness);
        }
        let rough = material.transmission_roughness + (at_point.roughness - material.roughness);
        at_point.transmission_roughness = clamp(rough, 0.0, 1.0);
    }
    if PLAN_EMISSION_TEXTURES == 1u {
        at_point.emission = material.emission * found[2].xyz;
    }
    return at_point;
}

// What a surface point emits, its holes left out.
fn emission_at(material: Material, uvs: vec4f) -> vec3f {
    var share = 1.0;
    if material_has_holes(material) {
        share = opacity_at(material, uvs);
    }
    if PLAN_EMISSION_TEXTURES == 0u || material.textures.w == NO_TEXTURE {
        return material.emission * share;
    }
    return material.emission * texture_lookup(material.textures.w, uvs).xyz * share;
}

// The share of light that a surface point stops.
fn opacity_at(material: Material, uvs: vec4f) -> f32 {
    var opacity = material.opacity;
    if material.opacity_texture != NO_TEXTURE {
        opacity *= texture_lookup(material.opacity_texture, uvs).w;
    }
    let masked = select(1.0, 0.0, opacity < material.alpha_cutoff);
    return select(masked, opacity, material.alpha_cutoff < 0.0);
}

// The normal that a normal texture gives, in world space; `tangent` with the sign of the bitangent in w.
fn mapped_normal(material: Material, uvs: vec4f, normal: vec3f, tangent: vec4f) -> vec3f {
    let encoded = texture_lookup(material.textures.z, uvs).xyz;
    let decoded = 2.0 * encoded - 1.0;
    let along = frame_from_tangent(normal, tangent.xyz, 0.0);
    let bitangent = along.bitangent * select(1.0, -1.0, tangent.w < 0.0);
    let slope = decoded.xy * material.normal_strength;
    // What points into the surface is laid down on it.
    return normalize_or(along.tangent * slope.x + bitangent * slope.y + normal * max(decoded.z, 0.0), normal);
}

// Both sets of texture coordinates at a place of a triangle.
fn uvs_at(corners: vec3u, weights: vec3f) -> vec4f {
    return corner_uvs(corners.x) * weights.x + corner_uvs(corners.y) * weights.y + corner_uvs(corners.z) * weights.z;
}

fn corner_uvs(vertex: u32) -> vec4f {
    let at = vertex_at(vertex);
    return vec4f(at.uv[0], at.uv[1], at.second_uv[0], at.second_uv[1]);
}
