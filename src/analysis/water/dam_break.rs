//! The kind `dam-break`: what a dam that fails would flood, by formulas.
//!
//! ```text
//!  level, ground behind the dam ──► volume, height ──► peak discharge (Froehlich 1995)
//!  way of water below the dam ──► reaches ──► peak at each, halved over a stated way ──► normal depth ──► posts below it
//! ```
//!
//! It is a first estimate for warning and reconnaissance. No water is moved: a wave, its front and its backwater need a
//! hydrodynamic model.

use super::flood::{DEPTHS, deepest_m, volume_m3};
use super::kinds::numbers;
use super::normal_depth::{ReachFlow, ValleyReach};
use super::outlines::outline_features;
use super::prepared::WaterGround;
use super::reservoir::Reservoir;
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::measures::area_km2;
use crate::outcome::{
    FeatureRole, Figure, Outcome, OutcomeFeature, OutcomeShape, OutcomeTable, PropertyValue, TableColumn,
    ValueClass,
};
use crate::water::drainage::Drainage;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// A kinematic wave travels so many times as fast as the water in it, where a section is wide.
const CELERITY: f64 = 5.0 / 3.0;

/// The columns of the table of reaches.
const COLUMNS: [TableColumn; 7] = [
    TableColumn::new("from", "km", 2),
    TableColumn::new("to", "km", 2),
    TableColumn::new("peak", "m³/s", 0),
    TableColumn::new("depth", "m", 1),
    TableColumn::new("mean width", "m", 0),
    TableColumn::new("speed", "m/s", 1),
    TableColumn::new("arrival", "min", 0),
];

/// The way of the water below a dam.
struct FloodWay {
    /// The posts, downward, and how far each is from the dam, meters.
    posts: Vec<usize>,
    stations_m: Vec<f64>,
}

/// The peak discharge of an embankment dam that fails, m³/s, of a volume in m³ above its breach and a height of water above the
/// breach's bottom in m: Froehlich (1995), from 22 dams.
fn peak_discharge(volume_m3: f64, height_m: f64) -> f64 {
    0.607 * libm::pow(volume_m3, 0.295) * libm::pow(height_m, 1.24)
}

