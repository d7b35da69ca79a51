// The pictures of a model: filtered by hand, so that both engines find the same numbers. Twin of src/scene/texture/mod.rs.
#import "optics/frame"
#import "optics/material"
#import "scene/bvh"
#import "scene/layout"

const WRAP_REPEAT: u32 = 0u;
const WRAP_MIRRORED: u32 = 1u;
const WRAP_CLAMP: u32 = 2u;
const IS_SRGB: u32 = 1u;
const IS_NEAREST: u32 = 2u;
const IS_SECOND_SET: u32 = 4u;
const IS_FINE: u32 = 8u;
const IS_BOX: u32 = 16u;
const TURNS_NORMALS: u32 = 32u;
const CHANNEL_SHIFT: u32 = 8u;
const WRAP_SHIFT: u32 = 16u;

// One use of a picture.
struct TextureRecord {
    u_from_uv: vec3f,
    first_texel: u32,
    v_from_uv: vec3f,
    width: u32,
    height: u32,
    flags: u32,
    scale: f32,
    offset: f32,
}

// Places on a surface by which pictures are looked up.
struct Uvs {
    // Both sets of texture coordinates.
    sets: vec4f,
    // Where the place is on a box around the model.
    on_box: vec2f,
}

fn texture_record(index: u32) -> TextureRecord {
    var words: array<vec4u, 3>;
    for (var i = 0u; i < 3u; i++) {
        let place = texel_place(3u * index + i);
        words[i] = textureLoad(texture_records, place.xy, place.z, 0);
    }
    return TextureRecord(
        bitcast<vec3f>(words[0].xyz), words[0].w, bitcast<vec3f>(words[1].xyz), words[1].w,
        words[2].x, words[2].y, bitcast<f32>(words[2].z), bitcast<f32>(words[2].w),
    );
}

fn texture_word(index: u32) -> u32 {
    let place = texel_place(index);
    return textureLoad(texture_words, place.xy, place.z, 0).x;
}

// Red, green, blue (linear) and alpha that a use of a picture gives; the same four times where one channel counts.
fn texture_lookup(index: u32, uvs: Uvs) -> vec4f {
    let record = texture_record(index);
    let found = filtered(record, uvs);
    let channel = (record.flags >> CHANNEL_SHIFT) & 7u;
    let chosen = select(found, vec4f(found[max(channel, 1u) - 1u]), channel != 0u);
    return chosen * record.scale + vec4f(record.offset);
}

