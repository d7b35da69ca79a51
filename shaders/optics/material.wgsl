// The material as the integrator sees it. Twin of src/optics/material.rs.
#import "optics/albedo"
#import "optics/fresnel"
#import "optics/lobe/registry"

struct Surface {
    frame: Frame,
    normal: vec3f,
    wo: vec3f,
    coat_normal: vec3f,
    is_inside: bool,
}

// Between the view and the shading normal.
fn view_cosine(surface: Surface) -> f32 {
    return dot(surface.frame.normal, surface.wo);
}

fn material_shape(material: Material) -> LobeShape {
    return LobeShape(
        planned(material.lobe, PLAN_LOBE), planned(material.curve, PLAN_CURVE), planned(material.horizon, PLAN_HORIZON),
        material.lobe_table, material.roughness, select(0.0, material.anisotropy, PLAN_ANISOTROPY),
        0.0,
    );
}

fn material_transmission_shape(material: Material, is_inside: bool) -> LobeShape {
    var shape = material_shape(material);
    shape.roughness = material.transmission_roughness;
    shape.eta = material_ior_ahead(material, is_inside);
    return shape;
}

fn material_ior_ahead(material: Material, is_inside: bool) -> f32 {
    return select(material.ior, 1.0 / material.ior, is_inside && material_transmits(material));
}

fn reflecting_ior_ahead(material: Material, is_inside: bool) -> f32 {
    if !PLAN_COAT {
        return material_ior_ahead(material, is_inside);
    }
    return select(material.reflecting_ior, 1.0 / material.ior, is_inside && material_transmits(material));
}

fn ior_under_coat(material: Material, weight: f32) -> f32 {
    let ior = material.bare_ior + (material.coated_ior - material.bare_ior) * weight;
    let root = sqrt(min(fresnel_f0(ior) * material.specular_weight, 0.99));
    return select(ior, (1.0 + root) / (1.0 - root), has_flag(material, WEIGHS_INDEX));
}

fn has_coated_table(material: Material) -> bool {
    return material.fresnel != FRESNEL_CONDUCTOR && has_flag(material, COATS_BASE) && material.coat_texture != NO_TEXTURE;
}

fn has_varied_blur(material: Material) -> bool {
    let of_coat = material.coat_texture != NO_TEXTURE || material.coat_roughness_texture != NO_TEXTURE;
    return PLAN_COAT && (PLAN_ROUGHNESS_TEXTURES || PLAN_COAT_TEXTURES) && material.coat_blur > 0.0
        && (of_coat || material.roughness_texture != NO_TEXTURE);
}

fn follow_coat(material: ptr<function, Material>) {
    if PLAN_COAT_TEXTURES && has_coated_table(*material) {
        (*material).reflecting_ior = ior_under_coat(*material, (*material).coat_weight);
    }
    if PLAN_COAT_TEXTURES && (*material).coat_roughness_texture != NO_TEXTURE && (*material).coat_blur > 0.0 {
        let square = (*material).coat_roughness * (*material).coat_roughness;
        (*material).coat_blur = 2.0 * square * square;
    }
}

// GGX's roughness under a coat of this weight.
fn roughness_under_coat(material: Material, roughness: f32, weight: f32) -> f32 {
    let square = roughness * roughness;
    return roughness + (sqrt(sqrt(min(square * square + material.coat_blur, 1.0))) - roughness) * weight;
}

fn material_fresnel_terms(material: Material, is_inside: bool) -> FresnelTerms {
    let is_bare = is_inside && material_transmits(material);
    let tint = select(material.specular_color, WHITE, is_bare);
    let weight = select(material.specular_weight, 1.0, is_bare);
    let before = select(ior_of_coat(material), 1.0, is_bare);
    return FresnelTerms(
        planned(material.fresnel, PLAN_FRESNEL), material.base_color, material.metalness, material.edge_tint, tint,
        select(weight * tint, WHITE, has_flag(material, SPARES_METAL)),
        select(weight, 1.0, has_flag(material, WEIGHS_INDEX)), reflecting_ior_ahead(material, is_inside),
        material.eta / before, material.k / before, before, material.has_film == 1u, material_film_terms(material, is_bare, before),
    );
}

fn material_film_terms(material: Material, is_within: bool, outside: f32) -> FilmTerms {
    if !PLAN_THIN_FILM {
        return FilmTerms();
    }
    let before = select(outside, material.ior, is_within);
    return FilmTerms(
        material.film_weight, material.film_ior / before, select(material.ior, 1.0, is_within) / before,
        material.film_path * before, has_flag(material, FILM_BANDS),
    );
}

// The index before the specular interface.
fn ior_of_coat(material: Material) -> f32 {
    return select(1.0, 1.0 + (material.coat_ior - 1.0) * material.coat_weight, PLAN_COAT && has_flag(material, COATS_BASE));
}

// Whether the material's tables extend over roughness or azimuth.
fn has_rows(material: Material) -> bool {
    return (PLAN_ROUGH_TABLES || PLAN_ANISOTROPY) && material.has_rough_tables != 0u;
}

fn is_over_azimuth(material: Material) -> bool {
    return PLAN_ANISOTROPY && (material.has_rough_tables & OVER_AZIMUTH) != 0u;
}

// Where such tables are read along their second side; 0 in others.
fn table_row(material: Material, surface: Surface) -> f32 {
    if is_over_azimuth(material) {
        return azimuth_place(material.anisotropy, surface.frame, surface.wo);
    }
    return select(0.0, material.roughness, has_rows(material));
}

fn material_has_holes(material: Material) -> bool {
    let is_constant = material.alpha_cutoff > material.opacity || (material.alpha_cutoff < 0.0 && material.opacity < 1.0);
    let is_varied = material.opacity_texture != NO_TEXTURE || has_vertex_flag(material, VERTEX_OPACITY);
    return PLAN_ALPHA && (is_constant || is_varied);
}

fn has_flag(material: Material, flag: u32) -> bool {
    return (material.flags & flag) != 0u;
}

// Whether vertices carry opacity or emission.
fn has_vertex_flag(material: Material, flag: u32) -> bool {
    return PLAN_VERTEX_COLORS && has_flag(material, flag);
}

fn material_has_base(material: Material) -> bool {
    let is_opaque = !PLAN_TRANSMISSION || material.transmission_weight < 1.0;
    return PLAN_BASE && is_opaque && material.metalness < 1.0 && any(material.base_color > vec3f());
}

fn material_transmits(material: Material) -> bool {
    return PLAN_TRANSMISSION && material.transmission_weight > 0.0 && material.metalness < 1.0;
}

// Whether the viewer is within a solid that light passes through.
fn is_within(material: Material, surface: Surface) -> bool {
    return surface.is_inside && material_transmits(material);
}

fn material_has_specular(material: Material) -> bool {
    if !PLAN_SPECULAR {
        return false;
    }
    let may_be_metal = material.metalness > 0.0 || material.metalness_texture != NO_TEXTURE;
    let is_spared = may_be_metal && has_flag(material, SPARES_METAL);
    return material.specular_weight > 0.0 || is_spared || material_transmits(material)
        || (PLAN_THIN_FILM && material.has_film == 1u && has_flag(material, WEIGHS_INDEX));
}
