//! Roads: centrelines from the document, the ground they want, the ribbons and junctions they make.
//!
//! ```text
//!  centreline::collect ─► (conform: the ground follows, stretches become bridges and tunnels) ─► network::lay
//! ```

pub mod centreline;
pub mod network;
