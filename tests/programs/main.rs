//! The command line, the HTTP service, and the README with its book.

#[path = "../common/mod.rs"]
mod common;

mod cli;
mod findings_page;
mod readme;
mod serve;
mod systems;
