//! `cargo bench --bench lod`: what the level-of-detail core costs, beside others and beside its own plain ways.

#[path = "lod/edits.rs"]
mod edits;

fn main() {
    edits::print();
}
