//! The adapter with a scene bound as the passes bind theirs, and the same scene for the Rust twins.

use std::sync::{LazyLock, OnceLock};

use bytemuck::cast_slice;
use glam::Vec2;
use glossmith::{
    gpu::{
        AdapterKind, GpuAdapter, GpuDevice, GpuError, Traversal, geometry_arrays::GeometryArrays, layout::Globals,
        scene_group, scene_group::SceneGroup,
    },
    job::{BackgroundKind, Settings, Strategy},
    optics::{
        albedo::{albedo_table, film_table, rough_albedo_table},
        curve::{CUSTOM_INTERVALS, Curve, custom_table},
        fresnel::Fresnel,
        lobe::{Horizon, Lobe},
        material::{
            COATS_BASE, COMPENSATES, HOLDS_FILM, HOLDS_INTEGRALS, MATCHED_NODES, Material, NO_TEXTURE, OVER_AZIMUTH,
        },
        random::Sequence,
        real::Scalar,
        scattering::scattering_table,
        table::append_table,
        thin_film::film_path,
        vector::vec3,
    },
    scene::{
        Filter, Geometry, Model, ModelSource, Slot, Texture, TextureRef, Wrap,
        camera::{Camera, PixelFilter},
        environment,
        environment::Environment,
        light::{LightChoice, Lights, Sampled},
        texture::{CHANNEL_SHIFT, IS_BOX, TURNS_NORMALS, TextureRecord, TextureTarget as On, Textures},
    },
};
use wgpu::util::{BufferInitDescriptor, DeviceExt};

use super::harness::Rng;

/// Custom curves in the tables.
pub const CUSTOM_CURVES: usize = 3;
/// Samples a node of the materials' albedo tables: their noise is the same for both twins.
const ALBEDO_SAMPLES: u32 = 16;

/// What the functions under test read besides their inputs.
pub struct Scene {
    pub geometry: Geometry,
    pub environment: Environment,
    /// Where each custom curve begins in the tables.
    pub curves: Vec<u32>,
    pub materials: Vec<Material<f32>>,
    pub tables: Vec<f32>,
    /// The teapot and the ground shine.
    pub lights: Lights,
    pub textures: Textures,
}

