//! Clips triangles to the view.
//!
//! A triangle is cut at the near plane, where the division by `w` would fail, and at a guard band far outside the
//! picture, beyond which sub-pixel coordinates would overflow (Sutherland and Hodgman 1974). A crossing is computed
//! from the inner end of an edge to the outer one, so that both triangles of an edge get the same corner and no crack
//! opens.

use glam::DVec3;

use crate::cpu::screen::Screen;

/// How far outside the picture corners may lie, in pixels. Wide, so that few triangles are cut; narrow enough that
/// corners of a 16384-pixel picture fit an i32 at [`crate::cpu::raster::SUBPIXEL_BITS`] and their products an
/// i64.
const GUARD_PX: f64 = 8192.0;

/// A triangle cut at five planes has at most this many corners.
pub const MOST_CORNERS: usize = 8;

#[derive(Clone, Copy, Debug)]
pub struct Outline {
    corners: [DVec3; MOST_CORNERS],
    count: usize,
}

impl Outline {
    fn whole(corners: &[DVec3; 3]) -> Self {
        let mut outline = Self { corners: [DVec3::ZERO; MOST_CORNERS], count: 0 };
        corners.iter().for_each(|&corner| outline.push(corner));
        outline
    }

    /// The corners in order; fewer than three where nothing is left.
    pub fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    fn push(&mut self, corner: DVec3) {
        // Rounding can make an outline cross a plane more than twice; corners that exceed the array are dropped.
        if self.count < MOST_CORNERS {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }

    /// The part where `inside` is not negative.
    fn cut(&self, inside: impl Fn(DVec3) -> f64) -> Self {
        let mut kept = Self { corners: self.corners, count: 0 };
        for (index, &here) in self.corners().iter().enumerate() {
            let next = self.corners[(index + 1) % self.count];
            let (from, to) = (inside(here), inside(next));
            if from >= 0.0 {
                kept.push(here);
            }
            if from >= 0.0 && to < 0.0 {
                kept.push(crossing(here, from, next, to));
            } else if from < 0.0 && to >= 0.0 {
                kept.push(crossing(next, to, here, from));
            }
        }
        kept
    }
}

/// The point between `inner` and `outer` where the distances `d_inner >= 0 > d_outer` meet zero.
fn crossing(inner: DVec3, d_inner: f64, outer: DVec3, d_outer: f64) -> DVec3 {
    inner + (outer - inner) * (d_inner / (d_inner - d_outer))
}

/// The part of a triangle that may be on the picture.
pub enum SeenPart {
    /// All of it.
    Whole,
    /// What is left of it. Few triangles are cut, and an outline is large beside one.
    Cut(Box<Outline>),
}

/// The part of the triangle before the near plane and inside the guard band, or `None` where it is off the picture.
/// Corners are homogeneous pixels and must be finite; parallel rays have no near plane.
pub fn clipped(corners: &[DVec3; 3], screen: &Screen) -> Option<SeenPart> {
    let [width, height] = screen.size.map(f64::from);
    let all = |outside: &dyn Fn(&DVec3) -> bool| corners.iter().all(outside);
    let (near, far) = if screen.is_parallel { (0.0, f64::INFINITY) } else { (screen.near, screen.far) };
    if all(&|p| p.z < near)
        || all(&|p| p.z > far)
        || all(&|p| p.x < 0.0)
        || all(&|p| p.x > width * p.z)
        || all(&|p| p.y < 0.0)
        || all(&|p| p.y > height * p.z)
    {
        return None;
    }
    let [low, right, bottom] = [-GUARD_PX, width + GUARD_PX, height + GUARD_PX];
    let fits = |p: &DVec3| {
        p.z >= near && p.x >= low * p.z && p.y >= low * p.z && p.x <= right * p.z && p.y <= bottom * p.z
    };
    if corners.iter().all(fits) {
        return Some(SeenPart::Whole);
    }
    let outline = Outline::whole(corners)
        .cut(|p| p.z - near)
        .cut(|p| p.x - low * p.z)
        .cut(|p| right * p.z - p.x)
        .cut(|p| p.y - low * p.z)
        .cut(|p| bottom * p.z - p.y);
    (outline.count >= 3).then(|| SeenPart::Cut(Box::new(outline)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use sandtable_view::camera::Camera;

    fn screen() -> Screen {
        Screen::new(&Camera::new(Vec3::ZERO, Vec3::Y, 1.0, (100, 100), (1.0, 1000.0)).expect("sound"))
    }

    fn cut(corners: [DVec3; 3]) -> Box<Outline> {
        match clipped(&corners, &screen()) {
            Some(SeenPart::Cut(outline)) => outline,
            Some(SeenPart::Whole) => panic!("{corners:?} is not cut"),
            None => panic!("{corners:?} is not in view"),
        }
    }

    #[test]
    fn a_triangle_in_view_is_left_alone() {
        let corners = [(10.0, 10.0), (50.0, 10.0), (10.0, 50.0)].map(|(x, y)| DVec3::new(x, y, 1.0) * 20.0);
        assert!(matches!(clipped(&corners, &screen()), Some(SeenPart::Whole)));
    }

    #[test]
    fn a_triangle_through_the_near_plane_keeps_what_lies_before_it() {
        let corners =
            [DVec3::new(500.0, 500.0, 10.0), DVec3::new(300.0, 200.0, -5.0), DVec3::new(200.0, 300.0, -5.0)];
        let outline = cut(corners);
        assert_eq!(outline.corners().len(), 3);
        assert!(outline.corners().iter().all(|corner| corner.z >= 1.0 - 1e-12));
    }

    #[test]
    fn a_gigantic_triangle_is_cut_to_the_guard_band() {
        let corners =
            [DVec3::new(-1e30, -1e30, 2.0), DVec3::new(1e30, -1e30, 2.0), DVec3::new(0.0, 1e30, 2.0)];
        let outline = cut(corners);
        let farthest = outline.corners().iter().map(|p| (p.x / p.z).abs().max((p.y / p.z).abs()));
        assert!(farthest.fold(0.0, f64::max) < 8293.0);
    }

    #[test]
    fn two_triangles_of_an_edge_get_the_same_crossings() {
        let [a, b] = [DVec3::new(700.0, 90.0, 9.0), DVec3::new(-4e6, 3e5, -3.0)];
        let [c, d] = [DVec3::new(100.0, 900.0, 12.0), DVec3::new(900.0, 20.0, 11.0)];
        let first = cut([a, b, c]);
        let second = cut([b, a, d]);
        let shared = first.corners().iter().filter(|corner| second.corners().contains(corner)).count();
        assert_eq!(shared, 2, "{:?} and {:?}", first.corners(), second.corners());
    }

    #[test]
    fn triangles_entirely_outside_are_dropped() {
        let beside = [(-10.0, 10.0), (-50.0, 10.0), (-10.0, 50.0)].map(|(x, y)| DVec3::new(x, y, 5.0));
        assert!(clipped(&beside, &screen()).is_none());
        let behind = [(10.0, 10.0), (50.0, 10.0), (10.0, 50.0)].map(|(x, y)| DVec3::new(x, y, -5.0));
        assert!(clipped(&behind, &screen()).is_none());
    }
}
