//! What every other crate stands on: zip archives, numbers in binary files, limits on input and work, words in messages.

pub mod archive;
pub mod bytes;
pub mod limits;
pub mod message;
