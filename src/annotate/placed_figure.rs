//! The numbers of a grid's lines as they are drawn, each with the line's end that it belongs to.

use glam::Vec2;

use crate::drawing::Drawing;
use crate::figure::CoordinateFigure;
use crate::pixel_box::PixelBox;

/// The number of a line, as it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedFigure {
    /// The line, as the caller counts lines; `None` for a coordinate of the block's edge that no line has.
    pub line: Option<usize>,
    /// What it says.
    pub figure: CoordinateFigure,
    /// The place of the line that it belongs to: pixels from the picture's upper left corner, Y down.
    pub at_px: Vec2,
    /// The direction in which the line would go on from there to the number, of length 1; zero for a number on the line.
    pub outward: Vec2,
    /// The upper left corner of its box.
    pub min: Vec2,
    /// The lower right corner of its box.
    pub max: Vec2,
}

impl PlacedFigure {
    /// The number that `drawing` shows.
    pub(crate) fn new(
        (line, figure): (Option<usize>, &CoordinateFigure),
        (at_px, outward): (Vec2, Vec2),
        drawing: &Drawing,
    ) -> Self {
        let PixelBox { min, max } = drawing.bounds();
        Self { line, figure: figure.clone(), at_px, outward, min, max }
    }

    /// By how many pixels it misses its line: the distance of its box from the line, continued for twice the height of the
    /// box.
    pub fn off_px(&self) -> f32 {
        /// Places along the continued line.
        const STEPS: u16 = 32;
        let reach = 2.0 * (self.max.y - self.min.y);
        let off = |step: u16| {
            let at = self.at_px + self.outward * (reach * f32::from(step) / f32::from(STEPS));
            at.distance(at.clamp(self.min, self.max))
        };
        (0..=STEPS).map(off).fold(f32::INFINITY, f32::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_misses_its_line_by_the_distance_of_its_box_from_the_line_continued() {
        let figure = |at_px: Vec2, outward: Vec2| PlacedFigure {
            line: Some(0),
            figure: "22°20′E".to_owned().into(),
            at_px,
            outward,
            min: Vec2::new(100.0, 100.0),
            max: Vec2::new(150.0, 112.0),
        };
        assert_eq!(figure(Vec2::new(120.0, 106.0), Vec2::ZERO).off_px(), 0.0);
        assert_eq!(figure(Vec2::new(120.0, 90.0), Vec2::Y).off_px(), 0.0);
        assert_eq!(figure(Vec2::new(90.0, 106.0), Vec2::Y).off_px(), 10.0);
        assert!(figure(Vec2::new(120.0, 60.0), Vec2::Y).off_px() > 15.0);
    }
}
