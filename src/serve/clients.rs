//! The clients, and what each may take of the service at once: connections, requests, long bodies, memory of answers.
//!
//! A client is an address, or of IPv6 the network of one (/64). Where something is used up, it is taken back from whoever
//! has most of it or uses it slowest, and one client's share never is all. So nobody waits or is refused for what others
//! hold:
//!
//! | | of one client | where all is taken |
//! |---|---|---|
//! | connections | half; more are refused | a connection of the client with most is closed, the idle ones first |
//! | requests | half; more are refused | |
//! | long bodies, long answers | half; more wait or are refused | the slowest is closed where it is slower than [`SLOW`] |
//! | heavy and expensive work | its turn | turns in order of arrival |

use std::collections::BTreeMap;
use std::net::{IpAddr, Ipv6Addr};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::Waker;
use std::time::Duration;

use tokio::sync::Semaphore;
use tokio::time::Instant;

/// Bytes a second below which a connection is closed in favor of one that waits: a line as slow as modems were. More would
/// cut off those with bad lines, less would let idlers hold what others need.
const SLOW: f64 = 8.0 * 1024.0;

/// How long a connection may take to gain speed.
const START: Duration = Duration::from_secs(1);

/// The shares of one client in every limited resource.
#[derive(Clone, Copy, Debug)]
pub struct ClientShares {
    pub connections: usize,
    pub requests: usize,
    pub long_bodies: usize,
    /// Units of the memory of unread answers.
    pub answers: usize,
    /// Heavy queries worked on at once.
    pub heavy: usize,
    /// Expensive queries worked on at once.
    pub expensive: usize,
}

/// A client with open connections.
#[derive(Debug)]
pub struct Client {
    pub requests: Arc<Semaphore>,
    pub long_bodies: Arc<Semaphore>,
    pub answers: Arc<Semaphore>,
    pub heavy: Arc<Semaphore>,
    pub expensive: Arc<Semaphore>,
}

impl Client {
    fn new(shares: &ClientShares) -> Self {
        let semaphore = |permits: usize| Arc::new(Semaphore::new(permits));
        Self {
            requests: semaphore(shares.requests),
            long_bodies: semaphore(shares.long_bodies),
            answers: semaphore(shares.answers),
            heavy: semaphore(shares.heavy),
            expensive: semaphore(shares.expensive),
        }
    }
}

/// Something scarce that a connection holds while bytes move over it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeldResource {
    /// A long body, until it is received.
    Body,
    /// A long answer, until it is read.
    Answer,
}

/// What a connection does.
#[derive(Debug)]
struct ConnectionActivity {
    /// Whether a request is being received or answered.
    is_busy: bool,
    /// Since when it is busy, or is not.
    since: Instant,
    held: Option<HeldResource>,
    /// Bytes that moved since the resource is held, and since when it is.
    moved: u64,
    held_since: Instant,
    is_closed: bool,
    /// Wakes the task of the connection.
    waker: Option<Waker>,
}

/// An open connection.
#[derive(Debug)]
pub struct Connection {
    number: u64,
    address: IpAddr,
    pub client: Arc<Client>,
    activity: Mutex<ConnectionActivity>,
}

impl Connection {
    fn activity(&self) -> MutexGuard<'_, ConnectionActivity> {
        self.activity.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn set_busy(&self, is_busy: bool) {
        let mut activity = self.activity();
        if activity.is_busy != is_busy {
            activity.is_busy = is_busy;
            activity.since = Instant::now();
        }
    }

    /// Counts bytes that were received or sent.
    pub fn moved(&self, bytes: usize) {
        self.activity().moved += bytes as u64;
    }

    /// Notes that a resource is held from now on, or is not any more.
    pub fn hold(&self, held: Option<HeldResource>) {
        let mut activity = self.activity();
        activity.held = held;
        activity.moved = 0;
        activity.held_since = Instant::now();
    }

