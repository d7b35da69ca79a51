// Texture maps: filtered in software, so that both engines get the same numbers. Twin of src/scene/texture/mod.rs.
#import "optics/frame"
#import "optics/albedo"
#import "optics/material"
#import "scene/intersect"
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
// The least roughness of fuzz.
const FUZZ_ROUGHNESS_MIN: f32 = 0.01;

// One use of a texture map.
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

// Texture coordinates of a surface point.
struct Uvs {
    // Both sets of texture coordinates.
    sets: vec4f,
    // Coordinates by box projection.
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

// Value of a texture use: linear RGB and alpha; one channel is repeated four times.
fn texture_lookup(index: u32, uvs: Uvs) -> vec4f {
    let record = texture_record(index);
    let found = filtered(record, uvs);
    let channel = (record.flags >> CHANNEL_SHIFT) & 7u;
    let chosen = select(found, vec4f(found[max(channel, 1u) - 1u]), channel != 0u);
    return chosen * record.scale + vec4f(record.offset);
}

// Filtered texture map: linear RGB and alpha.
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
    // The nearest texel, or the four around the place: a loop, so that the code of a texel is there once.
    var columns = vec2u(min(u32(x), record.width - 1u));
    var rows = vec2u(min(u32(y), record.height - 1u));
    var share = vec2f(0.0);
    var count = 1u;
    if (record.flags & IS_NEAREST) == 0u {
        let left = floor(x - 0.5);
        let top = floor(y - 0.5);
        columns = neighbours(left, record.width, wrap.x);
        rows = neighbours(top, record.height, wrap.y);
        share = vec2f(x - 0.5 - left, y - 0.5 - top);
        count = 4u;
    }
    var above = vec4f(0.0);
    var line = vec4f(0.0);
    for (var i = 0u; i < count; i++) {
        let is_right = (i & 1u) != 0u;
        let found = texel(record, select(columns.x, columns.y, is_right), select(rows.x, rows.y, i > 1u));
        if i == 2u {
            above = line;
        }
        line = select(found, mix_texels(line, found, share.x), is_right);
    }
    return select(line, mix_texels(above, line, share.y), count > 1u);
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
    let is_fine = (record.flags & IS_FINE) != 0u;
    let first = record.first_texel + select(place, 2u * place, is_fine);
    let word = texture_word(first);
    if is_fine {
        let next = texture_word(first + 1u);
        return vec4f(vec4u(word & 0xffffu, word >> 16u, next & 0xffffu, next >> 16u)) / 65535.0;
    }
    let codes = vec4u(word & 0xffu, (word >> 8u) & 0xffu, (word >> 16u) & 0xffu, word >> 24u);
    var color = vec4f(codes) / 255.0;
    let curved = select(0u, 3u, (record.flags & IS_SRGB) != 0u);
    for (var channel = 0u; channel < curved; channel++) {
        let linear = bitcast<f32>(texture_word((word >> (8u * channel)) & 0xffu));
        color = select(color, vec4f(linear), vec4<bool>(channel == 0u, channel == 1u, channel == 2u, false));
    }
    return color;
}

