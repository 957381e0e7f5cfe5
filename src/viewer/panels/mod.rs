//! The panels over the scene: each is a function of its state, so that tests draw it without a window.

pub mod analyses;
pub mod analysis_form;
pub mod detail;
pub mod findings;
pub mod help;
pub mod light;
pub mod open;
pub mod paging;
pub mod timing;
pub mod tools;
pub mod tree;
