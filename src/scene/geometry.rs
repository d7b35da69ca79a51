//! Triangles ready to trace, in one f32 coordinate system of unit size. The model and its surroundings (ground, area lights)
//! have a hierarchy each.

use std::{cell::LazyCell, sync::Arc};

use fearless_simd::Level;
use glam::{DMat4, DVec3};

use super::{
    area_shape::AreaShape,
    coarse::{is_coarse, leaning_areas},
    convex::is_convex,
    ground::Ground,
    hierarchy::{EntryPoints, PACKET, Packet, PacketHits, Placement, Wide},
    instanced::{Instance, Instanced, Traceable},
    intersect::{Hit, RayFrame},
    loading::{Cancelled, Loading},
    memory::prefetch,
    model::Model,
    part::{NO_OBJECT, Part, Vertex, exact, is_finite, is_traceable},
};
use crate::{instructions, parallel};

/// Gap between the lowest point and the ground, in bounding radii: enough that flat bottoms do not flicker.
const GROUND_GAP: f64 = 0.0001;

/// Geometry ready to trace, in units in which the model's bounding sphere about the origin has radius 1: a place p here
/// is `center_world + world_units_per_unit · p` in the world (right-handed, +Y up). Models that differ in scale or
/// place only give the same numbers here, up to the last bit.
///
/// Triangles are numbered through both parts, the model's first, and then through the instances of repeated meshes. What is
/// around the model has a hierarchy of its own: moving
/// a light costs what the lights cost, however many triangles the model has.
#[derive(Clone, Debug)]
pub struct Geometry {
    /// The model's triangles without the hidden ones, shared by all geometries of the model.
    pub model: Arc<Part>,
    /// The ground's and the area lights' triangles: the ground's slot is the number of the model's slots, those of area
    /// lights follow.
    pub around: Part,
    /// The model's instances, shared like `model`.
    instanced: Arc<Instanced>,
    /// Number of the model's slots.
    model_slots: u32,
    /// True if the model is one convex body.
    model_is_convex: bool,
    /// See [`Geometry::is_coarse`].
    pub is_coarse: bool,
    /// Centre of the model's bounding box, in world space.
    pub center_world: DVec3,
    /// Bounding radius of the model in world units: from that centre to the farthest vertex of a triangle; 1 without
    /// triangles.
    pub world_units_per_unit: f64,
    /// Bounds of the model (without ground and area lights): lowest and highest corner, in world units.
    pub bounds_world: [DVec3; 2],
    /// Number of triangles left out that have a corner that is not finite.
    pub dropped_not_finite: usize,
    /// Triangles left out because they have no area.
    pub dropped_no_area: usize,
}

impl Geometry {
    /// Makes a model ready to trace; a ground touches its lowest point, in the slot after the model's.
    pub fn build(model: &Model, ground: impl Into<Ground>) -> Self {
        Self::of_model(model, &[], &Loading::default())
            .expect("nobody cancels it")
            .surrounded(ground, &[])
    }

