//! Sites for camps and gun positions: a disk of level, dry, suitable ground, hidden from given posts, masked toward given
//! directions, and near water and roads.
//!
//! What must hold for each post of the disk becomes one number a post, the tangent of its slope or infinity, whose maximum
//! over the disk decides. What must hold for the site as a whole (distances to water and roads) counts from its center.

use rayon::prelude::*;

use super::disk::{DiskRows, circle};
use super::mask::mask_tangents;
use super::suitability::{
    LOW_M, SiteSurface, SuitedSlopes, class_name, code_raster, cover_at, hindrances, is_suited,
    suited_ground, tangent,
};
use crate::apart::first_apart;
use crate::arguments::AnalysisArguments;
use crate::center_columns::CenterColumns;
use crate::error::AnalysisError;
use crate::land::{Land, LandCover, WaterKind};
use crate::line_posts::along_line;
use crate::measures::post_grid;
use crate::observation::lookout::{Lookout, check_looks, curvature, posts_within, range_m};
use crate::observation::sight_land::SightLand;
use crate::outcome::{
    FeatureRole, Outcome, OutcomeFeature, OutcomeShape, OutcomeTable, PostValues, PropertyValue, TableColumn,
};
use crate::ring::AreaRow;
use sandtable_base::limits::memory::check_memory;
use sandtable_geom::distance_field::distances_m;
use sandtable_terrain::lattice::Post;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::sight::viewshed::{PostVisibility, ViewshedOptions};
use sandtable_terrain::stop_flag::StopFlag;

/// The most directions of an enemy.
const MOST_DIRECTIONS: usize = 36;

/// Slopes, layers, distances and codes of a post, with what a disk's maxima need.
const BYTES_PER_POST: u64 = 64;

/// What must grow on a site.
#[derive(Clone, Copy, PartialEq)]
enum SiteCover {
    Any,
    Open,
    Concealed,
}

/// What is known of each post as the center of a site.
struct SiteGround {
    /// The greatest tangent of a slope within the disk; infinite where something rules the site out.
    steepest: Vec<f32>,
    /// Distances to water and roads in meters; `None` where the layer is unknown.
    water_m: Option<Vec<f64>>,
    road_m: Option<Vec<f64>>,
    /// The least mask tangent toward the enemy; `None` where no direction is stated.
    masks: Option<Vec<f32>>,
}

/// The limits of a site as a whole.
struct SiteLimits {
    slopes: SuitedSlopes,
    water_m: Option<f64>,
    road_m: Option<f64>,
}

/// Codes of each post as the center of a site, and the best separated sites with a table.
///
/// # Errors
/// Slopes or masks out of order, a demand on a layer that is unknown, `hidden_from` off the ground or too many, memory, and
/// [`AnalysisError::Stopped`].
pub(crate) fn sites(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let limits = site_limits(arguments)?;
    let ground = &*land.ground;
    let posts = ground.heights().len();
    check_memory(posts as u64 * BYTES_PER_POST, "the analysis", "name a smaller `extent`")?;
    let site = site_ground(land, arguments, &limits, stop)?;
    let area = arguments.points("area");
    let is_near =
        |distances: &Option<Vec<f64>>, index: usize, limit_m: Option<f64>| match (distances, limit_m) {
            (Some(distances), Some(limit_m)) => distances[index] <= limit_m,
            _ => true,
        };
    let code = |index: usize, is_within: bool| {
        if ground.heights()[index].is_nan() || !is_within {
            PostValues::NO_CODE
        } else if site.steepest[index] > limits.slopes.greatest
            || !is_near(&site.water_m, index, limits.water_m)
            || !is_near(&site.road_m, index, limits.road_m)
        {
            0
        } else if site.steepest[index] > limits.slopes.free {
            1
        } else {
            2
        }
    };
    let columns = ground.columns() as usize;
    let mut codes = vec![PostValues::NO_CODE; posts];
    codes.par_chunks_mut(columns).enumerate().for_each(|(row, codes)| {
        let start = Post { column: 0, row: row as u32 };
        let inside = AreaRow::new(area, ground.map_position(start).y);
        for (column, place) in codes.iter_mut().enumerate() {
            let x = ground.map_position(Post { column: column as u32, ..start }).x;
            *place = code(row * columns + column, inside.holds(x));
        }
    });
    if stop.is_stopped() {
        return Err(AnalysisError::Stopped);
    }
    let mut order: Vec<(f32, u32)> = (0..posts as u32)
        .into_par_iter()
        .filter(|&index| is_suited(codes[index as usize]))
        .map(|index| (score(&site, &limits, index as usize), index))
        .collect();
    let suited = order.len();
    let rank = |index: u32| codes[index as usize];
    order.par_sort_unstable_by(|&(score, index), &(other_score, other)| {
        rank(other).cmp(&rank(index)).then(other_score.total_cmp(&score)).then(index.cmp(&other))
    });
    let size_m = arguments.number("size_m");
    let count = arguments.number("count") as usize;
    let apart_m = size_m + arguments.number("separation_m");
    let at = |index: u32| ground.map_position(ground.post_at(index as usize));
    let best = first_apart(&order, count, apart_m, |(_, index)| at(index));
    let disk = site_disk(land, size_m);
    let row = |&(score, index): &(f32, u32)| {
        let surface = SiteSurface::of(land, disk.posts(size_of(land), index as usize));
        SiteRow::new((score, codes[index as usize]), surface, &site, index as usize)
    };
    let rows: Vec<SiteRow> = best.iter().map(row).collect();
    let centers = CenterColumns::new(land, best.iter().map(|&(_, index)| at(index)).collect());
    let features = rows.iter().enumerate().map(|(rank, row)| OutcomeFeature {
        shape: OutcomeShape::Area(vec![circle(at(row.index as u32), size_m / 2.0)]),
        name: site_name(rank),
        role: FeatureRole::Site,
        properties: row.properties().into_iter().chain(centers.properties(rank)).collect(),
    });
    Ok(Outcome {
        features: features.collect(),
        tables: vec![table(&rows, &centers)],
        figures: vec![suited_ground(ground, suited)],
        raster: Some(code_raster("sites", codes)),
        ..Outcome::default()
    })
}

