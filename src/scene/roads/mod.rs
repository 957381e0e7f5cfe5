//! Roads: centerlines from the document, the ground they want, the ribbons and junctions they make.
//!
//! ```text
//!  centerline::collect ─► conform: the ground follows, stretches become bridges and tunnels
//!                      ─► levels: how high bridges and tunnels run ─► network::lay
//! ```

pub mod at_grade;
pub mod centerline;
pub mod chains;
pub mod conform;
pub mod crossings;
pub mod levels;
pub mod meetings;
pub mod network;
pub mod network_survey;
pub mod profiles;
pub mod route;
pub mod spans;
