//! Arrays on the GPU, uploaded in parts. In a storage buffer; or in a texture, if WebGPU's eight storage buffers per stage
//! or its 128 MiB per binding do not suffice, or if kernels compile faster with texels.

use std::{borrow::Cow, ops::Range};

use bytemuck::Pod;

use super::device::{GpuDevice, GpuError};

/// The binary logarithm of [`TEXEL_ROW`], which the shaders know.
pub const TEXEL_ROW_BITS: u32 = 12;
/// Texels per row of an array's texture, within the texture size of every adapter.
pub const TEXEL_ROW: usize = 1 << TEXEL_ROW_BITS;
/// Rows in a layer of it.
const LAYER_ROWS: usize = TEXEL_ROW;
/// Values that are made and written at once.
const PART: usize = 1 << 18;
/// Bytes of pending uploads at most; each has a staging buffer.
const PENDING_BYTES: usize = 64 << 20;

/// Plain values, made when they are asked for, so that a model is not there twice.
pub struct Values<'a, T: Pod> {
    count: usize,
    part: Box<dyn Fn(Range<usize>) -> Cow<'a, [T]> + 'a>,
}

impl<'a, T: Pod> Values<'a, T> {
    /// Values that are there already.
    pub fn of(values: &'a [T]) -> Self {
        Self {
            count: values.len(),
            part: Box::new(move |range| Cow::Borrowed(&values[range])),
        }
    }

    /// Values that are made one by one, by their number.
    pub fn made(count: usize, value: impl Fn(usize) -> T + 'a) -> Self {
        Self {
            count,
            part: Box::new(move |range| range.map(&value).collect()),
        }
    }

    /// The same values, converted.
    pub fn map<U: Pod>(self, other: impl Fn(&T) -> U + 'a) -> Values<'a, U>
    where
        T: 'a,
    {
        Values {
            count: self.count,
            part: Box::new(move |range| (self.part)(range).iter().map(&other).collect()),
        }
    }

    /// Bytes of all values.
    pub fn bytes(&self) -> u64 {
        (self.count * size_of::<T>()) as u64
    }

    /// Passes the values on in parts, each with the index of its first value. Waits for the device if much is pending.
    fn write(&self, gpu: &GpuDevice, mut write: impl FnMut(usize, &[T])) -> Result<(), GpuError> {
        let mut pending = 0;
        for first in (0..self.count).step_by(PART) {
            let part = (self.part)(first..(first + PART).min(self.count));
            write(first, &part);
            pending += size_of_val(&part[..]);
            if pending > PENDING_BYTES {
                gpu.queue.submit([]);
                gpu.wait()?;
                pending = 0;
            }
        }
        Ok(())
    }
}

/// A storage buffer of these values.
pub fn buffer<T: Pod>(gpu: &GpuDevice, what: &'static str, values: &Values<'_, T>) -> Result<wgpu::Buffer, GpuError> {
    let buffer = gpu.empty_storage(what, values.bytes())?;
    write_buffer(gpu, &buffer, 0, values)?;
    Ok(buffer)
}

/// Writes values into a storage buffer, from a place on.
pub fn write_buffer<T: Pod>(
    gpu: &GpuDevice,
    buffer: &wgpu::Buffer,
    place: usize,
    values: &Values<'_, T>,
) -> Result<(), GpuError> {
    values.write(gpu, |first, part| {
        gpu.queue.write_buffer(
            buffer,
            ((place + first) * size_of::<T>()) as u64,
            bytemuck::cast_slice(part),
        );
    })
}

/// A texture of these values, one or four words per texel: `u32`, or types of the size of several `[u32; 4]`. Shaders find
/// the texels by `texel_place`.
///
/// # Errors
///
/// [`GpuError::Lost`]. The adapter's objections to the texture are reported when the work is checked.
pub fn texture<T: Pod>(
    gpu: &GpuDevice,
    what: &'static str,
    values: &Values<'_, T>,
) -> Result<wgpu::TextureView, GpuError> {
    let texture = empty_texture::<T>(gpu, what, values.count);
    write_texture(gpu, &texture, 0, values)?;
    Ok(texture)
}

/// Bytes of a texel that holds values of a kind, or a part of one.
fn texel_bytes<T>() -> usize {
    size_of::<T>().min(16)
}

/// A texture for so many values, as [`texture`] makes them.
pub fn empty_texture<T: Pod>(gpu: &GpuDevice, what: &'static str, count: usize) -> wgpu::TextureView {
    let format = match texel_bytes::<T>() {
        4 => wgpu::TextureFormat::R32Uint,
        _ => wgpu::TextureFormat::Rgba32Uint,
    };
    let texels = (count * size_of::<T>() / texel_bytes::<T>()).max(1);
    let rows = texels.div_ceil(TEXEL_ROW);
    let is_opengl = gpu.info.backend == wgpu::Backend::Gl;
    let size = [texels.min(TEXEL_ROW), rows.min(LAYER_ROWS), layers(rows, is_opengl)];
    gpu.texture(what, size.map(|side| side as u32), format)
        .create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        })
}

/// Number of layers for a number of rows. In OpenGL, wgpu takes a single-layer texture for one without layers, and six
/// square layers for a cube: shaders would read zeros. So these get one layer more.
fn layers(rows: usize, is_opengl: bool) -> usize {
    let needed = rows.div_ceil(LAYER_ROWS);
    let is_mistaken = needed == 1 || needed.is_multiple_of(6);
    needed + usize::from(is_opengl && is_mistaken)
}

/// Writes values into an array's texture, from a place on.
pub fn write_texture<T: Pod>(
    gpu: &GpuDevice,
    texture: &wgpu::TextureView,
    place: usize,
    values: &Values<'_, T>,
) -> Result<(), GpuError> {
    let bytes_each = texel_bytes::<T>();
    values.write(gpu, |first, part| {
        let mut texel = (place + first) * size_of::<T>() / bytes_each;
        let mut rest: &[u8] = bytemuck::cast_slice(part);
        while !rest.is_empty() {
            let (line, after) = rest.split_at(rest.len().min((TEXEL_ROW - texel % TEXEL_ROW) * bytes_each));
            let row = texel / TEXEL_ROW;
            let place = [texel % TEXEL_ROW, row % LAYER_ROWS, row / LAYER_ROWS].map(|place| place as u32);
            gpu.write_texture(texture.texture(), place, [(line.len() / bytes_each) as u32, 1], line);
            (texel, rest) = (texel + line.len() / bytes_each, after);
        }
    })
}