/// The teapot on its ground in the studio, with a material for each combination of lobe, curve and Fresnel model.
pub static SCENE: LazyLock<Scene> = LazyLock::new(|| {
    let mut model = glossmith::import::load(&ModelSource::Teapot).unwrap();
    let mut rng = Rng::new(7);
    let mut coordinates = Rng::new(8);
    let mut coordinate = || coordinates.range(-1.0, 2.0);
    let second_uvs = model
        .mesh
        .positions
        .iter()
        .map(|_| Vec2::new(coordinate(), coordinate()));
    model.mesh.second_uvs = second_uvs.collect();
    let mut tables = Vec::new();
    let mut curves = Vec::new();
    for curve in 0..CUSTOM_CURVES {
        // Waves, then a density that falls to 0 at the end, then one that is 0 at both ends and in a gap. None whose
        // neighbouring nodes differ by several times: at roughness 1 the distance is rounded to 1e-6, and the density
        // to that times its slope.
        let density = |i: usize| {
            let x = i as f64 / CUSTOM_INTERVALS as f64;
            match curve {
                0 => 1.0 + 0.8 * (9.0 * x + 1.0).sin(),
                1 => 1.0 - x,
                _ => (x * (1.0 - x) * (x - 0.4).max(0.0)).max(x * (0.3 - x)).max(0.0),
            }
        };
        let density: Vec<f64> = (0..=CUSTOM_INTERVALS).map(density).collect();
        curves.push(append_table(
            &mut tables,
            &custom_table([1.0, 1.7, 0.6][curve], &density).unwrap(),
        ));
    }
    let mut textures = Textures::new(&pictures(&mut rng));
    // And those that are put on otherwise: by one channel, inverted in part, on a box, normals turning with them.
    for (number, record) in (0..).zip(textures.records.clone()) {
        textures.records.push(TextureRecord {
            flags: record.flags | IS_BOX | TURNS_NORMALS | (1 + number % 4) << CHANNEL_SHIFT,
            scale: -0.7,
            offset: 0.9,
            ..record
        });
    }
    let mut of_others = Rng::new(23);
    let mut materials = Vec::new();
    for lobe in Lobe::ALL {
        for curve in Curve::ALL {
            for fresnel in Fresnel::ALL {
                let mut material = random_material(&mut rng, *lobe, *curve, *fresnel);
                material.lobe_table = curves[rng.below(CUSTOM_CURVES)];
                let mut texture = || {
                    let record = rng.below(2 * textures.records.len());
                    if record < textures.records.len() {
                        record as u32
                    } else {
                        NO_TEXTURE
                    }
                };
                for target in [On::BaseColor, On::Roughness, On::Normal, On::Emission, On::Opacity] {
                    material.textures[target as usize] = texture();
                }
                // Of the metalness that of the roughness, or any other.
                let others = [
                    material.texture(On::Roughness),
                    of_others.below(textures.records.len()) as u32,
                ];
                material.textures[On::Metalness as usize] = others[of_others.below(2)];
                for target in [
                    &[On::Coat, On::CoatColor, On::Film][..],
                    On::OF_FUZZ,
                    &[On::FilmThickness, On::Specular, On::Transmission],
                ]
                .concat()
                {
                    material.textures[target as usize] = of_others.below(textures.records.len()) as u32;
                }
                materials.push(material);
            }
        }
    }
    // The materials of the geometry's slots: the teapot's stretched, the ground's not.
    materials[0].anisotropy = 0.6;
    materials[1].anisotropy = 0.0;
    materials[0].emission = vec3(0.7, 0.2, 0.4);
    materials[1].emission = vec3(0.001, 0.002, 0.003);
    // Linear pictures: the first with a normal texture, the second with one that shines.
    for material in &mut materials[..2] {
        for target in [On::BaseColor, On::Roughness, On::Normal, On::Emission, On::Opacity] {
            material.textures[target as usize] = NO_TEXTURE;
        }
    }
    materials[0].textures[On::Normal as usize] = 1;
    materials[1].textures[On::Emission as usize] = 0;
    materials[0].textures[On::CoatNormal as usize] = 2;
    // Never so steep that the tangent is along the normal.
    materials[0].normal_strength = 0.5;
    for material in &mut materials[..2] {
        material.light_luminance = material.emission.luminance();
        // Half the light within 60 degrees, none beyond 90.
        (material.spot_scale, material.spot_offset) = (1.4, 0.0);
        material.alpha_cutoff = -1.0;
    }
    for (number, material) in materials.iter_mut().enumerate() {
        if number % 3 == 1 {
            let matched: Vec<_> = (0..MATCHED_NODES).map(|node| (node as f32 / 16.0).powf(0.7)).collect();
            material.roughness_table = append_table(&mut tables, &matched);
        }
        // Stretched, these peaks would be narrower than directions of single precision.
        if material.coat_roughness < 1e-3 {
            material.coat_anisotropy = 0.0;
        }
        if material.roughness.min(material.transmission_roughness) < 1e-3 {
            material.anisotropy = 0.0;
        }
        material.has_rough_tables = match number % 4 {
            3 => HOLDS_INTEGRALS | HOLDS_FILM,
            2 if material.anisotropy != 0.0 => OVER_AZIMUTH,
            _ => 0,
        };
        let coat = Material {
            metalness: 0.0,
            ior: material.coat_ior,
            roughness: material.coat_roughness,
            reflecting_ior: material.coat_ior,
            anisotropy: material.coat_anisotropy,
            has_rough_tables: if material.coat_anisotropy == 0.0 {
                0
            } else {
                OVER_AZIMUTH
            },
            ..*material
        };
        let coat_table = albedo_table(&coat.cast(), &tables, ALBEDO_SAMPLES, false);
        material.coat_table = append_table(&mut tables, &coat_table);
        let albedo = [false, true].map(|is_inside| {
            let of = material.cast();
            if number % 4 != 3 {
                let table = albedo_table(&of, &tables, ALBEDO_SAMPLES, is_inside);
                return append_table(&mut tables, &table);
            }
            let [plain, film] =
                [rough_albedo_table, film_table].map(|table| table(&of, &tables, ALBEDO_SAMPLES, is_inside));
            let start = append_table(&mut tables, &plain);
            append_table(&mut tables, &film);
            start
        });
        [material.albedo_table, material.inner_albedo_table] = albedo;
        if Lobe::ALL[material.lobe as usize].traits().loses_light && number % 3 > 0 {
            let energies = scattering_table(&material.cast(), 16);
            material.lobe_table = append_table(&mut tables, &energies);
            material.flags |= COMPENSATES;
        }
    }
    let geometry = Geometry::build(&model, true);
    Scene {
        lights: Lights::new(&geometry, &materials),
        geometry,
        environment: environment::studio().unwrap(),
        curves,
        materials,
        tables,
        textures,
    }
});

