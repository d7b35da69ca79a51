// The path tracer. Twin of src/cpu/integrator/mod.rs.
#import "pass/light"
#import "pass/light_groups"
#import "optics/layer/scatter"
#import "scene/catcher"
#import "scene/visibility"

// Random pairs before the first bounce (pixel, lens) and per bounce (two for the lobe, two for light and roulette).
const FIRST_DIMENSION = 2u;
const BOUNCE_DIMENSIONS = 4u;
// First dimension of the directions below the specular lobe, two pairs per bounce: beyond the dimensions of every path.
const BELOW_DIMENSION = 4096u;
// Dimensions of the shadow catcher's choice to mirror, and (the next one) of the background's blur.
const CATCHER_DIMENSION = 12288u;
// A path's state after its camera ray hit the shadow catcher: no visible hit; shadow over an opaque background; shadow over
// a transparent one, whose light becomes alpha; mirrored.
const CATCHER_MISS = 0u;
const CATCHER_SHADOW = 1u;
const CATCHER_SHADOW_ALPHA = 2u;
const CATCHER_MIRRORED = 3u;
// Number of bounces without Russian roulette.
const ROULETTE_START = 3u;
// Largest radiance per channel that is kept. Its square would overflow; larger samples are dropped and counted.
const RADIANCE_MAX = 1e18f;

// Sums of the first-hit guides over a pixel's first samples, of the even-numbered or the odd-numbered ones.
struct GuideSums {
    // Times the throughput of the mirrors and glass before it.
    albedo: vec3f,
    // Number of samples whose camera ray hit.
    hits: f32,
    normal: vec3f,
    // Along the camera's axis, in the geometry's units.
    depth: f32,
}

// x: the first pixel row of the sums; y: their number of pixels.
@group(1) @binding(0) var<uniform> band: vec4u;
// The tiles of this dispatch, one texel each (see Tile); TILE_COLUMNS per row.
@group(1) @binding(1) var tiles: texture_2d<u32>;
// One element per pixel; then as many for each light group.
@group(1) @binding(2) var<storage, read_write> color_sums: array<PixelColors>;
@group(1) @binding(3) var<storage, read_write> statistics: array<PixelStatistics>;
// Two elements per pixel: even-numbered samples, then odd-numbered ones.
@group(1) @binding(4) var<storage, read_write> guide_sums: array<GuideSums>;

struct PathResult {
    radiance: vec3f,
    alpha: f32,
    rays: u32,
    // Luminance that the firefly clamp removed.
    clamped: f32,
    // Throughput's luminance if the bounce limit ended the path.
    cut: f32,
    // First-hit guides.
    guides: GuideSums,
}

// A shadow ray and the light that it may bring.
struct ShadowRay {
    ray: Ray,
    distance: f32,
    // Contribution if unoccluded; for the environment without its radiance.
    value: vec3f,
    is_environment: bool,
    // Number of the light's group.
    group: u32,
    // True if known to be unoccluded: no traversal needed.
    is_known_miss: bool,
    // True until the ray has been traced.
    is_pending: bool,
}

// True if a ray from the point is known to miss: outside a convex body, in a scene without interreflection.
fn is_known_miss(point: SurfacePoint, wi: vec3f) -> bool {
    return !PLAN_INTERREFLECTION && !point.surface.is_inside && dot(point.flat, wi) > 0.0;
}

// Adds a contribution after `reflections` bounces of the light, limited by the firefly clamp.
fn add_light(path: ptr<function, PathResult>, contribution: vec3f, reflections: u32, group: u32) {
    if reflections < globals.least_reflections {
        return;
    }
    let largest = max_component(contribution);
    var kept = 1.0;
    if PLAN_FIREFLY_CLAMP && reflections > 1u && largest > globals.firefly_clamp {
        kept = globals.firefly_clamp / largest;
        path.clamped += luminance(contribution) * (1.0 - kept);
    }
    let light = contribution * kept;
    path.radiance += light;
    add_to_group(group, light);
}

