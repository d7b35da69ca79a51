// The geometric lobe's density with the lobe as a unit ball. Twin of src/optics/chord.rs, which explains the mathematics.
#import "optics/curve/registry"

struct Chord {
    centre: f32,
    spread: f32,
    product: f32,
    nearest: f32,
    even: vec3f,
    odd: vec2f,
    a_root: f32,
    // D and W.
    last: vec2f,
    first: vec2f,
}

fn chord_density(
    curve: u32, table: u32, kappa: f32, stretch: f32, normal: vec3f, mirror: vec3f, light: vec3f,
) -> f32 {
    let chord = chord_through(curve_distance_max(curve, table), kappa, stretch, normal, mirror, light);
    // No intersection, or none ahead.
    if chord.nearest >= chord.last.x || chord.first.y <= -chord.last.y {
        return 0.0;
    }
    // Each integral is called at one place: drivers inline, and compile in more than proportion to the size.
    var how = curve_integral(curve);
    // The rules of 6, 12 and 20 points: half of them are in the table.
    var rule = select(vec2u(9u, 19u), vec2u(3u, 9u), kappa <= SHORT_RULE_ROUGHNESS);
    if how == INTEGRAL_POLYNOMIAL_TO_ZERO {
        how = INTEGRAL_POLYNOMIAL;
        if chord_range(chord) < SHORT_RANGE {
            how = INTEGRAL_QUADRATURE;
            rule = vec2u(0u, 3u);
        }
    }
    var integral = 0.0;
    switch how {
        case INTEGRAL_RECIPROCAL: { integral = chord_reciprocal_integral(chord); }
        case INTEGRAL_POLYNOMIAL: { integral = chord_polynomial_integral(chord, curve_polynomial(curve)); }
        case INTEGRAL_QUADRATURE: { integral = chord_quadrature(curve, rule.x, rule.y, chord); }
        default: { integral = chord_table_integral(table, chord); }
    }
    return max(0.25 * INV_PI * integral / chord.a_root, 0.0);
}

fn chord_through(reach: f32, kappa: f32, stretch: f32, normal: vec3f, mirror: vec3f, light: vec3f) -> Chord {
    let scale = (1.0 - kappa) * stretch;
    let k = (1.0 - kappa) * (1.0 + kappa);
    let apart = mirror - light;
    let perpendicular = (apart - light * dot(light, apart)) * scale;
    let mu = scale * (1.0 - 0.5 * dot(apart, apart));
    let m = kappa * dot(normal, perpendicular);
    let peak = scale * PEAK_RADIUS;
    let e = max(max(dot(perpendicular, perpendicular), peak * peak), TINY);
    let lift = kappa * dot(normal, light);
    let a = max(lift * lift + k, TINY);
    let a_root = sqrt(a);
    let a_inverse = 1.0 / a;
    let centre = m * a_inverse;
    let product = e * a_inverse;
    let spread = sqrt(centre * centre + product);
    let larger = spread + abs(centre);
    let nearest = select(larger, product / larger, centre < 0.0);
    // The sphere through the surface point: k D^2 - 2 kappa (n.a) D - |a|^2 = 0, 1 - kappa divided out.
    let tilt = kappa * dot(normal, mirror);
    let root = safe_sqrt(tilt * tilt + k);
    let through = select(root + tilt, k / (root + abs(tilt)), tilt < 0.0);
    let start = min(max(stretch * through / (1.0 + kappa), nearest), reach);
    let beyond = reach - nearest;
    let last = safe_sqrt(beyond * (beyond + 2.0 * spread));
    return Chord(
        centre,
        spread,
        product,
        nearest,
        vec3f(mu * mu - e, 2.0 * (mu * lift - m), lift * lift + a),
        vec2f(2.0 * a_root * mu, 2.0 * a_root * lift),
        a_root,
        vec2f(reach, last),
        vec2f(start, clamp((mu + lift * start) * (a_root * a_inverse), -last, last)),
    );
}