/// Pictures of random texels, looked up in every way.
fn pictures(rng: &mut Rng) -> Model {
    let mut deep = Rng::new(16);
    let textures = [[5, 3], [8, 8], [1, 4]].map(|[width, height]| Texture {
        name: format!("{width} × {height}"),
        width,
        height,
        rgba8: (0..4 * width * height).map(|_| rng.bits() as u8).collect(),
        // One of them has 16 bits, where it holds no colours.
        rgba16: (0..if width == 8 { 4 * width * height } else { 0 })
            .map(|_| deep.bits() as u16)
            .collect(),
    });
    let wraps = [Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge];
    let slots = (0..12).map(|number| {
        let reference = TextureRef {
            texture: number % 3,
            uv_set: number / 3 % 2,
            texture_from_mesh_uv: [(); 6].map(|()| rng.range(-1.5, 1.5)),
            wrap: [wraps[rng.below(3)], wraps[number % 3]],
            filter: if number == 7 { Filter::Nearest } else { Filter::Linear },
        };
        let mut slot = Slot::neutral("pictures");
        match number % 4 {
            3 => *slot.texture_mut(On::BaseColor) = Some(reference),
            _ => *slot.texture_mut(On::Normal) = Some(reference),
        }
        slot
    });
    Model {
        slots: slots.collect(),
        textures: textures.into(),
        ..Model::default()
    }
}

impl Scene {
    /// How light samples are shared out.
    pub fn light_choice(&self) -> LightChoice {
        let sampled = Sampled {
            environment: true,
            emitters: true,
            alone: false,
        };
        LightChoice::new(&self.environment, 1.0, &self.lights, sampled)
    }

    /// A material in the precision of a twin.
    pub fn material<T: Scalar>(&self, index: u32) -> Material<T> {
        self.materials[index as usize].cast()
    }
}

/// Mostly rough enough for f32 to tell directions in the lobe apart; sometimes narrow, a mirror or the limits.
pub fn random_roughness(rng: &mut Rng) -> f32 {
    match rng.below(32) {
        0 => 1.0,
        1 => rng.log_range(1e-3, 0.1),
        _ => rng.range(0.1, 1.0),
    }
}

