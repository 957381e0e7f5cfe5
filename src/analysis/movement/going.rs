//! What each post of the land is for a vehicle: unrestricted, restricted or severely restricted, and its speed there.
//!
//! The slope decides with what covers the ground; roads, bridges and fords then take its place. The speed is that on level
//! ground of this cover: what a slope does to it depends on the direction, see [`crate::movement::travel`].

use rayon::prelude::*;

use crate::land::{Crossing, CrossingKind, Land, LandCover, RoadClass, Stand, WaterKind, WaterPost};
use crate::line_posts::along_line;
use crate::movement::gaps::closed;
use crate::movement::vehicle::{Drive, Vehicle};
use crate::outcome::PostValues;
use sandtable_base::limits::memory::{MemoryRefused, check_memory};
use sandtable_terrain::lattice::Lattice;

/// Ground on which movement is unrestricted.
pub(crate) const UNRESTRICTED: u8 = 0;
/// Ground that slows movement.
pub(crate) const RESTRICTED: u8 = 1;
/// Ground that stops movement, or nearly.
pub(crate) const SEVERELY_RESTRICTED: u8 = 2;

/// What each post is for a vehicle.
pub(crate) struct Going {
    /// [`UNRESTRICTED`], [`RESTRICTED`], [`SEVERELY_RESTRICTED`], or [`PostValues::NO_CODE`]; by slope and all else.
    pub codes: Vec<u8>,
    /// The speed on level ground, km/h: 0 where what covers the ground stops the vehicle, NaN without data.
    pub speed_kmh: Vec<f32>,
    /// Whether a road, a track, a bridge or a ford is there that the vehicle takes.
    pub is_way: Vec<bool>,
    /// The ground with the gaps closed that the vehicle crosses; `None` where it is the land's.
    pub closed: Option<Lattice>,
    /// What was left out, a sentence each.
    pub notes: Vec<String>,
}

/// A code and the share of the speed on open ground.
#[derive(Clone, Copy)]
struct GroundRule {
    code: u8,
    share: f64,
}

const fn rule(code: u8, share: f64) -> GroundRule {
    GroundRule { code, share }
}

impl Going {
    /// What each post is for the vehicle.
    ///
    /// # Errors
    /// There is not enough memory.
    pub fn new(land: &Land, vehicle: &Vehicle) -> Result<Self, MemoryRefused> {
        let ground = &*land.ground;
        let (columns, posts) = (ground.columns() as usize, ground.heights().len());
        check_memory(posts as u64 * 30, "the analysis", "name a smaller `extent`")?;
        let closed = closed(ground, vehicle.gap_m);
        let ground = closed.as_ref().unwrap_or(ground);
        let mut going = Self {
            codes: vec![PostValues::NO_CODE; posts],
            speed_kmh: vec![f32::NAN; posts],
            is_way: vec![false; posts],
            closed: None,
            notes: Vec::new(),
        };
        let codes = going.codes.par_chunks_mut(columns).zip(going.speed_kmh.par_chunks_mut(columns));
        codes.enumerate().for_each(|(row, (codes, speeds))| {
            let slopes = ground.slopes_of_row(row as u32);
            for (column, slopes) in slopes.into_iter().enumerate() {
                let index = row * columns + column;
                if ground.heights()[index].is_nan() {
                    continue;
                }
                let rule = ground_rule(land, vehicle, index);
                codes[column] = rule.code.max(slope_code(vehicle, f64::from(slopes.length()) * 100.0));
                speeds[column] = (vehicle.speed_kmh * rule.share) as f32;
            }
        });
        if let Some(closed) = &closed {
            going.slow_over_gaps(closed, land, vehicle);
        }
        going.place_steps(land, vehicle);
        going.place_ways(land, vehicle);
        Ok(Self { closed, ..going })
    }

