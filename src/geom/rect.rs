//! An axis-aligned rectangle in map or world coordinates.

use glam::DVec2;

/// A closed rectangle `min..=max`. Empty where `min` exceeds `max` on either axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// South-west corner.
    pub min: DVec2,
    /// North-east corner.
    pub max: DVec2,
}

impl Rect {
    /// The rectangle that holds nothing: the start of every union.
    pub const EMPTY: Self = Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };

    /// The smallest rectangle around `points`; [`Rect::EMPTY`] for none.
    pub fn around(points: impl IntoIterator<Item = DVec2>) -> Self {
        points.into_iter().fold(Self::EMPTY, |rect, point| rect.with(point))
    }

    /// This rectangle grown to hold `point`.
    pub fn with(self, point: DVec2) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// This rectangle grown by `margin` on all four sides.
    pub fn grown(self, margin: f64) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// Whether nothing lies inside.
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x || self.min.y > self.max.y
    }

    /// Whether `point` lies inside or on the border.
    pub fn contains(&self, point: DVec2) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    /// Whether the two share at least a border point.
    pub fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// Width and height; negative where empty.
    pub fn size(&self) -> DVec2 {
        self.max - self.min
    }

    /// The middle; NaN where empty.
    pub fn center(&self) -> DVec2 {
        (self.min + self.max) * 0.5
    }
}
