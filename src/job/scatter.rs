//! Clouds of lobe samples: request and result, for either engine.

use super::probe::{LobeAnswer, LobeQuestion};
use crate::optics::{
    frame::Frame,
    lobe::lobe_middle,
    lobe::model::{LobeModel, view_direction},
    random::{Sequence, random_pair, random_state},
    real::Real,
    vector::{Vec3, vec3},
};

/// A request for samples of a lobe, in the local frame with the normal +z and the mirror direction in the x–z half plane x ≥
/// 0; refracted samples have z < 0.
#[derive(Clone, Debug, PartialEq)]
pub struct ScatterRequest {
    /// The lobe, not turned out of the plane of incidence.
    pub model: LobeModel,
    /// Angle between view and normal, degrees in [0, 90].
    pub view_angle_deg: f32,
    /// Number of samples, absorbed ones included.
    pub count: u32,
    /// Changes all random numbers.
    pub seed: u32,
}

impl ScatterRequest {
    /// Unit direction to the viewer.
    pub fn wo<T: Real>(&self) -> Vec3<T> {
        Vec3::from_f64(view_direction(f64::from(self.view_angle_deg).to_radians()).to_f64())
    }

    /// The middle of the lobe: the mirror direction, or the refracted one.
    pub fn middle(&self) -> Vec3<f64> {
        let frame = Self::frame();
        lobe_middle(&self.model.shape(), &frame, frame.normal, self.wo())
    }

    /// What draws sample `i`, as the path tracer does; its `wi` is left open.
    pub fn question(&self, i: u32) -> LobeQuestion {
        let state = random_state(0, 0, self.seed, i, Sequence::Independent);
        let ([a, b], [c, _]) = (random_pair(state, 0), random_pair(state, 1));
        let normal = Self::frame().normal;
        LobeQuestion {
            shading: normal,
            normal,
            wo: self.wo(),
            xi: [a, b, c],
            ..LobeQuestion::about(&self.model.shape(), 0)
        }
    }

    /// The frame: the axes.
    pub fn frame<T: Real>() -> Frame<T> {
        let (zero, one) = (T::ZERO, T::ONE);
        Frame {
            tangent: vec3(one, zero, zero),
            bitangent: vec3(zero, one, zero),
            normal: vec3(zero, zero, one),
        }
    }
}

/// Sampled directions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScatterCloud {
    /// Unit direction, then density per steradian; absorbed samples left out.
    pub samples: Vec<[f32; 4]>,
    pub absorbed: u32,
}

impl ScatterCloud {
    /// Adds a sample.
    pub fn add(&mut self, sample: &LobeAnswer) {
        let [x, y, z] = sample.wi.to_f32();
        match sample.weight > 0.0 {
            true => self.samples.push([x, y, z, sample.drawn[1]]),
            false => self.absorbed += 1,
        }
    }
}