fn chord_growth(chord: Chord, end: vec2f) -> f32 {
    let grown = (end.x - chord.nearest + abs(end.y)) / chord.spread;
    return select(grown, -grown / (1.0 + grown), end.y < 0.0);
}

fn chord_range(chord: Chord) -> f32 {
    let last = chord_growth(chord, chord.last);
    let first = chord_growth(chord, chord.first);
    return log1p(last + first + last * first);
}

fn chord_weighed(chord: Chord, even: vec3f, odd: vec2f) -> f32 {
    return dot(chord.even, even) + dot(chord.odd, odd);
}

fn chord_reciprocal_integral(chord: Chord) -> f32 {
    let last = chord.last.x;
    let w_last = chord.last.y;
    let first = chord.first.x;
    let w_first = chord.first.y;
    let product_root = sqrt(chord.product);
    // The integral of dv/D is the angle with the tangent y/x, doubled, over sqrt(product); both ends' angles added.
    let x1 = chord.nearest * (last - chord.nearest + 2.0 * chord.spread);
    let y1 = product_root * w_last;
    let x0 = chord.nearest * (first - chord.nearest + 2.0 * chord.spread);
    let y0 = product_root * w_first;
    let inverse = 2.0 * atan2(y1 * x0 + y0 * x1, x1 * x0 - y1 * y0) / product_root;
    let zeroth = chord_range(chord);
    let first_moment = w_last + w_first + chord.centre * zeroth;
    return chord_weighed(chord, vec3f(inverse, zeroth, first_moment), vec2f(log(last / first), last - first));
}

fn chord_polynomial_integral(chord: Chord, h: vec3f) -> f32 {
    let last = chord.last.x;
    let w_last = chord.last.y;
    let first = chord.first.x;
    let w_first = chord.first.y;
    let last2 = last * last;
    let first2 = first * first;
    let i0 = chord_range(chord);
    let i1 = w_last + w_first + chord.centre * i0;
    let i2 = 0.5 * (last * w_last + first * w_first + 3.0 * chord.centre * i1 + chord.product * i0);
    let ends3 = last2 * w_last + first2 * w_first;
    let i3 = (ends3 + 5.0 * chord.centre * i2 + 2.0 * chord.product * i1) * (1.0 / 3.0);
    let ends4 = last2 * last * w_last + first2 * first * w_first;
    let i4 = 0.25 * (ends4 + 7.0 * chord.centre * i3 + 3.0 * chord.product * i2);
    let d1 = last - first;
    let d2 = 0.5 * (last2 - first2);
    let d3 = (last2 * last - first2 * first) * (1.0 / 3.0);
    let d4 = 0.25 * (last2 * last2 - first2 * first2);
    return h.x * chord_weighed(chord, vec3f(i0, i1, i2), vec2f(d1, d2))
        + h.y * chord_weighed(chord, vec3f(i1, i2, i3), vec2f(d2, d3))
        + h.z * chord_weighed(chord, vec3f(i2, i3, i4), vec2f(d3, d4));
}

// By the nodes of GAUSS from `first` to before `end`.
fn chord_quadrature(curve: u32, first: u32, end: u32, chord: Chord) -> f32 {
    let mu = 0.5 * chord.odd.x / chord.a_root;
    let half_range = 0.5 * min(chord_range(chord), RANGE_MAX.x + RANGE_MAX.y * max(mu, 0.0));
    let middle = (1.0 + chord_growth(chord, chord.last)) * exp(-half_range);
    // The nodes' exponentials come in pairs, e^(m + d) and e^(m - d).
    var sum = 0.0;
    for (var i = first; i < end; i++) {
        let factor = exp(half_range * GAUSS[i].x);
        let values = chord_integrand(curve, chord, mu, middle * factor) + chord_integrand(curve, chord, mu, middle / factor);
        sum += values * GAUSS[i].y;
    }
    return sum * half_range;
}

