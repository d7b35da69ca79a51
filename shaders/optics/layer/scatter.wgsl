// Light that a material reflects, and directions drawn from it: one loop over its layers for both. Twin of
// src/optics/layer/evaluate.rs and src/optics/layer/sample.rs.
#import "optics/layer/registry"

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
    let first_draw = countOneBits(planned_layers());
    return vec2u(select(first_draw, 0u, evaluates), first_draw + select(0u, 1u + u32(PLAN_TRANSMISSION), draws));
}

fn material_sample(
    material: Material, surface: Surface, layers: Layers, numbers: MaterialNumbers, needs_density: bool,
) -> MaterialSample {
    return material_scatter(
        material, surface, layers, material_steps(false, true), numbers, needs_density, MaterialLight(),
    ).drawn;
}

fn material_evaluate(
    material: Material, surface: Surface, layers: Layers, wi: vec3f, light_density: f32, competing: f32,
) -> vec3f {
    return material_scatter(
        material, surface, layers, material_steps(true, false), MaterialNumbers(), false,
        MaterialLight(wi, light_density, competing),
    ).reflected;
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
    var reflected = vec3f();
    for (var step = steps.x; step < steps.y; step++) {
        let draws = step >= countOneBits(planned_layers());
        var place = step;
        if draws {
            let choice = layer_choice(material, layers, first, number);
            place = choice.place;
            if place >= countOneBits(planned_layers()) {
                break;
            }
            xi.x = select(choice.number, xi.x, is_apart);
        }
        let layer = planned_layer(place);
        let lobe = layer_lobe(layer, material, layers, surface);
        let mirror = is_mirror(lobe.shape);
        if !draws && (mirror || !lobe.is_there) {
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
        var share = lobe.share;
        if PLAN_SPECULAR && draws && layer == LAYER_SPECULAR && decides_by_facet(material) {
            let is_passed_on = specular_pass_on(material, &layers, weight, toward.probability);
            share = layers.specular;
            let part = split(numbers.facet, share.probability);
            if !part.is_below {
                // The layer below uses its own random numbers, or the same facet.
                xi = select(xi, numbers.below, is_passed_on);
                number = part.remapped;
                first = place + 1u;
                is_apart = true;
                continue;
            }
        }
        var evaluated = vec2f();
        if !draws || (needs_density && !mirror) {
            evaluated = layer_refined(layer, material, surface, lobe, wi);
        }
        var color = toward.color * share.transmittance;
        if PLAN_COAT_ABSORPTION && layer > LAYER_COAT {
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
