// The path tracer. Twin of src/cpu/integrator.rs.
#import "optics/material"
#import "optics/random"
#import "scene/camera"
#import "scene/environment"
#import "scene/light"
#import "scene/surface"

const STRATEGY_LOBE: u32 = 0u;
const STRATEGY_LIGHT: u32 = 1u;
const STRATEGY_MIS: u32 = 2u;
const BACKGROUND_ENVIRONMENT: u32 = 0u;
const BACKGROUND_TRANSPARENT: u32 = 1u;
// Pairs of numbers before the first bounce (pixel, lens) and a bounce (lobe twice, light twice).
const FIRST_DIMENSION: u32 = 2u;
const BOUNCE_DIMENSIONS: u32 = 4u;
// The first of the pairs of numbers for what the specular lobe passed on, two a bounce: beyond those of every path.
const BELOW_DIMENSION: u32 = 4096u;
// Bounces before Russian roulette.
const ROULETTE_START: u32 = 3u;
// Beyond it the square would overflow: dropped and counted.
const RADIANCE_MAX: f32 = 1e18;

struct PathResult {
    radiance: vec3f,
    alpha: f32,
    rays: u32,
    // Luminance that limiting fireflies took.
    clamped: f32,
}

fn far_radiance(direction: vec3f) -> vec3f {
    let local = environment_local_from_world(direction, globals.environment_rotation);
    return environment_radiance(local) * globals.environment_strength;
}

// What a path that left the scene sees, weighed against light sampling.
fn far_light(direction: vec3f, lobe_density: f32, is_mirror: bool) -> vec3f {
    let radiance = far_radiance(direction);
    if PLAN_LIGHT_SAMPLING == 0u || is_mirror || globals.strategy == STRATEGY_LOBE {
        return radiance;
    }
    if globals.strategy == STRATEGY_LIGHT {
        return vec3f(0.0);
    }
    let local = environment_local_from_world(direction, globals.environment_rotation);
    let light_density = globals.environment_probability * environment_density(local, globals.environment_cells_size);
    return radiance * lobe_share(lobe_density, light_density);
}

// What a surface emits that a path met at `distance`, weighed against light sampling.
fn emitted_light(point: SurfacePoint, distance: f32, lobe_density: f32, is_mirror: bool) -> vec3f {
    let emission = materials[point.slot].emission;
    if PLAN_EMITTER_SAMPLING == 0u || is_mirror || globals.strategy == STRATEGY_LOBE {
        return emission;
    }
    if globals.strategy == STRATEGY_LIGHT {
        return vec3f(0.0);
    }
    let cosine = dot(point.surface.normal, point.surface.wo);
    return emission * lobe_share(lobe_density, light_density(emission, cosine, distance));
}

// The share of the lobe under the balance heuristic (Veach 1997) where it met light by itself.
fn lobe_share(lobe_density: f32, light_density: f32) -> f32 {
    return lobe_density / max(lobe_density + light_density, 1e-30);
}

// Whether light is sampled at all.
fn samples_light() -> bool {
    return (PLAN_LIGHT_SAMPLING == 1u || PLAN_EMITTER_SAMPLING == 1u) && globals.strategy != STRATEGY_LOBE;
}

// Whether one light sample is drawn from the environment, not from the triangles that emit.
fn is_from_afar(xi: f32) -> bool {
    return PLAN_EMITTER_SAMPLING == 0u || (PLAN_LIGHT_SAMPLING == 1u && xi < globals.environment_probability);
}

// A direction drawn from the triangles that emit or from the environment, whose radiance is looked up once it is known
// to arrive.
fn draw_light(point: SurfacePoint, xi: vec3f) -> LightSample {
    let share = globals.environment_probability;
    if !is_from_afar(xi.z) {
        return light_sample(point.position, point.error, vec3f(xi.xy, (xi.z - share) / (1.0 - share)));
    }
    let drawn = environment_sample(vec3f(xi.xy, xi.z / share), globals.environment_cells_size);
    let direction = environment_world_from_local(drawn.direction, globals.environment_rotation);
    return LightSample(direction, drawn.density * share, vec3f(0.0), 1e30);
}

// Light that arrives straight from the environment or from what emits, one direction drawn.
fn direct_light(point: SurfacePoint, state: RandomState, dimension: u32, rays: ptr<function, u32>) -> vec3f {
    let xi = vec3f(random_pair(state, dimension), random_pair(state, dimension + 1u).x);
    let light = draw_light(point, xi);
    let wi = light.direction;
    let transmits = material_transmits(materials[point.slot]);
    if light.density <= 0.0 || (dot(point.surface.normal, wi) <= 0.0 && !transmits) {
        return vec3f(0.0);
    }
    let competing = select(0.0, 1.0, globals.strategy == STRATEGY_MIS);
    let value = material_evaluate(materials[point.slot], point.surface, wi, light.density, competing);
    if all(value <= vec3f(0.0)) {
        return vec3f(0.0);
    }
    *rays += 1u;
    if trace(ray_origin(point, wi, transmits), wi, light.distance, true).triangle != NO_HIT {
        return vec3f(0.0);
    }
    if is_from_afar(xi.z) {
        return value * far_radiance(wi) / light.density;
    }
    return value * light.radiance / light.density;
}