    /// Builds a model without surroundings, with progress and cancellation. Objects in `hidden` are left out; position and
    /// scale stay those of the whole model.
    pub fn of_model(model: &Model, hidden: &[usize], loading: &Loading) -> Result<Self, Cancelled> {
        loading.step("measuring the model")?;
        let mesh = &model.mesh;
        let Framing {
            usable,
            dropped_not_finite,
            bounds_world,
            center_world,
            world_units_per_unit,
            traceable,
        } = Framing::of(model);
        let is_usable = |triangle: &usize| is_traceable(mesh.corners(*triangle));
        let to_units = |place: DVec3| ((place - center_world) / world_units_per_unit).as_vec3().to_array();
        let is_shown = |triangle: &usize| {
            let object = model.object_of(*triangle);
            !hidden.iter().any(|hidden| Some(*hidden) == object)
        };
        let object_of = |triangle| model.object_of(triangle).map_or(NO_OBJECT, |object| object as u32);
        let chosen = loading.while_wanted(0..mesh.triangles.len()).filter(is_usable);
        let mut part = Part::default();
        let closed = if hidden.is_empty() {
            part.add(mesh, chosen, object_of, to_units)
        } else {
            part.add(mesh, chosen.filter(is_shown), object_of, to_units)
        };
        loading.check()?;
        part.build(loading)?;
        let units_from_world =
            DMat4::from_scale(DVec3::splat(world_units_per_unit.recip())) * DMat4::from_translation(-center_world);
        let (instanced, closed_instances) = Instanced::new(
            (&model.repeated, &model.instances),
            &traceable,
            hidden,
            units_from_world,
            loading,
        )?;
        let [own, repeated] = [leaning_areas(&part), instanced.leaning_areas()];
        Ok(Self {
            model_is_convex: instanced.is_empty() && is_convex(&part.positions, &part.triangles, loading)?,
            is_coarse: is_coarse([own[0] + repeated[0], own[1] + repeated[1]]),
            model: Arc::new(part),
            around: Part::default(),
            instanced: Arc::new(instanced),
            model_slots: model.slots.len() as u32,
            center_world,
            world_units_per_unit,
            bounds_world,
            dropped_not_finite,
            dropped_no_area: model.triangle_count() - dropped_not_finite - usable + closed + closed_instances,
        })
    }

    /// The same model with another ground and area lights, each in a slot of its own: shares the model's triangles and
    /// builds the surroundings.
    pub fn surrounded(&self, ground: impl Into<Ground>, area_lights: &[AreaShape]) -> Self {
        let mut around = Part::default();
        let ground = ground.into().mesh(self.ground_height(), self.model_slots);
        let first_light = self.model_slots + u32::from(ground.is_some());
        let lights = area_lights
            .iter()
            .zip(first_light..)
            .map(|(light, slot)| light.mesh(slot));
        for mesh in ground.into_iter().chain(lights) {
            let to_units = |place: DVec3| place.as_vec3().to_array();
            around.add(&mesh, 0..mesh.triangles.len(), |_| NO_OBJECT, to_units);
        }
        around.build(&Loading::default()).expect("nobody cancels it");
        Self {
            model: self.model.clone(),
            instanced: self.instanced.clone(),
            around,
            ..*self
        }
    }

    /// Whether every ray that leaves a face on its outside misses: the scene is one convex body.
    pub fn is_convex(&self) -> bool {
        self.model_is_convex && self.around.is_empty()
    }

    pub fn triangle_count(&self) -> usize {
        self.first_instanced() + self.instanced.triangle_count()
    }

    /// Number of the first triangle of the instances.
    fn first_instanced(&self) -> usize {
        self.model.triangles.len() + self.around.triangles.len()
    }

    /// Both parts, each with the number of its first triangle.
    pub fn parts(&self) -> [(&Part, usize); 2] {
        [(&self.model, 0), (&self.around, self.model.triangles.len())]
    }

    /// The part that a triangle is in, its number there, and the instance of the part.
    fn find(&self, triangle: usize) -> (&Part, usize, Option<&Instance>) {
        match triangle.checked_sub(self.model.triangles.len()) {
            None => (&self.model, triangle, None),
            Some(after) => match after.checked_sub(self.around.triangles.len()) {
                None => (&self.around, after, None),
                Some(instanced) => self.instanced.find(instanced),
            },
        }
    }

    /// The material slot of a triangle.
    pub fn slot(&self, triangle: usize) -> u32 {
        let (part, triangle, _) = self.find(triangle);
        part.slots[triangle]
    }

    /// The material slots of all triangles in order.
    pub fn slots(&self) -> impl Iterator<Item = u32> {
        self.model
            .slots
            .iter()
            .chain(&self.around.slots)
            .copied()
            .chain(self.instanced.slots())
    }

