//! A rectangle of sRGB pixels: a texture, a symbol, a picture.

use crate::color::Srgba;

/// Pixels row by row from the upper left corner.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    width: u32,
    height: u32,
    data: Vec<Srgba>,
}

impl Pixels {
    /// A picture of one color. A side of zero gives an empty picture.
    pub fn filled(width: u32, height: u32, color: Srgba) -> Self {
        Self { width, height, data: vec![color; width as usize * height as usize] }
    }

    /// A picture from its pixels, row by row; `None` where `data` does not hold `width` × `height` of them.
    pub fn from_data(width: u32, height: u32, data: Vec<Srgba>) -> Option<Self> {
        (data.len() == width as usize * height as usize).then_some(Self { width, height, data })
    }

    /// A picture whose pixel at column `x`, row `y` is `color(x, y)`.
    pub fn from_fn(width: u32, height: u32, color: impl Fn(u32, u32) -> Srgba) -> Self {
        let color = &color;
        let data = (0..height).flat_map(|y| (0..width).map(move |x| color(x, y))).collect();
        Self { width, height, data }
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row.
    pub fn data(&self) -> &[Srgba] {
        &self.data
    }

    /// All pixels, row by row, for painting.
    pub fn data_mut(&mut self) -> &mut [Srgba] {
        &mut self.data
    }

    /// The pixels as bytes, four per pixel: red, green, blue, alpha.
    pub fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.data)
    }

    /// The pixel at column `x`, row `y`. Panics outside the picture.
    pub fn at(&self, x: u32, y: u32) -> Srgba {
        let (width, height) = (self.width, self.height);
        assert!(x < width && y < height, "pixel ({x}, {y}) is outside {width}×{height}");
        self.data[y as usize * width as usize + x as usize]
    }
}
