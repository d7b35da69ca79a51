// The path tracer. Twin of src/cpu/integrator/mod.rs.
#import "optics/layer/scatter"
#import "optics/random"
#import "optics/warp"
#import "scene/camera"
#import "scene/catcher"
#import "scene/choices"
#import "scene/environment"
#import "scene/light"
#import "scene/surface"
#import "scene/visibility"

// Pairs of numbers before the first bounce (pixel, lens) and a bounce (lobe twice, light twice).
const FIRST_DIMENSION: u32 = 2u;
const BOUNCE_DIMENSIONS: u32 = 4u;
// The first of the pairs of numbers for what the specular lobe passed on, two a bounce: beyond those of every path.
const BELOW_DIMENSION: u32 = 4096u;
// The pairs of numbers for what a shadow catcher does with a camera ray, and for the blur of the background below it.
const CATCHER_DIMENSION: u32 = 12288u;
// What a shadow catcher makes of a path: it has met none; the light that arrives tells how much of the background is seen,
// or, over a transparent one, its alpha; it is mirrored.
const CAUGHT_NOT: u32 = 0u;
const CAUGHT_SHADOW: u32 = 1u;
const CAUGHT_ALPHA: u32 = 2u;
const CAUGHT_MIRRORED: u32 = 3u;
// The slot of no solid.
const NO_MEDIUM: u32 = 0xffffffffu;
// Bounces before Russian roulette.
const ROULETTE_START: u32 = 3u;
// Beyond it the square would overflow: dropped and counted.
const RADIANCE_MAX: f32 = 1e18;

// What a dispatch renders of one tile.
struct Tile {
    // Its top left pixel.
    origin: vec2u,
    first_sample: u32,
    sample_count: u32,
}

// Sums of a pixel's colours since the host last took them.
struct PixelColors {
    // With the coverage.
    all: vec4f,
    // The same of the odd samples alone, one of two independent halves, with their number.
    odd: vec4f,
}

// Other sums over the samples of a pixel since the host last took them.
struct PixelStatistics {
    // Of all samples, and of the odd ones.
    luminance_squared: vec2f,
    // Samples in the sums, and samples that were not sound.
    kept_dropped: vec2f,
    // Rays, and luminance that limiting fireflies took.
    rays_clamped: vec2f,
    // Luminance of the throughput of paths that ended at their last bounce.
    cut: f32,
    unused: f32,
}

// Sums over the even or the odd ones of a pixel's first samples of what they saw first.
struct GuideSums {
    // Each times what mirrors and glass before it leave of the light.
    albedo: vec3f,
    // How many samples met something.
    hits: f32,
    normal: vec3f,
    // Along the camera's axis, in the geometry's units.
    depth: f32,
}

// x: the first row of pixels that the sums are of.
@group(1) @binding(0) var<uniform> band: vec4u;
// What this dispatch renders, a Tile each; TILE_COLUMNS in a row.
@group(1) @binding(1) var tiles: texture_2d<u32>;
// Sums over the samples of a pixel since the host last took them.
@group(1) @binding(2) var<storage, read_write> color_sums: array<PixelColors>;
@group(1) @binding(3) var<storage, read_write> statistics: array<PixelStatistics>;
// Two a pixel: of the even samples and of the odd ones.
@group(1) @binding(4) var<storage, read_write> guide_sums: array<GuideSums>;

// Pixels along the side of a tile, which is a workgroup.
const TILE_SIDE: u32 = 8u;

struct PathResult {
    radiance: vec3f,
    alpha: f32,
    rays: u32,
    // Luminance that limiting fireflies took.
    clamped: f32,
    // Luminance of the throughput where it ended at its last bounce.
    cut: f32,
    // What it saw first, where it is one of those that tell.
    seen: GuideSums,
}

fn far_radiance(direction: vec3f) -> vec3f {
    let local = environment_local_from_world(direction, globals.environment_rotation);
    return environment_radiance(local) * globals.environment_strength;
}