    /// The model's object that a triangle belongs to; [`NO_OBJECT`] for ground and area lights.
    pub fn object(&self, triangle: usize) -> u32 {
        let (part, triangle, instance) = self.find(triangle);
        instance.map_or(part.objects[triangle], |instance| instance.object)
    }

    /// The places of a triangle's corners.
    pub fn corners(&self, triangle: usize) -> [[f32; 3]; 3] {
        let (part, triangle, instance) = self.find(triangle);
        placed(part.corners(triangle), instance, Placement::point)
    }

    /// Shading attributes of a triangle's vertices; for normals and tangents, which an instance turns, see
    /// [`Geometry::normals`] and [`Geometry::tangents`].
    pub fn vertices(&self, triangle: usize) -> [&Vertex; 3] {
        let (part, triangle, instance) = self.find(triangle);
        placed(part.vertices_of(triangle), instance, |_, vertex| vertex)
    }

    /// Normals at a triangle's corners.
    pub fn normals(&self, triangle: usize) -> [[f32; 3]; 3] {
        let (part, triangle, instance) = self.find(triangle);
        placed(
            part.vertices_of(triangle).map(|vertex| vertex.normal),
            instance,
            Placement::normal,
        )
    }

    /// Tangents at a triangle's corners, with the signs of their bitangents.
    pub fn tangents(&self, triangle: usize) -> [[f32; 4]; 3] {
        let (part, triangle, instance) = self.find(triangle);
        placed(
            part.vertices_of(triangle).map(Vertex::tangent_and_side),
            instance,
            Placement::tangent,
        )
    }

    /// The model with the triangles of its instances one by one, as the GPU has it.
    pub fn whole_model(&self) -> &Part {
        match self.instanced.is_empty() {
            true => &self.model,
            false => &self.instanced.whole(&self.model).part,
        }
    }

    /// Number of triangles of instances that [`Geometry::whole_model`] has yet to copy.
    pub fn triangles_to_copy(&self) -> usize {
        self.instanced.triangles_to_copy()
    }

    /// Both parts as the GPU has them, each with the place of its first triangle there.
    pub fn whole_parts(&self) -> [(&Part, usize); 2] {
        let model = self.whole_model();
        [(model, 0), (&self.around, model.triangles.len())]
    }

    /// The triangle at a place in the order in which the GPU has them.
    pub fn triangle_at(&self, place: u32) -> u32 {
        let [(model, _), (around, first)] = self.whole_parts();
        let own = self.model.triangles.len() as u32;
        match place.checked_sub(first as u32) {
            None => self.number_of(model.compressed().triangles[place as usize]),
            Some(after) => around.compressed().triangles[after as usize] + own,
        }
    }

    /// The number of a triangle of [`Geometry::whole_model`].
    fn number_of(&self, triangle: u32) -> u32 {
        if self.instanced.is_empty() {
            return triangle;
        }
        let number = self.instanced.whole(&self.model).numbers[triangle as usize];
        let is_own = (number as usize) < self.model.triangles.len();
        number + if is_own { 0 } else { self.around.triangles.len() as u32 }
    }

    /// Place of a triangle in the order in which the GPU has them: the inverse of [`Geometry::triangle_at`].
    pub fn places(&self) -> impl Fn(u32) -> u32 {
        let [(model, _), (around, first)] = self.whole_parts();
        // The model's places are only needed if the model emits.
        let of_model = LazyCell::new(|| match self.instanced.is_empty() {
            true => model.compressed().places(),
            false => self.instanced.whole(&self.model).places(),
        });
        let of_around = LazyCell::new(|| around.compressed().places());
        let own = self.model.triangles.len() as u32;
        move |triangle| match triangle.checked_sub(own) {
            None => of_model[triangle as usize],
            Some(after) => match after.checked_sub(around.triangles.len() as u32) {
                None => of_around[after as usize] + first as u32,
                Some(instanced) => of_model[(own + instanced) as usize],
            },
        }
    }

    /// Number of the model's slots; the ground's and the area lights' follow.
    pub fn model_slots(&self) -> usize {
        self.model_slots as usize
    }

