//! The medium that a path is in, and its absorption (Beer–Lambert). Twin of the media's functions in
//! `shaders/pass/path_trace.wgsl`.
//!
//! A path remembers the slot of the medium that it entered last. So each segment is absorbed, no matter what ends it: the
//! medium's back, an object inside it, or the front of another medium. It remembers one slot only: after leaving a nested
//! medium it has none until it hits the outer one's back.

use super::*;

impl<T: Single> Integrator<'_, T> {
    inlined! {
        /// Multiplies the throughput by the medium's transmittance over the segment that ends here. At the back of a surface
        /// that transmits, the medium is that surface's own.
        pub fn absorb<R: Recorder>(
            &self,
            point: &SurfacePoint<T>,
            material: &Material<T>,
            vertex: &mut PathVertex<T>,
            paths: &mut Paths<R>,
        ) {
            if !self.has_absorption {
                return;
            }
            let is_within = point.surface.is_within(material);
            let remembered = self.absorption(&vertex.group.each(&paths.state.media));
            let absorption = Vec3::select(is_within, material.absorption, remembered);
            let active = vertex.active & absorption.is_any();
            if !active.any() {
                return;
            }
            let kept = transmittance_over(absorption, vertex.distance);
            vertex
                .members
                .record(&mut paths.outputs, active, |lane| Event::Absorption {
                    distance: vertex.distance.lane(lane),
                    kept: kept.lane(lane).to_f32(),
                });
            vertex.throughput = Vec3::select(active, vertex.throughput * kept, vertex.throughput);
        }

        /// Updates the media of paths that continue in direction `wi`.
        pub fn update_media<R: Recorder>(
            &self,
            point: &SurfacePoint<T>,
            material: &Material<T>,
            wi: Vec3<T>,
            vertex: &PathVertex<T>,
            paths: &mut Paths<R>,
        ) {
            if self.has_absorption {
                let media = media_towards(point, material, wi, vertex, paths);
                vertex.group.set_each(&mut paths.state.media, &media);
            }
        }

        /// An emitter's radiance after absorption over a distance, in direction `wi` from a surface.
        pub fn attenuated_emission<R: Recorder>(
            &self,
            point: &SurfacePoint<T>,
            material: &Material<T>,
            [wi, radiance]: [Vec3<T>; 2],
            distance: T,
            vertex: &PathVertex<T>,
            paths: &Paths<R>,
        ) -> Vec3<T> {
            if !self.has_absorption {
                return radiance;
            }
            let absorption = self.absorption(&media_towards(point, material, wi, vertex, paths));
            if !absorption.is_any().any() {
                return radiance;
            }
            radiance * transmittance_over(absorption, distance)
        }

        /// Absorption coefficients of media by slot, per unit of length; 0 without a medium.
        fn absorption(&self, media: &T::Each<u32>) -> Vec3<T> {
            Vec3::from_lanes(|lane| {
                let medium = self.scalar_materials.get(media[lane] as usize);
                medium.map_or(Vec3::ZERO, |material| material.absorption)
            })
        }
    }
}

inlined! {
    /// Slots of the media that paths enter in direction `wi`.
    fn media_towards<T: Single, R: Recorder>(
        point: &SurfacePoint<T>,
        material: &Material<T>,
        wi: Vec3<T>,
        vertex: &PathVertex<T>,
        paths: &Paths<R>,
    ) -> T::Each<u32> {
        let media = vertex.group.each(&paths.state.media);
        let transmits = vertex.active & material.transmits();
        if !transmits.any() {
            return media;
        }
        let is_behind = point.surface.normal.dot(wi).below_zero();
        let is_inside = point.surface.is_inside;
        let stays = transmits & ((is_inside & !is_behind) | (!is_inside & is_behind));
        let (stays, leaves) = (stays.to_bits(), (transmits & is_inside & is_behind).to_bits());
        T::each(|lane| match (stays >> lane & 1, leaves >> lane & 1) {
            (1, _) => point.slot,
            (_, 1) => NO_MEDIUM,
            _ => media[lane],
        })
    }

    /// Beer–Lambert transmittance over a distance, per channel.
    fn transmittance_over<T: Single>(absorption: Vec3<T>, distance: T) -> Vec3<T> {
        (absorption * distance).map(
            #[inline(always)]
            |thickness| (-thickness).exp(),
        )
    }
}
