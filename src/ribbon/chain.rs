//! Stations that continue from ribbon to ribbon, so that dashes do not start again where one line ends and the next begins.
//!
//! A chain is walked from its free end, or, where it is a ring, from its first line; a line that points against the walk has
//! its stations run against it.

use std::collections::BTreeMap;

use sandtable_earthworks::alignment::chain::{ChainLink, LineEnd};

/// Every line in its chain, given the lines' lengths and which ends continue one another.
pub fn chained(lengths_m: &[f64], links: &[[LineEnd; 2]]) -> Vec<ChainLink> {
    let next: BTreeMap<LineEnd, LineEnd> = links.iter().flat_map(|&[a, b]| [(a, b), (b, a)]).collect();
    let mut chained: Vec<Option<ChainLink>> = vec![None; lengths_m.len()];
    let ends = |end: usize| (0..lengths_m.len()).map(move |line| LineEnd { line, end });
    let free = ends(0).chain(ends(1)).filter(|end| !next.contains_key(end));
    for start in free.chain(ends(0)) {
        let (mut entry, mut station_m) = (Some(start), 0.0);
        while let Some(at) = entry.filter(|at| chained[at.line].is_none()) {
            let link = at.link(station_m, lengths_m[at.line]);
            station_m = link.end_m();
            chained[at.line] = Some(link);
            entry = next.get(&at.opposite()).copied();
        }
    }
    chained.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn end(line: usize, end: usize) -> LineEnd {
        LineEnd { line, end }
    }

    #[test]
    fn stations_run_on_whichever_way_a_line_points() {
        let links = [[end(0, 1), end(1, 1)], [end(1, 0), end(2, 0)]];
        let found: Vec<_> = chained(&[10.0, 20.0, 5.0], &links)
            .iter()
            .map(|link| [0.0, 1.0].map(|at| link.station_m(at)))
            .collect();
        assert_eq!(found, [[0.0, 1.0], [30.0, 29.0], [30.0, 31.0]]);
    }

    #[test]
    fn a_ring_is_walked_once() {
        let links = [[end(0, 1), end(1, 0)], [end(1, 1), end(0, 0)], [end(2, 1), end(2, 0)]];
        let found = chained(&[10.0, 20.0, 5.0], &links);
        assert_eq!(found.iter().map(|link| link.station_m(0.0)).collect::<Vec<_>>(), [0.0, 10.0, 0.0]);
    }
}
