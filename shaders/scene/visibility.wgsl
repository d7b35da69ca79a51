// What stops a ray, and what lets it pass. Twin of Integrator::stop and Integrator::transmittance in
// src/cpu/integrator/rays.rs.
#import "optics/random"
#import "scene/camera"
#import "scene/plan"
#import "scene/surface"

// The first of the pairs of numbers that choose whether a surface stops a ray, one a bounce.
const OPACITY_DIMENSION: u32 = 8192u;
// Surfaces that a ray may go straight on through.
const PASSES_MAX: u32 = 256u;

// The share of light that reaches the origin of a ray from so far.
fn transmittance(start: vec3f, direction: vec3f, distance: f32, rays: ptr<function, u32>) -> f32 {
    if PLAN_ALPHA == 0u {
        *rays += 1u;
        return select(0.0, 1.0, trace(start, direction, distance, true).triangle == NO_HIT);
    }
    var origin = start;
    var share = 1.0;
    var left = distance;
    for (var i = 0u; i < PASSES_MAX; i++) {
        *rays += 1u;
        let hit = trace(origin, direction, left, false);
        if hit.triangle == NO_HIT {
            return share;
        }
        share *= 1.0 - hit_opacity(hit);
        if share <= 0.0 {
            break;
        }
        left -= hit.t;
        origin = passed_origin(hit, direction);
    }
    return 0.0;
}

// The hit that stops a ray, its t the distance from the ray's origin.
fn stop(ray: Ray, state: RandomState, bounce: u32, rays: ptr<function, u32>) -> Hit {
    if PLAN_ALPHA == 0u {
        *rays += 1u;
        return trace(ray.origin, ray.direction, 1e30, false);
    }
    var origin = ray.origin;
    var xi = random_pair(state, OPACITY_DIMENSION + bounce).x;
    var distance = 0.0;
    for (var i = 0u; i < PASSES_MAX; i++) {
        *rays += 1u;
        var hit = trace(origin, ray.direction, 1e30, false);
        if hit.triangle == NO_HIT {
            return hit;
        }
        distance += hit.t;
        hit.t = distance;
        let opacity = hit_opacity(hit);
        if xi < opacity {
            return hit;
        }
        // Uniform again, given that the surface did not stop the ray.
        xi = (xi - opacity) / max(1.0 - opacity, 1e-20);
        origin = passed_origin(hit, ray.direction);
    }
    return Hit(0.0, NO_HIT, 0.0, 0.0);
}
