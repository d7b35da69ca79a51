//! A ray's hit made into a surface to shade.

use crate::optics::frame::{frame_from_normal, frame_from_tangent};
use crate::optics::material::{Material, NO_TEXTURE, Surface};
use crate::optics::numeric::normalize_or;
use crate::optics::real::{Mask, Real};
use crate::optics::vector::{Vec3, vec3};

use super::texture::{Textures, Uvs, mapped_normal, opacity_at, uvs_at};
use super::{Geometry, Hit, Vertex, triangle_normal};

/// Rounding of the position's three products and sums, with what the box test and the transforms add.
pub const POSITION_ERROR: f64 = 1e-6;
/// Smallest cosine between shading normal and view: where interpolation leans further away, the normal is bent back.
pub const VIEW_COSINE_MIN: f64 = 1e-3;

/// Smallest cosine between geometric normal and the mirror direction about a normal from a texture.
pub const MIRROR_HEIGHT_MIN: f64 = 0.01;

/// A point on a surface, ready to shade.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint<T> {
    /// Frame, geometric normal and view.
    pub surface: Surface<T>,
    /// The point, in the geometry's units.
    pub position: Vec3<T>,
    /// How far off the true place `position` may be, along the normal.
    pub error: T,
    /// Material slot.
    pub slot: u32,
    /// The texture coordinates; zero where the material looks up no texture.
    pub uvs: Uvs<T>,
    /// The colour between the vertices, linear RGB; white where the material takes none.
    pub vertex_color: Vec3<T>,
}

impl<T: Real> SurfacePoint<T> {
    /// Where a ray from the surface towards `wi` starts: outside the bound on the position's error. Only a surface that
    /// `transmits` lets it start behind.
    #[inline(always)]
    pub fn ray_origin(&self, wi: Vec3<T>, transmits: bool) -> Vec3<T> {
        let is_behind = transmits && self.surface.normal.dot(wi).to_f64() < 0.0;
        self.position + self.surface.normal * if is_behind { -self.error } else { self.error }
    }
}

/// The shading normal, bent towards the viewer where interpolation turned it away.
#[inline(always)]
pub fn bent_normal<T: Real>(shading: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
    let lean = shading.dot(wo);
    let least = T::from_f64(VIEW_COSINE_MIN);
    let bent = normalize_or(shading + wo * (least - lean), wo);
    Vec3::select(lean.less(least), bent, shading)
}

/// The normal bent so far that the mirror direction about it is above the geometric surface: a lobe that would lie below
/// it were folded back whole, to angles of less reflection than the table of its albedo supposes, and the surface would be
/// dark there. Source: Keller et al., "The Iray Light Transport Simulation and Rendering System" (2017), appendix A.3.
#[inline(always)]
pub fn lifted_normal<T: Real>(shading: Vec3<T>, geometric: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
    let mirrored = wo.mirrored_about(shading);
    let height = mirrored.dot(geometric);
    let least = T::from_f64(MIRROR_HEIGHT_MIN);
    let lifted = normalize_or(mirrored + geometric * (least - height), geometric);
    Vec3::select(height.less(least), normalize_or(wo + lifted, geometric), shading)
}

/// Where a ray met the geometry.
#[derive(Clone, Copy, Debug)]
pub struct HitPlace<T> {
    /// The point, in the geometry's units.
    pub position: Vec3<T>,
    /// How far off the true place `position` may be, along the normal.
    pub error: T,
    /// The geometric normal, on the side of the ray's origin.
    pub normal: Vec3<T>,
    /// True where the back of the triangle was met.
    pub is_back: bool,
}

/// The weights of a hit triangle's corners.
#[inline(always)]
fn hit_weights<T: Real>(hit: &Hit) -> [T; 3] {
    let (u, v) = (T::from_f64(f64::from(hit.u)), T::from_f64(f64::from(hit.v)));
    [T::one() - u - v, u, v]
}

/// The place where a ray of unit `direction` met the geometry.
#[inline(always)]
pub fn hit_place<T: Real>(geometry: &Geometry, hit: &Hit, direction: Vec3<T>) -> HitPlace<T> {
    let corners = geometry.corners(hit.triangle as usize).map(Vec3::from_f32);
    let [p0, p1, p2] = corners;
    let weights: [T; 3] = hit_weights(hit);
    let out = normalize_or(triangle_normal(corners), -direction);
    let is_back = out.dot(-direction).less(T::zero());
    let normal = Vec3::select(is_back, -out, out);
    HitPlace {
        position: p0 * weights[0] + p1 * weights[1] + p2 * weights[2],
        error: position_error(corners, weights, normal),
        normal,
        is_back: is_back.any(),
    }
}

