//! Hauls from cut to fill: which earth goes where, so that volume times distance is the least.
//!
//! Cut and fill are gathered in square blocks, each at the centroid of its own cut or fill, and shared out by the
//! transportation problem, as mass hauls have been since Stark and Mayer (1983). The plan is the best one for these
//! centroids; how far a plan for every post could be from it is bounded by the earth's own distances to them.

use glam::DVec2;

use super::cut_fill::{differences, shares};
use super::transport::{Shipment, TransportCosts, cheapest_plan};
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{
    FeatureRole, Figure, Outcome, OutcomeFeature, OutcomeShape, OutcomeTable, PropertyValue, TableColumn,
};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// The most blocks with cut, and with fill: some seconds on one core.
const MOST_BLOCKS: usize = 400;

/// The most blocks that a land is divided into, with or without earth in them.
const MOST_SQUARES: f64 = 1e6;

/// Whole units of a cubic meter and of a meter: liters and centimeters.
const LITERS: f64 = 1e3;
const CENTIMETERS: f64 = 1e2;

/// Earth of a block.
#[derive(Clone, Copy, Debug, Default)]
struct EarthBlock {
    /// As cut, m³.
    volume_m3: f64,
    /// The sum of volume times position; after [`gather`] the centroid.
    at: DVec2,
}

/// Cut and fill by blocks.
struct EarthBlocks {
    size_m: f64,
    cuts: Vec<EarthBlock>,
    fills: Vec<EarthBlock>,
    /// Volume times distance to its block's centroid, of all cut and fill, m³·m.
    spread_m4: f64,
}

/// Hauls with their distances, lines between centroids, and what is left over.
///
/// # Errors
/// `against` as of cut and fill; `block_m` where there are too many blocks; [`AnalysisError::Stopped`].
pub(crate) fn haul(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let differences = differences(land, arguments, stop)?;
    let ground = &*land.ground;
    let swell = arguments.number("swell");
    let blocks = match arguments.number_if("block_m") {
        Some(size_m) => gather(ground, &differences, swell, size_m).ok_or_else(|| {
            AnalysisError::argument(
                "block_m",
                format!("gives more than {MOST_BLOCKS} blocks of cut or of fill; state a greater one"),
            )
        })?,
        None => block_sizes(ground)
            .find_map(|size_m| gather(ground, &differences, swell, size_m))
            .ok_or_else(|| AnalysisError::argument("block_m", "finds no size by itself; state one"))?,
    };
    drop(differences);
    let whole = |blocks: &[EarthBlock]| -> Vec<u64> {
        blocks.iter().map(|block| (block.volume_m3 * LITERS).round() as u64).collect()
    };
    let (supplies, demands) = (whole(&blocks.cuts), whole(&blocks.fills));
    let distance_m =
        |shipment: &Shipment| blocks.cuts[shipment.source].at.distance(blocks.fills[shipment.sink].at);
    let mut of_unit = Vec::with_capacity(supplies.len() * demands.len());
    for cut in &blocks.cuts {
        of_unit
            .extend(blocks.fills.iter().map(|fill| (cut.at.distance(fill.at) * CENTIMETERS).round() as u32));
    }
    let costs = TransportCosts { of_unit, sinks: demands.len() };
    let mut plan = cheapest_plan(&supplies, &demands, &costs, stop).ok_or(AnalysisError::Stopped)?;
    let haul_m4 = |shipment: &Shipment| shipment.amount as f64 / LITERS * distance_m(shipment);
    plan.sort_by(|one, other| haul_m4(other).total_cmp(&haul_m4(one)));
    let moved_m3 = plan.iter().map(|shipment| shipment.amount as f64 / LITERS).sum::<f64>();
    let total_m4 = plan.iter().map(haul_m4).sum::<f64>();
    let left = |amounts: &[u64], end: fn(&Shipment) -> usize| {
        let mut left = amounts.to_vec();
        plan.iter().for_each(|shipment| left[end(shipment)] -= shipment.amount);
        left
    };
    let (waste, borrow) = (left(&supplies, |part| part.source), left(&demands, |part| part.sink));
    let sum_m3 = |amounts: &[u64]| amounts.iter().sum::<u64>() as f64 / LITERS;
    let mut features: Vec<OutcomeFeature> = Vec::new();
    let mut rows = Vec::new();
    for shipment in &plan {
        let (from, to) = (blocks.cuts[shipment.source].at, blocks.fills[shipment.sink].at);
        let volume_m3 = shipment.amount as f64 / LITERS;
        rows.push(row(shipment, [from, to], haul_m4(shipment)));
        features.push(OutcomeFeature {
            shape: OutcomeShape::Line(vec![from, to]),
            name: String::new(),
            role: FeatureRole::Haul,
            properties: vec![
                ("volume_m3", PropertyValue::Number(volume_m3)),
                ("distance_m", PropertyValue::Number(from.distance(to))),
                ("haul_m3_km", PropertyValue::Number(haul_m4(shipment) / 1000.0)),
            ],
        });
    }
    for (kind, blocks, left) in [("waste", &blocks.cuts, &waste), ("borrow", &blocks.fills, &borrow)] {
        for (block, &amount) in blocks.iter().zip(left).filter(|(_, amount)| **amount > 0) {
            let volume_m3 = amount as f64 / LITERS;
            features.push(OutcomeFeature {
                shape: OutcomeShape::Point(block.at),
                name: format!("{kind} {volume_m3:.0} m³"),
                role: FeatureRole::Place,
                properties: vec![("volume_m3", PropertyValue::Number(volume_m3))],
            });
        }
    }
    let mean_m = if moved_m3 > 0.0 { total_m4 / moved_m3 } else { 0.0 };
    Ok(Outcome {
        features,
        tables: vec![OutcomeTable { title: "Hauls".to_owned(), columns: columns(), rows }],
        figures: vec![
            Figure::new("moved", moved_m3, "m³"),
            Figure::new("haul", total_m4 / 1000.0, "m³·km"),
            Figure::new("mean distance", mean_m, "m"),
            Figure::new("waste", sum_m3(&waste), "m³"),
            Figure::new("borrow", sum_m3(&borrow), "m³"),
            Figure::new("blocks", blocks.size_m, "m"),
            Figure::new("haul, uncertain by blocks", blocks.spread_m4 / 1000.0, "m³·km"),
        ],
        ..Outcome::default()
    })
}

