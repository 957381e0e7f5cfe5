//! The parts of a picture that show its scene, and those that show its background.

use glam::UVec2;

use crate::pixel_box::PixelBox;

/// The side of the squares that are told apart, pixels: fine enough for panels of some hundred.
const SIDE: u32 = 8;

/// The squares of a picture whose middle shows the scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneCover {
    size: UVec2,
    is_scene: Vec<bool>,
}

impl SceneCover {
    /// The cover of a picture of `width` × `height` pixels; `is_scene` returns whether the pixel at a column and a row
    /// shows the scene.
    pub fn new(width: u32, height: u32, is_scene: impl Fn(u32, u32) -> bool) -> Self {
        let size = UVec2::new(width, height) / SIDE;
        let middle = |index: u32| (index % size.x * SIDE + SIDE / 2, index / size.x * SIDE + SIDE / 2);
        let is_scene = (0..size.element_product()).map(|index| {
            let (x, y) = middle(index);
            is_scene(x, y)
        });
        Self { size, is_scene: is_scene.collect() }
    }

    /// The share of a box within the picture that shows the scene, 0..=1; 0 of a box without a whole square.
    pub(crate) fn share(&self, area: &PixelBox) -> f32 {
        let first = (area.min / SIDE as f32).ceil().as_uvec2().min(self.size);
        let end = (area.max / SIDE as f32).floor().as_uvec2().clamp(first, self.size);
        let squares =
            (first.y..end.y).flat_map(|y| (first.x..end.x).map(move |x| (y * self.size.x + x) as usize));
        let covered = squares.filter(|&square| self.is_scene[square]).count();
        covered as f32 / (end - first).element_product().max(1) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn the_share_of_a_box_is_that_of_its_squares() {
        let cover = SceneCover::new(160, 90, |x, _| x < 80);
        let share =
            |x: f32, width: f32| cover.share(&PixelBox::at(Vec2::new(x, 8.0), Vec2::new(width, 40.0)));
        assert_eq!((share(0.0, 80.0), share(80.0, 80.0), share(40.0, 80.0)), (1.0, 0.0, 0.5));
        assert_eq!((share(140.0, 500.0), share(-50.0, 66.0), share(1.0, 2.0)), (0.0, 1.0, 0.0));
    }
}
