// Light that a material reflects, and directions drawn from it: one loop over its layers for both. Twin of
// src/optics/layer/evaluate.rs and src/optics/layer/sample.rs.
#import "optics/layer/registry"
#import "optics/warp"

struct MaterialSample {
    wi: vec3f,
    throughput: vec3f,
    density: f32,
    is_mirror: bool,
}

struct MaterialNumbers {
    lobe: vec3f,
    facet: f32,
    below: vec3f,
}

// Light from a direction sampled with some density. competing: 1 if the material's own density enters the MIS weight.
struct MaterialLight {
    wi: vec3f,
    density: f32,
    competing: f32,
}

// A sampled direction, and the light's share that the material reflects.
struct MaterialScatter {
    drawn: MaterialSample,
    reflected: vec3f,
}

// Steps at a surface point, as a range: each planned layer weights the light (if `evaluates`), then a direction is sampled
// (if `draws`), and once more if the first layer passed it on.
fn material_steps(evaluates: bool, draws: bool) -> vec2u {
    let first_draw = planned_layers();
    return vec2u(select(first_draw, 0u, evaluates), first_draw + select(0u, 1u + PLAN_TRANSMISSION, draws));
}

fn material_sample(
    material: Material, surface: Surface, layers: Layers, numbers: MaterialNumbers, needs_density: bool,
) -> MaterialSample {
    let steps = material_steps(false, true);
    return material_scatter(material, surface, layers, steps, numbers, needs_density, MaterialLight()).drawn;
}

fn material_evaluate(
    material: Material, surface: Surface, layers: Layers, wi: vec3f, light_density: f32, competing: f32,
) -> vec3f {
    let light = MaterialLight(wi, light_density, competing);
    let steps = material_steps(true, false);
    return material_scatter(material, surface, layers, steps, MaterialNumbers(), false, light).reflected;
}

// Runs steps.x up to but not including steps.y. A loop, so that the lobes' code is in the kernel once: drivers inline every
// call, and compile time grows faster than size.
fn material_scatter(
    material: Material, surface: Surface, of_view: Layers, steps: vec2u, numbers: MaterialNumbers, needs_density: bool,
    light: MaterialLight,
) -> MaterialScatter {
    var layers = of_view;
    var xi = numbers.lobe;
    // The number that chooses a layer, the first layer that it may choose, and whether it is none of xi.
    var number = xi.x;
    var first = 0u;
    var is_apart = false;
    var drawn = MaterialSample();
    var reflected = vec3f(0.0);
    for (var step = steps.x; step < steps.y; step++) {
        let draws = step >= planned_layers();
        var layer = planned_layer(step);
        if draws {
            let choice = layer_choice(material, layers, first, number);
            layer = choice.layer;
            if layer == LAYERS {
                break;
            }
            if !is_apart {
                xi.x = choice.number;
            }
        } else if !layer_is_there(layer, material, surface) {
            continue;
        }
        let lobe = layer_lobe(layer, material, surface);
        let mirror = is_mirror(lobe.shape);
        if mirror && !draws {
            continue;
        }
        var wi = light.wi;
        var weight = 1.0;
        if draws {
            let sample = lobe_sample(lobe.shape, lobe.frame, surface.normal, surface.wo, xi);
            let refined = layer_refined_sample(layer, material, surface, xi, sample);
            wi = refined.wi;
            weight = refined.weight;
        }
        let toward = layer_toward(layer, material, layers, surface, lobe.shape, wi);
        if draws && layer_decides_by_facet(layer, material) {
            let is_passed_on = layer_pass_on(layer, material, &layers, weight, toward.probability);
            let part = split(numbers.facet, layer_share(layer, layers).probability);
            if !part.is_below {
                // The layer below uses its own random numbers, or the same facet.
                xi = select(xi, numbers.below, is_passed_on);
                number = part.remapped;
                first = layer + 1u;
                is_apart = true;
                continue;
            }
        }
        let share = layer_share(layer, layers);
        var evaluated = vec2f(0.0);
        if !draws || (needs_density && !mirror) {
            let of_lobe = lobe_evaluate(lobe.shape, lobe.frame, surface.normal, surface.wo, wi);
            evaluated = layer_refined(layer, material, surface, wi, of_lobe);
        }
        var color = toward.color * share.transmittance;
        if PLAN_COAT_ABSORPTION == 1u && layer > LAYER_COAT {
            color *= coat_tint(material, layers, surface, wi);
        }
        let density = share.reached * toward.probability * evaluated.y;
        if draws {
            // After the horizon policy has turned the direction, its selection probability differs from the one used to
            // sample: keep the latter.
            let drawn_with = max(share.reached * share.probability, 1e-20);
            drawn = MaterialSample(wi, color * (weight / drawn_with), density, mirror);
            break;
        }
        reflected += color * (evaluated.x * (light.density / (light.density + light.competing * density)));
    }
    return MaterialScatter(drawn, reflected);
}
