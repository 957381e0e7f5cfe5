//! The best landing zones, with what a pilot needs: place, size, how many land, slope, surface, and the way in and out.

use std::collections::VecDeque;

use glam::DVec2;

use super::disk::{DiskRows, circle};
use super::suitability::{LOW_M, SiteSurface, class_name, is_suited};
use super::zones::{HEADINGS, axes};
use crate::center_columns::CenterColumns;
use crate::land::Land;
use crate::outcome::{FeatureRole, OutcomeFeature, OutcomeShape, OutcomeTable, PropertyValue, TableColumn};
use sandtable_geom::azimuth::azimuth_deg;
use sandtable_terrain::lattice::Lattice;

/// The most touchdown points of a zone that are counted: more than a lift of a company. It bounds the search, whose ground
/// grows with their number.
const MOST_POINTS: usize = 20;

/// What rises beside touchdown disks.
pub(super) struct ApproachGround<'a> {
    /// The highest top in the disk around each post.
    pub tops: &'a [f32],
    /// How far an approach is looked along, meters.
    pub length_m: f64,
}

/// What zones are made of.
pub(super) struct SiteSearch<'a> {
    pub land: &'a Land,
    /// How each post suits as the center of a touchdown disk.
    pub codes: &'a [u8],
    /// The clear headings of each post, a bit each.
    pub headings: &'a [u8],
    pub approach: ApproachGround<'a>,
    pub disk: &'a DiskRows,
    /// The size of the touchdown point, 1 to 7.
    pub size: String,
    pub diameter_m: f64,
}

/// The way in and out of a zone, along one line.
struct LandingAxis {
    /// From where an aircraft comes, and to where it leaves, degrees clockwise from north.
    from_deg: f64,
    to_deg: f64,
    /// How many meters from the disk there are for each meter of an obstacle's height; infinite where nothing rises.
    from_ratio: f64,
    to_ratio: f64,
}

