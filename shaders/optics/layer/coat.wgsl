// A clear dielectric coat over everything else. Twin of src/optics/layer/coat.rs.
#import "optics/coat_medium"
#import "optics/layer/registry"

fn coat_is_there(material: Material, surface: Surface) -> bool {
    return PLAN_COAT && material.coat_weight > 0.0 && !is_within(material, surface);
}

fn coat_lobe(material: Material, layers: Layers, surface: Surface) -> LayerLobe {
    return LayerLobe(coat_is_there(material, surface), coat_shape(material), coat_frame(material, surface), layers.coat);
}

fn coat_frame(material: Material, surface: Surface) -> Frame {
    if PLAN_ANISOTROPY && material.coat_anisotropy != 0.0 {
        return frame_from_tangent(surface.coat_normal, surface.frame.tangent, 0.0);
    }
    return frame_from_normal(surface.coat_normal);
}

fn coat_shape(material: Material) -> LobeShape {
    let is_ggx = PLAN_COAT_GGX && has_flag(material, COAT_IS_GGX);
    return LobeShape(
        select(LOBE_GEOMETRIC, LOBE_GGX, is_ggx), CURVE_SMOOTH, HORIZON_MIRROR, 0u, material.coat_roughness,
        select(0.0, material.coat_anisotropy, PLAN_ANISOTROPY), 0.0,
    );
}

fn coat_albedo(material: Material, surface: Surface) -> LayerAlbedo {
    let cosine = dot(surface.coat_normal, surface.wo);
    var row = 0.0;
    if PLAN_COAT_TEXTURES && material.coat_roughness_texture != NO_TEXTURE {
        row = material.coat_roughness;
    } else if PLAN_ANISOTROPY && material.coat_anisotropy != 0.0 {
        row = azimuth_place(material.coat_anisotropy, coat_frame(material, surface), surface.wo);
    }
    let share = material.coat_weight * rough_albedo_lookup(material.coat_table, cosine, row).x;
    let color = select(material.coat_color, WHITE, has_flag(material, COATS_BASE));
    var transmittance = mix(WHITE, color, material.coat_weight) * max(1.0 - share, 0.0);
    if PLAN_COAT_DARKENING && material.coat_darkening > 0.0 {
        transmittance *= darkened(material, surface, cosine);
    }
    return LayerAlbedo(vec3f(share), transmittance);
}

fn coat_refined_sample(material: Material, surface: Surface, drawn: LobeSample) -> LobeSample {
    return LobeSample(drawn.wi, coat_fresnel(material, surface.wo, drawn.wi) * drawn.weight);
}

fn coat_fresnel(material: Material, wo: vec3f, wi: vec3f) -> f32 {
    return material.coat_weight * fresnel_dielectric(half_vector_cosine(wo, wi), material.coat_ior);
}

// What the layers below keep of their light if the coat reflects some of it back onto them each time.
fn darkened(material: Material, surface: Surface, cosine: f32) -> vec3f {
    let terms = material_fresnel_terms(material, surface.is_inside);
    let dielectric = fresnel(of_dielectric(terms), 1.0);
    let diffuse = select(vec3f(), material.base_color, PLAN_BASE);
    let deeper = mix(diffuse, material.transmission_tint, material.transmission_weight);
    let base = min(fresnel(terms, 1.0) + (1.0 - dielectric) * deeper * (1.0 - material.metalness), WHITE);
    let below = mix(1.0, material.ggx_roughness, min(luminance(dielectric), 1.0));
    let spread = mix(below, material.ggx_roughness, material.metalness);
    let inner = min(mix(fresnel_dielectric(cosine, material.coat_ior), material.coat_inner, spread), INNER_MAX);
    return mix(WHITE, (1.0 - inner) / (1.0 - base * inner), material.coat_weight * material.coat_darkening);
}

// What the coat's medium leaves of the light of a layer below, by its directions.
fn coat_tint(material: Material, layers: Layers, surface: Surface, wi: vec3f) -> vec3f {
    if !has_flag(material, COAT_ABSORBS) || !coat_is_there(material, surface) {
        return WHITE;
    }
    let reflected = layers.coat.albedo.x;
    let out = dot(surface.coat_normal, surface.wo);
    let back = select(abs(dot(surface.coat_normal, wi)), out, dot(surface.normal, wi) < 0.0);
    let color = color_over(material, way_length(material, out) + way_length(material, back));
    return mix(WHITE, color, max(material.coat_weight - reflected, 0.0) / max(1.0 - reflected, 1e-9));
}
