//! From materials as edited to materials as the integrators read them.

use std::sync::{Arc, Mutex};

use crate::{
    document::{
        CoatLobe, MaterialSettings,
        import::{MATCHED, geometric_from_ggx, ggx_under_texture},
    },
    optics::{
        albedo::{albedo_table, film_table, rough_albedo_table},
        fresnel::{Fresnel, fresnel_f0, weighted_ior},
        layer::coat::{coat_shape, inner_reflection},
        layer::fuzz::FUZZ_ROUGHNESS_MIN,
        lobe::{Lobe, LobeShape, Width, is_mirror},
        material::{
            COAT_ABSORBS, COAT_IS_GGX, COATS_BASE, COMPENSATES, FILM_BANDS, HAS_BOX, HOLDS_FILM, HOLDS_INTEGRALS,
            MATCHED_NODES, Material, NO_TEXTURE, OVER_AZIMUTH, SPARES_METAL, VERTEX_BASE, VERTEX_EMISSION,
            VERTEX_OPACITY, WEIGHS_INDEX, coat_blur,
        },
        scattering::scattering_table,
        table::{append_table, table_lookup},
        thin_film::{UNBANDED_PHASE, film_path},
        vector::Vec3,
    },
    panics::lock,
    scene::texture::{SlotTextures, TextureTarget as On},
};

/// Samples of each node of an albedo table.
const ALBEDO_SAMPLES: u32 = 1024;
/// The most that an interior absorbs over a length of 1: black would absorb infinitely.
const ABSORPTION_MAX: f32 = 1e9;
/// Albedo tables that are remembered.
const REMEMBERED: usize = 32;

/// Samples of each node of a table over the roughness too, of which there are many.
const ROUGH_ALBEDO_SAMPLES: u32 = 256;

/// Samples of the energies that a lobe keeps, over those of an albedo table: their errors are those of a whole metal.
const ENERGY_SAMPLES: u32 = 8;

/// The materials in the same order, and the tables they refer to.
pub fn compile(materials: &[MaterialSettings]) -> (Vec<Material<f32>>, Vec<f32>) {
    compile_textured(materials, &[])
}

/// The same with the textures of the first slots; the others have none.
pub fn compile_textured(materials: &[MaterialSettings], textures: &[SlotTextures]) -> (Vec<Material<f32>>, Vec<f32>) {
    let mut tables = Vec::new();
    let compiled = (0..)
        .zip(materials)
        .map(|(slot, settings)| {
            let textures = textures.get::<usize>(slot).copied().unwrap_or_default();
            compile_one(settings, textures, &mut tables)
        })
        .collect();
    (compiled, tables)
}

macro_rules! as_edited {
    ($($number:ident)*; $($color:ident)*) => {
        /// The parameters that are the same as edited and as compiled.
        fn as_edited(settings: &MaterialSettings) -> Material<f32> {
            Material {
                $($number: settings.$number,)*
                $($color: Vec3::from_f32(settings.$color),)*
                ..Material::default()
            }
        }
    };
}

as_edited! {
    metalness specular_weight ior anisotropy diffuse_roughness normal_strength transmission_weight coat_weight coat_roughness
    coat_ior fuzz_weight fuzz_roughness film_weight film_ior;
    specular_color eta k edge_tint coat_color fuzz_color
}