/// The posts of a site this far across.
fn site_disk(land: &Land, size_m: f64) -> DiskRows {
    let [columns, rows] = size_of(land);
    DiskRows::new(size_m / 2.0, land.ground.cell(), columns.max(rows))
}

/// Columns and rows of the ground.
fn size_of(land: &Land) -> [usize; 2] {
    [land.ground.columns(), land.ground.rows()].map(|count| count as usize)
}

/// The name of a site by its place in the order of scores.
fn site_name(rank: usize) -> String {
    format!("Site {}", rank + 1)
}

fn site_limits(arguments: &AnalysisArguments) -> Result<SiteLimits, AnalysisError> {
    let limits = SiteLimits {
        slopes: SuitedSlopes::of(arguments)?,
        water_m: arguments.number_if("water_m"),
        road_m: arguments.number_if("road_m"),
    };
    if limits.water_m.is_some_and(|water_m| water_m < arguments.number("dry_m")) {
        return Err(AnalysisError::argument("water_m", "is below `dry_m`; state a greater one"));
    }
    Ok(limits)
}

/// A distance that was stated needs its layer.
fn needs(key: &'static str, is_stated: bool, is_known: bool, layer: &str) -> Result<(), AnalysisError> {
    match is_stated && !is_known {
        true => Err(AnalysisError::argument(
            key,
            format!("needs {layer}, of which nothing is known; leave it out"),
        )),
        false => Ok(()),
    }
}

fn site_ground(
    land: &Land,
    arguments: &AnalysisArguments,
    limits: &SiteLimits,
    stop: &StopFlag,
) -> Result<SiteGround, AnalysisError> {
    let ground = &*land.ground;
    let columns = ground.columns() as usize;
    let grid = post_grid(ground);
    let cover = match arguments.word("cover").as_str() {
        "open" => SiteCover::Open,
        "concealed" => SiteCover::Concealed,
        _ => SiteCover::Any,
    };
    let is_cover_known = land.cover.is_some() || land.woods.is_some();
    needs("cover", cover == SiteCover::Concealed, is_cover_known, "the land's cover")?;
    needs("water_m", limits.water_m.is_some(), land.water.is_some(), "the land's water")?;
    needs("road_m", limits.road_m.is_some(), land.roads.is_some(), "the land's roads")?;
    let water_m = land.water.as_ref().map(|water| {
        let is_dry: Vec<bool> = water.iter().map(|water| water.kind == WaterKind::None).collect();
        distances_m(&is_dry, grid)
    });
    let road_m = land.roads.as_ref().map(|roads| {
        let mut is_free = vec![true; ground.heights().len()];
        for road in roads {
            along_line(ground, &road.line, road.width_m, |index| is_free[index] = false);
        }
        distances_m(&is_free, grid)
    });
    if stop.is_stopped() {
        return Err(AnalysisError::Stopped);
    }
    let mut values = hindrances(ground, limits.slopes.free, |index| fitness(land, cover, index));
    let dry_m = arguments.number("dry_m");
    if let Some(water_m) = &water_m {
        rule_out(&mut values, |index| water_m[index] == 0.0 || water_m[index] < dry_m);
    }
    if let Some(road_m) = &road_m {
        rule_out(&mut values, |index| road_m[index] == 0.0);
    }
    rule_out_seen(land, arguments, &mut values, stop)?;
    let masks = masks(land, arguments, &mut values, stop)?;
    let steepest = site_disk(land, arguments.number("size_m")).maxima(&values, columns, f32::INFINITY);
    Ok(SiteGround { steepest, water_m, road_m, masks })
}

