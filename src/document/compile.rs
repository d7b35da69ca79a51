//! From materials as edited to materials as the integrators read them.

use std::sync::{Arc, Mutex, PoisonError};

use super::MaterialSettings;
use crate::optics::curve::Curve;
use crate::optics::fresnel::Fresnel;
use crate::optics::lobe::Lobe;
use crate::optics::material::{Material, albedo_table};
use crate::optics::vector::Vec3;

/// Samples of each node of an albedo table.
const ALBEDO_SAMPLES: u32 = 1024;
/// The least that an interior lets through at its depth: black would absorb infinitely.
const TRANSMITTANCE_MIN: f32 = 1e-4;
/// Albedo tables that are remembered.
const REMEMBERED: usize = 32;

/// The materials in the same order, and the tables they refer to; never without a number, since a GPU's buffer cannot be
/// empty.
pub fn compile(materials: &[MaterialSettings]) -> (Vec<Material<f32>>, Vec<f32>) {
    let mut tables = Vec::new();
    let compiled = materials
        .iter()
        .map(|settings| compile_one(settings, &mut tables))
        .collect();
    if tables.is_empty() {
        tables.push(0.0);
    }
    (compiled, tables)
}

fn compile_one(settings: &MaterialSettings, tables: &mut Vec<f32>) -> Material<f32> {
    let mut material = Material {
        base_color: Vec3::from_f32(settings.base_color),
        metalness: settings.metalness,
        specular_color: Vec3::from_f32(settings.specular_color),
        specular_weight: settings.specular_weight,
        eta: Vec3::from_f32(settings.eta),
        ior: settings.ior,
        k: Vec3::from_f32(settings.k),
        roughness: settings.roughness,
        emission: Vec3::from_f32(settings.emission_color) * settings.emission_strength,
        anisotropy: settings.anisotropy,
        transmission_tint: Vec3::splat(1.0),
        transmission_weight: settings.transmission_weight,
        absorption: Vec3::zero(),
        transmission_roughness: (settings.roughness + settings.transmission_roughness).clamp(0.0, 1.0),
        rotation_rad: settings.rotation_deg.to_radians(),
        lobe: settings.lobe as u32,
        curve: settings.curve as u32,
        horizon: settings.horizon as u32,
        fresnel: settings.fresnel as u32,
        curve_table: 0,
        albedo_table: 0,
        inner_albedo_table: 0,
    };
    if material.transmits() {
        // Only the exact equations know total reflection.
        material.fresnel = Fresnel::Dielectric as u32;
        let color = Vec3::from_f32(settings.transmission_color);
        if settings.transmission_depth > 0.0 {
            material.absorption = color.map(|c: f32| -c.max(TRANSMITTANCE_MIN).ln() / settings.transmission_depth);
        } else {
            material.transmission_tint = color;
        }
    }
    let mut curve_table = Vec::new();
    if settings.lobe == Lobe::Geometric && settings.curve == Curve::Custom {
        curve_table = settings.custom_curve.table();
        material.curve_table = tables.len() as u32;
        tables.extend(&curve_table);
    }
    if (material.has_base() || material.transmits()) && material.has_specular() {
        material.albedo_table = tables.len() as u32;
        tables.extend(remembered_albedo(&material, &curve_table, false).iter());
    }
    if material.transmits() {
        material.inner_albedo_table = tables.len() as u32;
        tables.extend(remembered_albedo(&material, &curve_table, true).iter());
    }
    material
}

/// What an albedo table depends on.
#[derive(Clone, Debug, PartialEq)]
struct AlbedoKey {
    /// The material, what its specular reflection does not depend on being zero.
    material: Material<f32>,
    curve_table: Vec<f32>,
    is_inside: bool,
}

/// The tables made last, the latest at the end: dragging a colour must not cost milliseconds a frame.
static ALBEDOS: Mutex<Vec<(AlbedoKey, Arc<[f32]>)>> = Mutex::new(Vec::new());

fn remembered_albedo(material: &Material<f32>, curve_table: &[f32], is_inside: bool) -> Arc<[f32]> {
    let key = albedo_key(material, curve_table, is_inside);
    let memory = || ALBEDOS.lock().unwrap_or_else(PoisonError::into_inner);
    let known = memory()
        .iter()
        .find(|(of, _)| *of == key)
        .map(|(_, table)| table.clone());
    if let Some(table) = known {
        return table;
    }
    let table: Arc<[f32]> =
        albedo_table(&key.material.cast::<f64>(), &key.curve_table, ALBEDO_SAMPLES, is_inside).into();
    let mut memory = memory();
    if memory.len() >= REMEMBERED {
        memory.remove(0);
    }
    memory.push((key, table.clone()));
    table
}

fn albedo_key(material: &Material<f32>, curve_table: &[f32], is_inside: bool) -> AlbedoKey {
    let is_metallic = material.metalness > 0.0;
    let material = Material {
        base_color: if is_metallic { material.base_color } else { Vec3::zero() },
        emission: Vec3::zero(),
        rotation_rad: 0.0,
        curve_table: 0,
        albedo_table: 0,
        inner_albedo_table: 0,
        transmission_tint: Vec3::zero(),
        transmission_weight: if material.transmits() { 1.0 } else { 0.0 },
        absorption: Vec3::zero(),
        transmission_roughness: 0.0,
        ..*material
    };
    AlbedoKey {
        material,
        curve_table: curve_table.to_vec(),
        is_inside,
    }
}