fn textured_material(material: Material, uvs: Uvs, vertex_color: vec3f) -> Material {
    let pictures = PLAN_COLOR_TEXTURES + PLAN_ROUGHNESS_TEXTURES + PLAN_EMISSION_TEXTURES + PLAN_COAT_TEXTURES;
    if pictures + PLAN_FILM_TEXTURES + PLAN_FUZZ_TEXTURES + PLAN_VERTEX_COLORS == 0u {
        return material;
    }
    // A map with both roughness and metalness is looked up once.
    let has_both = material.metalness_texture == material.roughness_texture;
    // A loop, so that the look-up's code is there once.
    var found = array<vec4f, 7>(
        vec4f(1.0), vec4f(1.0), vec4f(1.0), vec4f(1.0), vec4f(1.0), vec4f(1.0), vec4f(1.0),
    );
    let indices = array<u32, 7>(
        material.base_color_texture, material.roughness_texture, material.emission_texture,
        select(material.metalness_texture, NO_TEXTURE, has_both), material.coat_texture, material.coat_roughness_texture,
        material.coat_color_texture,
    );
    // Over the set bits, because drivers unroll a loop of known length.
    var wanted = 0u;
    // Those of the coat come last.
    for (var kind = 0u; kind < select(4u, 7u, PLAN_COAT_TEXTURES == 1u); kind++) {
        wanted |= select(0u, 1u << kind, indices[kind] != NO_TEXTURE);
    }
    if PLAN_ROUGHNESS_TEXTURES + PLAN_COAT_TEXTURES == 0u {
        wanted &= 7u;
    }
    while wanted != 0u {
        let kind = firstTrailingBit(wanted);
        wanted &= wanted - 1u;
        found[kind] = texture_lookup(indices[kind], uvs);
    }
    var at_point = material;
    if PLAN_COLOR_TEXTURES == 1u {
        let color = select(vec3f(1.0), vertex_color, has_flag(material, VERTEX_BASE)) * found[0].xyz;
        at_point.base_color = material.base_color * color;
        at_point.transmission_tint = material.transmission_tint * color;
    }
    if PLAN_ROUGHNESS_TEXTURES == 1u {
        at_point.metalness = material.metalness * select(found[3], found[1], has_both).z;
    }
    if PLAN_COAT_TEXTURES == 1u {
        at_point.coat_weight = material.coat_weight * found[4].x;
        if has_flag(material, COATS_BASE) && material.coat_texture != NO_TEXTURE {
            at_point.reflecting_ior = ior_under_coat(material, at_point.coat_weight);
        }
        at_point.coat_roughness = material.coat_roughness * found[5].y;
        if material.coat_roughness_texture != NO_TEXTURE && material.coat_blur > 0.0 {
            let square = at_point.coat_roughness * at_point.coat_roughness;
            at_point.coat_blur = 2.0 * square * square;
        }
        at_point.coat_color = material.coat_color * found[6].xyz;
    }
    let has_roughness = PLAN_ROUGHNESS_TEXTURES == 1u && material.roughness_texture != NO_TEXTURE;
    let coat_varies = material.coat_texture != NO_TEXTURE || material.coat_roughness_texture != NO_TEXTURE;
    let has_coat = PLAN_COAT_TEXTURES == 1u && coat_varies;
    let blurs = PLAN_COAT == 1u && material.coat_blur > 0.0 && (has_roughness || has_coat);
    if has_roughness || blurs {
        at_point.ggx_roughness = material.texture_roughness * select(1.0, found[1].y, has_roughness);
        at_point.roughness = at_point.ggx_roughness;
        if blurs {
            at_point.roughness = roughness_under_coat(at_point, at_point.roughness, at_point.coat_weight);
        }
        if material.roughness_table != NO_TEXTURE {
            at_point.roughness = table_lookup(material.roughness_table, MATCHED_NODES, at_point.roughness);
        }
        let rough = at_point.roughness + (material.transmission_roughness - material.roughness);
        at_point.transmission_roughness = clamp(rough, 0.0, 1.0);
    }
    if PLAN_EMISSION_TEXTURES == 1u {
        at_point.emission = material.emission * found[2].xyz;
    }
    if has_vertex_flag(material, VERTEX_EMISSION) {
        at_point.emission *= vertex_color;
    }
    if PLAN_FILM_TEXTURES == 1u {
        if material.film_texture != NO_TEXTURE {
            at_point.film_weight = material.film_weight * texture_lookup(material.film_texture, uvs).x;
        }
        if material.film_thickness_texture != NO_TEXTURE {
            at_point.film_path = material.film_path * texture_lookup(material.film_thickness_texture, uvs).x;
        }
    }
    if PLAN_FUZZ_TEXTURES == 1u {
        let places = vec3u(material.fuzz_texture, material.fuzz_color_texture, material.fuzz_roughness_texture);
        let is_there = places != vec3u(NO_TEXTURE);
        var left = dot(select(vec3u(0u), vec3u(1u, 2u, 4u), is_there), vec3u(1u));
        while left != 0u {
            let kind = firstTrailingBit(left);
            left &= left - 1u;
            let value = texture_lookup(select(select(places.z, places.y, kind == 1u), places.x, kind == 0u), uvs);
            at_point.fuzz_weight *= select(1.0, value.x, kind == 0u);
            at_point.fuzz_color *= select(vec3f(1.0), value.xyz, kind == 1u);
            at_point.fuzz_roughness *= select(1.0, value.w, kind == 2u);
        }
        at_point.fuzz_roughness = max(at_point.fuzz_roughness, FUZZ_ROUGHNESS_MIN);
    }
    return at_point;
}

// The linear colour of a vertex that multiplies the material's, and its alpha.
fn corner_color(vertex: Vertex) -> vec4f {
    let alpha = f32((vertex.blue_side >> 16u) & 0x7fffu) / 32767.0;
    return vec4f(unpack2x16unorm(vertex.red_green), unpack2x16unorm(vertex.blue_side).x, alpha);
}

