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
    /// The empty rectangle, neutral in unions.
    pub const EMPTY: Self = Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };

    /// The smallest rectangle around `points`; [`Rect::EMPTY`] for none.
    pub fn around(points: impl IntoIterator<Item = DVec2>) -> Self {
        points.into_iter().fold(Self::EMPTY, |rect, point| rect.with(point))
    }

    /// The smallest rectangle that holds this one and `point`.
    pub fn with(self, point: DVec2) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The intersection of this rectangle and `other`; possibly empty.
    pub fn intersection(&self, other: &Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Its corners, the middles of its sides and its center: enough for its box in another coordinate system where it is
    /// not much curved there.
    pub fn grid_points(&self) -> impl Iterator<Item = DVec2> + use<> {
        let (min, half) = (self.min, self.size() / 2.0);
        (0..9u8).map(move |index| min + half * DVec2::new(f64::from(index % 3), f64::from(index / 3)))
    }

    /// This rectangle extended by `margin` on all four sides.
    pub fn grown(self, margin: f64) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// Whether it holds no point.
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x || self.min.y > self.max.y
    }

    /// Whether `point` lies inside or on the border.
    pub fn contains(&self, point: DVec2) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    /// Whether all of `other` lies inside or on the border.
    pub fn contains_rect(&self, other: &Self) -> bool {
        self.contains(other.min) && self.contains(other.max)
    }

    /// Whether the two have at least a border point in common.
    pub fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// The part of the line from `from` to `to` that lies inside; `None` where there is none (Liang and Barsky 1984). An
    /// end that lies inside comes back as it is.
    pub fn clip_line(&self, from: DVec2, to: DVec2) -> Option<(DVec2, DVec2)> {
        let along = to - from;
        let at = |part: f64| if part == 1.0 { to } else { from + along * part };
        self.clip_ray(from, along, (0.0, 1.0)).map(|(enter, leave)| (at(enter), at(leave)))
    }

    /// The part of the ray `from + along * part` that lies inside, as its parts, out of those from `enter` to `leave`; `None`
    /// where there is none.
    pub fn clip_ray(
        &self,
        from: DVec2,
        along: DVec2,
        (mut enter, mut leave): (f64, f64),
    ) -> Option<(f64, f64)> {
        for axis in 0..2 {
            let (low, high) = (self.min[axis] - from[axis], self.max[axis] - from[axis]);
            if along[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (first, last) = (low / along[axis], high / along[axis]);
            enter = first.min(last).max(enter);
            leave = first.max(last).min(leave);
        }
        (enter <= leave).then_some((enter, leave))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_clipped_to_its_part_inside() {
        let rect = Rect { min: DVec2::ZERO, max: DVec2::new(10.0, 20.0) };
        let inside = (DVec2::new(1.0, 2.0), DVec2::new(9.0, 19.0));
        assert_eq!(rect.clip_line(inside.0, inside.1), Some(inside));
        let through = rect.clip_line(DVec2::new(-10.0, 5.0), DVec2::new(30.0, 5.0));
        assert_eq!(through, Some((DVec2::new(0.0, 5.0), DVec2::new(10.0, 5.0))));
        assert_eq!(rect.clip_line(DVec2::new(-5.0, 15.0), DVec2::new(5.0, 35.0)), None);
        assert_eq!(rect.clip_line(DVec2::new(11.0, 0.0), DVec2::new(11.0, 20.0)), None);
    }
}
