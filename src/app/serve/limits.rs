//! What one client may ask, and all of them together.
//!
//! Everything that a request can make large has a bound that is checked before memory is taken for it: points, bytes,
//! posts of a viewshed, requests at once, connections, seconds. So the service's memory is bounded by its arguments,
//! whatever is sent to it.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use clap::Args;

/// What may be asked.
#[derive(Clone, Debug, Args)]
pub struct ServeLimits {
    /// The most points of one request: locations, samples, vertices
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub max_points: u32,
    /// The most posts of one viewshed: those in the square around its range
    #[arg(long, value_name = "N", default_value_t = 4_194_304, value_parser = clap::value_parser!(u32).range(1..=268_435_456))]
    pub max_posts: u32,
    /// The most requests answered at once; more are told to come back
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub max_requests: u32,
    /// The most connections held open
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub max_connections: u32,
    /// How long a request may take to arrive, and how long its answer may take
    #[arg(long, value_name = "SECONDS", default_value_t = 30, value_parser = clap::value_parser!(u16).range(1..=3600))]
    pub timeout: u16,
    /// How long the last answers may take when the service is stopped
    #[arg(long, value_name = "SECONDS", default_value_t = 10, value_parser = clap::value_parser!(u16).range(0..=3600))]
    pub grace: u16,
}

impl ServeLimits {
    /// The longest path and query of a request, in bytes. HTTP itself is refused from 65,535 bytes on, without a
    /// reason; this leaves room to give one.
    pub const LONGEST_URL: usize = 60_000;

    /// The largest body in bytes: 128 a point, which holds both coordinates at full precision with the quotes and
    /// escapes of any notation, and 64 KiB.
    pub fn longest_body(&self) -> usize {
        self.max_points as usize * 128 + 65_536
    }

    /// The most points of one request.
    pub fn points(&self) -> usize {
        self.max_points as usize
    }

    /// The most stations of one profile: ten times the points, for it has one wherever the ground bends.
    pub fn stations(&self) -> usize {
        self.max_points as usize * 10
    }

    /// How long a request may take to arrive, and how long its answer may take.
    pub fn patience(&self) -> Duration {
        Duration::from_secs(self.timeout.into())
    }
}

/// So many of something at once, and no more.
#[derive(Clone, Debug)]
pub struct Turnstile {
    inside: Arc<AtomicUsize>,
    most: usize,
}

impl Turnstile {
    /// One that lets in `most`.
    pub fn new(most: usize) -> Self {
        Self { inside: Arc::default(), most }
    }

    /// A place inside until it is dropped, or `None` where all are taken.
    pub fn enter(&self) -> Option<Permit> {
        let place = Permit(Arc::clone(&self.inside));
        // Counted in before it is compared, so that two who come at once cannot both have the last place.
        let before = self.inside.fetch_add(1, Ordering::Relaxed);
        (before < self.most).then_some(place)
    }
}

/// A place inside a [`Turnstile`].
#[derive(Debug)]
pub struct Permit(Arc<AtomicUsize>);

impl Drop for Permit {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turnstile_lets_in_as_many_as_it_says_and_the_next_when_one_has_left() {
        let gate = Turnstile::new(2);
        let (first, second) = (gate.enter(), gate.enter());
        assert!(first.is_some() && second.is_some() && gate.enter().is_none());
        drop(first);
        assert!(gate.enter().is_some());
    }
}
