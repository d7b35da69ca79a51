//! A ray's hit made into a surface to shade.

use crate::optics::prelude::*;
use crate::optics::{
    frame::{frame_from_normal, frame_from_tangent},
    material::{HAS_BOX, Material, NO_TEXTURE, Surface, VERTEX_BASE, VERTEX_EMISSION},
    numeric::normalize_or,
    target::TextureTarget,
};

use super::{
    Geometry, Hit, Vertex,
    texture::{Textures, Uvs, mapped_normal, opacity_at, uvs_at, vertex_factors},
    triangle_normal,
};

/// Relative rounding error of a position: three products and sums, plus the box test and the transforms.
pub const POSITION_ERROR: f64 = 1e-6;
/// Smallest cosine between shading normal and view. A normal that leans further away is bent back.
pub const VIEW_COSINE_MIN: f64 = 0.001;

/// Smallest cosine between geometric normal and the mirror direction about a normal from a texture.
pub const MIRROR_HEIGHT_MIN: f64 = 0.01;

/// A point on a surface, ready to shade.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint<T: Real> {
    /// Frame, geometric normal and view.
    pub surface: Surface<T>,
    /// The point, in the geometry's units.
    pub position: Vec3<T>,
    /// Error bound of `position` along the normal, in the geometry's units.
    pub error: T,
    /// Material slot: the same in all lanes.
    pub slot: u32,
    /// Texture coordinates; zero for an untextured material.
    pub uvs: T::Each<Uvs<T::Scalar>>,
    /// Interpolated vertex colour, linear RGB; white if unused.
    pub vertex_color: Vec3<T>,
    /// The shading normal without normal textures, on the side of the viewer.
    pub smooth: Vec3<T>,
    /// The rounded surface, if used; see [`SurfacePoint::round`].
    pub rounded: Option<Rounded<T>>,
}

/// A point of a coarse triangle on the round surface that its normals describe.
#[derive(Clone, Copy, Debug)]
pub struct Rounded<T> {
    /// The normal of the triangle itself, on the side of the viewer.
    pub flat: Vec3<T>,
    /// Offset from the triangle to the rounded surface.
    pub rise: Vec3<T>,
}

impl<T: Real> SurfacePoint<T> {
    inlined! {
        /// The normal of the triangle itself, on the side of the viewer.
        pub fn flat_normal(&self) -> Vec3<T> {
            self.rounded.map_or(self.surface.normal, |rounded| rounded.flat)
        }

        /// Origin of a ray from the surface towards `wi`: outside the position's error bound, behind the surface only if it
        /// `transmits`. A ray between the triangle's and the rounded surface's horizon starts on the latter.
        pub fn ray_origin(&self, wi: Vec3<T>, transmits: T::Mask) -> Vec3<T> {
            let flat = self.flat_normal();
            let is_below = flat.dot(wi).below_zero();
            let origin = self.position + flat * T::select(transmits & is_below, -self.error, self.error);
            match self.rounded {
                None => origin,
                Some(Rounded { rise, .. }) => Vec3::select(is_below, origin + rise, origin),
            }
        }

        /// Uses the smooth normal's horizon instead of the triangle's, where the triangle lies below the surface that its
        /// normals describe. So light on the round surface does not end at triangle edges. Source: Hanika, "Hacking the Shadow
        /// Terminator", Ray Tracing Gems II (2021), chapter 4.
        pub fn round(&mut self, geometry: &Geometry, hits: &Hits<T>) {
            let weights = hit_weights::<T>(hits);
            let corners = at_corners(hits, |triangle| geometry.corners(triangle));
            let normals = at_corners(hits, |triangle| geometry.normals(triangle));
            let flat = self.surface.normal;
            let is_turned = between(&normals, &weights).dot(flat).below_zero();
            let part = |i: usize| rise_to_plane(self.position, corners[i], normals[i], weights[i], is_turned);
            let rise = part(0) + part(1) + part(2);
            let is_round = self.error.less(rise.dot(flat));
            self.surface.normal = Vec3::select(is_round, self.smooth, flat);
            let rise = rise.masked(is_round);
            self.rounded = Some(Rounded { flat, rise });
        }
    }
}

