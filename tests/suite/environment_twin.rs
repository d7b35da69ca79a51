//! The environment's WGSL functions against their Rust twins, on the first adapter there is.

use glossmith::gpu::shader::link_with;
use glossmith::optics::vector::{Vec3, vec3};
use glossmith::scene::environment::{
    Environment, environment_density, environment_direction, environment_local_from_world, environment_radiance,
    environment_sample, environment_uv, environment_world_from_local,
};
use wgpu::util::DeviceExt;

const COUNT: usize = 10_000;
/// What the shader below writes for each input.
const RESULTS: usize = 5;

const HARNESS: &str = "
    @group(1) @binding(0) var<storage, read> inputs: array<vec4f>;
    @group(1) @binding(1) var<storage, read_write> results: array<vec4f>;

    @compute @workgroup_size(64)
    fn main(@builtin(global_invocation_id) id: vec3u) {
        let size = vec2u(37u, 19u);
        let xi = inputs[2u * id.x].xyz;
        let direction = inputs[2u * id.x + 1u].xyz;
        let rotation = vec2f(0.8, 0.6);
        let drawn = environment_sample(xi, size);
        let first = 5u * id.x;
        results[first] = vec4f(drawn.direction, drawn.density);
        results[first + 1u] = vec4f(environment_radiance(direction), environment_density(direction, size));
        results[first + 2u] = vec4f(environment_uv(direction), 0.0, 0.0);
        results[first + 3u] = vec4f(environment_direction(xi.xy), 0.0);
        let turned = environment_local_from_world(direction, rotation);
        results[first + 4u] = vec4f(turned + 2.0 * environment_world_from_local(direction, rotation), 0.0);
    }";

fn map() -> Environment {
    let texels = (0..37 * 19)
        .map(|index| {
            let value = |factor: f64| (1.5 + (f64::from(index) * factor).sin()) as f32;
            [value(12.9), value(78.2), value(37.7), 1.0]
        })
        .collect();
    Environment::from_texels("waves", 37, 19, texels).expect("a sound map")
}

/// Random triples and directions, low-discrepancy, the poles and axes among them.
fn inputs() -> Vec<[f32; 4]> {
    let fraction = |index: usize, step: f64| (index as f64 * step).fract() as f32;
    (0..COUNT)
        .flat_map(|index| {
            let xi = [0.819_172_513, 0.671_043_607, 0.549_700_478].map(|step| fraction(index, step));
            let direction: Vec3<f32> = match index {
                0 => vec3(0.0, 1.0, 0.0),
                1 => vec3(0.0, -1.0, 0.0),
                2 => vec3(0.0, 0.0, 1.0),
                3 => vec3(1e-4, 1.0, -1e-4),
                _ => environment_direction([fraction(index, 0.754_877_666), fraction(index, 0.569_840_291)]),
            };
            [[xi[0], xi[1], xi[2], 0.0], [direction.x, direction.y, direction.z, 0.0]]
        })
        .collect()
}

/// Runs the harness; panics, as a test should, where there is no adapter.
fn run(environment: &Environment, inputs: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
        .expect("no GPU adapter: install mesa-vulkan-drivers");
    let (device, queue) =
        pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default())).expect("a device");
    let map = device.create_texture_with_data(
        &queue,
        &wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d {
                width: environment.width,
                height: environment.height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        bytemuck::cast_slice(&environment.texels),
    );
    let storage = |contents: &[u8]| {
        let usage = wgpu::BufferUsages::STORAGE;
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents,
            usage,
        })
    };
    let cells = storage(bytemuck::cast_slice(&environment.cells));
    let inputs = storage(bytemuck::cast_slice(inputs));
    let size = (COUNT * RESULTS * size_of::<[f32; 4]>()) as u64;
    let buffer = |usage| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage,
            mapped_at_creation: false,
        })
    };
    let results = buffer(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let readback = buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);

    let source = link_with(&["scene/environment"], HARNESS)
        .expect("modules that exist")
        .source;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: None,
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let view = map.create_view(&wgpu::TextureViewDescriptor::default());
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry {
                binding: 7,
                resource: wgpu::BindingResource::TextureView(&view),
            },
            wgpu::BindGroupEntry {
                binding: 8,
                resource: cells.as_entire_binding(),
            },
        ],
    });
    let rows = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(1),
        entries: &[
            wgpu::BindGroupEntry {
                binding: 0,
                resource: inputs.as_entire_binding(),
            },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: results.as_entire_binding(),
            },
        ],
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.set_bind_group(1, &rows, &[]);
    pass.dispatch_workgroups(COUNT.div_ceil(64) as u32, 1, 1);
    drop(pass);
    encoder.copy_buffer_to_buffer(&results, 0, &readback, 0, size);
    queue.submit([encoder.finish()]);
    readback.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapped memory"));
    device
        .poll(wgpu::PollType::wait_indefinitely())
        .expect("a device that answers");
    let bytes = readback.get_mapped_range(..).expect("mapped memory");
    bytemuck::cast_slice(&bytes).to_vec()
}

fn assert_near(found: &[f32], expected: &[f32], tolerance: f32, what: &str) {
    for (found, expected) in found.iter().zip(expected) {
        assert!(
            (found - expected).abs() <= tolerance,
            "{what}: {found} on the GPU, {expected} here"
        );
    }
}

#[test]
fn shader_and_rust_agree() {
    let environment = map();
    let inputs = inputs();
    let results = run(&environment, &inputs);
    let mut strays = 0;
    for index in 0..COUNT {
        let (xi, direction) = (inputs[2 * index], inputs[2 * index + 1]);
        let direction = vec3(direction[0], direction[1], direction[2]);
        let [drawn, looked, uv, placed, turned] = [0, 1, 2, 3, 4].map(|slot| results[RESULTS * index + slot]);

        let (expected, density) = environment_sample(&environment, vec3(xi[0], xi[1], xi[2]));
        assert_eq!(drawn[3], density, "density of sample {index}");
        assert_near(&drawn, &expected.to_f32(), 2e-5, "sampled direction");

        let radiance = environment_radiance(&environment, direction).to_f32();
        assert_near(&looked, &radiance, 1e-4 * 2.5, &format!("radiance {index}"));
        // On a border between cells rounding decides.
        strays += usize::from(looked[3] != environment_density(&environment, direction));

        let expected_uv = environment_uv(direction);
        let seam = (uv[0] - expected_uv[0]).abs() > 0.5;
        assert_near(&[uv[0] + if seam { 1.0 } else { 0.0 }], &[expected_uv[0]], 1e-5, "u");
        assert_near(&uv[1..2], &expected_uv[1..], 1e-5, "v");
        assert_near(
            &placed,
            &environment_direction([xi[0], xi[1]]).to_f32(),
            2e-5,
            "direction",
        );
        let rotation = [0.8, 0.6];
        let expected =
            environment_local_from_world(direction, rotation) + environment_world_from_local(direction, rotation) * 2.0;
        assert_near(&turned, &expected.to_f32(), 1e-6, "rotation");
    }
    assert!(strays < COUNT / 1000, "{strays} densities differ");
}
