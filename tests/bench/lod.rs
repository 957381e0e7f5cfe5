//! `cargo bench --bench lod`: what the level-of-detail core costs, beside others and beside its own plain ways.

#[path = "lod/fields.rs"]
mod fields;
#[path = "lod/rtin.rs"]
mod rtin;

fn main() {
    rtin::print();
}
