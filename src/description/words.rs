//! The words that a key may take, one enum a key.
//!
//! To add a word, add a variant with its documentation and its spelling: the decoder, the schema, the reference page and
//! the messages read it from here.

use std::fmt::Debug;

/// A key's value that is one of a few words.
pub trait Word: Copy + Debug + PartialEq + 'static {
    /// Every value, in the order in which messages list them.
    const ALL: &'static [Self];
    /// What is declared of each value, in the same order.
    const DECLARATIONS: &'static [WordDeclaration];

    /// The value that a scene file writes as `word`.
    fn from_word(word: &str) -> Option<Self> {
        let place = Self::DECLARATIONS.iter().position(|declared| declared.word == word)?;
        Self::ALL.get(place).copied()
    }

    /// The word that a scene file writes for it.
    fn word(self) -> &'static str {
        let place = Self::ALL.iter().position(|value| *value == self);
        place.map_or("", |place| Self::DECLARATIONS[place].word)
    }
}

/// A word and its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WordDeclaration {
    /// The word as a scene file writes it.
    pub word: &'static str,
    /// What it means.
    pub doc: &'static str,
}

/// Declares an enum of words: `/// Doc.`, `Variant = "word"`.
macro_rules! words {
    ($(#[$attribute:meta])* $name:ident {
        $(#[doc = $doc:literal] $(#[$variant_attribute:meta])* $variant:ident = $word:literal,)+
    }) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum $name {
            $(#[doc = concat!("`", $word, "`:", $doc)] $(#[$variant_attribute])* $variant,)+
        }

        impl Word for $name {
            const ALL: &'static [Self] = &[$(Self::$variant),+];
            const DECLARATIONS: &'static [WordDeclaration] =
                &[$(WordDeclaration { word: $word, doc: $doc.trim_ascii() }),+];
        }
    };
}

words! {
    /// The paving of a road.
    RoadSurface {
        /// paved
        Asphalt = "asphalt",
        /// a made road without a seal
        Gravel = "gravel",
        /// worn, not made
        Track = "track",
    }
}

words! {
    /// How the height of a model is found.
    #[derive(Default)]
    Clamp {
        /// its lowest point stands on the ground; of a built-in model, its origin
        #[default]
        Ground = "ground",
        /// its origin is `height` above the ground
        Relative = "relative",
        /// its origin is at elevation `height`
        Absolute = "absolute",
    }
}

words! {
    /// What a label names; decides its type and its symbol.
    LabelKind {
        /// a summit
        Summit = "summit",
        /// a town or a farm
        Place = "place",
        /// a river or a lake
        Water = "water",
        /// anything else
        Point = "point",
    }
}

words! {
    /// A built-in color ramp, stretched from the lowest to the highest ground.
    RampName {
        /// green lowland over yellow and brown to white
        Atlas = "atlas",
        /// sand over red rock
        Desert = "desert",
        /// dark to light
        Gray = "gray",
    }
}

words! {
    /// How the colors of a PNG encode heights.
    HeightEncodingWord {
        /// Mapbox Terrain-RGB
        TerrainRgb = "terrain-rgb",
        /// Mapzen Terrarium
        Terrarium = "terrarium",
    }
}

words! {
    /// How two segments of a road meet.
    Join {
        /// both edges run on until they meet
        Miter = "miter",
        /// the outer corner is cut off
        Bevel = "bevel",
        /// the outer corner is an arc
        Round = "round",
    }
}

words! {
    /// The lines on asphalt.
    Markings {
        /// edge lines and a dashed center line
        Dashed = "dashed",
        /// edge lines and a solid center line
        Solid = "solid",
        /// edge lines only
        Edges = "edges",
        /// no lines
        None = "none",
    }
}

words! {
    /// Which of road and ground follows the other.
    ProfileMode {
        /// the road follows the ground
        Drape = "drape",
        /// the ground follows the road
        Conform = "conform",
    }
}

words! {
    /// Where a river's water lies.
    Water {
        /// its level never rises downstream, and the ground is cut to it
        Falls = "falls",
        /// on the ground as it is
        Drape = "drape",
    }
}

words! {
    /// Which height of the ground along its shore is a lake's level.
    LevelRule {
        /// the lowest
        Lowest = "lowest",
        /// the median
        Median = "median",
        /// the mean
        Mean = "mean",
    }
}

words! {
    /// What covers an area.
    Cover {
        /// trees
        Forest = "forest",
        /// bushes
        Scrub = "scrub",
        /// grass
        Meadow = "meadow",
        /// crops in rows
        Field = "field",
        /// fruit trees or vines in rows
        Orchard = "orchard",
        /// marsh
        Wetland = "wetland",
        /// sand or beach
        Sand = "sand",
        /// bare rock
        Rock = "rock",
        /// houses and yards
        BuiltUp = "built-up",
        /// halls and yards
        Industry = "industry",
        /// closed ground, hatched
        Restricted = "restricted",
    }
}

words! {
    /// The line along an area's outline.
    Border {
        /// no line
        None = "none",
        /// an unbroken line
        Solid = "solid",
        /// dashes
        Dashed = "dashed",
    }
}

words! {
    /// The height of the ground under its footprint at which a building stands.
    BaseRule {
        /// the lowest
        Lowest = "lowest",
        /// the mean
        Mean = "mean",
        /// the highest
        Highest = "highest",
        /// the mean, to which the ground is leveled
        Pad = "pad",
    }
}

words! {
    /// The shape of a roof.
    #[derive(Default)]
    RoofShape {
        /// level
        #[default]
        Flat = "flat",
        /// two slopes and two gables
        Gabled = "gabled",
        /// four slopes
        Hipped = "hipped",
        /// slopes that meet in one point
        Pyramidal = "pyramidal",
    }
}

words! {
    /// What stands or runs along a line.
    #[derive(Default)]
    FenceKind {
        /// posts and rails
        #[default]
        Fence = "fence",
        /// masonry
        Wall = "wall",
        /// a row of bushes
        Hedge = "hedge",
        /// pylons and sagging wires
        PowerLine = "power-line",
        /// a trench with a parapet
        Trench = "trench",
        /// a belt of obstacles
        Obstacles = "obstacles",
        /// a dashed line on the ground
        Boundary = "boundary",
    }
}

words! {
    /// The height of the ground that a model stands on.
    #[derive(Default)]
    Anchor {
        /// that under its origin
        #[default]
        Origin = "origin",
        /// the lowest under its footprint
        Lowest = "lowest",
        /// the highest under its footprint
        Highest = "highest",
        /// the mean under its footprint
        Mean = "mean",
    }
}

words! {
    /// What fills the gap between a model and the ground.
    #[derive(Default)]
    Footing {
        /// nothing
        #[default]
        None = "none",
        /// a block down to the ground
        Plinth = "plinth",
        /// the ground is leveled
        Pad = "pad",
    }
}
