//! Meshes that are compressed by Draco (KHR_draco_mesh_compression), decoded by the draco-gltf crate.

use draco_gltf::PackedGeometry;
use serde_json::Value as Json;

use super::container::Document;

/// A primitive's geometry, given as its JSON and that of its extension.
#[cfg(feature = "draco")]
pub(super) fn decompress(document: &Document, primitive: &Json, extension: &Json) -> Result<PackedGeometry, String> {
    use draco_gltf::{DecodeLimits, DracoPrimitiveContract, DracoPrimitiveExtension};
    /// Largest expansion: factor, and additional bytes. The entropy coder needs almost nothing for predictable data.
    const GROWTH: [u64; 2] = [4096, 1 << 20];
    let text = extension.to_string();
    let value = draco_gltf::JsonValue::parse(text.as_bytes())?;
    let extension = DracoPrimitiveExtension::from_json(&value).map_err(|error| error.to_string())?;
    let payload = document
        .view(extension.buffer_view())
        .map_err(|error| error.to_string())?;
    let most = GROWTH[0] * payload.len() as u64 + GROWTH[1];
    let limits = DecodeLimits::default()
        .with_max_points(most / 4)
        .with_max_faces(most / 4)
        .with_max_decoded_bytes(most);
    let mut contract = DracoPrimitiveContract::new().with_limits(limits);
    // Only the normalisation is used: counts in accessors are often wrong, and never needed.
    for (semantic, _) in extension.attributes() {
        let accessor = primitive["attributes"][semantic].as_u64();
        let accessor = accessor.and_then(|index| document.root.accessors.get(usize::try_from(index).ok()?));
        contract = contract.with_attribute(semantic, 0, accessor.is_some_and(|accessor| accessor.normalized));
    }
    // The crate may panic on a damaged stream.
    crate::panics::contained(|| extension.decode(&payload, &contract))
        .ok_or("its stream contradicts itself")?
        .map_err(|error| error.to_string())
}

/// Says that the program was built without.
#[cfg(not(feature = "draco"))]
pub(super) fn decompress(_: &Document, _: &Json, _: &Json) -> Result<PackedGeometry, String> {
    Err("this program was built without Draco (the feature `draco`)".to_owned())
}
