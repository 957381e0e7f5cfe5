//! Parts of messages to users.

pub mod capitalized;
pub mod chain;
pub mod choice;
pub mod numbers;
pub mod suggest;
pub mod xml;