/// The plain numbers of a material, its tables still to be made.
fn without_tables(settings: &MaterialSettings, slot: SlotTextures) -> Material<f32> {
    let uses = settings.textures;
    // Textures of one value are multiplied in here.
    let factor = |target| slot.constant(target).map_or(1.0, |[value, ..]| value);
    let roughness = slot
        .constant(On::Roughness)
        .map_or(settings.roughness, |[share, ..]| textured_roughness(settings, share));
    let mut emission = Vec3::from_f32(settings.emission_color) * settings.emission_strength;
    let mut mean_emission = emission;
    if uses[On::Emission] {
        mean_emission = emission * Vec3::from_f32(slot.mean_emission);
    }
    if slot.record(On::Emission) == NO_TEXTURE {
        emission = mean_emission;
    }
    let is_on_box = slot.on_box.contains(&true);
    let mut material = Material {
        base_color: Vec3::from_f32(settings.base_color) * settings.base_weight,
        roughness,
        transmission_tint: Vec3::splat(1.0),
        transmission_roughness: roughness + settings.transmission_roughness,
        rotation_rad: settings.rotation_deg.to_radians(),
        lobe: settings.lobe as u32,
        curve: settings.curve as u32,
        horizon: settings.horizon as u32,
        fresnel: settings.fresnel as u32,
        opacity: settings.opacity * factor(On::Opacity),
        light_luminance: mean_emission.luminance(),
        alpha_cutoff: if uses[On::Opacity] { slot.alpha_cutoff } else { -1.0 },
        flags: flags(settings, slot) | if is_on_box { HAS_BOX } else { 0 },
        reflecting_ior: settings.ior,
        bare_ior: settings.ior,
        coated_ior: settings.ior,
        ..as_edited(settings)
    };
    for &target in On::ALL {
        if let Some(value) = slot.constant(target) {
            material.multiply(target, Vec3::from_f32(value), value[0]);
        }
    }
    // What is no product of the texture's value and the parameter.
    material.emission = emission;
    material.ggx_roughness = settings.ggx_roughness(roughness);
    material.fuzz_roughness = material.fuzz_roughness.max(FUZZ_ROUGHNESS_MIN as f32);
    material.film_path = film_path(settings.film_thickness * factor(On::FilmThickness));
    let has_film = settings.has_film() && material.film_weight.min(material.film_path.x) > 0.0;
    material.has_film = u32::from(has_film);
    if has_film && settings.film_bands && f64::from(material.film_path.z * material.film_ior) > UNBANDED_PHASE {
        material.flags |= FILM_BANDS;
    }
    let layers = [
        ("coat.", material.coat_weight > 0.0),
        ("fuzz.", material.fuzz_weight > 0.0),
        ("thin_film.", has_film),
        ("transmission.", material.transmission_weight > 0.0),
    ];
    for &target in On::ALL {
        let is_missing = |(layer, is_there): &(&str, bool)| target.map_key().starts_with(layer) && !is_there;
        if !layers.iter().any(is_missing) {
            material.textures[target as usize] = slot.record(target);
        }
    }
    if !material.has_texture(&[On::Roughness]) {
        // Else it is brought into range where the texture has been looked up.
        material.transmission_roughness = material.transmission_roughness.clamp(0.0, 1.0);
    }
    let is_metal_in_part = material.metalness > 0.0 && (material.has_base() || material.transmits());
    let changes = material.has_texture(&[On::Roughness, On::Metalness, On::Specular])
        || (material.has_texture(On::OF_FILM) && material.least_metallic().metalness < 1.0);
    material.has_rough_tables = u32::from(changes || is_metal_in_part);
    if material.least_metallic().transmits() {
        // Only the exact equations know total reflection.
        material.fresnel = Fresnel::Dielectric as u32;
        let color = Vec3::from_f32(settings.transmission_color);
        if settings.transmission_depth > 0.0 {
            material.absorption = color.map(|c: f32| (-c.ln() / settings.transmission_depth).min(ABSORPTION_MAX));
        } else {
            material.transmission_tint = material.transmission_tint * color;
        }
    }
    // A table is for one index: a texture of the weight scales the reflection at every angle.
    if settings.has_weight_in_index() && !material.has_texture(&[On::Specular]) {
        material.ior = weighted_ior(settings.ior.into(), material.specular_weight.into()) as f32;
        material.flags |= WEIGHS_INDEX;
    }
    material.reflecting_ior = material.ior;
    if material.coat_weight > 0.0 {
        put_coat(settings, slot, &mut material);
    }
    if material.has_coated_table() || material.has_varied_blur() {
        material.has_rough_tables = HOLDS_INTEGRALS;
    }
    let is_of_one_roughness = !material.has_texture(&[On::Roughness]) && !material.has_varied_blur();
    if material.anisotropy != 0.0 && settings.lobe.is_anisotropic() && is_of_one_roughness {
        material.has_rough_tables |= OVER_AZIMUTH;
    }
    let has_index = [Fresnel::Schlick as u32, Fresnel::Dielectric as u32].contains(&material.fresnel);
    let is_varied = material.has_texture(On::OF_FILM) || material.has_coated_table();
    if has_film && material.holds_integrals() && has_index && !is_varied {
        material.has_rough_tables |= HOLDS_FILM;
    }
    // Schlick's reflectance head-on may be tinted up to 1; the others are 1 at grazing angles already.
    let is_schlick = material.fresnel == Fresnel::Schlick as u32;
    let most = if is_schlick {
        fresnel_f0(material.ior.max(material.reflecting_ior)).recip()
    } else {
        1.0
    };
    material.specular_color = material.specular_color.map(|x: f32| x.min(most));
    if settings.multiple_scattering && loses_light(settings, &material) {
        material.flags |= COMPENSATES;
    }
    material
}

