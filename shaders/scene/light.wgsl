// Surfaces that emit: sampled by power, triangle by triangle. Twin of src/scene/light.rs.
#import "optics/coat_medium"
#import "scene/alias"
#import "scene/surface"

struct LightSample {
    // Unit direction to the sampled position.
    direction: vec3f,
    // Density per steradian.
    density: f32,
    radiance: vec3f,
    // Length of the shadow ray: it ends just before the position, so that the triangle itself is not hit.
    distance: f32,
    // Number of its light group.
    group: u32,
}

// Samples a position on an emitting triangle for `origin`. xi.xy select an entry of the table and the position, xi.z the
// entry or its alias. There must be such a triangle. The ray may start up to origin_error off `origin`.
fn light_sample(origin: vec3f, origin_error: f32, xi: vec3f) -> LightSample {
    let drawn = grid_place(xi.xy, globals.light_cells_size);
    // An entry of the alias table: the threshold as bits, the alias and the triangle.
    let cell = texel_at(light_cells, drawn.index);
    let index = texel_at(light_cells, select(cell.y, drawn.index, xi.z < bitcast<f32>(cell.x))).z;
    let triangle = triangle_at(index);
    let at = corners(triangle);
    // Uniform in area.
    let s = sqrt(drawn.place.x);
    let weights = vec3f(1.0 - s, s * (1.0 - drawn.place.y), s * drawn.place.y);
    let towards = at * weights - origin;
    let distance = length(towards);
    let direction = normalize_or(towards, vec3f(0.0, 1.0, 0.0));
    let normal = normalize_or(triangle_normal(at), direction);
    let material = material_at(slot_at(index));
    var radiance = material.emission;
    let facing = -dot(normal, direction);
    let needs_uvs = PLAN_EMISSION_TEXTURES || PLAN_ALPHA || PLAN_VERTEX_COLORS;
    var uvs = Uvs();
    if needs_uvs || (PLAN_COAT_ABSORPTION && PLAN_COAT_TEXTURES) {
        uvs = uvs_at(triangle, weights, has_flag(material, HAS_BOX));
    }
    if needs_uvs {
        radiance = emission_at(material, uvs, vertex_factors(material, triangle, weights));
    }
    if PLAN_SPOT {
        radiance *= spot_share(material, facing) * profile_share(material, -direction);
    }
    if PLAN_COAT_ABSORPTION {
        var coated = material;
        if PLAN_COAT_TEXTURES {
            coated = textured_material(material, uvs, WHITE);
        }
        radiance *= coat_over_emission(coated, facing, facing < 0.0);
    }
    let cosine = abs(facing);
    let error = position_error(at, weights, normal) + origin_error + POSITION_ERROR * distance;
    return LightSample(
        direction, light_density(material.light_luminance, cosine, distance), radiance, distance - error / max(cosine, COSINE_MIN),
        material.flags >> LIGHT_GROUP_SHIFT,
    );
}

// Share in [0, 1] of its radiance that a spot emits at this cosine to its axis.
fn spot_share(material: Material, cosine: f32) -> f32 {
    let ramp = saturate(cosine * material.spot_scale + material.spot_offset);
    return ramp * ramp;
}

// A place among ascending angles: the last one not above it, at most the last but one, and the share of the way to the next.
struct AngleCell {
    low: u32,
    beyond: f32,
}

fn angle_cell(table: u32, first: u32, count: u32, angle: f32) -> AngleCell {
    var low = 0u;
    var high = count - 1u;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if angle < table_number(table, first + middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    let start = table_number(table, first + low);
    let beyond = (angle - start) / (table_number(table, first + high) - start);
    return AngleCell(low, saturate(beyond));
}

// The radiance in a unit direction away from a light over its mean, by the table of its profile; 1 without one.
fn profile_share(material: Material, direction: vec3f) -> f32 {
    if !has_flag(material, HAS_PROFILE) {
        return 1.0;
    }
    let table = material.lobe_table;
    let axis = table_numbers(table, 0u);
    let width = table_numbers(table, 1u);
    let across = dot(width.xyz, direction);
    let up = dot(table_numbers(table, 2u).xyz, direction);
    let aside = sqrt(across * across + up * up);
    let rows = u32(axis.w);
    let columns = u32(width.w);
    let vertical = min(arctan2(aside, dot(axis.xyz, direction)) * (180.0 / PI), 180.0);
    let last = table_number(table, PROFILE_AXES_LENGTH + rows - 1u);
    if vertical < table_number(table, PROFILE_AXES_LENGTH) || vertical > last {
        return 0.0;
    }
    let row = angle_cell(table, PROFILE_AXES_LENGTH, rows, vertical);
    let horizontals = PROFILE_AXES_LENGTH + rows;
    var column = AngleCell(0u, 0.0);
    if columns > 1u && aside > 0.0 {
        let turned = arctan2(up, across) * (180.0 / PI);
        column = angle_cell(table, horizontals, columns, select(turned, turned + 360.0, turned < 0.0));
    }
    var shares = vec2f();
    for (var side = 0u; side < 2u; side++) {
        let place = horizontals + columns + min(column.low + side, columns - 1u) * rows + row.low;
        shares[side] = mix(table_number(table, place), table_number(table, place + 1u), row.beyond);
    }
    return mix(shares.x, shares.y, column.beyond);
}

// Density per steradian of light_sample for a position on a material of this luminance, at this cosine and distance.
fn light_density(light_luminance: f32, cosine: f32, distance: f32) -> f32 {
    return globals.density_per_luminance * light_luminance * distance * distance / max(cosine, COSINE_MIN);
}
