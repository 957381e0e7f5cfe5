//! Roads: centrelines from the document, the ground they want, the ribbons and junctions they make.
//!
//! ```text
//!  centreline::collect ─► (conform: the ground follows, stretches become bridges and tunnels) ─► network::lay
//! ```

pub mod centreline;
pub mod chains;
pub mod crossings;
pub mod levels;
pub mod network;
pub mod spans;