fn rule_out(values: &mut [f32], is_out: impl Fn(usize) -> bool + Sync) {
    values.par_iter_mut().enumerate().filter(|(index, _)| is_out(*index)).for_each(|(_, value)| {
        *value = f32::INFINITY;
    });
}

/// Rules out what the posts of `hidden_from` see.
fn rule_out_seen(
    land: &Land,
    arguments: &AnalysisArguments,
    values: &mut [f32],
    stop: &StopFlag,
) -> Result<(), AnalysisError> {
    const KEY: &str = "hidden_from";
    let ground = &*land.ground;
    let range_m = range_m(arguments);
    check_looks(KEY, arguments.points(KEY).len() as f64, posts_within(ground, range_m))?;
    let sight = SightLand::new(land);
    for lookout in Lookout::all(land, arguments, KEY, arguments.number("observer_height"))? {
        let options = ViewshedOptions {
            target_above_m: arguments.number("hidden_height"),
            range_m,
            curvature: curvature(arguments),
            ..ViewshedOptions::new(lookout.end)
        };
        let view = sight.look(KEY, &options, stop)?;
        view.merge_into(values, PostRect::all(ground), |value, post| {
            if post == PostVisibility::Visible {
                *value = f32::INFINITY;
            }
        });
    }
    Ok(())
}

/// Rules out what is masked too little or too much toward a direction of `enemy_deg`; the least mask of each post.
fn masks(
    land: &Land,
    arguments: &AnalysisArguments,
    values: &mut [f32],
    stop: &StopFlag,
) -> Result<Option<Vec<f32>>, AnalysisError> {
    let (least, greatest) = (arguments.number("least_mask"), arguments.number("greatest_mask"));
    if least > greatest {
        return Err(AnalysisError::argument("least_mask", "is above `greatest_mask`; state a lower one"));
    }
    let azimuths = arguments.numbers("enemy_deg");
    if azimuths.len() > MOST_DIRECTIONS {
        return Err(AnalysisError::argument(
            "enemy_deg",
            format!("must be up to {MOST_DIRECTIONS} directions"),
        ));
    }
    let [least, greatest] = [least, greatest].map(tangent);
    let mut lowest: Option<Vec<f32>> = None;
    for azimuth in azimuths {
        if stop.is_stopped() {
            return Err(AnalysisError::Stopped);
        }
        let masks = mask_tangents(&land.ground, azimuth);
        rule_out(values, |index| !(masks[index] >= least && masks[index] <= greatest));
        match &mut lowest {
            None => lowest = Some(masks),
            Some(lowest) => lowest.iter_mut().zip(masks).for_each(|(low, mask)| *low = low.min(mask)),
        }
    }
    Ok(lowest)
}

/// How the cover of a post suits a site: 2 well, 1 with caution, 0 not.
fn fitness(land: &Land, wanted: SiteCover, index: usize) -> u8 {
    let cover = cover_at(land, index);
    let has_trees = land.woods.as_ref().is_some_and(|woods| woods[index].spacing_m > 0.0);
    let is_tall = land.obstacles_m.as_ref().is_some_and(|heights| heights[index] > LOW_M);
    let cover = if has_trees && cover != LandCover::Building { LandCover::Wood } else { cover };
    let by_cover: [u8; 3] = match cover {
        LandCover::Unknown | LandCover::Open | LandCover::Paved => [2, 2, 0],
        LandCover::Crops | LandCover::Sand | LandCover::Rock => [1, 1, 0],
        LandCover::Scrub => [1, 1, 1],
        LandCover::Wood | LandCover::Orchard => return [1, 0, 2][wanted as usize],
        LandCover::BuiltUp => [1, 0, 1],
        LandCover::Wetland | LandCover::Building => [0, 0, 0],
    };
    if is_tall { 0 } else { by_cover[wanted as usize] }
}