// A picture as it is: red, green, blue (linear) and alpha.
fn filtered(record: TextureRecord, uvs: Uvs) -> vec4f {
    var uv = select(uvs.sets.xy, uvs.sets.zw, (record.flags & IS_SECOND_SET) != 0u);
    if PLAN_BOX_PROJECTION == 1u && (record.flags & IS_BOX) != 0u {
        uv = uvs.on_box;
    }
    let wrap = vec2u(record.flags >> WRAP_SHIFT, record.flags >> (WRAP_SHIFT + 2u)) & vec2u(3u);
    let u = record.u_from_uv.x * uv.x + record.u_from_uv.y * uv.y + record.u_from_uv.z;
    let v = record.v_from_uv.x * uv.x + record.v_from_uv.y * uv.y + record.v_from_uv.z;
    let x = wrapped(u, wrap.x) * f32(record.width);
    let y = wrapped(v, wrap.y) * f32(record.height);
    if (record.flags & IS_NEAREST) != 0u {
        return texel(record, min(u32(x), record.width - 1u), min(u32(y), record.height - 1u));
    }
    let left = floor(x - 0.5);
    let top = floor(y - 0.5);
    let columns = neighbours(left, record.width, wrap.x);
    let rows = neighbours(top, record.height, wrap.y);
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

fn textured_material(material: Material, uvs: Uvs, vertex_color: vec3f) -> Material {
    if PLAN_COLOR_TEXTURES + PLAN_ROUGHNESS_TEXTURES + PLAN_EMISSION_TEXTURES + PLAN_COAT_TEXTURES == 0u {
        return material;
    }
    // A picture that has both roughness and metalness is looked up once.
    let has_both = material.metalness_texture == material.textures.y;
    // A loop, so that the look-up's code is there once.
    var found = array<vec4f, 5>(vec4f(1.0), vec4f(1.0), vec4f(1.0), vec4f(1.0), vec4f(1.0));
    let indices = array<u32, 5>(
        material.textures.x, material.textures.y, material.textures.w,
        select(material.metalness_texture, NO_TEXTURE, has_both), material.coat_texture,
    );
    let kinds = select(3u, 5u, PLAN_ROUGHNESS_TEXTURES + PLAN_COAT_TEXTURES > 0u);
    for (var kind = 0u; kind < kinds; kind++) {
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
    if PLAN_ROUGHNESS_TEXTURES == 1u {
        at_point.metalness = material.metalness * select(found[3], found[1], has_both).z;
    }
    if PLAN_ROUGHNESS_TEXTURES == 1u && material.textures.y != NO_TEXTURE {
        at_point.roughness = material.texture_roughness * found[1].y;
        if material.roughness_table != NO_TEXTURE {
            at_point.roughness = table_lookup(material.roughness_table, MATCHED_NODES, at_point.roughness);
        }
        let rough = material.transmission_roughness + (at_point.roughness - material.roughness);
        at_point.transmission_roughness = clamp(rough, 0.0, 1.0);
    }
    if PLAN_EMISSION_TEXTURES == 1u {
        at_point.emission = material.emission * found[2].xyz;
    }
    if PLAN_COAT_TEXTURES == 1u {
        at_point.coat_weight = material.coat_weight * found[4].x;
    }
    return at_point;
}

// What a surface point emits, its holes left out.
fn emission_at(material: Material, uvs: Uvs) -> vec3f {
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
fn opacity_at(material: Material, uvs: Uvs) -> f32 {
    var opacity = material.opacity;
    if material.opacity_texture != NO_TEXTURE {
        opacity *= texture_lookup(material.opacity_texture, uvs).w;
    }
    let masked = select(1.0, 0.0, opacity < material.alpha_cutoff);
    return select(masked, opacity, material.alpha_cutoff < 0.0);
}

// The normal that a normal texture gives, in world space; `tangent` with the sign of the bitangent in w, `outward` the normal
// on the front of the surface.
fn mapped_normal(material: Material, uvs: Uvs, normal: vec3f, tangent: vec4f, outward: vec3f) -> vec3f {
    let record = texture_record(material.textures.z);
    let decoded = 2.0 * filtered(record, uvs).xyz - 1.0;
    var slope = decoded.xy * material.normal_strength;
    if (record.flags & TURNS_NORMALS) != 0u {
        let turn = vec2f(record.u_from_uv.x, -record.u_from_uv.y) / length(record.u_from_uv.xy);
        slope = vec2f(turn.x * slope.x - turn.y * slope.y, turn.y * slope.x + turn.x * slope.y);
    }
    var right = tangent;
    if PLAN_BOX_PROJECTION == 1u && (record.flags & IS_BOX) != 0u {
        right = vec4f(box_right(outward), 1.0);
    }
    let along = frame_from_tangent(normal, right.xyz, 0.0);
    let bitangent = along.bitangent * select(1.0, -1.0, right.w < 0.0);
    // What points into the surface is laid down on it.
    return normalize_or(along.tangent * slope.x + bitangent * slope.y + normal * max(decoded.z, 0.0), normal);
}

// Both sets of texture coordinates at a place of a triangle.
fn uv_sets_at(corners: vec3u, weights: vec3f) -> vec4f {
    return corner_uvs(corners.x) * weights.x + corner_uvs(corners.y) * weights.y + corner_uvs(corners.z) * weights.z;
}

fn corner_uvs(vertex: u32) -> vec4f {
    let at = vertex_at(vertex);
    return vec4f(at.uv[0], at.uv[1], at.second_uv[0], at.second_uv[1]);
}

// The texture coordinates at a place of a triangle; those of the box where `has_box` says that they are needed.
fn uvs_at(triangle: Triangle, weights: vec3f, has_box: bool) -> Uvs {
    let corners = vec3u(triangle.corners[0].w, triangle.corners[1].w, triangle.corners[2].w);
    var on_box = vec2f(0.0);
    if PLAN_BOX_PROJECTION == 1u && has_box {
        let p0 = bitcast<vec3f>(triangle.corners[0].xyz);
        let p1 = bitcast<vec3f>(triangle.corners[1].xyz);
        let p2 = bitcast<vec3f>(triangle.corners[2].xyz);
        let smooth_normal = corner_normal(corners.x) * weights.x + corner_normal(corners.y) * weights.y +
            corner_normal(corners.z) * weights.z;
        let place = p0 * weights.x + p1 * weights.y + p2 * weights.z;
        on_box = box_uv(place, normalize_or(smooth_normal, triangle_normal(p0, p1, p2)));
    }
    return Uvs(uv_sets_at(corners, weights), on_box);
}

fn corner_normal(vertex: u32) -> vec3f {
    let at = vertex_at(vertex);
    return vec3f(at.normal[0], at.normal[1], at.normal[2]);
}

// The axis along which a picture lies to the right on the side of a box that a surface with this normal faces.
fn box_right(normal: vec3f) -> vec3f {
    let size = abs(normal);
    if size.x >= size.y && size.x >= size.z {
        return vec3f(0.0, 0.0, select(-1.0, 1.0, normal.x < 0.0));
    }
    if size.y >= size.z {
        return vec3f(1.0, 0.0, 0.0);
    }
    return vec3f(select(1.0, -1.0, normal.z < 0.0), 0.0, 0.0);
}

// Where a place with this normal is on the side of the box around the model that it faces, v downwards.
fn box_uv(position: vec3f, normal: vec3f) -> vec2f {
    let size = abs(normal);
    var down = -position.y;
    if size.y > size.x && size.y >= size.z {
        down = select(position.z, -position.z, normal.y < 0.0);
    }
    return vec2f(dot(box_right(normal), position), down) * 0.5 + 0.5;
}