// Slot of the medium that a path enters in direction wi.
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

// Beer-Lambert transmittance of a medium over a distance, per channel.
fn transmittance_over(medium: u32, distance: f32) -> vec3f {
    if medium == NO_MEDIUM {
        return WHITE;
    }
    return exp(-material_at(medium).absorption * distance);
}

// How a path continues after its camera ray hit the shadow catcher.
struct CatcherHit {
    kind: u32,
    throughput: vec3f,
    // Radiance that is added directly: the background if mirrored or invisible; else the background's channels that receive
    // no light here, which have no shadow.
    radiance: vec3f,
    alpha: f32,
}

// Hit of a camera ray on the shadow catcher. The catcher is invisible from below and without light.
fn hit_catcher(position: vec3f, direction: vec3f, state: RandomState) -> CatcherHit {
    let light = catcher_light(globals.catcher_table, position);
    let is_visible = direction.y < 0.0 && max_component(light) > 0.0;
    // An invisible catcher uses the random pair of a ray that missed.
    let background = camera_background(direction, state, select(FIRST_DIMENSION, CATCHER_DIMENSION + 1u, is_visible));
    let is_mirrored = random_pair(state, CATCHER_DIMENSION).x < catcher_reflectance(globals.catcher_table, -direction.y);
    if !is_visible || is_mirrored {
        return CatcherHit(select(CATCHER_MISS, CATCHER_MIRRORED, is_visible), WHITE, background.rgb, background.a);
    }
    let is_transparent = background.a <= 0.0;
    let shown = select(background.rgb, WHITE, is_transparent);
    let is_lit = select(vec3f(), WHITE, light > vec3f());
    let reflected = light * material_at(globals.catcher_slot).base_color;
    let kept = select(vec3f(), 1.0 / reflected, reflected > vec3f());
    return CatcherHit(
        select(CATCHER_SHADOW, CATCHER_SHADOW_ALPHA, is_transparent), shown * kept, shown * (1.0 - is_lit), 1.0,
    );
}

