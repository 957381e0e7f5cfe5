//! What these tests share with others; what is above the core has no part in them.

#[path = "../common/data.rs"]
pub mod data;
#[path = "../common/skip.rs"]
pub mod skip;
