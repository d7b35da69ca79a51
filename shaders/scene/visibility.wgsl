// Intersection and transmittance of rays. Twin of Integrator::intersect and Integrator::transmittance in
// src/cpu/integrator/rays.rs. One function for both, so that a kernel has the traversal once.
#import "scene/surface"
#import "scene/traversal"

// First dimension of the opacity tests, one pair per bounce.
const OPACITY_DIMENSION = 8192u;
// Transparent hits per ray at most. Beyond them a path's ray counts as a miss, and a shadow ray as blocked.
const PASSES_MAX = 4096u;

// Closest hit of a path's ray (t from the ray's origin), and transmittance of a shadow ray in [0, 1].
struct Intersection {
    hit: Hit,
    transmittance: f32,
    // Rays traced.
    rays: u32,
}

// The closest hit of a ray, which passes surfaces at random by their opacity; or the transmittance of a shadow ray.
fn intersect(
    ray: Ray, length: f32, is_shadow_ray: bool, is_camera_ray: bool, opacity_number: f32,
) -> Intersection {
    if !PLAN_ALPHA {
        let hit = trace(ray.origin, ray.direction, length, is_shadow_ray);
        return Intersection(hit, f32(hit.triangle == NO_HIT), 1u);
    }
    var origin = ray.origin;
    var xi = opacity_number;
    var distance = 0.0;
    var remaining = length;
    var intersection = Intersection(Hit(0.0, NO_HIT, 0.0, 0.0), 1.0, 0u);
    for (var i = 0u; i < PASSES_MAX; i++) {
        intersection.rays += 1u;
        let hit = trace(origin, ray.direction, remaining, false);
        if hit.triangle == NO_HIT {
            return intersection;
        }
        // Before the opacity, which reads the same triangle: drivers load it once.
        let place = hit_place(hit, ray.direction);
        let is_hidden = is_camera_ray && slot_at(hit.triangle) >= globals.first_hidden_slot;
        let opacity = select(hit_opacity(hit), 0.0, is_hidden);
        distance += hit.t;
        if is_shadow_ray {
            intersection.transmittance *= 1.0 - opacity;
            remaining -= hit.t;
            if intersection.transmittance <= 0.0 {
                return intersection;
            }
        } else if xi < opacity {
            intersection.hit = Hit(distance, hit.triangle, hit.u, hit.v);
            return intersection;
        }
        // Uniform again, given that the surface did not stop the ray.
        xi = (xi - opacity) / max(1.0 - opacity, 1e-20);
        origin = place.position - place.normal * place.error;
    }
    intersection.transmittance = 0.0;
    return intersection;
}
