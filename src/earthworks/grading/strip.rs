//! A stretch of road on the ground, as grading sees it: where a place lies beside it, and how high the road is there.
//!
//! Beside a straight leg a place has the station of its foot on the centerline, so that the road is flat across. Beside a
//! bend that would leap: on the inner side the nearest point goes from one leg straight to the other. So legs are parted
//! by the line that halves their angle, as mitered ribbons are, and near it stations are squeezed, or stretched, until the
//! bend's own station lies on that line for both legs:
//!
//! ```text
//!   station 0 │        20 ┊    ╱ 40         both legs have station 40 on the line between them;
//!             │───────────┊───╱             up to the ease, here 20 m before, the road is flat across
//!             │───────────┊──╱ ╲
//!             │───────────┊─╱   ╲
//! ```

use glam::DVec2;

use crate::alignment::Alignment;
use sandtable_geom::offset::{Continuations, LineBend};

/// The steepest border between two legs, meters along for each meter aside: that of a square turn.
const STEEPEST_LEAN: f64 = 1.0;

/// How far from a bend stations are squeezed, in meters of their shift at the formation's edge: a third steeper there.
const EASE: f64 = 4.0;

/// The cross section of a road beside its width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossSection {
    /// Each shoulder's width in meters.
    pub shoulder_m: f64,
    /// How far the carriageway falls from its middle to either side, meters per meter.
    pub crown: f64,
    /// Meters out for each meter down on an embankment; 0 for a wall.
    pub fill_slope: f64,
    /// Meters out for each meter up in a cutting; 0 for a wall.
    pub cut_slope: f64,
}

/// How steeply ground falls below a bridge from its abutment, meters out for each meter down: steeper than beside the
/// road, and the steeper the farther out, so that it fills little of what the bridge spans.
const ABUTMENT_SLOPE: f64 = 1.0;

/// How fast ground falls away from a bridge's carriageway where it goes on below it, meters per meter: so that it does
/// not show through, and no step shows where the road begins.
const BELOW_DECK: f64 = 0.1;

/// How far a portal's mouth reaches beyond the carriageway's edge, and its reveal into the hill, in meters: no ground may
/// stand in it.
const MOUTH_M: DVec2 = DVec2::new(0.7, 0.9);

/// The end of a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StripEnd {
    /// Nothing, or more road: batters go round it.
    Open,
    /// An abutment at which a bridge begins: the ground continues below its carriageway and falls away from it.
    Abutment {
        /// How the bridge rises away from the strip, meters per meter.
        grade: f64,
        /// How far below the bridge ground may be moved, in meters, above 0: what it spans stays as it is.
        reach_m: f64,
    },
    /// The wall of a portal: no batter goes round it.
    Wall,
}

/// A road on the ground between bridges and tunnels.
#[derive(Clone, Debug)]
pub struct GradingStrip {
    /// Its centerline, level and carriageway, of one width.
    pub alignment: Alignment,
    /// Across.
    pub section: CrossSection,
    /// The ends of the strip.
    pub ends: [StripEnd; 2],
}

/// The position of a point relative to a leg of a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StripOffset {
    /// How far from the edge of the formation, shoulders included, in meters; below 0 within.
    pub out_m: f64,
    /// The station of the leg that the place is beside.
    pub station_m: f64,
    /// How far from the centerline.
    pub aside_m: f64,
    /// How far beyond the strip's end; 0 beside it.
    pub beyond_m: f64,
}

impl GradingStrip {
    /// The number of its legs.
    pub fn legs(&self) -> usize {
        self.alignment.line.points().len() - 1
    }

    fn half_width_m(&self) -> f64 {
        self.alignment.width.widest_m() / 2.0
    }

    /// The distance from the centerline to the edge of the formation, in meters.
    pub fn reach_m(&self) -> f64 {
        self.half_width_m() + self.section.shoulder_m
    }

    /// The position of a world point relative to a leg.
    pub fn beside(&self, leg: usize, at: DVec2) -> StripOffset {
        let points = self.alignment.line.points();
        let (from, to) = (points[leg], points[leg + 1]);
        let (length, way) = (from.distance(to), (to - from).normalize_or_zero());
        let (along, left) = (way.dot(at - from), way.perp_dot(at - from));
        let reach = self.reach_m();
        let (before, after) = (-along, along - length);
        let beyond_m = match (leg == 0 && before > 0.0, leg + 1 == self.legs() && after > 0.0) {
            (true, _) => before,
            (false, true) => after,
            (false, false) => 0.0,
        };
        let out_m = if beyond_m > 0.0 {
            libm::hypot((left.abs() - reach).max(0.0), beyond_m)
        } else {
            libm::hypot(left, before.max(after).max(0.0)) - reach
        };
        let from_start = along + self.squeezed(leg, leg, left, along);
        let to_end = length - along + self.squeezed(leg + 1, leg, -left, length - along);
        // Each end's ease reaches to the middle at most, so that one of the two is no more than the distance itself.
        let within = if along < length / 2.0 { from_start } else { length - to_end };
        let station_m = self.alignment.line.stations()[leg] + within.clamp(0.0, length);
        StripOffset { out_m, station_m, aside_m: left.abs(), beyond_m }
    }

