//! A kind of analysis.

use crate::parameter::{AnalysisParameter, EXTENT};

/// A kind of analysis: a function from the land to a raster, features or a table.
#[derive(Debug)]
pub struct AnalysisKind {
    /// Its name: `kind` of `[[analysis]]`, and the word after `sandtable analyze`.
    pub name: &'static str,
    /// What it is about.
    pub family: AnalysisFamily,
    /// Its name in headings and legends.
    pub title: &'static str,
    /// What it computes, a sentence.
    pub summary: &'static str,
    /// Its parameters, in the order in which people read them.
    pub parameters: &'static [AnalysisParameter],
    /// What it gives.
    pub yields: AnalysisYield,
    /// From how far away the land has an effect on a value.
    pub reach: AnalysisReach,
    /// The layers of the land that it uses besides the ground; it says so where the land lacks one.
    pub layers: &'static [LandPart],
    /// Author and year, or the manual.
    pub source: &'static str,
    /// What it does not know, or may get wrong, a sentence each.
    pub limits: &'static [&'static str],
}

/// What analyses are about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AnalysisFamily {
    /// The form of the ground.
    Surface,
    /// Movement across it.
    Movement,
    /// Observation and fire over it.
    Observation,
    /// Landing and sites on it.
    Landing,
    /// Water on it.
    Water,
    /// Earth that is moved.
    Earth,
}

impl AnalysisFamily {
    /// All of them, in the order in which people read them.
    pub const ALL: [Self; 6] =
        [Self::Surface, Self::Movement, Self::Observation, Self::Landing, Self::Water, Self::Earth];

    /// Its name in headings.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Surface => "Surface",
            Self::Movement => "Movement",
            Self::Observation => "Observation and fire",
            Self::Landing => "Landing and sites",
            Self::Water => "Water",
            Self::Earth => "Earth",
        }
    }
}

/// What an analysis gives besides its figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnalysisYield {
    /// A value for each post.
    Raster,
    /// Points, lines or areas.
    Features,
    /// Both.
    Both,
    /// Rows of a table alone.
    Table,
}

/// From how far away the land has an effect on a value of a raster.
///
/// What reaches so many posts gives the same bits on a part of the land with that many posts around it as on the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnalysisReach {
    /// From at most so many posts.
    Posts(u32),
    /// From as many of the longer sides of a cell as this parameter says, and a post more.
    PostsBy(&'static str),
    /// From as many meters as this parameter says, and the posts of one cell more.
    MetersBy(&'static str),
    /// From between the value and the places of a parameter, as far as another parameter says, or everywhere without it. An
    /// extent cuts the land.
    Between {
        /// The parameter of the places.
        places: &'static str,
        /// The parameter of the range, meters.
        range: &'static str,
    },
    /// From everywhere within the range of the places: parted where the range is stated. An extent cuts the land.
    Around {
        /// The parameter of the places.
        places: &'static str,
        /// The parameter of the range, meters.
        range: &'static str,
    },
    /// From everywhere: the land cannot be parted, and an extent cuts it.
    Whole,
}

/// A layer of the land besides the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LandPart {
    /// What covers the ground.
    Cover,
    /// Roads, with their classes.
    Roads,
    /// Rivers, lakes and the sea.
    Water,
    /// Woods: the spacing of trees and their stems.
    Woods,
    /// Things that stand on the ground, with their heights.
    Obstacles,
    /// Bridges, culverts and fords.
    Crossings,
}

impl LandPart {
    /// Its name in messages.
    pub const fn noun(self) -> &'static str {
        match self {
            Self::Cover => "land cover",
            Self::Roads => "roads",
            Self::Water => "water",
            Self::Woods => "woods",
            Self::Obstacles => "trees and buildings",
            Self::Crossings => "bridges, culverts and fords",
        }
    }
}

impl AnalysisKind {
    /// Its own parameters, then those that every kind has.
    pub fn all_parameters(&self) -> impl Iterator<Item = &'static AnalysisParameter> {
        self.parameters.iter().chain([&EXTENT])
    }

    /// Its own parameter of this name; `None` where the kind has none.
    pub fn parameter(&self, name: &str) -> Option<&'static AnalysisParameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }
}
