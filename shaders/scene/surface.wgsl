// A ray's hit made into a surface to shade. Twin of src/scene/surface.rs.
#import "scene/texture"

struct SurfacePoint {
    surface: Surface,
    position: vec3f,
    // Error bound of `position` along the normal.
    error: f32,
    slot: u32,
    uvs: Uvs,
    // Interpolated vertex colour; white if unused.
    vertex_color: vec3f,
    // The normal of the triangle itself, on the side of the viewer.
    flat: vec3f,
    // Offset from the triangle to the rounded surface.
    rise: vec3f,
}

fn bent_normal(shading: vec3f, wo: vec3f) -> vec3f {
    let lean = dot(shading, wo);
    return select(shading, normalize_or(shading + wo * (VIEW_COSINE_MIN - lean), wo), lean < VIEW_COSINE_MIN);
}

// The normal bent so far that the mirror direction about it is above the geometric surface.
fn lifted_normal(shading: vec3f, geometric: vec3f, wo: vec3f) -> vec3f {
    let mirrored = 2.0 * dot(shading, wo) * shading - wo;
    let height = dot(mirrored, geometric);
    let lifted = normalize_or(mirrored + geometric * (MIRROR_HEIGHT_MIN - height), geometric);
    return select(shading, normalize_or(wo + lifted, geometric), height < MIRROR_HEIGHT_MIN);
}

// Position of a hit.
struct HitPlace {
    position: vec3f,
    // Error bound of `position` along the normal.
    error: f32,
    // The geometric normal, on the side of the ray's origin.
    normal: vec3f,
    is_back: bool,
}

fn hit_place(hit: Hit, direction: vec3f) -> HitPlace {
    let at = corners(triangle_at(hit.triangle));
    let weights = hit_weights(hit);
    let position = at * weights;
    let out = normalize_or(triangle_normal(at), -direction);
    let is_back = dot(out, -direction) < 0.0;
    let normal = select(out, -out, is_back);
    return HitPlace(position, position_error(at, weights, normal), normal, is_back);
}

// Barycentric weights of the corners.
fn hit_weights(hit: Hit) -> vec3f {
    return vec3f(1.0 - hit.u - hit.v, hit.u, hit.v);
}

fn surface_of(hit: Hit, direction: vec3f, slot: u32, material: Material) -> SurfacePoint {
    let triangle = triangle_at(hit.triangle);
    let weights = hit_weights(hit);
    let place = hit_place(hit, direction);
    let normal = place.normal;
    let wo = -direction;
    let indices = vertices(triangle);
    let a = vertex_at(indices.x);
    let b = vertex_at(indices.y);
    let c = vertex_at(indices.z);
    let normals = mat3x3f(a.normal, b.normal, c.normal);
    let interpolated = normals * weights;
    let smoothed = normalize_or(interpolated, normal);
    let side = select(1.0, -1.0, dot(smoothed, normal) < 0.0);
    let smooth_normal = bent_normal(side * smoothed, wo);
    var uvs = Uvs();
    if planned_textures() != 0u || PLAN_NORMAL_MAPS || PLAN_COAT_NORMALS {
        uvs = hit_uvs(hit, material);
    }
    let tangent = vec4f(
        mat3x3f(a.tangent, b.tangent, c.tangent) * weights,
        dot(vec3f(vertex_side(a), vertex_side(b), vertex_side(c)), weights),
    );
    let outward = normalize_or(interpolated, select(normal, -normal, place.is_back));
    var shading = smooth_normal;
    var coat_normal = smooth_normal;
    if PLAN_NORMAL_MAPS && material.normal_texture != NO_TEXTURE {
        let mapped = mapped_normal(material.normal_texture, material.normal_strength, uvs, smoothed, tangent, outward);
        shading = lifted_normal(bent_normal(side * mapped, wo), normal, wo);
    }
    if PLAN_COAT_NORMALS && material.coat_normal_texture != NO_TEXTURE {
        let mapped = mapped_normal(
            material.coat_normal_texture, material.coat_normal_strength, uvs, smoothed, tangent, outward,
        );
        coat_normal = lifted_normal(bent_normal(side * mapped, wo), normal, wo);
    }
    var frame = frame_from_normal(shading);
    if PLAN_ANISOTROPY && (material.anisotropy != 0.0 || material.coat_anisotropy != 0.0) {
        // The rotation is towards the bitangent; `shading` is on the viewer's side, the bitangent is defined from outside.
        let is_mirrored = side * tangent.w < 0.0;
        frame = frame_from_tangent(shading, tangent.xyz, select(1.0, -1.0, is_mirrored) * material.rotation_rad);
    }
    var horizon = normal;
    var rise = vec3f();
    if PLAN_SHADOW_TERMINATOR && globals.rounds_surfaces == 1u && !transmits_anywhere(material) {
        let at = corners(triangle);
        for (var i = 0u; i < 3u; i++) {
            rise += rise_to_plane(place.position, at[i], normals[i], weights[i], side < 0.0);
        }
        let is_round = dot(rise, normal) > place.error;
        horizon = select(normal, smooth_normal, is_round);
        rise = select(vec3f(), rise, is_round);
    }
    let surface = Surface(frame, horizon, wo, coat_normal, place.is_back);
    var color = WHITE;
    if (PLAN_COLOR_TEXTURES || PLAN_VERTEX_COLORS) && has_flag(material, VERTEX_BASE | VERTEX_EMISSION) {
        color = mat3x3f(corner_color(a).xyz, corner_color(b).xyz, corner_color(c).xyz) * weights;
    }
    return SurfacePoint(surface, place.position, place.error, slot, uvs, color, normal, rise);
}