// What a contribution that was reflected so many times adds; `taken` grows by the luminance that is beyond the limit.
fn limited(contribution: vec3f, reflections: u32, taken: ptr<function, f32>) -> vec3f {
    if PLAN_FIREFLY_CLAMP == 0u || reflections <= 1u {
        return contribution;
    }
    let largest = max(max(contribution.x, contribution.y), contribution.z);
    let kept = globals.firefly_clamp / max(largest, globals.firefly_clamp);
    *taken += luminance(contribution) * (1.0 - kept);
    return contribution * kept;
}

fn camera_background(direction: vec3f, rays: u32) -> PathResult {
    if globals.background_kind == BACKGROUND_ENVIRONMENT {
        return PathResult(far_radiance(direction), 1.0, rays, 0.0);
    }
    let is_transparent = globals.background_kind == BACKGROUND_TRANSPARENT;
    let color = select(globals.background, vec3f(0.0), is_transparent);
    return PathResult(color, select(1.0, 0.0, is_transparent), rays, 0.0);
}

fn trace_path(pixel: vec2u, sample: u32) -> PathResult {
    let state = random_state(pixel.x, pixel.y, globals.seed, sample, globals.sequence);
    let offset = filter_offset(globals.camera.filter_kind, random_pair(state, 0u));
    var camera = globals.camera;
    camera.lens_radius = select(0.0, camera.lens_radius, PLAN_LENS == 1u);
    var ray = camera_ray(camera, vec2f(pixel) + 0.5 + offset, globals.image_size, random_pair(state, 1u));
    var throughput = vec3f(1.0);
    var radiance = vec3f(0.0);
    var clamped = 0.0;
    var lobe_density = 0.0;
    var was_mirror = true;
    var rays = 0u;
    for (var bounce = 0u; ; bounce++) {
        rays += 1u;
        let hit = trace(ray.origin, ray.direction, 1e30, false);
        if hit.triangle == NO_HIT {
            if bounce == 0u {
                return camera_background(ray.direction, rays);
            }
            let found = throughput * far_light(ray.direction, lobe_density, was_mirror);
            radiance += limited(found, bounce, &clamped);
            break;
        }
        let point = surface_at(hit, ray.direction);
        let material = materials[point.slot];
        if PLAN_ABSORPTION == 1u && point.surface.is_inside && material_transmits(material) {
            throughput *= exp(-material.absorption * hit.t);
        }
        if PLAN_EMISSION == 1u {
            let found = throughput * emitted_light(point, hit.t, lobe_density, was_mirror);
            radiance += limited(found, bounce, &clamped);
        }
        if bounce >= globals.bounces {
            break;
        }
        let dimension = FIRST_DIMENSION + bounce * BOUNCE_DIMENSIONS;
        if samples_light() {
            let found = throughput * direct_light(point, state, dimension + 2u, &rays);
            radiance += limited(found, bounce + 1u, &clamped);
        }
        let xi = vec4f(random_pair(state, dimension), random_pair(state, dimension + 1u));
        let wants_density = samples_light() && globals.strategy == STRATEGY_MIS;
        var numbers = MaterialNumbers(xi.xyz, xi.w, xi.xyz);
        if material_transmits(material) {
            let pair = BELOW_DIMENSION + 2u * bounce;
            numbers.below = vec3f(random_pair(state, pair), random_pair(state, pair + 1u).x);
        }
        let drawn = material_sample(material, point.surface, numbers, wants_density);
        throughput *= drawn.throughput;
        let strength = max(max(throughput.x, throughput.y), throughput.z);
        if !(strength > 0.0) {
            break;
        }
        if bounce >= ROULETTE_START && strength < 1.0 {
            if random_pair(state, dimension + 3u).y >= strength {
                break;
            }
            throughput /= strength;
        }
        lobe_density = drawn.density;
        was_mirror = drawn.is_mirror;
        ray = Ray(ray_origin(point, drawn.wi, material_transmits(material)), drawn.wi);
    }
    return PathResult(radiance, 1.0, rays, clamped);
}

// Finite and not negative: what may be added to the picture.
fn is_sound(color: vec3f) -> bool {
    // Infinity fails the upper bound; NaN fails both.
    return all(color >= vec3f(0.0)) && all(color <= vec3f(RADIANCE_MAX));
}

@compute @workgroup_size(8, 8)
fn path_trace(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= globals.tile_size) {
        return;
    }
    let pixel = globals.tile_origin + id.xy;
    var color = vec4f(0.0);
    // Luminance squared, kept, dropped, rays.
    var sums = vec4f(0.0);
    var taken = 0.0;
    for (var i = 0u; i < globals.sample_count; i++) {
        let path = trace_path(pixel, globals.first_sample + i);
        sums.w += f32(path.rays);
        if is_sound(path.radiance) {
            let y = luminance(path.radiance);
            color += vec4f(path.radiance, path.alpha);
            taken += path.clamped;
            sums += vec4f(y * y, 1.0, 0.0, 0.0);
        } else {
            sums.z += 1.0;
        }
    }
    let index = pixel.y * globals.image_size.x + pixel.x;
    color_sums[index] += color;
    statistics[index] += sums;
    if PLAN_FIREFLY_CLAMP == 1u {
        statistics[globals.image_size.x * globals.image_size.y + index].x += taken;
    }
}