// The share of what a path that left the scene sees, weighed against light sampling.
fn far_share(direction: vec3f, lobe_density: f32, is_mirror: bool) -> f32 {
    if !samples_environment() || is_mirror {
        return 1.0;
    }
    let local = environment_local_from_world(direction, globals.environment_rotation);
    let light_density = globals.environment_probability * environment_density(local, globals.environment_cells_size);
    return lobe_share(lobe_density, light_density);
}

// What a surface emits that a path met at `distance`, weighed against light sampling.
fn emitted_light(
    point: SurfacePoint, material: Material, distance: f32, lobe_density: f32, is_mirror: bool,
) -> vec3f {
    var emission = material.emission;
    if PLAN_SPOT == 1u {
        let cosine = dot(point.flat, point.surface.wo);
        emission *= spot_share(material, select(cosine, -cosine, point.surface.is_inside));
    }
    if !samples_emitters() || is_mirror {
        return emission;
    }
    if globals.strategy == STRATEGY_LIGHT {
        return vec3f(0.0);
    }
    let cosine = dot(point.flat, point.surface.wo);
    return emission * lobe_share(lobe_density, light_density(material.light_luminance, cosine, distance));
}

// The share of the lobe under the balance heuristic (Veach 1997) where it met light by itself.
fn lobe_share(lobe_density: f32, light_density: f32) -> f32 {
    return lobe_density / max(lobe_density + light_density, 1e-30);
}

// Whether directions are drawn from the environment.
fn samples_environment() -> bool {
    return PLAN_LIGHT_SAMPLING == 1u && globals.environment_probability > 0.0 && globals.strategy != STRATEGY_LOBE;
}

// Whether directions are drawn towards the triangles that emit.
fn samples_emitters() -> bool {
    return PLAN_EMITTER_SAMPLING == 1u && globals.density_per_luminance > 0.0 && globals.strategy != STRATEGY_LOBE;
}

// Whether light is sampled at all.
fn samples_light() -> bool {
    return samples_environment() || samples_emitters();
}

// Whether the first number of a light sample chooses the environment, not the triangles that emit; and the number that
// draws from what it chose.
fn choose_afar(xi: f32) -> Part {
    if !samples_emitters() {
        return Part(true, xi);
    }
    if !samples_environment() {
        return Part(false, xi);
    }
    return split(xi, globals.environment_probability);
}

// A direction drawn from the environment, whose radiance is looked up once it is known to arrive, or from the triangles
// that emit.
fn draw_light(point: SurfacePoint, is_from_afar: bool, xi: vec3f) -> LightSample {
    if !is_from_afar {
        return light_sample(point.position, point.error, xi);
    }
    let drawn = environment_sample(xi, globals.environment_cells_size);
    let direction = environment_world_from_local(drawn.direction, globals.environment_rotation);
    return LightSample(direction, drawn.density * globals.environment_probability, vec3f(0.0), 1e30);
}

// Light drawn at a surface point, on the way there.
struct SampledLight {
    ray: Ray,
    distance: f32,
    // What it adds to the picture where nothing is in its way: times the radiance where it comes from afar.
    value: vec3f,
    is_from_afar: bool,
    // Where it is proven that nothing is.
    is_free: bool,
    // Where it is to be looked after.
    waits: bool,
}

// True where it is proven that nothing lies ahead: outside a convex body.
fn meets_nothing(point: SurfacePoint, wi: vec3f) -> bool {
    return PLAN_INTERREFLECTION == 0u && !point.surface.is_inside && dot(point.flat, wi) > 0.0;
}

// What a contribution that was reflected so many times adds; `taken` grows by the luminance that is beyond the limit.
fn limited(contribution: vec3f, reflections: u32, taken: ptr<function, f32>) -> vec3f {
    if reflections < globals.least_reflections {
        return vec3f(0.0);
    }
    let largest = max(max(contribution.x, contribution.y), contribution.z);
    if PLAN_FIREFLY_CLAMP == 0u || reflections <= 1u || !(largest > globals.firefly_clamp) {
        return contribution;
    }
    let kept = globals.firefly_clamp / largest;
    *taken += luminance(contribution) * (1.0 - kept);
    return contribution * kept;
}