// One sample of a pixel: unidirectional path tracing with next-event estimation and multiple importance sampling.
//
// A bounce has these steps: trace the last vertex's shadow ray and the path's own ray; if that escaped, add the background or
// the environment and end; else absorb, record guides, add emission, sample a light, sample the BSDF, play Russian roulette.
// Each look-up stands in the code once, because copies cost registers and compile time. Hence the loop over both rays.
fn trace_path(pixel: vec2u, sample: u32) -> PathResult {
    let state = path_state(pixel.x, pixel.y, globals.seed, sample, globals.sequence);
    clear_groups();
    var camera = globals.camera;
    camera.lens_radius = select(0.0, camera.lens_radius, PLAN_LENS);
    // The path's state. A camera ray counts as a mirror's: light sampling could not have drawn it, so its MIS weight is 1.
    var ray = pixel_ray(camera, pixel, globals.image_size, state);
    var throughput = WHITE;
    var path = PathResult();
    path.alpha = 1.0;
    var rough_bounces = 0u;
    var lobe_density = 0.0;
    var was_mirror = true;
    var known_miss = false;
    var is_active = true;
    var shadow_ray = ShadowRay();
    var catcher_state = CATCHER_MISS;
    var catcher_hit = CatcherHit();
    // The slot of the medium that the path is in.
    var medium = globals.camera_medium;
    // True while the path has met only mirrors and clear glass.
    var records_guides = PLAN_GUIDES && sample < GUIDE_SAMPLES;
    // A path that ended still has its last shadow ray to trace.
    for (var bounce = 0u; is_active || shadow_ray.is_pending; bounce++) {
        var hit = Hit(0.0, NO_HIT, 0.0, 0.0);
        var sky = vec3f();
        // Two turns: the last vertex's shadow ray, then the path's own ray. As a loop, so that the traversal and the
        // environment's look-up are in the kernel once.
        for (var turn = u32(!may_sample_light()); turn < 2u; turn++) {
            let is_shadow_ray = turn == 0u;
            if !select(is_active, shadow_ray.is_pending, is_shadow_ray) {
                continue;
            }
            var along = ray;
            var length = 1e30;
            var skips_traversal = known_miss;
            if is_shadow_ray {
                along = shadow_ray.ray;
                length = shadow_ray.distance;
                skips_traversal = shadow_ray.is_known_miss;
            }
            // Rays that leave a convex body miss: no traversal needed.
            var intersection = Intersection(hit, 1.0, 0u);
            if !skips_traversal {
                let xi = random_pair(state, OPACITY_DIMENSION + bounce).x;
                intersection = intersect(along, length, is_shadow_ray, bounce == 0u && !is_shadow_ray, xi);
                path.rays += intersection.rays;
            }
            // The environment is looked up only where its light arrives: after an unoccluded shadow ray towards it, or after
            // a miss. A blurred background is seen in a direction of its own.
            var needs_sky = intersection.transmittance > 0.0 && shadow_ray.is_environment;
            if !is_shadow_ray {
                hit = intersection.hit;
                // More surfaces to pass than are looked at.
                if hit.triangle == NO_HIT && intersection.transmittance == 0.0 {
                    path.cut += luminance(throughput);
                }
                needs_sky = hit.triangle == NO_HIT && needs_environment(bounce, was_mirror);
                if bounce == 0u && globals.background_kind == BACKGROUND_BLURRED {
                    along.direction = blurred(along.direction, random_pair(state, FIRST_DIMENSION));
                }
            }
            if needs_sky {
                sky = world_environment_radiance(along.direction);
            }
            // Direct light of the last vertex: `bounce` reflections, as that vertex was number `bounce` - 1.
            if is_shadow_ray {
                let arrives = select(WHITE, sky, shadow_ray.is_environment) * intersection.transmittance;
                add_light(&path, shadow_ray.value * arrives, bounce, shadow_ray.group);
                shadow_ray.is_pending = false;
            }
        }
        if !is_active {
            break;
        }
        // A miss ends the path: with the camera's background, or with the environment times its MIS weight.
        if hit.triangle == NO_HIT {
            // The catcher's reflection shows the background that the camera ray would have seen without it.
            if PLAN_SHADOW_CATCHER && catcher_state == CATCHER_MIRRORED {
                add_light(&path, catcher_hit.radiance, bounce, ENVIRONMENT_GROUP);
                path.alpha = catcher_hit.alpha;
                catcher_state = CATCHER_MISS;
                break;
            }
            var contribution = throughput * sky;
            if bounce == 0u {
                let background = plain_background(sky);
                contribution = background.rgb;
                path.alpha = background.a;
            } else {
                contribution *= environment_mis_weight(ray.direction, lobe_density, was_mirror);
            }
            add_light(&path, contribution, bounce, ENVIRONMENT_GROUP);
            break;
        }
        var slot = slot_at(hit.triangle);
        // Next to the surface look-up below, so that drivers merge the loads of both.
        let place = hit_place(hit, ray.direction);
        // A camera ray that hits the shadow catcher restarts there: with a throughput that turns the light into a share of the
        // background, or as a mirror ray. Where the catcher is invisible, the path ends with the background.
        if PLAN_SHADOW_CATCHER {
            if catcher_state == CATCHER_MIRRORED {
                catcher_state = CATCHER_MISS;
            }
            if bounce == 0u && slot == globals.catcher_slot {
                catcher_hit = hit_catcher(place.position, ray.direction, state);
                catcher_state = catcher_hit.kind;
                throughput = catcher_hit.throughput;
                if catcher_state == CATCHER_MIRRORED {
                    slot = globals.catcher_reflection_slot;
                } else {
                    add_light(&path, catcher_hit.radiance, 0u, ENVIRONMENT_GROUP);
                }
                if catcher_state == CATCHER_MISS {
                    path.alpha = catcher_hit.alpha;
                    break;
                }
            }
        }
        let material_there = material_at(slot);
        let point = surface_of(hit, ray.direction, slot, material_there);
        let is_mirrored = PLAN_SHADOW_CATCHER && catcher_state == CATCHER_MIRRORED;
        let material = textured_material(material_there, point.uvs, point.vertex_color);
        // Beer-Lambert absorption along the segment that ends here, before anything at this vertex is weighted.
        if PLAN_ABSORPTION {
            // At the back of a surface that transmits, the medium is that surface's own.
            throughput *= transmittance_over(select(medium, slot, is_within(material, point.surface)), hit.t);
        }
        let layers = material_layers(material, point.surface);
        // Guides for the denoiser. Later vertices overwrite them until one is not specular; depth is always the first hit's.
        let is_last = bounce >= globals.bounces;
        var albedo = vec3f();
        if records_guides || is_last {
            albedo = throughput * material_albedo(material, point.surface, layers);
        }
        if records_guides {
            path.guides.albedo = saturate(albedo);
            path.guides.normal = material_normal(material, point.surface, layers);
            if bounce == 0u {
                path.guides.hits = 1.0;
                path.guides.depth = hit.t * dot(ray.direction, camera.forward) - camera.parallel_from;
            }
        }
        // Emission that the path hit by BSDF sampling, weighted against light sampling.
        if PLAN_EMISSION {
            let contribution = throughput * emitted_light(point, material, hit.t, lobe_density, was_mirror);
            add_light(&path, contribution, bounce, material.flags >> LIGHT_GROUP_SHIFT);
        }
        // The bounce limit. What the surface would have scattered on is reported.
        if is_last {
            path.cut += luminance(albedo);
            break;
        }
        // Next-event estimation, first half: sample a direction towards the environment or an emitter. A mirror of the catcher
        // has no light sampling.
        let dimension = FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS;
        let transmits = material_transmits(material);
        let needs_density = samples_light() && globals.strategy == STRATEGY_MIS;
        var is_lit = false;
        var is_environment = false;
        var sampled_light = LightSample();
        if samples_light() && !is_mirrored {
            var xi = vec3f(random_pair(state, dimension + 2u), random_pair(state, dimension + 3u).x);
            let part = choose_environment(xi.x);
            xi.x = part.remapped;
            is_environment = part.is_below;
            sampled_light = sample_light(point, is_environment, xi);
            is_lit = sampled_light.density > 0.0 && (dot(point.surface.normal, sampled_light.direction) > 0.0 || transmits);
        }
        // The BSDF's value for that light and a sample of its own in one call, because both loop over the same layers.
        let xi = vec4f(random_pair(state, dimension), random_pair(state, dimension + 1u));
        var numbers = MaterialNumbers(xi.xyz, xi.w, xi.xyz);
        if passes_on(material) {
            let pair = BELOW_DIMENSION + 2u * bounce;
            numbers.below = vec3f(random_pair(state, pair), random_pair(state, pair + 1u).x);
        }
        let scattered = material_scatter(
            material, point.surface, layers, material_steps(is_lit, true), numbers, needs_density,
            MaterialLight(sampled_light.direction, sampled_light.density, f32(globals.strategy == STRATEGY_MIS)),
        );
        // The shadow ray is traced at the start of the next bounce, where the path's own ray needs the same code. Its value
        // is the whole contribution but for visibility and the environment's radiance.
        if may_sample_light() && any(scattered.reflected > vec3f()) {
            let along = sampled_light.direction;
            var value = throughput * scattered.reflected / sampled_light.density;
            value *= select(sampled_light.radiance, WHITE, is_environment);
            if PLAN_ABSORPTION && PLAN_EMITTER_SAMPLING && !is_environment {
                value *= transmittance_over(medium_towards(medium, point, slot, along, transmits), sampled_light.distance);
            }
            shadow_ray = ShadowRay(
                Ray(ray_origin(point, along, transmits), along), sampled_light.distance, value, is_environment,
                sampled_light.group, is_known_miss(point, along), true,
            );
        }
        // The sampled direction: the medium that it enters, and whether it can hit anything.
        var sampled = scattered.drawn;
        if PLAN_ABSORPTION {
            medium = medium_towards(medium, point, slot, sampled.wi, transmits);
        }
        known_miss = is_known_miss(point, sampled.wi);
        records_guides = records_guides && sampled.is_mirror;
        if is_mirrored {
            // The catcher's mirror ray keeps its full weight, also the light that facets would block. Its light must not
            // compete with light sampling, which the catcher does not do.
            known_miss = known_miss || !any(sampled.throughput > vec3f());
            sampled.throughput = WHITE;
            sampled.is_mirror = true;
        }
        throughput *= sampled.throughput;
        // Russian roulette by the largest throughput component. In glass the limit is low until enough bounces were rough:
        // long specular paths carry the caustics. NaN ends the path, too.
        let strength = max_component(throughput);
        is_active = strength > 0.0;
        var limit = 1.0;
        if PLAN_TRANSMISSION {
            limit = select(globals.roulette_floor, 1.0, rough_bounces >= ROULETTE_START);
            rough_bounces += u32(!sampled.is_mirror);
        }
        if bounce >= ROULETTE_START && strength < limit {
            let survival = strength / limit;
            is_active = is_active && random_pair(state, dimension + 3u).y < survival;
            throughput /= max(survival, 1e-37);
        }
        // What the next vertex needs to weight light that the ray finds.
        lobe_density = sampled.density;
        was_mirror = sampled.is_mirror;
        ray = Ray(ray_origin(point, sampled.wi, transmits), sampled.wi);
    }
    // Over a transparent background, the catcher's light is its alpha. A render of a part of the light has no shadow.
    if PLAN_SHADOW_CATCHER && catcher_state == CATCHER_SHADOW_ALPHA {
        clear_groups();
        path.alpha = select(1.0 - luminance(path.radiance), 0.0, globals.least_reflections > 0u);
        path.radiance = vec3f();
    }
    return path;
}

