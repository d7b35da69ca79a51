//! Numbers out of buffers, with every range checked.

use gltf::json;
use json::accessor::{ComponentType, Type};
use json::validation::Checked;

use super::container::Document;
use crate::model_error::ModelError;

/// Elements that an accessor may have without any bytes behind them.
const MAX_ZEROS: usize = 1 << 24;

impl Document {
    /// Elements of a vector accessor as f32; normalised integers become fractions.
    pub fn read_vectors<const N: usize>(&self, accessor: usize, what: &str) -> Result<Vec<[f32; N]>, ModelError> {
        let (component, normalized, bytes) = self.read_elements(accessor, N, what)?;
        let size = component.size();
        let number = |bytes: &[u8]| decode(component, normalized, bytes);
        let vector = |element: &[u8]| std::array::from_fn(|i| number(&element[i * size..(i + 1) * size]));
        Ok(bytes.chunks_exact(N * size).map(vector).collect())
    }

    /// Elements of an accessor of three or four components; a missing fourth is 1.
    pub fn read_colors(&self, accessor: usize, what: &str) -> Result<Vec<[f32; 4]>, ModelError> {
        let is_vec3 =
            self.root.accessors.get(accessor).map(|accessor| accessor.type_) == Some(Checked::Valid(Type::Vec3));
        if !is_vec3 {
            return self.read_vectors(accessor, what);
        }
        let colors = self.read_vectors::<3>(accessor, what)?;
        Ok(colors.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect())
    }

    /// The elements of a vector accessor of unsigned integers, which may be floats in old files.
    pub fn read_unsigned<const N: usize>(&self, accessor: usize, what: &str) -> Result<Vec<[u32; N]>, ModelError> {
        let (component, _, bytes) = self.read_elements(accessor, N, what)?;
        let size = component.size();
        let vector = |element: &[u8]| {
            std::array::from_fn(|i| decode(component, false, &element[i * size..(i + 1) * size]) as u32)
        };
        Ok(bytes.chunks_exact(N * size).map(vector).collect())
    }

    /// The matrices of an accessor, column by column.
    pub fn read_matrices(&self, accessor: usize, what: &str) -> Result<Vec<[f32; 16]>, ModelError> {
        self.read_vectors(accessor, what)
    }

    /// The elements of a scalar accessor of unsigned integers.
    pub fn read_indices(&self, accessor: usize) -> Result<Vec<u32>, ModelError> {
        let (component, _, bytes) = self.read_elements(accessor, 1, "indices")?;
        match component {
            ComponentType::U8 | ComponentType::U16 | ComponentType::U32 => Ok(unsigned(component, &bytes)),
            _ => Err(self.invalid(format!("accessor {accessor} (indices) does not hold unsigned integers"))),
        }
    }

    /// The component type, whether integers are normalised, and the elements without gaps, sparse ones put in.
    fn read_elements(
        &self,
        index: usize,
        components: usize,
        what: &str,
    ) -> Result<(ComponentType, bool, Vec<u8>), ModelError> {
        let invalid = |reason: &str| self.invalid(format!("accessor {index} ({what}) {reason}"));
        let accessor = self
            .root
            .accessors
            .get(index)
            .ok_or_else(|| invalid("does not exist"))?;
        let (Checked::Valid(component), Checked::Valid(kind)) = (accessor.component_type, accessor.type_) else {
            return Err(invalid("is of unknown type"));
        };
        // Small byte matrices have column gaps; none are read here.
        let is_vector = matches!(kind, Type::Scalar | Type::Vec2 | Type::Vec3 | Type::Vec4 | Type::Mat4);
        if !is_vector || kind.multiplicity() != components {
            return Err(invalid(&format!("does not have {components} components")));
        }
        let size = component.0.size() * components;
        let count = usize::try_from(accessor.count.0).map_err(|_| invalid("is too large"))?;
        let mut elements = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                self.strided(view.value(), offset, count, size)
                    .ok_or_else(|| invalid("reaches beyond its data"))?
            }
            None if count <= MAX_ZEROS => vec![0; count * size],
            None => return Err(invalid("is too large")),
        };
        if let Some(sparse) = &accessor.sparse {
            self.put_sparse(sparse, size, &mut elements)
                .ok_or_else(|| invalid("has sparse values out of range"))?;
        }
        Ok((component.0, accessor.normalized, elements))
    }

    /// `count` elements of `size` bytes without gaps; `None` if beyond the view.
    fn strided(&self, view: usize, offset: u64, count: usize, size: usize) -> Option<Vec<u8>> {
        let stride = self
            .root
            .buffer_views
            .get(view)?
            .byte_stride
            .map_or(0, |stride| stride.0);
        let stride = if stride == 0 { size } else { stride };
        let view = self.view(view).ok()?;
        let bytes = view.get(usize::try_from(offset).ok()?..)?;
        let Some(last) = count.checked_sub(1) else {
            return Some(Vec::new());
        };
        let end = last.checked_mul(stride)?.checked_add(size)?;
        // Overlapping elements would let a small file demand any amount of memory.
        let bytes = bytes.get(..end).filter(|_| stride >= size)?;
        Some(bytes.chunks(stride).flat_map(|chunk| &chunk[..size]).copied().collect())
    }

    fn put_sparse(&self, sparse: &json::accessor::sparse::Sparse, size: usize, elements: &mut [u8]) -> Option<()> {
        let count = usize::try_from(sparse.count.0).ok()?;
        let Checked::Valid(component) = sparse.indices.component_type else {
            return None;
        };
        let indices = &sparse.indices;
        let places = self.strided(
            indices.buffer_view.value(),
            indices.byte_offset.0,
            count,
            component.0.size(),
        )?;
        let values = self.strided(
            sparse.values.buffer_view.value(),
            sparse.values.byte_offset.0,
            count,
            size,
        )?;
        for (place, value) in unsigned(component.0, &places)
            .into_iter()
            .zip(values.chunks_exact(size))
        {
            let start = (place as usize).checked_mul(size)?;
            elements
                .get_mut(start..start.checked_add(size)?)?
                .copy_from_slice(value);
        }
        Some(())
    }
}

/// Little-endian unsigned integers of a component type's size.
pub(super) fn unsigned(component: ComponentType, bytes: &[u8]) -> Vec<u32> {
    let number = |bytes: &[u8]| {
        bytes
            .iter()
            .rev()
            .fold(0, |number, byte| number << 8 | u32::from(*byte))
    };
    bytes.chunks_exact(component.size()).map(number).collect()
}

/// One little-endian component.
pub(super) fn decode(component: ComponentType, normalized: bool, bytes: &[u8]) -> f32 {
    let scale = |value: f32, largest: f32| {
        if normalized { (value / largest).max(-1.0) } else { value }
    };
    match (component, bytes) {
        (ComponentType::F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
        (ComponentType::U32, &[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]) as f32,
        (ComponentType::U16, &[a, b]) => scale(f32::from(u16::from_le_bytes([a, b])), 65535.0),
        (ComponentType::I16, &[a, b]) => scale(f32::from(i16::from_le_bytes([a, b])), 32767.0),
        (ComponentType::U8, &[a]) => scale(f32::from(a), 255.0),
        (ComponentType::I8, &[a]) => scale(f32::from(a as i8), 127.0),
        _ => 0.0,
    }
}
