//! Tiles of an image, their samples so far and their goals: the schedule of both engines.

/// Side of a tile, pixels: a workgroup's, as the shaders say.
pub const TILE_SIDE: u32 = 8;

/// An image as a grid of tiles, rows from the top; those at the right and the bottom may be smaller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileGrid {
    /// Width of the image in pixels.
    pub width: u32,
    /// Height of the image in pixels.
    pub height: u32,
}

impl TileGrid {
    /// Number of tile columns.
    pub fn columns(self) -> usize {
        self.width.div_ceil(TILE_SIDE) as usize
    }

    /// Number of tile rows.
    pub fn rows(self) -> usize {
        self.height.div_ceil(TILE_SIDE) as usize
    }

    pub fn tiles(self) -> usize {
        self.columns() * self.rows()
    }

    /// The top left pixel of a tile.
    pub fn origin(self, tile: usize) -> [u32; 2] {
        [tile % self.columns(), tile / self.columns()].map(|place| place as u32 * TILE_SIDE)
    }

    /// Width and height of a tile, pixels.
    pub fn size(self, tile: usize) -> [u32; 2] {
        let [x, y] = self.origin(tile);
        [(self.width - x).min(TILE_SIDE), (self.height - y).min(TILE_SIDE)]
    }

    /// The numbers of a tile's pixels.
    pub fn pixels_of(self, tile: usize) -> impl Iterator<Item = usize> {
        let ([left, top], [columns, rows]) = (self.origin(tile), self.size(tile));
        let row = move |y: u32| (left..left + columns).map(move |x| y as usize * self.width as usize + x as usize);
        (top..top + rows).flat_map(row)
    }

    /// Number of pixels of a tile.
    pub fn pixels(self, tile: usize) -> u64 {
        let [width, height] = self.size(tile);
        u64::from(width) * u64::from(height)
    }

    /// Samples of all pixels together in some work.
    pub fn pixel_samples(self, works: &[Work]) -> u64 {
        let of_work = |work: &Work| self.pixels(work.tile) * u64::from(work.count);
        works.iter().map(of_work).sum()
    }

    /// The tile of a pixel, by the pixel's number row by row.
    pub fn of_pixel(self, pixel: usize) -> usize {
        let (width, side) = (self.width as usize, TILE_SIDE as usize);
        pixel / width / side * self.columns() + pixel % width / side
    }

    /// The tile of a pixel, by its column and row.
    pub fn at(self, [x, y]: [u32; 2]) -> usize {
        (y / TILE_SIDE) as usize * self.columns() + (x / TILE_SIDE) as usize
    }

    /// Whether a tile is rendered: all are, unless only those that overlap a region (left, top, right, bottom as shares of
    /// width and height).
    pub fn is_rendered(self, tile: usize, region: Option<[f64; 4]>) -> bool {
        let Some(region) = region else { return true };
        let (origin, size) = (self.origin(tile), self.size(tile));
        [self.width, self.height].into_iter().enumerate().all(|(axis, whole)| {
            let low = f64::from(origin[axis]) / f64::from(whole);
            let high = f64::from(origin[axis] + size[axis]) / f64::from(whole);
            low < region[axis + 2] && high > region[axis]
        })
    }

    /// The tiles around a tile, itself among them.
    pub fn around(self, tile: usize) -> impl Iterator<Item = usize> {
        let (columns, rows) = (self.columns(), self.rows());
        let (x, y) = (tile % columns, tile / columns);
        let across = x.saturating_sub(1)..(x + 2).min(columns);
        (y.saturating_sub(1)..(y + 2).min(rows)).flat_map(move |y| across.clone().map(move |x| y * columns + x))
    }
}

/// Work of an engine on one tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Work {
    /// Tile index.
    pub tile: usize,
    /// Index of its first sample.
    pub first_sample: u32,
    /// Samples per pixel.
    pub count: u32,
}

/// Limits of a slice.
#[derive(Clone, Copy, Debug)]
pub struct SliceLimits {
    /// Minimum (if it lacks so many) and maximum samples per pixel of a tile in a pass; at least 1.
    pub pass_samples: [u32; 2],
    /// Minimum (if there are so many) and maximum tiles of a slice; between them the affordable work decides.
    pub tiles: [usize; 2],
    /// Tile order of a pass.
    pub order: Order,
}

/// An order of an image's tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Row by row, for cache locality.
    Rows,
    /// Spread over the image, so that any consecutive few cost about the same.
    Spread,
}

