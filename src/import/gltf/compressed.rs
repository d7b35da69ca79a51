//! Meshes that are compressed: KHR_draco_mesh_compression, EXT_meshopt_compression and KHR_meshopt_compression.

use draco_gltf::{MeshoptFilter, MeshoptMode, PackedGeometry};
use gltf::json::accessor::ComponentType;
use serde::Deserialize;
use serde_json::Value as Json;

use super::accessor::{decode, unsigned};
use super::container::{Document, MESHOPT_EXTENSIONS};
use super::draco::decompress;
use crate::parallel;
use crate::scene::report::{Fate, ImportReport};

/// Largest expansion by meshopt: factor, and additional bytes. A block of 256 equal vertices takes a few bits per byte.
const MESHOPT_GROWTH: [usize; 2] = [2048, 1 << 16];

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct MeshoptView {
    buffer: usize,
    #[serde(default)]
    byte_offset: u64,
    byte_length: u64,
    byte_stride: usize,
    count: usize,
    mode: String,
    filter: Option<String>,
}

/// Decompresses the buffer views that are compressed by meshopt.
pub(super) fn decompress_views(document: &mut Document, report: &mut ImportReport) {
    let decoded = parallel::map(document.root.buffer_views.len(), |view| meshopt_view(document, view));
    for (view, result) in decoded.into_iter().enumerate() {
        let Some(result) = result else { continue };
        match result {
            Ok(bytes) => {
                report.note(Fate::Used, "buffer views with meshopt compression", "");
                document.decompressed.insert(view, bytes);
            }
            Err(reason) => {
                let name = format!("buffer view {view}");
                report.note(Fate::Missing, format!("data with meshopt compression: {reason}"), &name);
            }
        }
    }
}

/// Bytes of a buffer view compressed by meshopt; `None` if not compressed.
fn meshopt_view(document: &Document, view: usize) -> Option<Result<Vec<u8>, String>> {
    let extensions = document.raw["bufferViews"][view].get("extensions")?;
    let found = MESHOPT_EXTENSIONS.iter().find_map(|name| extensions.get(name))?;
    Some(read_meshopt(document, found))
}

fn read_meshopt(document: &Document, extension: &Json) -> Result<Vec<u8>, String> {
    let view = MeshoptView::deserialize(extension).map_err(|error| error.to_string())?;
    let source = document
        .slice(view.buffer, view.byte_offset, view.byte_length)
        .ok_or("it reaches beyond its buffer")?;
    let size = view.count.checked_mul(view.byte_stride).ok_or("it is too large")?;
    let [growth, floor] = MESHOPT_GROWTH;
    if size > source.len().saturating_mul(growth).saturating_add(floor) {
        return Err(format!("{} bytes cannot hold {size}", source.len()));
    }
    let text = |error: draco_gltf::GltfError| error.to_string();
    let mode = MeshoptMode::from_name(&view.mode).map_err(text)?;
    let filter = MeshoptFilter::from_name(view.filter.as_deref().unwrap_or("NONE")).map_err(text)?;
    let mut bytes = vec![0; size];
    draco_gltf::meshopt::decode_buffer_view(&mut bytes, source, mode, filter, view.count, view.byte_stride)
        .map_err(text)?;
    Ok(bytes)
}

/// A primitive that was compressed by Draco.
pub(super) struct DracoPrimitive(PackedGeometry);

impl DracoPrimitive {
    /// Decompresses a primitive from its JSON; `None` if not compressed.
    pub(super) fn read(document: &Document, primitive: &Json) -> Option<Result<Self, String>> {
        let extension = primitive.get("extensions")?.get("KHR_draco_mesh_compression")?;
        Some(decompress(document, primitive, extension).map(Self))
    }

    /// The corners of the triangles.
    pub(super) fn indices(&self) -> Vec<u32> {
        let indices = self.0.indices();
        indices.map_or_else(Vec::new, |indices| unsigned(ComponentType::U32, indices.bytes()))
    }

    /// An attribute with its components; `None` if stored elsewhere.
    pub(super) fn attribute<const N: usize>(&self, semantic: &str) -> Option<Vec<[f32; N]>> {
        let attribute = self.0.attributes().iter().find(|known| known.semantic() == semantic)?;
        let component = component_type(attribute.component_type())?;
        let (size, components) = (component.size(), usize::from(attribute.components()));
        let vector = |element: &[u8]| {
            let number = |i: usize| decode(component, attribute.normalized(), &element[i * size..(i + 1) * size]);
            // A colour without opacity is opaque.
            std::array::from_fn(|i| if i < components { number(i) } else { 1.0 })
        };
        Some(attribute.bytes().chunks_exact(components * size).map(vector).collect())
    }
}

fn component_type(of_crate: draco_gltf::ComponentType) -> Option<ComponentType> {
    Some(match of_crate {
        draco_gltf::ComponentType::I8 => ComponentType::I8,
        draco_gltf::ComponentType::U8 => ComponentType::U8,
        draco_gltf::ComponentType::I16 => ComponentType::I16,
        draco_gltf::ComponentType::U16 => ComponentType::U16,
        draco_gltf::ComponentType::U32 => ComponentType::U32,
        draco_gltf::ComponentType::F32 => ComponentType::F32,
        _ => return None,
    })
}