    /// Whether the connection must end; if not, `waker` is woken when it must.
    pub fn is_closed(&self, waker: &Waker) -> bool {
        let mut activity = self.activity();
        if !activity.waker.as_ref().is_some_and(|known| known.will_wake(waker)) {
            activity.waker = Some(waker.clone());
        }
        activity.is_closed
    }

    fn close(&self) {
        let mut activity = self.activity();
        activity.is_closed = true;
        if let Some(waker) = activity.waker.take() {
            waker.wake();
        }
    }

    /// Bytes a second of the connection that holds `resource`, where it is slow.
    fn slowness(&self, resource: HeldResource, now: Instant) -> Option<f64> {
        let activity = self.activity();
        let time = now.saturating_duration_since(activity.held_since);
        let rate = activity.moved as f64 / time.as_secs_f64();
        (activity.held == Some(resource) && !activity.is_closed && time > START && rate < SLOW)
            .then_some(rate)
    }
}

/// An open connection, which is not open any more when this is dropped.
#[derive(Debug)]
pub struct OpenConnection {
    pub connection: Arc<Connection>,
    clients: Arc<Clients>,
}

impl Drop for OpenConnection {
    fn drop(&mut self) {
        self.clients.table().remove(&self.connection);
    }
}

/// All clients with open connections.
#[derive(Debug)]
pub struct Clients {
    most: usize,
    shares: ClientShares,
    table: Mutex<ClientTable>,
}

#[derive(Debug, Default)]
struct ClientTable {
    clients: BTreeMap<IpAddr, ClientConnections>,
    open: usize,
    next: u64,
}

#[derive(Debug)]
struct ClientConnections {
    client: Arc<Client>,
    connections: BTreeMap<u64, Arc<Connection>>,
}

impl ClientTable {
    fn remove(&mut self, connection: &Connection) {
        let Some(entry) = self.clients.get_mut(&connection.address) else { return };
        if entry.connections.remove(&connection.number).is_none() {
            return;
        }
        self.open -= 1;
        if entry.connections.is_empty() {
            self.clients.remove(&connection.address);
        }
    }

    /// A connection of the client with most, where it has more than `most_fair`: one without a request, else one with, the
    /// oldest of them.
    fn excessive(&self, most_fair: usize) -> Option<Arc<Connection>> {
        let largest = self.clients.values().max_by_key(|entry| entry.connections.len())?;
        let age = |connection: &&Arc<Connection>| {
            let activity = connection.activity();
            (activity.is_busy, activity.since)
        };
        let oldest = || largest.connections.values().min_by_key(age).cloned();
        if largest.connections.len() > most_fair { oldest() } else { None }
    }
}

impl Clients {
    /// Clients with at most `most` connections in all.
    pub fn new(most: usize, shares: ClientShares) -> Arc<Self> {
        Arc::new(Self { most, shares, table: Mutex::default() })
    }

    fn table(&self) -> MutexGuard<'_, ClientTable> {
        self.table.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes a connection from `address`; `None` where the client has its share.
    pub fn admit(self: &Arc<Self>, address: IpAddr) -> Option<OpenConnection> {
        let address = client_address(address);
        let mut table = self.table();
        let own = table.clients.get(&address).map_or(0, |entry| entry.connections.len());
        if own >= self.shares.connections {
            return None;
        }
        if table.open >= self.most {
            let excessive = table.excessive(own + 1)?;
            excessive.close();
            table.remove(&excessive);
        }
        table.open += 1;
        table.next += 1;
        let number = table.next;
        let entry = table.clients.entry(address).or_insert_with(|| ClientConnections {
            client: Arc::new(Client::new(&self.shares)),
            connections: BTreeMap::new(),
        });
        let now = Instant::now();
        let connection = Arc::new(Connection {
            number,
            address,
            client: Arc::clone(&entry.client),
            activity: Mutex::new(ConnectionActivity {
                is_busy: false,
                since: now,
                held: None,
                moved: 0,
                held_since: now,
                is_closed: false,
                waker: None,
            }),
        });
        entry.connections.insert(number, Arc::clone(&connection));
        Some(OpenConnection { connection, clients: Arc::clone(self) })
    }