/// What a coat has of its own, and what it does to what lies below it.
fn put_coat(settings: &MaterialSettings, slot: SlotTextures, material: &mut Material<f32>) {
    material.coat_normal_strength = settings.coat_normal_strength;
    // A texture's values are meant for GGX.
    let mut roughness = settings.coat_ggx_roughness();
    if let Some([share, ..]) = slot.constant(On::CoatRoughness) {
        roughness *= share;
        material.coat_roughness = match settings.coat_lobe {
            CoatLobe::Geometric => geometric_from_ggx(roughness),
            CoatLobe::Ggx => roughness,
        };
    }
    let has_roughness_texture = material.has_texture(&[On::CoatRoughness]);
    if has_roughness_texture {
        material.coat_roughness = roughness;
    }
    material.coat_anisotropy = settings.coat_anisotropy;
    if settings.coat_lobe == CoatLobe::Ggx || has_roughness_texture {
        material.flags |= COAT_IS_GGX;
    }
    material.coat_darkening = settings.coat_darkening;
    material.coat_inner = inner_reflection(settings.coat_ior.into()) as f32;
    if !settings.coat_on_base {
        return;
    }
    material.flags |= COATS_BASE;
    if material.coat_color != Vec3::splat(1.0) || material.has_texture(&[On::CoatColor]) {
        material.flags |= COAT_ABSORBS;
    }
    // Total reflection by a coat of greater index would not be there: light is refracted into the coat first.
    let [base, coat] = [settings.ior, settings.coat_ior];
    material.coated_ior = base.max(coat) / base.min(coat);
    material.reflecting_ior = material.ior_under_coat(material.coat_weight);
    if settings.lobe.traits().width == Width::Fixed {
        return;
    }
    material.coat_blur = coat_blur(roughness);
    if material.has_varied_blur() {
        // Where a texture has been looked up.
        return;
    }
    if material.coat_blur > 0.0 {
        let blurred = material.roughness_under_coat(material.ggx_roughness, material.coat_weight);
        let is_geometric = settings.lobe.traits().width == Width::Roughness;
        let blurred = if is_geometric {
            geometric_from_ggx(blurred)
        } else {
            blurred
        };
        let extra = material.transmission_roughness - material.roughness;
        material.roughness = blurred.max(material.roughness);
        material.transmission_roughness = (material.roughness + extra).clamp(0.0, 1.0);
    }
}

/// Whether the lobe loses light between its facets that no base below takes: a metal's, or a clear interface's.
fn loses_light(settings: &MaterialSettings, material: &Material<f32>) -> bool {
    let has_model_of_metal = [Fresnel::None, Fresnel::Conductor].contains(&settings.fresnel);
    let is_metal = material.metalness > 0.0 && (has_model_of_metal || material.has_specular());
    let transmits = material.least_metallic().transmits();
    // Facets hide each other also where the index bends nothing to speak of; at 1 there are none.
    let through = LobeShape {
        eta: 0.0,
        ..material.transmission_shape(&[], false)
    };
    let refracts = transmits && material.ior != 1.0 && !is_mirror(&through);
    let is_rough = material.has_texture(&[On::Roughness]) || !is_mirror(&material.shape(&[])) || refracts;
    settings.lobe.traits().loses_light && is_rough && (is_metal || transmits)
}

/// What the vertices say where it is looked up, and whether metals keep their reflection.
fn flags(settings: &MaterialSettings, slot: SlotTextures) -> u32 {
    let uses = settings.textures;
    let vertex = [
        (uses[On::BaseColor], VERTEX_BASE),
        (uses[On::Emission], VERTEX_EMISSION),
        (uses[On::Opacity], VERTEX_OPACITY),
    ];
    let looked_up = vertex.iter().filter(|(is_on, _)| *is_on).map(|(_, flag)| flag);
    let spares = if settings.specular_on_metal { 0 } else { SPARES_METAL };
    (slot.vertex_flags & looked_up.sum::<u32>()) | spares
}

/// The roughness that a texture's value gives: such values are meant for GGX.
fn textured_roughness(settings: &MaterialSettings, share: f32) -> f32 {
    if settings.lobe.traits().width == Width::Roughness {
        let of_ggx = ggx_under_texture(settings.roughness) * share;
        return table_lookup(&*MATCHED, 0, MATCHED_NODES, of_ggx);
    }
    settings.roughness * share
}

