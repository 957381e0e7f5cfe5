//! Depressions of land in bands, filled as [`fill`](super::fill) fills them in memory.
//!
//! A band alone is filled to the posts of its edges, each a way out of its own. How high the water stands at an edge is then found
//! from the passes between ways out, within bands and across their borders, and all that drains by a way out stands no lower
//! (Barnes 2016). No more is kept in memory than the posts of edges and as many passes.

use std::ops::Range;

use super::bands::{BandArray, BandStore, LandBands, opposite};
use super::fill::{BASIN, BasinMeeting, Basins, flooded, raised, sortable};
use crate::error::AnalysisError;
use sandtable_base::limits::memory::check_memory;
use sandtable_terrain::stop_flag::StopFlag;

/// Bytes for each post of an edge: two passes across the border and one within, sorted, and what joins them.
const EDGE_BYTES: u64 = 64;

/// Land in bands whose depressions are filled.
pub(crate) struct BandFill {
    /// How high the water stands at each way out, the outside first, then the posts of edges.
    levels: Vec<f32>,
}

impl BandFill {
    /// Fills each band to its edges and keeps its heights and ways out; finds how high the water stands at the edges.
    ///
    /// # Errors
    /// Those of the store; [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
    pub fn new<S: BandStore>(bands: &LandBands, store: &mut S, stop: &StopFlag) -> Result<Self, S::Error> {
        let count = bands.edge_posts();
        let bytes = if count < BASIN as usize { count as u64 * EDGE_BYTES } else { u64::MAX };
        check_memory(bytes, "flow over the land", "take a smaller extent or wider posts")
            .map_err(AnalysisError::from)?;
        let mut edges = vec![f32::NAN; count];
        let mut passes = Vec::new();
        for band in 0..bands.count() {
            if stop.is_stopped() {
                return Err(AnalysisError::Stopped.into());
            }
            let rows = bands.rows_of(band);
            let heights = store.heights(rows.clone())?;
            for (edge, row) in bands.edges_of(band) {
                let own = row * bands.columns..(row + 1) * bands.columns;
                edges[bands.edge(edge)].copy_from_slice(&heights[own]);
            }
            let basins = Basins::of(&heights, bands.columns, bands.is_open(band), stop)?;
            // Outlets on an edge are no ways out of the band, and the outside is theirs.
            for (edge, row) in bands.edges_of(band) {
                let start = bands.edge(edge).start;
                passes.extend((0..bands.columns).filter_map(|column| {
                    let index = row * bands.columns + column;
                    basins.ends_outside(index).then(|| (sortable(heights[index]), 0, number(start + column)))
                }));
            }
            let (numbers, is_way_out) = ways_out(bands, band, &basins);
            let flood = basins.flood(&is_way_out);
            let of_all = |basin: u32| numbers[basin as usize];
            passes.extend(flood.passes.iter().map(|&(height, a, b)| (height, of_all(a), of_all(b))));
            let ways: Vec<u32> = flood.ways.iter().map(|&way| of_all(way)).collect();
            bands.write(store, BandArray::Ways, rows.start, &basins.spread(&ways, 0))?;
            bands.write(store, BandArray::Heights, rows.start, &basins.filled(&flood))?;
        }
        (0..bands.count().saturating_sub(1)).for_each(|band| across(bands, 2 * band, &edges, &mut passes));
        let mut is_way_out = vec![false; count + 1];
        is_way_out[0] = true;
        Ok(Self { levels: flooded(passes, &is_way_out).levels })
    }

    /// The filled heights of rows, meters; those before row `done` were written filled.
    ///
    /// # Errors
    /// Those of the store.
    pub fn filled<S: BandStore>(
        &self,
        bands: &LandBands,
        store: &mut S,
        rows: Range<usize>,
        done: usize,
    ) -> Result<Vec<f32>, S::Error> {
        let open = rows.start.max(done)..rows.end;
        let ways: Vec<u32> = bands.read(store, BandArray::Ways, open.clone())?;
        let mut heights: Vec<f32> = bands.read(store, BandArray::Heights, rows.clone())?;
        for (height, &way) in heights[(open.start - rows.start) * bands.columns..].iter_mut().zip(&ways) {
            *height = raised(*height, self.levels[way as usize]);
        }
        Ok(heights)
    }
}

/// For each basin of a band its number among all ways out, and whether it is one.
fn ways_out(bands: &LandBands, band: usize, basins: &Basins) -> (Vec<u32>, Vec<bool>) {
    let mut numbers = vec![0; basins.ends.len() + 1];
    let mut is_way_out = vec![false; basins.ends.len() + 1];
    is_way_out[0] = true;
    for (edge, row) in bands.edges_of(band) {
        let posts = row * bands.columns..(row + 1) * bands.columns;
        let first = basins.ends.partition_point(|&end| (end as usize) < posts.start);
        for (basin, &end) in basins.ends.iter().enumerate().skip(first) {
            if end as usize >= posts.end {
                break;
            }
            numbers[basin + 1] = number(bands.edge(edge).start + end as usize - posts.start);
            is_way_out[basin + 1] = true;
        }
    }
    (numbers, is_way_out)
}

/// Where ways out meet across a border, `edge` being the one south of it, and those that lie beside a hole beyond it.
fn across(bands: &LandBands, edge: usize, heights: &[f32], passes: &mut Vec<BasinMeeting>) {
    let columns = bands.columns;
    let [south, north] = [edge, opposite(edge)].map(|edge| bands.edge(edge).start);
    for column in 0..columns {
        let own = south + column;
        for other in column.saturating_sub(1)..(column + 2).min(columns) {
            let other = north + other;
            let (here, there) = (heights[own], heights[other]);
            let meeting = match (here.is_nan(), there.is_nan()) {
                (false, false) => (sortable(here.max(there)), number(own), number(other)),
                (false, true) => (sortable(here), 0, number(own)),
                (true, false) => (sortable(there), 0, number(other)),
                (true, true) => continue,
            };
            passes.push(meeting);
        }
    }
}

/// The number of a post of the edges among all ways out.
fn number(edge_post: usize) -> u32 {
    edge_post as u32 + 1
}
