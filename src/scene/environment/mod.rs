//! Light from far away: a lat-long map, looked up bilinearly and sampled in proportion to its luminance.
//!
//! The map's own frame is right-handed with +Y up. A direction's place in the map is (u, v), both in [0, 1]:
//! u = atan2(x, −z) / 2π, so that u = 0 looks along −Z, 0.25 along +X, 0.5 (the centre column) along +Z; v = acos(y) / π,
//! so that the top row is +Y. Texel (i, j) has its centre at ((i + ½) / width, (j + ½) / height). Rotation and strength
//! are not part of the map: see [`environment_local_from_world`].
//!
//! The functions whose names start with `environment_` have WGSL twins in `shaders/scene/environment.wgsl`.

mod brightest;
mod distribution;
mod error;
mod procedural;
mod thumbnail;

use std::{fmt, path::PathBuf, str::FromStr, sync::OnceLock};

use serde::{Deserialize, Serialize};

use crate::optics::prelude::*;
use crate::scene::{
    alias::grid_places,
    inversion::{draw_numbers, place_in, slot},
    memory::{in_large_pages, prefetch},
    path_text::path_of_text,
};

pub use distribution::{Cell, Distribution};
use distribution::{Luminances, Map};
pub use error::MapError;
pub use procedural::{
    SkyParams, furnace, overcast, portrait, product, rim, sky, studio, sun_direction, sun_irradiance, warehouse,
};
pub use thumbnail::{brightened, thumbnail};

/// Width in pixels to which larger maps are reduced.
pub const MAX_WIDTH: u32 = 8192;
/// Height in pixels to which larger maps are reduced.
pub const MAX_HEIGHT: u32 = 4096;
/// Largest width of a file's image, in pixels.
pub const SOURCE_MAX_WIDTH: u32 = 32768;
/// Largest height of a file's image, in pixels: a strip of six faces may be upright.
pub const SOURCE_MAX_HEIGHT: u32 = 32768;

/// Source of an environment. Written as one of the names in [`BUILT_IN`] or as a file name; a file of such a name is written
/// `./studio`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EnvironmentSource {
    /// Large soft boxes of daylight in a room of wood.
    #[default]
    Product,
    /// Soft boxes in a dark room.
    Studio,
    /// One large warm lamp near the camera.
    Portrait,
    /// Narrow lamps behind the object, warm and cool.
    Rim,
    /// A hall with skylights, windows and a gate.
    Warehouse,
    /// A sky full of clouds.
    Overcast,
    /// A clear sky with its sun, see [`SkyParams`].
    Sky,
    /// Radiance 1 from everywhere.
    Furnace,
    /// An image of the whole sphere: a latitude-longitude or cube map in a file with one of [`ENDINGS`], or a folder with
    /// the six faces of a cube.
    File(PathBuf),
}

/// Encoding of a panorama's integer values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EnvironmentEncoding {
    /// sRGB codes: the image is display-referred.
    #[default]
    Display,
    /// Proportional to radiance.
    Linear,
}

/// An environment that needs no file.
pub struct BuiltIn {
    pub source: EnvironmentSource,
    /// Name on the command line and in files.
    pub name: &'static str,
    /// Name in the window.
    pub label: &'static str,
    pub help: &'static str,
    make: fn() -> Result<Environment, MapError>,
}

macro_rules! built_in {
    ($($source:ident $name:literal $label:literal $help:literal $make:expr;)*) => {
        /// The built-in environments, in the order of the window.
        pub static BUILT_IN: [BuiltIn; 8] = [$(BuiltIn {
            source: EnvironmentSource::$source,
            name: $name,
            label: $label,
            help: $help,
            make: $make,
        }),*];
    };
}

#[rustfmt::skip]
built_in! {
    Product "product" "Product" "Large soft boxes and a grey backdrop in a room of wood: white is white, and gold is gold." product;
    Studio "studio" "Studio" "Soft boxes in a dark room." studio;
    Portrait "portrait" "Portrait" "One large warm lamp near the camera, and reflectors." portrait;
    Rim "rim" "Rim" "Two narrow lamps behind the object, warm and cool, in the dark." rim;
    Warehouse "warehouse" "Warehouse" "A hall with skylights, windows and a gate." warehouse;
    Overcast "overcast" "Overcast" "A sky full of clouds: soft light from above." overcast;
    Sky "sky" "Sky" "A clear sky with its sun." || sky(&SkyParams::default());
    Furnace "furnace" "Furnace" "White light from everywhere: a material that keeps all light vanishes." furnace;
}

