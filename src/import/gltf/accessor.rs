//! Numbers out of buffers, with every range checked.

use super::{container::Document, json::Sparse};

/// Elements that an accessor may have without any bytes behind them.
const MAX_ZEROS: usize = 1 << 24;

const I8: u32 = 5120;
const U8: u32 = 5121;
const I16: u32 = 5122;
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

/// Bytes of a component; `None` for an unknown type.
pub fn component_size(component: u32) -> Option<usize> {
    match component {
        I8 | U8 => Some(1),
        I16 | U16 => Some(2),
        U32 | F32 => Some(4),
        _ => None,
    }
}

impl Document {
    /// Elements of a vector accessor as f32; normalised integers become fractions. Colours may lack their opacity.
    pub fn read_vectors<const N: usize>(&self, accessor: usize, what: &str) -> Result<Vec<[f32; N]>, String> {
        let found = self.read_elements(accessor, what)?;
        if found.components != N && !(found.components == 3 && what.starts_with("COLOR_")) {
            return Err(format!("accessor {accessor} ({what}) does not have {N} components"));
        }
        Ok(found.vectors())
    }

    /// The elements of a scalar accessor of unsigned integers.
    pub fn read_indices(&self, accessor: usize) -> Result<Vec<u32>, String> {
        let found = self.read_elements(accessor, "indices")?;
        match (found.components, found.component) {
            (1, U8 | U16 | U32) => Ok(unsigned(&found.bytes, found.component_size)),
            _ => Err(format!("accessor {accessor} (indices) does not hold unsigned integers")),
        }
    }

    /// The elements without gaps, sparse ones put in.
    fn read_elements(&self, index: usize, what: &str) -> Result<Elements, String> {
        let invalid = |reason: &str| format!("accessor {index} ({what}) {reason}");
        let accessor = self
            .root
            .accessors
            .get(index)
            .ok_or_else(|| invalid("does not exist"))?;
        // Small byte matrices have column gaps; none are read here.
        let components = match accessor.r#type.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            _ => return Err(invalid("is of unknown type")),
        };
        let (component, count) = (accessor.component_type, accessor.count);
        let component_size = component_size(component).ok_or_else(|| invalid("is of unknown type"))?;
        let size = component_size * components;
        let mut bytes = match accessor.buffer_view {
            Some(view) => self
                .strided(view, accessor.byte_offset, count, size)
                .ok_or_else(|| invalid("reaches beyond its data"))?,
            None if count <= MAX_ZEROS => vec![0; count * size],
            None => return Err(invalid("is too large")),
        };
        if let Some(sparse) = &accessor.sparse {
            self.put_sparse(sparse, size, &mut bytes)
                .ok_or_else(|| invalid("has sparse values out of range"))?;
        }
        let normalized = accessor.normalized;
        Ok(Elements {
            component,
            component_size,
            components,
            normalized,
            bytes,
        })
    }

    /// `count` elements of `size` bytes without gaps; `None` if beyond the view.
    fn strided(&self, view: usize, offset: usize, count: usize, size: usize) -> Option<Vec<u8>> {
        let stride = match self.root.buffer_views.get(view)?.byte_stride {
            0 => size,
            stride => stride,
        };
        let view = self.view(view).ok()?;
        let bytes = view.get(offset..)?;
        let Some(last) = count.checked_sub(1) else {
            return Some(Vec::new());
        };
        let end = last.checked_mul(stride)?.checked_add(size)?;
        // Overlapping elements would let a small file demand any amount of memory.
        let bytes = bytes.get(..end).filter(|_| stride >= size)?;
        Some(bytes.chunks(stride).flat_map(|chunk| &chunk[..size]).copied().collect())
    }

    fn put_sparse(&self, sparse: &Sparse, size: usize, elements: &mut [u8]) -> Option<()> {
        let Sparse { count, indices, values } = sparse;
        let component_size = component_size(indices.component_type)?;
        let places = self.strided(indices.buffer_view, indices.byte_offset, *count, component_size)?;
        let values = self.strided(values.buffer_view, values.byte_offset, *count, size)?;
        let places = unsigned(&places, component_size);
        for (place, value) in places.into_iter().zip(values.chunks_exact(size)) {
            let start = (place as usize).checked_mul(size)?;
            elements
                .get_mut(start..start.checked_add(size)?)?
                .copy_from_slice(value);
        }
        Some(())
    }
}

/// Little-endian numbers, so many to an element.
pub struct Elements<B = Vec<u8>> {
    /// Their type, as the format numbers it.
    pub component: u32,
    pub component_size: usize,
    pub components: usize,
    pub normalized: bool,
    pub bytes: B,
}

impl<B: AsRef<[u8]>> Elements<B> {
    /// The elements as f32; a component that they lack is 1.
    pub fn vectors<const N: usize>(&self) -> Vec<[f32; N]> {
        let size = self.component_size;
        let vector = |element: &[u8]| {
            let number = |i: usize| element.get(i * size..(i + 1) * size);
            std::array::from_fn(|i| number(i).map_or(1.0, |bytes| self.decode(bytes)))
        };
        let elements = self.bytes.as_ref().chunks_exact(self.components * size);
        elements.map(vector).collect()
    }

    #[inline]
    fn decode(&self, bytes: &[u8]) -> f32 {
        let scale = |value: f32, largest: f32| {
            if self.normalized {
                (value / largest).max(-1.0)
            } else {
                value
            }
        };
        match (self.component, bytes) {
            (F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
            (U32, &[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]) as f32,
            (U16, &[a, b]) => scale(f32::from(u16::from_le_bytes([a, b])), 65535.0),
            (I16, &[a, b]) => scale(f32::from(i16::from_le_bytes([a, b])), 32767.0),
            (U8, &[a]) => scale(f32::from(a), 255.0),
            (I8, &[a]) => scale(f32::from(a as i8), 127.0),
            _ => 0.0,
        }
    }
}

/// Little-endian unsigned integers of so many bytes.
pub fn unsigned(bytes: &[u8], size: usize) -> Vec<u32> {
    let number = |bytes: &[u8]| {
        bytes
            .iter()
            .rev()
            .fold(0, |number, byte| number << 8 | u32::from(*byte))
    };
    bytes.chunks_exact(size).map(number).collect()
}
