//! Boxes and segments on the picture: pixels from the upper left corner, X right and Y down.
//!
//! In f32, as `tiny_skia` draws. Boxes are open: two that share only an edge do not overlap, so that things may stand
//! side by side.

use glam::Vec2;

use sandtable_geom::rect::Rect;

/// An upright rectangle on the picture; empty where `min` is not below `max` on both axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelBox {
    pub min: Vec2,
    pub max: Vec2,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelSegment {
    pub from: Vec2,
    pub to: Vec2,
}

impl PixelBox {
    /// The box that holds nothing: the start of every union.
    pub const EMPTY: Self = Self { min: Vec2::INFINITY, max: Vec2::NEG_INFINITY };

    /// The box with its upper left corner at `min`, extending `size` right and down.
    pub fn at(min: Vec2, size: Vec2) -> Self {
        Self { min, max: min + size }
    }

    pub fn around(center: Vec2, half: Vec2) -> Self {
        Self { min: center - half, max: center + half }
    }

    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// This box grown by `margin` on all four sides; a negative margin shrinks it.
    pub fn grown(self, margin: f32) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    pub fn moved(self, by: Vec2) -> Self {
        Self { min: self.min + by, max: self.max + by }
    }

    /// Width and height; negative where empty.
    pub fn size(&self) -> Vec2 {
        self.max - self.min
    }

    /// The center; NaN for [`PixelBox::EMPTY`].
    pub fn center(&self) -> Vec2 {
        (self.min + self.max) * 0.5
    }

    /// Whether the insides of the two share a point. False where a coordinate is NaN.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.min.cmplt(other.max).all() && other.min.cmplt(self.max).all()
    }

    /// Whether `other` lies inside; edges may coincide. False where a coordinate is NaN.
    pub fn holds(&self, other: &Self) -> bool {
        self.min.cmple(other.min).all() && other.max.cmple(self.max).all()
    }

    pub fn contains(&self, point: Vec2) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    pub fn meets(&self, segment: &PixelSegment) -> bool {
        let rect = Rect { min: self.min.as_dvec2(), max: self.max.as_dvec2() };
        rect.clip_line(segment.from.as_dvec2(), segment.to.as_dvec2()).is_some()
    }
}

impl PixelSegment {
    /// Whether the two cross or touch; parallel segments never do.
    pub fn crosses(&self, other: &Self) -> bool {
        let side = |line: &Self, point: Vec2| (line.to - line.from).perp_dot(point - line.from);
        let (a, b) = (side(self, other.from), side(self, other.to));
        let (c, d) = (side(other, self.from), side(other, self.to));
        (self.to - self.from).perp_dot(other.to - other.from) != 0.0 && a * b <= 0.0 && c * d <= 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> PixelBox {
        PixelBox::at(Vec2::ZERO, Vec2::splat(10.0))
    }

    #[test]
    fn boxes_that_share_only_an_edge_do_not_overlap() {
        assert!(!unit().overlaps(&unit().moved(Vec2::new(10.0, 0.0))));
        assert!(unit().overlaps(&unit().moved(Vec2::new(9.9, 0.0))));
    }

    #[test]
    fn a_segment_through_a_corner_region_but_past_the_box_does_not_meet_it() {
        let past = PixelSegment { from: Vec2::new(-6.0, 5.0), to: Vec2::new(5.0, -8.0) };
        assert!(!unit().meets(&past));
    }

    #[test]
    fn segments_meet_a_box_they_start_in_cross_or_touch() {
        let (inside, far) = (Vec2::splat(5.0), Vec2::new(50.0, 7.0));
        assert!(unit().meets(&PixelSegment { from: inside, to: far }));
        assert!(unit().meets(&PixelSegment { from: Vec2::new(-5.0, 5.0), to: far }));
        assert!(unit().meets(&PixelSegment { from: Vec2::new(3.0, -4.0), to: Vec2::new(3.0, 0.0) }));
        assert!(!unit().meets(&PixelSegment { from: Vec2::new(3.0, -4.0), to: Vec2::new(3.0, -0.1) }));
    }

    #[test]
    fn crossing_segments_cross_and_parallel_ones_do_not() {
        let rising = PixelSegment { from: Vec2::ZERO, to: Vec2::splat(10.0) };
        let falling = PixelSegment { from: Vec2::new(0.0, 10.0), to: Vec2::new(10.0, 0.0) };
        let beside = PixelSegment { from: Vec2::new(1.0, 0.0), to: Vec2::new(11.0, 10.0) };
        assert!(rising.crosses(&falling));
        assert!(!rising.crosses(&beside));
    }
}
