//! `cargo bench --bench heights`: what it costs to read elevation, to make grids of points and to answer questions
//! about heights, beside others.
//!
//! One section a question, one file a section. `cargo bench --bench heights -- NAME…` runs some of them; without names,
//! all are run. What is compared is run in turn (see `rounds`), because the ratio of two times taken together means
//! something on any machine, and a time alone only on the machine that it was taken on.

#[allow(dead_code, reason = "each bench uses its own part")]
#[path = "common/fields.rs"]
mod fields;
#[path = "heights/gridding.rs"]
mod gridding;
#[allow(dead_code, reason = "each bench uses its own part")]
#[path = "common/peers.rs"]
mod peers;
#[path = "heights/reading.rs"]
mod reading;
#[allow(dead_code, reason = "each bench uses its own part")]
#[path = "common/rounds.rs"]
mod rounds;

#[path = "heights/hillshade.rs"]
mod hillshade;
#[path = "heights/queries.rs"]
mod queries;
#[path = "heights/rays.rs"]
mod rays;
#[path = "heights/service.rs"]
mod service;
#[path = "heights/viewshed.rs"]
mod viewshed;
#[path = "heights/windows.rs"]
mod windows;

/// A section's name and what prints it.
type Section = (&'static str, fn());

const SECTIONS: &[Section] = &[
    ("service", service::print),
    ("reading", reading::print),
    ("windows", windows::print),
    ("queries", queries::print),
    ("rays", rays::print),
    ("viewshed", viewshed::print),
    ("hillshade", hillshade::print),
    ("gridding", gridding::print),
];

fn main() {
    rounds::sections(SECTIONS);
}
