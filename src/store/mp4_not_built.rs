//! In place of the MP4 encoder, where the program is built without the feature `video`.

/// Whether this program can write them.
pub const IS_BUILT: bool = false;

/// Frames as H.264: there are none.
pub enum Mp4 {}

impl Mp4 {
    pub fn new(_size: [u32; 2], _fps: f64) -> Result<Self, String> {
        Err("this program was built without H.264".to_owned())
    }

    pub fn add(&mut self, _size: [u32; 2], _rgba: &[u8]) -> Result<(), String> {
        match *self {}
    }

    pub fn bytes(self) -> Result<Vec<u8>, String> {
        match self {}
    }
}