/// What the failure of a dam would flood.
///
/// # Errors
/// [`AnalysisError::Argument`] where there is no ground beside the dam, no water behind it, or nothing tells which side that is
/// on; [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
pub(crate) fn dam_break(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let ground = &*land.ground;
    let water = WaterGround::of(land, arguments, stop)?;
    let reservoir = Reservoir::behind(ground, &water.heights, arguments, stop)?;
    let drainage = water.drained(stop)?;
    let way = FloodWay::from(reservoir.foot, &drainage, ground, arguments.number("way_km") * 1000.0);
    let peak = peak_discharge(reservoir.volume_m3, reservoir.height_m);
    let roughness = arguments.number("roughness");
    let halving_m = arguments.number("halving_km") * 1000.0;

    let nearest = way.nearest(&drainage, &reservoir.is_wet);
    let first_of_reach = way.reaches(arguments.number("reach_m"));
    let reach_of = |at: usize| first_of_reach.partition_point(|&first| first <= at) - 1;
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); first_of_reach.len()];
    for (index, &at) in nearest.iter().enumerate().filter(|(_, at)| **at != u32::MAX) {
        members[reach_of(at as usize)].push(index as u32);
    }
    let bed_m = |index: usize| f64::from(drainage.filled_m[way.posts[nearest[index] as usize]]);
    let mut depths: Vec<f32> =
        water.heights.iter().map(|height| if height.is_nan() { f32::NAN } else { 0.0 }).collect();
    let (mut rows, mut arrival_s) = (Vec::new(), 0.0);
    for (reach, members) in members.iter().enumerate() {
        let first = first_of_reach[reach];
        let last = first_of_reach.get(reach + 1).map_or(way.posts.len() - 1, |next| *next);
        let (from_m, to_m) = (way.stations_m[first], way.stations_m[last]);
        let level = |at: usize| f64::from(drainage.filled_m[way.posts[at]]);
        let length_m = (to_m - from_m).max(ground.cell().min_element());
        let above = |&index: &u32| f64::from(drainage.filled_m[index as usize]) - bed_m(index as usize);
        let heights_m = members.iter().map(above).collect();
        let valley = ValleyReach::new(heights_m, ground.cell_m2(), (length_m, level(first) - level(last)));
        let here = peak * libm::exp2(-(from_m + to_m) / 2.0 / halving_m);
        let ReachFlow { depth_m, section_m2, width_m, .. } = valley.of_discharge(here, roughness);
        for &index in members {
            let index = index as usize;
            let depth = bed_m(index) + depth_m - f64::from(water.heights[index]);
            if depth > 0.0 && f64::from(drainage.filled_m[index]) < bed_m(index) + depth_m {
                depths[index] = depth as f32;
            }
        }
        let speed = if section_m2 > 0.0 { here / section_m2 } else { 0.0 };
        arrival_s += if speed > 0.0 { length_m / (speed * CELERITY) } else { 0.0 };
        rows.push(
            [from_m / 1000.0, to_m / 1000.0, here, depth_m, width_m, speed, arrival_s / 60.0]
                .map(PropertyValue::Number)
                .into(),
        );
    }
    let mut notes = water.notes;
    notes.extend(reservoir.notes);
    let held_m3 = volume_m3(ground, &depths);
    if held_m3 > reservoir.volume_m3 {
        notes.push(
            "the crest of the flood would hold more water than the dam does: far from the dam the depths are too great"
                .into(),
        );
    }
    let wet = depths.iter().filter(|&&depth| depth > 0.0).count();
    let figures = vec![
        Figure::new("volume behind the dam", reservoir.volume_m3, "m³"),
        Figure::new("height of the water", reservoir.height_m, "m"),
        Figure::new("peak discharge at the dam", peak, "m³/s"),
        Figure::new("flooded area", area_km2(ground, wet), "km²"),
        Figure::new("greatest depth", deepest_m(&depths), "m"),
        Figure::new("volume of the flood's crest", held_m3, "m³"),
    ];
    let what = |what: &str| ("what", PropertyValue::Text(what.into()));
    let mut features = outline_features(ground, what("reservoir"), |index| reservoir.is_wet[index]);
    features.extend(outline_features(ground, what("flood"), |index| depths[index] > 0.0));
    if way.posts.len() > 1 {
        let line = way.posts.iter().map(|&index| ground.map_position(ground.post_at(index))).collect();
        let length_m = way.stations_m.last().copied().unwrap_or(0.0);
        features.push(OutcomeFeature {
            shape: OutcomeShape::Line(line),
            name: String::new(),
            role: FeatureRole::Stream,
            properties: vec![
                ("order", PropertyValue::Whole(1)),
                ("length_m", PropertyValue::Number(length_m)),
            ],
        });
    }
    Ok(Outcome {
        raster: Some(numbers("depth", "m", depths, ValueClass::of_rows(DEPTHS))),
        features,
        tables: vec![OutcomeTable { title: "Reaches below the dam".into(), columns: COLUMNS.into(), rows }],
        figures,
        notes,
        ..Outcome::default()
    })
}

impl FloodWay {
    /// The way that water takes from a post, at most so far.
    fn from(start: usize, drainage: &Drainage, ground: &Lattice, longest_m: f64) -> Self {
        let place = |index: usize| ground.map_position(ground.post_at(index));
        let (mut posts, mut stations_m) = (vec![start], vec![0.0]);
        let (mut at, mut station_m) = (start, 0.0);
        while let Some(to) = drainage.to(at) {
            station_m += place(at).distance(place(to));
            if station_m > longest_m {
                break;
            }
            posts.push(to);
            stations_m.push(station_m);
            at = to;
        }
        Self { posts, stations_m }
    }

    /// The place on the way to which each post drains first; `u32::MAX` of those that never do, or for which `is_out` holds.
    fn nearest(&self, drainage: &Drainage, is_out: &[bool]) -> Vec<u32> {
        let mut nearest = vec![u32::MAX; drainage.codes.len()];
        for (at, &index) in self.posts.iter().enumerate() {
            nearest[index] = at as u32;
        }
        let takes = |index: usize, at: u32| at == u32::MAX && !is_out[index];
        drainage.pass_up(&drainage.downstream(), &mut nearest, takes);
        nearest
    }

