//! The height query service as its clients meet it: the program is started, and asked over sockets.

mod analyses;
mod bits;
pub mod client;
#[cfg(unix)]
mod fairness;
mod ground;
mod heights;
mod hostile;
mod manners;
mod page;
mod refusals;
