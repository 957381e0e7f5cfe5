//! Roads as a graph: sections between the nodes where roads end or meet.

use crate::alignment::Support;
use crate::alignment::chain::LineEnd;
use crate::alignment::spans::EarthworkLimits;

/// A place where roads end or meet, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(pub u32);

impl NodeId {
    /// Its place in a list of one entry a node.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A stretch of road between two nodes and none between.
#[derive(Clone, Debug, PartialEq)]
pub struct RoadSection {
    /// Where it begins and ends; may be one node.
    pub ends: [NodeId; 2],
    /// Distances from its beginning in meters, from 0, never falling; at least two.
    pub stations_m: Vec<f64>,
    /// The ground at its stations in meters; NaN where there is none.
    pub ground_m: Vec<f64>,
    /// The steepest rise along it, meters per meter, above 0.
    pub max_grade: f64,
    /// What is stated to carry it from end to end; the ground carries it unless it cannot.
    pub support: Support,
    /// What an embankment and a cutting may be.
    pub limits: EarthworkLimits,
    /// The levels that are stated for it at its stations in meters, whatever the grade; `None` where they are designed.
    pub stated_m: Option<Vec<f64>>,
}

impl RoadSection {
    /// Its length in meters.
    pub fn length_m(&self) -> f64 {
        self.stations_m[self.stations_m.len() - 1]
    }
}

/// One number a station of every section, such as heights in meters; NaN where there is none.
pub type StationLevels = Vec<Vec<f64>>;

/// Levels that no network of roads can have.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum SectionLevelsError {
    /// A section is steeper than it may be.
    #[error("section {section} rises {rise_m} m in {run_m} m at station {station_m} m")]
    Steep { section: usize, rise_m: f64, run_m: f64, station_m: f64 },
    /// Two sections disagree where they meet.
    #[error("{node:?} lies at {before_m} m, and at {level_m} m for section {section}")]
    Apart { node: NodeId, before_m: f64, level_m: f64, section: usize },
}

/// A network of sections.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SectionNetwork {
    /// How many nodes there are.
    pub nodes: usize,
    /// Their ends are all among the nodes.
    pub sections: Vec<RoadSection>,
}

impl SectionNetwork {
    /// The ends of sections at each node, in order.
    pub fn arms(&self) -> Vec<Vec<LineEnd>> {
        let mut arms = vec![Vec::new(); self.nodes];
        for (index, section) in self.sections.iter().enumerate() {
            for (end, node) in section.ends.into_iter().enumerate() {
                arms[node.index()].push(LineEnd { line: index, end });
            }
        }
        arms
    }

    /// Levels that are NaN everywhere.
    pub fn nowhere(&self) -> StationLevels {
        self.sections.iter().map(|section| vec![f64::NAN; section.stations_m.len()]).collect()
    }

    /// Whether no section rises or falls faster than it may, but for `slack` meters per meter, and all sections agree
    /// where they meet, to a millimeter. Stations without a level are passed over.
    ///
    /// # Errors
    /// The first place that does not.
    pub fn check(&self, levels: &StationLevels, slack: f64) -> Result<(), SectionLevelsError> {
        let mut at_node = vec![f64::NAN; self.nodes];
        for (index, (section, levels)) in self.sections.iter().zip(levels).enumerate() {
            for (stations, pair) in section.stations_m.windows(2).zip(levels.windows(2)) {
                let (run_m, rise_m) = (stations[1] - stations[0], (pair[1] - pair[0]).abs());
                // A millimeter for stations that rounding has put beside each other.
                if rise_m > run_m * (section.max_grade + slack) + 1e-3 {
                    let station_m = stations[0];
                    return Err(SectionLevelsError::Steep { section: index, rise_m, run_m, station_m });
                }
            }
            for (node, level_m) in section.ends.into_iter().zip([levels[0], levels[levels.len() - 1]]) {
                let before_m = std::mem::replace(&mut at_node[node.index()], level_m);
                if (before_m - level_m).abs() > 1e-3 {
                    return Err(SectionLevelsError::Apart { node, before_m, level_m, section: index });
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A section between two nodes over ground at height 0, without limits.
    pub fn section(ends: [u32; 2], stations_m: Vec<f64>, max_grade: f64) -> RoadSection {
        let ground_m = vec![0.0; stations_m.len()];
        let (support, limits) = (Support::Ground, EarthworkLimits::NONE);
        RoadSection {
            ends: ends.map(NodeId),
            stations_m,
            ground_m,
            max_grade,
            support,
            limits,
            stated_m: None,
        }
    }
}