inlined! {
    /// Offset from a position in a triangle up to the tangent plane at a corner, if the position lies below it; times the
    /// corner's weight. `is_turned`: the normal points away from the viewer.
    pub fn rise_to_plane<T: Real>(
        position: Vec3<T>,
        corner: Vec3<T>,
        normal: Vec3<T>,
        weight: T,
        is_turned: T::Mask,
    ) -> Vec3<T> {
        let depth = (corner - position).dot(normal);
        normal * (T::select(is_turned, depth.min(T::ZERO), depth.max(T::ZERO)) * weight)
    }

    /// The shading normal, bent towards the viewer if interpolation turned it away.
    pub fn bent_normal<T: Real>(shading: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        let lean = shading.dot(wo);
        let least = T::from_f64(VIEW_COSINE_MIN);
        Vec3::select(
            lean.less(least),
            normalize_or(shading + wo * (least - lean), wo),
            shading,
        )
    }

    /// The normal, bent until its mirror direction is above the geometric surface. A lobe below the surface would be folded back
    /// to angles of less reflection than its albedo table assumes, and darken the surface. Source: Keller et al., "The Iray
    /// Light Transport Simulation and Rendering System" (2017), appendix A.3.
    pub fn lifted_normal<T: Real>(shading: Vec3<T>, geometric: Vec3<T>, wo: Vec3<T>) -> Vec3<T> {
        let mirrored = wo.mirrored_about(shading);
        let height = mirrored.dot(geometric);
        let least = T::from_f64(MIRROR_HEIGHT_MIN);
        let lifted = normalize_or(mirrored + geometric * (least - height), geometric);
        Vec3::select(height.less(least), normalize_or(wo + lifted, geometric), shading)
    }
}

/// Position of a hit.
#[derive(Clone, Copy, Debug)]
pub struct HitPlace<T: Real> {
    /// The point, in the geometry's units.
    pub position: Vec3<T>,
    /// Error bound of `position` along the normal, in the geometry's units.
    pub error: T,
    /// The geometric normal, on the side of the ray's origin.
    pub normal: Vec3<T>,
    /// True for a hit on the triangle's back.
    pub is_back: T::Mask,
}

/// Hits of a group of rays, one per lane.
pub type Hits<T> = <T as Real>::Each<Hit>;

inlined! {
    /// The weights of the hit triangles' corners.
    fn hit_weights<T: Real>(hits: &Hits<T>) -> [T; 3] {
        let number = |weight: f32| T::Scalar::from_f64(f64::from(weight));
        let u = T::from_lanes(|lane| number(hits[lane].u));
        let v = T::from_lanes(|lane| number(hits[lane].v));
        [T::ONE - u - v, u, v]
    }

    /// Three vectors a triangle, one of each corner.
    fn at_corners<T: Real>(hits: &Hits<T>, vectors: impl Fn(usize) -> [[f32; 3]; 3]) -> [Vec3<T>; 3] {
        let vectors = T::each(|lane| vectors(hits[lane].triangle as usize));
        let vectors = vectors.as_ref();
        [
            Vec3::from_lanes(|lane| Vec3::from_f32(vectors[lane][0])),
            Vec3::from_lanes(|lane| Vec3::from_f32(vectors[lane][1])),
            Vec3::from_lanes(|lane| Vec3::from_f32(vectors[lane][2])),
        ]
    }

    /// Barycentric interpolation between three corners.
    fn between<T: Real>(corners: &[Vec3<T>; 3], weights: &[T; 3]) -> Vec3<T> {
        corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
    }

    /// Positions of hits; `direction` is the rays' unit direction.
    pub fn hit_place<T: Real>(geometry: &Geometry, hits: &Hits<T>, direction: Vec3<T>) -> HitPlace<T> {
        let corners = at_corners(hits, |triangle| geometry.corners(triangle));
        let weights = hit_weights::<T>(hits);
        let out = normalize_or(triangle_normal(corners), -direction);
        let is_back = out.dot(-direction).below_zero();
        let normal = Vec3::select(is_back, -out, out);
        HitPlace {
            position: between(&corners, &weights),
            error: position_error(corners, weights, normal),
            normal,
            is_back,
        }
    }
}

/// Origin of a ray that continues through a surface.
pub fn passed_origin<T: Scalar>(geometry: &Geometry, hit: &Hit, direction: Vec3<T>) -> Vec3<T> {
    let place = hit_place(geometry, &T::each(|_| *hit), direction);
    place.position - place.normal * place.error
}

/// Surface point of a hit; `direction` is the ray's unit direction.
pub fn surface_at<T: Scalar>(
    geometry: &Geometry,
    materials: &[Material<T>],
    textures: &Textures,
    hit: &Hit,
    direction: Vec3<T>,
) -> SurfacePoint<T> {
    let slot = geometry.slot(hit.triangle as usize);
    let material = &materials[slot as usize];
    surfaces_at(
        geometry,
        slot,
        (material, material),
        textures,
        &T::each(|_| *hit),
        direction,
    )
}

