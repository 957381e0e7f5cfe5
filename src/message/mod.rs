//! Parts of messages to users.

pub mod chain;
pub mod choice;
pub mod suggest;
pub mod xml;
