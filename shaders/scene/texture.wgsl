// Texture maps: filtered in software, so that both engines get the same numbers. Twin of src/scene/texture/mod.rs.
#import "optics/albedo"
#import "optics/material"
#import "scene/intersect"

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
    let words = three_texels(texture_records, index);
    return TextureRecord(
        bitcast<vec3f>(words[0].xyz), words[0].w, bitcast<vec3f>(words[1].xyz), words[1].w,
        words[2].x, words[2].y, bitcast<f32>(words[2].z), bitcast<f32>(words[2].w),
    );
}

// Value of a texture use: linear RGB and alpha; one channel is repeated four times.
fn texture_lookup(index: u32, uvs: Uvs) -> vec4f {
    let record = texture_record(index);
    let found = filtered(record, uvs);
    let channel = (record.flags >> CHANNEL_SHIFT) & 7u;
    return select(found, vec4f(found[max(channel, 1u) - 1u]), channel != 0u) * record.scale + record.offset;
}

// Filtered texture map: linear RGB and alpha.
fn filtered(record: TextureRecord, uvs: Uvs) -> vec4f {
    var uv = select(uvs.sets.xy, uvs.sets.zw, (record.flags & IS_SECOND_SET) != 0u);
    if PLAN_BOX_PROJECTION && (record.flags & IS_BOX) != 0u {
        uv = uvs.on_box;
    }
    let wrap = (vec2u(record.flags) >> vec2u(WRAP_SHIFT, WRAP_SHIFT + 2u)) & vec2u(3u);
    let x = wrapped(dot(record.u_from_uv, vec3f(uv, 1.0)), wrap.x) * f32(record.width);
    let y = wrapped(dot(record.v_from_uv, vec3f(uv, 1.0)), wrap.y) * f32(record.height);
    // The nearest texel, or the four around the place: a loop, so that the code of a texel is there once.
    var columns = vec2u(min(u32(x), record.width - 1u));
    var rows = vec2u(min(u32(y), record.height - 1u));
    var share = vec2f();
    var count = 1u;
    if (record.flags & IS_NEAREST) == 0u {
        let left = floor(x - 0.5);
        let top = floor(y - 0.5);
        columns = neighbours(left, record.width, wrap.x);
        rows = neighbours(top, record.height, wrap.y);
        share = vec2f(x - 0.5 - left, y - 0.5 - top);
        count = 4u;
    }
    var above = vec4f();
    var line = vec4f();
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
        return saturate(place);
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
    let word = texel_at(texture_words, first).x;
    if is_fine {
        return vec4f(unpack2x16unorm(word), unpack2x16unorm(texel_at(texture_words, first + 1u).x));
    }
    var color = unpack4x8unorm(word);
    for (var channel = 0u; channel < select(0u, 3u, (record.flags & IS_SRGB) != 0u); channel++) {
        let linear = bitcast<f32>(texel_at(texture_words, (word >> (8u * channel)) & 0xffu).x);
        color = select(color, vec4f(linear), vec4<bool>(channel == 0u, channel == 1u, channel == 2u, false));
    }
    return color;
}