impl EnvironmentSource {
    /// The entry of [`BUILT_IN`]; `None` for a file.
    pub fn built_in(&self) -> Option<&'static BuiltIn> {
        BUILT_IN.iter().find(|built_in| built_in.source == *self)
    }

    /// The map of a built-in environment; [`MapError::IsFile`] for a file.
    pub fn computed(&self) -> Result<Environment, MapError> {
        match self.built_in() {
            Some(built_in) => (built_in.make)(),
            None => Err(MapError::IsFile(self.to_string())),
        }
    }
}

impl FromStr for EnvironmentSource {
    type Err = MapError;
    fn from_str(text: &str) -> Result<Self, MapError> {
        if text.is_empty() {
            return Err(MapError::NoName);
        }
        let built_in = BUILT_IN.iter().find(|built_in| built_in.name == text);
        Ok(built_in.map_or_else(|| Self::File(path_of_text(text)), |found| found.source.clone()))
    }
}

impl fmt::Display for EnvironmentSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => path.display().fmt(f),
            other => f.write_str(other.built_in().map_or("", |built_in| built_in.name)),
        }
    }
}

/// A lat-long map with the tables to sample it by, ready to upload.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// `width` × `height` linear Rec. 709 radiances, rows from +Y down, finite and not negative; the fourth number is 1.
    pub texels: Vec<[f32; 4]>,
    /// See [`Environment::distribution`].
    excess: Distribution,
    whole: OnceLock<Distribution>,
    /// Name: `studio`, …, or the file's name without folders.
    pub name: String,
    /// Faults of the file that were fixed, one sentence each.
    pub warnings: Vec<String>,
    /// Whether all texels are equal: then sampling gains nothing.
    pub is_constant: bool,
    /// Whether all texels are black: the density is 0 everywhere.
    pub is_black: bool,
    /// Radiance averaged over the sphere, per channel.
    pub mean_radiance: [f32; 3],
    /// The largest luminance of any texel.
    pub max_luminance: f32,
    /// Centre of the brightest region, in (u, v); `None` for a uniform map.
    pub brightest: Option<[f32; 2]>,
}

impl Environment {
    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.texels[..]) + self.excess.bytes() + self.whole.get().map_or(0, Distribution::bytes)
    }

    /// Builds the sampling tables over `texels` (`width` × `height`, finite and not negative).
    ///
    /// # Errors
    /// [`MapError::Empty`] if there are no texels or not `width` × `height` of them.
    pub fn from_texels(
        name: impl Into<String>,
        width: u32,
        height: u32,
        texels: Vec<[f32; 4]>,
    ) -> Result<Self, MapError> {
        let name = name.into();
        if texels.is_empty() || texels.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(MapError::Empty { name });
        }
        let map = Map {
            width,
            height,
            texels: &texels,
        };
        let (mean_radiance, max_luminance) = distribution::summarise(&map);
        let luminances = Luminances::of(&map);
        let excess = Distribution::of_excess(&luminances);
        let is_constant = texels.iter().all(|texel| *texel == texels[0]);
        let brightest = brightest::brightest(&luminances).filter(|_| !is_constant);
        Ok(Self {
            is_constant,
            brightest,
            is_black: max_luminance <= 0.0,
            mean_radiance,
            max_luminance,
            width,
            height,
            texels: in_large_pages(texels),
            excess,
            whole: OnceLock::new(),
            name,
            warnings: Vec::new(),
        })
    }
}

impl Environment {
    /// Distribution of light sampling. If it `is_alone`, proportional to luminance; otherwise to the luminance above the
    /// mean. BSDF sampling finds diffuse light, and each sample spent on that would miss the sun (Karlík et al., "MIS
    /// Compensation", ACM TOG 38(6), 2019).
    pub fn distribution(&self, is_alone: bool) -> &Distribution {
        if !is_alone {
            return &self.excess;
        }
        self.whole.get_or_init(|| {
            let map = Map {
                width: self.width,
                height: self.height,
                texels: &self.texels,
            };
            Distribution::new(&Luminances::of(&map), 0.0)
        })
    }
}

