// Arrays in textures: 1 << TEXEL_ROW_BITS texels in a row, as many rows in a layer (src/gpu/array.rs).
#import "scene/choices"

fn texel_at(texels: texture_2d_array<u32>, index: u32) -> vec4u {
    let row_mask = (1u << TEXEL_ROW_BITS) - 1u;
    let place = vec2u(index & row_mask, (index >> TEXEL_ROW_BITS) & row_mask);
    return textureLoad(texels, place, index >> (2u * TEXEL_ROW_BITS), 0);
}

// The texels of an element that has three.
fn three_texels(texels: texture_2d_array<u32>, index: u32) -> array<vec4u, 3> {
    var words: array<vec4u, 3>;
    for (var i = 0u; i < 3u; i++) {
        words[i] = texel_at(texels, 3u * index + i);
    }
    return words;
}