fn chord_integrand(curve: u32, chord: Chord, mu: f32, exp_v: f32) -> f32 {
    let inverse = 1.0 / exp_v;
    let distance = max(chord.centre + chord.spread * 0.5 * (exp_v + inverse), 0.0);
    let w = chord.spread * 0.5 * (exp_v - inverse);
    let t = mu + (0.5 * chord.odd.y * distance) / chord.a_root + chord.a_root * w;
    return t * t * curve_h(curve, 0u, distance);
}

fn chord_table_integral(table: u32, chord: Chord) -> f32 {
    var sum = 0.0;
    // Spheres that are intersected twice ahead of the surface point, where odd terms in W cancel; then those around it,
    // intersected once.
    for (var times = 2u; times > 0u; times--) {
        let is_around = times == 1u;
        let start = select(vec2f(chord.nearest, 0.0), vec2f(chord.first.x, abs(chord.first.y)), is_around);
        let end = select(chord.first.x, chord.last.x, is_around);
        if select(chord.first.y > 0.0, start.x < end, is_around) {
            sum += f32(times) * chord_table_section(table, chord, start, end, f32(is_around));
        }
    }
    return sum;
}

fn chord_table_section(table: u32, chord: Chord, start: vec2f, end: f32, odd: f32) -> f32 {
    let width = chord.last.x * (1.0 / f32(CUSTOM_INTERVALS));
    let per_width = 1.0 / width;
    let begin = min(u32(start.x * per_width), CUSTOM_INTERVALS - 1u);
    var low = start;
    var sum = 0.0;
    for (var interval = begin; interval < CUSTOM_INTERVALS && low.x < end; interval++) {
        let next = min(width * f32(interval + 1u), end);
        let beyond = max(next - chord.nearest, 0.0);
        let high = vec2f(next, sqrt(beyond * (beyond + 2.0 * chord.spread)));
        // The density of D here: intercept + slope D.
        let numbers = table_numbers(table, interval);
        let slope = (numbers.z - numbers.y) * per_width;
        let intercept = numbers.y - slope * (width * f32(interval));
        let moments = chord_interval(chord, low, high, interval < begin + 2u);
        let i1 = high.y - low.y + chord.centre * moments.y;
        let i2 = 0.5 * (high.x * high.y - low.x * low.y + 3.0 * chord.centre * i1 + chord.product * moments.y);
        let d1 = odd * (high.x - low.x);
        sum += intercept * chord_weighed(chord, vec3f(moments, i1), vec2f(odd * log(high.x / low.x), d1))
            + slope * chord_weighed(chord, vec3f(moments.y, i1, i2), vec2f(d1, 0.5 * d1 * (high.x + low.x)));
        low = high;
    }
    return sum;
}

fn chord_interval(chord: Chord, low: vec2f, high: vec2f, is_near: bool) -> vec2f {
    let gain = high.x - low.x + (high.y - low.y);
    let base = 2.0 * (low.x - chord.nearest + chord.spread + low.y);
    let x_low = chord.centre * low.x + chord.product;
    let x_high = chord.centre * high.x + chord.product;
    let rise = x_low * high.y - x_high * low.y;
    let run = x_low * x_high + chord.product * low.y * high.y;
    if is_near {
        let root = sqrt(chord.product);
        return vec2f(atan2(root * rise, run) / root, log1p(2.0 * gain / base));
    }
    return vec2f(chord_angle(rise / run, chord.product), chord_log_ratio(gain / (base + gain)));
}

fn chord_log_ratio(z: f32) -> f32 {
    let square = z * z;
    return 2.0 * z * (945.0 - square * (735.0 - square * 64.0)) / (945.0 - square * (1050.0 - square * 225.0));
}

fn chord_angle(z: f32, product: f32) -> f32 {
    let square = product * z * z;
    return z * (945.0 + square * (735.0 + square * 64.0)) / (945.0 + square * (1050.0 + square * 225.0));
}
