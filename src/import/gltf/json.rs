//! What is read of a file's JSON, by the names of the format. What a file leaves out has its default; indices may be out of
//! range, and are checked where they are used.

use std::collections::HashMap;

use serde::Deserialize;
use serde_json::Value as Json;

macro_rules! parts {
    ($($(#[$doc:meta])* $name:ident { $($field:ident: $kind:ty,)* })*) => {$(
        $(#[$doc])*
        #[derive(Debug, Default, Deserialize)]
        #[serde(default, rename_all = "camelCase")]
        pub(super) struct $name { $(pub $field: $kind,)* }
    )*};
}

parts! {
    /// All of a file.
    Root {
        extensions_used: Vec<String>,
        extensions_required: Vec<String>,
        extensions: Json,
        scene: usize,
        scenes: Vec<Scene>,
        nodes: Vec<Node>,
        cameras: Vec<Camera>,
        skins: Vec<Skin>,
        animations: Vec<Animation>,
        meshes: Vec<Mesh>,
        materials: Vec<Json>,
        textures: Vec<Texture>,
        samplers: Vec<Sampler>,
        images: Vec<Image>,
        accessors: Vec<Accessor>,
        buffer_views: Vec<BufferView>,
        buffers: Vec<Buffer>,
    }
    /// The same as far as every version of the format has it.
    AnyVersion { asset: Asset, }
    Asset { version: String, }
    Scene { name: Option<String>, nodes: Vec<usize>, }
    Node {
        name: Option<String>,
        children: Vec<usize>,
        matrix: Option<[f32; 16]>,
        translation: [f32; 3],
        rotation: Option<[f32; 4]>,
        scale: Option<[f32; 3]>,
        mesh: Option<usize>,
        weights: Vec<f32>,
        skin: Option<usize>,
        camera: Option<usize>,
        extensions: Json,
    }
    Camera { name: Option<String>, perspective: Option<Perspective>, orthographic: Option<Orthographic>, }
    Perspective { yfov: f32, aspect_ratio: Option<f32>, }
    Orthographic { ymag: f32, }
    Skin { inverse_bind_matrices: Option<usize>, joints: Vec<usize>, }
    Animation { channels: Vec<Channel>, samplers: Vec<Curve>, }
    Channel { sampler: usize, target: Target, }
    Target { node: Option<usize>, path: String, }
    Curve { input: usize, output: usize, interpolation: String, }
    Mesh { name: Option<String>, primitives: Vec<Primitive>, weights: Vec<f32>, }
    Primitive {
        attributes: HashMap<String, usize>,
        indices: Option<usize>,
        material: Option<usize>,
        mode: Option<u32>,
        targets: Vec<HashMap<String, usize>>,
        extensions: Json,
    }
    Texture { source: Option<usize>, sampler: Option<usize>, extensions: Json, }
    Sampler { mag_filter: u32, wrap_s: u32, wrap_t: u32, }
    Image { name: Option<String>, uri: Option<String>, buffer_view: Option<usize>, }
    Accessor {
        buffer_view: Option<usize>,
        byte_offset: usize,
        component_type: u32,
        normalized: bool,
        count: usize,
        r#type: String,
        sparse: Option<Sparse>,
    }
    Sparse { count: usize, indices: SparsePart, values: SparsePart, }
    SparsePart { buffer_view: usize, byte_offset: usize, component_type: u32, }
    BufferView {
        buffer: usize,
        byte_offset: usize,
        byte_length: usize,
        byte_stride: usize,
        extensions: Json,
    }
    Buffer { byte_length: u64, uri: Option<String>, extensions: Json, }
}
