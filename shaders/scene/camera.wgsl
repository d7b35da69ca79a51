// The camera's rays. Twin of src/scene/camera.rs.
#import "scene/constants"
#import "optics/random"
#import "scene/choices"
#import "optics/warp"

// 1 - exp(-(radius/sigma)^2/2): the Gaussian is cut off at 1.5 pixels.
const GAUSSIAN_KEPT = 0.988891f;

struct Camera {
    // In the geometry's units.
    origin: vec3f,
    // Share of the lens that is open, radius in the geometry's units.
    lens_radius: f32,
    forward: vec3f,
    focus_distance: f32,
    // Half the image's width and height at distance 1; with parallel rays themselves.
    right: vec3f,
    filter_kind: u32,
    up: vec3f,
    // How far behind the camera parallel rays start, which is where the origin is; 0 for a perspective.
    parallel_from: f32,
}

struct Ray {
    origin: vec3f,
    direction: vec3f,
}

fn filter_offset(filter_kind: u32, xi: vec2f) -> vec2f {
    if filter_kind == FILTER_BOX {
        return xi - 0.5;
    }
    return GAUSSIAN_SIGMA * safe_sqrt(-2.0 * log(1.0 - xi.x * GAUSSIAN_KEPT)) * unit_circle(xi.y);
}

fn pixel_ray(camera: Camera, pixel: vec2u, image_size: vec2u, state: RandomState) -> Ray {
    let offset = filter_offset(camera.filter_kind, random_pair(state, PIXEL_DIMENSION));
    return camera_ray(camera, vec2f(pixel) + 0.5 + offset, image_size, random_pair(state, LENS_DIMENSION));
}

fn camera_ray(camera: Camera, place: vec2f, image_size: vec2u, xi_lens: vec2f) -> Ray {
    let ndc = 2.0 * place / vec2f(image_size) - 1.0;
    var origin = camera.origin;
    var along = camera.forward + camera.right * ndc.x - camera.up * ndc.y;
    if camera.parallel_from > 0.0 {
        origin = camera.origin + camera.right * ndc.x - camera.up * ndc.y;
        along = camera.forward;
    }
    if camera.lens_radius <= 0.0 {
        return Ray(origin, normalize(along));
    }
    let disc = uniform_disc(xi_lens) * camera.lens_radius;
    let shift = normalize(camera.right) * disc.x + normalize(camera.up) * disc.y;
    return Ray(origin + shift, normalize(along * camera.focus_distance - shift));
}
