//! Summits and the passes that part them from higher ground, to the post.
//!
//! Posts are flooded from the highest down, level ones by their index. A post without a flooded neighbor is a summit; one
//! where two floods meet is the pass of the lower summit, whose prominence is its height above the pass (the merge tree of
//! Carr, Snoeyink and Axen 2003; prominence as Kirmse and de Ferranti 2017).

use std::collections::BTreeSet;

use rayon::prelude::*;

use crate::error::AnalysisError;
use sandtable_base::disjoint_sets::root;
use sandtable_base::limits::memory::check_memory;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::neighbors::neighbors;
use sandtable_terrain::stop_flag::StopFlag;

/// A summit and its pass, by indices of posts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DivideSummit {
    /// Its post; of level ground the first.
    pub(super) post: usize,
    /// The post of the pass to higher ground; `None` for the highest of connected ground.
    pub(super) pass: Option<usize>,
    /// Above the pass, or above the lowest post of connected ground; meters, above 0.
    pub(super) prominence_m: f32,
}

/// A post that is not flooded yet.
const DRY: u32 = u32::MAX;

/// Bytes of a post: its place in the order and its flood, with what sorting needs.
const BYTES_PER_POST: u64 = 16;

/// How many posts are flooded between two looks at the stop flag.
const POSTS_PER_LOOK: usize = 1 << 16;

/// All summits that rise at least so many meters above their pass, the most prominent first. Those at the border are among
/// them.
///
/// # Errors
/// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
pub(super) fn divide_summits(
    ground: &Lattice,
    least_m: f32,
    stop: &StopFlag,
) -> Result<Vec<DivideSummit>, AnalysisError> {
    let heights = ground.heights();
    check_memory(
        heights.len() as u64 * BYTES_PER_POST,
        "the divides of the ground",
        "name a smaller `extent`",
    )?;
    let mut order: Vec<u32> =
        (0..heights.len() as u32).filter(|&post| !heights[post as usize].is_nan()).collect();
    order.par_sort_unstable_by(|&a, &b| heights[b as usize].total_cmp(&heights[a as usize]).then(a.cmp(&b)));
    let mut floods = vec![DRY; heights.len()];
    let mut summits = Vec::new();
    stop.stretch(0.3..0.8, order.len());
    for posts in order.chunks(POSTS_PER_LOOK) {
        if stop.is_stopped() {
            return Err(AnalysisError::Stopped);
        }
        stop.did(posts.len());
        for &post in posts {
            floods[post as usize] = post;
            for neighbor in posts_around(ground, post as usize) {
                if floods[neighbor] == DRY {
                    continue;
                }
                let (own, other) = (root(&mut floods, post), root(&mut floods, neighbor as u32));
                if own == other {
                    continue;
                }
                // The root of a flood is its summit; the later one in the order is lower.
                let is_own_lower = is_after(heights, own, other);
                let (lower, higher) = if is_own_lower { (own, other) } else { (other, own) };
                floods[lower as usize] = higher;
                let prominence_m = heights[lower as usize] - heights[post as usize];
                if lower != post && prominence_m > 0.0 && prominence_m >= least_m {
                    let (post, pass) = (lower as usize, Some(post as usize));
                    summits.push(DivideSummit { post, pass, prominence_m });
                }
            }
        }
    }
    // The last post of a flood is its lowest.
    let mut is_measured = vec![false; heights.len()];
    for &lowest in order.iter().rev() {
        let root = root(&mut floods, lowest) as usize;
        if !std::mem::replace(&mut is_measured[root], true) {
            let prominence_m = heights[root] - heights[lowest as usize];
            if prominence_m > 0.0 && prominence_m >= least_m {
                summits.push(DivideSummit { post: root, pass: None, prominence_m });
            }
        }
    }
    summits.sort_by(|a, b| b.prominence_m.total_cmp(&a.prominence_m).then(a.post.cmp(&b.post)));
    Ok(summits)
}

/// The passes of summits with their depth, the prominence of the lower summit; where more than two floods meet, the
/// deepest. The deepest first.
pub(super) fn divide_passes(summits: &[DivideSummit]) -> Vec<(usize, f32)> {
    let mut seen = BTreeSet::new();
    let passes = summits.iter().filter_map(|summit| summit.pass.map(|pass| (pass, summit.prominence_m)));
    passes.filter(|&(pass, _)| seen.insert(pass)).collect()
}

/// Whether post `a` is flooded after `b`.
fn is_after(heights: &[f32], a: u32, b: u32) -> bool {
    heights[b as usize].total_cmp(&heights[a as usize]).then(a.cmp(&b)).is_gt()
}

/// The posts around a post, eight inside of the lattice.
pub(super) fn posts_around(ground: &Lattice, post: usize) -> impl Iterator<Item = usize> + use<> {
    neighbors(post, ground.columns() as usize, ground.rows() as usize).map(|(_, other)| other)
}
