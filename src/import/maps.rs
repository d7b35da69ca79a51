//! Textures of formats that name an image for each parameter: every image is read once, and those of numbers are put together.

use std::{borrow::Cow, collections::HashMap, collections::HashSet};

use crate::{
    files::Files,
    picture::Encoded,
    scene::{
        AlphaMode, ModelOptions, Slot, Texture, TextureRef,
        report::{Fate, ImportReport},
        texture::{TextureTarget, TextureValues},
    },
};

/// A channel of a texture: the texture, and the number that its texel stands for.
type Channel = (usize, fn([u8; 4]) -> u8);

/// A texture of a target; the number that its texel stands for if it is no colour.
pub type Part = (TextureTarget, TextureRef, fn([u8; 4]) -> u8);

/// The images that materials have asked for so far.
pub struct Maps<'a> {
    files: &'a Files,
    side_max: u32,
    /// Textures by name, and whether they hold colours; `None` if they can't be read.
    known: HashMap<(String, bool), Option<usize>>,
    /// Textures by the channels that they are made of.
    made: HashMap<[Option<(usize, usize)>; 4], usize>,
    textures: Vec<Texture>,
}

impl<'a> Maps<'a> {
    pub fn new(files: &'a Files, options: &ModelOptions) -> Self {
        Self {
            files,
            side_max: options.texture_side_max,
            known: HashMap::new(),
            made: HashMap::new(),
            textures: Vec::new(),
        }
    }

    /// The image in the model's file, or in the first file that is there; `None`, and reported, if it can't be read.
    pub fn image(
        &mut self,
        names: &[&str],
        embedded: Option<&[u8]>,
        is_color: bool,
        report: &mut ImportReport,
    ) -> Option<usize> {
        let name = names.first().copied().unwrap_or("an image without a name");
        let key = (name.to_owned(), is_color);
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let bytes = match embedded {
            Some(bytes) => Ok(Cow::Borrowed(bytes)),
            None => self.read(names).map(Cow::Owned),
        };
        let budget = &self.files.import.budget;
        let scaled = bytes.and_then(|bytes| {
            let name = name.to_owned();
            Encoded { name, bytes }
                .texture(is_color, self.side_max, budget)?
                .within(budget)
        });
        let texture = match scaled {
            Ok(scaled) => {
                scaled.report(report);
                Some(self.push(scaled.texture))
            }
            Err(reason) => {
                report.note(Fate::Missing, format!("a texture, grey instead ({reason})"), name);
                None
            }
        };
        self.known.insert(key, texture);
        texture
    }

    /// The first of these files that can be read, or what is wrong with the first.
    fn read(&self, names: &[&str]) -> Result<Vec<u8>, String> {
        let mut wrong = None;
        for name in names {
            match self.files.read(name) {
                Ok(bytes) => return Ok(bytes),
                Err(error) => wrong = wrong.or(Some(error.to_string())),
            }
        }
        Err(wrong.unwrap_or_else(|| "it names no file".to_owned()))
    }

    fn push(&mut self, texture: Texture) -> usize {
        self.textures.push(texture);
        self.textures.len() - 1
    }

    pub fn get(&self, texture: usize) -> &Texture {
        &self.textures[texture]
    }

    /// A texture of channels of others, as large as the largest; 1 where none is given.
    fn packed(&mut self, channels: [Option<Channel>; 4]) -> Result<usize, String> {
        let key = channels.map(|channel| channel.map(|(texture, code)| (texture, code as usize)));
        if let Some(known) = self.made.get(&key) {
            return Ok(*known);
        }
        let sources = || channels.iter().flatten().map(|(texture, _)| &self.textures[*texture]);
        let [width, height] = sources().fold([1; 2], |[width, height], source| {
            [width.max(source.width), height.max(source.height)]
        });
        let mut names: Vec<&str> = sources().map(|source| source.name.as_str()).collect();
        names.dedup();
        let name = names.join(" + ");
        let bytes = 4 * u64::from(width) * u64::from(height);
        self.files.import.budget.take(bytes).map_err(|over| over.to_string())?;
        let texel = |place: u64| {
            let (x, y) = (place % u64::from(width), place / u64::from(width));
            channels.map(|channel| {
                let Some((texture, code)) = channel else { return u8::MAX };
                let source = &self.textures[texture];
                let nearest = |at: u64, from: u32, to: u32| (at * u64::from(to) / u64::from(from)) as usize;
                let row = nearest(y, height, source.height) * source.width as usize;
                let texel = source
                    .rgba8
                    .as_chunks::<4>()
                    .0
                    .get(row + nearest(x, width, source.width));
                texel.map_or(u8::MAX, |texel| code(*texel))
            })
        };
        let rgba8 = (0..bytes / 4).flat_map(texel).collect();
        let texture = self.push(Texture {
            name,
            width,
            height,
            rgba8,
            rgba16: Vec::new(),
        });
        self.made.insert(key, texture);
        Ok(texture)
    }