// The slot of the solid that a path is in which leaves a surface towards wi.
fn medium_towards(medium: u32, point: SurfacePoint, slot: u32, wi: vec3f, transmits: bool) -> u32 {
    if !transmits {
        return medium;
    }
    let is_behind = dot(point.surface.normal, wi) < 0.0;
    if is_behind != point.surface.is_inside {
        return slot;
    }
    return select(medium, NO_MEDIUM, is_behind);
}

// What a solid leaves of light over a distance.
fn kept_over(medium: u32, distance: f32) -> vec3f {
    if medium == NO_MEDIUM {
        return vec3f(1.0);
    }
    return exp(-material_at(medium).absorption * distance);
}

// Whether a path that meets nothing looks the environment up.
fn looks_afar(bounce: u32, was_mirror: bool) -> bool {
    if bounce == 0u {
        return globals.background_kind == BACKGROUND_BLURRED || globals.background_kind == BACKGROUND_ENVIRONMENT;
    }
    return was_mirror || !samples_environment() || globals.strategy != STRATEGY_LIGHT;
}

fn blurred(direction: vec3f, xi: vec2f) -> vec3f {
    let disc = globals.background.x * uniform_disc(xi);
    return world_from_local(frame_from_normal(direction), vec3f(disc, safe_sqrt(1.0 - dot(disc, disc))));
}

// The colour of what the camera sees where it meets nothing, and its alpha; `sky` where it is looked up.
fn plain_background(sky: vec3f) -> vec4f {
    if looks_afar(0u, true) {
        return vec4f(sky, 1.0);
    }
    let is_transparent = globals.background_kind == BACKGROUND_TRANSPARENT;
    return select(vec4f(globals.background, 1.0), vec4f(0.0), is_transparent);
}

// Whether a kernel has light sampling at all.
fn may_sample_light() -> bool {
    return PLAN_LIGHT_SAMPLING == 1u || PLAN_EMITTER_SAMPLING == 1u;
}

// What the camera sees where it meets nothing, and its alpha; a blur is drawn with the pair of this dimension.
fn camera_background(direction: vec3f, state: RandomState, dimension: u32) -> vec4f {
    var sky = vec3f(0.0);
    if looks_afar(0u, true) {
        var along = direction;
        if globals.background_kind == BACKGROUND_BLURRED {
            along = blurred(direction, random_pair(state, dimension));
        }
        sky = far_radiance(along);
    }
    return plain_background(sky);
}

// How a path begins anew at the shadow catcher.
struct Caught {
    kind: u32,
    throughput: vec3f,
    // Of the background where it is mirrored or the catcher is not there; else what has no shadow, since no light of that
    // colour would reach the place.
    radiance: vec3f,
    alpha: f32,
}

// A camera ray met the shadow catcher; it is not there seen from below, and without light.
fn catch_shadow(position: vec3f, direction: vec3f, state: RandomState) -> Caught {
    let light = catcher_light(globals.catcher_table, position);
    let is_there = direction.y < 0.0 && max(max(light.x, light.y), light.z) > 0.0;
    // Where it is not, the numbers are those of a ray that met nothing.
    let background = camera_background(direction, state, select(FIRST_DIMENSION, CATCHER_DIMENSION + 1u, is_there));
    let is_mirrored = random_pair(state, CATCHER_DIMENSION).x < catcher_reflectance(globals.catcher_table, -direction.y);
    if !is_there || is_mirrored {
        return Caught(select(CAUGHT_NOT, CAUGHT_MIRRORED, is_there), vec3f(1.0), background.rgb, background.a);
    }
    let is_transparent = background.a <= 0.0;
    let shown = select(background.rgb, vec3f(1.0), is_transparent);
    let albedo = material_at(globals.catcher_slot).base_color;
    let is_lit = select(vec3f(0.0), vec3f(1.0), light > vec3f(0.0));
    let reflected = light * albedo + (vec3f(1.0) - is_lit);
    let kind = select(CAUGHT_SHADOW, CAUGHT_ALPHA, is_transparent);
    return Caught(kind, shown * is_lit / reflected, shown * (vec3f(1.0) - is_lit), 1.0);
}

