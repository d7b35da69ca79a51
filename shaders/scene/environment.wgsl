// The environment light: a latitude-longitude map, filtered bilinearly and sampled in proportion to its luminance. Twin of
// src/scene/environment/mod.rs, which describes the conventions. The map is rgba32float and read by textureLoad; the cells
// come from src/scene/environment/distribution.rs.
#import "scene/alias"
#import "scene/inversion"
#import "scene/layout"

struct EnvironmentSample {
    // Direction in the map's frame.
    direction: vec3f,
    // Per steradian; 0 if the map is black.
    density: f32,
}

// Converts a world direction to the frame of the map, which is rotated about +Y, anticlockwise from above. rotation: cosine
// and sine of the angle.
fn environment_local_from_world(direction_world: vec3f, rotation: vec2f) -> vec3f {
    let d = direction_world;
    return vec3f(d.x * rotation.x - d.z * rotation.y, d.y, d.x * rotation.y + d.z * rotation.x);
}

fn environment_world_from_local(direction_local: vec3f, rotation: vec2f) -> vec3f {
    return environment_local_from_world(direction_local, vec2f(rotation.x, -rotation.y));
}

fn environment_uv(direction: vec3f) -> vec2f {
    // atan2 instead of acos: near the poles y rounds to 1, and only x and z determine the angle.
    let horizontal = sqrt(direction.x * direction.x + direction.z * direction.z);
    // The null vector has no angle.
    let turns = arctan2(direction.x, -select(direction.z, -1.0, !(horizontal > 0.0))) / (2.0 * PI);
    let u = select(turns, turns + 1.0, turns < 0.0);
    // A tiny negative angle plus one turn rounds to a whole turn.
    return vec2f(select(0.0, u, u < 1.0), saturate(arctan2(horizontal, direction.y) / PI));
}

// Radiance from a direction: bilinear, wrapping in u, clamped at the poles in v.
fn environment_radiance(direction_local: vec3f) -> vec3f {
    let size = vec2i(textureDimensions(environment_map));
    let place = environment_uv(direction_local) * vec2f(size) - 0.5;
    let corner = floor(place);
    let share = place - corner;
    let columns = (vec2i(i32(corner.x), i32(corner.x) + 1) + size.x) % size.x;
    let rows = clamp(vec2i(i32(corner.y), i32(corner.y) + 1), vec2i(0), vec2i(size.y - 1));
    let left_top = textureLoad(environment_map, vec2i(columns.x, rows.x), 0);
    let right_top = textureLoad(environment_map, vec2i(columns.y, rows.x), 0);
    let left_bottom = textureLoad(environment_map, vec2i(columns.x, rows.y), 0);
    let right_bottom = textureLoad(environment_map, vec2i(columns.y, rows.y), 0);
    return mix(mix(left_top, right_top, share.x), mix(left_bottom, right_bottom, share.x), share.y).rgb;
}

// Samples a direction and its density. xi.y selects the row of a cell, xi.x the column; xi.z supplies the bits that they
// lack. cells_size: columns and rows of cells.
fn environment_sample(xi: vec3f, cells_size: vec2u) -> EnvironmentSample {
    let jitters = xi.z * 4096.0;
    var chosen = vec2u();
    var place = vec2f();
    var density = 0.0;
    // A row, then one of its cells.
    for (var step = 0u; step < 2u; step++) {
        let is_row = step == 0u;
        // A random number in [0, 1) as one of the 2^24.
        let number = u32(select(xi.x, xi.y, is_row) * f32(1u << DRAW_BITS));
        let count = select(cells_size.x, cells_size.y, is_row);
        let drawn = environment_draw(select(chosen.y, cells_size.y, is_row) * cells_size.x, count, number);
        if is_row {
            chosen.y = drawn.index;
            place.y = place_in(drawn.bounds, number, fract(jitters));
        } else {
            chosen.x = drawn.index;
            place.x = place_in(drawn.bounds, number, floor(jitters) / 4096.0);
            density = drawn.density;
        }
    }
    return EnvironmentSample(environment_direction_in_cell(chosen, place, cells_size), density);
}

struct DrawnCell {
    index: u32,
    bounds: vec2u,
    density: f32,
}

// The entry that a number draws of `count`, which begin with cell `first`.
fn environment_draw(first: u32, count: u32, number: u32) -> DrawnCell {
    // The slot of a number is the number without its last bits.
    let guide = texel_at(environment_cells, first + (number >> (DRAW_BITS - firstLeadingBit(count)))).z;
    var low = guide & 0xffffu;
    var high = guide >> 16u;
    var middle = (low + high) / 2u;
    var cell = texel_at(environment_cells, first + middle);
    loop {
        let is_later = number >= cell.y && middle < high;
        let is_before = number < cell.x && middle > low;
        if !(is_later || is_before) {
            break;
        }
        low = select(low, middle + 1u, is_later);
        high = select(high, middle - 1u, is_before);
        middle = (low + high) / 2u;
        cell = texel_at(environment_cells, first + middle);
    }
    return DrawnCell(middle, cell.xy, bitcast<f32>(cell.w));
}

// The direction at a place (in [0, 1]^2, from the top left) of a cell, uniform in solid angle.
fn environment_direction_in_cell(cell: vec2u, place: vec2f, cells_size: vec2u) -> vec3f {
    let u = (f32(cell.x) + place.x) / f32(cells_size.x);
    // sin^2 of half the angle is uniform in solid angle, and exact near the pole that the angle is counted from: the
    // nearer one.
    let is_south = 2u * cell.y >= cells_size.y;
    let row_from_pole = f32(select(cell.y, cells_size.y - 1u - cell.y, is_south));
    let across = select(place.y, 1.0 - place.y, is_south);
    let turns_per_row = 0.25 / f32(cells_size.y);
    let near = unit_circle(turns_per_row * row_from_pole).y;
    let far = unit_circle(turns_per_row * (row_from_pole + 1.0)).y;
    let s = near * near + across * (far * far - near * near);
    let cos_from_pole = 1.0 - 2.0 * s;
    let sin_polar = 2.0 * safe_sqrt(s * (1.0 - s));
    let azimuth = unit_circle(u - 0.5);
    return vec3f(-(azimuth.y * sin_polar), select(cos_from_pole, -cos_from_pole, is_south), azimuth.x * sin_polar);
}

// The density, per steradian, with which environment_sample draws a direction.
fn environment_density(direction_local: vec3f, cells_size: vec2u) -> f32 {
    return bitcast<f32>(texel_at(environment_cells, grid_place(environment_uv(direction_local), cells_size).index).w);
}
