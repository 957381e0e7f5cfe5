//! Files by address: `https://`, `s3://`, `gs://` and `az://`; elevation is read in parts where they are needed.
//!
//! ```text
//! address ─► store ─► http_client ─► the server        one request for neighboring blocks, retried with back-off
//!               │         └ access                     hosts that the user allows, and no others
//!               ▼
//!            object ─► file ◄─► blocks_on_disk         blocks of 8 KiB, checked by their SHA-256
//! ```
//!
//! The Cargo feature `cloud` builds all of it; without it, an address is refused with a sentence that says so. The crate
//! `object_store` signs requests and reads replies, and every request of it, for a token too, passes `http_client`: that one
//! place holds hosts, sizes and times to what is allowed.

pub mod access;
pub mod address;
#[cfg(feature = "cloud")]
pub(crate) mod blocks_on_disk;
pub mod companions;
pub mod error;
#[cfg(feature = "cloud")]
pub(crate) mod file;
#[cfg(feature = "cloud")]
pub(crate) mod http_client;
#[cfg(feature = "cloud")]
pub(crate) mod object;
pub mod open;
#[cfg(feature = "cloud")]
pub(crate) mod request_error;
#[cfg(feature = "cloud")]
pub(crate) mod runtime;
#[cfg(feature = "cloud")]
pub(crate) mod store;
#[cfg(feature = "cloud")]
pub(crate) mod times;
pub mod traffic;
