//! The skyline from an eye: in a direction, the steepest line from it to any ground.
//!
//! Ground is straight between two crossings of a line with edges of the finest triangles, and so the steepest ground lies at a
//! crossing. Curvature bends the ground between two crossings by less than a millimeter.

use std::ops::ControlFlow;

use glam::DVec2;

use crate::lattice::Lattice;
use crate::sight::Curvature;
use crate::sight::crossings::crossings;

/// An eye over the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkylineEye {
    /// Map coordinates in the lattice's system, meters.
    pub at: DVec2,
    /// Its elevation in meters.
    pub height_m: f64,
}

/// The ground that is seen against the sky in a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkylinePoint {
    /// Its rise over its distance, lowered by curvature: the tangent of its angle above the eye's horizontal.
    pub rise: f64,
    /// Its distance from the eye in plan, meters.
    pub distance_m: f64,
}

/// The skyline from `eye` toward `azimuth_rad`, clockwise from the map's north; `None` where no ground lies that way.
pub fn skyline(
    lattice: &Lattice,
    eye: SkylineEye,
    azimuth_rad: f64,
    curvature: Curvature,
) -> Option<SkylinePoint> {
    let extent = lattice.map_extent();
    let toward = DVec2::new(libm::sin(azimuth_rad), libm::cos(azimuth_rad));
    // Past the farthest corner: what is off the lattice costs nothing.
    let length_m = extent.size().length() + eye.at.distance(extent.min);
    let ends = [eye.at, eye.at + toward * length_m].map(|at| lattice.grid_from_map(at));
    let mut highest: Option<SkylinePoint> = None;
    let walk = crossings(lattice, ends[0], ends[1], |crossing| {
        let distance_m = crossing.part * length_m;
        let drop_m = curvature.drop_per_square_m() * distance_m * distance_m;
        let rise = (crossing.height_m - eye.height_m - drop_m) / distance_m;
        if highest.is_none_or(|highest| rise > highest.rise) && rise.is_finite() {
            highest = Some(SkylinePoint { rise, distance_m });
        }
        ControlFlow::<()>::Continue(())
    });
    debug_assert_eq!(walk, ControlFlow::Continue(()), "nothing breaks the walk");
    highest
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::query::{Interpolation, ground_height};

    /// Rough ground: 41 × 41 posts of 30 m.
    fn rough() -> Lattice {
        let mut state = 7u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let heights = (0..41 * 41).map(|_| 200.0 + 80.0 * random()).collect();
        Lattice::new(DVec2::new(5000.0, 9000.0), DVec2::splat(30.0), 41, heights).expect("a lattice")
    }

    #[test]
    fn a_lone_summit_stands_on_the_skyline_at_its_own_angle() {
        let mut heights = vec![0.0; 33 * 33];
        heights[16 * 33 + 28] = 120.0;
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(100.0), 33, heights).expect("a lattice");
        let eye = SkylineEye { at: DVec2::new(400.0, 1600.0), height_m: 20.0 };
        let east = skyline(&lattice, eye, FRAC_PI_2, Curvature::FLAT).expect("ground to the east");
        assert!(
            (east.rise - 100.0 / 2400.0).abs() < 1e-9 && (east.distance_m - 2400.0).abs() < 1e-6,
            "{east:?}"
        );
        let bent = skyline(&lattice, eye, FRAC_PI_2, Curvature::default()).expect("ground to the east");
        let drop_m = 2400.0f64.powi(2) * (6.0 / 7.0) / (2.0 * 6_371_008.8);
        assert!((bent.rise - (100.0 - drop_m) / 2400.0).abs() < 1e-9, "{bent:?}");
        let west = skyline(&lattice, eye, -FRAC_PI_2, Curvature::FLAT).expect("ground to the west");
        assert!((west.rise + 20.0 / 400.0).abs() < 1e-2, "level ground up to the border: {west:?}");
    }

    #[test]
    fn the_skyline_is_that_of_the_ground_in_small_steps() {
        let lattice = rough();
        let curvature = Curvature { radius_m: 50_000.0, refraction: 0.1 };
        let eye = SkylineEye { at: DVec2::new(5411.0, 9577.0), height_m: 290.0 };
        for degrees in (0..360).step_by(7) {
            let azimuth = f64::from(degrees) * PI / 180.0;
            let toward = DVec2::new(azimuth.sin(), azimuth.cos());
            let rise = |step: u32| {
                let distance_m = f64::from(step) * 0.05;
                let height = ground_height(&lattice, Interpolation::Planar, eye.at + toward * distance_m);
                let drop_m = distance_m * distance_m * 0.9 / 100_000.0;
                height.height_m().map(|height_m| (height_m - eye.height_m - drop_m) / distance_m)
            };
            let stepped = (200..40_000).filter_map(rise).fold(f64::NEG_INFINITY, f64::max);
            let found = skyline(&lattice, eye, azimuth, curvature).expect("ground all around");
            assert!((found.rise - stepped).abs() < 2e-3, "{degrees}°: {} against {stepped}", found.rise);
        }
    }

    #[test]
    fn off_the_lattice_there_is_a_skyline_only_toward_it() {
        let lattice = rough();
        let eye = SkylineEye { at: DVec2::new(2000.0, 9600.0), height_m: 290.0 };
        assert!(skyline(&lattice, eye, FRAC_PI_2, Curvature::FLAT).is_some());
        assert_eq!(skyline(&lattice, eye, -FRAC_PI_2, Curvature::FLAT), None);
    }
}
