//! The base of all other crates: zip archives, numbers in binary files, limits on input and work, words in messages, disjoint sets, a
//! hash, loops for the vectors that a processor has.

pub mod archive;
pub mod bytes;
pub mod disjoint_sets;
pub mod limits;
pub mod message;
pub mod split_mix;
pub mod vectorized;
