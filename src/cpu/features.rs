//! What the camera sees first: twin of `shaders/pass/features.wgsl`.

use rayon::prelude::*;

use super::integrator::Integrator;
use crate::job::Job;
use crate::job::features::{FeatureSums, Features};

/// The features of a job, over the first `samples` of each pixel.
pub fn features(job: &Job, samples: u32) -> Features {
    let integrator = Integrator::<f32>::new(job);
    let [width, height] = job.settings.image_size;
    let of_pixel = |index: u32| {
        let pixel = [index % width, index / width];
        let mut sums = FeatureSums::default();
        for sample in 0..samples {
            let Some(seen) = integrator.trace_features(pixel, sample) else {
                continue;
            };
            let [r, g, b] = seen.albedo.to_f32();
            let [x, y, z] = seen.normal.to_f32();
            add(&mut sums.albedo_hits, [r, g, b, 1.0]);
            add(&mut sums.normal_depth, [x, y, z, seen.depth]);
        }
        sums
    };
    let sums: Vec<_> = (0..width * height).into_par_iter().map(of_pixel).collect();
    Features::from_sums([width, height], &sums, samples, job.geometry.world_units_per_unit)
}

fn add(sums: &mut [f32; 4], values: [f32; 4]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += value;
    }
}