// Factors of emission and opacity that the vertices of a triangle give a place on it.
fn vertex_factors(material: Material, triangle: Triangle, weights: vec3f) -> vec4f {
    if !has_vertex_flag(material, VERTEX_EMISSION | VERTEX_OPACITY) {
        return vec4f(1.0);
    }
    // A loop, so that the code that loads a corner is there once.
    var corners = vec3u(triangle.corners[0].w, triangle.corners[1].w, triangle.corners[2].w);
    var weight = weights;
    var sum = vec4f(0.0);
    while any(weight != vec3f(0.0)) {
        sum += corner_color(vertex_at(corners.x)) * weight.x;
        corners = corners.yzx;
        weight = vec3f(weight.yz, 0.0);
    }
    let color = select(vec3f(1.0), sum.xyz, has_flag(material, VERTEX_EMISSION));
    return vec4f(color, select(1.0, sum.w, has_flag(material, VERTEX_OPACITY)));
}

// Emission at a surface point times its opacity; `of_vertices` from vertex_factors.
fn emission_at(material: Material, uvs: Uvs, of_vertices: vec4f) -> vec3f {
    // The emission map and the opacity map in a loop, so that the look-up's code is in the kernel once.
    var emission = material.emission * of_vertices.xyz;
    var opacity = material.opacity * of_vertices.w;
    let has_emission = PLAN_EMISSION_TEXTURES == 1u && material.emission_texture != NO_TEXTURE;
    let has_holes = material_has_holes(material);
    let has_opacity = has_holes && material.opacity_texture != NO_TEXTURE;
    var wanted = select(0u, 1u, has_emission) + select(0u, 2u, has_opacity);
    while wanted != 0u {
        let is_emission = (wanted & 1u) != 0u;
        wanted &= wanted - 1u;
        let found = texture_lookup(select(material.opacity_texture, material.emission_texture, is_emission), uvs);
        if is_emission {
            emission *= found.xyz;
        } else {
            opacity *= found.w;
        }
    }
    return emission * select(1.0, stopped_share(material, opacity), has_holes);
}

// The share of light that a surface point stops; `alpha` is that of the vertices.
fn opacity_at(material: Material, uvs: Uvs, alpha: f32) -> f32 {
    var opacity = material.opacity * alpha;
    if material.opacity_texture != NO_TEXTURE {
        opacity *= texture_lookup(material.opacity_texture, uvs).w;
    }
    return stopped_share(material, opacity);
}

// The same for a known opacity.
fn stopped_share(material: Material, opacity: f32) -> f32 {
    let masked = select(1.0, 0.0, opacity < material.alpha_cutoff);
    return select(masked, opacity, material.alpha_cutoff < 0.0);
}

// The normal that a normal texture gives, in world space; `tangent` with the sign of the bitangent in w, `outward` the normal
// on the front of the surface.
fn mapped_normal(texture: u32, strength: f32, uvs: Uvs, normal: vec3f, tangent: vec4f, outward: vec3f) -> vec3f {
    let record = texture_record(texture);
    let decoded = 2.0 * filtered(record, uvs).xyz - 1.0;
    var slope = decoded.xy * strength;
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
    // A normal that points into the surface is bent onto it.
    return normalize_or(along.tangent * slope.x + bitangent * slope.y + normal * max(decoded.z, 0.0), normal);
}

// Texture coordinates at a position in a triangle; box projection only if `has_box`.
fn uvs_at(triangle: Triangle, weights: vec3f, has_box: bool) -> Uvs {
    var corners = vec3u(triangle.corners[0].w, triangle.corners[1].w, triangle.corners[2].w);
    var weight = weights;
    var sets = vec4f(0.0);
    var smooth_normal = vec3f(0.0);
    // Corners that have weight, in turn, so that the code that loads one is there once.
    while any(weight != vec3f(0.0)) {
        let at = vertex_at(corners.x);
        sets += at.uvs * weight.x;
        smooth_normal += at.normal * weight.x;
        corners = corners.yzx;
        weight = vec3f(weight.yz, 0.0);
    }
    var on_box = vec2f(0.0);
    if PLAN_BOX_PROJECTION == 1u && has_box {
        let p0 = bitcast<vec3f>(triangle.corners[0].xyz);
        let p1 = bitcast<vec3f>(triangle.corners[1].xyz);
        let p2 = bitcast<vec3f>(triangle.corners[2].xyz);
        let place = p0 * weights.x + p1 * weights.y + p2 * weights.z;
        on_box = box_uv(place, normalize_or(smooth_normal, triangle_normal(p0, p1, p2)));
    }
    return Uvs(sets, on_box);
}

// Horizontal axis of the box side that a surface with this normal faces.
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

// Coordinates of a position on the box side that it faces, v downwards.
fn box_uv(position: vec3f, normal: vec3f) -> vec2f {
    let size = abs(normal);
    var down = -position.y;
    if size.y > size.x && size.y >= size.z {
        down = select(position.z, -position.z, normal.y < 0.0);
    }
    return vec2f(dot(box_right(normal), position), down) * 0.5 + 0.5;
}
