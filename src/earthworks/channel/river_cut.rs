//! A river to cut into the ground, and the result of cutting it.

use crate::alignment::Alignment;
use sandtable_base::limits::RIVER_POSTS;
use sandtable_terrain::volumes::Volumes;

/// A river to cut.
#[derive(Clone, Debug)]
pub struct Channel {
    /// The centerline in world coordinates, downstream, and the water's width.
    pub alignment: Alignment,
    /// How far beyond the bed the ground is blended, in meters, at least 0.
    pub bank_m: f64,
    /// How deep the ground may be cut, and how high it may be filled before a lake, in meters, above 0; infinite for any
    /// depth. A post that several channels touch may be cut as deep as the deepest of them.
    pub max_cut_m: f64,
}

/// The result of cutting one channel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cut {
    /// The water's level in meters where the line first has ground, and where it last has; `None` where it has none.
    pub levels_m: Option<(f64, f64)>,
    /// How deep the ground was cut at most, in meters.
    pub deepest_m: f64,
    /// Earth moved. What two channels share counts for one of them.
    pub volumes: Volumes,
    /// Where the ground rises downstream all the same, in order; no two meet.
    pub climbs: Vec<Climb>,
}

/// A stretch of a channel along which the ground rises downstream because no cut as deep as allowed lets water fall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Climb {
    /// Where it starts, in meters from the line's start.
    pub from_m: f64,
    /// Where it ends.
    pub to_m: f64,
    /// How far the ground rises along it, in meters; what it falls on the way is taken off.
    pub rise_m: f64,
}

/// The result of cutting a network.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cuts {
    /// One for each channel.
    pub cuts: Vec<Cut>,
}

/// Why a network cannot be cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChannelError {
    /// Beds of hundreds of millions of posts.
    #[error(
        "the beds of these rivers would cover more than {RIVER_POSTS} posts, each counted once a cell along the river; narrow them, or {RIVER_POSTS:#}"
    )]
    TooWide,
}
