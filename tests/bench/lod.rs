//! `cargo bench --bench lod`: what the level-of-detail core costs, beside others and beside its own plain ways.

#[path = "lod/paging.rs"]
mod paging;

fn main() {
    paging::print();
}
