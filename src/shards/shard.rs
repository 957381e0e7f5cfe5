//! One shard of a plan: a line of `shards.jsonl`.

use serde::{Deserialize, Serialize};

/// A shard.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shard {
    /// Its number in the plan, from 0.
    pub id: usize,
    /// Its name for people.
    pub name: String,
    /// A guess of the work; only ratios mean something.
    pub cost: f64,
    /// What it reads: columns and rows of an elevation file, or the rectangle of a sheet.
    pub window: ShardWindow,
    /// How far the window reaches beyond the points, in samples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub halo: Option<u32>,
    /// Its part of the points of a plan of heights.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub points: Option<PointRange>,
    /// The observers of viewsheds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub observers: Option<Vec<[f64; 2]>>,
    /// Level, x and y of the tile that a shard holds with all below it; none of the top.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tile: Option<[u64; 3]>,
    /// The row of a sheet, from the north, and its column, from the west, from 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sheet: Option<[u64; 2]>,
    /// The sheets beside it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub neighbors: Option<SheetNeighbors>,
}

impl Shard {
    /// A shard with a number, a cost and a window, and without all that a product needs besides.
    pub fn new(id: usize, name: String, cost: f64, window: ShardWindow) -> Self {
        Self {
            id,
            name,
            cost,
            window,
            halo: None,
            points: None,
            observers: None,
            tile: None,
            sheet: None,
            neighbors: None,
        }
    }
}

/// The numbers of the sheets beside a sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[allow(missing_docs, reason = "the names are directions")]
pub struct SheetNeighbors {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub north: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub east: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub south: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub west: Option<usize>,
}

impl SheetNeighbors {
    /// The neighbors that exist, with the names of their sides.
    pub fn sides(&self) -> impl Iterator<Item = (&'static str, usize)> {
        let Self { north, east, south, west } = *self;
        let all = [("north", north), ("east", east), ("south", south), ("west", west)];
        all.into_iter().filter_map(|(side, id)| Some((side, id?)))
    }
}

/// The part of the input that a shard reads.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ShardWindow {
    /// Column, row, width and height: in samples of an elevation file, from the north-west, or in posts of the ground in
    /// meters, from the south-west.
    Grid([u32; 4]),
    /// Least x and y, greatest x and y: in the system of a scene, or in degrees.
    Map([f64; 4]),
}

/// A part of the points of a plan, which lie in `points.bin` shard by shard.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PointRange {
    /// The number of points before it.
    pub first: u64,
    /// Its points.
    pub count: u64,
    /// Of their bytes.
    pub sha256: String,
}

/// The file name of a shard's results without an extension.
pub fn stem(id: usize) -> String {
    format!("{id:06}")
}