    /// Gives a slot its textures: those that share one are put together.
    pub fn put(&mut self, parts: &[Part], slot: &mut Slot, report: &mut ImportReport) {
        for home in TextureTarget::ALL.iter().filter(|target| target.home() == **target) {
            let mut of_home = parts.iter().filter(|(target, ..)| target.home() == *home).peekable();
            let Some((_, place, _)) = of_home.peek().copied() else {
                continue;
            };
            let mut channels: [Option<Channel>; 4] = [None; 4];
            let (mut is_packed, mut sources) = (false, HashSet::new());
            for (target, part, code) in of_home {
                sources.insert(part.texture);
                let is_elsewhere = TextureRef { texture: 0, ..*part } != TextureRef { texture: 0, ..*place };
                if is_elsewhere {
                    report.note(
                        Fate::Approximated,
                        "a texture, placed as another of its material",
                        &slot.name,
                    );
                }
                let texture = part.texture;
                match target.values() {
                    TextureValues::Number(channel) => {
                        is_packed = true;
                        channels[channel] = Some((texture, *code));
                    }
                    _ => {
                        let texel: [fn([u8; 4]) -> u8; 3] = [|t| t[0], |t| t[1], |t| t[2]];
                        for (channel, code) in channels.iter_mut().zip(texel) {
                            *channel = Some((texture, code));
                        }
                    }
                }
            }
            if *home == TextureTarget::Roughness && sources.len() == 1 && channels[1].is_some() && channels[2].is_some()
            {
                // One image for both has them in channels of their own.
                let texture = place.texture;
                channels = [None, Some((texture, |t| t[1])), Some((texture, |t| t[2])), None];
            }
            let texture = if is_packed {
                self.packed(channels)
            } else {
                Ok(place.texture)
            };
            match texture {
                Ok(texture) => *slot.texture_mut(*home) = Some(TextureRef { texture, ..*place }),
                Err(reason) => report.note(Fate::Missing, format!("a texture ({reason})"), &slot.name),
            }
        }
        if parts.iter().any(|(target, ..)| *target == TextureTarget::Opacity) {
            slot.alpha_mode = AlphaMode::Blend;
        }
    }

    /// The textures that slots look up.
    pub fn finish(mut self, slots: &mut [Slot]) -> Vec<Texture> {
        let mut places = vec![None; self.textures.len()];
        let mut kept = Vec::new();
        for reference in slots.iter_mut().flat_map(|slot| slot.textures.iter_mut().flatten()) {
            let from = reference.texture;
            reference.texture = *places[from].get_or_insert_with(|| {
                kept.push(std::mem::take(&mut self.textures[from]));
                kept.len() - 1
            });
        }
        kept
    }
}

/// The mean of red, green and blue.
pub fn grey([red, green, blue, _]: [u8; 4]) -> u8 {
    ((u32::from(red) + u32::from(green) + u32::from(blue)) / 3) as u8
}

/// The opacity of a mask's texels: its alpha if it has one, else its grey.
pub fn opacity_of(mask: &Texture) -> fn([u8; 4]) -> u8 {
    match mask.is_translucent() {
        true => |texel| texel[3],
        false => grey,
    }
}

/// Whether a map is grey everywhere: of heights, not of normals.
pub fn holds_heights(texture: &Texture) -> bool {
    let grey = |texel: &[u8; 4]| texel[0].abs_diff(texel[2]) < 8 && texel[1].abs_diff(texel[2]) < 8;
    texture.rgba8.as_chunks::<4>().0.iter().all(grey)
}
