//! The materials of a model's file as materials of ours: glTF's roughness is that of GGX, and other lobes get the
//! roughness at which they look alike.

use std::sync::LazyLock;

use rayon::prelude::*;

use super::MaterialSettings;
use crate::analysis::fit::{Measure, roughness, total_variation};
use crate::named::named;
use crate::optics::lobe::Lobe;
use crate::optics::lobe::model::{LobeModel, NORMAL, roughness_min};
use crate::optics::material::MATCHED_NODES;
use crate::optics::table::table_lookup;

named! {
    /// The lobe that a model's materials get.
    #[derive(Default)]
    ImportLobe {
        #[default]
        Geometric, "geometric", "Geometric", "The geometric lobe, its roughness matched to the look of GGX.";
        Ggx, "ggx", "GGX", "GGX with the roughness of the file.";
    }
}

impl ImportLobe {
    /// Gives a material that has the roughness of a file this lobe.
    pub fn apply(self, material: &mut MaterialSettings) {
        match self {
            Self::Geometric => {
                material.lobe = Lobe::Geometric;
                material.roughness = geometric_from_ggx(material.roughness);
            }
            Self::Ggx => material.lobe = Lobe::Ggx,
        }
    }
}

/// Steps of the scan for a roughness, and relative accuracy of its search.
const SCAN: (usize, f64) = (12, 2e-3);

/// The geometric lobe's roughness that comes closest to the look of GGX, by total variation at normal incidence, at
/// [`MATCHED_NODES`] roughnesses of GGX from 0 to 1; for the curve of new materials. It never falls.
pub static MATCHED: LazyLock<[f32; MATCHED_NODES]> = LazyLock::new(|| {
    let default = MaterialSettings::default();
    let nearest = |node: usize| {
        let ggx = LobeModel::new(Lobe::Ggx, node as f64 / (MATCHED_NODES - 1) as f64, default.curve);
        let geometric = LobeModel::new(Lobe::Geometric, 1.0, default.curve);
        let target = |wi| ggx.evaluate(NORMAL, wi)[0];
        let distance = |r: f64| total_variation(&target, &geometric.with_roughness(r), 0.0, Measure::Evaluate);
        roughness::minimum([roughness_min(Lobe::Geometric), 1.0], SCAN.0, SCAN.1, &distance).roughness
    };
    let found: Vec<f64> = (1..MATCHED_NODES).into_par_iter().map(nearest).collect();
    let mut matched = [0.0_f32; MATCHED_NODES];
    for (node, roughness) in found.into_iter().enumerate() {
        matched[node + 1] = matched[node].max(roughness as f32);
    }
    matched
});

/// The geometric lobe's roughness that looks like this one of GGX, both in [0, 1].
pub fn geometric_from_ggx(roughness: f32) -> f32 {
    table_lookup(&*MATCHED, 0, MATCHED_NODES, roughness)
}

/// The least roughness of GGX that looks like this one of the geometric lobe; 1 where none is rough enough.
pub fn ggx_from_geometric(roughness: f32) -> f32 {
    let last = (MATCHED_NODES - 1) as f32;
    let Some(node) = MATCHED.iter().position(|matched| *matched >= roughness) else {
        return 1.0;
    };
    let Some(before) = node.checked_sub(1) else { return 0.0 };
    let (low, high) = (MATCHED[before], MATCHED[node]);
    (before as f32 + (roughness - low) / (high - low)) / last
}
