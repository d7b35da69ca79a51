//! Hard cases of rays: counts of rays that leak through a closed mesh or miss.

use glam::{DVec3, Vec3};

use super::{
    Stage, StudyError,
    meshes::{add_square, cube, model},
};
use crate::{
    job::probe::{NO_HIT, ProbeScene, RayAnswer, RayQuestion},
    optics::random::hash_bits,
    scene::{Geometry, Hit, shapes, surface::surface_at, texture::Textures},
};

impl Stage {
    /// Number of rays to test for leaks.
    pub fn rays(&self) -> u32 {
        if self.thorough { 1_000_000 } else { 100_000 }
    }
}

/// A number in [0, 1) from bits.
pub fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / 16_777_216.0
}

/// The i-th of many directions.
pub fn direction(i: u32) -> Vec3 {
    let (a, b) = (hash_bits(i), hash_bits(i ^ 0x9e37_79b9));
    Vec3::from_array(crate::optics::warp::uniform_sphere([unit(a), unit(b)]).to_f32()).normalize()
}

pub fn ray(origin: Vec3, direction: Vec3) -> RayQuestion {
    RayQuestion {
        origin: origin.to_array(),
        direction: direction.to_array(),
        t_max: 1e30,
    }
}

/// A vertex, or a place on an edge, of a triangle.
pub fn edge_aim(geometry: &Geometry, i: u32) -> Vec3 {
    let triangle = hash_bits(i ^ 0x1234) as usize % geometry.triangle_count();
    let corners = geometry.corners(triangle).map(Vec3::from_array);
    match i % 3 {
        0 => corners[0],
        1 => corners[0].lerp(corners[1], unit(hash_bits(i ^ 0x777))),
        _ => corners[1].midpoint(corners[2]),
    }
}

/// Number of rays that miss, or miss before `t_max`.
pub fn leaks(stage: &Stage, geometry: &Geometry, rays: &[RayQuestion], t_max: f32) -> Result<f64, StudyError> {
    let answers = trace(stage, geometry, rays)?;
    let is_lost = |answer: &&RayAnswer| answer.triangle == NO_HIT || answer.t.is_nan() || answer.t > t_max;
    Ok(answers.iter().filter(is_lost).count() as f64)
}

fn trace(stage: &Stage, geometry: &Geometry, rays: &[RayQuestion]) -> Result<Vec<RayAnswer>, StudyError> {
    let scene = ProbeScene {
        geometry: Some(geometry),
        ..ProbeScene::default()
    };
    Ok(stage.prober.rays(&scene, rays)?)
}

/// Rays from grid points of a cube along axes and in planes: number of wrong exits.
pub fn axis_rays(stage: &Stage) -> Result<f64, StudyError> {
    let geometry = Geometry::build(&model(cube(DVec3::ONE, 8)), false);
    let wall = (1.0 / geometry.world_units_per_unit) as f32;
    let mut rays = Vec::new();
    let steps = [-0.75_f32, -0.5, 0.0, 0.25, 0.5];
    for x in steps {
        for y in steps {
            for z in steps {
                let origin = Vec3::new(x, y, z) * wall;
                for axis in 0..3 {
                    for (size, zero) in [(1.0, 0.0), (-1.0, 0.0), (1.0, -0.0), (-1.0, -0.0)] {
                        let mut along = [zero; 3];
                        along[axis] = size;
                        rays.push(ray(origin, Vec3::from_array(along)));
                        // In the planes of the walls' own squares, along their diagonals.
                        along[(axis + 1) % 3] = size;
                        rays.push(ray(origin, Vec3::from_array(along)));
                    }
                }
                rays.push(ray(origin, Vec3::ONE));
                rays.push(ray(origin, -Vec3::ONE));
            }
        }
    }
    let answers = trace(stage, &geometry, &rays)?;
    let is_wrong = |(ray, answer): &(&RayQuestion, &RayAnswer)| {
        let exits = (0..3).filter(|&i| ray.direction[i] != 0.0);
        let exits = exits.map(|i| (wall * ray.direction[i].signum() - ray.origin[i]) / ray.direction[i]);
        let exit = exits.fold(f32::INFINITY, f32::min);
        answer.triangle == NO_HIT || answer.t.is_nan() || (answer.t - exit).abs() > 1e-6
    };
    Ok(rays.iter().zip(&answers).filter(is_wrong).count() as f64)
}

/// Rays that leave a convex mesh outwards and inwards: number of wrong hits and misses.
pub fn leaving_rays(stage: &Stage) -> Result<f64, StudyError> {
    let mut wrong = 0.0;
    for radius in [1.0, 0.001] {
        let mut mesh = shapes::sphere(48, 24);
        for place in &mut mesh.positions {
            *place = *place * radius + DVec3::new(0.6, 0.5, 0.3) * f64::from(u8::from(radius < 1.0));
        }
        if radius < 1.0 {
            // Far away: hits there do not count.
            add_square(
                &mut mesh,
                [[-1.0, -1.0], [-0.9, -1.0], [-0.9, -0.9], [-1.0, -0.9]].map(|[x, z]| DVec3::new(x, -1.0, z)),
                false,
            );
        }
        let geometry = Geometry::build(&model(mesh), false);
        let materials = [Default::default(), Default::default()];
        let (materials, _) = crate::compile::compile(&materials);
        let textures = Textures::default();
        let mut rays = Vec::new();
        let mut is_outward = Vec::new();
        for i in 0..stage.rays() / 4 {
            let triangle = hash_bits(i ^ 0x4321) % geometry.triangle_count() as u32;
            let corners = geometry.corners(triangle as usize).map(Vec3::from_array);
            if radius < 1.0 && corners[0].distance(corners[1]) > 0.05 {
                continue;
            }
            let normal = (corners[1] - corners[0])
                .cross(corners[2] - corners[0])
                .normalize_or(Vec3::Y);
            // Half of the directions graze; in the plane itself, by rounding, no side is the right one.
            let flat = if i % 2 == 0 { 1.0 } else { 0.001 };
            let along = direction(i);
            let height = normal.dot(along);
            let out = (along - normal * height + normal * (height.abs() * flat).max(1e-5)).normalize_or(normal);
            let (u, v) = (unit(hash_bits(i ^ 1)), unit(hash_bits(i ^ 2)));
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let hit = Hit { t: 1.0, triangle, u, v };
            let eye = crate::optics::vector::Vec3::from_f32((-normal).to_array());
            let point = surface_at::<f32>(&geometry, &materials, &textures, &hit, eye);
            for direction in [out, -out] {
                let wi = crate::optics::vector::Vec3::from_f32(direction.to_array());
                rays.push(ray(Vec3::from_array(point.ray_origin(wi, true).to_f32()), direction));
                is_outward.push(direction == out);
            }
        }
        let answers = trace(stage, &geometry, &rays)?;
        let is_hit = |answer: &RayAnswer| answer.triangle != NO_HIT && (radius == 1.0 || answer.t < 0.1);
        let bad = |(answer, outward): &(&RayAnswer, &bool)| is_hit(answer) == **outward;
        wrong += answers.iter().zip(&is_outward).filter(bad).count() as f64;
    }
    Ok(wrong)
}
