//! Drop zones: rectangles along a heading, long enough for the jumpers of one pass, on level ground free of obstacles.
//!
//! The length is FM 3-21.38's and TC 3-21.220's D = R · T for drops that the ground releases: the speed of the aircraft in
//! whole meters a second (0.51 of its knots, rounded up), times the seconds between the first jumper and the last, and a
//! buffer at each end. A rectangle is searched at each post as its center: distances to what hinders rule most posts out or
//! in, sums along rows decide the rest by the posts that the rectangle holds.

use glam::DVec2;
use rayon::prelude::*;

use super::rectangle::{RectangleRows, RowCounts};
use super::suitability::{
    SiteSurface, SuitedSlopes, class_name, code_raster, cover_at, hindrances, is_low_and_dry, is_suited,
    suited_ground,
};
use crate::apart::first_apart;
use crate::arguments::AnalysisArguments;
use crate::center_columns::CenterColumns;
use crate::error::AnalysisError;
use crate::land::{Land, LandCover};
use crate::measures::post_grid;
use crate::outcome::{
    FeatureRole, Figure, Outcome, OutcomeFeature, OutcomeShape, OutcomeTable, PostValues, PropertyValue,
    TableColumn,
};
use sandtable_base::limits::memory::check_memory;
use sandtable_geom::distance_field::distances_m;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// Degrees between the headings that are tried where none is stated.
const HEADING_STEP_DEG: usize = 10;

/// Hindrances, counts, distances and codes of a post.
const BYTES_PER_POST: u64 = 36;

/// The shortest zone for one jumper, meters.
const SHORTEST_M: f64 = 275.0;

/// What a drop needs.
struct DropNeeds {
    length_m: f64,
    width_m: f64,
    buffer_m: f64,
    /// Whole meters a second.
    speed_mps: f64,
    interval_s: f64,
}

impl DropNeeds {
    fn new(arguments: &AnalysisArguments) -> Result<Self, AnalysisError> {
        let buffer_m = arguments.number("buffer_m");
        let speed_mps = (0.51 * arguments.number("speed_kn")).ceil();
        let interval_s = arguments.number("interval_s");
        let jumpers = arguments.number("jumpers").floor();
        let by_jumpers = ((jumpers - 1.0) * interval_s * speed_mps + 2.0 * buffer_m).max(SHORTEST_M);
        let length_m = arguments.number_if("length_m").unwrap_or(by_jumpers);
        let width_m = arguments.number("width_m");
        if width_m > length_m {
            return Err(AnalysisError::argument(
                "width_m",
                format!("is above the length of {length_m} m; state a lower one"),
            ));
        }
        Ok(Self { length_m, width_m, buffer_m, speed_mps, interval_s })
    }

    /// The jumpers of one pass, the first of whom takes no time.
    fn jumpers(&self) -> i64 {
        let seconds = (self.length_m - 2.0 * self.buffer_m) / self.speed_mps;
        if seconds < 0.0 { 0 } else { (seconds / self.interval_s + 1e-9).floor().min(1e9) as i64 + 1 }
    }
}

