//! The hash of all that an image is made of: by it a batch knows what is done.

use std::{hash::Hasher as _, io::Read as _, path::Path};

use anyhow::Context;
use siphasher::sip128::{Hasher128 as _, SipHasher13};

use crate::{
    document::Document,
    scene::{Model, environment::EnvironmentSource, mesh::Mesh},
    store::project::document_text,
};

/// To be raised where the same inputs make other files than before.
const VERSION: u32 = 2;

/// A hash that grows; its numbers are the same on every machine and with every compiler.
pub struct Inputs(SipHasher13);

impl Inputs {
    pub fn new() -> Self {
        let mut inputs = Self(SipHasher13::new());
        inputs.text(env!("CARGO_PKG_VERSION"));
        inputs.text(&VERSION.to_string());
        inputs
    }

    /// Adds a text.
    pub fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }

    /// Adds bytes and how many they are.
    fn bytes(&mut self, bytes: &[u8]) {
        self.0.write(&(bytes.len() as u64).to_le_bytes());
        self.0.write(bytes);
    }

    /// Adds a document, the contents of its model, the environment's files, the user's own textures and the table of colours. Files beside the batch's file may move with
    /// it.
    pub fn document(&mut self, document: &Document, model: &Model, batch: &Path) -> anyhow::Result<()> {
        self.text(&document_text(batch, document)?);
        self.model(model);
        if let EnvironmentSource::File(path) = &document.lighting.environment {
            self.file(path)?;
        }
        for path in document.pictures() {
            // Renders go on without what is missing.
            match path.exists() {
                true => self.file(path)?,
                false => self.text("missing"),
            }
        }
        Ok(())
    }

    /// What a model is: its files may be many.
    fn model(&mut self, model: &Model) {
        self.mesh(&model.mesh);
        model.repeated.iter().for_each(|mesh| self.mesh(mesh));
        for instance in &model.instances {
            self.text(&format!("{instance:?}"));
        }
        for slot in &model.slots {
            self.text(&format!("{slot:?}"));
        }
        for texture in &model.textures {
            self.text(&format!("{texture:?}"));
            self.bytes(&texture.rgba8);
            self.bytes(bytemuck::cast_slice(&texture.rgba16));
        }
    }

    fn mesh(&mut self, mesh: &Mesh) {
        self.bytes(bytemuck::cast_slice(&mesh.positions));
        self.bytes(bytemuck::cast_slice(&mesh.normals));
        self.bytes(bytemuck::cast_slice(&mesh.uvs));
        self.bytes(bytemuck::cast_slice(&mesh.second_uvs));
        self.bytes(bytemuck::cast_slice(&mesh.colors));
        self.bytes(bytemuck::cast_slice(&mesh.tangents));
        self.bytes(bytemuck::cast_slice(&mesh.triangles));
        self.bytes(bytemuck::cast_slice(&mesh.slots));
    }

    /// A file's contents, or those of a folder's files.
    pub fn file(&mut self, path: &Path) -> anyhow::Result<()> {
        let message = || format!("{}: cannot be read; check the path and its permissions", path.display());
        if path.is_dir() {
            let entries: std::io::Result<Vec<_>> = std::fs::read_dir(path).with_context(message)?.collect();
            let mut files: Vec<_> = entries
                .with_context(message)?
                .into_iter()
                .map(|entry| entry.path())
                .collect();
            files.sort();
            return files
                .iter()
                .filter(|file| file.is_file())
                .try_for_each(|file| self.file(file));
        }
        let mut file = std::fs::File::open(path).with_context(message)?;
        let mut piece = vec![0; 1 << 16];
        loop {
            match file.read(&mut piece).with_context(message)? {
                0 => return Ok(()),
                length => self.bytes(&piece[..length]),
            }
        }
    }

    /// 32 hexadecimal digits.
    pub fn hash(&self) -> String {
        format!("{:032x}", self.0.finish128().as_u128())
    }
}
