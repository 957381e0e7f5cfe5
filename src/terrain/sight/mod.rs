//! Lines of sight and viewsheds over the ground, with the Earth's curvature and refraction.
//!
//! The ground is planar on the finest triangles. A line of sight runs from a point above the ground to another; it is
//! blocked where, at a crossing with an edge of those triangles strictly between its ends, the ground is higher than the
//! line. The Earth's curvature lowers everything at distance `d` from the observer by `(1 − k) d² / 2R`, applied at the
//! crossings and at the target. Between two crossings the lowered ground counts as straight, wrong by less than
//! `(1 − k) l² / 8R` for crossings `l` apart, 2 µm at 10 m.
//!
//! **One definition.** [`line::line_of_sight`] is it. Every faster answer must equal it to the last bit, and tests check
//! that: [`ground::SightGround`] is faster by a [`Pyramid`](crate::pyramid::Pyramid) of the highest and lowest posts.
//!
//! ```text
//! crossings ─► line, rise (one line, all of it) ─► outlook (the visible stretches of a line)
//!     │         ║ the same answers
//!     └─► descent ─► ground (batches), ray ◄─ pyramid
//! ```

pub mod crossings;
pub(crate) mod descent;
pub mod ground;
pub mod line;
pub mod outlook;
pub mod ray;
pub mod rise;
pub mod skyline;
pub mod viewshed;

/// The Earth's shape and the refraction of its air along a line of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvature {
    /// The Earth's radius in meters; infinite for a flat one.
    pub radius_m: f64,
    /// The refraction coefficient k, the share of the curvature that refraction cancels: 0 for none.
    pub refraction: f64,
}

impl Default for Curvature {
    /// The mean radius, and 1/7 as surveyors and GDAL (`-cc 0.85714`) take for visible light.
    fn default() -> Self {
        Self { radius_m: 6_371_008.8, refraction: 1.0 / 7.0 }
    }
}

impl Curvature {
    /// A flat Earth without air.
    pub const FLAT: Self = Self { radius_m: f64::INFINITY, refraction: 0.0 };

    /// The drop of the ground below the observer's horizontal in meters, per square meter of distance.
    pub fn drop_per_square_m(self) -> f64 {
        (1.0 - self.refraction) / (2.0 * self.radius_m)
    }
}
