//! The gradient of the ground at a point, and from it the normal, the slope and the aspect.
//!
//! The planar surface has the gradient of its triangle; it steps at edges, where the southern triangle at a diagonal and
//! the cell of [`Lattice::cell_at`] count. A bilinear patch has `∂h/∂x = (1−y)(se − sw) + y(ne − nw)`,
//! `∂h/∂y = (1−x)(nw − sw) + x(ne − se)`, continuous within a cell. A constant cell has no gradient, and distance-weighted
//! patches have a cusp at every post, so neither is offered.

use glam::{DVec2, DVec3};

use crate::cell_triangle::{CellTriangle, Diagonal};
use crate::lattice::Lattice;
use sandtable_raster::answer::Status;

/// The surface between the posts whose gradient is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GradientSurface {
    /// The finest triangles.
    #[default]
    Planar,
    /// The bilinear patches.
    Bilinear,
}

/// Meters of rise per meter, eastward and northward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gradient(pub DVec2);

impl Gradient {
    /// The upward normal, of length 1; X east, Y north, Z up.
    pub fn normal(self) -> DVec3 {
        (-self.0).extend(1.0).normalize()
    }

    /// The angle from the horizontal in degrees, 0..90.
    pub fn slope_deg(self) -> f64 {
        libm::atan(self.0.length()).to_degrees()
    }

    /// Meters of rise per hundred meters in the steepest direction, at least 0: 100 at 45°.
    pub fn slope_percent(self) -> f64 {
        self.0.length() * 100.0
    }

    /// The direction that the ground faces, downhill: degrees clockwise from north, 0..360; `None` where it is level.
    pub fn aspect_deg(self) -> Option<f64> {
        if self.0 == DVec2::ZERO {
            return None;
        }
        let degrees = libm::atan2(-self.0.x, -self.0.y).to_degrees().rem_euclid(360.0);
        // The remainder of a tiny negative angle rounds to 360.
        Some(if degrees < 360.0 { degrees } else { 0.0 })
    }
}

