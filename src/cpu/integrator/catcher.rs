//! The shadow catcher: a ground plane of which the camera sees only shadows and reflections. Twin of the catcher's functions
//! in `shaders/pass/path_trace.wgsl`.
//!
//! To the camera it shows the background. A share is mirrored as in varnish. The rest is multiplied by the ratio of the
//! light that arrives to the light without occluders. Both equal the background itself if nothing occludes.
//!
//! Over a transparent background, alpha is 1 minus the light's luminance.

use super::*;
use crate::{
    cpu::recorder::Purpose,
    job::Catcher,
    scene::catcher::{catcher_light, catcher_reflectance},
};

/// Dimensions of the catcher's choice to mirror, and (the next one) of the background's blur: beyond those of every path.
pub const CATCHER_DIMENSION: u32 = 12288;

impl<T: Single> Integrator<'_, T> {
    /// Applies the shadow catcher to hits. Returns the lanes with a visible surface (the others show the background
    /// unchanged) and those that the catcher mirrors.
    #[inline(always)]
    pub fn apply_catcher<R: Recorder>(
        &self,
        point: &SurfacePoint<T>,
        vertex: &mut PathVertex<T>,
        paths: &mut Paths<R>,
    ) -> [T::Mask; 2] {
        let mut masks = [vertex.active, T::Mask::splat(false)];
        let Some(catcher) = self.settings.catcher else {
            return masks;
        };
        if vertex.bounce > 0 {
            vertex
                .members
                .for_each(&mut paths.catcher_hits, vertex.active, |hit, _| {
                    if hit.is_mirrored() {
                        *hit = CatcherHit::Miss;
                    }
                });
        } else if catcher.slot == point.slot {
            masks = out_of_line!(T, self.hit_catcher(catcher, point, vertex, paths));
        }
        masks
    }

    /// Restarts camera paths at the shadow catcher, or mirrors them. The catcher is invisible from below and where no light
    /// reaches it.
    #[inline(always)]
    fn hit_catcher<R: Recorder>(
        &self,
        catcher: Catcher,
        point: &SurfacePoint<T>,
        vertex: &mut PathVertex<T>,
        paths: &mut Paths<R>,
    ) -> [T::Mask; 2] {
        let (group, members) = (vertex.group, vertex.members);
        let positions = point.position.to_each();
        let light = Vec3::<T>::from_lanes(|lane| catcher_light(self.tables, catcher.table, positions[lane]));
        let is_visible = vertex.active & vertex.direction.y.below_zero() & light.max_component().above_zero();
        let uv = self.escaped_uv(vertex.direction, 0);
        let (background, alpha) = self.camera_background(&group, vertex.direction, uv, CATCHER_DIMENSION + 1, paths);
        let [choice, _] = group.pairs(paths, CATCHER_DIMENSION, [Purpose::Catcher, Purpose::Unused]);
        let share = catcher_reflectance(self.tables, catcher.table, -vertex.direction.y);
        let is_mirrored = is_visible & choice.less(share);
        let is_transparent = !alpha.above_zero();
        let shown = Vec3::select(is_transparent, Vec3::ONE, background);
        let albedo = self.materials[catcher.slot as usize].base_color;
        let is_lit = light.map(|light| T::ONE.masked(light.above_zero()));
        let kept = (light * albedo).map(|light| (T::ONE / light).masked(light.above_zero()));
        vertex.throughput = Vec3::select(is_mirrored, vertex.throughput, shown * kept);
        let (backgrounds, alphas) = (background.to_each(), alpha.to_each());
        let (mirrors, gaps) = (is_mirrored.to_bits(), is_transparent.to_bits());
        members.for_each(&mut paths.catcher_hits, is_visible, |hit, lane| {
            *hit = if mirrors >> lane & 1 == 1 {
                CatcherHit::Mirrored {
                    background: backgrounds[lane],
                    alpha: alphas[lane],
                }
            } else {
                CatcherHit::Shadow {
                    is_transparent: gaps >> lane & 1 == 1,
                }
            };
        });
        let throughput = vertex.throughput;
        members.record(&mut paths.outputs, is_visible, |lane| Event::CatcherHit {
            is_mirrored: mirrors >> lane & 1 == 1,
            background: shown.lane(lane).to_f32(),
            light: light.lane(lane).to_f32(),
            throughput: throughput.lane(lane).to_f32(),
        });
        // A colour channel without any light has no shadow: it shows the background.
        let unshadowed = shown * (Vec3::ONE - is_lit);
        self.add(
            &members,
            is_visible & !is_mirrored,
            Origin::Background,
            unshadowed,
            0,
            paths,
        );
        [is_visible, is_mirrored]
    }
}
