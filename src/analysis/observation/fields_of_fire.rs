//! Fields of fire: the ground that weapons hit by direct fire.
//!
//! A line of fire is the line of sight from the muzzle to the top of a target. It passes `clearance` above every crest
//! exactly where the line so much lower at both ends is clear: a viewshed from a lower muzzle to lower targets.

use std::f64::consts::TAU;

use glam::DVec2;
use rayon::prelude::*;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::measures::{area_km2, percent};
use crate::observation::lookout::{Lookout, LookoutView, check_windows, count_classes, curvature, shares};
use crate::observation::sight_land::SightLand;
use crate::outcome::{
    FeatureRole, Figure, Outcome, OutcomeFeature, OutcomeRaster, OutcomeShape, OutcomeTable, PostValues,
    PropertyValue, TableColumn,
};
use crate::sight_parts::{SightKind, SightValues, windows};
use crate::tally::FigureTally;
use sandtable_base::limits::memory::check_memory;
use sandtable_geom::azimuth::toward;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::sight::line::SightEnd;
use sandtable_terrain::sight::viewshed::{PostVisibility, Sector, ViewshedOptions};
use sandtable_terrain::stop_flag::StopFlag;

/// A value, the visibility, and what stands at each post, with what a viewshed needs while it is computed.
const BYTES_PER_POST: u64 = 16;

/// Corners of a full circle of a fan: its chords lie at most 0.04 % of the radius within it.
const CIRCLE_CORNERS: f64 = 120.0;

/// The fan of a weapon.
#[derive(Clone, Copy)]
struct FireFan {
    min_m: f64,
    max_m: f64,
    sector: Sector,
}

/// How many weapons hit each place, and the fan of each; no data beyond the ranges and sectors of all.
pub(crate) const SIGHT: SightKind = SightKind { values, summary };

/// The values of `posts`. The tally has the posts that each weapon hits, and of how many; then those that any hits, and of how
/// many.
///
/// # Errors
/// `weapons` off the ground or too many, `max_range` and `clearance` that do not fit, memory, and
/// [`AnalysisError::Stopped`].
fn values(
    land: &Land,
    arguments: &AnalysisArguments,
    posts: PostRect,
    stop: &StopFlag,
) -> Result<SightValues, AnalysisError> {
    let ground = &*land.ground;
    let fan = fan(arguments)?;
    let [muzzle_m, target_m] = heights_less_clearance(arguments)?;
    let places = arguments.points("weapons");
    let windows = windows(ground, arguments, posts);
    check_windows("weapons", windows.iter().map(|(_, window)| window))?;
    let count = posts.width() * posts.height();
    check_memory(count as u64 * BYTES_PER_POST, "the fields of fire", "state a smaller `extent`")?;
    let mut values = vec![f32::NAN; count];
    let mut tally = vec![0; 2 * places.len()];
    let sight = SightLand::new(land).cleared_around(places.iter().copied());
    stop.stretch(0.0..1.0, windows.len() * sight.look_units(target_m));
    for (index, window) in windows {
        let end = SightEnd { at: places[index], above_m: muzzle_m };
        let options = ViewshedOptions {
            target_above_m: target_m,
            range_m: fan.max_m,
            sector: fan.sector,
            curvature: curvature(arguments),
            ..ViewshedOptions::new(end)
        };
        let mut view = sight.look_at("weapons", (&options, window), stop)?;
        hide_nearer(ground, &mut view, end.at, fan.min_m);
        view.merge_into(&mut values, posts, |value, post| match post {
            PostVisibility::Beyond | PostVisibility::NoData => {}
            PostVisibility::Hidden => *value = value.max(0.0),
            PostVisibility::Visible => *value = value.max(0.0) + 1.0,
        });
        let (hit, of) = view.seen_of();
        (tally[2 * index], tally[2 * index + 1]) = (hit as u64, of as u64);
    }
    let hit = values.par_iter().filter(|&&value| value > 0.0).count();
    let all = values.par_iter().filter(|value| !value.is_nan()).count();
    tally.extend([hit as u64, all as u64]);
    let raster = OutcomeRaster {
        name: "weapons that hit",
        unit: "",
        values: PostValues::Numbers(values),
        classes: count_classes(places.len(), ["not hit", "hit by"]),
    };
    Ok(SightValues { raster, tally: FigureTally::new(tally) })
}

