//! Scenes of the benchmark, as files that any renderer reads: a teapot under a sky with a small sun and two soft boxes, and a
//! ground.

use std::{
    f64::consts::{PI, TAU},
    fs::File,
    io::{self, BufWriter, Write},
    path::Path,
};

use glam::{DVec3, Vec3};

use crate::{
    document::{Document, MaterialSettings},
    optics::{fresnel::Fresnel, lobe::Lobe},
    parallel,
    scene::{ModelSource, camera::PixelFilter, environment::EnvironmentSource, mesh::Mesh, teapot},
};

/// Segments of a patch of the teapot, and the names of the meshes by their numbers of triangles.
const MESHES: [(u32, &str); 3] = [(9, "6k"), (28, "60k"), (90, "600k")];
/// Complex index of refraction of gold.
pub const GOLD: [[f32; 3]; 2] = [[0.143, 0.375, 1.442], [3.983, 2.386, 1.603]];
/// Camera position.
pub const EYE: [f64; 3] = [3.744_755_1, 4.459_777_26, 7.494_526_51];
/// Point that the camera looks at.
pub const TARGET: [f64; 3] = [0.25, 1.45, 0.0];
/// Vertical angle of view in degrees.
pub const FOV_DEG: f64 = 45.0;
/// Path segments at most, the camera ray included.
pub const DEPTH: u32 = 8;
/// Half the side of the ground, about as large as the one that Glossmith adds.
const GROUND_HALF_SIDE: f64 = 64.0;
/// Materials of the scenes.
const MATERIALS: [&str; 5] = ["metal 0.09", "metal 0.25", "diffuse", "plastic", "glass"];

/// Columns and rows of the sky.
const SKY: [usize; 2] = [2048, 1024];
/// The sun: elevation, azimuth and radius in degrees, and its radiance.
const SUN_DEG: [f64; 3] = [42.0, -60.0, 0.6];
const SUN_RADIANCE: [f64; 3] = [25_000.0, 23_750.0, 21_500.0];
/// Samples of a texel of the sun along each side.
const SUN_SAMPLES: usize = 4;

fn smooth(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A rectangle that faces the origin.
struct SoftBox {
    centre: DVec3,
    size: [f64; 2],
    /// Width of its soft border.
    border: f64,
    radiance: DVec3,
}

impl SoftBox {
    fn radiance(&self, direction: DVec3) -> DVec3 {
        let normal = self.centre.normalize();
        let right = DVec3::Y.cross(normal).normalize();
        let towards = direction.dot(normal);
        if towards <= 0.001 {
            return DVec3::ZERO;
        }
        let place = direction * (self.centre.length() / towards);
        let inside = |across: f64, size: f64| 1.0 - smooth(size / 2.0 - self.border, size / 2.0, across.abs());
        let up = normal.cross(right);
        self.radiance * inside(place.dot(right), self.size[0]) * inside(place.dot(up), self.size[1])
    }
}

fn direction(column: f64, row: f64) -> DVec3 {
    let (azimuth, polar) = (TAU * column / SKY[0] as f64, PI * row / SKY[1] as f64);
    DVec3::new(polar.sin() * azimuth.sin(), polar.cos(), -polar.sin() * azimuth.cos())
}

fn sky_at(column: usize, row: usize) -> [f32; 3] {
    let at = |part: usize, of: usize, whole: usize| whole as f64 + (part as f64 + 0.5) / of as f64;
    let towards = direction(at(0, 1, column), at(0, 1, row));
    let (horizon, zenith) = (DVec3::new(0.85, 0.88, 0.92), DVec3::new(0.22, 0.38, 0.72));
    let ground = DVec3::new(0.16, 0.14, 0.12);
    let above = horizon.lerp(zenith, smooth(-0.02, 1.0, towards.y).powf(0.6));
    let mut radiance = above.lerp(ground, 1.0 - smooth(-0.08, 0.0, towards.y));
    let boxes = [
        SoftBox {
            centre: DVec3::new(-3.0, 2.0, 2.6),
            size: [2.2, 2.8],
            border: 0.08,
            radiance: DVec3::new(7.5, 7.2, 6.8),
        },
        SoftBox {
            centre: DVec3::new(4.0, 1.2, 1.0),
            size: [1.0, 3.0],
            border: 0.06,
            radiance: DVec3::new(3.2, 3.6, 4.2),
        },
    ];
    radiance += boxes.iter().map(|light| light.radiance(towards)).sum::<DVec3>();
    let [elevation, azimuth] = [SUN_DEG[0], SUN_DEG[1]].map(f64::to_radians);
    let sun = DVec3::new(
        azimuth.sin() * elevation.cos(),
        elevation.sin(),
        azimuth.cos() * elevation.cos(),
    );
    if towards.dot(sun) > 0.999 {
        let parts = (0..SUN_SAMPLES).flat_map(|y| (0..SUN_SAMPLES).map(move |x| (x, y)));
        let shares = parts.map(|(x, y)| {
            let towards = direction(at(x, SUN_SAMPLES, column), at(y, SUN_SAMPLES, row));
            let angle_deg = towards.dot(sun).clamp(-1.0, 1.0).acos().to_degrees();
            1.0 - smooth(SUN_DEG[2] * 0.9, SUN_DEG[2] * 1.1, angle_deg)
        });
        radiance += DVec3::from_array(SUN_RADIANCE) * (shares.sum::<f64>() / (SUN_SAMPLES * SUN_SAMPLES) as f64);
    }
    radiance.as_vec3().to_array()
}

/// Writes the sky.
fn write_sky(path: &Path) -> exr::error::UnitResult {
    let [width, height] = SKY;
    let texels = parallel::map(width * height, |index| sky_at(index % width, index / width));
    exr::prelude::write_rgb_file(path, width, height, |x, y| {
        let [red, green, blue] = texels[y * width + x];
        (red, green, blue)
    })
}

/// Writes a mesh as PLY with its normals.
fn write_ply(path: &Path, mesh: &Mesh) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    writeln!(
        file,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}",
        mesh.positions.len()
    )?;
    for name in ["x", "y", "z", "nx", "ny", "nz"] {
        writeln!(file, "property float {name}")?;
    }
    writeln!(
        file,
        "element face {}\nproperty list uchar int vertex_indices\nend_header",
        mesh.triangles.len()
    )?;
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        for number in position.as_vec3().to_array().into_iter().chain(normal.to_array()) {
            file.write_all(&number.to_le_bytes())?;
        }
    }
    for triangle in &mesh.triangles {
        file.write_all(&[3])?;
        for vertex in triangle {
            file.write_all(&vertex.to_le_bytes())?;
        }
    }
    file.flush()
}