    /// The first place of each reach; a reach is at least so long, the last maybe not.
    fn reaches(&self, length_m: f64) -> Vec<usize> {
        let mut firsts = vec![0];
        let mut next_m = length_m;
        for (at, &station_m) in self.stations_m.iter().enumerate().skip(1) {
            if station_m >= next_m && at + 1 < self.posts.len() {
                firsts.push(at);
                next_m = station_m + length_m;
            }
        }
        firsts
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::test_land::{run_kind, shaped, values_of};

    /// A valley of 600 posts that falls to the south by 0.1 m a row, with sides of 2 m a column; posts 10 m apart.
    fn valley() -> Land {
        shaped(61, 600, 10.0, |column, row| row as f32 * 0.1 + 2.0 * column.abs_diff(30) as f32)
    }

    /// A dam across its row 400, with water to 50 m: 10 m above the bed.
    fn broken(more: Vec<(&str, ArgumentValue)>) -> Result<Outcome, AnalysisError> {
        let dam = vec![DVec2::new(100.0, 4000.0), DVec2::new(500.0, 4000.0)];
        let mut arguments =
            vec![("dam", ArgumentValue::Points(dam)), ("level_m", ArgumentValue::Number(50.0))];
        arguments.extend(more);
        run_kind("dam-break", &valley(), arguments)
    }

    fn number(value: &PropertyValue) -> f64 {
        match value {
            PropertyValue::Number(number) => *number,
            _ => f64::NAN,
        }
    }

    #[test]
    fn the_volume_is_what_the_ground_holds_and_the_peak_froehlichs() {
        let outcome = broken(Vec::new()).expect("floods");
        let mut volume = 0.0;
        for row in 401..600 {
            for column in 0..61_u32 {
                let ground = row as f32 * 0.1 + 2.0 * column.abs_diff(30) as f32;
                volume += f64::from((50.0 - ground).max(0.0)) * 100.0;
            }
        }
        let figures: Vec<f64> = outcome.figures.iter().map(|figure| figure.value).collect();
        assert!((figures[0] / volume - 1.0).abs() < 1e-6, "{} is not {volume}", figures[0]);
        // The foot lies three to ten posts below the dam.
        assert!((10.0..11.1).contains(&figures[1]), "{}", figures[1]);
        let peak = 0.607 * figures[0].powf(0.295) * figures[1].powf(1.24);
        assert!((figures[2] / peak - 1.0).abs() < 1e-9);
        // 310 million m³ and 77.4 m, Teton's: 0.607 · 319.9 · 219.8.
        assert!((peak_discharge(310e6, 77.4) - 42_680.0).abs() < 100.0, "{}", peak_discharge(310e6, 77.4));
    }

    #[test]
    fn a_reach_has_the_normal_depth_of_its_section() {
        let outcome = broken(vec![("roughness", ArgumentValue::Number(0.05))]).expect("floods");
        let rows = &outcome.tables[0].rows;
        assert!(rows.len() >= 6, "{} reaches", rows.len());
        let peak = outcome.figures[2].value;
        let row: Vec<f64> = rows[2].iter().map(number).collect();
        let (middle_km, discharge, depth) = ((row[0] + row[1]) / 2.0, row[2], row[3]);
        assert!((discharge / (peak * (-middle_km / 50.0).exp2()) - 1.0).abs() < 1e-9);
        // By hand: each post drains along its row, 2 m lower a post, to the bed.
        let columns: Vec<f64> =
            (-30..=30_i32).map(|k| f64::from(2 * k.abs())).filter(|&k| k < depth).collect();
        let area: f64 = columns.iter().map(|k| (depth - k) * 10.0).sum();
        let width = columns.len() as f64 * 10.0;
        let by_hand = area * (area / (width + 2.0 * area / width)).powf(2.0 / 3.0) * 0.1 / 0.05;
        assert!((by_hand / discharge - 1.0).abs() < 0.02, "{by_hand} is not {discharge}");
        // The raster has that depth over the bed.
        let depths = values_of(outcome.raster.as_ref().expect("a raster"));
        assert!((f64::from(depths[270 * 61 + 30]) - depth).abs() < 0.2, "{}", depths[270 * 61 + 30]);
        assert_eq!(depths[450 * 61 + 30], 0.0);
    }

    #[test]
    fn the_peak_falls_and_the_wave_comes_later_downstream() {
        let outcome = broken(vec![("halving_km", ArgumentValue::Number(2.0))]).expect("floods");
        let column =
            |at: usize| outcome.tables[0].rows.iter().map(|row| number(&row[at])).collect::<Vec<_>>();
        assert!(column(2).windows(2).all(|pair| pair[1] < pair[0]));
        assert!(column(6).windows(2).all(|pair| pair[1] > pair[0]));
    }

    #[test]
    fn a_dam_without_water_or_off_the_land_is_refused_and_leaks_are_told() {
        let low = broken(vec![("level_m", ArgumentValue::Number(30.0))]).expect_err("no water");
        assert_eq!(low.key(), Some("level_m"));
        let off = vec![DVec2::splat(-900.0), DVec2::splat(-700.0)];
        let off = broken(vec![("dam", ArgumentValue::Points(off))]).expect_err("off the land");
        assert_eq!(off.key(), Some("dam"));
        let short = vec![DVec2::new(290.0, 4000.0), DVec2::new(310.0, 4000.0)];
        let short = broken(vec![("dam", ArgumentValue::Points(short))]).expect("floods");
        assert!(short.notes.iter().any(|note| note.contains("around the dam")), "{:?}", short.notes);
    }
}