fn compile_one(settings: &MaterialSettings, textures: SlotTextures, tables: &mut Vec<f32>) -> Material<f32> {
    let textures = textures.only(|target| settings.textures[target]);
    let mut material = without_tables(settings, textures);
    let anywhere = material.least_metallic();
    let mut curve_table = Vec::new();
    if settings.lobe.has_curves() && settings.curve.has_table() {
        curve_table = settings.custom_curve.table();
        material.lobe_table = append_table(tables, &curve_table);
    }
    if material.has_flag(COMPENSATES) {
        material.lobe_table = append_table(tables, &remembered(scattering_key(&material)));
    }
    if (anywhere.has_base() || anywhere.transmits()) && anywhere.has_specular() {
        if material.has_coated_table() {
            // One without the coat, then one under all of it.
            let [bare, coated] = [0.0, 1.0].map(|weight| {
                let reflecting_ior = material.ior_under_coat(weight);
                let under = Material {
                    coat_weight: weight,
                    reflecting_ior,
                    ..material
                };
                remembered_albedo(&under, &curve_table, false)
            });
            material.albedo_table = append_table(tables, &bare);
            append_table(tables, &coated);
        } else {
            material.albedo_table = append_albedo(tables, &material, &curve_table, false);
        }
    }
    if anywhere.transmits() {
        material.inner_albedo_table = append_albedo(tables, &material, &curve_table, true);
    }
    let varies = material.has_texture(&[On::Roughness]) || material.has_varied_blur();
    if varies && settings.lobe.traits().width == Width::Roughness {
        // A texture's values are meant for GGX.
        material.ggx_roughness = ggx_under_texture(material.roughness);
        material.roughness_table = append_table(tables, &*MATCHED);
    }
    if material.coat_weight > 0.0 {
        material.coat_table = append_table(tables, &remembered_albedo(&coat_alone(&material), &[], false));
    }
    material
}

/// Appends the albedo table of a side, then that of its film where it has one. Returns its start.
fn append_albedo(tables: &mut Vec<f32>, material: &Material<f32>, curve_table: &[f32], is_inside: bool) -> u32 {
    let start = append_table(tables, &remembered_albedo(material, curve_table, is_inside));
    if material.has_film_table() {
        append_table(tables, &remembered(film_key(material, curve_table, is_inside)));
    }
    start
}

/// A material whose specular lobe is the coat of another one.
fn coat_alone(material: &Material<f32>) -> Material<f32> {
    let shape = coat_shape(material);
    Material {
        metalness: 0.0,
        specular_color: Vec3::splat(1.0),
        specular_weight: 1.0,
        ior: material.coat_ior,
        reflecting_ior: material.coat_ior,
        roughness: shape.roughness,
        anisotropy: shape.anisotropy,
        lobe: shape.lobe as u32,
        curve: shape.curve as u32,
        horizon: shape.horizon as u32,
        fresnel: Fresnel::Dielectric as u32,
        transmission_weight: 0.0,
        has_rough_tables: match shape.anisotropy == 0.0 || material.has_texture(&[On::CoatRoughness]) {
            true => u32::from(material.has_texture(&[On::CoatRoughness])),
            false => OVER_AZIMUTH,
        },
        has_film: 0,
        ..*material
    }
}

/// What a table of a lobe holds.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Holds {
    /// Albedos for views from outside.
    Albedo,
    /// Albedos for views from within.
    InnerAlbedo,
    /// Energies that single scattering keeps.
    Energies,
    /// Changes of the albedo by a thin film, for views from outside or within.
    Film { is_inside: bool },
}

/// What a table of a lobe depends on.
#[derive(Clone, Debug, PartialEq)]
struct TableKey {
    /// The material, what its specular reflection does not depend on being zero.
    material: Material<f32>,
    curve_table: Vec<f32>,
    holds: Holds,
}

/// The tables made last, the latest at the end: dragging a colour must not cost milliseconds a frame.
static TABLES: Mutex<Vec<(TableKey, Arc<[f32]>)>> = Mutex::new(Vec::new());

fn remembered_albedo(material: &Material<f32>, curve_table: &[f32], is_inside: bool) -> Arc<[f32]> {
    remembered(albedo_key(material, curve_table, is_inside))
}

