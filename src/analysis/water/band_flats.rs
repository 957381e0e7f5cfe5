//! Directions of filled land in bands, across its flats, as [`directions`](super::directions) finds them in memory.
//!
//! The two distances of each post in a flat, to higher ground and to an outlet, are spread within a band, and over a border where
//! that makes them shorter, band by band to the north and to the south until none changes: then they are the least over all the land.
//! A flat that goes through a band once, as lakes do, takes two passes; one that winds through the same border again and again takes
//! as many as it crosses.

use glam::DVec2;
use rayon::prelude::*;

use super::band_fill::BandFill;
use super::bands::{BandArray, BandStore, LandBands, opposite};
use super::directions::{FlatRank, NO_DIRECTION, SHARE, direction_on_flat, fall_lines, flat_mask};
use crate::error::AnalysisError;
use sandtable_terrain::neighbors::neighbors;
use sandtable_terrain::stop_flag::StopFlag;

/// The distance of a post outside all flats.
const NO_FLAT: u32 = 0;

/// The distance of a post in a flat as long as none is known.
const UNKNOWN: u32 = u32::MAX;

/// Distances of posts in flats, in bands.
struct BandDistances {
    array: BandArray,
    /// Those of the posts of edges.
    edges: Vec<u32>,
}

/// Land in bands whose posts outside flats have directions, and those in flats distances.
pub(crate) struct BandFlats {
    away: BandDistances,
    toward: BandDistances,
    has_flats: Vec<bool>,
}

impl BandFlats {
    /// Keeps the filled heights, the directions of posts with lower neighbors, and the distances of those in flats.
    ///
    /// # Errors
    /// Those of the store; [`AnalysisError::Stopped`].
    pub fn new<S: BandStore>(
        bands: &LandBands,
        (fill, cell): (&BandFill, DVec2),
        store: &mut S,
        stop: &StopFlag,
    ) -> Result<Self, S::Error> {
        let columns = bands.columns;
        let mut flats = Self {
            away: BandDistances::new(BandArray::Ways, bands),
            toward: BandDistances::new(BandArray::Toward, bands),
            has_flats: vec![false; bands.count()],
        };
        for band in 0..bands.count() {
            if stop.is_stopped() {
                return Err(AnalysisError::Stopped.into());
            }
            // One row more to each side has directions, and these need heights one row beyond.
            let (rows, around) = (bands.rows_of(band), bands.rows_around(band, 2));
            let heights = fill.filled(bands, store, around.clone(), rows.start)?;
            let own = (rows.start - around.start) * columns..(rows.end - around.start) * columns;
            let mut codes = vec![NO_DIRECTION; heights.len()];
            let mut level = fall_lines(cell, &heights, columns, &mut codes);
            level.retain(|&index| own.contains(&(index as usize)));
            bands.write(store, BandArray::Heights, rows.start, &heights[own.clone()])?;
            bands.write(store, BandArray::Codes, rows.start, &codes[own.clone()])?;
            if level.is_empty() {
                continue;
            }
            flats.has_flats[band] = true;
            let count = around.len();
            let around = |index: u32| neighbors(index as usize, columns, count).map(|(_, other)| other);
            let height = |index: u32| heights[index as usize];
            let is_beside_higher = |index: u32| around(index).any(|other| heights[other] > height(index));
            let is_beside_outlet =
                |index: u32| around(index).any(|other| codes[other] <= 8 && heights[other] == height(index));
            let first = own.start as u32;
            let level_of_band: Vec<u32> = level.iter().map(|index| index - first).collect();
            for (distances, is_edge) in [
                (&mut flats.away, &is_beside_higher as &(dyn Fn(u32) -> bool + Sync)),
                (&mut flats.toward, &is_beside_outlet),
            ] {
                let edge = |share: &[u32]| -> Vec<(u32, u32)> {
                    let picked = share.iter().filter(|&&index| is_edge(index));
                    picked.map(|index| (1, index - first)).collect()
                };
                let edge = level.par_chunks(SHARE).map(edge).collect::<Vec<_>>().concat();
                distances.start(bands, band, (&level_of_band, edge), store, stop)?;
            }
        }
        flats.away.settle(bands, &flats.has_flats, store, stop)?;
        flats.toward.settle(bands, &flats.has_flats, store, stop)?;
        Ok(flats)
    }

    /// The directions of the posts of a band, those in flats among them.
    ///
    /// # Errors
    /// Those of the store.
    pub fn codes<S: BandStore>(
        &self,
        bands: &LandBands,
        band: usize,
        store: &mut S,
    ) -> Result<Vec<u8>, S::Error> {
        let rows = bands.rows_of(band);
        if !self.has_flats[band] {
            return bands.read(store, BandArray::Codes, rows);
        }
        let (columns, around) = (bands.columns, bands.rows_around(band, 1));
        let mut codes: Vec<u8> = bands.read(store, BandArray::Codes, around.clone())?;
        let heights: Vec<f32> = bands.read(store, BandArray::Heights, around.clone())?;
        let away = self.away.around(bands, band, store)?;
        let toward = self.toward.around(bands, band, store)?;
        let own = (rows.start - around.start) * columns..(rows.end - around.start) * columns;
        let direction = |index: usize| {
            let rank = |other: usize| match (toward[other], away[other]) {
                (NO_FLAT, _) => {
                    let is_outlet = codes[other] <= 8 && heights[other] == heights[index];
                    is_outlet.then_some(FlatRank::Outlet)
                }
                (toward, UNKNOWN) => Some(FlatRank::Flat(flat_mask(toward, 0))),
                (toward, away) => Some(FlatRank::Flat(flat_mask(toward, away))),
            };
            match toward[index] {
                NO_FLAT => codes[index],
                _ => direction_on_flat(neighbors(index, columns, around.len()), rank),
            }
        };
        let found: Vec<u8> = own.clone().into_par_iter().with_min_len(SHARE).map(direction).collect();
        codes.truncate(own.end);
        codes.drain(..own.start);
        codes.copy_from_slice(&found);
        Ok(codes)
    }
}

