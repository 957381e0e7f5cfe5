//! The vertical alignment of roads: how high a road runs at each station, for a whole network at once.
//!
//! A road may not rise faster than its grade, should lie as near to the ground as that allows, and where roads meet they
//! must agree. All three are one problem on a graph whose edges are stretches of road, and it has a closed form:
//!
//! ```text
//!   ground ──► envelope: the lowest profile above it and the highest below it ──► fit: midway between
//!          ──► ease: vertical curves ──► spans: where fill or cut is too high, bridges and tunnels
//!          ──► once more without the ground that those pass over or under
//! ```
//!
//! Midway between the two envelopes no other profile of that grade has a lower highest fill or cut (McShane, "Extension
//! of range of functions", 1934: the envelopes are his extensions). Least squares would move less earth in the sum, at
//! the price of an iteration without a bound, and of deeper cuts at the worst place.

pub mod chain;
pub mod design;
pub mod ease;
pub mod envelope;
pub mod fit;
pub mod network;
pub mod spans;