    /// Closes the slowest connection that holds `resource`, where one is too slow to be waited for.
    pub fn close_slowest(&self, resource: HeldResource) {
        self.close_slowest_at(resource, Instant::now());
    }

    fn close_slowest_at(&self, resource: HeldResource, now: Instant) {
        let table = self.table();
        let connections = table.clients.values().flat_map(|entry| entry.connections.values());
        let slow =
            connections.filter_map(|connection| Some((connection.slowness(resource, now)?, connection)));
        if let Some((_, slowest)) = slow.min_by(|(a, _), (b, _)| a.total_cmp(b)) {
            slowest.close();
        }
    }
}

/// The address that counts as one client: of IPv6 the network, of which one subscriber has all addresses.
fn client_address(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => Ipv6Addr::from_bits(address.to_bits() & !u128::from(u64::MAX)).into(),
        address => address,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clients(most: usize) -> Arc<Clients> {
        let shares = ClientShares {
            connections: most.div_ceil(2),
            requests: 1,
            long_bodies: 1,
            answers: 1,
            heavy: 1,
            expensive: 1,
        };
        Clients::new(most, shares)
    }

    fn address(last: u8) -> IpAddr {
        [10, 0, 0, last].into()
    }

    fn is_closed(open: &OpenConnection) -> bool {
        open.connection.is_closed(Waker::noop())
    }

    #[test]
    fn one_client_has_half_and_two_make_place_for_a_third() {
        let clients = clients(8);
        let take = |last: u8, count: usize| {
            (0..count).filter_map(|_| clients.admit(address(last))).collect::<Vec<_>>()
        };
        let first = take(1, 5);
        assert_eq!(first.len(), 4, "half of all");
        let second = take(2, 4);
        first[0].connection.set_busy(true);
        let third = take(3, 4);
        assert_eq!(third.len(), 2, "the others are left no fewer");
        let closed: Vec<bool> = first.iter().chain(&second).map(is_closed).collect();
        assert_eq!(closed.iter().filter(|&&closed| closed).count(), 2, "{closed:?}");
        assert!(!closed[0], "one with a request is closed last");
        drop((first, second));
        assert_eq!(clients.table().open, 2);
        drop(third);
        assert!(clients.table().clients.is_empty());
    }

    #[test]
    fn addresses_of_one_ipv6_network_are_one_client() {
        let of = |text: &str| client_address(text.parse().expect("an address"));
        assert_eq!(of("2001:db8::1"), of("2001:db8::ffff:2"));
        assert_ne!(of("2001:db8::1"), of("2001:db8:0:1::1"));
        assert_eq!(of("::ffff:10.0.0.1"), address(1));
    }

    #[test]
    fn the_slowest_is_closed_and_nobody_who_is_fast_enough() {
        use HeldResource::{Answer, Body};
        let clients = clients(8);
        let open: Vec<OpenConnection> = (0..4).filter_map(|last| clients.admit(address(last))).collect();
        for (open, held) in open.iter().zip([Some(Answer), Some(Answer), Some(Body), None]) {
            open.connection.hold(held);
        }
        clients.close_slowest(Answer);
        assert!(!open.iter().any(is_closed), "nobody had time");
        let later = Instant::now() + Duration::from_secs(2);
        open[0].connection.moved(100);
        clients.close_slowest_at(Answer, later);
        assert_eq!(open.iter().map(is_closed).collect::<Vec<_>>(), [false, true, false, false]);
        open[0].connection.moved(1 << 20);
        clients.close_slowest_at(Answer, later);
        assert!(!is_closed(&open[0]), "it is fast enough");
    }
}
