//! `serve`: what it refuses before it listens. What it answers is in `tests/serve.rs`.

use crate::cli::run_in;
use crate::common::scratch::Scratch;

const GRID: &str = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2\n3 4\n";

/// A port that is free, so that nothing is disturbed where the program listens after all.
const ANY: [&str; 2] = ["--listen", "127.0.0.1:0"];

fn refused(arguments: &[&str], code: i32) -> String {
    let scratch = Scratch::new();
    scratch.write("grid.asc", GRID);
    scratch.write("los.asc", GRID);
    let all = [&["serve"][..], arguments, &ANY].concat();
    run_in(scratch.folder(), &all).failed(code)
}

#[test]
fn a_file_that_cannot_be_had_is_named() {
    assert!(refused(&["grid.asc", "none.asc"], 1).contains("none.asc"));
    assert!(refused(&[], 2).contains("FILE"));
}

#[test]
fn two_datasets_of_one_name_and_names_that_are_taken_are_refused_with_a_way_out() {
    let twice = refused(&["grid.asc", "./grid.asc"], 2);
    assert!(twice.contains("'grid'") && twice.contains("other=./grid.asc"), "{twice}");
    let taken = refused(&["los.asc"], 2);
    assert!(taken.contains("'los'") && taken.contains("hills=los.asc"), "{taken}");
    refused(&["a,b=grid.asc"], 2);
}

#[test]
fn an_address_that_is_none_or_in_use_is_refused() {
    let scratch = Scratch::new();
    scratch.write("grid.asc", GRID);
    let serve = |listen: &str| run_in(scratch.folder(), &["serve", "grid.asc", "--listen", listen]);
    for wrong in ["8080", "nowhere", "127.0.0.1", "127.0.0.1:99999"] {
        assert!(serve(wrong).failed(2).contains("127.0.0.1:8080"), "{wrong}");
    }
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = taken.local_addr().expect("an address").to_string();
    assert!(serve(&address).failed(1).contains(&address));
}
