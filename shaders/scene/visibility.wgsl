// What stops a ray, and what lets it pass. Twin of Integrator::stop and Integrator::transmittance in
// src/cpu/integrator/rays.rs: one function, so that the traversal stands once in a kernel.
#import "optics/random"
#import "scene/camera"
#import "scene/plan"
#import "scene/surface"
#import "scene/traversal"

// The first of the pairs of numbers that choose whether a surface stops a ray, one a bounce.
const OPACITY_DIMENSION: u32 = 8192u;
// Surfaces that a ray may go straight on through.
const PASSES_MAX: u32 = 256u;

// What a ray met: its t the distance from the ray's origin, and the share of the light from its end that got through.
struct Met {
    hit: Hit,
    share: f32,
}

// What stops a ray; or, of the way to a light, what share of it gets through.
fn meet(ray: Ray, length: f32, is_to_light: bool, opacity_number: f32, rays: ptr<function, u32>) -> Met {
    if PLAN_ALPHA == 0u {
        *rays += 1u;
        let hit = trace(ray.origin, ray.direction, length, is_to_light);
        return Met(hit, select(0.0, 1.0, hit.triangle == NO_HIT));
    }
    var origin = ray.origin;
    var xi = opacity_number;
    var distance = 0.0;
    var left = length;
    var met = Met(Hit(0.0, NO_HIT, 0.0, 0.0), 1.0);
    for (var i = 0u; i < PASSES_MAX; i++) {
        *rays += 1u;
        let hit = trace(origin, ray.direction, left, false);
        if hit.triangle == NO_HIT {
            return met;
        }
        // Before the opacity, which looks at the same triangle: drivers load it once.
        let passed = passed_origin(hit, ray.direction);
        let opacity = hit_opacity(hit);
        distance += hit.t;
        if is_to_light {
            met.share *= 1.0 - opacity;
            left -= hit.t;
            if met.share <= 0.0 {
                return met;
            }
        } else if xi < opacity {
            met.hit = Hit(distance, hit.triangle, hit.u, hit.v);
            return met;
        }
        // Uniform again, given that the surface did not stop the ray.
        xi = (xi - opacity) / max(1.0 - opacity, 1e-20);
        origin = passed;
    }
    met.share = 0.0;
    return met;
}
