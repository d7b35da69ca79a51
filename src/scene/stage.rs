//! Cameras and lights of a model's file.

/// A camera of a file, in the units of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelCamera {
    /// Name in the file.
    pub name: String,
    /// Position in the units of the scene.
    pub position: [f64; 3],
    /// Unit viewing direction.
    pub forward: [f64; 3],
    /// Unit up vector of its image, perpendicular to `forward`.
    pub up: [f64; 3],
    /// Field of view.
    pub lens: ModelLens,
}

/// Vertical field of view of a file's camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModelLens {
    /// Angle in degrees.
    Perspective(f64),
    /// A length, the same however far away, in units of the scene.
    Orthographic(f64),
}

/// The most lights of a scene beside its environment.
pub const LIGHTS_MAX: usize = 64;

/// Kind of a file's light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// A point light: the same in all directions.
    Point,
    /// A spot light with its half angles in radians: full intensity within the first, none beyond the second.
    Spot([f64; 2]),
    /// Parallel, from far away.
    Directional,
}

/// A light of a file (KHR_lights_punctual), in the units of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelLight {
    /// Name in the file.
    pub name: String,
    /// Kind of the light.
    pub kind: LightKind,
    pub position: [f64; 3],
    /// Unit direction of its light.
    pub forward: [f64; 3],
    /// Linear RGB.
    pub color: [f32; 3],
    /// Intensity in candela, or in lux if directional; both used as radiometric numbers.
    pub intensity: f32,
}
