//! The curvature of the ground, from the quadratic surface that fits the nine heights of a window best (Evans 1980).
//!
//! With the first derivatives p, q and the second r, s, t of that surface, and `g = p² + q²`:
//!
//! ```text
//! profile     −(p²r + 2pqs + q²t) / (g (1 + g)^1.5)      along the fall line
//! tangential  −(q²r − 2pqs + p²t) / (g (1 + g)^0.5)      across it, normal section
//! plan        −(q²r − 2pqs + p²t) / g^1.5                of the contour
//! mean        −((1 + q²)r − 2pqs + (1 + p²)t) / (2 (1 + g)^1.5)
//! ```
//!
//! All are positive on convex ground (definitions after Minár, Evans and Jenčo 2020, with the sign of convexity).

use super::window::{WindowHeights, by_window};
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{Outcome, OutcomeRaster, PostValues};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// The curvature at each post, per kilometer, positive on convex ground; no data at the border and beside posts without
/// data. Profile, plan and tangential curvature are 0 on level ground, which has no fall line.
///
/// # Errors
/// None but [`AnalysisError::Stopped`].
pub(crate) fn curvature(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let fit = QuadraticFit::new(&land.ground);
    let curve = match &*arguments.word("direction") {
        "plan" => SurfaceDerivatives::plan,
        "tangential" => SurfaceDerivatives::tangential,
        "mean" => SurfaceDerivatives::mean,
        _ => SurfaceDerivatives::profile,
    };
    let values = by_window(&land.ground, stop, |window| (curve(&fit.of(window)) * 1000.0) as f32)?;
    let values = PostValues::Numbers(values);
    let raster = OutcomeRaster { name: "curvature", unit: "1/km", values, classes: Vec::new() };
    Ok(Outcome { raster: Some(raster), ..Outcome::default() })
}

/// Fits a quadratic surface to windows of a lattice.
struct QuadraticFit {
    east_m: f64,
    north_m: f64,
}

/// Derivatives of the ground at a post: `r`, `s` and `t` per meter.
struct SurfaceDerivatives {
    p: f64,
    q: f64,
    r: f64,
    s: f64,
    t: f64,
}

impl QuadraticFit {
    fn new(lattice: &Lattice) -> Self {
        Self { east_m: lattice.cell().x, north_m: lattice.cell().y }
    }

    fn of(&self, window: &WindowHeights) -> SurfaceDerivatives {
        // Differences from the middle are exact, or nearly so; the constant has no effect on derivatives.
        let w = window.map(|height| f64::from(height) - f64::from(window[4]));
        let (west, east) = (w[0] + w[3] + w[6], w[2] + w[5] + w[8]);
        let (south, north) = (w[0] + w[1] + w[2], w[6] + w[7] + w[8]);
        let (middle_column, middle_row) = (w[1] + w[7], w[3] + w[5]);
        SurfaceDerivatives {
            p: (east - west) / (6.0 * self.east_m),
            q: (north - south) / (6.0 * self.north_m),
            r: (east + west - 2.0 * middle_column) / (3.0 * self.east_m * self.east_m),
            s: (w[8] + w[0] - w[2] - w[6]) / (4.0 * self.east_m * self.north_m),
            t: (north + south - 2.0 * middle_row) / (3.0 * self.north_m * self.north_m),
        }
    }
}

impl SurfaceDerivatives {
    fn steepness(&self) -> f64 {
        self.p * self.p + self.q * self.q
    }

    /// The second derivative along the contour, times the steepness, negative where convex.
    fn across(&self) -> f64 {
        self.q * self.q * self.r - 2.0 * self.p * self.q * self.s + self.p * self.p * self.t
    }

    fn profile(&self) -> f64 {
        let along = self.p * self.p * self.r + 2.0 * self.p * self.q * self.s + self.q * self.q * self.t;
        self.over(along, |g| g * (1.0 + g) * (1.0 + g).sqrt())
    }

    fn tangential(&self) -> f64 {
        self.over(self.across(), |g| g * (1.0 + g).sqrt())
    }

    fn plan(&self) -> f64 {
        self.over(self.across(), |g| g * g.sqrt())
    }

    fn mean(&self) -> f64 {
        let g = 1.0 + self.steepness();
        let bend = self.r + self.t + self.across();
        -bend / (2.0 * g * g.sqrt())
    }

    /// `−bend / divisor(g)`; 0 on level ground.
    fn over(&self, bend: f64, divisor: impl Fn(f64) -> f64) -> f64 {
        let divisor = divisor(self.steepness());
        if divisor > 0.0 { -bend / divisor } else { divisor * 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::window::tests::{land, values};

    /// The middle of a quadratic surface with these derivatives, with cells of 10 m by 20 m.
    fn middle(direction: &str, [p, q, r, s, t]: [f64; 5]) -> f32 {
        let height = |index: i32| {
            let (x, y) = (f64::from(index % 3 - 1) * 10.0, f64::from(index / 3 - 1) * 20.0);
            (p * x + q * y + 0.5 * r * x * x + s * x * y + 0.5 * t * y * y) as f32
        };
        let land = land(DVec2::new(10.0, 20.0), 3, (0..9).map(height).collect());
        values(&land, "curvature", &[("direction", direction)], &[])[4]
    }

    #[test]
    fn curvatures_of_quadratic_surfaces_are_exact() {
        // A ridge along north that falls north by 1: only its cross-section bends.
        let ridge = [0.0, -1.0, -0.01, 0.0, 0.0];
        let near =
            |value: f32, wanted: f64| assert!((f64::from(value) - wanted).abs() < 1e-4, "{value} {wanted}");
        near(middle("profile", ridge), 0.0);
        near(middle("plan", ridge), 10.0);
        near(middle("tangential", ridge), 10.0 / 2f64.sqrt());
        // (1 + q²) r / 2 over 2^1.5
        near(middle("mean", ridge), 2.0 * 10.0 / 2.0 / 8f64.sqrt());
        // A slope that grows steeper downhill to the east is convex in profile: 10 / 2^1.5.
        let brow = [-1.0, 0.0, -0.01, 0.0, 0.0];
        near(middle("profile", brow), 10.0 / 8f64.sqrt());
        near(middle("plan", brow), 0.0);
        // A twist alone: along the diagonal 2pqs = 2·0.5·0.5·0.004 = 0.002 over 0.5 · 1.5^1.5.
        let twist = [0.5, 0.5, 0.0, 0.004, 0.0];
        near(middle("profile", twist), -2.0 / (0.5 * 1.5f64.powf(1.5)));
        near(middle("plan", twist), 2.0 / 0.5f64.powf(1.5));
    }

    #[test]
    fn a_summit_has_its_mean_curvature_and_no_direction() {
        let summit = [0.0, 0.0, -0.02, 0.0, -0.01];
        assert!((middle("mean", summit) - 15.0).abs() < 1e-3);
        assert_eq!(middle("profile", summit), 0.0);
        assert_eq!(middle("plan", summit), 0.0);
    }
}
