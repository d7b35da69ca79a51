// Tone curves, and sRGB's encoding. Twin of src/optics/tone.rs.

const TONE_AGX: u32 = 0u;
const TONE_ACES: u32 = 1u;
const TONE_PBR_NEUTRAL: u32 = 2u;
const TONE_NONE: u32 = 3u;

const SCENE_MAX: f32 = 65504.0;

fn tone_map(curve: u32, rgb_linear: vec3f) -> vec3f {
    let scene = clamp(rgb_linear, vec3f(0.0), vec3f(SCENE_MAX));
    var display = scene;
    switch curve {
        case TONE_AGX: { display = tone_agx(scene); }
        case TONE_ACES: { display = tone_aces(scene); }
        case TONE_PBR_NEUTRAL: { display = tone_pbr_neutral(scene); }
        default: { display = tone_none(scene); }
    }
    return clamp(display, vec3f(0.0), vec3f(1.0));
}

fn tone_agx(scene: vec3f) -> vec3f {
    let inset = vec3f(
        dot(vec3f(0.544814746, 0.373787398, 0.081397855), scene),
        dot(vec3f(0.140416948, 0.754137555, 0.105445497), scene),
        dot(vec3f(0.088810420, 0.178871756, 0.732317824), scene),
    );
    let stops = log2(max(inset, vec3f(1e-10)));
    let encoded = agx_contrast(saturate((stops - AGX_STOPS_MIN) / (AGX_STOPS_MAX - AGX_STOPS_MIN)));
    let outset = vec3f(
        dot(vec3f(1.127100582, -0.110606643, -0.016493939), encoded),
        dot(vec3f(-0.141329763, 1.157823702, -0.016493939), encoded),
        dot(vec3f(-0.141329763, -0.110606643, 1.251936407), encoded),
    );
    let linear = pow(max(outset, vec3f(1e-10)), vec3f(2.2));
    return vec3f(
        dot(vec3f(1.660491002, -0.587641139, -0.072849863), linear),
        dot(vec3f(-0.124550475, 1.132899897, -0.008349423), linear),
        dot(vec3f(-0.018150763, -0.100578898, 1.118729661), linear),
    );
}

const AGX_STOPS_MIN: f32 = -12.47393;
const AGX_STOPS_MAX: f32 = 4.026069;

fn agx_contrast(x: vec3f) -> vec3f {
    let high = 31.96 + x * (-40.14 + x * 15.5);
    return -0.00232 + x * (0.1191 + x * (0.4298 + x * (-6.868 + x * high)));
}

fn tone_aces(scene: vec3f) -> vec3f {
    let x = vec3f(
        dot(vec3f(0.59719, 0.35458, 0.04823), scene),
        dot(vec3f(0.07600, 0.90834, 0.01566), scene),
        dot(vec3f(0.02840, 0.13383, 0.83777), scene),
    );
    let a = x * (x + 0.0245786) - 0.000090537;
    let b = x * (0.983729 * x + 0.432951) + 0.238081;
    let fitted = a / b;
    return vec3f(
        dot(vec3f(1.60475, -0.53108, -0.07367), fitted),
        dot(vec3f(-0.10208, 1.10813, -0.00605), fitted),
        dot(vec3f(-0.00327, -0.07276, 1.07602), fitted),
    );
}

fn tone_pbr_neutral(scene: vec3f) -> vec3f {
    let darkest = min(min(scene.x, scene.y), scene.z);
    // Takes away the reflectance of 0.04 that every dielectric adds to its base colour.
    let offset = select(0.04, darkest - 6.25 * darkest * darkest, darkest < 0.08);
    let color = scene - offset;
    let peak = max(max(color.x, color.y), color.z);
    let room = 1.0 - NEUTRAL_START;
    let compressed_peak = 1.0 - room * room / max(peak + room - NEUTRAL_START, room);
    let whiteness = 1.0 - 1.0 / (0.15 * (peak - compressed_peak) + 1.0);
    let compressed = color * (compressed_peak / max(peak, NEUTRAL_START));
    let faded = mix(compressed, vec3f(compressed_peak), whiteness);
    return select(faded, color, peak < NEUTRAL_START);
}

const NEUTRAL_START: f32 = 0.76;

fn tone_none(scene: vec3f) -> vec3f {
    return scene;
}

fn srgb_from_linear(linear: vec3f) -> vec3f {
    let bright = 1.055 * pow(max(linear, vec3f(0.0031308)), vec3f(1.0 / 2.4)) - 0.055;
    return select(12.92 * linear, bright, linear > vec3f(0.0031308));
}

fn linear_from_srgb(srgb: vec3f) -> vec3f {
    let bright = pow((max(srgb, vec3f(0.04045)) + 0.055) / 1.055, vec3f(2.4));
    return select(srgb / 12.92, bright, srgb > vec3f(0.04045));
}