    /// Memory in bytes, with the hierarchies built so far; data shared with other geometries counts, too.
    pub fn bytes(&self) -> usize {
        self.model.bytes() + self.around.bytes() + self.instanced.bytes()
    }

    /// Builds the CPU's hierarchies, if not built yet, instead of at the first ray. Returns their memory in bytes.
    pub fn prepare(&self) -> usize {
        self.model.wide().bytes() + self.around.wide().bytes() + self.instanced.prepare()
    }

    /// The closest hit on a ray with 0 < t < `t_max`, in the geometry's units. The direction may have any length but 0.
    #[inline]
    pub fn intersect(&self, origin: [f32; 3], direction: [f32; 3], t_max: f32) -> Option<Hit> {
        self.intersect_by(instructions::level(), origin, direction, t_max)
    }

    /// The same with a given instruction set.
    #[inline]
    pub fn intersect_by(&self, level: Level, origin: [f32; 3], direction: [f32; 3], t_max: f32) -> Option<Hit> {
        let frame = RayFrame::new(origin.into(), direction.into());
        let mut nearest = self.model.hit::<false>(level, &frame, t_max);
        let reach = nearest.map_or(t_max, |hit| hit.t);
        if let Some(hit) = self.around.hit::<false>(level, &frame, reach) {
            let triangle = hit.triangle + self.model.triangles.len() as u32;
            nearest = Some(Hit { triangle, ..hit });
        }
        if !self.instanced.is_empty() {
            let reach = nearest.map_or(t_max, |hit| hit.t);
            if let Some(hit) = self.instanced.hit::<false>(level, &frame, reach) {
                let triangle = hit.triangle + self.first_instanced() as u32;
                nearest = Some(Hit { triangle, ..hit });
            }
        }
        nearest
    }

    /// True if any triangle is hit with 0 < t < `t_max`.
    #[inline]
    pub fn occluded(&self, origin: [f32; 3], direction: [f32; 3], t_max: f32) -> bool {
        self.occluded_by(instructions::level(), origin, direction, t_max)
    }

    /// The same with a given instruction set.
    #[inline]
    pub fn occluded_by(&self, level: Level, origin: [f32; 3], direction: [f32; 3], t_max: f32) -> bool {
        let frame = RayFrame::new(origin.into(), direction.into());
        self.model.hit::<true>(level, &frame, t_max).is_some()
            || self.around.hit::<true>(level, &frame, t_max).is_some()
            || (!self.instanced.is_empty() && self.instanced.hit::<true>(level, &frame, t_max).is_some())
    }

    /// The closest hit of each ray of a packet, the same as by [`Geometry::intersect`]. `level` is the instruction set.
    pub fn intersect_packet(&self, level: Level, packet: &Packet) -> [Option<Hit>; PACKET] {
        self.intersect_from(level, packet, &[None; 2])
    }

    /// The same for several packets of coherent rays, as a camera's through a tile. Calls `report` with each packet's hits
    /// in order, or never if no ray hits anything.
    pub fn intersect_packets(&self, level: Level, packets: &[Packet], mut report: impl FnMut([Option<Hit>; PACKET])) {
        let entry_points = self.parts().map(|(part, _)| part.wide().entry_points(level, packets));
        let are_empty = entry_points
            .iter()
            .all(|entry_points| entry_points.as_ref().is_some_and(EntryPoints::is_empty));
        if are_empty && self.instanced.is_empty() {
            return;
        }
        for packet in packets {
            report(self.intersect_from(level, packet, &entry_points));
        }
    }