    /// Gaps of the ground itself that are closed for the vehicle restrict it where they are deeper than it steps.
    fn slow_over_gaps(&mut self, closed: &Lattice, land: &Land, vehicle: &Vehicle) {
        let heights = closed.heights().iter().zip(land.ground.heights());
        for (index, (&closed_m, &ground_m)) in heights.enumerate() {
            if f64::from(closed_m - ground_m) > vehicle.step_m {
                self.hinder(index, vehicle, true);
            }
        }
    }

    /// Walls, banks and ditches: what the vehicle does not climb or cross is severely restricted, what it does is restricted.
    fn place_steps(&mut self, land: &Land, vehicle: &Vehicle) {
        for step in &land.steps {
            let is_climbed = step.height_m <= vehicle.step_m;
            along_line(&land.ground, &step.line, 0.0, |index| self.hinder(index, vehicle, is_climbed));
        }
        for gap in &land.gaps {
            let is_crossed = gap.width_m <= vehicle.gap_m;
            along_line(&land.ground, &gap.line, gap.width_m, |index| self.hinder(index, vehicle, is_crossed));
        }
    }

    fn hinder(&mut self, index: usize, vehicle: &Vehicle, is_passable: bool) {
        if self.codes[index] != PostValues::NO_CODE {
            let code = if is_passable { RESTRICTED } else { SEVERELY_RESTRICTED };
            self.codes[index] = self.codes[index].max(code);
            let share = if is_passable { 0.3 } else { 0.0 };
            self.speed_kmh[index] = self.speed_kmh[index].min((vehicle.speed_kmh * share) as f32);
        }
    }

    /// Roads, bridges and fords.
    fn place_ways(&mut self, land: &Land, vehicle: &Vehicle) {
        let mut surfaces = vec![RoadClass::None; self.codes.len()];
        for road in land.roads.iter().flatten() {
            along_line(&land.ground, &road.line, road.width_m, |index| {
                surfaces[index] = surfaces[index].max(road.surface);
            });
        }
        let is_too_weak = |crossing: &&Crossing| {
            crossing.kind != CrossingKind::Ford && crossing.load_t.is_some_and(|load| load < vehicle.mass_t)
        };
        for crossing in land.crossings.iter().filter(|crossing| crossing.kind == CrossingKind::Bridge) {
            along_line(&land.ground, &crossing.line, crossing.width_m, |index| {
                surfaces[index] = surfaces[index].max(RoadClass::Track);
            });
        }
        let mut weak = 0;
        for crossing in land.crossings.iter().filter(is_too_weak) {
            weak += 1;
            // Its road may be drawn a post wider than the bridge.
            let width_m = crossing.width_m.max(0.0) + 2.0 * land.ground.cell().max_element();
            along_line(&land.ground, &crossing.line, width_m, |index| surfaces[index] = RoadClass::None);
        }
        if weak > 0 {
            self.notes.push(format!(
                "{weak} bridges or culverts bear less than the {} t of `{}`",
                vehicle.mass_t, vehicle.name
            ));
        }
        for (index, &surface) in
            surfaces.iter().enumerate().filter(|&(_, surface)| *surface > RoadClass::None)
        {
            let speed = vehicle.speed_on_kmh(surface) as f32;
            if speed > 0.0 && self.codes[index] != PostValues::NO_CODE {
                self.take_way(index, UNRESTRICTED, speed);
            }
        }
        for ford in land.crossings.iter().filter(|crossing| crossing.kind == CrossingKind::Ford) {
            along_line(&land.ground, &ford.line, ford.width_m, |index| {
                let depth_m = water(land, index).map_or(0.0, |water| f64::from(water.depth_m));
                let is_deep = depth_m > vehicle.ford_m;
                if !is_deep && !self.is_way[index] && self.codes[index] != PostValues::NO_CODE {
                    self.take_way(index, RESTRICTED, (vehicle.speed_kmh * 0.3) as f32);
                }
            });
        }
    }

    fn take_way(&mut self, index: usize, code: u8, speed_kmh: f32) {
        self.codes[index] = code;
        self.speed_kmh[index] = speed_kmh;
        self.is_way[index] = true;
    }
}

