//! The camera: a thin lens or parallel rays, and the pixel filter that they are drawn from.

use crate::{named::named, optics::warp::uniform_disc};
use glam::DVec3;

use crate::optics::prelude::*;

named! {
    /// Pixel filter: distribution of a pixel's samples around its centre.
    #[derive(Default)]
    PixelFilter {
        Box = 0, "box", "Box", "Evenly over the pixel's square: what to compare renderers with.";
        #[default]
        Gaussian = 1, "gaussian", "Gaussian", "By a Gaussian of half a pixel's width, cut off at 1.5 pixels: smoother edges.";
    }
}

named! {
    /// How the camera projects.
    #[derive(Default)]
    Projection {
        #[default]
        Perspective, "perspective", "Perspective", "Rays from one place, as in an eye: what is farther away is smaller.";
        Orthographic, "orthographic", "Orthographic", "Parallel rays, as in a drawing: sizes don't change with the distance. What is at the target keeps its size.";
    }
}

/// The path's pair of numbers for the place in the pixel.
pub const PIXEL_DIMENSION: u32 = 0;
/// The path's pair of numbers for the place on the lens.
pub const LENS_DIMENSION: u32 = 1;
/// Radius at which the Gaussian is cut off, in pixels.
pub const GAUSSIAN_RADIUS: f64 = 1.5;
/// Standard deviation in pixels.
pub const GAUSSIAN_SIGMA: f64 = 0.5;

/// A camera in the geometry's units: a thin lens, or parallel rays from a plane behind it. The GPU reads the f32 form (`shaders/scene/layout.wgsl`).
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Camera<T> {
    /// Centre of the lens.
    pub origin: Vec3<T>,
    /// Radius of the lens; 0 is a pinhole.
    pub lens_radius: T,
    /// Unit viewing direction.
    pub forward: Vec3<T>,
    /// Focus distance along `forward`.
    pub focus_distance: T,
    /// Right vector, of half the image width at distance 1; with parallel rays of half the width itself.
    pub right: Vec3<T>,
    /// [`PixelFilter`] as a number.
    pub filter_kind: u32,
    /// Up vector, of half the image height as `right` is of its width.
    pub up: Vec3<T>,
    /// How far behind the camera parallel rays start, which is where `origin` is; 0 for a perspective.
    pub parallel_from: T,
}

// SAFETY: f32 and u32 fields without padding; any bit pattern is valid.
unsafe impl bytemuck::Zeroable for Camera<f32> {}
// SAFETY: as above.
unsafe impl bytemuck::Pod for Camera<f32> {}

impl Camera<f64> {
    /// A pinhole camera at `position` looking at `target` (in the geometry's units), +Y up; `fov_deg` is the vertical field
    /// of view, `aspect` width over height. If it looks straight up or down, −Z is up in the image.
    pub fn look_at(position: [f64; 3], target: [f64; 3], fov_deg: f64, aspect: f64, filter: PixelFilter) -> Self {
        let (position, target) = (DVec3::from_array(position), DVec3::from_array(target));
        let forward = (target - position).try_normalize().unwrap_or(DVec3::NEG_Z);
        let [right, up] = right_and_up(forward);
        let half_height = (0.5 * fov_deg.to_radians()).tan();
        Camera {
            origin: Vec3::from_f64(position.to_array()),
            lens_radius: 0.0,
            forward: Vec3::from_f64(forward.to_array()),
            focus_distance: (target - position).length().max(1e-6),
            right: Vec3::from_f64((right * half_height * aspect).to_array()),
            filter_kind: filter as u32,
            up: Vec3::from_f64((up * half_height).to_array()),
            parallel_from: 0.0,
        }
    }

    /// The same camera with parallel rays, that shows what is at the focus as large. They start `behind` it, above 0, so that
    /// nothing is cut off where it is near.
    pub fn orthographic(self, behind: f64) -> Self {
        let distance = self.focus_distance;
        Camera {
            origin: self.origin - self.forward * behind,
            focus_distance: distance + behind,
            right: self.right * distance,
            up: self.up * distance,
            parallel_from: behind,
            ..self
        }
    }

    /// The same camera rolled clockwise about its line of sight, seen by the viewer.
    pub fn rolled(self, roll_deg: f64) -> Self {
        let (sine, cosine) = roll_deg.to_radians().sin_cos();
        // Half the image's sides at distance 1.
        let [width, height] = [self.right.length(), self.up.length()];
        let turned = |along: Vec3<f64>, other: Vec3<f64>, length: f64| (along * cosine + other * sine) * length;
        let [right, up] = [self.right * width.recip(), self.up * height.recip()];
        Camera {
            right: turned(right, up * -1.0, width),
            up: turned(up, right, height),
            ..self
        }
    }

