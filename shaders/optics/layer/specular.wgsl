// The specular lobe. Twin of src/optics/layer/specular.rs.
#import "optics/layer/registry"

fn specular_albedo(material: Material, surface: Surface) -> LayerAlbedo {
    var albedos = mat2x3f();
    if has_more(material) {
        albedos = specular_albedos(material, surface);
    }
    // A metal has no layer below; the rest lies below the dielectric alone.
    return LayerAlbedo(albedos[0], max(1.0 - albedos[1], vec3f()));
}

fn specular_toward(material: Material, layers: Layers, surface: Surface, wi: vec3f) -> LayerToward {
    let terms = material_fresnel_terms(material, surface.is_inside);
    let cosine = half_vector_cosine(surface.wo, wi);
    let once = fresnel(terms, cosine);
    return LayerToward(
        scattered_again(material, surface, terms, cosine, once),
        specular_probability(material, layers, surface, wi, once),
    );
}

fn specular_choose(material: Material, layers: ptr<function, Layers>, below: f32) -> f32 {
    let specular = luminance(layers.specular.albedo);
    var share = select(1.0, sampled_share(specular / max(specular + below, 1e-9)), below > 0.0);
    // The part passed on is exactly the part not reflected, no estimate.
    share = select(share, min(specular, 1.0), passes_on(material));
    let through = (1.0 - share) * (transmission_estimate(material, *layers) / max(below, 1e-9));
    layers.specular.probability = share;
    layers.transmission.probability = through;
    layers.base.probability = 1.0 - share - through;
    return select(f32(material_has_specular(material)), specular + below, has_more(material));
}

fn specular_seen_albedo(material: Material, surface: Surface, share: LayerShare) -> vec3f {
    if !material_has_specular(material) || has_more(material) {
        return share.albedo;
    }
    return fresnel(material_fresnel_terms(material, surface.is_inside), view_cosine(surface));
}

fn specular_pass_on(material: Material, layers: ptr<function, Layers>, weight: f32, probability: f32) -> bool {
    if shares_facets(material) {
        layers.transmission.probability = 1.0 - layers.base.probability - probability;
    }
    let is_passed_on = passes_on(material);
    layers.specular.probability = select(probability, 0.0, is_passed_on && !(weight > 0.0));
    return is_passed_on;
}

fn has_more(material: Material) -> bool {
    return material_has_base(material) || material_transmits(material);
}

fn specular_albedos(material: Material, surface: Surface) -> mat2x3f {
    var place = view_cosine(surface);
    var first = material.albedo_table;
    if is_within(material, surface) {
        place = albedo_place(place, material_ior_ahead(material, true));
        first = material.inner_albedo_table;
    }
    let terms = material_fresnel_terms(material, surface.is_inside);
    let row = table_row(material, surface);
    var integrals = rough_albedo_lookup(first, place, row);
    if !PLAN_ROUGH_TABLES || (material.has_rough_tables & HOLDS_INTEGRALS) == 0u {
        let mean = integrals.xyz;
        return mat2x3f(mean * select(WHITE, terms.tint, terms.model == FRESNEL_DIELECTRIC), mean);
    }
    if first == material.albedo_table && PLAN_COAT_TEXTURES && has_coated_table(material) {
        integrals.x = dielectric_under_coat(material, vec2f(place, row), integrals.x);
    }
    var film = vec4f();
    if PLAN_THIN_FILM && (material.has_rough_tables & HOLDS_FILM) != 0u {
        film = vec4f(rough_albedo_lookup(first + ROUGH_ALBEDO_LENGTH, place, row).xyz, 1.0);
    }
    let below = of_dielectric(untinted(terms));
    return mat2x3f(rough_albedo(terms, integrals, film), rough_albedo(below, integrals, film));
}

// The dielectric's integral where a texture varies the cover over it.
fn dielectric_under_coat(material: Material, place: vec2f, bare: f32) -> f32 {
    let coated = rough_albedo_lookup(material.albedo_table + ROUGH_ALBEDO_LENGTH, place.x, place.y).x;
    let least = fresnel_f0(ior_under_coat(material, 0.0));
    let most = fresnel_f0(ior_under_coat(material, 1.0));
    let beyond = fresnel_f0(material.reflecting_ior) - least;
    return mix(bare, coated, beyond / select(1.0, most - least, most != least));
}

// The probability of sampling the specular lobe for a direction that it mirrors to with this Fresnel factor.
fn specular_probability(material: Material, layers: Layers, surface: Surface, wi: vec3f, color: vec3f) -> f32 {
    let reflected = luminance(color);
    if passes_on(material) {
        return reflected;
    }
    if !shares_facets(material) {
        return layers.specular.probability;
    }
    let ior = material_ior_ahead(material, surface.is_inside);
    let cosine = half_vector_cosine(surface.wo, wi);
    let square = refracted_square(cosine, ior);
    let left = left_by_facet(material, surface, vec2f(cosine, safe_sqrt(square) / ior));
    // Total reflection leaves nothing to refract, whichever Fresnel model is used.
    return (1.0 - layers.base.probability) * mirrored_share(reflected, select(0.0, luminance(left), square > 0.0));
}