    /// The closest hits of a packet, starting from the entry points of both parts where they are known.
    fn intersect_from(
        &self,
        level: Level,
        packet: &Packet,
        entry_points: &[Option<EntryPoints>; 2],
    ) -> [Option<Hit>; PACKET] {
        let mut hits = [None; PACKET];
        let mut packet_hits = PacketHits::none(packet);
        let is_traced = self.trace_parts(entry_points, &mut packet_hits, |wide, entry_points, packet_hits| {
            wide.hits::<false>(level, packet, entry_points, packet_hits)
        });
        for (lane, hit) in hits.iter_mut().enumerate() {
            *hit = match is_traced {
                true => packet_hits.hit(lane),
                false => self.intersect_by(level, packet.origin(lane), packet.direction(lane), packet.t_max[lane]),
            };
        }
        hits
    }

    /// Traces a packet through both parts by `trace`. Returns false if its rays are not in one octant, or there are
    /// instances: then rays are traced one by one.
    fn trace_parts(
        &self,
        entry_points: &[Option<EntryPoints>; 2],
        packet_hits: &mut PacketHits,
        trace: impl Fn(&Wide, Option<&EntryPoints>, &mut PacketHits) -> bool,
    ) -> bool {
        if !self.instanced.is_empty() {
            return false;
        }
        for ((part, first), entry_points) in self.parts().into_iter().zip(entry_points) {
            packet_hits.first = first as u32;
            if !part.is_empty() && !trace(part.wide(), entry_points.as_ref(), packet_hits) {
                return false;
            }
        }
        true
    }

    /// True for each ray of a packet that hits any triangle, the same as by [`Geometry::occluded`].
    pub fn occluded_packet(&self, level: Level, packet: &Packet) -> [bool; PACKET] {
        let mut is_occluded = [false; PACKET];
        let mut packet_hits = PacketHits::none(packet);
        let is_traced = self.trace_parts(&[None; 2], &mut packet_hits, |wide, _, packet_hits| {
            wide.hits::<true>(level, packet, None, packet_hits)
        });
        for (lane, is_occluded) in is_occluded.iter_mut().enumerate() {
            *is_occluded = match is_traced {
                true => packet_hits.is_hit(lane),
                false => self.occluded_by(level, packet.origin(lane), packet.direction(lane), packet.t_max[lane]),
            };
        }
        is_occluded
    }

    /// Prefetches the data that shading a triangle reads.
    #[inline(always)]
    pub fn prefetch(&self, triangle: u32) {
        if triangle as usize >= self.first_instanced() {
            return;
        }
        let (part, triangle, _) = self.find(triangle as usize);
        prefetch(&part.slots, triangle);
        for vertex in part.triangles[triangle] {
            prefetch(&part.vertices, vertex as usize);
        }
    }

    /// Height of the ground, in the geometry's units.
    pub fn ground_height(&self) -> f64 {
        (self.bounds_world[0].y - self.center_world.y) / self.world_units_per_unit - GROUND_GAP
    }

    /// Messages on triangles that were left out, one line each.
    pub fn warnings(&self) -> Vec<String> {
        let counts = [
            (self.dropped_not_finite, "a corner that is not finite"),
            (self.dropped_no_area, "no area"),
        ];
        counts
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, reason)| format!("{count} triangles left out: {reason}"))
            .collect()
    }

    /// Centre and radius, in the geometry's units, of a sphere around chosen triangles; `None` without triangles.
    pub fn sphere_around(&self, is_chosen: impl Fn(usize) -> bool) -> Option<([f32; 3], f64)> {
        let chosen = || (0..self.triangle_count()).filter(|&triangle| is_chosen(triangle));
        let places = || chosen().flat_map(|triangle| exact(self.corners(triangle)));
        let (low, high) = (places().reduce(DVec3::min)?, places().reduce(DVec3::max)?);
        let center = low.midpoint(high);
        let radius = places().map(|place| place.distance(center)).fold(0.0, f64::max);
        Some((center.as_vec3().to_array(), radius.max(1e-6)))
    }

    /// A place in the world of one in the geometry's units.
    pub fn world_from_units(&self, place: [f32; 3]) -> DVec3 {
        self.center_world + self.world_units_per_unit * DVec3::from_array(place.map(f64::from))
    }

    /// A place in the geometry's units of one in the world.
    pub fn units_from_world(&self, place: DVec3) -> DVec3 {
        (place - self.center_world) / self.world_units_per_unit
    }
}