fn random_material(rng: &mut Rng, lobe: Lobe, curve: Curve, fresnel: Fresnel) -> Material<f32> {
    let mut color = |low: f32, high: f32| vec3(rng.range(low, high), rng.range(low, high), rng.range(low, high));
    let (base_color, specular_color, eta, k) = (color(0.0, 1.0), color(0.2, 1.0), color(0.1, 3.0), color(0.0, 6.0));
    let tint = color(0.2, 1.0);
    let fuzz_roughness = rng.range(0.1, 1.0);
    // From a sequence of their own, so that the other numbers stay what they are.
    let mut of_film = Rng::new(u64::from(tint.x.to_bits()));
    let film = [
        of_film.range(0.0, 1.0),
        if of_film.chance(0.3) {
            of_film.range(0.1, 1.0)
        } else {
            0.0
        },
        of_film.range(1.0, 3.0),
    ];
    let ior = rng.range(1.01, 2.5);
    let metalness = if rng.chance(0.3) { 1.0 } else { rng.range(0.0, 1.0) };
    Material {
        base_color: if rng.chance(0.1) {
            vec3(0.0, 0.0, 0.0)
        } else {
            base_color
        },
        metalness,
        specular_color,
        specular_weight: if rng.chance(0.1) { 0.0 } else { rng.range(0.1, 1.0) },
        eta,
        ior,
        k,
        roughness: if rng.chance(0.1) { 5e-4 } else { rng.range(0.1, 1.0) },
        anisotropy: if rng.chance(0.5) { rng.range(-1.0, 1.0) } else { 0.0 },
        transmission_tint: tint,
        transmission_weight: match rng.below(4) {
            0 => rng.range(0.0, 1.0),
            1 => 1.0,
            _ => 0.0,
        },
        transmission_roughness: if rng.chance(0.1) { 5e-4 } else { rng.range(0.1, 1.0) },
        rotation_rad: rng.range(-3.0, 3.0),
        lobe: lobe as u32,
        curve: curve as u32,
        horizon: Horizon::ALL[rng.below(Horizon::ALL.len())] as u32,
        fresnel: fresnel as u32,
        edge_tint: if rng.chance(0.5) { tint } else { vec3(1.0, 1.0, 1.0) },
        opacity: rng.range(0.2, 1.0),
        coat_color: tint,
        coat_weight: if rng.chance(0.5) { rng.range(0.1, 1.0) } else { 0.0 },
        coat_roughness: if rng.chance(0.1) { 5e-4 } else { rng.range(0.1, 1.0) },
        coat_ior: rng.range(1.1, 2.0),
        fuzz_color: tint,
        fuzz_weight: if rng.chance(0.3) { rng.range(0.1, 1.0) } else { 0.0 },
        fuzz_roughness,
        film_path: film_path(film[0]),
        film_weight: film[1],
        film_ior: film[2],
        has_film: u32::from(film[1] > 0.0 && fresnel != Fresnel::None),
        reflecting_ior: if rng.chance(0.5) { rng.range(1.01, 2.5) } else { ior },
        bare_ior: ior,
        coated_ior: rng.range(1.01, 2.5),
        coat_blur: if rng.chance(0.5) { rng.range(0.0, 1.0) } else { 0.0 },
        ggx_roughness: rng.range(0.0, 1.0),
        coat_darkening: if rng.chance(0.5) { rng.range(0.0, 1.0) } else { 0.0 },
        coat_inner: rng.range(0.0, 0.9),
        coat_anisotropy: if rng.chance(0.3) { rng.range(-1.0, 1.0) } else { 0.0 },
        coat_normal_strength: 0.5,
        alpha_cutoff: if rng.chance(0.5) { rng.range(0.1, 0.6) } else { -1.0 },
        normal_strength: rng.range(-1.0, 2.0),
        flags: rng.below(16) as u32 | (rng.below(8) as u32 * COATS_BASE),
        diffuse_roughness: if rng.chance(0.5) { rng.range(0.0, 1.0) } else { 0.0 },
        ..Material::default()
    }
}

/// The adapter with the scene's buffers.
pub struct Bench {
    gpu: GpuDevice,
    layouts: [wgpu::BindGroupLayout; 2],
    layout: wgpu::PipelineLayout,
    scene: wgpu::BindGroup,
}

/// The bench, opened once for all tests.
///
/// Panics with what to install where there is no adapter: without one nothing here would be tested.
pub fn bench() -> &'static Bench {
    static BENCH: OnceLock<Result<Bench, GpuError>> = OnceLock::new();
    let opened = BENCH.get_or_init(|| Bench::open(&GpuAdapter::find(AdapterKind::Any)?, Traversal::Own));
    opened.as_ref().unwrap_or_else(|error| panic!("{error}"))
}

