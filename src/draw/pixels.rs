//! A rectangle of sRGB pixels: a texture, a symbol, a picture.

use std::sync::Arc;

use rayon::prelude::*;

use crate::color::Srgba;

/// Pixels row by row from the upper left corner. Clones share them until one is painted on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    width: u32,
    height: u32,
    data: Arc<Vec<Srgba>>,
}

impl Pixels {
    /// A picture of one color. A side of zero gives an empty picture.
    pub fn filled(width: u32, height: u32, color: Srgba) -> Self {
        Self { width, height, data: Arc::new(vec![color; width as usize * height as usize]) }
    }

    /// A picture from its pixels, row by row; `None` where `data` does not hold `width` × `height` of them.
    pub fn from_data(width: u32, height: u32, data: Vec<Srgba>) -> Option<Self> {
        let is_whole = data.len() == width as usize * height as usize;
        is_whole.then(|| Self { width, height, data: Arc::new(data) })
    }

    /// A picture whose pixel at column `x`, row `y` is `color(x, y)`.
    pub fn from_fn(width: u32, height: u32, color: impl Fn(u32, u32) -> Srgba) -> Self {
        let color = &color;
        let data: Vec<Srgba> = (0..height).flat_map(|y| (0..width).map(move |x| color(x, y))).collect();
        Self { width, height, data: Arc::new(data) }
    }

    /// The same on all threads, row by row.
    pub fn par_from_fn(width: u32, height: u32, color: impl Fn(u32, u32) -> Srgba + Sync) -> Self {
        let mut data: Vec<Srgba> = bytemuck::zeroed_vec(width as usize * height as usize);
        data.par_chunks_mut(width.max(1) as usize).zip(0..height).for_each(|(row, y)| {
            row.iter_mut().zip(0..width).for_each(|(pixel, x)| *pixel = color(x, y));
        });
        Self { width, height, data: Arc::new(data) }
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
        let data: &mut Vec<Srgba> = Arc::make_mut(&mut self.data);
        data
    }

    /// The pixels as bytes, four per pixel: red, green, blue, alpha.
    pub fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(self.data())
    }

    /// The pixel at column `x`, row `y`. Panics outside the picture.
    pub fn at(&self, x: u32, y: u32) -> Srgba {
        let (width, height) = (self.width, self.height);
        assert!(x < width && y < height, "pixel ({x}, {y}) is outside {width}×{height}");
        self.data[y as usize * width as usize + x as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clones_share_their_pixels_until_one_is_painted_on() {
        let first = Pixels::filled(3, 2, Srgba::WHITE);
        let mut second = first.clone();
        assert!(std::ptr::eq(first.data(), second.data()));
        second.data_mut()[4] = Srgba([1, 2, 3, 4]);
        assert_eq!((first.at(1, 1), second.at(1, 1)), (Srgba::WHITE, Srgba([1, 2, 3, 4])));
    }
}
