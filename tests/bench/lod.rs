//! `cargo bench --bench lod`: what the level-of-detail core costs, beside others and beside its own plain ways.
//!
//! One section a question, one file a section. `cargo bench --bench lod -- NAME…` runs some of them; without names,
//! all are run. What is compared is run in turn within one process (see `rounds`), because the ratio of two times
//! taken together means something on any machine, and a time alone only on the machine that it was taken on.

#[path = "lod/bound.rs"]
mod bound;
#[path = "lod/edits.rs"]
mod edits;
#[path = "lod/emitters.rs"]
mod emitters;
#[path = "common/fields.rs"]
mod fields;
#[path = "lod/flight.rs"]
mod flight;
#[path = "lod/frame.rs"]
mod frame;
#[path = "lod/paging.rs"]
mod paging;
#[path = "lod/refiners.rs"]
mod refiners;
#[path = "common/rounds.rs"]
mod rounds;
#[path = "lod/rtin.rs"]
mod rtin;
#[path = "lod/stateless.rs"]
mod stateless;
#[path = "lod/walks.rs"]
mod walks;

/// A section's name and what prints it.
type Section = (&'static str, fn());

const SECTIONS: &[Section] = &[
    ("frame", frame::print),
    ("refiners", refiners::print),
    ("rtin", rtin::print),
    ("bound", bound::print),
    ("edits", edits::print),
    ("emitters", emitters::print),
    ("paging", paging::print),
];

fn main() {
    rounds::sections(SECTIONS);
}