/// A square at the height of the teapot's bottom, of this half side.
fn ground(half_side: f64) -> Mesh {
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
    Mesh {
        positions: corners.map(|[x, z]| DVec3::new(x, 0.0, z) * half_side).to_vec(),
        normals: vec![Vec3::Y; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// A scene of the benchmark.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// Material: a name of the table in docs/PERFORMANCE.md.
    pub material: &'static str,
    /// Mesh by its number of triangles: `6k`, `60k` or `600k`.
    pub mesh: &'static str,
    /// Whether the teapot stands on a ground.
    pub ground: bool,
}

impl Scene {
    /// All scenes: five materials, three meshes, two on a ground.
    pub fn all() -> impl Iterator<Item = Self> {
        let scene = |material, mesh, ground| Self { material, mesh, ground };
        let of_materials = MATERIALS.into_iter().map(move |material| scene(material, "60k", false));
        let of_meshes = ["6k", "600k"]
            .into_iter()
            .map(move |mesh| scene(MATERIALS[0], mesh, false));
        let on_ground = [MATERIALS[0], "diffuse"]
            .into_iter()
            .map(move |material| scene(material, "60k", true));
        of_materials.chain(of_meshes).chain(on_ground)
    }

    /// Name in tables.
    pub fn name(&self) -> String {
        let ground = if self.ground { ", ground" } else { "" };
        format!("{}, {}{ground}", self.material, self.mesh)
    }

    /// Writes the files that the scenes name: sky, meshes, ground.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn write_files(folder: &Path) -> exr::error::UnitResult {
        write_sky(&folder.join("sky.exr"))?;
        for (segments, name) in MESHES {
            write_ply(&folder.join(format!("{name}.ply")), &teapot::mesh(segments))?;
        }
        Ok(write_ply(&folder.join("ground.ply"), &ground(GROUND_HALF_SIDE))?)
    }

    /// Document of the scene, `size` pixels square, with its files in `folder`.
    pub fn document(&self, folder: &Path, size: u32) -> Document {
        let mut document = Document {
            model: ModelSource::File(folder.join(format!("{}.ply", self.mesh))),
            ground: self.ground,
            materials: vec![self.material()],
            ..Document::default()
        };
        document.lighting.environment = EnvironmentSource::File(folder.join("sky.exr"));
        document.camera.position = Some(EYE);
        document.camera.target = Some(TARGET);
        document.camera.fov_deg = FOV_DEG;
        let render = &mut document.render;
        (render.width, render.height) = (size, size);
        render.bounces = DEPTH - 2;
        render.filter = PixelFilter::Box;
        render.adaptive = Some(false);
        document
    }

    fn material(&self) -> MaterialSettings {
        let metal = MaterialSettings {
            lobe: Lobe::Ggx,
            fresnel: Fresnel::Conductor,
            roughness: 0.3,
            eta: GOLD[0],
            k: GOLD[1],
            ..MaterialSettings::default()
        };
        let dielectric = MaterialSettings {
            metalness: 0.0,
            fresnel: Fresnel::Dielectric,
            ..metal.clone()
        };
        match self.material {
            "metal 0.25" => MaterialSettings {
                roughness: 0.5,
                ..metal
            },
            "diffuse" => MaterialSettings::diffuse("diffuse", [0.8; 3]),
            "plastic" => MaterialSettings {
                roughness: 0.1_f32.sqrt(),
                base_color: [0.6, 0.1, 0.1],
                ..dielectric
            },
            "glass" => MaterialSettings {
                transmission_weight: 1.0,
                base_color: [1.0; 3],
                ..dielectric
            },
            _ => metal,
        }
    }
}