/// The weapons with their fans and what they hit, as features, a table and figures.
fn summary(
    ground: &Lattice,
    arguments: &AnalysisArguments,
    heights_m: &[f64],
    tally: &FigureTally,
) -> Result<Outcome, AnalysisError> {
    let fan = fan(arguments)?;
    let [muzzle_m, _] = heights_less_clearance(arguments)?;
    let weapons = Lookout::with_heights(arguments, "weapons", muzzle_m, heights_m);
    let (shares, (hit, all)) = shares(tally);
    let post = |(weapon, &(hit, of)): (&Lookout, &(usize, usize))| {
        weapon.feature(vec![
            ("hit_km2", PropertyValue::Number(area_km2(ground, hit))),
            ("share_percent", PropertyValue::Number(percent(hit, of))),
        ])
    };
    let row = |(weapon, &(hit, of)): (&Lookout, &(usize, usize))| {
        vec![
            PropertyValue::Whole(weapon.number as i64),
            PropertyValue::Number(weapon.ground_m),
            PropertyValue::Number(area_km2(ground, hit)),
            PropertyValue::Number(percent(hit, of)),
        ]
    };
    let table = OutcomeTable {
        title: "Weapons".into(),
        columns: vec![
            TableColumn::of_marks("weapon"),
            TableColumn::new("ground", "m", 0),
            TableColumn::new("hit", "km²", 2),
            TableColumn::new("share", "%", 1),
        ],
        rows: weapons.iter().zip(&shares).map(row).collect(),
    };
    let share = |(weapon, &(hit, of)): (&Lookout, &(usize, usize))| {
        Figure::new(format!("hit by weapon {}", weapon.number), percent(hit, of), "%")
    };
    let of_all = [
        Figure::new("hit by any weapon", percent(hit, all), "%"),
        Figure::new("hit by any weapon, area", area_km2(ground, hit), "km²"),
    ];
    let outlines = weapons.iter().map(|weapon| outline(weapon, fan));
    Ok(Outcome {
        features: outlines.chain(weapons.iter().zip(&shares).map(post)).collect(),
        tables: vec![table],
        figures: weapons.iter().zip(&shares).map(share).chain(of_all).collect(),
        ..Outcome::default()
    })
}

/// The fan of the arguments.
fn fan(arguments: &AnalysisArguments) -> Result<FireFan, AnalysisError> {
    let (min_m, max_m) = (arguments.number("min_range"), arguments.number("max_range"));
    if min_m >= max_m {
        let problem = format!("of {max_m} m must be above `min_range`, {min_m} m");
        return Err(AnalysisError::argument("max_range", problem));
    }
    let (direction_deg, width_deg) = (arguments.number("direction"), arguments.number("arc"));
    let from_deg = (direction_deg - 0.5 * width_deg).rem_euclid(360.0);
    let sector = if width_deg >= 360.0 { Sector::ALL } else { Sector { from_deg, width_deg } };
    Ok(FireFan { min_m, max_m, sector })
}

/// The heights of muzzle and targets above the ground, each less the clearance, meters.
fn heights_less_clearance(arguments: &AnalysisArguments) -> Result<[f64; 2], AnalysisError> {
    let clearance_m = arguments.number("clearance");
    let heights = ["muzzle_height", "target_height"].map(|key| arguments.number(key) - clearance_m);
    if heights.iter().any(|&height| height < 0.0) {
        let problem = format!(
            "of {clearance_m} m is more than `muzzle_height` or `target_height`: no line of fire passes so far above the \
             ground beside its ends"
        );
        return Err(AnalysisError::argument("clearance", problem));
    }
    Ok(heights)
}

