//! Where a ray meets the ground, for the pointer and for what is hidden behind hills.
//!
//! A step is a fraction of a cell near the eye and grows with the distance: what is missed is smaller than a pixel. The
//! height there is a question to the ground of its own.

use glam::Vec3;

use crate::terrain::lattice::Lattice;
use crate::terrain::query::{Interpolation, ground_height};

/// The first step, in cells.
const STEP_CELLS: f32 = 0.5;
/// A step, as a share of the distance: four pixels of a picture a thousand pixels high.
const STEP_SHARE: f32 = 0.004;
/// Halvings of the step in which the ray goes under ground: a thousandth of it.
const HALVINGS: usize = 10;
/// The most steps: on any ground some tens of thousands suffice.
const MOST_STEPS: usize = 50_000;

/// The world Z of the ground at world X and Y; `None` where there is none.
pub fn ground_z(lattice: &Lattice, at: Vec3) -> Option<f32> {
    let map = lattice.origin() + at.truncate().as_dvec2();
    ground_height(lattice, Interpolation::Planar, map).height_m().map(|height_m| height_m as f32)
}

/// The first point of the ray from `from` along the unit vector `direction` that lies on the ground, no farther than
/// `longest_m`; heights are those that are drawn.
pub fn ground_hit(lattice: &Lattice, from: Vec3, direction: Vec3, longest_m: f32) -> Option<Vec3> {
    let first = lattice.cell().min_element() as f32 * STEP_CELLS;
    let above = |at: Vec3| ground_z(lattice, at).map(|ground| at.z - ground);
    let (mut near, mut was_above) = (0.0, above(from).is_some_and(|above| above >= 0.0));
    for _ in 0..MOST_STEPS {
        if near >= longest_m {
            return None;
        }
        let far = near + first.max(near * STEP_SHARE);
        match above(from + direction * far) {
            Some(above) if above < 0.0 && was_above => {
                return Some(halved(from, direction, (near, far), above_ground(lattice)));
            }
            found => was_above = found.is_some_and(|above| above >= 0.0),
        }
        near = far;
    }
    None
}

fn above_ground(lattice: &Lattice) -> impl Fn(Vec3) -> bool + '_ {
    |at| ground_z(lattice, at).is_none_or(|ground| at.z >= ground)
}

fn halved(
    from: Vec3,
    direction: Vec3,
    (mut near, mut far): (f32, f32),
    is_above: impl Fn(Vec3) -> bool,
) -> Vec3 {
    for _ in 0..HALVINGS {
        let middle = (near + far) * 0.5;
        if is_above(from + direction * middle) { near = middle } else { far = middle }
    }
    from + direction * near
}

/// Whether no ground lies between two points, but for what is within `slack_m` of either.
pub fn is_in_sight(lattice: &Lattice, from: Vec3, to: Vec3, slack_m: f32) -> bool {
    let distance = from.distance(to);
    let Some(direction) = (to - from).try_normalize() else { return true };
    ground_hit(lattice, from, direction, distance - slack_m).is_none()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    /// Level ground at 0 m with a wall 50 m high at X from 400 to 500 m.
    fn wall() -> Lattice {
        let heights = (0..101 * 101).map(|post| if (40..=50).contains(&(post % 101)) { 50.0 } else { 0.0 });
        Lattice::new(DVec2::new(1e5, 2e5), DVec2::splat(10.0), 101, heights.collect()).expect("sound")
    }

    #[test]
    fn a_ray_meets_the_wall_above_level_ground_and_the_ground_before_it() {
        let ground = wall();
        let from = Vec3::new(100.0, 500.0, 20.0);
        let hit = ground_hit(&ground, from, Vec3::X, 5e3).expect("the wall");
        assert!((hit.x - 394.0).abs() < 0.1 && hit.z == 20.0, "{hit}");
        let down = Vec3::new(1.0, 0.0, -0.2).normalize();
        let hit = ground_hit(&ground, from, down, 5e3).expect("the ground");
        assert!((hit.x - 200.0).abs() < 0.2 && hit.z.abs() < 0.1, "{hit}");
        assert_eq!(ground_hit(&ground, from, Vec3::Z, 5e3), None);
    }

    #[test]
    fn what_stands_behind_the_wall_is_not_in_sight_and_what_stands_on_it_is() {
        let ground = wall();
        let eye = Vec3::new(100.0, 500.0, 20.0);
        assert!(!is_in_sight(&ground, eye, Vec3::new(800.0, 500.0, 30.0), 5.0));
        assert!(is_in_sight(&ground, eye, Vec3::new(450.0, 500.0, 90.0), 5.0));
        assert!(is_in_sight(&ground, eye, Vec3::new(300.0, 500.0, 0.0), 5.0));
    }
}
