//! The land: the ground and what lies and stands on it, a value a post.

use std::sync::Arc;

use glam::DVec2;

use crate::movement::vehicle::Vehicle;
use sandtable_catalog::kind::LandPart;
use sandtable_geom::crs::Crs;
use sandtable_terrain::lattice::Lattice;

/// The land that an analysis is about. Layers hold a value for each post, row by row from the south-west, roads are lines; a
/// layer that is `None` is unknown, which a layer without anything in it is not.
#[derive(Clone)]
pub struct Land {
    /// The ground after earthworks.
    pub ground: Arc<Lattice>,
    /// Its coordinate system.
    pub crs: Crs,
    /// What covers the ground.
    pub cover: Option<Vec<LandCover>>,
    /// The roads.
    pub roads: Option<Vec<RoadLine>>,
    /// The water over each post.
    pub water: Option<Vec<WaterPost>>,
    /// The trees around each post.
    pub woods: Option<Vec<Stand>>,
    /// The height above the ground of what stands at each post, meters; 0 where nothing does.
    pub obstacles_m: Option<Vec<f32>>,
    /// Bridges, culverts and fords.
    pub crossings: Vec<Crossing>,
    /// Whether the crossings are known although the roads are not asked for.
    pub knows_crossings: bool,
    /// Walls, fences, banks and cliffs that a vehicle must climb.
    pub steps: Vec<Step>,
    /// Ditches and other gaps that a vehicle must cross.
    pub gaps: Vec<Gap>,
    /// The vehicles that the scene describes.
    pub vehicles: Vec<Vehicle>,
    /// The ground to compare with, on the same posts.
    pub other_ground: Option<Arc<Lattice>>,
}

/// What covers the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum LandCover {
    /// Nothing is known.
    #[default]
    Unknown,
    /// Grass, pasture, bare soil.
    Open,
    /// Fields with crops.
    Crops,
    /// Vineyards, orchards, plantations in rows.
    Orchard,
    /// Scrub, heath.
    Scrub,
    /// Woods.
    Wood,
    /// Swamp, marsh, reed.
    Wetland,
    /// Sand, dunes, shingle.
    Sand,
    /// Rock, scree, glacier.
    Rock,
    /// Built-up ground: houses with streets and gardens.
    BuiltUp,
    /// Under the roof of a building.
    Building,
    /// Paved ground other than roads: yards, runways.
    Paved,
}

impl LandCover {
    /// Its name in tables.
    pub const fn noun(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::Open => "open ground",
            Self::Crops => "crops",
            Self::Orchard => "orchard",
            Self::Scrub => "scrub",
            Self::Wood => "wood",
            Self::Wetland => "wetland",
            Self::Sand => "sand",
            Self::Rock => "rock",
            Self::BuiltUp => "built-up",
            Self::Building => "building",
            Self::Paved => "paved",
        }
    }
}

/// The surface of a road.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum RoadClass {
    /// No road.
    #[default]
    None,
    /// A path for people on foot.
    Path,
    /// A track: unpaved, for wheels.
    Track,
    /// A paved road of one or two lanes.
    Road,
    /// A main road.
    Main,
    /// A motorway.
    Motorway,
}

/// The water over a post.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WaterPost {
    /// What it is.
    pub kind: WaterKind,
    /// Its depth in meters; NaN where that is unknown.
    pub depth_m: f32,
}

/// A kind of water.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum WaterKind {
    /// None.
    #[default]
    None,
    /// A river, stream or canal.
    River,
    /// A lake or pond.
    Lake,
    /// The sea.
    Sea,
}

/// The trees around a post.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stand {
    /// Meters from one stem to the next; 0 where there are no trees.
    pub spacing_m: f32,
    /// The diameter of a stem at breast height, meters; NaN where that is unknown.
    pub stem_m: f32,
}

/// The center line of a road.
#[derive(Clone, Debug)]
pub struct RoadLine {
    /// Its name; may be empty.
    pub name: String,
    /// Map coordinates, two or more.
    pub line: Vec<DVec2>,
    /// Its surface.
    pub surface: RoadClass,
    /// Its width in meters.
    pub width_m: f64,
}

/// A place where a way and water pass each other.
#[derive(Clone, Debug)]
pub struct Crossing {
    /// Its name; may be empty.
    pub name: String,
    /// What it is.
    pub kind: CrossingKind,
    /// Map coordinates of the way over it: the deck of a bridge, the ford's line, the road over an inferred culvert; of a culvert
    /// that the data have, the water's line in it.
    pub line: Vec<DVec2>,
    /// Its width in meters.
    pub width_m: f64,
    /// The greatest load in tonnes; `None` where that is unknown.
    pub load_t: Option<f64>,
}

/// What lets a way and water pass each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CrossingKind {
    /// A bridge: its way is as good as its road, and water passes below.
    Bridge,
    /// A culvert that the data have: water passes along the line below what lies on it.
    Culvert,
    /// A culvert that no data have, inferred where a road crosses a stream: water passes below the road.
    InferredCulvert,
    /// A ford: a way through the water.
    Ford,
}

/// A step in the ground, or a thing like one.
#[derive(Clone, Debug)]
pub struct Step {
    /// Map coordinates, two or more.
    pub line: Vec<DVec2>,
    /// Its height in meters.
    pub height_m: f64,
}

/// A gap in the ground: a ditch or a trench.
#[derive(Clone, Debug)]
pub struct Gap {
    /// Map coordinates, two or more, along it.
    pub line: Vec<DVec2>,
    /// Its width from rim to rim, meters.
    pub width_m: f64,
}

impl Land {
    /// The land of bare ground: nothing is known of what lies on it.
    pub fn bare(ground: Arc<Lattice>, crs: Crs) -> Self {
        Self {
            ground,
            crs,
            cover: None,
            roads: None,
            water: None,
            woods: None,
            obstacles_m: None,
            crossings: Vec::new(),
            knows_crossings: false,
            steps: Vec::new(),
            gaps: Vec::new(),
            vehicles: Vec::new(),
            other_ground: None,
        }
    }

    /// Whether a layer is known. Crossings are where roads are, or where the land says so.
    pub fn knows(&self, layer: LandPart) -> bool {
        match layer {
            LandPart::Cover => self.cover.is_some(),
            LandPart::Roads => self.roads.is_some(),
            LandPart::Crossings => self.roads.is_some() || self.knows_crossings,
            LandPart::Water => self.water.is_some(),
            LandPart::Woods => self.woods.is_some(),
            LandPart::Obstacles => self.obstacles_m.is_some(),
        }
    }
}