/// The gradient of the ground at a map position.
///
/// # Errors
/// [`Status::NoData`] where a corner of the triangle, or of the bilinear cell, has no data, [`Status::Outside`] beyond
/// the lattice.
pub fn ground_gradient(lattice: &Lattice, patch: GradientSurface, at: DVec2) -> Result<Gradient, Status> {
    let (cell, part) = lattice.cell_at(at - lattice.origin()).ok_or(Status::Outside)?;
    let corners = lattice.corner_heights(cell).map(f64::from);
    let per_cell = match patch {
        GradientSurface::Planar => CellTriangle::holding(Diagonal::of_cell(cell), part).slope(corners),
        GradientSurface::Bilinear => {
            let (DVec2 { x, y }, [sw, se, nw, ne]) = (part, corners);
            DVec2::new((1.0 - y) * (se - sw) + y * (ne - nw), (1.0 - x) * (nw - sw) + x * (ne - se))
        }
    };
    let gradient = per_cell / lattice.cell();
    if gradient.is_nan() { Err(Status::NoData) } else { Ok(Gradient(gradient)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::{Interpolation, ground_height};

    const PATCHES: [GradientSurface; 2] = [GradientSurface::Planar, GradientSurface::Bilinear];

    fn lattice(cell_m: f64, side: u32, height: impl Fn(DVec2) -> f64) -> Lattice {
        let at = |index: u32| DVec2::new(f64::from(index % side), f64::from(index / side)) * cell_m;
        let heights = (0..side * side).map(|index| height(at(index)) as f32).collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(cell_m), side, heights).expect("sound")
    }

    #[test]
    fn the_compass_is_right() {
        for (rise, aspect) in [
            (DVec2::new(0.0, -1.0), 0.0),
            (DVec2::new(-1.0, -1.0), 45.0),
            (DVec2::new(-1.0, 0.0), 90.0),
            (DVec2::new(0.0, 1.0), 180.0),
            (DVec2::new(1.0, 0.0), 270.0),
        ] {
            let found = Gradient(rise).aspect_deg().expect("not level");
            assert!((found - aspect).abs() < 1e-12, "{rise} faces {found}");
        }
        assert_eq!(Gradient(DVec2::ZERO).aspect_deg(), None);
        assert_eq!(Gradient(DVec2::new(1e-300, -1.0)).aspect_deg(), Some(0.0), "never 360");
        assert_eq!(Gradient(DVec2::new(3.0, 4.0)).slope_percent(), 500.0);
        assert!((Gradient(DVec2::new(0.6, 0.8)).slope_deg() - 45.0).abs() < 1e-12);
    }

    #[test]
    fn a_plane_has_one_gradient() {
        let ground = lattice(8.0, 9, |at| 100.0 + 0.25 * at.x - 0.5 * at.y);
        for step in 0..200 {
            let at = DVec2::new(f64::from(step * 37 % 640) / 10.0, f64::from(step * 53 % 640) / 10.0);
            for patch in PATCHES {
                let found = ground_gradient(&ground, patch, at).expect("inside");
                assert_eq!(found.0, DVec2::new(0.25, -0.5), "{patch:?} at {at}");
                assert_eq!(found.normal(), DVec3::new(-0.25, 0.5, 1.0).normalize());
            }
        }
    }

    #[test]
    fn a_cone_faces_away_from_its_top_and_is_equally_steep_all_around() {
        let top = DVec2::splat(500.0);
        let ground = lattice(1.0, 1001, |at| 300.0 - 0.5 * at.distance(top));
        for step in 0..360 {
            let azimuth = f64::from(step).to_radians();
            let at = top + DVec2::new(libm::sin(azimuth), libm::cos(azimuth)) * 321.7;
            for patch in PATCHES {
                let found = ground_gradient(&ground, patch, at).expect("inside");
                let off =
                    (found.aspect_deg().expect("steep") - f64::from(step) + 180.0).rem_euclid(360.0) - 180.0;
                assert!(off.abs() < 0.2, "{patch:?}: {off}° off at {step}°");
                assert!((found.slope_percent() - 50.0).abs() < 0.1, "{patch:?} at {step}°");
            }
        }
    }

    #[test]
    fn on_a_sinusoid_the_gradient_is_the_cosine_within_a_cells_curvature() {
        let wave = 0.01;
        let ground = lattice(2.0, 401, |at| 100.0 * libm::sin(at.x * wave) + 50.0 * libm::cos(at.y * wave));
        for step in 0..500 {
            let at = DVec2::new(f64::from(step * 97 % 8000) / 10.0, f64::from(step * 61 % 8000) / 10.0);
            let exact = DVec2::new(100.0 * libm::cos(at.x * wave), -50.0 * libm::sin(at.y * wave)) * wave;
            for patch in PATCHES {
                let found = ground_gradient(&ground, patch, at).expect("inside").0;
                // A cell of 2 m curves by at most 100 · wave² · 2 m.
                assert!((found - exact).length() < 0.0225, "{patch:?} at {at}: {found} for {exact}");
            }
        }
    }

    #[test]
    fn the_gradient_is_that_of_the_heights_around_the_point() {
        let ground =
            lattice(10.0, 12, |at| libm::sin(at.x * 0.37) * 20.0 + libm::cos(at.y * 0.71 + at.x * 0.2) * 9.0);
        let step = 1e-4;
        for (patch, interpolation) in [
            (GradientSurface::Planar, Interpolation::Planar),
            (GradientSurface::Bilinear, Interpolation::Bilinear),
        ] {
            for index in 0..300 {
                let at = DVec2::new(f64::from(index * 29 % 109) + 0.137, f64::from(index * 43 % 109) + 0.271);
                let height =
                    |to: DVec2| ground_height(&ground, interpolation, at + to).height_m().expect("inside");
                let slopes = DVec2::new(
                    height(DVec2::X * step) - height(-DVec2::X * step),
                    height(DVec2::Y * step) - height(-DVec2::Y * step),
                ) / (2.0 * step);
                let found = ground_gradient(&ground, patch, at).expect("inside").0;
                assert!((found - slopes).length() < 1e-6, "{patch:?} at {at}: {found} for {slopes}");
            }
        }
    }

    #[test]
    fn a_hole_and_the_edge_have_different_statuses() {
        let holed = lattice(1.0, 4, |at| if at == DVec2::ONE { f64::NAN } else { 0.0 });
        for patch in PATCHES {
            assert_eq!(ground_gradient(&holed, patch, DVec2::splat(0.9)), Err(Status::NoData));
            assert_eq!(ground_gradient(&holed, patch, DVec2::splat(-0.1)), Err(Status::Outside));
            assert_eq!(ground_gradient(&holed, patch, DVec2::splat(2.5)), Ok(Gradient(DVec2::ZERO)));
        }
    }
}
