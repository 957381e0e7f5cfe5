//! Parts of messages to users.

pub mod suggest;