    /// The same camera in another precision.
    #[inline(always)]
    pub fn cast<T: Real>(&self) -> Camera<T> {
        let vector = |v: Vec3<f64>| Vec3::from_f64(v.to_f64());
        Camera {
            origin: vector(self.origin),
            lens_radius: T::from_f64(self.lens_radius),
            forward: vector(self.forward),
            focus_distance: T::from_f64(self.focus_distance),
            right: vector(self.right),
            filter_kind: self.filter_kind,
            up: vector(self.up),
            parallel_from: T::from_f64(self.parallel_from),
        }
    }
}

/// Unit right and up vectors of a view along the unit vector `forward`, +Y up. If it looks straight up or down, −Z is up in
/// the image.
pub fn right_and_up(forward: DVec3) -> [DVec3; 2] {
    let right = forward.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X);
    [right, right.cross(forward)]
}

/// The unit vector towards a place in orbit, in degrees: yaw 0, pitch 0 is +Z, the yaw goes towards +X, the pitch
/// towards +Y.
pub fn orbit_direction(yaw_deg: f64, pitch_deg: f64) -> DVec3 {
    let (yaw, pitch) = (yaw_deg.to_radians(), pitch_deg.to_radians());
    DVec3::new(pitch.cos() * yaw.sin(), pitch.sin(), pitch.cos() * yaw.cos())
}

inlined! {
    /// Offset of a sample from its pixel's centre, in pixels. Sampled from the filter, so that all samples have equal weight.
    pub fn filter_offset<T: Real>(filter_kind: u32, xi: [T; 2]) -> [T; 2] {
        let half = T::HALF;
        if filter_kind == PixelFilter::Box as u32 {
            return [xi[0] - half, xi[1] - half];
        }
        // The radius of a Gaussian cut off at GAUSSIAN_RADIUS, by inversion.
        let kept = 1.0 - (-0.5 * (GAUSSIAN_RADIUS / GAUSSIAN_SIGMA).powi(2)).exp();
        let radius =
            T::from_f64(GAUSSIAN_SIGMA) * (T::from_f64(-2.0) * (T::ONE - xi[0] * T::from_f64(kept)).ln()).safe_sqrt();
        let phi_rad = T::TAU * xi[1];
        [radius * phi_rad.cos(), radius * phi_rad.sin()]
    }

    /// The camera ray of a sample: (origin, unit direction). `pixel` is two whole numbers; the two random pairs are for the
    /// positions in the pixel and on the lens.
    pub fn pixel_ray<T: Real>(
        camera: &Camera<T>,
        pixel: [T; 2],
        image_size: [u32; 2],
        [xi_pixel, xi_lens]: [[T; 2]; 2],
    ) -> [Vec3<T>; 2] {
        let offset: [T; 2] = filter_offset(camera.filter_kind, xi_pixel);
        let half = T::HALF;
        camera_ray(
            camera,
            [pixel[0] + half + offset[0], pixel[1] + half + offset[1]],
            image_size,
            xi_lens,
        )
    }

    /// The ray through an image position, in pixels from the top left: (origin, unit direction).
    pub fn camera_ray<T: Real>(camera: &Camera<T>, place: [T; 2], image_size: [u32; 2], xi_lens: [T; 2]) -> [Vec3<T>; 2] {
        let two = T::TWO;
        let x = two * place[0] / T::from_f64(f64::from(image_size[0])) - T::ONE;
        let y = T::ONE - two * place[1] / T::from_f64(f64::from(image_size[1]));
        let (origin, along) = if camera.parallel_from.above_zero().any() {
            (camera.origin + camera.right * x + camera.up * y, camera.forward)
        } else {
            (camera.origin, camera.forward + camera.right * x + camera.up * y)
        };
        if !camera.lens_radius.above_zero().any() {
            return [origin, along.normalize()];
        }
        let disc = uniform_disc(xi_lens);
        let shift = camera.right.normalize() * (disc[0] * camera.lens_radius)
            + camera.up.normalize() * (disc[1] * camera.lens_radius);
        [origin + shift, (along * camera.focus_distance - shift).normalize()]
    }
}

/// Framing distance relative to the tight one.
const FRAME_MARGIN: f64 = 1.05;

/// Distance at which the bounding sphere of radius 1 just fits the image's shorter side.
pub fn framing_distance(fov_deg: f64, aspect: f64) -> f64 {
    FRAME_MARGIN / ((0.5 * fov_deg.to_radians()).tan() * aspect.min(1.0)).atan().sin()
}
