//! Chains: lines in a row, each of which continues the one before.
//!
//! Files cut roads where a name or a speed limit changes. A vertical curve, a bridge or a tunnel continues across such a
//! cut, and ends only where other roads meet.

use crate::alignment::network::{SectionNetwork, StationLevels};

/// The direction of a line in a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From its beginning.
    Forward,
    /// From its end.
    Backward,
}

/// One of the two ends of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct LineEnd {
    /// The index of the line.
    pub line: usize,
    /// 0 for its beginning, 1 for its end.
    pub end: usize,
}

impl LineEnd {
    /// The other end of the line.
    pub fn opposite(self) -> Self {
        Self { end: 1 - self.end, ..self }
    }

    /// The line in a chain that enters it by this end at station `start_m`.
    pub fn link(self, start_m: f64, length_m: f64) -> ChainLink {
        let direction = if self.end == 0 { Direction::Forward } else { Direction::Backward };
        ChainLink { line: self.line, direction, start_m, length_m }
    }
}

/// A line in a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainLink {
    /// The index of the line.
    pub line: usize,
    /// Which way the chain runs along it.
    pub direction: Direction,
    /// The station of the chain where the link begins, in meters.
    pub start_m: f64,
    /// The length of the line in meters.
    pub length_m: f64,
}

impl ChainLink {
    /// The station of the chain at a station of the line.
    pub fn station_m(&self, on_line_m: f64) -> f64 {
        match self.direction {
            Direction::Forward => self.start_m + on_line_m,
            Direction::Backward => self.end_m() - on_line_m,
        }
    }

    /// The station of the chain where the link ends.
    pub fn end_m(&self) -> f64 {
        self.start_m + self.length_m
    }

    /// The stations of the chain at the beginning and the end of the line; the second is the lower where it runs backward.
    pub fn reach_m(&self) -> [f64; 2] {
        match self.direction {
            Direction::Forward => [self.start_m, self.end_m()],
            Direction::Backward => [self.end_m(), self.start_m],
        }
    }

    /// The end of the line by which the chain enters it.
    pub fn entry(&self) -> LineEnd {
        LineEnd { line: self.line, end: usize::from(self.direction == Direction::Backward) }
    }
}

/// The chains of lines with these lengths, every line in exactly one, in the order of their first lines, which run forward.
/// `next` gives the end of another line that continues an end.
pub fn chains(lengths_m: &[f64], next: impl Fn(LineEnd) -> Option<LineEnd>) -> Vec<Vec<ChainLink>> {
    let mut taken = vec![false; lengths_m.len()];
    let mut chains = Vec::new();
    for first in 0..lengths_m.len() {
        if taken[first] {
            continue;
        }
        // Back to where the chain begins; round a ring, that is here.
        let mut entry = LineEnd { line: first, end: 0 };
        while let Some(before) = next(entry) {
            entry = before.opposite();
            if entry.line == first {
                break;
            }
        }
        let (mut links, mut start_m) = (Vec::new(), 0.0);
        let mut entered = Some(entry);
        while let Some(entry) = entered.filter(|entry| !taken[entry.line]) {
            taken[entry.line] = true;
            let link = entry.link(start_m, lengths_m[entry.line]);
            start_m = link.end_m();
            links.push(link);
            entered = next(entry.opposite());
        }
        chains.push(links);
    }
    chains
}

/// Sections in a row, at least one.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionChain {
    /// The sections of the network.
    pub links: Vec<ChainLink>,
}

impl SectionChain {
    /// Every section in exactly one chain. A chain continues where exactly two sections of one grade meet.
    pub fn all(network: &SectionNetwork) -> Vec<Self> {
        let arms = network.arms();
        let next = |at: LineEnd| {
            let [one, other] = arms[network.sections[at.line].ends[at.end].index()][..] else { return None };
            let next = if one == at { other } else { one };
            let is_same = network.sections[next.line].max_grade == network.sections[at.line].max_grade;
            (next.line != at.line && is_same).then_some(next)
        };
        let lengths_m: Vec<f64> = network.sections.iter().map(|section| section.length_m()).collect();
        chains(&lengths_m, next).into_iter().map(|links| Self { links }).collect()
    }

    /// The chain's stations: those of its sections, each shared one once.
    pub fn stations(&self, network: &SectionNetwork) -> Vec<f64> {
        let along = |link: &ChainLink| {
            network.sections[link.line].stations_m.iter().map(|&at| link.station_m(at)).collect()
        };
        self.joined(along)
    }

    /// The levels at the chain's stations; where two sections share one, that of either.
    pub fn gather(&self, levels: &StationLevels) -> Vec<f64> {
        self.joined(|link| levels[link.line].clone())
    }

    fn joined(&self, values_of: impl Fn(&ChainLink) -> Vec<f64>) -> Vec<f64> {
        let mut all: Vec<f64> = Vec::new();
        for (index, link) in self.links.iter().enumerate() {
            let mut own = values_of(link);
            if link.direction == Direction::Backward {
                own.reverse();
            }
            let mut own = own.into_iter();
            if index > 0
                && let (Some(shared), Some(again)) = (all.last_mut(), own.next())
                && shared.is_nan()
            {
                *shared = again;
            }
            all.extend(own);
        }
        all
    }

    /// Writes the levels at the chain's stations back to its sections.
    pub fn scatter(&self, values: &[f64], levels: &mut StationLevels) {
        let mut first = 0;
        for link in &self.links {
            let own = &mut levels[link.line];
            let past = first + own.len();
            own.copy_from_slice(&values[first..past]);
            if link.direction == Direction::Backward {
                own.reverse();
            }
            // The last station is the next section's first.
            first = past - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::network::tests::section;

    fn network(ends: &[[u32; 2]]) -> SectionNetwork {
        let section = |&ends: &[u32; 2]| section(ends, vec![0.0, 4.0, 10.0], 0.1);
        let nodes = ends.iter().flatten().max().map_or(0, |&most| most as usize + 1);
        SectionNetwork { nodes, sections: ends.iter().map(section).collect() }
    }

    #[test]
    fn a_road_in_pieces_is_one_chain_whichever_way_they_run() {
        let network = network(&[[1, 2], [1, 0], [3, 2]]);
        let chains = SectionChain::all(&network);
        assert_eq!(chains.len(), 1);
        let order: Vec<usize> = chains[0].links.iter().map(|link| link.line).collect();
        assert_eq!(order, [1, 0, 2]);
        assert_eq!(chains[0].stations(&network), [0.0, 6.0, 10.0, 14.0, 20.0, 26.0, 30.0]);
        let levels = vec![vec![3.0, 4.0, 5.0], vec![3.0, 2.0, 1.0], vec![7.0, 6.0, 5.0]];
        let along = chains[0].gather(&levels);
        assert_eq!(along, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let mut back = network.nowhere();
        chains[0].scatter(&along, &mut back);
        assert_eq!(back, levels);
    }

    #[test]
    fn a_chain_ends_where_three_meet_and_once_round_a_ring() {
        assert_eq!(SectionChain::all(&network(&[[0, 1], [1, 2], [1, 3]])).len(), 3);
        let ring = SectionChain::all(&network(&[[0, 1], [1, 2], [2, 0]]));
        assert_eq!((ring.len(), ring[0].links.len()), (1, 3));
        assert_eq!(SectionChain::all(&network(&[[0, 0]])).len(), 1);
    }
}