/// Surface points of hits on one slot; `direction` is the rays' unit direction. The material is given for all lanes and for
/// one lane.
#[inline(always)]
pub fn surfaces_at<T: Real>(
    geometry: &Geometry,
    slot: u32,
    (material, of_lane): (&Material<T>, &Material<T::Scalar>),
    textures: &Textures,
    hits: &Hits<T>,
    direction: Vec3<T>,
) -> SurfacePoint<T> {
    let weights = hit_weights::<T>(hits);
    let HitPlace {
        position,
        error,
        normal,
        is_back,
    } = hit_place(geometry, hits, direction);
    let wo = -direction;
    let normals = at_corners(hits, |triangle| geometry.normals(triangle));
    let interpolated = between(&normals, &weights);
    let smoothed = normalize_or(interpolated, normal);
    let is_turned = smoothed.dot(normal).below_zero();
    let triangle = |lane: usize| hits[lane].triangle as usize;
    let weights_of_lanes = [weights[0].to_each(), weights[1].to_each(), weights[2].to_each()];
    let mut uvs = T::each(|_| Uvs::default());
    if of_lane.is_textured() {
        uvs = T::each(|lane| {
            let weights = [0, 1, 2].map(|i| weights_of_lanes[i][lane]);
            uvs_at(geometry, triangle(lane), weights, of_lane.has_flag(HAS_BOX))
        });
    }
    let mut vertex_color = Vec3::ONE;
    if of_lane.has_flag(VERTEX_BASE | VERTEX_EMISSION) {
        let colors = at_corners(hits, |triangle| geometry.vertices(triangle).map(Vertex::rgb));
        vertex_color = between(&colors, &weights);
    }
    let has_map = of_lane.has_texture(&[TextureTarget::Normal, TextureTarget::CoatNormal]);
    let stretches = [material.anisotropy, material.coat_anisotropy];
    let is_stretched = stretches.iter().any(|stretch| stretch.differs(T::ZERO).any());
    let mut tangent = Vec3::ZERO;
    let mut side = T::ONE;
    if has_map || is_stretched {
        tangent = between(
            &at_corners(hits, |triangle| {
                geometry.tangents(triangle).map(|[x, y, z, _]| [x, y, z])
            }),
            &weights,
        );
        side = T::from_lanes(|lane| {
            let sides = geometry.tangents(triangle(lane)).map(|[_, _, _, side]| side);
            let part = |i: usize| T::Scalar::from_f64(f64::from(sides[i])) * weights_of_lanes[i][lane];
            part(0) + part(1) + part(2)
        });
    }
    let smooth = bent_normal(Vec3::select(is_turned, -smoothed, smoothed), wo);
    let (mut shading, mut coat_normal) = (smooth, smooth);
    if has_map {
        let outward = normalize_or(interpolated, Vec3::select(is_back, -normal, normal));
        let normals = [smoothed.to_each(), tangent.to_each(), outward.to_each()];
        let sides = side.to_each();
        let of_map = [
            (&mut shading, TextureTarget::Normal, of_lane.normal_strength),
            (
                &mut coat_normal,
                TextureTarget::CoatNormal,
                of_lane.coat_normal_strength,
            ),
        ];
        for (bent, target, strength) in of_map {
            let texture = of_lane.texture(target);
            if texture == NO_TEXTURE {
                continue;
            }
            let mapped = Vec3::from_lanes(|lane| {
                let normals = [0, 1, 2].map(|i| normals[i][lane]);
                let (uvs, side) = (uvs[lane], sides[lane]);
                mapped_normal(textures, (texture, strength), uvs, normals, side)
            });
            *bent = lifted_normal(bent_normal(Vec3::select(is_turned, -mapped, mapped), wo), normal, wo);
        }
    }
    let frame = if is_stretched {
        // The rotation is towards the bitangent; `shading` is on the viewer's side, the bitangent is defined from outside.
        let is_mirrored = T::select(is_turned, -side, side).below_zero();
        let rotation_rad = T::select(is_mirrored, -material.rotation_rad, material.rotation_rad);
        frame_from_tangent(shading, tangent, rotation_rad)
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
        vertex_color,
        smooth,
        rounded: None,
    }
}

/// Opacity at a hit, in [0, 1].
pub fn hit_opacity<T: Scalar>(geometry: &Geometry, materials: &[Material<T>], textures: &Textures, hit: &Hit) -> T {
    let material = &materials[geometry.slot(hit.triangle as usize) as usize];
    if !material.has_holes() {
        return T::ONE;
    }
    let has_box = material.has_flag(HAS_BOX);
    let (triangle, weights) = (hit.triangle as usize, hit_weights::<T>(&T::each(|_| *hit)));
    let uvs = uvs_at(geometry, triangle, weights, has_box);
    let (_, alpha) = vertex_factors(geometry, material, triangle, weights);
    opacity_at(textures, material, uvs, alpha)
}

/// Error bound, along the unit `normal`, of a position interpolated between a triangle's corners with these weights.
#[inline(always)]
pub fn position_error<T: Real>(corners: [Vec3<T>; 3], weights: [T; 3], normal: Vec3<T>) -> T {
    let [p0, p1, p2] = corners;
    let [w, u, v] = weights;
    let extent = p0.abs() * w.abs() + p1.abs() * u.abs() + p2.abs() * v.abs();
    T::from_f64(POSITION_ERROR) * normal.abs().dot(extent + Vec3::splat(T::from_f64(0.05)))
}
