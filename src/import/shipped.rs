//! Texture maps of the shipped materials. They are part of the program, and named as files of a folder that none has.

use std::path::Path;

use crate::scene::texture::SHIPPED;

macro_rules! maps {
    ($($file:literal)*) => { &[$(($file, include_bytes!(concat!("../../assets/maps/", $file)))),*] };
}

/// The maps by their names; `scripts/maps` makes them.
const MAPS: &[(&str, &[u8])] = maps! {
    "brushing.png" "fingerprints.png" "flakes.png" "hammered.png" "leather.png" "orange-peel.png" "weave.png"
    "weave-shade.png"
};

/// The contents of a shipped map; `None` for files.
pub fn shipped(path: &Path) -> Option<&'static [u8]> {
    let name = path.strip_prefix(SHIPPED).ok()?.to_str()?;
    MAPS.iter().find(|(map, _)| *map == name).map(|(_, bytes)| *bytes)
}
