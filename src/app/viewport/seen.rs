//! What is seen at a place of the image.

use glam::DVec3;

use super::*;
use crate::{
    optics::{material::Material, vector::Vec3},
    scene::{camera::camera_ray, surface::surface_at},
    services::look::SeenSurface,
};

/// The place in the image, in pixels, below its size.
pub fn pixel_at(at: Pos2, place: Rect, scene: &Scene) -> Option<[f64; 2]> {
    let share = (at - place.min) / place.size();
    let is_inside = (0.0..1.0).contains(&share.x) && (0.0..1.0).contains(&share.y);
    let [width, height] = scene.job.settings.image_size.map(f64::from);
    is_inside.then(|| [f64::from(share.x) * width, f64::from(share.y) * height])
}

/// The surface that is seen at a place, in pixels.
pub fn hit_at(pixel: [f64; 2], scene: &Scene) -> Option<SeenSurface> {
    let size = scene.job.settings.image_size;
    let (camera, geometry) = (&scene.job.settings.camera, &scene.job.geometry);
    let [origin, direction] = camera_ray(camera, pixel, size, [0.5; 2]);
    let hit = geometry.intersect(origin.to_f32(), direction.to_f32(), f32::INFINITY)?;
    let slot = geometry.slot(hit.triangle as usize) as usize;
    let materials: Vec<_> = scene.job.materials.iter().map(Material::cast).collect();
    let point = surface_at(geometry, &materials, &scene.job.textures, &hit, direction);
    let cosine: f64 = point.surface.frame.normal.dot(point.surface.wo);
    let surface = &point.surface;
    let vector = |of: Vec3<f64>| DVec3::new(of.x, of.y, of.z);
    Some(SeenSurface {
        place: vector(point.position),
        mirrored: vector(surface.wo.mirrored_about(surface.frame.normal)).normalize(),
        slot: (slot < scene.model.slots.len()).then_some(slot),
        object: Some(geometry.object(hit.triangle as usize) as usize)
            .filter(|object| *object < scene.model.objects.len()),
        depth: (f64::from(hit.t) * direction.dot(camera.forward) - camera.parallel_from)
            * geometry.world_units_per_unit,
        view_angle_deg: cosine.clamp(0.0, 1.0).acos().to_degrees() as f32,
    })
}
