//! Stations that run on from ribbon to ribbon, so that dashes do not begin anew where one line ends and the next begins.
//!
//! Ends that go on in one another make chains. A chain is walked from its free end, or, where it is a ring, from its
//! first line; a line that points against the walk has its stations run against it.

use std::collections::BTreeMap;

use crate::ribbon::junction::{LineEnd, StreetEnd};
use crate::ribbon::stroke::Stations;

/// The stations of every line, given the lines' lengths and which ends go on in one another.
pub fn stations(lengths_m: &[f64], links: &[[StreetEnd; 2]]) -> Vec<Stations> {
    let beyond: BTreeMap<StreetEnd, StreetEnd> = links.iter().flat_map(|&[a, b]| [(a, b), (b, a)]).collect();
    let mut found: Vec<Option<Stations>> = vec![None; lengths_m.len()];
    let ends = |which: LineEnd| (0..lengths_m.len()).map(move |street| StreetEnd { street, which });
    let free = ends(LineEnd::First).chain(ends(LineEnd::Last)).filter(|end| !beyond.contains_key(end));
    for start in free.chain(ends(LineEnd::First)) {
        walk(start, lengths_m, &beyond, &mut found);
    }
    found.into_iter().map(Option::unwrap_or_default).collect()
}

/// Follows a chain from the end `start` of its first line, as far as it has not been walked.
fn walk(
    start: StreetEnd,
    lengths_m: &[f64],
    beyond: &BTreeMap<StreetEnd, StreetEnd>,
    found: &mut [Option<Stations>],
) {
    let (mut entry, mut station_m) = (Some(start), 0.0);
    while let Some(StreetEnd { street, which }) = entry.filter(|end| found[end.street].is_none()) {
        let length_m = lengths_m[street];
        let (stations, exit) = match which {
            LineEnd::First => (Stations { first_m: station_m, per_m: 1.0 }, LineEnd::Last),
            LineEnd::Last => (Stations { first_m: station_m + length_m, per_m: -1.0 }, LineEnd::First),
        };
        found[street] = Some(stations);
        station_m += length_m;
        entry = beyond.get(&StreetEnd { street, which: exit }).copied();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn end(street: usize, which: LineEnd) -> StreetEnd {
        StreetEnd { street, which }
    }

    #[test]
    fn stations_run_on_whichever_way_a_line_points() {
        let links = [
            [end(0, LineEnd::Last), end(1, LineEnd::Last)],
            [end(1, LineEnd::First), end(2, LineEnd::First)],
        ];
        let found = stations(&[10.0, 20.0, 5.0], &links);
        let expected = [(0.0, 1.0), (30.0, -1.0), (30.0, 1.0)];
        assert_eq!(found, expected.map(|(first_m, per_m)| Stations { first_m, per_m }));
    }

    #[test]
    fn a_ring_is_walked_once() {
        let links = [
            [end(0, LineEnd::Last), end(1, LineEnd::First)],
            [end(1, LineEnd::Last), end(0, LineEnd::First)],
            [end(2, LineEnd::Last), end(2, LineEnd::First)],
        ];
        let found = stations(&[10.0, 20.0, 5.0], &links);
        assert_eq!(found.iter().map(|stations| stations.first_m).collect::<Vec<_>>(), [0.0, 10.0, 0.0]);
    }
}
