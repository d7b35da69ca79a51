//! Texture lines of a material library: options that start with a hyphen, then the file name.

/// A texture file and its mapping.
#[derive(Clone, Debug, PartialEq)]
pub struct Map<'a> {
    /// File name, which may have spaces.
    pub name: &'a str,
    /// Repetitions along u and v.
    pub scale: [f32; 2],
    /// Offset along u, and along v upwards.
    pub offset: [f32; 2],
    /// True for clamping to the edge.
    pub is_clamped: bool,
    /// Factor of a bump's height or a normal's tilt.
    pub strength: f32,
    /// Options that are not read, with their values.
    pub ignored: Vec<&'a str>,
}

/// The options with the most and the least values that each has.
const OPTIONS: [(&str, usize, usize); 12] = [
    ("-blendu", 1, 1),
    ("-blendv", 1, 1),
    ("-bm", 1, 1),
    ("-boost", 1, 1),
    ("-cc", 1, 1),
    ("-clamp", 1, 1),
    ("-imfchan", 1, 1),
    ("-mm", 2, 2),
    ("-o", 3, 1),
    ("-s", 3, 1),
    ("-t", 3, 1),
    ("-texres", 1, 1),
];

impl<'a> Map<'a> {
    /// Reads a line after its keyword.
    pub fn parse(line: &'a str) -> Self {
        let mut map = Self {
            name: line.trim(),
            scale: [1.0; 2],
            offset: [0.0; 2],
            is_clamped: false,
            strength: 1.0,
            ignored: Vec::new(),
        };
        while let Some((option, values, rest)) = next_option(map.name) {
            let whole = map.name[..map.name.len() - rest.len()].trim_end();
            map.take(option, &values, whole);
            map.name = rest;
        }
        map
    }

    fn take(&mut self, option: &str, values: &[&str], whole: &'a str) {
        let number = |place: usize| values.get(place).and_then(|value| value.parse::<f32>().ok());
        match (option, number(0)) {
            ("-s", Some(u)) => self.scale = [u, number(1).unwrap_or(1.0)],
            ("-o", Some(u)) => self.offset = [u, number(1).unwrap_or(0.0)],
            ("-bm", Some(strength)) => self.strength = strength,
            ("-clamp", _) => self.is_clamped = values == ["on"],
            // As it is without them.
            ("-blendu" | "-blendv", _) if values == ["on"] => {}
            ("-mm", Some(0.0)) if number(1) == Some(1.0) => {}
            ("-t", Some(u)) if u == 0.0 && number(1).unwrap_or(0.0) == 0.0 => {}
            _ => self.ignored.push(whole),
        }
    }

    /// Affine map from the mesh's coordinates, with v downwards, to the image's.
    pub fn texture_from_mesh_uv(&self) -> [f32; 6] {
        let ([scale_u, scale_v], [offset_u, offset_v]) = (self.scale, self.offset);
        [scale_u, 0.0, offset_u, 0.0, scale_v, 1.0 - scale_v - offset_v]
    }
}

/// The first option of a line, its values, and the rest.
fn next_option(line: &str) -> Option<(&str, Vec<&str>, &str)> {
    let (option, mut rest) = next_word(line)?;
    let (option, most, least) = OPTIONS.into_iter().find(|(known, ..)| *known == option)?;
    let mut values = Vec::new();
    while values.len() < most {
        let Some((word, after)) = next_word(rest) else { break };
        // Optional numbers end where a name follows.
        if values.len() >= least && (word.parse::<f32>().is_err() || after.is_empty()) {
            break;
        }
        values.push(word);
        rest = after;
    }
    Some((option, values, rest))
}

fn next_word(line: &str) -> Option<(&str, &str)> {
    let line = line.trim_start();
    let end = line.find(char::is_whitespace).unwrap_or(line.len());
    (end > 0).then(|| (&line[..end], line[end..].trim_start()))
}
