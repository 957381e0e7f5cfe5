//! Alignments of roads and rivers, and the vertical alignment of a whole network of roads.
//!
//! A road may not rise faster than its grade, should lie as near to the ground as that allows, and roads that meet must
//! agree. All three are one problem on a graph whose edges are sections of road, and it has a closed form:
//!
//! ```text
//!   ground ──► envelope: the lowest profile above it and the highest below it ──► fit: midway between
//!          ──► smoothed: vertical curves ──► spans: where fill or cut is too high, bridges and tunnels
//!          ──► once more without the ground that those pass over or under
//! ```
//!
//! Midway between the two envelopes no other profile of that grade has a lower highest fill or cut (McShane, "Extension
//! of range of functions", 1934: the envelopes are his extensions). Least squares would move less earth in the sum, at
//! the price of an iteration without a bound, and of deeper cuts at the worst place.

pub mod chain;
pub mod design;
pub mod envelope;
pub mod fit;
pub mod network;
pub mod spans;

use sandtable_geom::polyline::Polyline;
use sandtable_geom::profile::Profile;
use sandtable_geom::rect::Rect;

/// The support of a line: the ground, a bridge or a tunnel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Support {
    /// The ground.
    Ground,
    /// A bridge over it.
    Bridge,
    /// A tunnel under it.
    Tunnel,
}

impl Support {
    /// The word for it in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Ground => "ground",
            Self::Bridge => "bridge",
            Self::Tunnel => "tunnel",
        }
    }
}

/// A part of a line with one support.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportSpan {
    /// What carries it.
    pub support: Support,
    /// The station where it begins, in meters.
    pub from_m: f64,
    /// The station where it ends, above that.
    pub to_m: f64,
}

/// The width of a line, in meters, above 0.
#[derive(Clone, Debug, PartialEq)]
pub enum Width {
    /// One width everywhere.
    Constant(f64),
    /// Widths by station.
    Varying(Profile),
}

impl Width {
    /// The width at a station.
    pub fn at(&self, station_m: f64) -> f64 {
        match self {
            Self::Constant(width_m) => *width_m,
            Self::Varying(profile) => profile.at(station_m),
        }
    }

    /// The greatest width.
    pub fn widest_m(&self) -> f64 {
        match self {
            Self::Constant(width_m) => *width_m,
            Self::Varying(profile) => profile.values().iter().copied().fold(0.0, f64::max),
        }
    }

    /// Whether the width is the same everywhere.
    pub fn is_constant(&self) -> bool {
        match self {
            Self::Constant(_) => true,
            Self::Varying(profile) => profile.values().iter().all(|width_m| *width_m == profile.values()[0]),
        }
    }

    /// The width, `more_m` wider everywhere.
    pub fn grown(&self, more_m: f64) -> Self {
        match self {
            Self::Constant(width_m) => Self::Constant(width_m + more_m),
            Self::Varying(profile) => {
                let values = profile.values().iter().map(|width_m| width_m + more_m).collect();
                Profile::new(profile.stations().to_vec(), values)
                    .map_or(Self::Constant(more_m), Self::Varying)
            }
        }
    }

    /// The width along `part`, the part of the line that begins at station `from_m`.
    pub fn along(&self, part: &Polyline, from_m: f64) -> Self {
        let Self::Varying(profile) = self else { return self.clone() };
        let widths_m = part.stations().iter().map(|station| profile.at(from_m + station)).collect();
        Profile::new(part.stations().to_vec(), widths_m).map_or_else(|| self.clone(), Self::Varying)
    }
}

/// A line in world coordinates with its levels, width and support.
#[derive(Clone, Debug, PartialEq)]
pub struct Alignment {
    /// The centerline.
    pub line: Polyline,
    /// Its elevations in meters; `None` where it lies on the ground as that is, or they are not designed yet.
    pub level: Option<Profile>,
    /// How wide it is.
    pub width: Width,
    /// What carries it.
    pub support: Support,
}

/// Stations of an alignment nearer to each other than this are one, in meters.
const SAME_STATION_M: f64 = 1e-6;

impl Alignment {
    /// A line on the ground as it is, of one width.
    pub fn on_ground(line: Polyline, width_m: f64) -> Self {
        Self { line, level: None, width: Width::Constant(width_m), support: Support::Ground }
    }

    /// Whether the ground carries it.
    pub fn is_on_ground(&self) -> bool {
        self.support == Support::Ground
    }

    /// Its elevation at a station in meters; NaN where it has no levels.
    pub fn level_m(&self, station_m: f64) -> f64 {
        self.level.as_ref().map_or(f64::NAN, |level| level.at(station_m))
    }

    /// This alignment, `more_m` wider everywhere.
    pub fn widened(&self, more_m: f64) -> Self {
        Self { width: self.width.grown(more_m), ..self.clone() }
    }

    /// The part from where the line first enters `rect` to where it last leaves it; `None` where it passes by.
    pub fn within(&self, rect: &Rect) -> Option<Self> {
        let [from_m, to_m] = self.line.range_within(rect)?;
        let line = self.line.slice(from_m, to_m, SAME_STATION_M)?;
        let level = self.level.as_ref().map(|level| level.slice(from_m, to_m, SAME_STATION_M));
        let width = self.width.along(&line, from_m);
        Some(Self { line, level, width, support: self.support })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn line(points: &[(f64, f64)]) -> Polyline {
        Polyline::new(points.iter().map(|&at| DVec2::from(at)), 0.0).expect("a line")
    }

    #[test]
    fn a_line_is_kept_within_the_model_with_its_levels() {
        let line = line(&[(-10.0, 5.0), (10.0, 5.0), (30.0, 5.0), (90.0, 5.0)]);
        let level = Profile::new(line.stations().to_vec(), vec![0.0, 20.0, 40.0, 100.0]);
        let whole = Alignment { line, level, width: Width::Constant(6.0), support: Support::Bridge };
        let kept = whole.within(&Rect { min: DVec2::ZERO, max: DVec2::splat(50.0) }).expect("inside");
        let xs: Vec<f64> = kept.line.points().iter().map(|at| at.x).collect();
        assert_eq!(xs, [0.0, 10.0, 30.0, 50.0]);
        assert_eq!(kept.level.expect("levels").values(), [10.0, 20.0, 40.0, 60.0]);
        assert!(whole.within(&Rect { min: DVec2::splat(100.0), max: DVec2::splat(200.0) }).is_none());
    }

    #[test]
    fn a_part_of_a_road_is_as_wide_as_the_road_there() {
        let part = line(&[(5.0, 0.0), (10.0, 0.0), (20.0, 0.0)]);
        assert_eq!(Width::Constant(6.0).along(&part, 5.0), Width::Constant(6.0));
        let widths = Profile::new(vec![0.0, 10.0, 30.0], vec![4.0, 8.0, 4.0]).expect("stations rise");
        let Width::Varying(widths) = Width::Varying(widths).along(&part, 5.0) else { panic!("it varies") };
        assert_eq!(widths.values(), [6.0, 8.0, 6.0]);
    }
}