/// Sizes of blocks to try, 1, 2 and 5 times powers of ten, from that of a post on.
fn block_sizes(ground: &Lattice) -> impl Iterator<Item = f64> {
    let least = ground.cell().max_element();
    let greatest = ground.cell().max_element() * f64::from(ground.columns().max(ground.rows())) * 10.0;
    (-6..=12)
        .flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * libm::pow(10.0, f64::from(power))))
        .filter(move |size| (least..=greatest).contains(size))
}

/// Cut and fill by blocks of a size; `None` where there are too many.
fn gather(ground: &Lattice, differences: &[f32], swell: f64, size_m: f64) -> Option<EarthBlocks> {
    let (columns, rows) = (ground.columns() as usize, ground.rows() as usize);
    let cell = ground.cell();
    let along = |posts: usize, cell_m: f64| ((posts as f64 * cell_m) / size_m).ceil().max(1.0);
    let (wide, high) = (along(columns, cell.x), along(rows, cell.y));
    if wide * high > MOST_SQUARES {
        return None;
    }
    let (wide, high) = (wide as usize, high as usize);
    let mut blocks = [vec![EarthBlock::default(); wide * high], vec![EarthBlock::default(); wide * high]];
    let part = |index: usize, value: f32| {
        let (column, row) = (index % columns, index / columns);
        let at = DVec2::new(column as f64, row as f64) * cell;
        let block =
            ((at.y / size_m) as usize).min(high - 1) * wide + ((at.x / size_m) as usize).min(wide - 1);
        let volume_m3 =
            f64::from(value.abs()) * shares(column, columns) * shares(row, rows) * ground.cell_m2();
        // Fill counts as the cut that it takes.
        (usize::from(value > 0.0), block, at, if value > 0.0 { volume_m3 / swell } else { volume_m3 })
    };
    let parts = || differences.iter().enumerate().filter(|(_, value)| value.abs() > 0.0);
    for (index, &value) in parts() {
        let (side, block, at, volume_m3) = part(index, value);
        blocks[side][block].volume_m3 += volume_m3;
        blocks[side][block].at += at * volume_m3;
    }
    for block in blocks.iter_mut().flatten().filter(|block| block.volume_m3 > 0.0) {
        block.at /= block.volume_m3;
    }
    let spread = |(index, &value): (usize, &f32)| {
        let (side, block, at, volume_m3) = part(index, value);
        blocks[side][block].at.distance(at) * volume_m3
    };
    let spread_m4 = parts().map(spread).sum();
    let origin = ground.map_extent().min;
    let [cuts, fills] = blocks.map(|blocks| {
        let held = blocks.into_iter().filter(|block| block.volume_m3 * LITERS >= 0.5);
        held.map(|block| EarthBlock { at: origin + block.at, ..block }).collect::<Vec<_>>()
    });
    let is_bounded = cuts.len() <= MOST_BLOCKS && fills.len() <= MOST_BLOCKS;
    is_bounded.then_some(EarthBlocks { size_m, cuts, fills, spread_m4 })
}

fn columns() -> Vec<TableColumn> {
    let column = TableColumn::new;
    vec![
        column("from east", "m", 0),
        column("from north", "m", 0),
        column("to east", "m", 0),
        column("to north", "m", 0),
        column("cut", "m³", 0),
        column("distance", "m", 0),
        column("haul", "m³·km", 2),
    ]
}

fn row(shipment: &Shipment, [from, to]: [DVec2; 2], haul_m4: f64) -> Vec<PropertyValue> {
    [from.x, from.y, to.x, to.y, shipment.amount as f64 / LITERS, from.distance(to), haul_m4 / 1000.0]
        .map(PropertyValue::Number)
        .into()
}

#[cfg(test)]
#[path = "haul_tests.rs"]
mod tests;
