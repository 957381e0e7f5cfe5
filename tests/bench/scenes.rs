//! `cargo bench --bench scenes`: what it costs to lay features on the ground, and how that grows with their number.
//!
//! One section a question, one file a section. `cargo bench --bench scenes -- NAME…` runs some of them; without names,
//! all are run. What is compared is run in turn (see `rounds`), because the ratio of two times taken together means
//! something on any machine, and a time alone only on the machine that it was taken on.

#[path = "scenes/roads.rs"]
mod roads;
#[allow(dead_code, reason = "each bench uses its own part")]
#[path = "common/rounds.rs"]
mod rounds;

/// A section's name and what prints it.
type Section = (&'static str, fn());

const SECTIONS: &[Section] = &[("roads", roads::print)];

fn main() {
    rounds::sections(SECTIONS);
}
