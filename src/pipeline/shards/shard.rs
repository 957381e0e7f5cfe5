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
}

/// What a shard reads.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ShardWindow {
    /// Column, row, width and height: in samples of an elevation file, from the north-west, or in posts of the ground in
    /// meters, from the south-west.
    Grid([u32; 4]),
    /// Least x and y, greatest x and y in the system of a scene.
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
