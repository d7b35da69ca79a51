//! Cameras and lights of a model's file.

/// A camera of a file, in the units of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelCamera {
    /// What to call it.
    pub name: String,
    /// Where it is.
    pub position: [f64; 3],
    /// Where it looks, of length 1.
    pub forward: [f64; 3],
    /// What is up in its picture, of length 1, at right angles to `forward`.
    pub up: [f64; 3],
    /// How much of the scene it sees.
    pub lens: ModelLens,
}

/// How much of a scene a file's camera sees, from the lower to the upper edge of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModelLens {
    /// An angle, degrees.
    Perspective(f64),
    /// A length, the same however far away, in units of the scene.
    Orthographic(f64),
}

/// The most lights of a scene beside its environment.
pub const LIGHTS_MAX: usize = 64;

/// What kind a light of a file is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// The same in all directions, from a place.
    Point,
    /// A cone, from a place. Half the angles across it, radians: within the first it is as bright as it gets, beyond the
    /// other dark.
    Spot([f64; 2]),
    /// Parallel, from far away.
    Directional,
}

/// A light of a file (KHR_lights_punctual), in the units of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelLight {
    /// What to call it.
    pub name: String,
    /// How it shines.
    pub kind: LightKind,
    /// Where it is.
    pub position: [f64; 3],
    /// Where it shines, of length 1.
    pub forward: [f64; 3],
    /// Linear RGB.
    pub color: [f32; 3],
    /// Candela, or lux where it is directional; both taken as radiometric numbers.
    pub intensity: f32,
}