// True for a finite, non-negative colour of at most RADIANCE_MAX: only such samples enter the sums.
fn is_sound(color: vec3f) -> bool {
    // Infinity fails the upper bound; NaN fails both.
    return all(color >= vec3f()) && all(color <= vec3f(RADIANCE_MAX));
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
        sums.rays_clamped.x += f32(path.rays);
        if is_sound(path.radiance) {
            let y = luminance(path.radiance);
            let odd = f32(sample % 2u);
            colors.all += vec4f(path.radiance, path.alpha);
            colors.odd += odd * vec4f(path.radiance, 1.0);
            for (var group = 0u; PLAN_LIGHT_GROUPS && group < globals.light_groups; group++) {
                let light = vec4f(group_light(group), 0.0);
                let of_group = (1u + group) * band.y + index;
                color_sums[of_group].all += light;
                color_sums[of_group].odd += odd * light;
            }
            sums.luminance_squared += y * y * vec2f(1.0, odd);
            sums.kept_dropped.x += 1.0;
            sums.rays_clamped.y += path.clamped;
            sums.cut += path.cut;
            if PLAN_GUIDES && sample < GUIDE_SAMPLES {
                let half = 2u * index + sample % 2u;
                guide_sums[half].albedo += path.guides.albedo;
                guide_sums[half].hits += path.guides.hits;
                guide_sums[half].normal += path.guides.normal;
                guide_sums[half].depth += path.guides.depth;
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
    statistics[index].cut += sums.cut;
}
