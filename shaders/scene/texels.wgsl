// Arrays in textures: 1 << TEXEL_ROW_BITS texels in a row, as many rows in a layer (src/gpu/array.rs).
#import "scene/choices"

// Column, row and layer of an array's element.
fn texel_place(index: u32) -> vec3u {
    let row_mask = (1u << TEXEL_ROW_BITS) - 1u;
    return vec3u(index & row_mask, (index >> TEXEL_ROW_BITS) & row_mask, index >> (2u * TEXEL_ROW_BITS));
}