/// The code of a slope: by the lower of the limits uphill and downhill, since an overlay has no direction.
fn slope_code(vehicle: &Vehicle, slope_percent: f64) -> u8 {
    let limit = |index: usize| vehicle.slope_up_percent[index].min(vehicle.slope_down_percent[index]);
    match slope_percent {
        slope if slope > limit(1) => SEVERELY_RESTRICTED,
        slope if slope > limit(0) => RESTRICTED,
        _ => UNRESTRICTED,
    }
}

fn water(land: &Land, index: usize) -> Option<WaterPost> {
    let water = land.water.as_ref()?.get(index)?;
    (water.kind != WaterKind::None).then_some(*water)
}

/// The rule of what covers a post: water, else trees, else its cover.
fn ground_rule(land: &Land, vehicle: &Vehicle, index: usize) -> GroundRule {
    if let Some(water) = water(land, index) {
        // Unknown depth counts as not fordable.
        return match f64::from(water.depth_m) <= vehicle.ford_m {
            true => rule(RESTRICTED, 0.2),
            false => rule(SEVERELY_RESTRICTED, 0.0),
        };
    }
    let cover = land.cover.as_ref().and_then(|cover| cover.get(index)).copied().unwrap_or_default();
    let stand = land.woods.as_ref().and_then(|woods| woods.get(index)).copied().unwrap_or_default();
    let is_clear = matches!(cover, LandCover::Building | LandCover::BuiltUp | LandCover::Paved);
    if stand.spacing_m > 0.0 && !is_clear {
        return stand_rule(vehicle, stand);
    }
    cover_rule(vehicle, cover)
}

/// Trees: a vehicle goes between them where the gap is as wide as itself and half a meter more, and over stems that it
/// pushes over. A stem of unknown diameter counts as too thick.
fn stand_rule(vehicle: &Vehicle, stand: Stand) -> GroundRule {
    if vehicle.drive == Drive::Foot {
        return rule(UNRESTRICTED, 0.7);
    }
    let stem_m = f64::from(stand.stem_m);
    let gap_m = f64::from(stand.spacing_m) - if stem_m.is_nan() { 0.0 } else { stem_m };
    if gap_m >= 3.0 * vehicle.width_m {
        rule(RESTRICTED, 0.6)
    } else if gap_m >= vehicle.width_m + 0.5 {
        rule(RESTRICTED, 0.4)
    } else if stem_m <= vehicle.stem_m {
        rule(RESTRICTED, 0.3)
    } else {
        rule(SEVERELY_RESTRICTED, 0.0)
    }
}

/// The rule of a cover: on foot, on wheels, on tracks.
fn cover_rule(vehicle: &Vehicle, cover: LandCover) -> GroundRule {
    const FREE: u8 = UNRESTRICTED;
    const SLOW: u8 = RESTRICTED;
    const NOT: u8 = SEVERELY_RESTRICTED;
    let rules = match cover {
        LandCover::Unknown | LandCover::Open | LandCover::Paved => [(FREE, 1.0), (FREE, 1.0), (FREE, 1.0)],
        LandCover::Crops => [(FREE, 0.8), (FREE, 0.7), (FREE, 0.9)],
        LandCover::Orchard => [(FREE, 0.8), (SLOW, 0.3), (SLOW, 0.5)],
        LandCover::Scrub => [(FREE, 0.6), (SLOW, 0.4), (FREE, 0.7)],
        LandCover::Wood => [(FREE, 0.7), (SLOW, 0.25), (SLOW, 0.4)],
        LandCover::Wetland => [(SLOW, 0.3), (NOT, 0.0), (NOT, 0.0)],
        LandCover::Sand => [(FREE, 0.6), (SLOW, 0.4), (FREE, 0.7)],
        LandCover::Rock => [(SLOW, 0.5), (NOT, 0.0), (SLOW, 0.3)],
        LandCover::BuiltUp => return built_up_rule(vehicle),
        LandCover::Building => [(NOT, 0.0), (NOT, 0.0), (NOT, 0.0)],
    };
    let (code, share) = match vehicle.drive {
        Drive::Foot => rules[0],
        Drive::Wheels => rules[1],
        Drive::Tracks => rules[2],
    };
    rule(code, share)
}

