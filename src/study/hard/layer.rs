//! Layers at the ends of their parameters, in f32 against f64.

use super::{HardError, Stage};
use crate::compile::compile;
use crate::cpu::probe::probe_material;
use crate::document::{CoatLobe, MaterialSettings};
use crate::job::precision::{ERROR_BOUND, relative_error};
use crate::job::probe::{MaterialQuestion, MaterialView, ProbeScene};
use crate::optics::vector::{Vec3, vec3};

/// Cosines of views and lights.
const COSINES: [f32; 5] = [1.0, 0.7, 0.2, 1e-3, 1e-6];

cases! {
    "lobe"
    "coat-at-its-ends"
        "a coat that reflects all over a white base is 0/0, and its way at index 1 has no end at the horizon"
        "coats of weight 0, 1e-6 and 1, roughness 0 and 1, index 1 and 3, white to black. Metal, gloss and glass below; \
           cosines from 1 to 1e-6"
        "every value is finite and not negative, and that of f64"
        || {
        let (inner, base) = (1.0_f32, 1.0_f32);
        let darkened = (1.0 - inner) / (1.0 - inner * base);
        format!("{darkened}")
    },
        "error" ERROR_BOUND, largest_error;
}

/// Every coat over every base.
fn coated() -> Vec<MaterialSettings> {
    let mut all = Vec::new();
    let bases = [(1.0, 0.0), (0.0, 0.0), (0.0, 1.0)];
    for (number, (metalness, transmission_weight)) in (0..).zip(bases) {
        for ends in 0..24_u32 {
            let [is_rough, is_dense, is_grey] = [1, 2, 4].map(|bit| ends & bit != 0);
            let color = [[1.0; 3], [0.9, 0.5, 0.2], [0.0; 3]][(ends as usize + number) % 3];
            all.push(MaterialSettings {
                metalness,
                transmission_weight,
                base_color: [if is_grey { 0.5 } else { 1.0 }; 3],
                coat_weight: [0.0, 1e-6, 1.0][ends as usize / 8],
                coat_roughness: f32::from(is_rough),
                coat_lobe: if is_rough { CoatLobe::Ggx } else { CoatLobe::Geometric },
                coat_ior: if is_dense { 3.0 } else { 1.0 },
                coat_color: color,
                ..MaterialSettings::default()
            });
        }
    }
    all
}

fn question(material: u32, cosines: [f32; 2], azimuth_rad: f32) -> MaterialQuestion {
    let up = vec3(0.0, 0.0, 1.0);
    let [wo, wi] = [(cosines[0], 0.0), (cosines[1], azimuth_rad)].map(|(cosine, azimuth)| {
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        vec3(sine * azimuth.cos(), sine * azimuth.sin(), cosine)
    });
    MaterialQuestion {
        view: MaterialView {
            material,
            is_inside: 0,
            shading: up,
            tangent: vec3(1.0, 0.0, 0.0),
            normal: up,
            wo,
        },
        wi,
        light_density: 1.0,
        competing: 0.0,
    }
}

fn largest_error(stage: &mut Stage) -> Result<f64, HardError> {
    let (materials, tables) = compile(&coated());
    let scene = ProbeScene {
        tables: &tables,
        materials: &materials,
        geometry: None,
    };
    let mut questions = Vec::new();
    for material in 0..materials.len() as u32 {
        for view in COSINES {
            for light in COSINES {
                questions.extend([0.3, 2.9].map(|azimuth| question(material, [view, light], azimuth)));
            }
        }
    }
    let answers = stage.prober.materials(&scene, &questions)?;
    let error = |question: &MaterialQuestion, answer: &Vec3<f32>| {
        let is_sound = answer.to_f64().iter().all(|x| x.is_finite() && *x >= 0.0);
        if !is_sound {
            return f64::INFINITY;
        }
        relative_error(*answer, |moved| probe_material::<f64>(&scene, question, moved)).unwrap_or(0.0)
    };
    Ok(std::iter::zip(&questions, &answers)
        .map(|(question, answer)| error(question, answer))
        .fold(0.0, f64::max))
}
