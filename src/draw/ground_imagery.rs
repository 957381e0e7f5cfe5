//! A picture draped over the ground: its colors take the place of the ramp's and of the ground map's water; contours lie
//! over it, and where it is transparent the map shows through.

use glam::{Vec2, Vec3};

use crate::pixels::Pixels;

/// Pixels with their place in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundImagery {
    /// World X and Y of the south-west corner, meters.
    pub origin: Vec2,
    /// Meters eastward and northward, both positive.
    pub size: Vec2,
    /// North up; alpha is the share of the ground that it covers.
    pub pixels: Pixels,
    /// Whether the relief is shaded over it; where not, its colors are shown as they are.
    pub is_shaded: bool,
}

/// The color of the draped picture at a place, linear, and the share of the ground that it covers, 0..=1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DrapedColor {
    /// Linear light.
    pub color: Vec3,
    /// 0 where there is no picture.
    pub share: f32,
}

impl DrapedColor {
    /// `ground` with the picture over it.
    pub fn over(&self, ground: Vec3) -> Vec3 {
        ground.lerp(self.color, self.share)
    }
}

impl GroundImagery {
    /// Texture coordinates of a world position, V downward; within half a pixel of the border those of the border's
    /// pixels, so that a repeating texture does not show the opposite side. `None` beyond the picture.
    pub fn uv(&self, at: Vec2) -> Option<Vec2> {
        let part = (at - self.origin) / self.size;
        let is_within = part.cmpge(Vec2::ZERO).all() && part.cmple(Vec2::ONE).all();
        let half = 0.5 / self.sides().max(Vec2::ONE);
        is_within.then(|| Vec2::new(part.x, 1.0 - part.y).clamp(half, Vec2::ONE - half))
    }

    /// Pixels per meter eastward and northward.
    pub fn pixels_per_m(&self) -> Vec2 {
        self.sides() / self.size
    }

    /// The color at a world position: that of the pixel there.
    pub fn at(&self, at: Vec2) -> DrapedColor {
        let Some(uv) = self.uv(at) else { return DrapedColor::default() };
        let last = self.sides() - 1.0;
        let pixel = (uv * self.sides()).min(last).max(Vec2::ZERO).as_uvec2();
        let color = self.pixels.at(pixel.x, pixel.y);
        DrapedColor { color: color.linear(), share: color.alpha() }
    }

    /// Whether it hides all ground between two corners, looked at in places that are close to one another.
    pub fn covers(&self, min: Vec2, max: Vec2) -> bool {
        /// Places along each side: what they miss is too small to tell the ramp's colors in.
        const PLACES: u16 = 256;
        let at = |column: u16, row: u16| {
            let share = Vec2::new(f32::from(column), f32::from(row)) + 0.5;
            min + (max - min) * share / f32::from(PLACES)
        };
        (0..PLACES).all(|row| (0..PLACES).all(|column| self.at(at(column, row)).share >= 1.0))
    }

    /// Whether renderers can read it: pixels, a finite place and a positive size.
    pub fn is_sound(&self) -> bool {
        let is_placed = self.origin.is_finite() && self.size.is_finite() && self.size.min_element() > 0.0;
        is_placed && self.size.recip().is_finite() && !self.pixels.data().is_empty()
    }

    fn sides(&self) -> Vec2 {
        Vec2::new(self.pixels.width() as f32, self.pixels.height() as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Srgba;

    #[test]
    fn a_place_has_the_color_of_the_pixel_there_and_none_beyond_the_picture() {
        let pixels = Pixels::from_fn(4, 2, |x, y| Srgba([x as u8, y as u8, 0, 128]));
        let (origin, size) = (Vec2::new(100.0, 50.0), Vec2::new(40.0, 20.0));
        let opaque = Pixels::filled(4, 2, Srgba::WHITE);
        let whole = GroundImagery { origin, size, pixels: opaque, is_shaded: true };
        assert!(whole.covers(origin, origin + size) && !whole.covers(origin - 5.0, origin + size));
        let imagery = GroundImagery { origin, size, pixels, is_shaded: true };
        assert!(imagery.is_sound());
        let north_west = imagery.at(Vec2::new(101.0, 69.0));
        assert_eq!(north_west.color, Srgba::opaque(0, 0, 0).linear());
        let south_east = imagery.at(Vec2::new(140.0, 50.0));
        assert_eq!(south_east.color, Srgba::opaque(3, 1, 0).linear());
        assert!((south_east.share - 0.5).abs() < 0.01);
        assert_eq!(imagery.at(Vec2::new(99.0, 60.0)), DrapedColor::default());
        assert_eq!(imagery.at(Vec2::NAN), DrapedColor::default());
        assert_eq!(imagery.uv(Vec2::new(100.0, 70.0)), Some(Vec2::new(0.125, 0.25)));
    }
}
