//! Grading: the ground made to follow roads, with batters to the daylight line, and the earth that moves.
//!
//! ```text
//!            batter  shoulder  carriageway  shoulder  batter
//!                  ╲   ┌──────────┴──────────┐   ╱‾‾‾‾‾‾‾‾‾‾‾  ground
//!   ground  ‾‾‾‾‾‾‾‾╲  │                     │  ╱
//!                    ╲_│_____formation_______│_╱   cut: 1 up for `cut_slope` out
//!
//!                      │_____formation_______│
//!   ground  ________  ╱                       ╲    fill: 1 down for `fill_slope` out
//!                   ╲╱                         ╲______________
//!              daylight line
//! ```
//!
//! **The formation.** The ground between posts is the plane of three of them, so it follows the road under the whole
//! carriageway only where all corners of every triangle that the carriageway touches do. None is further from it than a
//! cell's diagonal: all posts that near take the level of the road beside them. Whatever the lattice, a straight road of
//! even grade lies in its ground to the rounding of f32; elsewhere it is off by what its curves bend within a cell.
//!
//! **The batters** burn outward from the formation like a grass fire: post by post, the nearest to a carriageway first,
//! each from the road that it is nearest to. A post where the batter comes to daylight stays as it is and carries the
//! fire no further, so that nothing beyond the daylight line is touched, and each changed post costs the same whatever
//! the road's length.
//!
//! Batters end at ground that is level for another reason, a lake's shore, as at a quay; the formation goes through.

pub mod fire;
pub mod formation;
pub mod strip;

use crate::grading::fire::batter;
use crate::grading::formation::Formation;
use crate::grading::strip::GradingStrip;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::volumes::Volumes;

/// Grades the lattice for strips of road: the earth moved for each, in their order.
///
/// Every post that is set is pinned. A post that two strips reach belongs to the nearer carriageway.
pub fn grade(lattice: &mut Lattice, strips: &[GradingStrip]) -> Vec<Volumes> {
    let formation = Formation::of(lattice, strips);
    let mut works = GradingWorks { lattice, volumes: vec![Volumes::default(); strips.len()] };
    formation.lay(strips, &mut works);
    batter(strips, formation, &mut works);
    works.volumes
}

/// The ground under way, and the earth moved so far.
struct GradingWorks<'a> {
    lattice: &'a mut Lattice,
    volumes: Vec<Volumes>,
}