fn trace_path(pixel: vec2u, sample: u32) -> PathResult {
    let state = path_state(pixel.x, pixel.y, globals.seed, sample, globals.sequence);
    var camera = globals.camera;
    camera.lens_radius = select(0.0, camera.lens_radius, PLAN_LENS == 1u);
    var ray = pixel_ray(camera, pixel, globals.image_size, state);
    var throughput = vec3f(1.0);
    var radiance = vec3f(0.0);
    var alpha = 1.0;
    var clamped = 0.0;
    var cut = 0.0;
    var rough_bounces = 0u;
    var lobe_density = 0.0;
    var was_mirror = true;
    var rays = 0u;
    var leaves = false;
    var goes_on = true;
    var light = SampledLight();
    var seen = GuideSums();
    var caught = CAUGHT_NOT;
    var below = Caught();
    // The slot of the solid that the path is in.
    var medium = globals.camera_medium;
    // Nothing but mirrors and clear glass so far.
    var looks = PLAN_GUIDES == 1u && sample < GUIDE_SAMPLES;
    for (var bounce = 0u; goes_on || light.waits; bounce++) {
        var hit = Hit(0.0, NO_HIT, 0.0, 0.0);
        var sky = vec3f(0.0);
        // The light that was drawn at the last surface, then the path itself: a loop, so that the traversal and the
        // environment's look-up are there once.
        for (var turn = select(1u, 0u, may_sample_light()); turn < 2u; turn++) {
            let is_light = turn == 0u;
            if !select(goes_on, light.waits, is_light) {
                continue;
            }
            var along = ray;
            var length = 1e30;
            var is_free = leaves;
            if is_light {
                along = light.ray;
                length = light.distance;
                is_free = light.is_free;
            }
            var met = Met(hit, 1.0);
            if !is_free {
                var xi = 0.0;
                if PLAN_ALPHA == 1u && !is_light {
                    xi = random_pair(state, OPACITY_DIMENSION + bounce).x;
                }
                met = meet(along, length, is_light, xi, &rays);
            }
            if !is_light {
                hit = met.hit;
            }
            var wants_sky = met.share > 0.0 && light.is_from_afar;
            if !is_light {
                wants_sky = hit.triangle == NO_HIT && looks_afar(bounce, was_mirror);
                if bounce == 0u && globals.background_kind == BACKGROUND_BLURRED {
                    along.direction = blurred(along.direction, random_pair(state, FIRST_DIMENSION));
                }
            }
            if wants_sky {
                sky = far_radiance(along.direction);
            }
            if is_light {
                let arrives = select(vec3f(1.0), sky, light.is_from_afar) * met.share;
                radiance += limited(light.value * arrives, bounce, &clamped);
                light.waits = false;
            }
        }
        if !goes_on {
            break;
        }
        if hit.triangle == NO_HIT {
            if PLAN_SHADOW_CATCHER == 1u && caught == CAUGHT_MIRRORED {
                radiance += limited(below.radiance, bounce, &clamped);
                alpha = below.alpha;
                caught = CAUGHT_NOT;
                break;
            }
            var found = throughput * sky;
            if bounce == 0u {
                let background = plain_background(sky);
                found = background.rgb;
                alpha = background.a;
            } else {
                found *= far_share(ray.direction, lobe_density, was_mirror);
            }
            radiance += limited(found, bounce, &clamped);
            break;
        }
        var slot = slot_at(hit.triangle);
        // Here, so that it is the same as that of the surface below, and drivers make one of both.
        let place = hit_place(hit, ray.direction);
        if PLAN_SHADOW_CATCHER == 1u {
            if caught == CAUGHT_MIRRORED {
                caught = CAUGHT_NOT;
            }
            if bounce == 0u && slot == globals.catcher_slot {
                below = catch_shadow(place.position, ray.direction, state);
                caught = below.kind;
                throughput = below.throughput;
                if caught == CAUGHT_MIRRORED {
                    slot = globals.catcher_reflection_slot;
                } else {
                    radiance = limited(below.radiance, 0u, &clamped);
                }
                if caught == CAUGHT_NOT {
                    alpha = below.alpha;
                    break;
                }
            }
        }
        let material_there = material_at(slot);
        let point = surface_of(hit, ray.direction, slot, material_there);
        let is_mirrored = PLAN_SHADOW_CATCHER == 1u && caught == CAUGHT_MIRRORED;
        let material = textured_material(material_there, point.uvs, point.vertex_color);
        if PLAN_ABSORPTION == 1u {
            // The back of a surface that transmits tells the solid by itself.
            let is_within = point.surface.is_inside && material_transmits(material);
            throughput *= kept_over(select(medium, slot, is_within), hit.t);
        }
        let layers = material_layers(material, point.surface);
        if looks {
            let albedo = throughput * material_albedo(material, point.surface, layers);
            seen.albedo = clamp(albedo, vec3f(0.0), vec3f(1.0));
            seen.normal = material_normal(material, point.surface, layers);
            if bounce == 0u {
                seen.hits = 1.0;
                seen.depth = hit.t * dot(ray.direction, camera.forward);
            }
        }
        if PLAN_EMISSION == 1u {
            let found = throughput * emitted_light(point, material, hit.t, lobe_density, was_mirror);
            radiance += limited(found, bounce, &clamped);
        }
        if bounce >= globals.bounces {
            if PLAN_TRANSMISSION == 1u {
                cut = luminance(throughput);
            }
            break;
        }
        let dimension = FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS;
        let transmits = material_transmits(material);
        let wants_density = samples_light() && globals.strategy == STRATEGY_MIS;
        var is_lit = false;
        var lit = LightSample(vec3f(0.0), 0.0, vec3f(0.0), 0.0);
        if may_sample_light() && samples_light() && !is_mirrored {
            var xi = vec3f(random_pair(state, dimension + 2u), random_pair(state, dimension + 3u).x);
            let part = choose_afar(xi.x);
            xi.x = part.stretched;
            light.is_from_afar = part.is_below;
            lit = draw_light(point, part.is_below, xi);
            is_lit = lit.density > 0.0 && (dot(point.surface.normal, lit.direction) > 0.0 || transmits);
        }
        let xi = vec4f(random_pair(state, dimension), random_pair(state, dimension + 1u));
        var numbers = MaterialNumbers(xi.xyz, xi.w, xi.xyz);
        if passes_on(material) {
            let pair = BELOW_DIMENSION + 2u * bounce;
            numbers.below = vec3f(random_pair(state, pair), random_pair(state, pair + 1u).x);
        }
        let asked = MaterialLight(lit.direction, lit.density, select(0.0, 1.0, globals.strategy == STRATEGY_MIS));
        let steps = material_steps(is_lit, true);
        let scattered = material_scatter(material, point.surface, layers, steps, numbers, wants_density, asked);
        if may_sample_light() && any(scattered.reflected > vec3f(0.0)) {
            light.ray = Ray(ray_origin(point, lit.direction, transmits), lit.direction);
            light.distance = lit.distance;
            light.value = throughput * scattered.reflected / lit.density;
            light.value *= select(lit.radiance, vec3f(1.0), light.is_from_afar);
            if PLAN_ABSORPTION == 1u && PLAN_EMITTER_SAMPLING == 1u && !light.is_from_afar {
                light.value *= kept_over(medium_towards(medium, point, slot, lit.direction, transmits), lit.distance);
            }
            light.is_free = meets_nothing(point, lit.direction);
            light.waits = true;
        }
        var drawn = scattered.drawn;
        if PLAN_ABSORPTION == 1u {
            medium = medium_towards(medium, point, slot, drawn.wi, transmits);
        }
        leaves = meets_nothing(point, drawn.wi);
        looks = looks && drawn.is_mirror;
        if is_mirrored {
            // All of it goes on, also what the facets would keep, and none of what it meets is left to light sampling.
            leaves = leaves || !any(drawn.throughput > vec3f(0.0));
            drawn.throughput = vec3f(1.0);
            drawn.is_mirror = true;
        }
        throughput *= drawn.throughput;
        let strength = max(max(throughput.x, throughput.y), throughput.z);
        goes_on = strength > 0.0;
        var limit = 1.0;
        if PLAN_TRANSMISSION == 1u {
            limit = select(globals.roulette_floor, 1.0, rough_bounces >= ROULETTE_START);
            rough_bounces += select(1u, 0u, drawn.is_mirror);
        }
        if bounce >= ROULETTE_START && strength < limit {
            let survival = strength / limit;
            goes_on = goes_on && random_pair(state, dimension + 3u).y < survival;
            throughput /= max(survival, 1e-37);
        }
        lobe_density = drawn.density;
        was_mirror = drawn.is_mirror;
        ray = Ray(ray_origin(point, drawn.wi, transmits), drawn.wi);
    }
    if PLAN_SHADOW_CATCHER == 1u && caught == CAUGHT_ALPHA {
        // A part of the light alone casts no shadow.
        let covered = select(1.0 - luminance(radiance), 0.0, globals.least_reflections > 0u);
        return PathResult(vec3f(0.0), covered, rays, clamped, cut, seen);
    }
    return PathResult(radiance, alpha, rays, clamped, cut, seen);
}

