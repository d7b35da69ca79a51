//! Meshes that are compressed: KHR_draco_mesh_compression, EXT_meshopt_compression and KHR_meshopt_compression, by the
//! draco-gltf crate.

use draco_gltf::{MeshoptFilter, MeshoptMode, PackedGeometry};
use serde::Deserialize;
use serde_json::Value as Json;

use super::{
    accessor::{Elements, component_size, unsigned},
    container::{Document, MESHOPT_EXTENSIONS},
    json::Primitive,
};
use crate::parallel;
use crate::scene::report::{Fate, ImportReport};

/// Largest expansion by meshopt: factor, and additional bytes. A block of 256 equal vertices takes a few bits per byte.
const MESHOPT_GROWTH: [usize; 2] = [2048, 1 << 16];

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct MeshoptView {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: usize,
    count: usize,
    mode: String,
    filter: Option<String>,
}

/// Decompresses the buffer views that are compressed by meshopt.
pub fn decompress_views(document: &mut Document, report: &mut ImportReport) {
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
    let extensions = &document.root.buffer_views[view].extensions;
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
pub struct DracoPrimitive(PackedGeometry);

impl DracoPrimitive {
    /// Decompresses a primitive; `None` if not compressed.
    pub fn read(document: &Document, primitive: &Primitive) -> Option<Result<Self, String>> {
        let extension = primitive.extensions.get("KHR_draco_mesh_compression")?;
        Some(decompress(document, primitive, extension).map(Self))
    }

    /// The corners of the triangles.
    pub fn indices(&self) -> Vec<u32> {
        self.0
            .indices()
            .map_or_else(Vec::new, |indices| unsigned(indices.bytes(), 4))
    }

    /// An attribute with its components; `None` if stored elsewhere.
    pub fn attribute<const N: usize>(&self, semantic: &str) -> Option<Vec<[f32; N]>> {
        let attribute = self.0.attributes().iter().find(|known| known.semantic() == semantic)?;
        let component = attribute.component_type() as u32;
        let elements = Elements {
            component,
            component_size: component_size(component)?,
            components: attribute.components().into(),
            normalized: attribute.normalized(),
            bytes: attribute.bytes(),
        };
        Some(elements.vectors())
    }
}

/// A primitive's geometry, given with its extension.
#[cfg(feature = "draco")]
pub fn decompress(document: &Document, primitive: &Primitive, extension: &Json) -> Result<PackedGeometry, String> {
    use draco_gltf::{DecodeLimits, DracoPrimitiveContract, DracoPrimitiveExtension};
    /// Largest expansion: factor, and additional bytes. The entropy coder needs almost nothing for predictable data.
    const GROWTH: [u64; 2] = [4096, 1 << 20];
    let text = extension.to_string();
    let value = draco_gltf::JsonValue::parse(text.as_bytes())?;
    let extension = DracoPrimitiveExtension::from_json(&value).map_err(|error| error.to_string())?;
    let payload = document.view(extension.buffer_view())?;
    let most = GROWTH[0] * payload.len() as u64 + GROWTH[1];
    let limits = DecodeLimits::default()
        .with_max_points(most / 4)
        .with_max_faces(most / 4)
        .with_max_decoded_bytes(most);
    let mut contract = DracoPrimitiveContract::new().with_limits(limits);
    // Only the normalisation is used: counts in accessors are often wrong, and never needed.
    for (semantic, _) in extension.attributes() {
        let accessor = primitive.attributes.get(semantic);
        let accessor = accessor.and_then(|index| document.root.accessors.get(*index));
        contract = contract.with_attribute(semantic, 0, accessor.is_some_and(|accessor| accessor.normalized));
    }
    // The crate may panic on a damaged stream.
    crate::panics::contained(|| extension.decode(&payload, &contract))
        .ok_or("its stream contradicts itself")?
        .map_err(|error| error.to_string())
}

/// Says that the program was built without.
#[cfg(not(feature = "draco"))]
pub fn decompress(_: &Document, _: &Primitive, _: &Json) -> Result<PackedGeometry, String> {
    Err("this program was built without Draco (the feature `draco`)".to_owned())
}