// Whether the material transmits where its textures make it least metallic.
fn transmits_anywhere(material: Material) -> bool {
    let is_metal = material.metalness >= 1.0 && material.metalness_texture == NO_TEXTURE;
    return PLAN_TRANSMISSION && material.transmission_weight > 0.0 && !is_metal;
}

// Offset from a position in a triangle up to the tangent plane at a corner, if the position lies below it; times the
// corner's weight (Hanika 2021). is_turned: the normal points away from the viewer.
fn rise_to_plane(position: vec3f, corner: vec3f, normal: vec3f, weight: f32, is_turned: bool) -> vec3f {
    let depth = dot(corner - position, normal);
    return normal * (select(max(depth, 0.0), min(depth, 0.0), is_turned) * weight);
}

// The sign of a vertex's bitangent.
fn vertex_side(vertex: Vertex) -> f32 {
    return select(1.0, -1.0, (vertex.blue_side >> 31u) == 0u);
}

fn hit_uvs(hit: Hit, material: Material) -> Uvs {
    return uvs_at(triangle_at(hit.triangle), hit_weights(hit), has_flag(material, HAS_BOX));
}

// Opacity at a hit, in [0, 1].
fn hit_opacity(hit: Hit) -> f32 {
    let material = material_at(slot_at(hit.triangle));
    if !material_has_holes(material) {
        return 1.0;
    }
    let of_vertices = vertex_factors(material, triangle_at(hit.triangle), hit_weights(hit));
    return opacity_at(material, hit_uvs(hit, material), of_vertices.w);
}

// Error bound along the normal of a position interpolated between a triangle's corners.
fn position_error(corners: mat3x3f, weights: vec3f, normal: vec3f) -> f32 {
    let size = mat3x3f(abs(corners[0]), abs(corners[1]), abs(corners[2])) * abs(weights);
    return POSITION_ERROR * dot(abs(normal), size + 0.05);
}

// Origin of a ray from the surface towards `wi`: outside the position's error bound, behind the surface only if it
// transmits. A ray between the triangle's and the rounded surface's horizon starts on the latter.
fn ray_origin(point: SurfacePoint, wi: vec3f, transmits: bool) -> vec3f {
    let is_below = dot(point.flat, wi) < 0.0;
    let origin = point.position + point.flat * select(point.error, -point.error, transmits && is_below);
    if PLAN_SHADOW_TERMINATOR && is_below {
        return origin + point.rise;
    }
    return origin;
}
