//! Culverts that the data have: reaches of rivers that run below what lies on them.
//!
//! The culverts that no map shows are not among them; [`land_of`](crate::land::land_of) infers those where a road crosses a stream.

use sandtable_draw::list::FeatureId;
use sandtable_geom::polyline::Polyline;

/// A reach of a river in a culvert.
#[derive(Clone, Debug, PartialEq)]
pub struct Culvert {
    /// The water's centerline in it, downstream, world X and Y.
    pub line: Polyline,
    /// The width of the water in meters.
    pub width_m: f64,
    /// The river's feature.
    pub feature: FeatureId,
}