/// Codes of each post as the center of a drop zone on the best of the headings, and the best zones with a table.
///
/// # Errors
/// Slopes or sizes out of order, memory, and [`AnalysisError::Stopped`].
pub(crate) fn drop_zones(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let SuitedSlopes { free, greatest } = SuitedSlopes::of(arguments)?;
    let needs = DropNeeds::new(arguments)?;
    let ground = &*land.ground;
    let posts = ground.heights().len();
    check_memory(posts as u64 * BYTES_PER_POST, "the analysis", "name a smaller `extent`")?;
    let headings: Vec<f64> = match arguments.number_if("heading") {
        Some(heading) => vec![heading],
        None => (0..180).step_by(HEADING_STEP_DEG).map(|heading| heading as f64).collect(),
    };
    let size = DVec2::new(needs.length_m, needs.width_m);
    let rectangles: Vec<RectangleRows> =
        headings.iter().map(|&heading| RectangleRows::new(heading, size, ground)).collect();
    let hindrances = hindrances(ground, free, |index| fitness(land, index));
    let mut codes: Vec<u8> =
        ground.heights().iter().map(|height| if height.is_nan() { PostValues::NO_CODE } else { 0 }).collect();
    let clear_m = raise_codes(ground, &mut codes, (&hindrances, greatest), &rectangles, 1, stop)?;
    raise_codes(ground, &mut codes, (&hindrances, free), &rectangles, 2, stop)?;
    let mut order: Vec<u32> = (0..posts as u32).filter(|&index| is_suited(codes[index as usize])).collect();
    let suited = order.len();
    order.par_sort_unstable_by(|&one, &other| {
        let [a, b] = [one, other].map(|index| index as usize);
        codes[b].cmp(&codes[a]).then(clear_m[b].total_cmp(&clear_m[a])).then(one.cmp(&other))
    });
    let apart_m = needs.length_m + arguments.number("separation_m");
    let count = arguments.number("count") as usize;
    let at = |index: u32| ground.map_position(ground.post_at(index as usize));
    let best = first_apart(&order, count, apart_m, at);
    let zones: Vec<DropZone> = best
        .iter()
        .filter_map(|&index| {
            DropZone::new(land, &hindrances, &rectangles, index as usize, codes[index as usize])
        })
        .collect();
    let centers = CenterColumns::new(land, zones.iter().map(|zone| at(zone.index as u32)).collect());
    let features = zones.iter().enumerate().map(|(rank, zone)| OutcomeFeature {
        shape: OutcomeShape::Area(vec![zone.ring(ground, size)]),
        name: format!("DZ {}", rank + 1),
        role: FeatureRole::Site,
        properties: [
            ("code", PropertyValue::Whole(i64::from(zone.code))),
            ("heading_deg", PropertyValue::Number(zone.heading_deg)),
            ("length_m", PropertyValue::Number(needs.length_m)),
            ("width_m", PropertyValue::Number(needs.width_m)),
            ("slope_deg", PropertyValue::Number(zone.surface.slope_deg)),
            ("surface", zone.surface.cover_noun()),
        ]
        .into_iter()
        .chain(centers.properties(rank))
        .collect(),
    });
    Ok(Outcome {
        features: features.collect(),
        tables: vec![table(&centers, &zones, &needs)],
        figures: vec![
            Figure::new("length", needs.length_m, "m"),
            Figure::new("jumpers a pass", needs.jumpers() as f64, ""),
            suited_ground(ground, suited),
        ],
        raster: Some(code_raster("drop", codes)),
        ..Outcome::default()
    })
}

/// Gives `code` to each post with the code below where a rectangle holds only posts whose hindrance is at most the limit;
/// the distance of each post to what is above it, meters.
fn raise_codes(
    ground: &Lattice,
    codes: &mut [u8],
    (hindrances, limit): (&[f32], f32),
    rectangles: &[RectangleRows],
    code: u8,
    stop: &StopFlag,
) -> Result<Vec<f32>, AnalysisError> {
    let columns = ground.columns() as usize;
    let is_fit: Vec<bool> = hindrances.par_iter().map(|&hindrance| hindrance <= limit).collect();
    let distances = distances_m(&is_fit, post_grid(ground));
    let clear_m: Vec<f32> = distances.into_par_iter().map(|distance| distance as f32).collect();
    let counts = RowCounts::new(&is_fit, columns);
    drop(is_fit);
    codes.par_chunks_mut(columns).enumerate().for_each(|(row, codes)| {
        if stop.is_stopped() {
            return;
        }
        for (column, value) in codes.iter_mut().enumerate().filter(|(_, value)| **value == code - 1) {
            if rectangles.iter().any(|rectangle| rectangle.fits(&counts, &clear_m, [column, row])) {
                *value = code;
            }
        }
    });
    if stop.is_stopped() { Err(AnalysisError::Stopped) } else { Ok(clear_m) }
}