    /// The shift of the station of a point `distance` meters along a leg from one of its vertices and `aside` meters to
    /// the left as seen from the leg's start, to the right as seen from its end.
    fn squeezed(&self, vertex: usize, leg: usize, aside: f64, distance: f64) -> f64 {
        let lean = self.lean(vertex, leg);
        let points = self.alignment.line.points();
        let half = points[leg].distance(points[leg + 1]) / 2.0;
        let reach = self.reach_m();
        let ease = (EASE * reach * lean.abs()).min(half);
        if distance >= ease || ease <= 0.0 {
            return 0.0;
        }
        let border = (lean * aside).clamp(-ease / 2.0, ease / 2.0);
        ease * (distance - border) / (ease - border) - distance
    }

    /// How far along a leg the line between it and its neighbor at a vertex goes for each meter to the left.
    fn lean(&self, vertex: usize, leg: usize) -> f64 {
        let points = self.alignment.line.points();
        let Some(bend) = LineBend::at(points, vertex, Continuations::default(), 0.0) else { return 0.0 };
        let own = (points[leg + 1] - points[leg]).normalize_or_zero();
        let between = bend.bisector();
        let (along, left) = (own.dot(between), own.perp_dot(between));
        if left > 1e-9 { (along / left).clamp(-STEEPEST_LEAN, STEEPEST_LEAN) } else { 0.0 }
    }

    /// The level of the formation at a place beside the strip.
    pub fn formation(&self, beside: &StripOffset) -> f64 {
        let beyond_m = match self.end(beside) {
            StripEnd::Abutment { grade, .. } => (grade - BELOW_DECK) * beside.beyond_m,
            StripEnd::Open | StripEnd::Wall => 0.0,
        };
        self.alignment.level_m(beside.station_m) + beyond_m
            - self.section.crown * beside.aside_m.min(self.half_width_m())
    }

    /// What ends the strip nearer to a place.
    fn end(&self, beside: &StripOffset) -> StripEnd {
        self.ends[usize::from(beside.station_m > self.alignment.line.length() / 2.0)]
    }

    /// The distance of a place from the ground that must be level: the formation, and a portal's mouth.
    pub fn out_of_level_m(&self, beside: &StripOffset) -> f64 {
        let from_end_m = beside.station_m.min(self.alignment.line.length() - beside.station_m);
        if self.end(beside) != StripEnd::Wall || from_end_m > MOUTH_M.y {
            return beside.out_m;
        }
        let away = DVec2::new(beside.aside_m - self.reach_m(), beside.beyond_m) - MOUTH_M;
        beside.out_m.min(away.max(DVec2::ZERO).length())
    }

    /// The distance beyond the formation's edge within which [`GradingStrip::out_of_level_m`] may be less, in meters.
    pub fn mouth_reach_m(&self) -> f64 {
        if self.ends.contains(&StripEnd::Wall) { MOUTH_M.max_element() } else { 0.0 }
    }

    /// The levels of the batters at a place: the fill's, below which there may be no ground, and the cut's, above which
    /// there may be none.
    pub fn batters(&self, beside: &StripOffset) -> (f64, f64) {
        let edge = self.formation(beside);
        let CrossSection { fill_slope, cut_slope, .. } = self.section;
        let out = beside.out_m.max(0.0);
        let steps = |out: f64, slope: f64| if slope > 0.0 { out / slope } else { f64::INFINITY };
        let fill = match self.end(beside) {
            StripEnd::Abutment { reach_m, .. } if beside.beyond_m > 0.0 => {
                let aside = (beside.aside_m - self.reach_m()).max(0.0);
                let aside = if aside > 0.0 { steps(aside, fill_slope) } else { 0.0 };
                let slope = ABUTMENT_SLOPE * (1.0 - beside.beyond_m / reach_m);
                libm::hypot(aside, steps(beside.beyond_m, slope))
            }
            _ => steps(out, fill_slope),
        };
        (edge - fill, edge + steps(out, cut_slope))
    }

    /// Whether a place lies behind a wall, where no batter goes.
    pub fn is_behind_wall(&self, beside: &StripOffset) -> bool {
        beside.beyond_m > 0.0 && self.end(beside) == StripEnd::Wall
    }
}

#[cfg(test)]
pub(in crate::grading) mod tests {
    use super::*;
    use sandtable_geom::polyline::Polyline;
    use sandtable_geom::profile::Profile;

    pub const FLAT: CrossSection =
        CrossSection { shoulder_m: 1.0, crown: 0.0, fill_slope: 1.5, cut_slope: 1.0 };

