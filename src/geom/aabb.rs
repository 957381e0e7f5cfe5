//! An axis-aligned box in three dimensions, and the sphere around it.

use glam::Vec3;

/// A closed box `min..=max`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Aabb {
    /// The corner with the least coordinates.
    pub min: Vec3,
    /// The corner with the greatest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The smallest box around `points`; `None` for no points.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Option<Self> {
        let boxes = points.into_iter().map(|point| Self { min: point, max: point });
        boxes.reduce(|one, other| Self { min: one.min.min(other.min), max: one.max.max(other.max) })
    }

    /// The middle.
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// The lengths of the sides.
    pub fn size(&self) -> Vec3 {
        self.max - self.min
    }

    /// The point of the box that is nearest to `at`.
    pub fn nearest_to(&self, at: Vec3) -> Vec3 {
        at.clamp(self.min, self.max)
    }

    /// The corner of the box that is farthest from `at`.
    pub fn farthest_from(&self, at: Vec3) -> Vec3 {
        Vec3::select((at - self.min).abs().cmpgt((at - self.max).abs()), self.min, self.max)
    }

    /// The eight corners.
    pub fn corners(&self) -> impl Iterator<Item = Vec3> + use<> {
        let ends = [self.min, self.max];
        (0..8).map(move |corner: usize| {
            Vec3::new(ends[corner & 1].x, ends[corner >> 1 & 1].y, ends[corner >> 2].z)
        })
    }

    /// The radius of the sphere through the corners.
    pub fn radius(&self) -> f32 {
        self.size().length() * 0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_holds_its_points_and_there_is_none_around_nothing() {
        let bounds = Aabb::around([Vec3::new(1.0, 4.0, 0.0), Vec3::new(3.0, 0.0, 4.0)]).expect("two points");
        assert_eq!((bounds.min, bounds.max), (Vec3::new(1.0, 0.0, 0.0), Vec3::new(3.0, 4.0, 4.0)));
        assert_eq!((bounds.center(), bounds.radius()), (Vec3::splat(2.0), 3.0));
        assert_eq!(Aabb::around([]), None);
    }

    #[test]
    fn a_box_is_nearest_on_its_side_and_farthest_at_a_corner() {
        let bounds = Aabb { min: Vec3::ZERO, max: Vec3::new(4.0, 3.0, 2.0) };
        let at = Vec3::new(1.0, 9.0, -1.0);
        assert_eq!(bounds.nearest_to(at), Vec3::new(1.0, 3.0, 0.0));
        assert_eq!(bounds.farthest_from(at), Vec3::new(4.0, 0.0, 2.0));
    }
}
