//! The solid that a path is in, and what it absorbs. Twin of the functions of that name in `shaders/pass/path_trace.wgsl`.
//!
//! A path remembers the slot of the solid that it entered last, so that a segment is absorbed whatever ends it: the back of
//! that solid, something opaque or shining inside it, the front of another solid. It remembers one slot: beyond a solid
//! inside another one it knows of none until it meets the outer one's back.

use super::paths::Paths;
use super::{Arrival, Integrator};
use crate::cpu::recorder::{Event, Recorder, single};
use crate::optics::material::Material;
use crate::optics::real::{Mask, Real};
use crate::optics::vector::Vec3;
use crate::scene::medium::NO_MEDIUM;
use crate::scene::surface::SurfacePoint;

impl<T: Real> Integrator<'_, T> {
    /// Multiplies the throughput by what the solid leaves of the light over the segment that ends here. The back of a
    /// surface that transmits tells the solid by itself.
    #[inline(always)]
    pub(super) fn absorb<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        arrival: &mut Arrival<T>,
        paths: &mut Paths<T::Scalar, R>,
    ) {
        if !self.has_absorption {
            return;
        }
        let is_within = point.surface.is_inside & material.transmits();
        let remembered = self.absorption(&arrival.group.each(&paths.state.media));
        let absorption = Vec3::select(is_within, material.absorption, remembered);
        let on = arrival.on & absorption.is_any();
        if !on.any() {
            return;
        }
        let kept = kept_over(absorption, arrival.distance);
        arrival.members.record(&mut paths.found, on, |lane| Event::Absorption {
            distance: single(arrival.distance.lane(lane)),
            kept: kept.to_each().as_ref()[lane].to_f32(),
        });
        arrival.throughput = Vec3::select(on, arrival.throughput * kept, arrival.throughput);
    }

    /// Notes the solids that paths are in which go on from a surface in a direction.
    #[inline(always)]
    pub(super) fn enter<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        wi: Vec3<T>,
        arrival: &Arrival<T>,
        paths: &mut Paths<T::Scalar, R>,
    ) {
        if self.has_absorption {
            let media = media_towards(point, material, wi, arrival, paths);
            arrival.group.set_each(&mut paths.state.media, &media);
        }
    }

    /// What is left of the light of an emitter at a distance, in a direction from a surface.
    #[inline(always)]
    pub(super) fn kept_from<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        material: &Material<T>,
        [wi, radiance]: [Vec3<T>; 2],
        distance: T,
        arrival: &Arrival<T>,
        paths: &Paths<T::Scalar, R>,
    ) -> Vec3<T> {
        if !self.has_absorption {
            return radiance;
        }
        let absorption = self.absorption(&media_towards(point, material, wi, arrival, paths));
        if !absorption.is_any().any() {
            return radiance;
        }
        radiance * kept_over(absorption, distance)
    }

    /// The absorption of the solids of these slots; 0 where there is none.
    #[inline(always)]
    fn absorption(&self, media: &T::Each<u32>) -> Vec3<T> {
        Vec3::from_lanes(
            #[inline(always)]
            |lane| {
                let medium = self.of_lane.get(media.as_ref()[lane] as usize);
                medium.map_or(Vec3::zero(), |material| material.absorption)
            },
        )
    }
}

/// The slots of the solids that paths are in which leave a surface towards `wi`.
#[inline(always)]
fn media_towards<T: Real, R: Recorder>(
    point: &SurfacePoint<T>,
    material: &Material<T>,
    wi: Vec3<T>,
    arrival: &Arrival<T>,
    paths: &Paths<T::Scalar, R>,
) -> T::Each<u32> {
    let media = arrival.group.each(&paths.state.media);
    let transmits = arrival.on & material.transmits();
    if !transmits.any() {
        return media;
    }
    let is_behind = point.surface.normal.dot(wi).less(T::zero());
    let is_inside = point.surface.is_inside;
    let stays = transmits & ((is_inside & !is_behind) | (!is_inside & is_behind));
    let (stays, leaves) = (stays.to_bits(), (transmits & is_inside & is_behind).to_bits());
    T::each(
        #[inline(always)]
        |lane| match (stays >> lane & 1, leaves >> lane & 1) {
            (1, _) => point.slot,
            (_, 1) => NO_MEDIUM,
            _ => media.as_ref()[lane],
        },
    )
}

/// What is left of light over a distance.
#[inline(always)]
fn kept_over<T: Real>(absorption: Vec3<T>, distance: T) -> Vec3<T> {
    let thickness = absorption * distance;
    Vec3 {
        x: (-thickness.x).exp(),
        y: (-thickness.y).exp(),
        z: (-thickness.z).exp(),
    }
}
