// Light at path vertices: the environment, emission and next-event estimation, combined by multiple importance sampling
// (MIS). Twin of src/cpu/integrator/light.rs.
#import "scene/environment"
#import "scene/light"

fn world_environment_radiance(direction: vec3f) -> vec3f {
    let local = environment_local_from_world(direction, globals.environment_rotation);
    return environment_radiance(local) * globals.environment_strength;
}

// MIS weight of BSDF sampling for the environment's light, in [0, 1].
fn environment_mis_weight(direction: vec3f, lobe_density: f32, is_mirror: bool) -> f32 {
    if !samples_environment() || is_mirror {
        return 1.0;
    }
    let local = environment_local_from_world(direction, globals.environment_rotation);
    let light_density = globals.environment_probability * environment_density(local, globals.environment_cells_size);
    return mis_weight_lobe(lobe_density, light_density);
}

// Emission of a surface that the path hit after `distance`, times the MIS weight of BSDF sampling.
fn emitted_light(
    point: SurfacePoint, material: Material, distance: f32, lobe_density: f32, is_mirror: bool,
) -> vec3f {
    var emission = material.emission;
    let cosine = dot(point.flat, point.surface.wo);
    if PLAN_SPOT {
        emission *= spot_share(material, select(cosine, -cosine, point.surface.is_inside));
        emission *= profile_share(material, point.surface.wo);
    }
    if PLAN_COAT_ABSORPTION {
        emission *= coat_over_emission(material, cosine, point.surface.is_inside);
    }
    if !samples_emitters() || is_mirror {
        return emission;
    }
    if globals.strategy == STRATEGY_LIGHT {
        return vec3f();
    }
    return emission * mis_weight_lobe(lobe_density, light_density(material.light_luminance, cosine, distance));
}

// Balance-heuristic weight of BSDF sampling (Veach 1997).
fn mis_weight_lobe(lobe_density: f32, light_density: f32) -> f32 {
    return lobe_density / max(lobe_density + light_density, 1e-30);
}

// Whether light sampling samples the environment.
fn samples_environment() -> bool {
    return PLAN_LIGHT_SAMPLING && globals.environment_probability > 0.0 && globals.strategy != STRATEGY_LOBE;
}

// Whether light sampling samples emitting triangles.
fn samples_emitters() -> bool {
    return PLAN_EMITTER_SAMPLING && globals.density_per_luminance > 0.0 && globals.strategy != STRATEGY_LOBE;
}

// Whether light is sampled (next-event estimation).
fn samples_light() -> bool {
    return samples_environment() || samples_emitters();
}

// Chooses by a light sample's first number between the environment (is_below) and the emitters; also returns the remapped
// number.
fn choose_environment(xi: f32) -> Part {
    if samples_emitters() && samples_environment() {
        return split(xi, globals.environment_probability);
    }
    return Part(!samples_emitters(), xi);
}

// Samples a direction to the environment or an emitter. The environment's radiance is left out: it is looked up only if the
// shadow ray is unoccluded.
fn sample_light(point: SurfacePoint, is_environment: bool, xi: vec3f) -> LightSample {
    if !is_environment {
        return light_sample(point.position, point.error, xi);
    }
    let sampled = environment_sample(xi, globals.environment_cells_size);
    let direction = environment_world_from_local(sampled.direction, globals.environment_rotation);
    return LightSample(direction, sampled.density * globals.environment_probability, vec3f(), 1e30, ENVIRONMENT_GROUP);
}

// Whether an escaped path looks up the environment.
fn needs_environment(bounce: u32, was_mirror: bool) -> bool {
    if bounce == 0u {
        return globals.background_kind == BACKGROUND_BLURRED || globals.background_kind == BACKGROUND_ENVIRONMENT;
    }
    return was_mirror || !samples_environment() || globals.strategy != STRATEGY_LIGHT;
}

fn blurred(direction: vec3f, xi: vec2f) -> vec3f {
    let disc = globals.background.x * uniform_disc(xi);
    return world_from_local(frame_from_normal(direction), vec3f(disc, safe_sqrt(1.0 - dot(disc, disc))));
}

// Background colour and alpha of camera rays that miss; `sky` is the environment's radiance, if needed.
fn plain_background(sky: vec3f) -> vec4f {
    if needs_environment(0u, true) {
        return vec4f(sky, 1.0);
    }
    return select(vec4f(globals.background, 1.0), vec4f(), globals.background_kind == BACKGROUND_TRANSPARENT);
}

// Whether the kernel is compiled with light sampling.
fn may_sample_light() -> bool {
    return PLAN_LIGHT_SAMPLING || PLAN_EMITTER_SAMPLING;
}

// Background colour and alpha of a camera ray that misses; a blur draws the random pair of `dimension`.
fn camera_background(direction: vec3f, state: RandomState, dimension: u32) -> vec4f {
    var sky = vec3f();
    if needs_environment(0u, true) {
        var along = direction;
        if globals.background_kind == BACKGROUND_BLURRED {
            along = blurred(direction, random_pair(state, dimension));
        }
        sky = world_environment_radiance(along);
    }
    return plain_background(sky);
}
