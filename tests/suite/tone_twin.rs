//! The tone curves' WGSL functions against their Rust twins, on the first adapter there is.

use glossmith::optics::tone::{ToneCurve, linear_from_srgb, srgb_from_linear, tone_map};
use glossmith::optics::vector::Vec3;
use wgpu::util::DeviceExt;

const COUNT: usize = 10_000;

/// Writes, for each input, each curve's outcome in the order of the registry, then the two encodings.
const HARNESS: &str = "
    @group(0) @binding(0) var<storage, read> inputs: array<vec4f>;
    @group(0) @binding(1) var<storage, read_write> results: array<vec4f>;

    @compute @workgroup_size(64)
    fn main(@builtin(global_invocation_id) id: vec3u) {
        if id.x >= arrayLength(&inputs) {
            return;
        }
        let color = inputs[id.x].xyz;
        let first = 6u * id.x;
        results[first] = vec4f(tone_map(TONE_AGX, color), 0.0);
        results[first + 1u] = vec4f(tone_map(TONE_ACES, color), 0.0);
        results[first + 2u] = vec4f(tone_map(TONE_PBR_NEUTRAL, color), 0.0);
        results[first + 3u] = vec4f(tone_map(TONE_NONE, color), 0.0);
        results[first + 4u] = vec4f(srgb_from_linear(saturate(color)), 0.0);
        results[first + 5u] = vec4f(linear_from_srgb(saturate(color)), 0.0);
    }";

/// Colours over 30 stops, negative channels among them.
fn inputs() -> Vec<[f32; 4]> {
    let fraction = |index: usize, step: f64| (index as f64 * step).fract();
    let channel = |index: usize, step: f64| ((30.0 * fraction(index, step) - 16.0).exp2() - 1e-3) as f32;
    let steps = [0.819_172_513, 0.671_043_607, 0.549_700_478];
    (0..COUNT)
        .map(|index| {
            let [r, g, b] = steps.map(|step| channel(index, step));
            [r, g, b, 0.0]
        })
        .collect()
}

/// Runs the harness; panics, as a test should, where there is no adapter.
fn run(inputs: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
        .expect("no GPU adapter: install mesa-vulkan-drivers");
    let (device, queue) =
        pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default())).expect("a device");
    let colors = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: None,
        contents: bytemuck::cast_slice(inputs),
        usage: wgpu::BufferUsages::STORAGE,
    });
    let size = (6 * size_of_val(inputs)) as u64;
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
    let source = include_str!("../../shaders/optics/tone.wgsl").to_owned() + HARNESS;
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
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry {
                binding: 0,
                resource: colors.as_entire_binding(),
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

#[test]
fn shader_and_rust_agree() {
    let inputs = inputs();
    let results = run(&inputs);
    for (index, [r, g, b, _]) in inputs.into_iter().enumerate() {
        let color = Vec3::from_f32([r, g, b]);
        let shown = color.map(|x: f32| x.clamp(0.0, 1.0));
        let mut expected: Vec<Vec3<f32>> = ToneCurve::ALL.iter().map(|&curve| tone_map(curve, color)).collect();
        expected.extend([srgb_from_linear(shown), linear_from_srgb(shown)]);
        for (which, expected) in expected.iter().enumerate() {
            let found = results[6 * index + which];
            for (found, expected) in found.into_iter().zip(expected.to_f32()) {
                // A hundredth of what 8 bits can show.
                assert!(
                    (found - expected).abs() < 4e-5,
                    "{which} of {color:?}: {found} instead of {expected}"
                );
            }
        }
    }
}
