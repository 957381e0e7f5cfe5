//! What these tests share with others; what is above the core has no part in them.

// Each test binary uses its own part of what is shared.
#![allow(dead_code)]

#[path = "../common/data.rs"]
pub mod data;
#[path = "../common/skip.rs"]
pub mod skip;
