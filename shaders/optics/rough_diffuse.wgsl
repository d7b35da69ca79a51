// Rough diffuse reflection that keeps its energy. Twin of src/optics/rough_diffuse.rs.
#import "scene/constants"
#import "optics/numeric"

fn rough_diffuse(albedo: vec3f, roughness: f32, cosines: vec2f, between: f32) -> vec3f {
    let c = clamp(cosines, vec2f(ROUGH_COSINE_MIN), vec2f(1.0));
    let head_on = 1.0 / (1.0 + roughness * HEAD_ON);
    var across = between - c.x * c.y;
    across = select(across, across / max(c.x, c.y), across > 0.0);
    let mean = head_on * (1.0 + roughness * MEAN);
    let lost = max(1.0 - single_albedo(c.x, roughness), 0.0) * max(1.0 - single_albedo(c.y, roughness), 0.0);
    let again = mean * lost / max(1.0 - mean, 1e-6);
    return vec3f(head_on * (1.0 + roughness * across)) + albedo * again / (1.0 - albedo * (1.0 - mean));
}

fn single_albedo(cosine: f32, roughness: f32) -> f32 {
    let sine = safe_sqrt((1.0 - cosine) * (1.0 + cosine));
    // (1 - s^3) s/c without cancellation, as 1 - s = c^2/(1 + s).
    let rest = sine * cosine * (1.0 + sine + sine * sine) / (1.0 + sine);
    let bent = sine * (arctan2(sine, cosine) - sine * cosine) + 2.0 / 3.0 * (rest - sine);
    return (1.0 + roughness * INV_PI * bent) / (1.0 + roughness * HEAD_ON);
}
