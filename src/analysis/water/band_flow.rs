//! Accumulation over land in bands, as [`drainage`](super::drainage) counts it in memory (Barnes 2017).
//!
//! ```text
//!   entry                 what enters a band at a post of its edge leaves it at one exit or nowhere; an exit passes on what
//!     ▼                   the band itself drains through it and what enters above it
//!  ───●─────────●───
//!      ╲       ╱          so that the flow over all borders is counted on the posts of edges alone, and each band is counted
//!       ╲     ▼           once more with what enters it
//!  ──────●──────────
//!        ▼ exit
//! ```

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::band_flats::BandFlats;
use super::bands::{BandArray, BandStore, LandBands, opposite};
use super::directions::{NO_DIRECTION, OFF};
use super::drainage::accumulated;
use super::fill::{BASIN, OUTSIDE, end_walk};
use crate::error::AnalysisError;
use sandtable_terrain::neighbors::STEPS;
use sandtable_terrain::stop_flag::StopFlag;

/// No post of an edge.
const NONE: u32 = u32::MAX;

/// Land in bands of which all posts have directions, and what enters bands.
pub(crate) struct BandFlow {
    /// The posts that drain over the border into each post of an edge.
    inflow: Vec<u32>,
}

/// What the posts of edges know of each other.
struct EdgeFlow {
    /// The post beyond the border that each drains to.
    to: Vec<u32>,
    /// The exit by which what enters at each leaves its band, itself it may be.
    exit: Vec<u32>,
    /// The posts of its own band that drain through an exit.
    own: Vec<u32>,
}

impl BandFlow {
    /// Keeps the directions of all posts and counts the flow over borders.
    ///
    /// # Errors
    /// Those of the store; [`AnalysisError::Stopped`].
    pub fn new<S: BandStore>(
        bands: &LandBands,
        flats: &BandFlats,
        store: &mut S,
        stop: &StopFlag,
    ) -> Result<Self, S::Error> {
        let nothing = || vec![NONE; bands.edge_posts()];
        let mut flow = EdgeFlow { to: nothing(), exit: nothing(), own: vec![0; bands.edge_posts()] };
        for band in 0..bands.count() {
            if stop.is_stopped() {
                return Err(AnalysisError::Stopped.into());
            }
            let mut codes = flats.codes(bands, band, store)?;
            bands.write(store, BandArray::Codes, bands.rows_of(band).start, &codes)?;
            flow.learn(bands, band, &mut codes);
        }
        Ok(Self { inflow: flow.inflow() })
    }

    /// The number of posts that drain through each of a band, itself among them; 0 without data.
    ///
    /// # Errors
    /// Those of the store.
    pub fn counts<S: BandStore>(
        &self,
        bands: &LandBands,
        band: usize,
        store: &mut S,
    ) -> Result<Vec<u32>, S::Error> {
        let mut codes: Vec<u8> = bands.read(store, BandArray::Codes, bands.rows_of(band))?;
        let mut inflow = vec![0; codes.len()];
        for (edge, row) in bands.edges_of(band) {
            inflow[row * bands.columns..(row + 1) * bands.columns]
                .copy_from_slice(&self.inflow[bands.edge(edge)]);
            (0..bands.columns).for_each(|column| {
                leave(bands, (edge, row), column, &mut codes);
            });
        }
        Ok(accumulated(&codes, bands.columns, inflow))
    }
}

/// Lets a post on an edge that drains over the border drain off the band; returns the post beyond, among those of all edges.
fn leave(bands: &LandBands, (edge, row): (usize, usize), column: usize, codes: &mut [u8]) -> Option<u32> {
    let code = &mut codes[row * bands.columns + column];
    if *code == OFF || *code == NO_DIRECTION {
        return None;
    }
    let (east, north) = STEPS[usize::from(*code) - 1];
    let is_over = if row == 0 { north < 0 } else { north > 0 };
    is_over.then(|| {
        *code = OFF;
        (bands.edge(opposite(edge)).start + column).wrapping_add_signed(east as isize) as u32
    })
}

impl EdgeFlow {
    /// Takes up what the directions of a band say; those over its borders become [`OFF`].
    fn learn(&mut self, bands: &LandBands, band: usize, codes: &mut [u8]) {
        let columns = bands.columns;
        for (edge, row) in bands.edges_of(band) {
            for (column, post) in bands.edge(edge).enumerate() {
                self.to[post] = leave(bands, (edge, row), column, codes).unwrap_or(NONE);
            }
        }
        let counts = accumulated(codes, columns, vec![0; codes.len()]);
        let step = |(index, &code): (usize, &u8)| match code {
            OFF | NO_DIRECTION => AtomicU32::new(OUTSIDE),
            code => {
                let (east, north) = STEPS[usize::from(code) - 1];
                let by = north as isize * columns as isize + east as isize;
                AtomicU32::new(index.wrapping_add_signed(by) as u32)
            }
        };
        let next: Vec<AtomicU32> = codes.par_iter().enumerate().with_min_len(1 << 14).map(step).collect();
        // The way of what enters ends in the number of its exit among the posts of edges, from 1 on.
        let edge_posts = || {
            let of_edge = |(edge, row): (usize, usize)| {
                bands.edge(edge).enumerate().map(move |(column, post)| (row * columns + column, post))
            };
            bands.edges_of(band).flat_map(of_edge)
        };
        for (index, post) in edge_posts().filter(|&(_, post)| self.to[post] != NONE) {
            self.own[post] = counts[index];
            next[index].store(BASIN | (post as u32 + 1), Ordering::Relaxed);
        }
        for (index, post) in edge_posts() {
            end_walk(&next, index);
            let end = next[index].load(Ordering::Relaxed);
            self.exit[post] = if end == OUTSIDE { NONE } else { (end & !BASIN) - 1 };
        }
    }

    /// The posts that drain over the border into each post of an edge.
    fn inflow(self) -> Vec<u32> {
        let Self { to, exit, own: mut total } = self;
        let posts = to.len();
        let mut inflow = vec![0; posts];
        // How many neighbors beyond the border have not told a post yet, and how many entries an exit.
        let mut awaited = vec![0_u32; posts];
        let mut awaited_entries = vec![0_u32; posts];
        to.iter().filter(|&&to| to != NONE).for_each(|&to| awaited[to as usize] += 1);
        for (&exit, _) in exit.iter().zip(&awaited).filter(|&(&exit, &awaited)| exit != NONE && awaited > 0) {
            awaited_entries[exit as usize] += 1;
        }
        let sources = (0..posts).filter(|&post| to[post] != NONE && awaited_entries[post] == 0);
        for source in sources.collect::<Vec<_>>() {
            let mut at = source;
            while to[at] != NONE {
                let entry = to[at] as usize;
                inflow[entry] += total[at];
                awaited[entry] -= 1;
                if awaited[entry] > 0 || exit[entry] == NONE {
                    break;
                }
                at = exit[entry] as usize;
                total[at] += inflow[entry];
                awaited_entries[at] -= 1;
                if awaited_entries[at] > 0 {
                    break;
                }
            }
        }
        inflow
    }
}
