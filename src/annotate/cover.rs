//! The parts of a picture that show its scene, and those that show its background.

use glam::UVec2;

use crate::pixel_box::PixelBox;

/// The side of the squares that are told apart, pixels: fine enough for panels of some hundred.
const SIDE: u32 = 8;

/// What the cover of a square of walls counts where a square of the ground counts 1: a panel over a wall hides soil in section.
const WALL: f32 = 0.5;

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShownPart {
    /// Sky, table or paper.
    Background,
    /// A wall of the block under the ground.
    Wall,
    /// The ground and what is on it.
    Ground,
}

/// What the middles of a picture's squares show.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneCover {
    size: UVec2,
    shown: Vec<ShownPart>,
}

impl SceneCover {
    /// The cover of a picture of `width` × `height` pixels; `shown` returns what the pixel at a column and a row shows.
    pub fn new(width: u32, height: u32, shown: impl Fn(u32, u32) -> ShownPart) -> Self {
        let size = UVec2::new(width, height) / SIDE;
        let middle = |index: u32| (index % size.x * SIDE + SIDE / 2, index / size.x * SIDE + SIDE / 2);
        let shown = (0..size.element_product()).map(|index| {
            let (x, y) = middle(index);
            shown(x, y)
        });
        Self { size, shown: shown.collect() }
    }

    /// The share of a box within the picture that shows the scene, 0..=1; 0 of a box without a whole square.
    pub(crate) fn share(&self, area: &PixelBox) -> f32 {
        self.mean(area, |part| if part == ShownPart::Background { 0.0 } else { 1.0 })
    }

    /// The same, a square of walls counting [`WALL`].
    pub(crate) fn weighted_share(&self, area: &PixelBox) -> f32 {
        self.mean(area, |part| match part {
            ShownPart::Background => 0.0,
            ShownPart::Wall => WALL,
            ShownPart::Ground => 1.0,
        })
    }

    /// The mean of a weight over the whole squares of a box.
    fn mean(&self, area: &PixelBox, weight: impl Fn(ShownPart) -> f32) -> f32 {
        let first = (area.min / SIDE as f32).ceil().as_uvec2().min(self.size);
        let end = (area.max / SIDE as f32).floor().as_uvec2().clamp(first, self.size);
        let squares =
            (first.y..end.y).flat_map(|y| (first.x..end.x).map(move |x| (y * self.size.x + x) as usize));
        let covered: f32 = squares.map(|square| weight(self.shown[square])).sum();
        covered / (end - first).element_product().max(1) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn the_share_of_a_box_is_that_of_its_squares() {
        let cover =
            SceneCover::new(160, 90, |x, _| if x < 80 { ShownPart::Ground } else { ShownPart::Background });
        let share =
            |x: f32, width: f32| cover.share(&PixelBox::at(Vec2::new(x, 8.0), Vec2::new(width, 40.0)));
        assert_eq!((share(0.0, 80.0), share(80.0, 80.0), share(40.0, 80.0)), (1.0, 0.0, 0.5));
        assert_eq!((share(140.0, 500.0), share(-50.0, 66.0), share(1.0, 2.0)), (0.0, 1.0, 0.0));
    }

    #[test]
    fn walls_weigh_half_of_the_ground() {
        let part = |x: u32| match x {
            ..40 => ShownPart::Ground,
            40..80 => ShownPart::Wall,
            _ => ShownPart::Background,
        };
        let cover = SceneCover::new(160, 90, |x, _| part(x));
        let weight = |x: f32| cover.weighted_share(&PixelBox::at(Vec2::new(x, 8.0), Vec2::new(40.0, 40.0)));
        assert_eq!([0.0, 40.0, 80.0, 120.0].map(weight), [1.0, WALL, 0.0, 0.0]);
    }
}
