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
#[path = "lod/fields.rs"]
mod fields;
#[path = "lod/flight.rs"]
mod flight;
#[path = "lod/frame.rs"]
mod frame;
#[path = "lod/paging.rs"]
mod paging;
#[path = "lod/refiners.rs"]
mod refiners;
#[path = "lod/rounds.rs"]
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
    // cargo hands on flags of its own, such as --bench
    let wanted: Vec<String> = std::env::args().skip(1).filter(|name| !name.starts_with('-')).collect();
    let names: Vec<&str> = SECTIONS.iter().map(|&(name, _)| name).collect();
    if let Some(unknown) = wanted.iter().find(|name| !names.contains(&name.as_str())) {
        eprintln!("there is no section '{unknown}'; there are {}", names.join(", "));
        std::process::exit(2);
    }
    println!("{}", rounds::machine());
    if cfg!(debug_assertions) {
        println!("This is a build for debugging: its times say nothing about a release.");
    }
    for (name, print) in SECTIONS {
        if wanted.is_empty() || wanted.iter().any(|wanted| wanted == name) {
            println!("\n== {name} (load {})\n", rounds::load());
            print();
        }
    }
}