/// Where a ray goes on that a surface did not stop.
#[inline(always)]
pub fn passed_origin<T: Real>(geometry: &Geometry, hit: &Hit, direction: Vec3<T>) -> Vec3<T> {
    let place = hit_place(geometry, hit, direction);
    place.position - place.normal * place.error
}

/// The surface where a ray of unit `direction` met the geometry.
#[inline(always)]
pub fn surface_at<T: Real>(
    geometry: &Geometry,
    materials: &[Material<T>],
    textures: &Textures,
    hit: &Hit,
    direction: Vec3<T>,
) -> SurfacePoint<T> {
    let index = hit.triangle as usize;
    let [w, u, v] = hit_weights(hit);
    let HitPlace {
        position,
        error,
        normal,
        is_back,
    } = hit_place(geometry, hit, direction);
    let wo = -direction;
    let corners = geometry.vertices(index);
    let interpolate =
        |a: [f32; 3], b: [f32; 3], c: [f32; 3]| Vec3::from_f32(a) * w + Vec3::from_f32(b) * u + Vec3::from_f32(c) * v;
    let interpolated = interpolate(corners[0].normal, corners[1].normal, corners[2].normal);
    let smoothed = normalize_or(interpolated, normal);
    let is_turned = smoothed.dot(normal).less(T::zero());
    let facing = |shading: Vec3<T>| bent_normal(Vec3::select(is_turned, -shading, shading), wo);
    let slot = geometry.slot(index);
    let material = &materials[slot as usize];
    let uvs = if material.is_textured() {
        uvs_at(geometry, index, [w, u, v], material.has_box_projection == 1)
    } else {
        [[T::zero(); 2]; 3]
    };
    let tangent = || {
        let axis = |i: usize| [corners[i].tangent[0], corners[i].tangent[1], corners[i].tangent[2]];
        interpolate(axis(0), axis(1), axis(2))
    };
    let color = if material.has_vertex_colors == 1 {
        let [a, b, c] = corners.map(vertex_color);
        a * w + b * u + c * v
    } else {
        Vec3::splat(T::one())
    };
    let coat_normal = facing(smoothed);
    let mut shading = coat_normal;
    if material.textures[2] != NO_TEXTURE {
        let side = |i: usize| T::from_f64(f64::from(corners[i].tangent[3]));
        let sign = side(0) * w + side(1) * u + side(2) * v;
        let outward = normalize_or(interpolated, if is_back { -normal } else { normal });
        let normals = [smoothed, tangent(), outward];
        shading = facing(mapped_normal(textures, material, uvs, normals, sign));
        shading = lifted_normal(shading, normal, wo);
    }
    let frame = if material.anisotropy.to_f64() != 0.0 {
        frame_from_tangent(shading, tangent(), material.rotation_rad)
    } else {
        frame_from_normal(shading)
    };
    SurfacePoint {
        surface: Surface {
            frame,
            normal,
            wo,
            coat_normal,
            is_inside: is_back,
        },
        position,
        error,
        slot,
        uvs,
        vertex_color: color,
    }
}

/// The linear colour of a vertex that multiplies the material's.
#[inline(always)]
fn vertex_color<T: Real>(vertex: &Vertex) -> Vec3<T> {
    Vec3::from_f32(vertex.rgb())
}

/// The share of light that is stopped where a ray met the geometry, in [0, 1].
#[inline(always)]
pub fn hit_opacity<T: Real>(geometry: &Geometry, materials: &[Material<T>], textures: &Textures, hit: &Hit) -> T {
    let material = &materials[geometry.slot(hit.triangle as usize) as usize];
    if !material.has_holes() {
        return T::one();
    }
    let has_box = material.has_box_projection == 1;
    let uvs = uvs_at(geometry, hit.triangle as usize, hit_weights(hit), has_box);
    opacity_at(textures, material, uvs)
}

/// How far off its plane, along the unit `normal`, the place may be that is interpolated between a triangle's corners
/// with these weights.
#[inline(always)]
pub fn position_error<T: Real>(corners: [Vec3<T>; 3], weights: [T; 3], normal: Vec3<T>) -> T {
    let [p0, p1, p2] = corners.map(|corner| corner.map(T::abs));
    let [w, u, v] = weights.map(T::abs);
    let margin = T::from_f64(0.05);
    T::from_f64(POSITION_ERROR)
        * normal
            .map(T::abs)
            .dot(p0 * w + p1 * u + p2 * v + vec3(margin, margin, margin))
}