inlined! {
    /// Converts a world direction to the frame of the map, which is rotated about +Y, anticlockwise from above (+Z towards +X).
    /// `rotation` is the cosine and sine of the angle.
    pub fn environment_local_from_world<T: Real>(direction_world: Vec3<T>, rotation: [T; 2]) -> Vec3<T> {
        let [cos, sin] = rotation;
        let d = direction_world;
        vec3(d.x * cos - d.z * sin, d.y, d.x * sin + d.z * cos)
    }

    /// The inverse of [`environment_local_from_world`].
    pub fn environment_world_from_local<T: Real>(direction_local: Vec3<T>, rotation: [T; 2]) -> Vec3<T> {
        let [cos, sin] = rotation;
        let d = direction_local;
        vec3(d.x * cos + d.z * sin, d.y, d.z * cos - d.x * sin)
    }

    /// Map coordinates of a unit direction: u in [0, 1), v in [0, 1]. At the poles u is 0.
    pub fn environment_uv<T: Real>(direction: Vec3<T>) -> [T; 2] {
        // atan2 instead of acos: near the poles y rounds to 1, and only x and z determine the angle.
        let horizontal = (direction.x * direction.x + direction.z * direction.z).sqrt();
        let v = horizontal.atan2(direction.y) * T::FRAC_1_PI;
        // atan2(0, 0) is undefined in WGSL.
        let z = T::select(!horizontal.above_zero(), -T::ONE, direction.z);
        let turns = direction.x.atan2(-z) * T::from_f64(0.5 * std::f64::consts::FRAC_1_PI);
        let u = T::select(turns.below_zero(), turns + T::ONE, turns);
        // A tiny negative angle plus one turn rounds to a whole turn.
        [u.masked(u.less(T::ONE)), v.clamp(T::ZERO, T::ONE)]
    }

    /// The unit direction of a place in the map, the inverse of [`environment_uv`].
    pub fn environment_direction<T: Real>(uv: [T; 2]) -> Vec3<T> {
        let polar_rad = uv[1] * T::from_f64(std::f64::consts::PI);
        environment_direction_from_angles(uv[0], polar_rad.cos(), polar_rad.sin())
    }
}

/// The unit direction to the centre of a texel.
pub fn texel_direction([column, row]: [u32; 2], [width, height]: [u32; 2]) -> Vec3<f64> {
    let center = |place: u32, count: u32| (f64::from(place) + 0.5) / f64::from(count);
    environment_direction([center(column, width), center(row, height)])
}

inlined! {
    /// The unit direction at `u` turns of azimuth with the given cosine and sine of the angle to +Y.
    fn environment_direction_from_angles<T: Real>(u: T, cos_polar: T, sin_polar: T) -> Vec3<T> {
        // Shifted by half a turn, so that the argument is in [−π, π], where GPUs guarantee accuracy.
        let azimuth_rad = (u - T::HALF) * T::TAU;
        vec3(
            -(azimuth_rad.sin() * sin_polar),
            cos_polar,
            azimuth_rad.cos() * sin_polar,
        )
    }

    /// Radiance from a unit direction: bilinear, wrapping in u, clamped at the poles in v.
    pub fn environment_radiance<T: Real>(environment: &Environment, direction_local: Vec3<T>) -> Vec3<T> {
        environment_radiance_at(environment, environment_uv(direction_local))
    }

    /// The same at map coordinates ([`environment_uv`]).
    pub fn environment_radiance_at<T: Real>(environment: &Environment, uv: [T; 2]) -> Vec3<T> {
        let Bilinear { texels, shares } = bilinear(environment, uv);
        let [upper_left, upper_right, lower_left, lower_right] = &texels;
        radiances(environment, upper_left)
            .mix(radiances(environment, upper_right), shares[0])
            .mix(
                radiances(environment, lower_left).mix(radiances(environment, lower_right), shares[0]),
                shares[1],
            )
    }

    /// The radiances of texels.
    fn radiances<T: Real>(environment: &Environment, texels: &T::Each<u32>) -> Vec3<T> {
        let texel = |lane: usize| &environment.texels[texels[lane] as usize];
        let number = |radiance: f32| T::Scalar::from_f64(f64::from(radiance));
        vec3(
            T::from_lanes(|lane| number(texel(lane)[0])),
            T::from_lanes(|lane| number(texel(lane)[1])),
            T::from_lanes(|lane| number(texel(lane)[2])),
        )
    }
}

