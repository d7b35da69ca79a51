// The geometric lobe and its density. Twin of src/optics/lobe/geometric.rs, which explains the mathematics.
#import "optics/curve"
#import "optics/lobe/lobe"
#import "optics/warp"

const GEOMETRIC_HEMISPHERICAL: bool = false;
const FEW_NODES_ROUGHNESS: f32 = 0.6;
const RANGE_MAX: f32 = 14.0;

const GAUSS_8: array<vec2f, 4> = array<vec2f, 4>(
    vec2f(0.183434642, 0.362683783),
    vec2f(0.52553241, 0.313706646),
    vec2f(0.796666477, 0.222381034),
    vec2f(0.960289856, 0.101228536),
);
const GAUSS_16: array<vec2f, 8> = array<vec2f, 8>(
    vec2f(0.0950125098, 0.18945061),
    vec2f(0.281603551, 0.182603415),
    vec2f(0.458016778, 0.169156519),
    vec2f(0.617876244, 0.149595989),
    vec2f(0.755404408, 0.124628971),
    vec2f(0.865631202, 0.0951585117),
    vec2f(0.944575023, 0.0622535239),
    vec2f(0.989400935, 0.0271524594),
);

fn geometric_widths(shape: LobeShape) -> vec3f {
    let stretch = stretch_from_anisotropy(shape.anisotropy);
    return vec3f(shape.roughness * stretch, shape.roughness / stretch, shape.roughness);
}

fn geometric_sample(shape: LobeShape, frame: Frame, wo: vec3f, xi: vec3f) -> vec3f {
    let mirror = mirrored_about(wo, frame.normal);
    let ball = uniform_sphere(xi.xy) + frame.normal * shape.roughness;
    let distance = curve_distance(shape.curve, shape.table, xi.z);
    var spread = ball * shape.roughness;
    if shape.anisotropy != 0.0 {
        spread = world_from_local(frame, local_from_world(frame, ball) * geometric_widths(shape));
    }
    // R = 1 with D = 0 or V = -n leaves nothing to normalise: any direction is right for a set of measure zero.
    return normalize_or(mirror * (1.0 - shape.roughness) + spread * distance, frame.normal);
}

fn geometric_density(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    let mirror_world = mirrored_about(wo, frame.normal);
    if shape.anisotropy == 0.0 {
        let scale = (1.0 - shape.roughness) / shape.roughness;
        return geometric_unit_ball_density(shape, frame.normal, mirror_world, scale, wi);
    }
    let width = geometric_widths(shape);
    let mirror = local_from_world(frame, mirror_world) / width;
    let light = local_from_world(frame, wi) / width;
    let mirror_length = length(mirror);
    let light_length = length(light);
    let scale = (1.0 - shape.roughness) * mirror_length;
    let up = vec3f(0.0, 0.0, 1.0);
    let value = geometric_unit_ball_density(shape, up, mirror / mirror_length, scale, light / light_length);
    return value / (width.x * width.y * width.z * light_length * light_length * light_length);
}

fn geometric_weight(shape: LobeShape, frame: Frame, wo: vec3f, wi: vec3f) -> f32 {
    return 1.0;
}

// The integrand's geometry for one direction: everything that does not depend on the node.
struct GeometricChord {
    kappa: f32,
    k: f32,
    nu: f32,
    m: f32,
    e: f32,
    tau_middle: f32,
    tau_scale: f32,
    delta_root: f32,
    mu: f32,
}

fn geometric_integrand(chord: GeometricChord, shape: LobeShape, exp_u: f32) -> f32 {
    let inverse = 1.0 / exp_u;
    let tau = chord.tau_middle + chord.tau_scale * 0.5 * (exp_u - inverse);
    let s = chord.delta_root * 0.5 * (exp_u + inverse);
    // D is the positive root of k D^2 + 2 kappa (n.q) D - |q|^2 = 0 in the form that does not cancel.
    let lifted = chord.kappa * (tau * chord.nu - chord.m);
    let distance = select(
        (s - lifted) / max(chord.k, 1e-9),
        (tau * tau + chord.e) / (lifted + s),
        lifted > 0.0,
    );
    let t = max(tau + chord.mu, 0.0);
    return t * t * curve_h(shape.curve, shape.table, distance);
}

fn geometric_unit_ball_density(shape: LobeShape, normal: vec3f, mirror: vec3f, scale: f32, light: vec3f) -> f32 {
    let kappa = shape.roughness;
    let k = max((1.0 - kappa) * (1.0 + kappa), 0.0);
    let apart = mirror - light;
    let versine = 0.5 * dot(apart, apart);
    // The part of a perpendicular to the direction, from the difference of the two: exact where they are close.
    let perpendicular = (apart + light * versine) * scale;
    let mu = scale * (1.0 - versine);
    let nu = dot(normal, light);
    let m = dot(normal, perpendicular);
    let e = dot(perpendicular, perpendicular);
    let kappa2 = kappa * kappa;
    let a_root = sqrt(max(kappa2 * nu * nu + k, 1e-30));
    let a = a_root * a_root;
    // Clamped from below: at the mirror direction the density has an integrable peak.
    let a_delta = max(k * (kappa2 * (nu * nu * e + m * m) + k * e), 1e-18);
    let tau_scale = sqrt(a_delta) / a;
    let tau_middle = kappa2 * nu * m / a;
    // The chord of the ball of D's maximum, and the part of it ahead of the surface point.
    let reach = curve_distance_max(shape.curve, shape.table);
    let discriminant = reach * reach * a - e - 2.0 * reach * kappa * m;
    let half_chord = safe_sqrt(discriminant);
    let tau_last = reach * kappa * nu + half_chord;
    let tau_first = max(reach * kappa * nu - half_chord, -mu);
    if discriminant <= 0.0 || tau_first >= tau_last {
        return 0.0;
    }
    let u_last = arsinh((tau_last - tau_middle) / tau_scale);
    let u_first = max(arsinh((tau_first - tau_middle) / tau_scale), u_last - RANGE_MAX);
    let chord = GeometricChord(kappa, k, nu, m, e, tau_middle, tau_scale, tau_scale * a_root, mu);
    let integral = geometric_integrate(chord, shape, u_first, u_last);
    return max(0.25 * INV_PI * integral / a_root, 0.0);
}

// Gauss-Legendre over u; the nodes' exponentials come in pairs, e^(c + d) and e^(c - d).
fn geometric_integrate(chord: GeometricChord, shape: LobeShape, first: f32, last: f32) -> f32 {
    let half_range = 0.5 * (last - first);
    let middle = exp(0.5 * (last + first));
    var sum = 0.0;
    if geometric_has_few_nodes(shape) {
        for (var i = 0u; i < 4u; i++) {
            sum += geometric_pair(chord, shape, middle, half_range, GAUSS_8[i]);
        }
    } else {
        for (var i = 0u; i < 8u; i++) {
            sum += geometric_pair(chord, shape, middle, half_range, GAUSS_16[i]);
        }
    }
    return sum * half_range;
}

fn geometric_pair(chord: GeometricChord, shape: LobeShape, middle: f32, half_range: f32, node: vec2f) -> f32 {
    let step = exp(half_range * node.x);
    let pair = geometric_integrand(chord, shape, middle * step) + geometric_integrand(chord, shape, middle / step);
    return pair * node.y;
}

fn geometric_has_few_nodes(shape: LobeShape) -> bool {
    let is_polynomial = shape.curve == CURVE_SQRT || shape.curve == CURVE_CBRT || shape.curve == CURVE_SMOOTH;
    return is_polynomial && shape.roughness <= FEW_NODES_ROUGHNESS;
}