fn textured_material(material: Material, uvs: Uvs, vertex_color: vec3f) -> Material {
    var at_point = material;
    if PLAN_COLOR_TEXTURES && has_flag(material, VERTEX_BASE) {
        at_point.base_color *= vertex_color;
        at_point.transmission_tint *= vertex_color;
    }
    if has_vertex_flag(material, VERTEX_EMISSION) {
        at_point.emission *= vertex_color;
    }
    // A loop, so that the look-up's code is there once; over the set bits, because drivers unroll a loop of known length. A
    // texture of targets in a row is looked up once.
    var known = NO_TEXTURE;
    var value = vec4f();
    for (var wanted = planned_textures(); wanted != 0u; wanted &= wanted - 1u) {
        let kind = firstTrailingBit(wanted);
        let texture = material_texture(material, kind);
        if texture == NO_TEXTURE {
            continue;
        }
        if texture != known {
            known = texture;
            value = texture_lookup(texture, uvs);
        }
        multiply(&at_point, kind, value);
    }
    at_point.fuzz_roughness = max(at_point.fuzz_roughness, FUZZ_ROUGHNESS_MIN);
    follow_coat(&at_point);
    let blurs = has_varied_blur(material);
    if blurs || (PLAN_ROUGHNESS_TEXTURES && material.roughness_texture != NO_TEXTURE) {
        at_point.roughness = at_point.ggx_roughness;
        if blurs {
            at_point.roughness = roughness_under_coat(at_point, at_point.roughness, at_point.coat_weight);
        }
        if material.roughness_table != NO_TEXTURE {
            at_point.roughness = table_lookup(material.roughness_table, MATCHED_NODES, at_point.roughness);
        }
        let extra = material.transmission_roughness - material.roughness;
        at_point.transmission_roughness = saturate(at_point.roughness + extra);
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
    var indices = vertices(triangle);
    var weight = weights;
    var sum = vec4f();
    while any(weight != vec3f()) {
        sum += corner_color(vertex_at(indices.x)) * weight.x;
        indices = indices.yzx;
        weight = vec3f(weight.yz, 0.0);
    }
    let color = select(WHITE, sum.xyz, has_flag(material, VERTEX_EMISSION));
    return vec4f(color, select(1.0, sum.w, has_flag(material, VERTEX_OPACITY)));
}

// Emission at a surface point times its opacity; `of_vertices` from vertex_factors.
fn emission_at(material: Material, uvs: Uvs, of_vertices: vec4f) -> vec3f {
    // The emission map and the opacity map in a loop, so that the look-up's code is in the kernel once.
    var light = vec4f(material.emission, material.opacity) * of_vertices;
    let has_emission = PLAN_EMISSION_TEXTURES && material.emission_texture != NO_TEXTURE;
    let has_holes = material_has_holes(material);
    let has_opacity = has_holes && material.opacity_texture != NO_TEXTURE;
    for (var wanted = u32(has_emission) + 2u * u32(has_opacity); wanted != 0u; wanted &= wanted - 1u) {
        let is_emission = (wanted & 1u) != 0u;
        let found = texture_lookup(select(material.opacity_texture, material.emission_texture, is_emission), uvs);
        light *= select(vec4f(1.0, 1.0, 1.0, found.w), vec4f(found.xyz, 1.0), is_emission);
    }
    return light.xyz * select(1.0, stopped_share(material, light.w), has_holes);
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
    return select(f32(opacity >= material.alpha_cutoff), opacity, material.alpha_cutoff < 0.0);
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
    if PLAN_BOX_PROJECTION && (record.flags & IS_BOX) != 0u {
        right = vec4f(box_right(outward), 1.0);
    }
    let along = frame_from_tangent(normal, right.xyz, 0.0);
    let bitangent = along.bitangent * select(1.0, -1.0, right.w < 0.0);
    // A normal that points into the surface is bent onto it.
    return normalize_or(along.tangent * slope.x + bitangent * slope.y + normal * max(decoded.z, 0.0), normal);
}

// Texture coordinates at a position in a triangle; box projection only if `has_box`.
fn uvs_at(triangle: Triangle, weights: vec3f, has_box: bool) -> Uvs {
    var indices = vertices(triangle);
    var weight = weights;
    var sets = vec4f();
    var smooth_normal = vec3f();
    // Corners that have weight, in turn, so that the code that loads one is there once.
    while any(weight != vec3f()) {
        let at = vertex_at(indices.x);
        sets += at.uvs * weight.x;
        smooth_normal += at.normal * weight.x;
        indices = indices.yzx;
        weight = vec3f(weight.yz, 0.0);
    }
    var on_box = vec2f();
    if PLAN_BOX_PROJECTION && has_box {
        let at = corners(triangle);
        on_box = box_uv(at * weights, normalize_or(smooth_normal, triangle_normal(at)));
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
