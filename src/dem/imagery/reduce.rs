//! Means of squares of pixels, in linear light and weighted by alpha: what a sensor with larger pixels would have seen.

use std::sync::LazyLock;

use glam::{DAffine2, DVec2, Vec3, Vec4};

use crate::imagery::ColorRaster;
use sandtable_raster::windows::RasterWindow;

/// Red, green, blue in sRGB and straight alpha.
pub type Rgba = [u8; 4];

/// Takes the rows of a window one after the other and keeps one row of sums.
pub(super) struct Reducer {
    window: RasterWindow,
    step: u32,
    rows: u32,
    sums: Vec<Vec4>,
    counts: Vec<f32>,
    raster: ColorRaster,
}

impl Reducer {
    pub fn new(window: RasterWindow, step: u32) -> Self {
        let (width, height) = (window.width.div_ceil(step), window.height.div_ceil(step));
        let corner = DVec2::new(window.column.into(), window.row.into());
        let grid_from_own =
            DAffine2::from_translation(corner) * DAffine2::from_scale(DVec2::splat(step.into()));
        let pixels = Vec::with_capacity(width as usize * height as usize);
        Self {
            window,
            step,
            rows: 0,
            sums: vec![Vec4::ZERO; width as usize],
            counts: vec![0.0; width as usize],
            raster: ColorRaster { width, height, pixels, grid_from_own },
        }
    }

    /// Adds the next row of the window.
    pub fn add_row(&mut self, colors: &[Rgba]) {
        self.rows += 1;
        if self.step == 1 {
            self.raster.pixels.extend_from_slice(colors);
            return;
        }
        let squares = colors.chunks(self.step as usize);
        for ((sum, count), square) in self.sums.iter_mut().zip(&mut self.counts).zip(squares) {
            square.iter().for_each(|&color| *sum += weighted(color));
            *count += square.len() as f32;
        }
        if self.rows.is_multiple_of(self.step) || self.rows == self.window.height {
            for (sum, count) in self.sums.iter_mut().zip(&mut self.counts) {
                self.raster.pixels.push(color(*sum, *count));
                (*sum, *count) = (Vec4::ZERO, 0.0);
            }
        }
    }

    /// The means of all squares, once all rows have been added.
    pub fn finish(self) -> ColorRaster {
        self.raster
    }
}

/// The mean of colors with weights that sum to 1.
pub(super) fn blended(colors: [(Rgba, f32); 4]) -> Rgba {
    let first = colors[0].0;
    if colors.iter().all(|&(color, _)| color == first) {
        return first;
    }
    color(colors.iter().map(|&(color, weight)| weighted(color) * weight).sum(), 1.0)
}

/// Linear light times alpha, and alpha, 0..=1.
fn weighted([red, green, blue, alpha]: Rgba) -> Vec4 {
    let light = Vec3::from_array([red, green, blue].map(|channel| LIGHT[usize::from(channel)]));
    let alpha = f32::from(alpha) / 255.0;
    (light * alpha).extend(alpha)
}

fn color(sum: Vec4, count: f32) -> Rgba {
    if sum.w <= 0.0 {
        return [0; 4];
    }
    let [red, green, blue] = (sum.truncate() / sum.w).to_array().map(channel);
    [red, green, blue, (sum.w / count * 255.0 + 0.5) as u8]
}

/// The light of each value of a channel (IEC 61966-2-1).
static LIGHT: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|value| {
        let value = value as f32 / 255.0;
        if value <= 0.04045 { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
    })
});

/// The value of a channel whose light is nearest.
fn channel(light: f32) -> u8 {
    let above = LIGHT.partition_point(|&value| value < light).clamp(1, 255);
    let nearer_below = light - LIGHT[above - 1] < LIGHT[above] - light;
    (above - usize::from(nearer_below)) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_of_a_channel_survives() {
        for value in 0..=255u8 {
            assert_eq!(channel(LIGHT[usize::from(value)]), value);
        }
        assert_eq!((channel(-1.0), channel(2.0)), (0, 255));
    }

    #[test]
    fn a_checkerboard_becomes_half_the_light() {
        let window = RasterWindow { column: 3, row: 5, width: 4, height: 2 };
        let mut reducer = Reducer::new(window, 2);
        let (black, white) = ([0, 0, 0, 255], [255; 4]);
        reducer.add_row(&[black, white, black, white]);
        reducer.add_row(&[white, black, white, black]);
        let raster = reducer.finish();
        assert_eq!(raster.pixels, [[188, 188, 188, 255]; 2]);
        assert_eq!(raster.grid_from_own.transform_point2(DVec2::ZERO), DVec2::new(3.0, 5.0));
    }
}
