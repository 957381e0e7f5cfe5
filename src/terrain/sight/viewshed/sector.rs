//! The directions of a sector.

use glam::DVec2;

use crate::sight::viewshed::Sector;

/// Directions nearer to a sector than this may lie in it, in degrees: more than the rounding of an azimuth.
const SLACK_DEG: f64 = 1e-6;

impl Sector {
    /// All around.
    pub const ALL: Self = Self { from_deg: 0.0, width_deg: 360.0 };

    /// The sector that turns clockwise from one azimuth to another; all around where they are the same direction.
    pub fn between(from_deg: f64, to_deg: f64) -> Self {
        let width_deg = (to_deg - from_deg).rem_euclid(360.0);
        let width_deg = if width_deg == 0.0 { 360.0 } else { width_deg };
        Self { from_deg: from_deg.rem_euclid(360.0), width_deg }
    }

    /// Whether a point at `offset` (east, north) from the apex lies in it; both borders and the apex do.
    pub fn contains(&self, offset: DVec2) -> bool {
        self.width_deg >= 360.0 || offset == DVec2::ZERO || self.past_start_deg(offset) <= self.width_deg
    }

    /// How far `offset` lies clockwise from the sector's start, 0..360.
    fn past_start_deg(&self, offset: DVec2) -> f64 {
        let azimuth_deg = libm::atan2(offset.x, offset.y).to_degrees();
        (azimuth_deg - self.from_deg).rem_euclid(360.0)
    }

    /// Whether it may contain a direction between two that are less than half a turn apart; `false` is certain.
    pub(super) fn may_touch(&self, directions: [DVec2; 2]) -> bool {
        if self.width_deg + 2.0 * SLACK_DEG >= 360.0 {
            return true;
        }
        let [one, other] = directions.map(|direction| self.past_start_deg(direction));
        // Counted from the sector's start, the directions span the lesser of the two arcs between them.
        let (first, last) = (one.min(other), one.max(other));
        let spans_start = last - first > 180.0;
        spans_start || first <= self.width_deg + SLACK_DEG || last >= 360.0 - SLACK_DEG
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sector_from_west_to_east_contains_north_but_not_south() {
        let sector = Sector::between(270.0, 90.0);
        assert!(sector.contains(DVec2::Y) && sector.contains(DVec2::X) && sector.contains(-DVec2::X));
        assert!(!sector.contains(-DVec2::Y));
        assert_eq!(Sector::between(10.0, 370.0), Sector { from_deg: 10.0, width_deg: 360.0 });
    }

    #[test]
    fn directions_around_one_in_the_sector_touch_it() {
        for start in 0..72 {
            let sector = Sector { from_deg: f64::from(start) * 5.0, width_deg: 3.0 };
            for turn in 0..360 {
                let direction = |degrees: f64| {
                    let (sin, cos) = degrees.to_radians().sin_cos();
                    DVec2::new(sin, cos)
                };
                let around = [-10.0, 10.0].map(|by| direction(f64::from(turn) + by));
                let inside = (-20..=20)
                    .any(|half| sector.contains(direction(f64::from(turn) + f64::from(half) / 2.0)));
                assert!(sector.may_touch(around) || !inside, "{sector:?} {turn}");
            }
        }
    }
}