// Finite and not negative: what may be added to the picture.
fn is_sound(color: vec3f) -> bool {
    // Infinity fails the upper bound; NaN fails both.
    return all(color >= vec3f(0.0)) && all(color <= vec3f(RADIANCE_MAX));
}

@compute @workgroup_size(TILE_SIDE, TILE_SIDE)
fn path_trace(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_id) place: vec3u) {
    let words = textureLoad(tiles, vec2u(workgroup.x % TILE_COLUMNS, workgroup.x / TILE_COLUMNS), 0);
    let tile = Tile(words.xy, words.z, words.w);
    let pixel = tile.origin + place.xy;
    if any(pixel >= globals.image_size) {
        return;
    }
    let index = (pixel.y - band.x) * globals.image_size.x + pixel.x;
    var colors = PixelColors();
    var sums = PixelStatistics();
    for (var i = 0u; i < tile.sample_count; i++) {
        let sample = tile.first_sample + i;
        let path = trace_path(pixel, sample);
        sums.rays_clamped += vec2f(f32(path.rays), 0.0);
        if is_sound(path.radiance) {
            let y = luminance(path.radiance);
            let odd = f32(sample % 2u);
            colors.all += vec4f(path.radiance, path.alpha);
            colors.odd += odd * vec4f(path.radiance, 1.0);
            sums.luminance_squared += y * y * vec2f(1.0, odd);
            sums.kept_dropped.x += 1.0;
            sums.rays_clamped.y += path.clamped;
            sums.cut += path.cut;
            if PLAN_GUIDES == 1u && sample < GUIDE_SAMPLES {
                let half = 2u * index + sample % 2u;
                guide_sums[half].albedo += path.seen.albedo;
                guide_sums[half].hits += path.seen.hits;
                guide_sums[half].normal += path.seen.normal;
                guide_sums[half].depth += path.seen.depth;
            }
        } else {
            sums.kept_dropped.y += 1.0;
        }
    }
    color_sums[index].all += colors.all;
    color_sums[index].odd += colors.odd;
    statistics[index].luminance_squared += sums.luminance_squared;
    statistics[index].kept_dropped += sums.kept_dropped;
    statistics[index].rays_clamped += sums.rays_clamped;
    if PLAN_TRANSMISSION == 1u {
        statistics[index].cut += sums.cut;
    }
}
