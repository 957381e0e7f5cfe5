//! An empty crate: its manifest enables features of third-party crates, so that all builds share their compiled code.
//!
//! Cargo compiles a crate once for each set of features. The program, its tests and the window depend on the same crates
//! with different features, and a crate compiled twice has all that stands on it compiled twice. The program depends on
//! this crate, so all three have one set, and what one of them compiled the others find.