fn remembered(key: TableKey) -> Arc<[f32]> {
    let memory = || lock(&TABLES);
    let known = memory()
        .iter()
        .find(|(of, _)| *of == key)
        .map(|(_, table)| table.clone());
    if let Some(table) = known {
        return table;
    }
    let of = key.material.cast::<f64>();
    let is_rough = of.holds_integrals();
    let samples = if of.has_rough_tables == 0 {
        ALBEDO_SAMPLES
    } else {
        ROUGH_ALBEDO_SAMPLES
    };
    let is_inside = key.holds == Holds::InnerAlbedo;
    let table: Arc<[f32]> = match key.holds {
        Holds::Energies => scattering_table(&of, ENERGY_SAMPLES * samples).into(),
        Holds::Film { is_inside } => film_table(&of, &key.curve_table, samples, is_inside).into(),
        _ if is_rough => rough_albedo_table(&of, &key.curve_table, samples, is_inside).into(),
        _ => albedo_table(&of, &key.curve_table, samples, is_inside).into(),
    };
    let mut memory = memory();
    if memory.len() >= REMEMBERED {
        memory.remove(0);
    }
    memory.push((key, table.clone()));
    table
}

/// The key of what a film changes.
fn film_key(material: &Material<f32>, curve_table: &[f32], is_inside: bool) -> TableKey {
    let key = albedo_key(material, curve_table, is_inside);
    TableKey {
        material: Material {
            has_film: 1,
            film_weight: material.film_weight,
            film_path: material.film_path,
            film_ior: material.film_ior,
            ..key.material
        },
        holds: Holds::Film { is_inside },
        ..key
    }
}

/// The key of the energies that a lobe keeps: the roughness of both lobes and, of a clear interface, its index.
fn scattering_key(material: &Material<f32>) -> TableKey {
    let key = albedo_key(material, &[], false);
    let transmits = key.material.transmits();
    let of_interface = |x: f32| if transmits { x } else { 0.0 };
    TableKey {
        material: Material {
            specular_color: Vec3::ZERO,
            eta: Vec3::ZERO,
            k: Vec3::ZERO,
            ior: of_interface(material.ior),
            reflecting_ior: of_interface(material.reflecting_ior),
            // The samplings of GGX share one model.
            lobe: Lobe::Ggx as u32,
            // With a table over the roughness their difference counts.
            roughness: material.roughness,
            transmission_roughness: of_interface(material.transmission_roughness),
            // Other than an albedo's, a table over the roughness has the film: it shares the light of each channel otherwise.
            has_film: if transmits { material.has_film } else { 0 },
            film_weight: of_interface(material.film_weight),
            film_path: material.film_path * of_interface(1.0),
            film_ior: of_interface(material.film_ior),
            ..key.material
        },
        holds: Holds::Energies,
        ..key
    }
}

fn albedo_key(material: &Material<f32>, curve_table: &[f32], is_inside: bool) -> TableKey {
    // A table over the roughness serves every roughness, metalness and colour; any other is a dielectric's.
    let is_rough = material.holds_integrals();
    let transmits = material.least_metallic().transmits();
    let is_measured = material.fresnel == Fresnel::Conductor as u32;
    // What counts the coat's index apart from the dielectric's.
    let meets_coat = material.has_flag(COATS_BASE) && (material.has_film == 1 || is_measured);
    let film = match material.has_film == 1 && (!is_rough || is_measured) {
        true => *material,
        // One over the roughness has no film in it, but for that on a measured metal.
        false => Material::default(),
    };
    let material = Material {
        // A factor of the exact equations is multiplied where the table is looked up.
        specular_color: match material.fresnel == Fresnel::Dielectric as u32 {
            true => Vec3::splat(1.0),
            false => material.specular_color,
        },
        specular_weight: material.specular_weight,
        eta: material.eta,
        ior: material.ior,
        reflecting_ior: material.reflecting_ior,
        k: material.k,
        roughness: if is_rough && !material.is_over_azimuth() {
            0.0
        } else {
            material.roughness
        },
        anisotropy: material.anisotropy,
        lobe: material.lobe,
        curve: material.curve,
        horizon: material.horizon,
        fresnel: material.fresnel,
        has_rough_tables: material.has_rough_tables,
        has_film: film.has_film,
        film_weight: film.film_weight,
        film_path: film.film_path,
        film_ior: film.film_ior,
        coat_ior: if meets_coat { material.coat_ior } else { 1.0 },
        coat_weight: if meets_coat { material.coat_weight } else { 0.0 },
        // A dielectric without vertices.
        flags: material.flags & (WEIGHS_INDEX | FILM_BANDS | if meets_coat { COATS_BASE } else { 0 }),
        transmission_weight: if transmits { 1.0 } else { 0.0 },
        ..Material::default()
    };
    TableKey {
        material,
        curve_table: curve_table.to_vec(),
        holds: if is_inside { Holds::InnerAlbedo } else { Holds::Albedo },
    }
}