/// Hides the posts nearer than the minimum range.
fn hide_nearer(ground: &Lattice, view: &mut LookoutView, at: DVec2, min_m: f64) {
    if min_m <= 0.0 {
        return;
    }
    let held = view.window.held;
    let rows = view.view.posts.par_chunks_mut(held.width()).enumerate();
    rows.for_each(|(row, posts)| {
        for (column, post) in posts.iter_mut().enumerate() {
            let position = held.first.offset(column as u32, row as u32);
            let is_near = || ground.map_position(position).distance(at) < min_m;
            if *post == PostVisibility::Visible && is_near() {
                *post = PostVisibility::Hidden;
            }
        }
    });
}

/// The outline of a weapon's fan.
fn outline(weapon: &Lookout, fan: FireFan) -> OutcomeFeature {
    let arc = |radius_m: f64| -> Vec<DVec2> {
        let sector = fan.sector;
        let is_circle = sector.width_deg >= 360.0;
        let chords = (sector.width_deg / 360.0 * CIRCLE_CORNERS).ceil().max(1.0);
        let corners = if is_circle { chords as u32 } else { chords as u32 + 1 };
        // Azimuths run clockwise, rings counter-clockwise.
        let corner = |corner: u32| {
            let turned = sector.width_deg * (1.0 - f64::from(corner) / chords);
            let azimuth = (sector.from_deg + turned) / 360.0 * TAU;
            weapon.end.at + toward(azimuth) * radius_m
        };
        (0..corners).map(corner).collect()
    };
    let mut outer = arc(fan.max_m);
    let mut inner = arc(fan.min_m);
    inner.reverse();
    let rings = match (fan.sector.width_deg >= 360.0, fan.min_m > 0.0) {
        (true, true) => vec![outer, inner],
        (true, false) => vec![outer],
        (false, true) => {
            outer.extend(inner);
            vec![outer]
        }
        (false, false) => {
            outer.push(weapon.end.at);
            vec![outer]
        }
    };
    OutcomeFeature {
        shape: OutcomeShape::Area(rings),
        name: String::new(),
        role: FeatureRole::Outline,
        properties: vec![("weapon", PropertyValue::Whole(weapon.number as i64))],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::observation::test_hills::{at, land, ripples};
    use crate::test_land::{on_pool, run_kind};
    use sandtable_geom::polygon::doubled_area;
    use sandtable_terrain::profile::profile;
    use sandtable_terrain::sight::Curvature;
    use sandtable_terrain::sight::line::SightLine;

    fn arguments(numbers: &[(&'static str, f64)]) -> Vec<(&'static str, ArgumentValue)> {
        let weapons = ("weapons", ArgumentValue::Points(vec![at(4.2, 5.1), at(7.0, 6.0)]));
        let numbers = numbers.iter().map(|&(name, number)| (name, ArgumentValue::Number(number)));
        std::iter::once(weapons).chain(numbers).collect()
    }

    #[test]
    fn a_place_is_hit_where_the_line_of_fire_clears_all_ground_between() {
        let land = land(20, ripples);
        let (muzzle_m, target_m, clearance_m) = (9.0, 4.0, 2.5);
        let arguments = arguments(&[
            ("muzzle_height", muzzle_m),
            ("target_height", target_m),
            ("clearance", clearance_m),
            ("min_range", 30.0),
            ("max_range", 130.0),
            ("direction", 20.0),
            ("arc", 150.0),
        ]);
        let run = || run_kind("fields-of-fire", &land, arguments.clone()).expect("sound");
        let outcome = run();
        let raster = outcome.raster.as_ref().expect("a raster");
        let mut counts = [0; 4];
        for post in land.ground.posts().filter(|&post| !land.ground.height(post).is_nan()) {
            let target = land.ground.map_position(post);
            let hits = [at(4.2, 5.1), at(7.0, 6.0)].map(|weapon| {
                let offset = target - weapon;
                let distance_m = offset.length();
                let azimuth_deg = libm::atan2(offset.x, offset.y).to_degrees();
                if distance_m > 130.0 || !(-55.0..=95.0).contains(&azimuth_deg) {
                    return None;
                }
                let stations = profile(&land.ground, &[weapon, target]);
                let height = |at: DVec2| height_of(&land, at);
                let line = SightLine::new(
                    height(weapon) + muzzle_m,
                    height(target) + target_m,
                    distance_m,
                    Curvature::default(),
                );
                let is_clear = stations.iter().all(|station| {
                    let ground_m = station.ground.height_m().unwrap_or(f64::NEG_INFINITY);
                    line.height_m(station.station_m / distance_m.max(1e-9)) - ground_m >= clearance_m - 1e-9
                });
                Some(is_clear && distance_m >= 30.0)
            });
            let value = raster.values.value(land.ground.index(post));
            if hits == [None, None] {
                assert!(value.is_nan(), "{post:?}");
                counts[3] += 1;
                continue;
            }
            let count = hits.iter().filter(|&&hit| hit == Some(true)).count();
            assert_eq!(value, count as f32, "{post:?}: {hits:?}");
            counts[count] += 1;
        }
        assert!(counts.iter().all(|&posts| posts > 2), "{counts:?}");
        let text = |threads| on_pool(threads, || format!("{:?}", run()));
        assert_eq!(text(1), text(4));
    }

    fn height_of(land: &Land, at: DVec2) -> f64 {
        crate::place::height_under(&land.ground, "weapons", at).expect("ground")
    }

    #[test]
    fn fans_are_rings_with_the_area_of_their_sector() {
        let land = land(20, |_, _| 0.0);
        let area = |numbers: &[(&'static str, f64)]| {
            let outcome = run_kind("fields-of-fire", &land, arguments(numbers)).expect("sound");
            let OutcomeShape::Area(rings) = &outcome.features[0].shape else { panic!("an area") };
            assert!(doubled_area(&rings[0]) > 0.0 && rings[1..].iter().all(|hole| doubled_area(hole) < 0.0));
            rings.iter().map(|ring| doubled_area(ring) / 2.0).sum::<f64>()
        };
        let ring = area(&[("min_range", 30.0), ("max_range", 100.0)]);
        assert!((ring / (9100.0 * TAU / 2.0) - 1.0).abs() < 1e-3, "{ring}");
        let quarter = area(&[("min_range", 30.0), ("max_range", 100.0), ("arc", 90.0), ("direction", 10.0)]);
        assert!((quarter / (9100.0 * TAU / 8.0) - 1.0).abs() < 1e-3, "{quarter}");
        let pie = area(&[("max_range", 100.0), ("arc", 90.0)]);
        assert!((pie / (10_000.0 * TAU / 8.0) - 1.0).abs() < 1e-3, "{pie}");
    }

    #[test]
    fn ranges_out_of_order_and_a_clearance_over_the_muzzle_are_errors() {
        let land = land(11, |_, _| 0.0);
        let key = |numbers: &[(&'static str, f64)]| {
            let mut arguments = arguments(numbers);
            arguments[0].1 = ArgumentValue::Points(vec![at(5.0, 5.0)]);
            run_kind("fields-of-fire", &land, arguments).err().and_then(|error| error.key())
        };
        assert_eq!(key(&[("min_range", 50.0), ("max_range", 50.0)]), Some("max_range"));
        assert_eq!(key(&[("max_range", 50.0), ("clearance", 1.5)]), Some("clearance"));
        assert_eq!(key(&[("max_range", 1e7)]), None);
    }
}