impl BandDistances {
    fn new(array: BandArray, bands: &LandBands) -> Self {
        Self { array, edges: vec![NO_FLAT; bands.edge_posts()] }
    }

    /// Spreads from the edge of the flats of a band and from the band south of it. `level` are the posts in flats.
    fn start<S: BandStore>(
        &mut self,
        bands: &LandBands,
        band: usize,
        (level, edge): (&[u32], Vec<(u32, u32)>),
        store: &mut S,
        stop: &StopFlag,
    ) -> Result<(), S::Error> {
        let mut distances = vec![NO_FLAT; bands.rows_of(band).len() * bands.columns];
        level.iter().for_each(|&index| distances[index as usize] = UNKNOWN);
        self.keep_edges(bands, band, &distances);
        let mut offers = self.offers(bands, band);
        offers.extend(edge);
        spread(&mut distances, bands.columns, offers, stop)?;
        self.keep_edges(bands, band, &distances);
        bands.write(store, self.array, bands.rows_of(band).start, &distances)
    }

    /// Spreads over the borders of bands until no distance becomes shorter.
    fn settle<S: BandStore>(
        &mut self,
        bands: &LandBands,
        has_flats: &[bool],
        store: &mut S,
        stop: &StopFlag,
    ) -> Result<(), S::Error> {
        let south = (0..bands.count()).rev();
        let order: Vec<usize> = south.chain(0..bands.count()).filter(|&band| has_flats[band]).collect();
        loop {
            let mut is_settled = true;
            for &band in &order {
                let offers = self.offers(bands, band);
                if offers.is_empty() {
                    continue;
                }
                is_settled = false;
                let rows = bands.rows_of(band);
                let mut distances: Vec<u32> = bands.read(store, self.array, rows.clone())?;
                spread(&mut distances, bands.columns, offers, stop)?;
                self.keep_edges(bands, band, &distances);
                bands.write(store, self.array, rows.start, &distances)?;
            }
            if is_settled {
                return Ok(());
            }
        }
    }

    fn keep_edges(&mut self, bands: &LandBands, band: usize, distances: &[u32]) {
        for (edge, row) in bands.edges_of(band) {
            self.edges[bands.edge(edge)]
                .copy_from_slice(&distances[row * bands.columns..(row + 1) * bands.columns]);
        }
    }

    /// The distances by which posts on the edges of a band come nearer across its borders, with their numbers in the band.
    fn offers(&self, bands: &LandBands, band: usize) -> Vec<(u32, u32)> {
        let mut offers = Vec::new();
        for (edge, row) in bands.edges_of(band) {
            let (own, beyond) = (&self.edges[bands.edge(edge)], &self.edges[bands.edge(opposite(edge))]);
            for (column, &known) in own.iter().enumerate().filter(|(_, known)| **known != NO_FLAT) {
                let beside = &beyond[column.saturating_sub(1)..(column + 2).min(bands.columns)];
                let nearest =
                    beside.iter().filter(|&&distance| distance != NO_FLAT && distance != UNKNOWN).min();
                let offer = nearest.map(|distance| distance + 1).filter(|&distance| distance < known);
                offers.extend(offer.map(|distance| (distance, (row * bands.columns + column) as u32)));
            }
        }
        offers
    }

    /// The distances in a band and in the rows beside it.
    fn around<S: BandStore>(
        &self,
        bands: &LandBands,
        band: usize,
        store: &mut S,
    ) -> Result<Vec<u32>, S::Error> {
        let mut distances = bands.read(store, self.array, bands.rows_of(band))?;
        for (edge, row) in bands.edges_of(band) {
            let beside = &self.edges[bands.edge(opposite(edge))];
            match row {
                0 => distances.splice(0..0, beside.iter().copied()).for_each(drop),
                _ => distances.extend(beside),
            }
        }
        Ok(distances)
    }
}

/// Spreads distances from posts that have come to be so near, through the flats that they lie in, where that makes them shorter.
fn spread(
    distances: &mut [u32],
    columns: usize,
    mut offers: Vec<(u32, u32)>,
    stop: &StopFlag,
) -> Result<(), AnalysisError> {
    offers.par_sort_unstable();
    let rows = distances.len() / columns;
    let mut offers = offers.into_iter().peekable();
    let (mut now, mut next) = (Vec::new(), Vec::new());
    let mut distance = 0;
    loop {
        match (now.is_empty(), offers.peek()) {
            (true, None) => return Ok(()),
            (true, Some(&(nearest, _))) => distance = nearest,
            (false, _) => {}
        }
        while let Some((_, index)) = offers.next_if(|&(offered, _)| offered == distance) {
            now.push(index);
        }
        if stop.is_stopped() {
            return Err(AnalysisError::Stopped);
        }
        for index in now.drain(..) {
            if distances[index as usize] <= distance {
                continue;
            }
            distances[index as usize] = distance;
            let beside = neighbors(index as usize, columns, rows).map(|(_, other)| other);
            next.extend(beside.filter(|&other| distances[other] > distance + 1).map(|other| other as u32));
        }
        std::mem::swap(&mut now, &mut next);
        distance += 1;
    }
}