impl SiteSearch<'_> {
    /// The features and the table of zones around these posts, the best first.
    pub fn zones(&self, posts: &[u32]) -> (Vec<OutcomeFeature>, OutcomeTable) {
        let ground = &*self.land.ground;
        let places: Vec<DVec2> =
            posts.iter().map(|&post| ground.map_position(ground.post_at(post as usize))).collect();
        let centers = CenterColumns::new(self.land, places.clone());
        let (mut features, mut rows) = (Vec::new(), Vec::new());
        let mut seen = vec![0; if posts.is_empty() { 0 } else { self.codes.len() }];
        for (rank, &post) in posts.iter().enumerate() {
            let index = post as usize;
            let Some(axis) = self.axis(index) else { continue };
            let surface = SiteSurface::of(self.land, self.disk.posts(size_of(ground), index));
            let points = self.touchdown_points(index, (&mut seen, rank as u32 + 1));
            let code = self.codes[index];
            let class = PropertyValue::Text(class_name(code).to_owned());
            let mut properties = vec![
                ("code", PropertyValue::Whole(i64::from(code))),
                ("size", PropertyValue::Text(self.size.clone())),
                ("diameter_m", PropertyValue::Number(self.diameter_m)),
                ("points", PropertyValue::Whole(points as i64)),
                ("slope_deg", PropertyValue::Number(surface.slope_deg)),
                ("surface", surface.cover_noun()),
                ("approach_from_deg", PropertyValue::Number(axis.from_deg)),
                ("departure_to_deg", PropertyValue::Number(axis.to_deg)),
            ];
            let ratios = [("approach_ratio", axis.from_ratio), ("departure_ratio", axis.to_ratio)];
            let ratios = ratios.into_iter().filter(|(_, ratio)| ratio.is_finite());
            properties.extend(ratios.map(|(name, ratio)| (name, PropertyValue::Number(ratio))));
            properties.extend(centers.properties(rank));
            features.push(OutcomeFeature {
                shape: OutcomeShape::Area(vec![circle(places[rank], self.diameter_m / 2.0)]),
                name: format!("LZ {}", rank + 1),
                role: FeatureRole::Site,
                properties,
            });
            let mut row = vec![PropertyValue::Text(format!("LZ {}", rank + 1))];
            row.extend(centers.cells(rank));
            row.extend([
                PropertyValue::Text(self.size.clone()),
                PropertyValue::Number(self.diameter_m),
                points_value(points),
                class,
                PropertyValue::Number(surface.slope_deg),
                surface.cover_noun(),
                PropertyValue::Number(axis.from_deg),
                PropertyValue::Number(axis.to_deg),
                axis.ratio_value(),
            ]);
            rows.push(row);
        }
        (features, OutcomeTable { title: "Landing zones".to_owned(), columns: columns(&centers), rows })
    }

    /// The clear axis of a post whose lesser ratio is the greatest, the first of equal ones; the aircraft comes from the side of
    /// the greater ratio.
    fn axis(&self, post: usize) -> Option<LandingAxis> {
        let ratios = axes(self.headings[post])
            .map(|heading| (heading, [heading, heading + 4].map(|side| self.ratio(post, HEADINGS[side]))));
        let lesser = |ratios: [f64; 2]| ratios[0].min(ratios[1]);
        let best = ratios.reduce(|best, other| if lesser(other.1) > lesser(best.1) { other } else { best });
        let (heading, [one, other]) = best?;
        let cell = self.land.ground.cell();
        let azimuth = |side: usize| {
            let (east, north) = HEADINGS[side % 8];
            azimuth_deg(DVec2::new(east as f64, north as f64) * cell)
        };
        let sides = if other > one { [heading + 4, heading] } else { [heading, heading + 4] };
        Some(LandingAxis {
            from_deg: azimuth(sides[0]),
            to_deg: azimuth(sides[1]),
            from_ratio: one.max(other),
            to_ratio: one.min(other),
        })
    }

    /// How many meters from the disk there are for each meter that an obstacle beside it is higher than what may stand in it:
    /// the least along a heading.
    fn ratio(&self, post: usize, (east, north): (i64, i64)) -> f64 {
        let ground = &*self.land.ground;
        let [columns, rows] = size_of(ground).map(|count| count as i64);
        let step = DVec2::new(east as f64 * ground.cell().x, north as f64 * ground.cell().y).length();
        let low = ground.heights()[post] + LOW_M;
        let (column, row) = (post as i64 % columns, post as i64 / columns);
        let on_land = |&(_, (column, row)): &(i64, (i64, i64))| {
            (0..columns).contains(&column) && (0..rows).contains(&row)
        };
        let ratio = |(away, (column, row)): (i64, (i64, i64))| {
            let rise = f64::from(self.approach.tops[(row * columns + column) as usize] - low);
            if rise > 0.0 { away as f64 * step / rise } else { f64::INFINITY }
        };
        (1..=(self.approach.length_m / step) as i64)
            .map(|away| (away, (column + away * east, row + away * north)))
            .take_while(on_land)
            .map(ratio)
            .fold(f64::INFINITY, f64::min)
    }

    /// How many touchdown points fit on the suited ground that hangs together around a post, up to [`MOST_POINTS`]: the post,
    /// then each post, in the order of steps from there, whose disk lies beside all before. `seen` holds marks of posts below
    /// `mark`.
    fn touchdown_points(&self, post: usize, (seen, mark): (&mut [u32], u32)) -> usize {
        let ground = &*self.land.ground;
        let [columns, rows] = size_of(ground);
        let at = |index: usize| ground.map_position(ground.post_at(index));
        let apart_m = self.diameter_m * (1.0 - 1e-9);
        let mut taken: Vec<DVec2> = Vec::new();
        let mut next = VecDeque::from([post]);
        seen[post] = mark;
        while let Some(index) = next.pop_front() {
            let here = at(index);
            if taken.iter().all(|other| other.distance(here) >= apart_m) {
                taken.push(here);
                if taken.len() == MOST_POINTS {
                    break;
                }
            }
            let (column, row) = (index % columns, index / columns);
            let beside = [
                (column + 1 < columns).then(|| index + 1),
                (row + 1 < rows).then(|| index + columns),
                (column > 0).then(|| index - 1),
                (row > 0).then(|| index - columns),
            ];
            for other in beside.into_iter().flatten() {
                if seen[other] != mark && is_suited(self.codes[other]) {
                    seen[other] = mark;
                    next.push_back(other);
                }
            }
        }
        taken.len()
    }
}

impl LandingAxis {
    /// The lesser ratio as whole meters for each meter of height, rounded down; `free` where nothing rises.
    fn ratio_value(&self) -> PropertyValue {
        let ratio = self.from_ratio.min(self.to_ratio);
        match ratio.is_finite() {
            true => PropertyValue::Whole(ratio.min(1e9).floor() as i64),
            false => PropertyValue::Text("free".to_owned()),
        }
    }
}

/// Columns and rows of the ground.
fn size_of(ground: &Lattice) -> [usize; 2] {
    [ground.columns() as usize, ground.rows() as usize]
}

fn points_value(points: usize) -> PropertyValue {
    match points < MOST_POINTS {
        true => PropertyValue::Whole(points as i64),
        false => PropertyValue::Text(format!("{MOST_POINTS}+")),
    }
}

fn columns(centers: &CenterColumns) -> Vec<TableColumn> {
    let column = TableColumn::new;
    let mut columns = vec![TableColumn::of_marks("zone")];
    columns.extend(centers.columns());
    columns.extend([
        column("size", "", 0),
        column("across", "m", 0),
        column("points", "", 0),
        column("class", "", 0),
        column("slope", "°", 1),
        column("surface", "", 0),
        column("in from", "°", 0),
        column("out to", "°", 0),
        column("ratio", ":1", 0),
    ]);
    columns
}

#[cfg(test)]
#[path = "zone_sites_tests.rs"]
mod tests;