impl Order {
    /// Reorders tiles from row order.
    fn arrange(self, tiles: Vec<usize>) -> Vec<usize> {
        let count = tiles.len();
        if self == Self::Rows || count < 2 {
            return tiles;
        }
        // Golden section steps keep consecutive tiles apart; a step coprime to the count visits every tile once.
        let coprime = |step: &usize| greatest_common_divisor(*step, count) == 1;
        let golden = (count as f64 * 0.618_034) as usize;
        let step = (golden.max(1)..).find(coprime).unwrap_or(1);
        (0..count).map(|place| tiles[place * step % count]).collect()
    }
}

fn greatest_common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// Rendered samples per tile, and the next ones. A *pass* visits all tiles that lack samples once.
#[derive(Clone, Debug, Default)]
pub struct Schedule {
    grid: TileGrid,
    /// The number of each pixel's first sample: all others here are counted from it.
    first_sample: u32,
    samples: Vec<u32>,
    goals: Vec<u32>,
    /// Tiles of the current pass, the number already rendered, and the maximum samples of each.
    pass: Vec<usize>,
    next: usize,
    pass_samples: u32,
    completed: u32,
}

impl Schedule {
    /// A schedule without samples and goals, which starts at sample `first_sample`.
    pub fn new(width: u32, height: u32, first_sample: u32) -> Self {
        let grid = TileGrid { width, height };
        Self {
            grid,
            first_sample,
            samples: vec![0; grid.tiles()],
            goals: vec![0; grid.tiles()],
            ..Self::default()
        }
    }

    pub fn grid(&self) -> TileGrid {
        self.grid
    }

    /// Sets how many samples per pixel of each tile is to have; one number a tile.
    pub fn set_goals(&mut self, goals: &[u32]) {
        self.goals.clear();
        self.goals.extend_from_slice(goals);
        self.goals.resize(self.samples.len(), 0);
    }

    /// The next work, of about `affordable` pixel samples: some tiles of a pass, or a pass of several samples per tile.
    /// Empty if no tile lacks any.
    pub fn slice(&mut self, affordable: f64, limits: SliceLimits) -> Vec<Work> {
        if self.next >= self.pass.len() {
            self.begin(affordable, limits);
        }
        let tile_samples = f64::from(TILE_SIDE * TILE_SIDE * self.pass_samples.max(1));
        let [least, most] = limits.tiles;
        self.next(((affordable / tile_samples) as usize).clamp(least, most))
    }

    /// Begins a pass over the tiles that lack samples.
    fn begin(&mut self, affordable: f64, limits: SliceLimits) {
        let lacks = |tile: &usize| self.samples[*tile] < self.goals[*tile];
        let in_rows = (0..self.samples.len()).filter(lacks).collect();
        self.pass = limits.order.arrange(in_rows);
        self.next = 0;
        let pixels: u64 = self.pass.iter().map(|tile| self.grid.pixels(*tile)).sum();
        let [least, most] = limits.pass_samples;
        self.pass_samples = ((affordable / pixels.max(1) as f64) as u32).clamp(least, most);
    }

    /// Maximum samples of a tile in the current pass.
    pub fn pass_samples(&self) -> u32 {
        self.pass_samples
    }

    /// The next tiles of the pass, at most `most`.
    fn next(&self, most: usize) -> Vec<Work> {
        let work = |tile: &usize| {
            let lacking = self.goals[*tile].saturating_sub(self.samples[*tile]);
            Work {
                tile: *tile,
                first_sample: self.first_sample.saturating_add(self.samples[*tile]),
                count: lacking.min(self.pass_samples),
            }
        };
        self.pass[self.next..].iter().take(most).map(work).collect()
    }

    /// Notes that the next tiles have been rendered; true at the end of the pass.
    pub fn finish(&mut self, works: &[Work]) -> bool {
        for work in works {
            self.samples[work.tile] += work.count;
        }
        self.next += works.len();
        let is_end = self.next >= self.pass.len();
        if is_end {
            self.completed = self.samples.iter().copied().max().unwrap_or(0);
        }
        is_end
    }

    /// Whether every tile has reached its goal.
    pub fn is_at_goal(&self) -> bool {
        self.next >= self.pass.len() && std::iter::zip(&self.samples, &self.goals).all(|(n, goal)| n >= goal)
    }

    /// Samples per pixel of each tile.
    pub fn samples(&self) -> &[u32] {
        &self.samples
    }

    /// Maximum samples per pixel at the end of the last pass; with equal goals every pixel has as many.
    pub fn samples_per_pixel(&self) -> u32 {
        self.completed
    }

    /// Samples of all pixels together.
    pub fn pixel_samples(&self) -> u64 {
        let of_tile = |(tile, n): (usize, &u32)| self.grid.pixels(tile) * u64::from(*n);
        self.samples.iter().enumerate().map(of_tile).sum()
    }
}
