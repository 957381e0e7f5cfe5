//! `cargo bench --bench lod`: what the level-of-detail core costs, beside others and beside its own plain ways.

#[path = "lod/emitters.rs"]
mod emitters;

fn main() {
    emitters::print();
}