/// How what covers a post suits a zone: 2 well, 1 with caution, 0 not.
fn fitness(land: &Land, index: usize) -> u8 {
    let is_clear = land.woods.as_ref().is_none_or(|woods| woods[index].spacing_m <= 0.0);
    if !is_clear || !is_low_and_dry(land, index) {
        return 0;
    }
    match cover_at(land, index) {
        LandCover::Unknown | LandCover::Open | LandCover::Crops | LandCover::Sand => 2,
        LandCover::Scrub | LandCover::Wetland | LandCover::Paved => 1,
        LandCover::Orchard | LandCover::Wood | LandCover::Rock | LandCover::BuiltUp | LandCover::Building => {
            0
        }
    }
}

/// A zone: its center's post, and the heading of the least slope.
struct DropZone {
    index: usize,
    code: u8,
    heading_deg: f64,
    surface: SiteSurface,
}

impl DropZone {
    /// The zone at a post, on the heading whose rectangle has the least greatest hindrance, the first of equal ones.
    fn new(
        land: &Land,
        hindrances: &[f32],
        rectangles: &[RectangleRows],
        index: usize,
        code: u8,
    ) -> Option<Self> {
        let [columns, rows] = [land.ground.columns(), land.ground.rows()].map(|count| count as usize);
        let center = [index % columns, index / columns];
        let greatest = |rectangle: &RectangleRows| rectangle.greatest(hindrances, columns, center);
        let (rectangle, _) = rectangles
            .iter()
            .map(|rectangle| (rectangle, greatest(rectangle)))
            .min_by(|one, other| one.1.total_cmp(&other.1))?;
        let surface = SiteSurface::of(land, rectangle.posts([columns, rows], index));
        Some(Self { index, code, heading_deg: rectangle.heading_deg(), surface })
    }

    /// Its corners, counter-clockwise.
    fn ring(&self, ground: &Lattice, size: DVec2) -> Vec<DVec2> {
        let center = ground.map_position(ground.post_at(self.index));
        let heading = self.heading_deg.to_radians();
        let along = DVec2::new(libm::sin(heading), libm::cos(heading)) * size.x / 2.0;
        let left = DVec2::new(-libm::cos(heading), libm::sin(heading)) * size.y / 2.0;
        vec![center - along - left, center + along - left, center + along + left, center - along + left]
    }
}

fn table(centers: &CenterColumns, zones: &[DropZone], needs: &DropNeeds) -> OutcomeTable {
    let column = TableColumn::new;
    let mut columns = vec![TableColumn::of_marks("zone")];
    columns.extend(centers.columns());
    columns.extend([
        column("class", "", 0),
        column("heading", "°", 0),
        column("length", "m", 0),
        column("width", "m", 0),
        column("slope", "°", 1),
        column("surface", "", 0),
        column("jumpers", "", 0),
    ]);
    let row = |(rank, zone): (usize, &DropZone)| {
        let mut row = vec![PropertyValue::Text(format!("DZ {}", rank + 1))];
        row.extend(centers.cells(rank));
        row.extend([
            PropertyValue::Text(class_name(zone.code).to_owned()),
            PropertyValue::Number(zone.heading_deg),
            PropertyValue::Number(needs.length_m),
            PropertyValue::Number(needs.width_m),
            PropertyValue::Number(zone.surface.slope_deg),
            zone.surface.cover_noun(),
            PropertyValue::Whole(needs.jumpers()),
        ]);
        row
    };
    let rows = zones.iter().enumerate().map(row).collect();
    OutcomeTable { title: "Drop zones".to_owned(), columns, rows }
}

#[cfg(test)]
#[path = "drop_tests.rs"]
mod tests;
