//! What of the image is looked at closely: a pixel, and what is seen there.

/// A pixel, as shares of the image's width and height.
pub type ImagePoint = [f64; 2];

/// What is seen at a place of the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenSurface {
    /// The material slot; `None` for the ground and area lights, which are no materials of the document.
    pub slot: Option<usize>,
    /// The object of the model; `None` for the ground and area lights.
    pub object: Option<usize>,
    /// Along the camera's viewing direction, scene units.
    pub depth: f64,
    /// Between view and shading normal, degrees.
    pub view_angle_deg: f32,
    /// The place, in the geometry's units.
    pub place: glam::DVec3,
    /// Where the viewer's ray goes that is mirrored there.
    pub mirrored: glam::DVec3,
}

/// The pixel that the inspector describes.
#[derive(Clone, Debug, Default)]
pub struct Look {
    /// Whether the inspector was shown in this frame, and in the one before: only then are pixels reported.
    pub is_shown: bool,
    pub was_shown: bool,
    /// The pixel under the pointer, or the one that it was at last, or that it is pinned to.
    pub at: Option<ImagePoint>,
    /// It stays where it is while the pointer moves on.
    pub is_pinned: bool,
    pub seen: Option<SeenSurface>,
}

impl Look {
    /// What is drawn before the inspector goes by the frame before.
    pub fn begin_frame(&mut self) {
        self.was_shown = std::mem::take(&mut self.is_shown);
    }

    /// Pins the pixel until it is released.
    pub fn pin(&mut self, at: ImagePoint) {
        (self.at, self.is_pinned) = (Some(at), true);
    }

    /// The pixel of an image of this size.
    pub fn pixel(&self, [width, height]: [u32; 2]) -> Option<[u32; 2]> {
        let [x, y] = self.at?;
        let index = |share: f64, side: u32| Some(((share * f64::from(side)) as u32).min(side.checked_sub(1)?));
        Some([index(x, width)?, index(y, height)?])
    }
}

/// The middle of a pixel of an image of this size.
pub fn middle([x, y]: [u32; 2], [width, height]: [u32; 2]) -> ImagePoint {
    let share = |index: u32, side: u32| (f64::from(index) + 0.5) / f64::from(side.max(1));
    [share(x, width), share(y, height)]
}