/// The texels around a place in the map.
struct Bilinear<T: Real> {
    /// Texel indices: two above, two below.
    texels: [T::Each<u32>; 4],
    /// Weights in [0, 1] of the right texels and of the lower ones.
    shares: [T; 2],
}

inlined! {
    fn bilinear<T: Real>(environment: &Environment, uv: [T; 2]) -> Bilinear<T> {
        let half = T::HALF;
        let x = uv[0] * T::from_f64(f64::from(environment.width)) - half;
        let y = uv[1] * T::from_f64(f64::from(environment.height)) - half;
        let (left, top) = (x.floor(), y.floor());
        let (width, height) = (environment.width as i32, environment.height as i32);
        // Written so that compilers turn it into lanes.
        let (columns, rows) = (left.to_integers(), top.to_integers());
        let (columns, rows) = (columns.as_ref(), rows.as_ref());
        // u is below 1: one step at most around the map.
        let left_column = |lane: usize| if columns[lane] < 0 { width - 1 } else { columns[lane] };
        let right_column = |lane: usize| {
            if columns[lane] + 1 >= width {
                0
            } else {
                columns[lane] + 1
            }
        };
        let line = |row: i32| row.clamp(0, height - 1) * width;
        Bilinear {
            texels: [
                T::each(|lane| (line(rows[lane]) + left_column(lane)) as u32),
                T::each(|lane| (line(rows[lane]) + right_column(lane)) as u32),
                T::each(|lane| (line(rows[lane] + 1) + left_column(lane)) as u32),
                T::each(|lane| (line(rows[lane] + 1) + right_column(lane)) as u32),
            ],
            shares: [x - left, y - top],
        }
    }

    /// Prefetches the texels at map coordinates: the left ones, as four neighbours share a cache line.
    pub fn prefetch_texels<T: Real>(environment: &Environment, uv: [T; 2]) {
        let [upper_left, _, lower_left, _] = &bilinear(environment, uv).texels;
        for texels in [upper_left, lower_left] {
            for &texel in texels.as_ref() {
                prefetch(&environment.texels, texel as usize);
            }
        }
    }

    /// Prefetches the cell at map coordinates.
    pub fn prefetch_cell<T: Real>(distribution: &Distribution, uv: [T; 2]) {
        let (cells, _) = grid_places(uv, [distribution.width, distribution.height]);
        for &cell in cells.as_ref() {
            prefetch(&distribution.cells, cell as usize);
        }
    }

    /// Samples a direction in the map's frame from three uniform numbers in [0, 1). Returns it with its density per steradian;
    /// for a black map the density is 0 and the direction arbitrary.
    ///
    /// `xi.y` selects the row of a cell, `xi.x` the column, and their remainders the position inside the cell: well distributed
    /// numbers give well distributed samples. `xi.z` supplies the bits that they lack.
    pub fn environment_sample<T: Real>(distribution: &Distribution, xi: Vec3<T>) -> (Vec3<T>, T) {
        sample_in_rows(distribution, &drawn_rows(distribution, xi.y), xi)
    }

    /// The rows of cells that [`environment_sample`] draws with `xi.y`.
    pub fn drawn_rows<T: Real>(distribution: &Distribution, xi_y: T) -> T::Each<u32> {
        let numbers = draw_numbers(xi_y);
        T::each(|lane| distribution.row(numbers[lane] as u32))
    }

    /// [`environment_sample`] for known rows.
    pub fn sample_in_rows<T: Real>(distribution: &Distribution, rows: &T::Each<u32>, xi: Vec3<T>) -> (Vec3<T>, T) {
        let (width, height) = (distribution.width, distribution.height);
        let (numbers, row_numbers) = (draw_numbers(xi.x), draw_numbers(xi.y));
        let [across, down] = jitter(xi.z);
        let (across, down) = (across.to_each(), down.to_each());
        let drawn = T::each(|lane| {
            let [row_number, number] = [row_numbers[lane] as u32, numbers[lane] as u32];
            let row = distribution.row_at(rows[lane]);
            let column = distribution.column(row.index, number);
            let [x, y] = [across[lane], down[lane]];
            let density = distribution.cells[(row.index * width + column.index) as usize].density;
            let place = [place_in(column, number, x), place_in(row, row_number, y)];
            (
                [column.index, row.index].map(T::Scalar::from_count),
                place,
                T::Scalar::from_f64(f64::from(density)),
            )
        });
        let drawn = drawn.as_ref();
        let cell = [
            T::from_lanes(|lane| drawn[lane].0[0]),
            T::from_lanes(|lane| drawn[lane].0[1]),
        ];
        let place = [
            T::from_lanes(|lane| drawn[lane].1[0]),
            T::from_lanes(|lane| drawn[lane].1[1]),
        ];
        (
            environment_direction_in_cell(cell, place, width, height),
            T::from_lanes(|lane| drawn[lane].2),
        )
    }
}