/// The rule of built-up ground: by the share of its speed that the vehicle has there.
fn built_up_rule(vehicle: &Vehicle) -> GroundRule {
    let share = vehicle.built_up_kmh / vehicle.speed_kmh;
    match share {
        0.0 => rule(SEVERELY_RESTRICTED, 0.0),
        share if share < 0.7 => rule(RESTRICTED, share),
        share => rule(UNRESTRICTED, share),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::land::{Gap, RoadLine, Step};
    use crate::test_land::{flat, flood, shaped};
    use glam::DVec2;

    fn tracked() -> Vehicle {
        Vehicle::built_in("tracked").expect("built in")
    }

    #[test]
    fn slopes_have_the_codes_of_the_vehicles_limits() {
        // Tracks: freely up to 30 %, slowly up to 45 %.
        for (slope, code) in
            [(0.29f32, UNRESTRICTED), (0.31, RESTRICTED), (0.44, RESTRICTED), (0.46, SEVERELY_RESTRICTED)]
        {
            let land = shaped(4, 4, 10.0, |column, _| column as f32 * 10.0 * slope);
            let going = Going::new(&land, &tracked()).expect("memory");
            assert!(going.codes.iter().all(|&found| found == code), "{slope}: {:?}", going.codes);
        }
    }

    #[test]
    fn trees_stop_a_vehicle_where_it_neither_fits_between_them_nor_pushes_them_over() {
        // A tank of 3.6 m needs a gap of 4.1 m, or stems up to 0.15 m.
        let mut land = flat(4, 2, 10.0);
        let stands = [(6.0, 0.3), (4.0, 0.3), (4.0, 0.1), (4.0, f32::NAN)];
        let mut woods = vec![Stand::default(); 8];
        for (post, (spacing_m, stem_m)) in woods.iter_mut().zip(stands) {
            *post = Stand { spacing_m, stem_m };
        }
        land.woods = Some(woods);
        let going = Going::new(&land, &tracked()).expect("memory");
        assert_eq!(going.codes, [1, 2, 1, 2, 0, 0, 0, 0]);
    }

    #[test]
    fn roads_and_bridges_make_ground_unrestricted_and_weak_bridges_do_not() {
        let mut land = flat(5, 3, 10.0);
        flood(&mut land, 2, f32::NAN);
        land.roads = Some(Vec::new());
        assert_eq!(Going::new(&land, &tracked()).expect("memory").codes[7], SEVERELY_RESTRICTED);
        let line = vec![DVec2::new(10.0, 10.0), DVec2::new(30.0, 10.0)];
        let surface = RoadClass::Main;
        let road = RoadLine { name: String::new(), line: line.clone(), surface, width_m: 6.0 };
        land.roads = Some(vec![road]);
        let going = Going::new(&land, &tracked()).expect("memory");
        assert_eq!((going.codes[7], going.speed_kmh[7], going.is_way[7]), (UNRESTRICTED, 55.0, true));
        assert_eq!(going.codes[2], SEVERELY_RESTRICTED, "the river beside the bridge stays");
        let bridge = Crossing {
            name: String::new(),
            kind: CrossingKind::Bridge,
            line,
            width_m: 6.0,
            load_t: Some(40.0),
        };
        land.crossings.push(bridge);
        let going = Going::new(&land, &tracked()).expect("memory");
        assert_eq!((going.codes[7], going.notes.len()), (SEVERELY_RESTRICTED, 1));
    }

    #[test]
    fn a_step_stops_what_does_not_climb_it_and_nothing_without_data_becomes_ground() {
        let mut land = shaped(4, 4, 10.0, |column, row| if column + row == 0 { f32::NAN } else { 0.0 });
        let line = vec![DVec2::new(0.0, 0.0), DVec2::new(30.0, 30.0)];
        land.steps = vec![Step { line, height_m: 0.6 }];
        let codes = |name: &str| {
            Going::new(&land, &Vehicle::built_in(name).expect("built in")).expect("memory").codes
        };
        assert_eq!((codes("tracked")[5], codes("truck")[5]), (RESTRICTED, SEVERELY_RESTRICTED));
        assert_eq!((codes("truck")[0], codes("truck")[1]), (PostValues::NO_CODE, UNRESTRICTED));
    }

    #[test]
    fn a_ditch_stops_what_does_not_cross_its_width() {
        let mut land = flat(4, 4, 10.0);
        land.gaps = vec![Gap { line: vec![DVec2::new(0.0, 10.0), DVec2::new(30.0, 10.0)], width_m: 2.0 }];
        let found = |name: &str| {
            let going = Going::new(&land, &Vehicle::built_in(name).expect("built in")).expect("memory");
            (going.codes[5], going.speed_kmh[5], going.codes[9])
        };
        // A tank crosses 2.5 m, a truck 0.5 m.
        assert_eq!(found("tracked"), (RESTRICTED, 9.0, UNRESTRICTED));
        assert_eq!(found("truck"), (SEVERELY_RESTRICTED, 0.0, UNRESTRICTED));
    }

    #[test]
    fn built_up_ground_has_the_vehicles_speed_there_and_stops_one_that_has_none() {
        let mut land = flat(3, 3, 10.0);
        land.cover = Some(vec![LandCover::BuiltUp; 9]);
        for (built_up_kmh, code) in [(0.0, SEVERELY_RESTRICTED), (12.0, RESTRICTED), (24.0, UNRESTRICTED)] {
            let going = Going::new(&land, &Vehicle { built_up_kmh, ..tracked() }).expect("memory");
            assert_eq!((going.codes[4], going.speed_kmh[4]), (code, built_up_kmh as f32));
        }
        let fault = Vehicle { built_up_kmh: -1.0, ..tracked() }.check().expect_err("below 0");
        assert_eq!(fault.key, "built_up_kmh");
    }

    #[test]
    fn spacing_stems_and_width_decide_each_by_itself_among_trees() {
        let mut land = flat(2, 2, 10.0);
        let mut code = |spacing_m: f32, stem_m: f32, vehicle: Vehicle| {
            land.woods = Some(vec![Stand { spacing_m, stem_m }; 4]);
            let going = Going::new(&land, &vehicle).expect("memory");
            (going.codes[0], going.speed_kmh[0])
        };
        // 3.6 m wide: the gap between stems must be 4.1 m, or 10.8 m to be wide.
        assert_eq!(code(11.3, 0.4, tracked()), (RESTRICTED, 18.0));
        assert_eq!(code(4.6, 0.4, tracked()), (RESTRICTED, 12.0));
        assert_eq!(code(4.4, 0.4, tracked()), (SEVERELY_RESTRICTED, 0.0));
        assert_eq!(code(4.4, 0.4, Vehicle { width_m: 3.5, ..tracked() }), (RESTRICTED, 12.0));
        assert_eq!(code(4.4, 0.4, Vehicle { stem_m: 0.5, ..tracked() }), (RESTRICTED, 9.0));
    }

    #[test]
    fn the_height_of_a_step_decides_who_climbs_it() {
        let mut land = flat(4, 4, 10.0);
        land.steps = vec![Step { line: vec![DVec2::new(10.0, 0.0), DVec2::new(10.0, 30.0)], height_m: 0.9 }];
        let found = |step_m: f64| {
            let going = Going::new(&land, &Vehicle { step_m, ..tracked() }).expect("memory");
            (going.codes[5], going.speed_kmh[5])
        };
        assert_eq!((found(0.9), found(0.8)), ((RESTRICTED, 9.0), (SEVERELY_RESTRICTED, 0.0)));
    }
}