    /// A strip ten meters wide along these points, its level rising evenly from the first to the second.
    pub fn strip(points: &[DVec2], [first, last]: [f64; 2], section: CrossSection) -> GradingStrip {
        let line = Polyline::new(points.iter().copied(), 0.0).expect("a line");
        let stations_m = line.stations().to_vec();
        let level = |station: &f64| first + (last - first) * station / line.length();
        let levels_m = stations_m.iter().map(level).collect();
        let level = Profile::new(stations_m, levels_m);
        let alignment = Alignment { level, ..Alignment::on_ground(line, 10.0) };
        GradingStrip { alignment, section, ends: [StripEnd::Open; 2] }
    }

    #[test]
    fn a_place_beside_a_straight_strip_has_its_foot_s_station() {
        let strip = strip(&[DVec2::ZERO, DVec2::new(100.0, 0.0)], [0.0, 10.0], FLAT);
        let beside = strip.beside(0, DVec2::new(30.0, 8.0));
        assert_eq!(beside, StripOffset { out_m: 2.0, station_m: 30.0, aside_m: 8.0, beyond_m: 0.0 });
        assert_eq!(strip.formation(&beside), 3.0);
        assert_eq!(strip.batters(&beside), (3.0 - 2.0 / 1.5, 5.0));
        assert_eq!(strip.beside(0, DVec2::new(104.0, 9.0)).out_m, 5.0, "ends are square");
    }

    #[test]
    fn levels_are_continuous_across_the_line_between_two_legs() {
        for quarter in 0..4 {
            let turned = |at: DVec2| (0..quarter).fold(at, |at, _| at.perp());
            let points = [DVec2::ZERO, DVec2::new(60.0, 0.0), DVec2::new(100.0, 30.0)].map(turned);
            let strip = strip(&points, [0.0, 11.0], FLAT);
            let between = ((points[1] - points[0]).normalize().perp()
                + (points[2] - points[1]).normalize().perp())
            .normalize();
            for aside in [-6.0, -2.0, 3.0, 6.0] {
                let at = points[1] + between * aside;
                let levels = [0, 1].map(|leg| strip.alignment.level_m(strip.beside(leg, at).station_m));
                assert!((levels[0] - levels[1]).abs() < 1e-9, "{levels:?} at {aside} m aside");
            }
        }
    }

    #[test]
    fn a_road_is_flat_across_away_from_its_bends() {
        let points = [DVec2::ZERO, DVec2::new(100.0, 0.0), DVec2::new(150.0, 50.0)];
        let strip = strip(&points, [0.0, 17.0], FLAT);
        for left in [-6.0, -3.0, 0.0, 3.0, 6.0] {
            let beside = strip.beside(0, DVec2::new(80.0, left));
            assert!((beside.station_m - 80.0).abs() < 1e-9, "{beside:?}");
        }
    }

    #[test]
    fn ground_goes_on_below_a_bridge_and_falls_away_from_its_abutment() {
        let ends = [StripEnd::Open, StripEnd::Abutment { grade: -0.05, reach_m: 12.0 }];
        let plain = strip(&[DVec2::ZERO, DVec2::new(100.0, 0.0)], [10.0, 10.0], FLAT);
        let strip = GradingStrip { ends, ..plain };
        let at = |x: f64, y: f64| strip.beside(0, DVec2::new(x, y));
        assert_eq!(strip.formation(&at(99.0, 0.0)), 10.0);
        // Below a carriageway that falls by 5 %.
        let below = strip.formation(&at(102.0, 0.0)) - (10.0 - 0.05 * 2.0);
        assert!(below < -0.1 && below > -0.3, "{below}");
        let lowest = |x: f64, y: f64| strip.batters(&at(x, y)).0;
        assert!(lowest(106.0, 0.0) < 0.0 && lowest(106.0, 0.0) > lowest(106.0, 20.0));
        assert_eq!(lowest(112.0, 0.0), f64::NEG_INFINITY, "what the bridge spans stays");
        assert_eq!(lowest(-6.0, 0.0), 10.0 - 6.0 / 1.5);
    }

    #[test]
    fn a_portal_s_mouth_lies_level_with_its_road() {
        let plain = strip(&[DVec2::ZERO, DVec2::new(100.0, 0.0)], [10.0, 10.0], FLAT);
        let out =
            |strip: &GradingStrip, x: f64, y: f64| strip.out_of_level_m(&strip.beside(0, DVec2::new(x, y)));
        let portal = GradingStrip { ends: [StripEnd::Open, StripEnd::Wall], ..plain.clone() };
        assert!(out(&plain, 100.8, 6.5) > 0.9 && out(&portal, 100.8, 6.5) <= 0.0);
        assert_eq!(out(&plain, 50.0, 6.5), out(&portal, 50.0, 6.5));
        assert!(out(&portal, -0.8, 6.5) > 0.9);
    }

    #[test]
    fn a_crown_falls_to_the_curbs_and_no_further() {
        let strip =
            strip(&[DVec2::ZERO, DVec2::new(0.0, 50.0)], [7.0, 7.0], CrossSection { crown: 0.02, ..FLAT });
        let levels = [0.0, 2.5, 5.0, 5.5].map(|x| strip.formation(&strip.beside(0, DVec2::new(x, 20.0))));
        assert_eq!(levels, [7.0, 6.95, 6.9, 6.9]);
    }
}