/// From 0 to 1: the mean of what is left of each limit, of the slope and of the stated distances to water and roads.
fn score(site: &SiteGround, limits: &SiteLimits, index: usize) -> f32 {
    let left = |value: f64, limit: f64| if limit > 0.0 { 1.0 - (value / limit).min(1.0) } else { 1.0 };
    let (mut sum, mut parts) =
        (left(f64::from(site.steepest[index]), f64::from(limits.slopes.greatest)), 1.0);
    for (distances, limit_m) in [(&site.water_m, limits.water_m), (&site.road_m, limits.road_m)] {
        if let (Some(distances), Some(limit_m)) = (distances, limit_m) {
            sum += left(distances[index], limit_m);
            parts += 1.0;
        }
    }
    (sum / parts) as f32
}

/// A row of the table of sites. What is unknown or not stated is `None`.
struct SiteRow {
    index: usize,
    code: u8,
    score: f64,
    surface: SiteSurface,
    water_m: Option<f64>,
    road_m: Option<f64>,
    mask_deg: Option<f64>,
}

impl SiteRow {
    fn new((score, code): (f32, u8), surface: SiteSurface, site: &SiteGround, index: usize) -> Self {
        let finite = |distances: &Option<Vec<f64>>| {
            distances.as_ref().map(|distances| distances[index]).filter(|distance| distance.is_finite())
        };
        let degrees = |tangent: f32| libm::atan(f64::from(tangent)).to_degrees();
        Self {
            index,
            code,
            score: f64::from(score),
            surface,
            water_m: finite(&site.water_m),
            road_m: finite(&site.road_m),
            mask_deg: site.masks.as_ref().map(|masks| degrees(masks[index])),
        }
    }

    fn properties(&self) -> Vec<(&'static str, PropertyValue)> {
        let mut properties = vec![
            ("code", PropertyValue::Whole(i64::from(self.code))),
            ("score", PropertyValue::Number(self.score)),
            ("slope_deg", PropertyValue::Number(self.surface.slope_deg)),
            ("surface", self.surface.cover_noun()),
        ];
        let distances = [("water_m", self.water_m), ("road_m", self.road_m), ("mask_deg", self.mask_deg)];
        properties.extend(
            distances.into_iter().filter_map(|(name, value)| Some((name, PropertyValue::Number(value?)))),
        );
        properties
    }
}

fn table(rows: &[SiteRow], centers: &CenterColumns) -> OutcomeTable {
    let column = TableColumn::new;
    let optional = [
        (column("to water", "m", 0), (|row: &SiteRow| row.water_m) as fn(&SiteRow) -> Option<f64>),
        (column("to road", "m", 0), |row| row.road_m),
        (column("mask", "°", 1), |row| row.mask_deg),
    ];
    let shown = || optional.iter().filter(|(_, value)| rows.iter().any(|row| value(row).is_some()));
    let mut columns = vec![TableColumn::of_marks("site")];
    columns.extend(centers.columns());
    columns.extend([
        column("class", "", 0),
        column("score", "", 2),
        column("slope", "°", 1),
        column("surface", "", 0),
    ]);
    columns.extend(shown().map(|(column, _)| column.clone()));
    let cells = |(rank, row): (usize, &SiteRow)| {
        let mut cells = vec![PropertyValue::Text(site_name(rank))];
        cells.extend(centers.cells(rank));
        cells.extend([
            PropertyValue::Text(class_name(row.code).to_owned()),
            PropertyValue::Number(row.score),
            PropertyValue::Number(row.surface.slope_deg),
            row.surface.cover_noun(),
        ]);
        cells.extend(shown().map(|(_, value)| match value(row) {
            Some(value) => PropertyValue::Number(value),
            None => PropertyValue::Text(String::new()),
        }));
        cells
    };
    OutcomeTable { title: "Sites".to_owned(), columns, rows: rows.iter().enumerate().map(cells).collect() }
}

#[cfg(test)]
#[path = "sites_tests.rs"]
mod tests;