impl GradingWorks<'_> {
    /// Sets a post for a strip.
    fn set(&mut self, post: Post, level_m: f64, strip: usize) {
        let rise = level_m - f64::from(self.lattice.height(post));
        let moved_m3 = rise * self.lattice.cell().x * self.lattice.cell().y;
        // Where there was no ground nothing is measured.
        if rise > 0.0 {
            self.volumes[strip].fill_m3 += moved_m3;
        } else if rise < 0.0 {
            self.volumes[strip].cut_m3 -= moved_m3;
        }
        self.lattice.pin(post, level_m as f32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::Support;
    use crate::alignment::design::design;
    use crate::alignment::network::{NodeId, RoadSection, SectionNetwork};
    use crate::alignment::spans::EarthworkLimits;
    use crate::grading::strip::StripEnd;
    use crate::grading::strip::tests::{FLAT, strip};
    use glam::DVec2;
    use proptest::prelude::*;
    use sandtable_geom::profile::Profile;
    use sandtable_terrain::densify::densify;
    use sandtable_terrain::profile::profile;
    use sandtable_terrain::query::{Interpolation, ground_height};

    const SIDE: u32 = 301;

    fn lattice(cell_m: f64, height: impl Fn(DVec2) -> f64) -> Lattice {
        let at = |index: u32| DVec2::new(f64::from(index % SIDE), f64::from(index / SIDE)) * cell_m;
        let heights = (0..SIDE * SIDE).map(|index| height(at(index)) as f32).collect();
        Lattice::new(DVec2::new(4e5, 5e6), DVec2::splat(cell_m), SIDE, heights).expect("sound")
    }

    fn planar(lattice: &Lattice, world: DVec2) -> f64 {
        let answer = ground_height(lattice, Interpolation::Planar, world + lattice.origin());
        answer.height_m().expect("on the model")
    }

    /// Points of a line turned about the middle of the lattice by quarters and a little more.
    fn turned(points: &[(f64, f64)], quarter: u32) -> Vec<DVec2> {
        let (middle, more) = (DVec2::splat(150.0), DVec2::from_angle(0.2));
        let turn = |(x, y): (f64, f64)| (0..quarter).fold(DVec2::new(x, y), |at, _| at.perp());
        points.iter().map(|&point| middle + more.rotate(turn(point))).collect()
    }

    #[test]
    fn an_embankment_and_a_cutting_move_the_earth_of_their_prisms() {
        // Twelve meters wide and five high, 200 m long; ends are half prisms and quarters of cones.
        let solid = |slope: f64| {
            let out = 5.0 * slope;
            let cones = std::f64::consts::PI * out * out * 5.0 / 3.0;
            200.0 * (12.0 * 5.0 + out * 5.0) + 2.0 * 12.0 * out * 5.0 / 2.0 + cones
        };
        for quarter in 0..4 {
            let points = turned(&[(-100.0, 3.0), (100.0, 3.0)], quarter);
            let mut flat = lattice(1.0, |_| 100.0);
            let [fill] = grade(&mut flat, &[strip(&points, [105.0; 2], FLAT)])[..] else {
                unreachable!("one strip")
            };
            assert!((fill.fill_m3 / solid(1.5) - 1.0).abs() < 0.03, "{fill:?}, not {}", solid(1.5));
            assert_eq!(fill.cut_m3, 0.0);
            let mut flat = lattice(1.0, |_| 100.0);
            let [cut] = grade(&mut flat, &[strip(&points, [95.0; 2], FLAT)])[..] else {
                unreachable!("one strip")
            };
            assert!((cut.cut_m3 / solid(1.0) - 1.0).abs() < 0.03, "{cut:?}, not {}", solid(1.0));
        }
    }

    #[test]
    fn a_straight_road_of_even_grade_lies_in_its_ground_exactly() {
        for quarter in 0..4 {
            let points = turned(&[(-120.0, 7.0), (110.0, 7.0)], quarter);
            let road = strip(&points, [90.0, 108.0], FLAT);
            let mut rough = lattice(1.0, |at| 100.0 + 8.0 * libm::sin(at.x / 9.0) * libm::cos(at.y / 13.0));
            grade(&mut rough, std::slice::from_ref(&road));
            for index in 0..500 {
                let (along, aside) = (f64::from(index) / 500.0 * 226.0 + 2.0, f64::from(index % 13) - 6.0);
                let way = (points[1] - points[0]).normalize();
                let off = planar(&rough, points[0] + way * along + way.perp() * aside)
                    - road.alignment.level_m(along);
                assert!(off.abs() < 1e-4, "{off} m at {along}, {aside}");
            }
        }
    }

    #[test]
    fn batters_end_at_a_level_shore_and_do_not_climb_over_a_portal() {
        let points = turned(&[(-80.0, 0.0), (0.0, 0.0)], 0);
        let way = (points[1] - points[0]).normalize();
        let mut shore = lattice(1.0, |_| 100.0);
        for post in shore.posts() {
            let aside = way.perp_dot(formation::world(&shore, post) - points[0]);
            if aside > 10.0 {
                shore.pin(post, 100.0);
            }
        }
        grade(&mut shore, &[strip(&points, [110.0; 2], FLAT)]);
        let beside = (points[0] + points[1]) / 2.0;
        assert_eq!(planar(&shore, beside + way.perp() * 12.0), 100.0);
        assert!(planar(&shore, beside - way.perp() * 12.0) > 105.0);

        let hill = || lattice(1.0, |_| 130.0);
        let mut open = hill();
        grade(&mut open, &[strip(&points, [110.0; 2], FLAT)]);
        let mut portal = hill();
        grade(
            &mut portal,
            &[GradingStrip { ends: [StripEnd::Open, StripEnd::Wall], ..strip(&points, [110.0; 2], FLAT) }],
        );
        let behind = points[1] + way * 6.0;
        assert!(planar(&open, behind) < 120.0);
        assert_eq!(planar(&portal, behind), 130.0);
    }

    #[test]
    fn slopes_beside_a_straight_cutting_are_the_same_all_along_it() {
        for turn in [0.2, 0.45, 0.75, 1.3] {
            // Posts every 1.25 m, between measured ones on a slope across the road.
            let (way, middle) = (DVec2::from_angle(turn), DVec2::splat(150.0));
            let measured = |index: u32| {
                let at = DVec2::new(f64::from(index % 31), f64::from(index / 31)) * 10.0;
                (106.0 + 0.3 * way.perp_dot(at - middle)) as f32
            };
            let heights = (0..31 * 31).map(measured).collect();
            let coarse = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 31, heights).expect("sound");
            let mut ground = densify(&coarse, 3).expect("sound");
            let points = [middle - way * 110.0, middle + way * 110.0];
            grade(&mut ground, &[strip(&points, [100.0; 2], FLAT)]);
            // As light has it, between posts.
            let across = |at: DVec2| {
                let (cell, part) = ground.cell_at(at).expect("on the model");
                let slope = |east, north| ground.slopes(cell.offset(east, north)).as_dvec2();
                let row = |north| slope(0, north).lerp(slope(1, north), part.x);
                way.perp_dot(row(0).lerp(row(1), part.y))
            };
            for aside in 12..40 {
                let aside = f64::from(aside) / 2.0;
                let place = |index: u32| middle + way * (f64::from(index) / 4.0 - 60.0) + way.perp() * aside;
                let all: Vec<f64> = (0..480).map(|index| across(place(index))).collect();
                let mean = all.iter().sum::<f64>() / 480.0;
                let variance = all.iter().map(|slope| (slope - mean).powi(2)).sum::<f64>() / 480.0;
                // Slopes from post to post vary by 0.07 to 0.12: teeth.
                assert!(variance.sqrt() < 0.06, "{} at {aside} m, turned by {turn}", variance.sqrt());
            }
        }
    }

    #[test]
    fn between_two_roads_each_post_belongs_to_the_nearer() {
        let upper = turned(&[(-80.0, 10.0), (80.0, 10.0)], 0);
        let lower = turned(&[(-80.0, -10.0), (80.0, -10.0)], 0);
        let mut ground = lattice(1.0, |_| 100.0);
        let strips = [strip(&upper, [104.0; 2], FLAT), strip(&lower, [98.0; 2], FLAT)];
        grade(&mut ground, &strips);
        for (points, level) in [(upper, 104.0), (lower, 98.0)] {
            assert!((planar(&ground, (points[0] + points[1]) / 2.0) - level).abs() < 1e-4);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn the_ground_follows_any_road_and_stays_as_it_was_beyond_its_batters(
            turns in prop::collection::vec(-0.9..0.9f64, 1..4),
            phase in 0.0..6.0f64,
            quarter in 0u32..4,
            grade_limit in 0.03..0.12f64,
        ) {
            let (mut points, mut heading, mut at) = (vec![(-120.0, -40.0)], 0.3, DVec2::new(-120.0, -40.0));
            for turn in turns {
                at += DVec2::from_angle(heading) * 65.0;
                points.push((at.x, at.y));
                heading += turn;
            }
            let points = turned(&points, quarter);
            prop_assume!(points.len() > 1);
            let before = lattice(1.0, |at| {
                100.0 + 12.0 * libm::sin(at.x / 31.0 + phase) * libm::cos(at.y / 43.0) + 2.0 * libm::sin(at.y / 7.0)
            });
            let road = designed(&before, &points, grade_limit);
            let mut after = before.clone();
            let volumes = grade(&mut after, std::slice::from_ref(&road));
            let bends: Vec<f64> = road.alignment.line.stations().to_vec();
            for index in 0..400 {
                let station = road.alignment.line.length() * f64::from(index) / 400.0;
                let leg = bends.partition_point(|&at| at <= station) - 1;
                let way = (points[leg + 1] - points[leg]).normalize();
                let aside = f64::from(index % 11) - 5.0;
                let place = road.alignment.line.at(station) + way.perp() * aside;
                let nearest = (0..road.legs()).map(|leg| road.beside(leg, place));
                let nearest = nearest.min_by(|a, b| a.out_m.total_cmp(&b.out_m)).expect("a leg");
                let off = (planar(&after, place) - road.formation(&nearest)).abs();
                // A cell's diagonal along the road, squeezed by a half at most beside bends.
                prop_assert!(off <= 1.5 * grade_limit * 2f64.sqrt(), "{} m at {}", off, station);
                let straight = bends.iter().all(|bend| (bend - station).abs() > 25.0);
                // What a vertical curve bends within a cell.
                prop_assert!(!straight || off <= 0.02, "{} m on a straight at {}", off, station);
            }
            for (post, (old, new)) in before.posts().zip(before.heights().iter().zip(after.heights())) {
                prop_assert!(after.is_pinned(post) || old.to_bits() == new.to_bits());
            }
            let map: Vec<DVec2> = points.iter().map(|at| *at + after.origin()).collect();
            let along = profile(&after, &map);
            for pair in along.windows(2) {
                let run = pair[1].station_m - pair[0].station_m;
                let rise = pair[1].ground.height_m().expect("ground") - pair[0].ground.height_m().expect("ground");
                // Where stations are squeezed beside a bend, the ground is a little steeper than the road.
                let is_bend = bends.iter().any(|bend| (bend - pair[0].station_m).abs() < 14.0);
                let most = if is_bend { 2.0 * grade_limit } else { grade_limit + 1e-3 };
                prop_assert!(rise.abs() <= run * most + 1e-4, "{} m in {} m at {}", rise, run, pair[0].station_m);
            }
            prop_assert!(volumes[0].cut_m3 + volumes[0].fill_m3 > 0.0);
        }
    }

    /// A road along these points, designed for a lattice.
    fn designed(lattice: &Lattice, points: &[DVec2], max_grade: f64) -> GradingStrip {
        let map: Vec<DVec2> = points.iter().map(|at| *at + lattice.origin()).collect();
        let stations = profile(lattice, &map);
        let stations_m: Vec<f64> = stations.iter().map(|at| at.station_m).collect();
        let ground_m = stations.iter().map(|at| at.ground.height_m().expect("ground")).collect();
        let ends = [NodeId(0), NodeId(1)];
        let (support, limits) = (Support::Ground, EarthworkLimits::NONE);
        let section = RoadSection {
            ends,
            stations_m: stations_m.clone(),
            ground_m,
            max_grade,
            support,
            limits,
            stated_m: None,
        };
        let network = SectionNetwork { nodes: 2, sections: vec![section] };
        let design = design(&network, &[f64::NAN; 2], 50.0);
        let mut strip = strip(points, [0.0; 2], FLAT);
        strip.alignment.level = Profile::new(stations_m, design.levels_m[0].clone());
        strip
    }
}
