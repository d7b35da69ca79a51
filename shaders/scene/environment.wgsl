// Light from far away: a lat-long map, looked up bilinearly and sampled in proportion to its luminance.
// Twin of src/scene/environment/mod.rs, which tells the conventions. The map is rgba32float and read by textureLoad, the
// cells come from src/scene/environment/distribution.rs.
#import "optics/numeric"
#import "scene/alias"
#import "scene/layout"

// One cell of the distribution: an entry of the alias table with the cell's density per steradian.
struct AliasCell {
    threshold: f32,
    alias_index: u32,
    density: f32,
}

fn environment_cell(index: u32) -> AliasCell {
    let place = texel_place(index);
    let words = textureLoad(environment_cells, place.xy, place.z, 0);
    return AliasCell(bitcast<f32>(words.x), words.y, bitcast<f32>(words.z));
}

struct EnvironmentSample {
    // In the map's frame.
    direction: vec3f,
    // Per steradian; 0 if the map is black.
    density: f32,
}

// The direction in the map's frame that a direction in the world meets when the map is turned about +Y, anticlockwise
// seen from above. rotation: cosine and sine of the angle.
fn environment_local_from_world(direction_world: vec3f, rotation: vec2f) -> vec3f {
    let d = direction_world;
    return vec3f(d.x * rotation.x - d.z * rotation.y, d.y, d.x * rotation.y + d.z * rotation.x);
}

fn environment_world_from_local(direction_local: vec3f, rotation: vec2f) -> vec3f {
    let d = direction_local;
    return vec3f(d.x * rotation.x + d.z * rotation.y, d.y, d.z * rotation.x - d.x * rotation.y);
}

fn environment_uv(direction: vec3f) -> vec2f {
    // An arctangent instead of acos: near the poles y is 1 to within rounding and only x and z tell the angle.
    let horizontal = sqrt(direction.x * direction.x + direction.z * direction.z);
    let v = arctan2(horizontal, direction.y) / PI;
    // The null vector has no angle.
    let z = select(direction.z, -1.0, !(horizontal > 0.0));
    let turns = arctan2(direction.x, -z) / (2.0 * PI);
    let u = select(turns, turns + 1.0, turns < 0.0);
    // A tiny negative angle plus one turn rounds to a whole turn.
    return vec2f(select(0.0, u, u < 1.0), clamp(v, 0.0, 1.0));
}

fn environment_direction(uv: vec2f) -> vec3f {
    let polar = unit_circle(0.5 * uv.y);
    return environment_direction_from_angles(uv.x, polar.x, polar.y);
}

fn environment_direction_from_angles(u: f32, cos_polar: f32, sin_polar: f32) -> vec3f {
    let azimuth = unit_circle(u - 0.5);
    return vec3f(-(azimuth.y * sin_polar), cos_polar, azimuth.x * sin_polar);
}

// Radiance from a direction: bilinear, wrapping in u, clamped at the poles in v.
fn environment_radiance(direction_local: vec3f) -> vec3f {
    let size = vec2i(textureDimensions(environment_map));
    let place = environment_uv(direction_local) * vec2f(size) - 0.5;
    let corner = floor(place);
    let share = place - corner;
    let columns = (vec2i(i32(corner.x), i32(corner.x) + 1) + size.x) % size.x;
    let rows = clamp(vec2i(i32(corner.y), i32(corner.y) + 1), vec2i(0), vec2i(size.y - 1));
    let upper = mix(
        textureLoad(environment_map, vec2i(columns.x, rows.x), 0).rgb,
        textureLoad(environment_map, vec2i(columns.y, rows.x), 0).rgb,
        share.x,
    );
    let lower = mix(
        textureLoad(environment_map, vec2i(columns.x, rows.y), 0).rgb,
        textureLoad(environment_map, vec2i(columns.y, rows.y), 0).rgb,
        share.x,
    );
    return mix(upper, lower, share.y);
}

// A direction drawn with the density that is returned with it. xi.xy choose the cell and the place in it, xi.z whether
// the cell or its alias is taken: see the twin for why one number would not do. cells_size: columns and rows of cells.
fn environment_sample(xi: vec3f, cells_size: vec2u) -> EnvironmentSample {
    let drawn = grid_place(xi.xy, cells_size);
    let cell = environment_cell(drawn.index);
    let chosen = select(cell.alias_index, drawn.index, xi.z < cell.threshold);
    let chosen_cell = vec2u(chosen % cells_size.x, chosen / cells_size.x);
    return EnvironmentSample(
        environment_direction_in_cell(chosen_cell, drawn.place, cells_size),
        environment_cell(chosen).density,
    );
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
    let sin_polar = 2.0 * sqrt(max(0.0, s * (1.0 - s)));
    return environment_direction_from_angles(u, select(cos_from_pole, -cos_from_pole, is_south), sin_polar);
}

// The density, per steradian, with which environment_sample draws a direction.
fn environment_density(direction_local: vec3f, cells_size: vec2u) -> f32 {
    return environment_cell(grid_place(environment_uv(direction_local), cells_size).index).density;
}
