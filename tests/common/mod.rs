//! What several integration tests share.

// Each test binary uses its own part of this.
#![allow(dead_code)]

pub mod data;
pub mod findings;
pub mod forest;
pub mod golden;
pub mod mountain_lake;
pub mod places;
pub mod scratch;
pub mod shapefile;
pub mod skip;
pub mod synthetic;
pub mod tiles;
pub mod validator;
