//! The height query service as its clients meet it: the program is started, and asked over sockets.

mod common;

#[path = "serve/bits.rs"]
mod bits;
#[path = "serve/client.rs"]
mod client;
#[path = "serve/ground.rs"]
mod ground;
#[path = "serve/heights.rs"]
mod heights;
#[path = "serve/hostile.rs"]
mod hostile;
#[path = "serve/manners.rs"]
mod manners;
#[path = "serve/refusals.rs"]
mod refusals;