impl Bench {
    /// The adapter opened for rays that go this way.
    pub fn open(adapter: &GpuAdapter, traversal: Traversal) -> Result<Self, GpuError> {
        let gpu = adapter.open(traversal)?;
        println!("{} ({})", gpu.info.name, gpu.driver());
        let layout_of = |entries: &[wgpu::BindGroupLayoutEntry]| {
            gpu.device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries })
        };
        let rows_entries = [storage_entry(0, true), storage_entry(1, false)];
        let layouts = [scene_group::layout(&gpu, traversal), layout_of(&rows_entries)];
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layouts[0]), Some(&layouts[1])],
            immediate_size: 0,
        });
        let scene = upload(&gpu, &layouts[0])?;
        Ok(Self {
            gpu,
            layouts,
            layout,
            scene,
        })
    }

    /// A shader module; panics where the driver refuses it.
    pub fn module(&self, source: &str) -> wgpu::ShaderModule {
        let scope = self.gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let module = self.gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        if let Some(error) = pollster::block_on(scope.pop()) {
            panic!("{error}");
        }
        module
    }

    /// The general plan's pipeline of an entry point.
    pub fn pipeline(&self, module: &wgpu::ShaderModule, entry_point: &str) -> wgpu::ComputePipeline {
        self.gpu
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&self.layout),
                module,
                entry_point: Some(entry_point),
                compilation_options: Default::default(),
                cache: None,
            })
    }

    /// Runs an entry point over rows of inputs, 64 a workgroup: `width` words a row come out.
    pub fn run(&self, pipeline: &wgpu::ComputePipeline, rows: &[u32], count: usize, width: usize) -> Vec<u32> {
        let input = self.gpu.device.create_buffer_init(&BufferInitDescriptor {
            label: Some("rows of inputs"),
            contents: cast_slice(rows),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let output = self
            .gpu
            .empty_storage("rows of outputs", (count * width * 4) as u64)
            .unwrap();
        let group = self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.layouts[1],
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: input.as_entire_binding(),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: output.as_entire_binding(),
                },
            ],
        });
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &self.scene, &[]);
            pass.set_bind_group(1, &group, &[]);
            pass.dispatch_workgroups(count.div_ceil(64) as u32, 1, 1);
        }
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.read(&output, 0..count * width).unwrap()
    }
}

fn storage_entry(binding: u32, read_only: bool) -> wgpu::BindGroupLayoutEntry {
    entry(binding, wgpu::BufferBindingType::Storage { read_only })
}

fn entry(binding: u32, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    let ty = wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty,
        count: None,
    }
}

fn settings() -> Settings {
    Settings {
        image_size: [64, 48],
        camera: Camera::look_at([0.0, 1.0, 4.0], [0.0; 3], 30.0, 4.0 / 3.0, PixelFilter::Gaussian),
        catcher: None,
        background: BackgroundKind::Environment,
        environment_rotation: [1.0, 0.0],
        environment_strength: 1.0,
        camera_medium: None,
        first_hidden_slot: u32::MAX,
        roulette_floor: 1.0,
        rounds_surfaces: false,
        light_choice: SCENE.light_choice(),
        bounces: 8,
        least_reflections: 0,
        light_groups: 0,
        guides: 2,
        sequence: Sequence::Sobol,
        strategy: Strategy::Mis,
        seed: 0,
        first_sample: 0,
        firefly_clamp: f64::INFINITY,
    }
}

fn upload(gpu: &GpuDevice, layout: &wgpu::BindGroupLayout) -> Result<wgpu::BindGroup, GpuError> {
    let Scene {
        geometry,
        environment,
        materials,
        tables,
        lights,
        textures,
        ..
    } = &*SCENE;
    let distribution = environment.distribution(false);
    let cells_size = [distribution.width, distribution.height];
    let globals = Globals::new(&settings(), geometry, cells_size);
    let group = SceneGroup {
        geometry: GeometryArrays::new(gpu, geometry)?,
        materials: scene_group::materials(gpu, materials)?,
        tables: scene_group::tables(gpu, tables)?,
        environment: scene_group::environment(gpu, environment, distribution)?,
        light_cells: scene_group::light_cells(gpu, geometry, lights)?,
        textures: scene_group::textures(gpu, textures, None)?,
    };
    Ok(group.bind(gpu, layout, &gpu.uniforms(&globals)))
}
