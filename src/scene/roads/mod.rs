//! Roads: centrelines from the document, the ground they want, the ribbons and junctions they make.
//!
//! ```text
//!  centreline::collect ─► conform: the ground follows, stretches become bridges and tunnels
//!                      ─► levels: how high bridges and tunnels run ─► network::lay
//! ```

pub mod at_grade;
pub mod centreline;
pub mod chains;
pub mod conform;
pub mod crossings;
pub mod levels;
pub mod meetings;
pub mod network;
pub mod profiles;
pub mod route;
pub mod spans;
pub mod stretches;
pub mod survey;