inlined! {
    /// Two numbers in [0, 1) of twelve bits out of one of 24.
    fn jitter<T: Real>(xi: T) -> [T; 2] {
        let steps = T::from_f64(4096.0);
        let scaled = xi * steps;
        let whole = scaled.floor();
        [whole / steps, scaled - whole]
    }

    /// Per lane the first cell of its row, and the cell with the guide of `xi_x`.
    fn guides<T: Real>(distribution: &Distribution, rows: &T::Each<u32>, xi_x: T) -> T::Each<[u32; 2]> {
        let (width, numbers) = (distribution.width, draw_numbers(xi_x));
        T::each(|lane| {
            let first = rows[lane] * width;
            [first, first + slot(width, numbers[lane] as u32)]
        })
    }

    /// Prefetches the guide to a row's cells, which [`sample_in_rows`] reads first.
    pub fn prefetch_guide<T: Real>(distribution: &Distribution, rows: &T::Each<u32>, xi_x: T) {
        for &[_, guide] in guides(distribution, rows, xi_x).as_ref() {
            prefetch(&distribution.cells, guide as usize);
        }
    }

    /// Prefetches the cell that [`sample_in_rows`] selects; reads the guide.
    pub fn prefetch_chosen<T: Real>(distribution: &Distribution, rows: &T::Each<u32>, xi_x: T) {
        for &[first, guide] in guides(distribution, rows, xi_x).as_ref() {
            prefetch(
                &distribution.cells,
                (first + distribution.cells[guide as usize].share.guide) as usize,
            );
        }
    }

    /// The direction at `place` (in [0, 1]², from the top left) of a cell, uniform in solid angle.
    fn environment_direction_in_cell<T: Real>(
        [column, row]: [T; 2],
        place: [T; 2],
        cells_width: u32,
        cells_height: u32,
    ) -> Vec3<T> {
        let (width, height) = (
            T::from_f64(f64::from(cells_width)),
            T::from_f64(f64::from(cells_height)),
        );
        let u = (column + place[0]) / width;
        // sin² of half the angle is uniform in solid angle, and exact near the pole that the angle is counted from: the
        // nearer one.
        let is_north = (row + row).less(height);
        let row_from_pole = T::select(is_north, row, height - T::ONE - row);
        let across = T::select(is_north, place[1], T::ONE - place[1]);
        let quarter_turn = T::from_f64(std::f64::consts::FRAC_PI_2);
        let near = (quarter_turn * (row_from_pole / height)).sin();
        let far = (quarter_turn * ((row_from_pole + T::ONE) / height)).sin();
        let near_squared = near * near;
        let s = near_squared + across * (far * far - near_squared);
        let cos_from_pole = T::ONE - (s + s);
        let sin_polar = T::TWO * (s * (T::ONE - s)).safe_sqrt();
        environment_direction_from_angles(u, T::select(is_north, cos_from_pole, -cos_from_pole), sin_polar)
    }

    /// The density, per steradian, with which [`environment_sample`] draws a unit direction in the map's frame.
    pub fn environment_density<T: Real>(distribution: &Distribution, direction_local: Vec3<T>) -> T {
        environment_density_at(distribution, environment_uv(direction_local))
    }

    /// The same at map coordinates ([`environment_uv`]).
    pub fn environment_density_at<T: Real>(distribution: &Distribution, uv: [T; 2]) -> T {
        let (cells, _) = grid_places(uv, [distribution.width, distribution.height]);
        T::from_lanes(|lane| T::Scalar::from_f64(f64::from(distribution.cells[cells.as_ref()[lane] as usize].density)))
    }
}
