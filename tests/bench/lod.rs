//! `cargo bench --bench lod`: what the level-of-detail core costs, beside others and beside its own plain ways.

#[path = "lod/bound.rs"]
mod bound;

fn main() {
    bound::print();
}
