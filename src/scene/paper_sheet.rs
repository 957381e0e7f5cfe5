//! The size of a picture in pixels: that of a sheet of paper, or of a screen.

/// The size of a picture where nothing states one, pixels.
pub const SCREEN_PX: (u32, u32) = (1920, 1080);

/// A sheet of paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperSheet {
    /// Width and height in millimeters.
    pub size_mm: [f64; 2],
    /// Pixels per inch.
    pub dpi: f64,
}

impl PaperSheet {
    /// Width and height in pixels.
    pub fn size_px(&self) -> (u32, u32) {
        let [width, height] = self.size_mm.map(|side| libm::round(side / 25.4 * self.dpi) as u32);
        (width.clamp(16, 16_384), height.clamp(16, 16_384))
    }
}
