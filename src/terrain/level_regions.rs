//! Where regions of posts of one height may be large, found on all threads: a search that visits post by post is then made
//! of these alone.
//!
//! A model of whole meters is all terraces, nearly each of them of a few posts. Its rows are worked off band by band as runs
//! of equal heights; runs that touch those of the row before are one part of a region:
//!
//! ```text
//! row before   7 7 7 7 8 8 8 6 6     the part of the 8 goes on, so does that of the 6; that of the 7 has ended, and is
//! row          5 8 8 8 8 8 6 6 6     left out where it is small
//! ```
//!
//! A part that reaches a row where its band ends may go on in the next one, and counts as large.

use rayon::prelude::*;

use sandtable_base::disjoint_sets::root;

/// Rows of a band: enough that few parts reach its ends, few enough that its runs take little memory.
const BAND_ROWS: usize = 64;

/// The index of the first post, of two with one height side by side in a row, of every part of a region of equal heights that may
/// belong to a region of at least `least` posts; rising. The same for any number of threads.
pub fn large_region_posts(heights: &[f32], columns: usize, least: usize) -> Vec<u32> {
    let bands = heights.par_chunks(BAND_ROWS * columns).enumerate().map(|(number, band)| {
        let first = number * BAND_ROWS * columns;
        let is_open = [first > 0, first + band.len() < heights.len()];
        let posts = band_posts(band, columns, is_open, least).into_iter();
        posts.map(|post| (first + post) as u32).collect::<Vec<_>>()
    });
    bands.collect::<Vec<_>>().concat()
}

/// Posts of a row of one height: from the first to before the end.
#[derive(Clone, Copy)]
struct LevelRun {
    first: usize,
    end: usize,
    /// Its part, by index.
    part: usize,
}

/// A part of a region in the rows so far.
struct RegionPart {
    posts: usize,
    /// Whether it reaches a row beyond which the region may go on.
    is_open: bool,
    /// Its first two posts side by side.
    first: Option<usize>,
}

/// The same of one band, by index in it; `is_open` says whether rows lie before and after it.
fn band_posts(band: &[f32], columns: usize, is_open: [bool; 2], least: usize) -> Vec<usize> {
    let last = band.len() / columns - 1;
    let (mut parts, mut links) = (Vec::<RegionPart>::new(), Vec::<usize>::new());
    let (mut before, mut runs) = (Vec::<LevelRun>::new(), Vec::<LevelRun>::new());
    for (row, heights) in band.chunks_exact(columns).enumerate() {
        let reaches_end = row == 0 && is_open[0] || row == last && is_open[1];
        let above = row.checked_sub(1).map(|above| &band[above * columns..][..columns]);
        let (mut first, mut touched) = (0, 0);
        runs.clear();
        while first < columns {
            let height = heights[first];
            let end = first + 1 + heights[first + 1..].iter().take_while(|&&next| next == height).count();
            while before.get(touched).is_some_and(|run| run.end <= first) {
                touched += 1;
            }
            let beside = before[touched..].iter().take_while(|run| run.first < end);
            let mut part = None;
            for run in beside.filter(|run| above.is_some_and(|above| above[run.first] == height)) {
                let other = root(&mut links, run.part);
                part = Some(part.map_or(other, |part| joined(&mut parts, &mut links, part, other)));
            }
            let part = part.unwrap_or_else(|| {
                links.push(parts.len());
                parts.push(RegionPart { posts: 0, is_open: false, first: None });
                parts.len() - 1
            });
            let own = &mut parts[part];
            own.posts += end - first;
            own.is_open |= reaches_end;
            if end - first > 1 {
                own.first.get_or_insert(row * columns + first);
            }
            runs.push(LevelRun { first, end, part });
            first = end;
        }
        std::mem::swap(&mut before, &mut runs);
    }
    let whole = parts.iter().enumerate().filter(|&(part, _)| links[part] == part);
    let large = whole.filter(|(_, part)| part.is_open || part.posts >= least);
    let mut posts: Vec<usize> = large.filter_map(|(_, part)| part.first).collect();
    posts.sort_unstable();
    posts
}

/// Joins two parts that lead to themselves: the lower number stays, and is returned.
fn joined(parts: &mut [RegionPart], links: &mut [usize], one: usize, other: usize) -> usize {
    let (kept, lost) = (one.min(other), one.max(other));
    if kept != lost {
        let RegionPart { posts, is_open, first } = parts[lost];
        let own = &mut parts[kept];
        own.posts += posts;
        own.is_open |= is_open;
        own.first = [own.first, first].into_iter().flatten().min();
        links[lost] = kept;
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The posts by visiting every region post by post.
    fn plain(heights: &[f32], columns: usize, least: usize) -> Vec<u32> {
        let mut is_found = vec![false; heights.len()];
        let mut posts = Vec::new();
        for start in 0..heights.len() {
            let mut open = if is_found[start] { vec![] } else { vec![start] };
            let mut region = Vec::new();
            while let Some(at) = open.pop() {
                if std::mem::replace(&mut is_found[at], true) {
                    continue;
                }
                region.push(at);
                let sides = crate::neighbors::sides(at, columns, heights.len());
                open.extend(sides.into_iter().flatten().filter(|&beside| heights[beside] == heights[at]));
            }
            region.sort_unstable();
            let pair = region
                .iter()
                .find(|&&at| (at + 1) % columns > 0 && heights.get(at + 1) == Some(&heights[at]));
            posts.extend(pair.filter(|_| region.len() >= least).map(|&at| at as u32));
        }
        posts.sort_unstable();
        posts
    }

    #[test]
    fn every_large_region_is_found_and_small_ones_within_a_band_are_not() {
        for (columns, rows, cells) in
            [(97, 200, 3.0), (40, 130, 7.0), (300, 65, 1.3), (2, 90, 2.0), (1, 70, 2.0)]
        {
            let heights: Vec<f32> = (0..columns * rows)
                .map(|at| {
                    let (x, y) = ((at % columns) as f32 / cells, (at / columns) as f32 / cells);
                    let height = (3.0 * libm::sinf(x) + 2.0 * libm::cosf(y + 0.3 * x)).round();
                    if at % 41 == 7 { f32::NAN } else { height }
                })
                .collect();
            let least = 30;
            let found = large_region_posts(&heights, columns, least);
            let large = plain(&heights, columns, least);
            assert!(found.is_sorted());
            assert!(large.iter().all(|post| found.contains(post)), "{columns} × {rows}");
            assert!(found.len() < plain(&heights, columns, 2).len() || columns < 3, "{columns} × {rows}");
        }
    }

    #[test]
    fn in_one_band_the_posts_are_those_of_large_regions_alone() {
        let spiral = [
            1.0, 1.0, 1.0, 1.0, 1.0, //
            2.0, 2.0, 2.0, 2.0, 1.0, //
            1.0, 1.0, 1.0, 2.0, 1.0, //
            1.0, 3.0, 2.0, 2.0, 1.0, //
            1.0, 1.0, 1.0, 1.0, 1.0,
        ];
        assert_eq!(large_region_posts(&spiral, 5, 7), plain(&spiral, 5, 7));
        assert_eq!(large_region_posts(&spiral, 5, 7), [0, 5]);
        assert_eq!(large_region_posts(&spiral, 5, 8), [0]);
    }
}