/// What a triangle's corners have, as it is in a part or as an instance of the part has it.
#[inline(always)]
fn placed<T>(corners: [T; 3], instance: Option<&Instance>, place: impl Fn(&Placement, T) -> T) -> [T; 3] {
    match instance {
        None => corners,
        Some(instance) => in_place(corners, &instance.placement, place),
    }
}

/// Kept out of the code that traces scenes without instances.
#[inline(never)]
fn in_place<T>(corners: [T; 3], placement: &Placement, place: impl Fn(&Placement, T) -> T) -> [T; 3] {
    placement.in_order(corners.map(|corner| place(placement, corner)))
}

/// The traceable triangles of a mesh and their bounding sphere.
pub struct Framing {
    /// Number of triangles with finite corners and an area.
    pub usable: usize,
    /// Number of triangles with a corner that is not finite.
    pub dropped_not_finite: usize,
    bounds_world: [DVec3; 2],
    /// Centre of the bounding box, in world space.
    pub center_world: DVec3,
    /// See [`Geometry::world_units_per_unit`].
    pub world_units_per_unit: f64,
    /// Of each of the model's repeated meshes.
    traceable: Vec<Traceable>,
}

impl Framing {
    /// The framing of a model.
    pub fn of(model: &Model) -> Self {
        let mesh = &model.mesh;
        let traceable = Traceable::of_meshes(&model.repeated);
        let in_instances = |count: fn(&Traceable) -> usize| {
            model
                .instances
                .iter()
                .map(|instance| count(&traceable[instance.mesh]))
                .sum::<usize>()
        };
        let counts = parallel::map_blocks(mesh.triangles.len(), |triangles| {
            let corners = || triangles.clone().map(|triangle| mesh.corners(triangle));
            let usable = corners().filter(|corners| is_traceable(*corners)).count();
            (usable, corners().filter(|corners| !is_finite(corners)).count())
        });
        // The largest of a function of all places.
        let largest = |of: &(dyn Fn(DVec3) -> DVec3 + Sync)| {
            let of_mesh = parallel::map_blocks(mesh.triangles.len(), |triangles| {
                let corners = triangles.map(|triangle| mesh.corners(triangle));
                let places = corners.filter(|corners| is_traceable(*corners)).flatten();
                places.map(of).fold(DVec3::NEG_INFINITY, DVec3::max)
            });
            let of_instances = parallel::map_each(&model.instances, |instance| {
                let places = traceable[instance.mesh].places.iter();
                let places = places.map(|place| instance.world_from_mesh.transform_point3(*place));
                places.map(of).fold(DVec3::NEG_INFINITY, DVec3::max)
            });
            of_mesh
                .into_iter()
                .chain(of_instances)
                .fold(DVec3::NEG_INFINITY, DVec3::max)
        };
        let (low, high) = (-largest(&|place| -place), largest(&|place| place));
        let bounds_world = if low.x <= high.x { [low, high] } else { [DVec3::ZERO; 2] };
        let center_world = bounds_world[0].midpoint(bounds_world[1]);
        let radius = largest(&|place| DVec3::splat(place.distance(center_world))).x;
        let has_radius = radius > 0.0 && radius.is_finite();
        Self {
            usable: counts.iter().map(|counts| counts.0).sum::<usize>() + in_instances(|mesh| mesh.count),
            dropped_not_finite: counts.iter().map(|counts| counts.1).sum::<usize>()
                + in_instances(|mesh| mesh.not_finite),
            bounds_world,
            center_world,
            world_units_per_unit: if has_radius { radius } else { 1.0 },
            traceable,
        }
    }
}

impl Model {
    /// Bounding radius in world units, from the centre of the bounding box to the farthest vertex; 1 without triangles.
    pub fn bounding_radius(&self) -> f64 {
        Framing::of(self).world_units_per_unit
    }
}
