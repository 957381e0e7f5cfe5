//! Sections that continue one another, as the one road that their users see.
//!
//! Files cut roads where a name or a speed limit changes. A vertical curve, a bridge or a tunnel goes on across such a
//! cut, and ends only where other roads meet.

use crate::earthworks::alignment::network::{SectionNetwork, StationLevels};

/// Which way a section is gone along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From its beginning.
    Forward,
    /// From its end.
    Backward,
}

/// A section in a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionLink {
    /// Which of the network's sections.
    pub section: usize,
    /// Which way the chain goes along it.
    pub direction: Direction,
    /// The chain's station where the section is entered.
    pub start_m: f64,
}

/// Sections from node to node, each of which continues the one before.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionChain {
    /// At least one; no section twice.
    pub links: Vec<SectionLink>,
}

/// Every section in exactly one chain. A chain goes on where exactly two sections of one grade meet.
pub fn chains(network: &SectionNetwork) -> Vec<SectionChain> {
    let arms = network.arms();
    let follows = |section: usize, end: usize| -> Option<(usize, usize)> {
        let [one, other] = arms[network.sections[section].ends[end].index()][..] else { return None };
        let next = if one == (section, end) { other } else { one };
        let same = network.sections[next.0].max_grade == network.sections[section].max_grade;
        (next.0 != section && same).then_some(next)
    };
    let mut taken = vec![false; network.sections.len()];
    let mut found = Vec::new();
    for first in 0..network.sections.len() {
        if taken[first] {
            continue;
        }
        // Back to where the road begins; round a ring, that is here.
        let (mut section, mut end) = (first, 0);
        while let Some((before, at)) = follows(section, end) {
            (section, end) = (before, 1 - at);
            if section == first {
                break;
            }
        }
        found.push(walk(network, (section, end), &follows, &mut taken));
    }
    found
}

/// The chain from this end of this section on.
fn walk(
    network: &SectionNetwork,
    (mut section, mut end): (usize, usize),
    follows: &impl Fn(usize, usize) -> Option<(usize, usize)>,
    taken: &mut [bool],
) -> SectionChain {
    let (mut links, mut start_m) = (Vec::new(), 0.0);
    loop {
        taken[section] = true;
        let direction = if end == 0 { Direction::Forward } else { Direction::Backward };
        links.push(SectionLink { section, direction, start_m });
        start_m += network.sections[section].length_m();
        match follows(section, 1 - end) {
            Some((next, at)) if !taken[next] => (section, end) = (next, at),
            _ => return SectionChain { links },
        }
    }
}

impl SectionChain {
    /// The chain's stations: those of its sections on end, each shared one once.
    pub fn stations(&self, network: &SectionNetwork) -> Vec<f64> {
        let along = |link: &SectionLink| {
            let section = &network.sections[link.section];
            let station = |&at: &f64| match link.direction {
                Direction::Forward => link.start_m + at,
                Direction::Backward => link.start_m + section.length_m() - at,
            };
            section.stations_m.iter().map(station).collect()
        };
        self.joined(along)
    }

    /// What stands at the chain's stations; where two sections share one, what either says of it.
    pub fn gather(&self, levels: &StationLevels) -> Vec<f64> {
        self.joined(|link| levels[link.section].clone())
    }

    fn joined(&self, of: impl Fn(&SectionLink) -> Vec<f64>) -> Vec<f64> {
        let mut all: Vec<f64> = Vec::new();
        for (index, link) in self.links.iter().enumerate() {
            let mut own = of(link);
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

    /// Puts what stands at the chain's stations back to its sections.
    pub fn scatter(&self, values: &[f64], levels: &mut StationLevels) {
        let mut first = 0;
        for link in &self.links {
            let own = &mut levels[link.section];
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
    use crate::earthworks::alignment::network::{NodeId, RoadSection};

    fn network(ends: &[[u32; 2]]) -> SectionNetwork {
        let section = |&[from, to]: &[u32; 2]| RoadSection {
            ends: [NodeId(from), NodeId(to)],
            stations_m: vec![0.0, 4.0, 10.0],
            max_grade: 0.1,
        };
        let nodes = ends.iter().flatten().max().map_or(0, |&most| most as usize + 1);
        SectionNetwork { nodes, sections: ends.iter().map(section).collect() }
    }

    #[test]
    fn a_road_in_pieces_is_one_chain_whichever_way_they_run() {
        let network = network(&[[1, 2], [1, 0], [3, 2]]);
        let chains = chains(&network);
        assert_eq!(chains.len(), 1);
        let order: Vec<usize> = chains[0].links.iter().map(|link| link.section).collect();
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
        assert_eq!(chains(&network(&[[0, 1], [1, 2], [1, 3]])).len(), 3);
        let ring = chains(&network(&[[0, 1], [1, 2], [2, 0]]));
        assert_eq!((ring.len(), ring[0].links.len()), (1, 3));
        assert_eq!(chains(&network(&[[0, 0]])).len(), 1);
    }
}
